//! What this program is: its version, the commit it was built from, and what was built into it. Nothing here looks
//! for a device; that is `brdf devices`.

use std::sync::LazyLock;

use brdf_sdk::manifest;
use brdf_sdk::native::abi;

use crate::exec::gpu;

/// Version and commit on one line.
pub(super) const SHORT: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("BRDF_COMMIT"), ")");

/// The one line, and what was built in.
pub(super) static LONG: LazyLock<String> = LazyLock::new(|| {
    let mut interfaces = gpu::interfaces();
    interfaces.push("the CPU executor in f32 and f64");
    format!(
        "{SHORT}\nbuild: {} for {}\nrenders by: {}\nreads: manifests of format {}, native tables of version {}",
        env!("BRDF_PROFILE"),
        env!("BRDF_TARGET"),
        interfaces.join(", "),
        manifest::FORMAT,
        abi::VERSION,
    )
});
