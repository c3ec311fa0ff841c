//! What a BRDF brings along beside its parameters: tables that its author lets the host fill ([`tables`]), arrays of a
//! native library, and the tables of a sampler that is fitted to it ([`fit`]), as words for a program's variables.
//!
//! It may name native, link and exec: tables and fits are computed by programs of their own, on the cores. Nothing is
//! known here of pictures, scenes or maps.

mod fit;
mod tables;

use std::sync::Arc;

use brdf_sdk::manifest::Element;
use brdf_sdk::{Problem, Result};

use crate::exec::{Executor, ResourceId};
use crate::link::{BindingKind, Program};
use crate::native::{Packed, Place, TEXTURE_WIDTH, buffer_names, texture_name};
use crate::plugin::Configured;

/// What a variable of a program holds.
pub struct Brought {
    /// The variable.
    pub name: String,
    /// What it holds.
    pub held: Held,
}

/// Words of a buffer, or a list of texels in rows of [`TEXTURE_WIDTH`].
pub enum Held {
    /// Words, and what they are bound as.
    Words(BindingKind, Arc<[u32]>),
    /// Texels, in whole rows, and as what their texture is bound.
    Texels(BindingKind, Arc<Vec<[f32; 4]>>),
}

impl Brought {
    /// Puts it on a device.
    ///
    /// # Errors
    /// What the device reports.
    pub fn upload(&self, executor: &mut dyn Executor) -> Result<ResourceId> {
        match &self.held {
            Held::Words(kind, words) => executor.words(*kind, Arc::clone(words)),
            Held::Texels(kind, texels) => {
                executor.list(*kind, texture_size(texels), Arc::clone(texels))
            }
        }
    }
}

/// Columns and rows.
pub fn texture_size(texels: &[[f32; 4]]) -> [u32; 2] {
    [TEXTURE_WIDTH as u32, (texels.len() / TEXTURE_WIDTH) as u32]
}

impl PartialEq for Brought {
    /// Large ones are the same where they are one: nobody compares a hundred megabytes.
    fn eq(&self, other: &Self) -> bool {
        const SMALL: usize = 256;
        let same = match (&self.held, &other.held) {
            (Held::Words(_, a), Held::Words(_, b)) => {
                Arc::ptr_eq(a, b) || (a.len() <= SMALL && a == b)
            }
            (Held::Texels(_, a), Held::Texels(_, b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        self.name == other.name && same
    }
}

/// What the program reads of it, and what the user should know.
///
/// # Errors
/// Tables that cannot be filled, libraries that cannot be loaded or give what does not fit.
pub fn of(program: &Program, brdf: &Configured) -> Result<(Vec<Brought>, Vec<String>)> {
    let mut all = Vec::new();
    let mut add = |name: String, held: Held| {
        if program.binds(&name) {
            all.push(Brought { name, held });
        }
    };
    if program.binds(tables::VARIABLE) {
        add(tables::VARIABLE.to_owned(), Held::Words(BindingKind::Read, tables::filled(brdf)?));
    }
    let arrays = &program.arrays;
    let mut names = buffer_names(arrays);
    names.extend(arrays.iter().map(texture_name));
    names.push(PLACES.to_owned());
    if !names.iter().any(|name| program.binds(name)) {
        return Ok((all, Vec::new()));
    }
    let plugin = &brdf.plugin;
    let own = match &plugin.native {
        _ if plugin.manifest.arrays.is_empty() => None,
        Some(native) => Some(native.arrays(&plugin.id, &plugin.manifest, &brdf.values)?),
        None => {
            let reason = "nothing fills its arrays";
            return Err(Problem::new(&plugin.id, reason, "add `library` to plugin.toml"));
        }
    };
    let packed = match own {
        Some(own) if arrays.len() == plugin.manifest.arrays.len() => own,
        own => fit::fitted(brdf, own)?,
    };
    if program.binds(PLACES) {
        add(PLACES.to_owned(), Held::Words(BindingKind::Read, places(program, &packed)));
    }
    for (name, words) in buffer_names(arrays).into_iter().zip(&packed.buffers) {
        add(name, Held::Words(BindingKind::Read, Arc::clone(words)));
    }
    let textures = arrays.iter().filter(|array| array.element.of_list().is_some());
    for (array, texels) in textures.zip(&packed.textures) {
        let kind = match array.element {
            Element::Vec4U => BindingKind::WordTexture,
            _ => BindingKind::Texture,
        };
        add(texture_name(array), Held::Texels(kind, Arc::clone(texels)));
    }
    let note = |note: &String| format!("{}: {note}", plugin.id);
    Ok((all, packed.notes.iter().map(note).collect()))
}

/// The variable that says where each array lies.
const PLACES: &str = "brdf_arrays";

fn places(program: &Program, packed: &Packed) -> Arc<[u32]> {
    let layout = program.required_layout(PLACES);
    let mut bytes = vec![0; layout.stride * packed.places.len()];
    for (index, Place { first, last, shape }) in packed.places.iter().enumerate() {
        let base = index * layout.stride;
        layout.write(&mut bytes, base, "first", &[*first]);
        layout.write(&mut bytes, base, "last", &[*last]);
        layout.write(&mut bytes, base, "shape", shape);
    }
    bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect()
}
