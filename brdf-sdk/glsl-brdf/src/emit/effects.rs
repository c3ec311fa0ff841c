//! What expressions change, and whether it may be done before them.
//!
//! WGSL has no assignments inside of expressions: they are done in statements before. That is right where nothing else in
//! the expression could see the difference, and refused where something could.

use brdf_sdk::Result;

use super::Emitter;
use super::names::Kind;
use crate::ast::{Expr, ExprKind, Passed, Span};

/// What an expression does beside having a value.
#[derive(Default)]
struct Effects {
    /// Changes, and calls of functions that change something.
    count: usize,
    /// Variables that change, by name.
    changed: Vec<String>,
    /// Calls of functions that change variables outside of functions.
    outside: usize,
    /// Such variables that are read.
    reads: usize,
}

/// The variable that a place belongs to.
pub(super) fn root(place: &Expr) -> &Expr {
    let mut root = place;
    while let ExprKind::Member(of, _) | ExprKind::Index(of, _) = &root.kind {
        root = of;
    }
    root
}

impl Emitter<'_> {
    /// Refuses a change inside of the expression that is being written where the rest of it could see that it is done
    /// before.
    pub(super) fn only_effect(&self, span: &Span) -> Result<()> {
        let Some(whole) = &self.whole else { return Ok(()) };
        let mut effects = Effects::default();
        // What is assigned at last comes last in any case, and so do assignments that are its value.
        let mut rest = whole;
        let mut targets: Vec<&Expr> = Vec::new();
        while let ExprKind::Assign(_, target, value) = &rest.kind {
            self.gather(target, &mut effects);
            if let ExprKind::Name(name) = &root(target).kind
                && targets.iter().any(|earlier| count_name(earlier, name) > 0)
            {
                effects.changed.push(name.clone());
            }
            targets.push(target);
            rest = value;
        }
        self.gather(rest, &mut effects);
        let twice = effects.changed.iter().find(|name| count_name(whole, name) > 1);
        let outside = effects.outside > 0 && effects.reads > 0;
        if let Some(name) = twice {
            return Err(self.source.problem(
                span.clone(),
                format!("`{name}` changes in the midst of an expression that also reads it"),
                "change it in a statement of its own",
            ));
        }
        if effects.count > 1 || outside {
            return Err(self.source.problem(
                span.clone(),
                "several parts of one expression change something",
                "write them as statements of their own",
            ));
        }
        Ok(())
    }

    /// Whether an expression changes anything.
    pub(super) fn changes(&self, expr: &Expr) -> bool {
        let mut effects = Effects::default();
        self.gather(expr, &mut effects);
        effects.count > 0
    }

    fn gather(&self, expr: &Expr, effects: &mut Effects) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Bool(_) => {}
            ExprKind::Name(name) => {
                if let Some(Kind::Global(index)) = self.variable(name).map(|found| found.kind) {
                    effects.reads += usize::from(self.learned.assigned_globals.contains(&index));
                }
            }
            ExprKind::Call { callee, arguments } => {
                let own = (0..self.functions.len()).filter(|index| {
                    let function = &self.functions[*index];
                    function.name == callee.name && function.arguments.len() == arguments.len()
                });
                let mut acts = false;
                for index in own {
                    for (place, (passed, _)) in self.functions[index].arguments.iter().enumerate() {
                        if *passed != Passed::In {
                            acts = true;
                            if let ExprKind::Name(name) = &root(&arguments[place]).kind {
                                effects.changed.push(name.clone());
                            }
                        }
                    }
                    if self.learned.reads_globals.contains(&index) {
                        acts = true;
                        effects.outside += 1;
                    }
                }
                effects.count += usize::from(acts);
                arguments.iter().for_each(|one| self.gather(one, effects));
            }
            ExprKind::Comma(all) | ExprKind::List(all) => {
                all.iter().for_each(|one| self.gather(one, effects));
            }
            ExprKind::Member(of, _) | ExprKind::Unary(_, of) => self.gather(of, effects),
            ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => {
                self.gather(a, effects);
                self.gather(b, effects);
            }
            ExprKind::Choice(a, b, c) => [a, b, c].iter().for_each(|one| self.gather(one, effects)),
            ExprKind::Assign(_, target, value) => {
                self.changed(target, effects);
                self.gather(value, effects);
            }
            ExprKind::Step { of, .. } => self.changed(of, effects),
        }
    }

    fn changed(&self, target: &Expr, effects: &mut Effects) {
        effects.count += 1;
        if let ExprKind::Name(name) = &root(target).kind {
            effects.changed.push(name.clone());
        }
        self.gather(target, effects);
    }
}

/// How often an expression names a variable.
fn count_name(expr: &Expr, name: &str) -> usize {
    let count = |expr: &Expr| count_name(expr, name);
    match &expr.kind {
        ExprKind::Name(found) => usize::from(found == name),
        ExprKind::Number(_) | ExprKind::Bool(_) => 0,
        ExprKind::Call { arguments: all, .. } | ExprKind::Comma(all) | ExprKind::List(all) => {
            all.iter().map(count).sum()
        }
        ExprKind::Member(of, _) | ExprKind::Unary(_, of) | ExprKind::Step { of, .. } => count(of),
        ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) | ExprKind::Assign(_, a, b) => {
            count(a) + count(b)
        }
        ExprKind::Choice(a, b, c) => count(a) + count(b) + count(c),
    }
}
