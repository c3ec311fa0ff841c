//! What can be done by a menu, by a key, or by its name: one list for all three.

use std::path::Path;

use brdf_sdk::{Problem, Result};
use egui::{Context, Key, KeyboardShortcut, Modifiers};
use egui_tiles::Tree;

use super::files::Purpose;
use super::layout::{self, Pane};
use super::viewer::State;
use crate::picture;
use crate::session::{render_command, shell_quoted};

/// Something to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    New,
    Open,
    OpenFolder,
    Save,
    SaveAs,
    SavePicture,
    CopyCommand,
    Quit,
    Undo,
    Redo,
    Show(Pane),
    ResetLayout,
    Palette,
    Shortcuts,
    About,
}

impl Action {
    /// All, in the order of the menus.
    pub(super) fn all() -> Vec<Self> {
        let mut all = vec![
            Self::New,
            Self::Open,
            Self::OpenFolder,
            Self::Save,
            Self::SaveAs,
            Self::SavePicture,
            Self::CopyCommand,
            Self::Quit,
            Self::Undo,
            Self::Redo,
        ];
        all.extend(Pane::all().into_iter().map(Self::Show));
        all.extend([Self::ResetLayout, Self::Palette, Self::Shortcuts, Self::About]);
        all
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::New => "New plugin…",
            Self::Open => "Open a file…",
            Self::OpenFolder => "Open a plugin's folder…",
            Self::Save => "Save the scene",
            Self::SaveAs => "Save the scene as…",
            Self::SavePicture => "Save the picture…",
            Self::CopyCommand => "Copy the `brdf render` command",
            Self::Quit => "Quit",
            Self::Undo => "Undo",
            Self::Redo => "Redo",
            Self::Show(pane) => pane.title(),
            Self::ResetLayout => "Views back to their places",
            Self::Palette => "Find anything by its name",
            Self::Shortcuts => "Keys",
            Self::About => "About",
        }
    }

    /// Its key.
    pub(super) fn shortcut(self) -> Option<KeyboardShortcut> {
        let with = |modifiers: Modifiers, key: Key| Some(KeyboardShortcut::new(modifiers, key));
        let shifted = Modifiers::COMMAND | Modifiers::SHIFT;
        match self {
            Self::New => with(Modifiers::COMMAND, Key::N),
            Self::Open => with(Modifiers::COMMAND, Key::O),
            Self::OpenFolder => with(shifted, Key::O),
            Self::Save => with(Modifiers::COMMAND, Key::S),
            Self::SaveAs => with(shifted, Key::S),
            Self::SavePicture => with(Modifiers::COMMAND, Key::E),
            Self::CopyCommand => with(shifted, Key::C),
            Self::Quit => with(Modifiers::COMMAND, Key::Q),
            Self::Undo => with(Modifiers::COMMAND, Key::Z),
            Self::Redo => with(shifted, Key::Z),
            Self::Palette => with(Modifiers::COMMAND, Key::P),
            Self::Shortcuts => with(Modifiers::NONE, Key::F1),
            Self::Show(pane) => {
                let keys = [
                    Key::Num1,
                    Key::Num2,
                    Key::Num3,
                    Key::Num4,
                    Key::Num5,
                    Key::Num6,
                    Key::Num7,
                    Key::Num8,
                    Key::Num9,
                    Key::Num0,
                ];
                let index = Pane::all().iter().position(|other| *other == pane)?;
                with(Modifiers::COMMAND, *keys.get(index)?)
            }
            Self::ResetLayout | Self::About => None,
        }
    }

    /// Those whose keys were pressed; the longer of two that begin alike comes first.
    pub(super) fn pressed(ctx: &Context, in_editor: bool) -> Vec<Self> {
        let mut all = Self::all();
        all.sort_by_key(|action| {
            action.shortcut().is_none_or(|shortcut| !shortcut.modifiers.shift)
        });
        let typing = ctx.egui_wants_keyboard_input();
        let mut pressed: Vec<Self> = all
            .into_iter()
            // Fields of text have an undo of their own.
            .filter(|action| !typing || !matches!(action, Self::Undo | Self::Redo))
            // It saves its own file.
            .filter(|action| !in_editor || *action != Self::Save)
            .filter(|action| {
                let shortcut = action.shortcut();
                shortcut.is_some_and(|s| ctx.input_mut(|input| input.consume_shortcut(&s)))
            })
            .collect();
        let question =
            |event: &egui::Event| matches!(event, egui::Event::Text(text) if text == "?");
        if !typing && ctx.input(|input| input.events.iter().any(question)) {
            pressed.push(Self::Shortcuts);
        }
        pressed
    }

    pub(super) fn perform(self, ctx: &Context, state: &mut State, tree: &mut Tree<Pane>) {
        match self {
            Self::New => state.create.open(),
            Self::Open => state.dialogs.ask(ctx, Purpose::Open, &[], ""),
            Self::OpenFolder => state.dialogs.ask(ctx, Purpose::OpenFolder, &[], ""),
            Self::Save => match state.file.clone() {
                Some(file) => {
                    let done = state.save(&file);
                    state.say(done);
                }
                None => Self::SaveAs.perform(ctx, state, tree),
            },
            Self::SaveAs => {
                state.dialogs.ask(ctx, Purpose::SaveScene, &["toml".to_owned()], "scene.toml");
            }
            Self::SavePicture => {
                let name = format!("{}.exr", state.document.current().chosen.name());
                state.dialogs.ask(ctx, Purpose::SavePicture, &["exr".to_owned()], &name);
            }
            Self::CopyCommand => {
                let words = render_command(&state.document.scene());
                let words: Vec<String> = words.iter().map(|word| shell_quoted(word)).collect();
                let command = format!("brdf {}", words.join(" "));
                ctx.copy_text(command.clone());
                state.message = format!("copied {command}");
            }
            Self::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Self::Undo => match state.history.undo(&mut state.document) {
                true => {
                    state.reload();
                    state.say(Ok("undone".to_owned()));
                }
                false => "nothing to undo".clone_into(&mut state.message),
            },
            Self::Redo => match state.history.redo(&mut state.document) {
                true => {
                    state.reload();
                    state.say(Ok("redone".to_owned()));
                }
                false => "nothing to redo".clone_into(&mut state.message),
            },
            Self::Show(pane) => layout::show(tree, pane),
            Self::ResetLayout => *tree = layout::usual(),
            Self::Palette => state.palette.toggle(),
            Self::About => state.about_open = !state.about_open,
            Self::Shortcuts => state.shortcuts_open = !state.shortcuts_open,
        }
    }
}

impl State {
    /// Tells what became of something; what could not be done is told until something else is.
    pub(super) fn say(&mut self, done: Result<String>) {
        match done {
            Ok(message) => {
                self.refused = None;
                self.message = message;
            }
            Err(problem) => self.refused = Some(problem),
        }
    }

    /// Saves the scene.
    pub(super) fn save(&mut self, path: &Path) -> Result<String> {
        let folder = path.parent().unwrap_or(Path::new(""));
        picture::write_text(path, &self.document.scene().to_toml_in(folder))?;
        self.file = Some(path.to_owned());
        Ok(format!("wrote {}", path.display()))
    }

    /// Saves the picture as it is now, as EXR with its scene and as PNG.
    pub(super) fn save_picture(&self, path: &Path) -> Result<String> {
        let shown = path.display().to_string();
        let Some(frame) = self.status.frame.as_ref().filter(|frame| !frame.preview) else {
            return Err(Problem::new(shown, "there is no picture yet", "wait a moment"));
        };
        let exr = picture::with_ending(path, "exr");
        let png = picture::with_ending(path, "png");
        let facts = vec![
            ("brdf.samples_done".to_owned(), frame.done.to_string()),
            ("brdf.device".to_owned(), self.status.device.clone()),
        ];
        let tone = self.document.session.film.tone;
        let staged = [
            picture::stage_exr(&exr, &frame.picture, &frame.session.to_toml(), &facts)?,
            picture::stage_png(&png, &frame.picture, tone)?,
        ];
        staged.into_iter().try_for_each(picture::Staged::keep)?;
        Ok(format!("wrote {} and {}", exr.display(), png.display()))
    }
}
