//! Bounds what constants unfold to, before naga computes them while parsing: a chain of arrays of
//! arrays doubles with every line, and the text stays short.

use std::collections::HashMap;

use brdf_sdk::{Problem, Result};

use super::declarations::Cut;
use super::tokens::TokenKind;

/// Values that the constants of a plugin may unfold to, and entries of one array.
const MAX_VALUES: u64 = 65_536;

/// Refuses constants, at module scope or in functions, that unfold to too many values.
pub fn check_size(file: &str, source: &str, cut: &Cut) -> Result<()> {
    let refuse = |index: usize, reason: String| {
        let cure = "large tables belong into a native plugin's arrays";
        Err(Problem::at(file, source, cut.tokens[index].span.clone(), reason, cure))
    };
    // Names with the tokens of their initialisers. Constants of one name in several functions count
    // together: a bound from above is all that is wanted.
    let mut initialisers: HashMap<&str, Vec<(usize, usize)>> = HashMap::new();
    for (index, token) in cut.tokens.iter().enumerate() {
        let word = token.text(source);
        if token.kind == TokenKind::Number {
            let digits: String = word.chars().take_while(char::is_ascii_digit).collect();
            let sized = cut.tokens.get(index + 1).is_some_and(|next| next.is('>'))
                && index > 0
                && cut.tokens[index - 1].is(',');
            if sized && digits.parse::<u64>().is_ok_and(|entries| entries > MAX_VALUES) {
                return refuse(
                    index,
                    format!("an array of {digits} entries is more than {MAX_VALUES}"),
                );
            }
        }
        if word == "const" && token.kind == TokenKind::Word {
            let end = cut.tokens[index..].iter().position(|t| t.is(';')).map(|n| index + n);
            if let (Some(name), Some(end)) = (cut.tokens.get(index + 1), end) {
                initialisers.entry(name.text(source)).or_default().push((index + 2, end));
            }
        }
    }
    let mut known: HashMap<&str, u64> = HashMap::new();
    let mut in_order: Vec<_> =
        initialisers.iter().map(|(name, ranges)| (ranges[0].0, *name)).collect();
    in_order.sort_unstable();
    for (first, name) in in_order {
        let size = unfolded(name, &initialisers, source, cut, &mut known, 0);
        if size > MAX_VALUES {
            return refuse(
                first - 1,
                format!("this constant unfolds to more than {MAX_VALUES} values"),
            );
        }
    }
    Ok(())
}

fn unfolded<'a>(
    name: &'a str,
    initialisers: &HashMap<&'a str, Vec<(usize, usize)>>,
    source: &'a str,
    cut: &Cut,
    known: &mut HashMap<&'a str, u64>,
    depth: usize,
) -> u64 {
    if let Some(size) = known.get(name) {
        return *size;
    }
    // A constant that needs itself is naga's to refuse.
    known.insert(name, 1);
    if depth > 1024 {
        return MAX_VALUES + 1;
    }
    let Some(ranges) = initialisers.get(name) else { return 1 };
    let mut total = 0u64;
    for (start, end) in ranges {
        for token in &cut.tokens[*start..(*end).max(*start)] {
            let word = token.text(source);
            let size = match token.kind {
                TokenKind::Word if initialisers.contains_key(word) => {
                    unfolded(word, initialisers, source, cut, known, depth + 1)
                }
                TokenKind::Word | TokenKind::Number => 1,
                _ => 0,
            };
            total = total.saturating_add(size);
        }
    }
    known.insert(name, total.max(1));
    total.max(1)
}
