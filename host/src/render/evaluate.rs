//! f, pdf and weight of a BRDF for a list of direction pairs.

use std::sync::Arc;

use brdf_sdk::Result;

use super::rows::Rows;
use crate::exec::{Executor, Precision, Readout};
use crate::link::{BindingKind, Program, endless_loop};
use crate::plugin::Configured;

/// Unit directions to viewer and light, local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// To the viewer.
    pub wo: [f32; 3],
    /// To the light.
    pub wi: [f32; 3],
}

impl Pair {
    /// Directions in f64, rounded.
    pub fn new(wo: [f64; 3], wi: [f64; 3]) -> Self {
        let short = |w: [f64; 3]| w.map(|c| c as f32);
        Self { wo: short(wo), wi: short(wi) }
    }

    /// Whether light can pass: `above_horizon` of shaders/scatter.wgsl, for whoever asks before a program runs.
    pub fn is_above_horizon(&self) -> bool {
        self.wo[2] > 0.0 && self.wi[2] > 0.0
    }
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
    let mut rows = Rows::new(executor, Arc::clone(program))?;
    let found = evaluate_rows(executor, &mut rows, brdf, pairs);
    rows.free(executor);
    found
}

/// The same by a program that is on the device already.
pub fn evaluate_rows(
    executor: &mut dyn Executor,
    rows: &mut Rows,
    brdf: &Configured,
    pairs: &[Pair],
) -> Result<Vec<Scattered>> {
    let layout = rows.program().required_layout("pairs");
    let rounded = u32::from(executor.precision() == Precision::F64);
    let mut results = Vec::with_capacity(pairs.len());
    for chunk in pairs.chunks(CHUNK) {
        let mut bytes = vec![0; layout.stride * chunk.len()];
        for (index, pair) in chunk.iter().enumerate() {
            let row = index * layout.stride;
            layout.write(&mut bytes, row, "wo", &pair.wo);
            layout.write(&mut bytes, row, "wi", &pair.wi);
            layout.write(&mut bytes, row, "rounded", &[rounded]);
        }
        let inputs = [("pairs", BindingKind::Read, bytes)];
        let read = rows.run(executor, brdf, &inputs, "scattered", chunk.len())?;
        gather(rows.program(), brdf, chunk.len(), &read, &mut results)?;
    }
    Ok(results)
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
            return Err(endless_loop(&brdf.plugin.id, "for one pair of directions"));
        }
        let three = |at: usize| [0, 4, 8].map(|offset| read.float(row + at + offset));
        results.push(Scattered { f: three(f), pdf: read.float(row + pdf), weight: three(weight) });
    }
    Ok(())
}
