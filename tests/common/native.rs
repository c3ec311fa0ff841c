//! Native libraries for tests: built by cargo where they lie, or by rustc from a few lines.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// What the system calls the library of that name.
pub fn file_name(name: &str) -> String {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    format!("{prefix}{name}{suffix}")
}

/// Runs `cargo build --release` in a folder, without a network.
pub fn cargo_build(folder: &Path) -> Output {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--offline", "--quiet"]).current_dir(folder);
    // The plugin's own folder is where its manifest expects the library.
    command.env_remove("CARGO_TARGET_DIR").output().unwrap()
}

/// Builds the crate in a folder, whose library its plugin.toml names; returns the folder.
pub fn built(folder: PathBuf) -> PathBuf {
    let output = cargo_build(&folder);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// Compiles one source file to a library in a folder.
pub fn compiled(folder: &Path, name: &str, source: &str) {
    let file = folder.join(format!("{name}.rs"));
    fs::write(&file, source).unwrap();
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc)
        .args(["--edition", "2024", "--crate-type", "cdylib", "--crate-name", name, "-o"])
        .arg(folder.join(file_name(name)))
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A plugin folder that reads one array of its library.
pub fn plugin(folder: &Path, library: &str, entry: &str) -> PathBuf {
    let own = folder.join(entry);
    fs::create_dir_all(&own).unwrap();
    let manifest = format!(
        "kind = \"brdf\"\nname = \"Case\"\nabout = \"For a test.\"\nlibrary = \"{library}\"\n\
         entry = \"{entry}\"\n\n[arrays.values]\ntype = \"f32\"\n"
    );
    fs::write(own.join("plugin.toml"), manifest).unwrap();
    let eval = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    return vec3f(values_at(0u));\n}\n";
    fs::write(own.join(format!("{entry}.wgsl")), eval).unwrap();
    own
}
