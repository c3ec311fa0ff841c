//! `brdf list`: what there is to render with, and where each comes from.

use brdf_sdk::{Kind, Param, ParamType, ParamValue, Result};
use serde_json::{Value, json};

use super::print;
use crate::registry::{Found, Registry};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let brdfs = registry.all(Kind::Brdf);
    let integrators = registry.all(Kind::Integrator);
    let recipes = registry.recipes();
    if arguments.json {
        let plugins = |found: &[Found]| found.iter().map(as_json).collect::<Vec<_>>();
        let environments: Vec<_> = recipes
            .iter()
            .map(|(id, origin)| {
                json!({ "name": id, "origin": origin.to_string(), "about": about_recipe(registry, id) })
            })
            .collect();
        let all = json!({
            "brdfs": plugins(&brdfs), "integrators": plugins(&integrators), "environments": environments
        });
        return print(&format!("{all}\n"));
    }
    let mut text = String::from("BRDFs (--set key=value)\n");
    text.extend(brdfs.iter().map(as_text));
    text.push_str("\nIntegrators (--rendering NAME, --iset key=value)\n");
    text.extend(integrators.iter().map(as_text));
    text.push_str("\nEnvironments (--ibl NAME, or the path of an .hdr, .exr or .ptx file)\n");
    for (id, origin) in recipes {
        text.push_str(&format!("  {id}  [{origin}]\n    {}\n", about_recipe(registry, &id)));
    }
    print(&text)
}

/// A recipe's own sentence; empty where it cannot be read.
fn about_recipe(registry: &Registry, id: &str) -> String {
    let Some(Ok((_, source))) = registry.recipe(id) else { return String::new() };
    let table = source.parse::<toml::Table>().unwrap_or_default();
    table.get("about").and_then(toml::Value::as_str).unwrap_or_default().to_owned()
}

fn as_text(found: &Found) -> String {
    let plugin = match &found.plugin {
        Ok(plugin) => plugin,
        Err(problem) => {
            return format!("  {}  [{}]\n    broken: {problem}\n", found.id, found.origin);
        }
    };
    let mut text = format!("  {}  [{}]\n    {}\n", found.id, found.origin, plugin.manifest.about);
    for param in &plugin.manifest.params {
        let default = ParamValue::default_of(param);
        let unit = param.unit.as_ref().map(|unit| format!(" [{unit}]")).unwrap_or_default();
        text.push_str(&format!(
            "      {} = {default}  {}{unit}. {}\n",
            param.key,
            limits(param),
            param.about
        ));
    }
    for preset in &plugin.manifest.presets {
        let values: Vec<_> =
            preset.values.iter().map(|(key, value)| format!("{key}={value}")).collect();
        text.push_str(&format!("      preset {}: {}\n", preset.name, values.join(" ")));
    }
    text
}

fn limits(param: &Param) -> String {
    match &param.ty {
        ParamType::Float { range: [min, max], .. } => format!("float in [{min}, {max}]"),
        ParamType::Int { range: [min, max], .. } => format!("int in [{min}, {max}]"),
        ParamType::Bool { .. } => "bool".to_owned(),
        ParamType::Color { range: [min, max], .. } => format!("color in [{min}, {max}]"),
        ParamType::Choice { options, .. } => format!("one of {}", options.join(", ")),
        ParamType::File { .. } => "file".to_owned(),
    }
}

fn as_json(found: &Found) -> Value {
    let origin = found.origin.to_string();
    match &found.plugin {
        Err(problem) => json!({ "name": found.id, "origin": origin, "error": problem.to_string() }),
        Ok(plugin) => {
            let params: Vec<_> = plugin
                .manifest
                .params
                .iter()
                .map(|param| {
                    json!({
                        "key": param.key,
                        "type": param.ty.word(),
                        "default": ParamValue::default_of(param).to_string(),
                        "limits": limits(param),
                        "about": param.about,
                    })
                })
                .collect();
            json!({
                "name": found.id, "origin": origin, "title": plugin.manifest.name,
                "about": plugin.manifest.about, "params": params
            })
        }
    }
}
