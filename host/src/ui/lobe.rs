//! The three-dimensional lobe: values over all directions of `wo`, as surfaces.

use egui::{ColorImage, Rect, TextureOptions, Ui, Vec2};

use std::sync::Arc;

use brdf_sdk::Result;

use super::asked::{self, Answer};
use super::key::key_ui;
use super::materials::pen;
use super::parts::{area_ui, fitted, named};
use super::plots;
use super::textures::Cached;
use super::viewer::State;
use crate::conformance::Drawer;
use crate::exec::Executor;
use crate::figure;
use crate::live::{Answered, Asked};
use crate::picture::chart::Raster;
use crate::plot::hemisphere::density;
use crate::plot::{Angles, Plot, Settings, Subject, View};
use crate::plugin::Configured;

/// Degrees of a drag's point.
const TURN: f64 = 0.5;

/// The surfaces as a picture.
#[derive(Default)]
pub(super) struct Lobe {
    drawn: Asked<Drawing, Raster>,
    over: Over,
    dots: Asked<Dots, Vec<[f64; 3]>>,
    texture: Cached<u64>,
    /// How much nearer it is seen, as a power of e.
    zoom: f32,
}

impl Lobe {
    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.drawn.is_waiting() || self.dots.is_waiting()
    }
}

/// What is drawn over the surfaces, of the current BRDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Over {
    #[default]
    Nothing,
    /// Directions that `sample` draws.
    Draws,
    /// What `pdf` says of them.
    Density,
}

/// What dots are asked for.
#[derive(Clone, PartialEq)]
struct Dots {
    brdf: Configured,
    wo: Angles,
    over: Over,
}

/// Directions that are drawn, and rings and steps of the density.
const DRAWS: usize = 1500;
const RINGS: [usize; 2] = [40, 48];

fn dots(question: &Dots, executor: &mut dyn Executor) -> Result<Vec<[f64; 3]>> {
    let Dots { brdf, wo, over } = question;
    match over {
        Over::Nothing => Ok(Vec::new()),
        Over::Density => {
            let mut subject = Subject::new(executor, brdf)?;
            let found = density(&mut subject, *wo, RINGS);
            subject.free();
            found
        }
        Over::Draws => {
            let mut drawer = Drawer::new(executor, brdf)?;
            let wo = wo.direction().map(|c| c as f32);
            let found = drawer.draws(executor, brdf, wo, 0, DRAWS);
            drawer.free(executor);
            let above = found?.into_iter().filter(|draw| draw.counts());
            Ok(above.map(|draw| draw.wi.map(f64::from)).collect())
        }
    }
}

/// What is drawn: numbers, and from where they are seen.
#[derive(Clone)]
struct Drawing {
    answer: Arc<Answered<Answer>>,
    dots: Arc<Answered<Vec<[f64; 3]>>>,
    settings: Settings,
}

impl PartialEq for Drawing {
    /// Numbers that were computed anew are others.
    fn eq(&self, other: &Self) -> bool {
        self.answer.number == other.answer.number
            && self.dots.number == other.dots.number
            && self.settings == other.settings
    }
}

pub(super) fn lobe_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        plots::values_ui(ui, state, View::Lobe);
        plots::wi_ui(ui, &mut state.document.plot);
        let over = &mut state.lobe.over;
        let words = match over {
            Over::Nothing => "no sampling",
            Over::Draws => "draws",
            Over::Density => "density",
        };
        let combo = egui::ComboBox::from_id_salt("over").width(90.0).selected_text(words);
        let shown = combo.show_ui(ui, |ui| {
            ui.selectable_value(over, Over::Nothing, "no sampling");
            ui.selectable_value(over, Over::Draws, "draws").on_hover_text(
                "Directions that `sample` draws for this direction, on the unit sphere.",
            );
            ui.selectable_value(over, Over::Density, "density")
                .on_hover_text("What `pdf` says of them, over its largest value.");
        });
        named(&shown.response, "Sampling of the current BRDF");
        asked::save_ui(ui, state, View::Lobe);
    });
    let answer = asked::ask(state, View::Lobe);
    if let Some(answer) = &answer
        && let Plot::Lobes(all) = &answer.plot
        && all.len() > 1
    {
        let pens = answer.question.pens.iter().map(|index| pen(*index));
        key_ui(ui, all.iter().zip(pens).map(|((name, _), pen)| (&**name, pen, false)));
    }
    let (area, response) = area_ui(ui, 2.0);
    steer(ui, &mut state.document.plot, &response);
    let Some(answer) = answer else { return };
    let Plot::Lobes(all) = &answer.plot else { return };
    let settings = Settings { eye: state.document.plot.eye, ..answer.question.settings };
    let radius = figure::lobe_axis(all, &settings);
    let brdf = state.document.current().chosen.configured.clone();
    let wanted = Dots { brdf, wo: settings.wi, over: state.lobe.over };
    state.lobe.dots.ask(&state.desk, &wanted, dots);
    if let Some(problem) = state.lobe.dots.problem() {
        state.message = problem.line();
    }
    let Some(dots) = state.lobe.dots.answer() else { return };
    let drawing = Drawing { answer: Arc::clone(&answer), dots, settings };
    state.lobe.drawn.ask(&state.desk, &drawing, |drawing, _| {
        let Plot::Lobes(all) = &drawing.answer.plot else {
            return Ok(Raster { size: [1, 1], pixels: vec![0; 4] });
        };
        Ok(figure::lobe_raster(
            all,
            &drawing.answer.question.pens,
            &drawing.settings,
            &drawing.dots,
        ))
    });
    let Some(drawn) = state.lobe.drawn.answer() else { return };
    let raster = &drawn.found;
    let key = drawn.number;
    let texture = state.lobe.texture.get(ui.ctx(), "lobe", key, TextureOptions::LINEAR, || {
        ColorImage::from_rgba_unmultiplied(raster.size, &raster.pixels)
    });
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta().y);
        state.lobe.zoom = (state.lobe.zoom + 0.003 * wheel).clamp(-2.0, 3.0);
    }
    if response.double_clicked() {
        state.lobe.zoom = 0.0;
        state.document.plot.eye = Settings::default().eye;
    }
    // Of the drawing's width the middle is used.
    const USED: f32 = 0.7;
    let [width, height] = raster.size.map(|side| side as f32);
    let rect = fitted(area, Vec2::new(USED * width, height));
    let rect = rect.scale_from_center(state.lobe.zoom.exp());
    let aside = 0.5 * (1.0 - USED);
    let middle = Rect::from_min_max(egui::Pos2::new(aside, 0.0), egui::Pos2::new(1.0 - aside, 1.0));
    let painter = ui.painter().with_clip_rect(area);
    painter.image(texture.id(), rect, middle, egui::Color32::WHITE);
    let log = if settings.decades.is_some() { " by logarithm" } else { "" };
    ui.label(format!(
        "centre {}, circle {} [1/sr]{log} · cyan wi, magenta mirror",
        radius.lowest(),
        radius.highest()
    ));
    ui.label("drag: turn · Shift: move wi · wheel: nearer · double click: back");
}

/// Drags turn the eye, with Shift they move the light.
fn steer(ui: &Ui, plot: &mut Settings, response: &egui::Response) {
    if !response.dragged() {
        return;
    }
    let [x, y] = [response.drag_delta().x, response.drag_delta().y].map(|c| TURN * f64::from(c));
    if ui.input(|input| input.modifiers.shift) {
        plot.wi.phi = (plot.wi.phi + x).rem_euclid(360.0);
        plot.wi.theta = (plot.wi.theta + y).clamp(0.0, 89.9);
    } else {
        let [azimuth, height] = plot.eye;
        plot.eye = [(azimuth - x).rem_euclid(360.0), (height + y).clamp(0.0, 90.0)];
    }
}
