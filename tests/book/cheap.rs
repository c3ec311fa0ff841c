//! Makes a command small enough for a test: few pixels and samples, small maps, one law, the cores. What it says stays
//! what it says; only the work shrinks. A few cannot be made small, and are parsed alone.

use brdf_host::cli::Cli;
use clap::CommandFactory;

use super::shell::Command;

/// What becomes of a command.
#[derive(Debug, PartialEq, Eq)]
pub enum Way {
    /// It runs, with these arguments.
    Run(Vec<String>),
    /// It is only parsed, for this reason.
    Parse(&'static str),
}

/// Options that every verb gets which has them, whatever the page says. All pictures of a page have one size, so that
/// they can be compared.
const FEW: [(&str, &str); 5] = [
    ("--resolution", "16"),
    ("--passes", "2"),
    ("--ibl-width", "32"),
    ("--repeats", "1"),
    ("--device", "cpu"),
];

/// Options whose values are replaced where a page has them.
const FEWER: [(&str, &str); 3] = [("--time", "0.05"), ("--size", "16"), ("--ibl-face", "16")];

/// The verb of these arguments.
pub fn verb(arguments: &[String]) -> Option<clap::Command> {
    let program = Cli::command();
    arguments.iter().find_map(|word| program.find_subcommand(word)).cloned()
}

/// What is to be done with a command of these arguments.
pub fn way(command: &Command, arguments: &[String]) -> Way {
    let mut small = Small { arguments: arguments.to_vec() };
    if small.has("--help") || small.has("--version") {
        return Way::Run(small.arguments);
    }
    let Some(verb) = verb(arguments) else { return Way::Parse("it opens the window") };
    if let Some(reason) = small.cannot_run(verb.get_name()) {
        return Way::Parse(reason);
    }
    small.shrink(&verb);
    small.shrink_further(verb.get_name(), command);
    Way::Run(small.arguments)
}

struct Small {
    arguments: Vec<String>,
}

impl Small {
    fn has(&self, option: &str) -> bool {
        let with = format!("{option}=");
        self.arguments.iter().any(|word| word == option || word.starts_with(&with))
    }

    /// Why a command is parsed and does not run.
    fn cannot_run(&self, verb: &str) -> Option<&'static str> {
        let preset = self.arguments.iter().skip_while(|word| *word != "--preset").nth(1);
        match verb {
            "view" => Some("it opens the window"),
            "docs" => Some("it takes a minute for each BRDF; tests/docs.rs does it"),
            "render" if self.has("--watch") => Some("it does not end; tests/watching.rs does it"),
            "bench" if preset.is_some_and(|name| name == "seed" || name == "hard") => {
                Some("its references take minutes; tests/bench.rs has small ones")
            }
            _ => None,
        }
    }

    /// Options that verbs have in common.
    fn shrink(&mut self, verb: &clap::Command) {
        let known = |option: &str| {
            verb.get_arguments().any(|argument| argument.get_long() == option.strip_prefix("--"))
        };
        // Of a map only the proof runs on a device.
        let has_device = verb.get_name() != "env" || self.has("--conform");
        for (option, value) in FEW {
            if known(option) && (option != "--device" || has_device) {
                self.set(option, value);
            }
        }
        for (option, value) in FEWER {
            if self.has(option) {
                self.set(option, value);
            }
        }
    }

    /// Options of one verb each.
    fn shrink_further(&mut self, verb: &str, command: &Command) {
        match verb {
            "render" => self.set("--samples", "8"),
            "bench" => {
                self.set("--samples", "16");
                self.set("--time", "0.01");
                if !self.has("--integrators") && !self.has("--preset") {
                    self.set("--integrators", "brdf-is,mis-balance");
                }
            }
            // What is not decided in that time is written all the same.
            "reference" => {
                self.set("--check-time", "1");
                self.add("--undecided");
            }
            "recommend" => self.set("--time", "0.01"),
            "import" => self.add("--no-report"),
            "conform" => {
                let references = self.has("--references");
                self.remove("--law");
                match command.code {
                    0 if references => self.set("--law", "references"),
                    0 => self.set("--law", "contract"),
                    // Those that are said to fail: `exit code 1: the law of sampling fails`.
                    _ => {
                        let laws = command.why.split("law of ").skip(1);
                        let laws = laws.filter_map(|rest| rest.split(' ').next());
                        laws.for_each(|law| self.more("--law", law));
                    }
                }
            }
            _ => {}
        }
    }

    /// Takes an option with its value out, however often it is there.
    fn remove(&mut self, option: &str) {
        let with = format!("{option}=");
        self.arguments.retain(|word| !word.starts_with(&with));
        while let Some(at) = self.arguments.iter().position(|word| word == option) {
            self.arguments.drain(at..(at + 2).min(self.arguments.len()));
        }
    }

    fn more(&mut self, option: &str, value: &str) {
        self.arguments.extend([option.to_owned(), value.to_owned()]);
    }

    fn set(&mut self, option: &str, value: &str) {
        self.remove(option);
        self.more(option, value);
    }

    fn add(&mut self, flag: &str) {
        if !self.has(flag) {
            self.arguments.push(flag.to_owned());
        }
    }
}
