//! The laws, held against the current BRDF as it is set, with the densities that were drawn beside those expected; and
//! the lines that lose digits. Both on a thread of their own: they take seconds.

use brdf_sdk::{Kind, Result};
use egui::{Color32, RichText, ScrollArea, TextureOptions, Ui, Vec2};

use super::parts::{file_name, picture_ui, pixel_at};
use super::textures::{Cached, image};
use super::viewer::State;
use crate::conformance::{Densities, Law, Outcome, Raster, Report, Verdict, Wanted, conform};
use crate::exec::Executor;
use crate::live::Asked;
use crate::numerics::{self, measure};
use crate::picture::Scale;
use crate::plot::{angle, digits};
use crate::plugin::Configured;
use crate::session::Chosen;

/// Pixels of a density along the azimuth and along theta.
const PIXELS: [usize; 2] = [200, 120];

/// Where the colours of deviations end [standard deviations].
const DEVIATIONS: f64 = 5.0;

/// The part of the draws that a window of densities holds.
const HELD: f64 = 0.999;

/// Angles along a side of the map of errors, and azimuths that each of its pixels looks at.
const ANGLES: usize = 90;
const AZIMUTHS: usize = 24;

/// What was proved lately.
#[derive(Default)]
pub(super) struct Proofs {
    laws: Asked<Question, Proof>,
    densities: Vec<[Cached<u64>; 3]>,
    numerics: Asked<Configured, Digits>,
    map: Cached<u64>,
}

impl Proofs {
    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.laws.is_waiting() || self.numerics.is_waiting()
    }
}

#[derive(Clone, PartialEq)]
struct Question {
    brdf: Configured,
    laws: Vec<Law>,
    integrators: Vec<Configured>,
}

struct Proof {
    of: Question,
    report: Report,
}

/// How many digits the functions keep.
struct Digits {
    of: Configured,
    report: numerics::Report,
    /// The largest relative error of f over azimuths, for each theta_i in the rows from 0 up and each theta_o.
    map: Vec<f64>,
}

/// The laws that tell of sampling.
const OF_SAMPLING: [Law; 4] = [Law::Contract, Law::Sampling, Law::Mean, Law::Variance];

pub(super) fn sampling_ui(ui: &mut Ui, state: &mut State) {
    let brdf = state.document.current().chosen.configured.clone();
    ui.horizontal_wrapped(|ui| {
        let mut wanted = None;
        if ui.button("prove sampling").on_hover_text("Draws against the density.").clicked() {
            wanted = Some(OF_SAMPLING.to_vec());
        }
        if ui.button("prove all laws").on_hover_text("As `brdf conform` does.").clicked() {
            wanted = Some(Law::ALL.to_vec());
        }
        if let Some(laws) = wanted {
            let find = |id: &String| Chosen::find(&state.registry, Kind::Integrator, id).ok();
            let ids: Vec<String> =
                state.catalogue.integrators.iter().map(|found| found.id.clone()).collect();
            let integrators = ids.iter().filter_map(find).map(|chosen| chosen.configured).collect();
            let question = Question { brdf: brdf.clone(), laws, integrators };
            state.proofs.laws.ask(&state.slow, &question, prove);
        }
        waiting_ui(ui, state.proofs.laws.is_waiting());
    });
    if let Some(problem) = state.proofs.laws.problem() {
        ui.colored_label(ui.visuals().error_fg_color, problem.line());
    }
    let Some(proof) = state.proofs.laws.answer() else {
        ui.label(
            "Draws a million directions at each view and counts them against the density; \
             takes half a minute or more.",
        );
        return;
    };
    stale_ui(ui, &proof.of.brdf, &brdf);
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        verdicts_ui(ui, &proof.report.verdicts);
        let key = proof.number;
        let all = &proof.report.plots.densities;
        state.proofs.densities.resize_with(all.len(), Default::default);
        for (densities, textures) in all.iter().zip(&mut state.proofs.densities) {
            densities_ui(ui, densities, textures, key);
        }
    });
}

fn waiting_ui(ui: &mut Ui, waiting: bool) {
    if waiting {
        ui.spinner();
        ui.label("proving…");
    }
}

/// Whether what is shown is still of what is open.
fn stale_ui(ui: &mut Ui, of: &Configured, now: &Configured) {
    if of != now {
        let words = format!("This is of {} as it was before.", of.plugin.manifest.name);
        ui.colored_label(ui.visuals().warn_fg_color, words);
    }
}

fn verdicts_ui(ui: &mut Ui, verdicts: &[Verdict]) {
    egui::Grid::new("verdicts").num_columns(3).striped(true).show(ui, |ui| {
        for verdict in verdicts {
            let (word, colour) = match verdict.outcome {
                Outcome::Passed => ("holds", Color32::from_rgb(47, 143, 58)),
                Outcome::Failed => ("FAILS", ui.visuals().error_fg_color),
                Outcome::Skipped => ("-", ui.visuals().weak_text_color()),
                Outcome::Reported => ("tells", ui.visuals().text_color()),
            };
            ui.label(RichText::new(word).color(colour).strong());
            ui.label(verdict.law.word());
            ui.vertical(|ui| {
                ui.add(egui::Label::new(&verdict.said).wrap());
                for more in verdict.reproduce.iter().chain(&verdict.notes) {
                    ui.add(egui::Label::new(RichText::new(more).small()).wrap());
                }
            });
            ui.end_row();
        }
    });
}

/// Drawn, expected, and how far they are from each other.
fn densities_ui(ui: &mut Ui, densities: &Densities, textures: &mut [Cached<u64>; 3], key: u64) {
    ui.separator();
    let mark = if densities.failed { "FAILS: " } else { "" };
    ui.label(format!("{mark}{}", densities.at));
    let mut raster: Option<(Raster, Scale)> = None;
    let mut paint = |which: usize| {
        let (raster, scale) = raster.get_or_insert_with(|| {
            let raster = densities.raster(densities.window(HELD), PIXELS);
            let both: Vec<f64> = raster.drawn.iter().chain(&raster.expected).copied().collect();
            (raster, Scale::spanning(&both))
        });
        let of_deviations = Scale::Diverging { largest: DEVIATIONS };
        let (values, scale) = match which {
            0 => (&raster.drawn, &*scale),
            1 => (&raster.expected, &*scale),
            _ => (&raster.deviations, &of_deviations),
        };
        let pixels: Vec<[u8; 3]> = values.iter().map(|value| scale.colour(*value)).collect();
        image(PIXELS, &pixels)
    };
    ui.horizontal(|ui| {
        let width = ((ui.available_width() - 16.0) / 3.0).clamp(40.0, 260.0);
        let size = Vec2::new(width, width * PIXELS[1] as f32 / PIXELS[0] as f32);
        let names = ["drawn", "expected", "deviations, ±5"];
        for (which, (texture, name)) in textures.iter_mut().zip(names).enumerate() {
            let options = TextureOptions::NEAREST;
            let texture = texture.get(ui.ctx(), name, key, options, || paint(which));
            ui.vertical(|ui| {
                ui.small(name);
                picture_ui(ui, texture.id(), size);
            });
        }
    });
}

fn prove(question: &Question, executor: &mut dyn Executor) -> Result<Proof> {
    let Question { brdf, laws, integrators } = question;
    let wanted =
        Wanted { laws: laws.clone(), integrators: integrators.clone(), ..Wanted::default() };
    let report = conform(executor, brdf, &wanted)?;
    Ok(Proof { of: question.clone(), report })
}

pub(super) fn numerics_ui(ui: &mut Ui, state: &mut State) {
    let brdf = state.document.current().chosen.configured.clone();
    ui.horizontal_wrapped(|ui| {
        let button = ui.button("measure").on_hover_text("As `brdf numerics` does: f32 beside f64.");
        if button.clicked() {
            state.proofs.numerics.ask(&state.slow, &brdf, look_at_digits);
        }
        waiting_ui(ui, state.proofs.numerics.is_waiting());
    });
    if let Some(problem) = state.proofs.numerics.problem() {
        ui.colored_label(ui.visuals().error_fg_color, problem.line());
    }
    let Some(digits) = state.proofs.numerics.answer() else {
        ui.label("Runs the functions in f32 beside f64 over hard cases, and finds the lines that lose digits.");
        return;
    };
    stale_ui(ui, &digits.of, &brdf);
    let key = digits.number;
    let texture = state.proofs.map.get(ui.ctx(), "errors", key, TextureOptions::NEAREST, || {
        let scale = Scale::spanning(&digits.map);
        // Rows of the map go up.
        let rows = digits.map.chunks(ANGLES).rev().flatten();
        image([ANGLES; 2], &rows.map(|value| scale.colour(*value)).collect::<Vec<_>>())
    });
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        errors_ui(ui, &digits.report);
        ui.separator();
        ui.label("error of f: theta_o right, theta_i up, 0 to 90°, brighter is more");
        let (rect, response) = picture_ui(ui, texture.id(), Vec2::splat(200.0));
        if let Some([column, down]) = pixel_at(rect, response.hover_pos(), [ANGLES; 2]) {
            let row = ANGLES - 1 - down;
            let [o, i] = [column, row].map(|index| angle(index, ANGLES));
            let value = digits.map[row * ANGLES + column];
            response.on_hover_text(format!("theta_o {o}°, theta_i {i}°: {value:.1e}"));
        }
        ui.separator();
        lines_ui(ui, &digits.report, &mut state.message);
    });
}

fn errors_ui(ui: &mut Ui, report: &numerics::Report) {
    let number = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{error:.1e}"));
    egui::Grid::new("errors").striped(true).show(ui, |ui| {
        for name in ["function", "median", "99 %", "largest", "not finite"] {
            ui.strong(name);
        }
        ui.end_row();
        for function in &report.functions {
            let errors = &function.errors;
            ui.label(function.function.name());
            ui.label(number(errors.median));
            ui.label(number(errors.percentile_99));
            ui.label(number(errors.largest));
            ui.label(errors.nonfinite.to_string());
            ui.end_row();
        }
    });
}

/// The lines in which errors arise, worst first.
fn lines_ui(ui: &mut Ui, report: &numerics::Report, message: &mut String) {
    let mut none = true;
    for function in &report.functions {
        for line in function.lines.iter().take(8) {
            none = false;
            let file = file_name(&line.file);
            ui.horizontal(|ui| {
                ui.label(format!(
                    "{} {:.1e}, {:.0} bits cancelled, {} cases",
                    function.function.name(),
                    line.error,
                    line.cancelled_bits,
                    line.cases
                ));
                let place = format!("{}:{}:{}", line.file, line.line, line.column);
                if ui.link(format!("{file}:{}", line.line)).on_hover_text(&place).clicked() {
                    ui.ctx().copy_text(place.clone());
                    *message = format!("copied {place}");
                }
            });
            let under = " ".repeat(line.column.saturating_sub(1)) + &"^".repeat(line.length.max(1));
            let text = format!("{}\n{under}", line.excerpt);
            ui.add(egui::Label::new(RichText::new(text).monospace()).extend());
        }
    }
    if none {
        ui.label("No line stands out: rounding only.");
    }
}

fn look_at_digits(brdf: &Configured, _: &mut dyn Executor) -> Result<Digits> {
    Ok(Digits {
        of: brdf.clone(),
        report: measure(brdf, &[])?,
        map: digits(brdf, ANGLES, AZIMUTHS)?,
    })
}
