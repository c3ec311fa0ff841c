//! Branches, loops and switches, by masks and selects.
//!
//! A branch on a uniform condition is a jump; its sides agree on their variables by moves. A branch on
//! a varying one runs both sides, each passed over where no lane takes it, and selects. A loop carries
//! its variables in registers of their own; lanes write them when they come round or leave. A uniform
//! loop is left by a jump, a divergent one when its mask of living lanes is empty.

use std::rc::Rc;

use naga::{Block, Expression, Handle, Span, Statement, SwitchCase, SwitchValue};

use super::function::{Call, Value};
use super::place::Place;
use super::{Env, Fact, Lowering, Result};
use crate::op::{Bank, NONE, Node, Op, Reg, U2};

/// A loop or a switch around the current point.
pub(super) struct Frame {
    id: u32,
    is_loop: bool,
    /// Left by jumps, all lanes together.
    uniform: bool,
    /// The mask with which it was entered.
    entry: Reg,
    /// Lanes still inside; divergent frames only.
    live: Reg,
    /// Lanes that left for somewhere beyond its end: by `return`, or a switch by `continue`.
    gone: Option<Reg>,
    /// Whether `gone` decides what follows.
    stops: bool,
    /// Variable, component, and the register that carries it.
    carried: Vec<(usize, usize, Reg)>,
}

/// What a body may do, found by looking through it.
#[derive(Default)]
struct Effects {
    vars: Vec<usize>,
    returns: bool,
    /// A `continue` of a loop around this switch.
    continues: bool,
}

impl<'a> Lowering<'a> {
    /// Lowers into a region that is passed over where no lane of `test` is set.
    pub(super) fn region(
        &mut self,
        test: Reg,
        body: impl FnOnce(&mut Self) -> Result<()>,
    ) -> Result<Node> {
        self.build.open(false);
        let done = body(self);
        let nodes = self.build.close();
        done.map(|()| Node::Region { test, body: nodes })
    }

    pub(super) fn branch(
        &mut self,
        call: &mut Call<'a>,
        condition: Reg,
        accept: impl FnOnce(&mut Self, &mut Call<'a>) -> Result<()>,
        reject: impl FnOnce(&mut Self, &mut Call<'a>) -> Result<()>,
    ) -> Result<()> {
        match self.build.constant_value(condition) {
            Some(0) => return reject(self, call),
            Some(_) => return accept(self, call),
            None => {}
        }
        let uniform = self.build.uniform(condition);
        let before = self.env.clone();
        let exec = before.exec;
        let (tests, masks) = if uniform {
            let not = self.build.unary(Op::U1(crate::op::U1::Not), condition);
            ([condition, not], [exec, exec])
        } else {
            let accepts = self.build.u2(U2::And, exec, condition);
            let rejects = self.build.u2(U2::AndNot, exec, condition);
            ([accepts, rejects], [accepts, rejects])
        };
        self.env.exec = masks[0];
        let accepted = self.region(tests[0], |lowering| accept(lowering, call))?;
        let first = std::mem::replace(&mut self.env, before.clone());
        self.env.exec = masks[1];
        let rejected = self.region(tests[1], |lowering| reject(lowering, call))?;
        let second = std::mem::replace(&mut self.env, before);
        if uniform {
            self.join_uniform(call, condition, [accepted, rejected], first, second)
        } else {
            self.build.push(accepted);
            self.build.push(rejected);
            self.join_varying(call, condition, masks, first, second);
            Ok(())
        }
    }

    /// Which of two values of a component survives without a select; `None` where both may.
    fn survivor(
        &self,
        call: &Call<'a>,
        var: usize,
        [x, y]: [Reg; 2],
        [first, second]: [&Env; 2],
    ) -> Option<Reg> {
        // A side that is dead wrote to its frames what they need. Without a frame it has returned, and
        // what belongs to the callers lives on.
        let forgotten =
            !call.frames.is_empty() || self.owners[var] == call.id && var != call.result;
        if x == y || y == NONE || (second.dead && forgotten) {
            Some(x)
        } else if x == NONE || (first.dead && forgotten) {
            Some(y)
        } else {
            None
        }
    }

    fn join_varying(
        &mut self,
        call: &Call<'a>,
        condition: Reg,
        [accepts, rejects]: [Reg; 2],
        first: Env,
        second: Env,
    ) {
        let entry = self.env.exec;
        for var in 0..self.env.vars.len() {
            let (xs, ys) = (&first.vars[var], &second.vars[var]);
            if Rc::ptr_eq(xs, ys) {
                self.env.vars[var] = Rc::clone(xs);
                continue;
            }
            let joined = xs
                .iter()
                .zip(ys.iter())
                .map(|(x, y)| {
                    self.survivor(call, var, [*x, *y], [&first, &second])
                        .unwrap_or_else(|| self.build.select(condition, *x, *y))
                })
                .collect();
            self.env.vars[var] = Rc::new(joined);
        }
        // A mask from inside a region is stale where the region was passed over.
        let mut lanes = |env: &Env, mask: Reg| {
            if env.exec == mask { mask } else { self.build.u2(U2::And, mask, env.exec) }
        };
        let (dead, exec) = match (first.dead, second.dead) {
            (true, true) => (true, entry),
            (true, false) => (false, lanes(&second, rejects)),
            (false, true) => (false, lanes(&first, accepts)),
            (false, false) if first.exec == accepts && second.exec == rejects => (false, entry),
            (false, false) => {
                let (x, y) = (lanes(&first, accepts), lanes(&second, rejects));
                (false, self.build.u2(U2::Or, x, y))
            }
        };
        self.env.exec = exec;
        self.env.dead = dead;
        self.env.jumped = false;
        self.env.returned = first.returned.max(second.returned);
    }

    fn join_uniform(
        &mut self,
        call: &Call<'a>,
        condition: Reg,
        [mut accepted, mut rejected]: [Node; 2],
        first: Env,
        second: Env,
    ) -> Result<()> {
        for var in 0..self.env.vars.len() {
            let (xs, ys) = (&first.vars[var], &second.vars[var]);
            if Rc::ptr_eq(xs, ys) {
                self.env.vars[var] = Rc::clone(xs);
                continue;
            }
            let mut joined = Vec::with_capacity(xs.len());
            for (x, y) in xs.iter().zip(ys.iter()) {
                joined.push(match self.survivor(call, var, [*x, *y], [&first, &second]) {
                    Some(survivor) => survivor,
                    None => self.agree([*x, *y], [&mut accepted, &mut rejected]),
                });
            }
            self.env.vars[var] = Rc::new(joined);
        }
        let entry = self.env.exec;
        let (dead, exec) = match (first.dead, second.dead) {
            (true, true) => (true, entry),
            // After a jump nobody comes here; without one, nobody is left who took that side.
            (true, false) if first.jumped => (false, second.exec),
            (false, true) if second.jumped => (false, first.exec),
            (true, false) => {
                let nobody = self.build.mask(false);
                (false, self.agree([nobody, second.exec], [&mut accepted, &mut rejected]))
            }
            (false, true) => {
                let nobody = self.build.mask(false);
                (false, self.agree([first.exec, nobody], [&mut accepted, &mut rejected]))
            }
            (false, false) if first.exec == second.exec => (false, first.exec),
            (false, false) => {
                (false, self.agree([first.exec, second.exec], [&mut accepted, &mut rejected]))
            }
        };
        debug_assert!(self.build.uniform(condition));
        self.build.push(accepted);
        self.build.push(rejected);
        self.env.exec = exec;
        self.env.dead = dead;
        self.env.jumped = dead && first.jumped && second.jumped;
        self.env.returned = first.returned.max(second.returned);
        Ok(())
    }

    /// A register that each side of a uniform branch moves its own value to.
    fn agree(&mut self, values: [Reg; 2], sides: [&mut Node; 2]) -> Reg {
        let uniform = values.iter().all(|value| self.build.uniform(*value));
        let bank = self.build.info(values[0]).bank;
        let level = self.build.level();
        let joined = self.build.mutable(bank, uniform, level);
        for (value, side) in values.into_iter().zip(sides) {
            let inst = self.build.write(joined, value, None);
            if let Node::Region { body, .. } = side {
                body.push(Node::Inst(inst));
            }
        }
        joined
    }

    pub(super) fn run_loop(
        &mut self,
        call: &mut Call<'a>,
        body: &'a Block,
        continuing: &'a Block,
        break_if: Option<Handle<Expression>>,
        rest: &[(&'a Statement, &'a Span)],
    ) -> Result<bool> {
        self.build.check_size()?;
        let mut effects = Effects::default();
        for block in [body, continuing] {
            self.look_through(call, block, true, &mut effects);
        }
        let gone = effects.returns;
        let index = self.enter(call, true, effects, gone);
        let (id, uniform, live) = {
            let frame = &call.frames[index];
            (frame.id, frame.uniform, frame.live)
        };
        let entry = self.env.exec;
        let inside = if uniform { entry } else { live };
        let span = self.build.span_id();

        self.env.exec = inside;
        self.build.open(true);
        self.block(call, body)?;
        if !self.env.dead {
            self.write_back(call, index);
        }
        let nodes = self.build.close();

        self.carry(call, index);
        self.env.exec = inside;
        self.env.dead = false;
        self.env.jumped = false;
        self.build.open(true);
        self.block(call, continuing)?;
        let stop = match break_if {
            Some(condition) => Some(self.one(call, condition)?),
            None => None,
        };
        self.write_back(call, index);
        if let Some(stop) = stop {
            if !uniform {
                self.build.update(U2::AndNot, live, stop);
            } else if self.build.uniform(stop) {
                self.build.push(Node::Region { test: stop, body: vec![Node::Exit(id)] });
            } else {
                self.facts.learn(Fact::Divergent(id));
            }
        }
        let next = self.build.close();

        let live = (!uniform).then_some(live);
        self.build.push(Node::Loop { id, live, body: nodes, next, span });
        self.exit(call, index, entry, rest)
    }

    pub(super) fn switch(
        &mut self,
        call: &mut Call<'a>,
        selector: Reg,
        cases: &'a [SwitchCase],
        rest: &[(&'a Statement, &'a Span)],
    ) -> Result<bool> {
        // Runs of values that share a body; the default runs where no other does.
        let mut groups: Vec<(Vec<u32>, bool, &'a Block)> = Vec::new();
        let (mut values, mut default) = (Vec::new(), false);
        for case in cases {
            match case.value {
                SwitchValue::I32(value) => values.push(value as u32),
                SwitchValue::U32(value) => values.push(value),
                SwitchValue::Default => default = true,
            }
            if case.fall_through {
                if !case.body.is_empty() {
                    return self.build.refuse("cases that fall through");
                }
                continue;
            }
            groups.push((std::mem::take(&mut values), std::mem::take(&mut default), &case.body));
        }
        let mut effects = Effects::default();
        for (_, _, body) in &groups {
            self.look_through(call, body, false, &mut effects);
        }
        let entry = self.env.exec;
        // A `break` at the end of a case says nothing; any other one needs a frame to leave.
        let framed = groups.iter().any(|(_, _, body)| {
            let last = body.len().saturating_sub(1);
            let ends = matches!(body.last(), Some(Statement::Break));
            has_break(body.iter().take(if ends { last } else { body.len() }))
        });
        let index = if framed {
            let gone = effects.returns || effects.continues;
            let index = self.enter(call, false, effects, gone);
            self.env.exec = call.frames[index].live;
            Some(index)
        } else {
            None
        };

        let mut elsewhere = self.build.mask(false);
        let mut fallback = None;
        for (values, default, body) in groups {
            let mut matches = self.build.mask(false);
            for value in values {
                let value = self.build.word(value);
                let equal = self.build.u2(U2::Equal, selector, value);
                matches = self.build.u2(U2::Or, matches, equal);
            }
            if default {
                fallback = Some(body);
                continue;
            }
            elsewhere = self.build.u2(U2::Or, elsewhere, matches);
            self.case(call, matches, body)?;
        }
        if let Some(body) = fallback {
            let matches = self.build.unary(Op::U1(crate::op::U1::Not), elsewhere);
            self.case(call, matches, body)?;
        }
        match index {
            Some(index) => {
                if !self.env.dead {
                    self.write_back(call, index);
                }
                self.exit(call, index, entry, rest)
            }
            None => Ok(false),
        }
    }

    /// One case of a switch, in the lanes that are still here.
    fn case(&mut self, call: &mut Call<'a>, matches: Reg, body: &'a Block) -> Result<()> {
        if self.env.dead {
            return Ok(());
        }
        let mut statements: Vec<_> = body.span_iter().collect();
        if matches!(statements.last(), Some((Statement::Break, _))) {
            statements.pop();
        }
        self.branch(
            call,
            matches,
            |lowering, call| lowering.statements(call, &statements),
            |_, _| Ok(()),
        )
    }

    /// Enters a loop or a switch: what it carries moves to registers of its own.
    fn enter(
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
    fn carry(&mut self, call: &Call<'a>, index: usize) {
        for (var, component, carrier) in &call.frames[index].carried {
            Rc::make_mut(&mut self.env.vars[*var])[*component] = *carrier;
        }
    }

    /// Leaves a frame at its end; lanes that went further are held back from what follows.
    fn exit(
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
            |lowering, call| {
                lowering.env.dead = true;
                if call.frames.is_empty() {
                    lowering.env.returned = lowering.env.returned.max(call.id);
                }
                Ok(())
            },
            |lowering, call| lowering.statements(call, rest),
        )?;
        Ok(true)
    }

    /// The lanes that are here write what a frame carries.
    fn write_back(&mut self, call: &Call<'a>, index: usize) {
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
            let value = if self.build.info(value).mutable {
                let bank = self.build.info(value).bank;
                self.build.raw(Op::Move(bank), [value, NONE, NONE], 0, 0)
            } else {
                value
            };
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
        let exec = self.env.exec;
        if !self.build.info(exec).mutable {
            return exec;
        }
        self.build.raw(Op::Move(Bank::Word), [exec, NONE, NONE], 0, 0)
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
            self.env.returned = self.env.returned.max(call.id);
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

    /// What a block writes and how it is left, calls included.
    fn look_through(&self, call: &Call<'a>, block: &Block, in_loop: bool, found: &mut Effects) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, .. } => self.written(call, *pointer, found),
                Statement::Call { arguments, .. } => {
                    for argument in arguments {
                        self.written(call, *argument, found);
                    }
                    for place in self.privates.values() {
                        found.vars.extend(place.variable());
                    }
                }
                Statement::Block(inner) => self.look_through(call, inner, in_loop, found),
                Statement::If { accept, reject, .. } => {
                    self.look_through(call, accept, in_loop, found);
                    self.look_through(call, reject, in_loop, found);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.look_through(call, &case.body, in_loop, found);
                    }
                }
                Statement::Loop { body, continuing, .. } => {
                    self.look_through(call, body, true, found);
                    self.look_through(call, continuing, true, found);
                }
                Statement::Return { .. } => found.returns = true,
                Statement::Continue if !in_loop => found.continues = true,
                _ => {}
            }
        }
    }

    fn written(&self, call: &Call<'a>, pointer: Handle<Expression>, found: &mut Effects) {
        let mut root = pointer;
        while let Expression::Access { base, .. } | Expression::AccessIndex { base, .. } =
            call.function.expressions[root]
        {
            root = base;
        }
        let place = match call.function.expressions[root] {
            Expression::LocalVariable(local) => call.locals.get(&local),
            Expression::GlobalVariable(global) => self.privates.get(&global),
            Expression::FunctionArgument(index) => match call.arguments.get(index as usize) {
                Some(Value::Place(place)) => Some(place),
                _ => None,
            },
            _ => None,
        };
        found.vars.extend(place.and_then(Place::variable));
    }
}

impl Place {
    /// The variable in registers that it is a part of.
    fn variable(&self) -> Option<usize> {
        match self {
            Place::Var { var, .. } | Place::OneOf { var, .. } => Some(*var),
            _ => None,
        }
    }
}

/// Whether statements hold a `break` of the switch that they stand in.
fn has_break<'a>(statements: impl Iterator<Item = &'a Statement>) -> bool {
    let mut statements = statements;
    statements.any(|statement| match statement {
        Statement::Break => true,
        Statement::Block(inner) => has_break(&mut inner.iter()),
        Statement::If { accept, reject, .. } => {
            has_break(&mut accept.iter()) || has_break(&mut reject.iter())
        }
        _ => false,
    })
}
