//! Texts of authors inside Markdown: they are shown as they stand and mean nothing there. Inside of SVG and HTML that is
//! `picture::chart::escape`'s part.

use std::fmt::Write as _;

/// A text as one line of Markdown, also inside a table's cell: white space becomes a blank, and what the
/// language would take for its own is escaped.
pub fn markdown(text: &str) -> String {
    let mut line = String::new();
    for (index, character) in one_line(text).chars().enumerate() {
        match character {
            // GitHub sets what stands between two of these as a formula, and a backslash does not help.
            '$' => line.push_str("&#36;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '&' | '|' | '~' | '#' => {
                line.extend(['\\', character]);
            }
            // What would begin a list or underline a heading.
            '-' | '+' | '=' if index == 0 => line.extend(['\\', character]),
            '.' | ')' if begins_with_number(&line) => line.extend(['\\', character]),
            _ => line.push(character),
        }
    }
    line
}

/// A text set as code. In a table's cell a bar has to be escaped, and nowhere else may it be.
pub fn code(text: &str, in_cell: bool) -> String {
    let text = one_line(text);
    // Longer than any run of backticks inside.
    let runs = text.split(|c| c != '`').map(str::len);
    let fence = "`".repeat(runs.max().unwrap_or_default() + 1);
    let pad = if text.starts_with('`') || text.ends_with('`') { " " } else { "" };
    let text = if in_cell { text.replace('|', "\\|") } else { text };
    match text.is_empty() {
        true => String::new(),
        false => format!("{fence}{pad}{text}{pad}{fence}"),
    }
}

/// A name as a part of a link, and as the anchor that the link leads to.
pub fn url(name: &str) -> String {
    let mut link = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => {
                link.push(char::from(byte));
            }
            _ => {
                let _ = write!(link, "%{byte:02X}");
            }
        }
    }
    link
}

fn one_line(text: &str) -> String {
    let blank = |c: char| c.is_whitespace() || c.is_control();
    text.split(blank).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}

fn begins_with_number(line: &str) -> bool {
    !line.is_empty() && line.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_markdown_would_take_for_its_own_is_escaped() {
        for (text, expected) in [
            ("plain (text), 3.5 - 2 + 1 = 2.5!", "plain (text), 3.5 - 2 + 1 = 2.5!"),
            ("a\n\tb\u{7}c ", "a b c"),
            (
                "<b>*a* | _b_ [c](d) `e` ~f~ \\ # &amp;",
                r"\<b\>\*a\* \| \_b\_ \[c\](d) \`e\` \~f\~ \\ \# \&amp;",
            ),
            ("$x$", "&#36;x&#36;"),
            ("- item", r"\- item"),
            ("12. item", r"12\. item"),
            ("1) item 2)", r"1\) item 2)"),
            ("=", r"\="),
        ] {
            assert_eq!(markdown(text), expected);
        }
    }

    #[test]
    fn code_holds_backticks_and_bars() {
        assert_eq!(code("f = a|b", false), "`f = a|b`");
        assert_eq!(code("f = a|b", true), r"`f = a\|b`");
        assert_eq!(code("a `` b ` c", false), "```a `` b ` c```");
        assert_eq!(code("`a`", false), "`` `a` ``");
        assert_eq!(code(" \n", false), "");
    }

    #[test]
    fn links_hold_every_character() {
        assert_eq!(url("a-b_c.d"), "a-b_c.d");
        assert_eq!(url("a b/ü#\""), "a%20b%2F%C3%BC%23%22");
    }
}
