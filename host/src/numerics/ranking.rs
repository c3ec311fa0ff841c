//! The lines in which errors arise, worst first.

use std::collections::HashMap;

use serde::Serialize;

use super::blame::{ROUNDING, Suspect, Wrong};
use crate::link::Origin;

/// A line in which errors arise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// The file's name in messages.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column of the expression with the largest error, in characters from 1.
    pub column: usize,
    /// Its length in characters.
    pub length: usize,
    /// The line itself.
    pub excerpt: String,
    /// Whether it is the author's, and not the prelude's.
    pub is_author: bool,
    /// The largest error that arose here and reached a result, relative.
    pub error: f64,
    /// Leading bits that cancelled there.
    pub cancelled_bits: f32,
    /// Results for which no other line answers for more.
    pub cases: usize,
}

/// Results in which rounding adds up without one line that makes it large.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Unblamed {
    /// How many.
    pub cases: usize,
    /// The largest of their errors.
    pub error: f64,
}

/// The lines found so far.
#[derive(Debug, Default)]
pub struct Ranking {
    lines: Vec<Line>,
    index: HashMap<(String, usize), usize>,
    /// What none of them answers for.
    pub unblamed: Unblamed,
}

impl Ranking {
    /// Takes in the suspects of some wrong cases.
    pub fn add(&mut self, suspects: &[Suspect], wrong: &[Wrong]) {
        let lines: Vec<usize> = suspects.iter().map(|s| self.line_of(&s.origin)).collect();
        for (case, wrong) in wrong.iter().enumerate() {
            let mut largest: Option<(f64, usize)> = None;
            for (suspect, line) in suspects.iter().zip(&lines) {
                let error = suspect.errors[case];
                if error < ROUNDING {
                    continue;
                }
                self.lines[*line].raise(&suspect.origin, error, suspect.cancelled[case]);
                if largest.is_none_or(|(known, _)| error > known) {
                    largest = Some((error, *line));
                }
            }
            match largest {
                Some((_, line)) => self.lines[line].cases += 1,
                None => {
                    self.unblamed.cases += 1;
                    self.unblamed.error = self.unblamed.error.max(wrong.error);
                }
            }
        }
    }

    /// The lines, worst first.
    pub fn into_lines(self) -> Vec<Line> {
        let mut lines: Vec<Line> =
            self.lines.into_iter().filter(|line| line.error >= ROUNDING).collect();
        lines.sort_by(|a, b| {
            let by_error = b.error.total_cmp(&a.error);
            by_error.then(b.cases.cmp(&a.cases)).then(a.line.cmp(&b.line))
        });
        lines
    }

    fn line_of(&mut self, origin: &Origin) -> usize {
        let key = (origin.file.clone(), origin.place.line);
        *self.index.entry(key).or_insert_with(|| {
            self.lines.push(Line {
                file: origin.file.clone(),
                line: origin.place.line,
                column: origin.place.column,
                length: origin.place.length,
                excerpt: origin.place.excerpt.clone(),
                is_author: origin.is_author,
                error: 0.0,
                cancelled_bits: 0.0,
                cases: 0,
            });
            self.lines.len() - 1
        })
    }
}

impl Line {
    fn raise(&mut self, origin: &Origin, error: f64, cancelled: f32) {
        if error > self.error {
            self.error = error;
            self.cancelled_bits = cancelled;
            (self.column, self.length) = (origin.place.column, origin.place.length);
        }
    }
}
