//! The invariants of the source tree: who may name what, and what stands in one place only.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use common::root;

fn files(folder: &str, extension: &str) -> Vec<(PathBuf, String)> {
    fn gather(folder: &Path, extension: &str, found: &mut Vec<(PathBuf, String)>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
                gather(&path, extension, found);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push((path.clone(), fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let mut found = Vec::new();
    gather(&root().join(folder), extension, &mut found);
    assert!(!found.is_empty(), "{folder} has no .{extension} files");
    found
}

/// Lines of code (comments aside) that hold `word`, outside the paths in `allowed`.
fn outside(folder: &str, extension: &str, word: &str, allowed: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in files(folder, extension) {
        let shown = path.strip_prefix(root()).unwrap().display().to_string();
        if allowed.iter().any(|prefix| shown.starts_with(prefix)) {
            continue;
        }
        let code =
            text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        let hits = code.filter(|(_, line)| line.contains(word));
        found.extend(hits.map(|(number, line)| format!("{shown}:{}: {}", number + 1, line.trim())));
    }
    found
}

fn nowhere(found: impl AsRef<[String]>) {
    let found = found.as_ref();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn only_the_gpu_executor_names_wgpu() {
    nowhere(outside("host/src", "rs", "wgpu", &["host/src/exec/gpu/"]));
    nowhere(outside("brdf-sdk", "rs", "wgpu", &[]));
}

#[test]
fn only_the_window_names_egui() {
    nowhere(outside("host/src", "rs", "egui", &["host/src/ui/"]));
    nowhere(outside("host/src", "rs", "eframe", &["host/src/ui/"]));
    nowhere(outside("brdf-sdk", "rs", "egui", &[]));
}

/// The lint refuses `unsafe` everywhere but where a native library is opened, called, or exports itself.
#[test]
fn unsafe_stands_at_the_border_alone() {
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    assert!(workspace.contains("unsafe_code = \"deny\""));
    let border =
        ["host/src/native/call.rs", "host/src/native/library.rs", "brdf-sdk/src/native/export.rs"];
    for folder in ["host", "brdf-sdk", "tests", "plugins"] {
        nowhere(outside(folder, "rs", &["allow(unsafe", "_code"].concat(), &border));
        nowhere(outside(folder, "rs", &["expect(unsafe", "_code"].concat(), &[]));
    }
}

/// The cosine and the horizon test occur in scatter.wgsl only; plugins have theirs in the model.
#[test]
fn the_cosine_stands_in_one_shader() {
    for word in ["wi.z", "wo.z", "_cos("] {
        // The density of the cosine, and the angle of a view.
        let mut found = outside(
            "shaders",
            "wgsl",
            word,
            &["shaders/scatter.wgsl", "shaders/cosine.wgsl", "shaders/lobes.wgsl"],
        );
        // Whoever calls it does not multiply.
        found.retain(|line| !line.contains("= brdf_cos("));
        nowhere(found);
    }
    nowhere(outside("plugins/integrator", "wgsl", "wi.z", &[]));
    let scatter = fs::read_to_string(root().join("shaders/scatter.wgsl")).unwrap();
    assert_eq!(scatter.matches("wi.z > 0.0").count(), 1);
    assert_eq!(scatter.matches("* max(wi.z, 0.0)").count(), 1);
}

/// What each module of the host may name of the others, and does; a module stands below all that it names, so that the
/// dependencies run one way and there are no cycles.
const MAY_NAME: &str = "
    # What knows nothing of the host, or of files, words and the colour space alone.
    file:
    held:
    layout:
    native: file held
    scene: file
    template:
    tone:
    measure: tone
    environment: file layout tone

    # From a folder to a program that runs. Of `native`, `plugin` has the library behind it, `link` how arrays lie.
    plugin: native
    registry: file native plugin template
    link: native plugin
    exec: link

    # What programs give. Of `link` they take the views, of `exec` what a machine is.
    data: exec held link native plugin
    render: data environment exec link measure plugin scene
    numerics: data link plugin
    tabulation: exec link plugin render
    plot: exec link numerics plugin render tone
    picture: file render scene tone
    figure: picture plot tone
    conformance: environment exec file link measure numerics plugin render scene
    catalogue: environment exec link picture plot plugin render scene tone

    # Whole scenes. A session names things and opens none; of `native` it asks which files a plugin reads, of `render`
    # it has the settings.
    session: layout native plugin registry render scene tone
    open: environment exec file picture registry render scene session
    bench: environment exec file layout link measure native open picture plugin registry render scene session tone

    # What people look at. The window computes nothing: its questions go to a desk, which hands them a machine of `exec`.
    live: environment exec link open picture plot plugin registry render scene session
    ui: conformance environment exec figure layout link live measure numerics open picture plot plugin registry render \
        scene session template tone
    cli: *
";

/// The table's lines: a module, and what it may name.
fn table() -> Vec<(&'static str, Vec<&'static str>)> {
    let lines = MAY_NAME.lines().map(str::trim).filter(|line| !line.starts_with('#'));
    let entry = |line: &'static str| {
        let (module, names) = line.split_once(':')?;
        Some((module, names.split_whitespace().collect()))
    };
    lines.filter_map(entry).collect()
}

/// The modules that are fuzzed as a crate of their own, which no other build sees, name no others.
#[test]
fn what_is_fuzzed_stands_alone() {
    let text = fs::read_to_string(root().join("fuzz/host/lib.rs")).unwrap();
    let modules: BTreeSet<&str> =
        text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert!(modules.len() > 4);
    for (module, names) in table() {
        let missing: Vec<_> = names.into_iter().filter(|name| !modules.contains(name)).collect();
        assert!(!modules.contains(module) || missing.is_empty(), "{module} names {missing:?}");
    }
}

/// The text without comments and without unit tests, which may name what they like.
fn code(path: &Path, text: &str) -> String {
    let in_tests = path.file_stem().is_some_and(|stem| stem == "tests")
        || path.parent().is_some_and(|folder| folder.ends_with("tests"));
    if in_tests {
        return String::new();
    }
    let mut lines: Vec<&str> = Vec::new();
    for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
        if line.contains("mod tests {") && lines.last() == Some(&"#[cfg(test)]") {
            break;
        }
        lines.push(line);
    }
    lines.join("\n")
}

/// The modules that code names by `crate::name`, or in the first layer of `crate::{name::.., name}`.
fn named(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let word = |text: &str| -> String {
        text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    for (at, start) in code.match_indices("crate::") {
        let rest = &code[at + start.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            found.insert(word(rest));
            continue;
        };
        let (mut depth, mut begins) = (1, true);
        for (at, c) in list.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => begins = true,
                c if begins && !c.is_whitespace() => {
                    found.insert(word(&list[at..]));
                    begins = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    found
}

/// Every module of the host with what it names of the others.
fn modules() -> BTreeMap<String, BTreeSet<String>> {
    let source = root().join("host/src");
    let mut modules: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, text) in files("host/src", "rs") {
        let inside = path.strip_prefix(&source).unwrap();
        let first = inside.iter().next().unwrap().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        if ["lib", "main"].contains(&module) {
            continue;
        }
        let code = code(&path, &text);
        // The first `super` of a module's own file is the crate.
        let climbs = if inside.ends_with("mod.rs") || inside.iter().count() == 1 { 1 } else { 2 };
        if inside.iter().count() <= 2 {
            let out = "super::".repeat(climbs);
            assert!(!code.contains(&out), "{} leaves its module by {out}", path.display());
        }
        let names = modules.entry(module.to_owned()).or_default();
        names.extend(named(&code).into_iter().filter(|name| name != module));
    }
    modules
}

#[test]
fn names_are_found_in_every_form_of_use() {
    let code =
        "use crate::a::{b, c};\nuse crate::{\n    d::{e, f},\n    g,\n};\nlet x = crate::h::i();";
    let found: Vec<String> = named(code).into_iter().collect();
    assert_eq!(found, ["a", "d", "g", "h"]);
}

/// Dependencies run one way inside the host: each module names what its line in the table says, and no line says more.
#[test]
fn dependencies_run_one_way() {
    let (modules, table) = (modules(), table());
    let mut wrong = Vec::new();
    for module in modules.keys().filter(|module| table.iter().all(|(known, _)| known != module)) {
        wrong.push(format!("`{module}` is not in the table: what may it name?"));
    }
    for (index, (module, allowed)) in table.iter().enumerate() {
        let Some(names) = modules.get(*module) else {
            wrong.push(format!("the table has `{module}`, and the host has not"));
            continue;
        };
        if allowed == &["*"] {
            continue;
        }
        for name in names.iter().filter(|name| !allowed.contains(&name.as_str())) {
            wrong.push(format!("`{module}` names `{name}`"));
        }
        for name in allowed {
            if !names.contains(*name) {
                wrong.push(format!("`{module}` may name `{name}`, and does not"));
            }
            if table[..index].iter().all(|(above, _)| above != name) {
                wrong.push(format!("`{name}` does not stand above `{module}`"));
            }
        }
    }
    nowhere(wrong);
    nowhere(outside("brdf-sdk", "rs", "brdf_host", &[]));
    nowhere(outside("brdf-sdk/wgsl-cpu", "rs", "brdf_sdk", &[]));
}

/// Every file opens with what it is.
#[test]
fn files_say_what_they_are() {
    for (folder, extension, head) in [
        ("host", "rs", "//!"),
        ("brdf-sdk", "rs", "//!"),
        ("plugins/native", "rs", "//!"),
        ("tests", "rs", "//!"),
        ("benches", "rs", "//!"),
        ("shaders", "wgsl", "// "),
        ("plugins", "wgsl", "// "),
        ("host/src/templates", "wgsl", "// "),
    ] {
        let files = files(folder, extension).into_iter();
        let dumb = files.filter(|(_, text)| !text.starts_with(head));
        let told = dumb.map(|(path, _)| format!("{} does not begin with {head}", path.display()));
        nowhere(told.collect::<Vec<_>>());
    }
}

/// The kernel rules: no workgroup memory, barriers, samplers or derivatives in any shader or plugin.
#[test]
fn kernels_keep_to_the_rules() {
    for folder in ["shaders", "plugins"] {
        for word in
            ["var<workgroup>", "Barrier(", "textureSample", "dpdx", "subgroup", "ptr<storage"]
        {
            nowhere(outside(folder, "wgsl", word, &[]));
        }
    }
}

/// No list of plugins exists anywhere: a plugin is named in its own folder, or as somebody's default.
#[test]
fn no_list_of_plugins_exists() {
    for (path, text) in files("host/src", "rs") {
        let both = text.contains("\"lambert\"") && text.contains("\"ggx\"");
        assert!(!both, "{} lists plugins", path.display());
    }
}

#[test]
fn files_stay_small() {
    for folder in ["host/src", "brdf-sdk/src", "brdf-sdk/wgsl-cpu/src", "shaders", "plugins"] {
        for extension in ["rs", "wgsl"] {
            if folder.contains("src") != (extension == "rs") {
                continue;
            }
            for (path, text) in files(folder, extension) {
                let lines = text.lines().count();
                assert!(lines <= 450, "{} has {lines} lines", path.display());
            }
        }
    }
}
