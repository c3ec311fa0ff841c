//! The law of energy: no more light leaves than comes.
//!
//! The directional albedo of the BRDF's white preset is integrated in f64 at 20 angles and three azimuths, for
//! each switch and choice that the preset leaves open. A model that gains energy declares by how much,
//! and the declaration is held against what is found from both sides. A material that is read from a file is
//! judged as it is; what somebody's data gains is told and not blamed on the plugin.

use brdf_sdk::Result;

use super::settings::{direction, options, switched};
use super::survey::Surveyor;
use super::verdict::{Law, Outcome, Verdict, outcome};
use crate::exec::Executor;
use crate::plugin::Configured;
use crate::render::albedo::ANGLES;

/// Azimuths of `wo` [degrees].
const AZIMUTHS: [f64; 3] = [0.0, 37.0, 90.0];
/// What the quadrature may miss, as a part of the albedo.
const ERROR: f64 = 1e-4;
/// A declared bound may lie above what is found by this much of it.
const SLACK: f64 = 0.02;

/// The directional albedo at an angle.
pub type Curve = Vec<[f64; 2]>;

/// Judges it; also the largest channel of the white preset's albedo along the angles at azimuth 0, for plots.
pub fn judge(executor: &mut dyn Executor, brdf: &Configured) -> Result<(Verdict, Curve)> {
    let laws = &brdf.plugin.manifest.laws;
    let manifest = &brdf.plugin.manifest;
    if laws.white.is_none() && manifest.files().next().is_none() {
        let said = "no preset is declared as the one that reflects most: `[laws] white = \"...\"`";
        return Ok((Verdict::new(Law::Energy, Outcome::Skipped, said), Vec::new()));
    }
    let mut own = brdf.clone();
    let mut fixed = Vec::new();
    let presets =
        manifest.presets.iter().filter(|preset| Some(&preset.name) == laws.white.as_ref());
    for preset in presets {
        own.set_preset(preset);
        fixed.extend(preset.values.iter().map(|(key, _)| key.as_str()));
    }
    let views: Vec<[f64; 2]> =
        ANGLES.iter().flat_map(|angle| AZIMUTHS.map(|azimuth| [*angle, azimuth])).collect();
    let directions: Vec<[f32; 3]> = views.iter().map(|view| direction(*view)).collect();
    let mut variants = vec![own.clone()];
    // Switches that the preset sets stay as they are.
    let open =
        |variant: &Configured| fixed.iter().all(|k| variant.values.get(k) == own.values.get(k));
    variants.extend(switched(&own).into_iter().map(|(variant, _)| variant).filter(open));
    let mut largest: Option<(f64, [f64; 2], String)> = None;
    let mut curve = Vec::new();
    let mut broken = None;
    for variant in &variants {
        let mut surveyor = Surveyor::new(executor, variant)?;
        let found = surveyor.albedos(executor, variant, &directions, ERROR)?;
        surveyor.free(executor);
        for (view, integrals) in views.iter().zip(&found) {
            if integrals.broken.is_some() {
                broken = Some((*view, options(variant)));
            }
            let albedo = integrals.total().light.iter().fold(0.0f64, |a, b| a.max(*b));
            if curve.len() < ANGLES.len() && view[1] == AZIMUTHS[0] {
                curve.push([view[0], albedo]);
            }
            if largest.as_ref().is_none_or(|(most, ..)| albedo > *most) {
                largest = Some((albedo, *view, options(variant)));
            }
        }
    }
    let at = |view: [f64; 2], set: &str| {
        format!("brdf eval BRDF --albedo --angles {} --azimuth {}{set}", view[0], view[1])
    };
    if let Some((view, set)) = broken {
        let said = "f is Inf or NaN where it is integrated";
        let verdict = Verdict::new(Law::Energy, Outcome::Failed, said);
        return Ok((verdict.shown_by(at(view, &set)), curve));
    }
    let Some((most, view, set)) = largest else {
        return Ok((Verdict::new(Law::Energy, Outcome::Skipped, "nothing to look at"), curve));
    };
    let where_ = format!("albedo at most {most:.4}, at {} degrees", view[0]);
    let cases = views.len() * variants.len();
    let limit = 1.0 + ERROR;
    let (outcome, said, threshold) = match &laws.energy {
        None if most > limit && brdf.data_file().is_some() => {
            (Outcome::Reported, format!("{where_}: so is the data"), limit)
        }
        None => (outcome(most <= limit), where_, limit),
        Some(_) if most <= limit && brdf.data_file().is_some() => {
            (Outcome::Passed, format!("{where_}: so is the data"), limit)
        }
        Some(declared) if brdf.data_file().is_some() => (
            Outcome::Reported,
            format!("{where_}: so is the data; {} is declared of the plugin's own", declared.bound),
            declared.bound,
        ),
        Some(declared) if most <= limit => (
            Outcome::Failed,
            format!("{where_}: it gains nothing; remove `energy` ({}) from [laws]", declared.bound),
            declared.bound,
        ),
        Some(declared) if most > declared.bound * (1.0 + ERROR) => (
            Outcome::Failed,
            format!("{where_}, and at most {} is declared", declared.bound),
            declared.bound,
        ),
        Some(declared) if most < declared.bound * (1.0 - SLACK) => (
            Outcome::Failed,
            format!("{where_}: declare that, and not {}", declared.bound),
            declared.bound,
        ),
        Some(declared) => {
            let said = format!("{where_}, as declared: {}", declared.reason);
            (Outcome::Passed, said, declared.bound)
        }
    };
    let verdict = Verdict::new(Law::Energy, outcome, said).with(most, threshold, cases);
    let verdict = match outcome {
        Outcome::Failed => verdict.shown_by(at(view, &set)),
        _ => verdict,
    };
    Ok((verdict, curve))
}
