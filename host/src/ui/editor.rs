//! The current BRDF's text, for small edits; saving writes the same file that any editor would.

use std::path::PathBuf;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Problem, Result};
use egui::{Key, KeyboardShortcut, Modifiers, ScrollArea, TextEdit, Ui, ViewportCommand};
use egui_extras::syntax_highlighting::{CodeTheme, highlight};

use super::viewer::State;
use crate::picture::write_text;

/// What is edited.
#[derive(Default)]
pub(super) struct Editor {
    /// Those that were looked at: what is written in one of them stays while another one is shown.
    files: Vec<File>,
    /// Whether somebody wants to leave while something is not saved, and whether they shall.
    leaving: bool,
    left: bool,
    manifest: bool,
    /// Whether Ctrl+S is its own in the next frame: its text has the keys, or is seen and not saved.
    pub takes_save: bool,
}

struct File {
    path: PathBuf,
    text: String,
    /// As it lies on disk.
    saved: String,
}

pub(super) fn editor_ui(ui: &mut Ui, state: &mut State) {
    let chosen = &state.document.current().chosen;
    let plugin = &chosen.configured.plugin;
    let Some(folder) = chosen.folder.clone() else {
        let id = plugin.id.clone();
        ui.label(format!("{id} is a part of the program."));
        if ui.button("make a copy to edit…").clicked() {
            state.create.copy(&id);
        }
        return;
    };
    let wgsl = plugin.manifest.wgsl.clone();
    let mut save = false;
    // A file of BRDF Explorer is a plugin by itself.
    let path = if folder.is_file() {
        state.editor.manifest = false;
        ui.label(folder.display().to_string());
        folder
    } else {
        ui.horizontal_wrapped(|ui| {
            ui.selectable_value(&mut state.editor.manifest, false, &wgsl);
            ui.selectable_value(&mut state.editor.manifest, true, MANIFEST_FILE);
        });
        folder.join(if state.editor.manifest { MANIFEST_FILE } else { &wgsl })
    };
    let on_disk = std::fs::read_to_string(&path);
    let known = state.editor.files.iter().position(|file| file.path == path);
    let file = match (known, on_disk) {
        (Some(index), on_disk) => {
            let file = &mut state.editor.files[index];
            // Another editor's changes come in as long as there are none here.
            if let Ok(text) = on_disk
                && text != file.saved
            {
                if file.text == file.saved {
                    file.text.clone_from(&text);
                }
                file.saved = text;
            }
            file
        }
        (None, Ok(text)) => {
            state.editor.files.push(File { path, text: text.clone(), saved: text });
            let last = state.editor.files.len() - 1;
            &mut state.editor.files[last]
        }
        (None, Err(error)) => {
            ui.label(format!("{}: {error}", path.display()));
            return;
        }
    };
    let changed = file.is_changed();
    ui.horizontal(|ui| {
        save = ui.add_enabled(changed, egui::Button::new("save")).clicked();
        if ui.add_enabled(changed, egui::Button::new("as on disk")).clicked() {
            file.text.clone_from(&file.saved);
        }
        ui.label(if changed { "changed; Ctrl+S saves" } else { "as on disk" });
    });
    let language = if state.editor.manifest { "toml" } else { "rs" };
    let theme = CodeTheme::from_memory(ui.ctx(), ui.style());
    let mut layouter = |ui: &Ui, text: &dyn egui::TextBuffer, width: f32| {
        let mut job = highlight(ui.ctx(), ui.style(), &theme, text.as_str(), language);
        job.wrap.max_width = width;
        ui.fonts_mut(|fonts| fonts.layout_job(job))
    };
    let mut focused = false;
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        let field = TextEdit::multiline(&mut file.text)
            .id_salt("editor")
            .code_editor()
            .desired_width(f32::INFINITY)
            .desired_rows(20)
            .layouter(&mut layouter);
        focused = ui.add(field).has_focus();
    });
    let takes_save = focused || file.is_changed();
    let key = KeyboardShortcut::new(Modifiers::COMMAND, Key::S);
    save |= takes_save && ui.input_mut(|input| input.consume_shortcut(&key));
    let written = save.then(|| write(file));
    state.editor.takes_save = takes_save;
    if let Some(done) = written {
        state.say(done);
    }
}

impl State {
    /// Asks before a window is closed over what is not saved.
    pub(super) fn keep_from_closing(&mut self, ctx: &egui::Context) {
        let wanted = ctx.input(|input| input.viewport().close_requested());
        let changed = self.editor.files.iter().any(File::is_changed);
        if wanted && changed && !self.editor.left {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.editor.leaving = true;
        }
    }
}

/// What becomes of texts that are not saved, when the window shall close.
pub(super) fn leaving_ui(ui: &Ui, state: &mut State) {
    if !state.editor.leaving {
        return;
    }
    let changed = state.editor.files.iter().filter(|file| file.is_changed());
    let names: Vec<String> = changed.map(|file| file.path.display().to_string()).collect();
    let (mut save, mut leave) = (false, false);
    let answered = egui::Modal::new(egui::Id::unique("leaving")).show(ui.ctx(), |ui| {
        ui.strong("Not saved yet:");
        names.iter().for_each(|name| {
            ui.label(name);
        });
        ui.horizontal(|ui| {
            save = ui.button("save and quit").clicked();
            leave = ui.button("quit without").clicked();
            ui.button("go on").clicked()
        })
        .inner
    });
    if save {
        let texts = state.editor.files.iter_mut().filter(|file| file.is_changed());
        let written: Result<Vec<String>> = texts.map(write).collect();
        leave = written.is_ok();
        if let Err(problem) = written {
            state.refused = Some(problem);
        }
    }
    if leave {
        state.editor.left = true;
        ui.ctx().send_viewport_cmd(ViewportCommand::Close);
    }
    state.editor.leaving = !(save || leave || answered.inner || answered.should_close());
}

impl File {
    fn is_changed(&self) -> bool {
        self.text != self.saved
    }
}

/// Writes the file, whole or not at all.
fn write(file: &mut File) -> Result<String> {
    write_text(&file.path, &file.text).map_err(|problem| Problem {
        cure: "what you wrote is still here".to_owned(),
        ..problem
    })?;
    file.saved.clone_from(&file.text);
    Ok(format!("saved {}", file.path.display()))
}
