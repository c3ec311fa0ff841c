//! Loops.
//!
//! A `for` stays one where its head fits WGSL's, and becomes a `loop` where it does not; so do `while` and `do`.
//! That loops end is the host's to see to.

use std::collections::HashMap;

use brdf_sdk::Result;

use super::{Emitter, OwnFunction};
use crate::ast::{Expr, ExprKind, Passed, Stmt, StmtKind};

impl Emitter<'_> {
    pub(super) fn for_loop(
        &mut self,
        place: usize,
        first: Option<&Stmt>,
        holds: Option<&Expr>,
        step: Option<&Expr>,
        body: &Stmt,
    ) -> Result<()> {
        self.out.begin(place);
        self.scopes.push(HashMap::new());
        let one = |first: &Stmt| match &first.kind {
            StmtKind::Declare(declaration) => declaration.names.len() == 1,
            StmtKind::Expr(expr) => is_step(expr),
            _ => false,
        };
        // WGSL's `for` has one statement at each place, and nothing that a condition needs before.
        let is_plain = first.is_none_or(one)
            && holds.is_none_or(|holds| self.is_plain(holds))
            && step.is_none_or(|step| is_step(step) && self.changes_plainly(step));
        if is_plain {
            self.out.put("for (");
            match first {
                Some(first) => self.statement(first)?,
                None => self.out.put(";"),
            }
            let test = holds.map(|holds| self.whole_condition(holds)).transpose()?;
            let done = step.map(|step| self.effect(step)).transpose()?.unwrap_or_default();
            if !self.pre.is_empty() || !self.post.is_empty() || done.len() > 1 {
                return Err(self.untranslated("this loop's head", &(place..body.span.start)));
            }
            let test = test.map_or(String::new(), |test| test.text);
            let done = done.concat();
            self.out.put(&format!(" {test}; {})", done.trim_end_matches(';')));
            self.body(body, None)?;
        } else {
            self.out.put("{");
            self.out.depth += 1;
            if let Some(first) = first {
                self.statement(first)?;
            }
            self.out.put_behind("");
            self.any_loop(holds, step, body)?;
            self.out.depth -= 1;
            self.out.put_behind("}");
        }
        self.scopes.pop();
        Ok(())
    }

    /// Whether nothing has to be done before an expression.
    fn is_plain(&self, expr: &Expr) -> bool {
        let plain = |expr: &Expr| self.is_plain(expr);
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Bool(_) | ExprKind::Name(_) => true,
            ExprKind::Call { callee, arguments } => {
                let hands_back = |function: &OwnFunction| {
                    function.arguments.iter().any(|(passed, _)| *passed != Passed::In)
                };
                let own = self.functions.iter().filter(|known| known.name == callee.name);
                !own.clone().any(hands_back) && arguments.iter().all(plain)
            }
            ExprKind::Member(of, _) | ExprKind::Unary(_, of) => plain(of),
            ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => plain(a) && plain(b),
            ExprKind::Choice(..)
            | ExprKind::Step { .. }
            | ExprKind::Assign(..)
            | ExprKind::Comma(_)
            | ExprKind::List(_) => false,
        }
    }

    /// Whether a step of a loop is one assignment to a variable.
    fn changes_plainly(&self, step: &Expr) -> bool {
        match &step.kind {
            ExprKind::Assign(_, target, value) => {
                matches!(target.kind, ExprKind::Name(_)) && self.is_plain(value)
            }
            ExprKind::Step { of, .. } => matches!(of.kind, ExprKind::Name(_)),
            _ => false,
        }
    }

    /// `loop` with a condition before the body, and what is done behind it.
    pub(super) fn any_loop(
        &mut self,
        holds: Option<&Expr>,
        step: Option<&Expr>,
        body: &Stmt,
    ) -> Result<()> {
        self.out.put("loop {");
        self.out.depth += 1;
        if let Some(holds) = holds {
            let test = self.whole_condition(holds)?;
            for text in std::mem::take(&mut self.pre) {
                self.out.put_behind(&text);
            }
            self.no_post(holds)?;
            self.out.put_behind(&format!("if !({}) {{ break; }}", test.plain()));
        }
        self.inner(body)?;
        if let Some(step) = step {
            self.whole = Some(step.clone());
            let texts = self.effect(step)?;
            self.whole = None;
            self.out.put_behind(&format!("continuing {{ {} }}", texts.join(" ")));
        }
        self.close(body);
        Ok(())
    }
}

fn is_step(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Assign(..) | ExprKind::Step { .. })
}
