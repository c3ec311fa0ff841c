//! Names: what the author's become, and what they stand for.
//!
//! A name stays as it is, unless WGSL, the plugin's contract or another name of the code has it already. Scopes are
//! those of GLSL.

use std::collections::HashMap;

use brdf_sdk::reserved::RESERVED_WORDS;

use super::Emitter;
use crate::builtins::WGSL_NAMES;
use crate::types::Ty;

/// What the host asks a plugin for by name.
const CONTRACT: [&str; 5] = ["eval", "sample", "pdf", "weight", "Params"];

/// What a name stands for.
#[derive(Debug, Clone)]
pub(super) struct Variable {
    pub(super) ty: Ty,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// In a function, under its WGSL name; its number among all of the code.
    Local { name: String, number: usize, is_const: bool, known: Option<f64> },
    /// An argument that is handed back.
    Pointer { name: String },
    /// A parameter of the file.
    Parameter { text: String },
    /// Outside of functions, by its place among those.
    Global(usize),
}

impl Emitter<'_> {
    /// A name for something outside of functions.
    pub(super) fn module_name(&mut self, name: &str) -> String {
        let name = &apart(name);
        let mut found = name.trim_start_matches('_').to_owned();
        if !name.starts_with("__") || found.is_empty() {
            name.clone_into(&mut found);
        }
        while is_taken(&found)
            || CONTRACT.contains(&found.as_str())
            || self.own_names.contains(&found)
            || self.module_names.contains(&found)
        {
            found.push('_');
        }
        self.module_names.insert(found.clone());
        found
    }

    /// A name for something inside of the function that is being written.
    pub(super) fn local_name(&self, name: &str) -> String {
        let active = |found: &str| {
            self.scopes.iter().any(|scope| {
                scope.values().any(|variable| match &variable.kind {
                    Kind::Local { name, .. } | Kind::Pointer { name } => name == found,
                    _ => false,
                })
            })
        };
        let mut found = apart(name);
        if found.starts_with("__") || found == "_" {
            found = format!("x{found}");
        }
        while is_taken(&found)
            || self.own_names.contains(&found)
            || self.module_names.contains(&found)
            || active(&found)
        {
            found.push('_');
        }
        found
    }

    /// What a name means here.
    pub(super) fn variable(&self, name: &str) -> Option<Variable> {
        let local = self.scopes.iter().rev().find_map(|scope: &HashMap<_, _>| scope.get(name));
        local.or_else(|| self.outer.get(name)).cloned()
    }
}

/// What names of the translation's own functions begin with.
const HELPERS: [&str; 7] = ["power_", "mod_", "isnan_", "isinf_", "inverse_", "product_", "outer_"];

/// What its variables begin with.
pub(super) const TEMPORARY: &str = "t_";

/// A name that is none of the translation's own functions'.
fn apart(name: &str) -> String {
    match HELPERS.iter().any(|begin| name.starts_with(begin)) {
        true => format!("own_{name}"),
        false => name.to_owned(),
    }
}

/// Words that WGSL keeps, or knows already, or that the translation needs.
fn is_taken(name: &str) -> bool {
    let is_temporary = name
        .strip_prefix(TEMPORARY)
        .is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|byte| byte.is_ascii_digit()));
    RESERVED_WORDS.contains(&name) || WGSL_NAMES.contains(&name) || is_temporary
}
