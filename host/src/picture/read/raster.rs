//! Radiance and PNG pictures, decoded with the image crate.

use std::io::Cursor;

use brdf_sdk::{Problem, Result};
use image::codecs::hdr::HdrDecoder;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, Limits};

use super::{Stored, check_size, damaged};
use crate::tone::light;

/// Bytes of memory that the PNG decoder may take for itself, above the picture.
const DECODER_BYTES: u64 = 1 << 26;

/// Run lengths shrink 63 times; an older kind more, which serves pictures of one colour only.
const RADIANCE_SHRINKS: u64 = 1100;
/// Deflate shrinks 1032 times at most.
const DEFLATE_SHRINKS: u64 = 1100;

/// Radiance of an .hdr picture; its EXPOSURE, by which the values were multiplied, is divided out.
pub fn decode_radiance(name: &str, bytes: &[u8]) -> Result<Stored> {
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(|error| wrong(name, &error))?;
    let (width, height) = decoder.dimensions();
    let size = [width, height].map(u64::from);
    let resolution = check_size(name, size, 4, RADIANCE_SHRINKS, bytes.len())?;
    let exposure = decoder.metadata().exposure.unwrap_or(1.0);
    if !(exposure.is_finite() && exposure > 0.0) {
        let reason = format!("its EXPOSURE is {exposure}, which undoes no exposure");
        return Err(Problem::new(name, reason, "correct or remove that line of its header"));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(|error| wrong(name, &error))?;
    let rgb = image.into_rgb32f().pixels().map(|p| p.0.map(|value| value / exposure)).collect();
    Ok(Stored { resolution, rgb, coverage: None, std_error: None, for_display: false })
}

/// The light that a PNG's sRGB values ask of a screen. Grey is taken for all three channels, and alpha
/// passed over.
pub fn decode_png(name: &str, bytes: &[u8]) -> Result<Stored> {
    let mut decoder = PngDecoder::new(Cursor::new(bytes)).map_err(|error| wrong(name, &error))?;
    let (width, height) = decoder.dimensions();
    // One bit a pixel at least, a byte once it is decoded.
    let size = [width, height].map(u64::from);
    let resolution = check_size(name, size, 1, 8 * DEFLATE_SHRINKS, bytes.len())?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(decoder.total_bytes().saturating_add(DECODER_BYTES));
    decoder.set_limits(limits).map_err(|error| wrong(name, &error))?;
    let image = DynamicImage::from_decoder(decoder).map_err(|error| wrong(name, &error))?;
    let rgb = image.into_rgb32f().pixels().map(|pixel| pixel.0.map(light)).collect();
    Ok(Stored { resolution, rgb, coverage: None, std_error: None, for_display: true })
}

fn wrong(name: &str, error: &ImageError) -> Problem {
    match error {
        ImageError::Unsupported(what) => Problem::new(
            name,
            format!("it uses a feature of its format that is not read ({what})"),
            "convert it to OpenEXR",
        ),
        other => damaged(name, &other.to_string().replace('\n', " ")),
    }
}
