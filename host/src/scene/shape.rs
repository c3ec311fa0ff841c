//! The shapes, each inside the unit sphere at the origin, and the first hit of a ray with them.
//!
//! Depends on its siblings and glam. Shapes have no place, size or rotation of their own.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DVec3;

use super::camera::Ray;
use super::frame::{Hit, parallel_tangent};
use super::mesh::Mesh;
use super::torus;

/// What is rendered.
#[derive(Debug, Clone)]
pub enum Shape {
    /// The unit sphere at the origin; tangent = normalize(cross(+y, n)), +x at the poles.
    Sphere,
    /// A ring in the xy-plane about the z axis, major radius 0.7, minor radius 0.3; the tangent
    /// follows the ring, counter-clockwise about +z.
    Torus,
    /// The square |x| <= 1, |y| <= 1 at z = 0; normal +z, tangent +x, two-sided.
    Plane,
    /// A triangle mesh, centred and scaled to the unit sphere.
    Mesh(Arc<Mesh>),
}

impl Shape {
    /// Those that need no file.
    pub const NAMES: [&'static str; 4] = ["sphere", "torus", "plane", "teapot"];

    /// The one of that name, if there is one.
    ///
    /// # Errors
    /// None that a test would not have found: `teapot` is checked as meshes of files are.
    pub fn named(name: &str) -> Result<Option<Self>> {
        Ok(Some(match name {
            "sphere" => Self::Sphere,
            "torus" => Self::Torus,
            "plane" => Self::Plane,
            "teapot" => Self::Mesh(Arc::new(Mesh::teapot()?)),
            _ => return Ok(None),
        }))
    }

    /// The first hit in front of the ray's origin.
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Sphere => sphere(ray),
            Self::Torus => torus::intersect(ray),
            Self::Plane => plane(ray),
            Self::Mesh(mesh) => mesh.intersect(ray),
        }
    }
}

/// The stretch of a ray inside the unit sphere, told from the point of the line nearest to the
/// origin. Everything downstream then computes with numbers of size 1, however far the eye.
pub(super) struct Chord {
    /// Point of the line nearest to the origin.
    pub middle: DVec3,
    /// Position of the ray's origin along the line, from `middle`.
    pub start: f64,
    /// Half the length inside the sphere: it spans [-half, half] from `middle`.
    pub half: f64,
}

/// The chord of a ray in the sphere of the given radius about the origin, if any lies ahead.
pub(super) fn chord(ray: &Ray, radius: f64) -> Option<Chord> {
    let start = ray.origin.dot(ray.dir);
    let middle = ray.origin - start * ray.dir;
    let half_squared = radius * radius - middle.length_squared();
    // Written so that a NaN is a miss.
    if half_squared >= 0.0 {
        let half = half_squared.sqrt();
        (half > start).then_some(Chord { middle, start, half })
    } else {
        None
    }
}

/// The near end of the chord, or the far one from inside. No difference of squares of the distance
/// occurs, hence no cancellation (the usual quadratic's b^2 - 4ac has it).
fn sphere(ray: &Ray) -> Option<Hit> {
    let Chord { middle, start, half } = chord(ray, 1.0)?;
    let end = if -half > start { -half } else { half };
    let geometric = (middle + end * ray.dir).normalize();
    Some(Hit { geometric, shading: None, tangent: parallel_tangent(geometric) })
}

fn plane(ray: &Ray) -> Option<Hit> {
    let t = -ray.origin.z / ray.dir.z;
    let point = ray.origin + t * ray.dir;
    // An infinite or NaN t (a ray along the plane) fails one of these.
    let inside = t > 0.0 && point.x.abs() <= 1.0 && point.y.abs() <= 1.0;
    inside.then_some(Hit { geometric: DVec3::Z, shading: None, tangent: DVec3::X })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f64; 3], dir: [f64; 3]) -> Ray {
        Ray { origin: origin.into(), dir: DVec3::from(dir).normalize() }
    }

    #[test]
    fn the_sphere_is_hit_on_its_near_side_and_from_inside_on_its_far_one() {
        let hit = sphere(&ray([0.0, 0.6, 5.0], [0.0, 0.0, -1.0])).unwrap();
        assert!((hit.geometric - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
        assert!((hit.tangent - DVec3::X).length() < 1e-15);
        let hit = sphere(&ray([0.0, 0.6, 0.0], [0.0, 0.0, -1.0])).unwrap();
        assert!((hit.geometric - DVec3::new(0.0, 0.6, -0.8)).length() < 1e-15);
        assert!(sphere(&ray([0.0, 0.0, 5.0], [0.0, 0.0, 1.0])).is_none(), "behind the eye");
        assert!(sphere(&ray([0.0, 1.0 + 1e-12, 5.0], [0.0, 0.0, -1.0])).is_none());
        let pole = sphere(&ray([0.0, 5.0, 0.0], [0.0, -1.0, 0.0])).unwrap();
        assert_eq!(pole.tangent, DVec3::X);
    }

    #[test]
    fn the_sphere_keeps_its_digits_from_far_away() {
        // At distance 1e6 the textbook quadratic keeps about four digits; the chord keeps ten.
        let hit = sphere(&ray([0.6, 0.0, 1e6], [0.0, 0.0, -1.0])).unwrap();
        assert!((hit.geometric - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-10);
    }

    #[test]
    fn the_plane_ends_at_its_edges_and_is_missed_edge_on() {
        assert!(plane(&ray([1.0, -1.0, 5.0], [0.0, 0.0, -1.0])).is_some());
        assert!(plane(&ray([1.0 + 1e-12, 0.0, 5.0], [0.0, 0.0, -1.0])).is_none());
        assert!(plane(&ray([0.0, 0.0, 5.0], [0.0, 0.0, 1.0])).is_none(), "behind the eye");
        assert!(plane(&ray([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0])).is_none(), "along the plane");
    }
}
