//! Parameters as a manifest.
//!
//! The text of `plugin.toml`, and the keys under which the WGSL reads parameters. It is written here and not
//! checked: the host reads it as it reads anybody's.

use std::fmt::Write as _;

use brdf_sdk::reserved::RESERVED_WORDS;

use crate::Use;
use crate::file::{Parameter, Value};
use crate::types::{BOOL, FLOAT, Ty, VEC3};

/// A parameter with its key in the manifest.
pub(crate) struct Keyed<'a> {
    pub(crate) key: String,
    pub(crate) declared: &'a Parameter,
}

impl Keyed<'_> {
    /// How WGSL reads it: a switch is a constant of the program.
    pub(crate) fn wgsl_use(&self) -> String {
        match self.declared.value {
            Value::Bool(_) => self.key.to_uppercase(),
            _ => format!("p.{}", self.key),
        }
    }

    pub(crate) fn ty(&self) -> Ty {
        match self.declared.value {
            Value::Float { .. } => FLOAT,
            Value::Bool(_) => BOOL,
            Value::Color(_) => VEC3,
        }
    }
}

/// Keys for names: `baseColor` becomes `base_color`.
pub(crate) fn keys(parameters: &[Parameter]) -> Vec<Keyed<'_>> {
    let mut keyed: Vec<Keyed<'_>> = Vec::new();
    for declared in parameters {
        let mut key = String::new();
        let mut before = '_';
        for c in declared.name.trim_start_matches('_').chars() {
            if c.is_ascii_uppercase() && (before.is_ascii_lowercase() || before.is_ascii_digit()) {
                key.push('_');
            }
            key.push(c.to_ascii_lowercase());
            before = c;
        }
        if !key.starts_with(|c: char| c.is_ascii_lowercase()) {
            key.insert(0, 'x');
        }
        while RESERVED_WORDS.contains(&key.as_str()) || keyed.iter().any(|known| known.key == key) {
            key.push('_');
        }
        keyed.push(Keyed { key, declared });
    }
    keyed
}

/// A path without its folders: a plugin may go elsewhere.
fn last(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted.push(' '),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// A number with a point.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A value as TOML writes it.
fn written(value: &Value) -> String {
    match value {
        Value::Float { default, .. } => number(*default),
        Value::Bool(on) => on.to_string(),
        Value::Color(rgb) => format!("[{}]", rgb.map(number).join(", ")),
    }
}

/// The manifest's text.
pub(crate) fn write(
    file_name: &str,
    id: &str,
    parameters: &[Keyed<'_>],
    values: Option<Use<'_>>,
) -> String {
    let mut text = format!(
        "kind = \"brdf\"\nname = {}\nabout = {}\n",
        quoted(id),
        quoted(&format!("From the file {} of BRDF Explorer.", last(file_name)))
    );
    for Keyed { key, declared } in parameters {
        let ty = match declared.value {
            Value::Float { .. } => "float",
            Value::Bool(_) => "bool",
            Value::Color(_) => "color",
        };
        let _ = write!(
            text,
            "\n[params.{key}]\ntype = \"{ty}\"\ndefault = {}\n",
            written(&declared.value)
        );
        match declared.value {
            Value::Float { range: [min, max], default } => {
                let all = || declared.admitted.iter().copied().chain([default]);
                let mut range = [all().fold(min, f64::min), all().fold(max, f64::max)];
                if range[0] == range[1] {
                    range[1] += range[1].abs().max(1.0);
                }
                let _ = writeln!(text, "range = [{}, {}]", number(range[0]), number(range[1]));
            }
            Value::Bool(_) => {}
            Value::Color(rgb) => {
                let all = || declared.admitted.iter().copied().chain(rgb);
                let most = all().fold(1.0, f64::max);
                let least = all().fold(0.0, f64::min);
                if most > 1.0 || least < 0.0 {
                    let _ = writeln!(text, "range = [{}, {}]", number(least), number(most));
                }
            }
        }
        if *key != declared.name {
            let _ = writeln!(text, "label = {}", quoted(&declared.name));
        }
        let about = match declared.about.as_str() {
            "" => declared.name.as_str(),
            about => about,
        };
        let _ = writeln!(text, "about = {}", quoted(about));
    }
    // Which values reflect most nobody knows: those of the file are judged.
    let own = parameters.iter().map(|keyed| (keyed.key.as_str(), &keyed.declared.value));
    text += &preset(
        AS_IN_THE_FILE,
        "The file's own values: those that the law of energy looks at.",
        own,
    );
    if let Some(Use::Preset(given, name)) = values {
        let key = |name: &str| {
            parameters
                .iter()
                .find(|keyed| keyed.declared.name == name)
                .map(|keyed| keyed.key.as_str())
        };
        let set = given.parameters.iter().filter_map(|own| Some((key(&own.name)?, &own.value)));
        text += &preset(&preset_name(name), &format!("From the file {}.", last(&given.file)), set);
    }
    text + "\n[laws]\nwhite = \"" + AS_IN_THE_FILE + "\"\n"
}

/// The preset of the file's own values.
const AS_IN_THE_FILE: &str = "as_in_the_file";

/// A name that a preset may have.
fn preset_name(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let own: String = name.chars().map(letter).collect();
    match own.starts_with(|c: char| c.is_ascii_lowercase()) && own != AS_IN_THE_FILE {
        true => own,
        false => format!("preset_{own}"),
    }
}

fn preset<'a>(
    name: &str,
    about: &str,
    values: impl Iterator<Item = (&'a str, &'a Value)>,
) -> String {
    let set: Vec<String> =
        values.map(|(key, value)| format!("{key} = {}", written(value))).collect();
    format!("\n[presets.{name}]\nabout = {}\nset = {{ {} }}\n", quoted(about), set.join(", "))
}
