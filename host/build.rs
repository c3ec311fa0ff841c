//! Gathers the plugins, recipes and hard scenes of the source tree, so that the binary works from any folder.
//!
//! It takes every plugin folder that is there: no list of plugins exists anywhere.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
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
    Ok(())
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
