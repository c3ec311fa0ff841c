//! The colour spaces of FLIP, over Rec. 709 primaries and their white, D65.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::tone::{PRIMARIES, WHITE};

/// XYZ of linear RGB, each divided by that of white, so that white is (1, 1, 1).
static XYZ_FROM_RGB: LazyLock<DMat3> = LazyLock::new(|| {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let [red, green, blue] = PRIMARIES.map(xyz);
    let white = xyz(WHITE);
    // How much of each primary makes white.
    let primaries = DMat3::from_cols(red, green, blue);
    let amounts = primaries.inverse() * white;
    DMat3::from_diagonal(white.recip()) * primaries * DMat3::from_diagonal(amounts)
});
static RGB_FROM_XYZ: LazyLock<DMat3> = LazyLock::new(|| XYZ_FROM_RGB.inverse());

/// The opponent space Y Cx Cz: CIELAB with its cube root left out, so that it is linear in light.
pub fn opponent(rgb: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = *XYZ_FROM_RGB * rgb;
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// Linear RGB of Y Cx Cz.
pub fn rgb_of_opponent(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    *RGB_FROM_XYZ * DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0)
}

/// CIELAB of linear RGB, with the Hunt effect: colours look less colourful where it is darker, a and b
/// are scaled by L / 100 (Andersson et al. 2020, section 4.1.3).
pub fn hunt_lab(rgb: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let xyz = *XYZ_FROM_RGB * rgb;
    let (x, y, z) = (f(xyz.x), f(xyz.y), f(xyz.z));
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    DVec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
}

/// The HyAB distance of two colours in a Lab space (Abasi, Tehran and Fairchild 2020): city block
/// between lightness and colour, Euclid within colour; right for large differences too.
pub fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_neutral_and_green_is_where_cielab_has_it() {
        assert!((opponent(DVec3::ONE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        assert!((hunt_lab(DVec3::ONE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        // The green primary in CIELAB under D65, from the published matrix of sRGB in seven digits;
        // Hunt scales a and b by 0.87735.
        let green = hunt_lab(DVec3::Y);
        let expected = DVec3::new(87.735, -86.183 * 0.877_35, 83.180 * 0.877_35);
        assert!((green - expected).length() < 0.02, "{green}");
        let colour = DVec3::new(0.3, 0.7, 0.1);
        assert!((rgb_of_opponent(opponent(colour)) - colour).length() < 1e-14);
    }

    #[test]
    fn hyab_adds_lightness_to_the_euclidean_distance_in_colour() {
        assert_eq!(hyab(DVec3::new(10.0, 3.0, 0.0), DVec3::new(8.0, 0.0, 4.0)), 7.0);
    }
}
