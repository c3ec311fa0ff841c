//! Numbers as GLSL writes them.
//!
//! With bases, suffixes and exponents, and as WGSL spells them: by the author's own digits. It knows nothing of
//! types beyond the three that a number may have.

/// A number in the code.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Number {
    Int(i64),
    Uint(u64),
    Float(f64),
}

/// Reads a number; none where it is not one.
pub(crate) fn number(text: &str) -> Option<Number> {
    let lower = text.to_ascii_lowercase();
    if let Some(digits) = lower.strip_prefix("0x") {
        let (digits, unsigned) = suffix(digits, 'u');
        let value = u64::from_str_radix(digits, 16).ok().filter(|v| *v <= u64::from(u32::MAX))?;
        return Some(integer(value, unsigned));
    }
    if lower.bytes().all(|byte| byte.is_ascii_digit() || byte == b'u') {
        let (digits, unsigned) = suffix(&lower, 'u');
        let is_octal = digits.len() > 1 && digits.starts_with('0');
        let value = u64::from_str_radix(digits, if is_octal { 8 } else { 10 }).ok()?;
        return (value <= u64::from(u32::MAX)).then(|| integer(value, unsigned));
    }
    // `1.0lf` is a double.
    let digits = lower.strip_suffix('f').unwrap_or(&lower);
    digits.parse().ok().map(Number::Float)
}

fn suffix(digits: &str, letter: char) -> (&str, bool) {
    match digits.strip_suffix(letter) {
        Some(digits) => (digits, true),
        None => (digits, false),
    }
}

/// What does not fit 31 bits keeps its bits, as in C.
fn integer(value: u64, unsigned: bool) -> Number {
    if unsigned { Number::Uint(value) } else { Number::Int(i64::from(value as u32 as i32)) }
}

/// A float as WGSL writes it, from the author's own digits.
pub(crate) fn float(text: &str) -> String {
    let text = text.trim_end_matches(['f', 'F']);
    let (digits, exponent) = match text.find(['e', 'E']) {
        Some(at) => text.split_at(at),
        None => (text, ""),
    };
    let mut digits = digits.to_owned();
    if digits.starts_with('.') {
        digits.insert(0, '0');
    }
    if digits.ends_with('.') {
        digits.push('0');
    }
    if !digits.contains('.') && exponent.is_empty() {
        digits.push_str(".0");
    }
    digits + &exponent.to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_and_written() {
        assert_eq!(number("1"), Some(Number::Int(1)));
        assert_eq!(number("010"), Some(Number::Int(8)));
        assert_eq!(number("0xFFu"), Some(Number::Uint(255)));
        assert_eq!(number("0xffffffff"), Some(Number::Int(-1)));
        assert_eq!(number(".5f"), Some(Number::Float(0.5)));
        assert_eq!(number("1e-3"), Some(Number::Float(1e-3)));
        assert_eq!(number("09"), None);
        assert_eq!(number("1.0lf"), None);
        for (glsl, wgsl) in
            [("1.", "1.0"), (".5", "0.5"), ("2.5F", "2.5"), ("1E-3", "1e-3"), ("1e3", "1e3")]
        {
            assert_eq!(float(glsl), wgsl);
        }
    }
}
