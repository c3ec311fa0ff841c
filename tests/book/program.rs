//! What the pages say of programs, held against the programs: `brdf` by its own parser of arguments, plugins, cargo's
//! tests and benchmarks by their names, scripts and files by whether they are there. Nothing runs here.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use brdf_host::cli::Cli;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use super::common::root;
use super::page::Page;
use super::shell;

/// Folders of the tree, by which a path in the prose is told.
const FOLDERS: [&str; 12] = [
    ".ci", "benches", "brdf-sdk", "docs", "envmaps", "examples", "fuzz", "host", "plugins",
    "scripts", "shaders", "tests",
];

/// Whether the program understands these arguments; asking for help or the version is understood.
pub fn parse(arguments: &[String]) -> Result<(), clap::Error> {
    let all = std::iter::once("brdf").chain(arguments.iter().map(String::as_str));
    match Cli::try_parse_from(all) {
        Err(error)
            if !matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) =>
        {
            Err(error)
        }
        _ => Ok(()),
    }
}

/// What a program complains of, on one line.
pub fn one_line(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" / ")
}

/// Words without the variables before them, `NAME=value`.
pub fn without_variables(words: &[String]) -> &[String] {
    let is_variable = |word: &&String| {
        let name = word.split_once('=').map_or("", |(name, _)| name);
        !name.is_empty()
            && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
    };
    &words[words.iter().take_while(is_variable).count()..]
}

/// Checks a command that is not run: one of cargo, of git, or a script of the tree.
pub fn check(words: &[String]) -> Result<(), String> {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["git", "clone", _, ..] => Ok(()),
        ["cargo", verb, ref rest @ ..] => cargo(verb, rest),
        [script, ..] if script.starts_with("scripts/") || script.starts_with(".ci/") => {
            is_program(script)
        }
        _ => Err("nothing is known of this program".to_owned()),
    }
}

fn is_program(script: &str) -> Result<(), String> {
    let file = root().join(script);
    let text = fs::read_to_string(file).map_err(|_| format!("there is no {script}"))?;
    if !text.starts_with("#!") {
        return Err(format!("{script} does not say what runs it"));
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode =
            root().join(script).metadata().map_err(|error| error.to_string())?.permissions().mode();
        if mode & 0o111 == 0 {
            return Err(format!("{script} cannot be executed"));
        }
    }
    Ok(())
}

fn cargo(verb: &str, rest: &[&str]) -> Result<(), String> {
    let split = rest.iter().position(|word| *word == "--").unwrap_or(rest.len());
    let (own, behind) = (&rest[..split], rest.get(split + 1..).unwrap_or_default());
    let named = |option: &str| {
        own.iter().position(|word| *word == option).and_then(|at| own.get(at + 1)).copied()
    };
    match verb {
        "run" => {
            let arguments: Vec<String> = behind.iter().map(|word| (*word).to_owned()).collect();
            return parse(&arguments).map_err(|error| one_line(&error.to_string()));
        }
        "install" => {
            let path = named("--path").ok_or("cargo install needs --path")?;
            if !root().join(path).join("Cargo.toml").exists() {
                return Err(format!("there is no crate in {path}"));
            }
        }
        "build" | "test" | "bench" | "clippy" | "fmt" | "doc" => {}
        _ => return Err(format!("nothing is known of cargo {verb}")),
    }
    for (option, table) in [("--test", "test"), ("--bench", "bench")] {
        if let Some(name) = named(option)
            && !targets(table).contains(name)
        {
            return Err(format!("there is no {table} {name}"));
        }
    }
    Ok(())
}

/// The tests or the benchmarks of the host, by name, and the tests of the other crates.
fn targets(table: &str) -> BTreeSet<String> {
    let manifest = fs::read_to_string(root().join("host/Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let own = manifest[table].as_array().unwrap().iter();
    let mut names: BTreeSet<String> =
        own.map(|target| target["name"].as_str().unwrap().to_owned()).collect();
    if table == "test" {
        for folder in
            ["brdf-sdk/glsl-brdf/tests", "brdf-sdk/wgsl-cpu/tests", "plugins/native/measured/tests"]
        {
            let files = fs::read_dir(root().join(folder)).into_iter().flatten();
            names.extend(
                files.filter_map(|file| Some(file.ok()?.path().file_stem()?.to_str()?.to_owned())),
            );
        }
    }
    names
}

/// What the code within the prose says that is not so.
pub fn wrong_in_prose(page: &Page) -> Vec<String> {
    let mut wrong = Vec::new();
    for (line, span) in page.spans() {
        let told = [command(&span), paths(&span), options(&span)];
        let told = told.into_iter().filter_map(Result::err);
        wrong.extend(told.map(|what| format!("{}:{line}: `{span}`: {what}", page.name)));
    }
    wrong
}

/// A whole command in the prose; one with `...` or brackets is a pattern, and a word in capitals stands for many.
fn command(span: &str) -> Result<(), String> {
    let begins =
        |program: &str| span.starts_with(program) || span.contains(&format!("| {program}"));
    let ours = begins("brdf ");
    let open = ["...", "…", "[", "<", "brdf VERB"].iter().any(|mark| span.contains(mark));
    if open || !(ours || begins("cargo ") || begins("scripts/") || span.contains(" scripts/")) {
        return Ok(());
    }
    let Some(command) = shell::parse(span)? else { return Ok(()) };
    let words = without_variables(&command.words);
    if !ours {
        return check(words);
    }
    let stands_for_many = |word: &String| {
        word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase() || c == '|') || word == "N"
    };
    let Err(error) = parse(words.get(1..).unwrap_or_default()) else { return plugins(words) };
    let fine = match error.kind() {
        // A verb and some of its options are named.
        ErrorKind::MissingRequiredArgument => true,
        // An option is named without its value, or with a word for it.
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            words.last().is_some_and(|word| word.starts_with("--"))
                || words.iter().any(stands_for_many)
        }
        _ => false,
    };
    if fine { Ok(()) } else { Err(one_line(&error.to_string())) }
}

/// Names of plugins that are none; paths and words in capitals are not names.
fn plugins(words: &[String]) -> Result<(), String> {
    // Help has no arguments.
    let Ok(matches) = Cli::command().try_get_matches_from(words) else { return Ok(()) };
    let Some((_, of_verb)) = matches.subcommand() else { return Ok(()) };
    for kind in ["brdf", "brdfs", "integrator", "integrators", "rendering", "by", "against"] {
        for name in of_verb.try_get_many::<String>(kind).ok().flatten().into_iter().flatten() {
            let is_name =
                !name.contains(['.', '/']) && !name.contains(|c: char| c.is_ascii_uppercase());
            let there = ["brdf", "integrator"]
                .iter()
                .any(|folder| root().join("plugins").join(folder).join(name).is_dir());
            if is_name && !there {
                return Err(format!("there is no plugin {name}"));
            }
        }
    }
    Ok(())
}

/// Paths into the tree that lead nowhere. What is written by a command need not be there.
fn paths(span: &str) -> Result<(), String> {
    let mut before = "";
    for word in span.split_whitespace() {
        let written = ["-o", "--export"].contains(&before);
        before = word;
        let path =
            word.trim_start_matches("./").split([':', '#', ',', '=']).next().unwrap_or_default();
        let first = path.split('/').next().unwrap_or_default();
        if written || !path.contains('/') || !FOLDERS.contains(&first) {
            continue;
        }
        // Up to what stands for many.
        let stands_for_many = |part: &&str| {
            let capitals = part.len() > 2 && part.chars().all(|c| c.is_ascii_uppercase());
            capitals || part.contains(['*', '{', '<', '%', '…']) || part.contains("...")
        };
        let parts = path.split('/').take_while(|part| !stands_for_many(part));
        let path = parts.collect::<Vec<_>>().join("/");
        if !root().join(&path).exists() {
            return Err(format!("there is no {path}"));
        }
    }
    Ok(())
}

/// Long options that no verb has, and no script.
fn options(span: &str) -> Result<(), String> {
    if ["cargo ", "pip ", "git ", "apt-get "].iter().any(|program| span.contains(program)) {
        return Ok(());
    }
    let known = known_options();
    for word in span.split([' ', '=', ',', '|', '[', ']', '(', ')']) {
        let Some(name) = word.strip_prefix("--").map(|name| name.trim_end_matches(['.', ';', ':']))
        else {
            continue;
        };
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        if is_name && !known.contains(name) && !script_has(word) {
            return Err(format!("no verb has --{name}"));
        }
    }
    Ok(())
}

fn known_options() -> BTreeSet<String> {
    let program = Cli::command();
    let verbs = program.get_subcommands().flat_map(clap::Command::get_arguments);
    let all = program.get_arguments().chain(verbs);
    let named = all.filter_map(|argument| argument.get_long().map(str::to_owned));
    named.chain(["help", "version"].map(str::to_owned)).collect()
}

fn script_has(word: &str) -> bool {
    let script = Path::new("examples/beside-mitsuba/compare.py");
    fs::read_to_string(root().join(script)).is_ok_and(|text| text.contains(&format!("\"{word}\"")))
}

/// The document of the integrators lists what there is.
pub fn every_integrator_has_its_line() {
    let page = fs::read_to_string(root().join("docs/integrators.md")).unwrap();
    let shipped =
        page.split_once("## Those that are shipped").unwrap().1.split("\n## ").next().unwrap();
    let listed: BTreeSet<String> = shipped
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once(" | "))
        .flat_map(|(names, _)| {
            names.split(", ").map(|name| name.trim_matches('`').to_owned()).collect::<Vec<_>>()
        })
        .collect();
    let folders = fs::read_dir(root().join("plugins/integrator")).unwrap();
    let there: BTreeSet<String> =
        folders.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(listed, there);
}
