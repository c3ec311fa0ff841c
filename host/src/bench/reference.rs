//! A case's reference: a sum over texels that samples agree with, or two kinds of samples that agree; kept under a hash
//! of all that it depends on.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use sha2::{Digest, Sha256};

use super::cache;
use super::case::{Opened, radiance};
use crate::exec::Executor;
use crate::file;
use crate::link::{View, link};
use crate::measure::agreement::{Agreement, Finding, places};
use crate::native::{self, Native};
use crate::picture::{self, Picture};
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::render::{Effort, Ended, Film, HEADLESS_BUDGET, Sampler, Wish, estimate, render};
use crate::session::Chosen;

/// The integrator that adds up the light of every texel, and how exactly: its actual error is far below.
const BY: &str = "convolution";
const TOLERANCE: &str = "tolerance=1e-3";

/// Texels of all pixels that it has time for; of larger scenes two kinds of samples agree.
const MOST_TEXELS: u64 = 1 << 25;

/// The integrators whose samples are held against each other, and how many of them a pixel has: at the most, and as
/// long as all pixels together have no more than that many.
const SAMPLERS: [(&str, u32); 2] = [("mis-balance", 1 << 16), ("product", 1 << 13)];
const MOST_SAMPLES: [u64; 2] = [1 << 28, 1 << 25];

/// The one whose samples a sum is held against, and how many of them a pixel has.
const AGAINST: &str = SAMPLERS[0].0;
const SAMPLES: u32 = 4096;

/// How many times as many on a device with many lanes: what is measured there has more samples, too.
const WIDE: u64 = 64;
const REPLICATES: u32 = 32;

/// Seed of their points: none that somebody would choose, so that they are others than those that are measured.
const SEED: u32 = 0x9e37_79b9;

/// What the sentence and the reference's own relMSE are called in the header.
const SENTENCE: &str = "brdf.reference";
const FLOOR: &str = "brdf.reference_relmse";

/// A reference of one case.
pub(super) struct Reference {
    /// The hash of all that it depends on.
    pub(super) hash: String,
    /// Radiance of every shading point.
    pub(super) rows: Vec<[f32; 3]>,
    /// How it was made, and what samples say of it.
    pub(super) said: String,
    /// Its own relMSE, estimated: no error is told apart from less.
    pub(super) floor: f64,
}

/// The reference of a case, from `store` where it is there, else made and kept there.
///
/// # Errors
/// Where it cannot be made, or was stopped by `go_on`.
pub(super) fn provide(
    registry: &Registry,
    executor: &mut dyn Executor,
    opened: &Opened,
    store: Option<&Path>,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Reference> {
    let counts = counts(opened.points().len(), executor);
    let hash = hash(registry, opened, counts)?;
    let path = store.map(|folder| folder.join(format!("{hash}.exr")));
    if let Some(known) = path.as_ref().and_then(|path| read(path, &hash, opened)) {
        return Ok(known);
    }
    let (finding, made) = match opened.texels() <= MOST_TEXELS {
        true => by_sum(registry, executor, opened, go_on)?,
        false => by_samples(registry, executor, opened, counts, go_on)?,
    };
    // One that is doubted is made anew the next time.
    if let Some(path) = path.filter(|_| finding != Finding::Disagrees) {
        keep(&path, opened, &made)?;
    }
    let Made { rows, said, floor } = made;
    Ok(Reference { hash, rows, said, floor })
}

/// Radiance, a sentence on the two ways to it, and its own relMSE.
struct Made {
    rows: Vec<[f32; 3]>,
    said: String,
    floor: f64,
}

/// Every texel, held against samples.
fn by_sum(
    registry: &Registry,
    executor: &mut dyn Executor,
    opened: &Opened,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<(Finding, Made)> {
    let by = sum(registry)?;
    let film = film(executor, opened, &by, Effort::new(1, 1), go_on)?;
    let samples = samples(registry, executor, opened, (AGAINST, SAMPLES), go_on)?;
    let own = estimate(&film).quadrature.unwrap_or_default();
    let (finding, beside) = beside(
        opened,
        |row| film.mean(row),
        |row, replicate| samples.replicate_mean(row, replicate),
    );
    let finding = if film.nonfinite() > 0 { Finding::Disagrees } else { finding };
    let said = format!(
        "by {BY}, its own error {own:.0e} of it, {} {SAMPLES} samples of {AGAINST}{beside}",
        word(finding)
    );
    Ok((finding, Made { rows: radiance(&film), said, floor: own * own }))
}

/// Two kinds of samples, which have to agree; the mean of both.
fn by_samples(
    registry: &Registry,
    executor: &mut dyn Executor,
    opened: &Opened,
    [one, other]: Counts,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<(Finding, Made)> {
    let first = samples(registry, executor, opened, one, go_on)?;
    let second = samples(registry, executor, opened, other, go_on)?;
    // The spread of the differences holds the noise of both.
    let (finding, beside) = beside(
        opened,
        |row| second.mean(row),
        |row, replicate| {
            let (a, b) =
                (first.replicate_mean(row, replicate), second.replicate_mean(row, replicate));
            let mean = second.mean(row);
            std::array::from_fn(|channel| a[channel] - b[channel] + mean[channel])
        },
    );
    // Weighed by the variance that each tells of itself.
    let errors = [&first, &second].map(|film| estimate(film).relmse.unwrap_or(1.0).max(1e-30));
    let part = errors[1] / (errors[0] + errors[1]);
    let mixed = |(a, b): ([f64; 3], [f64; 3])| {
        let mix = |channel: usize| part * a[channel] + (1.0 - part) * b[channel];
        std::array::from_fn(|channel| mix(channel) as f32)
    };
    let own = errors[0] * errors[1] / (errors[0] + errors[1]);
    let said = format!(
        "by {} samples of {}, its own relMSE about {own:.0e}, {} {} of {}{beside}",
        one.1,
        one.0,
        word(finding),
        other.1,
        other.0,
    );
    let rows = std::iter::zip(first.means(), second.means()).map(mixed).collect();
    Ok((finding, Made { rows, said, floor: own }))
}

/// The samplers, with the samples that a pixel has.
type Counts = [(&'static str, u32); 2];

/// Those for so many pixels.
fn counts(pixels: usize, executor: &dyn Executor) -> Counts {
    let wide = if executor.limits().parallel > 1 { WIDE } else { 1 };
    let bound = |index: usize| (wide * MOST_SAMPLES[index] / pixels.max(1) as u64).max(1).ilog2();
    std::array::from_fn(|index| {
        let (id, most) = SAMPLERS[index];
        (id, most.min(1 << bound(index)).max(4 * REPLICATES))
    })
}

fn word(finding: Finding) -> &'static str {
    match finding {
        Finding::Agrees => "agrees with",
        Finding::Disagrees => "DISAGREES with",
        Finding::Undecided => "undecided beside",
    }
}

/// The integrator of sums.
fn sum(registry: &Registry) -> Result<Chosen> {
    let mut integrator = Chosen::find(registry, Kind::Integrator, BY)?;
    let Chosen { configured, .. } = &mut integrator;
    configured.values.set_text(&configured.plugin.manifest, TOLERANCE)?;
    Ok(integrator)
}

/// The hash of all that it depends on: the programs that make it and are held against it, their numbers and files, how
/// much of it there is, the map and the points.
fn hash(registry: &Registry, opened: &Opened, counts: Counts) -> Result<String> {
    let brdf = &opened.case.scene.brdf;
    let form = opened.stage().form(Sampler::default());
    let mut hash = Sha256::new();
    hash.update(format!("{SEED} {REPLICATES} {counts:?} {AGAINST} {SAMPLES} {MOST_TEXELS}\n"));
    let mut makers = vec![sum(registry)?];
    for (id, _) in SAMPLERS {
        makers.push(Chosen::find(registry, Kind::Integrator, id)?);
    }
    for by in &makers {
        let program = link(&View::Film {
            brdf: brdf.configured.clone(),
            integrator: by.configured.clone(),
            form,
        })?;
        hash.update(&program.reached.text);
    }
    for chosen in makers.iter().chain([brdf]) {
        for (key, value) in chosen.configured.values.iter() {
            hash.update(format!("{key}={}\n", value.to_toml()));
        }
    }
    let Configured { plugin, values, .. } = &brdf.configured;
    let library = plugin.native.as_ref().and_then(Native::own_file);
    for file in native::files(&plugin.manifest, values).into_iter().chain(library) {
        hash.update(&file::read(&file, "check the path")?);
    }
    opened.feed(|bytes| hash.update(bytes));
    Ok(hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect())
}

fn read(path: &Path, hash: &str, opened: &Opened) -> Option<Reference> {
    let said = picture::read_fact(path, SENTENCE).ok()??;
    let stored = picture::read::read(path).ok()?;
    if stored.resolution != opened.case.scene.film.resolution {
        return None;
    }
    let rows = opened.points().iter().map(|point| stored.rgb.get(point.pixel as usize).copied());
    let floor = picture::read_fact(path, FLOOR).ok()??.parse().ok()?;
    Some(Reference { hash: hash.to_owned(), rows: rows.collect::<Option<_>>()?, said, floor })
}

fn keep(path: &Path, opened: &Opened, made: &Made) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    picture::make_folder(folder, "name another folder with --references")?;
    let resolution = opened.case.scene.film.resolution;
    let rgb = opened.in_picture(made.rows.iter().copied(), [0.0; 3]);
    let coverage = opened.in_picture(made.rows.iter().map(|_| 1.0), 0.0);
    let picture = Picture { resolution, rgb, coverage, std_error: None };
    let facts =
        [(SENTENCE.to_owned(), made.said.clone()), (FLOOR.to_owned(), made.floor.to_string())];
    picture::stage_exr(path, &picture, &opened.case.scene.to_toml(), &facts)?.keep()
}

/// Samples whose number is fixed beforehand, so that it is not chosen by what they say; other points than those that are
/// measured later.
fn samples(
    registry: &Registry,
    executor: &mut dyn Executor,
    opened: &Opened,
    (id, count): (&str, u32),
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Film> {
    let by = Chosen::find(registry, Kind::Integrator, id)?;
    // Of other points than each other, too.
    let effort = Effort { replicates: REPLICATES, seed: SEED ^ count, ..Effort::new(count, 1) };
    film(executor, opened, &by, effort, go_on)
}

/// A film, to its end.
fn film(
    executor: &mut dyn Executor,
    opened: &Opened,
    by: &Chosen,
    effort: Effort,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Film> {
    let brdf = &opened.case.scene.brdf.configured;
    let mut stage = opened.stage();
    let program = Arc::new(link(&View::Film {
        brdf: brdf.clone(),
        integrator: by.configured.clone(),
        form: stage.form(Sampler::default()),
    })?);
    let plugins = [brdf, &by.configured];
    let rendered =
        render(executor, &mut stage, &program, &plugins, effort, HEADLESS_BUDGET, &mut |at| {
            match go_on(at.done as f64 / at.of.max(1) as f64) {
                true => Wish::GoOn,
                false => Wish::Abandon,
            }
        });
    stage.unload(executor);
    let rendered = rendered?;
    match rendered.ended {
        Ended::Complete => Ok(rendered.film),
        Ended::Early | Ended::Abandoned => Err(Problem::new(
            format!("the reference of {}", opened.case.name),
            "it was stopped before its end",
            "let it finish; it is kept for the next time",
        )),
    }
}

/// What samples say of radiance, and how far it is from them.
fn beside(
    opened: &Opened,
    reference: impl Fn(usize) -> [f64; 3] + Sync,
    samples: impl Fn(usize, usize) -> [f64; 3] + Sync,
) -> (Finding, String) {
    let resolution = opened.case.scene.film.resolution;
    let places = places(opened.points().iter().map(|point| point.pixel), resolution);
    let found = Agreement::new(&places, reference, samples, REPLICATES as usize);
    let Some(agreement) = found else {
        return (Finding::Undecided, ": too few pixels".to_owned());
    };
    let worst = agreement.worst_channel();
    let doubt = agreement.doubt.as_ref().map(|doubt| format!(", {doubt}")).unwrap_or_default();
    let said = format!(
        "{doubt}: mean off by {:.0e} of it (z {:.1}), worst of {} tiles by {:.0e}",
        worst.off(),
        worst.z(),
        agreement.tiles,
        agreement.worst_tile.off(),
    );
    (agreement.finding, said)
}

/// Where references are kept where nobody names a folder.
pub(super) fn usual_store() -> Option<PathBuf> {
    Some(cache()?.join("references"))
}
