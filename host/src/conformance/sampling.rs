//! The laws of sampling: draws follow their density, the mean of the weights is the albedo, and sampling
//! pays.

use std::fmt::Write as _;

use brdf_sdk::Result;
use serde::Serialize;

use super::cell::Chart;
use super::chi_square::{ChiSquare, chi_square, normal_tails};
use super::draws::{Draw, Tally};
use super::integrals::Integral;
use super::settings::{Setting, options};
use super::survey::{DRAWS, Survey, Surveyor};
use super::values::row;
use super::verdict::{LEVEL, Law, Outcome, Verdict, outcome};
use crate::exec::Executor;
use crate::measure::student::sidak;

/// A failure must show again in this many draws of other numbers.
pub(super) const AGAIN: usize = 4 * DRAWS;
/// This much of the hemisphere's mass may be missing or too much: f32 at the horizon.
pub(super) const MASS: f64 = 1e-5;
/// This much of the albedo may lie between mean and quadrature: weights in f32.
const ALBEDO: f64 = 2e-5;

/// Whose mass is off by this has a density that is wrong as a whole.
const FACTOR: f64 = 0.01;
/// Seeds of the draws that are counted, and of those that a failure has to show in again.
const SEED: u32 = 1;
const SEED_AGAIN: u32 = 2;

/// One test's probability.
#[derive(Debug, Clone, Copy)]
struct Test {
    p: f64,
    survey: usize,
    what: What,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    Cells,
    LargeCells,
    Mass,
    Channel(usize),
}

/// How much the weights vary at a view, against draws by the cosine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Angles of `wo` [degrees].
    pub view: [f64; 2],
    /// Relative standard deviation of one sample.
    pub own: f64,
    /// Variance over that of the cosine's.
    pub ratio: f64,
}

/// Looks at all settings and views, until the law of sampling fails plainly; also whether it came to the end.
/// Where `mean_ends`, a mean that is plainly wrong is the end too.
pub fn surveys(
    executor: &mut dyn Executor,
    surveyor: &mut Option<Surveyor>,
    settings: &[Setting],
    mean_ends: bool,
) -> Result<(Vec<Survey>, bool)> {
    let mut found = Vec::new();
    for (index, setting) in settings.iter().enumerate() {
        let at = Surveyor::at(executor, surveyor, &setting.brdf)?;
        for view in &setting.views {
            let seed = SEED + 16 * found.len() as u32;
            found.push(at.survey(executor, (index, setting), *view, seed)?);
        }
        // Who is plainly wrong need not wait for the rest.
        let mean_is_hopeless = mean_ends && found.iter().any(has_hopeless_mean);
        if mean_is_hopeless || found.iter().any(is_plainly_wrong) {
            return Ok((found, index + 1 == settings.len()));
        }
    }
    Ok((found, true))
}

/// A probability that no correction for the number of tests could save.
const HOPELESS: f64 = 1e-30;

/// Whether draws plainly do not follow their density.
fn is_plainly_wrong(survey: &Survey) -> bool {
    let tally = &survey.tally;
    survey.integrals.broken.is_some()
        || tally.nonfinite.is_some()
        || tally.without_pdf_count as f64 > MASS * tally.draws as f64
        || tests_of(0, survey).iter().any(|test| test.p < HOPELESS)
}

fn has_hopeless_mean(survey: &Survey) -> bool {
    means(0, survey).iter().any(|test| test.p < HOPELESS)
}

/// The law of sampling; also the survey at which it fails.
pub fn sampling(
    executor: &mut dyn Executor,
    surveyor: &mut Option<Surveyor>,
    settings: &[Setting],
    surveys: &[Survey],
) -> Result<(Verdict, Option<usize>)> {
    let shown = |survey: &Survey, draw: &Draw| {
        let at = shown_view(settings, survey);
        format!("{at}, u {}: wi {}", row(draw.u), row(draw.wi))
    };
    for (index, survey) in surveys.iter().enumerate() {
        if let Some(cell) = survey.integrals.broken {
            let said = "pdf or f is Inf or NaN where it is integrated";
            let near = row(Chart::of(survey.wo).middle(cell));
            let at = format!("{}, near wi {near}", shown_view(settings, survey));
            let verdict = Verdict::new(Law::Sampling, Outcome::Failed, said);
            return Ok((verdict.shown_by(at), Some(index)));
        }
        if let Some(draw) = &survey.tally.nonfinite {
            let said = "a draw has Inf or NaN in its direction, density or weight";
            let verdict = Verdict::new(Law::Sampling, Outcome::Failed, said);
            return Ok((verdict.shown_by(shown(survey, draw)), Some(index)));
        }
        // Rounding in f32 may take a few draws out of a density that ends.
        let count = survey.tally.without_pdf_count;
        if let Some(draw) = &survey.tally.without_pdf
            && count as f64 > MASS * survey.tally.draws as f64
        {
            let said = format!("{count} of {DRAWS} draws lie where pdf is 0");
            let verdict = Verdict::new(Law::Sampling, Outcome::Failed, said);
            return Ok((verdict.shown_by(shown(survey, draw)), Some(index)));
        }
    }
    let tests: Vec<Test> =
        surveys.iter().enumerate().flat_map(|(index, survey)| tests_of(index, survey)).collect();
    let level = sidak(LEVEL, tests.len() as f64);
    let mut verdict = Verdict::new(Law::Sampling, Outcome::Passed, "");
    let mut worst = Test { p: 1.0, survey: 0, what: What::Cells };
    for test in &tests {
        if test.p < worst.p {
            worst = *test;
        }
        if test.p >= level {
            continue;
        }
        let survey = &surveys[test.survey];
        let setting = &settings[survey.setting];
        let seed = SEED_AGAIN + 16 * test.survey as u32;
        let at = Surveyor::at(executor, surveyor, &setting.brdf)?;
        let repeated = at.again(executor, &setting.brdf, survey, seed, AGAIN)?;
        let again = tests_of(test.survey, &repeated);
        let again = again.iter().find(|again| again.what == test.what && again.p < level);
        if let Some(again) = again {
            let said = describe(&repeated, again);
            let verdict = Verdict::new(Law::Sampling, Outcome::Failed, said);
            let at = shown_view(settings, survey);
            let verdict = verdict.with(test.p, level, tests.len()).shown_by(at);
            return Ok((verdict, Some(test.survey)));
        }
        verdict.notes.push(format!(
            "p = {:.1e} at {}, not again in {AGAIN} other draws and finer integrals",
            test.p,
            shown_view(settings, survey)
        ));
    }
    let survey = &surveys[worst.survey];
    verdict.said = format!("draws follow pdf; {}", describe(survey, &worst));
    let unsettled: usize = surveys.iter().map(|survey| survey.integrals.unsettled).sum();
    if unsettled > 0 {
        verdict.notes.push(format!("{unsettled} cells whose integral is not settled"));
    }
    Ok((verdict.with(worst.p, level, tests.len()), None))
}

fn expected(survey: &Survey, draws: u64) -> (Vec<f64>, f64) {
    let cells = survey.integrals.cells.iter().map(|cell| cell.pdf * draws as f64).collect();
    let below = (1.0 - survey.integrals.total().pdf).max(0.0) * draws as f64;
    (cells, below)
}

fn tests_of(index: usize, survey: &Survey) -> [Test; 3] {
    let test = |p, what| Test { p, survey: index, what };
    let total = survey.integrals.total();
    [
        test(over_cells(survey).p, What::Cells),
        test(over_groups(survey).p, What::LargeCells),
        test(mass_p(&total, &survey.tally), What::Mass),
    ]
}

/// Over all cells, and what lies below the horizon as one more.
fn over_cells(survey: &Survey) -> ChiSquare {
    let tally = &survey.tally;
    let (mut cells, below) = expected(survey, tally.draws);
    cells.push(below);
    let mut counts = tally.counts.clone();
    counts.push(tally.draws - tally.above);
    chi_square(&counts, &cells)
}

fn over_groups(survey: &Survey) -> ChiSquare {
    let tally = &survey.tally;
    let (cells, below) = expected(survey, tally.draws);
    let mut expected = vec![0.0; survey.tree.groups + 1];
    let mut counts = vec![0; survey.tree.groups + 1];
    for (leaf, group) in survey.tree.group.iter().enumerate() {
        expected[*group] += cells[leaf];
        counts[*group] += tally.counts[leaf];
    }
    expected[survey.tree.groups] = below;
    counts[survey.tree.groups] = tally.draws - tally.above;
    chi_square(&counts, &expected)
}

/// Whether as much was drawn above the horizon as the integral of pdf says.
fn mass_p(total: &Integral, tally: &Tally) -> f64 {
    let n = tally.draws as f64;
    let share = tally.above as f64 / n;
    let off = ((share - total.pdf).abs() - MASS - total.pdf_error).max(0.0);
    let deviation = (total.pdf.clamp(0.0, 1.0) * (1.0 - total.pdf).max(0.0) / n).sqrt();
    match off {
        0.0 => 1.0,
        off => normal_tails(off / deviation.max(1.0 / n)),
    }
}

fn describe(survey: &Survey, test: &Test) -> String {
    let (p, tally) = (test.p, &survey.tally);
    let share = tally.above as f64 / tally.draws as f64;
    let total = survey.integrals.total().pdf;
    let mass = format!("pdf integrates to {total:.6}, {share:.6} of the draws are above");
    let over_cells = |found: ChiSquare| {
        let cells = found.freedom + 1.0;
        let said = format!("chi-square {:.0} over {cells} cells (p = {p:.1e})", found.statistic);
        // A factor that is forgotten shows in the mass first.
        if (total - share).abs() > FACTOR { format!("{mass}; {said}") } else { said }
    };
    match test.what {
        What::Cells => over_cells(self::over_cells(survey)),
        What::LargeCells => over_cells(over_groups(survey)),
        What::Mass | What::Channel(_) => format!("{mass} (p = {p:.1e})"),
    }
}

/// Where a survey looks: the setting and `wo`.
pub fn shown_view(settings: &[Setting], survey: &Survey) -> String {
    let setting = &settings[survey.setting];
    let [theta, phi] = survey.view;
    let mut text = format!("wo at {theta} degrees from the normal, {phi} from the tangent");
    let options = options(&setting.brdf);
    if !options.is_empty() {
        let _ = write!(text, ",{options}");
    }
    text
}

/// The law of the mean.
pub fn mean(
    executor: &mut dyn Executor,
    surveyor: &mut Option<Surveyor>,
    settings: &[Setting],
    surveys: &[Survey],
) -> Result<Verdict> {
    let tests: Vec<Test> =
        surveys.iter().enumerate().flat_map(|(index, survey)| means(index, survey)).collect();
    let level = sidak(LEVEL, tests.len() as f64);
    let mut notes = Vec::new();
    let worst = tests.iter().min_by(|a, b| a.p.total_cmp(&b.p)).copied();
    for test in tests.iter().filter(|test| test.p < level) {
        let survey = &surveys[test.survey];
        let setting = &settings[survey.setting];
        let seed = SEED_AGAIN + 16 * test.survey as u32;
        let at = Surveyor::at(executor, surveyor, &setting.brdf)?;
        let repeated = at.again(executor, &setting.brdf, survey, seed, AGAIN)?;
        let again = means(test.survey, &repeated);
        if again.iter().any(|again| again.what == test.what && again.p < level) {
            let verdict = Verdict::new(Law::Mean, Outcome::Failed, mean_said(&repeated, test));
            let verdict = verdict.with(test.p, level, tests.len());
            return Ok(verdict.shown_by(shown_view(settings, survey)));
        }
        notes.push(format!(
            "p = {:.1e} at {}, not again in {AGAIN} other draws and finer integrals",
            test.p,
            shown_view(settings, survey)
        ));
    }
    let said = worst.map_or(String::new(), |worst| mean_said(&surveys[worst.survey], &worst));
    let verdict = Verdict::new(Law::Mean, Outcome::Passed, said);
    Ok(Verdict { notes, ..verdict.with(worst.map_or(1.0, |w| w.p), level, tests.len()) })
}

fn mean_said(survey: &Survey, test: &Test) -> String {
    let tally = &survey.tally;
    let What::Channel(channel) = test.what else { return String::new() };
    let mean = tally.weights[channel] / tally.draws as f64;
    let albedo = survey.integrals.total().light[channel];
    let name = ["red", "green", "blue"][channel];
    format!("mean weight {mean:.6}, albedo {albedo:.6} in {name} (p = {:.1e})", test.p)
}

fn means(index: usize, survey: &Survey) -> Vec<Test> {
    let tally = &survey.tally;
    let total = survey.integrals.total();
    let n = tally.draws as f64;
    (0..3)
        .map(|channel| {
            let albedo = total.light[channel];
            let off = (tally.weights[channel] / n - albedo).abs();
            let off = (off - ALBEDO * albedo - total.light_error).max(0.0);
            // The variance by quadrature: rare large weights that were not drawn are in it.
            let variance = (total.own[channel] - albedo * albedo).max(0.0);
            let p = match off {
                0.0 => 1.0,
                off => normal_tails(off / (variance / n).sqrt().max(1e-12)),
            };
            Test { p, survey: index, what: What::Channel(channel) }
        })
        .collect()
}

/// The law of variance: it tells where a BRDF's own sampling is worse than the cosine's.
pub fn variance(settings: &[Setting], surveys: &[Survey], varies: bool) -> (Verdict, Vec<Spread>) {
    if !varies {
        let said = "sampled by the host's cosine";
        return (Verdict::new(Law::Variance, Outcome::Skipped, said), Vec::new());
    }
    let spreads: Vec<(usize, Spread)> = surveys
        .iter()
        .enumerate()
        .filter_map(|(index, survey)| Some((index, spread(survey)?)))
        .collect();
    let worst = spreads.iter().max_by(|a, b| a.1.ratio.total_cmp(&b.1.ratio));
    let of_defaults = spreads.iter().filter(|(index, _)| surveys[*index].setting == 0);
    let of_defaults: Vec<Spread> = of_defaults.map(|(_, spread)| *spread).collect();
    let Some((index, worst)) = worst else {
        let said = "the weights do not vary";
        return (Verdict::new(Law::Variance, Outcome::Passed, said), of_defaults);
    };
    let pays = worst.ratio <= AS_GOOD;
    let deviation = format!("(deviation {:.2} of the mean there)", worst.own);
    // Where the cosine hardly varies, a ratio says nothing by its digits.
    let said = match worst.ratio > 1e3 {
        true => format!("variance over 1000 times the cosine's {deviation}"),
        false => format!("variance at most {:.3} of the cosine's {deviation}", worst.ratio),
    };
    let outcome = if pays { outcome(true) } else { Outcome::Reported };
    let mut verdict =
        Verdict::new(Law::Variance, outcome, said).with(worst.ratio, AS_GOOD, spreads.len());
    if !pays {
        let more = spreads.iter().filter(|(_, spread)| spread.ratio > AS_GOOD).count();
        verdict.notes.push(format!("worse than the cosine at {more} of {} views", spreads.len()));
        verdict = verdict.shown_by(shown_view(settings, &surveys[*index]));
    }
    (verdict, of_defaults)
}

/// Where the albedo is below 1e-4 nobody sees how it was sampled.
const BLACK: f64 = 3e-8;

/// A ratio of variances that is as good as 1: a lobe may be the cosine itself.
const AS_GOOD: f64 = 1.001;

/// `None` where neither varies by more than a thousandth of the mean, or nothing is reflected.
fn spread(survey: &Survey) -> Option<Spread> {
    let total = survey.integrals.total();
    let sum = |values: [f64; 3]| values.iter().sum::<f64>();
    let squares = sum(total.light.map(|light| light * light));
    let own = (sum(total.own) - squares).max(0.0);
    let cosine = (sum(total.cosine) - squares).max(0.0);
    (squares > BLACK && own.max(cosine) > 1e-6 * squares && own.is_finite()).then(|| Spread {
        view: survey.view,
        own: (own / squares).sqrt(),
        ratio: own / cosine.max(1e-9 * squares),
    })
}
