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
use super::tokens::tokens;
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
    if let Some(cure) = allowed_types(&notes) {
        // One label is on the call, the other one on the argument and says what it is.
        let argument =
            labels.iter().find_map(|(span, told)| Some((span, told.split_once(" has type ")?)));
        let (span, ty) = argument.map(|(span, (_, ty))| (span.clone(), ty)).unzip();
        let is =
            ty.map(|ty| format!(": it is of type {}", ty.trim_matches('`'))).unwrap_or_default();
        return problem(map, span, &format!("{}{is}", error.message()), &cure);
    }
    problem(map, label.map(|(span, _)| span.clone()), error.message(), &notes.join("; "))
}

/// naga's note for each type that an argument may have, thirty for `dot`, as one sentence: shapes that take the same
/// scalars together, and no scalars that programs here have no use for.
fn allowed_types(notes: &[&str]) -> Option<String> {
    const SCALARS: [&str; 4] = ["f32", "i32", "u32", "bool"];
    let types: Vec<&str> =
        notes.iter().filter_map(|note| note.strip_prefix("allowed type: ")).collect();
    if types.is_empty() {
        return None;
    }
    // A shape with the scalars it may have, in naga's order; other types as they are.
    let mut shapes: Vec<(&str, Vec<&str>)> = Vec::new();
    for ty in types {
        let (shape, scalar) = match ty.strip_suffix('>').and_then(|open| open.split_once('<')) {
            Some((shape, scalar)) => (shape, scalar),
            None => ("", ty),
        };
        let braced = scalar.contains('{');
        if braced || (!SCALARS.contains(&scalar) && scalar.starts_with(['f', 'i', 'u'])) {
            continue;
        }
        match shapes.iter_mut().find(|(known, _)| *known == shape) {
            Some((_, scalars)) => scalars.push(scalar),
            None => shapes.push((shape, vec![scalar])),
        }
    }
    let mut groups: Vec<(Vec<&str>, Vec<&str>)> = Vec::new();
    for (shape, scalars) in shapes {
        match groups.iter_mut().find(|(shapes, known)| *known == scalars && !shapes.contains(&"")) {
            Some((shapes, _)) if !shape.is_empty() => shapes.push(shape),
            _ => groups.push((vec![shape], scalars)),
        }
    }
    let words = groups.iter().map(|(shapes, scalars)| match shapes.as_slice() {
        [""] => scalars.join(", "),
        shapes => format!("{} of {}", shapes.join(", "), scalars.join(", ")),
    });
    Some(format!("it takes {}", words.collect::<Vec<_>>().join("; ")))
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

/// The name before the dot of a field at a problem's place.
fn holder(problem: &Problem) -> Option<&str> {
    let place = problem.place.as_ref()?;
    let (end, _) = place.excerpt.char_indices().nth(place.column - 1)?;
    let before = place.excerpt[..end].trim_end().strip_suffix('.')?.trim_end();
    let begin = before
        .rfind(|c: char| !c.is_alphanumeric() && c != '_')
        .map_or(0, |at| at + before[at..].chars().next().map_or(0, char::len_utf8));
    Some(&before[begin..]).filter(|name| !name.is_empty())
}

/// Whether the author declares this name as the plugin's parameters, as in `p: Params`, and as nothing else.
fn holds_parameters(plugin: &Plugin, name: &str) -> bool {
    let tokens = tokens(&plugin.source);
    let mut types = tokens.windows(3).filter_map(|three| {
        let [value, colon, ty] = three else { return None };
        let declares = value.text(&plugin.source) == name && colon.is(':');
        declares.then(|| ty.text(&plugin.source))
    });
    types.next().is_some_and(|ty| matches!(ty, "Params" | "Settings"))
        && types.all(|ty| matches!(ty, "Params" | "Settings"))
}

/// Whether one letter that is changed, added or left out makes one of the other.
fn is_a_letter_off(one: &str, other: &str) -> bool {
    let (short, long) = if one.len() <= other.len() { (one, other) } else { (other, one) };
    let [short, long] = [short, long].map(str::as_bytes);
    match long.len() - short.len() {
        0 => std::iter::zip(short, long).filter(|(a, b)| a != b).count() == 1,
        1 => (0..long.len()).any(|at| long[..at] == short[..at] && long[at + 1..] == short[at..]),
        _ => false,
    }
}

/// Functions of WGSL that formulas call.
const BUILT_IN: [&str; 32] = [
    "abs",
    "acos",
    "asin",
    "atan",
    "atan2",
    "bitcast",
    "ceil",
    "clamp",
    "cos",
    "cross",
    "distance",
    "dot",
    "exp",
    "exp2",
    "floor",
    "fract",
    "inverseSqrt",
    "length",
    "log",
    "log2",
    "max",
    "min",
    "mix",
    "normalize",
    "pow",
    "reflect",
    "select",
    "sign",
    "sin",
    "smoothstep",
    "sqrt",
    "tan",
];

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
            let is_brdf = plugin.manifest.kind == brdf_sdk::Kind::Brdf;
            let member = if is_brdf { "p." } else { "q." };
            let members: Vec<String> = params().map(|key| format!("{member}{key}")).collect();
            let names = |shader: &Cut| -> Vec<String> {
                shader.declarations.iter().map(|declared| declared.name.clone()).collect()
            };
            let known: Vec<String> =
                own.map(str::to_owned).chain(members).chain(names(prelude)).collect();
            // Integrators may call what the host has for them, which is long, and its own parts are in it: it is
            // suggested from, and not listed. Of WGSL's own functions those that a slip of one letter makes: others
            // are near by chance.
            let shaders = host.iter().filter(|_| !is_brdf);
            let of_host: Vec<String> = shaders.flat_map(names).collect();
            let built_in = BUILT_IN.into_iter().filter(|own| is_a_letter_off(name, own));
            let all = known.iter().chain(&of_host).map(String::as_str).chain(params());
            let meant = suggestion(name, all.chain(built_in));
            let listed = || suggestion(name, known.iter().map(String::as_str));
            match (meant.starts_with("did you mean"), is_brdf) {
                (true, _) => meant,
                (false, true) => listed(),
                (false, false) => format!(
                    "{}; and what the host has for integrators, as brdf_cos, env_light, next_2d, to_world",
                    listed()
                ),
            }
        }
    } else if let Some(name) = quoted("invalid field accessor `") {
        match holder(&problem).is_some_and(|value| holds_parameters(plugin, value)) {
            true => suggestion(name, params()),
            false => "write a field that the type before the dot has".to_owned(),
        }
    } else {
        return problem;
    };
    if problem.cure.is_empty() {
        problem.cure = cure;
    }
    problem
}
