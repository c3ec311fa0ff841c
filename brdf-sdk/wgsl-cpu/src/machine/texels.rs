//! Kernels that read textures.
//!
//! A texel is one load of 16 bytes, and its components go to four registers: four loads of 4 bytes, lane after lane,
//! took nearly half of the time of a program that lives on tables.

use pulp::NullaryFnOnce;

use super::Context;
use super::frame::Registers;
use super::isa::Isa;
use super::scalar::Component;
use crate::op::{Inst, Op, Texels};
use crate::storage::Resource;

/// One component of each lane's texel.
pub(super) fn fetch<T: Component>(
    targets: &mut [T],
    at: &[u32],
    inst: &Inst,
    context: &Context<'_>,
) {
    let Some(list) = List::of(inst, context) else { return };
    let component = inst.imm as usize % 4;
    let Some(last) = list.last(at) else {
        for (target, at) in targets.iter_mut().zip(at) {
            *target = T::stored(list.clamped(*at)[component]);
        }
        return;
    };
    for (target, at) in targets.iter_mut().zip(at) {
        *target = T::stored(list.texels[(*at as usize).min(last)][component]);
    }
}

/// All components of each lane's texel.
pub(super) fn fetch_all<T: Component, A: Isa>(
    isa: A,
    targets: [&mut [T]; 4],
    at: &[u32],
    inst: &Inst,
    context: &Context<'_>,
) {
    let Some(list) = List::of(inst, context) else { return };
    isa.run(FetchAll { isa, targets, at, list });
}

/// The texels of a texture, by their numbers.
#[derive(Clone, Copy)]
struct List<'a> {
    texels: &'a [[f32; 4]],
    size: [u32; 2],
    counted: Texels,
}

impl<'a> List<'a> {
    fn of(inst: &Inst, context: &Context<'a>) -> Option<Self> {
        let Resource::Texture { texels, size } = context.resource(inst) else { return None };
        let (Op::Fetch(_, counted) | Op::FetchAll(_, counted)) = inst.op else { return None };
        Some(Self { texels, size, counted })
    }

    /// The last texel, where all these numbers are places in memory.
    #[inline(always)]
    fn last(self, numbers: &[u32]) -> Option<usize> {
        let plain = match self.counted {
            Texels::AsTheyLie => true,
            Texels::InRows(bits) => self.size[0] == 1 << bits,
        };
        let [width, height] = self.size;
        let end = width.saturating_mul(height).min(self.texels.len() as u32);
        let within = numbers.iter().fold(true, |all, number| all & (*number < end));
        if plain && within { self.texels.len().checked_sub(1) } else { None }
    }

    /// A texel of rows of another width, or from beyond the end.
    #[cold]
    fn clamped(self, number: u32) -> [f32; 4] {
        let [width, height] = self.size;
        let (x, y) = match self.counted {
            Texels::AsTheyLie => (number % width.max(1), number / width.max(1)),
            Texels::InRows(bits) => (number & ((1 << bits) - 1), number >> bits),
        };
        let (x, y) = (x.min(width.saturating_sub(1)), y.min(height.saturating_sub(1)));
        let at = y.wrapping_mul(width).wrapping_add(x) as usize;
        self.texels.get(at).copied().unwrap_or_default()
    }
}

/// Four lanes at a time; the number of lanes is a multiple of 64.
struct FetchAll<'a, T, A> {
    isa: A,
    targets: [&'a mut [T]; 4],
    at: &'a [u32],
    list: List<'a>,
}

impl<T: Component, A: Isa> NullaryFnOnce for FetchAll<'_, T, A> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let (texels, lanes) = (self.list.texels, self.at.as_chunks::<4>().0);
        let [x, y, z, w] = self.targets;
        let (x, y) = (x.as_chunks_mut::<4>().0, y.as_chunks_mut::<4>().0);
        let (z, w) = (z.as_chunks_mut::<4>().0, w.as_chunks_mut::<4>().0);
        let count = lanes.len();
        let (x, y, z, w) = (&mut x[..count], &mut y[..count], &mut z[..count], &mut w[..count]);
        // No closures: they know nothing of the instruction set around them, and are not inlined.
        let Some(last) = self.list.last(self.at) else {
            for four in 0..count {
                for lane in 0..4 {
                    let texel = self.list.clamped(lanes[four][lane]);
                    x[four][lane] = T::stored(texel[0]);
                    y[four][lane] = T::stored(texel[1]);
                    z[four][lane] = T::stored(texel[2]);
                    w[four][lane] = T::stored(texel[3]);
                }
            }
            return;
        };
        for four in 0..count {
            let [a, b, c, d] = lanes[four];
            let columns = self.isa.transposed([
                texels[(a as usize).min(last)],
                texels[(b as usize).min(last)],
                texels[(c as usize).min(last)],
                texels[(d as usize).min(last)],
            ]);
            x[four] = T::four(columns[0]);
            y[four] = T::four(columns[1]);
            z[four] = T::four(columns[2]);
            w[four] = T::four(columns[3]);
        }
    }
}

/// Index of the texel at (x, y), row by row.
struct TexelIndex<'a> {
    targets: &'a mut [u32],
    x: &'a [u32],
    y: &'a [u32],
    size: [u32; 2],
}

impl NullaryFnOnce for TexelIndex<'_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let lanes = self.targets.len();
        let (x, y) = (&self.x[..lanes], &self.y[..lanes]);
        let [width, height] = self.size;
        let (right, bottom) = (width.saturating_sub(1), height.saturating_sub(1));
        for ((target, x), y) in self.targets.iter_mut().zip(x).zip(y) {
            *target = (*y).min(bottom).wrapping_mul(width).wrapping_add((*x).min(right));
        }
    }
}

/// The number of each lane's texel at (a, b).
pub(super) fn number<A: Isa>(
    isa: A,
    words: &mut Registers<u32>,
    inst: &Inst,
    context: &Context<'_>,
) {
    let Resource::Texture { size, .. } = context.resource(inst) else { return };
    let (targets, [x, y]) = words.split(inst.d, [inst.a, inst.b]);
    isa.run(TexelIndex { targets, x, y, size });
}
