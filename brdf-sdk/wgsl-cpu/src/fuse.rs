//! What one instruction alone reads becomes part of it: a product of a sum, the shift and the mask of a number that
//! lies in a word beside others, the shifts that turn a word.
//!
//! An instruction has a price of its own, and its result goes to memory and back.

use crate::lower::RegInfo;
use crate::op::{Bank, F2, F3, FromWord, Inst, NONE, Op, Reg, U2};

/// Instructions that are being joined.
pub(crate) struct Fusion<'a> {
    code: &'a mut [Inst],
    regs: &'a [RegInfo],
    /// Of each instruction the run that it belongs to: what lies between two may be passed over or repeated.
    runs: &'a [u32],
    /// How often each register is read, and which instruction writes it.
    uses: Vec<u32>,
    writer: Vec<Option<usize>>,
}

impl<'a> Fusion<'a> {
    /// `tests` are the registers that control reads.
    pub(crate) fn new(
        code: &'a mut [Inst],
        regs: &'a [RegInfo],
        runs: &'a [u32],
        tests: impl Iterator<Item = Reg>,
    ) -> Self {
        let mut uses = vec![0; regs.len()];
        let mut writer = vec![None; regs.len()];
        for (at, inst) in code.iter().enumerate() {
            for reg in inst.reads() {
                uses[reg as usize] += 1;
            }
            for reg in inst.writes() {
                writer[reg as usize] = Some(at);
            }
        }
        for reg in tests {
            uses[reg as usize] += 1;
        }
        Self { code, regs, runs, uses, writer }
    }

    /// Joins what comes from instruction `first` on, and says which instructions are of no use any more.
    pub(crate) fn run(self, first: usize) -> Vec<bool> {
        let mut dead = vec![false; self.code.len()];
        for at in first..self.code.len() {
            let joined = match self.code[at].op {
                Op::F2(F2::Add | F2::Sub) => self.sum_of_product(at),
                Op::U2(U2::And) => self.shifted_field(at),
                Op::U2(U2::Or) => self.turned(at),
                Op::FromWord(FromWord::U32) => self.float_of_field(at),
                _ => None,
            };
            if let Some((inst, from)) = joined
                && !self.is_uniform(inst.d)
            {
                self.code[at] = inst;
                from.into_iter().for_each(|from| dead[from] = true);
            }
        }
        dead
    }

    /// A sum with a product of its own. Both roundings stay.
    fn sum_of_product(&self, at: usize) -> Option<(Inst, Vec<usize>)> {
        let sum = self.code[at];
        for (factor, other, first) in [(sum.a, sum.b, true), (sum.b, sum.a, false)] {
            if factor == other || self.is_uniform(factor) {
                continue;
            }
            let Some(from) = self.maker(factor, at) else { continue };
            let product = self.code[from];
            // A mutable factor could be written in between.
            if product.op != Op::F2(F2::Mul) || product.reads().any(|reg| self.is_mutable(reg)) {
                continue;
            }
            let op = match (sum.op, first) {
                (Op::F2(F2::Add), _) => F3::MulAdd,
                (_, true) => F3::MulSub,
                (_, false) => F3::SubMul,
            };
            let [a, b] = match self.is_uniform(product.a) {
                true => [product.b, product.a],
                false => [product.a, product.b],
            };
            return Some((Inst { op: Op::F3(op), a, b, c: other, ..sum }, vec![from]));
        }
        None
    }

    /// A constant mask with the shift, by a constant, of what it is laid over.
    fn shifted_field(&self, at: usize) -> Option<(Inst, Vec<usize>)> {
        let (word, mask) = self.masked(at)?;
        let from = self.maker(word, at)?;
        let shift = self.code[from];
        if shift.op != Op::U2(U2::ShiftRightU) || !self.is_lasting(shift.a) {
            return None;
        }
        let by = self.constant(shift.b).filter(|by| *by < 32)?;
        let op = Op::Field(Bank::Word);
        Some((Inst { op, a: shift.a, b: NONE, imm: by, extra: mask, ..self.code[at] }, vec![from]))
    }

    /// Two shifts of one word that together turn it.
    fn turned(&self, at: usize) -> Option<(Inst, Vec<usize>)> {
        let Inst { a, b, .. } = self.code[at];
        let from = [self.maker(a, at)?, self.maker(b, at)?];
        let [x, y] = from.map(|from| self.code[from]);
        let (left, right) = match (x.op, y.op) {
            (Op::U2(U2::ShiftLeft), Op::U2(U2::ShiftRightU)) => (x, y),
            (Op::U2(U2::ShiftRightU), Op::U2(U2::ShiftLeft)) => (y, x),
            _ => return None,
        };
        let (up, down) = (self.constant(left.b)?, self.constant(right.b)?);
        let fits = up < 32 && up + down == 32 && left.a == right.a && self.is_lasting(left.a);
        let inst = Inst { op: Op::Turn, a: left.a, b: NONE, imm: up, ..self.code[at] };
        fits.then_some((inst, from.to_vec()))
    }

    /// A conversion to a float with the field that it converts.
    fn float_of_field(&self, at: usize) -> Option<(Inst, Vec<usize>)> {
        let from = self.maker(self.code[at].a, at)?;
        let field = self.code[from];
        let (a, by, mask) = match field.op {
            Op::Field(Bank::Word) => (field.a, field.imm, field.extra),
            Op::U2(U2::And) => {
                let (word, mask) = self.masked(from).filter(|(word, _)| self.is_lasting(*word))?;
                (word, 0, mask)
            }
            _ => return None,
        };
        let op = Op::Field(Bank::Float);
        Some((Inst { op, a, imm: by, extra: mask, ..self.code[at] }, vec![from]))
    }

    /// The instruction that makes a register which instruction `at` alone reads, in the same run.
    fn maker(&self, reg: Reg, at: usize) -> Option<usize> {
        let from = self.writer[reg as usize]?;
        let alone = self.uses[reg as usize] == 1 && !self.is_mutable(reg);
        (alone && self.runs[from] == self.runs[at]).then_some(from)
    }

    /// What a constant mask is laid over, and the mask.
    fn masked(&self, at: usize) -> Option<(Reg, u32)> {
        let Inst { a, b, .. } = self.code[at];
        self.constant(b).map(|mask| (a, mask)).or_else(|| self.constant(a).map(|mask| (b, mask)))
    }

    fn constant(&self, reg: Reg) -> Option<u32> {
        let made = self.code[self.writer[reg as usize]?];
        (made.op == Op::Constant(Bank::Word) && !self.is_mutable(reg)).then_some(made.imm)
    }

    /// Whether a register differs between lanes, and is the same for as long as it is needed.
    fn is_lasting(&self, reg: Reg) -> bool {
        !self.is_uniform(reg) && !self.is_mutable(reg)
    }

    fn is_uniform(&self, reg: Reg) -> bool {
        self.regs[reg as usize].uniform
    }

    fn is_mutable(&self, reg: Reg) -> bool {
        self.regs[reg as usize].mutable
    }
}
