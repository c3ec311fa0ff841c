//! The tree over a mesh's triangles: f32 boxes find candidates, an f64 test decides.
//!
//! Depends on glam and obvhs. Everything lies in the unit sphere, rays start at its edge or inside.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::RayHit;

use super::Ray;

/// Boxes are widened by this. In f32 the box test errs by some 1e-6 at size 1 (rounded origin and
/// direction, products along a path of length 2, and the stand-in for 1/0): ten times that keeps
/// every true hit among the candidates.
const MARGIN: f32 = 1e-5;

/// A tree over triangles.
pub(super) struct Tree {
    bvh: Bvh2,
}

/// What a ray met first.
pub(super) struct Found {
    pub triangle: u32,
    /// Barycentric weights of the three corners, sum 1.
    pub weights: [f64; 3],
}

impl Tree {
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let margin = Vec3A::splat(MARGIN);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|triangle| {
                let corners = triangle.map(|v| positions[v as usize].as_vec3a());
                let low = corners[0].min(corners[1]).min(corners[2]);
                let high = corners[0].max(corners[1]).max(corners[2]);
                Aabb::new(low - margin, high + margin)
            })
            .collect();
        let mut build_time = Duration::default();
        Self { bvh: build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut build_time) }
    }

    /// The nearest triangle in front of the ray's origin.
    pub fn first_hit(
        &self,
        ray: &Ray,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
    ) -> Option<Found> {
        let f32_ray = obvhs::ray::Ray::new_inf(ray.origin.as_vec3a(), ray.dir.as_vec3a());
        let mut nearest = f64::INFINITY;
        let mut found = None;
        self.bvh.ray_traverse(f32_ray, &mut RayHit::none(), |_, slot| {
            let triangle = self.bvh.primitive_indices[slot];
            let corners = triangles[triangle as usize].map(|v| positions[v as usize]);
            let Some((t, weights)) = intersect(ray, corners) else { return f32::INFINITY };
            if t < nearest {
                nearest = t;
                found = Some(Found { triangle, weights });
            }
            // Rounded up, so that the traversal never culls what f64 would still prefer.
            (t as f32).next_up()
        });
        found
    }
}

/// Distance and barycentric weights where a ray meets a triangle, from either side.
///
/// Each weight is the signed volume of ray and edge, dir . (a x b) with corners told from the
/// origin. For the triangle across the edge, (b, a) yields exactly the opposite number in floating
/// point, so a ray on a shared edge cannot pass between the two: zero counts for both (the
/// argument of Woop, Benthin and Wald 2013).
fn intersect(ray: &Ray, corners: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let [a, b, c] = corners.map(|corner| corner - ray.origin);
    let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|n| ray.dir.dot(n));
    let inside = volumes.iter().all(|&v| v >= 0.0) || volumes.iter().all(|&v| v <= 0.0);
    let sum: f64 = volumes.iter().sum();
    if !inside || sum == 0.0 {
        return None;
    }
    let weights = volumes.map(|v| v / sum);
    let point = weights[0] * a + weights[1] * b + weights[2] * c;
    let t = point.dot(ray.dir);
    (t > 0.0).then_some((t, weights))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_on_shared_edges_and_vertices_always_hit() {
        // A fan of 64 triangles around a vertex, turned so that no coordinate is round; rays aim
        // at points on its spokes and at its hub, from a skew eye.
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7);
        let rim = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 64.0;
            turn * (0.8 * DVec3::new(angle.cos(), angle.sin(), 0.1 * (5.0 * angle).sin()))
        };
        let hub = turn * DVec3::new(0.01, 0.02, 0.05);
        let positions: Vec<DVec3> = std::iter::once(hub).chain((0..64).map(rim)).collect();
        let triangles: Vec<[u32; 3]> = (0..64).map(|i| [0, i + 1, (i + 1) % 64 + 1]).collect();
        let tree = Tree::new(&positions, &triangles);
        let origin = turn * DVec3::new(0.13, -0.21, 0.9);
        for spoke in &positions[1..] {
            for step in 0..50 {
                let target = hub.lerp(*spoke, 0.99 * f64::from(step) / 50.0);
                let ray = Ray { origin, dir: (target - origin).normalize() };
                assert!(tree.first_hit(&ray, &positions, &triangles).is_some(), "{target}");
            }
        }
    }

    #[test]
    fn the_nearest_of_many_equal_boxes_is_found() {
        // A thousand squares' halves, one behind the other, plus copies at one place.
        let depths: Vec<f64> = (0..1000).map(|i| 0.5 * f64::from(i) / 1000.0).collect();
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for z in depths.iter().chain(&[0.25; 1000]) {
            let first = positions.len() as u32;
            positions
                .extend([[-0.5, -0.5], [0.5, -0.5], [0.0, 0.5]].map(|[x, y]| DVec3::new(x, y, *z)));
            triangles.push([first, first + 1, first + 2]);
        }
        let tree = Tree::new(&positions, &triangles);
        let ray = Ray { origin: DVec3::new(0.1, 0.0, 1.0), dir: -DVec3::Z };
        let found = tree.first_hit(&ray, &positions, &triangles).unwrap();
        assert_eq!(found.triangle, 999);
        let back = Ray { origin: DVec3::new(0.1, 0.0, 0.1001), dir: -DVec3::Z };
        let found = tree.first_hit(&back, &positions, &triangles).unwrap();
        assert_eq!(found.triangle, 200);
    }
}
