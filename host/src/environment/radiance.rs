//! Radiance pictures (.hdr, .pic): four bytes a texel, three mantissas and one shared exponent.
//!
//! After Ward, "Real Pixels" (Graphics Gems II, 1991), and Radiance's "File Formats" document. Reads flat,
//! old and new run-length coding, RGBE and XYZE, EXPOSURE, COLORCORR and PRIMARIES, and the four orientations whose
//! scanlines are rows. A mantissa m with exponent e is m 2^(e - 136), without the half step that
//! Radiance's own tools add: this is what the writers of today's maps mean. The image crate's
//! decoder is not used because it refuses XYZE, `#?RGBE` and flipped rows.

mod header;
mod scanline;

use glam::DMat3;
use rayon::prelude::*;

use brdf_sdk::{Problem, Result};

use super::Picture;
use super::colour::{self, Chromaticities};
use header::{Header, Pixels};

/// Decodes a whole file that starts with `#?`.
pub fn decode(name: &str, bytes: &[u8]) -> Result<Picture> {
    let (header, start) = header::read(name, bytes)?;
    let (width, height) = super::arrangement::check_size(name, header.width, header.height)?;

    // Rows are added as the file proves to hold them: a small file cannot claim much memory.
    let mut coded = Vec::new();
    let mut rest = &bytes[start..];
    for row in 0..height {
        rest = scanline::append(rest, width as usize, &mut coded).map_err(|fault| {
            let (what, cure) = match fault {
                scanline::Fault::Ends => ("the file ends in", "it was cut short: fetch it again"),
                scanline::Fault::Damaged => ("the coding is damaged in", "fetch the file again"),
            };
            Problem::new(name, format!("{what} scanline {} of {height}", row + 1), cure)
        })?;
    }

    // Radiance is the stored value over everything that was multiplied into it.
    let scale = header.colour_correction.map(|factor| 1.0 / (factor * header.exposure));
    if scale.iter().any(|scale| !scale.is_normal()) {
        let reason = "its EXPOSURE and COLORCORR lines multiply to an impossible factor";
        return Err(Problem::new(name, reason, "correct those lines"));
    }
    let powers: Vec<f64> = (0..256).map(scale_of_exponent).collect();
    let width_texels = width as usize;
    let mut texels = vec![[0.0_f32; 4]; coded.len()];
    texels.par_chunks_mut(width_texels).enumerate().for_each(|(row, out)| {
        let row = if header.bottom_up { height as usize - 1 - row } else { row };
        let coded = &coded[row * width_texels..][..width_texels];
        let decode = |&[r, g, b, e]: &[u8; 4]| {
            let power = powers[usize::from(e)];
            let value = |mantissa: u8, scale: f64| (f64::from(mantissa) * power * scale) as f32;
            [value(r, scale[0]), value(g, scale[1]), value(b, scale[2]), 0.0]
        };
        if header.right_to_left {
            out.iter_mut().zip(coded.iter().rev()).for_each(|(out, texel)| *out = decode(texel));
        } else {
            out.iter_mut().zip(coded).for_each(|(out, texel)| *out = decode(texel));
        }
    });

    let mut notes = header.notes();
    if let Some((matrix, note)) = conversion(name, &header)? {
        colour::convert(&mut texels, matrix);
        notes.push(note);
    }
    Ok(Picture { width, height, texels, declared: None, notes })
}

/// 2^(e - 136), and 0 for the exponent 0, which marks black.
fn scale_of_exponent(exponent: i32) -> f64 {
    if exponent == 0 { 0.0 } else { 2.0_f64.powi(exponent - 136) }
}

fn conversion(name: &str, header: &Header) -> Result<Option<(DMat3, String)>> {
    let wrong = |line: &str| {
        Problem::new(
            name,
            format!("{line} are no usable primaries"),
            "correct the PRIMARIES line, or remove it for Rec. 709",
        )
    };
    match (header.pixels, header.primaries) {
        (Pixels::Xyze, _) => {
            let matrix = colour::rec709_from_xyz().ok_or_else(|| wrong("these"))?;
            Ok(Some((matrix, "converted from CIE XYZ to linear Rec. 709".to_owned())))
        }
        (Pixels::Rgbe, Some(numbers)) => {
            let from = Chromaticities::from_numbers(numbers);
            // Widespread writers put zeros where they know nothing.
            if from.are_rec709() || numbers == [0.0; 8] {
                return Ok(None);
            }
            let shown = numbers.map(|number| number.to_string()).join(" ");
            let matrix = from.rec709_from_rgb().ok_or_else(|| wrong(&shown))?;
            Ok(Some((matrix, format!("converted from PRIMARIES {shown} to linear Rec. 709"))))
        }
        (Pixels::Rgbe, None) => Ok(None),
    }
}

#[cfg(test)]
mod tests;
