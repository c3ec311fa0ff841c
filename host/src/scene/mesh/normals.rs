//! Vertex normals where the file has none: smooth, weighted by angle, shared by position.
//!
//! Depends on glam alone. There is no crease angle: a cube without normals looks round.

use std::collections::HashMap;

use glam::DVec3;

/// Unit normals for all vertices: the file's where they are finite and not zero, computed ones
/// elsewhere; zero where the faces around a vertex cancel.
pub(super) fn complete(
    given: Vec<DVec3>,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> Vec<DVec3> {
    let mut normals: Vec<DVec3> = given.into_iter().map(DVec3::normalize_or_zero).collect();
    normals.resize(positions.len(), DVec3::ZERO);
    if normals.contains(&DVec3::ZERO) {
        let computed = smooth(positions, triangles);
        for (normal, computed) in normals.iter_mut().zip(computed) {
            if *normal == DVec3::ZERO {
                *normal = computed;
            }
        }
    }
    normals
}

/// Smooth normals: the sum of face normals around each position, weighted by the face's angle
/// there (Thuermer and Wuethrich 1998), which does not depend on how polygons were cut.
fn smooth(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    // Adding zero makes -0 and +0 the same place.
    let place = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut places = HashMap::new();
    let place_of: Vec<usize> = positions
        .iter()
        .map(|&p| {
            let next = places.len();
            *places.entry(place(p)).or_insert(next)
        })
        .collect();
    let mut sums = vec![DVec3::ZERO; places.len()];
    for triangle in triangles {
        let p = triangle.map(|v| positions[v as usize]);
        let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
        for i in 0..3 {
            sums[place_of[triangle[i] as usize]] += corner_angle(p, i) * normal;
        }
    }
    place_of.into_iter().map(|place| sums[place].normalize_or_zero()).collect()
}

/// The angle of a triangle at corner `i` [radians].
pub(super) fn corner_angle(p: [DVec3; 3], i: usize) -> f64 {
    let (e, f) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
    e.cross(f).length().atan2(e.dot(f))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_corner_points_along_its_diagonal_however_its_faces_are_cut() {
        // Three squares of different cuts meet at the origin; each spans 90 degrees there, so the
        // normal is the diagonal. Weights by area or by count would lean to the face with two.
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let positions = [DVec3::ZERO, x, x + y, y, y + z, z, z + x, DVec3::new(-0.0, 0.0, -0.0)];
        // The last vertex is the origin again, as a split vertex; it shares the normal.
        let triangles = [[0, 1, 2], [7, 2, 3], [0, 3, 5], [3, 4, 5], [0, 5, 6], [0, 6, 1]];
        let normals = complete(Vec::new(), &positions, &triangles);
        let diagonal = DVec3::ONE.normalize();
        assert!((normals[0] - diagonal).length() < 1e-15, "{}", normals[0]);
        assert_eq!(normals[7], normals[0]);
    }

    #[test]
    fn given_normals_stay_and_unusable_ones_are_computed() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let given = vec![DVec3::new(0.0, 3.0, 0.0), DVec3::ZERO, DVec3::NAN];
        let normals = complete(given, &positions, &[[0, 1, 2]]);
        assert_eq!(normals, [DVec3::Y, DVec3::Z, DVec3::Z]);
    }
}
