//! What each instruction computes, lane by lane, and the kernels that do it.
//!
//! One line a function, for every precision, and as total as the rest: no operand may panic. Instructions that touch
//! memory are `memory.rs`'s, those that steer `run.rs`'s.

use super::Kernel;
use super::apply::{All, Apply1, Apply2, Apply3, map1, map2, map3};
use super::f64_math;
use super::frame::Registers;
use super::isa::Isa;
use super::scalar::Scalar;
use crate::flat::Placed;
use crate::op::{Compare, F1, F2, F3, FromWord, Inst, ToWord, U1, U2};

/// The implementation of one function, with or without the type of floats.
macro_rules! implement {
    ([] $apply:ty, $name:ident, $($rest:tt)*) => {
        impl $apply for $name { implement!(@body $($rest)*); }
    };
    ([$scalar:ident] $apply:ty, $name:ident, $($rest:tt)*) => {
        impl<$scalar: Scalar> $apply for $name { implement!(@body $($rest)*); }
    };
    (@body $x:ty => $y:ty, |$($operand:ident),+| $body:expr) => {
        #[inline(always)]
        fn at($($operand: $x),+) -> $y {
            $body
        }
    };
    (@body $x:ty => $y:ty, |$operand:ident| $body:expr, where $fits:expr, else $any:expr) => {
        #[inline(always)]
        fn at($operand: $x) -> $y {
            $body
        }
        #[inline(always)]
        fn fits($operand: $x) -> bool {
            $fits
        }
        #[inline(always)]
        fn once($operand: $x) -> $y {
            if $fits { $body } else { $any }
        }
    };
}

/// Structs for the functions of a group, and the group's table of kernels.
macro_rules! group {
    ($module:ident, $group:ident, $apply:ident, $x:ty => $y:ty, $generic:tt,
     $table:ident, $kernels:ident, $shape:ty,
     $($name:ident: |$($operand:ident),+| $body:expr
        $(, where $fits:expr, else $any:expr)?;)*) => {
        mod $module {
            use super::*;
            $(
                pub(super) struct $name;
                implement!($generic $apply<$x, $y>, $name,
                    $x => $y, |$($operand),+| $body $(, where $fits, else $any)?);
            )*
        }

        pub(super) fn $table<S: Scalar, A: Isa>(op: $group, shape: $shape) -> Kernel<S, A> {
            match op {
                $($group::$name => $kernels::<S, A, $module::$name>(shape),)*
            }
        }
    };
}

/// Which operands are uniform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Varying,
    /// The second operand is uniform.
    Second,
    /// The first operand is uniform.
    First,
    /// Both are, and so is the result.
    Uniform,
}

impl Shape {
    pub(super) fn of(placed: &Placed) -> Self {
        match (placed.uniform[1], placed.uniform[2]) {
            (true, true) => Self::Uniform,
            (true, false) => Self::First,
            (false, true) => Self::Second,
            (false, false) => Self::Varying,
        }
    }
}

/// Which operands of three are uniform; of a product, the first never is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape3 {
    Varying,
    /// The second operand is uniform.
    Second,
    /// The third operand is uniform.
    Third,
    /// The last two are.
    Last,
    /// All are, and so is the result.
    Uniform,
}

impl Shape3 {
    pub(super) fn of(placed: &Placed) -> Self {
        match placed.uniform {
            [true, ..] => Self::Uniform,
            [_, _, false, false] => Self::Varying,
            [_, _, true, false] => Self::Second,
            [_, _, false, true] => Self::Third,
            [_, _, true, true] => Self::Last,
        }
    }
}

#[inline(always)]
fn mask(value: bool) -> u32 {
    if value { !0 } else { 0 }
}

/// a / b, in f64, which vectors have a division for. The quotient of two words of 32 bits is at least 2^-32 below
/// the next whole number where it is not one, and rounding moves it by less than 2^-21 / b: it never gets there.
#[inline(always)]
fn quotient(a: u32, b: u32) -> u32 {
    let quotient = f64_math::to_u32(f64::from(a) / f64::from(b));
    if b == 0 { a } else { quotient }
}

group!(f1, F1, Apply1, S => S, [S], float1, f1_kernels, bool,
    Neg: |x| x.neg();
    Abs: |x| x.abs();
    Sign: |x| x.sign();
    Sqrt: |x| x.sqrt();
    InverseSqrt: |x| x.inverse_sqrt();
    Floor: |x| x.floor();
    Ceil: |x| x.ceil();
    Trunc: |x| x.trunc();
    Round: |x| x.round();
    Fract: |x| x.fract();
    Sin: |x| x.sin(), where x.in_trig_range(), else x.sin_any();
    Cos: |x| x.cos(), where x.in_trig_range(), else x.cos_any();
    Tan: |x| x.tan(), where x.in_trig_range(), else x.tan_any();
    Asin: |x| x.asin();
    Acos: |x| x.acos();
    Atan: |x| x.atan();
    Sinh: |x| x.sinh();
    Cosh: |x| x.cosh();
    Tanh: |x| x.tanh();
    Asinh: |x| x.asinh();
    Acosh: |x| x.acosh();
    Atanh: |x| x.atanh();
    Exp: |x| x.exp();
    Exp2: |x| x.exp2();
    Ln: |x| x.ln();
    Log2: |x| x.log2();
    Radians: |x| x.radians();
    Degrees: |x| x.degrees();
    QuantizeF16: |x| S::from_f32(half::f16::from_f32(x.to_f32()).to_f32());
    FrexpFract: |x| x.frexp_fract();
);

group!(f2, F2, Apply2, S => S, [S], float2, f2_kernels, Shape,
    Add: |a, b| a.add(b);
    Sub: |a, b| a.sub(b);
    Mul: |a, b| a.mul(b);
    Div: |a, b| a.div(b);
    Min: |a, b| a.min(b);
    Max: |a, b| a.max(b);
    Atan2: |a, b| a.atan2(b);
    Pow: |a, b| a.pow(b);
);

group!(f3, F3, Apply3, S => S, [S], float3, f3_kernels, Shape3,
    Fma: |a, b, c| a.fma(b, c);
    MulAdd: |a, b, c| a.mul(b).add(c);
    MulSub: |a, b, c| a.mul(b).sub(c);
    SubMul: |a, b, c| c.sub(a.mul(b));
);

group!(compare, Compare, Apply2, S => u32, [S], compare2, compare_kernels, Shape,
    Equal: |a, b| mask(a.equal(b));
    NotEqual: |a, b| mask(!a.equal(b));
    Less: |a, b| mask(a.less(b));
    LessEqual: |a, b| mask(a.less_equal(b));
);

group!(to_word, ToWord, Apply1, S => u32, [S], to_word1, to_word_kernels, bool,
    I32: |x| x.to_i32() as u32;
    U32: |x| x.to_index(), where x.in_index_range(), else x.to_u32();
    Bits: |x| x.to_f32().to_bits();
    FrexpExponent: |x| x.frexp_exponent() as u32;
    Half: |x| u32::from(half::f16::from_f32(x.to_f32()).to_bits());
);

group!(from_word, FromWord, Apply1, u32 => S, [S], from_word1, from_word_kernels, bool,
    I32: |x| S::from_i32(x as i32);
    U32: |x| S::from_u32(x);
    Bits: |x| S::from_f32(f32::from_bits(x));
    Half: |x| S::from_f32(half::f16::from_bits(x as u16).to_f32());
    PowerOfTwo: |x| S::power_of_two(x as i32);
);

group!(u1, U1, Apply1, u32 => u32, [], word1, u1_kernels, bool,
    Not: |x| !x;
    AbsI: |x| (x as i32).wrapping_abs() as u32;
    ReverseBits: |x| x.reverse_bits();
    CountOneBits: |x| x.count_ones();
    LeadingZeros: |x| x.leading_zeros();
    TrailingZeros: |x| x.trailing_zeros();
);

// Division by zero gives the dividend and the remainder 0, and so does the one quotient that leaves
// the range (WGSL, section 8.7).
group!(u2, U2, Apply2, u32 => u32, [], word2, u2_kernels, Shape,
    Add: |a, b| a.wrapping_add(b);
    Sub: |a, b| a.wrapping_sub(b);
    Mul: |a, b| a.wrapping_mul(b);
    DivU: |a, b| quotient(a, b);
    DivI: |a, b| (a as i32).checked_div(b as i32).map_or(a, |quotient| quotient as u32);
    RemU: |a, b| if b == 0 { 0 } else { a.wrapping_sub(quotient(a, b).wrapping_mul(b)) };
    RemI: |a, b| (a as i32).checked_rem(b as i32).map_or(0, |rest| rest as u32);
    And: |a, b| a & b;
    Or: |a, b| a | b;
    Xor: |a, b| a ^ b;
    AndNot: |a, b| a & !b;
    ShiftLeft: |a, b| a.wrapping_shl(b);
    ShiftRightU: |a, b| a.wrapping_shr(b);
    ShiftRightI: |a, b| (a as i32).wrapping_shr(b) as u32;
    MinU: |a, b| a.min(b);
    MaxU: |a, b| a.max(b);
    MinI: |a, b| (a as i32).min(b as i32) as u32;
    MaxI: |a, b| (a as i32).max(b as i32) as u32;
    Equal: |a, b| mask(a == b);
    NotEqual: |a, b| mask(a != b);
    LessU: |a, b| mask(a < b);
    LessEqualU: |a, b| mask(a <= b);
    LessI: |a, b| mask((a as i32) < b as i32);
    LessEqualI: |a, b| mask(a as i32 <= b as i32);
);

fn f1_kernels<S: Scalar, A: Isa, O: Apply1<S, S>>(uniform: bool) -> Kernel<S, A> {
    if uniform {
        return |_, frame, inst, _| {
            let bank = &mut frame.floats.uniform;
            bank[inst.d as usize] = O::once(bank[inst.a as usize]);
        };
    }
    |isa, frame, inst, _| {
        let (target, [x]) = frame.floats.split(inst.d, [inst.a]);
        map1::<A, O, S, S>(isa, target, x);
    }
}

fn to_word_kernels<S: Scalar, A: Isa, O: Apply1<S, u32>>(uniform: bool) -> Kernel<S, A> {
    if uniform {
        return |_, frame, inst, _| {
            frame.words.uniform[inst.d as usize] = O::once(frame.floats.uniform[inst.a as usize]);
        };
    }
    |isa, frame, inst, _| {
        map1::<A, O, S, u32>(isa, frame.words.slot_mut(inst.d), frame.floats.slot(inst.a));
    }
}

fn from_word_kernels<S: Scalar, A: Isa, O: Apply1<u32, S>>(uniform: bool) -> Kernel<S, A> {
    if uniform {
        return |_, frame, inst, _| {
            frame.floats.uniform[inst.d as usize] = O::at(frame.words.uniform[inst.a as usize]);
        };
    }
    |isa, frame, inst, _| {
        map1::<A, O, u32, S>(isa, frame.floats.slot_mut(inst.d), frame.words.slot(inst.a));
    }
}

fn u1_kernels<S: Scalar, A: Isa, O: Apply1<u32, u32>>(uniform: bool) -> Kernel<S, A> {
    if uniform {
        return |_, frame, inst, _| {
            let bank = &mut frame.words.uniform;
            bank[inst.d as usize] = O::at(bank[inst.a as usize]);
        };
    }
    |isa, frame, inst, _| u1_lanes::<A, O>(isa, &mut frame.words, inst)
}

/// Apart, so that it is compiled once for all precisions.
#[inline(never)]
fn u1_lanes<A: Isa, O: Apply1<u32, u32>>(isa: A, words: &mut Registers<u32>, inst: &Inst) {
    let (target, [x]) = words.split(inst.d, [inst.a]);
    map1::<A, O, u32, u32>(isa, target, x);
}

/// Two operands of one bank, the result in the same bank.
fn same_bank<A: Isa, T: Copy + Default, O: Apply2<T, T>>(
    isa: A,
    bank: &mut Registers<T>,
    inst: &Inst,
    shape: Shape,
) {
    let Inst { d, a, b, .. } = *inst;
    match shape {
        Shape::Varying => {
            let (target, [a, b]) = bank.split(d, [a, b]);
            map2::<A, O, T, T, _, _>(isa, target, a, b);
        }
        Shape::Second => {
            let b = All(bank.uniform[b as usize]);
            let (target, [a]) = bank.split(d, [a]);
            map2::<A, O, T, T, _, _>(isa, target, a, b);
        }
        Shape::First => {
            let a = All(bank.uniform[a as usize]);
            let (target, [b]) = bank.split(d, [b]);
            map2::<A, O, T, T, _, _>(isa, target, a, b);
        }
        Shape::Uniform => {
            let (a, b) = (bank.uniform[a as usize], bank.uniform[b as usize]);
            bank.uniform[d as usize] = O::at(a, b);
        }
    }
}

fn f2_kernels<S: Scalar, A: Isa, O: Apply2<S, S>>(shape: Shape) -> Kernel<S, A> {
    match shape {
        Shape::Varying => |isa, frame, inst, _| {
            same_bank::<A, S, O>(isa, &mut frame.floats, inst, Shape::Varying);
        },
        Shape::Second => |isa, frame, inst, _| {
            same_bank::<A, S, O>(isa, &mut frame.floats, inst, Shape::Second);
        },
        Shape::First => |isa, frame, inst, _| {
            same_bank::<A, S, O>(isa, &mut frame.floats, inst, Shape::First);
        },
        Shape::Uniform => |isa, frame, inst, _| {
            same_bank::<A, S, O>(isa, &mut frame.floats, inst, Shape::Uniform);
        },
    }
}

#[inline(never)]
fn u2_varying<A: Isa, O: Apply2<u32, u32>>(isa: A, words: &mut Registers<u32>, inst: &Inst) {
    same_bank::<A, u32, O>(isa, words, inst, Shape::Varying);
}

#[inline(never)]
fn u2_second<A: Isa, O: Apply2<u32, u32>>(isa: A, words: &mut Registers<u32>, inst: &Inst) {
    same_bank::<A, u32, O>(isa, words, inst, Shape::Second);
}

#[inline(never)]
fn u2_first<A: Isa, O: Apply2<u32, u32>>(isa: A, words: &mut Registers<u32>, inst: &Inst) {
    same_bank::<A, u32, O>(isa, words, inst, Shape::First);
}

fn u2_kernels<S: Scalar, A: Isa, O: Apply2<u32, u32>>(shape: Shape) -> Kernel<S, A> {
    match shape {
        Shape::Varying => |isa, frame, inst, _| u2_varying::<A, O>(isa, &mut frame.words, inst),
        Shape::Second => |isa, frame, inst, _| u2_second::<A, O>(isa, &mut frame.words, inst),
        Shape::First => |isa, frame, inst, _| u2_first::<A, O>(isa, &mut frame.words, inst),
        Shape::Uniform => |isa, frame, inst, _| {
            same_bank::<A, u32, O>(isa, &mut frame.words, inst, Shape::Uniform);
        },
    }
}

fn compare_kernels<S: Scalar, A: Isa, O: Apply2<S, u32>>(shape: Shape) -> Kernel<S, A> {
    match shape {
        Shape::Varying => |isa, frame, Inst { d, a, b, .. }, _| {
            let (a, b) = (frame.floats.slot(*a), frame.floats.slot(*b));
            map2::<A, O, S, u32, _, _>(isa, frame.words.slot_mut(*d), a, b);
        },
        Shape::Second => |isa, frame, Inst { d, a, b, .. }, _| {
            let (a, b) = (frame.floats.slot(*a), All(frame.floats.uniform[*b as usize]));
            map2::<A, O, S, u32, _, _>(isa, frame.words.slot_mut(*d), a, b);
        },
        Shape::First => |isa, frame, Inst { d, a, b, .. }, _| {
            let (a, b) = (All(frame.floats.uniform[*a as usize]), frame.floats.slot(*b));
            map2::<A, O, S, u32, _, _>(isa, frame.words.slot_mut(*d), a, b);
        },
        Shape::Uniform => |_, frame, Inst { d, a, b, .. }, _| {
            let bank = &frame.floats.uniform;
            frame.words.uniform[*d as usize] = O::at(bank[*a as usize], bank[*b as usize]);
        },
    }
}

fn f3_kernels<S: Scalar, A: Isa, O: Apply3<S, S>>(shape: Shape3) -> Kernel<S, A> {
    match shape {
        Shape3::Varying => |isa, frame, Inst { d, a, b, c, .. }, _| {
            let (target, [a, b, c]) = frame.floats.split(*d, [*a, *b, *c]);
            map3::<A, O, S, S, _, _>(isa, target, a, b, c);
        },
        Shape3::Second => |isa, frame, Inst { d, a, b, c, .. }, _| {
            let b = All(frame.floats.uniform[*b as usize]);
            let (target, [a, c]) = frame.floats.split(*d, [*a, *c]);
            map3::<A, O, S, S, _, _>(isa, target, a, b, c);
        },
        Shape3::Third => |isa, frame, Inst { d, a, b, c, .. }, _| {
            let c = All(frame.floats.uniform[*c as usize]);
            let (target, [a, b]) = frame.floats.split(*d, [*a, *b]);
            map3::<A, O, S, S, _, _>(isa, target, a, b, c);
        },
        Shape3::Last => |isa, frame, Inst { d, a, b, c, .. }, _| {
            let (b, c) = (frame.floats.uniform[*b as usize], frame.floats.uniform[*c as usize]);
            let (target, [a]) = frame.floats.split(*d, [*a]);
            map3::<A, O, S, S, _, _>(isa, target, a, All(b), All(c));
        },
        Shape3::Uniform => |_, frame, inst, _| {
            let bank = &mut frame.floats.uniform;
            let [a, b, c] = [inst.a, inst.b, inst.c].map(|reg| bank[reg as usize]);
            bank[inst.d as usize] = O::at(a, b, c);
        },
    }
}
