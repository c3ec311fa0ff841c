//! Asking for files, beside the window's own work: an answer comes when it comes.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use brdf_sdk::{Problem, Result};
use egui::Context;
use rfd::{AsyncFileDialog, FileHandle};

use crate::plot::View;

/// What a file is for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Purpose {
    /// To open, whatever it is.
    Open,
    /// A plugin's folder to open.
    OpenFolder,
    /// Where to save the scene.
    SaveScene,
    /// Where to save the picture.
    SavePicture,
    /// Where to save a plot: a drawing or its numbers, by the ending.
    SavePlot(View),
    /// A picture to compare with.
    Reference,
    /// Another environment to compare with.
    OtherMap,
    /// The data of a parameter of the current BRDF.
    Data(String),
}

/// A file that was chosen, or why none could be.
type Answer = Result<(Purpose, PathBuf)>;

/// Whether the system has somebody to ask: elsewhere it always has; on Linux a portal on the session's bus, or zenity.
fn has_dialogs() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let bus = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some();
    let socket = std::env::var_os("XDG_RUNTIME_DIR")
        .is_some_and(|folder| PathBuf::from(folder).join("bus").exists());
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let zenity = std::env::split_paths(&folders).any(|folder| folder.join("zenity").exists());
    bus || socket || zenity
}

/// Dialogs that are open.
pub(super) struct Dialogs {
    sender: Sender<Answer>,
    answers: Receiver<Answer>,
}

impl Default for Dialogs {
    fn default() -> Self {
        let (sender, answers) = channel();
        Self { sender, answers }
    }
}

impl Dialogs {
    /// Opens a dialog. `endings` without the dot; none for any file.
    pub(super) fn ask(&self, ctx: &Context, purpose: Purpose, endings: &[String], name: &str) {
        if !has_dialogs() {
            let problem = Problem::new(
                "the dialog for files",
                "this system has none",
                "install zenity, or press Ctrl+P and type the path to open or to save at",
            );
            // The window may be gone.
            let _ = self.sender.send(Err(problem));
            ctx.request_repaint();
            return;
        }
        let dialog = AsyncFileDialog::new();
        let dialog = match endings.is_empty() {
            true => dialog,
            false => dialog.add_filter(endings.join(", "), endings),
        };
        let dialog = if name.is_empty() { dialog } else { dialog.set_file_name(name) };
        let sender = self.sender.clone();
        let ctx = ctx.clone();
        // Some systems want dialogs to be made where the window is, and waited for elsewhere.
        let answer: Box<dyn Future<Output = Vec<FileHandle>> + Send> = match &purpose {
            Purpose::Open => {
                let files = dialog.set_title("Open").pick_files();
                Box::new(async { files.await.unwrap_or_default() })
            }
            Purpose::Reference | Purpose::OtherMap | Purpose::Data(_) => {
                let file = dialog.set_title("Open").pick_file();
                Box::new(async { file.await.into_iter().collect() })
            }
            Purpose::OpenFolder => {
                let folder = dialog.set_title("Open a plugin's folder").pick_folder();
                Box::new(async { folder.await.into_iter().collect() })
            }
            Purpose::SaveScene | Purpose::SavePicture | Purpose::SavePlot(_) => {
                let file = dialog.set_title("Save").save_file();
                Box::new(async { file.await.into_iter().collect() })
            }
        };
        let answer = Box::into_pin(answer);
        std::thread::spawn(move || {
            for file in pollster::block_on(answer) {
                // The window may be gone.
                let _ = sender.send(Ok((purpose.clone(), file.path().to_owned())));
            }
            ctx.request_repaint();
        });
    }

    /// What was chosen since the last call.
    pub(super) fn answers(&self) -> Vec<Answer> {
        self.answers.try_iter().collect()
    }
}
