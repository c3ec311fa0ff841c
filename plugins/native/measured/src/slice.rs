//! Image slices: a material over theta_h and theta_d alone, from an image or a table of numbers.
//!
//! As BRDF Explorer shows them: theta_h grows to the right, theta_d upwards, each over 90 degrees. A table of
//! numbers begins with its columns and rows and lists the rows as the image would, the top one first; a pixel is
//! one number or three. What stands behind `#` is a comment.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::Cursor;
use std::panic::catch_unwind;

use brdf_sdk::native::{Array, Loaded};
use exr::meta::MetaData;
use exr::prelude::{Compression, ReadChannels, ReadLayers, Vec2};

use crate::file::{self, shown};

/// Bytes of a file at the most.
const MOST_BYTES: u64 = 256 << 20;

/// Pixels a side at the most.
const MOST_SIDE: usize = 4096;

/// A material: f_r [1/sr] in pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Pixels along theta_h.
    pub columns: usize,
    /// Red, green, blue, theta_h fastest, theta_d from 0 on.
    pub pixels: Vec<[f32; 3]>,
    /// Pixels that were below 0 in a channel.
    pub negative: usize,
}

/// The arrays of a file, or of a gloss that is made up.
pub fn load(path: Option<&str>) -> Result<Loaded, String> {
    let slice = match path {
        None => made_up(),
        Some(path) => parse(&file::whole(path, MOST_BYTES)?)?,
    };
    let shape = [(slice.pixels.len() / slice.columns) as u64, slice.columns as u64, 3];
    let negative = slice.negative;
    let mut loaded = Loaded::new([Array::f32("slice", shape, slice.pixels.into_flattened())]);
    if negative > 0 {
        loaded.notes.push(format!("pixels that are below 0 and were raised to it: {negative}"));
    }
    Ok(loaded)
}

/// Reads a picture or a table.
pub fn parse(bytes: &[u8]) -> Result<Slice, String> {
    const OPENEXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    let (columns, from_top) = match bytes.starts_with(&OPENEXR) {
        true => picture(bytes)?,
        false => table(bytes)?,
    };
    if columns == 0 || from_top.is_empty() {
        return Err("it holds no pixels; name an image with some".to_owned());
    }
    let mut negative = 0;
    for (index, pixel) in from_top.iter().enumerate() {
        if let Some(bad) = pixel.iter().find(|c| !c.is_finite()) {
            let (x, y) = (index % columns, index / columns);
            return Err(format!(
                "its pixel ({x}, {y}) holds {bad}; give every pixel a finite number"
            ));
        }
        negative += usize::from(pixel.iter().any(|c| *c < 0.0));
    }
    let rows = from_top.chunks(columns).rev().flatten();
    let pixels = rows.map(|pixel| pixel.map(|c| c.max(0.0))).collect();
    Ok(Slice { columns, pixels, negative })
}

/// Columns, and pixels from the top row on.
type Pixels = (usize, Vec<[f32; 3]>);

/// The decoder takes memory as headers ask for it, and asserts on some contradictions in damaged files: sizes are
/// looked at before, and its panics end here.
fn picture(bytes: &[u8]) -> Result<Pixels, String> {
    let unreadable = |why: &str| {
        let why = shown(why, 120);
        format!("it cannot be read as an OpenEXR image with R, G and B ({why}); save it again")
    };
    let wrong = |error: exr::error::Error| unreadable(&error.to_string());
    let decoded = catch_unwind(|| {
        fitting(&MetaData::read_from_buffered(bytes, false).map_err(wrong)?, bytes.len())?;
        pixels(bytes).map_err(wrong)
    });
    decoded.unwrap_or_else(|_| Err(unreadable("its decoder gave up")))
}

/// Refuses a picture with a layer that asks for more than is read.
fn fitting(picture: &MetaData, length: usize) -> Result<(), String> {
    for layer in &picture.headers {
        let (size, block) = (layer.layer_size, layer.max_block_pixel_size());
        if size.0.max(size.1) > MOST_SIDE {
            return Err(format!(
                "it has {} x {} pixels, and {MOST_SIDE} a side are the most; make it smaller",
                size.0, size.1
            ));
        }
        let bytes = |columns: usize, rows: usize| {
            (columns as u64 * rows as u64).saturating_mul(layer.channels.bytes_per_pixel as u64)
        };
        let block = bytes(block.0.min(size.0), block.1.min(size.1));
        if block > MOST_BYTES {
            return Err(format!(
                "a block of its pixels takes {block} bytes, and {MOST_BYTES} are the most; save it with R, G and B alone"
            ));
        }
        // Deflate shrinks 1032 times at most, PXR24 by a third more before it, run lengths less; DWA keeps one value
        // of an 8x8 square and deflates those.
        let shrinks = match layer.compression {
            Compression::Uncompressed => 1,
            Compression::DWAA(_) | Compression::DWAB(_) => 100_000,
            _ => 1_400,
        };
        if bytes(size.0, size.1) > shrinks * length as u64 {
            return Err(format!(
                "{length} bytes cannot hold its {} x {} pixels; it was cut off, so fetch it again",
                size.0, size.1
            ));
        }
    }
    Ok(())
}

fn pixels(bytes: &[u8]) -> exr::error::Result<Pixels> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            // A pixel that no block brings stays NaN, which is refused.
            |size: Vec2<usize>, _: &_| (size.0, vec![[f32::NAN; 3]; size.0 * size.1]),
            |(columns, pixels): &mut Pixels, at: Vec2<usize>, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.1 * *columns + at.0) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}

fn table(bytes: &[u8]) -> Result<Pixels, String> {
    let form = "write columns and rows, then each row's pixels as one number or three";
    let text = std::str::from_utf8(bytes).map_err(|_| {
        "it is neither an OpenEXR image nor text; name a file of either kind".to_owned()
    })?;
    let mut words = text.lines().enumerate().flat_map(|(line, text)| {
        let text = text.split('#').next().unwrap_or_default();
        let words =
            text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        words.map(move |word| (line + 1, word))
    });
    let mut size = |what: &str| match words.next() {
        None => Err(format!("it has no number of {what}; {form}")),
        Some((line, word)) => match word.parse::<usize>() {
            Ok(n) if (1..=MOST_SIDE).contains(&n) => Ok(n),
            _ => Err(format!(
                "line {line}: `{}` is no number of {what} up to {MOST_SIDE}; {form}",
                shown(word, 32)
            )),
        },
    };
    let (columns, rows) = (size("columns")?, size("rows")?);
    let mut numbers = Vec::new();
    for (line, word) in words {
        let number = word
            .parse::<f32>()
            .map_err(|_| format!("line {line}: `{}` is no number; {form}", shown(word, 32)))?;
        numbers.push(number);
    }
    let count = columns * rows;
    let pixels = match numbers.len() {
        given if given == count => numbers.iter().map(|n| [*n; 3]).collect(),
        given if given == 3 * count => numbers.as_chunks::<3>().0.to_vec(),
        given => {
            return Err(format!(
                "it has {given} numbers behind its size, and {columns} x {rows} pixels need {count} or {}; {form}",
                3 * count
            ));
        }
    };
    Ok((columns, pixels))
}

/// A green gloss whose terms depend on theta_h and theta_d alone: Lambert, and GGX's distribution times Schlick's
/// Fresnel term over 4, as with the masking cos(wo) cos(wi). Columns by the square root of theta_h.
fn made_up() -> Slice {
    const SIDE: usize = 90;
    const ALPHA: f64 = 0.2;
    const BASE: [f64; 3] = [0.05, 0.3, 0.08];
    const F0: f64 = 0.05;
    let pixel = |index: usize| {
        let part = |n: usize| (n as f64 + 0.5) / SIDE as f64;
        let root = part(index % SIDE);
        let (theta_h, theta_d) = (root * root * FRAC_PI_2, part(index / SIDE) * FRAC_PI_2);
        let (sine, cosine) = theta_h.sin_cos();
        let q = (sine / ALPHA).powi(2) + cosine * cosine;
        let distribution = 1.0 / (PI * ALPHA * ALPHA * q * q);
        let fresnel = F0 + (1.0 - F0) * (1.0 - theta_d.cos()).powi(5);
        BASE.map(|base| ((1.0 - F0) * base / PI + fresnel * distribution / 4.0) as f32)
    };
    Slice { columns: SIDE, pixels: (0..SIDE * SIDE).map(pixel).collect(), negative: 0 }
}
