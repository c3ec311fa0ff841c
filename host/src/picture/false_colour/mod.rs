//! A number for each pixel as a picture with a legend, so that it can be read alone.

mod colours;
mod letters;
mod scale;

use std::path::Path;

use brdf_sdk::Result;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

pub use scale::Scale;

use super::{Staged, stage};

/// Least width of the picture, which its legend needs [pixels].
const LEAST_WIDTH: usize = 320;
/// The legend's measures in dots of its letters.
const MARGIN: usize = 8;
const BAR: usize = 10;
const TICK: usize = 3;
/// From the picture's edge to the bar, so that the outer numbers have room.
const INDENT: usize = 28;

const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// Numbers to be shown, row by row; NaN is no value.
#[derive(Debug, Clone, Copy)]
pub struct FalseColour<'a> {
    /// Pixels in a row.
    pub width: usize,
    /// One number a pixel.
    pub values: &'a [f64],
    /// How numbers become colours.
    pub scale: Scale,
    /// What the numbers are, in capitals; a line of the legend holds 50 letters.
    pub title: &'a str,
}

/// Stages the numbers as a PNG with a legend below. Small pictures are enlarged by a whole factor.
pub fn stage_false_colour(path: &Path, map: &FalseColour) -> Result<Staged> {
    let canvas = draw(map);
    let (width, height) = (canvas.width as u32, (canvas.bytes.len() / 3 / canvas.width) as u32);
    stage(path, |file| {
        PngEncoder::new(file)
            .write_image(&canvas.bytes, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| error.to_string())
    })
}

/// An sRGB picture that is drawn into.
struct Canvas {
    width: usize,
    bytes: Vec<u8>,
}

impl Canvas {
    /// Fills a rectangle that lies inside.
    fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], colour: [u8; 3]) {
        for row in y..y + height {
            let first = 3 * (row * self.width + x);
            let row = &mut self.bytes[first..first + 3 * width];
            row.as_chunks_mut::<3>().0.iter_mut().for_each(|pixel| *pixel = colour);
        }
    }

    /// Writes a text, its dots `dot` pixels wide; what would lie outside is cut off.
    fn write(&mut self, [x, y]: [usize; 2], dot: usize, text: &str) {
        for (column, row) in letters::dots(text) {
            let at = [x + column * dot, y + row * dot];
            if at[0] + dot <= self.width {
                self.fill(at, [dot, dot], INK);
            }
        }
    }
}

fn draw(map: &FalseColour) -> Canvas {
    let FalseColour { width, values, scale, title } = *map;
    let height = values.len() / width;
    let enlarged = (LEAST_WIDTH / width.max(height)).max(1);
    let full = (width * enlarged).max(LEAST_WIDTH);
    let dot = full / LEAST_WIDTH;
    let no_value = values.iter().any(|value| value.is_nan());
    let mut lines = vec![format!("{title}, {}", scale.name())];
    lines.extend(no_value.then(|| "GREY: NO VALUE".to_owned()));
    let line = letters::HEIGHT + 4;
    let legend = MARGIN + lines.len() * line + BAR + TICK + 2 + letters::HEIGHT + MARGIN;
    let picture = height * enlarged;
    let mut canvas = Canvas { width: full, bytes: PAPER.repeat(full * (picture + legend * dot)) };

    let left = (full - width * enlarged) / 2;
    for (i, value) in values.iter().enumerate() {
        let at = [left + i % width * enlarged, i / width * enlarged];
        canvas.fill(at, [enlarged, enlarged], scale.colour(*value));
    }

    let mut y = picture + MARGIN * dot;
    for text in &lines {
        canvas.write([MARGIN * dot, y], dot, text);
        y += line * dot;
    }
    let length = full - 2 * INDENT * dot;
    for x in 0..length {
        let value = scale.value(x as f64 / (length - 1) as f64);
        canvas.fill([INDENT * dot + x, y], [1, BAR * dot], scale.colour(value));
    }
    y += BAR * dot;
    for (place, text) in scale.ticks() {
        let x = INDENT * dot + (place * (length - dot) as f64).round() as usize;
        canvas.fill([x, y], [dot, TICK * dot], INK);
        // The space behind the last letter is no part of the text.
        let half = (text.len() * letters::ADVANCE - 1) * dot / 2;
        canvas.write([(x + dot / 2).saturating_sub(half), y + (TICK + 2) * dot], dot, &text);
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_the_picture_above_its_legend() {
        let values = [0.0, 0.5, 1.0, f64::NAN, 2.0, 0.25];
        let scale = Scale::Linear { largest: 1.0 };
        let map = FalseColour { width: 3, values: &values, scale, title: "FLIP" };
        let canvas = draw(&map);
        // Three pixels enlarged by 320 / 3 = 106, with a pixel of paper at either side.
        assert_eq!(canvas.width, 320);
        let pixel = |x: usize, y: usize| {
            let first = 3 * (y * canvas.width + x);
            [canvas.bytes[first], canvas.bytes[first + 1], canvas.bytes[first + 2]]
        };
        assert_eq!((pixel(0, 0), pixel(319, 211)), (PAPER, PAPER));
        for (i, value) in values.iter().enumerate() {
            let (x, y) = (1 + i % 3 * 106, i / 3 * 106);
            assert_eq!([pixel(x, y), pixel(x + 105, y + 105)], [scale.colour(*value); 2]);
        }
        // Title, the line on grey, and the bar with both ends.
        let bar = 212 + 8 + 2 * 11;
        assert_eq!(pixel(INDENT, bar), scale.colour(0.0));
        assert_eq!(pixel(319 - INDENT, bar + BAR - 1), scale.colour(1.0));
        assert_eq!(canvas.bytes.len() / 3 / 320, bar + BAR + TICK + 2 + 7 + 8);
        let whole = draw(&FalseColour { values: &values[..3], ..map });
        assert_eq!(whole.bytes.len() / 3 / 320, 106 + 8 + 11 + BAR + TICK + 2 + 7 + 8);
    }

    #[test]
    fn pictures_of_odd_shapes_are_drawn_whole() {
        for (width, height) in [(1, 1), (1, 900), (900, 1), (2000, 3)] {
            let values = vec![1.0; width * height];
            let scale = Scale::Diverging { largest: 5e-3 };
            let canvas = draw(&FalseColour { width, values: &values, scale, title: "A" });
            assert!(canvas.width >= LEAST_WIDTH);
            assert!(canvas.bytes.len().is_multiple_of(3 * canvas.width));
        }
    }
}
