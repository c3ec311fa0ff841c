//! PNG, 8 bits per channel, sRGB.

use std::path::Path;

use brdf_sdk::{Problem, Result};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{Picture, Staged, read, stage};
use crate::tone::{Tone, byte};

/// Stages the picture as a screen shows it.
pub fn stage_png(path: &Path, picture: &Picture, tone: Tone) -> Result<Staged> {
    Raster::new(picture, tone).stage(path)
}

/// A picture as a screen shows it: sRGB of 8 bits a channel, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Raster {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Red, green and blue of every pixel.
    pub rgb: Vec<[u8; 3]>,
}

impl Raster {
    /// The picture as a screen shows it.
    pub fn new(picture: &Picture, tone: Tone) -> Self {
        Self::reduced(picture, tone, 1)
    }

    /// The same, `factor` (at least 1) times smaller each way. The mean is that of the screen's light, so that edges come
    /// out smooth however bright they are; rows and columns that fill no pixel are left out.
    pub fn reduced(picture: &Picture, tone: Tone, factor: u32) -> Self {
        let resolution = picture.resolution.map(|side| side / factor);
        let wide = picture.resolution[0] as usize;
        let pixel = |x: u32, y: u32| {
            let mut light = [0.0; 3];
            for (dx, dy) in (0..factor).flat_map(|dy| (0..factor).map(move |dx| (dx, dy))) {
                let at = (y * factor + dy) as usize * wide + (x * factor + dx) as usize;
                for (sum, radiance) in light.iter_mut().zip(picture.rgb[at]) {
                    *sum += tone.light(radiance);
                }
            }
            light.map(|sum| byte(sum / (factor * factor) as f32))
        };
        let rows = 0..resolution[1];
        let rgb = rows.flat_map(|y| (0..resolution[0]).map(move |x| (x, y)));
        Self { resolution, rgb: rgb.map(|(x, y)| pixel(x, y)).collect() }
    }

    /// Reads a PNG of at most 8 bits a channel.
    ///
    /// # Errors
    /// Where there is no such file, or it is no PNG.
    pub fn read(path: &Path) -> Result<Self> {
        let stored = read::read(path)?;
        if !stored.for_display {
            return Err(Problem::new(path.display().to_string(), "this is no PNG", "give a PNG"));
        }
        let rgb = stored.rgb.iter().map(|light| light.map(byte)).collect();
        Ok(Self { resolution: stored.resolution, rgb })
    }

    /// Stages it as a PNG.
    pub fn stage(&self, path: &Path) -> Result<Staged> {
        let [width, height] = self.resolution;
        stage(path, |file| {
            PngEncoder::new(file)
                .write_image(self.rgb.as_flattened(), width, height, ExtendedColorType::Rgb8)
                .map_err(|error| error.to_string())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(resolution: [u32; 2], rgb: Vec<[f32; 3]>) -> Picture {
        Picture { resolution, coverage: vec![1.0; rgb.len()], rgb, std_error: None }
    }

    #[test]
    fn a_written_picture_is_read_byte_for_byte() {
        let rgb = (0..256_u16).map(|i| [i as u8, 255 - i as u8, (i / 2) as u8]).collect();
        let raster = Raster { resolution: [16, 16], rgb };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        raster.stage(&path).unwrap().keep().unwrap();
        assert_eq!(Raster::read(&path).unwrap(), raster);
    }

    /// Black beside a light that the curve takes to 1 makes half the light, 188 of 255, not half the byte.
    #[test]
    fn a_smaller_picture_has_the_mean_light() {
        let (black, bright) = ([0.0; 3], [f32::INFINITY; 3]);
        let rgb = vec![black, bright, black, bright, black, bright];
        let raster = Raster::reduced(&picture([3, 2], rgb), Tone::default(), 2);
        assert_eq!((raster.resolution, raster.rgb), ([1, 1], vec![[188; 3]]));
    }
}
