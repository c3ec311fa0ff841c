//! The law of stability: f32 keeps the digits of f64, or loses no more than its inputs' last digit does.
//!
//! Each of the author's functions runs on the device in f32 and on the cores in f64, over the hard cases of
//! `brdf numerics`. What is allowed is measured: each input moves by one ulp, and f64 tells by how much the
//! result moves.

use std::collections::BTreeMap;
use std::sync::Arc;

use brdf_sdk::{ParamValue, Result};

use super::settings::{Setting, options};
use super::values::{command, row};
use super::verdict::{Law, Outcome, Verdict, outcome};
use crate::exec::cpu::Cpu;
use crate::exec::{Executor, Precision};
use crate::link::{BindingKind, Function, View, functions, link};
use crate::numerics::{Case, cases_of, error};
use crate::plugin::Configured;
use crate::render::evaluate::Pair;
use crate::render::rows::Rows;

/// Relative errors below this are fine anyway; angles are taken in units of the lobe's width.
const FINE: f64 = 1e-4;
/// Of what the result moves by when each input moves by one ulp.
const ULPS: f64 = 8.0;
/// Values below this part of the peak at their `wo` do not matter.
const FAINT: f64 = 1e-6;
/// The part of a stratum's errors that counts.
const PERCENTILE: f64 = 0.99;
/// A direction this many widths away came by another way through the author's branches.
const DIVERGED: f64 = 0.5;
/// How near to `wo` or its mirror direction a light is still retro or mirror.
const NEAR: f64 = 0.15;
/// Below this height a direction is grazing.
const GRAZING: f32 = 0.1;

/// Where a case lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    Grazing,
    Retro,
    Mirror,
    Elsewhere,
}

impl Place {
    fn of(function: Function, case: &Case) -> Self {
        let near = |target: [f32; 3]| {
            let square = |i: usize| f64::from(target[i] - case.wi[i]).powi(2);
            (0..3).map(square).sum::<f64>() < NEAR * NEAR
        };
        let [x, y, z] = case.wo;
        let pairs = function != Function::Sample;
        match () {
            () if z < GRAZING || (pairs && case.wi[2] < GRAZING) => Self::Grazing,
            () if pairs && near(case.wo) => Self::Retro,
            () if pairs && near([-x, -y, z]) => Self::Mirror,
            () => Self::Elsewhere,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Grazing => "grazing",
            Self::Retro => "retro",
            Self::Mirror => "mirror",
            Self::Elsewhere => "elsewhere",
        }
    }
}

/// The worst stratum so far.
#[derive(Default)]
struct Worst {
    ratio: f64,
    said: String,
    reproduce: String,
}

/// Judges it.
pub fn judge(executor: &mut dyn Executor, settings: &[Setting]) -> Result<Verdict> {
    let (functions, _) = functions(&settings[0].brdf)?;
    let mut cpu = Cpu::new(Precision::F64);
    let mut worst = Worst::default();
    // Where the author says that the model jumps.
    let mut at_steps = Worst::default();
    let steps = &settings[0].brdf.plugin.manifest.laws.not_continuous;
    let mut seen = 0;
    let mut judged = 0;
    let mut diverged = 0;
    for function in functions {
        let cases = cases_of(function);
        let mut held: Option<Held> = None;
        for setting in settings {
            let brdf = &setting.brdf;
            let jumps = steps.as_ref().is_some_and(|steps| steps.holds_at(&brdf.values));
            let worst = if jumps { &mut at_steps } else { &mut worst };
            let held = Held::at(&mut held, executor, &mut cpu, brdf, function)?;
            seen += cases.len();
            let low = held.on_device(executor, brdf, &cases)?;
            let high = held.in_f64(&mut cpu, brdf, &cases)?;
            if let Some(lost) = lost(&low, &high) {
                let said = format!("{} is Inf or NaN where f64 is not", function.name());
                let at = shown(function, brdf, &cases[lost]);
                return Ok(Verdict::new(Law::Stability, Outcome::Failed, said).shown_by(at));
            }
            let allowed = held.allowed(&mut cpu, brdf, &cases, &high)?;
            let widths = held.widths(&mut cpu, brdf, &cases, &high)?;
            let mut strata: BTreeMap<Place, Vec<(f64, f64, usize)>> = BTreeMap::new();
            for index in matter(function, &cases, &high) {
                let off = error(function, low[index], high[index]) / widths[index];
                let limit = (ULPS * allowed[index] / widths[index]).max(FINE);
                judged += 1;
                diverged += usize::from(function == Function::Sample && off > DIVERGED);
                let place = Place::of(function, &cases[index]);
                strata.entry(place).or_default().push((off / limit, off, index));
            }
            for (place, mut errors) in strata {
                errors.sort_by(|a, b| a.0.total_cmp(&b.0));
                let at = (PERCENTILE * (errors.len() - 1) as f64).floor() as usize;
                let (ratio, off, index) = errors[at];
                if ratio > worst.ratio {
                    let [name, place] = [function.name(), place.word()];
                    let kept = format!("{name}, {place}, {}: error {off:.1e}", setting.name);
                    let reproduce = shown(function, brdf, &cases[index]);
                    *worst = Worst { ratio, said: kept, reproduce };
                }
            }
        }
        if let Some(held) = held {
            held.free(executor, &mut cpu);
        }
    }
    if judged == 0 {
        let said = "nothing is reflected where it looks";
        return Ok(Verdict::new(Law::Stability, Outcome::Skipped, said));
    }
    let holds = worst.ratio <= 1.0;
    let said = match holds {
        true if worst.said.is_empty() => "all results are those of f64".to_owned(),
        true => format!("99 % of each stratum are within what is allowed; worst {}", worst.said),
        false => format!("{}, {:.1} times what is allowed", worst.said, worst.ratio),
    };
    let mut verdict =
        Verdict::new(Law::Stability, outcome(holds), said).with(worst.ratio, 1.0, seen);
    if let Some(steps) = steps {
        // Whether a case lies on a step is chance, so none need be found.
        let said = match at_steps.said.is_empty() {
            true => "no error where it jumps",
            false => &at_steps.said,
        };
        verdict.notes.push(format!("{said}, as declared: {}", steps.reason));
    }
    if diverged > 0 {
        verdict.notes.push(format!("{diverged} draws took another way in f32 than in f64"));
    }
    Ok(if holds { verdict } else { verdict.shown_by(worst.reproduce) })
}

fn shown(function: Function, brdf: &Configured, case: &Case) -> String {
    match function {
        Function::Sample => {
            format!("wo {}, u {}{}", row(case.wo), row(case.u), options(brdf))
        }
        _ => command("BRDF", &options(brdf), &Pair { wo: case.wo, wi: case.wi }),
    }
}

/// A case that f32 turned into Inf or NaN, and f64 did not.
fn lost(low: &[[f64; 3]], high: &[[f64; 3]]) -> Option<usize> {
    let finite = |value: &f64| value.is_finite();
    (0..low.len()).find(|index| {
        let fits = |value: &f64| finite(value) && (*value as f32).is_finite();
        high[*index].iter().all(fits) && !low[*index].iter().all(finite)
    })
}

/// The cases whose value matters beside the largest at their `wo`; for `sample` all above the horizon.
fn matter(function: Function, cases: &[Case], high: &[[f64; 3]]) -> Vec<usize> {
    let largest = |index: usize| high[index].iter().fold(0.0f64, |a, b| a.max(*b));
    let finite = |index: &usize| high[*index].iter().all(|value| value.is_finite());
    let all = (0..cases.len()).filter(finite);
    if function == Function::Sample {
        return all.filter(|index| high[*index][2] > 0.0).collect();
    }
    let mut peaks: BTreeMap<[u32; 3], f64> = BTreeMap::new();
    let key = |index: usize| cases[index].wo.map(f32::to_bits);
    let all: Vec<usize> = all.collect();
    for index in &all {
        let peak = peaks.entry(key(*index)).or_default();
        *peak = peak.max(largest(*index));
    }
    all.into_iter().filter(|index| largest(*index) > FAINT * peaks[&key(*index)]).collect()
}

/// A function's programs, for one choice of the BRDF's constants.
struct Held {
    function: Function,
    device: Rows,
    oracle: Rows,
    /// That of `pdf`, for the widths of lobes that `sample` draws from.
    pdf: Option<Rows>,
    of: Configured,
}

impl Held {
    fn at<'a>(
        held: &'a mut Option<Self>,
        executor: &mut dyn Executor,
        cpu: &mut Cpu,
        brdf: &Configured,
        function: Function,
    ) -> Result<&'a mut Self> {
        let found = match held.take() {
            Some(found) if found.of.constants() == brdf.constants() => found,
            other => {
                if let Some(other) = other {
                    other.free(executor, cpu);
                }
                let linked = |function| {
                    Ok(Arc::new(link(&View::Numerics { brdf: brdf.clone(), function })?))
                };
                let program = linked(function)?;
                let pdf = match function {
                    Function::Sample => Some(Rows::new(cpu, linked(Function::Pdf)?)?),
                    _ => None,
                };
                Self {
                    function,
                    device: Rows::new(executor, Arc::clone(&program))?,
                    oracle: Rows::new(cpu, program)?,
                    pdf,
                    of: brdf.clone(),
                }
            }
        };
        Ok(held.insert(found))
    }

    fn on_device(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        cases: &[Case],
    ) -> Result<Vec<[f64; 3]>> {
        run(&mut self.device, executor, brdf, cases)
    }

    fn in_f64(
        &mut self,
        cpu: &mut Cpu,
        brdf: &Configured,
        cases: &[Case],
    ) -> Result<Vec<[f64; 3]>> {
        run(&mut self.oracle, cpu, brdf, cases)
    }

    /// How far each result moves in f64 when each input moves by one ulp of f32, all moves added.
    fn allowed(
        &mut self,
        cpu: &mut Cpu,
        brdf: &Configured,
        cases: &[Case],
        high: &[[f64; 3]],
    ) -> Result<Vec<f64>> {
        let mut moved = vec![0.0; cases.len()];
        let mut add = |results: Vec<[f64; 3]>, function: Function| {
            for ((sum, result), own) in moved.iter_mut().zip(results).zip(high) {
                *sum += error(function, result, *own);
            }
        };
        for input in 0..9 {
            let is_read = match self.function {
                Function::Sample => !(3..6).contains(&input),
                _ => input < 6,
            };
            if !is_read {
                continue;
            }
            let nudged: Vec<Case> = cases
                .iter()
                .map(|case| {
                    let mut case = *case;
                    let value = match input {
                        0..3 => &mut case.wo[input],
                        3..6 => &mut case.wi[input - 3],
                        _ => &mut case.u[input - 6],
                    };
                    *value = value.next_up();
                    case
                })
                .collect();
            add(self.in_f64(cpu, brdf, &nudged)?, self.function);
        }
        for (key, value) in brdf.values.iter() {
            let ParamValue::Float(number) = value else { continue };
            let mut nudged = brdf.clone();
            nudged.values.set(key, ParamValue::Float(f64::from((*number as f32).next_up())));
            add(self.in_f64(cpu, &nudged, cases)?, self.function);
        }
        Ok(moved)
    }

    /// The widths of the lobes that directions were drawn from [radians]: a density of p covers a disc of
    /// area 1/p. 1 for all other functions.
    fn widths(
        &mut self,
        cpu: &mut Cpu,
        brdf: &Configured,
        cases: &[Case],
        drawn: &[[f64; 3]],
    ) -> Result<Vec<f64>> {
        let Some(pdf) = &mut self.pdf else { return Ok(vec![1.0; cases.len()]) };
        let there: Vec<Case> = cases
            .iter()
            .zip(drawn)
            .map(|(case, wi)| {
                let above = wi[2] > 0.0 && wi.iter().all(|c| c.is_finite());
                let wi = if above { *wi } else { [0.0, 0.0, 1.0] };
                Case { wi: wi.map(|c| c as f32), ..*case }
            })
            .collect();
        let densities = run(pdf, cpu, brdf, &there)?;
        let width = |[pdf, ..]: [f64; 3]| match pdf > 0.0 {
            true => (1.0 / (std::f64::consts::PI * pdf)).sqrt().min(1.0),
            false => 1.0,
        };
        Ok(densities.into_iter().map(width).collect())
    }

    fn free(self, executor: &mut dyn Executor, cpu: &mut Cpu) {
        self.device.free(executor);
        self.oracle.free(cpu);
        if let Some(pdf) = self.pdf {
            pdf.free(cpu);
        }
    }
}

fn run(
    rows: &mut Rows,
    executor: &mut dyn Executor,
    brdf: &Configured,
    cases: &[Case],
) -> Result<Vec<[f64; 3]>> {
    let mut bytes = Vec::new();
    // A function that reads nothing has no cases bound.
    if let Some(layout) = rows.program().layout("cases") {
        bytes = vec![0; layout.stride * cases.len()];
        for (index, case) in cases.iter().enumerate() {
            let base = index * layout.stride;
            layout.write(&mut bytes, base, "wo", &case.wo);
            layout.write(&mut bytes, base, "wi", &case.wi);
            layout.write(&mut bytes, base, "u", &case.u);
        }
    }
    let inputs = [("cases", BindingKind::Read, bytes)];
    let inputs = if inputs[0].2.is_empty() { &[] } else { &inputs[..] };
    let read = rows.run(executor, brdf, inputs, "outcomes", cases.len())?;
    let layout = rows.program().required_layout("outcomes");
    let at = layout.at("value");
    let three = |row: usize| [0, 4, 8].map(|offset| read.float(row * layout.stride + at + offset));
    Ok((0..cases.len()).map(three).collect())
}
