//! Opening the window: what there is to draw it with, and what was left the last time.

use std::path::PathBuf;
use std::sync::Arc;

use brdf_sdk::{Problem, Result};
use eframe::{NativeOptions, Renderer};

use super::{Viewer, memory};
use crate::exec;
use crate::live::Document;
use crate::registry::Registry;
use crate::session::Session;

const TITLE: &str = "brdf";

/// What is open before there is a window.
pub struct Begin {
    /// The document.
    pub document: Document,
    /// Its scene's own file, if it has one.
    pub file: Option<PathBuf>,
    /// What could not be opened.
    pub problems: Vec<Problem>,
}

/// Opens the window on what is open, or on the scene as it was left, and returns when it is closed; pictures are
/// rendered on `device` as `--device` names it.
///
/// # Errors
/// Where there is no display or nothing to draw with; `brdf render` works without.
pub fn open(registry: Registry, begin: Option<Begin>, device: Option<String>) -> Result<()> {
    let last = begin.is_none();
    let Begin { document, file, problems } = match begin {
        Some(begin) => begin,
        None => Begin {
            document: Document::new(Session::new(&registry)?),
            file: None,
            problems: Vec::new(),
        },
    };
    // Where no adapter is, OpenGL may still be.
    let renderer = if exec::has_adapter() { Renderer::Wgpu } else { Renderer::Glow };
    let native = NativeOptions {
        renderer,
        viewport: egui::ViewportBuilder::default()
            .with_inner_size([1280.0, 720.0])
            .with_min_inner_size([640.0, 400.0])
            .with_title(TITLE)
            .with_app_id(TITLE),
        ..NativeOptions::default()
    };
    let made = move |context: &eframe::CreationContext<'_>| {
        let ctx = context.egui_ctx.clone();
        let wake = Arc::new(move || ctx.request_repaint());
        let mut viewer = Viewer::new(registry, document, device, memory::folder(), wake)?;
        viewer.set_up(&context.egui_ctx);
        viewer.begin_with(file, problems);
        if last {
            viewer.open_last();
        }
        Ok(Box::new(Window { viewer, ctx: context.egui_ctx.clone() }) as Box<dyn eframe::App>)
    };
    eframe::run_native(TITLE, native, Box::new(made)).map_err(|error| {
        Problem::new(
            "the window",
            format!("it cannot be opened ({})", plain(&error.to_string())),
            "check DISPLAY or WAYLAND_DISPLAY, install a Vulkan or OpenGL driver (on Debian: apt-get install \
             mesa-vulkan-drivers libgl1-mesa-dri), or render without a window: `brdf render`",
        )
    })
}

/// An error without the place in somebody's source.
fn plain(error: &str) -> &str {
    let begin = error.rfind(".rs:").and_then(|at| Some(at + error[at..].find(": ")? + 2));
    error[begin.unwrap_or(0)..].trim_end_matches([')', '.'])
}

/// The viewer in a window.
struct Window {
    viewer: Viewer,
    ctx: egui::Context,
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.viewer.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.ctx = ui.ctx().clone();
        self.viewer.ui(ui);
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.viewer.remember(&self.ctx);
    }
}
