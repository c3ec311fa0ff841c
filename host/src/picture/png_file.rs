//! PNG, 8 bits per channel, sRGB.

use std::path::Path;

use brdf_sdk::Result;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{Picture, Staged, display, stage};

/// Stages the picture as the display curve shows it, exposed by `stops`.
pub fn stage_png(path: &Path, picture: &Picture, stops: f64) -> Result<Staged> {
    let byte = |radiance: f32| (display(radiance, stops as f32) * 255.0).round() as u8;
    let bytes: Vec<u8> = picture.rgb.iter().flatten().map(|channel| byte(*channel)).collect();
    let [width, height] = picture.resolution;
    stage(path, |file| {
        PngEncoder::new(file)
            .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| error.to_string())
    })
}
