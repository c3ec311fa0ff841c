//! The builtin functions on integers and their bits.
//!
//! Those without an instruction of their own are written as several. Packing is `packing.rs`'s.

use naga::MathFunction;

use super::{Lowering, Result};
use crate::op::{Op, Reg, U1, U2};

impl Lowering<'_> {
    pub(super) fn integer_math(
        &mut self,
        fun: MathFunction,
        signed: bool,
        x: &[Reg],
    ) -> Result<Reg> {
        use MathFunction as M;
        let a = x[0];
        let (least, most) = if signed { (U2::MinI, U2::MaxI) } else { (U2::MinU, U2::MaxU) };
        Ok(match fun {
            M::Abs if signed => self.build.unary(Op::U1(U1::AbsI), a),
            M::Abs => a,
            M::Min => self.build.u2(least, a, x[1]),
            M::Max => self.build.u2(most, a, x[1]),
            M::Clamp => {
                let above = self.build.u2(most, a, x[1]);
                self.build.u2(least, above, x[2])
            }
            M::Sign => {
                let (one, minus) = (self.build.word(1), self.build.word(!0));
                let above = self.build.u2(U2::MaxI, a, minus);
                self.build.u2(U2::MinI, above, one)
            }
            M::CountTrailingZeros => self.build.unary(Op::U1(U1::TrailingZeros), a),
            M::CountLeadingZeros => self.build.unary(Op::U1(U1::LeadingZeros), a),
            M::CountOneBits => self.build.unary(Op::U1(U1::CountOneBits), a),
            M::ReverseBits => self.build.unary(Op::U1(U1::ReverseBits), a),
            M::FirstTrailingBit => {
                // 32 zeros stand for no bit at all, which is -1.
                let zeros = self.build.unary(Op::U1(U1::TrailingZeros), a);
                self.none_at_zero(a, zeros)
            }
            M::FirstLeadingBit => {
                // The first bit that differs from the sign.
                let bits = if signed {
                    let sign = self.build.word(31);
                    let sign = self.build.u2(U2::ShiftRightI, a, sign);
                    self.build.u2(U2::Xor, a, sign)
                } else {
                    a
                };
                let zeros = self.build.unary(Op::U1(U1::LeadingZeros), bits);
                let last = self.build.word(31);
                let position = self.build.u2(U2::Sub, last, zeros);
                self.none_at_zero(bits, position)
            }
            M::ExtractBits => self.extract_bits(signed, a, x[1], x[2]),
            M::InsertBits => {
                let (offset, count) = self.clamped_bits(x[2], x[3]);
                let mask = self.low_bits(count);
                let mask = self.shift_left_full(mask, offset);
                let inserted = self.shift_left_full(x[1], offset);
                let inserted = self.build.u2(U2::And, inserted, mask);
                let kept = self.build.u2(U2::AndNot, a, mask);
                self.build.u2(U2::Or, kept, inserted)
            }
            other => return self.build.refuse(format!("the builtin function {other:?}")),
        })
    }

    fn none_at_zero(&mut self, bits: Reg, position: Reg) -> Reg {
        let (zero, none) = (self.build.word(0), self.build.word(!0));
        let empty = self.build.u2(U2::Equal, bits, zero);
        self.build.select(empty, none, position)
    }

    /// offset = min(offset, 32), count = min(count, 32 - offset).
    fn clamped_bits(&mut self, offset: Reg, count: Reg) -> (Reg, Reg) {
        let width = self.build.word(32);
        let offset = self.build.u2(U2::MinU, offset, width);
        let rest = self.build.u2(U2::Sub, width, offset);
        let count = self.build.u2(U2::MinU, count, rest);
        (offset, count)
    }

    /// 2^count - 1, count from 0 to 32.
    fn low_bits(&mut self, count: Reg) -> Reg {
        let (all, width) = (self.build.word(!0), self.build.word(32));
        let shift = self.build.u2(U2::Sub, width, count);
        let mask = self.build.u2(U2::ShiftRightU, all, shift);
        let zero = self.build.word(0);
        let none = self.build.u2(U2::Equal, count, zero);
        self.build.select(none, zero, mask)
    }

    /// A shift by 0 to 32.
    fn shift_left_full(&mut self, value: Reg, by: Reg) -> Reg {
        let (zero, width) = (self.build.word(0), self.build.word(32));
        let shifted = self.build.u2(U2::ShiftLeft, value, by);
        let out = self.build.u2(U2::LessEqualU, width, by);
        self.build.select(out, zero, shifted)
    }

    fn extract_bits(&mut self, signed: bool, a: Reg, offset: Reg, count: Reg) -> Reg {
        let (offset, count) = self.clamped_bits(offset, count);
        // Up to the top, and down again: a shift by 32 only where nothing is left.
        let width = self.build.word(32);
        let end = self.build.u2(U2::Add, offset, count);
        let up = self.build.u2(U2::Sub, width, end);
        let top = self.build.u2(U2::ShiftLeft, a, up);
        let down = self.build.u2(U2::Sub, width, count);
        let shift = if signed { U2::ShiftRightI } else { U2::ShiftRightU };
        let bits = self.build.u2(shift, top, down);
        let zero = self.build.word(0);
        let none = self.build.u2(U2::Equal, count, zero);
        self.build.select(none, zero, bits)
    }
}
