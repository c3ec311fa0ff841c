//! The parameters of a plugin: what they mean decides how they are offered, passed and checked.
//!
//! Types, ranges, defaults and names in WGSL. No widgets: an interface makes those of the meaning. Values are
//! `values.rs`'s.

use std::ops::Range;

use super::named_in_wgsl;
use crate::problem::Result;
use crate::table::{Entry, Table, Value, suggestion};

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Its stable id: in WGSL, in sessions, in `--set key=value`.
    pub key: String,
    /// Its name in the interface; the key where the manifest gives none.
    pub label: Option<String>,
    /// One sentence on what it means.
    pub about: String,
    /// Its unit, where it has one.
    pub unit: Option<String>,
    /// What kind of value it holds.
    pub ty: ParamType,
}

/// What a parameter holds, with its default and its limits.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamType {
    /// A number, `f32` in WGSL.
    Float {
        /// Value where nobody sets one.
        default: f64,
        /// Hard limits, both included.
        range: [f64; 2],
        /// The part of the range that a slider offers.
        slider: [f64; 2],
        /// How the slider moves.
        scale: Scale,
    },
    /// A whole number, `i32` in WGSL.
    Int {
        /// Value where nobody sets one.
        default: i64,
        /// Hard limits, both included.
        range: [i64; 2],
        /// The part of the range that a slider offers.
        slider: [i64; 2],
    },
    /// A switch; a module constant of the linked program.
    Bool {
        /// Value where nobody sets one.
        default: bool,
    },
    /// Linear Rec. 709, `vec3f` in WGSL.
    Color {
        /// Value where nobody sets one.
        default: [f64; 3],
        /// Hard limits of each channel, both included.
        range: [f64; 2],
    },
    /// One of several named options; a module constant of the linked program.
    Choice {
        /// Index of the option where nobody sets one.
        default: usize,
        /// The options' names.
        options: Vec<String>,
    },
    /// A file that the plugin's native library reads.
    File {
        /// Path where nobody sets one, relative to the plugin's folder.
        default: Option<String>,
        /// Endings to offer, without the dot.
        extensions: Vec<String>,
        /// Bytes that such files begin with; where there are any, they decide what opens a file.
        magic: Vec<Vec<u8>>,
    },
}

/// How a slider maps its travel to values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal ratios.
    Log,
}

impl ParamType {
    /// The word for it in manifests.
    pub fn word(&self) -> &'static str {
        match self {
            ParamType::Float { .. } => "float",
            ParamType::Int { .. } => "int",
            ParamType::Bool { .. } => "bool",
            ParamType::Color { .. } => "color",
            ParamType::Choice { .. } => "choice",
            ParamType::File { .. } => "file",
        }
    }

    /// The WGSL type of its member in `Params`; `None` where it becomes constants or reaches no WGSL.
    pub fn wgsl_member(&self) -> Option<&'static str> {
        match self {
            ParamType::Float { .. } => Some("f32"),
            ParamType::Int { .. } => Some("i32"),
            ParamType::Color { .. } => Some("vec3f"),
            ParamType::Bool { .. } | ParamType::Choice { .. } | ParamType::File { .. } => None,
        }
    }
}

impl Param {
    /// How an author's WGSL reads it: `p.alpha`, or the constant `MASKING`.
    pub fn wgsl_use(&self) -> String {
        let constant = self.constant_names().into_iter().next();
        constant.unwrap_or_else(|| format!("p.{}", self.key))
    }

    /// The module constants that the parameter adds to its plugin's scope, without their values:
    /// the parameter itself in capitals, then one for each option of a choice.
    pub fn constant_names(&self) -> Vec<String> {
        let own = self.key.to_uppercase();
        match &self.ty {
            ParamType::Bool { .. } => vec![own],
            ParamType::Choice { options, .. } => {
                let of_option = options
                    .iter()
                    .map(|option| format!("{own}_{}", option.to_uppercase().replace('-', "_")));
                std::iter::once(own.clone()).chain(of_option).collect()
            }
            _ => Vec::new(),
        }
    }
}

pub(super) fn read_params(table: &Table<'_>) -> Result<Vec<Param>> {
    let mut params: Vec<Param> = Vec::new();
    for entry in named_in_wgsl(table)? {
        let inner = entry.value.table()?;
        let param = read_param(&entry, &inner)?;
        inner.finish()?;
        let taken: Vec<_> = params.iter().flat_map(Param::constant_names).collect();
        if let Some(name) = param.constant_names().iter().find(|name| taken.contains(name)) {
            return Err(table.problem(
                entry.key_span,
                format!(
                    "`{}` and an earlier parameter both define the constant `{name}`",
                    entry.key
                ),
                "rename the parameter or its option",
            ));
        }
        params.push(param);
    }
    Ok(params)
}

const TYPES: [&str; 6] = ["float", "int", "bool", "color", "choice", "file"];

fn read_param(entry: &Entry<'_>, table: &Table<'_>) -> Result<Param> {
    let ty = table.require("type", "`type = \"float\"`, or int, bool, color, choice, file")?;
    let word = ty.string()?;
    let read = match word.as_str() {
        "float" => read_float(table)?,
        "int" => read_int(table)?,
        "bool" => ParamType::Bool { default: default_of(table)?.boolean()? },
        "color" => read_color(table)?,
        "choice" => read_choice(table)?,
        "file" => read_file(table)?,
        _ => {
            return Err(ty.problem(
                format!("there is no parameter type `{word}`"),
                suggestion(&word, TYPES.into_iter()),
            ));
        }
    };
    Ok(Param {
        key: entry.key.clone(),
        label: table.get("label").map(|value| value.string()).transpose()?,
        about: table.require("about", "`about = \"...\"`, one sentence")?.string()?,
        unit: table.get("unit").map(|value| value.string()).transpose()?,
        ty: read,
    })
}

fn default_of<'a>(table: &Table<'a>) -> Result<Value<'a>> {
    table.require("default", "`default = ...`, the value where nobody sets one")
}

fn read_float(table: &Table<'_>) -> Result<ParamType> {
    let range_value = table.require("range", "`range = [min, max]`, the hard limits")?;
    let range = ordered(&range_value)?;
    let slider = read_slider(table, range)?;
    let default = within(&default_of(table)?, range)?;
    let scale = match table.get("scale") {
        None => Scale::Linear,
        Some(value) => match value.string()?.as_str() {
            "linear" => Scale::Linear,
            "log" if slider[0] > 0.0 => Scale::Log,
            "log" => {
                return Err(value.problem(
                    format!("a log scale cannot begin at {}", slider[0]),
                    "give `range` or `slider` a positive minimum",
                ));
            }
            other => {
                return Err(value.problem(
                    format!("there is no scale `{other}`"),
                    "write \"linear\" or \"log\"",
                ));
            }
        },
    };
    Ok(ParamType::Float { default, range, slider, scale })
}

fn read_int(table: &Table<'_>) -> Result<ParamType> {
    let whole = |value: &Value<'_>| -> Result<[i64; 2]> {
        let range = ordered(value)?;
        let limits = f64::from(i32::MIN)..=f64::from(i32::MAX);
        if range.iter().any(|bound| bound.fract() != 0.0 || !limits.contains(bound)) {
            return Err(
                value.problem("these limits are no 32-bit whole numbers", "write whole numbers")
            );
        }
        Ok(range.map(|bound| bound as i64))
    };
    let range = whole(&table.require("range", "`range = [min, max]`, the hard limits")?)?;
    let slider = match table.get("slider") {
        Some(value) => {
            let slider = whole(&value)?;
            inside(&value, slider.map(|v| v as f64), range.map(|v| v as f64))?;
            slider
        }
        None => range,
    };
    let value = default_of(table)?;
    let default = value.integer()?;
    within(&value, range.map(|bound| bound as f64))?;
    Ok(ParamType::Int { default, range, slider })
}

fn read_color(table: &Table<'_>) -> Result<ParamType> {
    let range = match table.get("range") {
        Some(value) => ordered(&value)?,
        None => [0.0, 1.0],
    };
    let value = default_of(table)?;
    let default = value.numbers::<3>()?;
    for item in value.items()? {
        within(&item, range)?;
    }
    Ok(ParamType::Color { default, range })
}

fn read_choice(table: &Table<'_>) -> Result<ParamType> {
    let value = table.require("options", "`options = [\"a\", \"b\"]`, the names to choose from")?;
    let mut options: Vec<String> = Vec::new();
    for item in value.items()? {
        let option = item.string()?;
        let well_formed = option.starts_with(|c: char| c.is_ascii_lowercase())
            && option.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
        if !well_formed {
            return Err(item.problem(
                format!("`{option}` cannot be an option's name"),
                "use lower-case letters, digits and `-`, beginning with a letter",
            ));
        }
        if options.contains(&option) {
            return Err(item.problem(format!("the option `{option}` stands twice"), "remove one"));
        }
        options.push(option);
    }
    if options.len() < 2 {
        return Err(value.problem("a choice needs at least two options", "add options"));
    }
    let default_value = default_of(table)?;
    let default = default_value.string()?;
    let default = options.iter().position(|option| *option == default).ok_or_else(|| {
        default_value.problem(
            format!("the default `{default}` is none of the options"),
            suggestion(&default, options.iter().map(String::as_str)),
        )
    })?;
    Ok(ParamType::Choice { default, options })
}

fn read_file(table: &Table<'_>) -> Result<ParamType> {
    Ok(ParamType::File {
        default: table.get("default").map(|value| value.string()).transpose()?,
        extensions: match table.get("extensions") {
            Some(value) => value.items()?.iter().map(read_ending).collect::<Result<_>>()?,
            None => Vec::new(),
        },
        magic: match table.get("magic") {
            Some(value) => value.items()?.iter().map(read_magic).collect::<Result<_>>()?,
            None => Vec::new(),
        },
    })
}

/// What stands behind the last dot of a file's name.
fn read_ending(value: &Value<'_>) -> Result<String> {
    let ending = value.string()?;
    match ending.is_empty() || ending.contains(['.', '/']) {
        true => Err(value.problem(
            format!("`{ending}` is no ending of a file"),
            "write what stands behind the last dot, such as \"binary\"",
        )),
        false => Ok(ending),
    }
}

/// Bytes as hexadecimal digits, two a byte.
fn read_magic(value: &Value<'_>) -> Result<Vec<u8>> {
    let text = value.string()?;
    let digits: Option<Vec<u32>> = text.chars().map(|c| c.to_digit(16)).collect();
    match digits {
        Some(digits) if (4..=64).contains(&digits.len()) && digits.len() % 2 == 0 => {
            Ok(digits.chunks(2).map(|pair| (pair[0] * 16 + pair[1]) as u8).collect())
        }
        _ => Err(value.problem(
            format!("`{text}` is no magic of a file"),
            "write 2 to 32 bytes as hexadecimal digits, such as \"5a0000005a000000\"",
        )),
    }
}

fn read_slider(table: &Table<'_>, range: [f64; 2]) -> Result<[f64; 2]> {
    let Some(value) = table.get("slider") else { return Ok(range) };
    let slider = ordered(&value)?;
    inside(&value, slider, range)?;
    Ok(slider)
}

fn inside(value: &Value<'_>, slider: [f64; 2], range: [f64; 2]) -> Result<()> {
    if slider[0] < range[0] || slider[1] > range[1] {
        return Err(value.problem(
            format!(
                "the slider [{}, {}] exceeds the range [{}, {}]",
                slider[0], slider[1], range[0], range[1]
            ),
            "keep the slider inside the range",
        ));
    }
    Ok(())
}

fn ordered(value: &Value<'_>) -> Result<[f64; 2]> {
    let range = value.numbers::<2>()?;
    if range[0] >= range[1] {
        return Err(value.problem(
            format!("the minimum {} is not below the maximum {}", range[0], range[1]),
            "write [min, max] with min < max",
        ));
    }
    Ok(range)
}

fn within(value: &Value<'_>, range: [f64; 2]) -> Result<f64> {
    let number = value.number()?;
    if !(Range { start: range[0], end: range[1] }.contains(&number) || number == range[1]) {
        return Err(value.problem(
            format!("the default {number} is outside the range [{}, {}]", range[0], range[1]),
            "move the default or widen the range",
        ));
    }
    Ok(number)
}
