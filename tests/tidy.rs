//! The invariants of the source tree: who may name what, and what stands in one place only.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

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

/// Dependencies run one way inside the host: a lower layer does not name a higher one.
#[test]
fn dependencies_run_one_way() {
    let above: [(&str, &[&str]); 20] = [
        (
            "link",
            &[
                "exec",
                "render",
                "cli",
                "session",
                "scene",
                "environment",
                "picture",
                "measure",
                "registry",
                "open",
            ],
        ),
        (
            "exec",
            &[
                "render",
                "cli",
                "session",
                "scene",
                "environment",
                "picture",
                "measure",
                "registry",
                "open",
            ],
        ),
        (
            "scene",
            &[
                "link",
                "exec",
                "render",
                "cli",
                "session",
                "environment",
                "picture",
                "measure",
                "registry",
                "open",
            ],
        ),
        (
            "environment",
            &[
                "link", "exec", "render", "cli", "session", "scene", "picture", "measure",
                "registry", "open",
            ],
        ),
        (
            "registry",
            &[
                "link",
                "exec",
                "render",
                "cli",
                "session",
                "scene",
                "environment",
                "picture",
                "measure",
                "open",
            ],
        ),
        (
            "numerics",
            &[
                "exec",
                "render",
                "cli",
                "session",
                "scene",
                "environment",
                "picture",
                "measure",
                "registry",
                "open",
            ],
        ),
        (
            "native",
            &[
                "link",
                "exec",
                "render",
                "cli",
                "session",
                "scene",
                "environment",
                "picture",
                "measure",
                "registry",
                "open",
                "plugin",
                "tables",
                "data",
            ],
        ),
        ("data.rs", &["render", "cli", "session", "registry", "open"]),
        ("fit.rs", &["render", "cli", "session", "registry", "open"]),
        ("conformance", &["cli", "session", "picture", "registry", "open"]),
        ("tables.rs", &["exec", "render", "cli", "session", "registry", "open"]),
        ("render", &["cli", "session", "picture", "measure", "registry", "open"]),
        ("measure", &["cli", "session", "picture", "registry", "open", "exec", "link"]),
        ("picture", &["cli", "session", "registry", "open", "exec", "link", "measure"]),
        ("plot", &["cli", "session", "registry", "open", "measure", "scene", "picture"]),
        ("figure.rs", &["cli", "session", "registry", "open", "measure", "scene", "live", "ui"]),
        ("tone.rs", &["cli", "session", "registry", "open", "measure", "picture", "render", "ui"]),
        ("live", &["cli", "ui"]),
        ("catalogue", &["cli", "session", "registry", "open", "measure"]),
        ("session.rs", &["cli", "exec", "link", "environment", "picture", "measure", "open"]),
    ];
    for (module, forbidden) in above {
        for (path, text) in files("host/src", "rs") {
            if !path.starts_with(root().join("host/src").join(module)) {
                continue;
            }
            for other in forbidden {
                let names = format!("crate::{other}");
                assert!(!text.contains(&names), "{} names {names}", path.display());
            }
        }
    }
    let users = [
        "host/src/cli/",
        "host/src/conformance/",
        "host/src/numerics/",
        "host/src/plot/",
        "host/src/ui/",
    ];
    nowhere(outside("host/src", "rs", "crate::numerics", &users));
    // The laws know nothing of plugins' folders, pictures or people.
    nowhere(outside(
        "host/src",
        "rs",
        "crate::conformance",
        &["host/src/cli/", "host/src/conformance/", "host/src/ui/"],
    ));
    nowhere(outside("brdf-sdk", "rs", "brdf_host", &[]));
    nowhere(outside("brdf-sdk/wgsl-cpu", "rs", "brdf_sdk", &[]));
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
