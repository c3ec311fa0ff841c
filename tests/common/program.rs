//! The program as its users call it, in a folder of the test's own.

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
