//! What comes out of linking: a module for executors, and what its texts and plugins say of it.
//!
//! It asks naga and the source map; it links nothing and runs nothing.

use std::collections::HashSet;
use std::fmt;

use brdf_sdk::manifest::Array;
use brdf_sdk::{ParamValue, Place, Problem, Result};
use naga::valid::ModuleInfo;

use super::layout::{self, Binding, StructLayout};
use super::left_out::Reached;
use super::sampling::Sampling;
use super::source_map::SourceMap;
use super::{Sum, generated, validate};
use crate::native::texture_name;
use crate::plugin::Configured;

/// A linked, validated, folded program with one entry point, `main`.
#[derive(Debug)]
pub struct Program {
    /// The module that executors run.
    pub module: naga::Module,
    /// The resources that it reaches, and no more.
    pub bindings: Vec<Binding>,
    /// Where BRDF samples come from.
    pub sampling: Sampling,
    /// The arrays that its BRDF's text and its sampler read, if they do.
    pub arrays: Vec<Array>,
    /// How it adds up terms over the environment's texels; `None` where it averages samples.
    pub sum: Option<Sum>,
    /// Whether its plugins have loops, which may use up their budget.
    pub has_loops: bool,
    /// Whether its integrator wants a compensated importance table.
    pub compensated: bool,
    /// What is worth telling the user once.
    pub notes: Vec<String>,
    /// The program as text, and what was left out of it.
    pub reached: Reached,
    /// Where each part of the text comes from.
    pub(super) map: SourceMap,
}

impl Program {
    /// The layout of the struct that a variable holds or is an array of; `None` where the program
    /// does not reach the variable.
    pub fn layout(&self, variable: &str) -> Option<StructLayout> {
        layout::struct_layout(&self.module, variable)
    }

    /// The layout of a variable that every program of this view reaches.
    ///
    /// # Panics
    /// Where it does not: then the host's Rust and WGSL disagree.
    pub fn required_layout(&self, variable: &str) -> StructLayout {
        match self.layout(variable) {
            Some(layout) => layout,
            None => panic!("the host's shaders have no struct variable `{variable}`"),
        }
    }

    /// A problem at a place of the module, shown in the file that it comes from.
    pub fn problem(&self, span: naga::Span, reason: &str, cure: &str) -> Problem {
        match span.to_range() {
            Some(range) => self.map.problem(range, reason, cure),
            None => Problem::new("the linked program", reason, cure),
        }
    }

    /// Workgroups that make so many invocations, one of them at the least; how many each has, the kernel says.
    pub fn groups(&self, invocations: u32) -> [u32; 3] {
        let [size, ..] = self.module.entry_points[0].workgroup_size;
        [invocations.div_ceil(size).max(1), 1, 1]
    }

    /// naga's types of the module's expressions, which executors of the module ask for.
    ///
    /// # Errors
    /// None that linking has let through.
    pub fn types(&self) -> Result<ModuleInfo> {
        validate(&self.module, &self.map)
    }

    /// A construct that an executor does not run, at its place.
    pub fn refused(&self, refusal: &impl fmt::Display, span: naga::Span) -> Problem {
        self.problem(span, &refusal.to_string(), "write it another way")
    }

    /// Whether the program looks at the densities of the environment's texels.
    pub fn reads_densities(&self) -> bool {
        self.binds("env_ends") || self.calls("env_light")
    }

    /// Whether the program draws directions as its BRDF says.
    pub fn samples_brdf(&self) -> bool {
        self.calls("brdf_sample")
    }

    /// The variables of its arrays of vec4f and vec4u.
    pub fn lists(&self) -> HashSet<String> {
        let vectors = self.arrays.iter().filter(|array| array.element.of_list().is_some());
        vectors.map(texture_name).collect()
    }

    fn calls(&self, function: &str) -> bool {
        let mut names = self.module.functions.iter().filter_map(|(_, f)| f.name.as_deref());
        names.any(|name| name == function)
    }

    /// Whether the program binds a variable.
    pub fn binds(&self, variable: &str) -> bool {
        self.bindings.iter().any(|binding| binding.name == variable)
    }

    /// The bytes of a plugin's uniform; `None` where the program reaches none of its numbers.
    pub fn parameter_bytes(&self, configured: &Configured) -> Option<(String, Vec<u8>)> {
        let name = generated::uniform_name(configured.plugin.manifest.kind);
        let layout = self.layout(name)?;
        let mut bytes = vec![0; layout.stride];
        for (key, value) in configured.values.iter() {
            match value {
                ParamValue::Float(number) => layout.write(&mut bytes, 0, key, &[*number as f32]),
                ParamValue::Int(number) => layout.write(&mut bytes, 0, key, &[*number as i32]),
                ParamValue::Color(rgb) => layout.write(&mut bytes, 0, key, &rgb.map(|c| c as f32)),
                ParamValue::Bool(_) | ParamValue::Choice(_) | ParamValue::File(_) => {}
            }
        }
        Some((name.to_owned(), bytes))
    }

    /// The file and the place that a part of the module comes from.
    pub fn origin(&self, span: naga::Span) -> Option<Origin> {
        let (file, range) = self.map.original(span.to_range()?)?;
        let place = Place::locate(&file.text, range);
        Some(Origin { file: file.label.clone(), place, is_author: file.prefix.is_some() })
    }
}

/// Where a part of a program comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The file's name in messages.
    pub file: String,
    /// Where in the file.
    pub place: Place,
    /// Whether it is a plugin's own file.
    pub is_author: bool,
}
