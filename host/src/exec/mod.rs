//! The machines that run a linked program: the same few calls for each of them.
//!
//! An executor holds buffers, textures and kernels under ids, runs dispatches and reads results
//! back. It knows nothing of BRDFs, pictures or time budgets; of the host it may name link alone.

pub mod cpu;
pub mod gpu;
pub mod memory;
mod open;
mod readout;

use std::sync::Arc;
use std::time::Duration;

use brdf_sdk::{Problem, Result};
pub use open::{CPU, Opened, has_adapter, open};
pub use readout::Readout;

use crate::link::{BindingKind, Program};

/// What the floats of a program are while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Precision {
    /// f32, on any device
    #[default]
    F32,
    /// f64, on the CPU executor: the oracle of the same program
    F64,
}

impl Precision {
    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

impl From<Precision> for wgsl_cpu::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self::F32,
            Precision::F64 => Self::F64,
        }
    }
}

/// A machine that runs programs.
pub trait Executor: Send {
    /// Its name for reports.
    fn name(&self) -> &str;

    /// What its programs' floats are.
    fn precision(&self) -> Precision {
        Precision::F32
    }

    /// Whether it was lost or given up; then only a new one helps.
    fn is_gone(&self) -> bool;

    /// Whether a program shall be tried out elsewhere before this machine sees it: a driver that
    /// meets an endless loop may take the whole device with it.
    fn wants_trial(&self) -> bool;

    /// What it can hold.
    fn limits(&self) -> Limits;

    /// Prepares a program for dispatches, the driver's own compiler included.
    fn compile(&mut self, program: Arc<Program>) -> Result<KernelId>;

    /// A buffer of zeros.
    fn buffer(&mut self, kind: BindingKind, bytes: usize) -> Result<ResourceId>;

    /// A 2D texture of four f32 per texel, row by row from the top.
    fn texture(&mut self, size: [u32; 2], texels: Arc<Vec<[f32; 4]>>) -> Result<ResourceId>;

    /// A list of four f32 each, in whole rows of a texture of that size and kind; the machine keeps it as it reads it
    /// best. Where the kind is one of words, the floats are their bits.
    fn list(
        &mut self,
        _: BindingKind,
        size: [u32; 2],
        texels: Arc<Vec<[f32; 4]>>,
    ) -> Result<ResourceId> {
        self.texture(size, texels)
    }

    /// A buffer that programs only read, with these words in it.
    fn words(&mut self, kind: BindingKind, words: Arc<[u32]>) -> Result<ResourceId>;

    /// Replaces the first bytes of a buffer.
    fn write(&mut self, buffer: ResourceId, bytes: Vec<u8>) -> Result<()>;

    /// Runs a kernel, waits for its end, and says how long it took.
    fn dispatch(
        &mut self,
        kernel: KernelId,
        bound: &[Bound<'_>],
        invocations: u32,
    ) -> Result<Duration>;

    /// The first bytes of a buffer.
    fn read(&mut self, buffer: ResourceId, bytes: usize) -> Result<Readout>;

    /// Seconds that all dispatches so far took by the machine's own clock, without the way there and back; none where it
    /// has none.
    fn device_seconds(&mut self) -> Option<f64>;

    /// Takes something up that is worth telling the user.
    fn note(&mut self, note: String);

    /// What is worth telling of the programs run since the last call; each thing once.
    fn take_notes(&mut self) -> Vec<String>;

    /// Frees a buffer or a texture.
    fn free(&mut self, resource: ResourceId);

    /// Frees a kernel.
    fn forget(&mut self, kernel: KernelId);
}

/// A variable of the program and what stands behind it. Variables that the program does not reach
/// are passed over.
pub type Bound<'a> = (&'a str, ResourceId);

/// A prepared program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct KernelId(pub(crate) u64);

/// A buffer or a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ResourceId(pub(crate) u64);

/// What an executor can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the largest storage buffer.
    pub buffer_bytes: u64,
    /// Bytes that all resources together may take.
    pub total_bytes: u64,
    /// Invocations that keep it busy to the end of a dispatch; 1 where more of them gain nothing.
    pub parallel: u32,
}

/// A variable of the program with nothing behind it.
fn unbound(name: &str) -> Problem {
    Problem::new(name, "the program binds it and nothing stands behind it", "report this")
}
