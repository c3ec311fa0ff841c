//! Where the bytes go: bindings and struct layouts, read off the program itself.
//!
//! Nothing about a layout is written down in Rust. The host names a member and asks for its offset.

use std::collections::BTreeMap;

use naga::{AddressSpace, Handle, ImageClass, Module, ScalarKind, StorageAccess, Type, TypeInner};

/// What a binding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingKind {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer that the kernel only reads.
    Read,
    /// A storage buffer that the kernel writes.
    ReadWrite,
    /// A 2D texture of f32, read texel by texel.
    Texture,
    /// The same of u32.
    WordTexture,
}

/// One resource that the program reaches.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binding {
    /// The variable's name in WGSL.
    pub name: String,
    /// Its index in group 0.
    pub index: u32,
    /// What it holds.
    pub kind: BindingKind,
}

/// A struct's members.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructLayout {
    /// Bytes from one element of an array to the next, or of the whole struct.
    pub stride: usize,
    offsets: BTreeMap<String, usize>,
}

impl StructLayout {
    /// Writes 32-bit words at a member of the struct that starts at `bytes[base]`.
    ///
    /// # Panics
    /// As [`Self::at`].
    pub fn write<T: bytemuck::Pod>(
        &self,
        bytes: &mut [u8],
        base: usize,
        member: &str,
        words: &[T],
    ) {
        let at = base + self.at(member);
        let words: &[u8] = bytemuck::cast_slice(words);
        bytes[at..at + words.len()].copy_from_slice(words);
    }

    /// Offset of a member in bytes.
    ///
    /// # Panics
    /// Where the struct has no such member: then the host's Rust and WGSL disagree.
    pub fn at(&self, member: &str) -> usize {
        match self.offsets.get(member) {
            Some(offset) => *offset,
            None => panic!("the host's shader has no member `{member}`"),
        }
    }
}

/// The resources that a module binds, by index.
pub fn bindings(module: &Module) -> Vec<Binding> {
    let mut bindings: Vec<Binding> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| {
            let kind = match variable.space {
                AddressSpace::Uniform => BindingKind::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                    BindingKind::ReadWrite
                }
                AddressSpace::Storage { .. } => BindingKind::Read,
                AddressSpace::Handle => match module.types[variable.ty].inner {
                    TypeInner::Image {
                        class: ImageClass::Sampled { kind: ScalarKind::Uint, .. },
                        ..
                    } => BindingKind::WordTexture,
                    _ => BindingKind::Texture,
                },
                _ => return None,
            };
            let index = variable.binding.as_ref()?.binding;
            Some(Binding { name: variable.name.clone().unwrap_or_default(), index, kind })
        })
        .collect();
    bindings.sort_by_key(|binding| binding.index);
    bindings
}

/// The struct that a variable holds, or that it is an array of.
pub fn struct_layout(module: &Module, variable: &str) -> Option<StructLayout> {
    let (_, global) = module
        .global_variables
        .iter()
        .find(|(_, global)| global.name.as_deref() == Some(variable))?;
    let (ty, stride) = match module.types[global.ty].inner {
        TypeInner::Array { base, stride, .. } => (base, Some(stride as usize)),
        _ => (global.ty, None),
    };
    layout_of(module, ty, stride)
}

fn layout_of(module: &Module, ty: Handle<Type>, stride: Option<usize>) -> Option<StructLayout> {
    let TypeInner::Struct { members, span } = &module.types[ty].inner else { return None };
    let offsets = members
        .iter()
        .map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize))
        .collect();
    Some(StructLayout { stride: stride.unwrap_or(*span as usize), offsets })
}
