//! What a plugin declares beside its parameters: presets, tables that the host fills, state.
//!
//! Read from TOML through `table`, with the place of each mistake. What the WGSL has of them is the linker's to
//! check.

use super::{Kind, Param, ParamValue, named_in_wgsl};
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

/// Values of parameters, as `set = { key = value }` gives them; `whose` sets them.
pub(super) fn read_set(
    set: &Value<'_>,
    params: &[Param],
    whose: &str,
) -> Result<Vec<(String, ParamValue)>> {
    let set = set.table()?;
    let mut values = Vec::new();
    for given in set.entries() {
        let param = params.iter().find(|param| param.key == given.key).ok_or_else(|| {
            set.problem(
                given.key_span.clone(),
                format!("{whose} sets `{}`, which is no parameter", given.key),
                suggestion(&given.key, params.iter().map(|param| param.key.as_str())),
            )
        })?;
        values.push((given.key.clone(), ParamValue::from_toml(param, &given.value)?));
    }
    Ok(values)
}

pub(super) fn read_presets(table: &Table<'_>, params: &[Param]) -> Result<Vec<Preset>> {
    let mut presets = Vec::new();
    for entry in table.entries() {
        let inner = entry.value.table()?;
        let about = inner.get("about").map(|value| value.string()).transpose()?;
        let set = inner.require("set", "`set = { parameter = value }`")?;
        let values = read_set(&set, params, "the preset")?;
        inner.finish()?;
        presets.push(Preset { name: entry.key, about, values });
    }
    Ok(presets)
}

/// Entries of one table at the most.
const MOST_ENTRIES: i64 = 1 << 16;

pub(super) fn read_tables(table: &Table<'_>, kind: Kind) -> Result<Vec<Filled>> {
    let Some(value) = table.get("tables") else { return Ok(Vec::new()) };
    if kind != Kind::Brdf {
        return Err(value.problem("only a BRDF has tables", "remove [tables]"));
    }
    let mut tables = Vec::new();
    for entry in named_in_wgsl(&value.table()?)? {
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
    for entry in named_in_wgsl(&value.table()?)? {
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
