//! What a picture is worth: its estimated error, from the spread of its own passes, in f64.
//!
//! It reads films and says numbers; it renders nothing and prints nothing.

pub mod compare;

use crate::render::Film;

/// A picture's error as estimated from its own passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean radiance over covered pixels, per channel.
    pub mean: [f64; 3],
    /// Standard error of that mean, per channel; `None` before the second pass.
    pub mean_std_error: Option<[f64; 3]>,
    /// Root mean square, over covered pixels and channels, of a pixel's standard error.
    pub std_error: Option<f64>,
    /// Mean over covered pixels and channels of variance / (mean^2 + eps), eps = (0.01 picture mean)^2.
    pub relmse: Option<f64>,
}

/// Estimates a film's error.
///
/// Passes are independent scrambles, so the spread of pass means estimates the variance of their
/// mean without bias, however correlated the samples within a pass are. Pixels are scrambled
/// independently, so variances of pixels add.
pub fn estimate(film: &Film) -> Estimate {
    let rows = film.pixels().len();
    if rows == 0 {
        return Estimate { mean: [0.0; 3], mean_std_error: None, std_error: None, relmse: None };
    }
    let count = rows as f64;
    let mut mean = [0.0; 3];
    for pixel in film.pixels() {
        for (total, channel) in mean.iter_mut().zip(pixel.mean) {
            *total += channel / count;
        }
    }
    if film.passes() < 2 {
        return Estimate { mean, mean_std_error: None, std_error: None, relmse: None };
    }
    let eps = (0.01 * (mean[0] + mean[1] + mean[2]) / 3.0).powi(2);
    let mut variance = [0.0; 3];
    let mut relative = 0.0;
    for (row, pixel) in film.pixels().iter().enumerate() {
        let of_pixel = film.variance_of_mean(row).unwrap_or_default();
        for channel in 0..3 {
            variance[channel] += of_pixel[channel];
            let scale = pixel.mean[channel].powi(2) + eps;
            // An all-black picture has no relative error: 0 / 0 counts as none.
            relative += if of_pixel[channel] == 0.0 { 0.0 } else { of_pixel[channel] / scale };
        }
    }
    Estimate {
        mean,
        mean_std_error: Some(variance.map(|sum| sum.sqrt() / count)),
        std_error: Some((variance.iter().sum::<f64>() / (3.0 * count)).sqrt()),
        relmse: Some(relative / (3.0 * count)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_follow_from_the_spread_of_passes() {
        // Two pixels, two passes: (1, 3) and (2, 2). Means 2 and 2; variance of the mean
        // ((1-2)^2 + (3-2)^2) / 1 / 2 = 1 at the first pixel, 0 at the second.
        let mut film = Film::new(2);
        for (a, b) in [(1.0, 2.0), (3.0, 2.0)] {
            film.add_block(0, [a; 3], 0);
            film.add_block(1, [b; 3], 0);
            film.end_pass(1);
        }
        let estimate = estimate(&film);
        assert_eq!(estimate.mean, [2.0; 3]);
        assert_eq!(estimate.mean_std_error, Some([0.5; 3]));
        assert!((estimate.std_error.unwrap() - 0.5f64.sqrt()).abs() < 1e-15);
        let expected = 0.5 / (4.0 + 0.0004);
        assert!((estimate.relmse.unwrap() - expected).abs() < 1e-15);
    }
}
