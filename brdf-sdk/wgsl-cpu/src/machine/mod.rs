//! Runs flat programs: one instruction over a whole batch of lanes at a time, batches on threads.
//!
//! It may depend on instructions and their layout (`op`, `flat`) and on what programs read and write (`storage`). Of
//! naga it knows spans alone. Nothing here is `unsafe`: vectors are the compiler's, chosen through pulp.

mod apply;
mod f32_math;
mod f64_exp;
mod f64_math;
mod frame;
mod functions;
mod isa;
mod memory;
mod packed;
mod record;
mod rounding;
mod run;
mod scalar;
mod shadow;
mod texels;

pub use isa::VectorSet;
pub use record::Site;
pub use run::Stopped;
pub(crate) use run::{Job, run};
pub(crate) use shadow::Shadow;

use std::sync::atomic::AtomicU64;

use frame::Frame;

use crate::op::Inst;
use crate::storage::Resource;

/// One instruction over all lanes of a frame.
pub(crate) type Kernel<S, A> = fn(A, &mut Frame<S>, &Inst, &Context<'_>);

/// What all batches of a run share.
pub(crate) struct Context<'a> {
    /// In the order in which instructions name them.
    resources: Vec<Resource<'a>>,
    /// Tables of constants: of floats by their bits, and of words.
    tables: &'a [Vec<Vec<u32>>; 2],
    /// How often each watch saw what it watches for.
    watches: &'a [AtomicU64],
    /// Workgroups along each axis.
    groups: [u32; 3],
    /// Invocations of a workgroup along each axis.
    group_size: [u32; 3],
    /// Invocations in all.
    total: u32,
}

impl<'a> Context<'a> {
    fn resource(&self, inst: &Inst) -> Resource<'a> {
        self.resources[inst.extra as usize]
    }

    /// A word of a buffer that nobody writes while the program runs.
    fn word(&self, inst: &Inst, at: u32) -> u32 {
        let at = at.saturating_add(inst.imm) as usize;
        match self.resource(inst) {
            Resource::Words(words) => words.get(at).copied().unwrap_or(0),
            Resource::Storage(storage) => storage.word(at).unwrap_or(0),
            Resource::Texture { .. } => 0,
        }
    }
}
