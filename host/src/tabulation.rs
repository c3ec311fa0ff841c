//! Any BRDF as a MERL file, and how far the file is from it.
//!
//! A bin holds f at its middle, where both directions lie above the horizon, and otherwise the mean of points in
//! it that do; a bin without any is left unmeasured. The distance is told at points that no bin's middle is, by
//! the plugin that reads such files: the table's format is proved by it, not only written.

use std::sync::Arc;

use brdf_measured::merl;
use brdf_sdk::native::directions::{HalfDifference, Vec3, direction};
use brdf_sdk::{ParamValue, Problem, Result};

use crate::exec::Executor;
use crate::link::{View, link};
use crate::plugin::Configured;
use crate::render::evaluate::{Pair, Scattered, evaluate};

/// Relative differences that rounding makes.
pub const ROUNDING: f64 = 1e-4;

/// Points along each axis of a bin that is seen in part.
const ACROSS: usize = 4;

/// Points at which a table is compared.
const POINTS: usize = 1 << 16;

/// A BRDF in the bins of a MERL file.
pub struct Tabulated {
    /// The file.
    pub bytes: Vec<u8>,
    /// Bins that no pair of directions above the horizon falls into.
    pub unseen: usize,
    /// The largest relative change of f, of 64 pairs' largest, as both directions turn about the normal.
    pub anisotropy: f64,
}

/// Relative differences of f, of its luminance's larger value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Half of the points are closer.
    pub median: f64,
    /// 95 % of the points are closer.
    pub most: f64,
    /// The farthest point.
    pub worst: f64,
}

/// Evaluates the BRDF for each bin.
///
/// # Errors
/// What linking and running report, and values that no file can hold.
pub fn tabulate(executor: &mut dyn Executor, brdf: &Configured) -> Result<Tabulated> {
    let bins: usize = merl::BINS.iter().product();
    let mut pairs = Vec::new();
    let mut ends = Vec::with_capacity(bins);
    for bin in 0..bins {
        pairs.extend(merl::pairs(bin, ACROSS).into_iter().map(|(wo, wi)| Pair::new(wo, wi)));
        ends.push(pairs.len());
    }
    let values = values(executor, brdf, &pairs)?;
    let mut first = 0;
    let means = ends.iter().map(|end| {
        let of_bin = &values[first..*end];
        first = *end;
        let sum = of_bin.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|c| sum[c] + f[c]));
        (!of_bin.is_empty()).then(|| sum.map(|c| c / of_bin.len() as f64))
    });
    let means: Vec<Option<[f64; 3]>> = means.collect();
    Ok(Tabulated {
        bytes: merl::bytes(&means),
        unseen: means.iter().filter(|mean| mean.is_none()).count(),
        anisotropy: anisotropy(executor, brdf)?,
    })
}

/// How far a MERL plugin with the file is from the BRDF, for each of its interpolations.
///
/// # Errors
/// What linking and running report.
pub fn distance(
    executor: &mut dyn Executor,
    brdf: &Configured,
    merl: &Configured,
) -> Result<Vec<(&'static str, Distance)>> {
    let pairs: Vec<Pair> = points().into_iter().map(|(wo, wi)| Pair::new(wo, wi)).collect();
    let own = values(executor, brdf, &pairs)?;
    let mut all = Vec::new();
    for interpolation in ["trilinear", "nearest"] {
        let mut merl = merl.clone();
        merl.values.set("interpolation", ParamValue::Choice(interpolation.to_owned()));
        let tables = values(executor, &merl, &pairs)?;
        let mut off: Vec<f64> = own.iter().zip(&tables).map(|(a, b)| apart(*a, *b)).collect();
        off.sort_by(f64::total_cmp);
        let at = |part: f64| off[((off.len() - 1) as f64 * part) as usize];
        all.push((interpolation, Distance { median: at(0.5), most: at(0.95), worst: at(1.0) }));
    }
    Ok(all)
}

/// Pairs spread evenly over the bins' coordinates, both directions a degree above the horizon: a Kronecker
/// sequence of the plastic number's cousin in three dimensions (Roberts 2018).
fn points() -> Vec<(Vec3, Vec3)> {
    // The root of x^4 = x + 1.
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let part = |n: usize, axis: i32| (0.5 + n as f64 * ROOT.powi(-axis)).fract();
    let place = |n: usize| {
        let root = part(n, 1);
        let quarter = std::f64::consts::FRAC_PI_2;
        let angles = HalfDifference {
            theta_h: root * root * quarter,
            phi_h: 0.0,
            theta_d: part(n, 2) * quarter,
            phi_d: part(n, 3) * std::f64::consts::PI,
        };
        angles.directions()
    };
    let height = 1f64.to_radians().sin();
    (1..).map(place).filter(|(wo, wi)| wo[2] > height && wi[2] > height).take(POINTS).collect()
}

/// How much f changes as both directions turn about the normal.
fn anisotropy(executor: &mut dyn Executor, brdf: &Configured) -> Result<f64> {
    const TURNS: usize = 8;
    let turned = |v: Vec3, turn: usize| {
        let phi = v[1].atan2(v[0]) + turn as f64 * 0.37;
        direction(v[0].hypot(v[1]).atan2(v[2]), phi)
    };
    let points: Vec<_> = points().into_iter().step_by(POINTS / 64).collect();
    let pairs: Vec<Pair> = points
        .iter()
        .flat_map(|(wo, wi)| (0..TURNS).map(|t| Pair::new(turned(*wo, t), turned(*wi, t))))
        .collect();
    let values = values(executor, brdf, &pairs)?;
    let most = values
        .chunks(TURNS)
        .flat_map(|turns| turns.iter().map(|value| apart(turns[0], *value)).collect::<Vec<_>>());
    Ok(most.fold(0.0, f64::max))
}

/// The largest difference of a colour, of the pair's larger value.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let largest = a.iter().chain(&b).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let most = (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
    if largest > 0.0 { most / largest } else { 0.0 }
}

fn values(executor: &mut dyn Executor, brdf: &Configured, pairs: &[Pair]) -> Result<Vec<[f64; 3]>> {
    let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
    let found: Vec<Scattered> = evaluate(executor, &program, brdf, pairs)?;
    let bad = found.iter().position(|row| row.f.iter().any(|f| !f.is_finite() || *f < 0.0));
    if let Some(bad) = bad {
        let Pair { wo, wi } = pairs[bad];
        return Err(Problem::new(
            &brdf.plugin.id,
            format!("its value is {:?} at wo = {wo:?}, wi = {wi:?}", found[bad].f),
            "`brdf conform` shows where; mend `eval` first",
        ));
    }
    Ok(found.into_iter().map(|row| row.f).collect())
}
