//! The choice of an executor: the one that is named, else the best adapter, else the cores.

use brdf_sdk::{Problem, Result};

use super::cpu::{self, Cpu};
use super::gpu::{self, Gpu};
use super::{Executor, Precision};

/// The name by which `--device` means the CPU executor.
pub const CPU: &str = "cpu";

/// Whether a graphics adapter is there.
pub fn has_adapter() -> bool {
    !gpu::list().is_empty()
}

/// An executor, and what is worth telling about its choice.
pub struct Opened {
    /// The executor.
    pub executor: Box<dyn Executor>,
    /// One line where it was not the user's own choice.
    pub note: Option<String>,
}

/// Opens the device that `choice` names: `cpu`, or an adapter by its index or a part of its name.
/// Without a name the best adapter, or the CPU executor where there is none or f64 is asked for.
///
/// # Errors
/// Where there is no such device, it does not open, or it has no f64.
pub fn open(choice: Option<&str>, precision: Precision) -> Result<Opened> {
    let on_cpu = |note| Ok(Opened { executor: Box::new(Cpu::new(precision)), note });
    match choice {
        Some(name) if name.eq_ignore_ascii_case(CPU) => on_cpu(None),
        Some(name) if precision == Precision::F64 => Err(Problem::new(
            format!("--device {name}"),
            "f64 runs on the CPU executor alone",
            "write --device cpu, or leave --precision out",
        )),
        None if precision == Precision::F64 => on_cpu(None),
        None if gpu::list().is_empty() => {
            on_cpu(Some(format!("no graphics adapter here: running on the {}", cpu::describe())))
        }
        _ => Ok(Opened { executor: Box::new(Gpu::open(choice)?), note: None }),
    }
}
