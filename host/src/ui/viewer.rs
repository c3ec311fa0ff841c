//! The viewer: what is open, what runs behind it, and the order of things in a frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use brdf_sdk::{Kind, Problem, Result};
use egui::{CentralPanel, Context, Panel, Ui};
use egui_tiles::Tree;

use super::actions::Action;
use super::beside::Source;
use super::files::{Dialogs, Purpose};
use super::layout::{self, Pane};
use super::memory::Memory;
use super::palette::{self, Palette};
use super::{
    asked, compare, convergence, create, editor, environment, lit, lobe, materials, menu, plots,
    problems, proofs, slices,
};
use crate::live::{
    Desk, Document, Follow, History, Live, Opened, Order, Saved, Status, Timing, Wake,
};
use crate::open;
use crate::plot::View;
use crate::plugin::Configured;
use crate::registry::{Found, Registry};
use crate::session::{Chosen, Session};

/// The window's content; it needs no window.
pub struct Viewer {
    tree: Tree<Pane>,
    state: State,
}

/// Everything but where views lie.
pub(super) struct State {
    pub registry: Registry,
    pub catalogue: Catalogue,
    /// The integrator that albedos are made with.
    pub by_samples: Configured,
    pub document: Document,
    pub history: History<Document>,
    pub live: Live,
    pub desk: Desk,
    /// For what takes seconds.
    pub slow: Desk,
    pub dialogs: Dialogs,
    pub status: Status,
    /// What is wrong with files that were read.
    pub problems: Vec<Problem>,
    /// What was asked for last and could not be done; told until something else was done.
    pub refused: Option<Problem>,
    /// The newest thing worth a line.
    pub message: String,
    /// Where the scene was last saved.
    pub file: Option<PathBuf>,
    /// What shall be done at the end of this frame.
    pub actions: Vec<Action>,
    pub shortcuts_open: bool,
    pub about_open: bool,
    pub palette: Palette,
    pub memory: Memory,
    pub lit: lit::Look,
    pub plots: asked::Plots,
    pub slices: slices::Slices,
    pub lobe: lobe::Lobe,
    pub sky: environment::Sky,
    pub compare: compare::Compare,
    pub proofs: proofs::Proofs,
    pub editor: editor::Editor,
    pub create: create::Create,
    pub convergence: convergence::Convergence,
    /// Where pictures are rendered, as `--device` names it.
    pub device: Option<String>,
    pub wake: Wake,
    follow: Follow,
    /// The scene that is being rendered, and what shows its plugins' files.
    ordered: Option<Session>,
    /// When the files that the next order follows were saved.
    saved: Option<SystemTime>,
    told: Option<Timing>,
}

/// What there is to choose from.
pub(super) struct Catalogue {
    pub brdfs: Vec<Found>,
    pub integrators: Vec<Found>,
    pub maps: Vec<String>,
}

impl Catalogue {
    fn new(registry: &Registry) -> Self {
        Self {
            brdfs: registry.all(Kind::Brdf),
            integrators: registry.all(Kind::Integrator),
            maps: registry.recipes().into_iter().map(|(name, _)| name).collect(),
        }
    }
}

/// The views, as the tree of tabs draws them.
pub(super) struct Views<'a> {
    state: &'a mut State,
}

impl Views<'_> {
    pub(super) fn view_ui(&mut self, ui: &mut Ui, pane: Pane) {
        match pane {
            Pane::Lit => lit::lit_ui(ui, self.state),
            Pane::Convergence => convergence::convergence_ui(ui, self.state),
            Pane::Plot(View::Slice) => slices::slices_ui(ui, self.state),
            Pane::Plot(View::Lobe) => lobe::lobe_ui(ui, self.state),
            Pane::Plot(view) => plots::plot_ui(ui, self.state, view),
            Pane::Compare => compare::compare_ui(ui, self.state),
            Pane::Editor => editor::editor_ui(ui, self.state),
            Pane::Sampling => proofs::sampling_ui(ui, self.state),
            Pane::Numerics => proofs::numerics_ui(ui, self.state),
            Pane::Environment => environment::sky_ui(ui, self.state),
        }
    }
}

impl Viewer {
    /// A viewer of what is open, rendered on `device` as `--device` names it, that remembers itself in `folder`, or not at
    /// all. `wake` is called from other threads where the window shall be drawn again.
    ///
    /// # Errors
    /// Where a thread cannot be started.
    pub fn new(
        registry: Registry,
        document: Document,
        device: Option<String>,
        folder: Option<PathBuf>,
        wake: Wake,
    ) -> Result<Self> {
        let by_samples = Chosen::by_samples(&registry)?.configured;
        let live = Live::start(registry.clone(), device.clone(), Arc::clone(&wake))?;
        let heard = live.make_room();
        let desk = || Desk::start(Arc::clone(&wake), live.precedence());
        let state = State {
            catalogue: Catalogue::new(&registry),
            by_samples,
            history: History::new(&document),
            document,
            desk: desk()?,
            slow: desk()?,
            live,
            dialogs: Dialogs::default(),
            status: Status::default(),
            problems: Vec::new(),
            refused: None,
            message: String::new(),
            file: None,
            actions: Vec::new(),
            shortcuts_open: false,
            about_open: false,
            palette: Palette::default(),
            memory: Memory::new(folder),
            lit: lit::Look::default(),
            plots: asked::Plots::default(),
            slices: slices::Slices::default(),
            lobe: lobe::Lobe::default(),
            sky: environment::Sky::default(),
            compare: compare::Compare::default(),
            proofs: proofs::Proofs::default(),
            editor: editor::Editor::default(),
            create: create::Create::default(),
            convergence: convergence::Convergence::default(),
            device,
            wake: Arc::clone(&wake),
            follow: Follow::start(wake, heard)?,
            ordered: None,
            saved: None,
            told: None,
            registry,
        };
        let tree = layout::from_text(state.memory.layout()).unwrap_or_else(layout::usual);
        Ok(Self { tree, state })
    }

    /// What was opened before there was a window: the file of its scene, and what could not be opened.
    pub fn begin_with(&mut self, file: Option<PathBuf>, problems: Vec<Problem>) {
        (self.state.file, self.state.problems) = (file, problems);
    }

    /// Opens what lies at a path, whatever it is.
    pub fn open(&mut self, path: &Path) {
        self.state.open(path);
    }

    /// Opens the scene as it was left the last time, if it can still be opened.
    pub fn open_last(&mut self) {
        if let Some(path) = self.state.memory.scene()
            && let Ok(session) = open::session(&self.state.registry, &path)
        {
            self.state.document = Document::new(session);
        }
    }

    /// The theme that was chosen the last time.
    pub fn set_up(&self, ctx: &Context) {
        if let Some(theme) = self.state.memory.theme() {
            ctx.set_theme(theme);
        }
    }

    /// Writes down what shall be there the next time.
    pub fn remember(&mut self, ctx: &Context) {
        let scene = self.state.document.scene().to_toml();
        let theme = ctx.options(|options| options.theme_preference);
        if let Err(problem) = self.state.memory.keep(scene, layout::to_text(&self.tree), theme) {
            self.state.message = problem.line();
        }
    }

    /// The scene as it is now.
    pub fn scene(&self) -> Session {
        self.state.document.scene()
    }

    /// What is rendered, and how far it is.
    pub fn status(&self) -> Status {
        self.state.live.status()
    }

    /// Whether an answer of another thread is still to come.
    pub fn is_waiting(&self) -> bool {
        let state = &self.state;
        let drawn = state.status.frame.as_ref().is_some_and(|frame| frame.complete);
        !drawn
            || state.plots.is_waiting()
            || state.lobe.is_waiting()
            || state.sky.is_waiting()
            || state.compare.is_waiting()
            || state.proofs.is_waiting()
    }

    /// What has happened since the last frame: answers of other threads, files that were saved or dropped, keys.
    pub fn logic(&mut self, ctx: &Context) {
        let state = &mut self.state;
        state.status = state.live.status();
        state.note_convergence();
        state.tell_timing();
        state.take_saved();
        for answer in state.dialogs.answers() {
            match answer {
                Ok((purpose, path)) => state.answer(&purpose, &path),
                Err(problem) => state.refused = Some(problem),
            }
        }
        state.keep_from_closing(ctx);
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in &dropped {
            state.open(file.path());
        }
        state.palette.take_keys(ctx);
        let in_editor = std::mem::take(&mut state.editor.takes_save);
        state.actions.extend(Action::pressed(ctx, in_editor));
    }

    /// Draws everything, and gives the orders that follow.
    pub fn ui(&mut self, ui: &mut Ui) {
        let state = &mut self.state;
        Panel::top("menu").show(ui, |ui| menu::menu_ui(ui, state));
        Panel::bottom("message").show(ui, |ui| menu::message_ui(ui, state));
        if problems::any(state) {
            Panel::bottom("problems").resizable(true).default_size(150.0).show(ui, |ui| {
                problems::problems_ui(ui, state);
            });
        } else {
            // What is drawn below keeps its ids: a slider stays in the hand while the panel comes or goes.
            ui.skip_ahead_auto_ids(1);
        }
        Panel::left("materials").resizable(true).default_size(320.0).show(ui, |ui| {
            materials::materials_ui(ui, state);
        });
        let mut views = Views { state: &mut *state };
        CentralPanel::no_frame().show(ui, |ui| self.tree.ui(&mut views, ui));
        menu::shortcuts_ui(ui.ctx(), state);
        menu::about_ui(ui.ctx(), state);
        palette::palette_ui(ui, state);
        create::create_ui(ui, state);
        editor::leaving_ui(ui, state);
        for action in std::mem::take(&mut state.actions) {
            action.perform(ui.ctx(), state, &mut self.tree);
        }
        state.finish(ui.ctx());
        if self.state.memory.is_due() && !ui.ctx().input(|input| input.pointer.any_down()) {
            self.remember(ui.ctx());
        }
    }
}

impl State {
    /// Ends a frame: a step of undo where nothing is held any more, and what files and pictures follow.
    fn finish(&mut self, ctx: &Context) {
        let held = ctx.input(|input| input.pointer.any_down());
        self.live.interact(held);
        self.compare.interact(held);
        if !held {
            self.history.settle(&self.document);
        }
        let [mut folders, files] = self.document.files();
        folders.extend(self.registry.folders());
        self.follow.set(folders, files);
        self.order();
    }

    /// The order for what has changed.
    fn order(&mut self) {
        // What only the screen shows makes no other picture.
        let scene = self.document.scene().bare();
        if self.ordered.as_ref() != Some(&scene) {
            let mut order = Order::new(self.document.scene());
            order.saved = self.saved.take();
            self.live.show(order);
            self.ordered = Some(scene);
        }
    }

    /// Opens what lies at a path, and says so.
    pub(super) fn open(&mut self, path: &Path) {
        match self.document.open(&self.registry, path) {
            Ok(Opened { said, scene }) => {
                self.problems.clear();
                self.memory.opened(path);
                self.say(Ok(said));
                // Another scene is not written over the file of the one before.
                if let Some(file) = scene {
                    self.file = file;
                }
            }
            Err(problem) => self.refused = Some(problem),
        }
    }

    /// Reads the plugins again after their files were saved, or may have been.
    fn take_saved(&mut self) {
        let saved = self.follow.saved();
        if saved.is_empty() {
            return;
        }
        // What was changed by hand before is a step of its own.
        self.history.settle(&self.document);
        let told = std::mem::take(&mut self.problems);
        self.reload();
        self.catalogue = Catalogue::new(&self.registry);
        let times = saved.into_iter().filter_map(|saved| match saved {
            Saved::At(time) => Some(time),
            Saved::Perhaps => None,
        });
        match times.max() {
            Some(newest) => (self.saved, self.refused) = (Some(newest), None),
            // Nobody has mended anything.
            None => self.problems.extend(told),
        }
        // It is not kept waiting for this frame's drawing.
        self.order();
    }

    /// Reads the plugins again: those of an earlier step may be older than their files. What files change is no step.
    pub(super) fn reload(&mut self) {
        self.problems = self.document.reload(&self.registry);
        self.problems.extend(self.compare.reload(&self.registry).err());
        self.history.absorb(&self.document);
    }

    /// How long a saved file took to be seen, in the log.
    fn tell_timing(&mut self) {
        if self.status.timing != self.told
            && let Some(Timing { link, compile, first_pixel, saved }) = self.status.timing
        {
            self.told = self.status.timing;
            if !saved {
                return;
            }
            let ms = |seconds: f64| format!("{:.0} ms", seconds * 1e3);
            self.message = format!(
                "reloaded: first pixel {} after the save (link {}, compile {})",
                ms(first_pixel),
                ms(link),
                ms(compile)
            );
            eprintln!("{}", self.message);
        }
    }

    fn answer(&mut self, purpose: &Purpose, path: &Path) {
        let done = match purpose {
            Purpose::Open | Purpose::OpenFolder => {
                self.open(path);
                return;
            }
            Purpose::Reference => self.compare_with(path),
            Purpose::OtherMap => {
                let map = path.display().to_string();
                self.compare.take(Source::Map(map.clone()));
                Ok(format!("comparing with the light of {map}"))
            }
            Purpose::SaveScene => self.save(path),
            Purpose::SavePicture => self.save_picture(path),
            Purpose::SavePlot(view) => asked::save(self, *view, path),
            Purpose::Data(key) => {
                let path = path.display().to_string();
                let current = self.document.current;
                if let Some(material) = self.document.materials.get_mut(current) {
                    let values = &mut material.chosen.configured.values;
                    values.set(key, brdf_sdk::ParamValue::File(path.clone()));
                }
                Ok(format!("reading {path}"))
            }
        };
        self.say(done);
    }
}
