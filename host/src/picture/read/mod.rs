//! Reads a picture for measuring: its radiance as it stands, coverage and standard errors with it.
//!
//! OpenEXR, Radiance and PNG, told apart by content. Unlike environment maps, pictures may be of any
//! shape and may hold values that are no radiance: NaN and infinities are kept for who counts them.

mod openexr;
mod raster;
#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use brdf_sdk::{Problem, Result};

use crate::file;

/// Most pixels in a picture that is read; a larger claim is refused before anything is allocated.
const MAX_PIXELS: u64 = 1 << 26;

const SUPPORTED: &str = "give an OpenEXR (.exr), Radiance (.hdr) or PNG picture";

/// A picture as it lay in a file, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Linear Rec. 709: radiance, or a screen's light where the file was a PNG.
    pub rgb: Vec<[f32; 3]>,
    /// What the channel A holds: above 0 where the object is. `None` where there is none.
    pub coverage: Option<Vec<f32>>,
    /// Standard error of each value of `rgb`, from the channels `std_error.R`, `.G` and `.B`.
    pub std_error: Option<Vec<[f32; 3]>>,
    /// Whether the values have been through a display curve already, as a PNG's have.
    pub for_display: bool,
}

/// Reads a picture, whole or not at all.
pub fn read(path: &Path) -> Result<Stored> {
    let name = path.display().to_string();
    decode(&name, &file::read(path, SUPPORTED)?)
}

fn decode(name: &str, bytes: &[u8]) -> Result<Stored> {
    // Decoders assert on some contradictions in damaged files. Those panics end here, since a file must
    // never take the program down.
    let decoded = catch_unwind(AssertUnwindSafe(|| {
        if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            openexr::decode(name, bytes)
        } else if bytes.starts_with(b"#?") {
            raster::decode_radiance(name, bytes)
        } else if bytes.starts_with(b"\x89PNG") {
            raster::decode_png(name, bytes)
        } else {
            Err(Problem::new(name, "this is no picture that can be read", SUPPORTED))
        }
    }));
    decoded.unwrap_or_else(|_| Err(damaged(name, "its decoder gave up")))
}

fn damaged(name: &str, what: &str) -> Problem {
    let reason = format!("the file is cut short or damaged ({what})");
    Problem::new(name, reason, "copy or write it again")
}

/// Refuses sizes that a file of this length cannot hold, before anything of that size is allocated.
///
/// `shrinks` is how many times smaller than `bytes_per_pixel` the format makes a pixel at best.
fn check_size(
    name: &str,
    [width, height]: [u64; 2],
    bytes_per_pixel: u64,
    shrinks: u64,
    file_length: usize,
) -> Result<[u32; 2]> {
    let pixels = width.saturating_mul(height);
    let bytes = pixels.saturating_mul(bytes_per_pixel);
    if bytes > (file_length as u64).saturating_mul(shrinks) {
        return Err(damaged(
            name,
            &format!(
                "its header claims {width}x{height} pixels, more than {file_length} bytes can hold"
            ),
        ));
    }
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width @ 1..), Ok(height @ 1..)) if pixels <= MAX_PIXELS => Ok([width, height]),
        _ => Err(Problem::new(
            name,
            format!("the picture is {width}x{height}; 1 to {MAX_PIXELS} pixels can be read"),
            "give a picture of another size",
        )),
    }
}
