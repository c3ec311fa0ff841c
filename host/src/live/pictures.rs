//! The pictures of an order: a small one at once, then the whole one as it gets better.

use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::Result;

use super::frame::{Frame, fresh_number};
use super::kept::{Kept, Made, QUICK_SAMPLES};
use super::seen::Seen;
use super::{Shared, since};
use crate::picture::Picture;
use crate::render::{
    Effort, Ended, Estimate, Film, Progress, Stage, Stopping, Wish, estimate, rest,
};
use crate::scene::Coverage;
use crate::session::Session;

/// Samples of a pixel of what stands in for a sum over texels.
const STAND_IN_SAMPLES: u32 = 64;

/// A small picture that takes longer is made by another integrator the next time.
const PATIENCE: Duration = Duration::from_millis(20);

/// Pictures follow each other no faster, and after this many times what one takes: the film read back, the error, the
/// picture. An order that meets one waits for it.
const SHOWN_EVERY: Duration = Duration::from_millis(80);
const SHOWING_PART: u32 = 4;

impl Kept {
    /// A picture of few samples: a small one, which is seen while something moves, or one of the whole size that stands
    /// in for a sum over texels until that is through.
    pub(super) fn draw_quickly(
        &mut self,
        shared: &Shared,
        session: &Arc<Session>,
        samples: u32,
        seen: &mut Seen,
    ) -> Result<()> {
        let effort = Effort { replicates: 1, seed: session.effort.seed, ..Effort::new(samples, 1) };
        self.look_past(seen, session)?;
        let points = &seen.coverage.points;
        let start = Instant::now();
        let mut film = Film::new(0, 1, 1.0);
        let (Some(stage), Some(made)) =
            (&mut self.stage, self.quick.as_mut().or(self.film.as_mut()))
        else {
            return Ok(());
        };
        if !points.is_empty() {
            let executor = self.executor.as_mut();
            made.prepared.fit(executor, stage, effort)?;
            let ended = made.prepared.run(executor, stage, &mut film, &mut |_| Wish::GoOn)?;
            if ended == Ended::Abandoned {
                return Ok(());
            }
            made.slow |= samples == QUICK_SAMPLES && start.elapsed() > PATIENCE;
        }
        let frame = Figures {
            session,
            done: samples.into(),
            of: session.effort.spp(),
            seconds: since(start),
            preview: true,
            complete: false,
            estimate: None,
            convergence: &[],
        };
        let picture = Picture::compose(seen.size(), points, &film, &seen.background);
        publish(shared, &frame, picture, &film, points.len());
        Ok(())
    }

    /// The picture itself, shown as it gets better.
    pub(super) fn draw_whole(&mut self, shared: &Shared, session: &Arc<Session>) -> Result<()> {
        let size = session.film.resolution;
        let seen = self.whole.take();
        let mut seen = self.cover(seen, session, size)?;
        let sum = self.film.as_ref().and_then(|made| made.prepared.program().sum);
        let looked = match (shared.pace.is_abandoned(), sum) {
            (true, _) => Ok(()),
            (false, None) => self.look_past(&mut seen, session),
            (false, Some(_)) => self.draw_quickly(shared, session, STAND_IN_SAMPLES, &mut seen),
        };
        let (Some(mut stage), Some(mut made)) = (self.stage.take(), self.film.take()) else {
            return looked;
        };
        let drawn = looked.and_then(|()| match shared.pace.is_abandoned() {
            true => Ok(()),
            false => self.refine(shared, session, &seen, &mut stage, &mut made),
        });
        (self.stage, self.film, self.whole) = (Some(stage), Some(made), Some(seen));
        let notes = self.executor.take_notes();
        shared.update(|status| status.notes = notes);
        drawn
    }

    fn refine(
        &mut self,
        shared: &Shared,
        session: &Arc<Session>,
        seen: &Seen,
        stage: &mut Stage,
        made: &mut Made,
    ) -> Result<()> {
        let size = session.film.resolution;
        let Seen { coverage: Coverage { points, .. }, background, .. } = seen;
        let effort = Effort { doublings: session.stop.error.is_some(), ..session.effort };
        let mut film = Film::new(0, 1, 1.0);
        let mut last = Figures {
            session,
            done: 0,
            of: effort.spp(),
            seconds: 0.0,
            preview: false,
            complete: true,
            estimate: None,
            convergence: &[],
        };
        if points.is_empty() {
            let picture = Picture::compose(size, points, &film, background);
            publish(shared, &last, picture, &film, 0);
            return Ok(());
        }
        made.prepared.fit(self.executor.as_mut(), stage, effort)?;
        let sum = made.prepared.program().sum;
        if sum.is_some() {
            shared.update(|status| status.progress = Some([0, stage.terms().into()]));
        }
        let start = Instant::now();
        // Time that pictures take is none of rendering.
        let (mut showing, mut next) = (Duration::ZERO, Duration::ZERO);
        let mut stopping = Stopping::new(session.stop);
        let mut convergence: Vec<[f64; 3]> = Vec::new();
        let mut newest: Option<Estimate> = None;
        let mut looked_at = 0;
        // When the film was asked for.
        let mut asked = start;
        let executor = self.executor.as_mut();
        let ended = made.prepared.run(executor, stage, &mut film, &mut |progress| {
            let Progress { done, of, film, .. } = progress;
            let wish = stopping.wish(&progress, false);
            let Some(film) = film else {
                // A sum is no picture before its last texel.
                let due = start.elapsed() >= next;
                if due && sum.is_some() {
                    shared.update(|status| status.progress = Some([done, of]));
                    next = start.elapsed() + SHOWN_EVERY;
                }
                let due = due && sum.is_none();
                asked = Instant::now();
                return if wish == Wish::GoOn && due { Wish::Look } else { wish };
            };
            let seconds = (start.elapsed() - showing).as_secs_f64();
            let begin = Instant::now();
            // The error is looked at where the samples have half doubled.
            if 2 * done >= 3 * looked_at {
                looked_at = done;
                let found = estimate(film);
                convergence.extend(found.relmse.map(|relmse| [done as f64, seconds, relmse]));
                newest = Some(found);
            }
            // An order that came meanwhile waits for no picture that nobody sees.
            if shared.pace.is_abandoned() {
                return Wish::Abandon;
            }
            let figures = Figures {
                done,
                of,
                seconds,
                complete: false,
                estimate: newest,
                convergence: &convergence,
                ..last
            };
            let picture = Picture::compose(size, points, film, background);
            publish(shared, &figures, picture, film, points.len());
            showing += begin.elapsed();
            next = start.elapsed() + SHOWN_EVERY.max(asked.elapsed() * SHOWING_PART);
            wish
        });
        let ended = ended?;
        if ended == Ended::Abandoned {
            return Ok(());
        }
        let (program, brdf) = (made.prepared.program(), &session.brdf.configured);
        rest::complete(self.executor.as_mut(), stage, program, brdf, ended, &mut film)?;
        last.seconds = (start.elapsed() - showing).as_secs_f64();
        let found = estimate(&film);
        last.done = match film.quadrature() {
            Some(quadrature) => quadrature.terms[0].into(),
            None => film.samples(),
        };
        last.of = film.quadrature().map_or(last.of, |quadrature| quadrature.terms[1].into());
        let point = found.relmse.map(|relmse| [last.done as f64, last.seconds, relmse]);
        convergence
            .extend(point.filter(|point| convergence.last().is_none_or(|l| l[0] < point[0])));
        (last.estimate, last.convergence) = (Some(found), &convergence);
        let picture = Picture::compose(size, points, &film, background);
        publish(shared, &last, picture, &film, points.len());
        Ok(())
    }
}

fn publish(shared: &Shared, figures: &Figures<'_>, picture: Picture, film: &Film, points: usize) {
    let frame = Frame {
        number: fresh_number(),
        picture,
        session: Arc::clone(figures.session),
        preview: figures.preview,
        done: figures.done,
        of: figures.of,
        sum: film.quadrature().is_some(),
        seconds: figures.seconds,
        rate: figures.done as f64 * points as f64 / figures.seconds.max(1e-9) / 1e6,
        nonfinite: film.nonfinite(),
        estimate: figures.estimate,
        convergence: figures.convergence.to_vec(),
        complete: figures.complete,
    };
    shared.update(|status| {
        status.progress = None;
        status.frame = Some(Arc::new(frame));
    });
}

/// What is said of a picture.
#[derive(Clone, Copy)]
struct Figures<'a> {
    session: &'a Arc<Session>,
    done: u64,
    of: u64,
    seconds: f64,
    preview: bool,
    complete: bool,
    estimate: Option<Estimate>,
    convergence: &'a [[f64; 3]],
}
