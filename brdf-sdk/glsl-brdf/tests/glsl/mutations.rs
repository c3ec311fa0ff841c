//! Damaged files: each is translated or refused, and nothing panics or runs for ever.

use crate::common::translated;

/// Each construct in a line or two; what fuzzing begins with, too.
const WHOLE: &str = include_str!("../../../../fuzz/seeds/explorer/constructs.brdf");

#[test]
fn damaged_files_are_translated_or_refused() {
    assert!(translated(WHOLE).is_ok(), "{:?}", translated(WHOLE));
    let characters: Vec<char> = WHOLE.chars().collect();
    let pieces = [
        "(",
        ")",
        "{",
        "}",
        ";",
        "?",
        ":",
        "[",
        "]",
        "#if 1\n",
        "*/",
        "/*",
        "++",
        "=",
        ".",
        "1e",
        "vec3",
        "::end shader\n",
        "ä",
        "\u{1}",
        "out ",
    ];
    let mut state = 1u32;
    let mut next = |below: usize| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as usize % below
    };
    let mut told = 0;
    for _ in 0..4000 {
        let mut text = characters.clone();
        for _ in 0..=next(3) {
            let at = next(text.len());
            match next(4) {
                0 => {
                    text.remove(at);
                }
                1 => {
                    let piece: Vec<char> = pieces[next(pieces.len())].chars().collect();
                    text.splice(at..at, piece);
                }
                2 => {
                    let (length, to) = (next(40), next(text.len()));
                    let part: Vec<char> = text.iter().copied().skip(at).take(length).collect();
                    text.splice(to..to, part);
                }
                _ => text.truncate(at.max(20)),
            }
        }
        let text: String = text.into_iter().collect();
        told += usize::from(translated(&text).is_err());
    }
    assert!(told > 2000, "{told}");
}
