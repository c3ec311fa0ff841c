//! Expressions.
//!
//! Each is lowered where it is first asked for, and kept by the call. Operators and builtin functions have files of
//! their own; what pointers stand for is `place.rs`'s.

use std::rc::Rc;

use naga::{
    Expression, Handle, ImageQuery, Literal, RelationalFunction, ScalarKind, TypeInner,
    UnaryOperator,
};

use super::function::{Call, Value};
use super::place::Place;
use super::shape::{Ty, scalar_of};
use super::{Lowering, Result};
use crate::op::{Bank, F1, NONE, Op, Reg, Texels, U1, U2};

impl<'a> Lowering<'a> {
    /// The type of an expression.
    pub(super) fn inner(&self, call: &Call<'a>, handle: Handle<Expression>) -> &'a TypeInner {
        call.info[handle].ty.inner_with(&self.module.types)
    }

    pub(super) fn value(
        &mut self,
        call: &mut Call<'a>,
        handle: Handle<Expression>,
    ) -> Result<Value> {
        if let Some(value) = call.values.get(&handle) {
            return Ok(value.clone());
        }
        let outer = self.build.set_span(call.function.expressions.get_span(handle));
        let value = self.compute(call, handle)?;
        let value = self.pinned(call, handle, value);
        self.build.check_size()?;
        self.build.restore_span(outer);
        call.values.insert(handle, value.clone());
        Ok(value)
    }

    /// A value that the `continuing` part of a loop around it reads: what the loop carries is written
    /// before that part, so the value keeps a copy.
    pub(super) fn pinned(
        &mut self,
        call: &Call<'a>,
        handle: Handle<Expression>,
        value: Value,
    ) -> Value {
        match value {
            Value::Regs(regs) if call.pinned.contains(&handle) => {
                let copies = regs.iter().map(|reg| self.build.steady(*reg)).collect();
                Value::Regs(Rc::new(copies))
            }
            other => other,
        }
    }

    /// The components of a value.
    pub(super) fn regs(
        &mut self,
        call: &mut Call<'a>,
        handle: Handle<Expression>,
    ) -> Result<Rc<Vec<Reg>>> {
        match self.value(call, handle)? {
            Value::Regs(regs) => Ok(regs),
            Value::Place(_) => self.build.refuse("a pointer where a value is expected"),
        }
    }

    /// A scalar.
    pub(super) fn one(&mut self, call: &mut Call<'a>, handle: Handle<Expression>) -> Result<Reg> {
        let regs = self.regs(call, handle)?;
        match regs[..] {
            [reg] => Ok(reg),
            _ => self.build.refuse("this where a scalar is expected"),
        }
    }

    pub(super) fn place(
        &mut self,
        call: &mut Call<'a>,
        handle: Handle<Expression>,
    ) -> Result<Place> {
        match self.value(call, handle)? {
            Value::Place(place) => Ok(place),
            Value::Regs(_) => self.build.refuse("a value where a pointer is expected"),
        }
    }

    fn literal(&mut self, literal: Literal) -> Result<Reg> {
        Ok(match literal {
            Literal::F32(value) => self.build.float(value),
            Literal::U32(value) => self.build.word(value),
            Literal::I32(value) => self.build.word(value as u32),
            Literal::Bool(value) => self.build.mask(value),
            other => return self.build.refuse(format!("the literal {other:?}")),
        })
    }

    /// The value of a module-scope constant expression.
    pub(super) fn global_constant(&mut self, handle: Handle<Expression>) -> Result<Vec<Reg>> {
        Ok(match self.module.global_expressions[handle] {
            Expression::Literal(literal) => vec![self.literal(literal)?],
            Expression::Constant(constant) => {
                self.global_constant(self.module.constants[constant].init)?
            }
            Expression::ZeroValue(ty) => {
                let parts = self.parts(Ty::Handle(ty))?;
                self.zeros(&parts.banks)
            }
            Expression::Compose { ty, ref components } => {
                // Refused here where it is too large, before it is written out.
                self.parts(Ty::Handle(ty))?;
                let mut all = Vec::new();
                for component in components {
                    all.extend(self.global_constant(*component)?);
                }
                all
            }
            Expression::Splat { size, value } => {
                let value = self.global_constant(value)?;
                value.repeat(size as usize)
            }
            ref other => return self.build.refuse(format!("the constant {other:?}")),
        })
    }

    fn compute(&mut self, call: &mut Call<'a>, handle: Handle<Expression>) -> Result<Value> {
        let regs = |regs: Vec<Reg>| Ok(Value::Regs(Rc::new(regs)));
        match call.function.expressions[handle] {
            Expression::Literal(literal) => regs(vec![self.literal(literal)?]),
            Expression::Constant(constant) => {
                regs(self.global_constant(self.module.constants[constant].init)?)
            }
            Expression::ZeroValue(ty) => {
                let parts = self.parts(Ty::Handle(ty))?;
                regs(self.zeros(&parts.banks))
            }
            Expression::Compose { ty, ref components } => {
                self.parts(Ty::Handle(ty))?;
                let mut all = Vec::new();
                for component in components {
                    all.extend(self.regs(call, *component)?.iter());
                }
                regs(all)
            }
            Expression::Splat { size, value } => {
                let value = self.one(call, value)?;
                regs(vec![value; size as usize])
            }
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.regs(call, vector)?;
                let picked = &pattern[..size as usize];
                regs(picked.iter().map(|component| vector[*component as usize]).collect())
            }
            Expression::FunctionArgument(index) => Ok(call.arguments[index as usize].clone()),
            Expression::LocalVariable(local) => Ok(Value::Place(call.locals[&local].clone())),
            Expression::GlobalVariable(global) => Ok(Value::Place(self.global(global)?)),
            Expression::AccessIndex { base, index } => match self.value(call, base)? {
                Value::Place(place) => Ok(Value::Place(self.part(place, index)?)),
                Value::Regs(values) => {
                    let ty = self.type_of(call, base)?;
                    let child = self.shapes.child(ty, index);
                    let (first, _, child) = child.or_else(|reason| self.build.refuse(reason))?;
                    let count = self.parts(child)?.banks.len();
                    let first = first as usize;
                    regs(values[first..first + count].to_vec())
                }
            },
            Expression::Access { base, index } => {
                let index = self.one(call, index)?;
                match self.value(call, base)? {
                    Value::Place(place) => Ok(Value::Place(self.part_at(place, index)?)),
                    Value::Regs(values) => {
                        let ty = self.type_of(call, base)?;
                        regs(self.element(ty, &values, index)?)
                    }
                }
            }
            Expression::Load { pointer } => {
                let place = self.place(call, pointer)?;
                regs(self.load(&place)?)
            }
            Expression::ImageLoad { image, coordinate, array_index: None, sample: None, level } => {
                let Place::Texture(texture) = self.place(call, image)? else {
                    return self.build.refuse("a texture by another name");
                };
                // One level is all there is; any other one is clamped to it.
                if let Some(level) = level {
                    self.one(call, level)?;
                }
                let bank = match self.kind(call, handle)? {
                    ScalarKind::Float => Bank::Float,
                    _ => Bank::Word,
                };
                let at = self.regs(call, coordinate)?;
                let (texel, counted) = match self.build.cut_from(at[0], at[1]) {
                    Some((number, bits)) => (number, Texels::InRows(bits)),
                    None => {
                        let texel = self.build.emit(Op::Texel, [at[0], at[1], NONE], 0, texture);
                        (texel, Texels::AsTheyLie)
                    }
                };
                let fetch = |component| {
                    let op = Op::Fetch(bank, counted);
                    self.build.emit(op, [texel, NONE, NONE], component, texture)
                };
                regs((0..4).map(fetch).collect())
            }
            Expression::ImageQuery { image, query } => {
                let Place::Texture(texture) = self.place(call, image)? else {
                    return self.build.refuse("a texture by another name");
                };
                match query {
                    ImageQuery::Size { level } => {
                        if let Some(level) = level {
                            self.one(call, level)?;
                        }
                        let side =
                            |axis| self.build.emit(Op::TextureSize, [NONE; 3], axis, texture);
                        regs((0..2).map(side).collect())
                    }
                    ImageQuery::NumLevels => regs(vec![self.build.word(1)]),
                    _ => self.build.refuse("this question to a texture"),
                }
            }
            Expression::Unary { op, expr } => {
                let kind = self.kind(call, expr)?;
                let values = self.regs(call, expr)?;
                let op = match (op, kind) {
                    (UnaryOperator::Negate, ScalarKind::Float) => Op::F1(F1::Neg),
                    (UnaryOperator::Negate, _) => {
                        let zero = self.build.word(0);
                        let each = |value: &Reg| self.build.u2(U2::Sub, zero, *value);
                        return regs(values.iter().map(each).collect());
                    }
                    _ => Op::U1(U1::Not),
                };
                regs(values.iter().map(|value| self.build.unary(op, *value)).collect())
            }
            Expression::Binary { op, left, right } => {
                let types = [self.inner(call, left), self.inner(call, right)];
                let kind = self.kind(call, left)?;
                let (left, right) = (self.regs(call, left)?, self.regs(call, right)?);
                regs(self.operate(op, kind, types, &left, &right)?)
            }
            Expression::Select { condition, accept, reject } => {
                let condition = self.regs(call, condition)?;
                let (accept, reject) = (self.regs(call, accept)?, self.regs(call, reject)?);
                let each = |index: usize| {
                    let mask = condition[index % condition.len()];
                    self.build.select(mask, accept[index], reject[index])
                };
                regs((0..accept.len()).map(each).collect())
            }
            Expression::Relational { fun, argument } => {
                let values = self.regs(call, argument)?;
                let op = match fun {
                    RelationalFunction::All => U2::And,
                    RelationalFunction::Any => U2::Or,
                    _ => return self.build.refuse("isNan and isInf"),
                };
                let mut all = values[0];
                for value in &values[1..] {
                    all = self.build.u2(op, all, *value);
                }
                regs(vec![all])
            }
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                let kind = self.kind(call, arg)?;
                let ty = self.inner(call, arg);
                let mut arguments = vec![self.regs(call, arg)?];
                for more in [arg1, arg2, arg3].into_iter().flatten() {
                    arguments.push(self.regs(call, more)?);
                }
                regs(self.math(fun, kind, ty, &arguments)?)
            }
            Expression::As { expr, kind: to, convert } => {
                let from = self.kind(call, expr)?;
                let values = self.regs(call, expr)?;
                if convert.is_some_and(|width| width != 4 && to != ScalarKind::Bool) {
                    return self.build.refuse("conversions to other than 32 bits");
                }
                let each = |value: &Reg| match convert {
                    Some(_) => self.convert(from, to, *value),
                    None => self.bitcast(from, to, *value),
                };
                regs(values.iter().map(each).collect())
            }
            Expression::ArrayLength(pointer) => {
                let place = self.place(call, pointer)?;
                regs(vec![self.array_length(&place)?])
            }
            Expression::CallResult(_) | Expression::AtomicResult { .. } => {
                self.build.refuse("a result before its call")
            }
            Expression::ImageSample { .. } | Expression::ImageLoad { .. } => self
                .build
                .refuse("textures other than by textureLoad from texture_2d<f32> or <u32>"),
            Expression::Derivative { .. } => self.build.refuse("derivatives"),
            Expression::Override(_) => self.build.refuse("overrides"),
            _ => self.build.refuse("expressions of workgroups, subgroups and rays"),
        }
    }

    fn type_of(&self, call: &Call<'a>, handle: Handle<Expression>) -> Result<Ty> {
        use naga::proc::TypeResolution;
        match call.info[handle].ty {
            TypeResolution::Handle(ty) => Ok(Ty::Handle(ty)),
            TypeResolution::Value(TypeInner::Vector { size, scalar }) => {
                Ok(Ty::Vector(size, scalar))
            }
            TypeResolution::Value(TypeInner::Matrix { columns, rows, scalar }) => {
                Ok(Ty::Matrix(columns, rows, scalar))
            }
            TypeResolution::Value(TypeInner::Scalar(scalar)) => Ok(Ty::Scalar(scalar)),
            TypeResolution::Value(_) => self.build.refuse("an index into this value"),
        }
    }

    fn kind(&self, call: &Call<'a>, handle: Handle<Expression>) -> Result<ScalarKind> {
        match scalar_of(self.inner(call, handle)) {
            Some(scalar) if scalar.width == 4 || scalar.kind == ScalarKind::Bool => Ok(scalar.kind),
            Some(scalar) => {
                self.build.refuse(format!("scalars of {} bits", u32::from(scalar.width) * 8))
            }
            None => self.build.refuse("this operation on structs or arrays"),
        }
    }

    /// The child of a value at an index that is known when the program runs; it is clamped.
    fn element(&mut self, ty: Ty, values: &[Reg], index: Reg) -> Result<Vec<Reg>> {
        let step = self.shapes.step(ty).or_else(|reason| self.build.refuse(reason))?;
        let (count, size) = (step.count.unwrap_or(1), step.components as usize);
        let last = self.build.word(count.saturating_sub(1));
        let index = self.build.u2(U2::MinU, index, last);
        let mut picked = Vec::with_capacity(size);
        for component in 0..size {
            let column: Vec<Reg> =
                (0..count as usize).map(|child| values[child * size + component]).collect();
            picked.push(self.pick(&column, index));
        }
        Ok(picked)
    }

    /// One of several registers: from a table where all are constants, else by selects.
    fn pick(&mut self, column: &[Reg], index: Reg) -> Reg {
        let constants: Option<Vec<u32>> =
            column.iter().map(|reg| self.build.constant_value(*reg)).collect();
        if let Some(constants) = constants.filter(|constants| constants.len() > 4) {
            let bank = self.build.info(column[0]).bank;
            let table = self.build.table(bank, constants);
            return self.build.emit(Op::Table(bank), [index, NONE, NONE], table, 0);
        }
        let mut picked = column[0];
        for (child, reg) in column.iter().enumerate().skip(1) {
            let child = self.build.word(child as u32);
            let mask = self.build.u2(U2::Equal, index, child);
            picked = self.build.select(mask, *reg, picked);
        }
        picked
    }
}
