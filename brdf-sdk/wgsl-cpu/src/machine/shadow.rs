//! An f32 with an f64 at its side: where does the f32 program lose its digits?
//!
//! The f32 decides: comparisons, conversions to integers and bits are its own, so both follow one
//! path. Each operation notes its local error: how far its f32 result is from the exact one when the
//! operands are right and merely rounded to f32. Rounding alone gives 2^-24; a difference of close
//! numbers gives what cancels. This is the "local error" of Sanchez-Stern, Panchekha, Lerner and
//! Tatlock 2018, "Finding Root Causes of Floating Point Error", section 4. Where the right operand
//! happens to be an f32 it sees nothing, though the f32 program's own operand is off: so it also
//! counts what the operation made of the errors that came in, scaled to one rounding of them.

use super::scalar::Scalar;

/// The error of one operation on operands that are right but for their rounding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct LocalError {
    /// Relative to the exact result; infinite where only one of the two is finite or zero.
    pub relative: f32,
    /// Leading bits that a sum or difference lost to cancellation.
    pub cancelled: f32,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shadow {
    low: f32,
    cancelled: f32,
    high: f64,
    local: f32,
    /// Distance of `low` from `high`, what the operands brought included.
    total: f32,
}

/// One rounding of an operand.
const ULP: f32 = 1.0 / (1 << 24) as f32;

/// |computed - exact| / |exact|; 0 where both are the same kind of non-finite.
fn distance(computed: f32, exact: f64) -> f32 {
    let computed = f64::from(computed);
    // Beyond the range of f32 the exact result cannot be met: that is no error of an operation as
    // long as it goes to the right side.
    let target = if (exact as f32).is_infinite() { f64::from(exact as f32) } else { exact };
    if computed == target || computed.is_nan() && target.is_nan() {
        0.0
    } else if !computed.is_finite() || !target.is_finite() {
        f32::INFINITY
    } else {
        // Gradual underflow: measured against the smallest normal number.
        ((computed - target).abs() / target.abs().max(f64::from(f32::MIN_POSITIVE))) as f32
    }
}

impl Shadow {
    /// `low` and `high` are computed from the operands' own; `rounded` from the high ones, each
    /// rounded to f32 first; `brought` is the largest distance among the operands.
    fn new(low: f32, high: f64, rounded: f32, brought: f32) -> Self {
        let total = distance(low, high);
        // What came in without a right digit tells nothing of this operation.
        let grown = if brought < 0.5 { total / brought.max(ULP) * ULP } else { 0.0 };
        Self { low, high, local: distance(rounded, high).max(grown), cancelled: 0.0, total }
    }

    fn unary(self, low: impl Fn(f32) -> f32, high: impl Fn(f64) -> f64) -> Self {
        Self::new(low(self.low), high(self.high), low(self.high as f32), self.total)
    }

    fn binary(
        self,
        other: Self,
        low: impl Fn(f32, f32) -> f32,
        high: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let rounded = low(self.high as f32, other.high as f32);
        let brought = self.total.max(other.total);
        Self::new(low(self.low, other.low), high(self.high, other.high), rounded, brought)
    }

    /// Bits by which the largest operand of a sum exceeds its result.
    fn with_cancellation(self, operands: [f64; 2]) -> Self {
        let largest = operands[0].abs().max(operands[1].abs());
        let bits = if self.high == 0.0 { 53.0 } else { (largest / self.high.abs()).log2() };
        let cancelled = if bits.is_finite() { bits.clamp(0.0, 53.0) as f32 } else { 0.0 };
        Self { cancelled, ..self }
    }

    /// A value that was given, not computed.
    fn given(low: f32, high: f64) -> Self {
        Self { low, high, local: 0.0, cancelled: 0.0, total: distance(low, high) }
    }
}

macro_rules! unary {
    ($($name:ident),*) => {
        $(fn $name(self) -> Self {
            self.unary(<f32 as Scalar>::$name, <f64 as Scalar>::$name)
        })*
    };
}

impl Scalar for Shadow {
    const LANES: usize = 64;

    fn from_f32(value: f32) -> Self {
        Self::given(value, f64::from(value))
    }
    fn to_f32(self) -> f32 {
        self.low
    }
    fn from_words(word: u32, wide: u64) -> Self {
        Self::given(f32::from_bits(word), f64::from_bits(wide))
    }
    fn to_words(self) -> (u32, u64) {
        (self.low.to_bits(), self.high.to_bits())
    }
    fn from_i32(value: i32) -> Self {
        Self::new(f32::from_i32(value), f64::from(value), f32::from_i32(value), 0.0)
    }
    fn from_u32(value: u32) -> Self {
        Self::new(f32::from_u32(value), f64::from(value), f32::from_u32(value), 0.0)
    }
    fn to_i32(self) -> i32 {
        self.low.to_i32()
    }
    fn to_u32(self) -> u32 {
        self.low.to_u32()
    }
    fn in_index_range(self) -> bool {
        self.low.in_index_range()
    }
    fn to_index(self) -> u32 {
        self.low.to_index()
    }
    fn power_of_two(exponent: i32) -> Self {
        Self::given(f32::power_of_two(exponent), f64::power_of_two(exponent))
    }
    fn equal(self, other: Self) -> bool {
        self.low == other.low
    }
    fn less(self, other: Self) -> bool {
        self.low < other.low
    }
    fn less_equal(self, other: Self) -> bool {
        self.low <= other.low
    }
    fn add(self, other: Self) -> Self {
        self.binary(other, |a, b| a + b, |a, b| a + b).with_cancellation([self.high, other.high])
    }
    fn sub(self, other: Self) -> Self {
        self.binary(other, |a, b| a - b, |a, b| a - b).with_cancellation([self.high, other.high])
    }
    fn mul(self, other: Self) -> Self {
        self.binary(other, |a, b| a * b, |a, b| a * b)
    }
    fn div(self, other: Self) -> Self {
        self.binary(other, |a, b| a / b, |a, b| a / b)
    }
    // Continuous, so each takes its own: a maximum with 0 keeps f64 above 0 too.
    fn min(self, other: Self) -> Self {
        Self::given(Scalar::min(self.low, other.low), Scalar::min(self.high, other.high))
    }
    fn max(self, other: Self) -> Self {
        Self::given(Scalar::max(self.low, other.low), Scalar::max(self.high, other.high))
    }
    fn pow(self, other: Self) -> Self {
        self.binary(other, Scalar::pow, Scalar::pow)
    }
    fn atan2(self, other: Self) -> Self {
        self.binary(other, Scalar::atan2, Scalar::atan2)
    }
    fn fma(self, factor: Self, sum: Self) -> Self {
        let low = self.low.mul_add(factor.low, sum.low);
        let high = self.high.mul_add(factor.high, sum.high);
        let rounded = (self.high as f32).mul_add(factor.high as f32, sum.high as f32);
        let product = self.high * factor.high;
        let brought = self.total.max(factor.total).max(sum.total);
        Self::new(low, high, rounded, brought).with_cancellation([product, sum.high])
    }
    fn neg(self) -> Self {
        Self::given(-self.low, -self.high)
    }
    fn abs(self) -> Self {
        Self::given(self.low.abs(), self.high.abs())
    }
    fn sign(self) -> Self {
        Self::from_f32(Scalar::sign(self.low))
    }
    // What jumps follows the f32: both take the same step.
    fn floor(self) -> Self {
        Self::from_f32(Scalar::floor(self.low))
    }
    fn ceil(self) -> Self {
        Self::from_f32(Scalar::ceil(self.low))
    }
    fn trunc(self) -> Self {
        Self::from_f32(Scalar::trunc(self.low))
    }
    fn round(self) -> Self {
        Self::from_f32(Scalar::round(self.low))
    }
    fn fract(self) -> Self {
        let whole = Scalar::floor(self.low);
        let low = Scalar::fract(self.low);
        let high = self.high - f64::from(whole);
        let rounded = Scalar::fract(self.high as f32);
        Self::new(low, high, rounded, self.total).with_cancellation([self.high, f64::from(whole)])
    }
    unary!(
        sqrt,
        inverse_sqrt,
        sin,
        cos,
        tan,
        sin_any,
        cos_any,
        tan_any,
        asin,
        acos,
        atan,
        sinh,
        cosh,
        tanh,
        asinh,
        acosh,
        atanh,
        exp,
        exp2,
        ln,
        log2,
        radians,
        degrees
    );
    fn in_trig_range(self) -> bool {
        self.low.in_trig_range()
    }
    fn frexp_fract(self) -> Self {
        let exponent = self.low.frexp_exponent();
        let scale = f64::power_of_two(-exponent);
        Self::given(self.low.frexp_fract(), self.high * scale)
    }
    fn frexp_exponent(self) -> i32 {
        self.low.frexp_exponent()
    }
    fn off_by_local_error(self) -> Self {
        let scale = self.high.abs().max(f64::from(f32::MIN_POSITIVE));
        let step = (f64::from(self.local) * scale).copysign(f64::from(self.low) - self.high);
        let off = if self.local == 0.0 {
            self.high
        } else if step.is_finite() {
            self.high + step
        } else {
            f64::from(self.low)
        };
        Self { high: off, ..self }
    }
    fn local_error(self) -> Option<LocalError> {
        Some(LocalError { relative: self.local, cancelled: self.cancelled })
    }
}
