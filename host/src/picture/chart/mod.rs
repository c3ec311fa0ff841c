//! Charts as SVG for a page: curves over an angle, and numbers over two angles as false colours.
//!
//! They stand inside of HTML, need nothing from outside, and take their colours from [`STYLE`], so that they
//! can be read in a light and in a dark page.

mod axis;
mod curves;
mod panels;

use std::fmt::Write as _;

pub use axis::Axis;
pub use curves::{Curve, Curves};
pub use panels::{Panel, Panels};

/// The style sheet of the charts.
pub const STYLE: &str = include_str!("chart.css");

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

/// A thin line.
fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> String {
    format!("<path class=\"grid\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_leave_their_place() {
        let found = escape("a < b & \"c\" > 'd'\u{0}\u{1b}é");
        assert_eq!(found, "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;  é");
    }
}
