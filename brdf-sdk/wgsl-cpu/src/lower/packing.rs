//! WGSL's packing functions: several small numbers in one word.
//!
//! By shifts, masks and conversions: no instruction is theirs alone.

use naga::MathFunction;

use super::{Lowering, Result};
use crate::op::{F1, F2, FromWord, Op, Reg, ToWord, U2};

/// How one packed number looks.
struct Field {
    bits: u32,
    signed: bool,
    content: Content,
}

enum Content {
    /// A fraction of the largest value.
    Normalised,
    Half,
    Integer {
        clamped: bool,
    },
}

fn field(fun: MathFunction) -> Option<(bool, Field)> {
    use Content::{Half, Integer, Normalised};
    use MathFunction as M;
    let of = |pack, bits, signed, content| Some((pack, Field { bits, signed, content }));
    match fun {
        M::Pack4x8snorm => of(true, 8, true, Normalised),
        M::Pack4x8unorm => of(true, 8, false, Normalised),
        M::Pack2x16snorm => of(true, 16, true, Normalised),
        M::Pack2x16unorm => of(true, 16, false, Normalised),
        M::Pack2x16float => of(true, 16, false, Half),
        M::Pack4xI8 => of(true, 8, true, Integer { clamped: false }),
        M::Pack4xU8 => of(true, 8, false, Integer { clamped: false }),
        M::Pack4xI8Clamp => of(true, 8, true, Integer { clamped: true }),
        M::Pack4xU8Clamp => of(true, 8, false, Integer { clamped: true }),
        M::Unpack4x8snorm => of(false, 8, true, Normalised),
        M::Unpack4x8unorm => of(false, 8, false, Normalised),
        M::Unpack2x16snorm => of(false, 16, true, Normalised),
        M::Unpack2x16unorm => of(false, 16, false, Normalised),
        M::Unpack2x16float => of(false, 16, false, Half),
        M::Unpack4xI8 => of(false, 8, true, Integer { clamped: false }),
        M::Unpack4xU8 => of(false, 8, false, Integer { clamped: false }),
        _ => None,
    }
}

pub(super) fn is_packing(fun: MathFunction) -> bool {
    field(fun).is_some()
}

impl Field {
    /// The largest value of the integer.
    fn top(&self) -> u32 {
        (1 << (self.bits - u32::from(self.signed))) - 1
    }
}

impl Lowering<'_> {
    pub(super) fn packing(&mut self, fun: MathFunction, x: &[Reg]) -> Result<Vec<Reg>> {
        let Some((packs, field)) = field(fun) else {
            return self.build.refuse(format!("the builtin function {fun:?}"));
        };
        let count = 32 / field.bits;
        if !packs {
            return Ok((0..count).map(|index| self.unpack(&field, x[0], index)).collect());
        }
        let mut packed = self.build.word(0);
        for (index, value) in (0..count).zip(x) {
            let bits = self.pack(&field, *value);
            let mask = self.build.word(!0 >> (32 - field.bits));
            let bits = self.build.u2(U2::And, bits, mask);
            let shift = self.build.word(index * field.bits);
            let bits = self.build.u2(U2::ShiftLeft, bits, shift);
            packed = self.build.u2(U2::Or, packed, bits);
        }
        Ok(vec![packed])
    }

    fn pack(&mut self, field: &Field, value: Reg) -> Reg {
        match field.content {
            Content::Half => self.build.unary(Op::ToWord(ToWord::Half), value),
            Content::Normalised => {
                // floor(0.5 + top x clamp(e)): the specification's own rounding.
                let least = self.build.float(if field.signed { -1.0 } else { 0.0 });
                let (one, half) = (self.build.float(1.0), self.build.float(0.5));
                let top = self.build.float(field.top() as f32);
                let value = self.f2(F2::Max, value, least);
                let value = self.f2(F2::Min, value, one);
                let scaled = self.f2(F2::Mul, top, value);
                let shifted = self.f2(F2::Add, half, scaled);
                let whole = self.build.unary(Op::F1(F1::Floor), shifted);
                self.build.unary(Op::ToWord(ToWord::I32), whole)
            }
            Content::Integer { clamped: false } => value,
            Content::Integer { clamped: true } => {
                let (least, most) =
                    if field.signed { (U2::MinI, U2::MaxI) } else { (U2::MinU, U2::MaxU) };
                let top = self.build.word(field.top());
                let bottom = self.build.word(if field.signed { !field.top() } else { 0 });
                let value = self.build.u2(most, value, bottom);
                self.build.u2(least, value, top)
            }
        }
    }

    fn unpack(&mut self, field: &Field, word: Reg, index: u32) -> Reg {
        let up = self.build.word(32 - (index + 1) * field.bits);
        let down = self.build.word(32 - field.bits);
        let top = self.build.u2(U2::ShiftLeft, word, up);
        let shift = if field.signed { U2::ShiftRightI } else { U2::ShiftRightU };
        let bits = self.build.u2(shift, top, down);
        match field.content {
            Content::Half => self.build.unary(Op::FromWord(FromWord::Half), bits),
            Content::Integer { .. } => bits,
            Content::Normalised => {
                let from = if field.signed { FromWord::I32 } else { FromWord::U32 };
                let value = self.build.unary(Op::FromWord(from), bits);
                let top = self.build.float(field.top() as f32);
                let value = self.f2(F2::Div, value, top);
                if !field.signed {
                    return value;
                }
                let least = self.build.float(-1.0);
                self.f2(F2::Max, value, least)
            }
        }
    }

    /// The sum of the products of four bytes each.
    pub(super) fn dot_packed(&mut self, fun: MathFunction, a: Reg, b: Reg) -> Reg {
        let signed = fun == MathFunction::Dot4I8Packed;
        let bytes = Field { bits: 8, signed, content: Content::Integer { clamped: false } };
        let mut sum = self.build.word(0);
        for index in 0..4 {
            let (x, y) = (self.unpack(&bytes, a, index), self.unpack(&bytes, b, index));
            let product = self.build.u2(U2::Mul, x, y);
            sum = self.build.u2(U2::Add, sum, product);
        }
        sum
    }
}
