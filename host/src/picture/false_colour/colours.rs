//! Colours for numbers, laid out in Oklab (Ottosson 2020), where equal steps look about equal.
//!
//! Both scales stay inside sRGB, so that nothing is clipped and lightness alone tells the order: they
//! read in grey too.

use std::f32::consts::PI;

use crate::tone::byte;

/// Of a value that is none.
pub const NO_VALUE: [u8; 3] = [119, 119, 119];

/// From dark violet over red and orange to light yellow, for `t` in [0, 1]: lightness rises in
/// proportion, while the hue goes round.
pub fn sequential(t: f32) -> [u8; 3] {
    let t = t.clamp(0.0, 1.0);
    let chroma = 0.19 * (PI * (0.08 + 0.84 * t)).sin();
    from_oklch(0.15 + 0.8 * t, chroma, 280.0 + 190.0 * t)
}

/// From blue over near-white to red, for `t` in [-1, 1]: 0 is lightest, and both sides are equally dark.
pub fn diverging(t: f32) -> [u8; 3] {
    let t = t.clamp(-1.0, 1.0);
    let hue = if t < 0.0 { 258.0 } else { 27.0 };
    from_oklch(0.96 - 0.52 * t.abs(), 0.16 * t.abs(), hue)
}

/// sRGB bytes of lightness, chroma and hue [degrees] in Oklab.
fn from_oklch(lightness: f32, chroma: f32, hue: f32) -> [u8; 3] {
    light_of_oklch(lightness, chroma, hue).map(byte)
}

/// Linear Rec. 709 of Oklab, by the inverse of both matrices of Ottosson 2020.
fn light_of_oklch(lightness: f32, chroma: f32, hue: f32) -> [f32; 3] {
    let (sin, cos) = hue.to_radians().sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_93 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tone::light;

    /// CIE lightness L* of sRGB bytes, which knows nothing of Oklab.
    fn lightness(bytes: [u8; 3]) -> f32 {
        let [r, g, b] = bytes.map(|byte| light(f32::from(byte) / 255.0));
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    #[test]
    fn no_colour_leaves_srgb() {
        for i in 0..=1000 {
            let t = i as f32 / 1000.0;
            let chroma = 0.19 * (PI * (0.08 + 0.84 * t)).sin();
            let colours = [
                light_of_oklch(0.15 + 0.8 * t, chroma, 280.0 + 190.0 * t),
                light_of_oklch(0.96 - 0.52 * t, 0.16 * t, 258.0),
                light_of_oklch(0.96 - 0.52 * t, 0.16 * t, 27.0),
            ];
            for colour in colours {
                assert!(colour.iter().all(|c| (-1e-5..=1.0 + 1e-5).contains(c)), "{t} {colour:?}");
            }
        }
    }

    #[test]
    fn lightness_rises_in_even_steps() {
        let steps: Vec<f32> = (0..=10).map(|i| lightness(sequential(i as f32 / 10.0))).collect();
        let [first, .., last] = steps[..] else { panic!() };
        let even = (last - first) / 10.0;
        for pair in steps.windows(2) {
            // L* and Oklab's lightness differ a little for saturated colours.
            assert!((pair[1] - pair[0] - even).abs() < 0.4 * even, "{steps:?}");
        }
    }

    #[test]
    fn blue_is_below_red_above_and_zero_white() {
        let [[r, _, b], centre, [red, _, blue]] = [-1.0, 0.0, 1.0].map(diverging);
        assert!(b > r && red > blue, "{r} {b} {red} {blue}");
        assert!(centre.iter().all(|channel| *channel > 235), "{centre:?}");
        for t in [0.25, 0.5, 1.0] {
            let (below, above) = (lightness(diverging(-t)), lightness(diverging(t)));
            assert!((below - above).abs() < 4.0 && above < lightness(centre), "{below} {above}");
        }
        assert_eq!(diverging(7.0), diverging(1.0));
        assert_eq!(sequential(-1.0), sequential(0.0));
    }
}
