//! Any text, read as a file of BRDF Explorer, as a model and as values: translated, to a manifest that
//! can be read, or refused.
#![no_main]

use brdf_sdk::Manifest;
use glsl_brdf::{Source, read_preset, translate};
use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    brdf_fuzz::mutate(data, size, max_size, seed)
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let source = Source { file: "fuzzed.brdf", text };
    match translate(source, "fuzzed", None) {
        Err(problem) => brdf_fuzz::refused(&problem),
        Ok(translated) => {
            let manifest = Manifest::parse("plugin.toml", &translated.manifest, "fuzzed");
            assert!(manifest.is_ok(), "{manifest:?}\n{}", translated.manifest);
        }
    }
    if let Err(problem) = read_preset(source) {
        brdf_fuzz::refused(&problem);
    }
});
