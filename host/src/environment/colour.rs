//! From the colour space that a file declares to linear Rec. 709.
//!
//! Matrices are derived here from chromaticities; none is copied from a table but Bradford's.
//! Non-finite texels are left as they are, so that they can still be counted.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::tone::{PRIMARIES, WHITE};

/// CIE 1931 (x, y) of three primaries and of the white that equal amounts of them give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chromaticities {
    pub red: [f64; 2],
    pub green: [f64; 2],
    pub blue: [f64; 2],
    pub white: [f64; 2],
}

/// ITU-R BT.709 with its white D65.
const REC709: Chromaticities =
    Chromaticities { red: PRIMARIES[0], green: PRIMARIES[1], blue: PRIMARIES[2], white: WHITE };

/// Cone responses from XYZ: Lam 1985, the Bradford transform (rows as printed).
const BRADFORD: [[f64; 3]; 3] =
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

impl Chromaticities {
    /// From eight numbers in the order of Radiance's PRIMARIES and OpenEXR's chromaticities.
    pub fn from_numbers(n: [f64; 8]) -> Self {
        Self { red: [n[0], n[1]], green: [n[2], n[3]], blue: [n[4], n[5]], white: [n[6], n[7]] }
    }

    /// Whether these are Rec. 709's, to the three digits that files give.
    pub fn are_rec709(&self) -> bool {
        let near = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        near(self.red, REC709.red)
            && near(self.green, REC709.green)
            && near(self.blue, REC709.blue)
            && near(self.white, REC709.white)
    }

    /// XYZ of RGB, scaled so that white has Y = 1; none for primaries on one line or a white without luminance.
    fn xyz_from_rgb(&self) -> Option<DMat3> {
        let column = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        let primaries = DMat3::from_cols(column(self.red), column(self.green), column(self.blue));
        let usable = primaries.determinant().abs() > 1e-6 && self.white[1] > 1e-6;
        let amounts = primaries.inverse() * (column(self.white) / self.white[1]);
        let matrix = primaries * DMat3::from_diagonal(amounts);
        (usable && matrix.is_finite() && matrix.determinant().abs() > 1e-9).then_some(matrix)
    }

    /// Linear Rec. 709 of this RGB; white stays white (Bradford adaptation), and so does luminance
    /// where the two whites agree.
    pub fn rec709_from_rgb(&self) -> Option<DMat3> {
        let bradford = DMat3::from_cols_array_2d(&BRADFORD).transpose();
        let from_rgb = self.xyz_from_rgb()?;
        let source_cones = bradford * (from_rgb * DVec3::ONE);
        let target_cones = bradford * (REC709.xyz_from_rgb()? * DVec3::ONE);
        let adaptation =
            bradford.inverse() * DMat3::from_diagonal(target_cones / source_cones) * bradford;
        let matrix = rec709_from_xyz()? * adaptation * from_rgb;
        matrix.is_finite().then_some(matrix)
    }
}

/// Linear Rec. 709 of CIE XYZ, without adaptation: D65 becomes white.
pub fn rec709_from_xyz() -> Option<DMat3> {
    REC709.xyz_from_rgb().map(|matrix| matrix.inverse())
}

/// Multiplies every finite texel's RGB by `matrix`.
pub fn convert(texels: &mut [[f32; 4]], matrix: DMat3) {
    texels.par_iter_mut().with_min_len(1 << 14).for_each(|[r, g, b, _]| {
        let rgb = DVec3::new(f64::from(*r), f64::from(*g), f64::from(*b));
        if rgb.is_finite() {
            [*r, *g, *b] = (matrix * rgb).as_vec3().to_array();
        }
    });
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Rec. 2020 primaries, white D65.
    pub const REC2020: [f64; 8] = [0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290];

    fn assert_near(matrix: DMat3, rows: [[f64; 3]; 3], tolerance: f64) {
        for (row, expected) in rows.iter().enumerate() {
            for (column, expected) in expected.iter().enumerate() {
                let got = matrix.col(column)[row];
                assert!((got - expected).abs() < tolerance, "[{row}][{column}]: {got} {expected}");
            }
        }
    }

    #[test]
    fn xyz_to_rec709_is_the_published_matrix() {
        // IEC 61966-2-1 prints four digits.
        let rows =
            [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
        assert_near(rec709_from_xyz().unwrap(), rows, 4e-4);
    }

    #[test]
    fn rec2020_is_the_published_matrix() {
        // ITU-R BT.2087-0, the inverse of its matrix M2 (same white, no adaptation).
        let rows =
            [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        assert_near(Chromaticities::from_numbers(REC2020).rec709_from_rgb().unwrap(), rows, 1e-4);
    }

    #[test]
    fn another_white_is_adapted() {
        // Rec. 709 primaries under the equal-energy white: equal amounts stay equal.
        let equal = Chromaticities { white: [1.0 / 3.0, 1.0 / 3.0], ..REC709 };
        assert!(!equal.are_rec709());
        let white = equal.rec709_from_rgb().unwrap() * DVec3::ONE;
        assert!((white - DVec3::ONE).length() < 1e-12, "{white}");
        // ACEScg (AP1) to Rec. 709 with Bradford, as in the ACES documents.
        let ap1 = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];
        let rows =
            [[1.7051, -0.6218, -0.0833], [-0.1303, 1.1408, -0.0105], [-0.0240, -0.1290, 1.1530]];
        assert_near(Chromaticities::from_numbers(ap1).rec709_from_rgb().unwrap(), rows, 2e-4);
    }

    #[test]
    fn impossible_primaries_give_no_matrix() {
        let line = [0.3, 0.3, 0.4, 0.4, 0.5, 0.5, 0.3127, 0.329];
        assert_eq!(Chromaticities::from_numbers(line).rec709_from_rgb(), None);
        assert_eq!(Chromaticities { white: [0.3, 0.0], ..REC709 }.rec709_from_rgb(), None);
        assert_eq!(Chromaticities { white: [f64::NAN, 0.3], ..REC709 }.rec709_from_rgb(), None);
    }

    #[test]
    fn non_finite_texels_are_left_for_counting() {
        let mut texels = [[f32::INFINITY, 1.0, 2.0, 0.0], [1.0, 1.0, 1.0, 0.0]];
        convert(&mut texels, DMat3::from_diagonal(DVec3::splat(-1.0)));
        assert_eq!(texels, [[f32::INFINITY, 1.0, 2.0, 0.0], [-1.0, -1.0, -1.0, 0.0]]);
    }
}
