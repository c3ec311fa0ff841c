//! The image slice: f over half and difference angle.

use egui::{TextureOptions, Ui, Vec2};

use super::parts::{picture_ui, pixel_at};
use super::textures::{Cached, image};
use super::viewer::State;
use super::{asked, plots};
use crate::figure;
use crate::plot::{Plot, Settings, View};

/// The slices' textures.
#[derive(Default)]
pub(super) struct Slices {
    textures: Vec<Cached<[u64; 3]>>,
}

pub(super) fn slices_ui(ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        let plot = &mut state.document.plot;
        plots::angle_ui(ui, &mut plot.phi_d, "phi_d", 0.0..=360.0);
        ui.checkbox(&mut plot.square, "square theta_h");
        ui.checkbox(&mut plot.chroma, "chroma");
        let exposure = egui::DragValue::new(&mut plot.exposure).speed(0.05).range(-20.0..=20.0);
        ui.add(exposure.prefix("exposure ").suffix(" stops"));
        asked::save_ui(ui, state, View::Slice);
    });
    let Some(answer) = asked::ask(state, View::Slice) else { return };
    let Plot::Slices(slice, all) = &answer.plot else { return };
    let Settings { exposure, chroma, .. } = state.document.plot;
    let looks = Settings { exposure, chroma, ..answer.question.settings };
    state.slices.textures.resize_with(all.len(), Cached::default);
    let line = ui.text_style_height(&egui::TextStyle::Body) + ui.spacing().item_spacing.y;
    let space = ui.available_size();
    let side = (space.x / all.len().max(1) as f32 - 8.0).min(space.y - 2.0 * line).max(16.0);
    let mut under = String::new();
    ui.horizontal(|ui| {
        for ((name, values), texture) in all.iter().zip(&mut state.slices.textures) {
            let key = [answer.number, exposure.to_bits(), chroma.into()];
            let texture = texture.get(ui.ctx(), "slice", key, TextureOptions::NEAREST, || {
                // Rows of a slice go up.
                let pixels = figure::slice_pixels(values, &looks);
                let rows = pixels.chunks(slice.size).rev();
                image([slice.size; 2], &rows.flatten().copied().collect::<Vec<_>>())
            });
            ui.vertical(|ui| {
                ui.label(name);
                let (rect, response) = picture_ui(ui, texture.id(), Vec2::splat(side));
                let size = [slice.size; 2];
                if let Some([column, down]) = pixel_at(rect, response.hover_pos(), size) {
                    let row = slice.size - 1 - down;
                    let [theta_h, theta_d] = slice.angles(column, row);
                    let [r, g, b] = values[row * slice.size + column];
                    under = format!(
                        "theta_h {theta_h:.1}°, theta_d {theta_d:.1}°: {r:.5} {g:.5} {b:.5} [1/sr]"
                    );
                }
            });
        }
    });
    match under.is_empty() {
        true => ui.label("theta_h right, theta_d up, 0 to 90°; grey: below the horizon"),
        false => ui.label(under),
    };
}
