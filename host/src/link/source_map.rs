//! The linked text, and for each of its bytes the file and the byte that it came from.

use std::ops::Range;
use std::sync::Arc;

use brdf_sdk::Problem;

use super::declarations::Cut;
use super::tokens::TokenKind;

/// A file that went into the program.
#[derive(Debug, Clone)]
pub struct SourceFile {
    /// Its name in messages.
    pub label: String,
    /// Its text as the author wrote it.
    pub text: Arc<str>,
    /// What its own names are prefixed with; `None` for the host's shaders and for generated text.
    pub prefix: Option<String>,
}

/// Text linked so far.
#[derive(Debug, Clone, Default)]
pub struct SourceMap {
    /// The linked text.
    pub text: String,
    /// The files behind it.
    pub files: Vec<SourceFile>,
    segments: Vec<Segment>,
}

/// A run of linked bytes that stands for a run of bytes of one file.
#[derive(Debug, Clone)]
struct Segment {
    linked: Range<usize>,
    file: usize,
    original: Range<usize>,
}

impl SourceMap {
    /// Appends a file as it is.
    pub fn push(&mut self, label: &str, text: &str) {
        let file = self.add_file(label, text, None);
        self.append(file, 0..text.len(), text);
        self.text.push('\n');
    }

    /// Appends the host's shaders, one after the other.
    pub fn push_all(&mut self, shaders: &[(&str, &str)]) {
        for (label, text) in shaders {
            self.push(label, text);
        }
    }

    /// Appends a plugin's file with the names that it declares itself, and `also`, prefixed.
    pub fn push_renamed(
        &mut self,
        label: &str,
        text: &str,
        cut: &Cut,
        prefix: &str,
        also: &[String],
    ) {
        let file = self.add_file(label, text, Some(prefix.to_owned()));
        let mut copied = 0;
        for (index, token) in cut.tokens.iter().enumerate() {
            let word = token.text(text);
            let own = cut.declares(word) || also.iter().any(|name| name == word);
            if token.kind != TokenKind::Word || !own || cut.is_member(index) {
                continue;
            }
            self.append(file, copied..token.span.start, &text[copied..token.span.start]);
            self.append(file, token.span.clone(), &format!("{prefix}{word}"));
            copied = token.span.end;
        }
        self.append(file, copied..text.len(), &text[copied..]);
        self.text.push('\n');
    }

    /// The file and its bytes behind a range of the linked text.
    pub fn original(&self, linked: Range<usize>) -> Option<(&SourceFile, Range<usize>)> {
        let segment_at = |at: usize| {
            let index = self.segments.partition_point(|segment| segment.linked.end <= at);
            self.segments.get(index).filter(|segment| segment.linked.contains(&at))
        };
        let first = segment_at(linked.start)?;
        let start = first.start_of(linked.start);
        let last = segment_at(linked.end.saturating_sub(1).max(linked.start));
        let end = match last.filter(|last| last.file == first.file) {
            Some(last) => last.end_of(linked.end),
            None => first.original.end,
        };
        Some((&self.files[first.file], start..end.max(start)))
    }

    /// A problem at a range of the linked text, shown in its file and in the author's names.
    pub fn problem(&self, linked: Range<usize>, reason: &str, cure: &str) -> Problem {
        let (reason, cure) = (self.unrename(reason), self.unrename(cure));
        match self.original(linked) {
            Some((file, span)) => Problem::at(&file.label, &file.text, span, reason, cure),
            None => Problem::new("the linked program", reason, cure),
        }
    }

    /// Whether a range of the linked text comes from a plugin's own file.
    pub fn is_author(&self, linked: Range<usize>) -> bool {
        self.original(linked).is_some_and(|(file, _)| file.prefix.is_some())
    }

    /// A message with the linker's prefixes taken away.
    pub fn unrename(&self, message: &str) -> String {
        let prefixes = self.files.iter().filter_map(|file| file.prefix.as_deref());
        prefixes.fold(message.to_owned(), |message, prefix| message.replace(prefix, ""))
    }

    fn add_file(&mut self, label: &str, text: &str, prefix: Option<String>) -> usize {
        self.files.push(SourceFile { label: label.to_owned(), text: text.into(), prefix });
        self.files.len() - 1
    }

    fn append(&mut self, file: usize, original: Range<usize>, linked: &str) {
        let start = self.text.len();
        self.text.push_str(linked);
        if !linked.is_empty() {
            self.segments.push(Segment { linked: start..self.text.len(), file, original });
        }
    }
}

impl Segment {
    /// Verbatim runs map byte by byte; a renamed token maps as a whole.
    fn verbatim(&self) -> bool {
        self.linked.len() == self.original.len()
    }

    fn start_of(&self, at: usize) -> usize {
        if self.verbatim() {
            self.original.start + (at - self.linked.start)
        } else {
            self.original.start
        }
    }

    fn end_of(&self, at: usize) -> usize {
        if self.verbatim() {
            self.original.start + (at - self.linked.start)
        } else {
            self.original.end
        }
    }
}
