//! What the program reaches, told in the text's terms: the reachable declarations, and the rest.

use std::collections::BTreeSet;

use naga::Module;

use super::declarations::{Cut, Declaration};
use super::tokens::TokenKind;

/// The linked text without what nothing reaches, and the names of what was left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reached {
    /// The text of the reachable declarations, in order; it is a program of its own.
    pub text: String,
    /// Linked names of the declarations that nothing names.
    pub left_out: Vec<String>,
    /// Linked names of functions and variables that the text still names, but only behind branches
    /// that constants decide: the folded module has none of them.
    pub folded_away: Vec<String>,
}

/// Splits the linked text by what its entry point reaches.
///
/// Names are followed as words, which may keep a declaration that only shares its name with a
/// local; functions and variables are then checked against the folded and compacted module.
pub fn reached(text: &str, cut: &Cut, module: &Module) -> Reached {
    let entries = module.entry_points.iter().map(|entry| entry.name.as_str());
    let mut named: BTreeSet<&str> = entries.collect();
    let mut pending: Vec<&Declaration> =
        cut.declarations.iter().filter(|d| named.contains(d.name.as_str())).collect();
    while let Some(declaration) = pending.pop() {
        let first = cut.tokens.partition_point(|token| token.span.start < declaration.span.start);
        let inside = cut.tokens[first..].iter().enumerate();
        for (index, token) in inside.take_while(|(_, token)| token.span.end <= declaration.span.end)
        {
            if token.kind == TokenKind::Word
                && !cut.is_member(first + index)
                && let Some(other) = cut.declaration(token.text(text))
                && named.insert(other.name.as_str())
            {
                pending.push(other);
            }
        }
    }

    let functions = module.functions.iter().filter_map(|(_, function)| function.name.as_deref());
    let variables =
        module.global_variables.iter().filter_map(|(_, variable)| variable.name.as_deref());
    let entries = module.entry_points.iter().map(|entry| entry.name.as_str());
    let alive: BTreeSet<&str> = functions.chain(variables).chain(entries).collect();

    let mut reached =
        Reached { text: String::new(), left_out: Vec::new(), folded_away: Vec::new() };
    for declaration in &cut.declarations {
        let name = declaration.name.as_str();
        if name.is_empty() {
            // An assertion that held while linking says nothing more.
            continue;
        }
        if !named.contains(name) {
            reached.left_out.push(name.to_owned());
            continue;
        }
        reached.text.push_str(&text[declaration.span.clone()]);
        if matches!(declaration.keyword.as_str(), "fn" | "var") && !alive.contains(name) {
            reached.folded_away.push(name.to_owned());
        }
    }
    reached.text = reached.text.trim_start().to_owned() + "\n";
    reached
}
