//! Panics that the program catches, told apart by where they arise.
//!
//! The decoders of OpenEXR and glTF and the compiler of WGSL are others' code; they panic at some input, and the
//! program makes a sentence of it. libFuzzer's own hook would end the run there. With this one only a panic that
//! arises in this repository's code ends it, or one that nobody catches.

use std::panic::{catch_unwind, set_hook};
use std::sync::Mutex;

static LAST: Mutex<String> = Mutex::new(String::new());

/// Takes the place of libFuzzer's hook; to be called once, by a target's `init`.
pub fn of_others_pass() {
    set_hook(Box::new(|panic| {
        let is_own = panic.location().is_none_or(|place| !place.file().contains("/registry/src/"));
        if is_own {
            eprintln!("{panic}");
            std::process::abort();
        }
        if let Ok(mut last) = LAST.lock() {
            *last = panic.to_string();
        }
    }));
}

/// Runs `work`; a panic that leaves it is a find.
pub fn caught(work: impl FnOnce() + std::panic::UnwindSafe) {
    if catch_unwind(work).is_err() {
        eprintln!("{LAST:?}");
        std::process::abort();
    }
}
