//! The loop budget, put into every loop of a plugin, so that no plugin can hang a driver.
//!
//! Each iteration takes one from `loop_budget` (shaders/loops.wgsl); where none is left, the function
//! returns zero. The kernel then reports the invocation as exhausted, on every driver alike.

use brdf_sdk::Problem;
use naga::{
    BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Module, Range,
    Span, Statement,
};

/// The name of the counter in shaders/loops.wgsl.
const COUNTER: &str = "loop_budget";

/// Iterations that an invocation has for the plugins' loops, as shaders/loops.wgsl gives them. The kernels' own loops
/// have as many.
pub const LOOP_ITERATIONS: u32 = 16_384;

/// What a loop is told that used up the budget on its own; `during` says at what, as in `for one sample`.
pub fn endless_loop(plugins: &str, during: &str) -> Problem {
    Problem::new(
        plugins,
        format!("a loop took more than 16,383 iterations {during}"),
        "look for an endless loop, or give the loop a smaller bound",
    )
}

/// Bounds the loops of all functions whose name begins with one of `prefixes`; says whether there are any.
pub fn bound_loops(module: &mut Module, prefixes: &[String]) -> bool {
    let Some((counter, _)) = module
        .global_variables
        .iter()
        .find(|(_, variable)| variable.name.as_deref() == Some(COUNTER))
    else {
        return false;
    };
    let mut found = false;
    for (_, function) in module.functions.iter_mut() {
        let name = function.name.clone().unwrap_or_default();
        if prefixes.iter().any(|prefix| name.starts_with(prefix)) {
            let mut body = std::mem::take(&mut function.body);
            let before = function.expressions.len();
            bound_block(function, counter, &mut body);
            function.body = body;
            // A bound is made of new expressions.
            found |= function.expressions.len() > before;
        }
    }
    found
}

fn bound_block(function: &mut Function, counter: Handle<GlobalVariable>, block: &mut Block) {
    for statement in block.iter_mut() {
        match statement {
            Statement::Block(inner) => bound_block(function, counter, inner),
            Statement::If { accept, reject, .. } => {
                bound_block(function, counter, accept);
                bound_block(function, counter, reject);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    bound_block(function, counter, &mut case.body);
                }
            }
            Statement::Loop { body, continuing, .. } => {
                bound_block(function, counter, body);
                bound_block(function, counter, continuing);
                let mut guarded = take_one(function, counter);
                guarded.append(body);
                *body = guarded;
            }
            _ => {}
        }
    }
}

/// `if loop_budget == 0 { return zero; } loop_budget = loop_budget - 1;`
fn take_one(function: &mut Function, counter: Handle<GlobalVariable>) -> Block {
    let span = Span::UNDEFINED;
    let mut block = Block::new();
    let mut append = |expression| function.expressions.append(expression, span);
    let pointer = append(Expression::GlobalVariable(counter));
    let zero = append(Expression::Literal(Literal::U32(0)));
    let one = append(Expression::Literal(Literal::U32(1)));
    let left = append(Expression::Load { pointer });
    let none_left = append(Expression::Binary { op: BinaryOperator::Equal, left, right: zero });
    let fewer = append(Expression::Binary { op: BinaryOperator::Subtract, left, right: one });
    let value = function
        .result
        .as_ref()
        .map(|result| function.expressions.append(Expression::ZeroValue(result.ty), span));

    let mut stop = Block::new();
    stop.push(Statement::Return { value }, span);
    block.push(Statement::Emit(Range::new_from_bounds(left, fewer)), span);
    block.push(Statement::If { condition: none_left, accept: stop, reject: Block::new() }, span);
    block.push(Statement::Store { pointer, value: fewer }, span);
    block
}

#[cfg(test)]
mod tests {
    use super::super::shader::LOOPS;
    use super::*;

    #[test]
    fn the_shader_the_host_and_the_message_have_one_number() {
        assert!(LOOPS.1.contains(&format!("{COUNTER}: u32 = {LOOP_ITERATIONS}u;")));
        let told = endless_loop("p", "for one sample").reason.replace(',', "");
        assert!(told.contains(&format!("more than {} iterations", LOOP_ITERATIONS - 1)), "{told}");
    }
}
