//! Two pictures beside each other, numbers in, numbers out; B is the reference.
//!
//! A pixel that is not finite in all channels of both pictures has no difference: it is NaN in every map
//! here and enters no mean. Who compares has to count such pixels ([`finite`]) and to say so.

pub mod flip;
mod z_score;

pub use z_score::{ZScores, z_scores};

/// A picture's channels, pixel by pixel; of the same length wherever two stand side by side.
pub type Pixels = [[f32; 3]];

/// Which pixels are finite in both pictures.
pub fn finite(a: &Pixels, b: &Pixels) -> Vec<bool> {
    let all = |pixel: &[f32; 3]| pixel.iter().all(|channel| channel.is_finite());
    a.iter().zip(b).map(|(a, b)| all(a) && all(b)).collect()
}

/// (a - b)^2 of each pixel, averaged over its channels: their mean is the MSE.
pub fn squared(a: &Pixels, b: &Pixels) -> Vec<f64> {
    per_pixel(a, b, |a, b| (a - b).powi(2))
}

/// |a - b| of each pixel, averaged over its channels: their mean is the MAE.
pub fn absolute(a: &Pixels, b: &Pixels) -> Vec<f64> {
    per_pixel(a, b, |a, b| (a - b).abs())
}

/// a - b of each pixel, averaged over its channels.
pub fn signed(a: &Pixels, b: &Pixels) -> Vec<f64> {
    per_pixel(a, b, |a, b| a - b)
}

/// (a - b)^2 / (b^2 + eps) of each pixel, averaged over its channels: their mean is the relMSE.
///
/// `eps` is [`relative_eps`] of the reference. Where both are black there is no error; where the whole
/// reference is black, any difference is infinite.
pub fn relative(a: &Pixels, b: &Pixels, eps: f64) -> Vec<f64> {
    per_pixel(a, b, |a, b| if a == b { 0.0 } else { (a - b).powi(2) / (b * b + eps) })
}

/// The part of a picture's mean whose square is the eps of its relMSE: it keeps dark pixels from deciding it.
pub const EPS_PART: f64 = 0.01;

/// eps = (0.01 m)^2, where m is the mean of the counted pixels' channels.
pub fn relative_eps(reference: &Pixels, counted: &[bool]) -> f64 {
    let total = |pixel: &[f32; 3]| pixel.iter().map(|channel| f64::from(*channel)).sum::<f64>();
    let pixels: Vec<f64> = reference.iter().map(|pixel| total(pixel) / 3.0).collect();
    let mean = mean(&pixels, counted);
    if mean.is_nan() { 0.0 } else { (EPS_PART * mean).powi(2) }
}

/// The mean over the counted pixels; NaN where there are none.
pub fn mean(values: &[f64], counted: &[bool]) -> f64 {
    let counted = values.iter().zip(counted).filter(|(_, counted)| **counted);
    let (sum, count) =
        counted.fold((0.0, 0_usize), |(sum, count), (value, _)| (sum + value, count + 1));
    sum / count as f64
}

fn per_pixel(a: &Pixels, b: &Pixels, channel: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let finite = finite(a, b);
    let pixels = a.iter().zip(b).zip(finite);
    let difference = |((a, b), finite): ((&[f32; 3], &[f32; 3]), bool)| {
        let channels = a.iter().zip(b).map(|(a, b)| channel(f64::from(*a), f64::from(*b)));
        if finite { channels.sum::<f64>() / 3.0 } else { f64::NAN }
    };
    pixels.map(difference).collect()
}

/// How far A lies above B on the whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bias {
    /// Mean of a - b, per channel; NaN where no pixel is counted.
    pub mean: [f64; 3],
    /// Standard error of that mean, per channel; `None` where no picture has standard errors. Pixels
    /// draw independently, so their variances add.
    pub std_error: Option<[f64; 3]>,
}

/// The signed mean difference over the counted pixels.
///
/// `errors` are the pixels' standard errors of A and B; a picture without any counts as exact. One that
/// is not finite or negative makes the standard error of its channel NaN.
pub fn bias(a: &Pixels, b: &Pixels, errors: [Option<&Pixels>; 2], counted: &[bool]) -> Bias {
    let count = counted.iter().filter(|counted| **counted).count() as f64;
    let rows = || counted.iter().enumerate().filter(|(_, counted)| **counted).map(|(i, _)| i);
    let mean = [0, 1, 2].map(|channel| {
        let difference = |i: usize| f64::from(a[i][channel]) - f64::from(b[i][channel]);
        rows().map(difference).sum::<f64>() / count
    });
    let known = errors.iter().any(Option::is_some);
    let std_error = known.then(|| {
        [0, 1, 2].map(|channel| {
            let variance = |i: usize| variance(errors, i, channel).unwrap_or(f64::NAN);
            rows().map(variance).sum::<f64>().sqrt() / count
        })
    });
    Bias { mean, std_error }
}

/// Variance of a - b at one value; `None` where a standard error is no number or negative.
fn variance(errors: [Option<&Pixels>; 2], pixel: usize, channel: usize) -> Option<f64> {
    errors.into_iter().flatten().try_fold(0.0, |sum, errors| {
        let error = f64::from(errors[pixel][channel]);
        (error.is_finite() && error >= 0.0).then_some(sum + error * error)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [[f32; 3]; 3] = [[1.0, 2.0, 3.0], [0.0, 0.0, 0.0], [5.0, 5.0, 5.0]];
    const B: [[f32; 3]; 3] = [[1.0, 4.0, 2.0], [0.0, 3.0, 0.0], [5.0, 5.0, f32::NAN]];

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-14
    }

    #[test]
    fn differences_by_hand() {
        let counted = finite(&A, &B);
        assert_eq!(counted, [true, true, false]);
        // Differences 0 -2 1 | 0 -3 0.
        let squares = squared(&A, &B);
        assert!(close(squares[0], 5.0 / 3.0) && close(squares[1], 3.0) && squares[2].is_nan());
        assert!(close(mean(&squares, &counted), 14.0 / 6.0));
        assert!(close(mean(&absolute(&A, &B), &counted), 1.0));
        let signed = signed(&A, &B);
        assert!(close(signed[0], -1.0 / 3.0) && close(signed[1], -1.0) && signed[2].is_nan());
        assert!(mean(&squares, &[false; 3]).is_nan());
    }

    #[test]
    fn relative_errors_by_hand() {
        let counted = finite(&A, &B);
        // The reference's mean is (1 + 4 + 2 + 0 + 3 + 0) / 6 = 5/3.
        let eps = relative_eps(&B, &counted);
        assert!(close(eps, (0.05_f64 / 3.0).powi(2)));
        let relative = relative(&A, &B, eps);
        assert!(close(relative[0], (4.0 / (16.0 + eps) + 1.0 / (4.0 + eps)) / 3.0));
        assert!(close(relative[1], 9.0 / (9.0 + eps) / 3.0));
        // Black beside black is no error, anything beside black an infinite one.
        let black = [[0.0; 3]; 2];
        let eps = relative_eps(&black, &[true; 2]);
        let errors = super::relative(&[[0.0; 3], [0.0, 1e-3, 0.0]], &black, eps);
        assert_eq!(errors, [0.0, f64::INFINITY]);
        assert_eq!(relative_eps(&black, &[false; 2]), 0.0);
    }

    #[test]
    fn the_bias_has_the_error_of_a_mean() {
        let counted = finite(&A, &B);
        let errors = [[0.3_f32, 0.0, 0.6], [0.0, 0.5, 0.8], [9.0; 3]];
        let other = [[0.4_f32, 0.0, f32::NAN], [0.0, 1.2, 0.0], [9.0; 3]];
        let without = bias(&A, &B, [None, None], &counted);
        assert_eq!(without, Bias { mean: [0.0, -2.5, 0.5], std_error: None });
        // Variances of A: red 0.09 + 0, green 0 + 0.25, blue 0.36 + 0.64; the mean is over two.
        let one = bias(&A, &B, [Some(&errors), None], &counted).std_error.unwrap();
        assert!(one.iter().zip([0.15, 0.25, 0.5]).all(|(a, b)| (a - b).abs() < 1e-7), "{one:?}");
        // With B's: red 0.25, green 0.25 + 1.44 = 1.69; of blue one is not known.
        let both = bias(&A, &B, [Some(&errors), Some(&other)], &counted).std_error.unwrap();
        assert!((both[0] - 0.25).abs() < 1e-7 && (both[1] - 0.65).abs() < 1e-7, "{both:?}");
        assert!(both[2].is_nan());
    }
}
