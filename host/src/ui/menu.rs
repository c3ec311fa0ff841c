//! The menu above, the line below, and the page of keys.

use egui::{MenuBar, Ui};

use super::actions::Action;
use super::layout::Pane;
use super::viewer::State;

pub(super) fn menu_ui(ui: &mut Ui, state: &mut State) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| {
            use Action::{CopyCommand, Open, OpenFolder, Quit, Save, SaveAs, SavePicture};
            entry_ui(ui, state, Action::New, true);
            entry_ui(ui, state, Open, true);
            entry_ui(ui, state, OpenFolder, true);
            recent_ui(ui, state);
            ui.separator();
            for action in [Save, SaveAs, SavePicture, CopyCommand] {
                entry_ui(ui, state, action, true);
            }
            ui.separator();
            entry_ui(ui, state, Quit, true);
        });
        ui.menu_button("Edit", |ui| {
            let [undo, redo] = [state.history.can_undo(), state.history.can_redo()];
            entry_ui(ui, state, Action::Undo, undo);
            entry_ui(ui, state, Action::Redo, redo);
        });
        ui.menu_button("View", |ui| {
            for pane in Pane::all() {
                entry_ui(ui, state, Action::Show(pane), true);
            }
            ui.separator();
            entry_ui(ui, state, Action::ResetLayout, true);
            ui.separator();
            theme_ui(ui);
        });
        ui.menu_button("Help", |ui| {
            entry_ui(ui, state, Action::Palette, true);
            entry_ui(ui, state, Action::Shortcuts, true);
            entry_ui(ui, state, Action::About, true);
        });
    });
}

/// In words: the signs for it are in no font of ours.
fn theme_ui(ui: &mut Ui) {
    use egui::ThemePreference::{Dark, Light, System};
    let mut theme = ui.ctx().options(|options| options.theme_preference);
    for (choice, words) in
        [(System, "Theme of the system"), (Dark, "Dark theme"), (Light, "Light theme")]
    {
        if ui.radio_value(&mut theme, choice, words).clicked() {
            ui.ctx().set_theme(theme);
            ui.close();
        }
    }
}

fn recent_ui(ui: &mut Ui, state: &mut State) {
    let recent = state.memory.recent().to_vec();
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open again", |ui| {
            for path in recent {
                if ui.button(path.display().to_string()).clicked() {
                    state.open(&path);
                    ui.close();
                }
            }
        });
    });
}

fn entry_ui(ui: &mut Ui, state: &mut State, action: Action, enabled: bool) {
    let key = action.shortcut().map(|shortcut| ui.ctx().format_shortcut(&shortcut));
    let button = egui::Button::new(action.name()).shortcut_text(key.unwrap_or_default());
    if ui.add_enabled(enabled, button).clicked() {
        state.actions.push(action);
        ui.close();
    }
}

/// The newest thing worth telling, and what renders.
pub(super) fn message_ui(ui: &mut Ui, state: &State) {
    ui.horizontal(|ui| {
        let newest = match state.message.is_empty() {
            true => state.status.notes.first().cloned().unwrap_or_default(),
            false => state.message.clone(),
        };
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(&state.status.device);
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(newest).truncate());
            });
        });
    });
}

/// What this is.
pub(super) fn about_ui(ctx: &egui::Context, state: &mut State) {
    state.about_open &= !escaped(ctx);
    let window = egui::Window::new("About").open(&mut state.about_open).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        ui.strong(concat!("brdf ", env!("CARGO_PKG_VERSION")));
        ui.label("An explorer of reflectance functions: BRDFs and integrators as plugins.");
        ui.label("After Disney's BRDF Explorer, and a student project of Bordeaux, 2019.");
        ui.label(concat!("Licence: ", env!("CARGO_PKG_LICENSE")));
        ui.label(format!("Pictures: {}", state.status.device));
    });
}

/// Whether a window shall close.
pub(super) fn escaped(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.key_pressed(egui::Key::Escape))
}

/// All keys in one window.
pub(super) fn shortcuts_ui(ctx: &egui::Context, state: &mut State) {
    let mut open = state.shortcuts_open && !escaped(ctx);
    let window = egui::Window::new("Keys").open(&mut open).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        let shortcut = |action: &Action| {
            let keys = action.shortcut().map(|shortcut| ctx.format_shortcut(&shortcut));
            keys.map(|keys| (keys, action.name()))
        };
        let of_view = |action: &Action| matches!(action, Action::Show(_));
        let (views, others): (Vec<Action>, Vec<Action>) =
            Action::all().into_iter().partition(of_view);
        let moves = [
            ("?", "Keys"),
            ("F, held", "Compare: the other picture alone"),
            ("drag", "Turn the camera, or the eye of the lobe; move a plot"),
            ("Shift+drag", "Turn the environment; move wi over the lobe"),
            ("Ctrl+drag, middle drag", "Move the picture"),
            ("wheel", "Nearer and further; Ctrl with it: plots"),
            ("right drag", "Nearer and further; of a plot: a box"),
            ("double click", "Reset: the camera, a plot, a parameter by its name"),
        ];
        let moves = moves.map(|(keys, what)| (keys.to_owned(), what));
        let left: Vec<(String, &str)> = others.iter().filter_map(shortcut).collect();
        let right: Vec<(String, &str)> = views.iter().filter_map(shortcut).chain(moves).collect();
        // Side by side they fit a small window.
        let height = ctx.content_rect().height() - 90.0;
        let area = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
        area.show(ui, |ui| {
            ui.horizontal_top(|ui| {
                for (name, rows) in [("left keys", left), ("right keys", right)] {
                    egui::Grid::new(name).striped(true).show(ui, |ui| {
                        for (keys, what) in rows {
                            ui.monospace(keys);
                            ui.label(what);
                            ui.end_row();
                        }
                    });
                }
            });
        });
    });
    state.shortcuts_open = open;
}
