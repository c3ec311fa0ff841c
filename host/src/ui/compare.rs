//! Two pictures over each other: the lit object and what stands beside it. Their difference, and how large it is.

use std::sync::Arc;

use brdf_sdk::Result;
use egui::{Color32, Key, Pos2, Rect, TextureOptions, Ui, Vec2};

use super::beside::{self, Side, Source};
use super::parts::{area_ui, bar_ui, fitted};
use super::textures::{Cached, image, toned};
use super::viewer::State;
use crate::exec::Executor;
use crate::live::{Answered, Asked, Live, Order};
use crate::measure::compare::{finite, mean, relative, relative_eps, signed};
use crate::picture::Scale;
use crate::registry::Registry;
use crate::session::Session;
use crate::tone::Tone;

/// Shown while it is held.
const FLIP: Key = Key::F;

/// The view's choices, and what it knows.
#[derive(Default)]
pub(super) struct Compare {
    pub(super) source: Source,
    mode: Mode,
    /// Where the picture is split, from the left.
    split: f32,
    /// How often something else was put beside.
    turn: u64,
    /// Renders the other scene, from when one is first asked for.
    live: Option<Live>,
    ordered: Option<Session>,
    textures: [Cached<(u64, Tone)>; 2],
    difference: Cached<(u64, Mode)>,
    asked: Asked<Pair, Found>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Mode {
    #[default]
    Split,
    Difference,
    Error,
}

/// Two pictures of one size: one, and what it is held against.
#[derive(Clone)]
pub(super) struct Pair {
    pub(super) sides: [Side; 2],
    turn: u64,
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |pair: &Self| pair.sides.each_ref().map(Side::number);
        numbers(self) == numbers(other)
    }
}

/// Differences pixel by pixel, and in all.
pub(super) struct Found {
    pub(super) pair: Pair,
    difference: (Vec<f64>, Scale),
    error: (Vec<f64>, Scale),
    pub(super) relmse: f64,
    bias: f64,
}

impl Compare {
    /// Whether somebody is moving something.
    pub(super) fn interact(&self, held: bool) {
        self.live.iter().for_each(|live| live.interact(held));
    }

    /// Reads the other plugin again.
    pub(super) fn reload(&mut self, registry: &Registry) -> Result<()> {
        self.source.reload(registry)
    }

    /// Puts something else beside.
    pub(super) fn take(&mut self, source: Source) {
        if self.split == 0.0 {
            self.split = 0.5;
        }
        self.source = source;
        self.turn += 1;
    }

    /// The picture beside, if there is one.
    pub(super) fn side(&self) -> Option<Side> {
        self.source.side(self.live.as_ref().and_then(|live| live.status().frame))
    }

    /// The newest differences from what stands beside now.
    pub(super) fn found(&self) -> Option<Arc<Answered<Found>>> {
        self.asked.answer().filter(|found| found.pair.turn == self.turn)
    }

    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        let frame = self.live.as_ref().and_then(|live| live.status().frame);
        let rendered = !self.source.is_live() || frame.is_some_and(|frame| frame.complete);
        !rendered || self.asked.is_waiting()
    }
}

impl State {
    /// Asks how the lit object and the picture beside it differ, where they have one size.
    pub(super) fn ask_difference(&mut self) {
        let Some(frame) = self.status.frame.clone() else { return };
        // While one is looked at, pictures go on: the newest is taken then.
        if self.compare.asked.is_waiting() {
            return;
        }
        let sides = [Some(Side::Rendered(frame)), self.compare.side()];
        if let [Some(a), Some(b)] = sides
            && a.resolution() == b.resolution()
        {
            let pair = Pair { sides: [a, b], turn: self.compare.turn };
            self.compare.asked.ask(&self.desk, &pair, differ);
        }
    }
}

fn differ(pair: &Pair, _: &mut dyn Executor) -> Result<Found> {
    let [a, b] = pair.sides.each_ref().map(Side::rgb);
    let counted = finite(a, b);
    let difference = signed(a, b);
    let error = relative(a, b, relative_eps(b, &counted));
    let (relmse, bias) = (mean(&error, &counted), mean(&difference, &counted));
    let scales = [Scale::diverging(&difference), Scale::spanning(&error)];
    let [difference, error] = [(difference, scales[0]), (error, scales[1])];
    Ok(Found { pair: pair.clone(), difference, error, relmse, bias })
}

pub(super) fn compare_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        beside::choices_ui(ui, state);
        for (mode, name) in [
            (Mode::Split, "split"),
            (Mode::Difference, "difference"),
            (Mode::Error, "relative error"),
        ] {
            ui.selectable_value(&mut state.compare.mode, mode, name);
        }
    });
    beside::values_ui(ui, state);
    order(state);
    state.ask_difference();
    let other = state.compare.live.as_ref().filter(|_| state.compare.source.is_live());
    if let Some(problem) = other.and_then(|live| live.status().problem) {
        ui.colored_label(ui.visuals().warn_fg_color, problem.line());
    }
    let Some(frame) = state.status.frame.clone() else { return };
    let (area, response) = area_ui(ui, 2.0);
    let [width, height] = frame.session.film.resolution.map(|side| side as f32);
    let rect = fitted(area, Vec2::new(width, height));
    let tone = state.document.session.film.tone;
    let preview = frame.preview;
    let a = Side::Rendered(frame);
    let b = state.compare.side();
    let found = state.compare.found();
    let Compare { mode, split, textures, difference, .. } = &mut state.compare;
    let Some(b) = b else {
        let texture = texture(ui, &mut textures[0], &a, tone);
        part_ui(ui, texture, rect, [0.0, 1.0]);
        ui.label(
            "Choose what stands beside it: a BRDF, parameters, an integrator, an environment, a picture.",
        );
        return;
    };
    let comparable = a.resolution() == b.resolution();
    let found = found.filter(|_| comparable);
    if let (Some(found), Mode::Difference | Mode::Error) = (&found, *mode) {
        let (values, scale) = match *mode {
            Mode::Difference => &found.difference,
            _ => &found.error,
        };
        let key = (found.number, *mode);
        let size = a.resolution().map(|side| side as usize);
        let paint =
            || image(size, &values.iter().map(|value| scale.colour(*value)).collect::<Vec<_>>());
        let texture = difference.get(ui.ctx(), "difference", key, TextureOptions::NEAREST, paint);
        part_ui(ui, texture.id(), rect, [0.0, 1.0]);
        bar_ui(ui, rect, scale);
    } else {
        let flipped =
            ui.input(|input| input.key_down(FLIP)) && !ui.ctx().egui_wants_keyboard_input();
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            *split = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        let split = if flipped { 0.0 } else { *split };
        let [first, second] = textures;
        let left = texture(ui, first, &a, tone);
        let right = texture(ui, second, &b, tone);
        part_ui(ui, left, rect, [0.0, split]);
        part_ui(ui, right, rect, [split, 1.0]);
        let x = rect.left() + split * rect.width();
        let stroke = egui::Stroke::new(1.5, Color32::WHITE);
        ui.painter().line_segment([Pos2::new(x, rect.top()), Pos2::new(x, rect.bottom())], stroke);
    }
    let samples = [a.samples(), b.samples()].into_iter().flatten().collect::<Vec<_>>().join(" | ");
    ui.label(match (*mode, samples.is_empty()) {
        (Mode::Split, false) => format!("{samples} · drag: the split · hold F: the other alone"),
        (Mode::Split, true) => "drag: the split · hold F: the other alone".to_owned(),
        _ => samples,
    });
    let words = match &found {
        Some(found) => format!(
            "relMSE of the lit object against the other {:.2e} · mean difference {:.2e}",
            found.relmse, found.bias
        ),
        None if comparable || preview => "…".to_owned(),
        None => {
            let [[aw, ah], [bw, bh]] = [a.resolution(), b.resolution()];
            format!("{aw}x{ah} beside {bw}x{bh} pixels: no difference is taken")
        }
    };
    ui.label(words);
}

fn texture(ui: &Ui, cached: &mut Cached<(u64, Tone)>, side: &Side, tone: Tone) -> egui::TextureId {
    let key = (side.number(), tone);
    let paint = || toned(side.resolution(), side.rgb(), tone);
    cached.get(ui.ctx(), "compared", key, TextureOptions::LINEAR, paint).id()
}

/// The part of a picture between two places, from the left.
fn part_ui(ui: &Ui, texture: egui::TextureId, rect: Rect, [from, to]: [f32; 2]) {
    let x = |part: f32| rect.left() + part * rect.width();
    let place = Rect::from_x_y_ranges(x(from)..=x(to), rect.y_range());
    let uv = Rect::from_min_max(Pos2::new(from, 0.0), Pos2::new(to, 1.0));
    ui.painter().image(texture, place, uv, Color32::WHITE);
}

/// Orders the other scene, where there is one, if it has changed.
fn order(state: &mut State) {
    let Some(scene) = beside::scene(state) else { return };
    if state.compare.ordered.as_ref() == Some(&scene) {
        return;
    }
    if state.compare.live.is_none() {
        match Live::start(state.registry.clone(), state.device.clone(), Arc::clone(&state.wake)) {
            Ok(live) => state.compare.live = Some(live),
            Err(problem) => state.refused = Some(problem),
        }
    }
    if let Some(live) = &state.compare.live {
        live.show(Order::new(scene.clone()));
        state.compare.ordered = Some(scene);
    }
}
