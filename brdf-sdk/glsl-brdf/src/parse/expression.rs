//! Expressions, by the binding of their operators.
//!
//! It depends on tokens alone. What types the parts have, and whether they fit, is `emit`'s.

use brdf_sdk::Result;

use super::Parser;
use crate::ast::{Expr, ExprKind, LENGTH, Span, TypeName};
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

/// How deep expressions nest: a row of operators counts for each of them.
const HIGHEST: usize = 400;

impl Parser<'_> {
    /// An expression, unless it nests deeper than anybody writes.
    fn made(&self, kind: ExprKind, span: Span) -> Result<Expr> {
        let made = Expr::new(kind, span.clone());
        match made.height > HIGHEST {
            true => Err(self.source.problem(
                span.start..span.start + 1,
                format!("more than {HIGHEST} operators follow each other"),
                "give parts of it names",
            )),
            false => Ok(made),
        }
    }

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
        self.made(ExprKind::Comma(all), self.since(&start))
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
        self.made(ExprKind::List(values), self.since(&start))
    }

    pub(super) fn assignment(&mut self) -> Result<Expr> {
        let target = self.conditional()?;
        let found = ASSIGNING.iter().find(|operator| self.sees(operator));
        let Some(operator) = found else { return Ok(target) };
        self.at += 1;
        let value = self.deeper(Self::assignment)?;
        let span = target.span.start..value.span.end;
        self.made(ExprKind::Assign(operator, Box::new(target), Box::new(value)), span)
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
        self.made(ExprKind::Choice(Box::new(condition), Box::new(yes), Box::new(no)), span)
    }

    fn binary(&mut self, level: usize) -> Result<Expr> {
        let Some(operators) = BINDING.get(level) else { return self.unary() };
        let mut left = self.binary(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let right = self.binary(level + 1)?;
            let span = left.span.start..right.span.end;
            left = self.made(ExprKind::Binary(operator, Box::new(left), Box::new(right)), span)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Expr> {
        let start = self.here();
        if let Some(operator) = ["++", "--"].iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let of = Box::new(self.deeper(Self::unary)?);
            return self.made(ExprKind::Step { operator, of, before: true }, self.since(&start));
        }
        if let Some(operator) = UNARY.iter().find(|operator| self.sees(operator)) {
            self.at += 1;
            let of = Box::new(self.deeper(Self::unary)?);
            return self.made(ExprKind::Unary(operator, of), self.since(&start));
        }
        self.postfix()
    }

    fn postfix(&mut self) -> Result<Expr> {
        let start = self.here();
        let mut value = self.primary()?;
        loop {
            let kind = if self.take(".") {
                let (member, _) = self.word("a member")?;
                let member = match self.take("(") {
                    true if member == "length" => {
                        self.expect(")")?;
                        LENGTH.to_owned()
                    }
                    true => {
                        self.at -= 2;
                        return Err(self.problem(
                            format!("a value has no method `{member}`"),
                            "call a function",
                        ));
                    }
                    false => member,
                };
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
            value = self.made(kind, self.since(&start))?;
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
                return Ok(Expr { span: self.since(&start), ..inner });
            }
            Kind::Word if token.is("true") || token.is("false") => ExprKind::Bool(token.is("true")),
            Kind::Word => {
                let is_array = self.is_type(&token.text) && self.sees("[");
                if !is_array && !self.sees("(") {
                    ExprKind::Name(token.text)
                } else {
                    let lengths = if is_array { self.lengths()? } else { Vec::new() };
                    let callee = TypeName { name: token.text, lengths, span: start.clone() };
                    let arguments = self.listed(|parser| parser.deeper(Self::assignment))?;
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
        self.made(kind, self.since(&start))
    }
}
