//! Runs a translated file: `eval`, `sample` and `pdf` for given directions, on the executor of the cores.

use glsl_brdf::{Source, Translated, translate};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use wgsl_cpu::{Precision, Program, Resource, Run, Storage};

/// The translation of a file.
pub fn translated(text: &str) -> Result<Translated, String> {
    translate(Source { file: "t.brdf", text }, "t", None).map_err(|problem| problem.line())
}

/// A file with this code, and parameters.
pub fn file(parameters: &str, code: &str) -> String {
    format!(
        "analytic\n::begin parameters\n{parameters}\n::end parameters\n::begin shader\n{code}\n::end shader\n"
    )
}

/// Calls `body`, WGSL that gives three numbers for `wo`, `wi` and `p`, for each pair of directions.
pub fn run(
    translated: &Translated,
    parameters: &[(&str, &str)],
    switches: &[(&str, bool)],
    body: &str,
    pairs: &[[[f64; 3]; 2]],
) -> Vec<[f64; 3]> {
    let members: String = match parameters.is_empty() {
        true => "unused: f32,".to_owned(),
        false => parameters
            .iter()
            .map(|(key, value)| {
                format!("{key}: {},", if value.starts_with("vec3f") { "vec3f" } else { "f32" })
            })
            .collect(),
    };
    let values: Vec<&str> = match parameters.is_empty() {
        true => vec!["0.0"],
        false => parameters.iter().map(|(_, value)| *value).collect(),
    };
    let switches: String =
        switches.iter().map(|(name, on)| format!("const {name} = {on};\n")).collect();
    let source = format!(
        "struct Params {{ {members} }}\n{switches}\n{}\n\
         @group(0) @binding(0) var<storage, read_write> directions: array<f32>;\n\
         @group(0) @binding(1) var<storage, read_write> results: array<f32>;\n\
         @compute @workgroup_size(1)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n\
         let p = Params({});\n\
         let wo = vec3f(directions[6u * id.x], directions[6u * id.x + 1u], directions[6u * id.x + 2u]);\n\
         let wi = vec3f(directions[6u * id.x + 3u], directions[6u * id.x + 4u], directions[6u * id.x + 5u]);\n\
         let result = {body};\n\
         results[3u * id.x] = result.x; results[3u * id.x + 1u] = result.y; results[3u * id.x + 2u] = result.z;\n}}\n",
        translated.wgsl,
        values.join(", "),
    );
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let program = Program::new(&module, &info).unwrap();
    let mut directions = Storage::new(6 * pairs.len(), true);
    let words = pairs.iter().flatten().flatten().map(|number| (*number as f32).to_bits());
    directions.write(&words.collect::<Vec<_>>());
    let results = Storage::new(3 * pairs.len(), true);
    let place = |binding| naga::ResourceBinding { group: 0, binding };
    let resources =
        [(place(0), Resource::Storage(&directions)), (place(1), Resource::Storage(&results))];
    let run = Run {
        resources: &resources,
        groups: [pairs.len() as u32, 1, 1],
        fuel: 100_000,
        set: None,
        lanes: None,
    };
    program.run(Precision::F32, &run).unwrap();
    let number = |index| results.float(index).unwrap();
    (0..pairs.len()).map(|pair| [0, 1, 2].map(|channel| number(3 * pair + channel))).collect()
}
