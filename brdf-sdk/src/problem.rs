//! The one error type of the project: a line that names the thing, the reason and the cure.
//!
//! A problem in a text file also carries its place, and is then shown with line, column and excerpt.
//! Problems are values: nothing here prints, logs or exits.

use std::fmt;
use std::ops::Range;

/// What went wrong, told to the person who can mend it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The file, option or name at fault.
    pub thing: String,
    /// Where in the file, if `thing` is a text file.
    pub place: Option<Place>,
    /// Why it cannot be used.
    pub reason: String,
    /// What to do about it.
    pub cure: String,
}

/// A stretch of one line of a text file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Length of the marked stretch in characters, at least 1.
    pub length: usize,
    /// The line itself, without its line break.
    pub excerpt: String,
}

/// Shorthand for results whose error is a [`Problem`].
pub type Result<T, E = Problem> = std::result::Result<T, E>;

impl Problem {
    /// A problem with a thing as a whole.
    pub fn new(
        thing: impl Into<String>,
        reason: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self { thing: thing.into(), place: None, reason: reason.into(), cure: cure.into() }
    }

    /// A problem at a byte range of `source`, the text of the file `thing`.
    pub fn at(
        thing: impl Into<String>,
        source: &str,
        span: Range<usize>,
        reason: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self { place: Some(Place::locate(source, span)), ..Self::new(thing, reason, cure) }
    }

    /// The problem in one line, without an excerpt. What it quotes of a file may be anything: control characters
    /// are written out, so that one line stays one and a terminal is told nothing.
    pub fn line(&self) -> String {
        let mut line = self.thing.clone();
        if let Some(place) = &self.place {
            line += &format!(":{}:{}", place.line, place.column);
        }
        line += &format!(": {}", self.reason);
        if !self.cure.is_empty() {
            line += &format!("; {}", self.cure);
        }
        if line.contains(char::is_control) { written_out(&line) } else { line }
    }
}

fn written_out(text: &str) -> String {
    let each = |c: char| match c.is_control() {
        true => c.escape_default().to_string(),
        false => c.to_string(),
    };
    text.chars().map(each).collect()
}

impl Place {
    /// Finds line and column of a byte range; a range over several lines marks the rest of its first.
    pub fn locate(source: &str, span: Range<usize>) -> Self {
        let start = floor_char_boundary(source, span.start);
        let end = floor_char_boundary(source, span.end.max(start));
        let line_start = source[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = source[start..].find('\n').map_or(source.len(), |i| start + i);
        Self {
            line: source[..start].matches('\n').count() + 1,
            column: source[line_start..start].chars().count() + 1,
            length: source[start..end.min(line_end).max(start)].chars().count().max(1),
            excerpt: source[line_start..line_end].trim_end_matches('\r').to_owned(),
        }
    }
}

fn floor_char_boundary(source: &str, index: usize) -> usize {
    let mut index = index.min(source.len());
    while !source.is_char_boundary(index) {
        index -= 1;
    }
    index
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.line())?;
        if let Some(place) = &self.place {
            // Tabs and their like stand as one space, so that the marker sits under what it marks.
            let number = place.line.to_string();
            let gutter = " ".repeat(number.len());
            // Of a long line only the part around the mark is shown.
            const WIDTH: usize = 120;
            let first = (place.column - 1).saturating_sub(WIDTH / 2);
            let shown: String = place.excerpt.chars().skip(first).take(WIDTH).collect();
            let indent = " ".repeat(place.column - 1 - first);
            let marker = "^".repeat(place.length.min(WIDTH - indent.len()));
            write!(f, "\n {number} | {}", shown.replace(char::is_control, " "))?;
            write!(f, "\n {gutter} | {indent}{marker}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Problem {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_long_line_the_part_around_the_mark_is_shown() {
        let source = "x".repeat(5000);
        let shown = Problem::at("f", &source, 3000..3003, "is odd", "mend it").to_string();
        let lines: Vec<_> = shown.lines().collect();
        assert_eq!(lines[0], "f:1:3001: is odd; mend it");
        assert_eq!(lines[1].len(), " 1 | ".len() + 120);
        assert_eq!(lines[2].trim_start_matches([' ', '|']), "^^^");
    }

    #[test]
    fn one_line_stays_one_whatever_it_quotes() {
        let problem = Problem::new("a\nb", "`\0` and `\u{1b}[2J`, `\t\u{9b}é`", "mend it");
        assert_eq!(problem.to_string(), "a\\nb: `\\u{0}` and `\\u{1b}[2J`, `\\t\\u{9b}é`; mend it");
    }

    #[test]
    fn a_place_counts_characters_and_stays_on_its_line() {
        let source = "a = 1\n\tä = [1,\n2]\n";
        let start = source.find('[').unwrap();
        let place = Place::locate(source, start..source.len());
        assert_eq!((place.line, place.column, place.length), (2, 6, 3));
        let shown =
            Problem::at("f.toml", source, start..start + 1, "is odd", "mend it").to_string();
        assert_eq!(shown, "f.toml:2:6: is odd; mend it\n 2 |  ä = [1,\n   |      ^");
    }
}
