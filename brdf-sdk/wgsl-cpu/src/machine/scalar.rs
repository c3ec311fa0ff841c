//! What a float of the program is: f32, f64, or (shadow.rs) both side by side.
//!
//! The functions behind it are those of `f32_math` and `f64_math`. It knows neither lanes nor instructions.

use super::{f32_math, f64_math};

/// What a register holds of a texel: a float of the run's precision, or the word that a float's bits are.
pub(super) trait Component: Copy {
    fn stored(value: f32) -> Self;
    /// Four at once: where they need no conversion they stay one vector.
    #[inline(always)]
    fn four(values: [f32; 4]) -> [Self; 4] {
        let [a, b, c, d] = values;
        [Self::stored(a), Self::stored(b), Self::stored(c), Self::stored(d)]
    }
}

impl<S: Scalar> Component for S {
    #[inline(always)]
    fn stored(value: f32) -> Self {
        Self::from_f32(value)
    }
    #[inline(always)]
    fn four(values: [f32; 4]) -> [Self; 4] {
        Scalar::four(values)
    }
}

impl Component for u32 {
    #[inline(always)]
    fn stored(value: f32) -> Self {
        value.to_bits()
    }
    #[inline(always)]
    fn four(values: [f32; 4]) -> [Self; 4] {
        pulp::cast(values)
    }
}

/// A float of one precision, with all that WGSL does to floats. The functions inline into loops over
/// lanes and vectorise; those named `_any` are right for every argument, one lane at a time.
pub(crate) trait Scalar: Copy + Default + Send + Sync + 'static {
    /// Lanes of a batch: what keeps the registers in the processor's caches.
    const LANES: usize;

    fn from_f32(value: f32) -> Self;
    /// Four at once: where they need no conversion they stay one vector.
    #[inline(always)]
    fn four(values: [f32; 4]) -> [Self; 4] {
        let [a, b, c, d] = values;
        [Self::from_f32(a), Self::from_f32(b), Self::from_f32(c), Self::from_f32(d)]
    }
    fn to_f32(self) -> f32;
    /// From a buffer's 32-bit word and the f64 kept beside it.
    fn from_words(word: u32, wide: u64) -> Self;
    /// The 32-bit word, and the f64 kept beside it.
    fn to_words(self) -> (u32, u64);

    fn from_i32(value: i32) -> Self;
    fn from_u32(value: u32) -> Self;
    fn to_i32(self) -> i32;
    fn to_u32(self) -> u32;
    /// Whether `to_index` is right here.
    fn in_index_range(self) -> bool;
    /// `to_u32` of a number that is small enough.
    fn to_index(self) -> u32;
    /// 2^exponent; infinite or zero outside the range.
    fn power_of_two(exponent: i32) -> Self;

    fn equal(self, other: Self) -> bool;
    fn less(self, other: Self) -> bool;
    fn less_equal(self, other: Self) -> bool;

    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn pow(self, other: Self) -> Self;
    fn atan2(self, other: Self) -> Self;
    fn fma(self, factor: Self, sum: Self) -> Self;

    fn neg(self) -> Self;
    fn abs(self) -> Self;
    fn sign(self) -> Self;
    fn sqrt(self) -> Self;
    fn inverse_sqrt(self) -> Self;
    fn floor(self) -> Self;
    fn ceil(self) -> Self;
    fn trunc(self) -> Self;
    fn round(self) -> Self;
    fn fract(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn tan(self) -> Self;
    fn sin_any(self) -> Self;
    fn cos_any(self) -> Self;
    fn tan_any(self) -> Self;
    /// Whether `sin`, `cos` and `tan` are accurate here.
    fn in_trig_range(self) -> bool;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn sinh(self) -> Self;
    fn cosh(self) -> Self;
    fn tanh(self) -> Self;
    fn asinh(self) -> Self;
    fn acosh(self) -> Self;
    fn atanh(self) -> Self;
    fn exp(self) -> Self;
    fn exp2(self) -> Self;
    fn ln(self) -> Self;
    fn log2(self) -> Self;
    fn radians(self) -> Self;
    fn degrees(self) -> Self;
    /// The fraction of `frexp`, in [0.5, 1).
    fn frexp_fract(self) -> Self;
    fn frexp_exponent(self) -> i32;

    /// The value with the error that arose in the instruction which made it, and no other one.
    #[inline(always)]
    fn off_by_local_error(self) -> Self {
        self
    }

    /// The error that arose in the instruction which made this value, where the precision knows it.
    #[inline(always)]
    fn local_error(self) -> Option<super::shadow::LocalError> {
        None
    }
}

macro_rules! scalar {
    (
        $float:ident, $bits:ident, $math:ident, $lanes:literal, $exponent_bits:literal,
        |$word:ident, $wide:ident| $from_words:expr, |$four:ident| $converted:expr
    ) => {
        impl Scalar for $float {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn from_f32(value: f32) -> Self {
                $float::from(value)
            }
            #[inline(always)]
            fn four($four: [f32; 4]) -> [Self; 4] {
                $converted
            }
            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            fn from_words($word: u32, $wide: u64) -> Self {
                $from_words
            }
            #[inline(always)]
            fn to_words(self) -> (u32, u64) {
                ((self as f32).to_bits(), f64::from(self).to_bits())
            }
            #[inline(always)]
            fn from_i32(value: i32) -> Self {
                $math::from_i32(value)
            }
            #[inline(always)]
            fn from_u32(value: u32) -> Self {
                $math::from_u32(value)
            }
            #[inline(always)]
            fn to_i32(self) -> i32 {
                $math::to_i32(self)
            }
            #[inline(always)]
            fn to_u32(self) -> u32 {
                $math::to_u32(self)
            }
            #[inline(always)]
            fn in_index_range(self) -> bool {
                $math::in_index_range(self)
            }
            #[inline(always)]
            fn to_index(self) -> u32 {
                $math::to_index(self)
            }
            #[inline(always)]
            fn power_of_two(exponent: i32) -> Self {
                const MANTISSA: u32 = $float::MANTISSA_DIGITS - 1;
                const BIAS: i32 = $float::MAX_EXP - 1;
                // Below the normal numbers the two halves of `ldexp` are of no use any more.
                let biased = exponent.clamp(-BIAS, BIAS + 1) + BIAS;
                $float::from_bits((biased as $bits) << MANTISSA)
            }
            #[inline(always)]
            fn equal(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn less_equal(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self - other
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                self * other
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                self / other
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                $float::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                $float::max(self, other)
            }
            #[inline(always)]
            fn pow(self, other: Self) -> Self {
                $math::pow(self, other)
            }
            #[inline(always)]
            fn atan2(self, other: Self) -> Self {
                $math::atan2(self, other)
            }
            #[inline(always)]
            fn fma(self, factor: Self, sum: Self) -> Self {
                self.mul_add(factor, sum)
            }
            #[inline(always)]
            fn neg(self) -> Self {
                -self
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn sign(self) -> Self {
                // Zero keeps its sign, NaN stays.
                let above = if self > 0.0 { 1.0 } else { self };
                if self < 0.0 { -1.0 } else { above }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline(always)]
            fn inverse_sqrt(self) -> Self {
                1.0 / $float::sqrt(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $math::floor(self)
            }
            #[inline(always)]
            fn ceil(self) -> Self {
                $math::ceil(self)
            }
            #[inline(always)]
            fn trunc(self) -> Self {
                $math::trunc(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                $math::round_even(self)
            }
            #[inline(always)]
            fn fract(self) -> Self {
                $math::fract(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $math::sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $math::cos(self)
            }
            #[inline(always)]
            fn tan(self) -> Self {
                $math::tan(self)
            }
            fn sin_any(self) -> Self {
                $float::sin(self)
            }
            fn cos_any(self) -> Self {
                $float::cos(self)
            }
            fn tan_any(self) -> Self {
                $float::tan(self)
            }
            #[inline(always)]
            fn in_trig_range(self) -> bool {
                // NaN counts as inside: its sine is NaN either way.
                self.abs() <= $math::TRIG_LIMIT || self.is_nan()
            }
            #[inline(always)]
            fn asin(self) -> Self {
                $math::asin(self)
            }
            #[inline(always)]
            fn acos(self) -> Self {
                $math::acos(self)
            }
            #[inline(always)]
            fn atan(self) -> Self {
                $math::atan(self)
            }
            #[inline(always)]
            fn sinh(self) -> Self {
                $math::sinh(self)
            }
            #[inline(always)]
            fn cosh(self) -> Self {
                $math::cosh(self)
            }
            #[inline(always)]
            fn tanh(self) -> Self {
                $math::tanh(self)
            }
            #[inline(always)]
            fn asinh(self) -> Self {
                $math::asinh(self)
            }
            #[inline(always)]
            fn acosh(self) -> Self {
                $math::acosh(self)
            }
            #[inline(always)]
            fn atanh(self) -> Self {
                $math::atanh(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $math::exp(self)
            }
            #[inline(always)]
            fn exp2(self) -> Self {
                $math::exp2(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $math::ln(self)
            }
            #[inline(always)]
            fn log2(self) -> Self {
                $math::log2(self)
            }
            #[inline(always)]
            fn radians(self) -> Self {
                self.to_radians()
            }
            #[inline(always)]
            fn degrees(self) -> Self {
                self.to_degrees()
            }
            #[inline(always)]
            fn frexp_fract(self) -> Self {
                let (scaled, _) = normal(self, $float::MIN_POSITIVE);
                const MANTISSA: u32 = $float::MANTISSA_DIGITS - 1;
                const HALF: $bits = (0.5 as $float).to_bits();
                const EXPONENT: $bits = ((1 << $exponent_bits) - 1) << MANTISSA;
                let fract = $float::from_bits(scaled.to_bits() & !EXPONENT | HALF);
                if self == 0.0 || !self.is_finite() { self } else { fract }
            }
            #[inline(always)]
            fn frexp_exponent(self) -> i32 {
                let (scaled, shift) = normal(self, $float::MIN_POSITIVE);
                const MANTISSA: u32 = $float::MANTISSA_DIGITS - 1;
                let bits = (scaled.to_bits() >> MANTISSA) & ((1 << $exponent_bits) - 1);
                let exponent = bits as i32 - ($float::MAX_EXP - 2) - shift;
                if self == 0.0 || !self.is_finite() { 0 } else { exponent }
            }
        }
    };
}

/// A subnormal number times 2^64, and 64; any other as it is, and 0.
#[inline(always)]
fn normal<T>(value: T, smallest: T) -> (T, i32)
where
    T: Copy + PartialOrd + std::ops::Mul<Output = T> + std::ops::Neg<Output = T> + From<f32>,
{
    let subnormal = value < smallest && value > -smallest;
    let scale = T::from(if subnormal { 18_446_744_073_709_551_616.0 } else { 1.0 });
    (value * scale, if subnormal { 64 } else { 0 })
}

scalar!(f32, u32, f32_math, 256, 8, |word, _wide| f32::from_bits(word), |four| four);
scalar!(f64, u64, f64_math, 128, 11, |_word, wide| f64::from_bits(wide), |four| [
    four[0].into(),
    four[1].into(),
    four[2].into(),
    four[3].into()
]);
