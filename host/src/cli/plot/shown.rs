//! What a plot shows, as numbers.

use brdf_sdk::{Kind, Result};

use super::options::Options;
use super::{Subject, View};
use crate::exec::Executor;
use crate::plot::hemisphere::Hemisphere;
use crate::plot::lines::{Line, curve};
use crate::plot::{self, Quantity, slice};
use crate::registry::Registry;
use crate::render::Effort;
use crate::render::albedo::{self, directional_albedo};
use crate::session::Chosen;

/// A curve: an angle [degrees] and a value, and how far the value may be off.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) errors: Vec<f64>,
}

pub(super) enum Plot {
    /// Curves around the normal.
    Polar(Vec<Series>),
    /// Curves over an angle within a range; what the angle is.
    Lines(Vec<Series>, [f64; 2], &'static str),
    /// Directional albedos.
    Albedo(Vec<Series>),
    /// Colours over theta_h and theta_d, f itself.
    Slices(slice::Slice, Vec<(String, Vec<[f64; 3]>)>),
    /// Values over the hemisphere.
    Lobes(Vec<(String, Hemisphere)>),
}

impl Plot {
    /// How many things are told apart by their colours.
    pub(super) fn curves(&self) -> usize {
        match self {
            Self::Polar(series) | Self::Lines(series, ..) | Self::Albedo(series) => series.len(),
            Self::Slices(..) => 0,
            Self::Lobes(lobes) => lobes.len(),
        }
    }
}

/// Decades that a logarithmic plot shows below its peak.
pub(super) const DECADES: f64 = 4.0;

/// Rings and directions of a ring of a lobe.
const RINGS: [usize; 2] = [128, 128];

/// Samples of a pass, and passes, of a directional albedo: what is left of the error is a thin band.
const EFFORT: [u32; 2] = [4096, 4];

pub(super) fn of(
    registry: &Registry,
    executor: &mut dyn Executor,
    view: View,
    options: &Options,
    subjects: &[Subject],
) -> Result<Plot> {
    let wi = options.wi();
    let (theta_h, theta_d, phi_d) = (options.theta_h(), options.theta_d(), options.phi_d());
    let viewer = |phi| Line::Viewer { wi, phi };
    let half = Line::Half { theta_d, phi_d };
    let difference = Line::Difference { theta_h, phi_d };
    let lines = |executor: &mut dyn Executor, line: Line, name| -> Result<Plot> {
        Ok(Plot::Lines(curves(executor, options, subjects, line)?, line.range(), name))
    };
    match view {
        View::Polar => {
            let line = viewer(wi.phi + 180.0);
            Ok(Plot::Polar(curves(executor, options, subjects, line)?))
        }
        View::ThetaV => lines(executor, viewer(options.phi_v()), "theta_v: wo from the normal"),
        View::ThetaH => lines(executor, half, "theta_h: the half vector from the normal"),
        View::ThetaD => lines(executor, difference, "theta_d: wi from the half vector"),
        View::Albedo => albedos(registry, executor, options, subjects),
        View::Slice => slices(executor, options, subjects),
        View::Lobe => lobes(executor, options, subjects),
    }
}

fn curves(
    executor: &mut dyn Executor,
    options: &Options,
    subjects: &[Subject],
    line: Line,
) -> Result<Vec<Series>> {
    let linear = |value: f64, largest: f64| value / largest;
    let logarithmic =
        |value: f64, largest: f64| (1.0 + (value / largest).log10() / DECADES).clamp(0.0, 1.0);
    let height: &dyn Fn(f64, f64) -> f64 = if options.log { &logarithmic } else { &linear };
    let mut all = Vec::new();
    for subject in subjects {
        let mut asked = plot::Subject::new(executor, &subject.chosen.configured)?;
        for (quantity, suffix) in options.quantities() {
            let points = curve(&mut asked, line, quantity, height)?;
            let name = format!("{}{suffix}", subject.name);
            all.push(Series { name, points, errors: Vec::new() });
        }
        asked.free();
    }
    Ok(all)
}

fn albedos(
    registry: &Registry,
    executor: &mut dyn Executor,
    options: &Options,
    subjects: &[Subject],
) -> Result<Plot> {
    let integrator = Chosen::find(registry, Kind::Integrator, "brdf-is")?.configured;
    let [samples, passes] = EFFORT;
    let mut all = Vec::new();
    for subject in subjects {
        let table = directional_albedo(
            executor,
            &subject.chosen.configured,
            &integrator,
            &albedo::ANGLES,
            options.albedo_azimuth(),
            Effort::new(samples, passes),
        )?;
        table.notes.iter().for_each(|note| eprintln!("note: {note}"));
        for (Quantity { channel, .. }, suffix) in options.quantities() {
            all.push(Series {
                name: format!("{}{suffix}", subject.name),
                points: table.rows.iter().map(|row| [row.theta, channel.of(row.albedo)]).collect(),
                // Channels share their samples, so the errors of a sum are at most the sum of errors.
                errors: table.rows.iter().map(|row| channel.of(row.std_error)).collect(),
            });
        }
    }
    Ok(Plot::Albedo(all))
}

fn slices(executor: &mut dyn Executor, options: &Options, subjects: &[Subject]) -> Result<Plot> {
    let slice =
        slice::Slice { phi_d: options.phi_d(), square: options.square(), size: options.size() };
    let mut all = Vec::new();
    for subject in subjects {
        let mut asked = plot::Subject::new(executor, &subject.chosen.configured)?;
        all.push((subject.name.clone(), slice.values(&mut asked)?));
        asked.free();
    }
    Ok(Plot::Slices(slice, all))
}

fn lobes(executor: &mut dyn Executor, options: &Options, subjects: &[Subject]) -> Result<Plot> {
    let mut all = Vec::new();
    for subject in subjects {
        let mut asked = plot::Subject::new(executor, &subject.chosen.configured)?;
        for (quantity, _) in options.quantities() {
            let lobe = Hemisphere::new(&mut asked, options.wi(), quantity, RINGS)?;
            all.push((subject.name.clone(), lobe));
        }
        asked.free();
    }
    Ok(Plot::Lobes(all))
}
