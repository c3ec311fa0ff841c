//! Speed against error: every integrator on every case, in growing passes against a reference, timed in turns.
//!
//! A [`Plan`] says what is measured, [`run`] measures it, a [`Report`] holds what was found: written as JSON it is what a
//! later one is compared with ([`changes`]). Errors follow from the plan and its seed alone; times are medians of
//! repeated runs, told with their spread and beside a kernel that is the same everywhere (`calibration`).
//!
//! It renders as everybody does, by `render`; it never names cli or ui, and prints nothing.

mod calibration;
mod case;
mod changes;
mod errors;
mod figures;
mod measured;
mod plan;
mod preset;
mod recommend;
mod reference;
mod report;
mod run;
mod scenes;
mod spread;

use std::path::PathBuf;

pub use case::Case;
pub use changes::{Change, changes, times_are_compared};
pub use errors::Errors;
pub use plan::{Limits, Plan, Row, samplers};
pub use preset::Preset;
pub use recommend::{Trial, recommend};
pub use report::{CaseReport, CellReport, DeviceReport, PLAIN, Report, Step};
pub use run::{Pictured, Ran, Wanted, run};
pub use scenes::scenes;
pub use spread::Spread;

/// The program's part of the platform's folder for what can be made again.
fn cache() -> Option<PathBuf> {
    use etcetera::BaseStrategy;
    Some(etcetera::choose_base_strategy().ok()?.cache_dir().join("brdf"))
}
