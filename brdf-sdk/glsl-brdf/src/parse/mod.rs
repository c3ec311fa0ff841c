//! Tokens to a tree: declarations here, statements and expressions beside.
//!
//! By recursion, as deep as code may nest. Names of structs alone are remembered, since a declaration begins with a
//! type: the parser asks for the grammar, and not for the meaning.

mod expression;
mod statement;

use std::collections::HashSet;

use brdf_sdk::{Problem, Result};

use crate::Source;
use crate::ast::{Argument, Declaration, Declared, Function, Item, Passed, Span, Struct, TypeName};
use crate::lexer::{Kind, Token};
use crate::types::is_type_name;

/// Words that say how precise numbers are, and nothing that WGSL needs.
const PRECISIONS: [&str; 3] = ["highp", "mediump", "lowp"];

/// Words that declare what a BRDF cannot have.
const REFUSED: [(&str, &str); 9] = [
    (
        "uniform",
        "write it as a parameter: `float NAME MIN MAX DEFAULT` between `::begin parameters` and `::end parameters`",
    ),
    ("varying", "a BRDF has its arguments and parameters alone"),
    ("attribute", "a BRDF has its arguments and parameters alone"),
    ("layout", "a BRDF has its arguments and parameters alone"),
    ("buffer", "a BRDF has its arguments and parameters alone"),
    ("shared", "a BRDF has its arguments and parameters alone"),
    ("subroutine", "call a function by its name"),
    ("double", "write float: there are no doubles here"),
    ("sampler2D", "a BRDF reads no textures; tables belong into a native plugin"),
];

/// How deep expressions and blocks may nest.
const DEEPEST: usize = 200;

pub(crate) struct Parser<'a> {
    source: Source<'a>,
    tokens: Vec<Token>,
    at: usize,
    /// Names of the code's own structs.
    structs: HashSet<String>,
    depth: usize,
}

/// The tree of all code.
pub(crate) fn parse(source: Source<'_>, tokens: Vec<Token>) -> Result<Vec<Item>> {
    if let Some(bad) = tokens.iter().find(|token| token.kind == Kind::Bad || token.is("#")) {
        return Err(source.problem(
            bad.span.clone(),
            format!("GLSL has no `{}`", bad.text),
            "remove it",
        ));
    }
    let mut parser = Parser { source, tokens, at: 0, structs: HashSet::new(), depth: 0 };
    let mut items = Vec::new();
    while parser.peek().is_some() {
        parser.item(&mut items)?;
    }
    Ok(items)
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn sees(&self, text: &str) -> bool {
        self.peek().is_some_and(|token| token.is(text))
    }

    fn sees_at(&self, ahead: usize, text: &str) -> bool {
        self.tokens.get(self.at + ahead).is_some_and(|token| token.is(text))
    }

    /// The place of the next token, or behind the last one.
    fn here(&self) -> Span {
        match (self.peek(), self.tokens.last()) {
            (Some(token), _) => token.span.clone(),
            (None, Some(last)) => last.span.clone(),
            (None, None) => 0..0,
        }
    }

    /// From a place to the last token taken.
    fn since(&self, start: &Span) -> Span {
        let end = self
            .at
            .checked_sub(1)
            .and_then(|at| self.tokens.get(at))
            .map_or(start.end, |t| t.span.end);
        start.start..end.max(start.end)
    }

    fn take(&mut self, text: &str) -> bool {
        let sees = self.sees(text);
        self.at += usize::from(sees);
        sees
    }

    fn problem(&self, reason: impl Into<String>, cure: impl Into<String>) -> Problem {
        self.source.problem(self.here(), reason, cure)
    }

    fn expect(&mut self, text: &str) -> Result<Span> {
        let span = self.here();
        if self.take(text) {
            return Ok(span);
        }
        let found =
            self.peek().map_or("the end of the code".to_owned(), |t| format!("`{}`", t.text));
        Err(self.problem(format!("`{text}` is missing before {found}"), format!("write `{text}`")))
    }

    fn word(&mut self, what: &str) -> Result<(String, Span)> {
        match self.peek() {
            Some(token) if token.kind == Kind::Word => {
                let found = (token.text.clone(), token.span.clone());
                self.at += 1;
                Ok(found)
            }
            Some(token) => Err(self.problem(
                format!("`{}` stands where {what} should", token.text),
                format!("write {what}"),
            )),
            None => {
                Err(self.problem(format!("the code ends where {what} should stand"), "write it"))
            }
        }
    }

    /// Goes one level deeper; nobody writes so many.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T>) -> Result<T> {
        if self.depth >= DEEPEST {
            return Err(self.problem(
                format!("the code is nested more than {DEEPEST} deep"),
                "give parts of it names",
            ));
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    fn is_type(&self, name: &str) -> bool {
        is_type_name(name) || self.structs.contains(name)
    }

    fn refuse_qualifiers(&self) -> Result<()> {
        let Some(token) = self.peek() else { return Ok(()) };
        let word = match token.text.as_str() {
            text if text.starts_with("sampler") || text.starts_with("image") => "sampler2D",
            text => text,
        };
        match REFUSED.iter().find(|(known, _)| *known == word) {
            Some((_, cure)) if token.kind == Kind::Word => {
                Err(self.problem(format!("a BRDF has no `{}`", token.text), *cure))
            }
            _ => Ok(()),
        }
    }

    fn skip_precision(&mut self) {
        while self.peek().is_some_and(|token| PRECISIONS.contains(&token.text.as_str())) {
            self.at += 1;
        }
    }

    fn item(&mut self, items: &mut Vec<Item>) -> Result<()> {
        let start = self.here();
        if self.take(";") {
            return Ok(());
        }
        if self.take("precision") {
            while self.peek().is_some() && !self.take(";") {
                self.at += 1;
            }
            return Ok(());
        }
        self.refuse_qualifiers()?;
        if self.sees("struct") {
            let found = self.structure()?;
            items.push(Item::Struct(found));
            return Ok(());
        }
        let mut is_const = false;
        loop {
            if self.take("const") {
                is_const = true;
            } else if !(self.take("inline") || self.take("static")) {
                break;
            }
        }
        self.refuse_qualifiers()?;
        let ty = self.type_name()?;
        if self.peek().is_some_and(|token| token.kind == Kind::Word) && self.sees_at(1, "(") {
            let function = self.function(ty, start)?;
            items.push(Item::Function(function));
            return Ok(());
        }
        let declaration = self.declaration(is_const, ty, start)?;
        items.push(Item::Global(declaration));
        Ok(())
    }

    fn structure(&mut self) -> Result<Struct> {
        self.expect("struct")?;
        let (name, span) = self.word("the name of a struct")?;
        self.structs.insert(name.clone());
        self.expect("{")?;
        let mut members = Vec::new();
        while !self.take("}") {
            self.skip_precision();
            let ty = self.type_name()?;
            let mut names = vec![self.declared(false)?];
            while self.take(",") {
                names.push(self.declared(false)?);
            }
            self.expect(";")?;
            members.push((ty, names));
        }
        self.expect(";")?;
        Ok(Struct { name, span, members })
    }

    /// A type's name, with lengths where it is an array's.
    fn type_name(&mut self) -> Result<TypeName> {
        self.skip_precision();
        let (name, span) = self.word("a type")?;
        if name != "void" && !self.is_type(&name) {
            self.at -= 1;
            return Err(self.problem(
                format!("there is no type `{name}`"),
                "write float, vec3 or another type of GLSL, or declare the struct before",
            ));
        }
        let lengths = self.lengths()?;
        Ok(TypeName { name, lengths, span })
    }

    fn lengths(&mut self) -> Result<Vec<Option<crate::ast::Expr>>> {
        let mut lengths = Vec::new();
        while self.take("[") {
            if self.take("]") {
                lengths.push(None);
                continue;
            }
            lengths.push(Some(self.conditional()?));
            self.expect("]")?;
        }
        Ok(lengths)
    }

    fn declared(&mut self, with_value: bool) -> Result<Declared> {
        let (name, span) = self.word("a name")?;
        let lengths = self.lengths()?;
        let value = match with_value && self.take("=") {
            true => Some(self.initial()?),
            false => None,
        };
        Ok(Declared { name, span, lengths, value })
    }

    /// Names behind a type, up to the semicolon.
    fn declaration(&mut self, is_const: bool, ty: TypeName, start: Span) -> Result<Declaration> {
        let mut names = vec![self.declared(true)?];
        while self.take(",") {
            names.push(self.declared(true)?);
        }
        self.expect(";")?;
        Ok(Declaration { is_const, ty, names, span: self.since(&start) })
    }

    fn function(&mut self, result: TypeName, start: Span) -> Result<Function> {
        let (name, name_span) = self.word("the name of a function")?;
        let arguments = self.listed(Self::argument)?;
        let body = match self.take(";") {
            true => None,
            false => Some(self.block()?),
        };
        Ok(Function { result, name, name_span, arguments, body, span: self.since(&start) })
    }

    /// What stands in brackets, with commas between; `(void)` is nothing.
    fn listed<T>(&mut self, read: impl Fn(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        self.expect("(")?;
        if self.sees("void") && self.sees_at(1, ")") {
            self.at += 1;
        }
        let mut all = Vec::new();
        while !self.take(")") {
            if !all.is_empty() {
                self.expect(",")?;
            }
            all.push(read(self)?);
        }
        Ok(all)
    }

    fn argument(&mut self) -> Result<Argument> {
        let mut passed = Passed::In;
        loop {
            if self.take("out") {
                passed = Passed::Out;
            } else if self.take("inout") {
                passed = Passed::InOut;
            } else if !(self.take("const") || self.take("in")) {
                break;
            }
        }
        self.refuse_qualifiers()?;
        let mut ty = self.type_name()?;
        // An argument that nobody reads needs no name.
        let name = match self.sees(",") || self.sees(")") {
            true => String::new(),
            false => self.word("a name")?.0,
        };
        ty.lengths.extend(self.lengths()?);
        Ok(Argument { passed, ty, name })
    }
}
