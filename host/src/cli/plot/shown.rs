//! What a plot shows, as numbers.

use brdf_sdk::{Kind, Result};

use super::options::Options;
use super::{Subject, View};
use crate::exec::Executor;
use crate::plot::hemisphere::Hemisphere;
use crate::plot::lines::{Line, curve};
use crate::plot::{self, Channel, Quantity, slice};
use crate::registry::Registry;
use crate::render::Effort;
use crate::render::albedo::{self, directional_albedo};
use crate::session::Chosen;

/// A curve: an angle [degrees] and a value, and how far the value may be off.
pub(super) struct Series {
    pub(super) name: String,
    /// The number of its BRDF.
    pub(super) subject: usize,
    pub(super) channel: Channel,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) errors: Vec<f64>,
}

pub(super) enum Plot {
    /// Curves around the normal.
    Polar(Vec<Series>),
    /// Curves along a line of directions.
    Lines(Vec<Series>, Line),
    /// Directional albedos.
    Albedo(Vec<Series>),
    /// Colours over theta_h and theta_d, f itself.
    Slices(slice::Slice, Vec<(String, Vec<[f64; 3]>)>),
    /// Values over the hemisphere.
    Lobes(Vec<(String, Hemisphere)>),
}

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
    let lines = |executor: &mut dyn Executor, line: Line| -> Result<Plot> {
        Ok(Plot::Lines(curves(executor, options, subjects, line)?, line))
    };
    match view {
        View::Polar => {
            let line = viewer(wi.phi + 180.0);
            Ok(Plot::Polar(curves(executor, options, subjects, line)?))
        }
        View::ThetaV => lines(executor, viewer(options.phi_v())),
        View::ThetaH => lines(executor, half),
        View::ThetaD => lines(executor, difference),
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
    let height = |value: f64, largest: f64| match options.decades() {
        // One more than asked for: axes begin at a power of ten.
        Some(decades) => (1.0 + (value / largest).log10() / (decades + 1.0)).clamp(0.0, 1.0),
        None => value / largest,
    };
    let mut all = Vec::new();
    for (number, subject) in subjects.iter().enumerate() {
        let mut asked = plot::Subject::new(executor, &subject.chosen.configured)?;
        for quantity in options.quantities() {
            let points = curve(&mut asked, line, quantity, &height)?;
            all.push(series(options, (number, subject), quantity.channel, points, Vec::new()));
        }
        asked.free();
    }
    Ok(all)
}

/// Of three curves each is named after its channel.
fn series(
    options: &Options,
    (number, subject): (usize, &Subject),
    channel: Channel,
    points: Vec<[f64; 2]>,
    errors: Vec<f64>,
) -> Series {
    let suffix = match channel {
        Channel::Red if options.rgb() => " red",
        Channel::Green if options.rgb() => " green",
        Channel::Blue if options.rgb() => " blue",
        _ => "",
    };
    Series { name: format!("{}{suffix}", subject.name), subject: number, channel, points, errors }
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
    for (number, subject) in subjects.iter().enumerate() {
        let table = directional_albedo(
            executor,
            &subject.chosen.configured,
            &integrator,
            &albedo::ANGLES,
            options.albedo_azimuth(),
            Effort::new(samples, passes),
        )?;
        table.notes.iter().for_each(|note| eprintln!("note: {note}"));
        for Quantity { channel, .. } in options.quantities() {
            let points = table.rows.iter().map(|row| [row.theta, channel.of(row.albedo)]).collect();
            // Channels share their samples, so the error of a sum is at most the sum of errors.
            let errors = table.rows.iter().map(|row| channel.of(row.std_error)).collect();
            all.push(series(options, (number, subject), channel, points, errors));
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
        for quantity in options.quantities() {
            let lobe = Hemisphere::new(&mut asked, options.wi(), quantity, RINGS)?;
            all.push((subject.name.clone(), lobe));
        }
        asked.free();
    }
    Ok(Plot::Lobes(all))
}
