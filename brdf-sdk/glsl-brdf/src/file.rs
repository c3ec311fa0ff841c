//! The file as a whole: its kind, its sections, its parameters.
//!
//! Lines and words, each with its place; the code is cut out and not looked into. It opens nothing: text in, data or
//! a problem out.

use std::ops::Range;

use brdf_sdk::Result;

use crate::Source;

/// A model's file, cut up.
pub(crate) struct File {
    pub(crate) parameters: Vec<Parameter>,
    /// Code: sections in the order of the file.
    pub(crate) code: Vec<Range<usize>>,
    /// Lines of comment outside of code, without their `#`.
    pub(crate) comments: Vec<Range<usize>>,
}

/// A parameter as the file declares it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) span: Range<usize>,
    pub(crate) value: Value,
    /// What stands behind it in its line.
    pub(crate) about: String,
    /// Numbers that its range must hold, whatever the file says.
    pub(crate) admitted: Vec<f64>,
}

/// What a parameter holds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Float { range: [f64; 2], default: f64 },
    Bool(bool),
    Color([f64; 3]),
}

impl Parameter {
    /// Makes room in the range for a value, and takes it for the default where that is asked for; false where it is of
    /// another type.
    pub(crate) fn take(&mut self, value: &Value, as_default: bool) -> bool {
        let mut other = value.clone();
        match (&self.value, &mut other) {
            (Value::Float { range, .. }, Value::Float { range: own, default }) => {
                self.admitted.push(*default);
                *own = *range;
            }
            (Value::Color(_), Value::Color(rgb)) => self.admitted.extend(*rgb),
            (Value::Bool(_), Value::Bool(_)) => {}
            _ => return false,
        }
        if as_default {
            self.value = other;
        }
        true
    }
}

/// Values for a model: a `.bparam` file.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// The file's own name in messages.
    pub file: String,
    /// The model's file as it is named there.
    pub model: String,
    /// The file, to show where a value is wrong.
    pub(crate) text: String,
    pub(crate) parameters: Vec<Parameter>,
}

/// The sections that a file may have.
const SECTIONS: [&str; 3] = ["parameters", "shader", "isFunc"];

/// A line with its place, trimmed.
struct Line<'a> {
    text: &'a str,
    span: Range<usize>,
}

fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut at = 0;
    text.split_inclusive('\n').map(move |whole| {
        let begin = at + (whole.len() - whole.trim_start().len());
        at += whole.len();
        let text = whole.trim();
        let begin = if text.is_empty() { at } else { begin };
        Line { text, span: begin..begin + text.len() }
    })
}

/// The first line: the file's kind, and what stands behind it.
fn kind<'a>(source: Source<'a>) -> Result<(Line<'a>, &'a str, &'a str)> {
    let Some(first) = lines(source.text).next().filter(|line| !line.text.is_empty()) else {
        return Err(source.problem(
            0..0,
            "the file does not begin with its kind",
            "write `analytic` into the first line",
        ));
    };
    let (kind, rest) = first.text.split_once(char::is_whitespace).unwrap_or((first.text, ""));
    Ok((first, kind, rest.trim()))
}

/// Reads the file of a model.
pub(crate) fn read(source: Source<'_>) -> Result<File> {
    let (first, kind, _) = kind(source)?;
    if kind != "analytic" {
        return Err(source.problem(
            first.span,
            format!("`{kind}` is no kind of file that is read here"),
            "a model begins with `analytic`, a file of values with `bparam`",
        ));
    }
    let mut file = File { parameters: Vec::new(), code: Vec::new(), comments: Vec::new() };
    let mut has_shader = false;
    sections(source, &mut |section, line| match section {
        None => {
            file.comments.push(line.span.start + 1..line.span.end);
            Ok(())
        }
        Some("parameters") => add(source, &mut file.parameters, &line),
        Some(name) => {
            has_shader |= name == "shader";
            file.code.push(line.span);
            Ok(())
        }
    })?;
    if !has_shader {
        return Err(source.problem(
            first.span,
            "the file has no `::begin shader`",
            "write `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)` between `::begin shader` and `::end shader`",
        ));
    }
    Ok(file)
}

/// Reads a file of values.
///
/// # Errors
/// Where it breaks its grammar, with the place.
pub fn read_preset(source: Source<'_>) -> Result<Preset> {
    let (first, word, model) = kind(source)?;
    if word != "bparam" || model.is_empty() {
        return Err(source.problem(
            first.span,
            "a file of values begins with `bparam` and the name of a model's file",
            "write `bparam model.brdf`",
        ));
    }
    let mut parameters = Vec::new();
    sections(source, &mut |section, line| match section {
        None => Ok(()),
        Some("parameters") => add(source, &mut parameters, &line),
        Some(name) => Err(source.problem(
            line.span,
            format!("a file of values has no `{name}`"),
            "code belongs into the model's file",
        )),
    })?;
    let [file, model, text] = [source.file, model, source.text].map(str::to_owned);
    Ok(Preset { file, model, text, parameters })
}

/// Adds the parameter of a line to those that there are.
fn add(source: Source<'_>, all: &mut Vec<Parameter>, line: &Line<'_>) -> Result<()> {
    let parameter = parameter(source, line)?;
    if all.iter().any(|known| known.name == parameter.name) {
        return Err(source.problem(
            parameter.span,
            format!("the parameter `{}` stands twice", parameter.name),
            "remove one",
        ));
    }
    all.push(parameter);
    Ok(())
}

/// Calls `take` with every line of parameters, with every section of code as a whole, and with comments.
fn sections<'a>(
    source: Source<'a>,
    take: &mut dyn FnMut(Option<&'a str>, Line<'a>) -> Result<()>,
) -> Result<()> {
    let mut open: Option<(&str, Range<usize>)> = None;
    let mut code: Option<usize> = None;
    for line in lines(source.text).skip(1) {
        if let Some(name) = line.text.strip_prefix("::begin").map(str::trim) {
            if let Some((outer, _)) = open {
                return Err(source.problem(
                    line.span,
                    format!("a section begins inside of the section `{outer}`"),
                    format!("write `::end {outer}` before it"),
                ));
            }
            if !SECTIONS.contains(&name) {
                return Err(source.problem(
                    line.span,
                    format!("there is no section `{name}`"),
                    "name it parameters, shader or isFunc, or remove it",
                ));
            }
            code = (name != "parameters").then_some(line.span.end);
            open = Some((name, line.span));
        } else if let Some(name) = line.text.strip_prefix("::end").map(str::trim) {
            match open.take() {
                Some((known, _)) if known == name => {}
                Some((known, _)) => {
                    return Err(source.problem(
                        line.span,
                        format!("this ends `{name}`, and the open section is `{known}`"),
                        format!("write `::end {known}`"),
                    ));
                }
                None => {
                    return Err(source.problem(
                        line.span,
                        "this ends a section where none is open",
                        "remove it, or write the `::begin` that is missing",
                    ));
                }
            }
            if let Some(begin) = code.take() {
                let span = begin..line.span.start;
                take(Some(name), Line { text: &source.text[span.clone()], span })?;
            }
        } else if code.is_some() || line.text.is_empty() {
            continue;
        } else if line.text.starts_with('#') {
            take(None, line)?;
        } else if let Some((name, _)) = open {
            take(Some(name), line)?;
        } else {
            return Err(source.problem(
                line.span,
                "this line stands in no section",
                "put it between `::begin` and `::end`, or begin it with `#`",
            ));
        }
    }
    match open {
        Some((name, span)) => Err(source.problem(
            span,
            format!("the section `{name}` never ends"),
            format!("write `::end {name}`"),
        )),
        None => Ok(()),
    }
}

/// A word of a line, with its place.
fn words<'a>(line: &Line<'a>) -> Vec<(&'a str, Range<usize>)> {
    let begin = line.text.as_ptr() as usize;
    let place = |word: &str| word.as_ptr() as usize - begin + line.span.start;
    line.text.split_whitespace().map(|word| (word, place(word)..place(word) + word.len())).collect()
}

fn parameter(source: Source<'_>, line: &Line<'_>) -> Result<Parameter> {
    let words = words(line);
    let word = words[0].0;
    let (count, form) = match word {
        "float" => (3, "float NAME MIN MAX DEFAULT"),
        "bool" => (1, "bool NAME 0|1"),
        "color" => (3, "color NAME R G B"),
        _ => {
            return Err(source.problem(
                words[0].1.clone(),
                format!("there is no parameter type `{word}`"),
                "write float, bool or color",
            ));
        }
    };
    if words.len() < count + 2 {
        let reason = format!("a {word} has a name and {count} numbers, and this one has fewer");
        let reason = if count == 1 { "a bool has a name and 0 or 1".to_owned() } else { reason };
        return Err(source.problem(line.span.clone(), reason, format!("write `{form}`")));
    }
    let (name, span) = words[1].clone();
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(source.problem(
            span,
            format!("`{name}` cannot be a name in GLSL"),
            "use letters, digits and `_`, not beginning with a digit",
        ));
    }
    let number = |index: usize| -> Result<f64> {
        let (word, span) = &words[index];
        word.parse().ok().filter(|number: &f64| (*number as f32).is_finite()).ok_or_else(|| {
            source.problem(
                span.clone(),
                format!("`{word}` is no number"),
                format!("write `{form}`"),
            )
        })
    };
    let value = match word {
        "float" => {
            let range = [number(2)?, number(3)?];
            if range[0] > range[1] {
                return Err(source.problem(
                    words[2].1.start..words[3].1.end,
                    "the least value lies above the greatest",
                    "exchange them",
                ));
            }
            Value::Float { range, default: number(4)? }
        }
        "bool" => match words[2].0 {
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            _ => Value::Bool(number(2)? != 0.0),
        },
        _ => Value::Color([number(2)?, number(3)?, number(4)?]),
    };
    let rest = words.get(count + 2).map_or("", |(_, span)| &source.text[span.start..line.span.end]);
    let about = rest.trim_start_matches(['#', '/']).trim().to_owned();
    Ok(Parameter { name: name.to_owned(), span, value, about, admitted: Vec::new() })
}
