//! What the targets share: what every reader owes to any bytes, which is a value or a sentence.

#[cfg(feature = "host")]
pub mod map;
#[cfg(feature = "host")]
pub mod mesh;
pub mod panics;
#[cfg(feature = "host")]
pub mod plugin;
pub mod problem;
#[cfg(feature = "host")]
pub mod rows;
pub mod tokens;

use libfuzzer_sys::fuzzer_mutate;

pub use problem::{file, refused};

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

/// Changes the text in `data[..size]` in place, as `fuzz_mutator!` wants it, and gives its new size: by tokens, and
/// every fourth time as libFuzzer changes bytes.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut chance = tokens::Chance::new(seed);
    let text = std::str::from_utf8(&data[..size]).map(str::to_owned);
    let (Ok(text), 1..) = (text, chance.below(4)) else {
        return fuzzer_mutate(data, size, max_size);
    };
    let mut text = tokens::edited(&text, &mut chance);
    text.truncate(text.floor_char_boundary(max_size.min(data.len())));
    data[..text.len()].copy_from_slice(text.as_bytes());
    text.len()
}
