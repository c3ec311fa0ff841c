//! Environment maps: radiance in f32, linear Rec. 709, from picture files or a recipe.
//!
//! [`load`] tells Radiance, OpenEXR, Ptex and recipes apart by content, and lat-long maps, crosses and strips
//! by their shape; [`from_recipe`] evaluates a recipe that is embedded in the program. Of the host it names
//! `layout` and `tone`, the words and the colour space, `file`, and nothing that knows of devices. What it deliberately
//! does not do: no rotation, which is one uniform applied in the shaders; no clamping, and no repair that was
//! not asked for.

mod arrangement;
mod bad_texels;
mod colour;
mod convert;
mod coverage;
pub mod cube;
mod facts;
mod filter;
mod importance;
mod lookup;
mod openexr;
pub mod orientation;
mod overlap;
mod ptex;
mod radiance;
mod recipe;
mod resample;
mod six_files;
mod texels;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use brdf_sdk::{Problem, Result};

pub use crate::layout::{Arrangement, Layout};
pub use arrangement::pack;
pub use convert::Form;
pub use facts::Facts;
pub use filter::Filter;
pub use importance::{Importance, Purpose, Weighting, importance, scale};
pub use six_files::{face_paths, files_of};
pub use texels::{order, texel_radiance, texture};

use crate::file;
use resample::Pixels;

/// The largest map, in texels. A larger claim in a file's header is refused before anything is allocated.
pub const MAX_SIZE: (u32, u32) = (32_768, 16_384);

/// The largest side of a cube's face, in texels: six of them are no longer than the longest map.
pub const MAX_FACE: u32 = MAX_SIZE.0 / 6;

const SUPPORTED: &str = "give a Radiance picture (.hdr), an OpenEXR picture (.exr), a Ptex cube (.ptx) or a \
                         recipe (.toml)";

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
            notes: Vec::new(),
            seconds: 0.0,
        }
    }
}

/// What the person chose about a map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// Columns of a lat-long map: those at which a recipe is evaluated, even, its own default without it;
    /// those of a cube that becomes a lat-long map. Other pictures keep theirs.
    pub width: Option<u32>,
    /// Replace NaN and negative values by 0 and +infinity by the largest finite value of the map,
    /// instead of refusing the map.
    pub replace_bad: bool,
    /// How a picture is to be read; told by the file and its shape without it.
    pub arrangement: Option<Arrangement>,
    /// The layout that is wanted; that of the file without it.
    pub layout: Option<Layout>,
    /// The side of a cube's faces in texels; that of the file, or a quarter of a lat-long map's width, without it.
    pub face: Option<u32>,
}

/// What a decoder delivers: texels not yet checked for being radiance.
#[derive(Debug)]
struct Picture {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
    /// What the file itself says about its arrangement.
    declared: Option<Arrangement>,
    notes: Vec<String>,
}

/// Texels in a layout, not yet checked for being radiance.
struct Raw {
    layout: Layout,
    width: u32,
    /// Where the cells of its pixels lie.
    pixels: Pixels,
    texels: Vec<[f32; 4]>,
    notes: Vec<String>,
}

/// Loads a Radiance or OpenEXR picture, a Ptex cube, six pictures named with a `%`, or a recipe.
pub fn load(path: &Path, options: &Options) -> Result<Environment> {
    let start = Instant::now();
    let name = path.display().to_string();
    if six_files::is_named(path) {
        let picture = six_files::read(&name, path, options.arrangement)?;
        let raw = arranged(&name, picture, Some(Arrangement::StripCol))?;
        return finish(&name, raw, options, start);
    }
    let bytes = read(path)?;
    let raw = if bytes.starts_with(ptex::MAGIC) {
        if options.arrangement.is_some() {
            let cure = "leave out how it is to be read";
            return Err(Problem::new(&name, "a Ptex file is always a cube of six faces", cure));
        }
        let (side, texels, notes) = ptex::decode(&name, &bytes)?;
        Raw { layout: Layout::Cube, width: side, pixels: Pixels::Areas, texels, notes }
    } else if let Some(picture) = decode(&name, &bytes) {
        arranged(&name, picture?, options.arrangement)?
    } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        let source = std::str::from_utf8(&bytes).map_err(|_| {
            Problem::new(&name, "the recipe is not UTF-8 text", "save it as UTF-8 text")
        })?;
        return evaluate(&name, &name, source, options, start);
    } else {
        return Err(Problem::new(&name, unknown_content(&bytes), SUPPORTED));
    };
    finish(&name, raw, options, start)
}

/// Evaluates a recipe that is already in memory; messages show its place as in `file`.
pub fn from_recipe(name: &str, file: &str, source: &str, options: &Options) -> Result<Environment> {
    evaluate(name, file, source, options, Instant::now())
}

fn evaluate(
    name: &str,
    file: &str,
    source: &str,
    options: &Options,
    start: Instant,
) -> Result<Environment> {
    if options.arrangement.is_some() {
        let cure = "leave out how it is to be read";
        return Err(Problem::new(name, "a recipe is no picture of a layout", cure));
    }
    let picture = recipe::evaluate(file, source, options.width)?;
    let raw = arranged(name, picture, Some(Arrangement::LatLong))?;
    // The width was for the recipe.
    finish(name, raw, &Options { width: None, ..*options }, start)
}

/// Decodes a picture; none where the content is of neither kind.
fn decode(name: &str, bytes: &[u8]) -> Option<Result<Picture>> {
    if bytes.starts_with(b"#?") {
        Some(radiance::decode(name, bytes))
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        Some(openexr::decode(name, bytes))
    } else {
        None
    }
}

/// A picture's faces in the cube's order, or its lat-long map.
fn arranged(name: &str, picture: Picture, asked: Option<Arrangement>) -> Result<Raw> {
    let Picture { width, height, texels, declared, notes } = picture;
    let arrangement = arrangement::settle(name, (width, height), declared, asked)?;
    let pixels = match arrangement {
        Arrangement::OpenExrLatLong | Arrangement::OpenExrCube => Pixels::OnLimits,
        _ => Pixels::Areas,
    };
    let layout = arrangement.layout();
    let texels = arrangement::unpack(texels, width, arrangement);
    let width = match layout {
        Layout::LatLong => width,
        Layout::Cube => arrangement::side(arrangement, width),
    };
    Ok(Raw { layout, width, pixels, texels, notes })
}

fn finish(name: &str, raw: Raw, options: &Options, start: Instant) -> Result<Environment> {
    let Raw { layout, width, pixels, mut texels, mut notes } = raw;
    let replaced = bad_texels::settle(name, &mut texels, options.replace_bad)?;
    if !replaced.is_clean() {
        notes.push(format!(
            "replaced {replaced} texels (NaN and negative by 0, +infinity by the largest finite value)"
        ));
    }
    if pixels == Pixels::OnLimits {
        let (new, kind) = match layout {
            Layout::LatLong => (resample::lat_long(&texels, width, pixels, width), "LATLONG"),
            Layout::Cube => (resample::cube(&texels, width, pixels, width), "CUBE"),
        };
        texels = new;
        notes.push(format!(
            "resampled from OpenEXR's {kind}, whose outer pixel centres lie on the limits; the energy is kept"
        ));
    }
    let height = match layout {
        Layout::LatLong => width / 2,
        Layout::Cube => 6 * width,
    };
    let wanted = options.layout.unwrap_or(layout);
    let from_cube = layout == Layout::Cube && wanted == Layout::LatLong;
    if options.width.is_some() && !from_cube {
        notes.push(format!(
            "kept at its own {width}x{height}: a width can be chosen for recipes only"
        ));
    }
    let loaded = Environment {
        name: name.to_owned(),
        layout,
        width,
        height,
        texels: Arc::new(texels),
        notes,
        seconds: 0.0,
    };
    let width = options.width.filter(|_| from_cube);
    let form = Form { layout: options.layout, face: options.face, width };
    let mut environment = loaded.in_form(form)?;
    environment.seconds = start.elapsed().as_secs_f64();
    Ok(environment)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let bytes = file::read(path, SUPPORTED)?;
    if bytes.is_empty() {
        let name = path.display().to_string();
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
        None => "this is neither a Radiance nor an OpenEXR picture nor a Ptex file".to_owned(),
    }
}

#[cfg(test)]
mod tests;
