//! The lit object: the picture as it gets better, turned and lit by the mouse.

use std::sync::Arc;

use brdf_sdk::Kind;
use clap::ValueEnum;
use egui::{Align2, Color32, ColorImage, DragValue, FontId, Rect, TextureOptions, Ui, Vec2};
use rayon::prelude::*;

use super::files::Purpose;
use super::parts::{area_ui, bar_ui, draw, file_name, fitted, named, pixel_at, wrapped};
use super::textures::{Cached, image, toned};
use super::viewer::State;
use crate::live::{Doing, Frame};
use crate::picture::Scale;
use crate::scene::{Camera, Shape};
use crate::session::{Background, Chosen};
use crate::tone::luminance;
use crate::tone::{Curve, Tone};

/// How the picture is shown.
#[derive(Default)]
pub(super) struct Look {
    texture: Cached<(u64, Tone, bool)>,
    /// What false colours mean in it.
    scale: Option<Scale>,
    false_colour: bool,
}

/// Turns of a drag [degrees for a point], and of the wheel.
const TURN: f64 = 0.4;
const ZOOM: f64 = 0.002;

/// The camera stays outside of the unit sphere.
const NEAREST: f64 = 1.2;
const FURTHEST: f64 = 100.0;

pub(super) fn lit_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| choices_ui(ui, state));
    let Some(frame) = state.status.frame.clone() else {
        let words = match state.status.problem {
            Some(_) => "There is no picture: a problem is told of below.",
            None => "The first picture is being made.",
        };
        ui.centered_and_justified(|ui| ui.label(words));
        return;
    };
    let (area, response) = area_ui(ui, 2.0);
    let response = response.on_hover_cursor(egui::CursorIcon::Grab);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Lit object"));
    let [width, height] = frame.session.film.resolution.map(|side| side as f32);
    let rect = fitted(area, Vec2::new(width, height));
    let tone = state.document.session.film.tone;
    let Look { texture, scale, false_colour } = &mut state.lit;
    let false_colour = *false_colour;
    let texture = texture.get(
        ui.ctx(),
        "lit",
        (frame.number, tone, false_colour),
        TextureOptions::LINEAR,
        || {
            if false_colour {
                let (image, spanned) = luminances(&frame);
                *scale = Some(spanned);
                image
            } else {
                toned(frame.picture.resolution, &frame.picture.rgb, tone)
            }
        },
    );
    draw(ui, texture.id(), rect);
    if let Some(scale) = state.lit.scale.as_ref().filter(|_| false_colour) {
        bar_ui(ui, rect, scale);
    }
    if state.status.doing != Doing::Rendering && state.status.doing != Doing::Waiting {
        let words =
            if state.status.doing == Doing::Loading { "loading…" } else { "compiling…" };
        ui.painter().text(
            area.left_top() + Vec2::splat(6.0),
            Align2::LEFT_TOP,
            words,
            FontId::default(),
            Color32::WHITE,
        );
    }
    steer(ui, state, &response, rect.height());
    ui.label(figures(&frame, state.status.progress));
    ui.label(under_pointer(&frame, rect, response.hover_pos()));
}

/// What is rendered, by which integrator, under which light.
fn choices_ui(ui: &mut Ui, state: &mut State) {
    let session = &mut state.document.session;
    let now = session.integrator.configured.plugin.manifest.name.clone();
    let integrator =
        egui::ComboBox::from_id_salt("integrator").selected_text(now).width(150.0).height(420.0);
    let mut wanted = None;
    let shown = integrator.show_ui(ui, |ui| {
        for found in &state.catalogue.integrators {
            let Ok(plugin) = &found.plugin else { continue };
            let chosen = found.id == session.integrator.configured.plugin.id;
            let row = ui.selectable_label(chosen, &plugin.manifest.name);
            if row.on_hover_text(&plugin.manifest.about).clicked() {
                wanted = Some(found.id.clone());
            }
        }
    });
    named(&shown.response, "Integrator");
    if let Some(id) = wanted {
        match Chosen::find(&state.registry, Kind::Integrator, &id) {
            Ok(chosen) => session.integrator = chosen,
            Err(problem) => state.refused = Some(problem),
        }
    }
    let light = &mut session.environment;
    let combo = egui::ComboBox::from_id_salt("map").selected_text(file_name(&light.map));
    let shown = combo.width(130.0).height(420.0).show_ui(ui, |ui| {
        for map in &state.catalogue.maps {
            if ui.selectable_label(light.map == *map, map).clicked() {
                light.set_map(map.clone());
            }
        }
        if ui.button("Open a map…").clicked() {
            let endings = ["hdr", "exr", "ptex", "ptx", "penv", "toml"].map(str::to_owned);
            state.dialogs.ask(ui.ctx(), Purpose::Open, &endings, "");
        }
    });
    named(&shown.response, "Environment");
    let combo = egui::ComboBox::from_id_salt("shape").selected_text(file_name(&session.shape));
    let shown = combo.width(80.0).show_ui(ui, |ui| {
        for shape in Shape::NAMES {
            if ui.selectable_label(session.shape == shape, shape).clicked() {
                shape.clone_into(&mut session.shape);
            }
        }
        if ui.button("Open a mesh…").clicked() {
            let endings = ["obj", "gltf", "glb"].map(str::to_owned);
            state.dialogs.ask(ui.ctx(), Purpose::Open, &endings, "");
        }
    });
    named(&shown.response, "Shape");
    let mut behind = session.film.background == Background::Env;
    ui.checkbox(&mut behind, "background");
    session.film.background = if behind { Background::Env } else { Background::Black };
    let tone = &mut session.film.tone;
    let exposure = ui.add(
        DragValue::new(&mut tone.exposure)
            .speed(0.05)
            .range(-20.0..=20.0)
            .max_decimals(2)
            .prefix("exposure ")
            .suffix(" stops"),
    );
    if exposure.double_clicked() {
        tone.exposure = 0.0;
    }
    let words = |curve: Curve| match curve {
        Curve::Soft => "soft highlights",
        Curve::Linear => "linear, cut",
    };
    let combo = egui::ComboBox::from_id_salt("curve").selected_text(words(tone.curve)).width(110.0);
    let shown = combo.show_ui(ui, |ui| {
        for curve in Curve::value_variants() {
            ui.selectable_value(&mut tone.curve, *curve, words(*curve));
        }
    });
    named(&shown.response, "Tone curve");
    ui.checkbox(&mut state.lit.false_colour, "false colour")
        .on_hover_text("Luminances by their logarithm, brighter is more.");
}

/// Luminances in false colours, black to white over their factors of ten.
fn luminances(frame: &Arc<Frame>) -> (ColorImage, Scale) {
    let luminance = |rgb: &[f32; 3]| luminance(rgb.map(f64::from));
    let values: Vec<f64> = frame.picture.rgb.par_iter().map(luminance).collect();
    let scale = Scale::spanning(&values);
    let pixels: Vec<[u8; 3]> = values.par_iter().map(|value| scale.colour(*value)).collect();
    (image(frame.picture.resolution.map(|side| side as usize), &pixels), scale)
}

/// Drags turn the camera about the object, with Shift the environment, with Ctrl they move the picture, which is
/// `height` points high; the wheel and the right button go nearer.
fn steer(ui: &Ui, state: &mut State, response: &egui::Response, height: f32) {
    let session = &mut state.document.session;
    let delta = response.drag_delta();
    let [x, y] = [f64::from(delta.x), f64::from(delta.y)];
    let [shift, command] = ui.input(|input| [input.modifiers.shift, input.modifiers.command]);
    if response.dragged_by(egui::PointerButton::Middle)
        || (command && response.dragged_by(egui::PointerButton::Primary))
    {
        let [right, up] = &mut session.camera.shift;
        *right += 2.0 * x / f64::from(height);
        *up -= 2.0 * y / f64::from(height);
    } else if response.dragged_by(egui::PointerButton::Primary) {
        if shift {
            let light = &mut session.environment;
            light.phi = wrapped(light.phi + TURN * x);
            light.theta = (light.theta + TURN * y).clamp(-90.0, 90.0);
        } else {
            let camera = &mut session.camera;
            camera.yaw = wrapped(camera.yaw - TURN * x);
            camera.pitch = (camera.pitch + TURN * y).clamp(-90.0, 90.0);
        }
    }
    let wheel = match response.hovered() {
        true => f64::from(ui.input(|input| input.smooth_scroll_delta().y)),
        false => 0.0,
    };
    let by_drag = if response.dragged_by(egui::PointerButton::Secondary) { -2.0 * y } else { 0.0 };
    let nearer = wheel + by_drag;
    if nearer != 0.0 {
        let distance = session.camera.distance * (-ZOOM * nearer).exp();
        session.camera.distance = distance.clamp(NEAREST, FURTHEST);
    }
    if response.double_clicked() {
        session.camera = Camera::default();
        (session.environment.phi, session.environment.theta) = (0.0, 0.0);
    }
}

/// How far the picture is.
fn figures(frame: &Frame, progress: Option<[u64; 2]>) -> String {
    let [width, height] = frame.picture.resolution;
    if frame.preview {
        return match progress {
            Some([done, of]) => format!(
                "{width}x{height} by samples of the BRDF, until the sum is done: {done} of {of} texels"
            ),
            None => format!("{width}x{height}, a first look"),
        };
    }
    let what = if frame.sum { "texels" } else { "spp" };
    let error = frame.estimate.and_then(|found| match found.quadrature {
        Some(error) => Some(format!(" · error about {error:.1e} of the sum")),
        None => Some(format!(" · relMSE about {:.1e}", found.relmse?)),
    });
    let error = error.unwrap_or_default();
    let bad = match frame.nonfinite {
        0 => String::new(),
        count => format!(" · {count} samples were Inf or NaN"),
    };
    format!(
        "{} of {} {what} · {:.1} M/s · {:.1} s{error}{bad}",
        frame.done, frame.of, frame.rate, frame.seconds
    )
}

/// The pixel under the pointer.
fn under_pointer(frame: &Frame, rect: Rect, pointer: Option<egui::Pos2>) -> String {
    let size = frame.picture.resolution.map(|side| side as usize);
    let Some([x, y]) = pixel_at(rect, pointer, size) else {
        return "drag: turn · Shift: the environment · Ctrl: move · wheel: nearer · double click: back"
            .to_owned();
    };
    let index = y * size[0] + x;
    let Some([r, g, b]) = frame.picture.rgb.get(index) else { return String::new() };
    let error = match &frame.picture.std_error {
        Some(errors) => match errors.get(index) {
            Some([r, g, b]) => format!("  ± {r:.2e} {g:.2e} {b:.2e}"),
            None => String::new(),
        },
        None => String::new(),
    };
    format!("({x}, {y})  R {r:.5}  G {g:.5}  B {b:.5}{error}")
}
