//! A plot as a drawing.

use brdf_sdk::Result;

use super::options::Options;
use super::shown::{DECADES, Plot, Series};
use crate::picture::chart::{
    Arrow, Axis, Curve, Curves, Polar, Slice, Slices, Surface, Surfaces, alone,
};
use crate::picture::display;
use crate::plot::Angles;
use crate::plot::slice::chroma;

/// What is drawn where no pair of directions lies above the horizon.
const UNSEEN: [u8; 3] = [118, 118, 124];

/// Numbers below a slice [degrees].
const TICKS: [f64; 6] = [0.0, 5.0, 15.0, 30.0, 60.0, 90.0];

/// The SVG file.
pub(super) fn svg(plot: &Plot, options: &Options) -> Result<String> {
    let words = options.words();
    let wi = options.wi();
    let at_wi = format!("{words}, wi {}, azimuth {}", degrees(wi.theta), degrees(wi.phi));
    let drawing = match plot {
        Plot::Polar(series) => Polar {
            title: &at_wi,
            radius: axis(values(series), options.log),
            curves: &curves(series),
            marks: &[(-wi.theta, "wi"), (wi.theta, "mirror")],
        }
        .svg(),
        Plot::Lines(series, [low, high], name) => {
            let fixed = |name, angle| {
                format!("{words}, {name} {}, phi_d {}", degrees(angle), degrees(options.phi_d()))
            };
            let title = match name.split(':').next() {
                Some("theta_h") => fixed("theta_d", options.theta_d()),
                Some("theta_d") => fixed("theta_h", options.theta_h()),
                _ => at_wi,
            };
            let y = axis(values(series), options.log);
            let mut curves = curves(series);
            if options.log {
                // A line along the axis would be read as values.
                let points = curves.iter_mut().flat_map(|curve| &mut curve.points);
                points.filter(|point| !y.holds(point[1])).for_each(|point| point[1] = f64::NAN);
            }
            Curves {
                title: &title,
                x: (Axis::degrees(*low, *high), &format!("{name} [degrees]")),
                y,
                curves: &curves,
                line: None,
            }
            .svg()
        }
        Plot::Albedo(series) => {
            let y = match options.log {
                true => axis(values(series), true),
                false => Axis::from_zero(values(series), 1.0),
            };
            Curves {
                title: &format!("{}the directional albedo", options.channel_words()),
                x: (Axis::degrees(0.0, 90.0), "wo from the normal [degrees]"),
                y,
                curves: &curves(series),
                line: Some((1.0, "all light leaves")),
            }
            .svg()
        }
        Plot::Slices(slice, all) => {
            let pixel = |f: &[f64; 3]| match f.iter().all(|c| c.is_finite()) {
                true => {
                    let rgb = if options.chroma { chroma(*f) } else { *f };
                    let stops = options.exposure() as f32;
                    rgb.map(|c| (255.0 * display(c as f32, stops)).round() as u8)
                }
                false => UNSEEN,
            };
            let slices: Vec<Slice> = all
                .iter()
                .map(|(name, values)| Slice {
                    title: name.clone(),
                    pixels: values.iter().map(pixel).collect(),
                })
                .collect();
            let place =
                |angle: f64| if slice.square { (angle / 90.0).sqrt() } else { angle / 90.0 };
            // Closer together they would run into each other.
            let apart = |angle: &f64| slice.square || ![5.0, 15.0].contains(angle);
            let ticks: Vec<(f64, String)> = TICKS
                .into_iter()
                .filter(apart)
                .map(|angle| (place(angle), angle.to_string()))
                .collect();
            Slices {
                name: &format!("f, phi_d {}", degrees(slice.phi_d)),
                size: [slice.size; 2],
                x: (&ticks, "theta_h [degrees]"),
                y: (Axis::degrees(0.0, 90.0), "theta_d [degrees]"),
                slices: &slices,
            }
            .svg()?
        }
        Plot::Lobes(all) => {
            let radius =
                axis(all.iter().flat_map(|(_, lobe)| lobe.values.iter().copied()), options.log);
            let surfaces: Vec<Surface> = all
                .iter()
                .map(|(name, lobe)| Surface {
                    name: name.clone(),
                    around: lobe.around,
                    points: std::iter::zip(&lobe.directions, &lobe.values)
                        .map(|(direction, value)| direction.map(|c| c * radius.place(*value)))
                        .collect(),
                })
                .collect();
            let mirror = Angles { theta: wi.theta, phi: wi.phi + 180.0 };
            let arrow = |to, colour, name| Arrow { to, colour, name };
            Surfaces {
                title: &at_wi,
                from: options.eye(),
                surfaces: &surfaces,
                arrows: &[
                    arrow([1.0, 0.0, 0.0], [192, 48, 48], "tangent"),
                    arrow([0.0, 1.0, 0.0], [47, 143, 58], "bitangent"),
                    arrow([0.0, 0.0, 1.0], [48, 80, 192], "normal"),
                    arrow(wi.direction(), [15, 143, 160], "wi"),
                    arrow(mirror.direction(), [176, 47, 160], "mirror"),
                ],
            }
            .svg()?
        }
    };
    Ok(alone(&drawing))
}

/// An angle as titles have room for it.
fn degrees(angle: f64) -> String {
    format!("{}°", (10.0 * angle).round() / 10.0)
}

fn values(series: &[Series]) -> impl Iterator<Item = f64> {
    series.iter().flat_map(|series| series.points.iter().map(|[_, value]| *value))
}

/// From 0, or the decades below the largest value.
fn axis(values: impl Iterator<Item = f64>, log: bool) -> Axis {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let largest = values.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Axis::linear(0.0, 1.0);
    }
    if !log {
        return Axis::from_zero(values.into_iter(), largest);
    }
    let least = largest * 10f64.powf(-DECADES);
    Axis::logarithmic(values.into_iter().filter(|value| *value >= least), largest)
}

/// Bands reach two standard errors up and down.
fn curves(series: &[Series]) -> Vec<Curve> {
    let curve = |series: &Series| Curve {
        name: series.name.clone(),
        points: series.points.clone(),
        band: series.errors.iter().map(|error| 2.0 * error).collect(),
    };
    series.iter().map(curve).collect()
}
