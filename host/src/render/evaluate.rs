//! f, pdf and weight of a BRDF for a list of direction pairs.

use std::sync::Arc;

use brdf_sdk::Result;

use super::{endless_loop, trial};
use crate::exec::{Executor, KernelId, Readout, ResourceId};
use crate::link::{BindingKind, Program};
use crate::plugin::Configured;

/// Unit directions to viewer and light, local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// To the viewer.
    pub wo: [f32; 3],
    /// To the light.
    pub wi: [f32; 3],
}

/// What the BRDF says of a pair; zero below the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scattered {
    /// f_r [1/sr], linear Rec. 709.
    pub f: [f64; 3],
    /// Density of `sample` [1/sr].
    pub pdf: f64,
    /// f cos / pdf.
    pub weight: [f64; 3],
}

/// Pairs in one dispatch.
const CHUNK: usize = 1 << 18;

/// Evaluates a linked `View::Eval` program.
pub fn evaluate(
    executor: &mut dyn Executor,
    program: &Arc<Program>,
    brdf: &Configured,
    pairs: &[Pair],
) -> Result<Vec<Scattered>> {
    trial::try_pairs(executor, program, brdf, pairs)?;
    let kernel = executor.compile(Arc::clone(program))?;
    let mut results = Vec::with_capacity(pairs.len());
    let done = pairs.chunks(CHUNK).try_for_each(|chunk| {
        let mut owned = Vec::new();
        let read = run_chunk(executor, kernel, program, brdf, chunk, &mut owned);
        for (_, id) in &owned {
            executor.free(*id);
        }
        gather(program, brdf, chunk.len(), &read?, &mut results)
    });
    executor.forget(kernel);
    done.map(|()| results)
}

/// Runs one chunk; the buffers that it made go to `owned`.
fn run_chunk(
    executor: &mut dyn Executor,
    kernel: KernelId,
    program: &Program,
    brdf: &Configured,
    chunk: &[Pair],
    owned: &mut Vec<(String, ResourceId)>,
) -> Result<Readout> {
    let layout = program.required_layout("pairs");
    let mut bytes = vec![0; layout.stride * chunk.len()];
    for (index, pair) in chunk.iter().enumerate() {
        layout.write(&mut bytes, index * layout.stride, "wo", &pair.wo);
        layout.write(&mut bytes, index * layout.stride, "wi", &pair.wi);
    }
    let input = executor.buffer(BindingKind::Read, bytes.len())?;
    owned.push(("pairs".to_owned(), input));
    executor.write(input, bytes)?;
    let size = program.required_layout("scattered").stride * chunk.len();
    let output = executor.buffer(BindingKind::ReadWrite, size)?;
    owned.push(("scattered".to_owned(), output));
    if let Some((name, bytes)) = program.parameter_bytes(brdf) {
        let buffer = executor.buffer(BindingKind::Uniform, bytes.len())?;
        owned.push((name, buffer));
        executor.write(buffer, bytes)?;
    }
    let bound: Vec<_> = owned.iter().map(|(name, id)| (name.as_str(), *id)).collect();
    executor.dispatch(kernel, &bound, chunk.len() as u32)?;
    executor.read(output, size)
}

fn gather(
    program: &Program,
    brdf: &Configured,
    rows: usize,
    read: &Readout,
    results: &mut Vec<Scattered>,
) -> Result<()> {
    let layout = program.required_layout("scattered");
    let members = ["f", "pdf", "weight", "exhausted"].map(|member| layout.at(member));
    let [f, pdf, weight, exhausted] = members;
    for row in (0..rows).map(|row| row * layout.stride) {
        if read.word(row + exhausted) != 0 {
            return Err(endless_loop(&brdf.plugin.id, "pair of directions"));
        }
        let three = |at: usize| [0, 4, 8].map(|offset| read.float(row + at + offset));
        results.push(Scattered { f: three(f), pdf: read.float(row + pdf), weight: three(weight) });
    }
    Ok(())
}
