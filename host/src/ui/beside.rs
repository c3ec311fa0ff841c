//! What stands beside the lit object, and how it is chosen: another BRDF, other parameters, another integrator, another
//! environment, a picture that was held, or one from a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use egui::{CollapsingHeader, ScrollArea, Ui};

use super::files::Purpose;
use super::parameters::parameters_ui;
use super::parts::{file_name, named};
use super::viewer::State;
use crate::live::{Frame, fresh_number};
use crate::picture::read::{Stored, read};
use crate::registry::Registry;
use crate::session::{Chosen, Session};

#[derive(Default)]
pub(super) enum Source {
    /// Nothing yet.
    #[default]
    None,
    /// Another BRDF that is open, by its colour: its place changes when one before it is closed.
    Material(usize),
    /// A BRDF with parameters of its own.
    Values(Box<Chosen>),
    /// Another integrator.
    Integrator(Box<Chosen>),
    /// Another environment.
    Map(String),
    /// A picture as it was.
    Held(Arc<Frame>),
    /// A picture from a file.
    File(PathBuf, Arc<Still>),
}

/// A picture that does not change any more.
pub(super) struct Still {
    number: u64,
    resolution: [u32; 2],
    rgb: Vec<[f32; 3]>,
}

/// One of the two pictures.
#[derive(Clone)]
pub(super) enum Side {
    Rendered(Arc<Frame>),
    Read(Arc<Still>),
}

impl Side {
    /// No other picture has it.
    pub(super) fn number(&self) -> u64 {
        match self {
            Self::Rendered(frame) => frame.number,
            Self::Read(still) => still.number,
        }
    }

    /// Width and height.
    pub(super) fn resolution(&self) -> [u32; 2] {
        match self {
            Self::Rendered(frame) => frame.picture.resolution,
            Self::Read(still) => still.resolution,
        }
    }

    /// How far it is, where it is rendered.
    pub(super) fn samples(&self) -> Option<String> {
        match self {
            Self::Rendered(frame) if frame.sum => Some(format!("{} texels", frame.done)),
            Self::Rendered(frame) => Some(format!("{} spp", frame.done)),
            Self::Read(_) => None,
        }
    }

    /// Radiance, row by row from the top.
    pub(super) fn rgb(&self) -> &[[f32; 3]] {
        match self {
            Self::Rendered(frame) => &frame.picture.rgb,
            Self::Read(still) => &still.rgb,
        }
    }
}

impl Source {
    /// Whether it is a scene that is rendered beside the lit object.
    pub(super) fn is_live(&self) -> bool {
        matches!(self, Self::Material(_) | Self::Values(_) | Self::Integrator(_) | Self::Map(_))
    }

    /// The picture, where `rendered` is the newest one of the other scene.
    pub(super) fn side(&self, rendered: Option<Arc<Frame>>) -> Option<Side> {
        match self {
            Self::None => None,
            Self::Held(frame) => Some(Side::Rendered(Arc::clone(frame))),
            Self::File(_, still) => Some(Side::Read(Arc::clone(still))),
            _ => rendered.map(Side::Rendered),
        }
    }

    /// Reads the plugin again that it names.
    pub(super) fn reload(&mut self, registry: &Registry) -> Result<()> {
        if let Self::Integrator(chosen) | Self::Values(chosen) = self {
            **chosen = chosen.reload(registry)?;
        }
        Ok(())
    }

    fn words(&self, state: &State) -> String {
        match self {
            Self::None => "beside…".to_owned(),
            Self::Material(pen) => {
                let material = state.document.with_pen(*pen);
                material.map_or(String::new(), |material| material.chosen.name().to_owned())
            }
            Self::Values(chosen) => format!("{}, other parameters", chosen.name()),
            Self::Integrator(chosen) => chosen.configured.plugin.manifest.name.clone(),
            Self::Map(map) => file_name(map),
            Self::Held(_) => "the held picture".to_owned(),
            Self::File(path, _) => file_name(&path.to_string_lossy()),
        }
    }
}

/// The scene of the lit object with what is other in it; nothing where no scene is rendered beside.
pub(super) fn scene(state: &mut State) -> Option<Session> {
    let mut scene = state.document.scene();
    match &state.compare.source {
        Source::Material(pen) => match state.document.with_pen(*pen) {
            Some(material) => scene.brdf = material.chosen.clone(),
            None => {
                // It was closed.
                state.compare.source = Source::None;
                return None;
            }
        },
        Source::Values(chosen) => scene.brdf = (**chosen).clone(),
        Source::Integrator(chosen) => scene.integrator = (**chosen).clone(),
        Source::Map(map) => scene.environment.set_map(map.clone()),
        Source::None | Source::Held(_) | Source::File(..) => return None,
    }
    Some(scene.bare())
}

/// The list of all that can stand beside.
pub(super) fn choices_ui(ui: &mut Ui, state: &mut State) {
    let words = state.compare.source.words(state);
    let mut wanted = None;
    // High enough for the whole list.
    let combo =
        egui::ComboBox::from_id_salt("beside").width(150.0).height(520.0).selected_text(words);
    let shown = combo.show_ui(ui, |ui| wanted = list_ui(ui, state));
    named(&shown.response, "Beside");
    let hold =
        ui.button("hold this picture").on_hover_text("Compare with the picture as it is now.");
    if hold.clicked()
        && let Some(frame) = state.status.frame.as_ref().filter(|frame| !frame.preview)
    {
        wanted = Some(Source::Held(Arc::clone(frame)));
    }
    if let Some(wanted) = wanted {
        state.compare.take(wanted);
    }
}

fn list_ui(ui: &mut Ui, state: &mut State) -> Option<Source> {
    let mut wanted = None;
    let current = &state.document.current().chosen;
    if ui.selectable_label(false, "This BRDF with other parameters").clicked() {
        wanted = Some(Source::Values(Box::new(current.clone())));
    }
    for (index, material) in state.document.materials.iter().enumerate() {
        if index != state.document.current
            && ui.selectable_label(false, format!("BRDF: {}", material.chosen.name())).clicked()
        {
            wanted = Some(Source::Material(material.pen));
        }
    }
    for found in &state.catalogue.integrators {
        let Ok(plugin) = &found.plugin else { continue };
        if ui.selectable_label(false, format!("Integrator: {}", plugin.manifest.name)).clicked() {
            match Chosen::find(&state.registry, Kind::Integrator, &found.id) {
                Ok(chosen) => wanted = Some(Source::Integrator(Box::new(chosen))),
                Err(problem) => state.refused = Some(problem),
            }
        }
    }
    for map in &state.catalogue.maps {
        if *map != state.document.session.environment.map
            && ui.selectable_label(false, format!("Environment: {map}")).clicked()
        {
            wanted = Some(Source::Map(map.clone()));
        }
    }
    if ui.button("An environment from a file…").clicked() {
        let endings = ["hdr", "exr", "ptex", "ptx", "penv", "toml"].map(str::to_owned);
        state.dialogs.ask(ui.ctx(), Purpose::OtherMap, &endings, "");
    }
    if ui.button("A picture from a file…").clicked() {
        let endings = ["exr", "hdr", "png"].map(str::to_owned);
        state.dialogs.ask(ui.ctx(), Purpose::Reference, &endings, "");
    }
    wanted
}

/// Parameters of the other one, where it has its own; and the way to take them over.
pub(super) fn values_ui(ui: &mut Ui, state: &mut State) {
    let Source::Values(chosen) = &mut state.compare.source else { return };
    let plugin = Arc::clone(&chosen.configured.plugin);
    let current = state.document.current;
    let header = CollapsingHeader::new("Parameters of the other, on the right");
    header.id_salt("other parameters").default_open(true).show(ui, |ui| {
        ScrollArea::vertical().max_height(0.35 * ui.available_height()).show(ui, |ui| {
            ui.push_id("other", |ui| {
                parameters_ui(ui, &plugin.manifest, &mut chosen.configured.values, None);
            });
        });
        let Some(material) = state.document.materials.get_mut(current) else { return };
        let same = material.chosen.reference == chosen.reference;
        let swap = ui.add_enabled(same, egui::Button::new("swap with the lit object"));
        if swap.on_hover_text("Its parameters go there, and those from there come here.").clicked()
        {
            std::mem::swap(&mut material.chosen.configured, &mut chosen.configured);
        }
    });
}

impl State {
    /// Takes a picture from a file to compare with.
    pub(super) fn compare_with(&mut self, path: &Path) -> Result<String> {
        let stored = read(path)?;
        let shown = path.display().to_string();
        if stored.for_display {
            return Err(Problem::new(
                shown,
                "its values have been through a display curve",
                "give a picture of radiance: .exr or .hdr",
            ));
        }
        let Stored { resolution, rgb, .. } = stored;
        let still = Still { number: fresh_number(), resolution, rgb };
        self.compare.take(Source::File(path.to_owned(), Arc::new(still)));
        Ok(format!("comparing with {shown}"))
    }
}
