//! Loops and switches as statements.
//!
//! A loop runs on while one of its lanes is inside; a switch is a chain of branches. What lanes carry out of both is
//! `frames.rs`'s, the masks of a branch `branch.rs`'s.

use naga::{Block, Expression, Handle, Span, Statement, SwitchCase, SwitchValue};

use super::effects::{Effects, has_break, read_from_outside};
use super::function::Call;
use super::{Fact, Lowering, Result};
use crate::op::{Node, Op, Reg, U1, U2};

impl<'a> Lowering<'a> {
    pub(super) fn run_loop(
        &mut self,
        call: &mut Call<'a>,
        body: &'a Block,
        continuing: &'a Block,
        break_if: Option<Handle<Expression>>,
        rest: &[(&'a Statement, &'a Span)],
    ) -> Result<bool> {
        self.build.check_size()?;
        call.pinned.extend(read_from_outside(call.function, continuing, break_if));
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
            Some(condition) => {
                let stop = self.one(call, condition)?;
                Some(self.build.steady(stop))
            }
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
        let mut next = self.build.close();
        let live = (!uniform).then_some(live);
        if let Some(test) = live {
            // Where the last lanes have left, what is uniform may be what a skipped part left behind.
            next = vec![Node::Region { test, body: next }];
        }
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
            let matches = self.build.unary(Op::U1(U1::Not), elsewhere);
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
}
