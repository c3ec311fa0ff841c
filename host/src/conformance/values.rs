//! The laws of single values: finite and not negative, reciprocal, and a weight that is f cos / pdf.
//!
//! They look at the hard cases of `brdf numerics` and at random directions.

use std::sync::Arc;

use brdf_sdk::Result;

use super::settings::{Setting, options};
use super::verdict::{Law, Outcome, Verdict, outcome};
use crate::exec::cpu::Cpu;
use crate::exec::{Executor, Precision};
use crate::link::{Function, View, functions, link};
use crate::numerics::{cases_of, unit};
use crate::plugin::Configured;
use crate::render::evaluate::{Pair, Scattered, evaluate_rows};
use crate::render::rows::Rows;

/// Random pairs of directions.
const RANDOM: usize = 4096;
/// Reciprocity and weights are looked at in f64, where the hardest case still has ten digits.
const ROUNDING: f64 = 1e-7;
/// Directions whose sum is shorter are not asked to be reciprocal: both lie within this of the horizon, on opposite
/// sides, and of the angles between them and their half vector f64 itself has no seven digits left.
const SHORT: f64 = 2e-4;
/// Values below this part of the largest f at their setting say nothing of digits.
const FAINT: f64 = 1e-12;

/// Judges the three laws.
pub fn judge(executor: &mut dyn Executor, settings: &[Setting]) -> Result<[Verdict; 3]> {
    let pairs = pairs();
    let own = &settings[0].brdf;
    let (declared, _) = functions(own)?;
    let weighs = declared.contains(&Function::Weight);
    let mut device: Option<Machine> = None;
    let mut oracle: Option<Machine> = None;
    let mut cpu = Cpu::new(Precision::F64);
    let mut finite = Worst::default();
    let mut below_zero = 0.0f64;
    let mut reciprocal = Worst::default();
    let mut weight = Worst::default();
    let swapped: Vec<Pair> = pairs.iter().map(|pair| Pair { wo: pair.wi, wi: pair.wo }).collect();
    for setting in settings {
        let brdf = &setting.brdf;
        let machine = Machine::of(device.take(), executor, brdf)?;
        let machine = device.insert(machine);
        let found = evaluate_rows(executor, &mut machine.rows, brdf, &pairs)?;
        let negative = own.plugin.manifest.laws.negative.as_ref();
        let least = match negative.is_some_and(|exception| exception.holds_at(&brdf.values)) {
            true => f64::NEG_INFINITY,
            false => 0.0,
        };
        for (pair, at) in pairs.iter().zip(&found) {
            below_zero = below_zero.max(-at.f.iter().copied().fold(0.0, f64::min));
            let (bad, whose) = unsound(at, weighs, least);
            if bad > finite.value {
                finite.whose = whose;
            }
            finite.take(bad, setting, pair);
        }
        let machine = Machine::of(oracle.take(), &mut cpu, brdf)?;
        let machine = oracle.insert(machine);
        let there = evaluate_rows(&mut cpu, &mut machine.rows, brdf, &pairs)?;
        let back = evaluate_rows(&mut cpu, &mut machine.rows, brdf, &swapped)?;
        let peak = there.iter().map(|at| largest(&at.f)).filter(|f| f.is_finite());
        let peak = peak.fold(0.0, f64::max);
        for ((pair, one), other) in pairs.iter().zip(&there).zip(&back) {
            // What is not finite is as far apart as can be: infinity over infinity is NaN, which fails.
            let scale = largest(&one.f).max(largest(&other.f));
            if scale > FAINT * peak && length_of_sum(pair) > SHORT {
                reciprocal.take(apart(&one.f, &other.f) / scale, setting, pair);
            }
            if weighs && one.pdf > 0.0 {
                let wi = pair.wi.map(f64::from);
                let cosine = wi[2] / wi.iter().map(|c| c * c).sum::<f64>().sqrt();
                let to_weight = cosine / one.pdf;
                let quotient = one.f.map(|f| f * to_weight);
                let scale = largest(&quotient).max(largest(&one.weight));
                if scale > FAINT * peak * to_weight {
                    weight.take(apart(&one.weight, &quotient) / scale, setting, pair);
                }
            }
        }
    }
    for (machine, executor) in [(device, executor), (oracle, &mut cpu as &mut dyn Executor)] {
        if let Some(machine) = machine {
            machine.rows.free(executor);
        }
    }
    Ok([
        finite_verdict(&finite, below_zero, own),
        reciprocity_verdict(&reciprocal, own),
        weight_verdict(&weight, weighs),
    ])
}

/// A program of pairs and the constants that it was linked for.
struct Machine {
    rows: Rows,
    of: Configured,
}

impl Machine {
    fn of(old: Option<Self>, executor: &mut dyn Executor, brdf: &Configured) -> Result<Self> {
        match old {
            Some(old) if old.of.constants() == brdf.constants() => Ok(old),
            old => {
                if let Some(old) = old {
                    old.rows.free(executor);
                }
                let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
                Ok(Self { rows: Rows::new(executor, program)?, of: brdf.clone() })
            }
        }
    }
}

/// The worst case so far.
#[derive(Default)]
struct Worst {
    value: f64,
    cases: usize,
    bad: usize,
    /// The function whose value it is, where that is told.
    whose: &'static str,
    shown: Option<(String, Pair)>,
}

impl Worst {
    fn take(&mut self, value: f64, setting: &Setting, pair: &Pair) {
        self.cases += 1;
        let value = if value.is_nan() { f64::INFINITY } else { value };
        self.bad += usize::from(value > ROUNDING);
        if value > self.value {
            self.value = value;
            self.shown = Some((options(&setting.brdf), *pair));
        }
    }

    fn command(&self, id: &str) -> Option<String> {
        let (options, pair) = self.shown.as_ref()?;
        Some(command(id, options, pair))
    }
}

/// |wo + wi|, twice the cosine between either and their half vector.
fn length_of_sum(pair: &Pair) -> f64 {
    let sum = [0, 1, 2].map(|c| f64::from(pair.wo[c]) + f64::from(pair.wi[c]));
    sum.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// A direction as a row of text.
pub fn row(w: [f32; 3]) -> String {
    w.map(|c| c.to_string()).join(" ")
}

/// A shell's line that shows a pair's values.
pub fn command(id: &str, options: &str, pair: &Pair) -> String {
    format!("echo {} {} | brdf eval {id}{options}", row(pair.wo), row(pair.wi))
}

/// How bad it is, and whose: 0 where all is well, 1 where it is negative (`eval` below `least`), infinite where
/// it is not finite.
fn unsound(at: &Scattered, weighs: bool, least: f64) -> (f64, &'static str) {
    let bad = |values: &[f64], least: f64| {
        values.iter().fold(0.0f64, |worst, value| match value {
            value if !value.is_finite() => f64::INFINITY,
            value if *value < least => worst.max(1.0),
            _ => worst,
        })
    };
    let weight: &[f64] = if weighs { &at.weight } else { &[] };
    let each =
        [(bad(&at.f, least), "eval"), (bad(&[at.pdf], 0.0), "pdf"), (bad(weight, least), "weight")];
    each.into_iter().fold((0.0, ""), |worst, one| if one.0 > worst.0 { one } else { worst })
}

/// The largest size; infinite where one is NaN, which `max` would pass over.
pub fn largest(values: &[f64; 3]) -> f64 {
    values.iter().fold(0.0, |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b.abs()) })
}

/// The largest difference of two values' channels; infinite where one is NaN.
pub fn apart(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    largest(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}

fn finite_verdict(worst: &Worst, below_zero: f64, brdf: &Configured) -> Verdict {
    let said = match worst.value {
        0.0 => "eval, pdf and weight are finite and not negative".to_owned(),
        value if value.is_infinite() => {
            format!("{} is Inf or NaN; {} cases are unsound", worst.whose, worst.bad)
        }
        _ => format!("{} is negative; {} cases are unsound", worst.whose, worst.bad),
    };
    let verdict = Verdict::new(Law::Finite, outcome(worst.bad == 0), said);
    let reproduce = if worst.bad > 0 { worst.command("BRDF") } else { None };
    let mut verdict = Verdict { reproduce, ..verdict.with(worst.bad as f64, 0.0, worst.cases) };
    if let Some(exception) = &brdf.plugin.manifest.laws.negative
        && below_zero > 0.0
    {
        verdict
            .notes
            .push(format!("eval down to {:.1e}, as declared: {}", -below_zero, exception.reason));
    }
    verdict
}

fn reciprocity_verdict(worst: &Worst, brdf: &Configured) -> Verdict {
    let holds = worst.value <= ROUNDING;
    let apart =
        |worst: &Worst| format!("f(wo, wi) and f(wi, wo) differ by up to {:.1e}", worst.value);
    let declared = &brdf.plugin.manifest.laws.not_reciprocal;
    let (outcome, said) = match declared {
        None if holds => (Outcome::Passed, "f(wo, wi) = f(wi, wo) to rounding".to_owned()),
        None if brdf.data_file().is_some() => {
            (Outcome::Reported, format!("{} of themselves: so is the data", apart(worst)))
        }
        None => (Outcome::Failed, format!("{} of themselves", apart(worst))),
        Some(_) if holds && brdf.data_file().is_some() => {
            (Outcome::Passed, "f(wo, wi) = f(wi, wo) to rounding: so is the data".to_owned())
        }
        Some(_) if holds => {
            (Outcome::Failed, "it is reciprocal: remove `not_reciprocal` from [laws]".to_owned())
        }
        Some(reason) => (Outcome::Passed, format!("{}, as declared: {reason}", apart(worst))),
    };
    let verdict = Verdict::new(Law::Reciprocity, outcome, said);
    let reproduce = if holds { None } else { worst.command("BRDF") };
    Verdict { reproduce, ..verdict.with(worst.value, ROUNDING, worst.cases) }
}

fn weight_verdict(worst: &Worst, weighs: bool) -> Verdict {
    if !weighs {
        return Verdict::new(Law::Weight, Outcome::Skipped, "no closed form is given");
    }
    let holds = worst.value <= ROUNDING;
    let said = match holds {
        true => "the closed form is f cos / pdf".to_owned(),
        false => {
            format!("the closed form and f cos / pdf differ by up to {:.1e} of it", worst.value)
        }
    };
    let reproduce = if holds { None } else { worst.command("BRDF") };
    let verdict = Verdict::new(Law::Weight, outcome(holds), said);
    Verdict { reproduce, ..verdict.with(worst.value, ROUNDING, worst.cases) }
}

/// The hard cases, and random directions uniform over the hemisphere.
fn pairs() -> Vec<Pair> {
    let hard = cases_of(Function::Eval).into_iter();
    let mut all: Vec<Pair> = hard.map(|case| Pair { wo: case.wo, wi: case.wi }).collect();
    // Additive recurrence in four dimensions (Roberts 2018): the inverse powers of the root of x^5 = x + 1.
    const ROOT: f64 = 1.167_303_978_261_418_7;
    for index in 0..RANDOM {
        let u = [1, 2, 3, 4].map(|power| (0.5 + index as f64 / ROOT.powi(power)).fract());
        let at = |height: f64, turn: f64| {
            let r = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
            let phi = std::f64::consts::TAU * turn;
            unit([r * phi.cos(), r * phi.sin(), height])
        };
        let pair = at(u[0], u[1]).zip(at(u[2], u[3])).map(|(wo, wi)| Pair { wo, wi });
        all.extend(pair.filter(Pair::is_above_horizon));
    }
    all
}
