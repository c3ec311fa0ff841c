//! The loop that adds up terms, one for each texel of the map: blocks by their number alone.

use std::ops::Range;

use brdf_sdk::{Problem, Result};

use super::film::{Quadrature, Reading};
use super::loaded::Loaded;
use super::schedule::{Cut, Schedule, TERM_BLOCK};
use super::{Ended, Film, Observe, Progress, Stage, Wish};
use crate::exec::Executor;
use crate::link::endless_loop;

/// Where most pixels have all terms of a block, steps cost next to nothing, until a dispatch meets one that has not: no
/// more than this many times the rate of the block's first sweep is counted on.
const FASTER: f64 = 4.0;

/// A sum over texels under way.
pub(super) struct Terms<'a> {
    pub loaded: &'a Loaded,
    pub stage: &'a Stage,
    pub scale: f32,
    /// Terms in all.
    pub terms: u32,
    /// Calls of `term` in a dispatch at the most; 0 leaves it to the schedule.
    pub per_pass: u32,
}

impl Terms<'_> {
    /// Adds up into an empty film, from its start again where plugins' loops used up their budget.
    pub fn run(
        &self,
        executor: &mut dyn Executor,
        schedule: &mut Schedule,
        film: &mut Film,
        observe: &mut Observe<'_>,
    ) -> Result<Ended> {
        loop {
            film.begin(self.stage.points().len(), 1, self.scale);
            film.set_samples(vec![1]);
            film.set_quadrature(Quadrature {
                errors: vec![0.0; film.rows()],
                terms: [0, self.terms],
                evaluations: 0,
            });
            if let Some(ended) = self.attempt(executor, schedule, film, observe)? {
                return Ok(ended);
            }
            self.loaded.clear_sums(executor)?;
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
        let mut finished = film.quadrature().cloned().unwrap_or_default();
        let mut longest = 0;
        let mut begin = 0;
        while begin < self.terms {
            let end = (begin + TERM_BLOCK).min(self.terms);
            let mut begins = true;
            let mut steady = f64::INFINITY;
            // Some pixels take more calls for their terms than others; the block ends with the last of them.
            loop {
                let steps = self.sweep(executor, schedule, begin..end, begins)?;
                if begins {
                    steady = schedule.rate().unwrap_or(steady);
                    schedule.set_ceiling(FASTER * steady);
                }
                begins = false;
                longest = longest.max(steps);
                if schedule.is_abandoned() {
                    return Ok(Some(Ended::Abandoned));
                }
                let Some((least, quadrature)) = self.look(executor, film, &finished, begin)? else {
                    return match schedule.shorten(longest) {
                        true => Ok(None),
                        false => Err(endless_loop(&self.loaded.names, "for one texel")),
                    };
                };
                let at = begin + least;
                film.set_quadrature(Quadrature { terms: [at, self.terms], ..quadrature });
                let progress = Progress {
                    done: at.into(),
                    of: self.terms.into(),
                    doubling: false,
                    film: None,
                    device_seconds: None,
                };
                match observe(progress) {
                    Wish::Abandon => return Ok(Some(Ended::Abandoned)),
                    // Only where all pixels have the same texels can the rest be told.
                    Wish::Finish if at == end && at < self.terms => return Ok(Some(Ended::Early)),
                    Wish::Look
                        if at == end
                            && observe(Progress { film: Some(film), ..progress })
                                == Wish::Abandon =>
                    {
                        return Ok(Some(Ended::Abandoned));
                    }
                    _ => {}
                }
                if at == end {
                    break;
                }
            }
            // The next block's first sweep has work for all pixels again.
            schedule.set_ceiling(steady);
            film.end_block();
            finished = film.quadrature().cloned().unwrap_or_default();
            begin = end;
        }
        Ok(Some(Ended::Complete))
    }

    /// Goes on with a block at every row; returns the calls of an invocation.
    fn sweep(
        &self,
        executor: &mut dyn Executor,
        schedule: &mut Schedule,
        block: Range<u32>,
        begins: bool,
    ) -> Result<u32> {
        let mut longest = 0;
        let per_pass = if self.per_pass == 0 { u32::MAX } else { self.per_pass };
        for band in &self.loaded.bands {
            let mut row = 0;
            // The caller looks whether it was abandoned, too.
            while row < band.rows && schedule.goes_on() {
                let steps = (block.len() as u32).min(per_pass);
                let cut = schedule.cut(Cut { rows: band.rows - row, replicates: 1, steps });
                let words = [
                    ("first_row", band.first_row + row),
                    ("row_count", cut.rows),
                    ("first_band_row", band.first_row),
                    ("block_begin", block.start),
                    ("block_end", block.end),
                    ("steps", cut.steps),
                    ("begins", begins.into()),
                    ("scale", self.scale.to_bits()),
                ];
                let time = self.loaded.dispatch(executor, self.stage, band, &words, cut.rows)?;
                schedule.learn(u64::from(cut.steps) * u64::from(cut.rows), time);
                longest = longest.max(cut.steps);
                row += cut.rows;
            }
        }
        Ok(longest)
    }

    /// Reads the sums of the block under way: the terms that every row has, and what is known of the
    /// quadrature; `None` where a plugin's loops used up their budget.
    fn look(
        &self,
        executor: &mut dyn Executor,
        film: &mut Film,
        finished: &Quadrature,
        block_begin: u32,
    ) -> Result<Option<(u32, Quadrature)>> {
        let layout = &self.loaded.sum;
        let rgb = ["r", "g", "b"].map(|channel| layout.at(channel));
        let [error, terms, evaluations, nonfinite, exhausted] =
            ["error", "terms", "evaluations", "nonfinite", "exhausted"].map(|m| layout.at(m));
        let mut quadrature = finished.clone();
        let most = (self.terms - block_begin).min(TERM_BLOCK);
        let mut least = most;
        for band in &self.loaded.bands {
            let read = self.loaded.read(executor, band)?;
            let rows = band.rows as usize;
            for row in 0..rows {
                let sum = row * layout.stride;
                if read.word(sum + exhausted) != 0 {
                    return Ok(None);
                }
                least = least.min(read.word(sum + terms));
                quadrature.evaluations += u64::from(read.word(sum + evaluations));
                // Errors come unscaled: they are compared with radiance in the kernel.
                quadrature.errors[band.first_point + row] += read.float(sum + error);
            }
            film.read(band.first_point, rows, |row, _| {
                let sum = row * layout.stride;
                let channels = rgb.map(|channel| read.float(sum + channel));
                Ok::<_, Problem>(Reading { sum: channels, nonfinite: read.word(sum + nonfinite) })
            })?;
        }
        Ok(Some((least, quadrature)))
    }
}
