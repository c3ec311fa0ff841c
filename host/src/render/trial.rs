//! The trial that a program passes before a device sees it: a few of its own points, one sample each,
//! on the CPU executor under a budget of instructions.
//!
//! A device that meets an endless loop may be lost, and its driver with it; here it is one line that
//! names the loop.

use std::sync::Arc;

use brdf_sdk::Result;

use super::rows::{Input, Rows};
use super::{Effort, Film, HEADLESS_BUDGET, Pace, Prepared, Stage, Wish};
use crate::exec::Executor;
use crate::exec::cpu::Cpu;
use crate::link::Program;
use crate::plugin::Configured;

/// Points or rows that are tried.
const POINTS: usize = 64;

/// Instructions in loops that the trial's batch may take: some hundred thousand times what a sample of
/// the shipped plugins takes, and about two seconds.
const FUEL: u64 = 1 << 27;

/// Tries a film program on some of the stage's points, where the executor asks for it.
pub(super) fn try_film(
    executor: &mut dyn Executor,
    stage: &Stage,
    program: &Arc<Program>,
    plugins: &[&Configured],
    seed: u32,
) -> Result<()> {
    if !executor.wants_trial() {
        return Ok(());
    }
    let mut cpu = Cpu::with_fuel(FUEL);
    let mut stage = stage.thinned(POINTS);
    let effort = Effort { replicates: 1, seed, ..Effort::new(1, 1) };
    let mut film = Film::new(0, 1, 1.0);
    let pace = Pace::new(HEADLESS_BUDGET);
    let mut prepared = Prepared::new(&mut cpu, &mut stage, program, plugins, effort, pace)?;
    // Terms cost more than samples: one is looked at.
    prepared.run(&mut cpu, &stage, &mut film, &mut |_| Wish::Abandon)?;
    cpu.take_notes().into_iter().for_each(|note| executor.note(note));
    Ok(())
}

/// Tries a program of rows on some of its rows, where the executor asks for it. Its inputs are lists of
/// rows, whose first ones are taken, or small.
pub(super) fn try_rows(
    executor: &mut dyn Executor,
    program: &Arc<Program>,
    brdf: &Configured,
    inputs: &[Input<'_>],
    output: &str,
    rows: usize,
) -> Result<()> {
    if !executor.wants_trial() {
        return Ok(());
    }
    let mut cpu = Cpu::with_fuel(FUEL);
    let mut trial = Rows::new(&mut cpu, Arc::clone(program))?;
    trial.run(&mut cpu, brdf, inputs, output, rows.min(POINTS))?;
    cpu.take_notes().into_iter().for_each(|note| executor.note(note));
    Ok(())
}
