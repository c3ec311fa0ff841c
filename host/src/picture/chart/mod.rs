//! Charts as SVG for a page: curves over an angle, and numbers over two angles as false colours.
//!
//! They stand inside of HTML, need nothing from outside, and take their colours from [`STYLE`], so that they
//! can be read in a light and in a dark page. [`alone`] makes a file of one, with a light ground.

mod axis;
mod curves;
mod legend;
mod panels;
mod polar;
mod slices;
mod surface;

use std::fmt::Write as _;

pub use axis::Axis;
pub use curves::{Curve, Curves};
pub use legend::{PENS, Pen};
pub use panels::{Panel, Panels};
pub use polar::Polar;
pub use slices::{Slice, Slices};
pub use surface::{Arrow, Raster, Surface, Surfaces};

/// The style sheet of the charts.
pub const STYLE: &str = include_str!("chart.css");

/// What text and outlines have on a light ground.
const INK: &str = "#222";

/// How many times larger a chart is as a file than its own units are pixels.
const ENLARGED: f64 = 1.6;

/// A chart as a file of its own: with a ground, and with plain colours, since few programs that read SVG know variables.
pub fn alone(chart: &str) -> String {
    let (rules, _) = STYLE.split_once(":root").unwrap_or((STYLE, ""));
    let style = colours().fold(rules.replace("var(--ink)", INK), |style, (name, colour)| {
        style.replace(&format!("var({name})"), colour)
    });
    let size: Vec<f64> = chart
        .split_once("viewBox=\"0 0 ")
        .and_then(|(_, rest)| rest.split('"').next())
        .map(|size| size.split(' ').filter_map(|side| side.parse().ok()).collect())
        .unwrap_or_default();
    let [width, height] = size[..] else { return chart.to_owned() };
    let head = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" ",
        width * ENLARGED,
        height * ENLARGED
    );
    let ground = format!(
        "<style>{}</style><rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>",
        style.replace("system-ui, ", "")
    );
    let (tag, inside) = chart.split_once('>').unwrap_or((chart, ""));
    format!("{}>{ground}{inside}\n", tag.replacen("<svg ", &head, 1))
}

/// The names and values of the curves' colours on a light ground, as the style sheet has them.
fn colours() -> impl Iterator<Item = (&'static str, &'static str)> {
    let (_, rest) = STYLE.split_once(":root {").unwrap_or_default();
    let (list, _) = rest.split_once('}').unwrap_or_default();
    list.split(';').filter_map(|entry| entry.trim().split_once(": "))
}

/// A colour of the curves in [0, 1], sRGB, on a light ground.
pub fn colour(index: usize) -> [f64; 3] {
    let hexadecimal = colours().nth(index % legend::COLOURS).map_or("", |(_, value)| value);
    [1, 3, 5].map(|at| {
        let byte = hexadecimal.get(at..at + 2).and_then(|byte| u8::from_str_radix(byte, 16).ok());
        f64::from(byte.unwrap_or_default()) / 255.0
    })
}

/// Text for HTML and SVG, inside of elements and of attributes.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // HTML has no control characters, not even as numbers.
            letter if letter.is_control() && !letter.is_ascii_whitespace() => escaped.push(' '),
            // XML has no place for these two at all.
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// A rectangle of a chart: its left upper corner and its width and height.
#[derive(Debug, Clone, Copy)]
struct Frame {
    at: [f64; 2],
    size: [f64; 2],
}

impl Frame {
    /// The point at places of both axes, the second one upwards.
    fn point(&self, [along, up]: [f64; 2]) -> [f64; 2] {
        [self.at[0] + along * self.size[0], self.at[1] + (1.0 - up) * self.size[1]]
    }

    /// Its outline.
    fn outline(&self) -> String {
        let ([x, y], [width, height]) = (self.at, self.size);
        format!("<rect class=\"frame\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>")
    }

    /// The numbers and the name of the axis below; with lines across where `lines`.
    fn below(&self, ticks: &[(f64, String)], name: &str, lines: bool) -> String {
        let mut svg = String::new();
        let bottom = self.at[1] + self.size[1];
        for (place, label) in ticks {
            let [x, _] = self.point([*place, 0.0]);
            let top = if lines { self.at[1] } else { bottom };
            svg += &line([x, top], [x, bottom + 4.0]);
            svg += &text([x, bottom + 16.0], "middle", label);
        }
        svg + &text([self.at[0] + 0.5 * self.size[0], bottom + 32.0], "middle", name)
    }

    /// The numbers of the axis on the left; with lines across where `lines`.
    fn beside(&self, ticks: &[(f64, String)], lines: bool) -> String {
        let mut svg = String::new();
        for (place, label) in ticks {
            let [left, y] = self.point([0.0, *place]);
            let right = if lines { left + self.size[0] } else { left };
            svg += &line([left - 4.0, y], [right, y]);
            svg += &text([left - 7.0, y + 4.0], "end", label);
        }
        svg
    }

    /// The name of the axis on the left, upright; `away` from it.
    fn beside_name(&self, name: &str, away: f64) -> String {
        let [x, y] = [self.at[0] - away, self.at[1] + 0.5 * self.size[1]];
        let mut svg = String::new();
        let _ = write!(
            svg,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\">{}</text>",
            escape(name)
        );
        svg
    }
}

/// An SVG picture of what is drawn in it; `name` says what it shows.
fn picture(class: &str, name: &str, [width, height]: [f64; 2], inside: &str) -> String {
    format!(
        "<svg class=\"chart {class}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">{inside}</svg>",
        escape(name)
    )
}

/// A text; `anchor` is what lies at the point: its `start`, `middle` or `end`.
fn text([x, y]: [f64; 2], anchor: &str, text: &str) -> String {
    let text = escape(text);
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>")
}

/// A title.
fn title([x, y]: [f64; 2], text: &str) -> String {
    let text = escape(text);
    format!("<text class=\"title\" x=\"{x:.1}\" y=\"{y:.1}\">{text}</text>")
}

/// A title and a line of details below it, as far as there are any; with how far what follows is moved down.
fn heading(left: f64, words: &str, detail: &str) -> (String, f64) {
    match detail {
        "" => (title([left, 15.0], words), 0.0),
        detail => (title([left, 15.0], words) + &text([left, 32.0], "start", detail), legend::ROW),
    }
}

/// A thin line.
fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> String {
    format!("<path class=\"grid\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_alone_has_a_size_and_no_variables() {
        let chart = picture("curves", "n", [100.0, 50.0], "<path class=\"curve c7\"/>");
        let file = alone(&chart);
        assert!(file.starts_with("<svg xmlns="), "{file}");
        assert!(file.contains("width=\"160\" height=\"80\""), "{file}");
        assert!(!file.contains("var(") && file.contains("stroke: #5a5f6b"), "{file}");
        assert_eq!(colours().count(), legend::COLOURS);
        assert_eq!(colour(0), [0x1f, 0x66, 0xb5].map(|byte: u8| f64::from(byte) / 255.0));
    }

    #[test]
    fn texts_cannot_leave_their_place() {
        let found = escape("a < b & \"c\" > 'd'\u{0}\u{1b}é\u{ffff}");
        assert_eq!(found, "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;  é\u{fffd}");
    }
}
