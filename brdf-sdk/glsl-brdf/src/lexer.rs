//! Tokens, comments and preprocessor lines of the code, each with its place in the file.
//!
//! Comments are kept, since they are written again. Which tokens make sense together is `parse`'s.

use std::ops::Range;

use brdf_sdk::Result;

use crate::Source;
use crate::file::File;

/// A token. What a macro stands for has the place of the macro.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) text: String,
    pub(crate) span: Range<usize>,
}

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Word,
    Number,
    Mark,
    /// A character that GLSL does not have.
    Bad,
}

impl Token {
    pub(crate) fn is(&self, text: &str) -> bool {
        self.text == text
    }
}

/// A token, or a line for the preprocessor.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    Token(Token),
    /// The word behind `#`, the tokens behind it, and the whole line's place.
    Directive {
        name: Token,
        rest: Vec<Token>,
        span: Range<usize>,
    },
}

/// A comment of the author's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comment {
    pub(crate) span: Range<usize>,
    /// As WGSL writes it.
    pub(crate) text: String,
}

impl Comment {
    /// A line that WGSL does not have, kept as a comment.
    pub(crate) fn of_line(source: Source<'_>, span: Range<usize>) -> Self {
        let text = format!("// {}", on_one_line(source.text[span.clone()].trim()));
        Self { span, text }
    }
}

/// A text without what ends a line in WGSL.
fn on_one_line(text: &str) -> String {
    let ends = ['\n', '\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'];
    text.replace(ends, " ")
}

/// The code as it stands.
pub(crate) struct Lexed {
    pub(crate) items: Vec<Item>,
    pub(crate) comments: Vec<Comment>,
}

/// Marks, the longest first.
const MARKS: [&str; 47] = [
    "<<=", ">>=", "##", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "^^", "+=",
    "-=", "*=", "/=", "%=", "&=", "|=", "^=", "+", "-", "*", "/", "%", "<", ">", "=", "!", "~",
    "&", "|", "^", "?", ":", ";", ",", ".", "(", ")", "[", "]", "{", "}", "#",
];

/// Words behind `#` that are the preprocessor's.
const DIRECTIVES: [&str; 13] = [
    "define",
    "undef",
    "if",
    "ifdef",
    "ifndef",
    "elif",
    "else",
    "endif",
    "error",
    "version",
    "extension",
    "pragma",
    "line",
];

/// Cuts all code of a file up.
pub(crate) fn lex(source: Source<'_>, file: &File) -> Result<Lexed> {
    let mut lexed = Lexed { items: Vec::new(), comments: Vec::new() };
    for span in &file.comments {
        lexed.comments.push(Comment::of_line(source, span.clone()));
    }
    for code in &file.code {
        Lexer { source, at: code.start, end: code.end, begins_line: true, lexed: &mut lexed }
            .run()?;
    }
    lexed.comments.sort_by_key(|comment| comment.span.start);
    Ok(lexed)
}

struct Lexer<'a> {
    source: Source<'a>,
    at: usize,
    end: usize,
    /// Whether only blanks stand before in the line.
    begins_line: bool,
    lexed: &'a mut Lexed,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        &self.source.text[self.at..self.end]
    }

    fn run(&mut self) -> Result<()> {
        while let Some(c) = self.rest().chars().next() {
            if c == '\n' {
                self.begins_line = true;
                self.at += 1;
            } else if c.is_whitespace() {
                self.at += c.len_utf8();
            } else if c == '#' && self.begins_line {
                self.hash()?;
            } else if !self.comment()? {
                self.begins_line = false;
                let token = self.token();
                self.lexed.items.push(Item::Token(token));
            }
        }
        Ok(())
    }

    /// Takes a comment where there is one.
    fn comment(&mut self) -> Result<bool> {
        let rest = self.rest();
        let start = self.at;
        if rest.starts_with("//") {
            let length = rest.find('\n').unwrap_or(rest.len());
            self.at += length;
            let text = on_one_line(rest[..length].trim_end());
            self.lexed.comments.push(Comment { span: start..start + length, text });
            return Ok(true);
        }
        if !rest.starts_with("/*") {
            return Ok(false);
        }
        let Some(length) = rest[2..].find("*/").map(|at| at + 4) else {
            return Err(self.source.problem(
                start..start + 2,
                "this comment never ends",
                "close it with */",
            ));
        };
        self.at += length;
        // WGSL's comments nest, GLSL's do not.
        let lines: Vec<String> = rest[2..length - 2].split('\n').map(on_one_line).collect();
        let mut inner = lines.join("\n").replace("/*", "/ *");
        if inner.ends_with('/') {
            inner.push(' ');
        }
        let text = format!("/*{inner}*/");
        self.lexed.comments.push(Comment { span: start..start + length, text });
        Ok(true)
    }

    fn token(&mut self) -> Token {
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let begins_number = bytes[0].is_ascii_digit()
            || (bytes[0] == b'.' && bytes.get(1).is_some_and(u8::is_ascii_digit));
        let (kind, length) = if begins_number {
            let mut length = 1;
            while let Some(c) = rest[length..].chars().next() {
                let signed = matches!(c, '+' | '-')
                    && rest[..length].ends_with(['e', 'E'])
                    && !rest.starts_with("0x");
                if !(word(c) || c == '.' || signed) {
                    break;
                }
                length += 1;
            }
            (Kind::Number, length)
        } else if rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
            (Kind::Word, rest.find(|c: char| !word(c)).unwrap_or(rest.len()))
        } else if let Some(mark) = MARKS.iter().find(|mark| rest.starts_with(**mark)) {
            (Kind::Mark, mark.len())
        } else {
            (Kind::Bad, rest.chars().next().map_or(1, char::len_utf8))
        };
        let span = self.at..self.at + length;
        self.at += length;
        Token { kind, text: rest[..length].to_owned(), span }
    }

    /// A line that begins with `#`: for the preprocessor, or a comment as the format has them.
    fn hash(&mut self) -> Result<()> {
        let start = self.at;
        let rest = self.rest();
        let mut length = 0;
        // A backslash joins the next line.
        loop {
            length += rest[length..].find('\n').unwrap_or(rest.len() - length);
            if !rest[..length].trim_end_matches('\r').ends_with('\\') || length == rest.len() {
                break;
            }
            length += 1;
        }
        let mut line_end = self.at + length;
        self.at += 1;
        let spaced = self.rest().starts_with(char::is_whitespace);
        let mut tokens = Vec::new();
        while self.at < line_end {
            let c = self.rest().chars().next().unwrap_or('\n');
            if c.is_whitespace() || c == '\\' {
                self.at += c.len_utf8();
            } else if self.rest().starts_with("//") {
                break;
            } else if self.rest().starts_with("/*") {
                let inner = self.rest();
                let closed = inner.find("*/").map_or(inner.len(), |at| at + 2);
                self.at += closed;
                // Over its end the line goes on.
                if self.at > line_end {
                    let rest = self.rest();
                    line_end = self.at + rest.find('\n').unwrap_or(rest.len());
                }
            } else {
                tokens.push(self.token());
            }
        }
        self.at = line_end;
        self.begins_line = true;
        let span = start..line_end;
        let known = |token: &Token| DIRECTIVES.contains(&token.text.as_str());
        let is_directive = match tokens.first() {
            None => false,
            Some(first) if !spaced && first.kind == Kind::Word && !known(first) => {
                return Err(self.source.problem(
                    first.span.clone(),
                    format!("there is no preprocessor line `#{}`", first.text),
                    "a comment has a blank behind its `#`",
                ));
            }
            Some(first) => known(first) && (!spaced || !is_prose(&tokens)),
        };
        if is_directive {
            let rest = tokens.split_off(1);
            if let Some(name) = tokens.pop() {
                self.lexed.items.push(Item::Directive { name, rest, span: span.clone() });
            }
            // Its text stays, as a comment: what it does is done.
            self.lexed.comments.push(Comment::of_line(self.source, span));
        } else {
            self.lexed.comments.push(Comment::of_line(self.source, start + 1..span.end));
        }
        Ok(())
    }
}

/// Whether `# if ...` is a sentence: two words stand side by side, as in no condition.
fn is_prose(tokens: &[Token]) -> bool {
    let [name, rest @ ..] = tokens else { return true };
    match name.text.as_str() {
        // `# define the lobe` is a sentence, `# define N 3` is none.
        "define" => match rest {
            [name, first, ..] => {
                first.kind == Kind::Word && name.text.chars().all(|c| c.is_ascii_lowercase())
            }
            _ => false,
        },
        "undef" | "ifdef" | "ifndef" | "version" | "extension" | "pragma" => false,
        "endif" | "else" => !rest.is_empty(),
        "error" | "line" => true,
        _ => {
            let words = |pair: &[Token]| {
                pair.iter().all(|t| t.kind == Kind::Word) && !pair[0].is("defined")
            };
            rest.is_empty() || rest.windows(2).any(words)
        }
    }
}
