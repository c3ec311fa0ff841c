//! A program ready to run, and the run itself.
//!
//! The crate's front: a naga module, validated, becomes a program once, and runs as often as wanted on resources
//! that the caller holds. It prints nothing, reads no file and knows no device.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use naga::valid::ModuleInfo;
use naga::{AddressSpace, Module, ResourceBinding, Span, StorageAccess};

use crate::flat::{Flat, flatten, fuel};
use crate::lower::lower;
use crate::machine::{self, Job, Shadow, Site, Stopped, VectorSet};
use crate::refusal::Refusal;
use crate::storage::Resource;

/// Lowering recurses along nested blocks and calls.
const STACK: usize = 256 << 20;

/// What the program's floats are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// f32, as on a GPU.
    F32,
    /// f64: every f32 of the program is evaluated in f64; literals keep their f32 value.
    F64,
}

/// What a program is lowered for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Values,
    Errors,
}

/// The compute entry point of a module, lowered to a flat program over lanes.
#[derive(Debug)]
pub struct Program {
    flat: Flat,
    spans: Vec<Span>,
    tables: [Vec<Vec<u32>>; 2],
    memory: usize,
    bindings: Vec<(ResourceBinding, Kind)>,
    group_size: [u32; 3],
    /// Where `pow` stands, and in how many invocations its base was negative.
    watched: Vec<Span>,
    negative: Vec<AtomicU64>,
}

/// What may stand behind a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Read,
    Written,
    Texture,
}

impl Kind {
    fn of(space: AddressSpace) -> Self {
        match space {
            AddressSpace::Handle => Self::Texture,
            AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                Self::Written
            }
            _ => Self::Read,
        }
    }

    fn takes(self, resource: &Resource<'_>) -> bool {
        match resource {
            Resource::Words(_) => self == Self::Read,
            Resource::Storage(_) => self != Self::Texture,
            Resource::Texture { size: [width, height], texels } => {
                self == Self::Texture
                    && texels.len() as u64 >= u64::from(*width) * u64::from(*height)
            }
        }
    }
}

/// One run of a program.
#[derive(Debug)]
pub struct Run<'a> {
    /// What stands behind each binding that the program reaches; others are passed over.
    pub resources: &'a [(ResourceBinding, Resource<'a>)],
    /// Workgroups along each axis.
    pub groups: [u32; 3],
    /// Instructions that a batch of lanes may run inside loops before it is stopped.
    pub fuel: u64,
    /// The instruction set; the widest one of the processor without.
    pub set: Option<VectorSet>,
    /// Lanes of a batch; the precision's own number without.
    pub lanes: Option<usize>,
}

/// Why a run gave no result.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The budget of instructions was used up in a loop.
    Stopped(Stopped),
    /// Nothing stands behind a binding, or something of another kind.
    Missing(ResourceBinding),
    /// More invocations than 32 bits can count.
    TooMany,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped(_) => f.write_str("a loop used up the budget of instructions"),
            Self::Missing(ResourceBinding { group, binding }) => {
                write!(f, "nothing of its kind stands behind binding {binding} of group {group}")
            }
            Self::TooMany => f.write_str("there are more invocations than 32 bits can count"),
        }
    }
}

impl std::error::Error for Failure {}

impl Program {
    /// Lowers a module's only entry point, which must be a compute shader.
    ///
    /// # Errors
    /// The first construct that is not covered.
    pub fn new(module: &Module, info: &ModuleInfo) -> Result<Self, Refusal> {
        on_large_stack(|| Self::lowered(module, info, Purpose::Values))
    }

    /// Lowers a module for [`Program::errors`]: it keeps apart which lanes execute what.
    ///
    /// # Errors
    /// As [`Program::new`].
    pub fn for_errors(module: &Module, info: &ModuleInfo) -> Result<Self, Refusal> {
        on_large_stack(|| Self::lowered(module, info, Purpose::Errors))
    }

    fn lowered(module: &Module, info: &ModuleInfo, purpose: Purpose) -> Result<Self, Refusal> {
        let mut lowered = lower(module, info)?;
        let mut bindings = Vec::with_capacity(lowered.resources.len());
        for handle in &lowered.resources {
            let Some(binding) = module.global_variables[*handle].binding else {
                let span = module.global_variables.get_span(*handle);
                return Err(Refusal { reason: "resources without a binding".to_owned(), span });
            };
            let space = module.global_variables[*handle].space;
            bindings.push((binding, Kind::of(space)));
        }
        let flat = flatten(&mut lowered, purpose == Purpose::Errors)?;
        Ok(Self {
            flat,
            spans: lowered.spans,
            tables: lowered.tables,
            memory: lowered.memory as usize,
            bindings,
            group_size: module.entry_points[0].workgroup_size,
            negative: lowered.watches.iter().map(|_| AtomicU64::new(0)).collect(),
            watched: lowered.watches,
        })
    }

    /// What a batch takes of the budget to run through all instructions once.
    pub fn cost(&self) -> u64 {
        self.flat.code.iter().map(|placed| u64::from(fuel(&placed.inst))).sum()
    }

    /// Places where `pow` met a negative base since the last call of this, and how often: NaN here, and
    /// anything on a device.
    pub fn take_negative_bases(&self) -> Vec<(Span, u64)> {
        let counts = self.negative.iter().map(|count| count.swap(0, Relaxed));
        let counted = self.watched.iter().copied().zip(counts);
        counted.filter(|(_, count)| *count > 0).collect()
    }

    /// Runs all invocations of `run.groups`.
    ///
    /// # Errors
    /// Where a resource is missing, or the budget was used up; what was stored until then stays.
    pub fn run(&self, precision: Precision, run: &Run<'_>) -> Result<(), Failure> {
        let job = self.job(run)?;
        match precision {
            Precision::F32 => machine::run::<f32>(&job),
            Precision::F64 => machine::run::<f64>(&job),
        }
        .map(|_| ())
        .map_err(Failure::Stopped)
    }

    /// Runs in f32 with f64 at its side, for programs of [`Program::for_errors`]. Buffers get both:
    /// the f32 in their words, the f64 beside. The sites are the instructions in which errors arose.
    ///
    /// # Errors
    /// As [`Program::run`].
    pub fn errors(&self, run: &Run<'_>) -> Result<Vec<Site>, Failure> {
        machine::run::<Shadow>(&self.job(run)?).map_err(Failure::Stopped)
    }

    /// What the errors that arise in `span` do to the end, for programs of [`Program::for_errors`].
    /// As [`Program::errors`], but the f64 results of its instructions are off by their local errors,
    /// and all others are exact. How far the f64 at the end is from that of [`Program::errors`] is
    /// the span's contribution.
    ///
    /// # Errors
    /// As [`Program::run`].
    pub fn errors_of(&self, span: Span, run: &Run<'_>) -> Result<(), Failure> {
        // Equal spans have one index; with none of that span nothing errs.
        let errs = self.spans.iter().position(|known| *known == span);
        let errs = Some(errs.map_or(u32::MAX, |index| index as u32));
        let job = Job { errs, ..self.job(run)? };
        machine::run::<Shadow>(&job).map(|_| ()).map_err(Failure::Stopped)
    }

    fn job<'a>(&'a self, run: &Run<'a>) -> Result<Job<'a>, Failure> {
        let mut resources = Vec::with_capacity(self.bindings.len());
        for (binding, kind) in &self.bindings {
            let found = run.resources.iter().find(|(known, _)| known == binding);
            match found {
                Some((_, resource)) if kind.takes(resource) => resources.push(*resource),
                _ => return Err(Failure::Missing(*binding)),
            }
        }
        let mut counts = run.groups.iter().chain(&self.group_size);
        let total = counts.try_fold(1u32, |all, count| all.checked_mul(*count));
        let total = total.ok_or(Failure::TooMany)?;
        Ok(Job {
            flat: &self.flat,
            spans: &self.spans,
            tables: &self.tables,
            watches: &self.negative,
            memory: self.memory,
            resources,
            groups: run.groups,
            group_size: self.group_size,
            total,
            fuel: run.fuel,
            set: run.set.unwrap_or_else(VectorSet::best),
            lanes: run.lanes.map(|lanes| lanes.next_multiple_of(64)),
            errs: None,
        })
    }
}

fn on_large_stack<T: Send>(work: impl FnOnce() -> Result<T, Refusal> + Send) -> Result<T, Refusal> {
    std::thread::scope(|scope| {
        let failed = |reason: String| Refusal { reason, span: Span::UNDEFINED };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        match thread.map(std::thread::ScopedJoinHandle::join) {
            Ok(Ok(done)) => done,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => Err(failed(format!("anything without a thread ({error})"))),
        }
    })
}
