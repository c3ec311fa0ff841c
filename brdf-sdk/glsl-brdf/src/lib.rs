//! Reads the files of BRDF Explorer: `.brdf`, analytic models in GLSL, and `.bparam`, values for them.
//!
//! [`translate`] makes a plugin's manifest and WGSL of a model: `file` cuts it into parameters and code, `lexer` and
//! `preprocess` make tokens of the code, `parse` a tree, and `emit` writes WGSL in passes, of which the first
//! ones learn what the last has to know (who reads a parameter, which variable is ever assigned). The WGSL keeps the
//! author's comments and the author's lines: line n of the one is line n of the other, so that whatever is said of
//! the WGSL is said of the file. What cannot be translated is refused with its place, never left out.
//!
//! The crate knows GLSL's text and nothing of devices, plugins' folders or rendering.

mod ast;
mod builtins;
mod emit;
mod file;
mod lexer;
mod literal;
mod manifest;
mod parse;
mod preprocess;
mod types;

pub use file::{Preset, read_preset};

use brdf_sdk::{Problem, Result};
use file::Parameter;

/// Stack of the thread that translates.
const STACK: usize = 64 << 20;

/// A model as a plugin.
#[derive(Debug, Clone, PartialEq)]
pub struct Translated {
    /// The text of its plugin.toml.
    pub manifest: String,
    /// Its WGSL, line by line as the file's lines are.
    pub wgsl: String,
    /// What an author should know of what became of the file.
    pub notes: Vec<String>,
}

/// What becomes of the values of another file.
#[derive(Clone, Copy)]
pub enum Use<'a> {
    /// The parameters begin with them.
    Defaults(&'a Preset),
    /// They are a preset of this name beside the model's own defaults.
    Preset(&'a Preset, &'a str),
}

/// Where a name comes from, in messages and in the manifest.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The file's name in messages.
    pub file: &'a str,
    /// Its text.
    pub text: &'a str,
}

impl Source<'_> {
    fn problem(
        &self,
        span: std::ops::Range<usize>,
        reason: impl Into<String>,
        cure: impl Into<String>,
    ) -> Problem {
        Problem::at(self.file, self.text, span, reason, cure)
    }
}

/// Translates an analytic model. `id` names it; the parameters' ranges hold the values of another file, where there is one.
///
/// # Errors
/// Where the file breaks its grammar, or holds GLSL that no BRDF can be made of; each with its place.
pub fn translate(source: Source<'_>, id: &str, values: Option<Use<'_>>) -> Result<Translated> {
    // The tree is followed by recursion; callers' stacks may be small.
    std::thread::scope(|scope| {
        let work = || translate_here(source, id, values);
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        match thread.map(|thread| thread.join()) {
            Ok(Ok(translated)) => translated,
            Ok(Err(_)) => Err(Problem::new(
                source.file,
                "the translator failed on it",
                "simplify the last change, and report the file",
            )),
            Err(error) => {
                Err(Problem::new(source.file, error.to_string(), "free memory and try again"))
            }
        }
    })
}

fn translate_here(source: Source<'_>, id: &str, values: Option<Use<'_>>) -> Result<Translated> {
    let mut file = file::read(source)?;
    if let Some(Use::Defaults(preset) | Use::Preset(preset, _)) = values {
        let from = Source { file: &preset.file, text: &preset.text };
        for Parameter { name, value, span, .. } in &preset.parameters {
            let problem = |reason, cure: &str| Err(from.problem(span.clone(), reason, cure));
            let Some(own) = file.parameters.iter_mut().find(|own| own.name == *name) else {
                let reason = format!("{} has no parameter `{name}`", source.file);
                return problem(reason, "remove its line, or name the model that has it");
            };
            if !own.take(value, matches!(values, Some(Use::Defaults(_)))) {
                let reason =
                    format!("the parameter `{name}` of {} is of another type", source.file);
                return problem(reason, "write its line as the model has it");
            }
        }
    }
    let lexed = lexer::lex(source, &file)?;
    let tokens = preprocess::expand(source, lexed.items)?;
    let tree = parse::parse(source, tokens)?;
    let parameters = manifest::keys(&file.parameters);
    let written = emit::write(source, &tree, &parameters, lexed.comments)?;
    Ok(Translated {
        manifest: manifest::write(source.file, id, &parameters, values),
        wgsl: written.wgsl,
        notes: written.notes,
    })
}
