//! Environment maps on disk: OpenEXR with 32-bit floats, or Radiance RGBE.
//!
//! The EXR has no `envmap` attribute: it would say that the outer pixel centres lie on the limits, which
//! they do not.

use std::path::Path;

use brdf_sdk::{Problem, Result};
use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
use rayon::prelude::*;

use super::{Staged, stage};

/// The kind of a map's file, by its ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapFormat {
    /// OpenEXR, 32-bit floats: what the map holds.
    Exr,
    /// Radiance RGBE: 8 bits a channel under one exponent.
    Hdr,
}

impl MapFormat {
    /// The format of a path that ends in .exr or .hdr; a problem for all others.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match ending.as_str() {
            "exr" => Ok(Self::Exr),
            "hdr" => Ok(Self::Hdr),
            _ => Err(Problem::new(
                path.display().to_string(),
                "maps are written as .exr or .hdr",
                "give the name one of these endings",
            )),
        }
    }
}

/// Stages a map of `width` columns; texels row by row from the top left, the fourth value is left out.
pub fn stage_map(path: &Path, width: u32, texels: &[[f32; 4]]) -> Result<Staged> {
    match MapFormat::of(path)? {
        MapFormat::Exr => stage_exr(path, width as usize, texels),
        MapFormat::Hdr => stage_hdr(path, width as usize, texels),
    }
}

fn stage_exr(path: &Path, width: usize, texels: &[[f32; 4]]) -> Result<Staged> {
    let channels = SpecificChannels::rgb(|position: exr::math::Vec2<usize>| {
        let [r, g, b, _] = texels[position.y() * width + position.x()];
        (r, g, b)
    });
    let size = (width, texels.len() / width);
    let attributes = LayerAttributes::default();
    let image = Image::from_layer(Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels));
    stage(path, |file| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
        std::io::Write::write_all(file, bytes.get_ref()).map_err(|error| error.to_string())
    })
}

/// Own code, since the image crate cuts mantissas off: a map would lose a fifth of a percent of its energy.
fn stage_hdr(path: &Path, width: usize, texels: &[[f32; 4]]) -> Result<Staged> {
    let largest = texels.par_iter().flat_map_iter(|texel| &texel[..3]).copied();
    if largest.reduce(|| 0.0, f32::max) >= LARGEST {
        return Err(Problem::new(
            path.display().to_string(),
            "the map has texels above 1.7e38, more than an .hdr file can hold",
            "write an .exr file",
        ));
    }
    let lines: Vec<Vec<u8>> = texels.par_chunks(width).map(scanline).collect();
    let height = lines.len();
    stage(path, |file| {
        let write = |file: &mut dyn std::io::Write| {
            write!(file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n")?;
            lines.iter().try_for_each(|line| file.write_all(line))
        };
        write(file).map_err(|error| error.to_string())
    })
}

/// 255.5 2^119: what rounds beyond the largest texel, 255 2^(255 - 136).
const LARGEST: f32 = 255.5 * (1_u128 << 119) as f32;

/// The nearest RGBE: a mantissa m under the exponent e means m 2^(e - 136).
fn rgbe([r, g, b, _]: [f32; 4]) -> [u8; 4] {
    let largest = f64::from(r.max(g).max(b));
    // The smallest exponent under which the largest channel does not round up to 256.
    let mut exponent = (largest.log2().floor() as i32 + 129).clamp(1, 255);
    if largest * 2.0_f64.powi(136 - exponent) >= 255.5 {
        exponent += 1;
    }
    let scale = 2.0_f64.powi(136 - exponent);
    let [r, g, b] = [r, g, b].map(|value| (f64::from(value) * scale).round() as u8);
    if [r, g, b] == [0; 3] { [0; 4] } else { [r, g, b, exponent.min(255) as u8] }
}

/// One row: the four bytes of texels apart, each as runs; rows that run lengths cannot mark stay plain.
fn scanline(texels: &[[f32; 4]]) -> Vec<u8> {
    let coded: Vec<[u8; 4]> = texels.iter().map(|texel| rgbe(*texel)).collect();
    if !(8..0x8000).contains(&coded.len()) {
        return coded.into_flattened();
    }
    let mut line = vec![2, 2, (coded.len() >> 8) as u8, coded.len() as u8];
    for component in 0..4 {
        let bytes: Vec<u8> = coded.iter().map(|texel| texel[component]).collect();
        let mut plain = 0;
        let mut at = 0;
        while at < bytes.len() {
            let run = bytes[at..].iter().take(127).take_while(|byte| **byte == bytes[at]).count();
            // A run of fewer than four is no shorter than its bytes among others.
            if run >= 4 {
                plain_bytes(&bytes[plain..at], &mut line);
                line.extend([128 + run as u8, bytes[at]]);
                plain = at + run;
            }
            at += run;
        }
        plain_bytes(&bytes[plain..], &mut line);
    }
    line
}

fn plain_bytes(bytes: &[u8], line: &mut Vec<u8>) {
    for part in bytes.chunks(128) {
        line.push(part.len() as u8);
        line.extend(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mantissas_are_rounded_under_the_smallest_exponent() {
        assert_eq!(rgbe([0.0; 4]), [0; 4]);
        assert_eq!(rgbe([1.0, 0.5, 0.25, 0.0]), [128, 64, 32, 129]);
        // 255.4 / 256 keeps its exponent, 255.5 / 256 rounds up to the next.
        assert_eq!(rgbe([255.4 / 256.0, 0.0, 0.0, 0.0]), [255, 0, 0, 128]);
        assert_eq!(rgbe([255.5 / 256.0, 0.0, 0.0, 0.0]), [128, 0, 0, 129]);
        assert_eq!(rgbe([1.6e38, 1.0, 0.0, 0.0])[3], 255);
        assert_eq!(rgbe([f32::MIN_POSITIVE / 4096.0, 0.0, 0.0, 0.0]), [0; 4]);
        assert_eq!(rgbe([LARGEST.next_down(), 0.0, 0.0, 0.0]), [255, 0, 0, 255]);
    }

    /// Random mantissas come back without bias: the mean error of 60,000 values lies within 5 standard
    /// errors of 0, a mantissa's error being uniform over one step (1/sqrt(12) of a step).
    #[test]
    fn rounding_has_no_bias() {
        let mut sum = 0.0;
        let count = 60_000;
        for i in 0..count {
            let value = (1.0 + (f64::from(i) * 0.618_033_988_749_895).fract()) as f32;
            let [m, _, _, e] = rgbe([value, 0.0, 0.0, 0.0]);
            let step = 2.0_f64.powi(i32::from(e) - 136);
            sum += (f64::from(m) * step - f64::from(value)) / step;
        }
        let mean: f64 = sum / f64::from(count);
        assert!(mean.abs() < 5.0 / (12.0 * f64::from(count)).sqrt(), "{mean}");
    }

    #[test]
    fn other_endings_are_refused() {
        for name in ["a.png", "a", "a.exr.tif"] {
            let told = MapFormat::of(Path::new(name)).unwrap_err().to_string();
            assert!(told.contains("maps are written as .exr or .hdr"), "{told}");
        }
        assert_eq!(MapFormat::of(Path::new("a.EXR")).unwrap(), MapFormat::Exr);
    }
}
