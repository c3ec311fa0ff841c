//! All cells of a plan, in turns.

use std::path::Path;

use brdf_sdk::{Problem, Result};

use super::calibration::Calibration;
use super::case::{Opened, radiance};
use super::measured::{Aim, Measured, Reached, measure};
use super::reference::{Reference, provide, usual_store};
use super::report::{CaseReport, CellReport, DeviceReport, Report, Step};
use super::{Limits, Plan, Spread};
use crate::exec::{Executor, memory};
use crate::measure::compare::{finite, relative, relative_eps};
use crate::picture::{Raster, Scale};
use crate::registry::Registry;
use crate::session::{Chosen, Output};
use crate::tone::byte;

/// What came of a plan.
pub struct Ran {
    /// The figures.
    pub report: Report,
    /// Pictures after equal times, where they were asked for.
    pub pictures: Vec<Pictured>,
}

/// What a cell shows after the time that every cell has.
pub struct Pictured {
    /// The device's name.
    pub device: String,
    /// The scene's name.
    pub case: String,
    /// The integrator's id; none for the reference.
    pub integrator: Option<String>,
    /// The picture, its background black.
    pub picture: Raster,
    /// How far it is from the reference, relative to it, in false colours.
    pub error: Option<Raster>,
}

/// What is wanted beside figures.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// Where references are kept; the platform's folder without it.
    pub store: Option<&'a Path>,
    /// Whether pictures are wanted.
    pub pictures: bool,
}

/// What one cell's runs found so far.
struct Cell<'a> {
    device: usize,
    case: usize,
    integrator: &'a Chosen,
    limits: Limits,
    runs: Vec<Measured>,
    problem: Option<Problem>,
    peak: Option<u64>,
}

/// Measures a plan on devices. `tell` is told what is done and which part of all is behind, and says whether to go on.
///
/// # Errors
/// Where a scene cannot be opened, a reference cannot be made, a device fails at the kernel that calibrates it, or `tell`
/// says no.
pub fn run(
    registry: &Registry,
    plan: &Plan,
    devices: &mut [Box<dyn Executor>],
    wanted: Wanted<'_>,
    tell: &mut dyn FnMut(&str, f64) -> bool,
) -> Result<Ran> {
    plan.check()?;
    let own = usual_store();
    let store = wanted.store.or(own.as_deref());
    let opened = plan.rows.iter().map(|row| Opened::new(registry, &row.case));
    let opened: Vec<Opened> = opened.collect::<Result<_>>()?;
    let stopped = || Problem::new("brdf bench", "it was interrupted", "let it finish");
    let Some(first) = devices.first_mut() else {
        return Err(Problem::new("brdf bench", "it has no device", "name one with --device"));
    };
    let mut references: Vec<Reference> = Vec::new();
    for one in &opened {
        let name = format!("reference of {}", one.case.name);
        if !tell(&name, 0.0) {
            return Err(stopped());
        }
        let mut go_on = |part: f64| tell(&name, part);
        references.push(provide(registry, first.as_mut(), one, store, &mut go_on)?);
    }

    let mut calibrations = Vec::new();
    for device in devices.iter_mut() {
        calibrations.push(Calibration::new(registry, device.as_mut())?);
    }
    let mut cells = cells(plan, devices.len());
    let mut rates: Vec<Vec<f64>> = vec![Vec::new(); devices.len()];
    let all = (cells.len() * plan.limits.repeats as usize).max(1);
    let mut done = 0;
    for turn in 0..plan.limits.repeats {
        calibrate(devices, &mut calibrations, &mut rates)?;
        // Another order each turn, so that none has the same neighbours always.
        let count = cells.len();
        for index in (0..count).map(|index| (index + turn as usize * count / 3) % count) {
            let cell = &mut cells[index];
            let one = &opened[cell.case];
            let name = format!("{}, {}", one.case.name, cell.integrator.name());
            if !tell(&name, done as f64 / all as f64) {
                return Err(stopped());
            }
            done += 1;
            let device = devices[cell.device].as_mut();
            // One that was lost tells so in the cell.
            let _ = calibrations[cell.device].warm(device);
            cell.run(device, one, &references[cell.case]);
        }
    }
    calibrate(devices, &mut calibrations, &mut rates)?;
    for (device, calibration) in std::iter::zip(devices.iter_mut(), calibrations) {
        calibration.free(device.as_mut());
    }

    let mut report = Report::new(&plan.limits);
    for (device, rates) in std::iter::zip(devices.iter(), &rates) {
        let none = Spread { median: 0.0, low: 0.0, high: 0.0 };
        report.devices.push(DeviceReport {
            name: device.name().to_owned(),
            calibration: Spread::of(rates.iter().copied()).unwrap_or(none),
            disturbed: false,
        });
    }
    report.cases = std::iter::zip(&opened, &references).map(case_report).collect();
    for cell in &cells {
        let device = &report.devices[cell.device];
        let one = &opened[cell.case];
        let mut found = cell.report(&device.name, &one.case.name);
        found.derive(one.points().len(), plan.limits.target, device.calibration.median);
        report.cells.push(found);
    }
    report.derive();
    let mut pictures = Vec::new();
    if wanted.pictures {
        for (index, (one, reference)) in std::iter::zip(&opened, &references).enumerate() {
            for device in devices.iter() {
                pictures.push(reference_picture(device.name(), one, reference));
            }
            let of_case = cells.iter().filter(|cell| cell.case == index && cell.problem.is_none());
            for cell in of_case {
                if !tell(&format!("pictures of {}", one.case.name), 1.0) {
                    return Err(stopped());
                }
                let device = devices[cell.device].as_mut();
                // What was measured is not lost with a picture.
                pictures.extend(cell.picture(device, one, reference).ok().flatten());
            }
        }
    }
    Ok(Ran { report, pictures })
}

/// Asks every device for its rate.
fn calibrate(
    devices: &mut [Box<dyn Executor>],
    calibrations: &mut [Calibration],
    rates: &mut [Vec<f64>],
) -> Result<()> {
    for ((device, calibration), rates) in
        std::iter::zip(std::iter::zip(devices, calibrations), rates)
    {
        rates.push(calibration.rate(device.as_mut())?);
    }
    Ok(())
}

fn cells(plan: &Plan, devices: usize) -> Vec<Cell<'_>> {
    let mut cells = Vec::new();
    for device in 0..devices {
        for (case, row) in plan.rows.iter().enumerate() {
            cells.extend(row.integrators.iter().map(|integrator| Cell {
                device,
                case,
                integrator,
                limits: plan.limits.of_row(row),
                runs: Vec::new(),
                problem: None,
                peak: None,
            }));
        }
    }
    cells
}

fn case_report((one, reference): (&Opened, &Reference)) -> CaseReport {
    let scene = &one.case.scene;
    CaseReport {
        name: one.case.name.clone(),
        about: one.case.about.clone(),
        scene: scene.to_toml(),
        brdf: one.case.brdf_words(),
        map: one.case.map_words(),
        covered_pixels: one.points().len(),
        reference: reference.hash.clone(),
        reference_said: reference.said.clone(),
        reference_relmse: reference.floor,
        notes: one.notes.clone(),
    }
}

impl Cell<'_> {
    /// Runs it once more: the first time with errors, then for its time alone.
    fn run(&mut self, executor: &mut dyn Executor, one: &Opened, reference: &Reference) {
        if self.problem.is_some() {
            return;
        }
        let aim = match self.runs.first().and_then(|first| first.steps.last()) {
            Some(last) => Aim::Times(last.spp),
            None => Aim::Errors(reference),
        };
        memory::forget_peak();
        match measure(executor, one, self.integrator, &self.limits, aim) {
            Ok(measured) => self.runs.push(measured),
            Err(problem) => self.problem = Some(problem),
        }
        self.peak = self.peak.max(memory::peak());
    }

    fn report(&self, device: &str, case: &str) -> CellReport {
        let id = &self.integrator.configured.plugin.id;
        let mut found = CellReport::new(device, case, id);
        found.problem = self.problem.as_ref().map(Problem::line);
        let Some(first) = self.runs.first().filter(|_| self.problem.is_none()) else {
            return found;
        };
        found.link = Spread::of(self.runs.iter().map(|run| run.link));
        found.compile = Spread::of(self.runs.iter().map(|run| run.compile));
        found.texels = first.texels;
        found.peak_memory = self.peak;
        for (index, Reached { spp, errors, .. }) in first.steps.iter().enumerate() {
            let same = || {
                let steps = self.runs.iter().filter_map(|run| run.steps.get(index));
                steps.filter(|step| step.spp == *spp)
            };
            let device_seconds = Spread::of(same().filter_map(|step| step.device_seconds));
            if let (Some(seconds), Some(errors)) =
                (Spread::of(same().map(|step| step.seconds)), *errors)
            {
                found.steps.push(Step { spp: *spp, seconds, device_seconds, errors });
            }
        }
        found
    }

    fn picture(
        &self,
        executor: &mut dyn Executor,
        one: &Opened,
        reference: &Reference,
    ) -> Result<Option<Pictured>> {
        let measured = measure(executor, one, self.integrator, &self.limits, Aim::Picture)?;
        let Some(film) = measured.film else { return Ok(None) };
        let rows = radiance(&film);
        Ok(Some(Pictured {
            device: executor.name().to_owned(),
            case: one.case.name.clone(),
            integrator: Some(self.integrator.configured.plugin.id.clone()),
            picture: shown(&rows, one),
            error: Some(error_picture(&rows, reference, one)),
        }))
    }
}

/// Radiance of a case's points as a screen shows it.
fn shown(rows: &[[f32; 3]], one: &Opened) -> Raster {
    let Output { resolution, tone, .. } = one.case.scene.film;
    let pixels = rows.iter().map(|rgb| rgb.map(|c| byte(tone.light(c))));
    Raster { resolution, rgb: one.in_picture(pixels, [0; 3]) }
}

/// Factors of ten of the relative error, from a tenth of a percent to all of it, whoever's picture it is.
fn error_picture(rows: &[[f32; 3]], reference: &Reference, one: &Opened) -> Raster {
    let counted = finite(rows, &reference.rows);
    let errors = relative(rows, &reference.rows, relative_eps(&reference.rows, &counted));
    let scale = Scale::logarithmic(&[1e-6, 1.0]);
    let pixels = errors.iter().map(|error| scale.colour(*error));
    Raster { resolution: one.case.scene.film.resolution, rgb: one.in_picture(pixels, [0; 3]) }
}

fn reference_picture(device: &str, one: &Opened, reference: &Reference) -> Pictured {
    Pictured {
        device: device.to_owned(),
        case: one.case.name.clone(),
        integrator: None,
        picture: shown(&reference.rows, one),
        error: None,
    }
}
