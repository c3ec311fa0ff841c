//! Pictures as textures, made anew where what they show has changed.

use std::sync::OnceLock;

use egui::{Color32, ColorImage, Context, TextureHandle, TextureOptions};
use rayon::prelude::*;

use crate::tone::{Tone, byte};

/// A texture, and of what it was made.
pub(super) struct Cached<K> {
    key: Option<K>,
    texture: Option<TextureHandle>,
}

impl<K> Default for Cached<K> {
    fn default() -> Self {
        Self { key: None, texture: None }
    }
}

impl<K: PartialEq> Cached<K> {
    /// The texture for a key; `paint` makes its picture where the key is another than the last one.
    pub(super) fn get(
        &mut self,
        ctx: &Context,
        name: &str,
        key: K,
        options: TextureOptions,
        paint: impl FnOnce() -> ColorImage,
    ) -> TextureHandle {
        let made = match self.texture.take() {
            Some(texture) if self.key.as_ref() == Some(&key) => texture,
            Some(mut texture) => {
                texture.set(paint(), options);
                texture
            }
            None => ctx.load_texture(name, paint(), options),
        };
        self.key = Some(key);
        self.texture = Some(made.clone());
        made
    }
}

/// Pixels of three bytes, row by row from the top.
pub(super) fn image(size: [usize; 2], pixels: &[[u8; 3]]) -> ColorImage {
    ColorImage::from_rgb(size, pixels.as_flattened())
}

/// Radiance as the screen shows it.
pub(super) fn toned(resolution: [u32; 2], rgb: &[[f32; 3]], tone: Tone) -> ColorImage {
    let bytes = bytes();
    let most = (bytes.len() - 1) as f32;
    let shown = |[r, g, b]: &[f32; 3]| {
        let [r, g, b] = [r, g, b].map(|c| bytes[(tone.light(*c) * most + 0.5) as usize]);
        Color32::from_rgb(r, g, b)
    };
    let pixels: Vec<Color32> = rgb.par_iter().with_min_len(4096).map(shown).collect();
    let size = resolution.map(|side| side as usize);
    ColorImage::new(size, pixels)
}

/// The sRGB byte of linear light, in steps that no byte is broader than.
fn bytes() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    const STEPS: usize = 1 << 14;
    BYTES.get_or_init(|| (0..=STEPS).map(|i| byte(i as f32 / STEPS as f32)).collect())
}
