//! `brdf devices`: what can render on this machine.

use brdf_sdk::Result;

use super::print;
use crate::exec::{CPU, cpu, gpu};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let adapters = gpu::list();
    if arguments.json {
        let mut rows: Vec<_> = adapters
            .iter()
            .map(|a| {
                serde_json::json!({
                    "index": a.index, "name": a.name, "backend": a.backend, "kind": a.kind, "driver": a.driver
                })
            })
            .collect();
        rows.push(serde_json::json!({
            "index": CPU, "name": cpu::describe(), "backend": CPU, "kind": "CPU executor", "driver": ""
        }));
        return print(&format!("{}\n", serde_json::Value::Array(rows)));
    }
    let mut rows: String = adapters
        .iter()
        .map(|a| format!("{:<3}  {} ({}, {}; {})\n", a.index, a.name, a.backend, a.kind, a.driver))
        .collect();
    rows += &format!("{CPU}  {} (f32 and f64, no driver)\n", cpu::describe());
    print(&rows)
}
