//! Asking for files, beside the window's own work: an answer comes when it comes.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

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

/// Dialogs that are open.
pub(super) struct Dialogs {
    sender: Sender<(Purpose, PathBuf)>,
    answers: Receiver<(Purpose, PathBuf)>,
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
                let _ = sender.send((purpose.clone(), file.path().to_owned()));
            }
            ctx.request_repaint();
        });
    }

    /// What was chosen since the last call.
    pub(super) fn answers(&self) -> Vec<(Purpose, PathBuf)> {
        self.answers.try_iter().collect()
    }
}
