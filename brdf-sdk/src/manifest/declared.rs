//! What a plugin declares beside its parameters: presets, exceptions to the laws, arrays, state.

use super::{Kind, Param, ParamValue, non_empty, wgsl_name};
use crate::problem::Result;
use crate::table::{Table, Value, suggestion};

/// A named set of parameter values.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: String,
    /// What it shows.
    pub about: Option<String>,
    /// The values it sets; the other parameters keep their defaults.
    pub values: Vec<(String, ParamValue)>,
}

/// What a BRDF declares about the laws that every BRDF is held to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Laws {
    /// The preset whose directional albedo is the largest that the model reaches.
    pub white: Option<String>,
    /// Why f(wo, wi) = f(wi, wo) does not hold, where it does not.
    pub not_reciprocal: Option<String>,
    /// How far the directional albedo exceeds 1, where it does.
    pub energy: Option<EnergyBound>,
}

/// A measured bound of the directional albedo of a model that gains energy.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyBound {
    /// The largest directional albedo, above 1.
    pub bound: f64,
    /// Why the model exceeds 1.
    pub reason: String,
}

/// An array that a native library fills and the plugin's WGSL reads as `<name>_at(i)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name in WGSL.
    pub name: String,
    /// The type of its elements.
    pub element: Element,
    /// What it holds.
    pub about: Option<String>,
}

/// A table that the host fills by the author's `fill_<name>` before the plugin is used, and that its other
/// functions read as `<name>_at(i)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// Its name in WGSL.
    pub name: String,
    /// Columns and rows; entry (x, y) is `<name>_at(x + columns * y)`.
    pub size: [u32; 2],
    /// What it holds.
    pub about: Option<String>,
}

/// The element type of an [`Array`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// 32-bit float.
    F32,
    /// 32-bit unsigned integer.
    U32,
}

/// One field of an integrator's per-pixel memory.
#[derive(Debug, Clone, PartialEq)]
pub struct StateField {
    /// Its name in WGSL.
    pub name: String,
    /// Its number of f32 components, 1 to 4.
    pub components: usize,
}

impl StateField {
    /// Its type in WGSL.
    pub fn wgsl(&self) -> &'static str {
        match self.components {
            1 => "f32",
            2 => "vec2f",
            3 => "vec3f",
            _ => "vec4f",
        }
    }
}

pub(super) fn read_presets(table: &Table<'_>, params: &[Param]) -> Result<Vec<Preset>> {
    let mut presets = Vec::new();
    for entry in table.entries() {
        let inner = entry.value.table()?;
        let about = inner.get("about").map(|value| value.string()).transpose()?;
        let set = inner.require("set", "`set = { parameter = value }`")?.table()?;
        let mut values = Vec::new();
        for given in set.entries() {
            let param = params.iter().find(|param| param.key == given.key).ok_or_else(|| {
                table.problem(
                    given.key_span.clone(),
                    format!("the preset sets `{}`, which is no parameter", given.key),
                    suggestion(&given.key, params.iter().map(|param| param.key.as_str())),
                )
            })?;
            values.push((given.key.clone(), ParamValue::from_toml(param, &given.value)?));
        }
        inner.finish()?;
        presets.push(Preset { name: entry.key, about, values });
    }
    Ok(presets)
}

pub(super) fn read_laws(table: &Table<'_>, kind: Kind, presets: &[Preset]) -> Result<Laws> {
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
    inner.finish()?;
    Ok(Laws { white, not_reciprocal, energy })
}

pub(super) fn read_arrays(table: &Table<'_>, has_library: bool) -> Result<Vec<Array>> {
    let Some(value) = table.get("arrays") else { return Ok(Vec::new()) };
    if !has_library {
        return Err(value.problem(
            "arrays are filled by a native library, and the manifest names none",
            "add `library = \"...\"` or remove [arrays]",
        ));
    }
    let mut arrays = Vec::new();
    let outer = value.table()?;
    for entry in outer.entries() {
        wgsl_name(&outer, &entry.key, entry.key_span.clone())?;
        let inner = entry.value.table()?;
        let ty = inner.require("type", "`type = \"f32\"` or `type = \"u32\"`")?;
        let element = match ty.string()?.as_str() {
            "f32" => Element::F32,
            "u32" => Element::U32,
            other => {
                return Err(ty.problem(
                    format!("there is no array type `{other}`"),
                    "write \"f32\" or \"u32\"",
                ));
            }
        };
        let about = inner.get("about").map(|value| value.string()).transpose()?;
        inner.finish()?;
        arrays.push(Array { name: entry.key, element, about });
    }
    Ok(arrays)
}

/// Entries of one table at the most.
const MOST_ENTRIES: i64 = 1 << 16;

pub(super) fn read_tables(table: &Table<'_>, kind: Kind) -> Result<Vec<Filled>> {
    let Some(value) = table.get("tables") else { return Ok(Vec::new()) };
    if kind != Kind::Brdf {
        return Err(value.problem("only a BRDF has tables", "remove [tables]"));
    }
    let mut tables = Vec::new();
    let outer = value.table()?;
    for entry in outer.entries() {
        wgsl_name(&outer, &entry.key, entry.key_span.clone())?;
        let inner = entry.value.table()?;
        let size = inner.require("size", "`size = [32, 32]`, columns and rows")?;
        let sides = size.items()?;
        let sides: Vec<i64> = sides.iter().map(Value::integer).collect::<Result<_>>()?;
        let fits =
            matches!(sides[..], [w, h] if w >= 2 && h >= 2 && w.saturating_mul(h) <= MOST_ENTRIES);
        if !fits {
            return Err(size.problem(
                "this is no size of a table",
                format!("give columns and rows, at least 2 each and {MOST_ENTRIES} entries in all"),
            ));
        }
        let about = inner.get("about").map(|value| value.string()).transpose()?;
        inner.finish()?;
        let size = [sides[0] as u32, sides[1] as u32];
        tables.push(Filled { name: entry.key, size, about });
    }
    Ok(tables)
}

pub(super) fn read_state(table: &Table<'_>, kind: Kind) -> Result<Vec<StateField>> {
    let Some(value) = table.get("state") else { return Ok(Vec::new()) };
    if kind != Kind::Integrator {
        return Err(value.problem("only an integrator can keep state", "remove [state]"));
    }
    let mut fields = Vec::new();
    let inner = value.table()?;
    for entry in inner.entries() {
        wgsl_name(&inner, &entry.key, entry.key_span.clone())?;
        let word = entry.value.string()?;
        let components = match word.as_str() {
            "f32" => 1,
            "vec2f" => 2,
            "vec3f" => 3,
            "vec4f" => 4,
            _ => {
                return Err(entry.value.problem(
                    format!("there is no state type `{word}`"),
                    suggestion(&word, ["f32", "vec2f", "vec3f", "vec4f"].into_iter()),
                ));
            }
        };
        fields.push(StateField { name: entry.key, components });
    }
    Ok(fields)
}

pub(super) fn read_compensated(table: &Table<'_>, kind: Kind) -> Result<bool> {
    let Some(value) = table.get("compensated") else { return Ok(false) };
    if kind != Kind::Integrator {
        return Err(
            value.problem("only an integrator draws from the environment", "remove `compensated`")
        );
    }
    value.boolean()
}
