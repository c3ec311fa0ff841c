//! The law of the furnace: under light of radiance 1 from everywhere, every integrator shows the directional
//! albedo, at each pixel that of its own `wo`.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DMat3;

use super::integrals::Integral;
use super::settings::options;
use super::survey::Surveyor;
use super::values::row;
use super::verdict::{LEVEL, Law, Outcome, Verdict};
use crate::environment::Environment;
use crate::exec::Executor;
use crate::link::{Sampler, View, link};
use crate::measure::student;
use crate::plugin::Configured;
use crate::render::{Effort, Film, HEADLESS_BUDGET, Progress, Stage, Wish, render};
use crate::scene::{Camera, Shape, cast};

/// Pixels along a side of the picture.
const SIDE: u32 = 12;
/// Texels of the furnace: in one that fills half of the sphere a sum over texels looks for narrow lobes long.
const MAP: [u32; 2] = [32, 16];
/// Samples a pixel.
const SAMPLES: u32 = 1024;
/// What fails must fail again with this many others: means of few points have tails that Student's t does
/// not know.
const AGAIN: u32 = 4 * SAMPLES;
/// Samples of a lobe in each replicate after which their spread is believed.
const ENOUGH: f64 = 16.0;
/// Whose error is a larger part of the albedo than this has shown nothing.
const LOOSE: f64 = 0.25;
/// Relative error of the quadrature.
const EXACT: f64 = 1e-4;
/// What f32, quadrature and `convolution`'s own tolerance may put between the two.
const FLOOR: f64 = 1e-3;

/// Judges it for all integrators.
pub fn judge(
    executor: &mut dyn Executor,
    brdf: &Configured,
    integrators: &[Configured],
) -> Result<Verdict> {
    let points = cast(&Camera::default(), &Shape::Sphere, [SIDE, SIDE]).points;
    let views: Vec<[f32; 3]> = points.iter().map(|point| point.wo).collect();
    let mut surveyor = Surveyor::new(executor, brdf)?;
    let found = surveyor.albedos(executor, brdf, &views, EXACT)?;
    surveyor.free(executor);
    if let Some(index) = found.iter().position(|integrals| integrals.broken.is_some()) {
        let said = "f is Inf or NaN where it is integrated";
        let at = format!("wo {}{}", row(views[index]), options(brdf));
        return Ok(Verdict::new(Law::Furnace, Outcome::Failed, said).shown_by(at));
    }
    let expected: Vec<Expected> = found.iter().map(|found| Expected::of(&found.total())).collect();
    // Each pixel, and the whole picture.
    let tests = ((points.len() + 1) * 3 * integrators.len().max(1)) as f64;
    let mut worst: Option<(f64, String, Option<String>)> = None;
    let mut told = Vec::new();
    let mut judged = 0;
    for integrator in integrators {
        let id = &integrator.plugin.id;
        let mut look = |samples, seed| {
            let effort = Effort { seed, ..Effort::new(samples, 1) };
            picture(executor, brdf, integrator, points.clone(), effort)
        };
        let Some(mut shown) = look(SAMPLES, 0)? else {
            told.push(format!("{id} looks at no environment"));
            continue;
        };
        judged += 1;
        let nonfinite = shown.film.nonfinite();
        if nonfinite > 0 {
            let said = format!("{nonfinite} samples of {id} are Inf or NaN");
            let verdict = Verdict::new(Law::Furnace, Outcome::Failed, said);
            return Ok(verdict.shown_by(format!("brdf conform BRDF --law finite{}", options(brdf))));
        }
        let replicates = shown.film.replicates() as u32;
        let freedom = (replicates > 1).then(|| replicates - 1);
        let quantile = freedom.map_or(0.0, |n| student::quantile(student::sidak(LEVEL, tests), n));
        let mut farthest = farthest(&shown, &expected, quantile, |_| true);
        if farthest.excess > 1.0
            && let Some(again) = look(AGAIN, 1)?
        {
            let first = std::mem::replace(&mut shown, again);
            let failed = |at: &Pixel| excess(&first, at, &expected, quantile) > 1.0;
            let excess = farthest.excess;
            farthest = self::farthest(&shown, &expected, quantile, failed);
            if farthest.excess <= 1.0 {
                told.push(format!("{id}: {excess:.2}, not again in {AGAIN} other samples a pixel"));
            }
        }
        let Farthest { excess, at } = farthest;
        let seen = shown.film.mean(at.row)[at.channel];
        let is = expected[at.row].albedo[at.channel];
        let mut said = format!("{id} shows {seen:.5} where the albedo is {is:.5}");
        let mut reproduce = (excess > 1.0)
            .then(|| format!("wo {}{} under {id}", row(views[at.row]), options(brdf)));
        let mut excess = excess;
        // What is off at every pixel by less than its noise is seen of all together.
        let mut whole = whole(&shown, &expected, quantile);
        if whole.excess > 1.0
            && farthest.excess <= 1.0
            && let Some(again) = look(AGAIN, 2)?
        {
            whole = self::whole(&again, &expected, quantile);
        }
        if whole.allowed > LOOSE * whole.is {
            told.push(format!(
                "{id} is too noisy to tell: {:.5} of {:.5} is within the error",
                whole.allowed, whole.is
            ));
        }
        if whole.excess > excess {
            let Whole { seen, is, .. } = whole;
            excess = whole.excess;
            said = format!(
                "{id} shows {seen:.5} where the albedo is {is:.5}, in the mean of all pixels"
            );
            reproduce = (excess > 1.0).then(|| format!("all pixels{} under {id}", options(brdf)));
        }
        if worst.as_ref().is_none_or(|(most, ..)| excess > *most) {
            worst = Some((excess, said, reproduce));
        }
    }
    let Some((excess, said, reproduce)) = worst else {
        return Ok(Verdict::new(Law::Furnace, Outcome::Skipped, "there is no integrator"));
    };
    let outcome = super::verdict::outcome(excess <= 1.0);
    let said = match outcome {
        Outcome::Passed => {
            format!("{judged} integrators show the albedo at {} pixels", points.len())
        }
        _ => said,
    };
    let cases = points.len() * 3 * judged;
    let verdict = Verdict::new(Law::Furnace, outcome, said).with(excess, 1.0, cases);
    Ok(Verdict { reproduce, notes: told, ..verdict })
}

/// What is known of a pixel by quadrature, per channel.
struct Expected {
    albedo: [f64; 3],
    /// The variance of one sample of who does not ask the BRDF where its light is: by the cosine or by solid angle,
    /// the larger. Few samples meet a narrow lobe, and those that miss it do not tell how much they vary.
    blind: [f64; 3],
}

impl Expected {
    fn of(total: &Integral) -> Self {
        let blind = |channel: usize| {
            let second_moment = total.cosine[channel].max(total.uniform[channel]);
            (second_moment - total.light[channel].powi(2)).max(0.0)
        };
        Self { albedo: total.light, blind: [0, 1, 2].map(blind) }
    }
}

/// What an integrator shows.
struct Picture {
    film: Film,
    /// Whether it asks the BRDF for directions, or sums over all of them.
    asks: bool,
}

impl Picture {
    /// The variance of the mean over some pixels, known by quadrature, where the replicates' spread may not show it;
    /// 0 where it does: the integrator knows where light comes from, or each replicate has met enough of it.
    fn unseen_variance<'a>(
        &self,
        pixels: impl Iterator<Item = &'a Expected>,
        channel: usize,
    ) -> f64 {
        let (mut count, mut sum, mut variance) = (0.0, 0.0, 0.0);
        for pixel in pixels {
            count += 1.0;
            sum += pixel.albedo[channel];
            variance += pixel.blind[channel];
        }
        let samples = self.film.samples() as f64;
        // Samples of a lobe that returns as much as it does and varies as much.
        let met = samples / self.film.replicates() as f64 * sum * sum / variance;
        match self.asks || met >= ENOUGH || variance == 0.0 {
            true => 0.0,
            false => variance / (samples * count * count),
        }
    }
}

/// A pixel and one of its channels.
#[derive(Clone, Copy)]
struct Pixel {
    row: usize,
    channel: usize,
}

/// Where a picture is farthest from the albedo.
struct Farthest {
    /// In units of what is allowed.
    excess: f64,
    at: Pixel,
}

fn farthest(
    shown: &Picture,
    expected: &[Expected],
    quantile: f64,
    counts: impl Fn(&Pixel) -> bool,
) -> Farthest {
    let all = (0..expected.len()).flat_map(|row| (0..3).map(move |channel| Pixel { row, channel }));
    let none = Farthest { excess: 0.0, at: Pixel { row: 0, channel: 0 } };
    all.filter(counts).fold(none, |most, at| match excess(shown, &at, expected, quantile) {
        excess if excess > most.excess => Farthest { excess, at },
        _ => most,
    })
}

/// The picture as one.
struct Whole {
    /// In units of what is allowed.
    excess: f64,
    allowed: f64,
    seen: f64,
    is: f64,
}

/// The channel whose mean over all pixels is farthest from that of the albedos. Its error is the spread of the
/// replicates' means, however their pixels hang together.
fn whole(shown: &Picture, expected: &[Expected], quantile: f64) -> Whole {
    let film = &shown.film;
    let pixels = expected.len().max(1) as f64;
    let channels = (0..3).map(|channel| {
        let mean = |replicate| {
            let rows = 0..expected.len();
            rows.map(|row| film.replicate_mean(row, replicate)[channel]).sum::<f64>() / pixels
        };
        let means: Vec<f64> = (0..film.replicates()).map(mean).collect();
        let count = means.len() as f64;
        let seen = means.iter().sum::<f64>() / count;
        let spread = means.iter().map(|mean| (mean - seen).powi(2)).sum::<f64>();
        let error = if means.len() > 1 { (spread / (count * (count - 1.0))).sqrt() } else { 0.0 };
        let is = expected.iter().map(|pixel| pixel.albedo[channel]).sum::<f64>() / pixels;
        let error = error.max(shown.unseen_variance(expected.iter(), channel).sqrt());
        let allowed = (quantile * error).max(FLOOR * is.max(1e-6));
        let off = (seen - is).abs();
        let excess = if off.is_finite() { off / allowed } else { f64::INFINITY };
        Whole { excess, allowed, seen, is }
    });
    let none = Whole { excess: 0.0, allowed: 0.0, seen: 0.0, is: 0.0 };
    channels.fold(none, |most, one| if one.excess > most.excess { one } else { most })
}

/// How far a pixel is from its albedo, in units of what is allowed.
fn excess(shown: &Picture, at: &Pixel, expected: &[Expected], quantile: f64) -> f64 {
    let albedo = expected[at.row].albedo[at.channel];
    let spread = shown.film.variance_of_mean(at.row).unwrap_or_default()[at.channel];
    let pixel = std::iter::once(&expected[at.row]);
    let error = spread.max(shown.unseen_variance(pixel, at.channel)).sqrt();
    let allowed = (quantile * error).max(FLOOR * albedo.max(1e-6));
    let off = (shown.film.mean(at.row)[at.channel] - albedo).abs();
    if off.is_finite() { off / allowed } else { f64::INFINITY }
}

/// The sphere in the furnace; `None` where the integrator does not look at the environment.
fn picture(
    executor: &mut dyn Executor,
    brdf: &Configured,
    integrator: &Configured,
    points: Vec<crate::scene::ShadingPoint>,
    effort: Effort,
) -> Result<Option<Picture>> {
    let [width, height] = MAP;
    let texels = Arc::new(vec![[1.0, 1.0, 1.0, 0.0]; (width * height) as usize]);
    let furnace = Arc::new(Environment { width, height, texels, ..Environment::constant(1.0) });
    let mut stage = Stage::new(points, furnace, DMat3::IDENTITY);
    let form = stage.form(Sampler::OwenSobol);
    let view = View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form };
    let program = Arc::new(link(&view)?);
    if !program.binds("env_map") {
        return Ok(None);
    }
    let plugins = [brdf, integrator];
    let mut go_on = |_: Progress<'_>| Wish::GoOn;
    let rendered =
        render(executor, &mut stage, &program, &plugins, effort, HEADLESS_BUDGET, &mut go_on)?;
    stage.unload(executor);
    let asks = program.samples_brdf() || program.sum.is_some();
    Ok(Some(Picture { film: rendered.film, asks }))
}
