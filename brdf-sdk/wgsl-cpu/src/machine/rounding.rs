//! Rounding to integers, the same in both precisions; written as the functions of `f64_math` are, and for the same
//! reasons: straight-line code with selects, which becomes vector code.

/// `round_even`, `floor`, `ceil`, `trunc` and `fract` of one type of floats; from `$integers` on all floats are
/// integers.
macro_rules! rounding {
    ($float:ident, $integers:expr) => {
        /// Rounds to an integer, ties to even, for any `x`; the sign of zero is that of `x`.
        #[inline(always)]
        pub fn round_even(x: $float) -> $float {
            const INTEGERS: $float = $integers;
            let shift = INTEGERS.copysign(x);
            let r = ((x + shift) - shift).copysign(x);
            select(x.abs() < INTEGERS, r, x)
        }

        /// Largest integer not above `x`, as std's `floor`.
        #[inline(always)]
        pub fn floor(x: $float) -> $float {
            let r = round_even(x);
            (r - select(r > x, 1.0, 0.0)).copysign(x)
        }

        /// Smallest integer not below `x`, as std's `ceil`.
        #[inline(always)]
        pub fn ceil(x: $float) -> $float {
            let r = round_even(x);
            (r + select(r < x, 1.0, 0.0)).copysign(x)
        }

        /// Integer part of `x`, as std's `trunc`.
        #[inline(always)]
        pub fn trunc(x: $float) -> $float {
            let a = x.abs();
            let r = round_even(a);
            (r - select(r > a, 1.0, 0.0)).copysign(x)
        }

        /// `x - floor(x)`, WGSL's `fract`; 1 is possible for a tiny negative `x`.
        #[inline(always)]
        pub fn fract(x: $float) -> $float {
            x - floor(x)
        }
    };
}
pub(super) use rounding;
