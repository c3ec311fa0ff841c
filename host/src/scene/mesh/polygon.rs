//! A polygon -> triangles: a fan where it is convex, by clipping ears where it is not.
//!
//! Depends on glam alone. A polygon need not be flat: it is judged in projection along its mean
//! normal. One that crosses itself gets some triangles, as many as any other.

use glam::{DVec2, DVec3};

/// Polygons of more corners become fans: clipping may take the cube of their number.
const MAX_CLIPPED: usize = 1024;

/// Triangles of the polygon's winding, as indices of its corners, of which there are at least three.
pub(super) fn triangles(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let count = corners.len();
    if (4..=MAX_CLIPPED).contains(&count) {
        let flat = project(corners);
        let corner = |i: usize| [flat[i], flat[(i + 1) % count], flat[(i + 2) % count]];
        if (0..count).any(|i| twice_area(corner(i)) < 0.0) {
            return clip_ears(&flat);
        }
    }
    (2..count).map(|i| [0, i - 1, i]).collect()
}

/// Leaves out the axis along which the area is largest, so that the polygon turns to the left.
fn project(corners: &[DVec3]) -> Vec<DVec2> {
    let edges = corners.windows(2).map(|p| (p[0] - corners[0]).cross(p[1] - corners[0]));
    let normal: DVec3 = edges.sum();
    let axis = normal.abs().max_position();
    let flat = |p: &DVec3| {
        let p = p.to_array();
        let (first, second) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
        DVec2::new(if normal[axis] < 0.0 { -first } else { first }, second)
    };
    corners.iter().map(flat).collect()
}

/// Cuts off one corner after the other whose triangle holds no other corner.
fn clip_ears(flat: &[DVec2]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::new();
    while left.len() >= 3 {
        let count = left.len();
        let around = |i: usize| [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
        let ear = (0..count).find(|&i| is_ear(flat, &left, around(i))).unwrap_or(0);
        triangles.push(around(ear));
        left.remove(ear);
    }
    triangles
}

fn is_ear(flat: &[DVec2], left: &[usize], ear: [usize; 3]) -> bool {
    let [a, b, c] = ear.map(|i| flat[i]);
    let inside = |p: DVec2| {
        [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|part| twice_area(part) >= 0.0)
    };
    // A hole that is joined by an edge there and back has corners at the same place.
    let other = |p: &DVec2| ![a, b, c].contains(p);
    let mut others = left.iter().map(|&i| flat[i]).filter(other);
    twice_area([a, b, c]) > 0.0 && !others.any(inside)
}

/// Positive where the triangle turns to the left.
fn twice_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polygon in the plane, however it is turned and wherever it begins: its triangles have its
    /// winding and together its area. With no overlap in the other sense, they cover it once.
    #[track_caller]
    fn assert_covered(outline: &[[f64; 2]], area: f64) {
        let turns: [fn([f64; 2]) -> DVec3; 4] = [
            |[x, y]| DVec3::new(x, y, 0.0),
            |[x, y]| DVec3::new(0.0, x, y),
            |[x, y]| DVec3::new(y, 0.0, x),
            |[x, y]| DVec3::new(-x, y, x),
        ];
        for turn in turns {
            let up = turn([1.0, 0.0]).cross(turn([0.0, 1.0]));
            let mut corners: Vec<DVec3> = outline.iter().copied().map(turn).collect();
            for _ in outline {
                corners.rotate_left(1);
                let triangles = triangles(&corners);
                assert_eq!(triangles.len(), outline.len() - 2);
                let areas = triangles.iter().map(|t| {
                    let [a, b, c] = t.map(|i| corners[i]);
                    0.5 * (b - a).cross(c - a).dot(up) / up.length_squared()
                });
                assert!(areas.clone().all(|area| area >= 0.0), "{triangles:?}");
                assert!((areas.sum::<f64>() - area).abs() < 1e-12, "{triangles:?}");
            }
        }
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        // A square without a quarter that ends in its middle; an L; a comb of three teeth.
        assert_covered(&[[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0]], 3.0);
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        assert_covered(&l, 3.0);
        let mut comb = vec![[0.0, -1.0], [6.0, -1.0]];
        comb.extend([6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0].map(|x| [x, 3.0 * (x % 2.0)]));
        // The base has 6, each tooth 2 * 3 / 2.
        assert_covered(&comb, 6.0 + 3.0 * 3.0);
    }

    #[test]
    fn a_hole_that_is_joined_by_an_edge_stays_open() {
        let hole = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0]];
        let inner = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0]];
        assert_covered(&[hole, inner].concat(), 9.0 - 1.0);
    }

    #[test]
    fn convex_polygons_are_fans_and_what_is_none_ends() {
        let ring =
            |n: usize| (0..n).map(move |i| (std::f64::consts::TAU * i as f64 / n as f64).sin_cos());
        let corners: Vec<DVec3> = ring(300).map(|(y, x)| DVec3::new(x, y, 0.0)).collect();
        let fan: Vec<[usize; 3]> = (2..300).map(|i| [0, i - 1, i]).collect();
        assert_eq!(triangles(&corners), fan);
        // A bow tie, and one point four times.
        let tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(triangles(&tie.map(|[x, y]| DVec3::new(x, y, 0.0))).len(), 2);
        assert_eq!(triangles(&[DVec3::ONE; 4]).len(), 2);
    }
}
