//! What a view of a plot shows, as numbers: each BRDF is asked for what the settings want.

use brdf_sdk::Result;

use super::hemisphere::Hemisphere;
use super::lines::{Line, curve};
use super::settings::{Settings, View};
use super::{Channel, Quantity, Subject, slice};
use crate::exec::Executor;
use crate::plugin::Configured;
use crate::render::Effort;
use crate::render::albedo::{self, directional_albedo};

/// A BRDF to plot, and what it is called.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Its name in legends and rows.
    pub name: String,
    /// The BRDF with its parameters.
    pub brdf: Configured,
}

/// A curve: an angle [degrees] and a value, and how far the value may be off.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// The number of its BRDF.
    pub subject: usize,
    /// The number of the colour.
    pub channel: Channel,
    /// Angle and value.
    pub points: Vec<[f64; 2]>,
    /// A standard error for each point, or nothing.
    pub errors: Vec<f64>,
}

/// Names with a number behind those that were given before.
pub fn told_apart(names: &[String]) -> Vec<String> {
    let numbered = |(index, name): (usize, &String)| match names[..index]
        .iter()
        .filter(|before| *before == name)
        .count()
    {
        0 => name.clone(),
        count => format!("{name} ({})", count + 1),
    };
    names.iter().enumerate().map(numbered).collect()
}

/// What a view shows, as numbers.
#[derive(Debug, Clone)]
pub enum Plot {
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

/// The numbers of a view. Albedos are made by samples of `by_samples`, an integrator.
///
/// # Errors
/// What is wrong with a plugin, and what it does that ends a program.
pub fn shown(
    executor: &mut dyn Executor,
    by_samples: &Configured,
    view: View,
    settings: &Settings,
    subjects: &[Named],
) -> Result<Plot> {
    let Settings { wi, theta_h, theta_d, phi_d, .. } = *settings;
    let viewer = |phi| Line::Viewer { wi, phi };
    let half = Line::Half { theta_d, phi_d };
    let difference = Line::Difference { theta_h, phi_d };
    let lines = |executor: &mut dyn Executor, line: Line| -> Result<Plot> {
        Ok(Plot::Lines(curves(executor, settings, subjects, line)?, line))
    };
    match view {
        View::Polar => {
            let line = viewer(wi.phi + 180.0);
            Ok(Plot::Polar(curves(executor, settings, subjects, line)?))
        }
        View::ThetaV => lines(executor, viewer(settings.phi_v)),
        View::ThetaH => lines(executor, half),
        View::ThetaD => lines(executor, difference),
        View::Albedo => albedos(by_samples, executor, settings, subjects),
        View::Slice => slices(executor, settings, subjects),
        View::Lobe => lobes(executor, settings, subjects),
    }
}

fn curves(
    executor: &mut dyn Executor,
    settings: &Settings,
    subjects: &[Named],
    line: Line,
) -> Result<Vec<Series>> {
    let height = |value: f64, largest: f64| match settings.decades {
        // One more than asked for: axes begin at a power of ten.
        Some(decades) => (1.0 + (value / largest).log10() / (decades + 1.0)).clamp(0.0, 1.0),
        None => value / largest,
    };
    let mut all = Vec::new();
    for (number, subject) in subjects.iter().enumerate() {
        let mut asked = Subject::new(executor, &subject.brdf)?;
        for quantity in settings.quantities() {
            let points = curve(&mut asked, line, quantity, &height)?;
            all.push(series(settings, (number, subject), quantity.channel, points, Vec::new()));
        }
        asked.free();
    }
    Ok(all)
}

/// Of three curves each is named after its channel.
fn series(
    settings: &Settings,
    (number, subject): (usize, &Named),
    channel: Channel,
    points: Vec<[f64; 2]>,
    errors: Vec<f64>,
) -> Series {
    let suffix = match channel {
        Channel::Red if settings.rgb() => " red",
        Channel::Green if settings.rgb() => " green",
        Channel::Blue if settings.rgb() => " blue",
        _ => "",
    };
    Series { name: format!("{}{suffix}", subject.name), subject: number, channel, points, errors }
}

fn albedos(
    integrator: &Configured,
    executor: &mut dyn Executor,
    settings: &Settings,
    subjects: &[Named],
) -> Result<Plot> {
    let [samples, passes] = EFFORT;
    let mut all = Vec::new();
    for (number, subject) in subjects.iter().enumerate() {
        let table = directional_albedo(
            executor,
            &subject.brdf,
            integrator,
            &albedo::ANGLES,
            settings.albedo_azimuth,
            Effort::new(samples, passes),
        )?;
        table.notes.iter().for_each(|note| executor.note(note.clone()));
        for Quantity { channel, .. } in settings.quantities() {
            let points = table.rows.iter().map(|row| [row.theta, channel.of(row.albedo)]).collect();
            // Channels share their samples, so the error of a sum is at most the sum of errors.
            let errors = table.rows.iter().map(|row| channel.of(row.std_error)).collect();
            all.push(series(settings, (number, subject), channel, points, errors));
        }
    }
    Ok(Plot::Albedo(all))
}

fn slices(executor: &mut dyn Executor, settings: &Settings, subjects: &[Named]) -> Result<Plot> {
    let slice =
        slice::Slice { phi_d: settings.phi_d, square: settings.square, size: settings.size };
    let mut all = Vec::new();
    for subject in subjects {
        let mut asked = Subject::new(executor, &subject.brdf)?;
        all.push((subject.name.clone(), slice.values(&mut asked)?));
        asked.free();
    }
    Ok(Plot::Slices(slice, all))
}

fn lobes(executor: &mut dyn Executor, settings: &Settings, subjects: &[Named]) -> Result<Plot> {
    let mut all = Vec::new();
    for subject in subjects {
        let mut asked = Subject::new(executor, &subject.brdf)?;
        for quantity in settings.quantities() {
            let lobe = Hemisphere::new(&mut asked, settings.wi, quantity, RINGS)?;
            all.push((subject.name.clone(), lobe));
        }
        asked.free();
    }
    Ok(Plot::Lobes(all))
}
