//! Curves in one chart.

use std::fmt::Write as _;

use super::{Axis, Frame, line, picture, text, title};

/// A curve through points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend; none where it is empty.
    pub name: String,
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
    /// The axis below, and what it is of.
    pub x: (Axis, &'a str),
    /// The axis on the left.
    pub y: Axis,
    /// The curves; there are eight colours.
    pub curves: &'a [Curve],
    /// A line across at this height, and what it is.
    pub line: Option<(f64, &'a str)>,
}

const SIZE: [f64; 2] = [440.0, 290.0];
const FRAME: Frame = Frame { at: [48.0, 46.0], size: [376.0, 200.0] };

impl Curves<'_> {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let names: Vec<&str> = self.curves.iter().map(|curve| curve.name.as_str()).collect();
        let (legend, rows) = legend(&names, FRAME.at[0], self.end_of_names());
        // A legend of several rows moves what lies below it.
        let below = ROW * (rows.max(1) - 1) as f64;
        let frame = Frame { at: [FRAME.at[0], FRAME.at[1] + below], ..FRAME };
        let mut inside = title([FRAME.at[0], 15.0], self.title);
        inside += &legend;
        inside += &frame.below(&self.x.0.ticks(7), self.x.1, true);
        inside += &frame.beside(&self.y.ticks(6), true);
        inside += &frame.outline();
        if let Some((height, name)) = self.line {
            let across = self.y.place(height);
            let [from, to] = [0.0, 1.0].map(|along| frame.point([along, across]));
            let _ = write!(
                inside,
                "<path class=\"bound\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>",
                from[0], from[1], to[0], to[1]
            );
            let left = self.end_of_names() + 16.0;
            inside += &sample("bound", left, LEGEND);
            inside += &text([left + SAMPLE + 5.0, LEGEND], "start", name);
        }
        for (index, curve) in self.curves.iter().enumerate() {
            inside += &self.curve(&frame, index, curve);
        }
        picture("curves", self.title, [SIZE[0], SIZE[1] + below], &inside)
    }

    /// How far to the right the curves' names may go: the line's stands at the end of their first row.
    fn end_of_names(&self) -> f64 {
        let right = FRAME.at[0] + FRAME.size[0];
        self.line.map_or(right, |(_, name)| right - width(name) - SAMPLE - 21.0)
    }

    fn curve(&self, frame: &Frame, index: usize, curve: &Curve) -> String {
        let colour = index % COLOURS;
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
        format!("{band}<path class=\"curve c{colour}\" d=\"{path}\"/>{dots}")
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

/// Where the first row of a legend stands, and how far rows are apart.
const LEGEND: f64 = 35.0;
pub(super) const ROW: f64 = 17.0;

/// The names of curves from `left` on in rows that end before `right`, and how many rows they are.
pub(super) fn legend(names: &[&str], left: f64, right: f64) -> (String, usize) {
    let mut svg = String::new();
    let (mut x, mut rows) = (left, 0);
    for (index, name) in names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        let end = x + SAMPLE + 5.0 + width(name);
        if rows == 0 || (end > right && x > left) {
            (x, rows) = (left, rows + 1);
        }
        let y = LEGEND + ROW * (rows - 1) as f64;
        svg += &sample(&format!("curve c{}", index % COLOURS), x, y);
        svg += &text([x + SAMPLE + 5.0, y], "start", name);
        x += SAMPLE + 16.0 + width(name);
    }
    (svg, rows)
}

/// Length of a line in the legend.
const SAMPLE: f64 = 22.0;

/// A line of the legend, at the height of a text.
fn sample(class: &str, x: f64, y: f64) -> String {
    format!("<path class=\"{class}\" d=\"M{x:.1} {0:.1}L{1:.1} {0:.1}\"/>", y - 4.0, x + SAMPLE)
}

/// About the width of a text: nobody knows the font.
fn width(text: &str) -> f64 {
    6.8 * text.chars().count() as f64
}

/// Colours of curves in the style sheet.
pub const COLOURS: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_do_not_fit_go_on_in_another_row() {
        let names = ["a long name of a curve"; 5];
        let (svg, rows) = legend(&names, 0.0, 400.0);
        assert_eq!((rows, svg.matches("<text").count()), (3, 5));
        assert_eq!(legend(&["", ""], 0.0, 400.0), (String::new(), 0));
        assert_eq!(legend(&names[..1], 0.0, 10.0).1, 1);
    }

    #[test]
    fn a_curve_goes_through_its_points_and_stops_at_what_is_none() {
        let points = vec![[0.0, 0.5], [45.0, 1.0], [60.0, f64::NAN], [90.0, 0.0]];
        let curve = Curve { name: "a < b".to_owned(), points, band: vec![0.1; 4] };
        let chart = Curves {
            title: "T",
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
