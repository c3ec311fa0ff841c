//! Curves over the directions of a half plane: the normal up, the horizon below.

use std::fmt::Write as _;

use super::legend::{LEGEND, ROW, legend};
use super::{Axis, Curve, heading, line, picture, text};

/// A polar chart.
#[derive(Debug, Clone)]
pub struct Polar<'a> {
    /// What it shows.
    pub title: &'a str,
    /// More of that in a line below.
    pub detail: &'a str,
    /// What the radius is, from the centre to the outer ring.
    pub radius: Axis,
    /// Curves of an angle from the normal [degrees], to the right where it is positive, and a value.
    pub curves: &'a [Curve],
    /// Angles that are marked [degrees], and what they are.
    pub marks: &'a [(f64, &'a str)],
}

const SIZE: [f64; 2] = [480.0, 292.0];
/// The place that directions go out from, and the radius of the outer ring.
const CENTRE: [f64; 2] = [240.0, 262.0];
const RADIUS: f64 = 178.0;
/// Angles that have a spoke [degrees].
const SPOKES: [f64; 7] = [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0];

/// Where titles and legends begin.
const LEFT: f64 = 16.0;
/// Names around the chart need so much room [degrees], and numbers of rings so much of the radius.
const APART: f64 = 8.0;
const ROOM: f64 = 0.16;

impl Polar<'_> {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let named: Vec<(&str, String)> =
            self.curves.iter().map(|curve| (curve.name.as_str(), curve.pen.classes())).collect();
        let (head, top) = heading(LEFT, self.title, self.detail);
        let (legend, rows) = legend(&named, [LEFT, SIZE[0] - LEFT], top + LEGEND);
        let below = top + ROW * (rows.max(1) - 1) as f64;
        let at = |angle: f64, radius: f64| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            [CENTRE[0] + RADIUS * radius * sine, CENTRE[1] + below - RADIUS * radius * cosine]
        };
        let mut inside = head + &legend;
        for angle in SPOKES {
            inside += &line(at(0.0, 0.0), at(angle, 1.0));
            // Where a mark's name stands there is no room.
            if self.marks.iter().any(|(mark, _)| (mark - angle).abs() < APART) {
                continue;
            }
            inside += &beside(at(angle, 1.0 + 7.0 / RADIUS), angle, &format!("{}°", angle.abs()));
        }
        // The outer ring ends the axis, whether a round number lies there or not.
        let mut rings = self.radius.ticks(5);
        let has = |rings: &[(f64, String)], end: f64| {
            rings.iter().any(|(place, _)| (place - end).abs() < ROOM)
        };
        for (end, label) in [(0.0, self.radius.lowest()), (1.0, self.radius.highest())] {
            if !has(&rings, end) {
                rings.push((end, label));
            }
        }
        for (place, label) in &rings {
            inside += &ring(at(-90.0, *place), at(90.0, *place), RADIUS * place);
            let [x, y] = at(90.0, *place);
            inside += &text([x, y + 16.0], "middle", label);
        }
        inside += &ring(at(-90.0, 1.0), at(90.0, 1.0), RADIUS);
        for (angle, name) in self.marks {
            let ([x, y], [a, b]) = (at(0.0, 0.0), at(*angle, 1.0));
            let _ = write!(inside, "<path class=\"bound\" d=\"M{x:.1} {y:.1}L{a:.1} {b:.1}\"/>");
            inside += &beside(at(*angle, 1.0 + 7.0 / RADIUS), *angle, name);
        }
        for curve in self.curves {
            let (mut path, mut pen) = (String::new(), 'M');
            for [angle, value] in &curve.points {
                if !value.is_finite() {
                    pen = 'M';
                    continue;
                }
                let [x, y] = at(*angle, self.radius.place(*value));
                let _ = write!(path, "{pen}{x:.1} {y:.1}");
                pen = 'L';
            }
            let _ = write!(inside, "<path class=\"{}\" d=\"{path}\"/>", curve.pen.classes());
        }
        picture("curves", self.title, [SIZE[0], SIZE[1] + below], &inside)
    }
}

/// Half a ring from one end to the other.
fn ring([left, y]: [f64; 2], [right, _]: [f64; 2], r: f64) -> String {
    format!("<path class=\"grid\" d=\"M{left:.1} {y:.1}A{r:.1} {r:.1} 0 0 1 {right:.1} {y:.1}\"/>")
}

/// A text outside of the outer ring, at an angle.
fn beside([x, y]: [f64; 2], angle: f64, words: &str) -> String {
    let anchor = match angle {
        -5.0..=5.0 => "middle",
        angle if angle < 0.0 => "end",
        _ => "start",
    };
    text([x, y + 4.0 * angle.to_radians().sin().abs()], anchor, words)
}

#[cfg(test)]
mod tests {
    use super::super::Pen;
    use super::*;

    /// Up is the normal, and the largest value lies on the outer ring.
    #[test]
    fn directions_go_out_from_the_centre() {
        let points = vec![[0.0, 2.0], [90.0, 1.0], [10.0, f64::NAN], [-90.0, 2.0]];
        let polar = Polar {
            title: "T",
            detail: "",
            radius: Axis::linear(0.0, 2.0),
            curves: &[Curve { name: String::new(), pen: Pen::of(0), points, band: Vec::new() }],
            marks: &[(-45.0, "wi")],
        };
        let svg = polar.svg();
        assert!(svg.contains("d=\"M240.0 84.0L329.0 262.0M62.0 262.0\""), "{svg}");
        assert!(svg.contains(">wi</text>"));
    }
}
