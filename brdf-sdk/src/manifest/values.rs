//! Values of parameters: from the command line, from TOML, and back.
//!
//! A value that stands here lies in its parameter's range. Files are paths, and nobody looks for them here.

use std::fmt;

use super::{Manifest, Param, ParamType};
use crate::problem::{Problem, Result};
use crate::table::{Table, Value, suggestion};

/// The value of one parameter, inside its range.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamValue {
    /// Of a `float`.
    Float(f64),
    /// Of an `int`.
    Int(i64),
    /// Of a `bool`.
    Bool(bool),
    /// Of a `color`, linear Rec. 709.
    Color([f64; 3]),
    /// Of a `choice`: the option's name.
    Choice(String),
    /// Of a `file`: a path, empty where none is set.
    File(String),
}

/// A value for every parameter of one plugin, in the manifest's order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParamValues(Vec<(String, ParamValue)>);

impl ParamValue {
    /// The parameter's default.
    pub fn default_of(param: &Param) -> Self {
        match &param.ty {
            ParamType::Float { default, .. } => Self::Float(*default),
            ParamType::Int { default, .. } => Self::Int(*default),
            ParamType::Bool { default } => Self::Bool(*default),
            ParamType::Color { default, .. } => Self::Color(*default),
            ParamType::Choice { default, options } => Self::Choice(options[*default].clone()),
            ParamType::File { default, .. } => Self::File(default.clone().unwrap_or_default()),
        }
    }

    /// A value as written in TOML, checked against the parameter.
    pub fn from_toml(param: &Param, value: &Value<'_>) -> Result<Self> {
        let read = match &param.ty {
            ParamType::Float { .. } => Self::Float(value.number()?),
            ParamType::Int { .. } => Self::Int(value.integer()?),
            ParamType::Bool { .. } => Self::Bool(value.boolean()?),
            ParamType::Color { .. } => Self::Color(value.numbers()?),
            ParamType::Choice { .. } => Self::Choice(value.string()?),
            ParamType::File { .. } => Self::File(value.string()?),
        };
        read.check(param).map_err(|(reason, cure)| value.problem(reason, cure))?;
        Ok(read)
    }

    /// A value as written on the command line: `0.2`, `3`, `true`, `0.9,0.5,0.1`, `separable`.
    /// One number stands for a grey colour.
    pub fn from_text(param: &Param, text: &str) -> Result<Self> {
        let thing = format!("{}={text}", param.key);
        let wrong = |wanted: &str| {
            Problem::new(thing.clone(), format!("`{text}` is not {wanted}"), param.usage())
        };
        let number =
            |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let read = match &param.ty {
            ParamType::Float { .. } => Self::Float(number(text).ok_or_else(|| wrong("a number"))?),
            ParamType::Int { .. } => {
                Self::Int(text.trim().parse().map_err(|_| wrong("a whole number"))?)
            }
            ParamType::Bool { .. } => {
                Self::Bool(text.trim().parse().map_err(|_| wrong("true or false"))?)
            }
            ParamType::Color { .. } => {
                let channels: Option<Vec<f64>> = text.split(',').map(number).collect();
                Self::Color(match channels.as_deref() {
                    Some([grey]) => [*grey; 3],
                    Some([r, g, b]) => [*r, *g, *b],
                    _ => return Err(wrong("a colour r,g,b")),
                })
            }
            ParamType::Choice { .. } => Self::Choice(text.trim().to_owned()),
            ParamType::File { .. } => Self::File(text.to_owned()),
        };
        read.check(param).map_err(|(reason, cure)| Problem::new(thing, reason, cure))?;
        Ok(read)
    }

    /// The value as TOML writes it.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Float(number) => format!("{number:?}"),
            Self::Int(number) => number.to_string(),
            Self::Bool(value) => value.to_string(),
            Self::Color([r, g, b]) => format!("[{r:?}, {g:?}, {b:?}]"),
            Self::Choice(text) | Self::File(text) => toml::Value::String(text.clone()).to_string(),
        }
    }

    fn check(&self, param: &Param) -> Result<(), (String, String)> {
        let numbers = match self {
            Self::Float(number) => vec![*number],
            Self::Int(number) => vec![*number as f64],
            Self::Color(channels) => channels.to_vec(),
            _ => Vec::new(),
        };
        let range = match &param.ty {
            ParamType::Float { range, .. } | ParamType::Color { range, .. } => *range,
            ParamType::Int { range, .. } => range.map(|bound| bound as f64),
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        if let Some(number) =
            numbers.iter().find(|number| **number < range[0] || **number > range[1])
        {
            return Err((
                format!("{number} is outside the range [{}, {}]", range[0], range[1]),
                param.usage(),
            ));
        }
        if let (Self::Choice(name), ParamType::Choice { options, .. }) = (self, &param.ty)
            && !options.contains(name)
        {
            let known = options.iter().map(String::as_str);
            return Err((
                format!("`{name}` is no option of `{}`", param.key),
                suggestion(name, known),
            ));
        }
        Ok(())
    }
}

impl Param {
    /// How to set the parameter, in a few words.
    pub fn usage(&self) -> String {
        let key = &self.key;
        match &self.ty {
            ParamType::Float { range: [min, max], .. } => {
                format!("`{key}` is a number in [{min}, {max}]")
            }
            ParamType::Int { range: [min, max], .. } => {
                format!("`{key}` is a whole number in [{min}, {max}]")
            }
            ParamType::Bool { .. } => format!("`{key}` is true or false"),
            ParamType::Color { range: [min, max], .. } => {
                format!("`{key}` is a colour r,g,b with channels in [{min}, {max}]")
            }
            ParamType::Choice { options, .. } => {
                format!("`{key}` is one of {}", options.join(", "))
            }
            ParamType::File { .. } => format!("`{key}` is a path"),
        }
    }
}

impl ParamValues {
    /// The defaults of every parameter.
    pub fn defaults(manifest: &Manifest) -> Self {
        let params = manifest.params.iter();
        Self(params.map(|param| (param.key.clone(), ParamValue::default_of(param))).collect())
    }

    /// The value of a parameter.
    pub fn get(&self, key: &str) -> Option<&ParamValue> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// All values, in the manifest's order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &ParamValue)> {
        self.0.iter().map(|(key, value)| (key.as_str(), value))
    }

    /// Replaces one value; unknown keys are ignored, since values come checked against the manifest.
    pub fn set(&mut self, key: &str, value: ParamValue) {
        if let Some((_, slot)) = self.0.iter_mut().find(|(name, _)| name == key) {
            *slot = value;
        }
    }

    /// Applies one `key=value` of the command line.
    pub fn set_text(&mut self, manifest: &Manifest, assignment: &str) -> Result<()> {
        let pair = assignment.split_once('=').filter(|(key, _)| !key.trim().is_empty());
        let Some((key, text)) = pair else {
            return Err(Problem::new(assignment, "this sets nothing", "write key=value"));
        };
        let param = manifest.param(key.trim()).ok_or_else(|| {
            Problem::new(
                assignment,
                format!("{} has no parameter `{}`", manifest.name, key.trim()),
                suggestion(key.trim(), manifest.params.iter().map(|param| param.key.as_str())),
            )
        })?;
        self.set(&param.key, ParamValue::from_text(param, text)?);
        Ok(())
    }

    /// Applies every entry of a TOML table.
    pub fn set_table(&mut self, manifest: &Manifest, table: &Table<'_>) -> Result<()> {
        for entry in table.entries() {
            let param = manifest.param(&entry.key).ok_or_else(|| {
                table.problem(
                    entry.key_span.clone(),
                    format!("{} has no parameter `{}`", manifest.name, entry.key),
                    suggestion(&entry.key, manifest.params.iter().map(|param| param.key.as_str())),
                )
            })?;
            self.set(&param.key, ParamValue::from_toml(param, &entry.value)?);
        }
        Ok(())
    }
}

impl fmt::Display for ParamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(number) => write!(f, "{number}"),
            Self::Int(number) => write!(f, "{number}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Color([r, g, b]) => write!(f, "{r},{g},{b}"),
            Self::Choice(text) | Self::File(text) => write!(f, "{text}"),
        }
    }
}
