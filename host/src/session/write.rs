//! Scene -> `scene.toml`: every choice, so that later defaults do not change what a file means.

use std::fmt::Write as _;
use std::path::Path;

use brdf_sdk::{Kind, ParamValue};

use super::paths::{absolute, seen_from};
use super::{Chosen, Output, Session};
use crate::layout::word;
use crate::render::{Effort, Lighting};
use crate::scene::Camera;

impl Session {
    /// The scene as `scene.toml`, with absolute paths.
    pub fn to_toml(&self) -> String {
        self.written(&absolute)
    }

    /// The scene as a file in this folder: paths of what lies there, too, are relative.
    pub fn to_toml_in(&self, folder: &Path) -> String {
        self.written(&|name| seen_from(folder, name))
    }

    fn written(&self, path: &dyn Fn(&str) -> String) -> String {
        let mut text = String::from("format = 1\n");
        for chosen in [&self.brdf, &self.integrator] {
            let kind = chosen.configured.plugin.manifest.kind;
            let plugin = quoted(&path(&chosen.reference));
            let _ = writeln!(text, "\n[{}]\nplugin = {plugin}", kind.word());
            if kind == Kind::Brdf && self.place > 0 {
                let _ = writeln!(text, "place = {}", self.place);
            }
            write_fit(&mut text, chosen);
            if chosen.configured.values.iter().next().is_some() {
                let _ = writeln!(text, "\n[{}.params]", kind.word());
            }
            write_values(&mut text, chosen, path);
        }
        for chosen in &self.beside {
            let plugin = quoted(&path(&chosen.reference));
            let _ = writeln!(text, "\n[[beside]]\nplugin = {plugin}");
            write_fit(&mut text, chosen);
            text.push_str("\n[beside.params]\n");
            write_values(&mut text, chosen, path);
        }
        let light = &self.environment;
        let _ = writeln!(text, "\n[environment]\nmap = {}", quoted(&path(&light.map)));
        let _ = writeln!(text, "phi = {:?}\ntheta = {:?}", light.phi, light.theta);
        if let Some(width) = light.width {
            let _ = writeln!(text, "width = {width}");
        }
        if light.replace_bad_texels {
            text.push_str("replace_bad_texels = true\n");
        }
        let Lighting { filter, weighting } = light.lighting;
        let _ = writeln!(text, "filter = {:?}\nweighting = {:?}", word(&filter), word(&weighting));
        if let Some(arrangement) = light.arrangement {
            let _ = writeln!(text, "read_as = {:?}", word(&arrangement));
        }
        if let Some(layout) = light.layout {
            let _ = writeln!(text, "layout = {:?}", word(&layout));
        }
        if let Some(face) = light.face {
            let _ = writeln!(text, "face = {face}");
        }
        let _ = writeln!(text, "\n[shape]\nkind = {}", quoted(&path(&self.shape)));
        let Camera { yaw, pitch, distance, fov, shift } = self.camera;
        let _ = writeln!(
            text,
            "\n[camera]\nyaw = {yaw:?}\npitch = {pitch:?}\ndistance = {distance:?}\nfov = {fov:?}"
        );
        if shift != [0.0; 2] {
            let _ = writeln!(text, "shift = {shift:?}");
        }
        let Output { resolution: [width, height], tone, background } = self.film;
        let _ = writeln!(
            text,
            "\n[film]\nresolution = [{width}, {height}]\nexposure = {:?}\ncurve = {:?}\nbackground = {:?}",
            tone.exposure,
            word(&tone.curve),
            word(&background)
        );
        let Effort { samples, passes, replicates, seed, .. } = self.effort;
        let _ = writeln!(text, "\n[stopping]\nsamples = {samples}");
        if let Some(passes) = passes {
            let _ = writeln!(text, "passes = {passes}");
        }
        for (key, value) in [("time", self.stop.time), ("error", self.stop.error)] {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
        let sampler = word(&self.sampler);
        let _ = writeln!(text, "replicates = {replicates}\nseed = {seed}\nsampler = {sampler:?}");
        text
    }
}

fn write_fit(text: &mut String, chosen: &Chosen) {
    if chosen.configured.fit_sampler {
        text.push_str("fit_sampler = true\n");
    }
}

/// A line for each parameter.
fn write_values(text: &mut String, chosen: &Chosen, path: &dyn Fn(&str) -> String) {
    for (key, value) in chosen.configured.values.iter() {
        let value = match value {
            ParamValue::File(file) => ParamValue::File(path(file)),
            other => other.clone(),
        };
        let _ = writeln!(text, "{key} = {}", value.to_toml());
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
