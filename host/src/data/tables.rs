//! Tables that a BRDF asks the host to fill before it is used: directional albedos and the like.
//!
//! The manifest names a table and its size, the author's `fill_<name>(at)` gives its entries, and the
//! plugin's other functions read them by `<name>_at(i)`. Entries are computed on the cores in f64, once for
//! each choice of a plugin's switches, however often it is linked.

use std::sync::Arc;

use brdf_sdk::{Problem, Result};
use naga::ResourceBinding;
use wgsl_cpu::{Failure, Precision, Resource, Run, Storage};

use crate::link::{View, link};
use crate::plugin::Configured;

/// The variable that holds all tables of a BRDF, one after the other.
pub const VARIABLE: &str = "brdf_tables";

/// Instructions of a batch of entries in loops: some seconds.
const FUEL: u64 = 1 << 31;

/// The entries of all tables of a BRDF, one table after the other, as bits of f32.
///
/// # Errors
/// What linking refuses, a fill that does not come to an end, and entries that are not finite.
pub fn filled(brdf: &Configured) -> Result<Arc<[u32]>> {
    brdf.plugin.tables.at(&brdf.constants(), || {
        let mut all = Vec::new();
        for table in 0..brdf.plugin.manifest.tables.len() {
            fill(brdf, table, &mut all)?;
        }
        Ok(all)
    })
}

fn fill(brdf: &Configured, table: usize, all: &mut Vec<u32>) -> Result<()> {
    let declared = &brdf.plugin.manifest.tables[table];
    let [width, height] = declared.size;
    let count = (width * height) as usize;
    let program = link(&View::Table { brdf: brdf.clone(), table })?;
    let at = |reason: String, cure: &str| {
        Problem::new(&brdf.plugin.wgsl_file, format!("`fill_{}`: {reason}", declared.name), cure)
    };
    let layout = program.required_layout("entries");
    let machine = wgsl_cpu::Program::new(&program.module, &program.types()?)
        .map_err(|refusal| program.refused(&refusal, refusal.span))?;
    let entries = Storage::new(count * layout.stride / 4, true);
    let mut resources = Vec::new();
    for binding in &program.bindings {
        if binding.name != "entries" {
            return Err(at(
                format!("it reads `{}`", binding.name),
                "compute each entry from `at` and from switches and choices: numbers change and tables do not",
            ));
        }
        let binding = ResourceBinding { group: 0, binding: binding.index };
        resources.push((binding, Resource::Storage(&entries)));
    }
    let groups = program.groups(count as u32);
    let run = Run { resources: &resources, groups, fuel: FUEL, set: None, lanes: None };
    machine.run(Precision::F64, &run).map_err(|failure| match failure {
        Failure::Stopped(stopped) => program.problem(
            stopped.span,
            "this loop does not come to an end while a table is filled",
            "look at its condition, or give it a smaller bound",
        ),
        other => at(other.to_string(), "report this"),
    })?;
    let first = layout.at("value") / 4;
    for entry in 0..count {
        let value = entries.float(entry * layout.stride / 4 + first).unwrap_or(f64::NAN) as f32;
        if !value.is_finite() {
            let place = [entry as u32 % width, entry as u32 / width];
            return Err(at(
                format!("entry {place:?} is {value}"),
                "return a finite number for every `at` in [0, 1]^2",
            ));
        }
        all.push(value.to_bits());
    }
    Ok(())
}
