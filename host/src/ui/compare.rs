//! Two pictures over each other: the lit object and another BRDF, another integrator, a picture that was held or one
//! from a file. Their difference, and how large it is.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use egui::{Color32, Key, Pos2, Rect, TextureOptions, Ui, Vec2};

use super::files::Purpose;
use super::parts::{area_ui, file_name, fitted, named};
use super::textures::{Cached, image, toned};
use super::viewer::State;
use crate::live::{Frame, Live, Order, fresh_number};
use crate::measure::compare::{finite, mean, relative, relative_eps, signed};
use crate::picture::Scale;
use crate::picture::read::{Stored, read};
use crate::registry::Registry;
use crate::session::{Chosen, Session};

/// Shown while it is held.
const FLIP: Key = Key::F;

/// What stands beside the lit object.
#[derive(Default)]
pub(super) struct Compare {
    source: Source,
    mode: Mode,
    /// Where the picture is split, from the left.
    split: f32,
    /// Renders the other scene, from when one is first asked for.
    live: Option<Live>,
    ordered: Option<Session>,
    textures: [Cached<(u64, u64)>; 2],
    difference: Cached<([u64; 2], Mode)>,
    /// Differences of these two pictures.
    found: Option<([u64; 2], Found)>,
}

impl Compare {
    /// Whether somebody is moving something.
    pub(super) fn interact(&self, held: bool) {
        self.live.iter().for_each(|live| live.interact(held));
    }

    /// Reads the other integrator again.
    pub(super) fn reload(&mut self, registry: &Registry) -> Result<()> {
        if let Source::Integrator(chosen) = &mut self.source {
            **chosen = chosen.reload(registry)?;
        }
        Ok(())
    }

    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        let live = matches!(self.source, Source::Material(_) | Source::Integrator(_));
        let frame = self.live.as_ref().and_then(|live| live.status().frame);
        live && !frame.is_some_and(|frame| frame.complete)
    }
}

#[derive(Default)]
enum Source {
    /// Nothing yet.
    #[default]
    None,
    /// Another BRDF that is open, by its colour: its place changes when one before it is closed.
    Material(usize),
    /// Another integrator.
    Integrator(Box<Chosen>),
    /// A picture as it was.
    Held(Arc<Frame>),
    /// A picture from a file.
    File(PathBuf, Still),
}

/// A picture that does not change any more.
struct Still {
    number: u64,
    resolution: [u32; 2],
    rgb: Vec<[f32; 3]>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Mode {
    #[default]
    Split,
    Difference,
    Error,
}

/// Differences pixel by pixel, and in all.
struct Found {
    difference: Vec<f64>,
    error: Vec<f64>,
    relmse: f64,
    bias: f64,
}

/// One of the two pictures.
struct Side<'a> {
    number: u64,
    resolution: [u32; 2],
    rgb: &'a [[f32; 3]],
}

pub(super) fn compare_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| choices_ui(ui, state));
    order(state);
    let Some(frame) = state.status.frame.clone() else { return };
    let other = state.compare.live.as_ref().and_then(|live| live.status().frame);
    let a = Side {
        number: frame.number,
        resolution: frame.picture.resolution,
        rgb: &frame.picture.rgb,
    };
    let (area, response) = area_ui(ui, 2.0);
    let [width, height] = frame.session.film.resolution.map(|side| side as f32);
    let rect = fitted(area, Vec2::new(width, height));
    let exposure = state.document.session.film.exposure;
    let Compare { source, mode, split, textures, difference, found: held, .. } = &mut state.compare;
    let b = match (&*source, &other) {
        (Source::Held(frame), _) => Some(side(frame)),
        (Source::File(_, still), _) => {
            Some(Side { number: still.number, resolution: still.resolution, rgb: &still.rgb })
        }
        (Source::Material(_) | Source::Integrator(_), Some(frame)) => Some(side(frame)),
        _ => None,
    };
    let Some(b) = b else {
        let texture = texture(ui, &mut textures[0], &a, exposure);
        part_ui(ui, texture, rect, [0.0, 1.0]);
        ui.label("Choose what it is compared with: another BRDF or integrator, this picture held, or a file.");
        return;
    };
    let comparable = a.resolution == b.resolution;
    if comparable && *mode != Mode::Split {
        let numbers = [a.number, b.number];
        let found = found(held, &a, &b);
        let (values, scale) = match *mode {
            Mode::Difference => (&found.difference, Scale::diverging(&found.difference)),
            _ => (&found.error, Scale::spanning(&found.error)),
        };
        let key = (numbers, *mode);
        let size = a.resolution.map(|side| side as usize);
        let texture = difference.get(ui.ctx(), "difference", key, TextureOptions::NEAREST, || {
            image(size, &values.iter().map(|value| scale.colour(*value)).collect::<Vec<_>>())
        });
        part_ui(ui, texture.id(), rect, [0.0, 1.0]);
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
        let left = texture(ui, first, &a, exposure);
        let right = texture(ui, second, &b, exposure);
        part_ui(ui, left, rect, [0.0, split]);
        part_ui(ui, right, rect, [split, 1.0]);
        let x = rect.left() + split * rect.width();
        let stroke = egui::Stroke::new(1.5, Color32::WHITE);
        ui.painter().line_segment([Pos2::new(x, rect.top()), Pos2::new(x, rect.bottom())], stroke);
    }
    ui.label("drag: move the split · hold F: the other picture alone");
    let words = match comparable {
        true => {
            let Found { relmse, bias, .. } = found(held, &a, &b);
            format!(
                "relMSE of the lit object against the other {relmse:.2e} · mean difference {bias:.2e}"
            )
        }
        false if frame.preview => "…".to_owned(),
        false => {
            let [[aw, ah], [bw, bh]] = [a.resolution, b.resolution];
            format!("{aw}x{ah} beside {bw}x{bh} pixels: no difference is taken")
        }
    };
    ui.label(words);
}

fn side(frame: &Frame) -> Side<'_> {
    Side { number: frame.number, resolution: frame.picture.resolution, rgb: &frame.picture.rgb }
}

/// What differs between two pictures of one size; nothing is computed twice.
fn found<'a>(held: &'a mut Option<([u64; 2], Found)>, a: &Side<'_>, b: &Side<'_>) -> &'a Found {
    let numbers = [a.number, b.number];
    let fresh = held.take().filter(|(known, _)| *known == numbers).unwrap_or_else(|| {
        let counted = finite(a.rgb, b.rgb);
        let difference = signed(a.rgb, b.rgb);
        let error = relative(a.rgb, b.rgb, relative_eps(b.rgb, &counted));
        let (relmse, bias) = (mean(&error, &counted), mean(&difference, &counted));
        (numbers, Found { difference, error, relmse, bias })
    });
    &held.insert(fresh).1
}

fn texture(
    ui: &Ui,
    cached: &mut Cached<(u64, u64)>,
    side: &Side<'_>,
    exposure: f64,
) -> egui::TextureId {
    let key = (side.number, exposure.to_bits());
    let paint = || toned(side.resolution, side.rgb, exposure as f32);
    cached.get(ui.ctx(), "compared", key, TextureOptions::LINEAR, paint).id()
}

/// The part of a picture between two places, from the left.
fn part_ui(ui: &Ui, texture: egui::TextureId, rect: Rect, [from, to]: [f32; 2]) {
    let x = |part: f32| rect.left() + part * rect.width();
    let place = Rect::from_x_y_ranges(x(from)..=x(to), rect.y_range());
    let uv = Rect::from_min_max(Pos2::new(from, 0.0), Pos2::new(to, 1.0));
    ui.painter().image(texture, place, uv, Color32::WHITE);
}

fn choices_ui(ui: &mut Ui, state: &mut State) {
    let source = match &state.compare.source {
        Source::None => "beside…".to_owned(),
        Source::Material(pen) => {
            let material = state.document.with_pen(*pen);
            material.map_or(String::new(), |material| material.chosen.name().to_owned())
        }
        Source::Integrator(chosen) => chosen.configured.plugin.manifest.name.clone(),
        Source::Held(_) => "the held picture".to_owned(),
        Source::File(path, _) => file_name(&path.to_string_lossy()),
    };
    let mut wanted = None;
    let combo = egui::ComboBox::from_id_salt("beside").width(150.0).selected_text(source);
    let shown = combo.show_ui(ui, |ui| {
        for (index, material) in state.document.materials.iter().enumerate() {
            if index != state.document.current
                && ui.selectable_label(false, format!("BRDF: {}", material.chosen.name())).clicked()
            {
                wanted = Some(Source::Material(material.pen));
            }
        }
        for found in &state.catalogue.integrators {
            let Ok(plugin) = &found.plugin else { continue };
            let name = format!("Integrator: {}", plugin.manifest.name);
            if ui.selectable_label(false, name).clicked() {
                match Chosen::find(&state.registry, Kind::Integrator, &found.id) {
                    Ok(chosen) => wanted = Some(Source::Integrator(Box::new(chosen))),
                    Err(problem) => state.problems = vec![problem],
                }
            }
        }
        if ui.button("A picture from a file…").clicked() {
            let endings = ["exr", "hdr", "png"].map(str::to_owned);
            state.dialogs.ask(ui.ctx(), Purpose::Reference, &endings, "");
        }
    });
    named(&shown.response, "Beside");
    let hold =
        ui.button("hold this picture").on_hover_text("Compare with the picture as it is now.");
    if hold.clicked()
        && let Some(frame) = state.status.frame.as_ref().filter(|frame| !frame.preview)
    {
        wanted = Some(Source::Held(Arc::clone(frame)));
    }
    if let Some(wanted) = wanted {
        if state.compare.split == 0.0 {
            state.compare.split = 0.5;
        }
        state.compare.source = wanted;
    }
    for (mode, name) in
        [(Mode::Split, "split"), (Mode::Difference, "difference"), (Mode::Error, "relative error")]
    {
        ui.selectable_value(&mut state.compare.mode, mode, name);
    }
}

/// The other scene, where there is one, as the thread shall render it.
fn order(state: &mut State) {
    let mut scene = state.document.scene();
    match &state.compare.source {
        Source::Material(pen) => match state.document.with_pen(*pen) {
            Some(material) => scene.brdf = material.chosen.clone(),
            // It was closed.
            None => state.compare.source = Source::None,
        },
        Source::Integrator(chosen) => scene.integrator = (**chosen).clone(),
        Source::None | Source::Held(_) | Source::File(..) => {}
    }
    if !matches!(state.compare.source, Source::Material(_) | Source::Integrator(_)) {
        return;
    }
    (scene.film.exposure, scene.beside) = (0.0, Vec::new());
    if state.compare.ordered.as_ref() == Some(&scene) {
        return;
    }
    if state.compare.live.is_none() {
        match Live::start(state.registry.clone(), state.device.clone(), Arc::clone(&state.wake)) {
            Ok(live) => state.compare.live = Some(live),
            Err(problem) => state.problems = vec![problem],
        }
    }
    if let Some(live) = &state.compare.live {
        live.show(Order::new(scene.clone()));
        state.compare.ordered = Some(scene);
    }
}

impl State {
    /// Takes a picture from a file to compare with.
    pub(super) fn compare_with(&mut self, path: &Path) -> Result<String> {
        let stored = read(path)?;
        let shown = path.display().to_string();
        if stored.for_display {
            return Err(Problem::new(
                shown,
                "its values have been through a display curve",
                "give a picture of radiance: .exr or .hdr",
            ));
        }
        let Stored { resolution, rgb, .. } = stored;
        let still = Still { number: fresh_number(), resolution, rgb };
        self.compare.source = Source::File(path.to_owned(), still);
        self.compare.split = 0.5;
        Ok(format!("comparing with {shown}"))
    }
}
