//! How work is cut into dispatches: by measured time, within the kernel rules.
//!
//! The cut never shows in the picture: the kernel adds a cut block's parts in the same order as the
//! whole. Blocks themselves follow from the settings alone.

use std::time::Duration;

/// Samples of a full block. Its sum is f32; the blocks are added in f64.
pub const BLOCK: u32 = 1024;

/// Iterations that the kernel's own loops may take in one invocation and dispatch.
const KERNEL_ITERATIONS: u32 = 16_384;

/// The smallest share of the rows worth a dispatch of its own.
const MIN_ROWS: u32 = 4096;

/// No dispatch does more than this many times the work of the longest one so far.
const GROWTH: u64 = 8;

/// How long a dispatch should take while nobody waits.
pub const HEADLESS_BUDGET: Duration = Duration::from_millis(100);

/// Learns how fast samples are, and says how much the next dispatch may do.
#[derive(Debug, Clone)]
pub struct Schedule {
    budget: Duration,
    /// Samples (of any pixel) per second.
    rate: Option<f64>,
    longest: u64,
    /// Samples of one invocation in one dispatch; lowered where a plugin's loops ran out of budget.
    sample_limit: u32,
}

/// How the next stretch of work is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// Whole blocks done side by side, at least one.
    pub blocks: u32,
    /// Rows in one dispatch.
    pub rows: u32,
}

impl Schedule {
    /// A schedule for dispatches of about `budget`.
    pub fn new(budget: Duration) -> Self {
        Self {
            budget,
            rate: None,
            longest: u64::from(MIN_ROWS) / GROWTH,
            sample_limit: KERNEL_ITERATIONS,
        }
    }

    /// The next cut, for `blocks` remaining blocks of `block_samples` samples over `rows` rows.
    pub fn next(&self, blocks: u32, block_samples: u32, rows: u32) -> Cut {
        let block_samples = block_samples.max(1);
        let block = u64::from(rows) * u64::from(block_samples);
        let allowed = self.allowed();
        if block_samples <= self.sample_limit && allowed >= block {
            // A block costs the kernel an iteration of its own, beside one for each sample.
            let by_iterations = self.sample_limit / (block_samples + 1);
            let by_time = u32::try_from(allowed / block.max(1)).unwrap_or(u32::MAX);
            return Cut { blocks: blocks.min(by_iterations).min(by_time).max(1), rows };
        }
        let samples = u64::from(block_samples.min(self.sample_limit));
        let fitting = u32::try_from(allowed / samples).unwrap_or(u32::MAX);
        Cut { blocks: 1, rows: fitting.max(MIN_ROWS).min(rows) }
    }

    /// Samples that the next dispatch over `rows` rows may do of a block with `left` samples to go.
    pub fn samples(&self, rows: u32, left: u32) -> u32 {
        let fitting = self.allowed() / u64::from(rows.max(1));
        u32::try_from(fitting).unwrap_or(u32::MAX).min(self.sample_limit).min(left).max(1)
    }

    /// Samples of any pixel that one dispatch may do.
    fn allowed(&self) -> u64 {
        let by_time = match self.rate {
            Some(rate) => (rate * self.budget.as_secs_f64()) as u64,
            None => u64::from(MIN_ROWS),
        };
        by_time.min(self.longest.saturating_mul(GROWTH)).max(1)
    }

    /// Takes note of a dispatch that did `samples` samples (of any pixel) in `time`.
    pub fn learn(&mut self, samples: u64, time: Duration) {
        self.rate = Some(samples as f64 / time.as_secs_f64().max(1e-6));
        self.longest = self.longest.max(samples);
    }

    /// Lowers the samples of one invocation after `done` of them used up the plugins' loop budget;
    /// false where a single one did.
    pub fn shorten(&mut self, done: u32) -> bool {
        self.sample_limit = (done / 8).max(1);
        done > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_grows_from_a_small_start_to_the_budget() {
        let mut schedule = Schedule::new(Duration::from_millis(100));
        assert_eq!(schedule.next(100, 64, 150_000), Cut { blocks: 1, rows: 4096 });
        assert_eq!(schedule.samples(4096, 64), 1);
        // A device of 100 million samples per second: 10 million a dispatch, one block of 9.6 million.
        let mut largest = 0;
        for _ in 0..20 {
            let cut = schedule.next(100, 64, 150_000);
            let whole = cut.rows == 150_000;
            let each = if whole { 64 } else { schedule.samples(cut.rows, 64) };
            let samples = u64::from(cut.blocks) * u64::from(cut.rows) * u64::from(each);
            assert!(samples <= 10_000_000);
            largest = largest.max(samples);
            schedule.learn(samples, Duration::from_secs_f64(samples as f64 / 1e8));
        }
        assert_eq!(largest, 9_600_000);
    }

    #[test]
    fn slow_plugins_get_few_samples_and_kernel_loops_stay_in_their_half() {
        let mut schedule = Schedule::new(Duration::from_millis(100));
        schedule.learn(4096, Duration::from_secs(1));
        assert_eq!(schedule.next(9, 64, 150_000), Cut { blocks: 1, rows: 4096 });
        assert_eq!(schedule.samples(4096, 64), 1);

        let mut fast = Schedule::new(Duration::from_secs(100));
        fast.learn(u64::from(u32::MAX), Duration::from_millis(1));
        let cut = fast.next(u32::MAX, 1, 10);
        assert!(cut.blocks > 1000 && cut.blocks * 2 <= KERNEL_ITERATIONS);
        assert!(fast.shorten(1024));
        assert_eq!(fast.next(9, 1024, 10), Cut { blocks: 1, rows: 10 });
        assert_eq!(fast.samples(10, 1024), 128);
        assert_eq!(fast.next(9, 31, 10), Cut { blocks: 4, rows: 10 });
        assert!(fast.shorten(2) && !fast.shorten(1));
    }
}
