//! A file that somebody named, read whole, or one line on why it cannot be.
//!
//! What is no regular file is refused, since a pipe would be waited for. What the bytes mean is the caller's part.

use std::io::ErrorKind;
use std::path::Path;

use brdf_sdk::{Problem, Result};

/// The bytes of a file.
///
/// # Errors
/// Where there is none, or it cannot be read; `cure` says what else would do.
pub fn read(path: &Path, cure: &str) -> Result<Vec<u8>> {
    let problem = |reason: String| Problem::new(path.display().to_string(), reason, cure);
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => problem("there is no such file".to_owned()),
        _ => problem(format!("it cannot be read ({error})")),
    };
    let known = std::fs::metadata(path).map_err(failed)?;
    if known.is_dir() {
        return Err(problem("this is a folder".to_owned()));
    }
    if !known.is_file() {
        return Err(problem("this is no regular file".to_owned()));
    }
    std::fs::read(path).map_err(failed)
}
