//! Branches, by masks and selects.
//!
//! A branch on a uniform condition is a jump over one side. A branch on a varying one runs both sides, each passed
//! over where no lane takes it. After either, what the sides made is selected from.

use std::rc::Rc;

use super::function::Call;
use super::{Env, Lowering, Result};
use crate::op::{NONE, Node, Op, Reg, U1, U2};

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
            let not = self.build.unary(Op::U1(U1::Not), condition);
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
        self.build.push(accepted);
        self.build.push(rejected);
        self.join(call, condition, [&first, &second]);
        if uniform {
            self.lanes_by_jump(condition, [&first, &second]);
        } else {
            self.lanes_by_mask(masks, [&first, &second]);
        }
        Ok(())
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

    /// Variables after a branch: what both sides left is selected from. What a side that was passed over would have
    /// left is stale, and not selected. A select is pure, so what follows is shared, and hoisted out of loops that do
    /// not change it, as if there were no branch.
    fn join(&mut self, call: &Call<'a>, condition: Reg, [first, second]: [&Env; 2]) {
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
                    self.survivor(call, var, [*x, *y], [first, second])
                        .unwrap_or_else(|| self.build.select(condition, *x, *y))
                })
                .collect();
            self.env.vars[var] = Rc::new(joined);
        }
    }

    /// The lanes that are left after a branch that each of them took by itself.
    fn lanes_by_mask(&mut self, [accepts, rejects]: [Reg; 2], [first, second]: [&Env; 2]) {
        let entry = self.env.exec;
        // A mask from inside a region is stale where the region was passed over.
        let mut lanes = |env: &Env, mask: Reg| {
            if env.exec == mask { mask } else { self.build.u2(U2::And, mask, env.exec) }
        };
        let (dead, exec) = match (first.dead, second.dead) {
            (true, true) => (true, entry),
            (true, false) => (false, lanes(second, rejects)),
            (false, true) => (false, lanes(first, accepts)),
            (false, false) if first.exec == accepts && second.exec == rejects => (false, entry),
            (false, false) => {
                let (x, y) = (lanes(first, accepts), lanes(second, rejects));
                (false, self.build.u2(U2::Or, x, y))
            }
        };
        self.env.exec = exec;
        self.env.dead = dead;
        self.env.jumped = false;
    }

    /// The lanes that are left after a branch that all of them took together.
    fn lanes_by_jump(&mut self, condition: Reg, [first, second]: [&Env; 2]) {
        let entry = self.env.exec;
        let nobody = self.build.mask(false);
        let (dead, exec) = match (first.dead, second.dead) {
            (true, true) => (true, entry),
            // After a jump nobody comes here; without one, nobody is left who took that side.
            (true, false) if first.jumped => (false, second.exec),
            (false, true) if second.jumped => (false, first.exec),
            (true, false) => (false, self.build.select(condition, nobody, second.exec)),
            (false, true) => (false, self.build.select(condition, first.exec, nobody)),
            (false, false) => (false, self.build.select(condition, first.exec, second.exec)),
        };
        self.env.exec = exec;
        self.env.dead = dead;
        self.env.jumped = dead && first.jumped && second.jumped;
    }
}
