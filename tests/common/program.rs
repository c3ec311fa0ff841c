//! The program as its users call it, in a folder of the test's own.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// The program with its arguments, not started yet.
pub fn brdf(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_brdf"));
    // A folder of its own for drivers that would otherwise complain on standard error.
    command.current_dir(folder).env("XDG_RUNTIME_DIR", folder).args(arguments).stdin(Stdio::null());
    command
}

/// Runs the program to its end.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    brdf(folder, arguments).output().unwrap()
}

/// A fresh folder.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// What was printed.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// `render` with little work, and more arguments.
pub fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["render", "--resolution", "24", "--samples", "4", "--passes", "2"];
    arguments.extend_from_slice(more);
    arguments
}

/// Runs with bad input: exit code 2, one problem on standard error, nothing else, no file left.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let files = || {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = files();
    let output = run(folder, arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed {}", text(&output.stdout));
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    assert_eq!(files(), before, "{arguments:?} left files");
    let problems: Vec<_> = error.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(problems.len(), 1, "{arguments:?}: {error}");
    problems[0].to_owned()
}
