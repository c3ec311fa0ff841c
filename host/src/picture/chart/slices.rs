//! Pictures over two axes, side by side.

use brdf_sdk::Result;

use super::legend::{ROW as LINE, fitting};
use super::panels::image;
use super::{Axis, Frame, heading, picture, title};

/// A picture and what it shows.
#[derive(Debug, Clone)]
pub struct Slice {
    /// What it shows.
    pub title: String,
    /// Colours for the screen, row by row from the lower ends of both axes.
    pub pixels: Vec<[u8; 3]>,
}

/// Pictures of the same size over the same axes.
#[derive(Debug, Clone)]
pub struct Slices<'a> {
    /// What they show together.
    pub title: &'a str,
    /// More of that in a line below.
    pub detail: &'a str,
    /// Pixels along the axes.
    pub size: [usize; 2],
    /// Places of the numbers below in [0, 1] and what they say, and what the axis is of.
    pub x: (&'a [(f64, String)], &'a str),
    /// The axis on the left, and what it is of.
    pub y: (Axis, &'a str),
    /// The pictures.
    pub slices: &'a [Slice],
}

const FRAME: Frame = Frame { at: [56.0, 52.0], size: [238.0, 238.0] };
/// A picture's share of the width and of the height.
const SHARE: [f64; 2] = [306.0, 312.0];
/// Letters of titles are wider than those of legends.
const BOLD: f64 = 0.85;
/// Pictures in a row.
const ROW: usize = 3;

impl Slices<'_> {
    /// The pictures as an SVG element.
    ///
    /// # Errors
    /// Where a picture cannot be coded.
    pub fn svg(&self) -> Result<String> {
        let (mut inside, top) = heading(16.0, self.title, self.detail);
        for (index, slice) in self.slices.iter().enumerate() {
            let at = [
                FRAME.at[0] + SHARE[0] * (index % ROW) as f64,
                FRAME.at[1] + top + SHARE[1] * (index / ROW) as f64,
            ];
            let frame = Frame { at, ..FRAME };
            inside += &title([at[0], at[1] - 9.0], &fitting(&slice.title, BOLD * FRAME.size[0]));
            let rows = slice.pixels.chunks(self.size[0]).rev().flatten();
            let pixels: Vec<u8> = rows.flatten().copied().collect();
            inside += &image(&frame, &pixels, self.size)?;
            inside += &frame.outline();
            inside += &frame.below(self.x.0, self.x.1, false);
            inside += &frame.beside(&self.y.0.ticks(4), false);
            inside += &frame.beside_name(self.y.1, 36.0);
        }
        let [columns, rows] = [self.slices.len().min(ROW), self.slices.len().div_ceil(ROW)];
        let size = [SHARE[0] * columns as f64 + 10.0, SHARE[1] * rows as f64 + 26.0 + LINE];
        Ok(picture("panels", self.title, size, &inside))
    }
}
