//! Camera and shape -> shading points: what every covered pixel sees, once per camera or object.
//!
//! Use: [`Camera`] (or [`Camera::parse`]), a [`Shape`] (a mesh by [`Mesh::load`]), then [`cast`];
//! [`flat_points`] makes points for given local directions, as tables of albedo need.
//! Geometry is f64 throughout and rounded to f32 once, in `frame`.
//!
//! Depends on `brdf_sdk::Problem`, glam, rayon and the mesh crates (gltf, obvhs); of the host on `file`, never on
//! exec, render or ui.
//!
//! Deliberately absent: shadows, self-occlusion and any bounce (only primary hits count), pixel
//! filters (one ray through each pixel's centre), materials, textures, skinning and animation.

mod camera;
mod cast;
mod frame;
mod mesh;
mod shape;
mod torus;

pub use camera::{Camera, Ray};
pub use cast::{Coverage, cast, flat_points};
pub use frame::ShadingPoint;
pub use mesh::Mesh;
pub use shape::Shape;
