//! What a reader owes to any bytes where it gives no value, and how it gets them.

use brdf_sdk::Problem;

/// Holds a problem to the form of all of them: one line, beside the line of the author's file that it may show. Only
/// what the shader compiler finds at a place may lack a cure.
///
/// # Panics
/// It has another form.
pub fn refused(problem: &Problem) {
    let line = problem.line();
    let parts = [&problem.thing, &problem.reason, &problem.cure];
    let whole = parts.iter().all(|part| !part.is_empty()) || problem.place.is_some();
    assert!(whole && !problem.reason.is_empty() && !line.contains(char::is_control), "{line:?}");
    let lines = 1 + 2 * usize::from(problem.place.is_some());
    let shown = problem.to_string();
    assert_eq!(shown.lines().count(), lines, "{shown:?}");
}

/// A path that each run of a target writes its bytes to, for readers that take a path.
///
/// # Panics
/// It cannot be written.
pub fn file(extension: &str, bytes: &[u8]) -> std::path::PathBuf {
    let name = format!("brdf-fuzz-{}.{extension}", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, bytes).expect("the folder for temporary files takes a file");
    path
}
