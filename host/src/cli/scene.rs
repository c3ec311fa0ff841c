//! The options that describe a scene, the same for every verb that makes pictures.

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, Problem, Result};

use super::parameters::Parameters;
use crate::environment::{Filter, Weighting};
use crate::layout::{Layout, Reading};
use crate::link::Sampler;
use crate::open;
use crate::picture;
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::session::{Background, Chosen, Light, Session, parse_resolution};
use crate::tone::Curve;

#[derive(Debug, clap::Args)]
pub(super) struct SceneOptions {
    /// Start from a scene.toml, or from the header of a picture that this program wrote
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// The environment: a recipe's name, or an .hdr, .exr or .ptx file; six files with a % [default: studio]
    #[arg(long, value_name = "MAP")]
    ibl: Option<String>,
    /// Width of a recipe's map in texels, or of a cube's that becomes a lat-long map
    #[arg(long, value_name = "N")]
    ibl_width: Option<u32>,
    /// Light with the map as a lat-long map or as a cube [default: as in its file]
    #[arg(long, value_enum, value_name = "LAYOUT")]
    ibl_layout: Option<Layout>,
    /// The side of a cube's faces in texels [default: as in its file, or a quarter of the width]
    #[arg(long, value_name = "N")]
    ibl_face: Option<u32>,
    /// How the map's file is to be read: auto, lat-long, cross-h, cross-v, strip-row, strip-col,
    /// openexr-lat-long, openexr-cube [default: by its content and shape]
    #[arg(long, value_name = "LAYOUT")]
    env_layout: Option<Reading>,
    /// How radiance is read between texel centres [default: nearest]
    #[arg(long, value_enum)]
    filter: Option<Filter>,
    /// What the probability of drawing a texel follows [default: luminance]
    #[arg(long, value_enum)]
    weighting: Option<Weighting>,
    /// Replace NaN and negative texels by 0, infinite ones by the map's largest value
    #[arg(long)]
    replace_bad_texels: bool,
    /// Turn the environment about +y first [degrees]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    phi: Option<f64>,
    /// Turn the environment about +x second [degrees]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta: Option<f64>,
    /// sphere, torus, plane, teapot, or an .obj, .gltf or .glb file [default: sphere]
    #[arg(long, value_name = "SHAPE")]
    shape: Option<String>,
    /// yaw, pitch, fov in degrees, distance, shift_x and shift_y, as in yaw=30,pitch=20,distance=4.5,fov=30
    #[arg(long, value_name = "KEY=VALUE,...", allow_hyphen_values = true)]
    camera: Option<String>,
    /// Size of the picture [default: 512]
    #[arg(long, value_name = "N|WxH", allow_hyphen_values = true)]
    resolution: Option<String>,
    /// Where the samples' points come from [default: owen-sobol]
    #[arg(long, value_enum)]
    sampler: Option<Sampler>,
    /// Seed of the samples [default: 0]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    seed: Option<u32>,
    #[command(flatten)]
    parameters: Parameters,
    /// Fit a sampler to the values of BRDFs that have no `sample` and `pdf`, instead of drawing by the cosine
    #[arg(long)]
    fit_sampler: bool,
    /// What is seen past the object [default: env]
    #[arg(long, value_enum)]
    background: Option<Background>,
    /// Exposure of the PNG in stops [default: 0]
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    exposure: Option<f64>,
    /// Highlights of the PNG: soft is x up to 0.5 and 1 - 1/(4x) above; linear is cut at 1 [default: soft]
    #[arg(long, value_enum)]
    curve: Option<Curve>,
}

impl SceneOptions {
    /// Whether nothing says how large the picture is.
    pub(super) fn has_no_size(&self) -> bool {
        self.resolution.is_none() && self.session.is_none()
    }

    /// The preset that is named.
    pub(super) fn preset(&self) -> Option<&str> {
        self.parameters.preset.as_deref()
    }

    /// The scene: from a file or the defaults, changed by the options.
    pub(super) fn session(&self, registry: &Registry) -> Result<Session> {
        let mut session = match &self.session {
            None => Session::new(registry)?,
            Some(path) => open::session(registry, path)?,
        };
        self.change(&mut session)?;
        Ok(session)
    }

    /// The samples' seed, where one is named.
    pub(super) fn seed(&self) -> Option<u32> {
        self.seed
    }

    /// Whether what a scene is made of is named: a file, a map, a shape, parameters of its BRDF.
    pub(super) fn names_parts(&self) -> bool {
        [
            self.session.is_some(),
            self.ibl.is_some(),
            self.shape.is_some(),
            !self.parameters.set.is_empty(),
        ]
        .contains(&true)
    }

    /// Changes a scene by all options but those of its BRDF.
    pub(super) fn change(&self, session: &mut Session) -> Result<()> {
        let light = &mut session.environment;
        if let Some(map) = &self.ibl {
            light.map.clone_from(map);
        }
        self.resample(light);
        if let Some(Reading(arrangement)) = self.env_layout {
            light.arrangement = arrangement;
        }
        light.replace_bad_texels |= self.replace_bad_texels;
        light.lighting.filter = self.filter.unwrap_or(light.lighting.filter);
        light.lighting.weighting = self.weighting.unwrap_or(light.lighting.weighting);
        light.phi = finite("--phi", self.phi)?.unwrap_or(light.phi);
        light.theta = finite("--theta", self.theta)?.unwrap_or(light.theta);
        if let Some(shape) = &self.shape {
            session.shape.clone_from(shape);
        }
        if let Some(camera) = &self.camera {
            session.camera = crate::scene::Camera::parse(camera)?;
        }
        let film = &mut session.film;
        if let Some(resolution) = &self.resolution {
            film.resolution = parse_resolution(resolution)?;
        }
        let tone = &mut film.tone;
        tone.exposure = finite("--exposure", self.exposure)?.unwrap_or(tone.exposure);
        tone.curve = self.curve.unwrap_or(tone.curve);
        film.background = self.background.unwrap_or(film.background);
        session.brdf.configured.fit_sampler |= self.fit_sampler;
        session.sampler = self.sampler.unwrap_or(session.sampler);
        session.effort.seed = self.seed.unwrap_or(session.effort.seed);
        Ok(())
    }

    /// How finely a map is to be sampled, and in which layout: for whatever map there is.
    pub(super) fn resample(&self, light: &mut Light) {
        light.width = self.ibl_width.or(light.width);
        light.layout = self.ibl_layout.or(light.layout);
        light.face = self.ibl_face.or(light.face);
    }

    /// The BRDFs of these names, or the session's own, with `--preset` and `--set` applied to each that
    /// has such a preset or parameter.
    pub(super) fn brdfs(
        &self,
        registry: &Registry,
        names: &[String],
        session: &Session,
    ) -> Result<Vec<Chosen>> {
        if names.is_empty() {
            return self.configured(vec![session.brdf.clone()]);
        }
        let find = |name: &String| Chosen::find(registry, Kind::Brdf, name);
        self.configured(names.iter().map(find).collect::<Result<_>>()?)
    }

    /// BRDFs with `--preset` and `--set` applied to each that has such a preset or parameter.
    pub(super) fn configured(&self, mut brdfs: Vec<Chosen>) -> Result<Vec<Chosen>> {
        brdfs.iter_mut().for_each(|brdf| brdf.configured.fit_sampler |= self.fit_sampler);
        let mut all: Vec<&mut Configured> =
            brdfs.iter_mut().map(|brdf| &mut brdf.configured).collect();
        self.parameters.apply_each(&mut all)?;
        Ok(brdfs)
    }

    /// Refuses a path for a picture that could not be written, or that would replace the picture that
    /// the scene comes from.
    pub(super) fn check_export(
        &self,
        export: &Path,
        brdf: &Chosen,
        session: &Session,
    ) -> Result<()> {
        let full = |path: &Path| path.canonicalize().ok();
        let pictures = ["exr", "png"].map(|ending| full(&picture::with_ending(export, ending)));
        let read = [
            ("the one that --session names", self.session.as_deref()),
            ("the data file that is rendered", brdf.configured.data_file()),
            ("the environment map", Some(Path::new(&session.environment.map))),
            ("the shape", Some(Path::new(&session.shape))),
        ];
        let replaced = |path: &Path| full(path).is_some_and(|file| pictures.contains(&Some(file)));
        if let Some((what, _)) = read.into_iter().find(|(_, path)| path.is_some_and(replaced)) {
            return Err(Problem::new(
                export.display().to_string(),
                format!("the new picture would replace {what}"),
                "give it another name with --export",
            ));
        }
        ["exr", "png"]
            .into_iter()
            .try_for_each(|ending| picture::check_writable(&picture::with_ending(export, ending)))
    }
}

/// A number of an option that must be above 0.
pub(super) fn positive(option: &str, value: Option<f64>) -> Result<Option<f64>> {
    match value {
        Some(number) if !(number > 0.0 && number.is_finite()) => Err(Problem::new(
            format!("{option} {number}"),
            "this is no positive number",
            "write a number above 0",
        )),
        other => Ok(other),
    }
}

fn finite(option: &str, value: Option<f64>) -> Result<Option<f64>> {
    match value {
        Some(number) if !number.is_finite() => Err(Problem::new(
            format!("{option} {number}"),
            "this is no finite number",
            "write a finite number",
        )),
        other => Ok(other),
    }
}
