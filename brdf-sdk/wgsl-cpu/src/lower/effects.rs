//! What a body may do, found by looking through it: the variables that it writes, calls included, and
//! how it is left.

use std::collections::HashSet;

use naga::{Block, Expression, Function, Handle, Statement};

use super::Lowering;
use super::function::{Call, Value};
use super::place::Place;

/// What a body may do.
#[derive(Default)]
pub(super) struct Effects {
    pub vars: Vec<usize>,
    pub returns: bool,
    /// A `continue` of a loop around this switch.
    pub continues: bool,
}

impl<'a> Lowering<'a> {
    /// What a block writes and how it is left, calls included.
    pub(super) fn look_through(
        &self,
        call: &Call<'a>,
        block: &Block,
        in_loop: bool,
        found: &mut Effects,
    ) {
        for statement in block {
            match statement {
                Statement::Store { pointer, .. } => self.written(call, *pointer, found),
                Statement::Call { arguments, .. } => {
                    for argument in arguments {
                        self.written(call, *argument, found);
                    }
                    for place in self.privates.values() {
                        found.vars.extend(place.variable());
                    }
                }
                Statement::Block(inner) => self.look_through(call, inner, in_loop, found),
                Statement::If { accept, reject, .. } => {
                    self.look_through(call, accept, in_loop, found);
                    self.look_through(call, reject, in_loop, found);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.look_through(call, &case.body, in_loop, found);
                    }
                }
                Statement::Loop { body, continuing, .. } => {
                    self.look_through(call, body, true, found);
                    self.look_through(call, continuing, true, found);
                }
                Statement::Return { .. } => found.returns = true,
                Statement::Continue if !in_loop => found.continues = true,
                _ => {}
            }
        }
    }

    fn written(&self, call: &Call<'a>, pointer: Handle<Expression>, found: &mut Effects) {
        let mut root = pointer;
        while let Expression::Access { base, .. } | Expression::AccessIndex { base, .. } =
            call.function.expressions[root]
        {
            root = base;
        }
        let place = match call.function.expressions[root] {
            Expression::LocalVariable(local) => call.locals.get(&local),
            Expression::GlobalVariable(global) => self.privates.get(&global),
            Expression::FunctionArgument(index) => match call.arguments.get(index as usize) {
                Some(Value::Place(place)) => Some(place),
                _ => None,
            },
            _ => None,
        };
        found.vars.extend(place.and_then(Place::variable));
    }
}

impl Place {
    /// The variable in registers that it is a part of.
    fn variable(&self) -> Option<usize> {
        match self {
            Place::Var { var, .. } | Place::OneOf { var, .. } => Some(*var),
            _ => None,
        }
    }
}

/// Whether statements hold a `break` of the switch that they stand in.
pub(super) fn has_break<'a>(statements: impl Iterator<Item = &'a Statement>) -> bool {
    let mut statements = statements;
    statements.any(|statement| match statement {
        Statement::Break => true,
        Statement::Block(inner) => has_break(&mut inner.iter()),
        Statement::If { accept, reject, .. } => {
            has_break(&mut accept.iter()) || has_break(&mut reject.iter())
        }
        _ => false,
    })
}

/// Expressions that the `continuing` part of a loop reads and does not compute itself.
pub(super) fn read_from_outside(
    function: &Function,
    continuing: &Block,
    break_if: Option<Handle<Expression>>,
) -> HashSet<Handle<Expression>> {
    let (mut read, mut computed) = (HashSet::new(), HashSet::new());
    read.extend(break_if);
    reads(function, continuing, &mut read, &mut computed);
    read.difference(&computed).copied().collect()
}

fn reads(
    function: &Function,
    block: &Block,
    read: &mut HashSet<Handle<Expression>>,
    computed: &mut HashSet<Handle<Expression>>,
) {
    for statement in block {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    computed.insert(handle);
                    operands(&function.expressions[handle], read);
                }
            }
            Statement::Block(inner) => reads(function, inner, read, computed),
            Statement::If { condition, accept, reject } => {
                read.insert(*condition);
                reads(function, accept, read, computed);
                reads(function, reject, read, computed);
            }
            Statement::Switch { selector, cases } => {
                read.insert(*selector);
                cases.iter().for_each(|case| reads(function, &case.body, read, computed));
            }
            Statement::Loop { body, continuing, break_if } => {
                read.extend(break_if);
                reads(function, body, read, computed);
                reads(function, continuing, read, computed);
            }
            Statement::Store { pointer, value } => read.extend([*pointer, *value]),
            Statement::Call { arguments, result, .. } => {
                read.extend(arguments);
                computed.extend(result);
            }
            Statement::Atomic { pointer, value, result, .. } => {
                read.extend([*pointer, *value]);
                computed.extend(result);
            }
            _ => {}
        }
    }
}

/// The expressions that an expression is made of.
fn operands(expression: &Expression, read: &mut HashSet<Handle<Expression>>) {
    match *expression {
        Expression::Compose { ref components, .. } => read.extend(components),
        Expression::Access { base, index } => read.extend([base, index]),
        Expression::AccessIndex { base, .. } => read.extend([base]),
        Expression::Splat { value, .. } => read.extend([value]),
        Expression::Swizzle { vector, .. } => read.extend([vector]),
        Expression::Load { pointer } => read.extend([pointer]),
        Expression::ImageLoad { image, coordinate, level, .. } => {
            read.extend([image, coordinate]);
            read.extend(level);
        }
        Expression::Unary { expr, .. } | Expression::As { expr, .. } => read.extend([expr]),
        Expression::Binary { left, right, .. } => read.extend([left, right]),
        Expression::Select { condition, accept, reject } => {
            read.extend([condition, accept, reject]);
        }
        Expression::Relational { argument, .. } => read.extend([argument]),
        Expression::Math { arg, arg1, arg2, arg3, .. } => {
            read.extend([arg]);
            read.extend([arg1, arg2, arg3].into_iter().flatten());
        }
        Expression::ArrayLength(pointer) => read.extend([pointer]),
        _ => {}
    }
}
