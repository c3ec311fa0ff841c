//! Loops and switches from the inside: what they carry, and how lanes leave them.
//!
//! A frame carries its variables in registers of their own; lanes write them when they come round or
//! leave. A uniform loop is left by a jump, a divergent one when its mask of living lanes is empty.

use std::rc::Rc;

use naga::{Span, Statement};

use super::effects::Effects;
use super::function::Call;
use super::{Fact, Lowering, Result};
use crate::op::{Bank, NONE, Node, Reg, U2};

/// A loop or a switch around the current point.
pub(super) struct Frame {
    pub id: u32,
    is_loop: bool,
    /// Left by jumps, all lanes together.
    pub uniform: bool,
    /// The mask with which it was entered.
    entry: Reg,
    /// Lanes still inside; divergent frames only.
    pub live: Reg,
    /// Lanes that left for somewhere beyond its end: by `return`, or a switch by `continue`.
    gone: Option<Reg>,
    /// Whether `gone` decides what follows.
    stops: bool,
    /// Variable, component, and the register that carries it.
    carried: Vec<(usize, usize, Reg)>,
}

impl<'a> Lowering<'a> {
    /// Enters a loop or a switch: what it carries moves to registers of its own.
    pub(super) fn enter(
        &mut self,
        call: &mut Call<'a>,
        is_loop: bool,
        mut effects: Effects,
        needs_gone: bool,
    ) -> usize {
        self.loops += 1;
        let id = self.loops;
        let uniform = is_loop && !self.facts.holds(Fact::Divergent(id));
        let inner = self.build.level() + 1;
        if effects.returns {
            effects.vars.push(call.result);
        }
        effects.vars.sort_unstable();
        effects.vars.dedup();
        let mut carried = Vec::new();
        for var in effects.vars {
            for component in 0..self.env.vars[var].len() {
                let value = self.env.vars[var][component];
                let bank = match value {
                    // The result before the first `return`: its bank follows from its type.
                    NONE => self.result_bank(call, component),
                    _ => self.build.info(value).bank,
                };
                let value = if value == NONE { self.build.zero(bank) } else { value };
                let fact = Fact::Varying { frame: id, var, component };
                let same = uniform && self.build.uniform(value) && !self.facts.holds(fact);
                let carrier = self.build.mutable(bank, same, inner);
                let inst = self.build.write(carrier, value, None);
                self.build.push(Node::Inst(inst));
                Rc::make_mut(&mut self.env.vars[var])[component] = carrier;
                carried.push((var, component, carrier));
            }
        }
        let mask = |lowering: &mut Self, uniform: bool, value: Reg| {
            let reg = lowering.build.mutable(Bank::Word, uniform, inner);
            let inst = lowering.build.write(reg, value, None);
            lowering.build.push(Node::Inst(inst));
            reg
        };
        let live = if uniform { NONE } else { mask(self, false, self.env.exec) };
        let nobody = self.build.mask(false);
        let gone = needs_gone.then(|| mask(self, uniform, nobody));
        call.frames.push(Frame {
            id,
            is_loop,
            uniform,
            entry: self.env.exec,
            live,
            gone,
            stops: false,
            carried,
        });
        call.frames.len() - 1
    }

    fn result_bank(&mut self, call: &Call<'a>, component: usize) -> Bank {
        let parts = call
            .function
            .result
            .as_ref()
            .and_then(|result| self.shapes.parts(super::shape::Ty::Handle(result.ty)).ok());
        parts.map_or(Bank::Word, |parts| parts.banks[component])
    }

    /// The variables are what the frame carries.
    pub(super) fn carry(&mut self, call: &Call<'a>, index: usize) {
        for (var, component, carrier) in &call.frames[index].carried {
            Rc::make_mut(&mut self.env.vars[*var])[*component] = *carrier;
        }
    }

    /// Leaves a frame at its end; lanes that went further are held back from what follows.
    pub(super) fn exit(
        &mut self,
        call: &mut Call<'a>,
        index: usize,
        entry: Reg,
        rest: &[(&'a Statement, &'a Span)],
    ) -> Result<bool> {
        self.carry(call, index);
        let Some(frame) = call.frames.pop() else { return Ok(false) };
        for (_, _, carrier) in &frame.carried {
            self.build.settle(*carrier);
        }
        self.env.exec = entry;
        self.env.dead = false;
        self.env.jumped = false;
        let Some(gone) = frame.gone else { return Ok(false) };
        self.build.settle(gone);
        if frame.uniform && !frame.stops {
            return Ok(false);
        }
        self.branch(
            call,
            gone,
            |lowering, _| {
                lowering.env.dead = true;
                Ok(())
            },
            |lowering, call| lowering.statements(call, rest),
        )?;
        Ok(true)
    }

    /// The lanes that are here write what a frame carries.
    pub(super) fn write_back(&mut self, call: &Call<'a>, index: usize) {
        let writes = self.writes(call, index, true);
        self.perform(&writes);
    }

    /// What the lanes that are here have to write for a frame: carrier, value, mask. After a `return`
    /// the call's own variables are of no use to anybody.
    fn writes(
        &mut self,
        call: &Call<'a>,
        index: usize,
        with_locals: bool,
    ) -> Vec<(Reg, Reg, Option<Reg>)> {
        let frame = &call.frames[index];
        let exec = self.env.exec;
        if frame.uniform && exec != frame.entry {
            self.facts.learn(Fact::Divergent(frame.id));
        }
        let mut writes = Vec::new();
        for (var, component, carrier) in &frame.carried {
            let value = self.env.vars[*var][*component];
            let local = self.owners[*var] == call.id && *var != call.result;
            if value == *carrier || value == NONE || (local && !with_locals) {
                continue;
            }
            if self.build.uniform(*carrier) && !self.build.uniform(value) {
                let fact = Fact::Varying { frame: frame.id, var: *var, component: *component };
                self.facts.learn(fact);
                continue;
            }
            // Another carrier may be overwritten before it is read.
            let value = self.build.steady(value);
            writes.push((*carrier, value, (!frame.uniform).then_some(exec)));
        }
        writes
    }

    fn perform(&mut self, writes: &[(Reg, Reg, Option<Reg>)]) {
        for (carrier, value, mask) in writes {
            let inst = self.build.write(*carrier, *value, *mask);
            self.build.push(Node::Inst(inst));
        }
    }

    /// The mask of the lanes that are here, for several frames to be left: it may be the very register
    /// that the innermost of them keeps its living lanes in.
    fn leaving(&mut self) -> Reg {
        self.build.steady(self.env.exec)
    }

    /// Takes the lanes that are here (`leaving`) out of a frame; false where they leave it by a jump.
    fn leave(&mut self, call: &Call<'a>, index: usize, leaving: Reg, for_good: bool) -> bool {
        let frame = &call.frames[index];
        let exec = self.env.exec;
        if frame.uniform && exec == frame.entry {
            if let Some(gone) = frame.gone.filter(|_| for_good) {
                let yes = self.build.mask(true);
                let inst = self.build.write(gone, yes, None);
                self.build.push(Node::Inst(inst));
            }
            return false;
        }
        if frame.uniform {
            self.facts.learn(Fact::Divergent(frame.id));
            return true;
        }
        self.build.update(U2::AndNot, frame.live, leaving);
        if let Some(gone) = frame.gone.filter(|_| for_good) {
            self.build.update(U2::Or, gone, leaving);
        }
        true
    }

    pub(super) fn leave_by_break(&mut self, call: &Call<'a>) {
        let Some(index) = call.frames.len().checked_sub(1) else { return };
        self.write_back(call, index);
        let leaving = self.leaving();
        self.env.jumped = !self.leave(call, index, leaving, false);
        if self.env.jumped {
            self.build.push(Node::Exit(call.frames[index].id));
        }
        self.env.dead = true;
    }

    pub(super) fn leave_by_continue(&mut self, call: &Call<'a>) {
        let Some(target) = call.frames.iter().rposition(|frame| frame.is_loop) else { return };
        self.write_back(call, target);
        let leaving = self.leaving();
        for index in (target + 1..call.frames.len()).rev() {
            self.leave(call, index, leaving, true);
        }
        let frame = &call.frames[target];
        if frame.uniform {
            // Where lanes differ, the write-back has learned it, and this attempt is not used.
            self.build.push(Node::Next(frame.id));
            self.env.jumped = true;
        }
        self.env.dead = true;
    }

    pub(super) fn leave_by_return(&mut self, call: &mut Call<'a>) {
        self.env.dead = true;
        if call.frames.is_empty() {
            return;
        }
        let frames = 0..call.frames.len();
        let writes: Vec<_> = frames.flat_map(|index| self.writes(call, index, false)).collect();
        self.perform(&writes);
        let leaving = self.leaving();
        let mut jump = None;
        let mut jumping = true;
        for index in (0..call.frames.len()).rev() {
            let stays = self.leave(call, index, leaving, true);
            jumping &= !stays;
            if jumping {
                jump = Some(index);
            }
        }
        if let Some(index) = jump {
            call.frames[index].stops = true;
            self.build.push(Node::Exit(call.frames[index].id));
            self.env.jumped = true;
        }
    }
}
