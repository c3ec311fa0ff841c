//! Everything by its name: what is typed finds actions, BRDFs, integrators, maps, shapes, and paths to open or to save at.

use std::path::{Path, PathBuf};

use brdf_sdk::Kind;
use egui::{Key, ScrollArea, TextEdit, Ui};

use super::actions::Action;
use super::asked;
use super::viewer::State;
use crate::layout::word;
use crate::plot::View;
use crate::scene::Shape;
use crate::session::Chosen;

/// Entries that are shown.
const MOST: usize = 14;

/// The palette, open or not.
#[derive(Default)]
pub(super) struct Palette {
    open: bool,
    text: String,
    row: usize,
    keys: Keys,
}

/// Keys of this frame that are the palette's.
#[derive(Default, Clone, Copy)]
struct Keys {
    down: usize,
    up: usize,
    enter: bool,
    escape: bool,
}

impl Palette {
    pub(super) fn toggle(&mut self) {
        *self = Self { open: !self.open, ..Self::default() };
    }

    /// Takes its keys, before anything that is drawn beneath it could.
    pub(super) fn take_keys(&mut self, ctx: &egui::Context) {
        if !self.open {
            return;
        }
        self.keys = ctx.input_mut(|input| {
            let mut pressed = |key| input.count_and_consume_key(egui::Modifiers::NONE, key);
            Keys {
                down: pressed(Key::ArrowDown),
                up: pressed(Key::ArrowUp),
                enter: pressed(Key::Enter) > 0,
                escape: pressed(Key::Escape) > 0,
            }
        });
    }
}

/// Something that a name means.
#[derive(Debug, Clone, PartialEq)]
enum Entry {
    Action(Action),
    Plugin(Kind, String),
    Map(String),
    Shape(&'static str),
    SaveScene(PathBuf),
    SavePicture(PathBuf),
    SavePlot(View, PathBuf),
    Path(PathBuf),
}

pub(super) fn palette_ui(ui: &mut Ui, state: &mut State) {
    if !state.palette.open {
        return;
    }
    let Keys { down, up, enter, escape } = std::mem::take(&mut state.palette.keys);
    let mut chosen = None;
    let window = egui::Window::new("Palette").title_bar(false).resizable(false);
    window.anchor(egui::Align2::CENTER_TOP, [0.0, 60.0]).fixed_size([460.0, 0.0]).show(
        ui.ctx(),
        |ui| {
            let hint = "an action, a BRDF, an integrator, a map, a shape, or a path";
            let field = TextEdit::singleline(&mut state.palette.text).hint_text(hint);
            let field = ui.add(field.desired_width(f32::INFINITY));
            field.request_focus();
            if field.changed() {
                state.palette.row = 0;
            }
            // What the text means now: a quick hand types and presses Enter within one frame.
            let entries = entries(state);
            let row = &mut state.palette.row;
            *row = (*row + down).min(entries.len().saturating_sub(1)).saturating_sub(up);
            chosen = entries.get(*row).filter(|_| enter).map(|(_, entry)| entry.clone());
            // All of them have room.
            ScrollArea::vertical().max_height(420.0).min_scrolled_height(420.0).show(ui, |ui| {
                for (index, (name, entry)) in entries.iter().enumerate() {
                    if ui.selectable_label(index == *row, name).clicked() {
                        chosen = Some(entry.clone());
                    }
                }
                if entries.is_empty() {
                    ui.weak("nothing is called so");
                }
            });
        },
    );
    if let Some(entry) = chosen {
        state.palette = Palette::default();
        state.perform(entry);
    } else if escape {
        state.palette = Palette::default();
    }
}

fn is_path(entry: &Entry) -> bool {
    use Entry::{Path, SavePicture, SavePlot, SaveScene};
    matches!(entry, Path(_) | SaveScene(_) | SavePicture(_) | SavePlot(..))
}

/// What the text means: those whose names hold all its words.
fn entries(state: &State) -> Vec<(String, Entry)> {
    let text = state.palette.text.trim();
    let path = Path::new(text);
    let mut all = Vec::new();
    if !text.is_empty() && path.exists() {
        all.push((format!("Open {text}"), Entry::Path(path.to_owned())));
    }
    // Where there are no dialogs, this is the way to a file.
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("toml") => {
            all.push((format!("Save the scene as {text}"), Entry::SaveScene(path.to_owned())));
        }
        Some("exr" | "png") => {
            all.push((format!("Save the picture as {text}"), Entry::SavePicture(path.to_owned())));
        }
        Some("svg" | "csv") => all.extend(state.plots.views().into_iter().map(|view| {
            let plot = word(&view);
            (format!("Save the plot `{plot}` as {text}"), Entry::SavePlot(view, path.to_owned()))
        })),
        _ => {}
    }
    all.extend(Action::all().into_iter().map(|action| {
        let verb = if matches!(action, Action::Show(_)) { "Show: " } else { "" };
        (format!("{verb}{}", action.name()), Entry::Action(action))
    }));
    let lists = [
        ("BRDF", Kind::Brdf, &state.catalogue.brdfs),
        ("Integrator", Kind::Integrator, &state.catalogue.integrators),
    ];
    for (word, kind, list) in lists {
        for found in list {
            let name = found.plugin.as_ref().map_or(&found.id, |plugin| &plugin.manifest.name);
            all.push((format!("{word}: {name}"), Entry::Plugin(kind, found.id.clone())));
        }
    }
    let maps = &state.catalogue.maps;
    all.extend(maps.iter().map(|map| (format!("Environment: {map}"), Entry::Map(map.clone()))));
    all.extend(Shape::NAMES.map(|shape| (format!("Shape: {shape}"), Entry::Shape(shape))));
    let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
    let holds = |name: &str| words.iter().all(|word| name.to_lowercase().contains(word.as_str()));
    all.retain(|(name, entry)| is_path(entry) || holds(name));
    all.truncate(MOST);
    all
}

impl State {
    fn perform(&mut self, entry: Entry) {
        match entry {
            Entry::Action(action) => self.actions.push(action),
            Entry::Plugin(kind, id) => match Chosen::find(&self.registry, kind, &id) {
                Ok(chosen) if kind == Kind::Brdf => self.document.add(chosen),
                Ok(chosen) => self.document.session.integrator = chosen,
                Err(problem) => self.refused = Some(problem),
            },
            Entry::Map(map) => self.document.session.environment.set_map(map),
            Entry::Shape(shape) => shape.clone_into(&mut self.document.session.shape),
            Entry::Path(path) => self.open(&path),
            Entry::SaveScene(path) => {
                let done = self.save(&path);
                self.say(done);
            }
            Entry::SavePicture(path) => {
                let done = self.save_picture(&path);
                self.say(done);
            }
            Entry::SavePlot(view, path) => {
                let done = asked::save(self, view, &path);
                self.say(done);
            }
        }
    }
}
