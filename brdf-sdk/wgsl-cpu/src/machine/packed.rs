//! Kernels that take words apart: numbers that lie beside others in one, and words that are turned. What several
//! instructions did was joined (`fuse.rs`).

#![allow(clippy::needless_range_loop, reason = "as in apply.rs")]

use pulp::NullaryFnOnce;

use super::Kernel;
use super::apply::{All, Apply2, map2};
use super::isa::Isa;
use super::scalar::Scalar;
use crate::op::Bank;

/// A number that lies in a word beside others, as a word or as a float.
pub(super) fn field<S: Scalar, A: Isa>(bank: Bank) -> Kernel<S, A> {
    match bank {
        Bank::Float => |isa, frame, inst, _| {
            let (target, words) = (frame.floats.slot_mut(inst.d), frame.words.slot(inst.a));
            isa.run(Floats { target, words, by: inst.imm, mask: inst.extra });
        },
        Bank::Word => |isa, frame, inst, _| {
            let (target, [words]) = frame.words.split(inst.d, [inst.a]);
            isa.run(Words { target, words, by: inst.imm, mask: inst.extra });
        },
    }
}

struct Floats<'a, S> {
    target: &'a mut [S],
    words: &'a [u32],
    by: u32,
    mask: u32,
}

impl<S: Scalar> NullaryFnOnce for Floats<'_, S> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.target.len();
        let words = &self.words[..lanes];
        for lane in 0..lanes {
            self.target[lane] = S::from_u32(words[lane].wrapping_shr(self.by) & self.mask);
        }
    }
}

struct Words<'a> {
    target: &'a mut [u32],
    words: &'a [u32],
    by: u32,
    mask: u32,
}

impl NullaryFnOnce for Words<'_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.target.len();
        let words = &self.words[..lanes];
        for lane in 0..lanes {
            self.target[lane] = words[lane].wrapping_shr(self.by) & self.mask;
        }
    }
}

/// A word turned by constant bits.
pub(super) fn turn<S: Scalar, A: Isa>() -> Kernel<S, A> {
    |isa, frame, inst, _| {
        let (target, [words]) = frame.words.split(inst.d, [inst.a]);
        map2::<A, Turn, u32, u32, _, _>(isa, target, words, All(inst.imm));
    }
}

struct Turn;

impl Apply2<u32, u32> for Turn {
    #[inline(always)]
    fn at(word: u32, by: u32) -> u32 {
        word.rotate_left(by)
    }
}
