//! Statements.
//!
//! It depends on tokens alone. Whether a `break` stands in a loop, or a value fits its variable, is not asked here.

use brdf_sdk::Result;

use super::Parser;
use crate::ast::{Case, Stmt, StmtKind};
use crate::lexer::Kind;

impl Parser<'_> {
    /// Statements in braces.
    pub(super) fn block(&mut self) -> Result<Vec<Stmt>> {
        self.expect("{")?;
        let mut body = Vec::new();
        while !self.take("}") {
            body.push(self.deeper(Self::statement)?);
        }
        Ok(body)
    }

    /// Whether a declaration begins here.
    fn declares(&self) -> bool {
        let Some(token) = self.peek() else { return false };
        if matches!(token.text.as_str(), "const" | "highp" | "mediump" | "lowp") {
            return true;
        }
        // `vec3 x`, `float[2] x`; but not `vec3(1.0).x`.
        token.kind == Kind::Word
            && self.is_type(&token.text)
            && !self.sees_at(1, "(")
            && !self.sees_at(1, ".")
    }

    pub(super) fn statement(&mut self) -> Result<Stmt> {
        let start = self.here();
        let kind = self.statement_kind()?;
        Ok(Stmt { kind, span: self.since(&start) })
    }

    fn statement_kind(&mut self) -> Result<StmtKind> {
        let Some(token) = self.peek() else {
            return Err(self.problem("the code ends inside of a function", "close it with `}`"));
        };
        let start = token.span.clone();
        match token.text.as_str() {
            ";" => {
                self.at += 1;
                Ok(StmtKind::Empty)
            }
            "{" => Ok(StmtKind::Block(self.block()?)),
            "if" => {
                self.at += 1;
                let condition = self.in_brackets()?;
                let then = Box::new(self.deeper(Self::statement)?);
                let other = match self.take("else") {
                    true => Some(Box::new(self.deeper(Self::statement)?)),
                    false => None,
                };
                Ok(StmtKind::If(condition, then, other))
            }
            "for" => self.for_loop(),
            "while" => {
                self.at += 1;
                let holds = self.in_brackets()?;
                Ok(StmtKind::While(holds, Box::new(self.deeper(Self::statement)?)))
            }
            "do" => {
                self.at += 1;
                let body = Box::new(self.deeper(Self::statement)?);
                self.expect("while")?;
                let holds = self.in_brackets()?;
                self.expect(";")?;
                Ok(StmtKind::DoWhile(body, holds))
            }
            "switch" => self.switch(),
            "return" => {
                self.at += 1;
                let value = match self.sees(";") {
                    true => None,
                    false => Some(self.expression()?),
                };
                self.expect(";")?;
                Ok(StmtKind::Return(value))
            }
            "break" | "continue" => {
                let is_break = token.is("break");
                self.at += 1;
                self.expect(";")?;
                Ok(if is_break { StmtKind::Break } else { StmtKind::Continue })
            }
            "discard" => {
                Err(self.problem("a BRDF has no pixel to discard", "return vec3(0.0) instead"))
            }
            "struct" => {
                Err(self.problem("a struct stands inside of a function", "declare it outside"))
            }
            "precision" => {
                while self.peek().is_some() && !self.take(";") {
                    self.at += 1;
                }
                Ok(StmtKind::Empty)
            }
            _ => {
                self.refuse_qualifiers()?;
                if self.declares() {
                    let is_const = self.take("const");
                    let ty = self.type_name()?;
                    return Ok(StmtKind::Declare(self.declaration(is_const, ty, start)?));
                }
                let value = self.expression()?;
                self.expect(";")?;
                Ok(StmtKind::Expr(value))
            }
        }
    }

    fn in_brackets(&mut self) -> Result<crate::ast::Expr> {
        self.expect("(")?;
        let value = self.expression()?;
        self.expect(")")?;
        Ok(value)
    }

    fn for_loop(&mut self) -> Result<StmtKind> {
        self.at += 1;
        self.expect("(")?;
        let first = match self.take(";") {
            true => None,
            false => Some(Box::new(self.statement()?)),
        };
        let holds = match self.sees(";") {
            true => None,
            false => Some(self.expression()?),
        };
        self.expect(";")?;
        let step = match self.sees(")") {
            true => None,
            false => Some(self.expression()?),
        };
        self.expect(")")?;
        let body = Box::new(self.deeper(Self::statement)?);
        Ok(StmtKind::For { first, holds, step, body })
    }

    fn switch(&mut self) -> Result<StmtKind> {
        self.at += 1;
        let of = self.in_brackets()?;
        self.expect("{")?;
        let mut cases: Vec<Case> = Vec::new();
        while !self.take("}") {
            let span = self.here();
            let mut labels = Vec::new();
            loop {
                if self.take("default") {
                    labels.push(None);
                } else if self.take("case") {
                    labels.push(Some(self.expression()?));
                } else {
                    break;
                }
                self.expect(":")?;
            }
            if labels.is_empty() {
                return Err(self.problem("a switch begins with `case` or `default`", "write one"));
            }
            let mut body = Vec::new();
            while !(self.sees("case") || self.sees("default") || self.sees("}")) {
                body.push(self.deeper(Self::statement)?);
            }
            cases.push(Case { labels, body, span });
        }
        Ok(StmtKind::Switch(of, cases))
    }
}
