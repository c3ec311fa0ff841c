//! What every parser owes to any bytes: a value, or a sentence.

/// Holds an error to the form of all of them: one line, the reason, the cure.
///
/// # Panics
/// The error has another form.
pub fn held<T>(result: Result<T, String>) {
    if let Err(error) = result {
        let one_line = error.len() < 1000 && !error.contains(char::is_control);
        assert!(one_line && error.contains("; "), "{error:?}");
    }
}
