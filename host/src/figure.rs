//! Plots as drawings: SVG for files, pixels for the window's lobe. The numbers are `plot`'s, shapes and axes
//! `picture::chart`'s; what is decided here is how a view looks.

use brdf_sdk::Result;
use glam::DVec3;

use crate::picture::chart::{
    Arrow, Axis, Curve, Curves, PENS, Pen, Polar, Raster, Slice, Slices, Surface, Surfaces, alone,
};
use crate::plot::hemisphere::Hemisphere;
use crate::plot::lines::Line;
use crate::plot::slice::chroma;
use crate::plot::{Angles, Channel, Plot, Series, Settings};
use crate::tone::{Tone, byte};

/// What is drawn where no pair of directions lies above the horizon.
const UNSEEN: [u8; 3] = [118, 118, 124];

/// Numbers below a slice [degrees], and those among them that need the wider axis.
const TICKS: [(f64, bool); 6] =
    [(0.0, false), (5.0, true), (15.0, true), (30.0, false), (60.0, false), (90.0, false)];

/// The SVG file. Each BRDF has the pen of its number; those beyond them have one by their place.
///
/// # Errors
/// Where a picture cannot be coded.
pub fn svg(plot: &Plot, settings: &Settings, pens: &[usize]) -> Result<String> {
    let words = settings.words();
    let wi = settings.wi;
    let light = format!("wi {} from the normal, azimuth {}", degrees(wi.theta), degrees(wi.phi));
    let drawing = match plot {
        Plot::Polar(series) => Polar {
            title: &words,
            detail: &format!("{light}; wo in the same plane"),
            radius: axis(values(series), settings.decades),
            curves: &curves(series, settings, pens),
            marks: &marks(wi),
        }
        .svg(),
        Plot::Lines(series, line) => {
            let y = axis(values(series), settings.decades);
            let mut curves = curves(series, settings, pens);
            if settings.decades.is_some() {
                // A line along the axis would be read as values.
                let points = curves.iter_mut().flat_map(|curve| &mut curve.points);
                points.filter(|point| !y.holds(point[1])).for_each(|point| point[1] = f64::NAN);
            }
            let [low, high] = line.range();
            let (name, detail) = line_words(line, &light, settings);
            let x = (Axis::degrees(low, high), name);
            Curves { title: &words, detail: &detail, x, y, curves: &curves, line: None }.svg()
        }
        Plot::Albedo(series) => Curves {
            title: &format!("{}the directional albedo", settings.channel_words()),
            detail: &format!(
                "wo at azimuth {}; bands reach two standard errors",
                degrees(settings.albedo_azimuth)
            ),
            x: (Axis::degrees(0.0, 90.0), "wo from the normal [degrees]"),
            y: match settings.decades {
                Some(_) => axis(values(series).chain([1.0]), settings.decades),
                None => Axis::from_zero(values(series), 1.0),
            },
            curves: &curves(series, settings, pens),
            line: Some((1.0, "all light leaves")),
        }
        .svg(),
        Plot::Slices(slice, all) => {
            let place = |angle: f64| match slice.square {
                true => (angle / 90.0).sqrt(),
                false => angle / 90.0,
            };
            let ticks: Vec<(f64, String)> = TICKS
                .into_iter()
                .filter(|(_, wide)| slice.square || !wide)
                .map(|(angle, _)| (place(angle), angle.to_string()))
                .collect();
            let what = if settings.chroma { "f over its largest channel" } else { "f [1/sr]" };
            Slices {
                title: &format!("{what}, {:+} stops", settings.exposure),
                detail: &format!("phi_d {}; grey lies below the horizon", degrees(slice.phi_d)),
                size: [slice.size; 2],
                x: (&ticks, "theta_h [degrees]"),
                y: (Axis::degrees(0.0, 90.0), "theta_d [degrees]"),
                slices: &all.iter().map(|one| picture(one, settings)).collect::<Vec<_>>(),
            }
            .svg()?
        }
        Plot::Lobes(all) => {
            let radius = lobe_axis(all, settings);
            let log = if settings.decades.is_some() { ", by logarithm" } else { "" };
            let scale =
                format!("{light}; centre {}, ring {}{log}", radius.lowest(), radius.highest());
            Surfaces {
                title: &words,
                detail: &scale,
                from: settings.eye,
                surfaces: &surfaces(all, pens, &radius),
                arrows: &arrows(wi),
                dots: &[],
            }
            .svg()?
        }
    };
    Ok(alone(&drawing))
}

/// The surfaces of a lobe view alone, as pixels; each in the colour of its pen, and points over them.
pub fn lobe_raster(
    all: &[(String, Hemisphere)],
    pens: &[usize],
    settings: &Settings,
    dots: &[[f64; 3]],
) -> Raster {
    const CIRCLE: [u8; 3] = [128; 3];
    let surfaces = &surfaces(all, pens, &lobe_axis(all, settings));
    let arrows = &arrows(settings.wi);
    let dots: &Vec<DVec3> = &dots.iter().map(|dot| DVec3::from(*dot)).collect();
    let from = settings.eye;
    Surfaces { title: "", detail: "", from, surfaces, arrows, dots }.raster(Some(CIRCLE))
}

/// What the centre and the ring around a lobe stand for.
pub fn lobe_axis(all: &[(String, Hemisphere)], settings: &Settings) -> Axis {
    let values = all.iter().flat_map(|(_, lobe)| lobe.values.iter().copied());
    axis(values, settings.decades)
}

fn surfaces(all: &[(String, Hemisphere)], pens: &[usize], radius: &Axis) -> Vec<Surface> {
    let surface = |(index, (name, lobe)): (usize, &(String, Hemisphere))| Surface {
        name: name.clone(),
        pen: pen_of(pens, index),
        around: lobe.around,
        points: std::iter::zip(&lobe.directions, &lobe.values)
            .map(|(to, value)| DVec3::from(*to) * radius.place(*value))
            .collect(),
    };
    all.iter().enumerate().map(surface).collect()
}

fn pen_of(pens: &[usize], index: usize) -> usize {
    pens.get(index).copied().unwrap_or(index)
}

fn arrows(wi: Angles) -> [Arrow<'static>; 5] {
    let mirror = Angles { theta: wi.theta, phi: wi.phi + 180.0 };
    let arrow = |to, colour, name| Arrow { to, colour, name };
    [
        arrow(DVec3::X, [192, 48, 48], "tangent"),
        arrow(DVec3::Y, [47, 143, 58], "bitangent"),
        arrow(DVec3::Z, [48, 80, 192], "normal"),
        arrow(wi.direction().into(), [15, 143, 160], "wi"),
        arrow(mirror.direction().into(), [176, 47, 160], "mirror"),
    ]
}

/// What the axis below is of, and the angles that do not move.
fn line_words(line: &Line, light: &str, settings: &Settings) -> (&'static str, String) {
    let phi_d = degrees(settings.phi_d);
    match line {
        Line::Viewer { phi, .. } => {
            ("theta_v: wo from the normal [degrees]", format!("{light}; wo at {}", degrees(*phi)))
        }
        Line::Half { theta_d, .. } => (
            "theta_h: the half vector from the normal [degrees]",
            format!("theta_d {}, phi_d {phi_d}", degrees(*theta_d)),
        ),
        Line::Difference { theta_h, .. } => (
            "theta_d: wi from the half vector [degrees]",
            format!("theta_h {}, phi_d {phi_d}", degrees(*theta_h)),
        ),
    }
}

/// Both directions, or one name for both where they would lie on each other.
fn marks(wi: Angles) -> Vec<(f64, &'static str)> {
    const APART: f64 = 8.0;
    match wi.theta < APART {
        true => vec![(wi.theta, "wi, mirror")],
        false => vec![(-wi.theta, "wi"), (wi.theta, "mirror")],
    }
}

fn picture((name, values): &(String, Vec<[f64; 3]>), settings: &Settings) -> Slice {
    Slice { title: name.clone(), pixels: slice_pixels(values, settings) }
}

/// f as the screen shows it, row by row from below.
pub fn slice_pixels(values: &[[f64; 3]], settings: &Settings) -> Vec<[u8; 3]> {
    let tone = Tone::exposed(settings.exposure);
    let pixel = |f: &[f64; 3]| match f.iter().all(|c| c.is_finite()) {
        true => {
            let rgb = if settings.chroma { chroma(*f) } else { *f };
            rgb.map(|c| byte(tone.light(c as f32)))
        }
        false => UNSEEN,
    };
    values.iter().map(pixel).collect()
}

/// What a drawing cannot show.
pub fn notes(plot: &Plot, settings: &Settings) -> Vec<String> {
    let mut notes = Vec::new();
    let (named, told): (Vec<(&str, f64)>, usize) = match plot {
        Plot::Polar(series) | Plot::Lines(series, _) | Plot::Albedo(series) => {
            let largest = |one: &Series| largest(one.points.iter().map(|point| point[1]));
            let named = series.iter().map(|one| (one.name.as_str(), largest(one)));
            // Three colours, and fewer pens of each.
            (named.collect(), if settings.rgb() { 3 * 2 * 4 } else { PENS })
        }
        Plot::Lobes(all) => {
            let named = all
                .iter()
                .map(|(name, lobe)| (name.as_str(), largest(lobe.values.iter().copied())));
            (named.collect(), PENS / 2)
        }
        Plot::Slices(_, all) => {
            let named = all
                .iter()
                .map(|(name, values)| (name.as_str(), largest(values.iter().flatten().copied())));
            (named.collect(), usize::MAX)
        }
    };
    if named.len() > told {
        notes.push(format!("there are {} curves, and {told} can be told apart", named.len()));
    }
    let peak = largest(named.iter().map(|(_, largest)| *largest));
    for (name, largest) in named {
        let floor = settings.decades.map_or(0.0, |decades| peak * 10f64.powf(-decades));
        if !largest.is_finite() {
            notes.push(format!("{name}: no pair of these directions lies above the horizon"));
        } else if largest <= 0.0 {
            notes.push(format!("{name}: no value is above 0"));
        } else if largest < floor {
            notes.push(format!("{name} lies below what is drawn; give more --decades"));
        }
    }
    notes
}

/// The largest value; none that is finite is the negative infinity.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(f64::NEG_INFINITY, f64::max)
}

/// An angle as a line of details has room for it.
fn degrees(angle: f64) -> String {
    format!("{}°", (100.0 * angle).round() / 100.0)
}

fn values(series: &[Series]) -> impl Iterator<Item = f64> {
    series.iter().flat_map(|series| series.points.iter().map(|[_, value]| *value))
}

/// From 0, or from so many decades below the largest value.
fn axis(values: impl Iterator<Item = f64>, decades: Option<f64>) -> Axis {
    let values: Vec<f64> = values.collect();
    let largest = largest(values.iter().copied());
    if largest <= 0.0 {
        return Axis::linear(0.0, 1.0);
    }
    match decades {
        None => Axis::from_zero(values.into_iter(), largest),
        Some(decades) => {
            let least = largest * 10f64.powf(-decades);
            Axis::logarithmic(values.into_iter().filter(|value| *value >= least), largest)
        }
    }
}

/// Bands reach two standard errors up and down. Channels have their own colours, BRDFs the dashes then.
fn curves(series: &[Series], settings: &Settings, pens: &[usize]) -> Vec<Curve> {
    let pen = |one: &Series| match one.channel {
        Channel::Red if settings.rgb() => Pen::coloured(4, one.subject),
        Channel::Green if settings.rgb() => Pen::coloured(2, one.subject),
        Channel::Blue if settings.rgb() => Pen::coloured(0, one.subject),
        _ => Pen::of(pen_of(pens, one.subject)),
    };
    let curve = |one: &Series| Curve {
        name: one.name.clone(),
        pen: pen(one),
        points: one.points.clone(),
        band: one.errors.iter().map(|error| 2.0 * error).collect(),
    };
    series.iter().map(curve).collect()
}
