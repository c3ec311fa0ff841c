//! Curves in one chart.

use std::fmt::Write as _;

use super::{Axis, Frame, line, picture, text, title};

/// A curve through points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend; none where it is empty.
    pub name: String,
    /// Its points; where one is not finite the curve is interrupted.
    pub points: Vec<[f64; 2]>,
}

/// A chart of curves.
#[derive(Debug, Clone)]
pub struct Curves<'a> {
    /// What it shows.
    pub title: &'a str,
    /// The axis below, and what it is of.
    pub x: (Axis, &'a str),
    /// The axis on the left.
    pub y: Axis,
    /// The curves; there are four colours.
    pub curves: &'a [Curve],
    /// A line across at this height, and what it is.
    pub line: (f64, &'a str),
}

const SIZE: [f64; 2] = [440.0, 290.0];
const FRAME: Frame = Frame { at: [48.0, 46.0], size: [376.0, 200.0] };

impl Curves<'_> {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let mut inside = title([FRAME.at[0], 15.0], self.title);
        inside += &self.legend();
        inside += &FRAME.below(&self.x.0.ticks(7), self.x.1, true);
        inside += &FRAME.beside(&self.y.ticks(6), true);
        inside += &FRAME.outline();
        let across = self.y.place(self.line.0);
        let [from, to] = [0.0, 1.0].map(|along| FRAME.point([along, across]));
        let _ = write!(
            inside,
            "<path class=\"bound\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>",
            from[0], from[1], to[0], to[1]
        );
        for (index, curve) in self.curves.iter().enumerate() {
            inside += &self.curve(index, curve);
        }
        picture("curves", self.title, SIZE, &inside)
    }

    /// The curves' names from the left, the line's from the right.
    fn legend(&self) -> String {
        let mut svg = String::new();
        let mut x = FRAME.at[0];
        let named = self.curves.iter().enumerate().filter(|(_, curve)| !curve.name.is_empty());
        for (index, curve) in named {
            svg += &sample(&format!("curve c{}", index % COLOURS), x);
            svg += &text([x + SAMPLE + 5.0, 35.0], "start", &curve.name);
            x += SAMPLE + 16.0 + width(&curve.name);
        }
        let left = FRAME.at[0] + FRAME.size[0] - width(self.line.1);
        svg += &sample("bound", left - SAMPLE - 5.0);
        svg + &text([left, 35.0], "start", self.line.1)
    }

    fn curve(&self, index: usize, curve: &Curve) -> String {
        let colour = index % COLOURS;
        let (mut path, mut dots) = (String::new(), String::new());
        let mut pen = 'M';
        for point in &curve.points {
            if !point.iter().all(|value| value.is_finite()) {
                pen = 'M';
                continue;
            }
            let [x, y] = FRAME.point([self.x.0.place(point[0]), self.y.place(point[1])]);
            let _ = write!(path, "{pen}{x:.1} {y:.1}");
            let _ = write!(
                dots,
                "<circle class=\"dot c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\"/>"
            );
            pen = 'L';
        }
        if path.is_empty() {
            return line(FRAME.at, FRAME.at);
        }
        format!("<path class=\"curve c{colour}\" d=\"{path}\"/>{dots}")
    }
}

/// Length of a line in the legend.
const SAMPLE: f64 = 22.0;

/// A line of the legend.
fn sample(class: &str, x: f64) -> String {
    format!("<path class=\"{class}\" d=\"M{x:.1} 31L{:.1} 31\"/>", x + SAMPLE)
}

/// About the width of a text: nobody knows the font.
fn width(text: &str) -> f64 {
    6.8 * text.chars().count() as f64
}

/// Colours of curves in the style sheet.
const COLOURS: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_its_points_and_stops_at_what_is_none() {
        let points = vec![[0.0, 0.5], [45.0, 1.0], [60.0, f64::NAN], [90.0, 0.0]];
        let curve = Curve { name: "a < b".to_owned(), points };
        let chart = Curves {
            title: "T",
            x: (Axis::degrees(0.0, 90.0), "angle"),
            y: Axis::linear(0.0, 1.0),
            curves: &[curve],
            line: (1.0, "bound"),
        };
        let svg = chart.svg();
        // From (48, 46), 376 wide and 200 high, upwards.
        assert!(svg.contains("d=\"M48.0 146.0L236.0 46.0M424.0 246.0\""), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN"), "{svg}");
    }
}
