//! A kernel that turns rows of input into rows of output: lists of directions, draws, cells.

use std::sync::Arc;

use brdf_sdk::Result;

use super::trial;
use crate::data::{self, Brought};
use crate::exec::{Executor, KernelId, Readout, ResourceId};
use crate::link::{BindingKind, Program};
use crate::plugin::Configured;

/// Has what a BRDF brings along on a device; what is there from before stays.
pub(super) fn bring(
    executor: &mut dyn Executor,
    program: &Program,
    brdf: &Configured,
    held: &mut Vec<(Brought, ResourceId)>,
) -> Result<()> {
    let (all, notes) = data::of(program, brdf)?;
    notes.into_iter().for_each(|note| executor.note(note));
    for (_, old) in held.extract_if(.., |(old, _)| !all.contains(old)) {
        executor.free(old);
    }
    for new in all {
        if !held.iter().any(|(known, _)| *known == new) {
            let id = new.upload(executor)?;
            held.push((new, id));
        }
    }
    Ok(())
}

/// A program of rows on a device.
pub struct Rows {
    program: Arc<Program>,
    kernel: KernelId,
    tried: bool,
    /// What the BRDF brought along the last time, which is mostly what it brings the next time.
    brought: Vec<(Brought, ResourceId)>,
}

/// What a program of rows reads: a variable, its kind, its bytes.
pub type Input<'a> = (&'a str, BindingKind, Vec<u8>);

impl Rows {
    /// Compiles the program, the driver's own compiler included.
    pub fn new(executor: &mut dyn Executor, program: Arc<Program>) -> Result<Self> {
        let kernel = executor.compile(Arc::clone(&program))?;
        Ok(Self { program, kernel, tried: false, brought: Vec::new() })
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Runs it for `rows` rows of `output`, with the BRDF's numbers as they are now.
    pub fn run(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        inputs: &[Input<'_>],
        output: &str,
        rows: usize,
    ) -> Result<Readout> {
        if !self.tried {
            trial::try_rows(executor, &self.program, brdf, inputs, output, rows)?;
            self.tried = true;
        }
        let mut owned = Vec::new();
        let read = self.dispatch(executor, brdf, inputs, output, rows, &mut owned);
        for (_, id) in owned {
            executor.free(id);
        }
        read
    }

    /// The buffers that it makes go to `owned`.
    fn dispatch<'a>(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        inputs: &[Input<'a>],
        output: &'a str,
        rows: usize,
        owned: &mut Vec<(String, ResourceId)>,
    ) -> Result<Readout> {
        let parameters = self.program.parameter_bytes(brdf);
        let parameters =
            parameters.iter().map(|(name, bytes)| (name.as_str(), BindingKind::Uniform, bytes));
        let inputs = inputs.iter().map(|(name, kind, bytes)| (*name, *kind, bytes));
        for (name, kind, bytes) in inputs.chain(parameters) {
            let buffer = executor.buffer(kind, bytes.len())?;
            owned.push((name.to_owned(), buffer));
            executor.write(buffer, bytes.clone())?;
        }
        bring(executor, &self.program, brdf, &mut self.brought)?;
        let bytes = self.program.required_layout(output).stride * rows;
        let results = executor.buffer(BindingKind::ReadWrite, bytes)?;
        owned.push((output.to_owned(), results));
        let brought = self.brought.iter().map(|(brought, id)| (brought.name.as_str(), *id));
        let bound: Vec<_> =
            owned.iter().map(|(name, id)| (name.as_str(), *id)).chain(brought).collect();
        executor.dispatch(self.kernel, &bound, rows as u32)?;
        executor.read(results, bytes)
    }

    /// Frees what it holds on the device.
    pub fn free(self, executor: &mut dyn Executor) {
        for (_, id) in self.brought {
            executor.free(id);
        }
        executor.forget(self.kernel);
    }
}
