//! The tree as WGSL.
//!
//! Written in three passes of the same code, of which two only learn: which globals change, and who reads those and
//! the parameters. It may depend on the tree, the types and the parameters' keys; it knows no tokens, and opens no
//! file.

mod assign;
mod builtin;
mod call;
mod effects;
mod expr;
mod global;
mod loops;
mod names;
mod operator;
mod shim;
mod stmt;
mod value;
mod writer;

use std::collections::{BTreeMap, HashMap, HashSet};

use brdf_sdk::Result;

use crate::Source;
use crate::ast::{Expr, Item, Passed};
use crate::lexer::Comment;
use crate::manifest::Keyed;
use crate::types::Ty;
use names::{Kind, Variable};
use writer::Writer;

/// What was written.
pub(crate) struct Written {
    pub(crate) wgsl: String,
    pub(crate) notes: Vec<String>,
}

/// What a pass finds out for the next one. Functions go by their place among functions, variables by their number;
/// behind the functions come globals, whose first values may read parameters too.
#[derive(Default, Clone)]
struct Learned {
    assigned: HashSet<usize>,
    assigned_globals: HashSet<usize>,
    touched_globals: HashSet<(usize, usize)>,
    reads_parameters: HashSet<usize>,
    reads_globals: HashSet<usize>,
    calls: HashSet<(usize, usize)>,
}

struct Structure {
    name: String,
    wgsl: String,
    members: Vec<(String, Ty, String)>,
}

#[derive(Clone)]
struct OwnFunction {
    name: String,
    wgsl: String,
    arguments: Vec<(Passed, Ty)>,
    names: Vec<String>,
    result: Ty,
    is_defined: bool,
}

struct Global {
    wgsl: String,
    ty: Ty,
    is_const: bool,
    /// Whether WGSL takes it for a constant; else it is a function, or a member where it changes.
    is_constant: bool,
    /// Its value, where it is one number that never changes.
    number: Option<f64>,
}

struct Emitter<'a> {
    source: Source<'a>,
    learned: Learned,
    learning: Learned,
    structs: Vec<Structure>,
    functions: Vec<OwnFunction>,
    globals: Vec<Global>,
    /// Parameters and globals by the author's names.
    outer: HashMap<String, Variable>,
    scopes: Vec<HashMap<String, Variable>>,
    /// Names that the plugin's contract and its parameters take.
    own_names: HashSet<String>,
    module_names: HashSet<String>,
    globals_name: String,
    helpers: BTreeMap<String, String>,
    /// First values of globals that change, in their order.
    first_values: Vec<String>,
    shim_text: String,
    /// The function or global that is being written, for what is learned of it.
    current: usize,
    result: Ty,
    numbers: usize,
    temporaries: usize,
    pre: Vec<String>,
    post: Vec<String>,
    /// The expression that is being written, with all that it is a part of.
    whole: Option<Expr>,
    work: usize,
    out: Writer,
}

/// What functions are handed beside the author's arguments.
const HANDED: [&str; 2] = ["p", "globals"];

/// Writes the tree.
pub(crate) fn write(
    source: Source<'_>,
    tree: &[Item],
    parameters: &[Keyed<'_>],
    comments: Vec<Comment>,
) -> Result<Written> {
    // The first pass finds which globals change, the second who reads those, and the parameters; the third writes.
    let mut learned = Learned::default();
    for _ in 0..2 {
        let mut emitter = Emitter::new(source, parameters, Vec::new(), learned.clone());
        emitter.all(tree)?;
        learned = emitter.settle();
    }
    let mut emitter = Emitter::new(source, parameters, comments, learned);
    let notes = emitter.all(tree)?;
    let behind = emitter.behind();
    Ok(Written { wgsl: emitter.out.finish(&behind), notes })
}

impl<'a> Emitter<'a> {
    fn new(
        source: Source<'a>,
        parameters: &[Keyed<'_>],
        comments: Vec<Comment>,
        learned: Learned,
    ) -> Self {
        let mut own_names: HashSet<String> = HANDED.iter().map(|name| (*name).to_owned()).collect();
        let mut outer = HashMap::new();
        for parameter in parameters {
            let text = parameter.wgsl_use();
            own_names.insert(text.clone());
            let variable = Variable { ty: parameter.ty(), kind: Kind::Parameter { text } };
            outer.insert(parameter.declared.name.clone(), variable);
        }
        Self {
            source,
            learned,
            learning: Learned::default(),
            structs: Vec::new(),
            functions: Vec::new(),
            globals: Vec::new(),
            outer,
            scopes: Vec::new(),
            own_names,
            module_names: HashSet::new(),
            globals_name: String::new(),
            helpers: BTreeMap::new(),
            first_values: Vec::new(),
            shim_text: String::new(),
            current: 0,
            result: Ty::Void,
            numbers: 0,
            temporaries: 0,
            pre: Vec::new(),
            post: Vec::new(),
            whole: None,
            work: 0,
            out: Writer::new(source, comments),
        }
    }

    /// Everything that the file says; then what the host asks for.
    fn all(&mut self, tree: &[Item]) -> Result<Vec<String>> {
        self.announce(tree)?;
        let mut globals = 0;
        for item in tree {
            match item {
                Item::Struct(found) => self.write_structure(found)?,
                Item::Global(declaration) => {
                    self.write_globals(declaration, globals)?;
                    globals += declaration.names.len();
                }
                Item::Function(function) => {
                    let index = self.function_of(function)?;
                    self.function(index, function)?;
                }
            }
        }
        self.shim()
    }

    /// Follows calls to all who need parameters and globals.
    fn settle(self) -> Learned {
        let mut learned = self.learning;
        for (node, global) in &learned.touched_globals {
            if learned.assigned_globals.contains(global) {
                learned.reads_globals.insert(*node);
            }
        }
        loop {
            let before = learned.reads_parameters.len() + learned.reads_globals.len();
            for (caller, callee) in &learned.calls {
                if learned.reads_parameters.contains(callee) {
                    learned.reads_parameters.insert(*caller);
                }
                if learned.reads_globals.contains(callee) {
                    learned.reads_globals.insert(*caller);
                }
            }
            if learned.reads_parameters.len() + learned.reads_globals.len() == before {
                return learned;
            }
        }
    }

    /// A function of the translation's own, under a name that nobody has.
    fn helper(&mut self, name: &str, body: &str) -> String {
        let mut found = name.to_owned();
        while self.module_names.contains(&found) {
            found.push('_');
        }
        self.helpers.entry(found.clone()).or_insert_with(|| format!("fn {found}{body}\n"));
        found
    }
}
