//! What a manifest says of its native library: what it is asked for, and the arrays that it gives.
//!
//! Nothing is opened here: finding, trusting and calling a library is the host's.

use super::{Param, ParamType, named_in_wgsl, non_empty};
use crate::native::lobes::NAMES;
use crate::problem::Result;
use crate::table::{Table, suggestion};

/// An array that a native library fills and the plugin's WGSL reads as `<name>_at(i)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name in WGSL.
    pub name: String,
    /// The type of its elements.
    pub element: Element,
    /// Buffers of 128 MiB that it may take at the most.
    pub parts: u32,
    /// What it holds.
    pub about: Option<String>,
}

impl Array {
    /// The tables of `native::lobes`.
    pub fn of_lobes() -> impl Iterator<Item = Array> {
        let elements = [Element::U32, Element::U32, Element::F32];
        let named = NAMES.into_iter().zip(elements);
        named.map(|(name, element)| Array { name: name.to_owned(), element, parts: 1, about: None })
    }
}

/// What tables of `native::lobes` a library gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lobes {
    /// Of one azimuth of the viewer, since the material does not depend on it.
    Isotropic,
    /// Of several around.
    Anisotropic,
}

/// The element type of an [`Array`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// 32-bit float.
    F32,
    /// 16-bit float; the library gives 32 bits, and the host rounds.
    F16,
    /// 32-bit unsigned integer.
    U32,
    /// Four 32-bit floats, read at once; the library gives floats whose last dimension is 4.
    Vec4F,
    /// Four 32-bit unsigned integers, read at once; the library gives u32 whose last dimension is 4.
    Vec4U,
}

impl Element {
    /// Its name where it is read four at once, from a list of its own.
    pub fn of_list(self) -> Option<&'static str> {
        match self {
            Self::Vec4F => Some("vec4f"),
            Self::Vec4U => Some("vec4u"),
            Self::F32 | Self::F16 | Self::U32 => None,
        }
    }

    /// The type of one of its numbers, by its name in a manifest.
    pub fn of_one(self) -> &'static str {
        match self {
            Self::F32 | Self::Vec4F => "f32",
            Self::F16 => "f16",
            Self::U32 | Self::Vec4U => "u32",
        }
    }
}

/// Buffers of one array at the most: devices bind few.
const MOST_PARTS: i64 = 4;

/// What the library is asked for.
pub(super) fn read_entry(table: &Table<'_>, has_library: bool, folder: &str) -> Result<String> {
    match table.get("entry") {
        None => Ok(folder.to_owned()),
        Some(value) if has_library => non_empty(&value),
        Some(value) => Err(value.problem(
            "a native library is asked for an entry, and the manifest names none",
            "add `library = \"...\"` or remove `entry`",
        )),
    }
}

/// The parameters that the library is handed: those that `load` names, or all files.
pub(super) fn read_load(
    table: &Table<'_>,
    has_library: bool,
    params: &[Param],
) -> Result<Vec<String>> {
    let Some(value) = table.get("load") else {
        let files = params.iter().filter(|param| matches!(param.ty, ParamType::File { .. }));
        return Ok(files.map(|param| param.key.clone()).collect());
    };
    if !has_library {
        return Err(value.problem(
            "parameters are handed to a native library, and the manifest names none",
            "add `library = \"...\"` or remove `load`",
        ));
    }
    let mut keys: Vec<String> = Vec::new();
    for item in value.items()? {
        let key = item.string()?;
        if !params.iter().any(|param| param.key == key) {
            return Err(item.problem(
                format!("there is no parameter `{key}`"),
                suggestion(&key, params.iter().map(|param| param.key.as_str())),
            ));
        }
        if keys.contains(&key) {
            return Err(item.problem(format!("`{key}` stands twice"), "remove one"));
        }
        keys.push(key);
    }
    Ok(keys)
}

pub(super) fn read_lobes(table: &Table<'_>, has_library: bool) -> Result<Option<Lobes>> {
    let Some(value) = table.get("lobes") else { return Ok(None) };
    if !has_library {
        return Err(value.problem(
            "lobes are tables of a native library, and the manifest names none",
            "add `library = \"...\"` or remove `lobes`",
        ));
    }
    match value.string()?.as_str() {
        "isotropic" => Ok(Some(Lobes::Isotropic)),
        "anisotropic" => Ok(Some(Lobes::Anisotropic)),
        other => Err(value.problem(
            format!("there are no lobes `{other}`"),
            suggestion(other, ["isotropic", "anisotropic"].into_iter()),
        )),
    }
}

/// The author's arrays, then those of `lobes`.
pub(super) fn read_arrays(
    table: &Table<'_>,
    has_library: bool,
    lobes: Option<Lobes>,
) -> Result<Vec<Array>> {
    let mut arrays = read_own_arrays(table, has_library)?;
    if lobes.is_none() {
        return Ok(arrays);
    }
    for of_lobes in Array::of_lobes() {
        let name = &of_lobes.name;
        if arrays.iter().any(|array| array.name == *name) {
            let span = table.get("arrays").map_or(0..0, |value| value.span());
            return Err(table.problem(
                span,
                format!("the array `{name}` comes with `lobes`"),
                "remove it from [arrays]",
            ));
        }
        arrays.push(of_lobes);
    }
    Ok(arrays)
}

fn read_own_arrays(table: &Table<'_>, has_library: bool) -> Result<Vec<Array>> {
    let Some(value) = table.get("arrays") else { return Ok(Vec::new()) };
    if !has_library {
        return Err(value.problem(
            "arrays are filled by a native library, and the manifest names none",
            "add `library = \"...\"` or remove [arrays]",
        ));
    }
    let mut arrays = Vec::new();
    for entry in named_in_wgsl(&value.table()?)? {
        let inner = entry.value.table()?;
        let ty =
            inner.require("type", "`type = \"f32\"`, \"f16\", \"u32\", \"vec4f\" or \"vec4u\"")?;
        let element = match ty.string()?.as_str() {
            "f32" => Element::F32,
            "f16" => Element::F16,
            "u32" => Element::U32,
            "vec4f" => Element::Vec4F,
            "vec4u" => Element::Vec4U,
            other => {
                return Err(ty.problem(
                    format!("there is no array type `{other}`"),
                    "write \"f32\", \"f16\", \"u32\", \"vec4f\" or \"vec4u\"",
                ));
            }
        };
        let parts = match inner.get("parts") {
            None => 1,
            Some(value) => match value.integer()? {
                parts @ 1..=MOST_PARTS => match element.of_list() {
                    Some(name) if parts > 1 => {
                        return Err(value.problem(
                            format!("an array of {name} lies in one texture"),
                            "remove `parts`",
                        ));
                    }
                    _ => parts as u32,
                },
                parts => {
                    return Err(value.problem(
                        format!("an array cannot take {parts} buffers"),
                        format!("write a number from 1 to {MOST_PARTS}"),
                    ));
                }
            },
        };
        let about = inner.get("about").map(|value| value.string()).transpose()?;
        inner.finish()?;
        arrays.push(Array { name: entry.key, element, parts, about });
    }
    Ok(arrays)
}
