//! The executor on this machine's own cores: the same program, no GPU and no driver.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};
use naga::ResourceBinding;
use wgsl_cpu::{Failure, Resource, Run, Storage, VectorSet};

use super::{Bound, Executor, KernelId, Limits, Precision, Readout, ResourceId, memory};
use crate::link::{BindingKind, Program};

/// Instructions of a batch that no loop of an honest program comes near.
const FUEL: u64 = 1 << 40;

/// Threads with kernels and what they read and write.
pub struct Cpu {
    name: String,
    precision: Precision,
    fuel: u64,
    budget: u64,
    used: u64,
    next: u64,
    kernels: HashMap<KernelId, Kernel>,
    resources: HashMap<ResourceId, Held>,
    /// What is worth telling and was not told yet; in order, each thing once.
    notes: BTreeSet<String>,
}

struct Kernel {
    lowered: wgsl_cpu::Program,
    program: Arc<Program>,
}

impl Kernel {
    fn note_negative_bases(&self, notes: &mut BTreeSet<String>) {
        for (span, _) in self.lowered.take_negative_bases() {
            let reason = "`pow` of a negative base: NaN here, and anything on a device";
            let cure = "take `abs` or `max(x, 0.0)` of it";
            notes.insert(self.program.problem(span, reason, cure).line());
        }
    }
}

/// A buffer or a texture, and what it takes of the budget.
struct Held {
    bytes: u64,
    held: HeldAs,
}

enum HeldAs {
    Words(Vec<u32>),
    Shared(Arc<[u32]>),
    Storage(Storage),
    Texture { size: [u32; 2], texels: Arc<Vec<[f32; 4]>> },
}

impl Cpu {
    /// All cores, at a precision.
    pub fn new(precision: Precision) -> Self {
        Self {
            name: format!("{}, {}", describe(), precision.word()),
            precision,
            fuel: FUEL,
            budget: memory::budget(),
            used: 0,
            next: 0,
            kernels: HashMap::new(),
            resources: HashMap::new(),
            notes: BTreeSet::new(),
        }
    }

    /// For trying a program out: f32, and a loop that takes more than `fuel` instructions is an error.
    pub fn with_fuel(fuel: u64) -> Self {
        Self { fuel, ..Self::new(Precision::F32) }
    }

    fn new_id(&mut self) -> u64 {
        self.next += 1;
        self.next
    }

    /// Holds what `make` makes, if it fits.
    fn hold(&mut self, bytes: u64, make: impl FnOnce() -> HeldAs) -> Result<ResourceId> {
        let wanted = self.used.saturating_add(bytes);
        if wanted > self.budget {
            return Err(Problem::new(
                "the CPU executor",
                format!(
                    "{} are needed and {} may be used",
                    memory::shown(wanted),
                    memory::shown(self.budget)
                ),
                "lower --resolution",
            ));
        }
        self.used = wanted;
        let id = ResourceId(self.new_id());
        self.resources.insert(id, Held { bytes, held: make() });
        Ok(id)
    }
}

/// What the executor runs on, for reports and lists: `CPU (2 threads, AVX2)`.
pub fn describe() -> String {
    let threads = rayon::current_num_threads();
    let plural = if threads == 1 { "" } else { "s" };
    format!("CPU ({threads} thread{plural}, {})", VectorSet::best().name())
}

fn gone() -> Problem {
    Problem::new("the CPU executor", "a kernel or a resource is gone", "start again")
}

impl Executor for Cpu {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn is_gone(&self) -> bool {
        false
    }

    fn wants_trial(&self) -> bool {
        false
    }

    fn limits(&self) -> Limits {
        Limits { buffer_bytes: u64::from(u32::MAX), total_bytes: self.budget, parallel: 1 }
    }

    fn compile(&mut self, program: Arc<Program>) -> Result<KernelId> {
        let lowered = wgsl_cpu::Program::new(&program.module, &program.types()?)
            .map_err(|refusal| program.refused(&refusal, refusal.span))?;
        let id = KernelId(self.new_id());
        self.kernels.insert(id, Kernel { lowered, program });
        Ok(id)
    }

    fn buffer(&mut self, kind: BindingKind, bytes: usize) -> Result<ResourceId> {
        let words = bytes.div_ceil(4);
        let wide = self.precision == Precision::F64;
        match kind {
            BindingKind::ReadWrite => {
                let each = if wide { 12 } else { 4 };
                self.hold(words as u64 * each, || HeldAs::Storage(Storage::new(words, wide)))
            }
            _ => self.hold(words as u64 * 4, || HeldAs::Words(vec![0; words])),
        }
    }

    fn texture(&mut self, size: [u32; 2], texels: Arc<Vec<[f32; 4]>>) -> Result<ResourceId> {
        // The texels are the environment's own.
        self.hold(0, || HeldAs::Texture { size, texels })
    }

    fn words(&mut self, _: BindingKind, words: Arc<[u32]>) -> Result<ResourceId> {
        // The words are their maker's own.
        self.hold(0, || HeldAs::Shared(words))
    }

    fn write(&mut self, buffer: ResourceId, bytes: Vec<u8>) -> Result<()> {
        let words = || bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned::<u32>);
        match &mut self.resources.get_mut(&buffer).ok_or_else(gone)?.held {
            HeldAs::Words(target) => {
                target.iter_mut().zip(words()).for_each(|(target, word)| *target = word);
            }
            HeldAs::Storage(storage) => storage.write(&words().collect::<Vec<_>>()),
            HeldAs::Shared(_) | HeldAs::Texture { .. } => return Err(gone()),
        }
        Ok(())
    }

    fn dispatch(
        &mut self,
        kernel: KernelId,
        bound: &[Bound<'_>],
        invocations: u32,
    ) -> Result<Duration> {
        let kernel = self.kernels.get(&kernel).ok_or_else(gone)?;
        let mut resources = Vec::new();
        for binding in &kernel.program.bindings {
            let named = bound.iter().find(|(name, _)| *name == binding.name);
            let (_, id) = named.ok_or_else(|| super::unbound(&binding.name))?;
            let resource = match &self.resources.get(id).ok_or_else(gone)?.held {
                HeldAs::Words(words) => Resource::Words(words),
                HeldAs::Shared(words) => Resource::Words(words),
                HeldAs::Storage(storage) => Resource::Storage(storage),
                HeldAs::Texture { size, texels } => Resource::Texture { size: *size, texels },
            };
            resources.push((ResourceBinding { group: 0, binding: binding.index }, resource));
        }
        let start = Instant::now();
        let groups = kernel.program.groups(invocations);
        let run = Run { resources: &resources, groups, fuel: self.fuel, set: None, lanes: None };
        match kernel.lowered.run(self.precision.into(), &run) {
            Ok(()) => Ok(start.elapsed()),
            Err(Failure::Stopped(stopped)) => Err(kernel.program.problem(
                stopped.span,
                &format!("this loop takes more than {} million instructions", self.fuel >> 20),
                "look for an endless loop, or give it a smaller bound",
            )),
            Err(failure) => {
                Err(Problem::new("the CPU executor", failure.to_string(), "report this"))
            }
        }
    }

    fn read(&mut self, buffer: ResourceId, bytes: usize) -> Result<Readout> {
        let count = bytes.div_ceil(4);
        Ok(match &self.resources.get(&buffer).ok_or_else(gone)?.held {
            HeldAs::Words(words) => Readout::new(words.iter().take(count).copied().collect()),
            HeldAs::Storage(storage) => {
                let readout = Readout::new(storage.words(count));
                match self.precision {
                    Precision::F32 => readout,
                    Precision::F64 => readout.with_wide(storage.floats(count)),
                }
            }
            HeldAs::Shared(words) => Readout::new(words.iter().take(count).copied().collect()),
            HeldAs::Texture { .. } => return Err(gone()),
        })
    }

    fn device_seconds(&mut self) -> Option<f64> {
        None
    }

    fn note(&mut self, note: String) {
        self.notes.insert(note);
    }

    fn take_notes(&mut self) -> Vec<String> {
        for kernel in self.kernels.values() {
            kernel.note_negative_bases(&mut self.notes);
        }
        std::mem::take(&mut self.notes).into_iter().collect()
    }

    fn free(&mut self, resource: ResourceId) {
        if let Some(held) = self.resources.remove(&resource) {
            self.used = self.used.saturating_sub(held.bytes);
        }
    }

    fn forget(&mut self, kernel: KernelId) {
        if let Some(kernel) = self.kernels.remove(&kernel) {
            kernel.note_negative_bases(&mut self.notes);
        }
    }
}
