//! What a picture is worth: its estimated error, from its own replicates, in f64.

use rayon::prelude::*;

use super::Film;
use crate::measure::compare::EPS_PART;
use crate::measure::student::DOUBTFUL_SHARE;

/// A picture's error as estimated from its own replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean radiance over covered pixels, per channel.
    pub mean: [f64; 3],
    /// Standard error of that mean, per channel, from the spread of the replicates' means of the whole
    /// picture; `None` with fewer than two replicates.
    pub mean_std_error: Option<[f64; 3]>,
    /// The same of the mean over all channels.
    pub grey_std_error: Option<f64>,
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

impl Estimate {
    /// Whether one replicate holds so much of the variance that its spread says little.
    pub fn is_doubtful(&self) -> bool {
        self.largest_share.is_some_and(|share| share > DOUBTFUL_SHARE)
    }
}

/// Estimates a film's error.
///
/// Replicates are independent scrambles, so the spread of their means estimates the variance of the
/// picture's mean, however correlated the samples within a replicate are.
pub fn estimate(film: &Film) -> Estimate {
    let rows = film.rows();
    let sampled = film.sampled_replicates();
    let count = (rows as f64).max(1.0);
    let average = |sums: &[f64; 3]| sums.map(|sum| sum / count);
    let sums = sums(rows, sampled, &|row, sums: &mut Sums| {
        add(&mut sums.whole, film.mean(row));
        for (replicate, sum) in sums.apart.iter_mut().enumerate() {
            add(sum, film.replicate_mean(row, replicate));
        }
    });
    let mean = average(&sums.whole);
    let mut estimate = Estimate {
        mean,
        mean_std_error: None,
        grey_std_error: None,
        std_error: None,
        relmse: None,
        largest_share: None,
        quadrature: film.quadrature().map(|quadrature| {
            let total = (mean[0] + mean[1] + mean[2]) / 3.0 * rows as f64;
            let errors: f64 = quadrature.errors.iter().sum();
            if total > 0.0 { errors / total } else { 0.0 }
        }),
    };
    if rows == 0 || sampled < 2 {
        return estimate;
    }
    let mut squares = [0.0; 3];
    let mut grey_squares = 0.0;
    for own in sums.apart.iter().map(average) {
        let away: [f64; 3] = std::array::from_fn(|channel| own[channel] - mean[channel]);
        add(&mut squares, away.map(|away| away.powi(2)));
        grey_squares += (away.iter().sum::<f64>() / 3.0).powi(2);
    }
    let n = sampled as f64;
    let std_error = |squares: f64| (squares / (n - 1.0) / n).sqrt();
    estimate.mean_std_error = Some(squares.map(std_error));
    estimate.grey_std_error = Some(std_error(grey_squares));

    let eps = (EPS_PART * (mean[0] + mean[1] + mean[2]) / 3.0).powi(2);
    // Squared distances of each replicate from the mean, relative as relMSE is; and the variance of the mean.
    let distances = self::sums(rows, sampled, &|row, sums: &mut Sums| {
        let mean = film.mean(row);
        for (replicate, sum) in sums.apart.iter_mut().enumerate() {
            let own = film.replicate_mean(row, replicate);
            let squares: [f64; 3] =
                std::array::from_fn(|channel| (own[channel] - mean[channel]).powi(2));
            add(&mut sums.whole, squares);
            // An all-black picture has no relative error: 0 / 0 counts as none.
            let relative = |channel: usize| match squares[channel] {
                0.0 => 0.0,
                square => square / (mean[channel].powi(2) + eps),
            };
            add(sum, std::array::from_fn(relative));
        }
    });
    let variance = average(&distances.whole).map(|sum| sum / (n - 1.0) / n);
    estimate.std_error = Some((variance.iter().sum::<f64>() / 3.0).sqrt());
    let of_replicate = |sums: &[f64; 3]| average(sums).iter().sum::<f64>() / 3.0;
    let distances: Vec<f64> = distances.apart.iter().map(of_replicate).collect();
    let total: f64 = distances.iter().sum();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    estimate.relmse = Some(total / (n - 1.0) / n);
    estimate.largest_share = Some(if total > 0.0 { largest / total } else { 0.0 });
    estimate
}

/// Sums over rows: of all replicates together, and of each apart.
#[derive(Clone)]
struct Sums {
    whole: [f64; 3],
    apart: Vec<[f64; 3]>,
}

fn add(sum: &mut [f64; 3], more: [f64; 3]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

/// Sums over all rows of what `take` adds for each: one way through the film, in chunks of fixed rows, so that they do
/// not depend on the number of threads.
fn sums(rows: usize, replicates: usize, take: &(dyn Fn(usize, &mut Sums) + Sync)) -> Sums {
    let none = Sums { whole: [0.0; 3], apart: vec![[0.0; 3]; replicates] };
    let chunks: Vec<Sums> = (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sums = none.clone();
            (chunk * CHUNK..((chunk + 1) * CHUNK).min(rows)).for_each(|row| take(row, &mut sums));
            sums
        })
        .collect();
    chunks.into_iter().fold(none, |mut all, chunk| {
        add(&mut all.whole, chunk.whole);
        all.apart.iter_mut().zip(chunk.apart).for_each(|(sum, more)| add(sum, more));
        all
    })
}

/// Rows that are added up together.
const CHUNK: usize = 4096;

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
        assert_eq!(estimate.grey_std_error, Some(0.5));
        assert!((estimate.std_error.unwrap() - 0.5f64.sqrt()).abs() < 1e-15);
        let expected = 0.5 / (4.0 + 0.0004);
        assert!((estimate.relmse.unwrap() - expected).abs() < 1e-15);
        assert_eq!(estimate.largest_share, Some(0.5));
    }
}
