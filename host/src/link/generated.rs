//! The WGSL that the linker writes itself: a plugin's parameters, and the adapters between a plugin
//! and the host's shaders.

use brdf_sdk::manifest::{Filled, Lobes};
use brdf_sdk::{Kind, ParamType, ParamValue};

use super::Sampling;
use super::declarations::Cut;
use crate::plugin::Configured;

/// The struct that holds a plugin's numbers, as its author names it.
fn struct_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Brdf => "Params",
        Kind::Integrator => "Settings",
    }
}

/// The uniform behind that struct.
pub fn uniform_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Brdf => "brdf_params",
        Kind::Integrator => "integrator_settings",
    }
}

/// What every name of a plugin is prefixed with: `brdf_modified_phong__`.
pub fn prefix(configured: &Configured) -> String {
    let plugin = &configured.plugin;
    let folder: String =
        plugin.id.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    format!("{}_{}__", plugin.manifest.kind.word(), folder.trim_matches('_'))
}

/// `Params` or `Settings`, and the constants of switches and choices.
pub fn parameters(configured: &Configured) -> String {
    let manifest = &configured.plugin.manifest;
    let members: Vec<String> = manifest
        .params
        .iter()
        .filter_map(|param| Some(format!("    {}: {},\n", param.key, param.ty.wgsl_member()?)))
        .collect();
    // WGSL has no empty structs.
    let members = if members.is_empty() { "    none: u32,\n".to_owned() } else { members.concat() };
    let mut text = format!("struct {} {{\n{members}}}\n", struct_name(manifest.kind));
    if !manifest.state.is_empty() {
        let fields = manifest.state.iter();
        let members: String =
            fields.map(|field| format!("    {}: {},\n", field.name, field.wgsl())).collect();
        text.push_str(&format!("struct State {{\n{members}}}\n"));
    }
    for param in &manifest.params {
        let names = param.constant_names();
        match (&param.ty, configured.values.get(&param.key)) {
            (ParamType::Bool { .. }, Some(ParamValue::Bool(value))) => {
                text.push_str(&format!("const {}: bool = {value};\n", names[0]));
            }
            (ParamType::Choice { options, .. }, Some(ParamValue::Choice(chosen))) => {
                let index = options.iter().position(|option| option == chosen).unwrap_or(0);
                text.push_str(&format!("const {}: u32 = {index}u;\n", names[0]));
                for (index, name) in names[1..].iter().enumerate() {
                    text.push_str(&format!("const {name}: u32 = {index}u;\n"));
                }
            }
            _ => {}
        }
    }
    text
}

/// The names that [`parameters`] declares.
pub fn parameter_names(configured: &Configured) -> Vec<String> {
    let manifest = &configured.plugin.manifest;
    let constants = manifest.params.iter().flat_map(|param| param.constant_names());
    let state = (!manifest.state.is_empty()).then(|| "State".to_owned());
    std::iter::once(struct_name(manifest.kind).to_owned()).chain(state).chain(constants).collect()
}

/// The uniform declaration and the expression that passes the struct to a plugin's function.
fn uniform(configured: &Configured, prefix: &str) -> (String, String) {
    let kind = configured.plugin.manifest.kind;
    let ty = format!("{prefix}{}", struct_name(kind));
    let numeric = configured.plugin.manifest.params.iter().any(|p| p.ty.wgsl_member().is_some());
    if !numeric {
        return (String::new(), format!("{ty}(0u)"));
    }
    let binding = match kind {
        Kind::Brdf => 0,
        Kind::Integrator => 1,
    };
    let name = uniform_name(kind);
    (format!("@group(0) @binding({binding}) var<uniform> {name}: {ty};\n"), name.to_owned())
}

/// The buffer of all tables, and the function that reads each; `None` where there are no tables.
pub fn table_accessors(configured: &Configured) -> Option<String> {
    let tables = &configured.plugin.manifest.tables;
    if tables.is_empty() {
        return None;
    }
    let mut text =
        String::from("@group(0) @binding(11) var<storage, read> brdf_tables: array<f32>;\n");
    let mut first = 0;
    for Filled { name, size: [columns, rows], .. } in tables {
        let count = columns * rows;
        text.push_str(&format!(
            "fn {name}_at(i: u32) -> f32 {{\n    \
             return brdf_tables[{first}u + min(i, {}u)];\n}}\n",
            count - 1
        ));
        first += count;
    }
    Some(text)
}

/// What `table.wgsl` calls.
pub fn fill_adapter(configured: &Configured, table: usize) -> String {
    let Filled { name, size: [columns, rows], .. } = &configured.plugin.manifest.tables[table];
    let prefix = prefix(configured);
    format!(
        "const TABLE_WIDTH: u32 = {columns}u;\nconst TABLE_HEIGHT: u32 = {rows}u;\n\
         fn author_fill(at: vec2f) -> f32 {{\n    return {prefix}fill_{name}(at);\n}}\n"
    )
}

/// What `lobes.wgsl` leaves open: whether views go around. A library's manifest says it; without, the tables were fitted,
/// and with other numbers of the BRDF others are.
pub fn lobes(lobes: Option<Lobes>) -> String {
    let around = match lobes {
        Some(Lobes::Isotropic) => "false",
        Some(Lobes::Anisotropic) => "true",
        None => "lobe_rows_size(1u) > 1u",
    };
    format!("fn lobe_around() -> bool {{\n    return {around};\n}}\n")
}

/// What `scatter.wgsl` calls. Where the author gives no `sample` with `pdf`, the cosine or fitted tables serve.
pub fn brdf_adapter(configured: &Configured, cut: &Cut, sampling: Sampling) -> String {
    let prefix = prefix(configured);
    let (uniform, p) = uniform(configured, &prefix);
    let weighs = sampling == Sampling::Own && cut.declares("weight");
    let (sample, pdf) = match sampling {
        Sampling::Own => {
            (format!("{prefix}sample({p}, wo, u)"), format!("{prefix}pdf({p}, wo, wi)"))
        }
        Sampling::Cosine => ("cosine_sample(u.xy)".to_owned(), "cosine_pdf(wi)".to_owned()),
        Sampling::Fitted => ("lobe_sample(wo, u)".to_owned(), "lobe_pdf(wo, wi)".to_owned()),
    };
    let weight = if weighs { format!("{prefix}weight({p}, wo, wi)") } else { "vec3f(0.0)".into() };
    format!(
        "{uniform}const AUTHOR_WEIGHS: bool = {weighs};\n\
         fn author_eval(wo: vec3f, wi: vec3f) -> vec3f {{\n    return {prefix}eval({p}, wo, wi);\n}}\n\
         fn author_sample(wo: vec3f, u: vec3f) -> vec3f {{\n    return {sample};\n}}\n\
         fn author_pdf(wo: vec3f, wi: vec3f) -> f32 {{\n    return {pdf};\n}}\n\
         fn author_weight(wo: vec3f, wi: vec3f) -> vec3f {{\n    return {weight};\n}}\n"
    )
}

/// What `film.wgsl` or `terms.wgsl` calls.
pub fn integrator_adapter(configured: &Configured, cut: &Cut) -> String {
    let prefix = prefix(configured);
    let (uniform, q) = uniform(configured, &prefix);
    let prepares = cut.declares("prepare");
    let learns = !configured.plugin.manifest.state.is_empty();
    let mut text = uniform;
    let mut handed = String::new();
    if prepares {
        handed.push_str(", prepared");
        text.push_str(&format!(
            "alias PluginPrepared = {prefix}Prepared;\n\
             fn plugin_prepare(hit: Hit) -> PluginPrepared {{\n    return {prefix}prepare({q}, hit);\n}}\n"
        ));
    } else {
        text.push_str(
            "alias PluginPrepared = u32;\n\
             fn plugin_prepare(hit: Hit) -> PluginPrepared {\n    return 0u;\n}\n",
        );
    }
    if cut.declares("term") {
        text.push_str(&format!(
            "fn plugin_term(hit: Hit, k: u32, sum: ptr<function, Quadrature>, \
             prepared: ptr<function, PluginPrepared>) -> vec3f {{\n    \
             return {prefix}term({q}, hit, k, sum{handed});\n}}\n"
        ));
        return text;
    }
    if learns {
        handed.push_str(", state");
        text.push_str(&format!(
            "const LEARNS: bool = true;\n\
             alias PluginState = {prefix}State;\n\
             @group(0) @binding(7) var<storage, read_write> states: array<PluginState>;\n\
             fn plugin_load(slot: u32) -> PluginState {{\n    return states[slot];\n}}\n\
             fn plugin_store(slot: u32, state: PluginState) {{\n    states[slot] = state;\n}}\n\
             fn plugin_learn(state: ptr<function, PluginState>) {{\n    {prefix}learn({q}, state);\n}}\n"
        ));
    } else {
        text.push_str(
            "const LEARNS: bool = false;\n\
             alias PluginState = u32;\n\
             fn plugin_load(slot: u32) -> PluginState {\n    return 0u;\n}\n\
             fn plugin_store(slot: u32, state: PluginState) {\n}\n\
             fn plugin_learn(state: ptr<function, PluginState>) {\n}\n",
        );
    }
    text.push_str(&format!(
        "fn plugin_estimate(hit: Hit, s: ptr<function, Sampler>, \
         prepared: ptr<function, PluginPrepared>, state: ptr<function, PluginState>) -> vec3f {{\n    \
         return {prefix}estimate({q}, hit, s{handed});\n}}\n"
    ));
    text
}

/// Stands for a BRDF while an integrator is checked alone.
pub const BRDF_STAND_IN: &str = "const AUTHOR_WEIGHS: bool = false;
fn author_eval(wo: vec3f, wi: vec3f) -> vec3f { return vec3f(0.0); }
fn author_sample(wo: vec3f, u: vec3f) -> vec3f { return cosine_sample(u.xy); }
fn author_pdf(wo: vec3f, wi: vec3f) -> f32 { return cosine_pdf(wi); }
fn author_weight(wo: vec3f, wi: vec3f) -> vec3f { return vec3f(0.0); }
";
