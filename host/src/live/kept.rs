//! What the rendering thread keeps from order to order: the device, the map, the shape, the compiled program. An order
//! makes anew what it changes, and nothing else.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use brdf_sdk::{Problem, Result};

use super::frame::Timing;
use super::order::{Order, same_program};
use super::seen::Seen;
use super::{Doing, Shared, since};
use crate::environment::{Environment, orientation};
use crate::exec::{Executor, Opened, Precision, open};
use crate::link::{View, link};
use crate::open;
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::render::background::Backdrop;
use crate::render::{Effort, Lighting, Pace, Prepared, Sampler, Stage};
use crate::scene::Shape;
use crate::session::{Chosen, Light, Session};

/// Small pictures are this many times smaller along each side, and no smaller than `LEAST`.
const SHRINK: u32 = 4;
const LEAST: u32 = 64;

/// Samples of a pixel of a small picture.
pub(super) const QUICK_SAMPLES: u32 = 4;

/// The rendering thread's things.
pub(super) struct Kept {
    pub(super) registry: Registry,
    /// The integrator of small pictures where the own one is slow, as a sum over texels is: it has no picture before it
    /// is through.
    pub(super) by_samples: Chosen,
    pub(super) executor: Box<dyn Executor>,
    pub(super) light: Option<(Light, Arc<Environment>)>,
    pub(super) shape: Option<(String, Shape)>,
    pub(super) stage: Option<Stage>,
    pub(super) backdrop: Option<Backdrop>,
    pub(super) film: Option<Made>,
    /// The program of small pictures where the integrator is slow.
    pub(super) quick: Option<Made>,
    /// What is seen of small pictures, and of whole ones.
    pub(super) small: Option<Seen>,
    pub(super) whole: Option<Seen>,
    /// The last plugins that linked, compiled, and drew a picture.
    pub(super) good: Option<[Chosen; 2]>,
}

/// A program on the device, and what it was made of.
pub(super) struct Made {
    of: [Configured; 2],
    lighting: (Lighting, Sampler),
    pub(super) prepared: Prepared,
    /// Whether its small pictures take longer than somebody who moves something shall wait.
    pub(super) slow: bool,
}

/// The parts of a light that say which texels there are.
fn texels_of(light: &Light) -> Light {
    Light { phi: 0.0, theta: 0.0, lighting: Lighting::default(), ..light.clone() }
}

impl Kept {
    pub(super) fn open(
        registry: &Registry,
        device: Option<&str>,
    ) -> Result<(Self, Option<String>)> {
        let Opened { executor, note } = open_device(device)?;
        let kept = Self {
            registry: registry.clone(),
            by_samples: Chosen::by_samples(registry)?,
            executor,
            light: None,
            shape: None,
            stage: None,
            backdrop: None,
            film: None,
            quick: None,
            small: None,
            whole: None,
            good: None,
        };
        Ok((kept, note))
    }

    pub(super) fn device(&self) -> String {
        self.executor.name().to_owned()
    }

    pub(super) fn is_gone(&self) -> bool {
        self.executor.is_gone()
    }

    /// Draws an order, until it is finished or another one waits.
    pub(super) fn draw(&mut self, shared: &Shared, order: &Order) -> Result<()> {
        let start = Instant::now();
        let mut session = Arc::new(order.session.clone());
        shared.update(|status| status.doing = Doing::Loading);
        self.set_light(&session)?;
        self.set_shape(&session.shape)?;
        let map = self.light.as_ref().map(|(_, environment)| Arc::clone(environment));
        shared.update(|status| status.environment = map);
        shared.update(|status| status.doing = Doing::Compiling);

        let size = session.film.resolution.map(|side| (side / SHRINK).max(LEAST.min(side)));
        let seen = self.small.take();
        let mut small = self.cover(seen, &session, size)?;
        let mut looked = self.first_look(shared, &session, None, &mut small);
        if let Err(broken) = &looked
            && let Some(older) = self.good.as_ref().and_then(|good| with_older(&session, good))
        {
            // What worked before goes on, with the numbers as they are now; a finished picture of it stays as it is.
            if shared.has_finished(&older) {
                self.small = Some(small);
                return looked.map(|_| ());
            }
            session = Arc::new(older);
            looked = self.first_look(shared, &session, Some(broken.clone()), &mut small);
        }
        self.small = Some(small);
        let timing = looked?;
        if let Some([link, compile]) = timing {
            let first_pixel = match order.saved {
                Some(saved) => {
                    SystemTime::now().duration_since(saved).unwrap_or_default().as_secs_f64()
                }
                None => since(start),
            };
            shared.update(|status| {
                status.timing =
                    Some(Timing { link, compile, first_pixel, saved: order.saved.is_some() });
            });
        }
        // Whoever is moving something is answered by small pictures alone, which come the faster.
        if shared.is_moving() {
            return Ok(());
        }
        self.draw_whole(shared, &session)
    }

    /// The session's program and a small picture by it. Only what has drawn one counts as good: some loops end nowhere
    /// but on the device. Seconds as `set_program` has them.
    fn first_look(
        &mut self,
        shared: &Shared,
        session: &Arc<Session>,
        problem: Option<Problem>,
        small: &mut Seen,
    ) -> Result<Option<[f64; 2]>> {
        let timing = self.set_program(session, &shared.pace)?;
        shared.update(|status| {
            status.problem = problem;
            status.doing = Doing::Rendering;
        });
        shared.pace.hold(true);
        let drawn = self.draw_quickly(shared, session, QUICK_SAMPLES, small);
        shared.pace.hold(false);
        shared.picture_is_there();
        drawn?;
        self.good = Some([session.brdf.clone(), session.integrator.clone()]);
        Ok(timing)
    }

    /// The map, if another is named, and how it lies.
    fn set_light(&mut self, session: &Session) -> Result<()> {
        let light = &session.environment;
        let key = texels_of(light);
        if self.light.as_ref().is_none_or(|(known, _)| *known != key) {
            let environment = Arc::new(open::environment(&self.registry, light)?);
            self.drop_stage();
            self.light = Some((key, environment));
        }
        let world_from_map = orientation::world_from_map(light.phi, light.theta);
        if self.stage.as_ref().is_some_and(|stage| stage.lighting() != light.lighting) {
            self.drop_stage();
        }
        match (&mut self.stage, &self.light) {
            (Some(stage), _) => stage.turn(self.executor.as_mut(), world_from_map),
            (stage, Some((_, environment))) => {
                let fresh = Stage::new(Vec::new(), Arc::clone(environment), world_from_map);
                *stage = Some(fresh.lit(light.lighting));
            }
            (None, None) => {}
        }
        Ok(())
    }

    /// Takes the map off the device, and what was compiled for its layout.
    fn drop_stage(&mut self) {
        let executor = self.executor.as_mut();
        if let Some(mut stage) = self.stage.take() {
            stage.unload(executor);
        }
        self.backdrop.take().into_iter().for_each(|backdrop| backdrop.free(executor));
        for made in self.film.take().into_iter().chain(self.quick.take()) {
            made.prepared.free(executor);
        }
    }

    fn set_shape(&mut self, name: &str) -> Result<()> {
        if self.shape.as_ref().is_none_or(|(known, _)| known != name) {
            self.shape = Some((name.to_owned(), open::shape(name)?));
        }
        Ok(())
    }

    /// Has the session's program on the device; seconds of linking and compiling where it was not there.
    fn set_program(&mut self, session: &Session, pace: &Arc<Pace>) -> Result<Option<[f64; 2]>> {
        let Some(stage) = &mut self.stage else { return Ok(None) };
        let executor = self.executor.as_mut();
        let times = provide(executor, stage, &mut self.film, session, pace)?;
        let slow = self.film.as_ref().is_some_and(|made| made.slow);
        if slow {
            let session = Session { integrator: self.by_samples.clone(), ..session.clone() };
            provide(executor, stage, &mut self.quick, &session, pace)?;
        } else if let Some(old) = self.quick.take() {
            old.prepared.free(executor);
        }
        Ok(times)
    }
}

/// A named device; without a name the best one, and the cores where it does not open.
fn open_device(device: Option<&str>) -> Result<Opened> {
    let opened = open(device, Precision::F32);
    match (device, opened) {
        (None, Err(problem)) => {
            let cores = open(Some(crate::exec::CPU), Precision::F32)?;
            Ok(Opened { note: Some(format!("{problem}: running on the cores")), ..cores })
        }
        (_, opened) => opened,
    }
}

/// Has `session`'s program in `slot`, or its numbers in the one that is there.
fn provide(
    executor: &mut dyn Executor,
    stage: &mut Stage,
    slot: &mut Option<Made>,
    session: &Session,
    pace: &Arc<Pace>,
) -> Result<Option<[f64; 2]>> {
    let of = [&session.brdf.configured, &session.integrator.configured];
    let lighting = (session.environment.lighting, session.sampler);
    if let Some(made) = slot
        && made.lighting == lighting
        && std::iter::zip(&made.of, of).all(|(known, wanted)| same_program(known, wanted))
    {
        made.prepared.set_values(executor, &of)?;
        made.of = of.map(Clone::clone);
        return Ok(None);
    }
    let start = Instant::now();
    let view = View::Film {
        brdf: of[0].clone(),
        integrator: of[1].clone(),
        form: stage.form(session.sampler),
    };
    let program = Arc::new(link(&view)?);
    let linked = since(start);
    let start = Instant::now();
    let effort = Effort { replicates: 1, ..Effort::new(QUICK_SAMPLES, 1) };
    program.notes.iter().for_each(|note| executor.note(note.clone()));
    let prepared = Prepared::new(executor, stage, &program, &of, effort, Arc::clone(pace))?;
    let slow = program.sum.is_some();
    if let Some(old) = slot.replace(Made { of: of.map(Clone::clone), lighting, prepared, slow }) {
        old.prepared.free(executor);
    }
    Ok(Some([linked, since(start)]))
}

/// The session with the plugins that worked before, if they are these very ones in an older form; parameters keep
/// their values where the older form takes them.
fn with_older(session: &Session, good: &[Chosen; 2]) -> Option<Session> {
    let mut older = session.clone();
    for (slot, good) in [&mut older.brdf, &mut older.integrator].into_iter().zip(good) {
        if slot.reference != good.reference {
            continue;
        }
        let mut chosen = good.clone();
        chosen.configured.fit_sampler = slot.configured.fit_sampler;
        chosen.configured.take(slot.configured.values.iter());
        *slot = chosen;
    }
    (older != *session).then_some(older)
}
