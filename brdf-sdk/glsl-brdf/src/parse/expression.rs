//! Expressions, by the binding of their operators.

use brdf_sdk::Result;

use super::Parser;
use crate::ast::{Expr, ExprKind, TypeName};
use crate::lexer::Kind;

/// Operators between two values, from the loosest to the closest.
const BINDING: [&[&str]; 11] = [
    &["||"],
    &["^^"],
    &["&&"],
    &["|"],
    &["^"],
    &["&"],
    &["==", "!="],
    &["<", ">", "<=", ">="],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/", "%"],
];

const ASSIGNING: [&str; 11] = ["=", "+=", "-=", "*=", "/=", "%=", "<<=", ">>=", "&=", "^=", "|="];

const UNARY: [&str; 4] = ["-", "+", "!", "~"];

impl Parser<'_> {
    /// Any expression, those with commas too.
    pub(super) fn expression(&mut self) -> Result<Expr> {
        let first = self.assignment()?;
        if !self.sees(",") {
            return Ok(first);
        }
        let start = first.span.clone();
        let mut all = vec![first];
        while self.take(",") {
            all.push(self.assignment()?);
        }
        Ok(Expr { kind: ExprKind::Comma(all), span: self.since(&start) })
    }

    /// What a variable begins with: an expression, or values in braces.
    pub(super) fn initial(&mut self) -> Result<Expr> {
        if !self.sees("{") {
            return self.assignment();
        }
        let start = self.here();
        self.at += 1;
        let mut values = Vec::new();
        while !self.take("}") {
            values.push(self.deeper(Self::initial)?);
            if !self.take(",") && !self.sees("}") {
                self.expect("}")?;
            }
        }
        Ok(Expr { kind: ExprKind::List(values), span: self.since(&start) })
    }

    pub(super) fn assignment(&mut self) -> Result<Expr> {
        let target = self.conditional()?;
        let found = ASSIGNING.iter().find(|operator| self.sees(operator));
        let Some(operator) = found else { return Ok(target) };
        self.at += 1;
        let value = self.deeper(Self::assignment)?;
        let span = target.span.start..value.span.end;
        Ok(Expr { kind: ExprKind::Assign(operator, Box::new(target), Box::new(value)), span })
    }

    pub(super) fn conditional(&mut self) -> Result<Expr> {
        let condition = self.deeper(|parser| parser.binary(0))?;
        if !self.take("?") {
            return Ok(condition);
        }
        let yes = self.deeper(Self::assignment)?;
        self.expect(":")?;
        let no = self.deeper(Self::assignment)?;
        let span = condition.span.start..no.span.end;
        Ok(Expr { kind: ExprKind::Choice(Box::new(condition), Box::new(yes), Box::new(no)), span })
    }

    fn binary(&mut self, level: usize) -> Result<Expr> {
        let Some(operators) = BINDING.get(level) else { return self.unary() };
        let mut left = self.binary(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let right = self.binary(level + 1)?;
            let span = left.span.start..right.span.end;
            left = Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), span };
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Expr> {
        let start = self.here();
        if let Some(operator) = ["++", "--"].iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let of = Box::new(self.deeper(Self::unary)?);
            return Ok(Expr {
                kind: ExprKind::Step { operator, of, before: true },
                span: self.since(&start),
            });
        }
        if let Some(operator) = UNARY.iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let of = Box::new(self.deeper(Self::unary)?);
            return Ok(Expr { kind: ExprKind::Unary(operator, of), span: self.since(&start) });
        }
        self.postfix()
    }

    fn postfix(&mut self) -> Result<Expr> {
        let start = self.here();
        let mut value = self.primary()?;
        loop {
            let kind = if self.take(".") {
                let (member, _) = self.word("a member")?;
                if self.sees("(") {
                    self.at -= 1;
                    return Err(self.problem(
                        format!("a value has no method `{member}`"),
                        "write the number of elements itself",
                    ));
                }
                ExprKind::Member(Box::new(value), member)
            } else if self.take("[") {
                let index = self.deeper(Self::expression)?;
                self.expect("]")?;
                ExprKind::Index(Box::new(value), Box::new(index))
            } else if let Some(operator) = ["++", "--"].iter().find(|o| self.sees(o)) {
                self.at += 1;
                ExprKind::Step { operator, of: Box::new(value), before: false }
            } else {
                return Ok(value);
            };
            value = Expr { kind, span: self.since(&start) };
        }
    }

    fn primary(&mut self) -> Result<Expr> {
        let Some(token) = self.peek().cloned() else {
            return Err(self.problem("the code ends where a value should stand", "write it"));
        };
        let start = token.span.clone();
        self.at += 1;
        let kind = match token.kind {
            Kind::Number => ExprKind::Number(token.text),
            Kind::Mark if token.is("(") => {
                let inner = self.deeper(Self::expression)?;
                self.expect(")")?;
                return Ok(Expr { kind: inner.kind, span: self.since(&start) });
            }
            Kind::Word if token.is("true") || token.is("false") => ExprKind::Bool(token.is("true")),
            Kind::Word => {
                let is_array = self.is_type(&token.text) && self.sees("[");
                if !is_array && !self.sees("(") {
                    ExprKind::Name(token.text)
                } else {
                    let lengths = if is_array { self.lengths()? } else { Vec::new() };
                    let callee = TypeName { name: token.text, lengths, span: start.clone() };
                    self.expect("(")?;
                    let mut arguments = Vec::new();
                    if self.sees("void") && self.sees_at(1, ")") {
                        self.at += 1;
                    }
                    while !self.take(")") {
                        if !arguments.is_empty() {
                            self.expect(",")?;
                        }
                        arguments.push(self.deeper(Self::assignment)?);
                    }
                    ExprKind::Call { callee, arguments }
                }
            }
            _ => {
                self.at -= 1;
                return Err(self.problem(
                    format!("`{}` stands where a value should", token.text),
                    "write a value",
                ));
            }
        };
        Ok(Expr { kind, span: self.since(&start) })
    }
}
