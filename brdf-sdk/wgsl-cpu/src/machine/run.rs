//! A run: batches of lanes, spread over threads, each with a frame of its own.
//!
//! The flow of a program is followed here: regions that no lane takes, loops and the fuel that they burn. What
//! instructions compute is `functions.rs`'s and `memory.rs`'s. Results do not depend on threads, lanes or the vector
//! set.

use std::marker::PhantomData;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::frame::{Frame, Registers};
use super::functions::{self, Shape, Shape3};
use super::isa::{Isa, VectorSet, WithIsa};
use super::record::{self, Record, Site};
use super::scalar::Scalar;
use super::{Context, Kernel, apply, memory, packed};
use crate::flat::{Flat, Flow, Placed};
use crate::op::{Bank, Inst, Op};
use crate::storage::Resource;

/// A run was ended before its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stopped {
    /// The loop that used the budget up.
    pub span: naga::Span,
}

/// What to run, and on what.
pub(crate) struct Job<'a> {
    pub flat: &'a Flat,
    pub spans: &'a [naga::Span],
    pub tables: &'a [Vec<Vec<u32>>; 2],
    pub watches: &'a [AtomicU64],
    /// Elements of a lane's own memory.
    pub memory: usize,
    pub resources: Vec<Resource<'a>>,
    pub groups: [u32; 3],
    pub group_size: [u32; 3],
    /// Invocations in all.
    pub total: u32,
    /// Instructions that a batch may run.
    pub fuel: u64,
    pub set: VectorSet,
    /// Lanes of a batch, a multiple of 64; the precision's own number without.
    pub lanes: Option<usize>,
    /// The span, by its index, whose local errors go into the f64. Then no errors are recorded.
    pub errs: Option<u32>,
}

/// Runs a job; for each arithmetic instruction its errors, where the precision knows them.
pub(crate) fn run<S: Scalar>(job: &Job<'_>) -> Result<Vec<Site>, Stopped> {
    job.set.choose(At::<S>(job, PhantomData))
}

/// A job at a precision.
struct At<'a, S>(&'a Job<'a>, PhantomData<S>);

impl<S: Scalar> WithIsa for At<'_, S> {
    type Output = Result<Vec<Site>, Stopped>;
    fn with<A: Isa>(self, isa: A) -> Self::Output {
        run_on::<S, A>(isa, self.0)
    }
}

struct Step<S, A> {
    kernel: Kernel<S, A>,
    inst: Inst,
    /// Whether its result is.
    uniform: bool,
    /// Whether its local error goes into the f64.
    errs: bool,
}

fn step<S: Scalar, A: Isa>(placed: &Placed, errs: Option<u32>) -> Step<S, A> {
    let uniform = placed.uniform[0];
    let shape = Shape::of(placed);
    let kernel = match placed.inst.op {
        Op::F1(op) => functions::float1(op, uniform),
        Op::F2(op) => functions::float2(op, shape),
        Op::F3(op) => functions::float3(op, Shape3::of(placed)),
        Op::Compare(op) => functions::compare2(op, shape),
        Op::ToWord(op) => functions::to_word1(op, uniform),
        Op::FromWord(op) => functions::from_word1(op, uniform),
        Op::U1(op) => functions::word1(op, uniform),
        Op::U2(op) => functions::word2(op, shape),
        Op::Field(bank) => packed::field(bank),
        Op::Turn => packed::turn(),
        _ => memory::kernel(placed),
    };
    let errs = errs == Some(placed.inst.span) && record::is_arithmetic(placed.inst.op);
    Step { kernel, inst: placed.inst, uniform, errs }
}

struct Machine<'a, S, A> {
    isa: A,
    once: Vec<Step<S, A>>,
    code: Vec<Step<S, A>>,
    flow: &'a [Flow],
    context: Context<'a>,
    fuel: u64,
}

fn run_on<S: Scalar, A: Isa>(isa: A, job: &Job<'_>) -> Result<Vec<Site>, Stopped> {
    let flat = job.flat;
    let total = job.total;
    let machine = Machine {
        isa,
        once: flat.once.iter().map(|placed| step(placed, job.errs)).collect(),
        code: flat.code.iter().map(|placed| step(placed, job.errs)).collect(),
        flow: &flat.flow,
        context: Context {
            resources: job.resources.clone(),
            tables: job.tables,
            watches: job.watches,
            groups: job.groups.map(|count| count.max(1)),
            group_size: job.group_size.map(|count| count.max(1)),
            total,
        },
        fuel: job.fuel,
    };
    // Wide where every thread still gets many batches: the last ones, and those whose loops run longest, keep the
    // others waiting. No wider than the work, so that a few invocations cost a few lanes.
    let wide = S::LANES * A::BATCH;
    let many = 8 * rayon::current_num_threads() * wide;
    let usual = if total as usize >= many { wide } else { S::LANES };
    let wanted = job.lanes.unwrap_or(usual);
    let lanes = wanted.min((total as usize).next_multiple_of(64)).max(64);
    let frame = || {
        let mut frame = machine.frame(flat, job.memory, lanes);
        machine.prepare(&mut frame);
        frame
    };
    let stopped = Mutex::new(None);
    let stop = AtomicBool::new(false);
    let records = S::default().local_error().is_some() && job.errs.is_none();
    let sites = Mutex::new(Vec::new());
    let batches = (total as usize).div_ceil(lanes);
    let run_batch = |frame: &mut Frame<S>, batch: usize| {
        if stop.load(Relaxed) {
            return;
        }
        frame.first = (batch * lanes) as u32;
        let mut record = records.then(|| machine.record(frame));
        if let Err(span) = machine.batch(frame, record.as_mut()) {
            stop.store(true, Relaxed);
            let span = job.spans[span as usize];
            *stopped.lock().unwrap_or_else(|error| error.into_inner()) = Some(Stopped { span });
        }
        if let Some(record) = record {
            sites.lock().unwrap_or_else(|error| error.into_inner()).push((batch, record));
        }
    };
    if batches == 1 {
        // Not worth waking the other threads.
        run_batch(&mut frame(), 0);
    } else {
        (0..batches).into_par_iter().for_each_init(frame, run_batch);
    }
    if let Some(stopped) = stopped.into_inner().unwrap_or_else(|error| error.into_inner()) {
        return Err(stopped);
    }
    let mut records = sites.into_inner().unwrap_or_else(|error| error.into_inner());
    records.sort_by_key(|(batch, _)| *batch);
    let records: Vec<Record> = records.into_iter().map(|(_, record)| record).collect();
    Ok(record::sites(flat, job.spans, total as usize, &records))
}

impl<S: Scalar, A: Isa> Machine<'_, S, A> {
    fn frame(&self, flat: &Flat, memory: usize, lanes: usize) -> Frame<S> {
        let [floats, words] = flat.slots;
        let [uniform_floats, uniform_words] = flat.uniforms;
        let uses = |bank: Bank| {
            let own = |step: &Step<S, A>| match step.inst.op {
                Op::Recall(own) | Op::Keep(own) | Op::Clear(own) => own == bank,
                _ => false,
            };
            if self.code.iter().any(own) { memory * lanes } else { 0 }
        };
        Frame {
            floats: Registers::new(floats, uniform_floats, lanes),
            words: Registers::new(words, uniform_words, lanes),
            own_floats: vec![S::default(); uses(Bank::Float)],
            own_words: vec![0; uses(Bank::Word)],
            lanes,
            first: 0,
        }
    }

    /// What is the same for all batches.
    fn prepare(&self, frame: &mut Frame<S>) {
        for step in &self.once {
            self.execute(step, frame);
        }
    }

    fn execute(&self, step: &Step<S, A>, frame: &mut Frame<S>) {
        (step.kernel)(self.isa, frame, &step.inst, &self.context);
        if step.errs {
            let made = if step.uniform {
                std::slice::from_mut(&mut frame.floats.uniform[step.inst.d as usize])
            } else {
                frame.floats.slot_mut(step.inst.d)
            };
            made.iter_mut().for_each(|value| *value = value.off_by_local_error());
        }
    }

    /// A record that knows the errors of what is the same for all batches.
    fn record(&self, frame: &Frame<S>) -> Record {
        let mut record = Record::new(self.once.len() + self.code.len(), frame.lanes);
        for (index, step) in self.once.iter().enumerate() {
            record.note(frame, index, &step.inst, step.uniform);
        }
        record
    }

    /// Runs one batch; an error is the loop that used the budget up.
    fn batch(&self, frame: &mut Frame<S>, mut record: Option<&mut Record>) -> Result<(), u32> {
        let mut fuel = self.fuel;
        let mut at = 0;
        while let Some(flow) = self.flow.get(at) {
            if let Some(record) = record.as_deref_mut() {
                record.leave(at);
            }
            at += 1;
            match *flow {
                Flow::Run(start, end) => {
                    let steps = &self.code[start as usize..end as usize];
                    for (index, step) in steps.iter().enumerate() {
                        self.execute(step, frame);
                        if let Some(record) = record.as_deref_mut() {
                            let index = self.once.len() + start as usize + index;
                            record.note(frame, index, &step.inst, step.uniform);
                        }
                    }
                }
                Flow::SkipNone { mask, to } => {
                    if !apply::any(self.isa, frame.words.slot(mask)) {
                        at = to as usize;
                    } else if let Some(record) = record.as_deref_mut() {
                        record.enter(frame.words.slot(mask), to as usize);
                    }
                }
                Flow::Skip { test, to } => {
                    if frame.words.uniform[test as usize] == 0 {
                        at = to as usize;
                    }
                }
                Flow::Jump(to) => at = to as usize,
                Flow::Back { mask, to, cost, span } => {
                    let more = mask.is_none_or(|mask| apply::any(self.isa, frame.words.slot(mask)));
                    if more {
                        fuel = fuel.checked_sub(u64::from(cost)).ok_or(span)?;
                        at = to as usize;
                    }
                }
            }
        }
        Ok(())
    }
}
