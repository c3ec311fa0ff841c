//! A file that somebody named, read whole, or one line on why it cannot be.
//!
//! What is no regular file is refused, since a pipe would be waited for. What the bytes mean is the caller's part.

use std::io::ErrorKind;
use std::path::Path;

use brdf_sdk::{Problem, Result};

/// Why something could not be read or written, in the words of people: the system's own end in a number.
pub fn why(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::InvalidData => "it is no text".to_owned(),
        _ => {
            let told = error.to_string();
            told.split(" (os error").next().unwrap_or_default().to_lowercase()
        }
    }
}

/// The text of a file.
///
/// # Errors
/// Where there is none, it cannot be read, or is no text; `cure` says what else would do.
pub fn read_text(path: &Path, cure: &str) -> Result<String> {
    let bytes = read(path, cure)?;
    String::from_utf8(bytes)
        .map_err(|_| Problem::new(path.display().to_string(), "it is no text", cure))
}

/// The bytes of a file.
///
/// # Errors
/// Where there is none, or it cannot be read; `cure` says what else would do.
pub fn read(path: &Path, cure: &str) -> Result<Vec<u8>> {
    let problem = |reason: String| Problem::new(path.display().to_string(), reason, cure);
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => problem(why(&error)),
        _ => problem(format!("it cannot be read ({})", why(&error))),
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
