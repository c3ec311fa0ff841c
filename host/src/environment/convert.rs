//! From lat-long to cube and back, and to other sizes: each new texel is the mean over its solid angle.
//!
//! Texels are areas of constant radiance on both sides, weighted by their true overlap. What the conversion
//! changes of the energy, the radiance integrated over the sphere, is the error of `overlap`'s points; it is
//! measured and told each time.

use std::sync::Arc;
use std::time::Instant;

use brdf_sdk::{Problem, Result};
use rayon::prelude::*;

use super::overlap::Overlap;
use super::resample::{self, Mean, Pixels};
use super::{Environment, Layout, MAX_FACE, MAX_SIZE};
use crate::tone::luminance;

/// Rows of a cube whose overlaps are held at a time while a lat-long map is filled.
const BATCH: usize = 64;

/// A wanted form of a map; what is not given follows from the map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Form {
    /// How its texels lie; as they do without.
    pub layout: Option<Layout>,
    /// The side of a cube's faces [texels]; a quarter of a lat-long map's width, or its own, without.
    pub face: Option<u32>,
    /// The columns of a lat-long map; four faces of a cube, or its own, without.
    pub width: Option<u32>,
}

impl Environment {
    /// The map in another form, with a note on the change of energy; itself where it has that form already.
    ///
    /// Errors: a size for the other layout, odd widths, and sizes beyond [`MAX_SIZE`] and [`MAX_FACE`].
    pub fn in_form(self, form: Form) -> Result<Self> {
        let layout = form.layout.unwrap_or(self.layout);
        let asked = match layout {
            Layout::LatLong => form.width,
            Layout::Cube => form.face,
        };
        match (layout, form.face, form.width) {
            (Layout::LatLong, Some(face), _) => {
                let thing = format!("a face of {face}");
                let reason = format!("{} is to be a lat-long map, which has no faces", self.name);
                return Err(Problem::new(thing, reason, "ask for the layout `cube` as well"));
            }
            (Layout::Cube, _, Some(width)) => {
                let thing = format!("a width of {width}");
                let reason = format!("{} is to be a cube, whose size is that of a face", self.name);
                return Err(Problem::new(thing, reason, "give the size of a face instead"));
            }
            _ => {}
        }
        let size = match asked {
            Some(size) => checked(layout, size)?,
            None if layout == self.layout => self.width,
            None => default_size(layout, self.width),
        };
        if layout == self.layout && size == self.width {
            return Ok(self);
        }
        Ok(self.converted(layout, size))
    }

    /// The map in a layout at a size that has been checked.
    fn converted(self, layout: Layout, size: u32) -> Self {
        let start = Instant::now();
        let before = self.energy();
        let texels = match (self.layout, layout) {
            (Layout::LatLong, Layout::LatLong) => {
                resample::lat_long(&self.texels, self.width, Pixels::Areas, size)
            }
            (Layout::Cube, Layout::Cube) => {
                resample::cube(&self.texels, self.width, Pixels::Areas, size)
            }
            (Layout::LatLong, Layout::Cube) => to_cube(&self.texels, self.width, size),
            (Layout::Cube, Layout::LatLong) => to_lat_long(&self.texels, self.width, size),
        };
        let height = match layout {
            Layout::LatLong => size / 2,
            Layout::Cube => 6 * size,
        };
        let old = shown(self.layout, self.width);
        let mut new = Self { layout, width: size, height, texels: Arc::new(texels), ..self };
        let change = relative(luminance(before), luminance(new.energy()));
        new.notes.push(format!(
            "converted from {old} to {}: the energy changed by {change:+.1e} of it",
            shown(layout, size)
        ));
        new.seconds += start.elapsed().as_secs_f64();
        new
    }
}

/// By how much of `before` it changed; 0 where there was nothing.
pub fn relative(before: f64, after: f64) -> f64 {
    if before > 0.0 { (after - before) / before } else { 0.0 }
}

fn shown(layout: Layout, size: u32) -> String {
    match layout {
        Layout::LatLong => format!("a lat-long map of {size}x{}", size / 2),
        Layout::Cube => format!("a cube with faces of {size}x{size}"),
    }
}

/// The size that keeps the texels at the horizon as large as they are.
fn default_size(layout: Layout, width: u32) -> u32 {
    match layout {
        Layout::LatLong => (4 * width).min(MAX_SIZE.0),
        Layout::Cube => width.div_ceil(4).clamp(1, MAX_FACE),
    }
}

fn checked(layout: Layout, size: u32) -> Result<u32> {
    let (thing, fine, cure) = match layout {
        Layout::LatLong => (
            format!("a width of {size}"),
            size >= 2 && size.is_multiple_of(2) && size <= MAX_SIZE.0,
            format!("give an even number from 2 to {}", MAX_SIZE.0),
        ),
        Layout::Cube => (
            format!("a face of {size}"),
            (1..=MAX_FACE).contains(&size),
            format!("give a number from 1 to {MAX_FACE}"),
        ),
    };
    match fine {
        true => Ok(size),
        false => Err(Problem::new(thing, "this is no size of a map", cure)),
    }
}

/// A lat-long map of `width` columns as a cube with faces of `side`.
fn to_cube(texels: &[[f32; 4]], width: u32, side: u32) -> Vec<[f32; 4]> {
    let overlap = Overlap::new(side, width, width / 2);
    let side = side as usize;
    let mut cube = vec![[0.0; 4]; 6 * side * side];
    let (sides, rest) = cube.split_at_mut(2 * side * side);
    let (top, rest) = rest.split_at_mut(side * side);
    let (bottom, ends) = rest.split_at_mut(side * side);
    for (first, faces) in [(0, sides), (4, ends)] {
        faces.par_chunks_mut(side).enumerate().for_each(|(line, row)| {
            for (column, texel) in row.iter_mut().enumerate() {
                let mut mean = Mean::default();
                overlap.each(first + line / side, column, line % side, &mut |index, part| {
                    mean.add(texels[index], part);
                });
                *texel = mean.texel();
            }
        });
    }
    // The two polar faces take the most work, and what one covers the other covers in the mirror.
    let pairs = top.par_chunks_mut(side).zip(bottom.par_chunks_mut(side).rev());
    pairs.enumerate().for_each(|(row, (top, bottom))| {
        for (column, (up, down)) in top.iter_mut().zip(bottom).enumerate() {
            let mut means = [Mean::default(); 2];
            overlap.each(2, column, row, &mut |index, part| {
                means[0].add(texels[index], part);
                means[1].add(texels[overlap.mirrored(index)], part);
            });
            [*up, *down] = means.map(Mean::texel);
        }
    });
    cube
}

/// A cube with faces of `side` as a lat-long map of `width` columns.
fn to_lat_long(cube: &[[f32; 4]], side: u32, width: u32) -> Vec<[f32; 4]> {
    let height = width / 2;
    let overlap = Overlap::new(side, width, height);
    let side = side as usize;
    // The fourth value gathers weights in units of the texel, so that all values keep their range.
    let mut map = vec![[0.0_f32; 4]; width as usize * height as usize];
    let per_row: Vec<f64> = (0..height)
        .map(|row| 1.0 / super::orientation::texel_solid_angle(row, width, height))
        .collect();
    let lines: Vec<usize> = (0..6 * side).collect();
    for batch in lines.chunks(BATCH) {
        let parts = batch.par_iter().map(|line| {
            let mut parts = Vec::new();
            for column in 0..side {
                let [r, g, b, _] = cube[line * side + column];
                overlap.each(line / side, column, line % side, &mut |index, part| {
                    let weight = (part * per_row[index / width as usize]) as f32;
                    parts.push((index, [weight * r, weight * g, weight * b, weight]));
                });
            }
            parts
        });
        // Added in order, so that the digits do not depend on the number of threads.
        for (index, part) in parts.collect::<Vec<_>>().into_iter().flatten() {
            map[index].iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
    }
    map.par_iter_mut().for_each(|[r, g, b, weight]| {
        let scale = if *weight > 0.0 { 1.0 / *weight } else { 0.0 };
        (*r, *g, *b, *weight) = (*r * scale, *g * scale, *b * scale, 0.0);
    });
    map
}
