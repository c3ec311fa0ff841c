//! The catalogue of BRDFs as a page with pictures, made from the plugins alone.
//!
//! A [`Workshop`] makes an [`Entry`] of each BRDF: a sphere and its lobes, both on the CPU executor, so
//! that a catalogue can be made again bit for bit on any machine. A [`Catalogue`] of entries is written
//! to a folder, or held against what lies there. The texts are the manifests'; nothing is known here of
//! any one BRDF, and nothing is looked up: plugins and the map are handed in.

mod escape;
mod folder;
mod lobe;
mod page;
mod sphere;
mod svg;

use std::sync::Arc;

use brdf_sdk::Result;

use crate::environment::Environment;
use crate::exec::cpu::Cpu;
use crate::exec::{Executor, Precision};
use crate::link::{Function, functions};
use crate::picture::Raster;
use crate::plugin::{Configured, Plugin};

pub use folder::Catalogue;

/// The recipe under which spheres are shown.
pub const RECIPE: &str = "studio";
/// The integrator that renders them.
pub const INTEGRATOR: &str = "mis-balance";

/// What makes entries: two executors, and the scene on one of them.
pub struct Workshop {
    booth: sphere::Booth,
    exact: Cpu,
}

/// What the catalogue has of one BRDF.
#[derive(Debug, Clone)]
pub struct Entry {
    plugin: Arc<Plugin>,
    /// Those that the author gave and the host calls.
    functions: Vec<Function>,
    sphere: Raster,
    /// An SVG.
    lobes: String,
    /// Directions whose value is no part of a curve, since it is negative or not finite.
    left_out: usize,
    /// What is worth telling of the making, each thing once.
    pub notes: Vec<String>,
}

impl Workshop {
    /// Opens it with a map for the spheres and the integrator that renders them.
    ///
    /// # Errors
    /// Where the map does not fit the memory.
    pub fn new(environment: Arc<Environment>, integrator: Configured) -> Result<Self> {
        let booth = sphere::Booth::new(environment, integrator)?;
        Ok(Self { booth, exact: Cpu::new(Precision::F64) })
    }

    /// Renders a BRDF with its defaults and traces its lobes.
    ///
    /// # Errors
    /// Where the plugin does not link or run.
    pub fn entry(&mut self, plugin: &Arc<Plugin>) -> Result<Entry> {
        let brdf = Configured::new(Arc::clone(plugin));
        let (functions, _) = functions(&brdf)?;
        let (sphere, mut notes) = self.booth.picture(&brdf)?;
        let lobes = lobe::lobes(&mut self.exact, &brdf)?;
        notes.extend(self.exact.take_notes());
        Ok(Entry {
            plugin: Arc::clone(plugin),
            functions,
            sphere,
            left_out: lobes.iter().map(|lobe| lobe.left_out).sum(),
            lobes: svg::drawing(&plugin.manifest.name, &lobes),
            notes,
        })
    }
}
