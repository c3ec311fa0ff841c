//! What a plugin's functions may do, checked on the parsed module, where no spelling can hide it.
//!
//! A function computes from its arguments: it touches no module variable, no other invocation and no
//! storage. And it stays small: drivers inline every call and unroll every array, so the size of what
//! they will see is bounded here.

use brdf_sdk::{Problem, Result};
use naga::{Block, Expression, Function, Module, Span, Statement};

use super::source_map::SourceMap;

/// Bytes of the largest value that a plugin may hold.
const MAX_VALUE_BYTES: u32 = 16 << 10;

/// Expressions of a plugin's function with every call in it written out.
const MAX_EXPANDED: u64 = 200_000;

/// Checks the functions whose linked name begins with `prefix`.
pub fn check(module: &Module, map: &SourceMap, prefix: &str) -> Result<()> {
    for (_, variable) in module.global_variables.iter() {
        if variable.name.as_deref().is_some_and(|name| name.starts_with(prefix)) {
            return Err(Problem::new(
                "the plugin",
                "it declares a variable at module scope",
                "use `const`, or a `var` inside the function",
            ));
        }
    }
    if !module.entry_points.is_empty() {
        return Err(Problem::new(
            "the plugin",
            "it declares an entry point",
            "remove it: entry points are the host's",
        ));
    }
    let mut expanded: Vec<u64> = Vec::new();
    for (handle, function) in module.functions.iter() {
        // Functions stand in the order of their calls: what is called is known already.
        let calls = called(&function.body);
        // A call costs something where the function is empty too.
        let own = function.expressions.len() as u64 + 1;
        let cost = calls.iter().fold(own, |cost, callee| {
            cost.saturating_add(expanded.get(callee.index()).copied().unwrap_or(0))
        });
        expanded.push(cost);
        let own = function.name.as_deref().is_some_and(|name| name.starts_with(prefix));
        if !own {
            continue;
        }
        let at = |span: Span, reason: &str, cure: &str| match span.to_range() {
            Some(range) => map.problem(range, reason, cure),
            None => Problem::new("the plugin", reason, cure),
        };
        if cost > MAX_EXPANDED {
            return Err(at(
                module.functions.get_span(handle),
                &format!(
                    "with its calls written out, this function has {cost} expressions and calls, more than {MAX_EXPANDED}"
                ),
                "call fewer functions from functions: drivers inline them all",
            ));
        }
        check_sizes(module, function, &at)?;
        check_expressions(module, function, &at)?;
        check_statements(&function.body, &at)?;
    }
    Ok(())
}

type At<'a> = dyn Fn(Span, &str, &str) -> Problem + 'a;

fn check_sizes(module: &Module, function: &Function, at: &At<'_>) -> Result<()> {
    let size = |ty: naga::Handle<naga::Type>| module.types[ty].inner.size(module.to_ctx());
    let reason = |bytes: u32| {
        format!(
            "this holds {bytes} bytes, more than the {MAX_VALUE_BYTES} that drivers keep in registers"
        )
    };
    let cure = "use a smaller array; large tables belong into a native plugin's arrays";
    for (handle, local) in function.local_variables.iter() {
        let bytes = size(local.ty);
        if bytes > MAX_VALUE_BYTES {
            return Err(at(function.local_variables.get_span(handle), &reason(bytes), cure));
        }
    }
    for (handle, expression) in function.expressions.iter() {
        if let Expression::Compose { ty, .. } | Expression::ZeroValue(ty) = expression
            && size(*ty) > MAX_VALUE_BYTES
        {
            return Err(at(function.expressions.get_span(handle), &reason(size(*ty)), cure));
        }
    }
    Ok(())
}

fn check_expressions(module: &Module, function: &Function, at: &At<'_>) -> Result<()> {
    for (handle, expression) in function.expressions.iter() {
        let refused = match expression {
            Expression::GlobalVariable(variable) => {
                let name =
                    module.global_variables[*variable].name.as_deref().unwrap_or("a variable");
                format!("`{name}` is the host's own")
            }
            Expression::Derivative { .. } => "derivatives look at other invocations".to_owned(),
            Expression::SubgroupBallotResult
            | Expression::SubgroupOperationResult { .. }
            | Expression::AtomicResult { .. }
            | Expression::WorkGroupUniformLoadResult { .. } => {
                "this looks at other invocations".to_owned()
            }
            _ => continue,
        };
        let cure = "compute from the arguments alone: invocations are independent";
        return Err(at(function.expressions.get_span(handle), &refused, cure));
    }
    Ok(())
}

fn check_statements(block: &Block, at: &At<'_>) -> Result<()> {
    for (statement, span) in block.span_iter() {
        match statement {
            Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) => {
                return Err(at(
                    *span,
                    "a plugin may not wait for other invocations",
                    "compute from the arguments alone: invocations are independent",
                ));
            }
            other => {
                for inner in inner_blocks(other) {
                    check_statements(inner, at)?;
                }
            }
        }
    }
    Ok(())
}

/// The functions that a block calls, once for each call.
fn called(block: &Block) -> Vec<naga::Handle<Function>> {
    let mut calls = Vec::new();
    for statement in block {
        if let Statement::Call { function, .. } = statement {
            calls.push(*function);
        }
        for inner in inner_blocks(statement) {
            calls.extend(called(inner));
        }
    }
    calls
}

fn inner_blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        _ => Vec::new(),
    }
}
