//! The loop that renders by samples: replicates in turn, blocks by the settings alone.

use std::ops::Range;
use std::time::Duration;

use brdf_sdk::{Problem, Result};

use super::film::Reading;
use super::loaded::{Band, Loaded};
use super::schedule::{BLOCK, Cut, Schedule};
use super::{Effort, Ended, Film, Observe, Progress, Stage, Wish};
use crate::exec::{Executor, Readout};
use crate::link::endless_loop;

/// Rows, dispatches and time that probing takes at the most.
const PROBE_ROWS: u32 = 8192;
const PROBES: u32 = 5;
const PROBE_TIME: Duration = Duration::from_millis(4);

/// Where the members of a sum lie, looked up once.
struct SumLayout {
    stride: usize,
    rgb: [usize; 3],
    counts: usize,
}

/// Bits of `Sum.counts` in shaders/film.wgsl.
mod counts {
    pub fn samples(counts: u32) -> u32 {
        counts & 0x7ff
    }
    pub fn nonfinite(counts: u32) -> u32 {
        (counts >> 11) & 0x7ff
    }
    pub fn exhausted(counts: u32) -> bool {
        counts >> 22 != 0
    }
}

/// A rendering by samples under way.
pub(super) struct Samples<'a> {
    pub loaded: &'a Loaded,
    pub stage: &'a Stage,
    pub effort: Effort,
    pub scale: f32,
    /// Whether the plugins have loops, which may use up their budget.
    pub has_loops: bool,
}

impl Samples<'_> {
    /// Renders into an empty film, from its start again where plugins' loops used up their budget.
    pub fn run(
        &self,
        executor: &mut dyn Executor,
        schedule: &mut Schedule,
        film: &mut Film,
        observe: &mut Observe<'_>,
    ) -> Result<Ended> {
        loop {
            film.begin(self.stage.points().len(), self.effort.replicates as usize, self.scale);
            if let Some(ended) = self.attempt(executor, schedule, film, observe)? {
                return Ok(ended);
            }
            self.loaded.clear_states(executor)?;
        }
    }

    /// `None` where the loops' budget was used up and the schedule will now cut shorter.
    fn attempt(
        &self,
        executor: &mut dyn Executor,
        schedule: &mut Schedule,
        film: &mut Film,
        observe: &mut Observe<'_>,
    ) -> Result<Option<Ended>> {
        let replicates = self.effort.replicates;
        let all = self.effort.samples_of(0);
        let mut at = 0;
        let mut longest = self.probe(executor, schedule, all)?;
        while at < all {
            let block_begin = at / BLOCK * BLOCK;
            let block_end = (block_begin + BLOCK).min(all);
            let rows = self.stage.points().len() as u64;
            let mut to = at.saturating_add(schedule.stretch(rows, replicates)).min(block_end);
            if self.effort.doublings {
                to = to.min(if at == 0 { 1 } else { 2u32 << at.ilog2() });
            }
            for band in &self.loaded.bands {
                let done = self.stretch(executor, schedule, band, at..to, block_begin)?;
                longest = longest.max(done);
            }
            if schedule.is_abandoned() {
                return Ok(Some(Ended::Abandoned));
            }
            let first = at == 0;
            at = to;
            let samples = (0..replicates).map(|r| self.effort.samples_of(r).min(at).into());
            let samples: Vec<u64> = samples.collect();
            let progress = Progress {
                done: samples.iter().sum(),
                of: self.effort.spp(),
                doubling: at.is_power_of_two(),
                film: None,
                device_seconds: None,
            };
            let wish = observe(progress);
            if wish == Wish::Abandon {
                return Ok(Some(Ended::Abandoned));
            }
            // Loops without an end show at once, or cost a whole block.
            let unsure = first && self.has_loops;
            if wish == Wish::GoOn && at < block_end && !unsure {
                continue;
            }
            if !self.look(executor, film, at, block_begin)? {
                return match schedule.shorten(longest) {
                    true => Ok(None),
                    false => Err(endless_loop(&self.loaded.names, "for one sample")),
                };
            }
            // Whoever has no use for it any more need not see it.
            if schedule.is_abandoned() {
                return Ok(Some(Ended::Abandoned));
            }
            film.set_samples(samples);
            if at == block_end && at < all {
                film.end_block();
            }
            if wish == Wish::Finish {
                return Ok(Some(if at == all { Ended::Complete } else { Ended::Early }));
            }
            let wish = observe(Progress {
                film: Some(film),
                device_seconds: match self.effort.doublings {
                    true => executor.device_seconds(),
                    false => None,
                },
                ..progress
            });
            match wish {
                Wish::Abandon => return Ok(Some(Ended::Abandoned)),
                Wish::Finish if at < all => return Ok(Some(Ended::Early)),
                _ => {}
            }
        }
        Ok(Some(Ended::Complete))
    }

    /// Learns how fast a few rows are, so that the first stretch is not too long; what it adds up is begun
    /// again. A program that learns from its samples is not probed: its state would remember.
    fn probe(&self, executor: &mut dyn Executor, schedule: &mut Schedule, all: u32) -> Result<u32> {
        let (Some(band), false) = (self.loaded.bands.first(), self.loaded.keeps_state()) else {
            return Ok(0);
        };
        if schedule.knows() {
            return Ok(0);
        }
        let rows = band.rows.min(PROBE_ROWS);
        let wanted = Cut { rows, replicates: self.effort.replicates, steps: all.min(4) };
        let mut longest = 0;
        for _ in 0..PROBES {
            let cut = schedule.cut(wanted);
            let shares = schedule.shares(cut.rows, cut.replicates);
            let time = self.dispatch(executor, band, [0, 0, 0], cut, shares, 0)?;
            schedule.learn(cut.work(), time);
            longest = longest.max(cut.steps * cut.replicates.div_ceil(shares));
            if cut == wanted || time > PROBE_TIME {
                break;
            }
        }
        Ok(longest)
    }

    /// One dispatch: from this row of the band, this replicate and this sample on.
    fn dispatch(
        &self,
        executor: &mut dyn Executor,
        band: &Band,
        [row, replicate, sample]: [u32; 3],
        cut: Cut,
        shares: u32,
        block_begin: u32,
    ) -> Result<Duration> {
        let effort = self.effort;
        let words = [
            ("first_row", band.first_row + row),
            ("row_count", cut.rows),
            ("first_band_row", band.first_row),
            ("band_rows", band.rows),
            ("first_replicate", replicate),
            ("replicate_count", cut.replicates),
            ("shares", shares),
            ("first_sample", sample),
            ("sample_count", cut.steps),
            ("block_begin", block_begin),
            ("replicates", effort.replicates),
            ("replicate_samples", effort.samples_of(effort.replicates)),
            ("longer_replicates", effort.longer_replicates()),
            ("seed", effort.seed),
            ("scale", self.scale.to_bits()),
        ];
        self.loaded.dispatch(executor, self.stage, band, &words, cut.rows * shares)
    }

    /// Does samples `range` of every replicate at every row of a band; returns the samples of the longest
    /// invocation.
    fn stretch(
        &self,
        executor: &mut dyn Executor,
        schedule: &mut Schedule,
        band: &Band,
        range: Range<u32>,
        block_begin: u32,
    ) -> Result<u32> {
        let effort = self.effort;
        let steps = range.len() as u32;
        let mut longest = 0;
        let mut row = 0;
        // The caller looks whether it was abandoned, too.
        while row < band.rows && schedule.goes_on() {
            let all = Cut { rows: band.rows - row, replicates: effort.replicates, steps };
            let rows = schedule.cut(all).rows;
            let mut replicate = 0;
            while replicate < effort.replicates && schedule.goes_on() {
                let left = effort.replicates - replicate;
                let replicates = schedule.cut(Cut { rows, replicates: left, steps }).replicates;
                let mut at = range.start;
                while at < range.end && schedule.goes_on() {
                    let mut cut = schedule.cut(Cut { rows, replicates, steps: range.end - at });
                    (cut.rows, cut.replicates) = (rows, replicates);
                    let place = [row, replicate, at];
                    let shares = schedule.shares(rows, replicates);
                    let time = self.dispatch(executor, band, place, cut, shares, block_begin)?;
                    schedule.learn(cut.work(), time);
                    longest = longest.max(cut.steps * replicates.div_ceil(shares));
                    at += cut.steps;
                }
                replicate += replicates;
            }
            row += rows;
        }
        Ok(longest)
    }

    /// Reads the sums of the block under way; false where a plugin's loops used up their budget.
    fn look(
        &self,
        executor: &mut dyn Executor,
        film: &mut Film,
        at: u32,
        block_begin: u32,
    ) -> Result<bool> {
        let layout = SumLayout {
            stride: self.loaded.sum.stride,
            rgb: ["r", "g", "b"].map(|channel| self.loaded.sum.at(channel)),
            counts: self.loaded.sum.at("counts"),
        };
        let expected: Vec<u32> = (0..self.effort.replicates)
            .map(|replicate| {
                let own = self.effort.samples_of(replicate);
                own.min(at) - own.min(block_begin)
            })
            .collect();
        for band in &self.loaded.bands {
            let read = self.loaded.read(executor, band)?;
            let rows = band.rows as usize;
            let mut sums = (0..rows * expected.len()).map(|slot| slot * layout.stride);
            if self.has_loops && sums.any(|sum| counts::exhausted(read.word(sum + layout.counts))) {
                return Ok(false);
            }
            film.read(band.first_point, rows, |row, replicate| {
                self.reading(
                    &read,
                    (replicate * rows + row) * layout.stride,
                    &layout,
                    expected[replicate],
                )
            })?;
        }
        Ok(true)
    }

    /// One sum, checked against the number of samples that it must hold.
    fn reading(
        &self,
        read: &Readout,
        at: usize,
        layout: &SumLayout,
        expected: u32,
    ) -> Result<Reading> {
        let word = read.word(at + layout.counts);
        let done = counts::samples(word);
        if done != expected {
            return Err(Problem::new(
                &self.loaded.names,
                format!(
                    "a pixel did {done} samples of {expected}: the driver ended its loop early"
                ),
                "use a newer driver or another `--device`, or fewer --samples",
            ));
        }
        let sum = layout.rgb.map(|channel| read.float(at + channel));
        Ok(Reading { sum, nonfinite: counts::nonfinite(word) })
    }
}
