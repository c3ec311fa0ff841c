//! Numbers over two axes as false colours: panels side by side over the same axes, above the legends of their
//! colours.

use std::fmt::Write as _;

use brdf_sdk::{Problem, Result};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::{Axis, Frame, line, picture, text, title};
use crate::picture::Scale;

/// Numbers that are shown as colours.
#[derive(Debug, Clone, Copy)]
pub struct Panel<'a> {
    /// What it shows.
    pub title: &'a str,
    /// One number a pixel, row by row from the lower ends of both axes; NaN is no value.
    pub values: &'a [f64],
    /// How they become colours. Neighbours with the same scale share a legend.
    pub scale: Scale,
    /// What the numbers are, with their unit.
    pub legend: &'a str,
}

/// Panels side by side; three fill the width.
#[derive(Debug, Clone)]
pub struct Panels<'a> {
    /// What they show together.
    pub name: &'a str,
    /// Pixels along the axes.
    pub size: [usize; 2],
    /// The axis below, and what it is of.
    pub x: (Axis, &'a str),
    /// The axis on the left, and what it is of.
    pub y: (Axis, &'a str),
    /// The panels.
    pub panels: &'a [Panel<'a>],
    /// Points with a ring around them.
    pub marks: &'a [[f64; 2]],
}

/// Each panel's share of the width, and where its pixels lie in it.
const SHARE: f64 = 320.0;
const FRAME: Frame = Frame { at: [56.0, 26.0], size: [246.0, 178.0] };
const HEIGHT: f64 = 296.0;
/// The legend's bar.
const BAR: [f64; 2] = [250.0, 11.0];
/// Steps of colour in a legend.
const STEPS: usize = 256;

impl Panels<'_> {
    /// The panels as an SVG element.
    ///
    /// # Errors
    /// Where a picture cannot be coded.
    pub fn svg(&self) -> Result<String> {
        let mut inside = String::new();
        for (index, panel) in self.panels.iter().enumerate() {
            inside += &self.panel(index, panel)?;
        }
        let mut first = 0;
        for alike in self.panels.chunk_by(|a, b| a.scale == b.scale) {
            inside += &legend(frame(first).at[0], frame(first + alike.len() - 1), &alike[0])?;
            first += alike.len();
        }
        let size = [SHARE * self.panels.len() as f64, HEIGHT];
        Ok(picture("panels", self.name, size, &inside))
    }

    fn panel(&self, index: usize, panel: &Panel<'_>) -> Result<String> {
        let frame = frame(index);
        let mut svg = title([frame.at[0], 15.0], panel.title);
        // The first row of a PNG is its uppermost.
        let rows = panel.values.chunks(self.size[0]).rev().flatten();
        let pixels: Vec<u8> = rows.flat_map(|value| panel.scale.colour(*value)).collect();
        svg += &image(&frame, &pixels, self.size)?;
        svg += &frame.outline();
        svg += &frame.below(&self.x.0.ticks(5), self.x.1, false);
        svg += &frame.beside(&self.y.0.ticks(5), false);
        if index == 0 {
            svg += &frame.beside_name(self.y.1, 42.0);
        }
        for [x, y] in self.marks {
            if self.x.0.holds(*x) && self.y.0.holds(*y) {
                let [x, y] = frame.point([self.x.0.place(*x), self.y.0.place(*y)]);
                for class in ["halo", "mark"] {
                    let _ = write!(
                        svg,
                        "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\"/>"
                    );
                }
            }
        }
        Ok(svg)
    }
}

fn frame(index: usize) -> Frame {
    Frame { at: [FRAME.at[0] + SHARE * index as f64, FRAME.at[1]], ..FRAME }
}

/// The bar of a scale from `left` to the right side of a panel.
fn legend(left: f64, last: Frame, panel: &Panel<'_>) -> Result<String> {
    let width = last.at[0] + last.size[0] - left;
    let bar = Frame { at: [left, BAR[0]], size: [width, BAR[1]] };
    let place = |step: usize| (step as f64 + 0.5) / STEPS as f64;
    let colours = (0..STEPS).map(|step| panel.scale.colour(panel.scale.value(place(step))));
    let pixels: Vec<u8> = colours.flatten().collect();
    let mut svg = image(&bar, &pixels, [STEPS, 1])? + &bar.outline();
    let bottom = BAR[0] + BAR[1];
    for (place, label) in panel.scale.ticks() {
        let [x, _] = bar.point([place, 0.0]);
        svg += &line([x, bottom], [x, bottom + 4.0]);
        svg += &text([x, bottom + 16.0], "middle", &label.to_lowercase());
    }
    Ok(svg + &text([left + 0.5 * width, bottom + 32.0], "middle", panel.legend))
}

/// Pixels as a PNG that is stretched over a frame: red, green and blue of each, and its coverage where there are four.
pub(super) fn image(frame: &Frame, pixels: &[u8], [columns, rows]: [usize; 2]) -> Result<String> {
    let mut png = Vec::new();
    let kind = match pixels.len() == 4 * columns * rows {
        true => ExtendedColorType::Rgba8,
        false => ExtendedColorType::Rgb8,
    };
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::NoFilter)
        .write_image(pixels, columns as u32, rows as u32, kind)
        .map_err(|error| Problem::new("a chart", error.to_string(), "report this as a fault"))?;
    let ([x, y], [width, height]) = (frame.at, frame.size);
    Ok(format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>",
        base64::encode(png)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_one_scale_share_a_legend_and_rows_go_up() {
        let scale = Scale::Linear { largest: 1.0 };
        let one = Panel { title: "a", values: &[0.0, 0.2, 0.8, 1.0], scale, legend: "x" };
        let other = Panel { scale: Scale::Diverging { largest: 5.0 }, legend: "y", ..one };
        let panels = Panels {
            name: "n",
            size: [2, 2],
            x: (Axis::linear(0.0, 1.0), "x"),
            y: (Axis::linear(0.0, 1.0), "y"),
            panels: &[one, one, other],
            marks: &[[0.5, 0.5], [2.0, 0.5]],
        };
        let svg = panels.svg().unwrap();
        assert_eq!(svg.matches("<image").count(), 5);
        assert_eq!(svg.matches("class=\"mark\"").count(), 3);
        let first = svg.split("base64,").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        let png = image::load_from_memory(&base64::decode(first).unwrap()).unwrap().to_rgb8();
        assert_eq!(png.get_pixel(0, 0).0, scale.colour(0.8));
        assert_eq!(png.get_pixel(1, 1).0, scale.colour(0.2));
    }
}
