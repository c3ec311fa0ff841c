//! Environment maps: lat-long radiance in f32, linear Rec. 709, from a picture file or a recipe.
//!
//! [`load`] tells Radiance, OpenEXR and recipes apart by content; [`from_recipe`] evaluates a
//! recipe that is embedded in the program. May depend on brdf-sdk, glam, rayon and exr, never on
//! exec, render or ui. What it deliberately does not do: no importance tables; no rotation, which
//! is one uniform applied in the shaders; no clamping, and no repair that was not asked for.

mod bad_texels;
mod colour;
mod coverage;
pub mod cube;
mod filter;
mod importance;
mod openexr;
pub mod orientation;
mod radiance;
mod recipe;
mod texels;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use brdf_sdk::{Problem, Result};

pub use bad_texels::BadTexels;
pub use filter::Filter;
pub use importance::{Importance, Purpose, Weighting, importance, luminance, scale, solid_angle};
pub use texels::{order, texel_radiance, texture};

/// The largest map, in texels. A larger claim in a file's header is refused before anything is allocated.
pub const MAX_SIZE: (u32, u32) = (32_768, 16_384);

const SUPPORTED: &str =
    "give a Radiance picture (.hdr), an OpenEXR picture (.exr) or a recipe (.toml)";

/// How a map's texels lie on the sphere.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Layout {
    /// Rows of equal latitude, row 0 at +y; twice as wide as high (see [`orientation`]).
    #[default]
    LatLong,
    /// Six square faces, one below the other: +x, -x, +y, -y, +z, -z; six times as high as wide.
    Cube,
}

/// Radiance over all directions.
#[derive(Debug, Clone)]
pub struct Environment {
    /// The path or the recipe's name, as it was given.
    pub name: String,
    /// How the texels lie on the sphere.
    pub layout: Layout,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Radiance in the map's own units, linear Rec. 709, row by row; the fourth value is 0 and
    /// pads for an rgba32float texture. All finite and not negative.
    pub texels: Arc<Vec<[f32; 4]>>,
    /// Texels that were no radiance and were replaced, as [`Options::replace_bad`] asked.
    pub replaced: BadTexels,
    /// One-line facts worth telling: an EXPOSURE that was applied, a colour space that was converted.
    pub notes: Vec<String>,
    /// From the first access to the file until everything above was ready [s].
    pub seconds: f64,
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: f32) -> Self {
        Self {
            name: "furnace".to_owned(),
            layout: Layout::LatLong,
            width: 2,
            height: 1,
            texels: Arc::new(vec![[radiance, radiance, radiance, 0.0]; 2]),
            replaced: BadTexels::default(),
            notes: Vec::new(),
            seconds: 0.0,
        }
    }
}

/// What the person chose about a map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// Columns at which a recipe is evaluated, even; the recipe's own default without it. Pictures keep theirs.
    pub width: Option<u32>,
    /// Replace NaN and negative values by 0 and +infinity by the largest finite value of the map,
    /// instead of refusing the map.
    pub replace_bad: bool,
}

/// What a decoder delivers: texels not yet checked for being radiance.
#[derive(Debug)]
struct Picture {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
    notes: Vec<String>,
}

/// Loads a Radiance or OpenEXR picture, told apart by content, or a recipe.
pub fn load(path: &Path, options: &Options) -> Result<Environment> {
    let start = Instant::now();
    let name = path.display().to_string();
    let bytes = read(&name, path)?;
    let mut picture = if bytes.starts_with(b"#?") {
        radiance::decode(&name, &bytes)?
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        openexr::decode(&name, &bytes)?
    } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        let source = std::str::from_utf8(&bytes).map_err(|_| {
            Problem::new(&name, "the recipe is not UTF-8 text", "save it as UTF-8 text")
        })?;
        return finish(&name, recipe::evaluate(&name, source, options.width)?, options, start);
    } else {
        return Err(Problem::new(&name, unknown_content(&bytes), SUPPORTED));
    };
    if options.width.is_some() {
        picture.notes.push(format!(
            "kept at its own {}x{}: a width can be chosen for recipes only",
            picture.width, picture.height
        ));
    }
    finish(&name, picture, options, start)
}

/// Evaluates a recipe that is already in memory; messages show its place as in `file`.
pub fn from_recipe(name: &str, file: &str, source: &str, options: &Options) -> Result<Environment> {
    let start = Instant::now();
    finish(name, recipe::evaluate(file, source, options.width)?, options, start)
}

fn finish(name: &str, picture: Picture, options: &Options, start: Instant) -> Result<Environment> {
    let Picture { width, height, mut texels, mut notes } = picture;
    let replaced = bad_texels::settle(name, &mut texels, options.replace_bad)?;
    if !replaced.is_clean() {
        notes.push(format!(
            "replaced {replaced} texels (NaN and negative by 0, +infinity by the largest finite value)"
        ));
    }
    let seconds = start.elapsed().as_secs_f64();
    Ok(Environment {
        name: name.to_owned(),
        layout: Layout::LatLong,
        width,
        height,
        texels: Arc::new(texels),
        replaced,
        notes,
        seconds,
    })
}

fn read(name: &str, path: &Path) -> Result<Vec<u8>> {
    let failed = |error: std::io::Error| {
        let reason = match error.kind() {
            std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
            _ => format!("it cannot be read ({error})"),
        };
        Problem::new(name, reason, SUPPORTED)
    };
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if metadata.is_dir() {
        return Err(Problem::new(name, "this is a folder", SUPPORTED));
    }
    if !metadata.is_file() {
        return Err(Problem::new(name, "this is no regular file", SUPPORTED));
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    if bytes.is_empty() {
        return Err(Problem::new(name, "the file is empty", SUPPORTED));
    }
    Ok(bytes)
}

/// Says what a file seems to be that is no map.
fn unknown_content(bytes: &[u8]) -> String {
    let kinds: [(&[u8], &str); 6] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"II*\0", "a TIFF picture"),
        (b"MM\0*", "a TIFF picture"),
        (b"DDS ", "a DDS texture"),
        (b"PF\n", "a PFM picture"),
    ];
    match kinds.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        Some((_, kind)) => format!("this is {kind}, not a map that can be read"),
        None => "this is neither a Radiance nor an OpenEXR picture".to_owned(),
    }
}

/// Refuses sizes that are no lat-long panorama or beyond [`MAX_SIZE`]; called before anything is allocated.
fn check_size(name: &str, width: u64, height: u64) -> Result<(u32, u32)> {
    if width != 2 * height || height == 0 {
        return Err(Problem::new(
            name,
            format!(
                "the picture is {width}x{height}, a lat-long panorama is twice as wide as high"
            ),
            "give a full lat-long (equirectangular) panorama; convert or resize it with an image tool",
        ));
    }
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width), Ok(height)) if width <= MAX_SIZE.0 && height <= MAX_SIZE.1 => {
            Ok((width, height))
        }
        _ => Err(Problem::new(
            name,
            format!(
                "the picture is {width}x{height}, the largest map is {}x{}",
                MAX_SIZE.0, MAX_SIZE.1
            ),
            "give a smaller one",
        )),
    }
}

#[cfg(test)]
mod tests;
