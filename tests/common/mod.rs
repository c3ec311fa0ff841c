//! What several test targets share: where things lie, the registry, a device if there is one.

#![allow(dead_code, reason = "each test target uses its own part of this")]

pub mod native;
pub mod program;
pub mod shot;
pub mod wide;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::gpu::Gpu;
use brdf_host::exec::{Executor, Precision};
use brdf_host::plugin::{Configured, Plugin};
use brdf_host::registry::Registry;
use brdf_host::session::Chosen;
use brdf_sdk::{Kind, Manifest};

/// The root of the source tree.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// The plugins of the source tree, and those that only tests use; their native libraries are the tree's own.
pub fn registry() -> Registry {
    Registry::new(&[root().join("plugins"), root().join("tests/fixtures")]).allowing_native(true)
}

/// A plugin of the source tree with some parameters set.
pub fn plugin(kind: Kind, name: &str, set: &[&str]) -> Configured {
    let mut configured = Chosen::find(&registry(), kind, name).unwrap().configured;
    let manifest = configured.plugin.manifest.clone();
    for assignment in set {
        configured.values.set_text(&manifest, assignment).unwrap();
    }
    configured
}

pub fn brdf(name: &str, set: &[&str]) -> Configured {
    plugin(Kind::Brdf, name, set)
}

pub fn integrator(name: &str, set: &[&str]) -> Configured {
    plugin(Kind::Integrator, name, set)
}

/// A plugin from text alone.
pub fn from_text(id: &str, manifest: &str, source: &str) -> Configured {
    let manifest = Manifest::parse("plugin.toml", manifest, id).unwrap();
    let wgsl_file = format!("{id}.wgsl");
    Configured::new(Arc::new(Plugin {
        id: id.to_owned(),
        manifest,
        wgsl_file,
        source: source.into(),
        tables: Default::default(),
        native: None,
    }))
}

/// The CPU executor, and the graphics adapter of this machine if it has one: what is said of one
/// holds for both.
pub fn devices() -> Vec<Box<dyn Executor>> {
    let mut devices: Vec<Box<dyn Executor>> = vec![Box::new(Cpu::new(Precision::F32))];
    if let Some(gpu) = gpu() {
        devices.push(Box::new(gpu));
    }
    devices
}

/// The graphics adapter, or a line that says why the test runs without.
pub fn gpu() -> Option<Gpu> {
    if brdf_host::exec::gpu::list().is_empty() {
        skip("on a graphics adapter: this machine has none");
        return None;
    }
    Some(Gpu::open(None).expect("the adapter opens"))
}

/// The folder of outside data, or a line that says why the test is skipped.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("BRDF_TEST_DATA").map(PathBuf::from);
    if folder.is_none() {
        skip("BRDF_TEST_DATA names no folder of outside data");
    }
    folder
}

pub fn skip(reason: &str) {
    // Past the test runner's capture, so that every skip is seen.
    use std::io::Write;
    let name = std::thread::current().name().unwrap_or("a test").to_owned();
    let _ = writeln!(std::io::stderr(), "skipped {name}: {reason}");
}
