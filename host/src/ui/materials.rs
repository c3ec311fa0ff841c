//! The BRDFs that are open, with the parameters of the current one; below them the integrator's.

use brdf_sdk::Kind;
use egui::{CollapsingHeader, Color32, RichText, ScrollArea, Sense, Ui, Vec2};

use super::actions::Action;
use super::parameters::parameters_ui;
use super::parts::named;
use super::viewer::State;
use crate::link;
use crate::picture::chart;
use crate::render::MAX_SAMPLES;
use crate::session::Chosen;

pub(super) fn materials_ui(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.strong("BRDFs");
            add_ui(ui, state);
        });
        list_ui(ui, state);
        ui.separator();
        current_ui(ui, state);
        ui.separator();
        integrator_ui(ui, state);
    });
}

/// What can be opened by name.
fn add_ui(ui: &mut Ui, state: &mut State) {
    ui.menu_button("add…", |ui| {
        ScrollArea::vertical().max_height(560.0).show(ui, |ui| {
            let mut wanted = None;
            for found in &state.catalogue.brdfs {
                match &found.plugin {
                    Ok(plugin) => {
                        let row = ui.button(&plugin.manifest.name);
                        if row.on_hover_text(&plugin.manifest.about).clicked() {
                            wanted = Some(found.id.clone());
                        }
                    }
                    Err(problem) => {
                        let row = ui.add_enabled(false, egui::Button::new(&found.id));
                        row.on_disabled_hover_text(problem.line());
                    }
                }
            }
            if let Some(id) = wanted {
                match Chosen::find(&state.registry, Kind::Brdf, &id) {
                    Ok(chosen) => state.document.add(chosen),
                    Err(problem) => state.refused = Some(problem),
                }
                ui.close();
            }
        });
        ui.separator();
        if ui.button("Open a file…").clicked() {
            state.actions.push(Action::Open);
            ui.close();
        }
        if ui.button("Open a plugin's folder…").clicked() {
            state.actions.push(Action::OpenFolder);
            ui.close();
        }
    });
}

/// A row for each: its colour, its name, whether plots show it.
fn list_ui(ui: &mut Ui, state: &mut State) {
    let mut close = None;
    let several = state.document.materials.len() > 1;
    for index in 0..state.document.materials.len() {
        let current = index == state.document.current;
        ui.horizontal(|ui| {
            let material = &mut state.document.materials[index];
            let (rect, _) = ui.allocate_exact_size(Vec2::splat(12.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, pen(material.pen));
            let name = material.chosen.name().to_owned();
            let row = ui.selectable_label(current, RichText::new(&name));
            if row.on_hover_text("Show it in pictures.").clicked() {
                state.document.current = index;
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let material = &mut state.document.materials[index];
                if several && ui.small_button("×").on_hover_text(format!("Close {name}.")).clicked()
                {
                    close = Some(index);
                }
                ui.toggle_value(&mut material.solo, "solo").on_hover_text("Plots show such alone.");
                ui.checkbox(&mut material.visible, "plot")
                    .on_hover_text(format!("Whether plots show {name}."));
            });
        });
    }
    if let Some(index) = close {
        state.document.close(index);
    }
}

/// Presets and parameters of the current BRDF.
fn current_ui(ui: &mut Ui, state: &mut State) {
    let current = state.document.current;
    let Some(material) = state.document.materials.get_mut(current) else { return };
    let configured = &mut material.chosen.configured;
    let plugin = std::sync::Arc::clone(&configured.plugin);
    let manifest = &plugin.manifest;
    ui.horizontal(|ui| {
        ui.strong(&manifest.name).on_hover_text(&manifest.about);
        if !manifest.presets.is_empty() {
            let combo = egui::ComboBox::from_id_salt("preset").selected_text("preset…");
            let shown = combo.width(90.0).show_ui(ui, |ui| {
                for preset in &manifest.presets {
                    let row = ui.selectable_label(false, &preset.name);
                    let row = match &preset.about {
                        Some(about) => row.on_hover_text(about),
                        None => row,
                    };
                    if row.clicked() {
                        configured.set_preset(preset);
                    }
                }
            });
            named(&shown.response, "Preset");
        }
        if ui
            .small_button("reset")
            .on_hover_text("All parameters back to their defaults.")
            .clicked()
        {
            configured.values = brdf_sdk::ParamValues::defaults(manifest);
        }
    });
    ui.push_id("brdf", |ui| {
        parameters_ui(ui, manifest, &mut configured.values, Some(&state.dialogs));
    });
    if link::sampling(configured).is_ok_and(|drawn| drawn.by_host().is_some()) {
        ui.checkbox(&mut configured.fit_sampler, "fit a sampler").on_hover_text(
            "It has no sampling of its own: draw by what its values say instead of by the cosine. For glossy ones.",
        );
    }
}

fn integrator_ui(ui: &mut Ui, state: &mut State) {
    let configured = &mut state.document.session.integrator.configured;
    let plugin = std::sync::Arc::clone(&configured.plugin);
    let manifest = &plugin.manifest;
    let header = CollapsingHeader::new(format!("Integrator: {}", manifest.name));
    header.id_salt("integrator").default_open(true).show(ui, |ui| {
        ui.label(&manifest.about);
        ui.push_id("integrator", |ui| {
            parameters_ui(ui, manifest, &mut configured.values, Some(&state.dialogs));
        });
        let effort = &mut state.document.session.effort;
        ui.horizontal(|ui| {
            let mut spp = u32::try_from(effort.spp()).unwrap_or(u32::MAX);
            let before = spp;
            let label = ui.label("samples of a pixel");
            let drag = egui::DragValue::new(&mut spp).speed(16).range(1..=MAX_SAMPLES);
            ui.add(drag).labelled_by(label.id);
            if spp != before {
                // Passes only cut the work; one sample more is one more.
                let samples =
                    (1..=64).rev().find(|samples| spp.is_multiple_of(*samples)).unwrap_or(1);
                (effort.samples, effort.passes) = (samples, Some(spp / samples));
            }
        });
    });
}

/// The colour of a pen on the screen.
pub(super) fn pen(index: usize) -> Color32 {
    let [r, g, b] = chart::colour(index).map(|c| (255.0 * c).round() as u8);
    Color32::from_rgb(r, g, b)
}
