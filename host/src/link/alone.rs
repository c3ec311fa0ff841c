//! A plugin checked alone, with what is in its scope and nothing else, so that the author's line is blamed and not the
//! host's use of it.

use brdf_sdk::{Kind, Problem, Result};

use super::declarations::Cut;
use super::sampling::Sampling;
use super::source_map::SourceMap;
use super::text::push_plugin;
use super::{Form, constants, generated, messages, parse_and_validate, purity, shader, signatures};
use crate::plugin::{Configured, Plugin};

/// Checks a plugin, and takes its text apart.
pub fn checked(configured: &Configured, kind: Kind) -> Result<Cut> {
    let plugin = &configured.plugin;
    if plugin.manifest.kind != kind {
        return Err(Problem::new(
            &plugin.id,
            format!("this is a plugin of kind `{}`", plugin.manifest.kind.word()),
            format!("name one of kind `{}`", kind.word()),
        ));
    }
    let cut = Cut::new(&plugin.wgsl_file, &plugin.source)?;
    cut.check_plugin(&plugin.wgsl_file, &plugin.source)?;
    let generated = generated::parameter_names(configured);
    if let Some(taken) = cut.declarations.iter().find(|d| generated.contains(&d.name)) {
        return Err(Problem::at(
            &plugin.wgsl_file,
            &plugin.source,
            taken.name_span.clone(),
            format!("`{}` is already declared, from plugin.toml", taken.name),
            "rename it",
        ));
    }
    signatures::check_presence(plugin, &cut)?;
    constants::check_size(&plugin.wgsl_file, &plugin.source, &cut)?;

    let mut map = SourceMap::default();
    map.push_all(&[shader::PRELUDE, shader::COSINE]);
    if kind == Kind::Integrator {
        map.push("the stand-in for a BRDF", generated::BRDF_STAND_IN);
        map.push_all(&[shader::SCATTER]);
        Form::default().push(&mut map);
    }
    push_plugin(&mut map, configured, &cut, Sampling::Own)?;
    let module = parse_and_validate(&map).map_err(|problem| advised(problem, plugin, &cut))?;
    let prefix = generated::prefix(configured);
    purity::check(&module, &map, &prefix).map_err(|problem| named(problem, plugin))?;
    signatures::check_types(plugin, &cut, &module, &prefix)?;
    Ok(cut)
}

/// Problems without a place are the plugin's all the same.
fn named(problem: Problem, plugin: &Plugin) -> Problem {
    if problem.place.is_some() {
        return problem;
    }
    let cure = if problem.cure.is_empty() {
        "simplify the plugin's last change".to_owned()
    } else {
        problem.cure
    };
    Problem { thing: plugin.wgsl_file.clone(), cure, ..problem }
}

fn advised(problem: Problem, plugin: &Plugin, cut: &Cut) -> Problem {
    let problem = named(problem, plugin);
    let host: Vec<Cut> = shader::OF_INTEGRATORS
        .iter()
        .chain([&shader::SCATTER, &shader::FILM])
        .filter_map(|(label, text)| Cut::new(label, text).ok())
        .collect();
    match Cut::new(shader::PRELUDE.0, shader::PRELUDE.1) {
        Ok(prelude) => messages::with_cure(problem, plugin, cut, &prelude, &host),
        Err(_) => problem,
    }
}
