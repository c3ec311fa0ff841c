//! The film: mean and variance of every covered pixel across passes, in f64.
//!
//! Welford's recurrence (1962) keeps both exact for any number of passes: nothing is summed that
//! later has to be subtracted. Non-finite samples come in as zero and are counted beside.

/// Mean and spread of one pixel's passes, per channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pixel {
    /// Mean radiance over the passes so far.
    pub mean: [f64; 3],
    /// Sum of squared deviations of the passes from their mean.
    deviations: [f64; 3],
}

/// What has been rendered so far, one [`Pixel`] a row of the hit list.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    pixels: Vec<Pixel>,
    /// Sums of the pass under way, where a pass has several blocks.
    partial: Vec<[f64; 3]>,
    passes: u64,
    nonfinite: u64,
    nonfinite_pixels: u64,
    flagged: Vec<bool>,
}

impl Film {
    /// A film of `rows` pixels without passes.
    pub fn new(rows: usize) -> Self {
        Self {
            pixels: vec![Pixel::default(); rows],
            partial: vec![[0.0; 3]; rows],
            passes: 0,
            nonfinite: 0,
            nonfinite_pixels: 0,
            flagged: vec![false; rows],
        }
    }

    /// Adds the sum of a block of samples to the pass under way at one pixel.
    pub fn add_block(&mut self, row: usize, sum: [f64; 3], nonfinite: u32) {
        // Samples that are finite one by one can overflow together; they count as one more.
        let overflowed = sum.iter().any(|channel| !channel.is_finite());
        let nonfinite = nonfinite + u32::from(overflowed);
        if !overflowed {
            for (total, channel) in self.partial[row].iter_mut().zip(sum) {
                *total += channel;
            }
        }
        if nonfinite > 0 {
            self.nonfinite += u64::from(nonfinite);
            if !std::mem::replace(&mut self.flagged[row], true) {
                self.nonfinite_pixels += 1;
            }
        }
    }

    /// Ends the pass under way: `samples` samples a pixel went into it.
    pub fn end_pass(&mut self, samples: u32) {
        self.passes += 1;
        let (count, scale) = (self.passes as f64, 1.0 / f64::from(samples));
        for (pixel, partial) in self.pixels.iter_mut().zip(&mut self.partial) {
            let sums = std::mem::take(partial);
            for ((mean, deviations), sum) in
                pixel.mean.iter_mut().zip(&mut pixel.deviations).zip(sums)
            {
                let value = sum * scale;
                let delta = value - *mean;
                *mean += delta / count;
                *deviations += delta * (value - *mean);
            }
        }
    }

    /// Passes so far.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// The pixels, in the order of the hit list.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// Samples with a channel that was Inf or NaN.
    pub fn nonfinite(&self) -> u64 {
        self.nonfinite
    }

    /// Pixels that such samples fell into.
    pub fn nonfinite_pixels(&self) -> u64 {
        self.nonfinite_pixels
    }

    /// Variance of a pixel's mean per channel, across passes; `None` before the second pass.
    pub fn variance_of_mean(&self, row: usize) -> Option<[f64; 3]> {
        let count = self.passes as f64;
        (self.passes >= 2).then(|| {
            self.pixels[row].deviations.map(|deviations| deviations / (count - 1.0) / count)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small generator, so that the expected sums below are of known numbers.
    fn pseudo_random(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 40) as f32 / (1u32 << 24) as f32
    }

    #[test]
    fn a_million_passes_and_one_outlier_do_not_drift() {
        let mut film = Film::new(1);
        let mut state = 7;
        let values: Vec<f32> = (0..1_000_000)
            .map(|pass| if pass == 400_000 { 1e6 } else { pseudo_random(&mut state) })
            .collect();
        for value in &values {
            film.add_block(0, [f64::from(*value); 3], 0);
            film.end_pass(1);
        }
        // The other way: two plain passes over the values in f64.
        let n = values.len() as f64;
        let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum();
        let variance = squares / (n - 1.0) / n;
        let relative = |a: f64, b: f64| ((a - b) / b).abs();
        assert!(relative(film.pixels()[0].mean[1], mean) < 1e-6);
        assert!(relative(film.variance_of_mean(0).unwrap()[1], variance) < 1e-4);
    }

    #[test]
    fn blocks_of_a_pass_count_as_one_and_nonfinite_samples_stay_in_the_denominator() {
        let mut film = Film::new(2);
        for (first, second) in [(1.0, 3.0), (5.0, 7.0)] {
            film.add_block(0, [first; 3], 1);
            film.add_block(0, [second; 3], 2);
            film.end_pass(4);
        }
        assert_eq!(film.pixels()[0].mean, [2.0; 3]);
        // Passes of 1 and 3: sample variance 2, of the mean 1.
        assert_eq!(film.variance_of_mean(0), Some([1.0; 3]));
        assert_eq!((film.nonfinite(), film.nonfinite_pixels()), (6, 1));
        film.add_block(1, [f64::INFINITY, 1.0, 1.0], 0);
        film.end_pass(4);
        assert_eq!((film.nonfinite(), film.nonfinite_pixels()), (7, 2));
        assert_eq!(film.pixels()[1].mean, [0.0; 3]);
    }
}
