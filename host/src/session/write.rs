//! Scene -> `scene.toml`: every choice, so that later defaults do not change what a file means.

use std::fmt::Write as _;

use brdf_sdk::ParamValue;

use super::paths::absolute;
use super::{Chosen, Output, Session};
use crate::layout::word;
use crate::render::{Effort, Lighting};
use crate::scene::Camera;

impl Session {
    /// The scene as `scene.toml`, with absolute paths.
    pub fn to_toml(&self) -> String {
        let mut text = String::from("format = 1\n");
        for chosen in [&self.brdf, &self.integrator] {
            let kind = chosen.configured.plugin.manifest.kind.word();
            let plugin = quoted(&chosen.reference);
            let _ = writeln!(text, "\n[{kind}]\nplugin = {plugin}");
            write_fit(&mut text, chosen);
            if chosen.configured.values.iter().next().is_some() {
                let _ = writeln!(text, "\n[{kind}.params]");
            }
            write_values(&mut text, chosen);
        }
        for chosen in &self.beside {
            let plugin = quoted(&chosen.reference);
            let _ = writeln!(text, "\n[[beside]]\nplugin = {plugin}");
            write_fit(&mut text, chosen);
            text.push_str("\n[beside.params]\n");
            write_values(&mut text, chosen);
        }
        let light = &self.environment;
        let _ = writeln!(text, "\n[environment]\nmap = {}", quoted(&absolute(&light.map)));
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
        let _ = writeln!(text, "\n[shape]\nkind = {}", quoted(&absolute(&self.shape)));
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
fn write_values(text: &mut String, chosen: &Chosen) {
    for (key, value) in chosen.configured.values.iter() {
        let value = match value {
            ParamValue::File(path) => ParamValue::File(absolute(path)),
            other => other.clone(),
        };
        let _ = writeln!(text, "{key} = {}", value.to_toml());
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
