//! Assignments, and expressions for what they do.
//!
//! Their statements: several components at once, `+=` and `++`, arrays and their first values. Whether an assignment
//! inside of an expression may be done before it is `effects.rs`'s to say.

use brdf_sdk::Result;

use super::effects::root;
use super::names::Kind;
use super::value::Value;
use super::{Emitter, value::bind};
use crate::ast::{Expr, ExprKind, Span};
use crate::types::{INT, Scalar, Ty};

impl Emitter<'_> {
    /// An expression that stands for what it does: statements.
    pub(super) fn effect(&mut self, expr: &Expr) -> Result<Vec<String>> {
        let outer = (std::mem::take(&mut self.pre), std::mem::take(&mut self.post));
        let done = match &expr.kind {
            ExprKind::Assign(operator, target, value) => {
                Some(self.assignment(operator, target, value, &expr.span)?)
            }
            ExprKind::Step { operator, of, .. } => Some(self.step(operator, of, &expr.span)?),
            ExprKind::Comma(all) => {
                let mut statements = Vec::new();
                for one in all {
                    statements.extend(self.effect(one)?);
                }
                self.pre.extend(statements);
                None
            }
            _ => {
                let value = self.expr(expr)?;
                let calls = matches!(expr.kind, ExprKind::Call { .. }) && value.ty == Ty::Void;
                Some(match calls {
                    true => format!("{};", value.text),
                    false => format!("_ = {};", value.text),
                })
            }
        };
        let pre = std::mem::replace(&mut self.pre, outer.0);
        let post = std::mem::replace(&mut self.post, outer.1);
        Ok(pre.into_iter().chain(done).chain(post).collect())
    }

    /// `target operator value` as a statement.
    pub(super) fn assignment(
        &mut self,
        operator: &str,
        target: &Expr,
        value: &Expr,
        span: &Span,
    ) -> Result<String> {
        let value = self.expr(value)?;
        self.assigned(operator, target, &value, span)
    }

    /// The same of a value that is written.
    pub(super) fn assigned(
        &mut self,
        operator: &str,
        target: &Expr,
        value: &Value,
        span: &Span,
    ) -> Result<String> {
        self.note_assigned(target)?;
        let is_plain = operator == "=" && !matches!(target.kind, ExprKind::Member(..));
        if !is_plain && self.changes(target) {
            return Err(
                self.untranslated("a place that changes while it is looked for", &target.span)
            );
        }
        // Several components at once are no place in WGSL.
        if let ExprKind::Member(of, member) = &target.kind {
            let base = self.expr(of)?;
            let is_scalar = base.ty.vector().is_some_and(|(_, n)| n == 1);
            if base.ty.vector().is_some() && (member.len() > 1 || is_scalar) {
                let (scalar, _, letters) = self.swizzle(&base.ty, member, &target.span)?;
                if is_scalar {
                    return self.assigned(operator, of, value, span);
                }
                let ty = Ty::Vector(scalar, letters.len());
                let current =
                    Value::single(format!("{}.{letters}", base.within(bind::SINGLE)), ty.clone());
                let new = self.combined(operator, &current, value, &ty, span)?;
                let name = self.temporary();
                let mut text = format!("let {name} = {};", new.text);
                for (index, letter) in letters.chars().enumerate() {
                    let from = &"xyzw"[index..=index];
                    text += &format!(" {}.{letter} = {name}.{from};", base.plain());
                }
                return Ok(text);
            }
        }
        let place = self.expr(target)?;
        let place_text = match place.text.strip_suffix(')').and_then(|text| text.split_once("(*")) {
            Some((marks, name)) => format!("{marks}*{name}"),
            None => place.text.clone(),
        };
        // What WGSL can do in place: the operand has the place's own type, or is a number.
        let arithmetic = matches!(operator, "+=" | "-=" | "*=" | "/=") && place.ty.is_float();
        if arithmetic {
            let own = value.converted(&place.ty).or_else(|| {
                let (scalar, _) = place.ty.vector()?;
                value.converted(&Ty::Vector(scalar, 1))
            });
            if let Some(own) = own {
                return Ok(format!("{place_text} {operator} {};", own.text));
            }
        }
        let new = self.combined(operator, &place, value, &place.ty, span)?;
        Ok(format!("{place_text} = {};", new.text))
    }

    /// The value that `current operator= value` makes, as the place's type.
    fn combined(
        &mut self,
        operator: &str,
        current: &Value,
        value: &Value,
        ty: &Ty,
        span: &Span,
    ) -> Result<Value> {
        let new = match operator {
            "=" => value.clone(),
            _ => {
                let current = Value { text: current.plain(), ..current.clone() };
                self.operate(operator.trim_end_matches('='), &current, value, span)?
            }
        };
        new.converted(ty).ok_or_else(|| {
            self.source.problem(
                span.clone(),
                format!("a {} takes no {}", ty.glsl(), new.ty.glsl()),
                "convert the value",
            )
        })
    }

    pub(super) fn step(&mut self, operator: &str, of: &Expr, span: &Span) -> Result<String> {
        let one = Value {
            is_literal: true,
            is_constant: true,
            number: Some(1.0),
            ..Value::single("1", INT)
        };
        let operator = if operator == "++" { "+=" } else { "-=" };
        self.assigned(operator, of, &one, span)
    }

    /// Refuses components of several components as a place: WGSL has none.
    fn no_part_of_swizzle(&mut self, target: &Expr) -> Result<()> {
        let (ExprKind::Member(of, _) | ExprKind::Index(of, _)) = &target.kind else {
            return Ok(());
        };
        if let ExprKind::Member(inner, member) = &of.kind
            && member.len() > 1
            && self.expr(inner)?.ty.vector().is_some()
        {
            return Err(
                self.untranslated("a component of several components as a place", &target.span)
            );
        }
        self.no_part_of_swizzle(of)
    }

    /// Remembers that a variable changes, and refuses what cannot.
    fn note_assigned(&mut self, target: &Expr) -> Result<()> {
        self.no_part_of_swizzle(target)?;
        let root = root(target);
        let ExprKind::Name(name) = &root.kind else {
            return Err(self.source.problem(
                target.span.clone(),
                "this is no place that a value can go to",
                "name a variable",
            ));
        };
        let problem = |what: &str| {
            let reason = format!("`{name}` is {what} and cannot change");
            Err(self.source.problem(root.span.clone(), reason, "copy it into a variable first"))
        };
        match self.variable(name).map(|variable| variable.kind) {
            Some(Kind::Local { is_const: true, .. }) => problem("const"),
            Some(Kind::Local { number, .. }) => {
                self.learning.assigned.insert(number);
                Ok(())
            }
            Some(Kind::Parameter { .. }) => problem("a parameter"),
            Some(Kind::Global(index)) if self.globals[index].is_const => problem("const"),
            Some(Kind::Global(index)) => {
                self.learning.assigned_globals.insert(index);
                Ok(())
            }
            // What is unknown is refused where it is read.
            Some(Kind::Pointer { .. }) | None => Ok(()),
        }
    }

    /// The type of an array, or the type itself; `count`: its length where none is written.
    pub(super) fn array_type(
        &mut self,
        base: Ty,
        lengths: &[Option<Expr>],
        count: Option<usize>,
    ) -> Result<Ty> {
        let mut ty = base;
        for length in lengths.iter().rev() {
            let n = match length {
                None => count,
                Some(length) => {
                    let value = self.expr(length)?;
                    let whole =
                        value.number.filter(|n| n.fract() == 0.0 && (1.0..=4096.0).contains(n));
                    if !matches!(value.ty, Ty::Vector(Scalar::Int | Scalar::Uint, 1))
                        || whole.is_none()
                    {
                        return Err(self.source.problem(
                            length.span.clone(),
                            "an array's length is a whole number from 1 to 4096 that is known",
                            "write the number",
                        ));
                    }
                    whole.map(|n| n as usize)
                }
            };
            let Some(n) = n else {
                return Err(brdf_sdk::Problem::new(
                    self.source.file,
                    "an array in it has no length",
                    "write its length, or values in braces",
                ));
            };
            ty = Ty::Array(Box::new(ty), n);
        }
        Ok(ty)
    }

    /// What a variable begins with, as its type; values in braces become what they stand for.
    pub(super) fn initial(&mut self, ty: &Ty, expr: &Expr) -> Result<Value> {
        let ExprKind::List(items) = &expr.kind else {
            let value = self.expr(expr)?;
            return value.converted(ty).ok_or_else(|| {
                self.source.problem(
                    expr.span.clone(),
                    format!("a {} does not begin with a {}", ty.glsl(), value.ty.glsl()),
                    "convert the value",
                )
            });
        };
        let types = match ty {
            Ty::Array(of, n) => vec![(**of).clone(); *n],
            Ty::Vector(scalar, n) => vec![Ty::Vector(*scalar, 1); *n],
            Ty::Matrix(c, r) => vec![Ty::Vector(Scalar::Float, *r); *c],
            Ty::Struct(index, _) => {
                self.structs[*index].members.iter().map(|(_, ty, _)| ty.clone()).collect()
            }
            Ty::Void => Vec::new(),
        };
        let mut values = Vec::new();
        for (item, ty) in std::iter::zip(items, &types) {
            values.push(self.initial(ty, item)?);
        }
        if items.len() != types.len() {
            values.clear();
        }
        self.all_as(ty, &types, &values, &expr.span)
    }
}
