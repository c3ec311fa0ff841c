//! Kernels that take words apart: numbers that lie beside others in one, and words that are turned. What several
//! instructions did was joined (`fuse.rs`).

#![allow(clippy::needless_range_loop, reason = "as in apply.rs")]

use std::marker::PhantomData;

use pulp::NullaryFnOnce;

use super::Kernel;
use super::apply::{All, Apply1, Apply2, map2};
use super::isa::Isa;
use super::scalar::Scalar;
use crate::op::{Bank, Inst};

/// A number that lies in a word beside others, as a word or as a float.
pub(super) fn field<S: Scalar, A: Isa>(bank: Bank) -> Kernel<S, A> {
    match bank {
        Bank::Float => |isa, frame, inst, _| {
            let (target, words) = (frame.floats.slot_mut(inst.d), frame.words.slot(inst.a));
            isa.run(Field::<AsFloat, S>(target, words, inst, PhantomData));
        },
        Bank::Word => |isa, frame, inst, _| {
            let (target, [words]) = frame.words.split(inst.d, [inst.a]);
            isa.run(Field::<AsWord, u32>(target, words, inst, PhantomData));
        },
    }
}

struct Field<'a, O, Y>(&'a mut [Y], &'a [u32], &'a Inst, PhantomData<O>);

impl<O: Apply1<u32, Y>, Y> NullaryFnOnce for Field<'_, O, Y> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.0.len();
        let (words, by, mask) = (&self.1[..lanes], self.2.imm, self.2.extra);
        for lane in 0..lanes {
            self.0[lane] = O::at(words[lane].wrapping_shr(by) & mask);
        }
    }
}

struct AsFloat;

impl<S: Scalar> Apply1<u32, S> for AsFloat {
    #[inline(always)]
    fn at(word: u32) -> S {
        S::from_u32(word)
    }
}

struct AsWord;

impl Apply1<u32, u32> for AsWord {
    #[inline(always)]
    fn at(word: u32) -> u32 {
        word
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
