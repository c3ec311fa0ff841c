//! Any text, read as an environment's recipe, evaluated at a few texels.
#![no_main]

use brdf_host::environment::{Options, from_recipe};
use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    brdf_fuzz::mutate(data, size, max_size, seed)
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let options = Options { width: Some(8), ..Options::default() };
    match from_recipe("fuzzed", "fuzzed.toml", text, &options) {
        Ok(map) => brdf_fuzz::map::held(&map),
        Err(problem) => brdf_fuzz::refused(&problem),
    }
});
