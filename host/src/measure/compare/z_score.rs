//! Differences in units of their own standard error.

use super::{Pixels, finite, variance};

/// z = (a - b) / sqrt(e_a^2 + e_b^2) of every value.
///
/// Where the standard errors are right and the two pictures' noise is independent, z has mean 0 and
/// variance 1: its RMS is 1, and 0.27 % of normal ones lie beyond 3.
#[derive(Debug, Clone, PartialEq)]
pub struct ZScores {
    /// Mean of a pixel's z over the channels that have one; NaN where none has.
    pub per_pixel: Vec<f64>,
    /// Root mean square over the counted pixels' values; NaN where there are none.
    pub rms: f64,
    /// Share of those with |z| > 3; NaN where there are none.
    pub beyond_3: f64,
    /// How many values these are of.
    pub values: usize,
    /// Values left out, since neither difference nor standard error is there.
    pub equal_without_error: usize,
    /// Values left out, since they differ where the standard error is 0: z would be infinite.
    pub different_without_error: usize,
    /// Values left out, since a standard error is not finite or negative.
    pub unknown: usize,
}

/// The z-scores of A against B. `errors` are the pixels' standard errors; a picture without any counts as
/// exact.
pub fn z_scores(a: &Pixels, b: &Pixels, errors: [Option<&Pixels>; 2], counted: &[bool]) -> ZScores {
    let finite = finite(a, b);
    let mut scores = ZScores {
        per_pixel: vec![f64::NAN; a.len()],
        rms: f64::NAN,
        beyond_3: f64::NAN,
        values: 0,
        equal_without_error: 0,
        different_without_error: 0,
        unknown: 0,
    };
    let (mut squares, mut beyond) = (0.0, 0_usize);
    for pixel in (0..a.len()).filter(|pixel| finite[*pixel]) {
        let (mut sum, mut channels) = (0.0, 0);
        for channel in 0..3 {
            let difference = f64::from(a[pixel][channel]) - f64::from(b[pixel][channel]);
            let counts = usize::from(counted[pixel]);
            match variance(errors, pixel, channel) {
                None => scores.unknown += counts,
                Some(0.0) if difference == 0.0 => scores.equal_without_error += counts,
                Some(0.0) => scores.different_without_error += counts,
                Some(variance) => {
                    let z = difference / variance.sqrt();
                    sum += z;
                    channels += 1;
                    if counted[pixel] {
                        scores.values += 1;
                        squares += z * z;
                        beyond += usize::from(z.abs() > 3.0);
                    }
                }
            }
        }
        scores.per_pixel[pixel] = sum / f64::from(channels);
    }
    scores.rms = (squares / scores.values as f64).sqrt();
    scores.beyond_3 = beyond as f64 / scores.values as f64;
    scores
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_by_hand() {
        let a = [[1.0, 2.0, 3.0], [4.0, 0.0, 1.0], [f32::INFINITY, 0.0, 0.0], [9.0; 3]];
        let b = [[0.0, 2.0, 3.0], [0.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        let error_a = [[0.3, 0.0, 0.5], [0.0, 0.0, 0.0], [1.0; 3], [1.0; 3]];
        let error_b = [[0.4, 0.0, f32::NAN], [1.0, 0.0, 0.0], [1.0; 3], [1.0; 3]];
        let counted = [true, true, false, false];
        let scores = z_scores(&a, &b, [Some(&error_a), Some(&error_b)], &counted);
        // z = 1 / 0.5 = 2 | equal, unknown | 4 / 1 = 4 | equal | different.
        assert_eq!((scores.values, scores.unknown), (2, 1));
        assert_eq!((scores.equal_without_error, scores.different_without_error), (2, 1));
        assert!((scores.rms - 10.0_f64.sqrt()).abs() < 1e-6);
        assert_eq!(scores.beyond_3, 0.5);
        assert!((scores.per_pixel[0] - 2.0).abs() < 1e-6 && scores.per_pixel[2].is_nan());
        // The last one is in the map and in no mean.
        assert!((scores.per_pixel[3] - 9.0 / 2.0_f64.sqrt()).abs() < 1e-6);
        // B taken as exact.
        let one = z_scores(&a, &b, [Some(&error_a), None], &counted);
        assert!((one.rms - ((1.0 / 0.09) / 2.0_f64).sqrt()).abs() < 1e-4, "{}", one.rms);
        let none = z_scores(&a, &b, [Some(&[[0.0; 3]; 4]), None], &[false; 4]);
        assert!(none.rms.is_nan() && none.beyond_3.is_nan() && none.per_pixel[0].is_nan());
    }

    /// Noise of a known spread has an RMS of 1 within what so few values leave open.
    #[test]
    fn true_errors_give_an_rms_of_one() {
        // A sum of 12 uniform numbers has variance 1 and is all but normal (Irwin-Hall).
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let spread = |i: usize| 0.5 + (i % 7) as f64;
        let mut noisy = |scale: f64| -> Vec<[f32; 3]> {
            (0..4096)
                .map(|i| [(); 3].map(|()| (10.0 + scale * spread(i) * normal()) as f32))
                .collect()
        };
        let (a, b) = (noisy(1.0), noisy(2.0));
        let errors = |scale: f64| -> Vec<[f32; 3]> {
            (0..4096).map(|i| [(scale * spread(i)) as f32; 3]).collect()
        };
        let (error_a, error_b) = (errors(1.0), errors(2.0));
        let scores = z_scores(&a, &b, [Some(&error_a), Some(&error_b)], &[true; 4096]);
        // The RMS of n = 12,288 normal values has the standard error 1 / sqrt(2 n) = 0.0064.
        assert!((scores.rms - 1.0).abs() < 4.0 * 0.0064, "{}", scores.rms);
        // 0.27 % of 12,288 are 33, give or take 6.
        assert!((scores.beyond_3 - 0.0027).abs() < 4.0 * 0.0005, "{}", scores.beyond_3);
        // With B's error forgotten the RMS is sqrt(1 + 4).
        let half_told = z_scores(&a, &b, [Some(&error_a), None], &[true; 4096]);
        assert!((half_told.rms - 5.0_f64.sqrt()).abs() < 0.06, "{}", half_told.rms);
    }
}
