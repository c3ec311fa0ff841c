//! A new plugin: from the template, or a copy of what is open.

use std::path::PathBuf;

use brdf_sdk::{Kind, Result};
use egui::text::{CCursor, CCursorRange};
use egui::{TextEdit, Ui};

use super::menu::escaped;
use super::viewer::State;
use crate::template::{self, Texts};

/// The window that asks for it.
pub(super) struct Create {
    open: bool,
    /// Whether it has just been opened, so that its field wants the keys.
    fresh: bool,
    folder: String,
    from: From,
}

impl Default for Create {
    fn default() -> Self {
        let folder = "my-brdf".to_owned();
        Self { open: false, fresh: false, folder, from: From::Template(Kind::Brdf) }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum From {
    Template(Kind),
    /// The current BRDF.
    Copy,
}

impl Create {
    pub(super) fn open(&mut self) {
        (self.open, self.fresh) = (true, true);
        self.folder = free(&self.folder);
    }

    /// Asks for a copy of the current BRDF.
    pub(super) fn copy(&mut self, id: &str) {
        (self.open, self.fresh, self.from) = (true, true, From::Copy);
        self.folder = free(&format!("my-{id}"));
    }
}

/// The name, or the first one with a number behind it that nothing has.
fn free(name: &str) -> String {
    let numbered = |number: u32| format!("{name}-{number}");
    let mut names = std::iter::once(name.to_owned()).chain((2..).map(numbered));
    names.find(|name| !std::path::Path::new(name).exists()).unwrap_or_default()
}

pub(super) fn create_ui(ui: &mut Ui, state: &mut State) {
    if !state.create.open {
        return;
    }
    let mut open = !escaped(ui.ctx());
    let mut made = None;
    let current = state.document.current().chosen.name().to_owned();
    let window = egui::Window::new("New plugin").open(&mut open).resizable(false);
    let window = window.anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]);
    window.show(ui.ctx(), |ui| {
        let Create { folder, from, fresh, .. } = &mut state.create;
        let mut enter = false;
        for (choice, words) in [
            (From::Template(Kind::Brdf), "a BRDF from the template".to_owned()),
            (From::Template(Kind::Integrator), "an integrator from the template".to_owned()),
            (From::Copy, format!("a copy of {current}")),
        ] {
            ui.radio_value(from, choice, words);
        }
        ui.horizontal(|ui| {
            let label = ui.label("folder");
            let mut shown = TextEdit::singleline(folder).desired_width(260.0).show(ui);
            let field = shown.response.response.labelled_by(label.id);
            let field = field.on_hover_text("Its last part names the plugin.");
            if std::mem::take(fresh) {
                field.request_focus();
                // Who types another name need not delete this one first.
                let ends = [0, folder.chars().count()].map(CCursor::new);
                shown.state.cursor.set_char_range(Some(CCursorRange::two(ends[0], ends[1])));
                shown.state.store(ui.ctx(), field.id);
            }
            enter = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        });
        if let Ok(here) = std::env::current_dir() {
            ui.small(here.join(&*folder).display().to_string());
        }
        if ui.button("make").clicked() || enter {
            made = Some((*from, PathBuf::from(&*folder)));
        }
    });
    state.create.open = open;
    if let Some((from, folder)) = made {
        match state.make(from, &folder) {
            Ok(()) => {
                state.create.open = false;
                state.open(&folder);
            }
            Err(problem) => {
                // The field has the keys again, for another name.
                state.create.fresh = true;
                state.refused = Some(problem);
            }
        }
    }
}

impl State {
    fn make(&self, from: From, folder: &std::path::Path) -> Result<()> {
        let texts = match from {
            From::Template(kind) => Texts::template(kind, folder),
            From::Copy => {
                let chosen = &self.document.current().chosen;
                let id = &chosen.configured.plugin.id;
                self.registry.texts(Kind::Brdf, id, chosen.folder.as_deref())?
            }
        };
        template::make(&texts, folder)
    }
}
