//! Recipes: procedural maps written in TOML, evaluated in f64 at any resolution.
//!
//! Lights add to the background; texels replace what lies under them. The keys are described in
//! `envmaps/README.md`. Reads no files; what an outline covers of a texel is `coverage`'s part.

mod read;

use std::f64::consts::PI;

use rayon::prelude::*;

use brdf_sdk::Result;
use brdf_sdk::table::Document;

use super::Picture;
use super::coverage::{Piece, Shape};

/// Rows of the background inside each row of texels.
const BACKGROUND_STEPS: u32 = 32;

/// A recipe as read.
#[derive(Debug, Clone)]
struct Recipe {
    width: u32,
    background: Background,
    lights: Vec<Light>,
    texels: Vec<Texel>,
}

/// Radiance that depends on the elevation alone.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Background {
    zenith: [f64; 3],
    horizon: [f64; 3],
    ground: [f64; 3],
    /// Powers of the elevation's sine by which the horizon blends into zenith and ground.
    power: [f64; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Light {
    shape: Shape,
    radiance: [f64; 3],
}

/// One texel, at a place in [0, 1) of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Texel {
    u: f64,
    v: f64,
    radiance: [f64; 3],
}

/// Reads the recipe `source`, called `file` in messages, and evaluates it at `width` columns or at its default.
pub fn evaluate(file: &str, source: &str, width: Option<u32>) -> Result<Picture> {
    let recipe = Document { file, source }.read(read::recipe)?;
    let width = match width {
        Some(width) => read::checked_width(i64::from(width)).map_err(|(reason, cure)| {
            brdf_sdk::Problem::new(file, format!("a width of {width} {reason}"), cure)
        })?,
        None => recipe.width,
    };
    let height = width / 2;
    let mut texels = vec![[0.0_f32; 4]; width as usize * height as usize];
    texels
        .par_chunks_mut(width as usize)
        .enumerate()
        .for_each(|(y, row)| recipe.fill_row(y as u32, height, row));
    for texel in &recipe.texels {
        let x = (texel.u * f64::from(width)) as u32;
        let y = (texel.v * f64::from(height)) as u32;
        texels[(y.min(height - 1) * width + x.min(width - 1)) as usize] = rgba(texel.radiance);
    }
    Ok(Picture { width, height, texels, declared: None, notes: Vec::new() })
}

impl Recipe {
    fn fill_row(&self, y: u32, height: u32, row: &mut [[f32; 4]]) {
        let theta = [y, y + 1].map(|edge| PI * f64::from(edge) / f64::from(height));
        let cos_theta = theta.map(f64::cos);
        let background = self.background.mean(cos_theta);
        // Lights that this row may see.
        let lights = self.lights.iter().filter(|light| {
            let (axis, radius) = light.shape.bound();
            let polar = axis.x.hypot(axis.z).atan2(axis.y);
            polar - radius < theta[1] && polar + radius > theta[0]
        });
        let lights: Vec<&Light> = lights.collect();
        let step = 1.0 / row.len() as f64;
        for (x, texel) in row.iter_mut().enumerate() {
            let u = [x as f64 * step, (x + 1) as f64 * step];
            let mut radiance = background;
            for light in &lights {
                let coverage = light.shape.coverage(Piece { u, cos_theta });
                for (sum, value) in radiance.iter_mut().zip(light.radiance) {
                    *sum += coverage * value;
                }
            }
            *texel = rgba(radiance);
        }
    }
}

impl Background {
    /// The mean by solid angle between two cosines of the polar angle.
    fn mean(&self, [from, to]: [f64; 2]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for step in 0..BACKGROUND_STEPS {
            let t = (f64::from(step) + 0.5) / f64::from(BACKGROUND_STEPS);
            let radiance = self.at(from + t * (to - from));
            sum.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += value);
        }
        sum.map(|sum| sum / f64::from(BACKGROUND_STEPS))
    }

    fn at(&self, sine: f64) -> [f64; 3] {
        let (end, power) =
            if sine > 0.0 { (self.zenith, self.power[0]) } else { (self.ground, self.power[1]) };
        let t = sine.abs().powf(power);
        std::array::from_fn(|i| self.horizon[i] + t * (end[i] - self.horizon[i]))
    }
}

fn rgba([r, g, b]: [f64; 3]) -> [f32; 4] {
    [r as f32, g as f32, b as f32, 0.0]
}

#[cfg(test)]
mod tests;
