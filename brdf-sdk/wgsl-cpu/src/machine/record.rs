//! Where errors arose in a shadow run: for each instruction and invocation the largest.
//!
//! It listens and changes nothing: a run with a record stores what one without stores. Whom errors are to be blamed
//! on is the caller's question.

use super::frame::Frame;
use super::scalar::Scalar;
use crate::flat::Flat;
use crate::op::{Inst, Op};

/// An instruction of the program, and the errors that arose in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Site {
    /// Where it stands.
    pub span: naga::Span,
    /// For each invocation the largest relative error that arose there.
    pub errors: Vec<f32>,
    /// For each invocation the leading bits that cancelled when it did.
    pub cancelled: Vec<f32>,
}

/// Whether an instruction makes a float that can be wrong.
pub(super) fn is_arithmetic(op: Op) -> bool {
    matches!(op, Op::F1(_) | Op::F2(_) | Op::F3(_) | Op::FromWord(_))
}

/// The errors of one batch.
pub(super) struct Record {
    lanes: usize,
    errors: Vec<f32>,
    cancelled: Vec<f32>,
    /// The lanes that execute this point: masks of the regions around it, and where each ends.
    masks: Vec<(Vec<u32>, usize)>,
}

impl Record {
    pub(super) fn new(instructions: usize, lanes: usize) -> Self {
        let size = instructions * lanes;
        Self { lanes, errors: vec![0.0; size], cancelled: vec![0.0; size], masks: Vec::new() }
    }

    /// Enters a region that ends before step `end` of the flow.
    pub(super) fn enter(&mut self, mask: &[u32], end: usize) {
        self.masks.push((mask.to_vec(), end));
    }

    /// Leaves the regions that do not hold step `at`.
    pub(super) fn leave(&mut self, at: usize) {
        while self.masks.last().is_some_and(|(_, end)| at >= *end) {
            self.masks.pop();
        }
    }

    /// Takes note of the errors that an instruction has just made.
    pub(super) fn note<S: Scalar>(
        &mut self,
        frame: &Frame<S>,
        index: usize,
        inst: &Inst,
        uniform: bool,
    ) {
        if !is_arithmetic(inst.op) {
            return;
        }
        let first = index * self.lanes;
        for lane in 0..self.lanes {
            let value = if uniform {
                frame.floats.uniform[inst.d as usize]
            } else {
                frame.floats.slot(inst.d)[lane]
            };
            let here = self.masks.last().is_none_or(|(mask, _)| mask[lane] != 0);
            if let Some(local) = value.local_error()
                && here
                && local.relative > self.errors[first + lane]
            {
                self.errors[first + lane] = local.relative;
                self.cancelled[first + lane] = local.cancelled;
            }
        }
    }
}

/// The instructions in which errors arose; records are those of all batches, in order.
pub(super) fn sites(
    flat: &Flat,
    spans: &[naga::Span],
    total: usize,
    records: &[Record],
) -> Vec<Site> {
    let mut sites = Vec::new();
    if records.is_empty() {
        return sites;
    }
    for (index, placed) in flat.once.iter().chain(&flat.code).enumerate() {
        let lanes = |of: fn(&Record) -> &Vec<f32>| -> Vec<f32> {
            let all = records.iter().flat_map(|record| {
                of(record)[index * record.lanes..][..record.lanes].iter().copied()
            });
            all.take(total).collect()
        };
        let errors = lanes(|record| &record.errors);
        if errors.iter().any(|error| *error > 0.0) {
            let span = spans[placed.inst.span as usize];
            sites.push(Site { span, errors, cancelled: lanes(|record| &record.cancelled) });
        }
    }
    sites
}
