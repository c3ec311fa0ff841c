//! Any text, read as a plugin.toml; what follows from one that is read: its defaults, its presets, its values as text.
#![no_main]

use brdf_sdk::table::Document;
use brdf_sdk::{Manifest, Param, ParamValue, ParamValues};
use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    brdf_fuzz::mutate(data, size, max_size, seed)
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Manifest::parse("plugin.toml", text, "fuzzed") {
        Err(problem) => brdf_fuzz::refused(&problem),
        Ok(manifest) => follow(&manifest),
    }
});

/// Whatever a manifest lets in comes back from TOML, and from the command line, as it went there.
fn follow(manifest: &Manifest) {
    let mut values = ParamValues::defaults(manifest);
    for (key, value) in manifest.presets.iter().flat_map(|preset| &preset.values) {
        values.set(key, value.clone());
    }
    assert_eq!(values.iter().count(), manifest.params.len());
    for param in &manifest.params {
        let value = values.get(&param.key).expect("every parameter has a value");
        assert_eq!(from_toml(param, &format!("x = {}", value.to_toml())), *value);
        let typed = ParamValue::from_text(param, &value.to_string());
        assert_eq!(typed.as_ref(), Ok(value), "{}", param.usage());
        assert!(!param.wgsl_use().is_empty());
    }
}

fn from_toml(param: &Param, source: &str) -> ParamValue {
    let read = Document { file: "value", source }
        .read(|table| ParamValue::from_toml(param, &table.require("x", "the value")?));
    read.unwrap_or_else(|problem| panic!("{problem}"))
}
