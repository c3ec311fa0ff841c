//! A triangle mesh: loaded, checked, scaled to the unit sphere, ready for rays.
//!
//! Depends on `brdf_sdk::Problem`, `file`, glam, and through its files on gltf and obvhs. Materials,
//! textures, skins, morphs and animations are not read; a mesh is seen in the pose of its file.
//!
//! `obj` (with `polygon`) and `gltf` turn a file into a [`Soup`], `teapot` makes one without;
//! `normals` and `tangents` fill what it lacks; `tree` finds what a ray meets.

mod gltf;
mod normals;
mod obj;
mod polygon;
mod tangents;
mod teapot;
mod tree;

use std::fmt;
use std::path::Path;

use brdf_sdk::{Problem, Result};
use glam::{DVec2, DVec3};

use super::camera::Ray;
use super::frame::{Hit, parallel_tangent};
use super::shape::chord;
use crate::file;
use tree::Tree;

/// More triangles than this are refused: the tree alone would take gigabytes.
const MAX_TRIANGLES: usize = 50_000_000;

/// A triangle is degenerate when twice its area is below this, relative to its longest edge
/// squared: thinner than what f32 coordinates can mean.
const DEGENERATE: f64 = 1e-12;

/// What a file holds: attributes per vertex, all of one length, and triangles that index them.
#[derive(Debug, Default)]
struct Soup {
    positions: Vec<DVec3>,
    /// Zero or non-finite where the file has none.
    normals: Vec<DVec3>,
    /// NaN where the file has none.
    uvs: Vec<DVec2>,
    /// Zero where the file has none.
    tangents: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// A triangle mesh, centred and scaled to the unit sphere.
pub struct Mesh {
    positions: Vec<DVec3>,
    /// Per vertex, unit; zero where the faces around it cancel.
    normals: Vec<DVec3>,
    /// Two per vertex, for triangles with uv as they are and mirrored; zero for "as the sphere".
    tangents: Vec<[DVec3; 2]>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle: whether its uv chart is mirrored.
    mirrored: Vec<bool>,
    tree: Tree,
    degenerate: usize,
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mesh({} triangles)", self.triangles.len())
    }
}

impl Mesh {
    /// Loads an .obj, .gltf or .glb file; the centre of its bounding box becomes the origin, and
    /// its farthest vertex lies on the unit sphere.
    ///
    /// Where the file has no normals, smooth ones are computed: vertices at one place share theirs,
    /// each face weighs by its angle there. Without uv or tangents, the tangent is the sphere's.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let thing = path.display().to_string();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let read = || file::read(path, "check the path");
        let soup = match extension.to_ascii_lowercase().as_str() {
            "obj" => obj::parse(&thing, &read()?)?,
            "gltf" | "glb" => gltf::parse(&thing, &read()?, path.parent())?,
            _ => {
                return Err(Problem::new(
                    thing,
                    "is no mesh file of a known kind",
                    "use .obj, .gltf or .glb",
                ));
            }
        };
        Self::new(&thing, soup)
    }

    /// A teapot that needs no file.
    pub(super) fn teapot() -> Result<Self> {
        Self::new("teapot", teapot::teapot())
    }

    /// Number of triangles, degenerate ones left out.
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Number of triangles without area that the file held, and that were dropped.
    pub fn degenerate(&self) -> usize {
        self.degenerate
    }

    fn new(thing: &str, mut soup: Soup) -> Result<Self> {
        let fail = |reason: String, cure: &str| Err(Problem::new(thing, reason, cure));
        let count = soup.triangles.len();
        check_count(thing, count)?;
        if count == 0 {
            return fail("holds no triangles".into(), "export the mesh with its faces");
        }
        let out = |&index: &u32| index as usize >= soup.positions.len();
        if let Some(index) = soup.triangles.iter().flatten().copied().find(out) {
            let vertices = soup.positions.len();
            let reason = format!("a face uses vertex {index} of {vertices}, counted from 0");
            return fail(reason, "export the mesh again");
        }
        let corners = || soup.triangles.iter().flatten().map(|&v| soup.positions[v as usize]);
        if let Some(p) = corners().find(|p| !p.is_finite()) {
            return fail(format!("a vertex is not finite: {p}"), "repair the vertex");
        }

        // Only vertices that a face uses count for centre and size.
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (low + high);
        let radius = corners().map(|p| (p - centre).length()).fold(0.0, f64::max);
        if radius <= 0.0 {
            return fail("has no size: all its vertices are one point".into(), "export it again");
        }
        for p in &mut soup.positions {
            *p = (*p - centre) / radius;
        }

        let positions = soup.positions;
        soup.triangles.retain(|triangle| !is_degenerate(triangle.map(|v| positions[v as usize])));
        if soup.triangles.is_empty() {
            return fail(format!("all its {count} triangles have no area"), "export it again");
        }
        let triangles = soup.triangles;
        let normals = normals::complete(soup.normals, &positions, &triangles);
        let (tangents, mirrored) =
            tangents::complete(soup.tangents, &soup.uvs, &positions, &triangles);
        let tree = Tree::new(&positions, &triangles);
        let degenerate = count - triangles.len();
        Ok(Self { positions, normals, tangents, triangles, mirrored, tree, degenerate })
    }

    /// The first hit in front of the ray's origin.
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        // Start where the ray enters the unit sphere: the tree computes in f32, and a far eye would
        // cost it its digits.
        let chord = chord(ray, 1.0 + 1e-3)?;
        let start = chord.start.max(-chord.half);
        let near = Ray { origin: chord.middle + start * ray.dir, dir: ray.dir };
        let found = self.tree.first_hit(&near, &self.positions, &self.triangles)?;

        let index = found.triangle as usize;
        let corners = self.triangles[index].map(|v| v as usize);
        let [a, b, c] = corners.map(|v| self.positions[v]);
        let blend = |values: [DVec3; 3]| {
            let [u, v, w] = found.weights;
            u * values[0] + v * values[1] + w * values[2]
        };
        let chart = usize::from(self.mirrored[index]);
        let geometric = (b - a).cross(c - a).normalize();
        let shading = blend(corners.map(|v| self.normals[v])).normalize_or_zero();
        let tangent = blend(corners.map(|v| self.tangents[v][chart]));
        let tangent = tangent.try_normalize().unwrap_or_else(|| parallel_tangent(shading));
        Some(Hit { geometric, shading: Some(shading), tangent })
    }
}

/// Refuses what would not fit, before it is built.
fn check_count(thing: &str, triangles: usize) -> Result<()> {
    if triangles <= MAX_TRIANGLES {
        return Ok(());
    }
    Err(Problem::new(
        thing,
        format!("has {triangles} triangles, more than the {MAX_TRIANGLES} allowed"),
        "decimate the mesh",
    ))
}

fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let edges = [b - a, c - b, a - c];
    let longest = edges.map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
    edges[0].cross(edges[1]).length() <= DEGENERATE * longest
}

#[cfg(test)]
mod tests;
