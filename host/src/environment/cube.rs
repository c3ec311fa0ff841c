//! Which texel of a cube looks where, in map space.
//!
//! Six faces in the order +x, -x, +y, -y, +z, -z, one below the other. On a face s runs to the right
//! and t down, both from -1 to 1; texel i of n covers s from 2 i / n - 1 to 2 (i + 1) / n - 1. This is
//! OpenGL's table of a cube map's faces, read as directions of the right-handed map space; which pictures
//! fill it so that nothing comes out mirrored is `arrangement`'s part.

use glam::DVec3;

/// The direction of a place on a face, as long as it comes out: its largest component is 1.
pub fn direction_of(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    }
}

/// The face that a direction (any length) leaves by, and where: (face, s, t).
pub fn face_of(d: DVec3) -> (usize, f64, f64) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        let face = usize::from(d.x < 0.0);
        (face, if face == 0 { -d.z } else { d.z } / a.x, -d.y / a.x)
    } else if a.y >= a.z {
        let face = 2 + usize::from(d.y < 0.0);
        (face, d.x / a.y, if face == 2 { d.z } else { -d.z } / a.y)
    } else {
        let face = 4 + usize::from(d.z < 0.0);
        (face, if face == 4 { d.x } else { -d.x } / a.z, -d.y / a.z)
    }
}

/// The solid angle [sr] of a texel of a face of `side` x `side`.
///
/// The part of a face between its centre and (s, t) has the solid angle atan(s t / sqrt(1 + s^2 + t^2));
/// a texel is the alternating sum of its corners.
pub fn texel_solid_angle(side: u32, column: u32, row: u32) -> f64 {
    let edge = |i: u32| 2.0 * f64::from(i) / f64::from(side) - 1.0;
    solid_angle([edge(column), edge(column + 1)], [edge(row), edge(row + 1)])
}

/// The solid angle [sr] of a rectangle on a face.
pub fn solid_angle([s0, s1]: [f64; 2], [t0, t1]: [f64; 2]) -> f64 {
    corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0)
}

/// The solid angles [sr] of a row of texels of a face of `side` x `side`.
pub fn row_solid_angles(side: u32, row: u32) -> Vec<f64> {
    let edge = |i: u32| 2.0 * f64::from(i) / f64::from(side) - 1.0;
    let (top, bottom) = (edge(row), edge(row + 1));
    let up_to: Vec<f64> =
        (0..=side).map(|i| corner(edge(i), bottom) - corner(edge(i), top)).collect();
    up_to.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// The solid angle of the part of a face between its centre and (s, t), with the sign of s t.
fn corner(s: f64, t: f64) -> f64 {
    (s * t).atan2((1.0 + s * s + t * t).sqrt())
}

/// The density over solid angle [1/sr] at (s, t) of a point that is uniform over the area of its texel.
///
/// The texel has the area (2 / side)^2 on the face, and (1 + s^2 + t^2)^(-3/2) of solid angle lies on a unit
/// of area there (Pharr, Jakob and Humphreys 2016, section 5.5.3: cos / r^2 with r^2 = 1 + s^2 + t^2).
pub fn uniform_density(side: u32, s: f64, t: f64) -> f64 {
    let side = f64::from(side);
    side * side / 4.0 * (1.0 + s * s + t * t).powf(1.5)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn texels_fill_the_sphere() {
        for side in [1, 2, 3, 64] {
            for row in 0..side {
                for (column, angle) in (0..side).zip(row_solid_angles(side, row)) {
                    assert!((angle - texel_solid_angle(side, column, row)).abs() < 1e-15);
                }
            }
            let texels = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
            let face: f64 = texels.map(|(column, row)| texel_solid_angle(side, column, row)).sum();
            assert!((6.0 * face / (4.0 * PI) - 1.0).abs() < 1e-12, "{side}: {face}");
        }
        // Each texel of a 2x2 face is an octant's third: 4 pi / 24.
        assert!((texel_solid_angle(2, 0, 1) - PI / 6.0).abs() < 1e-15);
    }

    /// The mean of 1 / density over a texel's area is its solid angle, for whole faces and for small texels.
    #[test]
    fn the_density_integrates_to_one_over_a_texel() {
        for (side, column, row) in [(1, 0, 0), (4, 0, 0), (4, 1, 2), (4, 3, 1)] {
            let steps = 400;
            let at = |cell: u32, step: u32| {
                let place = f64::from(cell) + (f64::from(step) + 0.5) / f64::from(steps);
                2.0 * place / f64::from(side) - 1.0
            };
            let mut sum = 0.0;
            for i in 0..steps {
                for j in 0..steps {
                    sum += 1.0 / uniform_density(side, at(column, i), at(row, j));
                }
            }
            let mean = sum / f64::from(steps * steps);
            let exact = texel_solid_angle(side, column, row);
            // The midpoint rule is off by about a third of a step squared.
            assert!((mean / exact - 1.0).abs() < 1e-5, "{side} {column} {row}: {mean} {exact}");
        }
    }

    #[test]
    fn places_and_directions_are_inverse() {
        for face in 0..6 {
            for i in 0..100 {
                let (s, t) = (f64::from(i % 10) / 5.1 - 0.9, f64::from(i / 10) / 5.1 - 0.9);
                let (face_back, s_back, t_back) = face_of(direction_of(face, s, t) * 3.0);
                assert_eq!(face_back, face);
                assert!((s - s_back).abs() < 1e-15 && (t - t_back).abs() < 1e-15);
            }
        }
    }
}
