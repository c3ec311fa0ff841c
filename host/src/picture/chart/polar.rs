//! Curves over the directions of a half plane: the normal up, the horizon below.

use std::fmt::Write as _;

use super::curves::{COLOURS, ROW, legend};
use super::{Axis, Curve, line, picture, text, title};

/// A polar chart.
#[derive(Debug, Clone)]
pub struct Polar<'a> {
    /// What it shows.
    pub title: &'a str,
    /// What the radius is, from the centre to the outer ring.
    pub radius: Axis,
    /// Curves of an angle from the normal [degrees], to the right where it is positive, and a value.
    pub curves: &'a [Curve],
    /// Angles that are marked [degrees], and what they are.
    pub marks: &'a [(f64, &'a str)],
}

const SIZE: [f64; 2] = [440.0, 292.0];
/// The place that directions go out from, and the radius of the outer ring.
const CENTRE: [f64; 2] = [220.0, 262.0];
const RADIUS: f64 = 178.0;
/// Angles that have a spoke [degrees].
const SPOKES: [f64; 7] = [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0];

/// Names around the chart need so much room [degrees].
const APART: f64 = 8.0;

impl Polar<'_> {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let names: Vec<&str> = self.curves.iter().map(|curve| curve.name.as_str()).collect();
        let (legend, rows) = legend(&names, 16.0, SIZE[0] - 10.0);
        let below = ROW * (rows.max(1) - 1) as f64;
        let at = |angle: f64, radius: f64| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            [CENTRE[0] + RADIUS * radius * sine, CENTRE[1] + below - RADIUS * radius * cosine]
        };
        let mut inside = title([16.0, 15.0], self.title) + &legend;
        for angle in SPOKES {
            inside += &line(at(0.0, 0.0), at(angle, 1.0));
            // Where a mark's name stands there is no room.
            if self.marks.iter().any(|(mark, _)| (mark - angle).abs() < APART) {
                continue;
            }
            inside += &beside(at(angle, 1.0 + 7.0 / RADIUS), angle, &format!("{}°", angle.abs()));
        }
        for (place, label) in self.radius.ticks(4) {
            let ([left, y], [right, _]) = (at(-90.0, place), at(90.0, place));
            let r = RADIUS * place;
            let _ = write!(
                inside,
                "<path class=\"grid\" d=\"M{left:.1} {y:.1}A{r:.1} {r:.1} 0 0 1 {right:.1} {y:.1}\"/>"
            );
            inside += &text([right, y + 16.0], "middle", &label);
        }
        for (angle, name) in self.marks {
            let ([x, y], [a, b]) = (at(0.0, 0.0), at(*angle, 1.0));
            let _ = write!(inside, "<path class=\"bound\" d=\"M{x:.1} {y:.1}L{a:.1} {b:.1}\"/>");
            inside += &beside(at(*angle, 1.0 + 7.0 / RADIUS), *angle, name);
        }
        for (index, curve) in self.curves.iter().enumerate() {
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
            let _ = write!(inside, "<path class=\"curve c{}\" d=\"{path}\"/>", index % COLOURS);
        }
        picture("curves", self.title, [SIZE[0], SIZE[1] + below], &inside)
    }
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
    use super::*;

    /// Up is the normal, and the largest value lies on the outer ring.
    #[test]
    fn directions_go_out_from_the_centre() {
        let points = vec![[0.0, 2.0], [90.0, 1.0], [10.0, f64::NAN], [-90.0, 2.0]];
        let polar = Polar {
            title: "T",
            radius: Axis::linear(0.0, 2.0),
            curves: &[Curve { name: String::new(), points, band: Vec::new() }],
            marks: &[(-45.0, "wi")],
        };
        let svg = polar.svg();
        assert!(svg.contains("d=\"M220.0 84.0L309.0 262.0M42.0 262.0\""), "{svg}");
        assert!(svg.contains(">wi</text>"));
    }
}
