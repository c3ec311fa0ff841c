//! Branch-free elementary functions in `f32` for lane loops that the compiler vectorises.
//!
//! Every function is straight-line code with selects only, so `for k in 0..n { d[k] = f(x[k]) }`
//! becomes vector code under SSE2, AVX2 and AVX-512 alike. (A select is `select_unpredictable`:
//! an `if` between values may be split into branches before the loop is vectorised.) Nothing
//! here uses a fused multiply-add, a table or libm, so all instruction sets give the same bits.
//!
//! The transcendental functions work in `f64` inside. That makes argument reduction (Cody and
//! Waite, "Software Manual for the Elementary Functions", 1980) nearly exact, turns subnormal
//! inputs into normal numbers, and leaves overflow and gradual underflow to the final rounding.
//! Polynomials are minimax fits (Remez exchange) of the relative error. Errors quoted are the
//! largest found against the C library's `f64` functions, over every 37th `f32` at least and for
//! two arguments over 6 * 10^7 pairs, in units of the last place (half is the best possible).

use super::f64_exp::{MANTISSA, clamp, log_edges};
use super::f64_math::{MAGIC, poly};
use super::rounding::rounding;
use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, LN_2, LOG2_E, PI};
use std::hint::select_unpredictable as select;

/// Largest `|x|` for which [`sin`], [`cos`] and [`tan`] keep their stated accuracy.
pub const TRIG_LIMIT: f32 = 1.0e7;

rounding!(f32, 8_388_608.0); // 2^23

/// `sin r` for `|r| <= pi/2`: odd polynomial, relative error 2^-35.
#[inline(always)]
fn sin_poly(r: f64) -> f64 {
    let z = r * r;
    let c = poly!(z; 1.0, -0.16666666631793714, 0.00833333132599985, -0.00019840894406589492,
        2.7526633347966282e-6, -2.390948672559519e-8);
    r * c
}

/// `(-1)^n sin(x - (n + shift) pi)` where `m = n + MAGIC`; pi in two parts, the first of 30 bits.
#[inline(always)]
fn sin_reduced(x: f64, m: f64, shift: f64) -> f64 {
    let n = (m - MAGIC) + shift;
    let r = (x - n * 3.141592651605606) - n * 1.984187159361081e-9;
    f64::from_bits(sin_poly(r).to_bits() ^ (m.to_bits() << 63))
}

/// Sine. Reduction by multiples of pi, then one odd polynomial.
/// For `|x| <= TRIG_LIMIT`, up to 0.51 ulp.
#[inline(always)]
pub fn sin(x: f32) -> f32 {
    let x = x as f64;
    sin_reduced(x, x * FRAC_1_PI + MAGIC, 0.0) as f32
}

/// Cosine, as minus the sine of `x - (n + 1/2) pi`. For `|x| <= TRIG_LIMIT`, up to 0.51 ulp.
#[inline(always)]
pub fn cos(x: f32) -> f32 {
    let x = x as f64;
    -sin_reduced(x, (x * FRAC_1_PI - 0.5) + MAGIC, 0.5) as f32
}

/// Tangent: reduction by multiples of pi/2, then the quotient of two polynomials.
/// For `|x| <= TRIG_LIMIT`, up to 0.57 ulp.
#[inline(always)]
pub fn tan(x: f32) -> f32 {
    let x = x as f64;
    let m = x * FRAC_2_PI + MAGIC;
    let n = m - MAGIC;
    let r = (x - n * 1.570796325802803) - n * 9.920935796805404e-10;
    let z = r * r;
    let c = poly!(z; 1.0, -0.166666549402052, 0.008332177916484928, -0.00019517266837854437);
    let s = r * c;
    let c = poly!(z; 1.0, -0.5, 0.041666646860851454, -0.001388736722375881,
        2.4438416408065038e-5);
    let odd = m.to_bits() & 1 != 0;
    let num = select(odd, -c, s);
    let den = select(odd, s, c);
    (num / den) as f32
}

/// `asin t` for `0 <= t <= 1/2`: odd polynomial, relative error 2^-31.
#[inline(always)]
fn asin_poly(t: f64) -> f64 {
    let z = t * t;
    let p = poly!(z; 0.16666659872193504, 0.07500510911873788, 0.04451572022763784,
        0.03181761729924241, 0.014402571973572954, 0.037565260057937);
    t + t * z * p
}

/// Arcsine; NaN beyond [-1, 1]. For `|x| > 1/2`, `asin x = pi/2 - 2 asin sqrt((1 - x)/2)`.
/// Up to 0.51 ulp.
#[inline(always)]
pub fn asin(x: f32) -> f32 {
    let a = x.abs() as f64;
    let far = a > 0.5;
    let p = asin_poly(select(far, (0.5 - 0.5 * a).sqrt(), a));
    let r = select(far, FRAC_PI_2 - 2.0 * p, p);
    (r as f32).copysign(x)
}

/// Arccosine; NaN beyond [-1, 1]. Same reduction as [`asin`]. Up to 0.51 ulp.
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let x = x as f64;
    let a = x.abs();
    let far = a > 0.5;
    let p = asin_poly(select(far, (0.5 - 0.5 * a).sqrt(), a));
    let p = select(far, 2.0 * p, FRAC_PI_2 - p);
    select(x < 0.0, PI - p, p) as f32
}

/// `atan(num / den)` for `0 <= num <= den`, `den > 0`: above `tan(pi/8)` reduced to
/// `pi/4 + atan((num - den) / (num + den))`, so that one short polynomial (relative error 2^-30) serves.
#[inline(always)]
fn atan_unit(num: f64, den: f64) -> f64 {
    let far = num > den * 0.41421356237309503;
    let q = (num - select(far, den, 0.0)) / (den + select(far, num, 0.0));
    let z = q * q;
    let c = poly!(z; -0.33333315501761396, 0.19998489202119488, -0.14243843951373364,
        0.10595963848768099, -0.06083352626683962);
    let p = z * c;
    (q + q * p) + select(far, FRAC_PI_4, 0.0)
}

/// Arctangent. Up to 0.51 ulp.
#[inline(always)]
pub fn atan(x: f32) -> f32 {
    let a = x.abs() as f64;
    let steep = a > 1.0;
    let p = atan_unit(select(steep, 1.0, a), select(steep, a, 1.0));
    (select(steep, FRAC_PI_2 - p, p) as f32).copysign(x)
}

/// Angle of the point `(x, y)`, with IEEE's signed zeros and infinities as `f32::atan2`.
/// Up to 0.51 ulp.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    // Bounds far outside f32's range make 1 of inf/inf and 0 of 0/0; a NaN stays.
    const HUGE: f64 = 1e300;
    const TINY: f64 = 1e-100;
    let w = x as f64;
    let (ay, ax) = (y.abs() as f64, w.abs());
    let steep = ay > ax;
    let num = select(steep, ax, ay);
    let den = select(steep, ay, ax);
    let num = select(num > HUGE, HUGE, num);
    let den = select(den > HUGE, HUGE, den);
    let p = atan_unit(num, select(den < TINY, TINY, den));
    let p = select(steep, FRAC_PI_2 - p, p);
    let p = select(w.is_sign_negative(), PI - p, p);
    (p as f32).copysign(y)
}

/// `2^n e^r` where `m = n + MAGIC` and `|r| <= ln 2 / 2`; relative error 2^-34.
#[inline(always)]
fn scaled_exp(m: f64, r: f64) -> f64 {
    let p = poly!(r; 1.0, 1.0, 0.500000007831944, 0.16666666862043877, 0.041666268521329645,
        0.008333264039184165, 0.0013946175991492538, 0.0001991855959769645);
    f64::from_bits(p.to_bits().wrapping_add(m.to_bits() << 52))
}

/// `e^x` in `f64`, for a NaN or `|x| <= 700`.
#[inline(always)]
fn exp_f64(x: f64) -> f64 {
    let m = x * LOG2_E + MAGIC;
    scaled_exp(m, x - (m - MAGIC) * LN_2)
}

/// `2^x` in `f64`, for a NaN or `|x| <= 1000`.
#[inline(always)]
fn exp2_f64(x: f64) -> f64 {
    let m = x + MAGIC;
    scaled_exp(m, (x - (m - MAGIC)) * LN_2)
}

/// `e^x`: Cody and Waite reduction by ln 2, polynomial of degree 7. Up to 0.51 ulp.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    exp_f64(clamp(x as f64, 200.0)) as f32
}

/// `2^x`. Up to 0.51 ulp.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    exp2_f64(clamp(x as f64, 300.0)) as f32
}

/// `(k, ln m)` with `x = 2^k m`, `m` in `[sqrt 1/2, sqrt 2)`, for a positive normal `x`:
/// `ln m = 2 artanh s` with `s = (m - 1)/(m + 1)`, relative error 2^-44.
#[inline(always)]
fn ln_parts(x: f64) -> (f64, f64) {
    const OFFSET: u64 = 0x3fe6_a09e_667f_3bcd;
    let t = x.to_bits().wrapping_add(0x3ff0_0000_0000_0000 - OFFSET);
    let k = f64::from_bits((t >> 52) | 0x4330_0000_0000_0000) - (4_503_599_627_370_496.0 + 1023.0);
    let m = f64::from_bits((t & MANTISSA).wrapping_add(OFFSET));
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let p = poly!(z; 2.0, 0.6666666667580402, 0.39999995620920215, 0.28572109243683985,
        0.22176185537333445, 0.1958419208376509);
    (k, s * p)
}

/// Natural logarithm in `f64`, of any `f32` or positive normal value.
#[inline(always)]
fn ln_f64(x: f64) -> f64 {
    let (k, l) = ln_parts(x);
    log_edges(x, k * LN_2 + l)
}

/// Binary logarithm in `f64`, of any `f32` or positive normal value.
#[inline(always)]
fn log2_f64(x: f64) -> f64 {
    let (k, l) = ln_parts(x);
    log_edges(x, k + l * LOG2_E)
}

/// Natural logarithm. Up to 0.51 ulp.
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    ln_f64(x as f64) as f32
}

/// Binary logarithm, exact for powers of two. Up to 0.51 ulp.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    log2_f64(x as f64) as f32
}

/// `x^y` as `2^(y log2 x)`, for `x >= 0`; a negative `x` gives NaN and -0 counts as +0.
/// Otherwise as `f32::powf`, also for infinities, `pow(x, 0) = 1` and `pow(1, y) = 1`.
/// Up to 0.51 ulp.
#[inline(always)]
pub fn pow(x: f32, y: f32) -> f32 {
    let r = exp2_f64(clamp(y as f64 * log2_f64(x as f64), 300.0)) as f32;
    let r = select((y == 0.0) | (x == 1.0), 1.0, r);
    select(x < 0.0, f32::NAN, r)
}

/// `sinh x` for `|x| <= 1`: odd polynomial, relative error 2^-34.
#[inline(always)]
fn sinh_poly(x: f64) -> f64 {
    let z = x * x;
    let p = poly!(z; 0.16666666488716655, 0.008333350598211258, 0.00019836066216550533,
        2.8174398213535688e-6);
    x + x * z * p
}

/// Hyperbolic sine: odd polynomial up to 1, then `(e^x - e^-x)/2`. Up to 0.51 ulp.
#[inline(always)]
pub fn sinh(x: f32) -> f32 {
    let a = x.abs() as f64;
    let e = exp_f64(clamp(a, 200.0));
    let r = select(a < 1.0, sinh_poly(a), 0.5 * (e - 1.0 / e));
    (r as f32).copysign(x)
}

/// Hyperbolic cosine, `(e^x + e^-x)/2`. Up to 0.51 ulp.
#[inline(always)]
pub fn cosh(x: f32) -> f32 {
    let e = exp_f64(clamp(x as f64, 200.0));
    (0.5 * (e + 1.0 / e)) as f32
}

/// Hyperbolic tangent: `s / sqrt(1 + s^2)` with `s = sinh x` up to 1, then
/// `1 - 2/(e^2x + 1)`. Up to 0.51 ulp.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    let a = x.abs() as f64;
    let s = sinh_poly(a);
    let near = s / (1.0 + s * s).sqrt();
    let far = 1.0 - 2.0 / (exp_f64(clamp(a + a, 200.0)) + 1.0);
    (select(a < 1.0, near, far) as f32).copysign(x)
}

/// Below this the first two terms of the series serve the inverse hyperbolic functions.
const SMALL: f64 = 1.0 / 4096.0;

/// Inverse hyperbolic sine, `ln(x + sqrt(x^2 + 1))`. Up to 0.51 ulp.
#[inline(always)]
pub fn asinh(x: f32) -> f32 {
    let a = x.abs() as f64;
    let r = ln_f64(a + (a * a + 1.0).sqrt());
    let r = select(a < SMALL, a - a * a * a * (1.0 / 6.0), r);
    (r as f32).copysign(x)
}

/// Inverse hyperbolic cosine, `ln(x + sqrt(x^2 - 1))`; NaN below 1. Up to 0.51 ulp.
#[inline(always)]
pub fn acosh(x: f32) -> f32 {
    let w = x as f64;
    let r = ln_f64(w + (w * w - 1.0).sqrt()) as f32;
    select(x < 1.0, f32::NAN, r)
}

/// Inverse hyperbolic tangent, `ln((1 + x)/(1 - x))/2`; NaN beyond [-1, 1]. Up to 0.51 ulp.
#[inline(always)]
pub fn atanh(x: f32) -> f32 {
    let w = x as f64;
    let r = 0.5 * ln_f64((1.0 + w) / (1.0 - w));
    select(w.abs() < SMALL, w + w * w * w * (1.0 / 3.0), r) as f32
}

/// WGSL's `i32(x)`: truncates, clamps to the range and takes NaN to 0, as `x as i32`.
#[inline(always)]
pub fn to_i32(x: f32) -> i32 {
    let magnitude = to_u32(x.abs());
    let below = magnitude.min(1 << 31).wrapping_neg();
    let above = magnitude.min(i32::MAX as u32);
    select(x < 0.0, below, above) as i32
}

/// WGSL's `u32(x)`: truncates, clamps to the range and takes NaN to 0, as `x as u32`.
#[inline(always)]
pub fn to_u32(x: f32) -> u32 {
    const END: f32 = 4_294_967_296.0;
    // 2^23: behind it stand integers, by their bits.
    const INTEGERS: f32 = 8_388_608.0;
    let positive = select(x > 0.0, x, 0.0);
    // The upper and the lower 16 bits, each floored; both are exact, scaled by powers of two.
    let scaled = select(positive < END, positive, 0.0) * (1.0 / 65_536.0);
    let nearest = (scaled + INTEGERS) - INTEGERS;
    let high = nearest - select(nearest > scaled, 1.0, 0.0);
    let rest = (scaled - high) * 65_536.0;
    let nearest = (rest + INTEGERS) - INTEGERS;
    let low = nearest - select(nearest > rest, 1.0, 0.0);
    let bits = |whole: f32| (whole + INTEGERS).to_bits() & 0xffff;
    select(positive < END, bits(high) << 16 | bits(low), u32::MAX)
}

/// Where [`to_index`] is right: below 2^22.
#[inline(always)]
pub fn in_index_range(x: f32) -> bool {
    x < 4_194_304.0
}

/// [`to_u32`] of numbers as small as those of texels and entries, in a third of its time.
#[inline(always)]
pub fn to_index(x: f32) -> u32 {
    const INTEGERS: f32 = 8_388_608.0;
    let positive = select(x > 0.0, x, 0.0);
    let nearest = positive + INTEGERS;
    let above = select(nearest - INTEGERS > positive, 1, 0);
    (nearest.to_bits() & 0x7f_ffff).wrapping_sub(above)
}

/// The nearest `f32`, ties to even.
#[inline(always)]
pub fn from_i32(x: i32) -> f32 {
    x as f32
}

/// The nearest `f32`, ties to even.
#[inline(always)]
pub fn from_u32(x: u32) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: [f32; 16] = [
        0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 1e-3, 1e-9, 1e-45, 1e-39, 88.7, 88.73, 103.9, 127.5,
        149.5,
    ];

    /// Notable values of both signs.
    fn edges() -> impl Iterator<Item = f32> {
        let extremes = [f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN];
        EDGES.into_iter().chain(extremes).flat_map(|x| [x, -x])
    }

    /// Whether `got` is within `ulps` of `want`; NaN, infinity and zero must be met exactly.
    fn near(got: f32, want: f64, ulps: f64) -> bool {
        let rounded = want as f32;
        if got.to_bits() == rounded.to_bits() || got.is_nan() && rounded.is_nan() {
            return true;
        }
        let exponent = (rounded.abs().min(f32::MAX).to_bits() >> 23).max(1) as i32 - 150;
        rounded != 0.0 && (got as f64 - want).abs() <= ulps * 2f64.powi(exponent)
    }

    fn check(f: fn(f32) -> f32, std: fn(f64) -> f64, limit: f32, ulps: f64) {
        let sweep = (0..=u32::MAX).step_by(40_009).map(f32::from_bits);
        for x in edges().chain(sweep) {
            if x.is_finite() && x.abs() > limit {
                continue;
            }
            let (got, want) = (f(x), std(x as f64));
            assert!(near(got, want, ulps), "{x:e}: {got:e}, not {want:e}");
        }
    }

    #[test]
    fn rounding_and_conversions() {
        check(floor, f64::floor, f32::MAX, 0.0);
        check(ceil, f64::ceil, f32::MAX, 0.0);
        check(trunc, f64::trunc, f32::MAX, 0.0);
        check(round_even, f64::round_ties_even, f32::MAX, 0.0);
        check(fract, |x| (x as f32 - (x as f32).floor()) as f64, f32::MAX, 0.0);
        check(|x| from_i32(to_i32(x)), |x| (x as i32 as f32) as f64, f32::MAX, 0.0);
        check(|x| from_u32(to_u32(x)), |x| (x as u32 as f32) as f64, f32::MAX, 0.0);
        let near_zero = |x: f32| if in_index_range(x) { to_index(x) } else { to_u32(x) };
        let whole = [1e6f32, 4_194_303.0, 4_194_304.0, 8_388_607.0, 16_777_216.0];
        let around =
            whole.into_iter().flat_map(|x| [x - 0.5, x.next_down(), x, x.next_up(), x + 0.5]);
        for x in edges().chain(around).chain((0..=u32::MAX).step_by(40_009).map(f32::from_bits)) {
            assert_eq!(near_zero(x), x as u32, "{x:e}");
        }
        for x in [2147483500f32, 2147483648.0, -2147483648.0, -2147484000.0, 4294967000.0] {
            assert_eq!((to_i32(x), to_u32(x)), (x as i32, x as u32));
        }
    }

    #[test]
    fn functions() {
        macro_rules! all {
            ($limit:expr; $($f:ident)*) => { $(check($f, f64::$f, $limit, 1.0);)* };
        }
        all!(TRIG_LIMIT; sin cos tan);
        all!(f32::MAX; asin acos atan exp exp2 ln log2 sinh cosh tanh asinh acosh atanh);
    }

    #[test]
    fn two_arguments() {
        let power = |x: f64, y: f64| if x < 0.0 { f64::NAN } else { x.abs().powf(y) };
        let both = |a: f32, b: f32| {
            let (x, y) = (a as f64, b as f64);
            assert!(near(atan2(a, b), x.atan2(y), 1.0), "atan2({a:e}, {b:e}): {:e}", atan2(a, b));
            assert!(near(pow(a, b), power(x, y), 1.0), "pow({a:e}, {b:e}): {:e}", pow(a, b));
        };
        edges().for_each(|a| edges().for_each(|b| both(a, b)));
        for k in (0..=u32::MAX).step_by(40_009) {
            let (a, b) = (f32::from_bits(k), f32::from_bits(k.wrapping_mul(0x9e37_79b1)));
            both(a, b);
            both(a, (b.to_bits() >> 8) as f32 * 4e-6 - 30.0);
            both(1.0 + (k >> 16) as f32 * 1e-6, (b.to_bits() >> 8) as f32 - 8e6);
        }
    }
}
