//! Which texel looks where: the lat-long orientation of the maps, in map space.
//!
//! As in OpenEXR's latitude-longitude maps: row 0 is +y, the middle of the picture looks to +z, and
//! longitude grows towards +x on the left half. Depends on glam alone. No rotation is applied to
//! texels: it is one uniform of the shaders, whose matrix [`world_from_map`] gives.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

/// The unit direction (map space) of the picture position (`u`, `v`), both in [0, 1].
///
/// u = 0.25 is +x, 0.5 is +z, 0.75 is -x, 0 is -z; v = 0 is +y, v = 1 is -y.
pub fn direction_of(u: f64, v: f64) -> DVec3 {
    let (sin_theta, cos_theta) = (PI * v).sin_cos();
    at_longitude(u, sin_theta, cos_theta)
}

/// The direction at `u` whose polar angle from +y has this sine and cosine.
pub(super) fn at_longitude(u: f64, sin_theta: f64, cos_theta: f64) -> DVec3 {
    let (sin_longitude, cos_longitude) = (TAU * (0.5 - u)).sin_cos();
    DVec3::new(sin_theta * sin_longitude, cos_theta, sin_theta * cos_longitude)
}

/// The picture position (`u` in [0, 1), `v` in [0, 1]) of a direction (map space, any length).
pub fn uv_of(dir: DVec3) -> (f64, f64) {
    let u = 0.5 - dir.x.atan2(dir.z) / TAU;
    // Directions just beside the seam round to 1, which is the same meridian as 0.
    let u = if (0.0..1.0).contains(&u) { u } else { 0.0 };
    (u, dir.x.hypot(dir.z).atan2(dir.y) / PI)
}

/// The rotation of a map in the world: `phi` degrees about +y, then `theta` degrees about +x
/// (world = Rx(theta) Ry(phi) map, right-handed).
pub fn world_from_map(phi_deg: f64, theta_deg: f64) -> DMat3 {
    DMat3::from_rotation_x(theta_deg.to_radians()) * DMat3::from_rotation_y(phi_deg.to_radians())
}

/// The solid angle [sr] of a texel in row `y` of a map of this size: (cos t0 - cos t1) dphi,
/// written as a product so that rows at the poles keep their digits.
pub fn texel_solid_angle(y: u32, width: u32, height: u32) -> f64 {
    let half_step = PI / f64::from(height) / 2.0;
    let middle = (f64::from(y) + 0.5) * 2.0 * half_step;
    2.0 * middle.sin() * half_step.sin() * TAU / f64::from(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_named_meridians_and_the_poles() {
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-15, "{a} is not {b}");
        near(direction_of(0.25, 0.5), DVec3::X);
        near(direction_of(0.5, 0.5), DVec3::Z);
        near(direction_of(0.75, 0.5), DVec3::NEG_X);
        near(direction_of(0.0, 0.5), DVec3::NEG_Z);
        near(direction_of(0.3, 0.0), DVec3::Y);
        near(direction_of(0.3, 1.0), DVec3::NEG_Y);
        assert_eq!(uv_of(DVec3::X), (0.25, 0.5));
        assert_eq!(uv_of(DVec3::Z), (0.5, 0.5));
        assert_eq!(uv_of(DVec3::NEG_X), (0.75, 0.5));
        assert_eq!(uv_of(DVec3::NEG_Z), (0.0, 0.5));
        assert_eq!(uv_of(DVec3::new(-0.0, 0.0, -1.0)), (0.0, 0.5), "both sides of the seam");
        assert_eq!(uv_of(DVec3::Y).1, 0.0);
        assert_eq!(uv_of(DVec3::NEG_Y).1, 1.0);
    }

    #[test]
    fn positions_and_directions_are_inverse() {
        for row in 0..=40 {
            for column in 0..80 {
                let (u, v) = (f64::from(column) / 80.0, f64::from(row) / 40.0);
                let (u_back, v_back) = uv_of(direction_of(u, v));
                assert!((v - v_back).abs() < 1e-12, "v {v} came back as {v_back}");
                let off = (u - u_back).abs();
                let at_pole = row == 0 || row == 40;
                assert!(at_pole || off.min(1.0 - off) < 1e-12, "u {u} came back as {u_back}");
                assert!((0.0..1.0).contains(&u_back));
            }
        }
        // The last double below the seam, and rows of a map 16384 high right at the pole.
        let (u, v) = uv_of(DVec3::new(-1e-300, 0.0, -1.0));
        assert!((0.0..1.0).contains(&u) && v == 0.5);
        let tiny = 0.5 / 16384.0;
        assert!((uv_of(direction_of(0.1, tiny)).1 - tiny).abs() < 1e-17);
    }

    #[test]
    fn the_rotation_is_phi_about_y_then_theta_about_x() {
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-15, "{a} is not {b}");
        // Right-handed: a quarter turn about +y takes +z to +x; one about +x takes +y to +z.
        near(world_from_map(90.0, 0.0) * DVec3::Z, DVec3::X);
        near(world_from_map(90.0, 0.0) * DVec3::X, DVec3::NEG_Z);
        near(world_from_map(0.0, 90.0) * DVec3::Y, DVec3::Z);
        near(world_from_map(0.0, 90.0) * DVec3::Z, DVec3::NEG_Y);
        // Both: +z goes to +x by phi, and theta leaves +x alone; the other order would give -y.
        near(world_from_map(90.0, 90.0) * DVec3::Z, DVec3::X);
        near(world_from_map(90.0, 90.0) * DVec3::X, DVec3::Y);
    }

    #[test]
    fn texels_fill_the_sphere() {
        for (width, height) in [(2, 1), (64, 32), (8192, 4096)] {
            let rows = (0..height).map(|y| texel_solid_angle(y, width, height));
            let sum = rows.sum::<f64>() * f64::from(width);
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-12, "{width}: {sum}");
        }
    }
}
