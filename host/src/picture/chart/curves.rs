//! Curves in one chart.

use std::fmt::Write as _;

use super::legend::{LEGEND, Pen, ROW, legend};
use super::{Axis, Frame, heading, line, picture};

/// A curve through points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend; none where it is empty.
    pub name: String,
    /// How it is drawn.
    pub pen: Pen,
    /// Its points; where one is not finite the curve is interrupted. Few of them are shown as dots as well.
    pub points: Vec<[f64; 2]>,
    /// How far a band around it reaches up and down at each point; none where it is empty.
    pub band: Vec<f64>,
}

/// A chart of curves.
#[derive(Debug, Clone)]
pub struct Curves<'a> {
    /// What it shows.
    pub title: &'a str,
    /// More of that in a line below; none where it is empty.
    pub detail: &'a str,
    /// The axis below, and what it is of.
    pub x: (Axis, &'a str),
    /// The axis on the left.
    pub y: Axis,
    /// The curves.
    pub curves: &'a [Curve],
    /// A line across at this height, and what it is.
    pub line: Option<(f64, &'a str)>,
}

const SIZE: [f64; 2] = [440.0, 290.0];
const FRAME: Frame = Frame { at: [48.0, 46.0], size: [376.0, 200.0] };

impl Curves<'_> {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let line = self.line.map(|(_, name)| (name, "bound".to_owned()));
        let named: Vec<(&str, String)> = self
            .curves
            .iter()
            .map(|curve| (curve.name.as_str(), curve.pen.classes()))
            .chain(line)
            .collect();
        let (head, top) = heading(FRAME.at[0], self.title, self.detail);
        let top = top + LEGEND;
        let (legend, rows) = legend(&named, [FRAME.at[0], FRAME.at[0] + FRAME.size[0]], top);
        // What lies below moves with the legend.
        let below = top - LEGEND + ROW * (rows.max(1) - 1) as f64;
        let frame = Frame { at: [FRAME.at[0], FRAME.at[1] + below], ..FRAME };
        let mut inside = head + &legend;
        inside += &frame.below(&self.x.0.ticks(7), self.x.1, true);
        inside += &frame.beside(&self.y.ticks(6), true);
        inside += &frame.outline();
        if let Some((height, _)) = self.line {
            let across = self.y.place(height);
            let [from, to] = [0.0, 1.0].map(|along| frame.point([along, across]));
            let _ = write!(
                inside,
                "<path class=\"bound\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>",
                from[0], from[1], to[0], to[1]
            );
        }
        self.curves.iter().for_each(|curve| inside += &self.curve(&frame, curve));
        picture("curves", self.title, [SIZE[0], SIZE[1] + below], &inside)
    }

    fn curve(&self, frame: &Frame, curve: &Curve) -> String {
        let colour = curve.pen.colour;
        let (mut path, mut dots) = (String::new(), String::new());
        let mut pen = 'M';
        for point in &curve.points {
            if !point.iter().all(|value| value.is_finite()) {
                pen = 'M';
                continue;
            }
            let [x, y] = frame.point([self.x.0.place(point[0]), self.y.place(point[1])]);
            let _ = write!(path, "{pen}{x:.1} {y:.1}");
            let _ = write!(
                dots,
                "<circle class=\"dot c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\"/>"
            );
            pen = 'L';
        }
        if path.is_empty() {
            return line(frame.at, frame.at);
        }
        if curve.points.len() > MOST_DOTS {
            dots.clear();
        }
        let band = self.band(frame, curve, colour);
        format!("{band}<path class=\"{}\" d=\"{path}\"/>{dots}", curve.pen.classes())
    }

    /// The band around a curve, forth along its upper side and back along the lower one.
    fn band(&self, frame: &Frame, curve: &Curve, colour: usize) -> String {
        let sides = curve.points.iter().zip(&curve.band);
        let finite: Vec<_> =
            sides.filter(|(point, half)| point[1].is_finite() && half.is_finite()).collect();
        let side = |sign: f64, ([x, y], half): &(&[f64; 2], &f64)| {
            let [x, y] = frame.point([self.x.0.place(*x), self.y.place(y + sign * *half)]);
            format!("{x:.1} {y:.1}")
        };
        let upper = finite.iter().map(|at| side(1.0, at));
        let outline: Vec<String> =
            upper.chain(finite.iter().rev().map(|at| side(-1.0, at))).collect();
        match outline.is_empty() {
            true => String::new(),
            false => format!("<path class=\"band c{colour}\" d=\"M{}Z\"/>", outline.join("L")),
        }
    }
}

/// More points than these are a line and no longer seen as dots.
const MOST_DOTS: usize = 40;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_its_points_and_stops_at_what_is_none() {
        let points = vec![[0.0, 0.5], [45.0, 1.0], [60.0, f64::NAN], [90.0, 0.0]];
        let curve = Curve { name: "a < b".to_owned(), pen: Pen::of(0), points, band: vec![0.1; 4] };
        let chart = Curves {
            title: "T",
            detail: "",
            x: (Axis::degrees(0.0, 90.0), "angle"),
            y: Axis::linear(0.0, 1.0),
            curves: &[curve],
            line: Some((1.0, "bound")),
        };
        let svg = chart.svg();
        // From (48, 46), 376 wide and 200 high, upwards.
        assert!(svg.contains("d=\"M48.0 146.0L236.0 46.0M424.0 246.0\""), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3);
        // 0.1 above and below the curve.
        let band = "d=\"M48.0 126.0L236.0 46.0L424.0 226.0L424.0 246.0L236.0 66.0L48.0 166.0Z\"";
        assert!(svg.contains(band), "{svg}");
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN"), "{svg}");
    }
}
