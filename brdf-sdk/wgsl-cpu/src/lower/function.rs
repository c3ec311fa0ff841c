//! Functions and their statements. A call is written out where it stands.
//!
//! So there is no stack when the program runs, and recursion, which WGSL forbids, could not be run. Expressions are
//! `value.rs`'s, places in memory `place.rs`'s.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use naga::valid::FunctionInfo;
use naga::{
    AtomicFunction, BinaryOperator, Block, BuiltIn, EntryPoint, Expression, Function, Handle,
    LocalVariable, Span, Statement,
};

use super::frames::Frame;
use super::place::{Place, signed};
use super::shape::Ty;
use super::{Lowering, Result};
use crate::op::{AtomicOp, Builtin, NONE, Op, Reg};

/// Calls inside calls, and blocks inside blocks.
const MAX_DEPTH: usize = 1500;

/// What an expression is while lowering.
#[derive(Debug, Clone)]
pub(super) enum Value {
    Regs(Rc<Vec<Reg>>),
    Place(Place),
}

/// One call under way.
pub(super) struct Call<'a> {
    pub function: &'a Function,
    pub info: &'a FunctionInfo,
    /// Counts from 1; variables know it as their owner.
    pub id: usize,
    pub values: HashMap<Handle<Expression>, Value>,
    pub arguments: Vec<Value>,
    pub locals: HashMap<Handle<LocalVariable>, Place>,
    /// The variable that holds the result.
    pub result: usize,
    /// The loops and switches around this point, the innermost last.
    pub frames: Vec<Frame>,
    /// Blocks and calls around this point.
    pub depth: usize,
    /// Expressions that the `continuing` part of a loop reads from outside it.
    pub pinned: HashSet<Handle<Expression>>,
}

impl<'a> Lowering<'a> {
    /// The mask of the lanes that stand for an invocation.
    pub(super) fn active(&mut self) -> Reg {
        self.build.emit(Op::Builtin(Builtin::Active), [NONE; 3], 0, 0)
    }

    pub(super) fn entry_call(&mut self, entry: &'a EntryPoint) -> Result<()> {
        let mut arguments = Vec::new();
        for argument in &entry.function.arguments {
            let values = match argument.binding {
                Some(naga::Binding::BuiltIn(builtin)) => self.builtin(builtin)?,
                _ => return self.build.refuse("entry points with arguments other than builtins"),
            };
            arguments.push(Value::Regs(Rc::new(values)));
        }
        let info = self.info.get_entry_point(0);
        self.call(&entry.function, info, arguments, 0)?;
        Ok(())
    }

    fn builtin(&mut self, builtin: BuiltIn) -> Result<Vec<Reg>> {
        let axes = |lowering: &mut Self, of: fn(u8) -> Builtin| -> Vec<Reg> {
            (0..3).map(|axis| lowering.build.emit(Op::Builtin(of(axis)), [NONE; 3], 0, 0)).collect()
        };
        Ok(match builtin {
            BuiltIn::GlobalInvocationId => axes(self, Builtin::GlobalId),
            BuiltIn::LocalInvocationId => axes(self, Builtin::LocalId),
            BuiltIn::WorkGroupId => axes(self, Builtin::GroupId),
            BuiltIn::LocalInvocationIndex => {
                vec![self.build.emit(Op::Builtin(Builtin::LocalIndex), [NONE; 3], 0, 0)]
            }
            BuiltIn::NumWorkGroups => {
                (0..3).map(|axis| self.build.emit(Op::GroupCount, [NONE; 3], axis, 0)).collect()
            }
            other => return self.build.refuse(format!("the builtin value {other:?}")),
        })
    }

    /// Writes a call out; its result's components, none without a result.
    pub(super) fn call(
        &mut self,
        function: &'a Function,
        info: &'a FunctionInfo,
        arguments: Vec<Value>,
        depth: usize,
    ) -> Result<Vec<Reg>> {
        self.build.count_call();
        self.build.check_size()?;
        self.calls += 1;
        let id = self.calls;
        let (first_var, memory) = (self.env.vars.len(), self.memory);
        let components = match &function.result {
            Some(result) => self.parts(Ty::Handle(result.ty))?.banks.len(),
            None => 0,
        };
        let result = self.new_var(id, vec![NONE; components]);
        let mut call = Call {
            function,
            info,
            id,
            values: HashMap::new(),
            arguments,
            locals: HashMap::new(),
            result,
            frames: Vec::new(),
            depth,
            pinned: HashSet::new(),
        };
        for (handle, local) in function.local_variables.iter() {
            let outer = self.build.set_span(function.local_variables.get_span(handle));
            let init = match local.init {
                Some(init) => Some(self.regs(&mut call, init)?.to_vec()),
                None => None,
            };
            let place = self.variable(id, local.ty, init)?;
            call.locals.insert(handle, place);
            self.build.restore_span(outer);
        }
        let exec = self.env.exec;
        let statements: Vec<_> = function.body.span_iter().collect();
        self.statements(&mut call, &statements)?;
        let values = self.env.vars[result].to_vec();
        self.env.exec = exec;
        self.env.dead = false;
        self.env.jumped = false;
        self.env.vars.truncate(first_var);
        self.owners.truncate(first_var);
        self.memory = memory;
        // A path without a result is one that no lane takes.
        let parts = match &function.result {
            Some(result) => self.parts(Ty::Handle(result.ty))?,
            None => return Ok(values),
        };
        Ok(values
            .into_iter()
            .zip(&parts.banks)
            .map(|(value, bank)| if value == NONE { self.build.zero(*bank) } else { value })
            .collect())
    }

    pub(super) fn block(&mut self, call: &mut Call<'a>, block: &'a Block) -> Result<()> {
        let statements: Vec<_> = block.span_iter().collect();
        self.statements(call, &statements)
    }

    pub(super) fn statements(
        &mut self,
        call: &mut Call<'a>,
        statements: &[(&'a Statement, &'a Span)],
    ) -> Result<()> {
        if call.depth > MAX_DEPTH {
            return self.build.refuse("blocks and calls nested this deep");
        }
        call.depth += 1;
        let result = self.statements_here(call, statements);
        call.depth -= 1;
        result
    }

    fn statements_here(
        &mut self,
        call: &mut Call<'a>,
        statements: &[(&'a Statement, &'a Span)],
    ) -> Result<()> {
        for (index, (statement, span)) in statements.iter().enumerate() {
            let outer = self.build.set_span(**span);
            let rest = &statements[index + 1..];
            let before = self.env.exec;
            let took_rest = self.statement(call, statement, rest)?;
            self.build.check_size()?;
            self.build.restore_span(outer);
            if took_rest || self.env.dead {
                return Ok(());
            }
            if self.env.exec != before && !rest.is_empty() {
                // Some lanes have left: where all of them have, the rest is passed over.
                let here = self.env.exec;
                return self.branch(
                    call,
                    here,
                    |lowering, call| lowering.statements(call, rest),
                    |lowering, _| {
                        lowering.env.dead = true;
                        Ok(())
                    },
                );
            }
        }
        Ok(())
    }

    /// Lowers a statement; true where it took the statements that follow it along.
    fn statement(
        &mut self,
        call: &mut Call<'a>,
        statement: &'a Statement,
        rest: &[(&'a Statement, &'a Span)],
    ) -> Result<bool> {
        match *statement {
            Statement::Emit(ref range) => {
                for handle in range.clone() {
                    self.value(call, handle)?;
                }
            }
            Statement::Block(ref block) => {
                if rest.is_empty() {
                    self.block(call, block)?;
                } else {
                    let mut all: Vec<_> = block.span_iter().collect();
                    all.extend_from_slice(rest);
                    self.statements(call, &all)?;
                }
                return Ok(true);
            }
            Statement::If { condition, ref accept, ref reject } => {
                let condition = self.one(call, condition)?;
                let mut sides = [accept, reject].map(|side| side.span_iter().collect::<Vec<_>>());
                // Where one side ends here, what follows belongs to the other one.
                let taken = if ends(accept) {
                    sides[1].extend_from_slice(rest);
                    true
                } else if ends(reject) {
                    sides[0].extend_from_slice(rest);
                    true
                } else {
                    false
                };
                let [accept, reject] = sides;
                self.branch(
                    call,
                    condition,
                    |lowering, call| lowering.statements(call, &accept),
                    |lowering, call| lowering.statements(call, &reject),
                )?;
                return Ok(taken);
            }
            Statement::Switch { selector, ref cases } => {
                let selector = self.one(call, selector)?;
                return self.switch(call, selector, cases, rest);
            }
            Statement::Loop { ref body, ref continuing, break_if } => {
                return self.run_loop(call, body, continuing, break_if, rest);
            }
            Statement::Break => self.leave_by_break(call),
            Statement::Continue => self.leave_by_continue(call),
            Statement::Return { value } => {
                if let Some(value) = value {
                    let values = self.regs(call, value)?;
                    // Lanes that have returned are held apart by the branch around this point.
                    self.env.vars[call.result] = values;
                }
                self.leave_by_return(call);
            }
            Statement::Store { pointer, value } => {
                let values = self.regs(call, value)?;
                let place = self.place(call, pointer)?;
                self.store(&place, &values)?;
            }
            Statement::Call { function, ref arguments, result } => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    values.push(self.value(call, *argument)?);
                }
                let (callee, info) = (&self.module.functions[function], &self.info[function]);
                let values = self.call(callee, info, values, call.depth + 1)?;
                if let Some(result) = result {
                    let value = self.pinned(call, result, Value::Regs(Rc::new(values)));
                    call.values.insert(result, value);
                }
            }
            Statement::Atomic { pointer, ref fun, value, result } => {
                let place = self.place(call, pointer)?;
                let kind = super::shape::scalar_of(self.inner(call, value));
                let is_signed = kind.is_some_and(signed);
                let value = self.one(call, value)?;
                let op = match *fun {
                    AtomicFunction::Add => AtomicOp::Add,
                    AtomicFunction::Subtract => AtomicOp::Sub,
                    AtomicFunction::And => AtomicOp::And,
                    AtomicFunction::ExclusiveOr => AtomicOp::Xor,
                    AtomicFunction::InclusiveOr => AtomicOp::Or,
                    AtomicFunction::Min if is_signed => AtomicOp::MinI,
                    AtomicFunction::Min => AtomicOp::MinU,
                    AtomicFunction::Max if is_signed => AtomicOp::MaxI,
                    AtomicFunction::Max => AtomicOp::MaxU,
                    AtomicFunction::Exchange { compare: None } => AtomicOp::Exchange,
                    AtomicFunction::Exchange { compare: Some(_) } => {
                        return self.build.refuse("atomicCompareExchangeWeak");
                    }
                };
                let before = self.atomic(&place, op, value)?;
                if let Some(result) = result {
                    call.values.insert(result, Value::Regs(Rc::new(vec![before])));
                }
            }
            Statement::Kill => return self.build.refuse("`discard`"),
            Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) => {
                return self.build.refuse("barriers: invocations do not meet here");
            }
            Statement::WorkGroupUniformLoad { .. } => {
                return self.build.refuse("workgroup memory");
            }
            Statement::ImageStore { .. } | Statement::ImageAtomic { .. } => {
                return self.build.refuse("stores to textures");
            }
            _ => return self.build.refuse("statements of subgroups, rays and matrices"),
        }
        Ok(false)
    }
}

/// Whether control never comes to the end of a block.
fn ends(block: &Block) -> bool {
    match block.last() {
        Some(Statement::Return { .. } | Statement::Break | Statement::Continue) => true,
        Some(Statement::If { accept, reject, .. }) => ends(accept) && ends(reject),
        Some(Statement::Block(inner)) => ends(inner),
        _ => false,
    }
}

/// Which comparison a binary operator is, with its operands perhaps the other way round.
pub(super) fn turned(op: BinaryOperator) -> Option<BinaryOperator> {
    match op {
        BinaryOperator::Greater => Some(BinaryOperator::Less),
        BinaryOperator::GreaterEqual => Some(BinaryOperator::LessEqual),
        _ => None,
    }
}
