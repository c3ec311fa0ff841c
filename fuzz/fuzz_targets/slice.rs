//! Any bytes, read as an image slice, a picture or a table. The decoder of OpenEXR panics at some pictures, and the
//! parser makes a sentence of it: only a panic that leaves the parser is a find.
#![no_main]

use std::panic::{catch_unwind, set_hook};
use std::sync::Mutex;

use libfuzzer_sys::fuzz_target;

static LAST: Mutex<String> = Mutex::new(String::new());

fn listen() {
    set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST.lock() {
            *last = panic.to_string();
        }
    }));
}

fuzz_target!(init: listen(), |data: &[u8]| {
    if catch_unwind(|| brdf_fuzz::held(brdf_measured::slice::parse(data))).is_err() {
        eprintln!("{LAST:?}");
        std::process::abort();
    }
});
