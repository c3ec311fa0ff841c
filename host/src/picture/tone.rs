//! The curve from radiance to display values.

/// A display value in [0, 1] from radiance, exposed by `stops`.
///
/// x = L 2^stops; up to 1/2 it is kept, above it becomes 1 - 1 / (4 x), which has the same value and
/// slope at 1/2 and never reaches 1; then the sRGB transfer function (IEC 61966-2-1).
pub fn display(radiance: f32, stops: f32) -> f32 {
    let x = (radiance * stops.exp2()).max(0.0);
    let toned = if x <= 0.5 { x } else { 1.0 - 0.25 / x };
    if toned <= 0.003_130_8 { 12.92 * toned } else { 1.055 * toned.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
