//! Operators.
//!
//! GLSL's rules for their types, written by WGSL's operators, which convert nothing by themselves. Assigning
//! operators are `assign.rs`'s.

use brdf_sdk::Result;

use super::Emitter;
use super::value::{Value, bind};
use crate::ast::{Expr, Span};
use crate::types::{BOOL, FLOAT, Scalar, Ty};

impl Emitter<'_> {
    pub(super) fn unary(&mut self, operator: &str, of: &Expr, span: &Span) -> Result<Value> {
        let value = self.expr(of)?;
        let wrong = |ty: &Ty| {
            self.source.problem(
                span.clone(),
                format!("`{operator}` has no meaning for a {}", ty.glsl()),
                "give it another type",
            )
        };
        let scalar = value.ty.vector().map(|(scalar, _)| scalar);
        match (operator, scalar) {
            ("+", Some(Scalar::Int | Scalar::Uint | Scalar::Float)) => return Ok(value),
            ("-", None) if matches!(value.ty, Ty::Matrix(..)) => {
                let text = format!("{} * -1.0", value.within(bind::TIMES));
                return Ok(Value {
                    bind: bind::TIMES,
                    acts: value.acts,
                    ..Value::single(text, value.ty)
                });
            }
            ("-", Some(Scalar::Int | Scalar::Float))
            | ("!", Some(Scalar::Bool))
            | ("~", Some(Scalar::Int | Scalar::Uint)) => {}
            ("-", Some(Scalar::Uint)) => {
                let text = format!("0u - {}", value.within(bind::TIMES));
                return Ok(Value {
                    bind: bind::PLUS,
                    acts: value.acts,
                    ..Value::single(text, value.ty)
                });
            }
            _ => return Err(wrong(&value.ty)),
        }
        let text = format!("{operator}{}", value.within(bind::UNARY + 1));
        let number = value.number.filter(|_| operator == "-").map(|number| -number);
        // `-(-1)` takes no point of its own.
        let plain = value.plain();
        let is_literal =
            value.is_literal && operator == "-" && plain.bytes().all(|b| b.is_ascii_digit());
        Ok(Value { text, number, is_literal, bind: bind::UNARY, ..value })
    }

    /// Both as numbers of one kind.
    fn promoted(&self, a: &Value, b: &Value) -> Option<(Value, Value, Scalar)> {
        let ((p, n), (q, m)) = (a.ty.vector()?, b.ty.vector()?);
        let scalar = p.max(q);
        let a = a.converted(&Ty::Vector(scalar, n))?;
        let b = b.converted(&Ty::Vector(scalar, m))?;
        Some((a, b, scalar))
    }

    pub(super) fn binary(
        &mut self,
        operator: &'static str,
        a: &Expr,
        b: &Expr,
        span: &Span,
    ) -> Result<Value> {
        if matches!(operator, "&&" | "||") {
            return self.logic(operator, a, b, span);
        }
        let (a, b) = (self.expr(a)?, self.expr(b)?);
        self.operate(operator, &a, &b, span)
    }

    /// `a operator b`.
    pub(super) fn operate(
        &self,
        operator: &str,
        a: &Value,
        b: &Value,
        span: &Span,
    ) -> Result<Value> {
        let acts = a.acts || b.acts;
        let joined = |a: &Value, operator: &str, b: &Value, ty: Ty, level: u8| {
            // Of equal operators the left one comes first; comparisons and bits stand in brackets beside others.
            let (left, right) = match level {
                bind::PLUS | bind::TIMES => (level, level + 1),
                bind::COMPARE => (bind::PLUS, bind::PLUS),
                _ => (bind::UNARY, bind::UNARY),
            };
            let text = format!("{} {operator} {}", a.within(left), b.within(right));
            let is_constant = a.is_constant && b.is_constant;
            Value { bind: level, acts, is_constant, ..Value::single(text, ty) }
        };
        let problem = || {
            self.source.problem(
                span.clone(),
                format!("`{operator}` has no meaning between {} and {}", a.ty.glsl(), b.ty.glsl()),
                "convert one of them",
            )
        };
        match operator {
            "+" | "-" | "*" | "/" => {
                let level = if matches!(operator, "+" | "-") { bind::PLUS } else { bind::TIMES };
                if let Some(value) =
                    self.with_matrix(operator, a, b, &|a, o, b, ty| joined(a, o, b, ty, level))
                {
                    return Ok(value);
                }
                let (x, y, scalar) = self.promoted(a, b).ok_or_else(problem)?;
                let n = match (x.ty.vector().map_or(1, |v| v.1), y.ty.vector().map_or(1, |v| v.1)) {
                    (n, m) if n == m || m == 1 => n,
                    (1, m) => m,
                    _ => return Err(problem()),
                };
                if scalar == Scalar::Bool {
                    return Err(problem());
                }
                let mut value = joined(&x, operator, &y, Ty::Vector(scalar, n), level);
                value.number = match (a.number, b.number, operator) {
                    (Some(a), Some(b), "+") => Some(a + b),
                    (Some(a), Some(b), "-") => Some(a - b),
                    (Some(a), Some(b), "*") => Some(a * b),
                    (Some(a), Some(b), "/") if scalar == Scalar::Float => Some(a / b),
                    (Some(a), Some(b), "/") if b != 0.0 => Some((a / b).trunc()),
                    _ => None,
                };
                if operator == "/" && value.is_constant && b.number == Some(0.0) {
                    return Err(self.source.problem(
                        span.clone(),
                        "this divides by a zero that is written there",
                        "write the number that is meant, such as 3e38",
                    ));
                }
                Ok(value)
            }
            "%" => {
                let (x, y, scalar) = self.promoted(a, b).ok_or_else(problem)?;
                let n = x.ty.vector().map_or(1, |v| v.1).max(y.ty.vector().map_or(1, |v| v.1));
                match scalar {
                    Scalar::Int | Scalar::Uint => {
                        Ok(joined(&x, "%", &y, Ty::Vector(scalar, n), bind::TIMES))
                    }
                    _ => Err(problem()),
                }
            }
            "<" | ">" | "<=" | ">=" => {
                let (x, y, scalar) = self.promoted(a, b).ok_or_else(problem)?;
                match (scalar, &x.ty, &y.ty) {
                    (Scalar::Bool, ..) => Err(problem()),
                    (_, Ty::Vector(_, 1), Ty::Vector(_, 1)) => {
                        Ok(joined(&x, operator, &y, BOOL, bind::COMPARE))
                    }
                    _ => Err(problem()),
                }
            }
            "==" | "!=" | "^^" => {
                let operator = if operator == "^^" { "!=" } else { operator };
                let (x, y, _) =
                    self.promoted(a, b).filter(|(x, y, _)| x.ty == y.ty).ok_or_else(problem)?;
                if matches!(x.ty, Ty::Vector(_, 1)) {
                    return Ok(joined(&x, operator, &y, BOOL, bind::COMPARE));
                }
                let each = joined(&x, operator, &y, BOOL, bind::COMPARE);
                Ok(Value::call(if operator == "==" { "all" } else { "any" }, &[&each], BOOL))
            }
            "<<" | ">>" => {
                let n = a.ty.vector().map_or(1, |v| v.1);
                let by = Value::call(
                    &Ty::Vector(Scalar::Uint, n).wgsl(),
                    &[b],
                    Ty::Vector(Scalar::Uint, n),
                );
                Ok(joined(a, operator, &by, a.ty.clone(), bind::BITS))
            }
            _ => {
                let (x, y, scalar) = self.promoted(a, b).ok_or_else(problem)?;
                match scalar {
                    Scalar::Int | Scalar::Uint if x.ty == y.ty => {
                        Ok(joined(&x, operator, &y, x.ty.clone(), bind::BITS))
                    }
                    _ => Err(problem()),
                }
            }
        }
    }

    /// Sums and products with matrices; `None` where there is none, or where they have no meaning.
    fn with_matrix(
        &self,
        operator: &str,
        a: &Value,
        b: &Value,
        joined: &dyn Fn(&Value, &str, &Value, Ty) -> Value,
    ) -> Option<Value> {
        let vector = |n: usize| Ty::Vector(Scalar::Float, n);
        match (&a.ty, operator, &b.ty) {
            (Ty::Matrix(..), "+" | "-", other) if a.ty == *other => {
                Some(joined(a, operator, b, a.ty.clone()))
            }
            (Ty::Matrix(c, r), "*", Ty::Matrix(c2, r2)) if c == r2 => {
                Some(joined(a, "*", b, Ty::Matrix(*c2, *r)))
            }
            (Ty::Matrix(c, r), "*", Ty::Vector(Scalar::Float, n)) if n == c => {
                Some(joined(a, "*", b, vector(*r)))
            }
            (Ty::Vector(Scalar::Float, n), "*", Ty::Matrix(c, r)) if n == r => {
                Some(joined(a, "*", b, vector(*c)))
            }
            (Ty::Matrix(..), "*", Ty::Vector(_, 1)) => {
                Some(joined(a, "*", &b.converted(&FLOAT)?, a.ty.clone()))
            }
            (Ty::Vector(_, 1), "*", Ty::Matrix(..)) => {
                Some(joined(&a.converted(&FLOAT)?, "*", b, b.ty.clone()))
            }
            (Ty::Matrix(..), "/", Ty::Vector(_, 1)) => {
                let text = format!("(1.0 / {})", b.converted(&FLOAT)?.within(bind::UNARY));
                let inverse = Value { acts: b.acts, ..Value::single(text, FLOAT) };
                Some(joined(a, "*", &inverse, a.ty.clone()))
            }
            _ => None,
        }
    }

    fn logic(&mut self, operator: &'static str, a: &Expr, b: &Expr, span: &Span) -> Result<Value> {
        let first = self.condition(a)?;
        let before = std::mem::take(&mut self.pre);
        let back = self.post.len();
        let second = self.condition(b)?;
        let needed = std::mem::replace(&mut self.pre, before);
        if self.post.len() > back {
            let what = "an argument that is handed back behind `&&` or `||`";
            return Err(self.untranslated(what, span));
        }
        if !needed.is_empty() {
            // What the second one needs is done where it is asked for alone.
            let name = self.temporary();
            let test = if operator == "&&" { name.clone() } else { format!("!{name}") };
            let inner = format!("{} {name} = {};", needed.join(" "), second.plain());
            self.pre.push(format!("var {name} = {}; if {test} {{ {inner} }}", first.plain()));
            return Ok(Value::single(name, BOOL));
        }
        // WGSL takes a chain of one operator without brackets, and no other mixture.
        let part = |value: &Value| {
            let same = value.bind == bind::LOGIC && value.plain().contains(operator) && {
                let other = if operator == "&&" { "||" } else { "&&" };
                !value.plain().contains(other)
            };
            if same { value.text.clone() } else { value.within(bind::COMPARE) }
        };
        let text = format!("{} {operator} {}", part(&first), second.within(bind::COMPARE));
        let acts = first.acts || second.acts;
        Ok(Value { bind: bind::LOGIC, acts, ..Value::single(text, BOOL) })
    }
}
