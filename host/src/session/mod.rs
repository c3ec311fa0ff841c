//! One scene: what the command line, sessions, references, benchmarks and the EXR header share.
//!
//! Read from `scene.toml`, written back the same way; the header of every picture holds it, so that a
//! picture can be made again from itself. It names things; nothing is opened or rendered here, except
//! that plugins are looked up, since their manifests say what their parameters mean.

use brdf_sdk::{Kind, Result};

use crate::layout::{Arrangement, Layout};
use crate::registry::Registry;
use crate::render::{Effort, Lighting, Sampler, Stop};
use crate::scene::Camera;
use crate::tone::Tone;

mod chosen;
mod command;
mod paths;
mod read;
mod values;
mod write;

pub use chosen::Chosen;
pub use command::{parse_resolution, quoted as shell_quoted, render_command};

/// A scene with all its choices made.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// The BRDF with its parameters.
    pub brdf: Chosen,
    /// BRDFs that plots show beside it; a picture has no use for them.
    pub beside: Vec<Chosen>,
    /// How many of those come before it in lists, which also decides its colour in plots.
    pub place: usize,
    /// The integrator with its settings.
    pub integrator: Chosen,
    /// The light.
    pub environment: Light,
    /// `sphere`, `torus`, `plane`, or the path of a mesh.
    pub shape: String,
    /// From where it is seen.
    pub camera: Camera,
    /// The picture.
    pub film: Output,
    /// How much is sampled.
    pub effort: Effort,
    /// What ends it earlier.
    pub stop: Stop,
    /// Where the samples' points come from.
    pub sampler: Sampler,
}

/// An environment and how it is turned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Light {
    /// A recipe's name, or the path of a map's file; one with a `%` names six files.
    pub map: String,
    /// Turn about +y, applied first [degrees].
    pub phi: f64,
    /// Turn about +x, applied second [degrees].
    pub theta: f64,
    /// Width of a recipe's map in texels, or of a cube's that becomes a lat-long map; its own default without.
    pub width: Option<u32>,
    /// Whether NaN, Inf and negative texels are replaced.
    pub replace_bad_texels: bool,
    /// How it is read and its importance weighed.
    pub lighting: Lighting,
    /// How the map's picture is to be read; by its content and shape without.
    pub arrangement: Option<Arrangement>,
    /// The layout that lights the object; that of the file without.
    pub layout: Option<Layout>,
    /// The side of a cube's faces in texels; that of the file, or a quarter of the width, without.
    pub face: Option<u32>,
}

impl Light {
    /// Another map, read as it is by itself; how it is turned and filtered stays.
    pub fn set_map(&mut self, map: String) {
        let Self { phi, theta, replace_bad_texels, lighting, .. } = *self;
        *self = Self { map, phi, theta, replace_bad_texels, lighting, ..Self::default() };
    }
}

/// The picture's size and looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// How the PNG and screens show it; the EXR stays as it is.
    pub tone: Tone,
    /// What is seen past the object.
    pub background: Background,
}

/// What is seen past the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Background {
    /// The environment.
    Env,
    /// Nothing.
    Black,
}

impl Session {
    /// The scene without what no rendering of it depends on: how a screen shows it, and the BRDFs beside.
    pub fn bare(mut self) -> Self {
        (self.film.tone, self.beside, self.place) = (Tone::default(), Vec::new(), 0);
        self
    }

    /// The scene that `brdf render` alone renders.
    pub fn new(registry: &Registry) -> Result<Self> {
        Ok(Self {
            brdf: Chosen::find(registry, Kind::Brdf, "ggx")?,
            beside: Vec::new(),
            place: 0,
            integrator: Chosen::by_samples(registry)?,
            environment: Light { map: "studio".to_owned(), ..Light::default() },
            shape: "sphere".to_owned(),
            camera: Camera::default(),
            film: Output {
                resolution: [512, 512],
                tone: Tone::default(),
                background: Background::Env,
            },
            effort: Effort::new(64, 16),
            stop: Stop::default(),
            sampler: Sampler::default(),
        })
    }
}
