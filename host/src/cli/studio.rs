//! A device with a scene on it, and the pictures that are made there.

use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::{ParamValues, Result};
use indicatif::{ProgressBar, ProgressStyle};

use super::machine::Machine;
use super::reference::Check;
use super::report::{Report, Seconds, SumReport, sampling_word};
use super::{interrupt, print};
use crate::exec::{Executor, Opened};
use crate::layout::word;
use crate::link::{Program, View, link};
use crate::open::{self, Scene};
use crate::picture::{self, Picture};
use crate::registry::Registry;
use crate::render::{
    Effort, Ended, HEADLESS_BUDGET, Progress, Reason, Rendered, Stage, Stopping, Wish, background,
    estimate, render,
};
use crate::scene::Coverage;
use crate::session::{Background, Session};

#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    machine: Machine,
    /// Print one JSON object a picture
    #[arg(long)]
    pub(super) json: bool,
}

/// The device and the scene on it: made once, used for every picture.
pub(super) struct Studio {
    executor: Box<dyn Executor>,
    coverage: Coverage,
    stage: Stage,
    background: Vec<[f32; 3]>,
    notes: Vec<String>,
    setup: Duration,
    json: bool,
    machine: Machine,
    /// Notes that were printed with the last picture.
    told: Vec<String>,
}

/// A film that was made in the studio, and how.
pub(super) struct Made {
    /// Linking.
    pub link: Duration,
    /// The film and its times.
    pub rendered: Rendered,
    /// What ended it.
    pub stopped: Reason,
    program: Arc<Program>,
}

impl Made {
    /// Whether less was done than was asked for.
    pub(super) fn unfinished(&self) -> bool {
        let sum = self.rendered.film.quadrature().is_some();
        self.rendered.ended == Ended::Early && (sum || self.stopped == Reason::Interrupted)
    }
}

impl Studio {
    pub(super) fn open(registry: &Registry, options: &Options, session: &Session) -> Result<Self> {
        let start = Instant::now();
        let scene = Scene::open(registry, session)?;
        let environment = &scene.environment;
        let mut notes = environment.notes.clone();
        notes.push(format!(
            "{} is {}x{} texels, ready in {:.3} s",
            environment.name, environment.width, environment.height, environment.seconds
        ));
        notes.extend(open::shape_note(&session.shape, &scene.shape));
        if scene.coverage.points.is_empty() {
            notes.push("the object covers no pixel: look at --camera and --shape".to_owned());
        }
        let Opened { mut executor, note } = options.machine.open()?;
        notes.extend(note);
        let mut stage = scene.stage();
        let coverage = scene.coverage;
        let background = match session.film.background {
            Background::Black => Vec::new(),
            Background::Env => background::background(
                executor.as_mut(),
                &mut stage,
                &coverage.rays_past(&session.camera, session.film.resolution),
            )?,
        };
        let setup = start.elapsed();
        Ok(Self {
            executor,
            coverage,
            stage,
            background,
            notes,
            setup,
            json: options.json,
            machine: options.machine.clone(),
            told: Vec::new(),
        })
    }

    /// Links, renders, writes and reports one picture; `observe` may end it, and then nothing is written.
    pub(super) fn picture(
        &mut self,
        session: &Session,
        export: &Path,
        observe: &mut dyn FnMut(&Progress<'_>) -> Wish,
    ) -> Result<Made> {
        let made = self.make(session, observe)?;
        if made.rendered.ended != Ended::Abandoned {
            self.write(session, export, &made, None)?;
        }
        Ok(made)
    }

    /// Links the scene's plugins.
    pub(super) fn link(&self, session: &Session) -> Result<Program> {
        link(&View::Film {
            brdf: session.brdf.configured.clone(),
            integrator: session.integrator.configured.clone(),
            form: self.stage.form(session.sampler),
        })
    }

    /// Links and renders; `observe` may end it.
    pub(super) fn make(
        &mut self,
        session: &Session,
        observe: &mut dyn FnMut(&Progress<'_>) -> Wish,
    ) -> Result<Made> {
        if self.executor.is_gone() {
            self.executor = self.machine.open()?.executor;
            self.stage.forget();
        }
        let start = Instant::now();
        let program = Arc::new(self.link(session)?);
        let link = start.elapsed();
        let bar = progress_bar(1000);
        let mut stopping = Stopping::new(session.stop);
        let rendered = render(
            self.executor.as_mut(),
            &mut self.stage,
            &program,
            &[&session.brdf.configured, &session.integrator.configured],
            Effort { doublings: session.stop.error.is_some(), ..session.effort },
            HEADLESS_BUDGET,
            &mut |progress| {
                bar.set_position((stopping.part(&progress) * 1000.0) as u64);
                match observe(&progress) {
                    Wish::GoOn => stopping.wish(&progress, interrupt::asked()),
                    other => other,
                }
            },
        );
        bar.finish_and_clear();
        Ok(Made { link, rendered: rendered?, stopped: stopping.reason, program })
    }

    /// The pixels that the object covers, in the order of the film's rows.
    pub(super) fn pixels(&self) -> impl Iterator<Item = u32> {
        self.coverage.points.iter().map(|point| point.pixel)
    }

    /// Writes a picture and reports it; `check` is what a reference was held against.
    pub(super) fn write(
        &mut self,
        session: &Session,
        export: &Path,
        made: &Made,
        check: Option<Check>,
    ) -> Result<()> {
        let Made { link, rendered, stopped, program } = made;
        let setup = self.setup + *link;
        let exr = picture::with_ending(export, "exr");
        let png = picture::with_ending(export, "png");
        let film = &rendered.film;
        let sum = film.quadrature();
        let spp = if sum.is_some() { 0 } else { film.samples() };
        let each = sum.map_or(spp, |sum| sum.terms[0].into());
        let samples = each as f64 * self.coverage.points.len() as f64;
        let unfinished = made.unfinished();
        let notes: Vec<String> =
            self.notes.iter().chain(&program.notes).chain(&rendered.notes).cloned().collect();
        let found = estimate(film);
        let (id, name) = (&session.brdf.configured.plugin.id, session.brdf.name());
        let report = Report {
            brdf: id.clone(),
            title: if name == id { id.clone() } else { format!("{name} ({id})") },
            brdf_params: as_json(&session.brdf.configured.values),
            integrator: session.integrator.configured.plugin.id.clone(),
            integrator_params: as_json(&session.integrator.configured.values),
            sampling: sampling_word(program.sampling),
            environment: session.environment.map.clone(),
            shape: session.shape.clone(),
            device: self.executor.name().to_owned(),
            resolution: session.film.resolution,
            covered_pixels: self.coverage.points.len(),
            bent_normals: self.coverage.bent,
            samples: session.effort.samples,
            passes: session.effort.passes,
            spp,
            replicates: session.effort.replicates,
            sampler: word(&session.sampler),
            filter: word(&session.environment.lighting.filter),
            sum: sum.map(|sum| SumReport {
                texels: sum.terms[0],
                of: sum.terms[1],
                evaluations: sum.evaluations,
                error: found.quadrature,
            }),
            stopped: stopped.word(),
            unfinished,
            biased: unfinished && sum.is_some(),
            seed: session.effort.seed,
            seconds: Seconds {
                setup: setup.as_secs_f64(),
                compile: rendered.compile.as_secs_f64(),
                render: rendered.render.as_secs_f64(),
            },
            msamples_per_s: samples / rendered.render.as_secs_f64().max(1e-9) / 1e6,
            mean: found.mean,
            mean_std_error: found.mean_std_error,
            std_error: found.std_error,
            relmse_estimate: found.relmse,
            largest_replicate_share: found.largest_share,
            nonfinite: film.nonfinite(),
            nonfinite_pixels: film.nonfinite_pixels(),
            notes,
            reference: check.as_ref().map(Check::sentence),
            check,
            exr: exr.display().to_string(),
            png: png.display().to_string(),
        };
        let resolution = session.film.resolution;
        let picture = Picture::compose(resolution, &self.coverage.points, film, &self.background);
        let staged = [
            picture::stage_exr(&exr, &picture, &session.to_toml(), &report.facts())?,
            picture::stage_png(&png, &picture, session.film.tone)?,
        ];
        staged.into_iter().try_for_each(picture::Staged::keep)?;
        if self.json {
            return print(&format!("{}\n", report.json()));
        }
        for note in report.notes.iter().filter(|note| !self.told.contains(note)) {
            eprintln!("note: {note}");
        }
        self.told = report.notes.clone();
        print(&report.text())
    }
}

fn as_json(values: &ParamValues) -> serde_json::Map<String, serde_json::Value> {
    use brdf_sdk::ParamValue;
    let json = |value: &ParamValue| match value {
        ParamValue::Float(number) => (*number).into(),
        ParamValue::Int(number) => (*number).into(),
        ParamValue::Bool(value) => (*value).into(),
        ParamValue::Color(rgb) => rgb.to_vec().into(),
        ParamValue::Choice(text) | ParamValue::File(text) => text.clone().into(),
    };
    values.iter().map(|(key, value)| (key.to_owned(), json(value))).collect()
}

/// A bar on a terminal, nothing on a pipe.
pub(super) fn progress_bar(length: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of about {duration}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
