//! glTF 2.0 (.gltf, .glb) -> soup, by the gltf crate.
//!
//! The default scene's nodes (or the first scene's) with their transforms; primitives of mode
//! TRIANGLES with POSITION, NORMAL, TANGENT, TEXCOORD_0 and indices. Not read: other modes, images,
//! materials, skins, morph targets, sparse accessors. Accessors are read here and not by the
//! crate's readers, since those trust the file's types and sizes.

use std::path::Path;

use ::gltf::accessor::{Accessor, DataType};
use ::gltf::buffer::{Data, Source};
use ::gltf::mesh::{Mode, Primitive};
use ::gltf::{Document, Gltf, Semantic};
use brdf_sdk::{Problem, Result};
use glam::{DMat3, DMat4, DVec2, DVec3, Mat4};

use super::{Soup, check_count};

const EXPORT: &str = "export it again";

/// A file's name, for problems, and its binary data.
struct File<'a> {
    thing: &'a str,
    buffers: Vec<Data>,
}

/// Reads a .gltf or .glb file; `folder` is where its buffers lie.
pub(super) fn parse(thing: &str, bytes: &[u8], folder: Option<&Path>) -> Result<Soup> {
    let problem = |reason: String, cure: &str| Problem::new(thing, reason, cure);
    let invalid = |error: ::gltf::Error| {
        let line = error.to_string().replace('\n', " ");
        problem(format!("is not a valid glTF file: {line}"), EXPORT)
    };
    // The crate subtracts the header's size from this length unchecked.
    if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        if (length as usize) < 12 || bytes.len() < length as usize {
            let found = bytes.len();
            let reason = format!("is cut short: {found} bytes, its header says {length}");
            return Err(problem(reason, "copy or export it again"));
        }
    }
    check_accessors(thing, &Gltf::from_slice_without_validation(bytes).map_err(invalid)?)?;
    let Gltf { document, blob } = Gltf::from_slice(bytes).map_err(invalid)?;
    for buffer in document.buffers() {
        if let Source::Uri(uri) = buffer.source() {
            check_uri(thing, uri)?;
        }
    }
    let folder = Some(folder.unwrap_or(Path::new("")));
    let buffers = ::gltf::import_buffers(&document, folder, blob)
        .map_err(|error| problem(format!("its data cannot be read: {error}"), EXPORT))?;
    walk(&document, &File { thing, buffers })
}

/// Refuses meshes whose data is not there: the crate's validation looks positions up before it checks their number.
fn check_accessors(thing: &str, file: &Gltf) -> Result<()> {
    let root = file.document.as_json();
    let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let missing = |index: usize| index >= root.accessors.len();
    match primitives.any(|part| part.attributes.values().any(|index| missing(index.value()))) {
        false => Ok(()),
        true => Err(Problem::new(thing, "a mesh names data that is not in the file", EXPORT)),
    }
}

/// Refuses names that the crate would panic on: percent escapes that are not UTF-8.
fn check_uri(thing: &str, uri: &str) -> Result<()> {
    let mut bytes = uri.bytes();
    let mut decoded = Vec::new();
    while let Some(byte) = bytes.next() {
        let escape = uri.get(uri.len() - bytes.len()..).and_then(|rest| rest.get(..2));
        match escape.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(value) if byte == b'%' => {
                decoded.push(value);
                bytes.nth(1);
            }
            _ => decoded.push(byte),
        }
    }
    match String::from_utf8(decoded) {
        Ok(_) => Ok(()),
        Err(_) => Err(Problem::new(thing, format!("cannot read the file name \"{uri}\""), EXPORT)),
    }
}

/// Collects the triangles of every node in the scene.
fn walk(document: &Document, file: &File<'_>) -> Result<Soup> {
    let fail = |reason: &str| Err(Problem::new(file.thing, reason, EXPORT));
    let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) else {
        return fail("holds no scene");
    };
    let mut soup = Soup::default();
    let mut skipped = 0;
    // glTF demands a tree; a cycle would never end and a shared node is an error of the exporter.
    let mut visited = vec![false; document.nodes().len()];
    let mut stack: Vec<_> = scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((node, world_from_parent)) = stack.pop() {
        if std::mem::replace(&mut visited[node.index()], true) {
            return fail("its nodes are no tree: one is reached twice");
        }
        let local = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let world_from_local = world_from_parent * local;
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            if primitive.mode() == Mode::Triangles {
                append(&mut soup, &primitive, world_from_local, file)?;
            } else {
                skipped += 1;
            }
        }
        stack.extend(node.children().map(|child| (child, world_from_local)));
    }
    if soup.triangles.is_empty() {
        return fail(&format!("holds no triangles ({skipped} primitives of other modes)"));
    }
    Ok(soup)
}

/// Adds one primitive, in world space.
fn append(soup: &mut Soup, part: &Primitive<'_>, world: DMat4, file: &File<'_>) -> Result<()> {
    let Some(accessor) = part.get(&Semantic::Positions) else { return Ok(()) };
    let corners = part.indices().map_or(accessor.count(), |indices| indices.count());
    check_count(file.thing, soup.triangles.len() + corners / 3)?;
    if soup.positions.len().saturating_add(accessor.count()) > u32::MAX as usize {
        let reason = "has more vertices than 32 bits can count";
        return Err(Problem::new(file.thing, reason, "decimate the mesh"));
    }
    let positions = file.read::<3>(&accessor, "POSITION")?;
    let count = positions.len();
    let optional = |semantic: Semantic| part.get(&semantic).filter(|a| a.count() == count);

    // Normals go by the cofactors of the linear part: the inverse transpose times its determinant,
    // defined for singular transforms too; the sign undoes the determinant of a mirror.
    let linear = DMat3::from_mat4(world);
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let cofactors = sign * DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));

    let first = soup.positions.len();
    let total = first + count;
    soup.positions.extend(positions.into_iter().map(|p| world.transform_point3(p.into())));
    if let Some(accessor) = optional(Semantic::Normals) {
        let normals = file.read::<3>(&accessor, "NORMAL")?;
        soup.normals.extend(normals.into_iter().map(|n| cofactors * DVec3::from(n)));
    }
    if let Some(accessor) = optional(Semantic::TexCoords(0)) {
        soup.uvs.extend(file.read::<2>(&accessor, "TEXCOORD_0")?.into_iter().map(DVec2::from));
    }
    if let Some(accessor) = optional(Semantic::Tangents) {
        let tangents = file.read::<4>(&accessor, "TANGENT")?;
        soup.tangents.extend(tangents.into_iter().map(|[x, y, z, _]| linear * DVec3::new(x, y, z)));
    }
    soup.normals.resize(total, DVec3::ZERO);
    soup.uvs.resize(total, DVec2::NAN);
    soup.tangents.resize(total, DVec3::ZERO);

    let indices: Vec<usize> = match part.indices() {
        Some(accessor) => {
            file.read::<1>(&accessor, "indices")?.into_iter().map(|[i]| i as usize).collect()
        }
        None => (0..count).collect(),
    };
    if let Some(index) = indices.iter().find(|&&index| index >= count) {
        let reason = format!("a face uses vertex {index} of {count}, counted from 0");
        return Err(Problem::new(file.thing, reason, EXPORT));
    }
    let at = |index: usize| (first + index) as u32;
    // A mirror turns the winding as well.
    let triangle = |t: &[usize]| match sign < 0.0 {
        true => [at(t[0]), at(t[2]), at(t[1])],
        false => [at(t[0]), at(t[1]), at(t[2])],
    };
    soup.triangles.extend(indices.chunks_exact(3).map(triangle));
    Ok(())
}

impl File<'_> {
    /// All elements of an accessor with N components, normalized integers as fractions.
    fn read<const N: usize>(&self, accessor: &Accessor<'_>, name: &str) -> Result<Vec<[f64; N]>> {
        let fail = |reason: &str, cure: &str| {
            Err(Problem::new(
                self.thing,
                format!("{name} (accessor {}) {reason}", accessor.index()),
                cure,
            ))
        };
        if accessor.dimensions().multiplicity() != N {
            return fail("has the wrong number of components", EXPORT);
        }
        if accessor.sparse().is_some() {
            return fail("is sparse", "export it without sparse accessors");
        }
        let Some(elements) = self.elements(accessor) else {
            return fail("reaches beyond its buffer", EXPORT);
        };
        let kind = accessor.data_type();
        let normalized = accessor.normalized();
        let value =
            |element: &[u8], i: usize| component(kind, normalized, &element[i * kind.size()..]);
        Ok(elements.map(|element| std::array::from_fn(|i| value(element, i))).collect())
    }

    /// The bytes of each element, or none if they are not all there.
    fn elements<'a>(&'a self, accessor: &Accessor<'_>) -> Option<impl Iterator<Item = &'a [u8]>> {
        let view = accessor.view()?;
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size);
        let view_end = view.offset().checked_add(view.length())?;
        let bytes = self.buffers.get(view.buffer().index())?.get(view.offset()..view_end)?;
        let count = accessor.count();
        let bytes = bytes.get(accessor.offset()..)?;
        let last = stride.checked_mul(count.saturating_sub(1))?;
        let fits = count == 0 || last.checked_add(size)? <= bytes.len();
        (fits && stride >= size)
            .then(|| (0..count).map(move |i| &bytes[i * stride..i * stride + size]))
    }
}

/// One component at the start of `b`, which holds at least its size.
fn component(kind: DataType, normalized: bool, b: &[u8]) -> f64 {
    let (value, one) = match kind {
        DataType::I8 => (f64::from(b[0] as i8), 127.0),
        DataType::U8 => (f64::from(b[0]), 255.0),
        DataType::I16 => (f64::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
        DataType::U16 => (f64::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
        DataType::U32 => (f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])), 4294967295.0),
        DataType::F32 => return f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
    };
    if normalized { (value / one).max(-1.0) } else { value }
}
