//! A report's plots as parts of a page.

use brdf_sdk::Result;

use crate::conformance::{Densities, Plots, Raster, Spread, Window};
use crate::picture::Scale;
use crate::picture::chart::{Axis, Curve, Curves, Panel, Panels, Pen, escape};

/// Pixels of a density along the azimuth and along theta.
const PIXELS: [usize; 2] = [246, 178];
/// The parts of the draws that a view's windows hold: nearly all of them, and the core of a lobe that is small
/// in that window.
const ALL: f64 = 0.999;
const CORE: f64 = 0.9;
/// What part of the window of all the core's may be, to be shown as well.
const SMALL: f64 = 1.0 / 16.0;
/// Where the colours of deviations end.
const DEVIATIONS: f64 = 5.0;

/// All plots that there is something to show in; empty where there are none.
pub fn plots(plots: &Plots) -> Result<String> {
    let mut html = String::new();
    let curves = [albedo(plots), own(plots), ratio(plots)];
    let curves: String = curves.into_iter().flatten().collect();
    if !curves.is_empty() {
        html += &format!("<h3>Along the angle</h3>\n<div class=\"row\">{curves}</div>\n");
    }
    if let Some(first) = plots.densities.first() {
        html += &format!(
            "<h3>Densities</h3>\n<p>{} draws at each view, counted in up to {} cells that follow the density; \
             what is expected is the integral of <code>pdf</code> over each cell in f64. The window holds \
             99.9 % of the draws; where most of them fill a small part of it, another one follows that \
             holds 90 %. Deviations are those of a cell's count, or of the sum of counts where a pixel holds \
             several cells. The ring is the mirror direction.</p>\n",
            grouped(first.draws),
            grouped(plots.densities.iter().map(|one| one.cells.len() as u64).max().unwrap_or(0))
        );
    }
    for one in &plots.densities {
        html += &view(one)?;
    }
    Ok(html)
}

/// A view's densities in one window or in two.
fn view(densities: &Densities) -> Result<String> {
    let [all, core] = [ALL, CORE].map(|held| densities.window(held));
    let small = core.area() < SMALL * all.area();
    let mark = if densities.failed { "<span class=\"failed\">FAILED</span> " } else { "" };
    let mut html = format!("<figure><figcaption>{mark}{}</figcaption>", escape(&densities.at));
    for window in [Some(all), small.then_some(core)].into_iter().flatten() {
        html += &panels(densities, window)?;
    }
    Ok(html + "</figure>\n")
}

/// A number with its thousands set apart.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let comma = |place: usize| place > 0 && (digits.len() - place).is_multiple_of(3);
    let grouped = digits.chars().enumerate();
    grouped
        .flat_map(|(place, digit)| comma(place).then_some(',').into_iter().chain([digit]))
        .collect()
}

/// Drawn, expected and how far they are from each other, side by side.
fn panels(densities: &Densities, window: Window) -> Result<String> {
    let Raster { drawn, expected, deviations } = densities.raster(window, PIXELS);
    let both: Vec<f64> = drawn.iter().chain(&expected).copied().collect();
    let scale = Scale::spanning(&both);
    let density =
        |title, values| Panel { title, values, scale, legend: "density [1/sr], logarithmic" };
    let theta = densities.view[0];
    let azimuth = match theta {
        0.0 => "azimuth from the tangent [degrees]",
        _ => "azimuth from wo [degrees]",
    };
    let degrees = |[low, high]: [f64; 2]| Axis::degrees(low.to_degrees(), high.to_degrees());
    let panels = Panels {
        name: &format!("Densities with {}", densities.at),
        size: PIXELS,
        x: (degrees(window.azimuth), azimuth),
        y: (degrees(window.theta), "theta [degrees]"),
        panels: &[
            density("drawn", &drawn),
            density("expected", &expected),
            Panel {
                title: "(drawn − expected) / √expected",
                values: &deviations,
                scale: Scale::Diverging { largest: DEVIATIONS },
                legend: "deviation [standard deviations of the count]",
            },
        ],
        marks: if theta == 0.0 { &[] } else { &[[180.0, theta]] },
    };
    panels.svg()
}

/// The directional albedo of the white preset.
fn albedo(plots: &Plots) -> Option<String> {
    const MOST_LINEAR: f64 = 2.0;
    let values = || plots.albedo.iter().map(|[_, albedo]| *albedo);
    let high = values().filter(|albedo| *albedo > MOST_LINEAR).count() > 0;
    let y = if high { Axis::logarithmic(values(), 1.0) } else { Axis::from_zero(values(), 1.0) };
    let curve = Curve {
        name: String::new(),
        pen: Pen::of(0),
        points: plots.albedo.clone(),
        band: Vec::new(),
    };
    curves("Directional albedo of the white preset", y, &[curve], (1.0, "all light leaves"))
}

/// How much the weights vary.
fn own(plots: &Plots) -> Option<String> {
    const MOST_LINEAR: f64 = 3.0;
    let values = || plots.spreads.iter().map(|spread| spread.own);
    let high = values().filter(|own| *own > MOST_LINEAR).count() > 0;
    let y = if high { Axis::logarithmic(values(), 1.0) } else { Axis::from_zero(values(), 1.0) };
    let found = by_azimuth(&plots.spreads, |spread| spread.own);
    curves("Relative deviation of a weight", y, &found, (1.0, "the mean"))
}

/// How the variance compares with draws by the cosine.
fn ratio(plots: &Plots) -> Option<String> {
    let y = Axis::logarithmic(plots.spreads.iter().map(|spread| spread.ratio), 1.0);
    let found = by_azimuth(&plots.spreads, |spread| spread.ratio);
    curves("Variance over that of draws by the cosine", y, &found, (1.0, "the cosine's"))
}

/// A curve for each azimuth of `wo`.
fn by_azimuth(spreads: &[Spread], value: fn(&Spread) -> f64) -> Vec<Curve> {
    let mut azimuths: Vec<f64> = spreads.iter().map(|spread| spread.view[1]).collect();
    azimuths.sort_by(f64::total_cmp);
    azimuths.dedup();
    // The legend has room for the word once.
    let curve = |(index, azimuth): (usize, f64)| {
        let of = spreads.iter().filter(|spread| spread.view[1] == azimuth);
        let points = of.map(|spread| [spread.view[0], value(spread)]).collect();
        let word = if index == 0 { "azimuth " } else { "" };
        Curve { name: format!("{word}{azimuth}°"), pen: Pen::of(index), points, band: Vec::new() }
    };
    azimuths.into_iter().enumerate().map(curve).collect()
}

/// A chart along the angle of `wo`; `None` without points.
fn curves(title: &str, y: Axis, curves: &[Curve], line: (f64, &str)) -> Option<String> {
    let x = (Axis::degrees(0.0, 90.0), "angle of wo from the normal [degrees]");
    let points = curves.iter().any(|curve| !curve.points.is_empty());
    points.then(|| Curves { title, detail: "", x, y, curves, line: Some(line) }.svg())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_set_apart() {
        let found = [0, 999, 1000, 65_536, 1_000_000].map(grouped);
        assert_eq!(found, ["0", "999", "1,000", "65,536", "1,000,000"]);
    }

    /// A view's plots whatever the numbers: none, no draws, no finite density.
    #[test]
    fn odd_numbers_make_plots_too() {
        let mut found = Plots::default();
        assert_eq!(plots(&found).unwrap(), "");
        let cell = crate::conformance::Cell::HEMISPHERE;
        for density in [0.0, f64::NAN, f64::INFINITY] {
            let cells = vec![(cell, [0.0, density])];
            let at = "<at>".to_owned();
            let one = Densities { view: [30.0, 37.0], at, failed: true, draws: 0, cells };
            found.densities.push(one);
        }
        found.albedo = vec![[0.0, f64::NAN], [45.0, 0.0], [89.0, 700.0]];
        found.spreads = vec![Spread { view: [0.0, 0.0], own: 0.0, ratio: 0.0 }];
        let html = plots(&found).unwrap();
        assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
        assert_eq!(html.matches("FAILED</span> &lt;at&gt;").count(), 3);
        assert_eq!(html.matches("class=\"chart curves\"").count(), 3);
    }
}
