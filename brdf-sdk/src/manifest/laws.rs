//! What a BRDF declares about the laws that every BRDF is held to: exceptions, each with its reason.
//!
//! The words alone; whether an exception is needed, and holds, is for the host's laws to prove.

use super::declared::read_set;
use super::{Kind, Param, ParamValue, ParamValues, Preset, non_empty};
use crate::problem::Result;
use crate::table::{Table, suggestion};

/// What a BRDF declares about the laws that every BRDF is held to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Laws {
    /// The preset whose directional albedo is the largest that the model reaches.
    pub white: Option<String>,
    /// Why f(wo, wi) = f(wi, wo) does not hold, where it does not.
    pub not_reciprocal: Option<String>,
    /// How far the directional albedo exceeds 1, where it does.
    pub energy: Option<EnergyBound>,
    /// Where the model jumps by intent, so that f32 and f64 may fall on two sides of a step.
    pub not_continuous: Option<Exception>,
    /// Where values below 0 are shown as the data has them.
    pub negative: Option<Exception>,
}

/// Values of parameters with which a law is not kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Exception {
    /// The values, all of which must hold.
    pub values: Vec<(String, ParamValue)>,
    /// Why the law is not kept there.
    pub reason: String,
}

impl Exception {
    /// Whether a plugin's values are those of the exception.
    pub fn holds_at(&self, values: &ParamValues) -> bool {
        self.values.iter().all(|(key, value)| values.get(key) == Some(value))
    }
}

/// A measured bound of the directional albedo of a model that gains energy.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyBound {
    /// The largest directional albedo, above 1.
    pub bound: f64,
    /// Why the model exceeds 1.
    pub reason: String,
}

pub(super) fn read_laws(
    table: &Table<'_>,
    kind: Kind,
    params: &[Param],
    presets: &[Preset],
) -> Result<Laws> {
    let Some(value) = table.get("laws") else { return Ok(Laws::default()) };
    if kind != Kind::Brdf {
        return Err(value.problem("the laws hold for BRDFs only", "remove [laws]"));
    }
    let inner = value.table()?;
    let white = match inner.get("white") {
        None => None,
        Some(value) => {
            let name = value.string()?;
            if !presets.iter().any(|preset| preset.name == name) {
                let known = presets.iter().map(|preset| preset.name.as_str());
                let cure = match presets.is_empty() {
                    true => format!("add [presets.{name}]"),
                    false => suggestion(&name, known),
                };
                return Err(value.problem(format!("there is no preset `{name}`"), cure));
            }
            Some(name)
        }
    };
    let not_reciprocal = match inner.get("not_reciprocal") {
        None => None,
        Some(value) => {
            let exception = value.table()?;
            let reason = non_empty(&exception.require("reason", "`reason = \"...\"`")?)?;
            exception.finish()?;
            Some(reason)
        }
    };
    let energy = match inner.get("energy") {
        None => None,
        Some(value) => {
            let exception = value.table()?;
            let bound_value = exception.require("bound", "`bound = 1.2`, the largest albedo")?;
            let bound = bound_value.number()?;
            if bound <= 1.0 {
                return Err(bound_value.problem(
                    format!("an energy bound of {bound} is no exception"),
                    "give the measured bound above 1, or remove [laws.energy]",
                ));
            }
            let reason = non_empty(&exception.require("reason", "`reason = \"...\"`")?)?;
            exception.finish()?;
            if white.is_none() {
                return Err(value.problem(
                    "the bound is held to no preset",
                    "add `white = \"...\"`, the preset that reflects most",
                ));
            }
            Some(EnergyBound { bound, reason })
        }
    };
    let not_continuous = read_exception(&inner, "not_continuous", params)?;
    let negative = read_exception(&inner, "negative", params)?;
    inner.finish()?;
    Ok(Laws { white, not_reciprocal, energy, not_continuous, negative })
}

/// An exception that holds at some values, `key = { set = { parameter = value }, reason = "..." }`.
fn read_exception(laws: &Table<'_>, key: &str, params: &[Param]) -> Result<Option<Exception>> {
    let Some(value) = laws.get(key) else { return Ok(None) };
    let inner = value.table()?;
    let set = inner.require("set", "`set = { parameter = value }`, where the law is not kept")?;
    let values = read_set(&set, params, "the exception")?;
    let reason = non_empty(&inner.require("reason", "`reason = \"...\"`")?)?;
    inner.finish()?;
    Ok(Some(Exception { values, reason }))
}
