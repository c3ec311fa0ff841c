//! Kernels that move values: between registers, buffers and the lanes' own memory. Textures are `texels.rs`'s.
//!
//! Every address is clamped to what is there, so no program reads or writes anything else.

use std::sync::atomic::Ordering::Relaxed;

use super::apply::{blend, overwrite};
use super::frame::{Frame, Registers};
use super::isa::Isa;
use super::scalar::Scalar;
use super::{Context, Kernel, texels};
use crate::flat::Placed;
use crate::op::{AtomicOp, Bank, Builtin, Inst, Op};
use crate::storage::{Resource, Storage};

/// The kernel of an instruction that is no function of its operands alone.
pub(super) fn kernel<S: Scalar, A: Isa>(placed: &Placed) -> Kernel<S, A> {
    let uniform = placed.uniform[0];
    match placed.inst.op {
        Op::Select(Bank::Float) if uniform => |_, frame, inst, _| {
            let mask = frame.words.uniform[inst.a as usize];
            let from = if mask != 0 { inst.b } else { inst.c };
            frame.floats.uniform[inst.d as usize] = frame.floats.uniform[from as usize];
        },
        Op::Select(Bank::Word) if uniform => |_, frame, inst, _| {
            let bank = &mut frame.words.uniform;
            let from = if bank[inst.a as usize] != 0 { inst.b } else { inst.c };
            bank[inst.d as usize] = bank[from as usize];
        },
        Op::Select(Bank::Float) => |isa, frame, inst, _| {
            let (target, [a, b]) = frame.floats.split(inst.d, [inst.b, inst.c]);
            blend(isa, target, frame.words.slot(inst.a), a, b);
        },
        Op::Select(Bank::Word) => |isa, frame, inst, _| {
            let (target, [mask, a, b]) = frame.words.split(inst.d, [inst.a, inst.b, inst.c]);
            blend(isa, target, mask, a, b);
        },
        Op::Move(Bank::Float) if uniform => |_, frame, inst, _| {
            let bank = &mut frame.floats.uniform;
            bank[inst.d as usize] = bank[inst.a as usize];
        },
        Op::Move(Bank::Float) => |_, frame, inst, _| copy(&mut frame.floats, inst),
        Op::Move(Bank::Word) if uniform => |_, frame, inst, _| {
            let bank = &mut frame.words.uniform;
            bank[inst.d as usize] = bank[inst.a as usize];
        },
        Op::Move(Bank::Word) => |_, frame, inst, _| copy(&mut frame.words, inst),
        Op::Splat(Bank::Float) => |_, frame, inst, _| splat(&mut frame.floats, inst),
        Op::Splat(Bank::Word) => |_, frame, inst, _| splat(&mut frame.words, inst),
        Op::Merge(Bank::Float) => |isa, frame, inst, _| {
            let (target, [a]) = frame.floats.split(inst.d, [inst.a]);
            overwrite(isa, target, frame.words.slot(inst.b), a);
        },
        Op::Merge(Bank::Word) => |isa, frame, inst, _| {
            let (target, [a, mask]) = frame.words.split(inst.d, [inst.a, inst.b]);
            overwrite(isa, target, mask, a);
        },
        Op::Constant(Bank::Float) => |_, frame, inst, _| {
            frame.floats.uniform[inst.d as usize] = S::from_f32(f32::from_bits(inst.imm));
        },
        Op::Constant(Bank::Word) => |_, frame, inst, _| {
            frame.words.uniform[inst.d as usize] = inst.imm;
        },
        Op::Builtin(_) => |_, frame, inst, context| builtin(frame, inst, context),
        Op::GroupCount => |_, frame, inst, context| {
            frame.words.uniform[inst.d as usize] = context.groups[inst.imm as usize % 3];
        },
        Op::Load(Bank::Float) if uniform => |_, frame, inst, context| {
            let at = frame.words.uniform[inst.a as usize];
            frame.floats.uniform[inst.d as usize] = match context.resource(inst) {
                Resource::Storage(storage) => float_at(storage, at.saturating_add(inst.imm)),
                _ => S::from_f32(f32::from_bits(context.word(inst, at))),
            };
        },
        Op::Load(Bank::Word) if uniform => |_, frame, inst, context| {
            let word = context.word(inst, frame.words.uniform[inst.a as usize]);
            frame.words.uniform[inst.d as usize] = word;
        },
        Op::Load(Bank::Float) => |_, frame, inst, context| {
            let at = frame.words.slot(inst.a);
            let targets = frame.floats.slot_mut(inst.d);
            if let Resource::Storage(storage) = context.resource(inst) {
                for (target, at) in targets.iter_mut().zip(at) {
                    *target = float_at(storage, at.saturating_add(inst.imm));
                }
                return;
            }
            let value = |word| S::from_f32(f32::from_bits(word));
            gather(targets, at, inst, context, value);
        },
        Op::Load(Bank::Word) => |_, frame, inst, context| {
            let (targets, [at]) = frame.words.split(inst.d, [inst.a]);
            gather(targets, at, inst, context, |word| word);
        },
        Op::LoadOrdered(Bank::Float) => |_, frame, inst, context| {
            let Resource::Storage(storage) = context.resource(inst) else { return };
            let at = frame.words.slot(inst.a);
            for (target, at) in frame.floats.slot_mut(inst.d).iter_mut().zip(at) {
                *target = float_at(storage, at.saturating_add(inst.imm));
            }
        },
        Op::LoadOrdered(Bank::Word) => |_, frame, inst, context| {
            let Resource::Storage(storage) = context.resource(inst) else { return };
            let (targets, [at]) = frame.words.split(inst.d, [inst.a]);
            for (target, at) in targets.iter_mut().zip(at) {
                *target = storage.word(at.saturating_add(inst.imm) as usize).unwrap_or(0);
            }
        },
        Op::Store(Bank::Float) => |_, frame, inst, context| {
            store(frame.floats.slot(inst.b), &frame.words, inst, context, |x| x.to_words());
        },
        Op::Store(Bank::Word) => |_, frame, inst, context| {
            let wide = |word| f64::from(f32::from_bits(word)).to_bits();
            store(frame.words.slot(inst.b), &frame.words, inst, context, |x| (x, wide(x)));
        },
        Op::Atomic(_) => |_, frame, inst, context| atomic(&mut frame.words, inst, context),
        Op::BufferWords => |_, frame, inst, context| {
            let words = match context.resource(inst) {
                Resource::Words(words) => words.len(),
                Resource::Storage(storage) => storage.len(),
                Resource::Texture { .. } => 0,
            };
            frame.words.uniform[inst.d as usize] = u32::try_from(words).unwrap_or(u32::MAX);
        },
        Op::Texel => |isa, frame, inst, context| {
            texels::number(isa, &mut frame.words, inst, context);
        },
        Op::Fetch(Bank::Float, _) => |_, frame, inst, context| {
            let at = frame.words.slot(inst.a);
            texels::fetch(frame.floats.slot_mut(inst.d), at, inst, context);
        },
        Op::Fetch(Bank::Word, _) => |_, frame, inst, context| {
            let (targets, [at]) = frame.words.split(inst.d, [inst.a]);
            texels::fetch(targets, at, inst, context);
        },
        Op::FetchAll(Bank::Float, _) => |isa, frame, inst, context| {
            let targets = frame.floats.slots_mut([inst.d, inst.b, inst.c, inst.imm]);
            texels::fetch_all(isa, targets, frame.words.slot(inst.a), inst, context);
        },
        Op::FetchAll(Bank::Word, _) => |isa, frame, inst, context| {
            let slots = [inst.d, inst.b, inst.c, inst.imm, inst.a];
            let [x, y, z, w, at] = frame.words.slots_mut(slots);
            texels::fetch_all(isa, [x, y, z, w], at, inst, context);
        },
        Op::TextureSize => |_, frame, inst, context| {
            let Resource::Texture { size, .. } = context.resource(inst) else { return };
            frame.words.uniform[inst.d as usize] = size[inst.imm as usize % 2];
        },
        Op::Recall(Bank::Float) => |_, frame, inst, _| {
            let (own, lanes) = (&frame.own_floats, frame.lanes);
            let at = frame.words.slot(inst.a);
            for (lane, target) in frame.floats.slot_mut(inst.d).iter_mut().enumerate() {
                *target = own[element(inst, at[lane]) * lanes + lane];
            }
        },
        Op::Recall(Bank::Word) => |_, frame, inst, _| {
            let (own, lanes) = (&frame.own_words, frame.lanes);
            let (targets, [at]) = frame.words.split(inst.d, [inst.a]);
            for (lane, target) in targets.iter_mut().enumerate() {
                *target = own[element(inst, at[lane]) * lanes + lane];
            }
        },
        Op::Keep(Bank::Float) => |_, frame, inst, _| {
            let values = frame.floats.slot(inst.b);
            keep(&mut frame.own_floats, frame.lanes, &frame.words, inst, values);
        },
        Op::Keep(Bank::Word) => |_, frame, inst, _| {
            let values = frame.words.slot(inst.b);
            keep(&mut frame.own_words, frame.lanes, &frame.words, inst, values);
        },
        Op::Clear(Bank::Float) => |_, frame, inst, _| {
            clear(&mut frame.own_floats, frame.lanes, &frame.words, inst);
        },
        Op::Clear(Bank::Word) => |_, frame, inst, _| {
            clear(&mut frame.own_words, frame.lanes, &frame.words, inst);
        },
        Op::Table(Bank::Float) => |_, frame, inst, context| {
            let table = &context.tables[0][inst.imm as usize];
            let at = frame.words.slot(inst.a);
            for (target, at) in frame.floats.slot_mut(inst.d).iter_mut().zip(at) {
                *target = S::from_f32(f32::from_bits(table[(*at as usize).min(table.len() - 1)]));
            }
        },
        Op::Table(Bank::Word) => |_, frame, inst, context| {
            let table = &context.tables[1][inst.imm as usize];
            let (targets, [at]) = frame.words.split(inst.d, [inst.a]);
            for (target, at) in targets.iter_mut().zip(at) {
                *target = table[(*at as usize).min(table.len() - 1)];
            }
        },
        Op::WatchNegative => |_, frame, inst, context| {
            let (values, mask) = (frame.floats.slot(inst.a), frame.words.slot(inst.b));
            let zero = S::default();
            let lanes = values.iter().zip(mask);
            let negative = lanes.filter(|(value, here)| value.less(zero) && **here != 0).count();
            if negative > 0 {
                context.watches[inst.imm as usize].fetch_add(negative as u64, Relaxed);
            }
        },
        // The functions of operands alone have kernels of their own.
        Op::F1(_) | Op::F2(_) | Op::F3(_) | Op::Compare(_) | Op::ToWord(_) | Op::FromWord(_) => {
            |_, _, _, _| {}
        }
        Op::U1(_) | Op::U2(_) | Op::Field(_) | Op::Turn => |_, _, _, _| {},
    }
}

fn copy<T: Copy + Default>(bank: &mut Registers<T>, inst: &Inst) {
    let (target, [source]) = bank.split(inst.d, [inst.a]);
    target.copy_from_slice(source);
}

fn splat<T: Copy + Default>(bank: &mut Registers<T>, inst: &Inst) {
    let value = bank.uniform[inst.a as usize];
    bank.slot_mut(inst.d).fill(value);
}

fn builtin<S: Scalar>(frame: &mut Frame<S>, inst: &Inst, context: &Context<'_>) {
    let Op::Builtin(builtin) = inst.op else { return };
    let size = context.group_size;
    let per_group = size[0] * size[1] * size[2];
    let local =
        |index: u32| [index % size[0], index / size[0] % size[1], index / (size[0] * size[1])];
    let group = |number: u32| {
        let [x, y, _] = context.groups;
        [number % x, number / x % y, number / (x * y)]
    };
    let first = frame.first;
    for (lane, target) in frame.words.slot_mut(inst.d).iter_mut().enumerate() {
        let invocation = first.wrapping_add(lane as u32);
        // Lanes past the end stand for the last invocation, and are active nowhere.
        let at = invocation.min(context.total.saturating_sub(1));
        *target = match builtin {
            Builtin::Active if invocation < context.total => !0,
            Builtin::Active => 0,
            Builtin::LocalIndex => at % per_group,
            Builtin::LocalId(axis) => local(at % per_group)[axis as usize],
            Builtin::GroupId(axis) => group(at / per_group)[axis as usize],
            Builtin::GlobalId(axis) => {
                let axis = axis as usize;
                group(at / per_group)[axis] * size[axis] + local(at % per_group)[axis]
            }
        };
    }
}

/// Words of a buffer that nobody writes, through `value`.
fn gather<T: Copy>(
    targets: &mut [T],
    at: &[u32],
    inst: &Inst,
    context: &Context<'_>,
    value: impl Fn(u32) -> T,
) {
    let Resource::Words(words) = context.resource(inst) else {
        for (target, at) in targets.iter_mut().zip(at) {
            *target = value(context.word(inst, *at));
        }
        return;
    };
    let words = words.get(inst.imm as usize..).unwrap_or(&[]);
    let Some(last) = words.len().checked_sub(1) else { return targets.fill(value(0)) };
    for (target, at) in targets.iter_mut().zip(at) {
        *target = value(words[(*at as usize).min(last)]);
    }
}

fn float_at<S: Scalar>(storage: &Storage, at: u32) -> S {
    let at = at as usize;
    let word = storage.word(at).unwrap_or(0);
    let wide = storage.wide.get(at).map(|wide| wide.load(Relaxed));
    S::from_words(word, wide.unwrap_or_else(|| f64::from(f32::from_bits(word)).to_bits()))
}

/// The values of lanes in the mask to a buffer, each as a 32-bit word and the f64 kept beside it.
fn store<T: Copy>(
    values: &[T],
    words: &Registers<u32>,
    inst: &Inst,
    context: &Context<'_>,
    to_words: impl Fn(T) -> (u32, u64),
) {
    let Resource::Storage(storage) = context.resource(inst) else { return };
    let (at, mask) = (words.slot(inst.a), words.slot(inst.c));
    for (lane, value) in values.iter().enumerate() {
        if mask[lane] != 0 {
            let at = at[lane].saturating_add(inst.imm) as usize;
            let (word, wide) = to_words(*value);
            if let Some(target) = storage.words.get(at) {
                target.store(word, Relaxed);
            }
            if let Some(target) = storage.wide.get(at) {
                target.store(wide, Relaxed);
            }
        }
    }
}

fn atomic(words: &mut Registers<u32>, inst: &Inst, context: &Context<'_>) {
    let (Op::Atomic(op), Resource::Storage(storage)) = (inst.op, context.resource(inst)) else {
        return;
    };
    let (targets, [at, values, mask]) = words.split(inst.d, [inst.a, inst.b, inst.c]);
    for (lane, target) in targets.iter_mut().enumerate() {
        let at = at[lane].saturating_add(inst.imm) as usize;
        let Some(word) = storage.words.get(at).filter(|_| mask[lane] != 0) else { continue };
        let value = values[lane];
        let signed = |choose: fn(i32, i32) -> i32| {
            // The closure always returns a value, so the update cannot fail.
            word.fetch_update(Relaxed, Relaxed, |old| Some(choose(old as i32, value as i32) as u32))
                .unwrap_or_default()
        };
        *target = match op {
            AtomicOp::Add => word.fetch_add(value, Relaxed),
            AtomicOp::Sub => word.fetch_sub(value, Relaxed),
            AtomicOp::And => word.fetch_and(value, Relaxed),
            AtomicOp::Or => word.fetch_or(value, Relaxed),
            AtomicOp::Xor => word.fetch_xor(value, Relaxed),
            AtomicOp::MinU => word.fetch_min(value, Relaxed),
            AtomicOp::MaxU => word.fetch_max(value, Relaxed),
            AtomicOp::MinI => signed(i32::min),
            AtomicOp::MaxI => signed(i32::max),
            AtomicOp::Exchange => word.swap(value, Relaxed),
        };
    }
}

/// The element of the lane's own memory that an instruction means.
fn element(inst: &Inst, at: u32) -> usize {
    at.saturating_add(inst.imm).min(inst.extra - 1) as usize
}

fn keep<T: Copy>(own: &mut [T], lanes: usize, words: &Registers<u32>, inst: &Inst, values: &[T]) {
    let (at, mask) = (words.slot(inst.a), words.slot(inst.c));
    for (lane, value) in values.iter().enumerate() {
        if mask[lane] != 0 {
            own[element(inst, at[lane]) * lanes + lane] = *value;
        }
    }
}

fn clear<T: Copy + Default>(own: &mut [T], lanes: usize, words: &Registers<u32>, inst: &Inst) {
    let mask = words.slot(inst.a);
    let first = inst.imm as usize;
    for element in first..first + inst.extra as usize {
        for (lane, value) in own[element * lanes..][..lanes].iter_mut().enumerate() {
            if mask[lane] != 0 {
                *value = T::default();
            }
        }
    }
}
