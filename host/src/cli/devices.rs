//! `brdf devices`: the adapters of this machine.

use brdf_sdk::Result;

use super::print;
use crate::exec::gpu;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let adapters = gpu::list();
    if arguments.json {
        let rows: Vec<_> = adapters
            .iter()
            .map(|a| {
                serde_json::json!({
                    "index": a.index, "name": a.name, "backend": a.backend, "kind": a.kind, "driver": a.driver
                })
            })
            .collect();
        return print(&format!("{}\n", serde_json::Value::Array(rows)));
    }
    if adapters.is_empty() {
        return print(
            "no adapter: install a graphics driver; the software one is \
             `apt-get install mesa-vulkan-drivers` on Debian\n",
        );
    }
    let rows: String = adapters
        .iter()
        .map(|a| format!("{}  {} ({}, {}; {})\n", a.index, a.name, a.backend, a.kind, a.driver))
        .collect();
    print(&rows)
}
