//! Any text, read as a file of BRDF Explorer, as a model and as values.
#![no_main]

use glsl_brdf::{Source, read_preset, translate};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let source = Source { file: "fuzzed.brdf", text };
    // Translated or refused: what matters is that it ends.
    let _ = translate(source, "fuzzed", None);
    let _ = read_preset(source);
});
