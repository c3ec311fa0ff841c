//! Branch-free exponentials, logarithms, powers and hyperbolic functions in `f64`: the second
//! half of `f64_math`, whose introduction holds here too.

use super::f64_math::{MAGIC, TWO_52, poly};
use std::f64::consts::{LN_2, LOG2_E};
use std::hint::select_unpredictable as select;

pub(super) const MANTISSA: u64 = (1 << 52) - 1;
/// The upper 26 of 53 significant bits.
const UPPER: u64 = !((1 << 27) - 1);

/// `x`'s upper half, of 26 bits, and the rest: products of halves are exact (Dekker 1971).
#[inline(always)]
fn halves(x: f64) -> (f64, f64) {
    let high = f64::from_bits(x.to_bits() & UPPER);
    (high, x - high)
}

/// `a b` as a rounded product and its rounding error.
#[inline(always)]
fn product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

/// `2^n (e^r)` where `m = n + MAGIC`, `|r| <= ln 2 / 2` and `|n| < 2000`. The power of two is
/// applied in two steps: only the second can overflow or round to a subnormal.
#[inline(always)]
fn scaled_exp(m: f64, r: f64) -> f64 {
    let c = poly!(r; 0.5, 0.16666666666666685, 0.04166666666666673,
        0.008333333333316617, 0.0013888888888858209, 0.00019841269897361943,
        2.480158737409264e-5, 2.755723392954036e-6, 2.7557233106646933e-7,
        2.5112348416370125e-8, 2.0927013291924297e-9);
    let p = r * r * c;
    let n = m.to_bits().wrapping_add(2048) & 4095;
    let half = n >> 1;
    let first = f64::from_bits((half - 1) << 52);
    let second = f64::from_bits((n - half - 1) << 52);
    (1.0 + (r + p)) * first * second
}

/// `x` held within `-limit ..= limit`; a NaN stays.
#[inline(always)]
pub(super) fn clamp(x: f64, limit: f64) -> f64 {
    let x = select(x > limit, limit, x);
    select(x < -limit, -limit, x)
}

/// `2^shift e^x`; ln 2 in two parts, the first of 32 bits.
#[inline(always)]
fn exp_shifted(x: f64, shift: f64) -> f64 {
    let x = clamp(x, 800.0);
    let m = x * LOG2_E + MAGIC;
    let n = m - MAGIC;
    let r = (x - n * 0.6931471803691238) - n * 1.9082149292705877e-10;
    scaled_exp(m + shift, r)
}

/// `2^(x + low)` for a small `low`.
#[inline(always)]
fn exp2_sum(x: f64, low: f64) -> f64 {
    let x = clamp(x, 1200.0);
    let m = x + MAGIC;
    scaled_exp(m, ((x - (m - MAGIC)) + low) * LN_2)
}

/// `e^x`. Up to 0.93 ulp.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    exp_shifted(x, 0.0)
}

/// `2^x`. Up to 0.98 ulp.
#[inline(always)]
pub fn exp2(x: f64) -> f64 {
    exp2_sum(x, 0.0)
}

/// `(k, m)` with `x = 2^k m` and `m` in `[sqrt 1/2, sqrt 2)`, for a positive finite `x`.
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    const OFFSET: u64 = 0x3fe6_a09e_667f_3bcd;
    let tiny = x < f64::MIN_POSITIVE;
    let x = select(tiny, x * TWO_52, x);
    let bias = TWO_52 + select(tiny, 1075.0, 1023.0);
    let t = x.to_bits().wrapping_add(0x3ff0_0000_0000_0000 - OFFSET);
    let k = f64::from_bits((t >> 52) | 0x4330_0000_0000_0000) - bias;
    (k, f64::from_bits((t & MANTISSA).wrapping_add(OFFSET)))
}

/// `(f, f^2/2, t)` with `ln m = f - f^2/2 + t` for `m` in `[sqrt 1/2, sqrt 2)` and `f = m - 1`;
/// from `ln m = 2 artanh(f/(2 + f))`, relative error 2^-58.
#[inline(always)]
fn ln_parts(m: f64) -> (f64, f64, f64) {
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let c = poly!(z; 0.6666666666666734, 0.3999999999941432, 0.28571428742473176,
        0.22222198563775872, 0.181835648472948, 0.15314036413648913, 0.14796099001645088);
    let p = z * c;
    let h = 0.5 * f * f;
    (f, h, s * (h + p))
}

/// A logarithm's `value`, put right where `x` is not a positive finite number.
#[inline(always)]
pub(super) fn log_edges(x: f64, value: f64) -> f64 {
    let r = select(x < f64::INFINITY, value, x);
    let edge = select(x == 0.0, f64::NEG_INFINITY, f64::NAN);
    select(x <= 0.0, edge, r)
}

/// `ln x + low` for a small `low`.
#[inline(always)]
fn ln_sum(x: f64, low: f64) -> f64 {
    let (k, m) = split(x);
    let (f, h, t) = ln_parts(m);
    let low = k * 1.9082149292705877e-10 + low;
    log_edges(x, k * 0.6931471803691238 - ((h - (t + low)) - f))
}

/// `ln(1 + x)` for `x > -1`: the rounding of `1 + x` enters as a correction.
#[inline(always)]
fn ln_1p(x: f64) -> f64 {
    let u = 1.0 + x;
    let c = (x - (u - 1.0)) / u;
    ln_sum(u, select(u < f64::INFINITY, c, 0.0))
}

/// Natural logarithm. Up to 0.83 ulp.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    ln_sum(x, 0.0)
}

/// Binary logarithm, exact for powers of two. Up to 0.83 ulp.
#[inline(always)]
pub fn log2(x: f64) -> f64 {
    // log2 e in two parts, the first of 26 bits.
    const HIGH: f64 = 1.4426950216293335;
    const LOW: f64 = 1.9259629911266175e-8;
    let (k, m) = split(x);
    let (f, h, t) = ln_parts(m);
    let (hi, _) = halves(f - h);
    let lo = ((f - hi) - h) + t;
    let v = hi * HIGH;
    let w = k + v;
    log_edges(x, w + (((k - w) + v) + ((lo + hi) * LOW + lo * HIGH)))
}

/// `log2 x` as an unevaluated sum, relative error about 2^-63.
#[inline(always)]
fn log2_pair(x: f64) -> (f64, f64) {
    // 2/ln 2 and a third of it, with what they exceed their `f64` by.
    const A: f64 = 2.8853900817779268;
    const A_LO: f64 = 4.0710547481862066e-17;
    const B: f64 = 0.9617966939259756;
    const B_LO: f64 = 5.0577616648125907e-17;
    let (k, m) = split(x);
    let f = m - 1.0;
    let d = m + 1.0;
    let d_lo = m - (d - 1.0);
    let inverse = 1.0 / d;
    let s = f * inverse;
    let (p, e) = product(s, d);
    let s_lo = (((f - p) - e) - s * d_lo) * inverse;
    let (z, e) = product(s, s);
    let z_lo = e + 2.0 * s * s_lo;
    let c = poly!(z; 0.577078016355618, 0.41219858309195606, 0.3205989022707154,
        0.2623077013713882, 0.22198398660185345, 0.19125541664769774, 0.19038309203691567);
    let tail = z * z * c;
    // v = A + B z + tail, then the logarithm s v.
    let (b, e) = product(z, B);
    let v = A + b;
    let v_lo = ((A - v) + b) + (A_LO + (e + (B * z_lo + B_LO * z) + tail));
    let (l, e) = product(s, v);
    let l_lo = e + (s * v_lo + s_lo * v);
    let high = k + l;
    (log_edges(x, high), ((k - high) + l) + l_lo)
}

/// `x^y` as `2^(y log2 x)` with the logarithm in double-double, for `x >= 0`; a negative `x`
/// gives NaN and -0 counts as +0. Otherwise as `f64::powf`, also for infinities,
/// `pow(x, 0) = 1` and `pow(1, y) = 1`. Up to 2.4 ulp.
#[inline(always)]
pub fn pow(x: f64, y: f64) -> f64 {
    let (l, l_lo) = log2_pair(x);
    let (p, e) = product(y, l);
    let low = e + y * l_lo;
    let r = exp2_sum(p, select(p.abs() < 2000.0, low, 0.0));
    let r = select((y == 0.0) | (x == 1.0), 1.0, r);
    select(x < 0.0, f64::NAN, r)
}

/// `sinh x` for `|x| <= 1`: odd polynomial, relative error 2^-63.
#[inline(always)]
fn sinh_poly(x: f64) -> f64 {
    let z = x * x;
    let c = poly!(z; 0.16666666666666669, 0.008333333333333139, 0.00019841269841437678,
        2.755731915533766e-6, 2.505212339840952e-8, 1.6057240353181863e-10,
        7.759311842391483e-13);
    x + x * z * c
}

/// Hyperbolic sine: odd polynomial up to 1, then `(e^x - e^-x)/2`. Up to 1.7 ulp.
#[inline(always)]
pub fn sinh(x: f64) -> f64 {
    let a = x.abs();
    let h = exp_shifted(a, -1.0);
    let r = select(a < 1.0, sinh_poly(a), h - 0.25 / h);
    r.copysign(x)
}

/// Hyperbolic cosine, `(e^x + e^-x)/2`. Up to 1.3 ulp.
#[inline(always)]
pub fn cosh(x: f64) -> f64 {
    let h = exp_shifted(x.abs(), -1.0);
    h + 0.25 / h
}

/// Hyperbolic tangent: `s / sqrt(1 + s^2)` with `s = sinh x` up to 1, then
/// `1 - 2/(e^2x + 1)`. Up to 2.5 ulp.
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let a = x.abs();
    let s = sinh_poly(a);
    let near = s / (1.0 + s * s).sqrt();
    let far = 1.0 - 2.0 / (exp_shifted(a + a, 0.0) + 1.0);
    select(a < 1.0, near, far).copysign(x)
}

/// From here on `x` absorbs 1, and the logarithm takes `2 x` instead of a root.
const LARGE: f64 = 1e17;

/// Inverse hyperbolic sine, `ln(1 + (x + x^2 / (1 + sqrt(x^2 + 1))))`. Up to 1.3 ulp.
#[inline(always)]
pub fn asinh(x: f64) -> f64 {
    let a = x.abs();
    let large = a > LARGE;
    let t = a + a * a / (1.0 + (a * a + 1.0).sqrt());
    let r = ln_1p(select(large, a, t));
    (r + select(large, LN_2, 0.0)).copysign(x)
}

/// Inverse hyperbolic cosine, `ln(1 + (t + sqrt(2 t + t^2)))` with `t = x - 1`; NaN below 1.
/// Up to 1.5 ulp.
#[inline(always)]
pub fn acosh(x: f64) -> f64 {
    let large = x > LARGE;
    let t = x - 1.0;
    let r = ln_1p(select(large, x, t + (2.0 * t + t * t).sqrt()));
    let r = r + select(large, LN_2, 0.0);
    select(x < 1.0, f64::NAN, r)
}

/// Inverse hyperbolic tangent, `ln(1 + 2 x/(1 - x))/2`; NaN beyond [-1, 1]. Up to 1.5 ulp.
#[inline(always)]
pub fn atanh(x: f64) -> f64 {
    let a = x.abs();
    let t = a + a;
    let t = select(a < 0.5, t + t * a / (1.0 - a), t / (1.0 - a));
    (0.5 * ln_1p(t)).copysign(x)
}
