//! Operators, and conversions from one type to another.
//!
//! One component at a time. What division by zero and values out of range give is in the instruction
//! (`machine/functions.rs`).

use naga::{BinaryOperator, ScalarKind, TypeInner};

use super::function::turned;
use super::{Lowering, Result};
use crate::op::{Compare, F1, F2, FromWord, Op, Reg, ToWord, U2};

impl Lowering<'_> {
    pub(super) fn operate(
        &mut self,
        op: BinaryOperator,
        kind: ScalarKind,
        [left_type, right_type]: [&TypeInner; 2],
        left: &[Reg],
        right: &[Reg],
    ) -> Result<Vec<Reg>> {
        if op == BinaryOperator::Multiply
            && let Some(product) = self.matrix_product(left_type, right_type, left, right)
        {
            return Ok(product);
        }
        if let Some(op) = turned(op) {
            return self.operate(op, kind, [right_type, left_type], right, left);
        }
        let count = left.len().max(right.len());
        let mut values = Vec::with_capacity(count);
        for index in 0..count {
            let (a, b) = (left[index % left.len()], right[index % right.len()]);
            values.push(self.operate_one(op, kind, a, b)?);
        }
        Ok(values)
    }

    fn operate_one(&mut self, op: BinaryOperator, kind: ScalarKind, a: Reg, b: Reg) -> Result<Reg> {
        use BinaryOperator as B;
        let signed = kind == ScalarKind::Sint;
        let either = |of_signed, of_unsigned| if signed { of_signed } else { of_unsigned };
        if kind == ScalarKind::Float {
            let op = match op {
                B::Add => Op::F2(F2::Add),
                B::Subtract => Op::F2(F2::Sub),
                B::Multiply => Op::F2(F2::Mul),
                B::Divide => Op::F2(F2::Div),
                B::Modulo => return Ok(self.remainder(a, b)),
                B::Equal => Op::Compare(Compare::Equal),
                B::NotEqual => Op::Compare(Compare::NotEqual),
                B::Less => Op::Compare(Compare::Less),
                B::LessEqual => Op::Compare(Compare::LessEqual),
                _ => return self.build.refuse("this operator on floats"),
            };
            return Ok(self.build.binary(op, a, b));
        }
        let op = match op {
            B::Add => U2::Add,
            B::Subtract => U2::Sub,
            B::Multiply => U2::Mul,
            B::Divide => either(U2::DivI, U2::DivU),
            B::Modulo => either(U2::RemI, U2::RemU),
            B::Equal => U2::Equal,
            B::NotEqual => U2::NotEqual,
            B::Less => either(U2::LessI, U2::LessU),
            B::LessEqual => either(U2::LessEqualI, U2::LessEqualU),
            B::And | B::LogicalAnd => U2::And,
            B::InclusiveOr | B::LogicalOr => U2::Or,
            B::ExclusiveOr => U2::Xor,
            B::ShiftLeft => U2::ShiftLeft,
            B::ShiftRight => either(U2::ShiftRightI, U2::ShiftRightU),
            B::Greater | B::GreaterEqual => return self.build.refuse("this comparison"),
        };
        Ok(self.build.u2(op, a, b))
    }

    /// a - b trunc(a / b), WGSL's definition.
    fn remainder(&mut self, a: Reg, b: Reg) -> Reg {
        let quotient = self.build.binary(Op::F2(F2::Div), a, b);
        let whole = self.build.unary(Op::F1(F1::Trunc), quotient);
        let product = self.build.binary(Op::F2(F2::Mul), b, whole);
        self.build.binary(Op::F2(F2::Sub), a, product)
    }

    /// Conversion by value.
    pub(super) fn convert(&mut self, from: ScalarKind, to: ScalarKind, value: Reg) -> Reg {
        use ScalarKind::{Bool, Float, Sint, Uint};
        let op = match (from, to) {
            (Float, Sint) => Op::ToWord(ToWord::I32),
            (Float, Uint) => Op::ToWord(ToWord::U32),
            (Sint, Float) => Op::FromWord(FromWord::I32),
            (Uint, Float) => Op::FromWord(FromWord::U32),
            (Float, Bool) => {
                let zero = self.build.float(0.0);
                return self.build.binary(Op::Compare(Compare::NotEqual), value, zero);
            }
            (Sint | Uint, Bool) => {
                let zero = self.build.word(0);
                return self.build.u2(U2::NotEqual, value, zero);
            }
            (Bool, Float) => {
                let (zero, one) = (self.build.float(0.0), self.build.float(1.0));
                return self.build.select(value, one, zero);
            }
            (Bool, Sint | Uint) => {
                let one = self.build.word(1);
                return self.build.u2(U2::And, value, one);
            }
            _ => return value,
        };
        self.build.unary(op, value)
    }

    pub(super) fn bitcast(&mut self, from: ScalarKind, to: ScalarKind, value: Reg) -> Reg {
        match (from == ScalarKind::Float, to == ScalarKind::Float) {
            (true, false) => self.build.unary(Op::ToWord(ToWord::Bits), value),
            (false, true) => self.build.unary(Op::FromWord(FromWord::Bits), value),
            _ => value,
        }
    }
}
