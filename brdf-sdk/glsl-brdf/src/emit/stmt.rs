//! Statements and functions.
//!
//! Each begins on its own line of the file. What an expression needs before it is put before its statement. Loops
//! are `loops.rs`'s.

use std::collections::HashMap;

use brdf_sdk::Result;

use super::Emitter;
use super::names::{Kind, Variable};
use super::value::Value;
use crate::ast::{
    Case, Declaration, Declared, Expr, ExprKind, Function, Passed, Stmt, StmtKind, TypeName,
};
use crate::types::{Scalar, Ty, named};

impl Emitter<'_> {
    /// A type of GLSL's own, or a struct of the code's.
    pub(super) fn named(&self, name: &str) -> Option<Ty> {
        let own = || self.structs.iter().position(|known| known.name == name);
        let structure = |index: usize| Ty::Struct(index, self.structs[index].wgsl.clone());
        named(name).or_else(|| own().map(structure))
    }

    pub(super) fn type_of(&mut self, name: &TypeName) -> Result<Ty> {
        self.type_with(name, None)
    }

    /// The type of a declared name; an array without a length has that of its first value.
    pub(super) fn declared_type(&mut self, ty: &TypeName, one: &Declared) -> Result<Ty> {
        let count = match one.value.as_ref().map(|value| &value.kind) {
            Some(ExprKind::List(all) | ExprKind::Call { arguments: all, .. }) => Some(all.len()),
            _ => None,
        };
        let base = self.type_with(ty, count)?;
        self.array_type(base, &one.lengths, count)
    }

    fn type_with(&mut self, name: &TypeName, count: Option<usize>) -> Result<Ty> {
        let Some(base) = self.named(&name.name) else {
            return Err(self.source.problem(
                name.span.clone(),
                format!("there is no type `{}`", name.name),
                "declare it before",
            ));
        };
        self.array_type(base, &name.lengths, count)
    }

    /// Writes a function of the code.
    pub(super) fn function(&mut self, index: usize, function: &Function) -> Result<()> {
        let Some(body) = &function.body else { return Ok(()) };
        self.current = index;
        self.temporaries = 0;
        let own = self.functions[index].clone();
        self.result = own.result.clone();
        self.scopes = vec![HashMap::new()];
        let mut arguments = Vec::new();
        if self.learned.reads_parameters.contains(&index) {
            arguments.push("p: Params".to_owned());
        }
        if self.learned.reads_globals.contains(&index) {
            arguments.push(format!("globals: ptr<function, {}>", self.globals_name));
        }
        let mut first = Vec::new();
        for (argument, (passed, ty)) in std::iter::zip(&function.arguments, &own.arguments) {
            let given = if argument.name.is_empty() { "unused" } else { &argument.name };
            let name = self.local_name(given);
            let number = self.next_number();
            let kind = match passed {
                Passed::In => {
                    Kind::Local { name: name.clone(), number, is_const: false, known: None }
                }
                _ => Kind::Pointer { name: name.clone() },
            };
            if *passed != Passed::In {
                arguments.push(format!("{name}: ptr<function, {}>", ty.wgsl()));
            } else if self.learned.assigned.contains(&number) {
                // WGSL's arguments stay what they are.
                let given = self.local_name(&format!("{name}_in"));
                arguments.push(format!("{given}: {}", ty.wgsl()));
                first.push(format!("var {name} = {given};"));
                let kind = Kind::Pointer { name: given };
                self.scopes[0].insert(format!("in {number}"), Variable { ty: ty.clone(), kind });
            } else {
                arguments.push(format!("{name}: {}", ty.wgsl()));
            }
            let variable = Variable { ty: ty.clone(), kind };
            let key = match argument.name.is_empty() {
                true => format!("unnamed {number}"),
                false => argument.name.clone(),
            };
            self.scopes[0].insert(key, variable);
        }
        self.out.begin(function.span.start);
        let result = if own.result == Ty::Void {
            String::new()
        } else {
            format!(" -> {}", own.result.wgsl())
        };
        self.out.put(&format!("fn {}({}){result} {{", own.wgsl, arguments.join(", ")));
        self.out.depth += 1;
        for line in first {
            self.out.put_behind(&line);
        }
        self.scopes.push(HashMap::new());
        self.statements(body)?;
        if own.result != Ty::Void
            && !matches!(body.last().map(|s| &s.kind), Some(StmtKind::Return(_)))
        {
            // GLSL leaves open what a function gives that ends without saying so; WGSL wants it said.
            self.out.put_behind(&format!("return {}();", own.result.wgsl()));
        }
        self.out.depth -= 1;
        self.out.begin(function.span.end - 1);
        self.out.put("}");
        self.scopes.clear();
        Ok(())
    }

    fn next_number(&mut self) -> usize {
        self.numbers += 1;
        self.numbers
    }

    pub(super) fn statements(&mut self, all: &[Stmt]) -> Result<()> {
        for (index, statement) in all.iter().enumerate() {
            self.statement(statement)?;
            let ends = matches!(
                statement.kind,
                StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue
            );
            if ends && let Some(next) = all.get(index + 1) {
                let end = all.last().map_or(next.span.end, |last| last.span.end);
                let text = self.source.text[next.span.start..end].replace(['\n', '\r'], " ");
                self.out.put_behind(&format!(
                    "/* never reached: {} */",
                    text.replace("*/", "* /").replace("/*", "/ *")
                ));
                break;
            }
        }
        Ok(())
    }

    /// Writes what an expression needs before it, and gives back what it needs afterwards.
    fn needs(&mut self) -> Vec<String> {
        for text in std::mem::take(&mut self.pre) {
            self.out.put_behind(&text);
        }
        std::mem::take(&mut self.post)
    }

    fn all_behind(&mut self, texts: Vec<String>) {
        for text in texts {
            self.out.put_behind(&text);
        }
    }

    pub(super) fn statement(&mut self, statement: &Stmt) -> Result<()> {
        let place = statement.span.start;
        match &statement.kind {
            StmtKind::Empty => {}
            StmtKind::Declare(declaration) => self.declare(declaration)?,
            StmtKind::Expr(expr) => {
                self.whole = Some(expr.clone());
                let texts = self.effect(expr)?;
                self.whole = None;
                self.out.begin(place);
                for (index, text) in texts.iter().enumerate() {
                    match index {
                        0 => self.out.put(text),
                        _ => self.out.put_behind(text),
                    }
                }
            }
            StmtKind::If(condition, then, other) => {
                self.out.begin(place);
                self.if_else(condition, then, other.as_deref())?;
            }
            StmtKind::For { first, holds, step, body } => {
                self.for_loop(place, first.as_deref(), holds.as_ref(), step.as_ref(), body)?;
            }
            StmtKind::While(holds, body) => {
                self.out.begin(place);
                self.any_loop(Some(holds), None, body)?;
            }
            StmtKind::DoWhile(body, holds) => {
                self.out.begin(place);
                self.out.put("loop");
                self.body(body, Some(holds))?;
            }
            StmtKind::Switch(of, cases) => self.switch(place, of, cases)?,
            StmtKind::Return(value) => {
                self.out.begin(place);
                let Some(value) = value else {
                    self.out.put("return;");
                    return Ok(());
                };
                self.whole = Some(value.clone());
                let ty = self.result.clone();
                let value = self.initial(&ty, value)?;
                self.whole = None;
                let post = self.needs();
                if post.is_empty() {
                    self.out.put(&format!("return {};", value.text));
                } else {
                    let name = self.temporary();
                    self.out.put(&format!("let {name} = {};", value.text));
                    self.all_behind(post);
                    self.out.put_behind(&format!("return {name};"));
                }
            }
            StmtKind::Break => {
                self.out.begin(place);
                self.out.put("break;");
            }
            StmtKind::Continue => {
                self.out.begin(place);
                self.out.put("continue;");
            }
            StmtKind::Block(_) => {
                self.out.begin(place);
                self.body(statement, None)?;
            }
        }
        Ok(())
    }

    fn declare(&mut self, declaration: &Declaration) -> Result<()> {
        for (index, one) in declaration.names.iter().enumerate() {
            let ty = self.declared_type(&declaration.ty, one)?;
            // A name begins behind what it begins with: that may be a function of the same name.
            self.whole.clone_from(&one.value);
            let value = one.value.as_ref().map(|value| self.initial(&ty, value)).transpose()?;
            self.whole = None;
            self.out.begin(if index == 0 { declaration.span.start } else { one.span.start });
            let post = self.needs();
            let name = self.local_name(&one.name);
            let number = self.next_number();
            let changes = self.learned.assigned.contains(&number);
            let known = value.as_ref().and_then(|value| value.number).filter(|_| !changes);
            self.out.put(&match value {
                None => format!("var {name}: {};", ty.wgsl()),
                Some(value) => {
                    let word = if changes { "var" } else { "let" };
                    // A whole number as it is written would be an i32 in any case; a constant one of an array would not.
                    format!("{word} {name} = {};", value.text)
                }
            });
            self.all_behind(post);
            let kind = Kind::Local { name, number, is_const: declaration.is_const, known };
            if let Some(scope) = self.scopes.last_mut() {
                scope.insert(one.name.clone(), Variable { ty, kind });
            }
        }
        Ok(())
    }

    /// A statement in braces; `holds`: what is asked behind it in a loop.
    pub(super) fn body(&mut self, statement: &Stmt, holds: Option<&Expr>) -> Result<()> {
        self.out.put_behind("{");
        self.out.depth += 1;
        self.inner(statement)?;
        // What is asked at the end does not see the body's own names.
        if let Some(holds) = holds {
            let test = self.whole_condition(holds)?;
            let needed = std::mem::take(&mut self.pre);
            self.no_post(holds)?;
            let needed = if needed.is_empty() { String::new() } else { needed.join(" ") + " " };
            let text = format!("continuing {{ {needed}break if !({}); }}", test.plain());
            self.out.put_behind(&text);
        }
        self.close(statement);
        Ok(())
    }

    /// Closes the braces about a statement where the author did, or behind it.
    pub(super) fn close(&mut self, statement: &Stmt) {
        self.out.depth -= 1;
        if matches!(statement.kind, StmtKind::Block(_)) {
            self.out.begin(statement.span.end - 1);
            self.out.put("}");
        } else {
            self.out.put_behind("}");
        }
    }

    /// What a statement does, in a scope of its own.
    pub(super) fn inner(&mut self, statement: &Stmt) -> Result<()> {
        self.scopes.push(HashMap::new());
        match &statement.kind {
            StmtKind::Block(all) => self.statements(all)?,
            _ => self.statement(statement)?,
        }
        self.scopes.pop();
        Ok(())
    }

    fn if_else(&mut self, condition: &Expr, then: &Stmt, other: Option<&Stmt>) -> Result<()> {
        let test = self.whole_condition(condition)?;
        let test = self.settled(test);
        self.out.put(&format!("if {}", test.text));
        self.body(then, None)?;
        let Some(other) = other else { return Ok(()) };
        self.out.put_behind("else");
        let StmtKind::If(condition, then, more) = &other.kind else {
            return self.body(other, None);
        };
        // `else if`, unless the condition needs something done before.
        let state = (self.pre.clone(), self.post.clone(), self.temporaries);
        self.condition(condition)?;
        let is_plain = self.pre.is_empty() && self.post.is_empty();
        (self.pre, self.post, self.temporaries) = state;
        if is_plain {
            self.out.put_behind("");
            return self.if_else(condition, then, more.as_deref());
        }
        self.body(other, None)
    }

    /// A condition that is no part of another expression.
    pub(super) fn whole_condition(&mut self, expr: &Expr) -> Result<Value> {
        self.whole = Some(expr.clone());
        let value = self.condition(expr);
        self.whole = None;
        value
    }

    /// A value after all that it needs is done.
    fn settled(&mut self, value: Value) -> Value {
        if self.post.is_empty() {
            self.needs();
            return value;
        }
        let kept = self.kept(&value);
        let post = self.needs();
        self.all_behind(post);
        self.out.put_behind("");
        kept
    }

    pub(super) fn no_post(&mut self, expr: &Expr) -> Result<()> {
        match std::mem::take(&mut self.post).is_empty() {
            true => Ok(()),
            false => Err(self
                .untranslated("an argument that is handed back in a loop's condition", &expr.span)),
        }
    }

    fn switch(&mut self, place: usize, of: &Expr, cases: &[Case]) -> Result<()> {
        self.out.begin(place);
        self.whole = Some(of.clone());
        let value = self.expr(of)?;
        self.whole = None;
        let Ty::Vector(scalar @ (Scalar::Int | Scalar::Uint), 1) = value.ty else {
            return Err(self.source.problem(
                of.span.clone(),
                format!("a switch asks for a whole number, and this is a {}", value.ty.glsl()),
                "write int(...)",
            ));
        };
        let value = self.settled(value);
        self.out.put(&format!("switch {} {{", value.text));
        self.out.depth += 1;
        let mut has_default = false;
        for (index, case) in cases.iter().enumerate() {
            let mut labels = Vec::new();
            for label in &case.labels {
                match label {
                    None => {
                        has_default = true;
                        labels.push("default".to_owned());
                    }
                    Some(label) => {
                        let value = self.expr(label)?;
                        let value = value
                            .converted(&Ty::Vector(scalar, 1))
                            .filter(|value| value.is_constant);
                        let value =
                            value.ok_or_else(|| self.untranslated("this label", &label.span))?;
                        labels.push(value.text);
                    }
                }
            }
            let (body, ends) = match case.body.split_last() {
                Some((Stmt { kind: StmtKind::Break, .. }, body)) => (body, true),
                Some((last, _)) => (case.body.as_slice(), leaves(last) || index + 1 == cases.len()),
                None => (case.body.as_slice(), index + 1 == cases.len()),
            };
            if !ends {
                return Err(self.source.problem(
                    case.span.clone(),
                    "this case goes on with the next one",
                    "end it with `break`, and write what both do into a function",
                ));
            }
            self.out.begin(case.span.start);
            self.out.put(&format!("case {}: {{", labels.join(", ")));
            self.out.depth += 1;
            self.scopes.push(HashMap::new());
            self.statements(body)?;
            self.scopes.pop();
            self.out.depth -= 1;
            self.out.put_behind("}");
        }
        if !has_default {
            self.out.put_behind("default: {}");
        }
        self.out.depth -= 1;
        self.out.put_behind("}");
        Ok(())
    }
}

/// Whether nothing behind a statement is reached from it.
fn leaves(statement: &Stmt) -> bool {
    match &statement.kind {
        StmtKind::Return(_) | StmtKind::Continue | StmtKind::Break => true,
        StmtKind::Block(all) => all.last().is_some_and(leaves),
        StmtKind::If(_, then, Some(other)) => leaves(then) && leaves(other),
        _ => false,
    }
}
