//! The functions by which a plugin's WGSL reads the arrays of its native library.
//!
//! They hold for arrays of any size: where each lies stands in a buffer, so that another file needs no other program.
//! In a storage buffer: software Vulkan (Mesa 22.3.6) died where some programs read sizes from a uniform, as it put the
//! uniforms' values into the program and looked for them in a buffer of number -1.

use brdf_sdk::manifest::{Array, Element};
use brdf_sdk::native::lobes::NAMES;
use brdf_sdk::{Problem, Result};

use crate::native::{PART_WORDS, TEXTURE_WIDTH, buffer_names, texture_name};
use crate::plugin::Plugin;

/// The first binding of the buffers; the one before says where arrays lie.
const FIRST: usize = 13;

/// The arrays of a plugin, and behind them the tables of a sampler that is fitted to it.
///
/// # Errors
/// Where the author has given one of their names to something else.
pub fn with_lobes(plugin: &Plugin) -> Result<Vec<Array>> {
    let mut arrays = plugin.manifest.arrays.clone();
    let tables = plugin.manifest.tables.iter().map(|table| &table.name);
    let mut taken = arrays.iter().map(|array| &array.name).chain(tables);
    if let Some(name) = taken.find(|name| NAMES.contains(&name.as_str())) {
        return Err(Problem::new(
            &plugin.id,
            format!("`{name}` of its plugin.toml is also a table of the sampler to be fitted"),
            "rename it, or leave --fit-sampler out",
        ));
    }
    arrays.extend(Array::of_lobes());
    Ok(arrays)
}

/// The buffers of all arrays with `<name>_at(i)` and `<name>_size(axis)` of each; `None` where there are none.
pub fn accessors(arrays: &[Array]) -> Option<String> {
    if arrays.is_empty() {
        return None;
    }
    let mut text = format!(
        "struct BrdfArray {{\n    first: u32,\n    last: u32,\n    shape: vec4u,\n}}\n\
         @group(0) @binding({}) var<storage, read> brdf_arrays: array<BrdfArray, {}>;\n",
        FIRST - 1,
        arrays.len()
    );
    let buffers = buffer_names(arrays)
        .into_iter()
        .map(|name| format!("var<storage, read> {name}: array<u32>"));
    let textures = arrays.iter().filter(|array| array.element.of_list().is_some());
    let textures = textures.map(|array| {
        format!("var {}: texture_2d<{}>", texture_name(array), array.element.of_one())
    });
    for (index, variable) in buffers.chain(textures).enumerate() {
        text.push_str(&format!("@group(0) @binding({}) {variable};\n", FIRST + index));
    }
    for (index, array) in arrays.iter().enumerate() {
        let Array { name, element, parts, .. } = array;
        let place = format!("brdf_arrays[{index}]");
        text.push_str(&format!(
            "fn {name}_size(axis: u32) -> u32 {{\n    return {place}.shape[min(axis, 3u)];\n}}\n"
        ));
        if let Some(vector) = element.of_list() {
            let (bits, mask) = (TEXTURE_WIDTH.trailing_zeros(), TEXTURE_WIDTH - 1);
            text.push_str(&format!(
                "fn {name}_at(i: u32) -> {vector} {{\n    \
                 return textureLoad({}, vec2u(i & {mask}u, i >> {bits}u), 0);\n}}\n",
                texture_name(array)
            ));
            continue;
        }
        let (ty, word) = match element {
            Element::U32 | Element::Vec4U => ("u32", "at"),
            Element::F32 | Element::Vec4F => ("f32", "at"),
            Element::F16 => ("f32", "at >> 1u"),
        };
        let read = |buffer: &str, at: &str| match element {
            Element::F32 | Element::Vec4F => format!("bitcast<f32>({buffer}[{at}])"),
            Element::U32 | Element::Vec4U => format!("{buffer}[{at}]"),
            Element::F16 => format!("unpack2x16float({buffer}[{at}])[at & 1u]"),
        };
        text.push_str(&format!(
            "fn {name}_at(i: u32) -> {ty} {{\n    let at = min(i, {place}.last);\n"
        ));
        if *parts == 1 {
            let value = read("brdf_data", &format!("{place}.first + ({word})"));
            text.push_str(&format!("    return {value};\n}}\n"));
            continue;
        }
        let (bits, mask) = (PART_WORDS.trailing_zeros(), PART_WORDS - 1);
        text.push_str(&format!("    let word = {word};\n    switch word >> {bits}u {{\n"));
        for part in 1..*parts {
            let value = read(&format!("brdf_data_{name}_{part}"), &format!("word & {mask}u"));
            text.push_str(&format!("        case {part}u: {{ return {value}; }}\n"));
        }
        let value = read(&format!("brdf_data_{name}_0"), &format!("word & {mask}u"));
        text.push_str(&format!("        default: {{ return {value}; }}\n    }}\n}}\n"));
    }
    Some(text)
}
