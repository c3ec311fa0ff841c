//! The module-scope declarations of one WGSL file, and what a plugin's file may not hold.

use std::ops::Range;

use brdf_sdk::{Problem, Result};

use super::tokens::{Token, TokenKind, tokens};

/// One module-scope declaration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Declaration {
    /// `fn`, `struct`, `const`, `alias`, `var`, `override` or `const_assert`.
    pub keyword: String,
    /// Its name; empty for `const_assert`.
    pub name: String,
    /// Where the name stands.
    pub name_span: Range<usize>,
    /// The declaration with its attributes and the comments before it.
    pub span: Range<usize>,
}

/// A WGSL file, cut up.
#[derive(Debug, Clone)]
pub struct Cut {
    /// All tokens.
    pub tokens: Vec<Token>,
    /// The module-scope declarations in order.
    pub declarations: Vec<Declaration>,
    /// Token ranges of the bodies of structs, where `name :` is a member.
    pub struct_bodies: Vec<Range<usize>>,
}

/// No plugin's file has more tokens: naga recurses along long expressions, and its stack is finite.
const MAX_TOKENS: usize = 30_000;

const DECLARING: [&str; 7] = ["fn", "struct", "const", "alias", "var", "override", "const_assert"];

impl Cut {
    /// Cuts a text up; unbalanced brackets are refused, so that an error cannot spill into the next file.
    pub fn new(file: &str, source: &str) -> Result<Self> {
        let cut = Self::unbounded(file, source)?;
        if let Some(token) = cut.tokens.get(MAX_TOKENS) {
            return Err(Problem::at(
                file,
                source,
                token.span.clone(),
                format!("the file has {} tokens, more than {MAX_TOKENS}", cut.tokens.len()),
                "shorten it; large tables belong into a native plugin's arrays",
            ));
        }
        Ok(cut)
    }

    /// As [`Self::new`], for a text of any length.
    pub fn unbounded(file: &str, source: &str) -> Result<Self> {
        let tokens = tokens(source);
        let problem = |span: Range<usize>, reason: String, cure: &str| {
            Err(Problem::at(file, source, span, reason, cure))
        };

        let mut open: Vec<&Token> = Vec::new();
        let mut declarations: Vec<Declaration> = Vec::new();
        let mut struct_bodies = Vec::new();
        let mut end_of_last = 0;
        let mut current: Option<(usize, Declaration)> = None;
        for (index, token) in tokens.iter().enumerate() {
            let TokenKind::Punctuation(c) = token.kind else {
                if token.kind == TokenKind::OpenComment {
                    let span = token.span.start..token.span.start + 2;
                    return problem(span, "this comment never ends".into(), "close it with */");
                }
                // A declaration begins with its keyword at module scope, outside every bracket.
                let word = token.text(source);
                if open.is_empty() && current.is_none() && DECLARING.contains(&word) {
                    let (name, name_span) = declared_name(source, &tokens[index..]);
                    let span = end_of_last..token.span.end;
                    let declaration =
                        Declaration { keyword: word.to_owned(), name, name_span, span };
                    current = Some((index, declaration));
                }
                continue;
            };
            if matches!(c, '(' | '[' | '{') {
                open.push(token);
            } else if matches!(c, ')' | ']' | '}') {
                let opened = open.pop().map(|token| token.text(source));
                let expected = match c {
                    ')' => "(",
                    ']' => "[",
                    _ => "{",
                };
                if opened != Some(expected) {
                    let reason = match opened {
                        None => format!("this `{c}` closes nothing"),
                        Some(opened) => format!("this `{c}` does not close the open `{opened}`"),
                    };
                    return problem(token.span.clone(), reason, "balance the brackets");
                }
            }
            let ends = open.is_empty()
                && match &current {
                    Some((_, declaration))
                        if matches!(declaration.keyword.as_str(), "fn" | "struct") =>
                    {
                        c == '}'
                    }
                    _ => c == ';',
                };
            if ends {
                end_of_last = token.span.end;
                if let Some((first, mut declaration)) = current.take() {
                    declaration.span.end = token.span.end;
                    if declaration.keyword == "struct" {
                        struct_bodies.push(first..index);
                    }
                    declarations.push(declaration);
                }
            }
        }
        if let Some(token) = open.last() {
            let reason = format!("this `{}` is never closed", token.text(source));
            return problem(token.span.clone(), reason, "balance the brackets");
        }
        Ok(Self { tokens, declarations, struct_bodies })
    }

    /// Refuses what a plugin may not hold: directives, attributes, module variables, overrides,
    /// and two declarations of one name. What its functions do is `purity`'s to judge.
    pub fn check_plugin(&self, file: &str, source: &str) -> Result<()> {
        let refuse = |span: Range<usize>, reason: String, cure: &str| {
            Err(Problem::at(file, source, span, reason, cure))
        };
        for (index, token) in self.tokens.iter().enumerate() {
            let word = token.text(source);
            let next = self.tokens.get(index + 1);
            if token.is('@') {
                let span = token.span.start..next.map_or(token.span.end, |next| next.span.end);
                let name = next.map_or("", |next| next.text(source));
                return refuse(
                    span,
                    format!("a plugin has no attributes such as `@{name}`"),
                    "remove it: bindings and entry points are the host's",
                );
            }
            if token.kind != TokenKind::Word {
                continue;
            }
            let at_start = index == 0 || self.tokens[index - 1].is(';');
            if at_start
                && matches!(word, "enable" | "requires" | "diagnostic")
                && !self.declares(word)
            {
                return refuse(
                    token.span.clone(),
                    format!("a plugin has no directives such as `{word}`"),
                    "remove it",
                );
            }
        }
        for (index, declaration) in self.declarations.iter().enumerate() {
            let span = declaration.name_span.clone();
            match declaration.keyword.as_str() {
                "var" => {
                    return refuse(
                        span,
                        format!(
                            "a plugin has no variables at module scope such as `{}`",
                            declaration.name
                        ),
                        "use `const`, or a `var` inside the function: values may not pass from sample to sample",
                    );
                }
                "override" => {
                    return refuse(
                        span,
                        format!("a plugin has no overrides such as `{}`", declaration.name),
                        "declare a parameter in plugin.toml, or use `const`",
                    );
                }
                _ => {}
            }
            let earlier = &self.declarations[..index];
            if !declaration.name.is_empty()
                && earlier.iter().any(|other| other.name == declaration.name)
            {
                return refuse(
                    span,
                    format!("`{}` is declared twice", declaration.name),
                    "rename one of them",
                );
            }
        }
        Ok(())
    }

    /// Whether the file declares this name.
    pub fn declares(&self, name: &str) -> bool {
        self.declaration(name).is_some()
    }

    /// The declaration of this name.
    pub fn declaration(&self, name: &str) -> Option<&Declaration> {
        self.declarations.iter().find(|declaration| declaration.name == name)
    }

    /// Whether a token names a member (`x` in `p.x` or in a struct's body) or an attribute, which
    /// no module-scope name can mean.
    pub fn is_member(&self, index: usize) -> bool {
        if index > 0 && (self.tokens[index - 1].is('.') || self.tokens[index - 1].is('@')) {
            return true;
        }
        let in_struct = self.struct_bodies.iter().any(|body| body.contains(&index));
        let before =
            index > 0 && (self.tokens[index - 1].is('{') || self.tokens[index - 1].is(','));
        in_struct && before && self.tokens.get(index + 1).is_some_and(|next| next.is(':'))
    }
}

/// The first word behind the keyword that is no template argument: `var<private> x` declares x.
fn declared_name(source: &str, tokens: &[Token]) -> (String, Range<usize>) {
    let mut depth = 0;
    for token in &tokens[1..] {
        match token.kind {
            TokenKind::Punctuation('<') => depth += 1,
            TokenKind::Punctuation('>') => depth -= 1,
            TokenKind::Word if depth == 0 && tokens[0].text(source) != "const_assert" => {
                return (token.text(source).to_owned(), token.span.clone());
            }
            _ if depth == 0 => break,
            _ => {}
        }
    }
    (String::new(), tokens[0].span.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_have_names_and_spans() {
        let source = "// head\nconst A = vec2(1, 2);\n@x fn f(a: i32) { if a > 0 { return; } }\nstruct S { a: f32, f: A }\nvar<private> v: array<f32, 3>;";
        let cut = Cut::new("f.wgsl", source).unwrap();
        let names: Vec<_> =
            cut.declarations.iter().map(|d| (d.keyword.as_str(), d.name.as_str())).collect();
        assert_eq!(names, [("const", "A"), ("fn", "f"), ("struct", "S"), ("var", "v")]);
        assert_eq!(
            &source[cut.declarations[1].span.clone()],
            "\n@x fn f(a: i32) { if a > 0 { return; } }"
        );
        // The member `f` of S is not the function f.
        let member = cut.tokens.iter().rposition(|t| t.text(source) == "f").unwrap();
        assert!(cut.is_member(member));
    }

    #[test]
    fn brackets_are_checked_within_the_file() {
        let reason = |source| Cut::new("f.wgsl", source).unwrap_err().reason;
        assert_eq!(reason("fn f() {"), "this `{` is never closed");
        assert_eq!(reason("fn f() }"), "this `}` closes nothing");
        assert_eq!(reason("fn f( }"), "this `}` does not close the open `(`");
        assert_eq!(reason("a /* b"), "this comment never ends");
    }
}
