//! A recipe from its TOML, every number inside its range.

use glam::DVec3;

use brdf_sdk::Result;
use brdf_sdk::table::{Table, Value};

use super::{Background, Light, Recipe, Texel};
use crate::environment::coverage::Shape;

/// Columns of a recipe that says nothing.
const DEFAULT_WIDTH: u32 = 1024;
/// The brightest light [the map's units]; leaves room for sums in f32.
const MAX_RADIANCE: f64 = 1e30;

/// Reads the root table.
pub fn recipe(root: &Table<'_>) -> Result<Recipe> {
    let kind = root.require("kind", "`kind = \"recipe\"`")?;
    if kind.string()? != "recipe" {
        return Err(kind.problem("this is no recipe of a map", "write `kind = \"recipe\"`"));
    }
    let format = root.require("format", "`format = 1`")?;
    if format.integer()? != 1 {
        return Err(format.problem("this format of recipes is not known", "write `format = 1`"));
    }
    root.require("about", "one sentence on the map")?.string()?;
    let width = match root.get("width") {
        Some(value) => checked_width(value.integer()?)
            .map_err(|(reason, cure)| value.problem(format!("this width {reason}"), cure))?,
        None => DEFAULT_WIDTH,
    };
    let background = match root.get("background") {
        Some(value) => background(&value.table()?)?,
        None => Background::constant([0.0; 3]),
    };
    let mut lights = Vec::new();
    each(root, "disk", |table| {
        lights.push(disk(table)?);
        Ok(())
    })?;
    each(root, "softbox", |table| {
        lights.push(softbox(table)?);
        Ok(())
    })?;
    let mut texels = Vec::new();
    each(root, "texel", |table| {
        texels.push(texel(table, width)?);
        Ok(())
    })?;
    Ok(Recipe { width, background, lights, texels })
}

/// A width that a map can have, or the reason and the cure.
pub fn checked_width(width: i64) -> Result<u32, (&'static str, &'static str)> {
    let cure = "give an even number from 2 to 32768";
    match u32::try_from(width) {
        Ok(width) if !width.is_multiple_of(2) => Err(("is odd", cure)),
        Ok(width) if (2..=crate::environment::MAX_SIZE.0).contains(&width) => Ok(width),
        _ => Err(("is out of range", cure)),
    }
}

impl Background {
    fn constant(radiance: [f64; 3]) -> Self {
        Self { zenith: radiance, horizon: radiance, ground: radiance, power: [1.0; 2] }
    }
}

fn each(root: &Table<'_>, key: &str, mut read: impl FnMut(&Table<'_>) -> Result<()>) -> Result<()> {
    let Some(list) = root.get(key) else { return Ok(()) };
    for item in list.items()? {
        let table = item.table()?;
        read(&table)?;
        table.finish()?;
    }
    Ok(())
}

fn background(table: &Table<'_>) -> Result<Background> {
    let background = match table.get("constant") {
        Some(value) => Background::constant(radiance(&value)?),
        None => Background {
            zenith: required_radiance(table, "zenith")?,
            horizon: required_radiance(table, "horizon")?,
            ground: required_radiance(table, "ground")?,
            power: [
                optional(table, "sky_power", 0.0, 10.0, 1.0)?,
                optional(table, "ground_power", 0.0, 10.0, 1.0)?,
            ],
        },
    };
    table.finish()?;
    Ok(background)
}

fn disk(table: &Table<'_>) -> Result<Light> {
    let (axis, _) = frame(table)?;
    let diameter = required(table, "diameter", "degrees across", 0.001, 180.0)?;
    let edge = optional(table, "edge", 0.0, 1.0, 0.0)?;
    let shape = Shape::Disk { axis, radius: diameter.to_radians() / 2.0, edge };
    Ok(Light { shape, radiance: required_radiance(table, "radiance")? })
}

fn softbox(table: &Table<'_>) -> Result<Light> {
    let (axis, right) = frame(table)?;
    let mut half = [0.0; 2];
    for (half, key) in half.iter_mut().zip(["width", "height"]) {
        let degrees = required(table, key, "degrees, seen from the origin", 0.001, 160.0)?;
        *half = (degrees.to_radians() / 2.0).tan();
    }
    let edge = optional(table, "edge", 0.0, 1.0, 0.0)?;
    let shape = Shape::Rectangle { axis, right, up: axis.cross(right), half, edge };
    Ok(Light { shape, radiance: required_radiance(table, "radiance")? })
}

/// The direction of `polar` and `azimuth`, and the horizontal direction of growing azimuth.
fn frame(table: &Table<'_>) -> Result<(DVec3, DVec3)> {
    let polar = required(table, "polar", "degrees from +y", 0.0, 180.0)?;
    let azimuth = required(table, "azimuth", "degrees from +z towards +x", -360.0, 360.0)?;
    let (sin_polar, cos_polar) = polar.to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
    let axis = DVec3::new(sin_polar * sin_azimuth, cos_polar, sin_polar * cos_azimuth);
    Ok((axis, DVec3::new(cos_azimuth, 0.0, -sin_azimuth)))
}

fn texel(table: &Table<'_>, width: u32) -> Result<Texel> {
    let (u, v) = if table.get("u").is_some() || table.get("v").is_some() {
        (fraction(table, "u")?, fraction(table, "v")?)
    } else {
        (index(table, "x", width)?, index(table, "y", width / 2)?)
    };
    Ok(Texel { u, v, radiance: required_radiance(table, "radiance")? })
}

fn fraction(table: &Table<'_>, key: &str) -> Result<f64> {
    let value = table.require(key, "a fraction of the map from 0 to below 1")?;
    let number = value.number()?;
    if !(0.0..1.0).contains(&number) {
        return Err(
            value.problem(format!("`{key}` is {number}"), "write a number from 0 to below 1")
        );
    }
    Ok(number)
}

/// The middle of a texel that is counted at the recipe's own width.
fn index(table: &Table<'_>, key: &str, count: u32) -> Result<f64> {
    let value = table.require(key, "a texel's index at the recipe's own width, or use u and v")?;
    let number = value.integer()?;
    if !(0..i64::from(count)).contains(&number) {
        let cure = format!("write a whole number from 0 to {}", count - 1);
        return Err(value.problem(format!("`{key}` is {number}"), cure));
    }
    Ok((number as f64 + 0.5) / f64::from(count))
}

fn required(table: &Table<'_>, key: &str, meaning: &str, least: f64, most: f64) -> Result<f64> {
    inside(&table.require(key, meaning)?, key, least, most)
}

fn optional(table: &Table<'_>, key: &str, least: f64, most: f64, default: f64) -> Result<f64> {
    table.get(key).map_or(Ok(default), |value| inside(&value, key, least, most))
}

fn inside(value: &Value<'_>, key: &str, least: f64, most: f64) -> Result<f64> {
    let number = value.number()?;
    if !(least..=most).contains(&number) {
        let cure = format!("write a number from {least} to {most}");
        return Err(value.problem(format!("`{key}` is {number}"), cure));
    }
    Ok(number)
}

fn required_radiance(table: &Table<'_>, key: &str) -> Result<[f64; 3]> {
    radiance(&table.require(key, "radiance as [red, green, blue], linear Rec. 709")?)
}

fn radiance(value: &Value<'_>) -> Result<[f64; 3]> {
    let rgb = value.numbers::<3>()?;
    if rgb.iter().any(|channel| !(0.0..=MAX_RADIANCE).contains(channel)) {
        return Err(value.problem("this is no radiance", "write three numbers from 0 to 1e30"));
    }
    Ok(rgb)
}
