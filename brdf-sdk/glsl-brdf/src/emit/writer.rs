//! Text that keeps the author's lines and comments.
//!
//! What comes from a place of the file lands on the line of that place; comments go between. It knows nothing of
//! GLSL or WGSL but how comments begin.

use crate::Source;
use crate::lexer::Comment;

/// Stands in a text before what comes from a place of the file.
pub(super) fn mark(place: usize) -> String {
    format!("\u{1}{place}\u{2}")
}

/// A text without its marks.
pub(super) fn unmarked(text: &str) -> String {
    let mut plain = String::new();
    for part in text.split('\u{1}') {
        plain.push_str(part.split_once('\u{2}').map_or(part, |(_, rest)| rest));
    }
    plain
}

/// Writes line n of the WGSL where line n of the file has what it comes from, as far as there is room.
pub(super) struct Writer {
    text: String,
    /// Where the file's lines begin.
    begins: Vec<usize>,
    /// The line that is being written, from 0.
    line: usize,
    comments: std::vec::IntoIter<Comment>,
    next: Option<Comment>,
    pub(super) depth: usize,
    /// Whether a comment runs to the end of the line.
    ends_line: bool,
}

impl Writer {
    pub(super) fn new(source: Source<'_>, comments: Vec<Comment>) -> Self {
        let begins =
            std::iter::once(0).chain(source.text.match_indices('\n').map(|(at, _)| at + 1));
        let mut comments = comments.into_iter();
        let next = comments.next();
        Self {
            text: String::new(),
            begins: begins.collect(),
            line: 0,
            comments,
            next,
            depth: 0,
            ends_line: false,
        }
    }

    fn line_of(&self, place: usize) -> usize {
        self.begins.partition_point(|begin| *begin <= place) - 1
    }

    fn break_line(&mut self) {
        self.text.push('\n');
        self.line += 1;
        self.ends_line = false;
    }

    /// Goes on to a line, or to the next one behind a comment; says whether the line is new.
    fn reach(&mut self, line: usize, indent: usize) -> bool {
        let before = self.line;
        if self.ends_line {
            self.break_line();
        }
        while self.line < line {
            self.break_line();
        }
        let is_new = self.line > before || self.text.is_empty();
        if is_new {
            self.text.push_str(&"    ".repeat(indent));
        }
        is_new
    }

    /// Writes the comments that stand before a place.
    fn comments_to(&mut self, place: usize) {
        while let Some(comment) = self.next.take_if(|comment| comment.span.start < place) {
            let line = self.line_of(comment.span.start);
            if !self.reach(line, self.depth) && !self.text.ends_with([' ', '(']) {
                self.text.push(' ');
            }
            self.line += comment.text.matches('\n').count();
            self.ends_line = comment.text.starts_with("//");
            self.text.push_str(&comment.text);
            self.next = self.comments.next();
        }
    }

    /// Begins a statement that stands at a place.
    pub(super) fn begin(&mut self, place: usize) {
        self.comments_to(place);
        let line = self.line_of(place);
        if !self.reach(line, self.depth) && !self.text.ends_with([' ', '\n', '(']) {
            self.text.push(' ');
        }
    }

    /// Writes a text, each part of it on its line.
    pub(super) fn put(&mut self, text: &str) {
        let mut parts = text.split('\u{1}');
        self.text.push_str(parts.next().unwrap_or_default());
        for part in parts {
            let Some((place, rest)) = part.split_once('\u{2}') else { continue };
            let place = place.parse().unwrap_or(0);
            self.comments_to(place);
            let line = self.line_of(place);
            if line > self.line || self.ends_line {
                while self.text.ends_with(' ') {
                    self.text.pop();
                }
                self.reach(line, self.depth + 1);
            } else if self.text.ends_with("*/") {
                self.text.push(' ');
            }
            self.text.push_str(rest);
        }
    }

    /// Writes a whole statement behind what stands in the line.
    pub(super) fn put_behind(&mut self, text: &str) {
        if self.ends_line {
            self.break_line();
            self.text.push_str(&"    ".repeat(self.depth));
        } else if !self.text.ends_with([' ', '\n']) {
            self.text.push(' ');
        }
        self.text.push_str(&unmarked(text));
    }

    /// The text, with what comes behind all lines.
    pub(super) fn finish(mut self, behind: &str) -> String {
        self.comments_to(usize::MAX);
        let last = self.begins.len() - 1;
        if self.ends_line || self.line < last {
            self.reach(last, 0);
        }
        self.text.push_str("\n\n");
        self.text.push_str(behind);
        let lines: Vec<&str> = self.text.lines().map(str::trim_end).collect();
        lines.join("\n") + "\n"
    }
}
