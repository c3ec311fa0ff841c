//! Changes of texts by whole words, numbers, operators, groups in brackets and statements, which changes of bytes
//! rarely leave in one piece.

/// Numbers at which code decides.
const NUMBERS: [&str; 14] = [
    "0",
    "1",
    "2",
    "-1",
    "3",
    "64",
    "0.0",
    "1.0",
    "0.5",
    "1e-38",
    "3.4e38",
    "2147483647",
    "4294967295u",
    "1e308",
];
const OPERATORS: [&str; 18] = [
    "+", "-", "*", "/", "%", "<", ">", "<=", ">=", "==", "!=", "&&", "||", "&", "|", "^", "<<",
    ">>",
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Space,
    Word,
    Number,
    Other,
}

/// The text after one to four changes.
pub fn edited(text: &str, chance: &mut Chance) -> String {
    let mut tokens: Vec<&str> = split(text);
    for _ in 0..=chance.below(4) {
        edit(&mut tokens, chance);
    }
    tokens.concat()
}

fn edit(tokens: &mut Vec<&str>, chance: &mut Chance) {
    let Some(at) = chance.index(tokens.len()) else { return };
    let kind = kind(tokens[at]);
    match chance.below(9) {
        // Another token of the kind, of the text itself or of those that decide.
        0 | 1 => {
            let alike: Vec<&str> =
                tokens.iter().copied().filter(|t| self::kind(t) == kind).collect();
            tokens[at] = alike[chance.below(alike.len())];
        }
        2 if kind == Kind::Number => tokens[at] = NUMBERS[chance.below(NUMBERS.len())],
        2 if kind == Kind::Other => tokens[at] = OPERATORS[chance.below(OPERATORS.len())],
        2 | 3 => {
            tokens.remove(at);
        }
        4 => {
            let other = tokens[chance.below(tokens.len())];
            tokens.insert(at, other);
        }
        // A statement or a line, again elsewhere, or away.
        5 | 6 => {
            let piece = piece(tokens, at);
            let copy = tokens[piece].to_vec();
            let to = piece_start(tokens, chance.below(tokens.len()));
            tokens.splice(to..to, copy);
        }
        7 => {
            tokens.drain(piece(tokens, at));
        }
        // A group in brackets in the place of another.
        _ => {
            let groups = groups(tokens);
            if groups.len() > 1 {
                let (from, to) =
                    (groups[chance.below(groups.len())], groups[chance.below(groups.len())]);
                let copy = tokens[from.0..=from.1].to_vec();
                tokens.splice(to.0..=to.1, copy);
            }
        }
    }
}

/// From behind the separator before `at` to the next one.
fn piece(tokens: &[&str], at: usize) -> std::ops::Range<usize> {
    let end = tokens[at..]
        .iter()
        .position(|token| is_end(token))
        .map_or(tokens.len(), |end| at + end + 1);
    piece_start(tokens, at)..end
}

fn piece_start(tokens: &[&str], at: usize) -> usize {
    tokens[..at].iter().rposition(|token| is_end(token)).map_or(0, |start| start + 1)
}

fn is_end(token: &str) -> bool {
    matches!(token, ";" | "{" | "}" | "\n")
}

/// Pairs of brackets, by the places of both.
fn groups(tokens: &[&str]) -> Vec<(usize, usize)> {
    let (mut open, mut groups) = (Vec::new(), Vec::new());
    for (index, token) in tokens.iter().enumerate() {
        match *token {
            "(" | "[" => open.push(index),
            ")" | "]" => groups.extend(open.pop().map(|start| (start, index))),
            _ => {}
        }
    }
    groups
}

fn kind(token: &str) -> Kind {
    match token.chars().next() {
        Some(c) if c.is_ascii_digit() => Kind::Number,
        Some(c) if c.is_alphanumeric() || c == '_' => Kind::Word,
        Some(c) if c.is_whitespace() => Kind::Space,
        _ => Kind::Other,
    }
}

/// Words and numbers whole, all else character by character.
fn split(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = match kind(rest) {
            Kind::Word => rest.find(|c: char| !c.is_alphanumeric() && c != '_'),
            Kind::Number => rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '.'),
            _ => Some(first.len_utf8()),
        };
        let (token, others) = rest.split_at(length.unwrap_or(rest.len()));
        tokens.push(token);
        rest = others;
    }
    tokens
}

/// Numbers by chance (Marsaglia 2003, Xorshift RNGs).
pub struct Chance(u64);

impl Chance {
    /// The same numbers for the same seed.
    pub fn new(seed: u32) -> Self {
        Self(u64::from(seed) << 1 | 1)
    }

    /// A number below `count`, which is positive.
    pub fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % count
    }

    fn index(&mut self, count: usize) -> Option<usize> {
        (count > 0).then(|| self.below(count))
    }
}
