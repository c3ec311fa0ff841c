//! What the host asks for, made of what the file has.
//!
//! `eval`, and `sample` with `pdf` where the file has functions for both; a file that has half of them gets a note,
//! and the host's sampling. Nothing of the model is changed here but what BRDF Explorer itself changes: values below
//! 0 are 0.

use std::fmt::Write as _;

use brdf_sdk::{Problem, Result};

use super::Emitter;
use crate::ast::Passed;
use crate::types::{FLOAT, Scalar, Ty, VEC3};

/// The functions of the file, and what a file with sampling also has.
const BRDF: &str = "BRDF";
const SAMPLE: &str = "sampleBRDF";

/// Where an argument of a function comes from, by its name: the light's direction, the viewer's, the normal and tangents.
const ROLES: [(&str, &[&str]); 5] = [
    ("wi", &["l", "wi", "light", "lightdir", "tolight", "incoming", "i"]),
    ("wo", &["v", "wo", "view", "viewdir", "eye", "toviewer", "outgoing", "o"]),
    ("vec3f(0.0, 0.0, 1.0)", &["n", "normal"]),
    ("vec3f(1.0, 0.0, 0.0)", &["x", "tangent", "t"]),
    ("vec3f(0.0, 1.0, 0.0)", &["y", "bitangent", "binormal", "b"]),
];

impl Emitter<'_> {
    /// Writes `eval`, and `sample` and `pdf` where the file can; returns what is worth telling.
    pub(super) fn shim(&mut self) -> Result<Vec<String>> {
        let brdf = self.functions.iter().position(|function| function.name == BRDF);
        let right = |index: &usize| {
            let function = &self.functions[*index];
            function.result == VEC3
                && function.is_defined
                && function.arguments
                    == [
                        (Passed::In, VEC3),
                        (Passed::In, VEC3),
                        (Passed::In, VEC3),
                        (Passed::In, VEC3),
                        (Passed::In, VEC3),
                    ]
        };
        let Some(brdf) = brdf.filter(right) else {
            const CURE: &str = "write `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)`";
            return Err(match brdf {
                None => Problem::new(self.source.file, "its shader has no function `BRDF`", CURE),
                Some(_) => Problem::new(
                    self.source.file,
                    "its function `BRDF` takes and gives something else",
                    CURE,
                ),
            });
        };
        let roles: Vec<&str> = ROLES.iter().map(|(text, _)| *text).collect();
        let mut text = String::from(
            "/// f in the frame of the surface, the normal along z; nothing below 0 and nothing that is no number, as BRDF Explorer\n/// shows it.\n",
        );
        let call = self.call_text(brdf, &roles);
        let begin = self.begin_globals();
        let _ = write!(
            text,
            "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{\n{begin}    let f = {call};\n    return select(vec3f(0.0), f, f > vec3f(0.0));\n}}\n"
        );
        let mut notes = Vec::new();
        match self.sampling() {
            Ok(Some(sampling)) => text += &sampling,
            Ok(None) => {}
            Err(note) => notes.push(note),
        }
        self.shim_text = text;
        Ok(notes)
    }

    /// Variables that change begin anew at each evaluation.
    fn begin_globals(&self) -> String {
        if self.first_values.is_empty() {
            return String::new();
        }
        format!("    var globals = {}({});\n", self.globals_name, self.first_values.join(", "))
    }

    fn call_text(&self, index: usize, arguments: &[&str]) -> String {
        let mut texts = Vec::new();
        if self.learned.reads_parameters.contains(&index) {
            texts.push("p");
        }
        if self.learned.reads_globals.contains(&index) {
            texts.push("&globals");
        }
        texts.extend(arguments);
        format!("{}({})", self.functions[index].wgsl, texts.join(", "))
    }

    /// `sample` and `pdf` of the file's own functions; a note where it has half of them.
    fn sampling(&self) -> Result<Option<String>, String> {
        let Some(index) = self.functions.iter().position(|known| known.name == SAMPLE) else {
            return Ok(None);
        };
        let function = &self.functions[index];
        let densities: Vec<usize> = (0..self.functions.len())
            .filter(|index| {
                let known = &self.functions[*index];
                let roles = self.directions(*index);
                known.result == FLOAT
                    && known.is_defined
                    && known.name.to_lowercase().contains("pdf")
                    && roles.iter().all(Option::is_some)
                    && roles.contains(&Some("wi"))
            })
            .collect();
        let by_name = densities.iter().find(|index| {
            matches!(
                self.functions[**index].name.to_lowercase().as_str(),
                "pdf" | "pdfbrdf" | "brdfpdf"
            )
        });
        let only = if densities.len() == 1 { densities.first() } else { None };
        let Some(density) = by_name.or(only).copied() else {
            return Err(format!(
                "{}: `{SAMPLE}` draws directions, and no one function `pdf...` of wi (or L), wo (or V) and the frame tells the density of a given one: both are needed",
                self.source.file
            ));
        };
        let unknown = |index: usize| {
            Err(format!(
                "{}: the arguments of `{}` are not understood",
                self.source.file, self.functions[index].name
            ))
        };
        // Numbers come first, directions by their names; what is handed back is the direction and its density.
        let mut numbers = ["u.x", "u.y", "u.z"].into_iter();
        let mut texts = Vec::new();
        let mut before = String::new();
        let mut drawn = None;
        let directions = self.directions(index);
        for (place, (passed, ty)) in function.arguments.iter().enumerate() {
            let text = match (passed, ty) {
                (Passed::In, ty) if *ty == FLOAT => numbers.next().map(str::to_owned),
                (Passed::In, ty) if *ty == VEC3 => directions[place].map(str::to_owned),
                (Passed::In, Ty::Vector(Scalar::Float, 2)) => {
                    numbers = ["u.z", "", ""].into_iter();
                    Some("u.xy".to_owned())
                }
                (Passed::Out | Passed::InOut, ty @ Ty::Vector(..)) => {
                    let name = format!("back_{place}");
                    let _ = writeln!(before, "    var {name}: {};", ty.wgsl());
                    let own = function.names[place].to_lowercase();
                    let is_light = ROLES[0].1.contains(&own.as_str());
                    if *ty == VEC3 && (is_light || drawn.is_none()) {
                        drawn = Some(name.clone());
                    }
                    Some(format!("&{name}"))
                }
                _ => None,
            };
            match text {
                Some(text) => texts.push(text),
                None => return unknown(index),
            }
        }
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let call = self.call_text(index, &texts);
        let begin = self.begin_globals();
        let result = match drawn {
            Some(name) if function.result == Ty::Void => {
                format!("    {call};\n    return {name};\n")
            }
            Some(name) => format!("    _ = {call};\n    return {name};\n"),
            None if function.result == VEC3 => format!("    return {call};\n"),
            None => return unknown(index),
        };
        let directions: Vec<&str> = self.directions(density).into_iter().flatten().collect();
        let call = self.call_text(density, &directions);
        Ok(Some(format!(
            "\nfn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {{\n{begin}{before}{result}}}\n\n\
             fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {{\n{begin}    return {call};\n}}\n"
        )))
    }

    /// What a function's arguments are, by their names, where they are directions.
    fn directions(&self, index: usize) -> Vec<Option<&'static str>> {
        let function = &self.functions[index];
        let role = |(argument, name): (&(Passed, Ty), &String)| {
            let name = name.to_lowercase();
            let (text, _) = ROLES.iter().find(|(_, names)| names.contains(&name.as_str()))?;
            (*argument == (Passed::In, VEC3)).then_some(*text)
        };
        std::iter::zip(&function.arguments, &function.names).map(role).collect()
    }

    /// What comes behind the file's lines.
    pub(super) fn behind(&mut self) -> String {
        let mut text = std::mem::take(&mut self.shim_text);
        if !self.first_values.is_empty() {
            let changing = self.globals.iter().enumerate();
            let changing =
                changing.filter(|(index, _)| self.learned.assigned_globals.contains(index));
            let members: Vec<String> = changing
                .map(|(_, global)| format!("    {}: {},\n", global.wgsl, global.ty.wgsl()))
                .collect();
            let _ = write!(
                text,
                "\n/// Variables of the file that change.\nstruct {} {{\n{}}}\n",
                self.globals_name,
                members.concat()
            );
        }
        for helper in self.helpers.values() {
            text.push('\n');
            text.push_str(helper);
        }
        text
    }
}
