//! Lobes as a drawing: a small SVG with a ground of its own, so that it is legible on light and dark pages.

use std::fmt::Write as _;

use super::lobe::{Lobe, VIEWS};
use crate::picture::chart::escape;

/// The drawing's size, the origin of the directions in it and the radius of a peak [pixels].
const SIZE: [u32; 2] = [440, 192];
const ORIGIN: [f64; 2] = [168.0, 164.0];
const RADIUS: f64 = 134.0;
/// Where the words on the right begin [pixels].
const WORDS: f64 = 336.0;

/// Behind everything: about as dark as what is behind the spheres.
const GROUND: &str = "#2c2e33";

/// A colour and a width for each view, told apart by colour-blind eyes too; later curves lie on earlier
/// ones and are thinner, so that equal curves are all seen.
const PENS: [(&str, f64); VIEWS.len()] = [("#56b4e9", 4.4), ("#f0a030", 2.6), ("#f4f4f4", 1.2)];

/// Parts of the peak that have a ring.
const RINGS: [(f64, &str); 4] = [(1.0, "1"), (0.1, "0.1"), (0.01, "0.01"), (0.001, "")];

/// Angles that have a spoke [degrees], and at which end its label meets it.
const SPOKES: [(f64, &str); 5] =
    [(-60.0, "end"), (-30.0, "end"), (0.0, "middle"), (30.0, "start"), (60.0, "start")];

/// A line that is left out of a curve changes the drawing by less [pixels].
const TOLERANCE: f64 = 0.04;

/// The drawing as a text of its own.
pub fn drawing(name: &str, lobes: &[Lobe]) -> String {
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <title>Lobes of {}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" rx=\"5\" fill=\"{GROUND}\"/>\n",
        escape(name)
    );
    grid(&mut svg);
    labels(&mut svg);
    lobes.iter().zip(PENS).for_each(|(lobe, (colour, _))| mirror(&mut svg, lobe.view, colour));
    lobes.iter().zip(PENS).for_each(|(lobe, pen)| curve(&mut svg, lobe, pen));
    lobes.iter().zip(PENS).for_each(|(lobe, (colour, _))| viewer(&mut svg, lobe.view, colour));
    words(&mut svg, lobes);
    svg.push_str("</svg>\n");
    svg
}

/// Where an angle [radians, to the right] and a radius, in parts of the peak's, lie.
fn at(angle: f64, radius: f64) -> [f64; 2] {
    let [x, y] = ORIGIN;
    [x + RADIUS * radius * angle.sin(), y - RADIUS * radius * angle.cos()]
}

/// Rings, spokes and the surface.
fn grid(svg: &mut String) {
    let [x, y] = ORIGIN;
    svg.push_str("<g fill=\"none\" stroke=\"#5c6068\">\n");
    for (part, _) in RINGS {
        let r = RADIUS * f64::cbrt(part);
        let (left, right) = (x - r, x + r);
        let _ =
            writeln!(svg, "<path d=\"M{left:.2},{y:.2}A{r:.2},{r:.2} 0 0 1 {right:.2},{y:.2}\"/>");
    }
    for (degrees, _) in SPOKES {
        let [a, b] = at(degrees.to_radians(), 1.0);
        let _ = writeln!(svg, "<path d=\"M{x:.2},{y:.2}L{a:.2},{b:.2}\"/>");
    }
    let (left, right) = (x - RADIUS - 14.0, x + RADIUS + 14.0);
    let _ = writeln!(svg, "<path d=\"M{left:.2},{y:.2}H{right:.2}\" stroke=\"#a9adb5\"/>\n</g>");
}

/// What rings and spokes stand for.
fn labels(svg: &mut String) {
    let [x, y] = ORIGIN;
    svg.push_str("<g fill=\"#c6c9cf\" text-anchor=\"middle\">\n");
    for (part, label) in RINGS.iter().filter(|(_, label)| !label.is_empty()) {
        for side in [-1.0, 1.0] {
            let x = x + side * RADIUS * f64::cbrt(*part);
            let _ = writeln!(svg, "<text x=\"{x:.2}\" y=\"{:.2}\">{label}</text>", y + 15.0);
        }
    }
    for (degrees, anchor) in SPOKES {
        let [x, y] = at(degrees.to_radians(), 1.0 + 9.0 / RADIUS);
        let _ = writeln!(
            svg,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\">{:.0}°</text>",
            degrees.abs()
        );
    }
    svg.push_str("</g>\n");
}

/// The mirror direction of a viewer.
fn mirror(svg: &mut String, view: f64, colour: &str) {
    let ([x, y], [a, b]) = (ORIGIN, at(view.to_radians(), 1.0));
    let _ = writeln!(
        svg,
        "<path d=\"M{x:.2},{y:.2}L{a:.2},{b:.2}\" stroke=\"{colour}\" stroke-dasharray=\"4 4\"/>"
    );
}

/// The viewer on the rim, on the other side.
fn viewer(svg: &mut String, view: f64, colour: &str) {
    let [x, y] = at(-view.to_radians(), 1.0);
    let _ = writeln!(
        svg,
        "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"4\" fill=\"{GROUND}\" stroke=\"{colour}\" \
         stroke-width=\"2\"/>"
    );
}

fn curve(svg: &mut String, lobe: &Lobe, (colour, width): (&str, f64)) {
    let mut path = String::new();
    for piece in &lobe.pieces {
        let points: Vec<[f64; 2]> =
            piece.iter().map(|[angle, radius]| at(*angle, *radius)).collect();
        for (index, [x, y]) in simplified(&points).iter().enumerate() {
            let _ = write!(path, "{}{x:.2},{y:.2}", if index == 0 { 'M' } else { 'L' });
        }
    }
    if !path.is_empty() {
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\"/>"
        );
    }
}

/// What the colours mean, with the peaks.
fn words(svg: &mut String, lobes: &[Lobe]) {
    svg.push_str("<g fill=\"#e3e5e8\">\n");
    let _ = writeln!(svg, "<text x=\"{WORDS}\" y=\"34\">peak [1/sr]</text>");
    for (index, (lobe, (colour, width))) in lobes.iter().zip(PENS).enumerate() {
        let y = 56.0 + 20.0 * index as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{WORDS},{:.0}h18\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\n\
             <text x=\"{:.0}\" y=\"{y:.0}\">{}°: {}</text>",
            y - 4.0,
            WORDS + 25.0,
            lobe.view,
            short(lobe.peak)
        );
    }
    let (line, circle) = (WORDS + 25.0, WORDS + 9.0);
    let _ = writeln!(
        svg,
        "<circle cx=\"{circle:.0}\" cy=\"137\" r=\"4\" fill=\"none\" stroke=\"#e3e5e8\" stroke-width=\"2\"/>\n\
         <text x=\"{line:.0}\" y=\"141\">viewer</text>\n\
         <path d=\"M{WORDS},157h18\" stroke=\"#e3e5e8\" stroke-dasharray=\"4 4\"/>\n\
         <text x=\"{line:.0}\" y=\"161\">mirror</text>\n</g>"
    );
}

/// Three digits.
fn short(value: f64) -> String {
    match value {
        0.0 => "none".to_owned(),
        value if !(1e-3..1e5).contains(&value) => format!("{value:.2e}"),
        value => {
            let digits = (2 - value.log10().floor() as i32).clamp(0, 5) as usize;
            format!("{value:.digits$}")
        }
    }
}

/// The curve by fewer points: those whose neighbours' chord passes them closely are left out (Douglas and
/// Peucker 1973).
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = vec![false; points.len()];
    let mut open = vec![(0, points.len().saturating_sub(1))];
    while let Some((first, last)) = open.pop() {
        let [Some(a), Some(b)] = [points.get(first), points.get(last)] else { break };
        (kept[first], kept[last]) = (true, true);
        let inner = (first + 1..last).map(|i| (distance(points[i], *a, *b), i));
        if let Some((far, index)) = inner.max_by(|a, b| a.0.total_cmp(&b.0))
            && far > TOLERANCE
        {
            open.extend([(first, index), (index, last)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// From a point to the chord between two others.
fn distance([x, y]: [f64; 2], [ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let length = dx * dx + dy * dy;
    let along = ((x - ax) * dx + (y - ay) * dy) / length;
    let along = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
    (x - ax - along * dx).hypot(y - ay - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_keeps_its_corners_and_its_ends_and_loses_what_lies_on_lines() {
        let points = [[0.0, 0.0], [1.0, 0.01], [2.0, 0.0], [2.0, 5.0], [2.0, 1.0], [9.0, 1.0]];
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 5.0], [2.0, 1.0], [9.0, 1.0]];
        assert_eq!(simplified(&points), corners);
        assert!(simplified(&[]).is_empty());
        // A closed way has two ends at one place.
        let there_and_back = [[0.0, 0.0], [3.0, 4.0], [0.0, 0.0]];
        assert_eq!(simplified(&there_and_back), there_and_back);
    }

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.159_15, "0.159"),
            (4.2, "4.20"),
            (39_123.4, "39123"),
            (123_456.0, "1.23e5"),
            (0.001_234, "0.00123"),
            (9.9e-5, "9.90e-5"),
            (0.0, "none"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_name_is_no_markup() {
        let lobe =
            Lobe { view: 30.0, peak: 1.0, pieces: vec![vec![[0.0, 1.0], [0.5, 0.5]]], left_out: 0 };
        let svg = drawing("<script>\"&", &[lobe]);
        assert!(svg.contains("Lobes of &lt;script&gt;&quot;&amp;</title>"), "{svg}");
    }
}
