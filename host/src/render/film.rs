//! The film: every covered pixel's sums, of each replicate apart, in f64.
//!
//! A replicate is one scramble of the sequence, continued as long as the picture is rendered. Replicates are
//! independent, so the spread of their means is the error of the picture's mean, however correlated
//! the samples inside of a replicate are. A sum over texels is a film of one replicate, whose terms are added and not
//! averaged; its error is the quadrature's own.

use rayon::prelude::*;

/// What has been rendered so far, one row for each shading point.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    replicates: usize,
    /// Samples that each replicate has at every pixel.
    samples: Vec<u64>,
    /// Sums as they stand, row by row, all replicates of a row side by side.
    sums: Vec<[f64; 3]>,
    /// Sums of the blocks that are complete; empty before the first one is.
    finished: Vec<[f64; 3]>,
    /// Samples of each row with a channel that was Inf or NaN; and those of complete blocks.
    nonfinite: Vec<u32>,
    nonfinite_finished: Vec<u32>,
    /// What sums are multiplied by to become radiance.
    unit: f64,
    quadrature: Option<Quadrature>,
}

/// What is known of a sum over texels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Quadrature {
    /// Estimated error of each row's sum [radiance].
    pub errors: Vec<f64>,
    /// Evaluations of the integrand so far.
    pub evaluations: u64,
    /// Terms summed up, and all there are.
    pub terms: [u32; 2],
}

/// One pixel's sums as they come from the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Sum of the samples.
    pub sum: [f64; 3],
    /// Samples that were Inf or NaN and count as zero in the sum.
    pub nonfinite: u32,
}

impl Film {
    /// A film of `rows` pixels without samples, whose sums come in times `scale`.
    pub fn new(rows: usize, replicates: usize, scale: f32) -> Self {
        Self {
            replicates,
            samples: vec![0; replicates],
            sums: vec![[0.0; 3]; rows * replicates],
            finished: Vec::new(),
            nonfinite: vec![0; rows],
            nonfinite_finished: vec![0; rows],
            unit: 1.0 / f64::from(scale),
            quadrature: None,
        }
    }

    /// Begins anew, as `new` does, in the memory that it has.
    pub fn begin(&mut self, rows: usize, replicates: usize, scale: f32) {
        let mut sums = std::mem::take(&mut self.sums);
        if sums.len() == rows * replicates {
            sums.par_iter_mut().with_min_len(1 << 16).for_each(|sum| *sum = [0.0; 3]);
        } else {
            // Fresh memory is zero already: whoever reads sums into it touches it first, on all cores.
            drop(sums);
            sums = vec![[0.0; 3]; rows * replicates];
        }
        *self = Self { sums, ..Self::new(0, replicates, scale) };
        self.nonfinite = vec![0; rows];
        self.nonfinite_finished = vec![0; rows];
    }

    /// Takes the sums of the block under way from `reading(row, replicate)`, for rows from `first` on;
    /// what was read of the same block before gives way.
    ///
    /// # Errors
    /// The first that `reading` returns.
    pub fn read<E: Send>(
        &mut self,
        first: usize,
        count: usize,
        reading: impl Fn(usize, usize) -> Result<Reading, E> + Sync,
    ) -> Result<(), E> {
        let width = self.replicates;
        let sums = &mut self.sums[first * width..(first + count) * width];
        let finished = &self.finished;
        let nonfinite = &mut self.nonfinite[first..first + count];
        let nonfinite_finished = &self.nonfinite_finished[first..first + count];
        sums.par_chunks_mut(width)
            .zip(nonfinite.par_iter_mut().zip(nonfinite_finished))
            .enumerate()
            .with_min_len(1024)
            .try_for_each(|(row, (sums, (nonfinite, before)))| {
                *nonfinite = *before;
                for (replicate, total) in sums.iter_mut().enumerate() {
                    let Reading { mut sum, nonfinite: mut bad } = reading(row, replicate)?;
                    // Samples that are finite one by one can overflow together; they count as one more.
                    if sum.iter().any(|channel| !channel.is_finite()) {
                        sum = [0.0; 3];
                        bad += 1;
                    }
                    let base = finished.get((first + row) * width + replicate);
                    let base = base.copied().unwrap_or_default();
                    *total = std::array::from_fn(|channel| base[channel] + sum[channel]);
                    *nonfinite = nonfinite.saturating_add(bad);
                }
                Ok(())
            })
    }

    /// Says how many samples each replicate has in the sums that were read.
    pub fn set_samples(&mut self, samples: Vec<u64>) {
        self.samples = samples;
    }

    /// Ends the block under way: what is read from now on is added to it.
    pub fn end_block(&mut self) {
        self.sums.par_iter().with_min_len(1 << 16).copied().collect_into_vec(&mut self.finished);
        self.nonfinite_finished.clone_from(&self.nonfinite);
    }

    /// Says what is known of a sum over texels.
    pub fn set_quadrature(&mut self, quadrature: Quadrature) {
        self.quadrature = Some(quadrature);
    }

    /// Adds radiance to every row: what an unfinished sum leaves out, estimated.
    pub fn add(&mut self, radiance: impl Fn(usize) -> [f64; 3]) {
        let (width, unit) = (self.replicates, self.unit);
        for (row, sums) in self.sums.chunks_mut(width).enumerate() {
            for (total, more) in sums[0].iter_mut().zip(radiance(row)) {
                *total += more / unit;
            }
        }
    }

    /// What is known of a sum over texels; `None` for a picture made of samples.
    pub fn quadrature(&self) -> Option<&Quadrature> {
        self.quadrature.as_ref()
    }

    /// Pixels.
    pub fn rows(&self) -> usize {
        self.nonfinite.len()
    }

    /// Replicates.
    pub fn replicates(&self) -> usize {
        self.replicates
    }

    /// Samples of every pixel, over all replicates; 1 for a sum over texels.
    pub fn samples(&self) -> u64 {
        self.samples.iter().sum()
    }

    /// Mean radiance of a pixel, per channel.
    pub fn mean(&self, row: usize) -> [f64; 3] {
        let sums = &self.sums[row * self.replicates..(row + 1) * self.replicates];
        let count = self.samples().max(1) as f64;
        std::array::from_fn(|channel| {
            sums.iter().map(|sum| sum[channel]).sum::<f64>() / count * self.unit
        })
    }

    /// Mean radiance of every pixel, in order.
    pub fn means(&self) -> impl Iterator<Item = [f64; 3]> {
        (0..self.rows()).map(|row| self.mean(row))
    }

    /// Mean radiance of a pixel in one replicate, per channel; 0 where it has no samples.
    pub fn replicate_mean(&self, row: usize, replicate: usize) -> [f64; 3] {
        let count = self.samples[replicate].max(1) as f64;
        self.sums[row * self.replicates + replicate].map(|sum| sum / count * self.unit)
    }

    /// Replicates with samples; fewer than two say nothing of the error.
    pub fn sampled_replicates(&self) -> usize {
        self.samples.iter().filter(|samples| **samples > 0).count()
    }

    /// Variance of a pixel's mean per channel, across replicates; `None` where fewer than two have samples.
    pub fn variance_of_mean(&self, row: usize) -> Option<[f64; 3]> {
        let count = self.sampled_replicates() as f64;
        (count >= 2.0).then(|| {
            let mean = self.mean(row);
            let mut squares = [0.0; 3];
            for replicate in (0..self.replicates).filter(|r| self.samples[*r] > 0) {
                let own = self.replicate_mean(row, replicate);
                for channel in 0..3 {
                    squares[channel] += (own[channel] - mean[channel]).powi(2);
                }
            }
            squares.map(|sum| sum / (count - 1.0) / count)
        })
    }

    /// Samples with a channel that was Inf or NaN.
    pub fn nonfinite(&self) -> u64 {
        self.nonfinite.iter().map(|count| u64::from(*count)).sum()
    }

    /// Pixels that such samples fell into.
    pub fn nonfinite_pixels(&self) -> u64 {
        self.nonfinite.iter().filter(|count| **count > 0).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(film: &mut Film, sums: &[[f64; 2]]) {
        let reading = |row: usize, replicate: usize| {
            Ok::<_, ()>(Reading { sum: [sums[row][replicate]; 3], nonfinite: 0 })
        };
        film.read(0, sums.len(), reading).unwrap();
    }

    #[test]
    fn replicates_are_averaged_and_their_spread_is_the_error() {
        let mut film = Film::new(1, 2, 0.5);
        // Sums come in times 1/2: samples of 2 + 4 and of 6 + 4 in the two replicates.
        read(&mut film, &[[3.0, 5.0]]);
        film.set_samples(vec![2, 2]);
        assert_eq!(film.mean(0), [4.0; 3]);
        assert_eq!(film.replicate_mean(0, 1), [5.0; 3]);
        // Means 3 and 5: sample variance 2, of the mean 1.
        assert_eq!(film.variance_of_mean(0), Some([1.0; 3]));
    }

    #[test]
    fn a_block_is_read_over_itself_until_it_ends() {
        let mut film = Film::new(1, 2, 1.0);
        for (samples, sums) in [(1, [1.0, 2.0]), (2, [3.0, 4.0])] {
            read(&mut film, &[sums]);
            film.set_samples(vec![samples; 2]);
        }
        assert_eq!(film.mean(0), [7.0 / 4.0; 3]);
        film.end_block();
        read(&mut film, &[[1.0, 1.0]]);
        film.set_samples(vec![3; 2]);
        assert_eq!(film.mean(0), [9.0 / 6.0; 3]);
    }

    #[test]
    fn nonfinite_samples_stay_in_the_denominator_and_are_counted() {
        let mut film = Film::new(2, 1, 1.0);
        let reading = |row: usize, _| {
            let sum = if row == 0 { [8.0; 3] } else { [f64::INFINITY, 1.0, 1.0] };
            Ok::<_, ()>(Reading { sum, nonfinite: 2 * u32::from(row == 0) })
        };
        film.read(0, 2, reading).unwrap();
        film.set_samples(vec![4]);
        assert_eq!((film.mean(0), film.mean(1)), ([2.0; 3], [0.0; 3]));
        assert_eq!((film.nonfinite(), film.nonfinite_pixels()), (3, 2));
        assert_eq!(film.variance_of_mean(0), None);
    }
}
