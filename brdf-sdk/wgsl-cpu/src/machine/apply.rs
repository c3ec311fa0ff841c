//! One function over many lanes: loops that the compiler turns into vectors, once for each
//! instruction set.
//!
//! They are written by index over slices of one length: an iterator with a bounds check in it makes
//! the compiler leave the last vectors of every loop to scalar code, which costs a factor of three.

#![allow(clippy::needless_range_loop, reason = "see above")]

use std::hint::select_unpredictable;
use std::marker::PhantomData;

use pulp::NullaryFnOnce;

use super::isa::Isa;

/// A function of one operand.
pub(super) trait Apply1<X: Copy, Y> {
    fn at(x: X) -> Y;

    /// Whether `at` is right for this operand; for others it gives anything, but does not panic.
    #[inline(always)]
    fn fits(_x: X) -> bool {
        true
    }

    /// Right for every operand, and slower.
    #[inline(always)]
    fn once(x: X) -> Y {
        Self::at(x)
    }

    #[inline(always)]
    fn map(target: &mut [Y], x: &[X]) {
        let lanes = target.len();
        let x = &x[..lanes];
        let mut fit = true;
        for lane in 0..lanes {
            fit &= Self::fits(x[lane]);
            target[lane] = Self::at(x[lane]);
        }
        if !fit {
            for lane in 0..lanes {
                target[lane] = Self::once(x[lane]);
            }
        }
    }
}

/// A function of two operands.
pub(super) trait Apply2<X, Y> {
    fn at(a: X, b: X) -> Y;
}

/// A function of three operands.
pub(super) trait Apply3<X, Y> {
    fn at(a: X, b: X, c: X) -> Y;
}

/// An operand: a slot, or a uniform value.
pub(super) trait Operand<X>: Copy {
    fn cut(self, lanes: usize) -> Self;
    fn lane(self, lane: usize) -> X;
}

impl<X: Copy> Operand<X> for &[X] {
    #[inline(always)]
    fn cut(self, lanes: usize) -> Self {
        &self[..lanes]
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> X {
        self[lane]
    }
}

/// The same value in all lanes.
#[derive(Clone, Copy)]
pub(super) struct All<X>(pub X);

impl<X: Copy> Operand<X> for All<X> {
    #[inline(always)]
    fn cut(self, _lanes: usize) -> Self {
        self
    }
    #[inline(always)]
    fn lane(self, _lane: usize) -> X {
        self.0
    }
}

struct Map1<'a, O, X, Y>(&'a mut [Y], &'a [X], PhantomData<O>);

impl<X: Copy, Y, O: Apply1<X, Y>> NullaryFnOnce for Map1<'_, O, X, Y> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        O::map(self.0, self.1);
    }
}

struct Map2<'a, O, Y, P, Q>(&'a mut [Y], P, Q, PhantomData<O>);

/// The operand type of a map, so that its function is known.
struct Of<O, X>(PhantomData<(O, X)>);

impl<X, Y, O: Apply2<X, Y>, P: Operand<X>, Q: Operand<X>> NullaryFnOnce
    for Map2<'_, Of<O, X>, Y, P, Q>
{
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.0.len();
        let (a, b) = (self.1.cut(lanes), self.2.cut(lanes));
        for lane in 0..lanes {
            self.0[lane] = O::at(a.lane(lane), b.lane(lane));
        }
    }
}

struct Map3<'a, O, X, Y, Q, R>(&'a mut [Y], &'a [X], Q, R, PhantomData<O>);

impl<X: Copy, Y, O: Apply3<X, Y>, Q: Operand<X>, R: Operand<X>> NullaryFnOnce
    for Map3<'_, O, X, Y, Q, R>
{
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.0.len();
        let (a, b, c) = (self.1.cut(lanes), self.2.cut(lanes), self.3.cut(lanes));
        for lane in 0..lanes {
            self.0[lane] = O::at(a[lane], b.lane(lane), c.lane(lane));
        }
    }
}

struct Blend<'a, T>(&'a mut [T], &'a [u32], &'a [T], &'a [T]);

impl<T: Copy> NullaryFnOnce for Blend<'_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.0.len();
        let (mask, a, b) = (&self.1[..lanes], &self.2[..lanes], &self.3[..lanes]);
        for lane in 0..lanes {
            // Both are read, so that nothing stands in a vector's way.
            let (accept, reject) = (a[lane], b[lane]);
            self.0[lane] = select_unpredictable(mask[lane] != 0, accept, reject);
        }
    }
}

struct Overwrite<'a, T>(&'a mut [T], &'a [u32], &'a [T]);

impl<T: Copy> NullaryFnOnce for Overwrite<'_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.0.len();
        let (mask, a) = (&self.1[..lanes], &self.2[..lanes]);
        for lane in 0..lanes {
            let (accept, reject) = (a[lane], self.0[lane]);
            self.0[lane] = select_unpredictable(mask[lane] != 0, accept, reject);
        }
    }
}

struct Any<'a>(&'a [u32]);

impl NullaryFnOnce for Any<'_> {
    type Output = bool;
    #[inline(always)]
    fn call(self) -> bool {
        self.0.iter().fold(0, |all, lane| all | lane) != 0
    }
}

pub(super) fn map1<A: Isa, O: Apply1<X, Y>, X: Copy, Y>(isa: A, target: &mut [Y], x: &[X]) {
    isa.run(Map1(target, x, PhantomData::<O>));
}

pub(super) fn map2<A: Isa, O: Apply2<X, Y>, X, Y, P: Operand<X>, Q: Operand<X>>(
    isa: A,
    target: &mut [Y],
    a: P,
    b: Q,
) {
    isa.run(Map2(target, a, b, PhantomData::<Of<O, X>>));
}

pub(super) fn map3<A: Isa, O: Apply3<X, Y>, X: Copy, Y, Q: Operand<X>, R: Operand<X>>(
    isa: A,
    target: &mut [Y],
    a: &[X],
    b: Q,
    c: R,
) {
    isa.run(Map3(target, a, b, c, PhantomData::<O>));
}

/// target = mask ? a : b
pub(super) fn blend<A: Isa, T: Copy>(isa: A, target: &mut [T], mask: &[u32], a: &[T], b: &[T]) {
    isa.run(Blend(target, mask, a, b));
}

/// target = mask ? a : target
pub(super) fn overwrite<A: Isa, T: Copy>(isa: A, target: &mut [T], mask: &[u32], a: &[T]) {
    isa.run(Overwrite(target, mask, a));
}

/// Whether a lane of the mask is set.
pub(super) fn any<A: Isa>(isa: A, mask: &[u32]) -> bool {
    isa.run(Any(mask))
}
