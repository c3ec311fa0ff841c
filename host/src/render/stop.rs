//! When a rendering is done: after its passes, a time, at an error, or at a word from outside.

use std::time::{Duration, Instant};

use super::{Progress, Wish, estimate};

/// Samples a pixel before which no error is believed.
const LEAST_SAMPLES: u64 = 64;

/// What ends a rendering before its last pass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stop {
    /// Time of rendering [s].
    pub time: Option<f64>,
    /// Estimated relMSE of the whole picture.
    pub error: Option<f64>,
}

/// Why a rendering ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// All passes were done, or all texels added.
    Passes,
    /// The time was over.
    Time,
    /// The estimated error was low enough.
    Error,
    /// A word from outside: the picture is unfinished.
    Interrupted,
}

impl Reason {
    /// Its name in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passes => "passes",
            Self::Time => "time",
            Self::Error => "error",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Watches a rendering by these rules.
#[derive(Debug)]
pub struct Stopping {
    stop: Stop,
    /// When the first stretch of work was seen.
    start: Option<Instant>,
    /// What has ended it.
    pub reason: Reason,
}

impl Stopping {
    /// Nothing seen yet.
    pub fn new(stop: Stop) -> Self {
        Self { stop, start: None, reason: Reason::Passes }
    }

    /// What is to come after this progress; `elapsed` is the time of rendering so far.
    ///
    /// The error is looked at only where the samples of each replicate have doubled: who looks at every
    /// sample stops at a lucky one, and the picture is biased. An estimate of which one replicate
    /// holds most is not believed.
    pub fn wish(&mut self, progress: &Progress<'_>, interrupted: bool) -> Wish {
        let start = *self.start.get_or_insert_with(Instant::now);
        if let Some(film) = progress.film {
            let Some(target) = self.stop.error else { return Wish::GoOn };
            if !progress.doubling || progress.done < LEAST_SAMPLES {
                return Wish::GoOn;
            }
            let estimate = estimate(film);
            let low = estimate.relmse.is_some_and(|relmse| relmse <= target);
            if low && !estimate.is_doubtful() {
                return self.finish(Reason::Error);
            }
            return Wish::GoOn;
        }
        if interrupted {
            return self.finish(Reason::Interrupted);
        }
        let over = |time: f64| {
            start.elapsed() >= Duration::try_from_secs_f64(time).unwrap_or(Duration::MAX)
        };
        if self.stop.time.is_some_and(over) {
            return self.finish(Reason::Time);
        }
        match self.stop.error.is_some() && progress.doubling {
            true => Wish::Look,
            false => Wish::GoOn,
        }
    }

    fn finish(&mut self, reason: Reason) -> Wish {
        self.reason = reason;
        Wish::Finish
    }

    /// The part of the way that is behind, in [0, 1], by whichever rule is nearest.
    pub fn part(&self, progress: &Progress<'_>) -> f64 {
        let by_work = progress.done as f64 / progress.of.max(1) as f64;
        let by_time = match (self.stop.time, self.start) {
            (Some(time), Some(start)) => start.elapsed().as_secs_f64() / time.max(1e-9),
            _ => 0.0,
        };
        by_work.max(by_time).min(1.0)
    }
}
