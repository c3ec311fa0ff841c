//! The preprocessor: macros, and code that stands under conditions.
//!
//! Tokens in, tokens out; what a macro stands for has the place of its use, so that messages name the author's line.
//! Text and steps are bounded, since macros of macros double. Files are not included.

use std::cell::Cell;
use std::collections::HashMap;
use std::ops::Range;

use brdf_sdk::Result;

use crate::Source;
use crate::lexer::{Item, Kind, Token};
use crate::literal::{Number, number};

/// A macro's arguments, where it has any, and what it stands for.
#[derive(Clone)]
struct Macro {
    arguments: Option<Vec<String>>,
    body: Vec<Token>,
}

/// No code grows beyond this: macros of macros double with each.
const MOST_TOKENS: usize = 200_000;

/// Nor does replacing take more steps than this: macros of nothing double, too.
const MOST_STEPS: usize = 2_000_000;

/// How deep conditions nest.
const DEEPEST: usize = 60;

/// One `#if` that is open: whether its code counts, whether any of its branches did, and whether `#else` was there.
struct Condition {
    counts: bool,
    done: bool,
    last: bool,
    span: Range<usize>,
}

struct Preprocessor<'a> {
    source: Source<'a>,
    macros: HashMap<String, Macro>,
    steps: Cell<usize>,
}

/// The tokens that are left, with macros replaced.
pub(crate) fn expand(source: Source<'_>, items: Vec<Item>) -> Result<Vec<Token>> {
    let mut preprocessor = Preprocessor { source, macros: HashMap::new(), steps: Cell::new(0) };
    for (name, value) in [("__VERSION__", "410"), ("GL_core_profile", "1")] {
        let text = value.to_owned();
        let body = vec![Token { kind: Kind::Number, text, span: 0..0 }];
        preprocessor.macros.insert(name.to_owned(), Macro { arguments: None, body });
    }
    let mut open: Vec<Condition> = Vec::new();
    let mut out = Vec::new();
    // Tokens up to the next directive: a macro's arguments may run over lines.
    let mut waiting = Vec::new();
    for item in items {
        let counts = open.iter().all(|condition| condition.counts);
        match item {
            Item::Token(token) if counts => waiting.push(token),
            Item::Token(_) => {}
            Item::Directive { name, rest, span } => {
                preprocessor.replace(&std::mem::take(&mut waiting), &mut Vec::new(), &mut out)?;
                preprocessor.directive(&name, &rest, &span, &mut open)?;
            }
        }
    }
    preprocessor.replace(&waiting, &mut Vec::new(), &mut out)?;
    match open.pop() {
        Some(condition) => {
            Err(source.problem(condition.span, "this condition never ends", "write `#endif`"))
        }
        None => Ok(out),
    }
}

impl Preprocessor<'_> {
    fn directive(
        &mut self,
        name: &Token,
        rest: &[Token],
        span: &Range<usize>,
        open: &mut Vec<Condition>,
    ) -> Result<()> {
        let outer = open.iter().all(|condition| condition.counts);
        let problem =
            |reason: &str, cure: &str| Err(self.source.problem(span.clone(), reason, cure));
        match name.text.as_str() {
            "if" | "ifdef" | "ifndef" => {
                let counts = outer && self.holds(name, rest, span)?;
                open.push(Condition {
                    counts,
                    done: counts || !outer,
                    last: false,
                    span: span.clone(),
                });
            }
            "elif" | "else" | "endif" => {
                let Some(mut last) = open.pop() else {
                    return problem("there is no `#if` before it", "remove it, or write the `#if`");
                };
                if name.is("endif") {
                    return Ok(());
                }
                if last.last {
                    return problem("the `#else` was there already", "remove one of them");
                }
                last.last = name.is("else");
                last.counts = !last.done && (last.last || self.holds(name, rest, span)?);
                last.done |= last.counts;
                open.push(last);
            }
            _ if !outer => {}
            "define" => self.define(rest, span)?,
            "undef" => {
                if let Some(name) = rest.first() {
                    self.macros.remove(&name.text);
                }
            }
            "error" => {
                let words: Vec<_> = rest.iter().map(|token| token.text.as_str()).collect();
                return problem(
                    &format!("the code says: {}", words.join(" ")),
                    "mend what it names",
                );
            }
            // Versions, extensions and the like mean nothing here; they stay as comments.
            _ => {}
        }
        Ok(())
    }

    fn define(&mut self, rest: &[Token], span: &Range<usize>) -> Result<()> {
        let Some((name, rest)) = rest.split_first().filter(|(name, _)| name.kind == Kind::Word)
        else {
            let reason = "a macro needs a name";
            return Err(self.source.problem(span.clone(), reason, "write `#define NAME VALUE`"));
        };
        // Arguments follow without a blank.
        let opens = rest.first().is_some_and(|t| t.is("(") && t.span.start == name.span.end);
        let (arguments, body) = match rest.iter().position(|token| token.is(")")) {
            Some(close) if opens => {
                let words = rest[1..close].iter().filter(|token| !token.is(","));
                (Some(words.map(|token| token.text.clone()).collect()), &rest[close + 1..])
            }
            _ => (None, rest),
        };
        if let Some(token) = body.iter().find(|token| token.is("##") || token.is("#")) {
            return Err(self.source.problem(
                token.span.clone(),
                "tokens are not joined here",
                "write the macro out",
            ));
        }
        self.macros.insert(name.text.clone(), Macro { arguments, body: body.to_vec() });
        Ok(())
    }

    /// Counts tokens that were taken up.
    fn step(&self, count: usize, token: &Token) -> Result<()> {
        self.steps.set(self.steps.get() + count);
        match self.steps.get() > MOST_STEPS {
            true => Err(self.source.problem(
                token.span.clone(),
                "macros take more steps than anybody waits for",
                "write less of it by macros",
            )),
            false => Ok(()),
        }
    }

    /// Replaces macros, but for those in `hidden`, which are being replaced.
    fn replace(
        &self,
        tokens: &[Token],
        hidden: &mut Vec<String>,
        out: &mut Vec<Token>,
    ) -> Result<()> {
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            at += 1;
            self.step(1, token)?;
            let found = self.macros.get(&token.text).filter(|_| !hidden.contains(&token.text));
            let Some(found) = found else {
                out.push(token.clone());
                continue;
            };
            let mut body = found.body.clone();
            if let Some(names) = &found.arguments {
                if !tokens.get(at).is_some_and(|token| token.is("(")) {
                    out.push(token.clone());
                    continue;
                }
                let Some((given, end)) = arguments(tokens, at) else {
                    return Err(self.source.problem(
                        token.span.clone(),
                        "the macro's arguments never end",
                        "balance the brackets",
                    ));
                };
                self.step(end - at, token)?;
                at = end;
                if given.len() != names.len().max(1) {
                    return Err(self.source.problem(
                        token.span.clone(),
                        format!(
                            "the macro has {} arguments and is given {}",
                            names.len(),
                            given.len()
                        ),
                        "give it as many",
                    ));
                }
                let mut filled = Vec::new();
                for part in body {
                    match names.iter().position(|name| part.is(name)) {
                        Some(index) => self.replace(&given[index], hidden, &mut filled)?,
                        None => filled.push(part),
                    }
                }
                body = filled;
            }
            body.iter_mut().for_each(|part| part.span = token.span.clone());
            hidden.push(token.text.clone());
            self.replace(&body, hidden, out)?;
            hidden.pop();
            if out.len() > MOST_TOKENS {
                return Err(self.source.problem(
                    token.span.clone(),
                    "macros make more code than fits",
                    "write less of it by macros",
                ));
            }
        }
        Ok(())
    }

    /// Whether the code under a condition counts.
    fn holds(&self, name: &Token, rest: &[Token], span: &Range<usize>) -> Result<bool> {
        let unreadable = || {
            self.source.problem(
                span.clone(),
                "this condition cannot be read",
                "compare whole numbers and ask for `defined(NAME)`",
            )
        };
        if name.is("ifdef") || name.is("ifndef") {
            let [word] = rest else { return Err(unreadable()) };
            return Ok(self.macros.contains_key(&word.text) == name.is("ifdef"));
        }
        // `defined` asks for names, and not for what they stand for.
        let mut asked = Vec::new();
        let mut at = 0;
        while let Some(token) = rest.get(at) {
            at += 1;
            if !token.is("defined") {
                asked.push(token.clone());
                continue;
            }
            let bracket = rest.get(at).is_some_and(|token| token.is("("));
            let word = rest.get(at + usize::from(bracket)).ok_or_else(unreadable)?;
            at += if bracket { 3 } else { 1 };
            let text = if self.macros.contains_key(&word.text) { "1" } else { "0" };
            asked.push(Token {
                kind: Kind::Number,
                text: text.to_owned(),
                span: word.span.clone(),
            });
        }
        let mut tokens = Vec::new();
        self.replace(&asked, &mut Vec::new(), &mut tokens)?;
        let mut tokens = tokens.as_slice();
        let value = condition(&mut tokens, 0, 0).filter(|_| tokens.is_empty());
        value.map(|value| value != 0).ok_or_else(unreadable)
    }
}

/// The arguments of a macro whose bracket stands at `open`, and where the code goes on.
fn arguments(tokens: &[Token], open: usize) -> Option<(Vec<Vec<Token>>, usize)> {
    let mut given = vec![Vec::new()];
    let mut depth = 0usize;
    for (index, token) in tokens.iter().enumerate().skip(open) {
        match token.text.as_str() {
            "(" => depth += 1,
            ")" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some((given, index + 1));
        }
        if depth == 1 && token.is(",") {
            given.push(Vec::new());
        } else if !(depth == 1 && index == open) {
            given.last_mut()?.push(token.clone());
        }
    }
    None
}

/// Operators of conditions by their binding.
const BINDING: [&[&str]; 6] =
    [&["||"], &["&&"], &["==", "!="], &["<", "<=", ">", ">="], &["+", "-"], &["*", "/", "%"]];

fn condition(tokens: &mut &[Token], level: usize, depth: usize) -> Option<i64> {
    let Some(operators) = BINDING.get(level) else { return single(tokens, depth) };
    let mut value = condition(tokens, level + 1, depth)?;
    while let Some((operator, rest)) = tokens.split_first() {
        if !operators.contains(&operator.text.as_str()) {
            break;
        }
        *tokens = rest;
        let other = condition(tokens, level + 1, depth)?;
        let truth = |holds: bool| Some(i64::from(holds));
        value = match operator.text.as_str() {
            "||" => truth(value != 0 || other != 0),
            "&&" => truth(value != 0 && other != 0),
            "==" => truth(value == other),
            "!=" => truth(value != other),
            "<" => truth(value < other),
            "<=" => truth(value <= other),
            ">" => truth(value > other),
            ">=" => truth(value >= other),
            "+" => value.checked_add(other),
            "-" => value.checked_sub(other),
            "*" => value.checked_mul(other),
            "/" => value.checked_div(other),
            _ => value.checked_rem(other),
        }?;
    }
    Some(value)
}

fn single(tokens: &mut &[Token], depth: usize) -> Option<i64> {
    if depth > DEEPEST {
        return None;
    }
    let depth = depth + 1;
    let (first, rest) = tokens.split_first()?;
    *tokens = rest;
    match first.text.as_str() {
        "!" => Some(i64::from(single(tokens, depth)? == 0)),
        "-" => single(tokens, depth)?.checked_neg(),
        "+" => single(tokens, depth),
        "(" => {
            let value = condition(tokens, 0, depth)?;
            let (close, rest) = tokens.split_first()?;
            *tokens = rest;
            close.is(")").then_some(value)
        }
        _ => match (first.kind, number(&first.text)) {
            (Kind::Number, Some(Number::Int(value))) => Some(value),
            (Kind::Word, _) => Some(0),
            _ => None,
        },
    }
}
