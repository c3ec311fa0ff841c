//! naga's errors in the author's terms: file, line, column and names as the author wrote them.

use std::error::Error;
use std::ops::Range;

use brdf_sdk::Problem;
use naga::front::wgsl::ParseError;
use naga::valid::ValidationError;
use naga::{Span, WithSpan};

use super::source_map::SourceMap;

/// A syntax, name or type error.
pub fn parse_problem(map: &SourceMap, error: &ParseError) -> Problem {
    let labels: Vec<_> = error
        .labels()
        .filter_map(|(span, label)| Some((span.to_range()?, label.to_owned())))
        .collect();
    let label = labels.iter().find(|(span, _)| map.is_author(span.clone())).or(labels.first());
    let mut reason = error.message().to_owned();
    if let Some((_, label)) = label
        && !label.is_empty()
        && !reason.contains(label.as_str())
    {
        reason = format!("{reason} ({label})");
    }
    let notes: Vec<_> = error.notes().collect();
    problem(map, label.map(|(span, _)| span.clone()), &reason, &notes.join("; "))
}

/// An error of the validator: the innermost cause, at the innermost place that the author wrote.
pub fn validation_problem(map: &SourceMap, error: &WithSpan<ValidationError>) -> Problem {
    let spans: Vec<_> =
        error.spans().filter_map(|(span, _): &(Span, String)| span.to_range()).collect();
    let authored = spans.iter().find(|span| map.is_author((*span).clone()));
    let mut cause: &dyn Error = error.as_inner();
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    problem(map, authored.or(spans.first()).cloned(), &cause.to_string(), "")
}

fn problem(map: &SourceMap, span: Option<Range<usize>>, reason: &str, cure: &str) -> Problem {
    match span {
        Some(span) => map.problem(span, reason, cure),
        None => Problem::new("the linked program", map.unrename(reason), map.unrename(cure)),
    }
}
