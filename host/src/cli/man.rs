//! `brdf man`: the manual, from the same declarations that read the command line.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};
use clap::{Arg, Command};

use super::print;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The folder that gets the pages; it must be there
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Write cli.md, one page of Markdown, instead of a man page for the program and each of its verbs
    #[arg(long)]
    markdown: bool,
}

pub(super) fn run(program: Command, arguments: &Arguments) -> Result<()> {
    let folder = &arguments.folder;
    if !folder.is_dir() {
        return Err(Problem::new(
            folder.display().to_string(),
            "there is no such folder",
            "make it, or name one that is there",
        ));
    }
    let pages = match arguments.markdown {
        true => vec![("cli.md".to_owned(), markdown(program).into_bytes())],
        false => man_pages(program).map_err(|error| unwritten(folder, &error))?,
    };
    for (name, page) in &pages {
        let path = folder.join(name);
        std::fs::write(&path, page).map_err(|error| unwritten(&path, &error))?;
    }
    let plural = if pages.len() == 1 { "" } else { "s" };
    print(&format!("wrote {} page{plural} to {}\n", pages.len(), folder.display()))
}

fn unwritten(path: &Path, error: &std::io::Error) -> Problem {
    Problem::new(path.display().to_string(), error.to_string(), "name a folder that can be written")
}

/// `brdf.1`, and `brdf-VERB.1` for each verb.
fn man_pages(program: Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    // The commit would change every page with every commit.
    let mut program = program.version(env!("CARGO_PKG_VERSION")).disable_help_subcommand(true);
    program.build();
    let verbs = program.get_subcommands().filter(|verb| !verb.is_hide_set()).cloned();
    let pages: Vec<_> = std::iter::once(program.clone()).chain(verbs).collect();
    pages
        .into_iter()
        .map(|command| {
            let man = clap_mangen::Man::new(command);
            let mut page = Vec::new();
            man.render(&mut page)?;
            Ok((man.get_filename(), page))
        })
        .collect()
}

/// All verbs on one page: usage, arguments and options of each.
fn markdown(program: Command) -> String {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let mut page = format!(
        "# Command line\n\nMade by `brdf man docs --markdown` of what the program itself reads; `brdf VERB --help` \
         says the same. {}\n\nEvery verb takes these, too:\n\n{}\n",
        program.get_about().map(ToString::to_string).unwrap_or_default() + ".",
        table(program.get_arguments().filter(|argument| argument.is_global_set())),
    );
    page += "| verb | what it does |\n|---|---|\n";
    for verb in program.get_subcommands() {
        let name = verb.get_name();
        let _ = writeln!(page, "| [`{name}`](#brdf-{name}) | {} |", cell(&about(verb)));
    }
    for verb in program.get_subcommands() {
        let usage = verb.clone().render_usage().to_string();
        let usage = usage.trim_start_matches("Usage: ");
        let _ = write!(page, "\n## brdf {}\n\n{}.\n\n`{usage}`\n", verb.get_name(), about(verb));
        let own = verb.get_arguments().filter(|argument| !argument.is_global_set());
        let rows = table(own);
        if !rows.is_empty() {
            let _ = write!(page, "\n{rows}");
        }
    }
    page
}

/// One line on a verb.
fn about(verb: &Command) -> String {
    verb.get_about().map(ToString::to_string).unwrap_or_default()
}

/// A row for each argument, positional ones first as they are declared.
fn table<'a>(arguments: impl Iterator<Item = &'a Arg>) -> String {
    let shown = |argument: &&Arg| !argument.is_hide_set() && argument.get_id() != "help";
    let rows: String = arguments.filter(shown).map(row).collect();
    match rows.is_empty() {
        true => rows,
        false => format!("| argument | meaning |\n|---|---|\n{rows}"),
    }
}

fn row(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help());
    let mut meaning = help.map(ToString::to_string).unwrap_or_default();
    let takes_value = argument.get_action().takes_values();
    let names_choices = takes_value && !argument.is_hide_possible_values_set();
    let choices: Vec<_> = argument
        .get_possible_values()
        .iter()
        .filter(|value| names_choices && !value.is_hide_set())
        .map(|value| value.get_name().to_owned())
        .collect();
    if !choices.is_empty() {
        let _ = write!(meaning, " [one of: {}]", choices.join(", "));
    }
    let defaults: Vec<_> =
        argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if takes_value && !defaults.is_empty() {
        let _ = write!(meaning, " [default: {}]", defaults.join(" "));
    }
    format!("| `{}` | {} |\n", spelling(argument).replace('|', "\\|"), cell(&meaning))
}

/// As it is written on a command line: `-o, --output FILE`.
fn spelling(argument: &Arg) -> String {
    let names = argument.get_value_names().unwrap_or_default();
    let values = names.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    if argument.is_positional() {
        let many = argument.get_num_args().is_some_and(|count| count.max_values() > 1);
        return format!("{values}{}", if many { "..." } else { "" });
    }
    let short = argument.get_short().map(|short| format!("-{short}"));
    let long = argument.get_long().map(|long| format!("--{long}"));
    let flag = short.into_iter().chain(long).collect::<Vec<_>>().join(", ");
    match argument.get_action().takes_values() {
        true => format!("{flag} {values}"),
        false => flag,
    }
}

/// A text that keeps to its cell of a table.
fn cell(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}
