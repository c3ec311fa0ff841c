//! Vertex tangents from uv: the direction of growing u, averaged around each vertex.
//!
//! Depends on glam alone. Triangles whose chart is mirrored average apart from the others, since at
//! a mirror's seam the two directions cancel. Orthogonality to the normal is made at the hit.

use glam::{DVec2, DVec3};

use super::normals::corner_angle;

/// Two tangents per vertex, for charts as they are and mirrored, zero where there is none; and
/// whether each triangle's chart is mirrored. The file's own tangents serve both.
pub(super) fn complete(
    given: Vec<DVec3>,
    uvs: &[DVec2],
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> (Vec<[DVec3; 2]>, Vec<bool>) {
    let mut sums = vec![[DVec3::ZERO; 2]; positions.len()];
    let mut mirrored = vec![false; triangles.len()];
    if !uvs.is_empty() {
        for (triangle, mirrored) in triangles.iter().zip(&mut mirrored) {
            let p = triangle.map(|v| positions[v as usize]);
            let uv = triangle.map(|v| uvs[v as usize]);
            let Some((tangent, mirror)) = along_u(p, uv) else { continue };
            *mirrored = mirror;
            for i in 0..3 {
                sums[triangle[i] as usize][usize::from(mirror)] += corner_angle(p, i) * tangent;
            }
        }
    }
    let mut tangents: Vec<_> = sums.into_iter().map(|s| s.map(DVec3::normalize_or_zero)).collect();
    for (tangent, given) in tangents.iter_mut().zip(given) {
        if let Some(given) = given.try_normalize() {
            *tangent = [given; 2];
        }
    }
    (tangents, mirrored)
}

/// The unit direction in which u grows over a triangle, and whether its chart is mirrored; none
/// where uv is missing or has no area.
fn along_u(p: [DVec3; 3], uv: [DVec2; 3]) -> Option<(DVec3, bool)> {
    let (e, f) = (p[1] - p[0], p[2] - p[0]);
    let (du, dv) = (uv[1] - uv[0], uv[2] - uv[0]);
    let area = du.perp_dot(dv);
    let tangent = (dv.y * e - du.y * f) * area.signum();
    let usable = area.is_finite() && area != 0.0;
    Some((tangent.try_normalize().filter(|_| usable)?, area < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tangent_follows_u_and_mirrored_charts_stay_apart() {
        // Two triangles share the edge x = 0; u = |x|, so that it grows away from the seam.
        let (x, y) = (DVec3::X, DVec3::Y);
        let positions = [DVec3::ZERO, y, x, -x];
        let uvs = [DVec2::ZERO, DVec2::Y, DVec2::X, DVec2::X];
        let triangles = [[0, 2, 1], [0, 1, 3]];
        let (tangents, mirrored) = complete(Vec::new(), &uvs, &positions, &triangles);
        assert_eq!(mirrored, [false, true]);
        assert_eq!(tangents[0], [x, -x]);
        assert_eq!(tangents[3], [DVec3::ZERO, -x]);
    }

    #[test]
    fn missing_or_flat_uv_gives_no_tangent_and_given_ones_win() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let flat = [DVec2::ZERO, DVec2::X, 2.0 * DVec2::X];
        let none = [DVec2::NAN; 3];
        for uvs in [flat, none] {
            let given = vec![DVec3::ZERO, 2.0 * DVec3::Z];
            let (tangents, _) = complete(given, &uvs, &positions, &[[0, 1, 2]]);
            assert_eq!(tangents, [[DVec3::ZERO; 2], [DVec3::Z; 2], [DVec3::ZERO; 2]]);
        }
    }
}
