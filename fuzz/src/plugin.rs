//! A plugin from one text: its manifest, a line `//---`, its WGSL. Without that line all is WGSL, beside a manifest
//! that has a parameter of each type.

use std::sync::Arc;

use brdf_host::plugin::{Configured, Plugin};
use brdf_sdk::{Manifest, Result};

/// What parts manifest and WGSL.
const BORDER: &str = "\n//---\n";

const MANIFEST: &str = r#"
kind = "brdf"
name = "Fuzzed"
about = "Has a parameter of each type."
[params]
alpha = { type = "float", default = 0.3, min = 0.001, max = 1.0, about = "A number." }
bounces = { type = "int", default = 2, min = 0, max = 9, about = "A whole number." }
color = { type = "color", default = [0.5, 0.1, 0.2], about = "A colour." }
swap = { type = "bool", default = false, about = "A switch." }
masking = { type = "choice", default = "separable", options = ["separable", "correlated"], about = "A choice." }
"#;

/// The BRDF with its defaults.
///
/// # Errors
/// The manifest's own.
pub fn read(text: &str) -> Result<Configured> {
    let (manifest, wgsl) = text.split_once(BORDER).unwrap_or((MANIFEST, text));
    let manifest = Manifest::parse("plugin.toml", manifest, "fuzzed")?;
    let plugin = Plugin {
        id: "fuzzed".to_owned(),
        wgsl_file: manifest.wgsl.clone(),
        manifest,
        source: wgsl.into(),
        tables: Default::default(),
        native: None,
    };
    Ok(Configured::new(Arc::new(plugin)))
}
