//! WGSL cut into tokens: just enough to rename identifiers and to find declarations.
//!
//! The grammar is left to naga; this lexer never refuses what naga would accept.

use std::ops::Range;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokenKind {
    /// An identifier or keyword.
    Word,
    /// A number.
    Number,
    /// One character of punctuation.
    Punctuation(char),
    /// A block comment that never ends.
    OpenComment,
}

/// One token and its bytes in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// Where it stands.
    pub span: Range<usize>,
}

impl Token {
    /// The token's text.
    pub fn text<'a>(&self, source: &'a str) -> &'a str {
        &source[self.span.clone()]
    }

    /// Whether it is this character of punctuation.
    pub fn is(&self, c: char) -> bool {
        self.kind == TokenKind::Punctuation(c)
    }
}

/// All tokens of a text, without comments and white space.
pub fn tokens(source: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = source[at..].chars().next() {
        let rest = &source[at..];
        let (kind, length) = if is_blank(c) {
            (None, c.len_utf8())
        } else if rest.starts_with("//") {
            (None, rest.find(is_line_break).unwrap_or(rest.len()))
        } else if rest.starts_with("/*") {
            match block_comment_length(rest) {
                Some(length) => (None, length),
                None => (Some(TokenKind::OpenComment), rest.len()),
            }
        } else if is_word_start(c) {
            (Some(TokenKind::Word), length_while(rest, is_word))
        } else if c.is_ascii_digit() {
            (Some(TokenKind::Number), number_length(rest))
        } else {
            (Some(TokenKind::Punctuation(c)), c.len_utf8())
        };
        if let Some(kind) = kind {
            tokens.push(Token { kind, span: at..at + length });
        }
        at += length;
    }
    tokens
}

/// WGSL's blankspace (section 3.2), which Rust's white space does not quite cover.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}')
}

/// WGSL's line breaks (section 3.2): a comment ends at any of them.
fn is_line_break(c: char) -> bool {
    matches!(c, '\n' | '\u{b}' | '\u{c}' | '\r' | '\u{85}' | '\u{2028}' | '\u{2029}')
}

fn is_word_start(c: char) -> bool {
    c == '_' || unicode_ident::is_xid_start(c)
}

fn is_word(c: char) -> bool {
    c == '_' || unicode_ident::is_xid_continue(c)
}

fn length_while(text: &str, keep: impl Fn(char) -> bool) -> usize {
    text.find(|c| !keep(c)).unwrap_or(text.len())
}

/// Digits, letters (suffix, exponent, hexadecimal) and dots; a sign only behind an exponent letter.
fn number_length(text: &str) -> usize {
    let hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    let mut previous = '0';
    for (at, c) in text.char_indices() {
        let exponent =
            if hexadecimal { matches!(previous, 'p' | 'P') } else { matches!(previous, 'e' | 'E') };
        if !(is_word(c) || c == '.' || (exponent && matches!(c, '+' | '-'))) {
            return at;
        }
        previous = c;
    }
    text.len()
}

/// WGSL's block comments nest.
fn block_comment_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => {
                (depth, at) = (depth - 1, at + 2);
                if depth == 0 {
                    return Some(at);
                }
            }
            _ => at += 1,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(source: &str) -> Vec<&str> {
        tokens(source).iter().map(|token| token.text(source)).collect()
    }

    #[test]
    fn comments_nest_and_numbers_keep_their_signs() {
        assert_eq!(words("a/* x /* y */ z */b // c\nd"), ["a", "b", "d"]);
        assert_eq!(words("1e-3+0x1p-24f-.5"), ["1e-3", "+", "0x1p-24f", "-", ".", "5"]);
        assert_eq!(words("a.x_1(ä)"), ["a", ".", "x_1", "(", "ä", ")"]);
        // A decomposed letter is one word; a comment ends at every line break of WGSL.
        assert_eq!(words("e\u{301}b c"), ["e\u{301}b", "c"]);
        assert_eq!(words("// x\ra // y\u{2028}b\u{200e}(c"), ["a", "b", "(", "c"]);
        assert_eq!(tokens("/* /* */").last().unwrap().kind, TokenKind::OpenComment);
    }
}
