//! Names: what the author's become, and what they stand for.

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
    Local { name: String, number: usize, is_const: bool },
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
        let mut found = name.to_owned();
        if found.starts_with("__") {
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

/// Words that WGSL keeps, or knows already.
fn is_taken(name: &str) -> bool {
    RESERVED_WORDS.contains(&name) || WGSL_NAMES.contains(&name)
}
