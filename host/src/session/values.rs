//! Values of scene.toml: numbers in their ranges and words of the command line, or a problem at their place.

use brdf_sdk::Result;
use brdf_sdk::table::{Value, suggestion};

use crate::layout::word;

/// Sets `slot` where the value is there.
pub fn set<T>(
    slot: &mut T,
    value: Option<Value<'_>>,
    read: impl FnOnce(&Value<'_>) -> Result<T>,
) -> Result<()> {
    if let Some(value) = value {
        *slot = read(&value)?;
    }
    Ok(())
}

/// A whole number of at least `least`.
pub fn count(value: &Value<'_>, least: u32) -> Result<u32> {
    let number = value.integer()?;
    u32::try_from(number).ok().filter(|number| *number >= least).ok_or_else(|| {
        value.problem(
            format!("{number} is not between {least} and {}", u32::MAX),
            "write a whole number in that range",
        )
    })
}

/// One of the words that the command line takes.
pub fn one_of<T: clap::ValueEnum>(value: &Value<'_>) -> Result<T> {
    told(value, |text| format!("there is no `{text}` here"))
}

/// The same of all things of a kind that has a name.
pub fn one_of_all<T: clap::ValueEnum>(value: &Value<'_>, kind: &str) -> Result<T> {
    told(value, |text| format!("there is no {kind} `{text}`"))
}

fn told<T: clap::ValueEnum>(value: &Value<'_>, reason: impl Fn(&str) -> String) -> Result<T> {
    let text = value.string()?;
    T::from_str(&text, false).map_err(|_| {
        let words: Vec<String> = T::value_variants().iter().map(word).collect();
        value.problem(reason(&text), suggestion(&text, words.iter().map(String::as_str)))
    })
}

/// A finite number above 0.
pub fn positive(value: &Value<'_>) -> Result<f64> {
    let number = value.number()?;
    match number > 0.0 && number.is_finite() {
        true => Ok(number),
        false => Err(value.problem(format!("{number} is not above 0"), "write a positive number")),
    }
}
