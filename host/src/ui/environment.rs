//! The environment as it lies in the world: its radiance or the density it is drawn with, and draws of it.

use std::sync::Arc;

use brdf_sdk::Result;
use egui::{Color32, Pos2, Rect, TextureOptions, Ui, Vec2};
use glam::DMat3;

use super::parts::{area_ui, bar_ui, draw, fitted, pixel_at, wrapped};
use super::textures::{Cached, image};
use super::viewer::State;
use crate::conformance::LightDraws;
use crate::environment::{Environment, Purpose, importance, orientation};
use crate::exec::Executor;
use crate::live::Asked;
use crate::picture::Scale;
use crate::render::Lighting;
use crate::tone::{Tone, byte};

/// Columns and rows of the picture.
const SIZE: [usize; 2] = [768, 384];

/// Draws that are shown.
const DRAWS: usize = 2000;

/// Degrees of a drag's point, as of the lit object.
const TURN: f64 = 0.4;

/// The view's choices.
#[derive(Default)]
pub(super) struct Sky {
    asked: Asked<Question, Answer>,
    texture: Cached<(u64, Tone)>,
    density: bool,
    draws: bool,
}

impl Sky {
    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.asked.is_waiting()
    }
}

#[derive(Clone)]
struct Question {
    map: Arc<Environment>,
    world_from_map: DMat3,
    lighting: Lighting,
    density: bool,
    draws: bool,
}

impl PartialEq for Question {
    /// A map that was read again is another.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.map, &other.map)
            && self.world_from_map == other.world_from_map
            && self.lighting == other.lighting
            && (self.density, self.draws) == (other.density, other.draws)
    }
}

struct Answer {
    question: Question,
    /// Radiance, or the density [1/sr], row by row from the top.
    values: Vec<[f32; 3]>,
    /// The colours of densities, which go over many factors of ten.
    scale: Scale,
    /// Where draws lie in the picture, in [0, 1].
    draws: Vec<[f32; 2]>,
}

pub(super) fn sky_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        ui.selectable_value(&mut state.sky.density, false, "radiance");
        ui.selectable_value(&mut state.sky.density, true, "density of draws");
        ui.checkbox(&mut state.sky.draws, format!("{DRAWS} draws"));
        let light = &mut state.document.session.environment;
        for (angle, name) in [(&mut light.phi, "phi "), (&mut light.theta, "theta ")] {
            ui.add(egui::DragValue::new(angle).prefix(name).suffix("°").max_decimals(2));
        }
    });
    let Some(map) = state.status.environment.clone() else { return };
    let light = &state.document.session.environment;
    let question = Question {
        map,
        world_from_map: orientation::world_from_map(light.phi, light.theta),
        lighting: light.lighting,
        density: state.sky.density,
        draws: state.sky.draws,
    };
    state.sky.asked.ask(&state.desk, &question, look);
    let Some(answer) = state.sky.asked.answer() else { return };
    let tone = state.document.session.film.tone;
    let key = (answer.number, tone);
    let texture = state.sky.texture.get(ui.ctx(), "sky", key, TextureOptions::LINEAR, || {
        let pixel = |rgb: &[f32; 3]| match answer.question.density {
            true => answer.scale.colour(rgb[0].into()),
            false => rgb.map(|c| byte(tone.light(c))),
        };
        image(SIZE, &answer.values.iter().map(pixel).collect::<Vec<_>>())
    });
    let (area, response) = area_ui(ui, 2.0);
    let rect = fitted(area, Vec2::new(2.0, 1.0));
    draw(ui, texture.id(), rect);
    if answer.question.density {
        bar_ui(ui, rect, &answer.scale);
    }
    for [u, v] in &answer.draws {
        let at = rect.min + Vec2::new(*u, *v) * rect.size();
        ui.painter().circle(at, 1.5, Color32::WHITE, egui::Stroke::new(0.8, Color32::BLACK));
    }
    let light = &mut state.document.session.environment;
    if response.dragged() {
        let [x, y] = [response.drag_delta().x, response.drag_delta().y].map(f64::from);
        light.phi = wrapped(light.phi + TURN * x);
        light.theta = (light.theta + TURN * y).clamp(-90.0, 90.0);
    }
    if response.double_clicked() {
        (light.phi, light.theta) = (0.0, 0.0);
    }
    ui.label(under_pointer(&answer, rect, response.hover_pos()));
    let Environment { name, width, height, .. } = answer.question.map.as_ref();
    ui.label(format!("{name}, {width}x{height} texels; the middle looks to +z, the top to +y"));
}

fn under_pointer(answer: &Answer, rect: Rect, pointer: Option<Pos2>) -> String {
    let Some([column, row]) = pixel_at(rect, pointer, SIZE) else {
        return "drag: turn · double click: back".to_owned();
    };
    let [r, g, b] = answer.values[row * SIZE[0] + column];
    match answer.question.density {
        true => format!("density {r:.4e} [1/sr]"),
        false => format!("R {r:.5}  G {g:.5}  B {b:.5}"),
    }
}

fn look(question: &Question, executor: &mut dyn Executor) -> Result<Answer> {
    let Question { map, world_from_map, lighting, density, draws } = question;
    let purpose =
        Purpose { filter: lighting.filter, weighting: lighting.weighting, compensated: false };
    let densities = density.then(|| importance(map, purpose));
    let map_from_world = world_from_map.transpose();
    let [columns, rows] = SIZE;
    let value = |index: usize| {
        let (column, row) = (index % columns, index / columns);
        let part = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
        let world = orientation::direction_of(part(column, columns), part(row, rows));
        let direction = map_from_world * world;
        let Some(densities) = &densities else { return map.radiance(direction) };
        [densities.density(map, direction) as f32; 3]
    };
    let values: Vec<[f32; 3]> = (0..columns * rows).map(value).collect();
    let mut drawn = Vec::new();
    if *draws {
        let mut program = LightDraws::new(executor, map, *world_from_map, purpose)?;
        let found = program.draw(executor, 0, 0, DRAWS);
        program.free(executor);
        drawn = found?
            .into_iter()
            .map(|(direction, _)| {
                let (u, v) = orientation::uv_of(direction.into());
                [u as f32, v as f32]
            })
            .collect();
    }
    let scale =
        Scale::logarithmic(&values.iter().map(|value| value[0].into()).collect::<Vec<f64>>());
    Ok(Answer { question: question.clone(), values, scale, draws: drawn })
}
