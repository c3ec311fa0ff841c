//! Branch-free elementary functions in `f64` for lane loops that the compiler vectorises:
//! rounding, trigonometry and conversions here, exponentials and logarithms in `f64_exp`.
//!
//! Every function is straight-line code with selects only, so `for k in 0..n { d[k] = f(x[k]) }`
//! becomes vector code under SSE2, AVX2 and AVX-512 alike. (A select is `select_unpredictable`:
//! an `if` between values may be split into branches before the loop is vectorised.) Nothing
//! here uses a fused multiply-add, a table or libm, so all instruction sets give the same bits.
//!
//! Arguments are reduced as by Cody and Waite ("Software Manual for the Elementary Functions",
//! 1980); polynomials are minimax fits (Remez exchange) of the relative error. Errors are in
//! units of the last place, the largest found: 10^7 inputs against std, and those that differed
//! against 160-bit arithmetic.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};
use std::hint::select_unpredictable as select;

pub use super::f64_exp::*;
use super::rounding::rounding;

/// Largest `|x|` for which [`sin`], [`cos`] and [`tan`] keep their stated accuracy.
pub const TRIG_LIMIT: f64 = 1.0e5;

/// 1.5 * 2^52: adding it rounds to an integer held in the low bits.
pub(super) const MAGIC: f64 = 6_755_399_441_055_744.0;
pub(super) const TWO_52: f64 = 4_503_599_627_370_496.0;
/// What pi/2 and pi exceed their `f64` by.
const FRAC_PI_2_LO: f64 = 6.123233995736766e-17;
const PI_LO: f64 = 1.2246467991473532e-16;

/// `c0 + x c1 + x^2 c2 + ...`, in pairs of terms: half the latency of Horner's rule.
macro_rules! poly {
    ($x:expr; $($c:expr),+) => {{
        let x = $x;
        let square = x * x;
        poly!(@ x, square; $($c),+)
    }};
    (@ $x:ident, $s:ident; $a:expr) => { $a };
    (@ $x:ident, $s:ident; $a:expr, $b:expr) => { ($a + $x * $b) };
    (@ $x:ident, $s:ident; $a:expr, $b:expr, $($c:expr),+) => {
        ($a + $x * $b) + $s * poly!(@ $x, $s; $($c),+)
    };
}
pub(super) use poly;

rounding!(f64, TWO_52);

/// `(r, e, m)` with `x = n pi/2 + r + e`, `|r| <= pi/4` and `m = n + MAGIC`. The first two of
/// pi/2's three parts have 33 bits, so that their products with `n` are exact.
#[inline(always)]
fn reduce(x: f64) -> (f64, f64, u64) {
    let m = x * FRAC_2_PI + MAGIC;
    let n = m - MAGIC;
    let a = x - n * 1.5707963267341256;
    let w = n * 6.077100506303966e-11;
    let b = a - w;
    let w = n * 2.0222662487959506e-21 - ((a - b) - w);
    let r = b - w;
    (r, (b - r) - w, m.to_bits())
}

/// `sin(r + e)` for `|r| <= pi/4`, relative error of the polynomial 2^-58.
#[inline(always)]
fn sin_poly(r: f64, e: f64) -> f64 {
    let z = r * r;
    let p = poly!(z; -0.16666666666666632, 0.008333333333322418, -0.00019841269829812353,
        2.755731369357077e-6, -2.5050758384834086e-8, 1.5896811858059738e-10);
    r + (r * z * p + e * (1.0 - 0.5 * z))
}

/// `cos(r + e)` for `|r| <= pi/4`, relative error of the polynomial 2^-64.
#[inline(always)]
fn cos_poly(r: f64, e: f64) -> f64 {
    let z = r * r;
    let p = poly!(z; 0.0416666666666666, -0.0013888888888874131, 2.480158728948717e-5,
        -2.7557314353829943e-7, 2.08757234842009e-9, -1.1359659099382371e-11);
    let h = 0.5 * z;
    let w = 1.0 - h;
    w + (((1.0 - w) - h) + (z * z * p - r * e))
}

/// Sine or cosine of `x` by quadrant `q`: the cosine polynomial for odd `q`, minus for bit 1.
#[inline(always)]
fn quadrant(r: f64, e: f64, q: u64) -> f64 {
    let (s, c) = (sin_poly(r, e), cos_poly(r, e));
    let v = select(q & 1 == 0, s, c);
    f64::from_bits(v.to_bits() ^ ((q & 2) << 62))
}

/// Sine. For `|x| <= TRIG_LIMIT`, up to 0.79 ulp.
#[inline(always)]
pub fn sin(x: f64) -> f64 {
    let (r, e, q) = reduce(x);
    let v = quadrant(r, e, q);
    select(x == 0.0, x, v)
}

/// Cosine. For `|x| <= TRIG_LIMIT`, up to 0.75 ulp.
#[inline(always)]
pub fn cos(x: f64) -> f64 {
    let (r, e, q) = reduce(x);
    quadrant(r, e, q.wrapping_add(1))
}

/// Tangent, as the quotient of sine and cosine. For `|x| <= TRIG_LIMIT`, up to 2.2 ulp.
#[inline(always)]
pub fn tan(x: f64) -> f64 {
    let (r, e, q) = reduce(x);
    let (s, c) = (sin_poly(r, e), cos_poly(r, e));
    let odd = q & 1 != 0;
    let v = select(odd, -c, s) / select(odd, s, c);
    select(x == 0.0, x, v)
}

/// `asin t - t` for `0 <= t <= 1/2` and `z = t^2`, relative error of the sum 2^-60.
#[inline(always)]
fn asin_tail(t: f64, z: f64) -> f64 {
    let c = poly!(z; 0.16666666666666763, 0.07499999999970268, 0.044642857175115555,
        0.030381942683846183, 0.02237221565430579, 0.01735160019347333, 0.013980960291699807,
        0.011397785062879529, 0.010786480285034435, 0.0036832188285302278,
        0.021763085680645836, -0.021076729523525125, 0.03267655108167396);
    t * z * c
}

/// `(t, asin t - t, far)`: where `far`, `|x| > 1/2` and `t = sqrt((1 - |x|)/2)`, else `t = |x|`.
#[inline(always)]
fn asin_reduced(x: f64) -> (f64, f64, bool) {
    let a = x.abs();
    let far = a > 0.5;
    let h = 0.5 - 0.5 * a;
    let t = select(far, h.sqrt(), a);
    (t, asin_tail(t, select(far, h, a * a)), far)
}

/// Arcsine; NaN beyond [-1, 1]. For `|x| > 1/2`, `asin x = pi/2 - 2 asin sqrt((1 - x)/2)`.
/// Up to 1.1 ulp.
#[inline(always)]
pub fn asin(x: f64) -> f64 {
    let (t, p, far) = asin_reduced(x);
    let d = FRAC_PI_2 - 2.0 * t;
    let lo = FRAC_PI_2_LO + ((FRAC_PI_2 - d) - 2.0 * t);
    let r = select(far, d - (2.0 * p - lo), t + p);
    r.copysign(x)
}

/// Arccosine; NaN beyond [-1, 1]. Same reduction as [`asin`]. Up to 1.1 ulp.
#[inline(always)]
pub fn acos(x: f64) -> f64 {
    let (t, p, far) = asin_reduced(x);
    let negative = x < 0.0;
    let s = 2.0 * (t + p);
    let s = select(negative, PI - (s - PI_LO), s);
    let (t, p) = (t.copysign(x), p.copysign(x));
    let near = FRAC_PI_2 - (t + (p - FRAC_PI_2_LO));
    select(far, s, near)
}

/// The angle of `(den, num)`, both of any magnitude but not negative, `num <= den` and `den > 0`,
/// taken from `base` quarter turns of pi/4 in the direction `sign` (1 or -1). Above `tan(pi/8)`
/// it is `pi/4 + atan((num - den) / (num + den))`.
#[inline(always)]
fn turn(num: f64, den: f64, base: f64, sign: f64) -> f64 {
    // pi/4 in two parts: the first ends in two zero bits, so up to four times it is exact.
    const STEP: f64 = FRAC_PI_4;
    const STEP_LO: f64 = 3.061616997868383e-17;
    let far = num > den * 0.41421356237309503;
    let q = sign * (num - select(far, den, 0.0)) / (den + select(far, num, 0.0));
    let z = q * q;
    let c = poly!(z; -0.333333333333332, 0.19999999999954066, -0.1428571428024686,
        0.11111110786051749, -0.0909089783386655, 0.07692061589351996, -0.06663119821353264,
        0.05848004689423505, -0.05039825902848614, 0.038077809363371275,
        -0.017921705256089573);
    let p = q * z * c;
    let base = base + select(far, sign, 0.0);
    base * STEP + (q + (p + base * STEP_LO))
}

/// Arctangent. Up to 1.9 ulp.
#[inline(always)]
pub fn atan(x: f64) -> f64 {
    let a = x.abs();
    let steep = a > 1.0;
    let num = select(steep, 1.0, a);
    let den = select(steep, a, 1.0);
    let base = select(steep, 2.0, 0.0);
    turn(num, den, base, select(steep, -1.0, 1.0)).copysign(x)
}

/// Angle of the point `(x, y)`, with IEEE's signed zeros and infinities as `f64::atan2`.
/// Up to 1.9 ulp.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    const HUGE: f64 = 1e300;
    const TINY: f64 = 1e-290;
    let (ay, ax) = (y.abs(), x.abs());
    let steep = ay > ax;
    let num = select(steep, ax, ay);
    let den = select(steep, ay, ax);
    // Neither overflow nor subnormals; inf/inf counts as 1/1 and 0/0 as 0/1. A NaN stays.
    let scale = select(den > HUGE, 0.25, 1.0);
    let scale = select(den < TINY, TWO_52, scale);
    let inf = (num == f64::INFINITY) & (den == num);
    let num = select(inf, 1.0, num * scale);
    let den = select(inf | (den == 0.0), 1.0, den * scale);
    let base = select(steep, 2.0, 0.0);
    let sign = select(steep, -1.0, 1.0);
    let left = x.is_sign_negative();
    let base = select(left, 4.0 - base, base);
    turn(num, den, base, select(left, -sign, sign)).copysign(y)
}

/// `x` truncated and held within `low ..= high`, NaN as `low`: the integer's low 32 bits.
#[inline(always)]
fn to_bits(x: f64, low: f64, high: f64) -> u32 {
    let x = select(x > low, x, low);
    let x = select(x < high, x, high);
    let a = x.abs();
    let r = (a + MAGIC) - MAGIC;
    let r = r - select(r > a, 1.0, 0.0);
    (r.copysign(x) + MAGIC).to_bits() as u32
}

/// WGSL's `i32(x)`: truncates, clamps to the range and takes NaN to 0, as `x as i32`.
#[inline(always)]
pub fn to_i32(x: f64) -> i32 {
    to_bits(select(x.is_nan(), 0.0, x), i32::MIN as f64, i32::MAX as f64) as i32
}

/// WGSL's `u32(x)`: truncates, clamps to the range and takes NaN to 0, as `x as u32`.
#[inline(always)]
pub fn to_u32(x: f64) -> u32 {
    to_bits(x, 0.0, u32::MAX as f64)
}

/// Where [`to_index`] is right.
#[inline(always)]
pub fn in_index_range(_x: f64) -> bool {
    true
}

/// [`to_u32`], which costs little for any number.
#[inline(always)]
pub fn to_index(x: f64) -> u32 {
    to_u32(x)
}

/// Exact.
#[inline(always)]
pub fn from_i32(x: i32) -> f64 {
    x as f64
}

/// Exact.
#[inline(always)]
pub fn from_u32(x: u32) -> f64 {
    x as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: [f64; 20] = [
        0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 1e-3, 1e-9, 5e-324, 1e-310, 1e5, 700.0, 709.7, 710.2,
        745.1, 746.0, 1022.5, 1074.5, 1e300,
    ];

    /// Notable values of both signs.
    fn edges() -> impl Iterator<Item = f64> {
        let extremes = [f64::MIN_POSITIVE, f64::MAX, f64::INFINITY, f64::NAN];
        EDGES.into_iter().chain(extremes).flat_map(|x| [x, -x])
    }

    /// Whether `got` is within `ulps` of `want`; NaN, infinity and zero must be met exactly.
    fn near(got: f64, want: f64, ulps: u64) -> bool {
        let (g, w) = (got.to_bits(), want.to_bits());
        g == w || got.is_nan() && want.is_nan() || want != 0.0 && g.abs_diff(w) <= ulps
    }

    /// Uniform in [0, 1).
    fn random(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64
    }

    fn check(f: fn(f64) -> f64, std: fn(f64) -> f64, limit: f64, ulps: u64) {
        let mut seed = 1;
        let random = (0..40_000).flat_map(|k| {
            let (u, v) = (random(&mut seed), random(&mut seed));
            let exponents = if k % 2 == 0 { 2098.0 } else { 20.0 };
            [u * 4.0 - 2.0, u * 200.0 - 100.0, (v + 1.0) * ((u - 0.5) * exponents).exp2()]
        });
        for x in edges().chain(random) {
            if x.is_finite() && x.abs() > limit {
                continue;
            }
            let (got, want) = (f(x), std(x));
            assert!(near(got, want, ulps), "{x:e}: {got:e}, not {want:e}");
        }
    }

    #[test]
    fn rounding() {
        check(floor, f64::floor, f64::MAX, 0);
        check(ceil, f64::ceil, f64::MAX, 0);
        check(trunc, f64::trunc, f64::MAX, 0);
        check(round_even, f64::round_ties_even, f64::MAX, 0);
        check(fract, |x| x - x.floor(), f64::MAX, 0);
    }

    #[test]
    fn conversions() {
        check(|x| to_i32(x) as f64, |x| x as i32 as f64, f64::MAX, 0);
        check(|x| to_u32(x) as f64, |x| x as u32 as f64, f64::MAX, 0);
        for x in
            [2147483647.5, 2147483648.0, -2147483648.5, -2147483649.0, 4294967295.5, 4294967296.0]
        {
            assert_eq!((to_i32(x), to_u32(x)), (x as i32, x as u32));
        }
        assert_eq!((from_i32(i32::MIN), from_u32(u32::MAX)), (-2147483648.0, 4294967295.0));
    }

    #[test]
    fn trigonometry() {
        check(sin, f64::sin, TRIG_LIMIT, 2);
        check(cos, f64::cos, TRIG_LIMIT, 2);
        check(tan, f64::tan, TRIG_LIMIT, 4);
        check(asin, f64::asin, f64::MAX, 2);
        check(acos, f64::acos, f64::MAX, 2);
        check(atan, f64::atan, f64::MAX, 2);
    }

    #[test]
    fn exponentials() {
        check(exp, f64::exp, f64::MAX, 2);
        check(exp2, f64::exp2, f64::MAX, 2);
        check(ln, f64::ln, f64::MAX, 2);
        check(log2, f64::log2, f64::MAX, 2);
        check(sinh, f64::sinh, f64::MAX, 4);
        check(cosh, f64::cosh, f64::MAX, 4);
        check(tanh, f64::tanh, f64::MAX, 4);
        // std's own formulas for the inverses overflow early and are less exact near 1 or for x < 0.
        let std_acosh = |x: f64| {
            let t = x - 1.0;
            if x < 1.0 { f64::NAN } else { (t + (2.0 * t + t * t).sqrt()).ln_1p() }
        };
        check(asinh, f64::asinh, 1e150, 5);
        check(acosh, std_acosh, 1e150, 5);
        check(atanh, |x| x.abs().atanh().copysign(x), f64::MAX, 5);
        assert!(near(asinh(-f64::MAX), -710.4758600739439, 1));
        assert!(near(acosh(f64::MAX), 710.4758600739439, 1));
    }

    #[test]
    fn two_arguments() {
        let power = |x: f64, y: f64| if x < 0.0 { f64::NAN } else { x.abs().powf(y) };
        let both = |a: f64, b: f64| {
            let (got, want) = (atan2(a, b), a.atan2(b));
            assert!(near(got, want, 2), "atan2({a:e}, {b:e}): {got:e}, not {want:e}");
            let (got, want) = (pow(a, b), power(a, b));
            assert!(near(got, want, 4), "pow({a:e}, {b:e}): {got:e}, not {want:e}");
        };
        edges().for_each(|a| edges().for_each(|b| both(a, b)));
        let mut seed = 1;
        for _ in 0..40_000 {
            let (u, v) = (random(&mut seed), random(&mut seed));
            both((u * 2000.0 - 1000.0).exp2(), v * 4.0 - 2.0);
            both(u * 40.0, v * 400.0 - 200.0);
            both(1.0 + u * 1e-6, v * 1e9 - 5e8);
        }
    }
}
