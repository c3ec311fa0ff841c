//! One run of one cell: time and, where they are asked for, errors at every doubling of the samples.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

use super::Limits;
use super::case::Opened;
use super::errors::{Errors, Look};
use super::reference::Reference;
use crate::exec::Executor;
use crate::link::{View, link};
use crate::render::{
    Effort, Ended, Film, HEADLESS_BUDGET, Pace, Prepared, Progress, TERM_BLOCK, Wish, rest,
};
use crate::session::Chosen;

/// What is waited for at the most before a first step, in times of the limit.
const PATIENCE: f64 = 4.0;

/// One run.
pub(super) struct Measured {
    /// Linking and validating [s].
    pub(super) link: f64,
    /// The device's compiler, and all that the program reads brought there [s].
    pub(super) compile: f64,
    /// Where samples had doubled.
    pub(super) steps: Vec<Reached>,
    /// Of a sum over texels: those that were added, and all.
    pub(super) texels: Option<[u32; 2]>,
    /// Time of rendering [s].
    pub(super) seconds: f64,
    /// The last film, where it was asked for.
    pub(super) film: Option<Film>,
}

/// A number of samples that a run has reached.
pub(super) struct Reached {
    /// Samples of a pixel; 0 of a sum.
    pub(super) spp: u64,
    /// Time of rendering [s].
    pub(super) seconds: f64,
    /// The dispatches' own part of it, by the device's clock [s].
    pub(super) device_seconds: Option<f64>,
    /// The errors, where they were asked for.
    pub(super) errors: Option<Errors>,
}

/// What a run is for.
#[derive(Clone, Copy)]
pub(super) enum Aim<'a> {
    /// Errors against the reference, and times.
    Errors(&'a Reference),
    /// Times alone, up to so many samples of a pixel; of a sum as far as it comes.
    Times(u64),
    /// The film after the time that a cell has.
    Picture,
}

/// Runs a cell.
///
/// # Errors
/// Where its program does not link, the device refuses it, or a sum has no time for its first texels.
pub(super) fn measure(
    executor: &mut dyn Executor,
    opened: &Opened,
    integrator: &Chosen,
    limits: &Limits,
    aim: Aim<'_>,
) -> Result<Measured> {
    let scene = &opened.case.scene;
    let mut stage = opened.stage();
    let start = Instant::now();
    let program = Arc::new(link(&View::Film {
        brdf: scene.brdf.configured.clone(),
        integrator: integrator.configured.clone(),
        form: stage.form(scene.sampler),
    })?);
    let linked = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let effort = Effort {
        samples: u32::try_from(limits.samples).unwrap_or(u32::MAX),
        passes: Some(1),
        replicates: limits.replicates,
        seed: limits.seed,
        doublings: true,
    };
    let plugins = [&scene.brdf.configured, &integrator.configured];
    let pace = Pace::new(HEADLESS_BUDGET);
    let own = Arc::clone(&pace);
    let mut prepared = match Prepared::new(executor, &mut stage, &program, &plugins, effort, own) {
        Ok(prepared) => prepared,
        Err(problem) => {
            stage.unload(executor);
            return Err(problem);
        }
    };
    let compile = start.elapsed().as_secs_f64();

    let device_start = executor.device_seconds();
    let mut watch = Watch {
        limits,
        aim,
        is_sum: program.sum.is_some(),
        start: Instant::now(),
        paused: Duration::ZERO,
        asked: None,
        device_start,
        steps: Vec::new(),
    };
    let mut film = Film::new(0, 1, 1.0);
    let guard = program.sum.map(|_| abandon_after(&pace, 2.0 * PATIENCE * limits.time));
    let ended = prepared.run(executor, &stage, &mut film, &mut |progress| watch.see(&progress));
    drop(guard);
    let seconds = watch.seconds();
    let device_seconds = watch.on_device(executor.device_seconds());
    prepared.free(executor);
    let rested = match &ended {
        Ok(ended) => {
            let brdf = &scene.brdf.configured;
            rest::complete(executor, &stage, &program, brdf, *ended, &mut film)
        }
        Err(_) => Ok(()),
    };
    stage.unload(executor);
    if ended? == Ended::Abandoned {
        return Err(Problem::new(
            integrator.configured.plugin.id.clone(),
            format!("{seconds:.0} s were not enough for its first {TERM_BLOCK} texels"),
            "give it more --time, fewer pixels, or a faster device",
        ));
    }
    rested?;
    let texels = film.quadrature().map(|sum| sum.terms);
    if watch.steps.is_empty() || texels.is_some() {
        let done = if texels.is_some() { 0 } else { film.samples() };
        let look = watch.look(&film);
        watch.steps = vec![Step { spp: done, seconds, device_seconds, look }];
    }
    let steps = watch.steps.into_iter().map(|step| step.reached(aim, opened)).collect();
    let film = matches!(aim, Aim::Picture).then_some(film);
    Ok(Measured { link: linked, compile, steps, texels, seconds, film })
}

/// A number of samples that a run under way has reached.
struct Step {
    spp: u64,
    seconds: f64,
    device_seconds: Option<f64>,
    look: Option<Look>,
}

impl Step {
    fn reached(self, aim: Aim<'_>, opened: &Opened) -> Reached {
        let Self { spp, seconds, device_seconds, look } = self;
        let errors = match (aim, look) {
            (Aim::Errors(reference), Some(look)) => {
                Some(Errors::new(&look, &reference.rows, opened))
            }
            _ => None,
        };
        Reached { spp, seconds, device_seconds, errors }
    }
}

/// Abandons a rendering after a time, unless what is returned is dropped before. Where each pixel takes seconds for its
/// first texels, nobody else is asked meanwhile.
fn abandon_after(pace: &Arc<Pace>, seconds: f64) -> Sender<()> {
    let (guard, dropped) = channel::<()>();
    let pace = Arc::clone(pace);
    let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    std::thread::spawn(move || {
        if dropped.recv_timeout(time) == Err(RecvTimeoutError::Timeout) {
            pace.abandon(true);
        }
    });
    guard
}

/// Watches a run: its time is that of rendering, without looks at errors.
struct Watch<'a> {
    limits: &'a Limits,
    aim: Aim<'a>,
    is_sum: bool,
    start: Instant,
    paused: Duration,
    /// When the film was asked for last, and the time of rendering then.
    asked: Option<(Instant, f64)>,
    /// What the device's clock said before.
    device_start: Option<f64>,
    steps: Vec<Step>,
}

impl Watch<'_> {
    fn seconds(&self) -> f64 {
        (self.start.elapsed() - self.paused).as_secs_f64()
    }

    fn on_device(&self, now: Option<f64>) -> Option<f64> {
        Some(now? - self.device_start?)
    }

    fn look(&self, film: &Film) -> Option<Look> {
        matches!(self.aim, Aim::Errors(_)).then(|| Look::new(film))
    }

    fn see(&mut self, progress: &Progress<'_>) -> Wish {
        let seconds = self.seconds();
        let Some(film) = progress.film else {
            let enough = match (self.aim, self.steps.is_empty()) {
                (Aim::Picture, _) => seconds >= self.limits.time,
                (_, true) => seconds >= PATIENCE * self.limits.time,
                (_, false) => false,
            };
            // A sum has one step, its end; a picture is looked at once.
            let looks = !self.is_sum && !matches!(self.aim, Aim::Picture);
            self.asked = Some((Instant::now(), seconds));
            return match (enough, progress.doubling && looks) {
                (true, _) => Wish::Finish,
                (false, true) => Wish::Look,
                (false, false) => Wish::GoOn,
            };
        };
        let done = progress.done;
        if !(progress.doubling || done == progress.of) || self.is_sum {
            return Wish::GoOn;
        }
        // Neither reading the film back nor looking at it is rendering.
        let (asked, seconds) = self.asked.unwrap_or((Instant::now(), seconds));
        let look = self.look(film);
        self.paused += asked.elapsed();
        let device_seconds = self.on_device(progress.device_seconds);
        // Where loops were cut shorter, the rendering began anew.
        self.steps.retain(|step| step.spp < done);
        self.steps.push(Step { spp: done, seconds, device_seconds, look });
        let next = (2 * done).min(progress.of);
        let enough = match self.aim {
            Aim::Times(samples) => done >= samples,
            _ => done == next || seconds * next as f64 / done as f64 > self.limits.time,
        };
        if enough { Wish::Finish } else { Wish::GoOn }
    }
}
