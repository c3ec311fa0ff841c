//! Which BRDF opens a data file.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use brdf_sdk::{ParamType, Problem, Result};

use super::Found;
use crate::file;

/// Bytes of a file that are looked at: magics, and the header of a picture.
const MOST_MAGIC: u64 = 1 << 16;

/// The attribute by which pictures of this program hold their scene; a test of `picture::exr_file`, which writes it, holds
/// the two together.
const SCENE: &[u8] = b"brdf.scene\0";

/// The plugin whose file parameter has this magic, else the one that has none and knows the ending.
pub(super) fn of(file: &Path, plugins: Vec<Found>) -> Result<(Found, String)> {
    let shown = file.display().to_string();
    let mut begin = Vec::new();
    File::open(file)
        .and_then(|open| open.take(MOST_MAGIC).read_to_end(&mut begin))
        .map_err(|error| Problem::new(&shown, file::why(&error), "check its permissions"))?;
    if begin.is_empty() {
        return Err(Problem::new(shown, "the file is empty", "name one with data"));
    }
    if begin.windows(SCENE.len()).any(|bytes| bytes == SCENE) {
        return Err(Problem::new(
            shown,
            "this is a picture with its scene, and not a material",
            "render the scene by --session, or name the plugin that shall read it: `image-slice --set file=...`",
        ));
    }
    let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let mut by_ending = None;
    let mut known: Vec<String> = Vec::new();
    let mut wrong_magic = None;
    for found in plugins {
        let Ok(plugin) = &found.plugin else { continue };
        for param in &plugin.manifest.params {
            let ParamType::File { extensions, magic, .. } = &param.ty else { continue };
            let ends = extensions.iter().any(|known| known.eq_ignore_ascii_case(ending));
            known.extend(extensions.iter().map(|ending| format!(".{ending} ({})", plugin.id)));
            if magic.iter().any(|magic| begin.starts_with(magic)) {
                return Ok((found.clone(), param.key.clone()));
            }
            if ends && magic.is_empty() {
                by_ending.get_or_insert_with(|| (found.clone(), param.key.clone()));
            } else if ends {
                wrong_magic = Some(plugin.manifest.name.clone());
            }
        }
    }
    by_ending.ok_or_else(|| match wrong_magic {
        Some(name) => Problem::new(
            shown,
            format!("its first bytes are not those of a file for {name}"),
            "name a whole file of that format; others have the same ending",
        ),
        None => Problem::new(
            shown,
            "no plugin opens such a file",
            match ending.to_ascii_lowercase().as_str() {
                "toml" => "give a scene to --session, and name a plugin by its folder".to_owned(),
                "wgsl" => "name the plugin by its folder".to_owned(),
                "hdr" | "ptx" => "give a map to --ibl".to_owned(),
                "obj" | "gltf" | "glb" => "give a mesh to --shape".to_owned(),
                _ => format!(
                    "name a plugin, a plugin folder, or a file that ends in .brdf, .bparam, {}",
                    known.join(", ")
                ),
            },
        ),
    })
}
