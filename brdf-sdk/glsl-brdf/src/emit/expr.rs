//! Expressions.
//!
//! Each becomes one WGSL expression with its type; what has to be done before or after it stands in `pre` and
//! `post`. Operators, calls and assignments have files of their own.

use brdf_sdk::Result;

use super::Emitter;
use super::names::{Kind, TEMPORARY};
use super::value::{Value, bind};
use crate::ast::{Expr, ExprKind, LENGTH, Span};
use crate::literal::{Number, float, number};
use crate::types::{BOOL, FLOAT, INT, Scalar, Ty};

/// Expressions that are written at the most.
const MOST_WORK: usize = 1_000_000;

impl Emitter<'_> {
    /// An expression as WGSL. What has to be done before it goes into `pre`, what after it into `post`.
    pub(super) fn expr(&mut self, expr: &Expr) -> Result<Value> {
        // Functions are chosen by what they are given, which is written for that alone, again at each depth.
        self.work += 1;
        if self.work > MOST_WORK {
            return Err(self.untranslated("code that nests so many calls", &expr.span));
        }
        match &expr.kind {
            ExprKind::Number(text) => self.number(text, &expr.span),
            ExprKind::Bool(on) => Ok(Value::bool(on.to_string()).at(expr.span.start)),
            ExprKind::Name(name) => self.name(name, &expr.span),
            ExprKind::Call { callee, arguments } => self.call(callee, arguments, &expr.span),
            ExprKind::Member(of, member) => self.member(of, member, &expr.span),
            ExprKind::Index(of, index) => {
                let of_value = self.expr(of)?;
                let index = self.expr(index)?;
                let ty = match &of_value.ty {
                    Ty::Array(of, _) => (**of).clone(),
                    Ty::Vector(scalar, 2..) => Ty::Vector(*scalar, 1),
                    Ty::Matrix(_, rows) => Ty::Vector(Scalar::Float, *rows),
                    other => return Err(self.no_elements(other, &expr.span)),
                };
                if !matches!(index.ty, Ty::Vector(Scalar::Int | Scalar::Uint, 1)) {
                    return Err(self.source.problem(
                        expr.span.clone(),
                        format!("an index is a whole number, and this is a {}", index.ty.glsl()),
                        "write int(...)",
                    ));
                }
                let acts = of_value.acts || index.acts;
                let text = format!("{}[{}]", of_value.within(bind::SINGLE), index.text);
                Ok(Value { acts, ..Value::single(text, ty) })
            }
            ExprKind::Unary(operator, of) => self.unary(operator, of, &expr.span),
            ExprKind::Binary(operator, a, b) => self.binary(operator, a, b, &expr.span),
            ExprKind::Choice(condition, yes, no) => self.choice(condition, yes, no, &expr.span),
            ExprKind::Assign(operator, target, value) => {
                self.only_effect(&expr.span)?;
                let statement = self.assignment(operator, target, value, &expr.span)?;
                self.pre.push(statement);
                self.expr(target)
            }
            ExprKind::Step { operator, of, before } => {
                self.only_effect(&expr.span)?;
                let old = self.expr(of)?;
                let kept = (!before).then(|| self.kept(&old));
                let statement = self.step(operator, of, &expr.span)?;
                self.pre.push(statement);
                match kept {
                    Some(kept) => Ok(kept),
                    None => self.expr(of),
                }
            }
            ExprKind::Comma(all) => {
                let Some((last, others)) = all.split_last() else {
                    return Err(self.untranslated("an empty list", &expr.span));
                };
                for other in others {
                    let statements = self.effect(other)?;
                    self.pre.extend(statements);
                }
                self.expr(last)
            }
            ExprKind::List(_) => Err(self.untranslated("values in braces here", &expr.span)),
        }
    }

    pub(super) fn untranslated(&self, what: &str, span: &Span) -> brdf_sdk::Problem {
        self.source.problem(
            span.clone(),
            format!("{what} cannot be translated"),
            "write it in another way, as statements of its own",
        )
    }

    fn no_elements(&self, ty: &Ty, span: &Span) -> brdf_sdk::Problem {
        self.source.problem(
            span.clone(),
            format!("a {} has no elements", ty.glsl()),
            "index a vector, a matrix or an array",
        )
    }

    /// A value under a name, so that it is computed once and now.
    pub(super) fn kept(&mut self, value: &Value) -> Value {
        let name = self.temporary();
        self.pre.push(format!("let {name} = {};", value.plain()));
        Value::single(name, value.ty.clone())
    }

    pub(super) fn temporary(&mut self) -> String {
        self.temporaries += 1;
        format!("{TEMPORARY}{}", self.temporaries)
    }

    fn number(&mut self, text: &str, span: &Span) -> Result<Value> {
        let value = match number(text) {
            // WGSL reckons with small ones as they are; large ones have to wrap.
            Some(Number::Int(value)) if !(0..1 << 24).contains(&value) => {
                Value { number: Some(value as f64), ..Value::single(format!("i32({value})"), INT) }
            }
            Some(Number::Int(value)) => Value {
                is_literal: true,
                number: Some(value as f64),
                ..Value::single(value.to_string(), INT)
            },
            Some(Number::Uint(value)) => Value {
                number: Some(value as f64),
                ..Value::single(format!("{value}u"), Ty::Vector(Scalar::Uint, 1))
            },
            Some(Number::Float(value)) if (value as f32).is_finite() => {
                Value { number: Some(value), ..Value::single(float(text), FLOAT) }
            }
            Some(Number::Float(_)) => {
                return Err(self.source.problem(
                    span.clone(),
                    format!("`{text}` is larger than a float"),
                    "write at most 3.4e38",
                ));
            }
            None => {
                return Err(self.source.problem(
                    span.clone(),
                    format!("`{text}` is no number"),
                    "write 1, 1u, 0x1f or 1.0",
                ));
            }
        };
        Ok(Value { is_constant: true, ..value }.at(span.start))
    }

    fn name(&mut self, name: &str, span: &Span) -> Result<Value> {
        let Some(variable) = self.variable(name) else {
            let hint = match self.functions.iter().any(|function| function.name == name) {
                true => format!("`{name}` is a function: call it"),
                false => "declare it, or write it into the parameters".to_owned(),
            };
            return Err(self.source.problem(
                span.clone(),
                format!("there is nothing of the name `{name}` here"),
                hint,
            ));
        };
        let value = match variable.kind {
            Kind::Local { name, known, .. } => {
                Value { number: known, ..Value::single(name, variable.ty) }
            }
            Kind::Pointer { name } => Value::single(format!("(*{name})"), variable.ty),
            Kind::Parameter { text } => {
                if text.starts_with("p.") {
                    self.learning.reads_parameters.insert(self.current);
                }
                Value::single(text, variable.ty)
            }
            Kind::Global(index) => self.global(index, variable.ty),
        };
        Ok(value.at(span.start))
    }

    fn member(&mut self, of: &Expr, member: &str, span: &Span) -> Result<Value> {
        let value = self.expr(of)?;
        if member == LENGTH {
            let n = match value.ty {
                Ty::Array(_, n) | Ty::Vector(_, n @ 2..) | Ty::Matrix(n, _) => n,
                _ => return Err(self.no_elements(&value.ty, span)),
            };
            let (number, text) = (Some(n as f64), n.to_string());
            return Ok(Value {
                number,
                is_literal: true,
                is_constant: true,
                ..Value::single(text, INT)
            });
        }
        if let Ty::Struct(index, _) = &value.ty {
            let found = self.structs[*index].members.iter().find(|(name, ..)| name == member);
            let Some((_, ty, wgsl)) = found else {
                return Err(self.source.problem(
                    span.clone(),
                    format!("the struct has no member `{member}`"),
                    "name one that it has",
                ));
            };
            let text = format!("{}.{wgsl}", value.within(bind::SINGLE));
            return Ok(Value { acts: value.acts, ..Value::single(text, ty.clone()) });
        }
        let (scalar, _, letters) = self.swizzle(&value.ty, member, span)?;
        let ty = Ty::Vector(scalar, letters.len());
        if value.ty.vector().is_some_and(|(_, n)| n == 1) {
            return Ok(match letters.len() {
                1 => value,
                _ => Value::call(&ty.wgsl(), &[&value], ty),
            });
        }
        let text = format!("{}.{letters}", value.within(bind::SINGLE));
        Ok(Value { acts: value.acts, ..Value::single(text, ty) })
    }

    /// The components that a member's letters name, in WGSL's letters.
    pub(super) fn swizzle(
        &self,
        ty: &Ty,
        member: &str,
        span: &Span,
    ) -> Result<(Scalar, usize, String)> {
        let problem = || {
            self.source.problem(
                span.clone(),
                format!("a {} has no `.{member}`", ty.glsl()),
                "name components by xyzw, rgba or stpq",
            )
        };
        let (scalar, n) = ty.vector().ok_or_else(problem)?;
        let set = ["xyzw", "rgba", "stpq"]
            .into_iter()
            .find(|set| member.chars().all(|c| set.contains(c)));
        let set = set.filter(|_| (1..=4).contains(&member.len())).ok_or_else(problem)?;
        let mut letters = String::new();
        for c in member.chars() {
            let index = set.find(c).filter(|index| *index < n).ok_or_else(problem)?;
            letters.push_str(&"xyzw"[index..=index]);
        }
        Ok((scalar, n, letters))
    }

    pub(super) fn truth(&self, value: &Value, span: &Span) -> Result<()> {
        match value.ty == BOOL {
            true => Ok(()),
            false => Err(self.source.problem(
                span.clone(),
                format!("a condition is a bool, and this is a {}", value.ty.glsl()),
                "compare it with something",
            )),
        }
    }

    /// A condition.
    pub(super) fn condition(&mut self, expr: &Expr) -> Result<Value> {
        let value = self.expr(expr)?;
        self.truth(&value, &expr.span)?;
        Ok(value)
    }

    fn choice(&mut self, condition: &Expr, yes: &Expr, no: &Expr, span: &Span) -> Result<Value> {
        let test = self.condition(condition)?;
        let before = std::mem::take(&mut self.pre);
        let back = self.post.len();
        let yes = self.expr(yes)?;
        let for_yes = std::mem::take(&mut self.pre);
        let no = self.expr(no)?;
        let for_no = std::mem::replace(&mut self.pre, before);
        if self.post.len() > back {
            return Err(self.untranslated("an argument that is handed back inside of `?:`", span));
        }
        let (yes, no) = match (yes.converted(&no.ty), no.converted(&yes.ty)) {
            (_, Some(no)) => (yes, no),
            (Some(yes), None) => (yes, no),
            (None, None) => {
                return Err(self.source.problem(
                    span.clone(),
                    format!("`?:` chooses between {} and {}", yes.ty.glsl(), no.ty.glsl()),
                    "give both one type",
                ));
            }
        };
        let plain = for_yes.is_empty() && for_no.is_empty() && !yes.acts && !no.acts;
        if plain && yes.ty.is_selectable() {
            // `select` has them the other way round: only the condition, which came first, keeps its place.
            let plain = |value: &Value| Value { text: value.plain(), ..value.clone() };
            let ty = yes.ty.clone();
            return Ok(Value::call("select", &[&plain(&no), &plain(&yes), &test], ty));
        }
        if yes.acts || no.acts || !for_yes.is_empty() || !for_no.is_empty() {
            self.only_effect(span)?;
        }
        let name = self.temporary();
        let branch = |needed: &[String], value: &Value| {
            format!("{} {name} = {};", needed.join(" "), value.plain())
        };
        let text = format!(
            "var {name}: {}; if {} {{ {} }} else {{ {} }}",
            yes.ty.wgsl(),
            test.plain(),
            branch(&for_yes, &yes).trim(),
            branch(&for_no, &no).trim(),
        );
        self.pre.push(text);
        Ok(Value::single(name, yes.ty))
    }
}
