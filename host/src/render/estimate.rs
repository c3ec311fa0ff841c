//! What a picture is worth: its estimated error, from its own replicates, in f64.

use rayon::prelude::*;

use super::Film;

/// A picture's error as estimated from its own replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean radiance over covered pixels, per channel.
    pub mean: [f64; 3],
    /// Standard error of that mean, per channel, from the spread of the replicates' means of the whole
    /// picture; `None` with fewer than two replicates.
    pub mean_std_error: Option<[f64; 3]>,
    /// Root mean square, over covered pixels and channels, of a pixel's standard error.
    pub std_error: Option<f64>,
    /// Mean over covered pixels and channels of variance / (mean^2 + eps), eps = (0.01 picture mean)^2.
    pub relmse: Option<f64>,
    /// The part of that relMSE that the replicate farthest off holds: about 1 / replicates where all see
    /// the same, near 1 where one of them met a rare bright sample.
    pub largest_share: Option<f64>,
    /// Of a sum over texels: its estimated error as a part of the sum, over all pixels.
    pub quadrature: Option<f64>,
}

/// One replicate holding more than this part of the variance makes the estimate doubtful.
pub const DOUBTFUL_SHARE: f64 = 0.5;

/// Estimates a film's error.
///
/// Replicates are independent scrambles, so the spread of their means estimates the variance of the
/// picture's mean, however correlated the samples within a replicate are.
pub fn estimate(film: &Film) -> Estimate {
    let rows = film.rows();
    let count = rows as f64;
    let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let sum = |of: &(dyn Fn(usize) -> [f64; 3] + Sync)| {
        // In chunks of fixed rows: the sum does not depend on the number of threads.
        let chunks: Vec<[f64; 3]> = (0..rows.div_ceil(4096))
            .into_par_iter()
            .map(|chunk| (chunk * 4096..((chunk + 1) * 4096).min(rows)).map(of).fold([0.0; 3], add))
            .collect();
        chunks.into_iter().fold([0.0; 3], add).map(|total| total / count.max(1.0))
    };
    let mean = sum(&|row| film.mean(row));
    let mut estimate = Estimate {
        mean,
        mean_std_error: None,
        std_error: None,
        relmse: None,
        largest_share: None,
        quadrature: film.quadrature().map(|quadrature| {
            let total = (mean[0] + mean[1] + mean[2]) / 3.0 * count;
            let errors: f64 = quadrature.errors.iter().sum();
            if total > 0.0 { errors / total } else { 0.0 }
        }),
    };
    let sampled = film.sampled_replicates();
    if rows == 0 || sampled < 2 {
        return estimate;
    }
    let mut squares = [0.0; 3];
    for replicate in 0..sampled {
        let own = sum(&|row| film.replicate_mean(row, replicate));
        for channel in 0..3 {
            squares[channel] += (own[channel] - mean[channel]).powi(2);
        }
    }
    let n = sampled as f64;
    estimate.mean_std_error = Some(squares.map(|sum| (sum / (n - 1.0) / n).sqrt()));

    let eps = (0.01 * (mean[0] + mean[1] + mean[2]) / 3.0).powi(2);
    let variance = sum(&|row| film.variance_of_mean(row).unwrap_or_default());
    estimate.std_error = Some((variance.iter().sum::<f64>() / 3.0).sqrt());
    // Squared distances of each replicate from the mean, relative as relMSE is.
    let distances: Vec<f64> = (0..sampled)
        .map(|replicate| {
            let of_row = |row: usize| {
                let (own, mean) = (film.replicate_mean(row, replicate), film.mean(row));
                std::array::from_fn(|channel| {
                    let square = (own[channel] - mean[channel]).powi(2);
                    // An all-black picture has no relative error: 0 / 0 counts as none.
                    if square == 0.0 { 0.0 } else { square / (mean[channel].powi(2) + eps) }
                })
            };
            sum(&of_row).iter().sum::<f64>() / 3.0
        })
        .collect();
    let total: f64 = distances.iter().sum();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    estimate.relmse = Some(total / (n - 1.0) / n);
    estimate.largest_share = Some(if total > 0.0 { largest / total } else { 0.0 });
    estimate
}

#[cfg(test)]
mod tests {
    use super::super::film::Reading;
    use super::*;

    #[test]
    fn errors_follow_from_the_spread_of_replicates() {
        // Two pixels, two replicates: (1, 3) and (2, 2). Means 2 and 2; variance of the mean
        // ((1-2)^2 + (3-2)^2) / 1 / 2 = 1 at the first pixel, 0 at the second. The picture's means are
        // 1.5 and 2.5: variance 0.5 / 2.
        let mut film = Film::new(2, 2, 1.0);
        let sums = [[1.0, 3.0], [2.0, 2.0]];
        let reading = |row: usize, replicate: usize| {
            Ok::<_, ()>(Reading { sum: [sums[row][replicate]; 3], nonfinite: 0 })
        };
        film.read(0, 2, reading).unwrap();
        film.set_samples(vec![1, 1]);
        let estimate = estimate(&film);
        assert_eq!(estimate.mean, [2.0; 3]);
        assert_eq!(estimate.mean_std_error, Some([0.5; 3]));
        assert!((estimate.std_error.unwrap() - 0.5f64.sqrt()).abs() < 1e-15);
        let expected = 0.5 / (4.0 + 0.0004);
        assert!((estimate.relmse.unwrap() - expected).abs() < 1e-15);
        assert_eq!(estimate.largest_share, Some(0.5));
    }
}
