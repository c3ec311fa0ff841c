//! Gathers the plugins, recipes and hard scenes of the source tree, so that the binary works from any folder, and
//! says which commit it is built from.
//!
//! It takes every plugin folder that is there: no list of plugins exists anywhere.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("..");
    let mut table = String::from("pub const FILES: &[(&str, &str)] = &[\n");
    for (folder, extensions) in [
        ("plugins/brdf", ["toml", "wgsl"]),
        ("plugins/integrator", ["toml", "wgsl"]),
        ("envmaps", ["toml", "toml"]),
        ("examples/hard", ["toml", "wgsl"]),
    ] {
        println!("cargo:rerun-if-changed={}", root.join(folder).display());
        let mut files = Vec::new();
        gather(&root.join(folder), &mut files)?;
        files.sort();
        for file in files {
            let wanted = file.extension().is_some_and(|e| extensions.iter().any(|x| e == *x));
            if wanted {
                let name = file.strip_prefix(&root)?.to_string_lossy().replace('\\', "/");
                let path = file.canonicalize()?;
                writeln!(table, "    ({name:?}, include_str!({path:?})),")?;
            }
        }
    }
    table.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR")?).join("embedded.rs"), table)?;
    let profile = env::var("PROFILE")?;
    println!("cargo:rustc-env=BRDF_COMMIT={}", commit(&root, &profile));
    println!("cargo:rustc-env=BRDF_PROFILE={profile}");
    println!("cargo:rustc-env=BRDF_TARGET={}", env::var("TARGET")?);
    Ok(())
}

/// The commit, and whether files differ from it. Builds for development do not ask: each commit would
/// compile the program again.
fn commit(root: &Path, profile: &str) -> String {
    if profile != "release" {
        return "development build".to_owned();
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok().filter(|_| output.status.success())?;
        Some(text.trim().to_owned())
    };
    // A copy without its history, perhaps within somebody else's.
    let here = git(&["ls-files", "--error-unmatch", "host/build.rs"]).is_some();
    let Some(hash) = git(&["rev-parse", "--short=10", "HEAD"]).filter(|_| here) else {
        return "commit unknown".to_owned();
    };
    // Whoever commits, or edits what the program is made of, makes cargo ask again.
    for moved in ["HEAD", "logs/HEAD"] {
        if let Some(file) = git(&["rev-parse", "--path-format=absolute", "--git-path", moved]) {
            println!("cargo:rerun-if-changed={file}");
        }
    }
    for folder in ["Cargo.lock", "brdf-sdk", "host/src", "plugins", "shaders"] {
        println!("cargo:rerun-if-changed={}", root.join(folder).display());
    }
    let clean =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|s| s.is_empty());
    format!("commit {hash}{}", if clean { "" } else { ", edited" })
}

fn gather(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            gather(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}
