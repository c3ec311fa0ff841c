//! naga's errors in the author's terms: file, line, column, names and types as the author wrote them.

use std::error::Error;
use std::ops::Range;

use brdf_sdk::Problem;
use brdf_sdk::table::suggestion;
use naga::front::wgsl::ParseError;
use naga::valid::{FunctionError, ValidationError};
use naga::{Span, WithSpan};

use super::declarations::Cut;
use super::source_map::SourceMap;
use crate::plugin::Plugin;

/// A syntax, name or type error.
pub fn parse_problem(map: &SourceMap, error: &ParseError) -> Problem {
    let labels: Vec<_> = error
        .labels()
        .filter_map(|(span, label)| Some((span.to_range()?, label.to_owned())))
        .collect();
    let label = labels.iter().find(|(span, _)| map.is_author(span.clone())).or(labels.first());
    let notes: Vec<_> = error.notes().collect();
    if notes.iter().any(|note| note.contains("recursion limit")) {
        let reason = "its expressions or blocks are nested too deep for the shader compiler";
        return problem(map, None, reason, "name parts of them with `let`");
    }
    problem(map, label.map(|(span, _)| span.clone()), error.message(), &notes.join("; "))
}

/// An error of the validator: the innermost cause, at the narrowest place that the author wrote.
pub fn validation_problem(map: &SourceMap, error: &WithSpan<ValidationError>) -> Problem {
    let spans: Vec<_> =
        error.spans().filter_map(|(span, _): &(Span, String)| span.to_range()).collect();
    let authored = spans.iter().filter(|span| map.is_author((*span).clone()));
    let narrowest = authored.min_by_key(|span| span.len()).or(spans.first()).cloned();
    if let ValidationError::Function { source: FunctionError::InvalidReturnType { .. }, .. } =
        error.as_inner()
    {
        let reason = "what is returned is not of the function's declared type";
        return problem(map, narrowest, reason, "return the declared type, or declare another");
    }
    let mut cause: &dyn Error = error.as_inner();
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    problem(map, narrowest, &with_wgsl_types(&cause.to_string()), "")
}

fn problem(map: &SourceMap, span: Option<Range<usize>>, reason: &str, cure: &str) -> Problem {
    match span {
        Some(span) => map.problem(span, reason, cure),
        None => Problem::new("the linked program", map.unrename(reason), map.unrename(cure)),
    }
}

/// naga's `[4] (of type Vector { size: Bi, .. })` as `vec2f`.
fn with_wgsl_types(reason: &str) -> String {
    let mut reason = reason.to_owned();
    for (kind, width, scalar, letter) in [
        ("Float", 4, "f32", "f"),
        ("Sint", 4, "i32", "i"),
        ("Uint", 4, "u32", "u"),
        ("Bool", 1, "bool", "<bool>"),
    ] {
        let inner = format!("Scalar {{ kind: {kind}, width: {width} }}");
        for (size, n) in [("Bi", 2), ("Tri", 3), ("Quad", 4)] {
            let vector = format!("Vector {{ size: {size}, scalar: {inner} }}");
            reason = reason.replace(&vector, &format!("vec{n}{letter}"));
        }
        reason = reason.replace(&format!("Scalar({inner})"), scalar);
    }
    // `[4] (of type vec2f)` becomes `vec2f`: the handle means nothing to an author.
    while let Some(of) = reason.find("] (of type ") {
        let Some(open) = reason[..of].rfind('[') else { break };
        let Some(close) = reason[of..].find(')') else { break };
        let ty = reason[of + "] (of type ".len()..of + close].to_owned();
        reason.replace_range(open..of + close + 1, &ty);
    }
    reason
}

/// Adds the cure where naga gives none and the manifest or the host's names suggest one.
pub fn with_cure(
    mut problem: Problem,
    plugin: &Plugin,
    cut: &Cut,
    prelude: &Cut,
    host: &[Cut],
) -> Problem {
    let quoted =
        |prefix: &str| -> Option<&str> { problem.reason.strip_prefix(prefix)?.strip_suffix('`') };
    let params = || plugin.manifest.params.iter().map(|param| param.key.as_str());
    let cure = if let Some(name) = quoted("no definition in scope for identifier: `") {
        let own = cut.declarations.iter().map(|declaration| declaration.name.as_str());
        if params().any(|key| key == name) {
            let holder = if plugin.manifest.kind == brdf_sdk::Kind::Brdf { "p" } else { "q" };
            format!("a parameter is a member: write `{holder}.{name}`")
        } else if host.iter().any(|shader| shader.declares(name)) {
            "the host keeps it for itself: a BRDF has its arguments, its parameters and the prelude"
                .to_owned()
        } else {
            let prelude = prelude.declarations.iter().map(|declaration| declaration.name.as_str());
            suggestion(name, own.chain(params()).chain(prelude))
        }
    } else if let Some(name) = quoted("invalid field accessor `") {
        suggestion(name, params())
    } else {
        return problem;
    };
    if problem.cure.is_empty() {
        problem.cure = cure;
    }
    problem
}
