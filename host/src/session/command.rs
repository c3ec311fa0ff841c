//! A scene as the command that renders it, and the words that the command line has for its parts.

use brdf_sdk::{ParamValue, Problem, Result};

use super::{Background, Chosen, Session};
use crate::layout::word;
use crate::render::{Effort, Lighting};
use crate::tone::Curve;

/// The words of a `brdf` command that renders a scene; `render` is the first of them. What `brdf render` does of itself
/// is left out, but for parameters and camera.
pub fn render_command(session: &Session) -> Vec<String> {
    let mut words = vec!["render".to_owned(), session.brdf.reference.clone()];
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    for (name, assigned) in [
        ("--set", assignments(&session.brdf)),
        ("--rendering", vec![session.integrator.reference.clone()]),
        ("--iset", assignments(&session.integrator)),
    ] {
        assigned.into_iter().for_each(|assigned| option(name, assigned));
    }
    let light = &session.environment;
    option("--ibl", light.map.clone());
    let tone = session.film.tone;
    let numbers = [
        ("--ibl-width", light.width.map(f64::from)),
        ("--ibl-face", light.face.map(f64::from)),
        ("--phi", (light.phi != 0.0).then_some(light.phi)),
        ("--theta", (light.theta != 0.0).then_some(light.theta)),
        ("--exposure", (tone.exposure != 0.0).then_some(tone.exposure)),
        ("--passes", session.effort.passes.map(f64::from)),
        ("--time", session.stop.time),
        ("--error", session.stop.error),
    ];
    for (name, number) in numbers {
        number.into_iter().for_each(|number| option(name, number.to_string()));
    }
    let Lighting { filter, weighting } = light.lighting;
    let usual = Lighting::default();
    let chosen = [
        ("--ibl-layout", light.layout.as_ref().map(word)),
        ("--env-layout", light.arrangement.as_ref().map(word)),
        ("--filter", (filter != usual.filter).then(|| word(&filter))),
        ("--curve", (tone.curve != Curve::default()).then(|| word(&tone.curve))),
        ("--weighting", (weighting != usual.weighting).then(|| word(&weighting))),
    ];
    for (name, chosen) in chosen {
        chosen.into_iter().for_each(|chosen| option(name, chosen));
    }
    let [width, height] = session.film.resolution;
    let Effort { samples, replicates, seed, .. } = session.effort;
    option("--shape", session.shape.clone());
    option("--camera", session.camera.to_string());
    option("--resolution", format!("{width}x{height}"));
    option("--samples", samples.to_string());
    option("--replicates", replicates.to_string());
    option("--seed", seed.to_string());
    option("--sampler", word(&session.sampler));
    if session.film.background == Background::Black {
        option("--background", word(&session.film.background));
    }
    if light.replace_bad_texels {
        words.push("--replace-bad-texels".to_owned());
    }
    if session.brdf.configured.fit_sampler {
        words.push("--fit-sampler".to_owned());
    }
    words
}

fn assignments(chosen: &Chosen) -> Vec<String> {
    let assigned = |(key, value): (&str, &ParamValue)| format!("{key}={value}");
    chosen.configured.values.iter().map(assigned).collect()
}

/// A word as shells take it: in quotes where one of them would read it otherwise.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// Reads a resolution as the command line writes it: `512` or `640x480`.
pub fn parse_resolution(text: &str) -> Result<[u32; 2]> {
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| *side > 0);
    let parsed = match text.split_once(['x', 'X']) {
        Some((width, height)) => side(width).zip(side(height)).map(|(w, h)| [w, h]),
        None => side(text).map(|n| [n, n]),
    };
    parsed.ok_or_else(|| {
        Problem::new(
            format!("--resolution {text}"),
            "this is no picture size",
            "write N or WxH with whole numbers of at least 1, such as 512 or 640x480",
        )
    })
}
