//! Branches on constants are decided here: naga evaluates the condition but keeps both sides, and
//! with them all that the dead side reached.

use naga::{Block, Expression, Function, Handle, Literal, Module, Statement, SwitchValue};

/// Folds every `if` and `switch` whose selector is a constant, in all functions.
pub fn fold_constant_branches(module: &mut Module) {
    let constants: Vec<Option<Literal>> = module
        .constants
        .iter()
        .map(|(_, constant)| match module.global_expressions[constant.init] {
            Expression::Literal(literal) => Some(literal),
            _ => None,
        })
        .collect();
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    let entries = module.entry_points.iter_mut().map(|entry| &mut entry.function);
    for function in functions.chain(entries) {
        let mut body = std::mem::take(&mut function.body);
        fold_block(function, &constants, &mut body);
        function.body = body;
        // A name keeps its expression alive, and that of a call in a dead branch has no call any more.
        function.named_expressions.clear();
    }
}

fn fold_block(function: &Function, constants: &[Option<Literal>], block: &mut Block) {
    let mut folded = Block::with_capacity(block.len());
    for (mut statement, span) in std::mem::take(block).span_into_iter() {
        match statement {
            Statement::If { condition, ref mut accept, ref mut reject } => {
                fold_block(function, constants, accept);
                fold_block(function, constants, reject);
                let taken = match literal(function, constants, condition) {
                    Some(Literal::Bool(true)) => Some(std::mem::take(accept)),
                    Some(Literal::Bool(false)) => Some(std::mem::take(reject)),
                    _ => None,
                };
                match taken {
                    Some(taken) => {
                        let leaves = leaves(&taken);
                        folded.push(Statement::Block(taken), span);
                        if leaves {
                            // What follows is never reached, nor what it calls.
                            break;
                        }
                    }
                    None => folded.push(statement, span),
                }
            }
            Statement::Switch { selector, ref mut cases } => {
                for case in cases.iter_mut() {
                    fold_block(function, constants, &mut case.body);
                }
                let value = match literal(function, constants, selector) {
                    Some(Literal::U32(value)) => Some(SwitchValue::U32(value)),
                    Some(Literal::I32(value)) => Some(SwitchValue::I32(value)),
                    _ => None,
                };
                // The switch stays, with the one case that is taken: `break` needs it.
                if let Some(value) = value {
                    let hit = cases.iter().position(|case| case.value == value);
                    let default = cases.iter().position(|case| case.value == SwitchValue::Default);
                    if let Some(first) = hit.or(default) {
                        let last = (first..cases.len()).find(|&i| !cases[i].fall_through);
                        let mut kept: Vec<_> =
                            cases.drain(first..=last.unwrap_or(cases.len() - 1)).collect();
                        for case in &mut kept {
                            case.value = SwitchValue::Default;
                        }
                        // A run that falls through is one body; only its last entry carries it.
                        kept.drain(..kept.len() - 1);
                        *cases = kept;
                    }
                }
                folded.push(statement, span);
            }
            Statement::Block(ref mut inner) => {
                fold_block(function, constants, inner);
                folded.push(statement, span);
            }
            Statement::Loop { ref mut body, ref mut continuing, .. } => {
                fold_block(function, constants, body);
                fold_block(function, constants, continuing);
                folded.push(statement, span);
            }
            other => folded.push(other, span),
        }
    }
    *block = folded;
}

/// Whether nothing behind the block is reached.
fn leaves(block: &Block) -> bool {
    match block.last() {
        Some(Statement::Return { .. } | Statement::Break | Statement::Continue) => true,
        Some(Statement::Block(inner)) => leaves(inner),
        _ => false,
    }
}

fn literal(
    function: &Function,
    constants: &[Option<Literal>],
    expression: Handle<Expression>,
) -> Option<Literal> {
    match function.expressions[expression] {
        Expression::Literal(literal) => Some(literal),
        Expression::Constant(constant) => constants[constant.index()],
        _ => None,
    }
}
