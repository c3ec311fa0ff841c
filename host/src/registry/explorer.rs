//! Files of BRDF Explorer as plugins: `.brdf`, a model in GLSL, and `.bparam`, values for one.

use std::path::{Path, PathBuf};

use brdf_sdk::{Manifest, Problem, Result};
use glsl_brdf::{Preset, Source, Translated, Use, read_preset, translate};

use super::folder::{read_old_text, shown};
use crate::plugin::Plugin;

/// A file of a model, and one of values.
const MODEL: &str = "brdf";
const VALUES: &str = "bparam";

fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Whether a path names such a file.
pub fn is_file(path: &Path) -> bool {
    [MODEL, VALUES].iter().any(|ending| ends_in(path, ending)) && path.is_file()
}

/// What becomes of the values of a `.bparam`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Values {
    /// The parameters begin with them.
    Defaults,
    /// They are a preset beside the model's own defaults.
    Preset,
}

/// A model as it is translated.
pub struct Read {
    /// The model's file.
    pub model: PathBuf,
    /// The translation.
    pub translated: Translated,
}

/// Reads a file of either kind.
///
/// # Errors
/// Where a file cannot be read or translated, or a file of values names a model that is not there.
pub fn read(path: &Path, values: Values) -> Result<Read> {
    let preset = match ends_in(path, VALUES) {
        true => Some(preset(path)?),
        false => None,
    };
    let model = match &preset {
        Some(preset) => model_of(path, preset)?,
        None => path.to_owned(),
    };
    let name = id_of(path);
    let using = preset.as_ref().map(|preset| match values {
        Values::Defaults => Use::Defaults(preset),
        Values::Preset => Use::Preset(preset, &name),
    });
    let text = read_old_text(&model)?;
    let source = Source { file: &shown(&model), text: &text };
    let translated = translate(source, &id_of(&model), using)?;
    Ok(Read { model, translated })
}

/// The values of a file.
fn preset(path: &Path) -> Result<Preset> {
    read_preset(Source { file: &shown(path), text: &read_old_text(path)? })
}

/// The file that a file of values is for: as it is named there, or beside it.
fn model_of(path: &Path, preset: &Preset) -> Result<PathBuf> {
    // Files from elsewhere name it with their own system's marks.
    let model = preset.model.replace('\\', "/");
    let named = Path::new(&model);
    let beside = path.with_file_name("").join(named);
    let by_name = named.file_name().map(|name| path.with_file_name(name));
    let places = [Some(beside), by_name, Some(named.to_owned())];
    let model = places.into_iter().flatten().find(|place| place.is_file()).ok_or_else(|| {
        Problem::new(
            shown(path),
            format!("the model that it is for, {}, is not there", preset.model),
            "put it beside this file, or mend the first line",
        )
    })?;
    match ends_in(&model, MODEL) {
        true => Ok(model),
        false => Err(Problem::new(
            shown(path),
            format!("it is for {}, which is no model in GLSL", shown(&model)),
            format!("open {} itself", shown(&model)),
        )),
    }
}

/// A file's name without its ending.
fn id_of(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// A translation as a text of its own: without the room that other lines of its file leave.
pub fn tidied(wgsl: &str) -> String {
    let mut lines: Vec<&str> = Vec::new();
    for line in wgsl.lines() {
        let leaves_room = lines.last().is_none_or(|last| last.is_empty() || last.ends_with('{'));
        if line.is_empty() && leaves_room {
            continue;
        }
        if line.trim() == "}" && lines.last() == Some(&"") {
            lines.pop();
        }
        lines.push(line);
    }
    lines.join("\n") + "\n"
}

/// The plugin that a file stands for.
pub(super) fn plugin(path: &Path) -> Result<Plugin> {
    let Read { model, translated } = read(path, Values::Defaults)?;
    let id = id_of(path);
    let wgsl_file = shown(&model);
    // What its checks find is none of the file's own lines.
    let as_manifest = format!("{wgsl_file} as a manifest");
    let manifest = Manifest::parse(&as_manifest, &translated.manifest, &id)?;
    let source = translated.wgsl.into();
    Ok(Plugin { id, manifest, wgsl_file, source, tables: Default::default(), native: None })
}
