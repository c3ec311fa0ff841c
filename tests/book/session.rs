//! A page as a session: its commands run in a fresh folder, in their order, and end as they are said to.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use super::cheap::{Way, verb, way};
use super::common::program;
use super::page::{Block, Page};
use super::shell::{self, Command};
use super::{bring, crates, program as known};

/// Languages of blocks; those of the first line may be files, and the others are looked at by nobody.
const FILES: [&str; 5] = ["toml", "wgsl", "rust", "json", "text"];
const PASSED_OVER: [&str; 5] = ["", "console", "glsl", "c", "python"];

/// Verbs whose work is not made small, and whose numbers are the same on every machine: a block of `text` behind them
/// holds what they print, shortened perhaps.
const AS_IT_STANDS: [&str; 2] = ["eval", "numerics"];

/// How many commands of a page run, and are not only parsed.
pub fn commands(page: &Page) -> usize {
    let lines = page
        .blocks()
        .into_iter()
        .filter(|block| block.language == "sh")
        .flat_map(|block| block.lines);
    let commands = lines.filter_map(|line| shell::parse(&line).ok().flatten());
    let runs = |command: &Command| match command.words.split_first() {
        Some((first, arguments)) => {
            first == "brdf" && matches!(way(command, arguments), Way::Run(_))
        }
        None => false,
    };
    commands.filter(runs).count()
}

/// What is wrong with the blocks of a page.
pub fn wrong(page: &Page) -> Vec<String> {
    let blocks = page.blocks();
    let mut session = Session::new();
    let commands: Vec<&String> = blocks
        .iter()
        .filter(|block| block.language == "sh")
        .flat_map(|block| &block.lines)
        .collect();
    bring::files(&session.top, &commands);
    let mut wrong = Vec::new();
    for block in &blocks {
        let told = session.block(block).into_iter();
        let place =
            |at: usize| (block.line + at, block.lines.get(at).map_or("", |line| line.trim()));
        wrong.extend(told.map(|(at, what)| {
            let (number, line) = place(at);
            format!("{}:{number}: {line}: {what}", page.name)
        }));
    }
    wrong
}

struct Session {
    /// The reader's folder, and the one that belongs to the user and not to the page.
    top: PathBuf,
    home: PathBuf,
    /// Where the reader is now.
    here: PathBuf,
    /// What the last command of the block before has printed, where it was run as it stands.
    printed: Option<String>,
    _folder: tempfile::TempDir,
}

impl Session {
    fn new() -> Self {
        let folder = program::folder();
        let of = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir(&path).unwrap();
            path
        };
        let (top, home) = (of("reader"), of("home"));
        Self { here: top.clone(), top, home, printed: None, _folder: folder }
    }

    /// What is wrong with a block, by its lines from 0.
    fn block(&mut self, block: &Block) -> Vec<(usize, String)> {
        let lines = block.lines.iter().enumerate();
        match block.language.as_str() {
            "sh" => lines.filter_map(|(at, line)| Some((at, self.line(line).err()?))).collect(),
            language if FILES.contains(&language) => {
                let mut wrong: Vec<_> =
                    self.file(block).err().into_iter().map(|what| (0, what)).collect();
                if let (Some(printed), "text") = (self.printed.take(), language) {
                    let is_there =
                        |line: &str| printed.lines().any(|known| known.trim_end() == line);
                    let missing = lines.filter(|(_, line)| {
                        let line = line.trim_end();
                        !line.is_empty() && line.trim() != "..." && !is_there(line)
                    });
                    wrong.extend(
                        missing.map(|(at, _)| {
                            (at, "the command above does not print this".to_owned())
                        }),
                    );
                }
                wrong
            }
            language if PASSED_OVER.contains(&language) => {
                let is_command =
                    |line: &str| language.is_empty() && line.trim_start().starts_with("brdf ");
                let commands = lines.filter(|(_, line)| is_command(line));
                const LANGUAGE: &str =
                    "a command in a block without a language; write `sh` behind the fence";
                commands.map(|(at, _)| (at, LANGUAGE.to_owned())).collect()
            }
            language => vec![(0, format!("nothing is known of blocks of `{language}`"))],
        }
    }

    /// A line of a block of `sh`.
    fn line(&mut self, line: &str) -> Result<(), String> {
        let Some(command) = shell::parse(line)? else { return Ok(()) };
        self.printed = None;
        let words = known::without_variables(&command.words);
        let Some((first, arguments)) = words.split_first() else {
            return Err("there is no command".to_owned());
        };
        match (first.as_str(), arguments) {
            ("brdf", arguments) => self.run(&command, arguments),
            ("cd", [folder]) => self.enter(folder),
            ("mkdir", [folder]) => {
                fs::create_dir(self.here.join(folder)).map_err(|error| format!("{folder}: {error}"))
            }
            ("cargo", [build, ..]) if build == "build" && self.here.join("Cargo.toml").exists() => {
                crates::build(&self.here)
            }
            _ => known::check(words),
        }
    }

    fn enter(&mut self, folder: &str) -> Result<(), String> {
        let to = self
            .here
            .join(folder)
            .canonicalize()
            .map_err(|_| format!("there is no folder {folder}"))?;
        if !to.starts_with(self.top.canonicalize().unwrap()) {
            return Err("it leads out of the page's folder".to_owned());
        }
        self.here = to;
        Ok(())
    }

    fn run(&mut self, command: &Command, arguments: &[String]) -> Result<(), String> {
        known::parse(arguments).map_err(|error| known::one_line(&error.to_string()))?;
        let Way::Run(small) = way(command, arguments) else { return Ok(()) };
        let small: Vec<&str> = small.iter().map(String::as_str).collect();
        let mut program = program::brdf(&self.here, &small);
        for variable in [
            "HOME",
            "XDG_DATA_HOME",
            "XDG_CONFIG_HOME",
            "XDG_CACHE_HOME",
            "XDG_RUNTIME_DIR",
            "APPDATA",
        ] {
            program.env(variable, &self.home);
        }
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = program.spawn().map_err(|error| error.to_string())?;
        if let (Some(mut stdin), Some(input)) = (child.stdin.take(), &command.input) {
            stdin.write_all(input.as_bytes()).map_err(|error| error.to_string())?;
        }
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        let said = program::text(&output.stderr);
        let shown = match said.trim() {
            "" => program::text(&output.stdout),
            _ => said.clone(),
        };
        let shown = known::one_line(&shown);
        match output.status.code() {
            _ if said.contains("panicked") => Err(shown),
            Some(code) if code == command.code => {
                let exact =
                    verb(arguments).is_some_and(|verb| AS_IT_STANDS.contains(&verb.get_name()));
                self.printed = exact.then(|| program::text(&output.stdout));
                Ok(())
            }
            Some(code) => {
                let small = small.join(" ");
                Err(format!("exit code {code} and not {} of `brdf {small}`: {shown}", command.code))
            }
            None => Err(format!("it ended by a signal: {shown}")),
        }
    }

    /// A block that begins with its path.
    fn file(&self, block: &Block) -> Result<(), String> {
        let Some(path) = path_of(block)? else { return Ok(()) };
        let file = self.top.join(&path);
        if Path::new(&path)
            .components()
            .any(|part| !matches!(part, std::path::Component::Normal(_)))
        {
            return Err("a file of a page lies in the page's folder".to_owned());
        }
        // JSON has no comments.
        let first = usize::from(block.language == "json");
        fs::create_dir_all(file.parent().unwrap()).map_err(|error| error.to_string())?;
        fs::write(file, block.lines[first..].join("\n") + "\n").map_err(|error| error.to_string())
    }
}

/// The path that a block's first line names. A comment that begins with a path and goes on is refused: it looks as if
/// the block were written there.
fn path_of(block: &Block) -> Result<Option<String>, String> {
    let first = block.lines.first().map_or("", String::as_str);
    let comment =
        first.strip_prefix("# ").or_else(|| first.strip_prefix("// ")).unwrap_or_default();
    let word = comment.split([' ', ',', ':', ';']).next().unwrap_or_default();
    let ending = word.rsplit_once('.').map_or("", |(_, ending)| ending);
    let allowed = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    match ["toml", "wgsl", "rs", "json", "txt"].contains(&ending) && word.chars().all(allowed) {
        false => Ok(None),
        true if comment.trim_end() == word => Ok(Some(word.to_owned())),
        true => Err("write the path alone, and the block is that file".to_owned()),
    }
}
