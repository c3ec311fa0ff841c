//! Rec. 709, the space of all radiance here, and from radiance to a screen's light: exposure, highlights, sRGB.
//!
//! Numbers in, numbers out; it names nothing of the host.

/// How radiance above what a screen shows is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, clap::ValueEnum)]
pub enum Curve {
    /// Half of the screen's light is kept, more comes nearer to white and never reaches it.
    #[default]
    Soft,
    /// All is kept, and cut at white.
    Linear,
}

/// How radiance becomes the light of a screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tone {
    /// Exposure in stops.
    pub exposure: f64,
    /// What becomes of bright pixels.
    pub curve: Curve,
}

impl Tone {
    /// The soft curve at an exposure.
    pub fn exposed(exposure: f64) -> Self {
        Self { exposure, curve: Curve::Soft }
    }

    /// The screen's linear light in [0, 1]; black for a NaN.
    ///
    /// x = L 2^exposure. By the soft curve x is kept up to 1/2 and becomes 1 - 1 / (4 x) above, which has the same
    /// value and slope at 1/2 and never reaches 1.
    pub fn light(self, radiance: f32) -> f32 {
        let x = (radiance * (self.exposure as f32).exp2()).max(0.0);
        match self.curve {
            Curve::Soft if x > 0.5 => 1.0 - 0.25 / x,
            Curve::Soft => x,
            Curve::Linear => x.min(1.0),
        }
    }
}

/// Chromaticities x, y of red, green and blue of Rec. 709, and of its white, D65 (ITU-R BT.709-6, tables 1.3 and 1.4).
pub const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
/// See [`PRIMARIES`].
pub const WHITE: [f64; 2] = [0.3127, 0.3290];

/// Luminance of linear Rec. 709 (ITU-R BT.709, the row of Y).
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The sRGB value of linear light in [0, 1] (IEC 61966-2-1).
pub fn srgb(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// The byte that shows linear light, which is cut to [0, 1].
pub fn byte(light: f32) -> u8 {
    (srgb(light.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// Linear light of an sRGB value in [0, 1]: the inverse of `srgb`.
pub fn light(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sRGB value by the soft curve.
    fn display(radiance: f32, stops: f64) -> f32 {
        srgb(Tone::exposed(stops).light(radiance))
    }

    #[test]
    fn the_curve_rises_from_black_to_white_without_a_break() {
        assert_eq!(display(0.0, 0.0), 0.0);
        assert_eq!(display(-1.0, 0.0), 0.0);
        assert!((display(f32::INFINITY, 0.0) - 1.0).abs() < 1e-6);
        // 0.18 is below the shoulder: plain sRGB, 1.055 * 0.18^(1/2.4) - 0.055 = 0.4614.
        assert!((display(0.18, 0.0) - 0.4614).abs() < 1e-4);
        assert_eq!(display(0.09, 1.0), display(0.18, 0.0));
        // 1 becomes 3/4: 1.055 * 0.75^(1/2.4) - 0.055 = 0.8808.
        assert!((display(1.0, 0.0) - 0.8808).abs() < 1e-4);
        let values: Vec<f32> = (0..2000).map(|i| display(i as f32 * 0.002, 0.0)).collect();
        assert!(values.windows(2).all(|pair| pair[1] >= pair[0] && pair[1] - pair[0] < 0.03));
    }

    #[test]
    fn the_linear_curve_is_the_soft_one_up_to_a_half_and_is_cut_at_one() {
        let [soft, linear] =
            [Curve::Soft, Curve::Linear].map(|curve| Tone { exposure: 1.0, curve });
        for radiance in [-1.0, 0.0, 0.1, 0.25] {
            assert_eq!(soft.light(radiance), linear.light(radiance));
        }
        assert_eq!([linear.light(0.4), linear.light(0.5), linear.light(7.0)], [0.8, 1.0, 1.0]);
        // 0.4 by two is 0.8: 1 - 1 / (4 * 0.8).
        assert!((soft.light(0.4) - 0.6875).abs() < 1e-6);
        assert_eq!([soft.light(f32::NAN), linear.light(f32::NAN)], [0.0, 0.0]);
    }

    #[test]
    fn srgb_and_its_inverse_undo_each_other() {
        // Half of the scale is 0.2140 in light: ((0.5 + 0.055) / 1.055)^2.4.
        assert!((light(0.5) - 0.2140).abs() < 1e-4);
        for byte in 0..=255_u8 {
            let value = f32::from(byte) / 255.0;
            assert!((srgb(light(value)) - value).abs() < 1e-6, "{byte}");
        }
    }
}
