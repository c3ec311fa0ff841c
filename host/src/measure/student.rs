//! Student's t: how far a mean of few replicates may lie from the truth by chance, and when their spread says nothing.

use std::f64::consts::FRAC_PI_2;

/// One replicate holding more than this part of the variance makes an estimate doubtful.
pub const DOUBTFUL_SHARE: f64 = 0.5;

/// The smallest probability that [`quantile`] tells apart from none.
const LEAST: f64 = 1e-12;

/// The probability that |t| exceeds `t` (not negative) with `freedom` (at least 1) degrees of freedom.
///
/// The finite series for whole degrees (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4). It subtracts
/// from 1: figures below 1e-12 have no digits.
fn tails(t: f64, freedom: u32) -> f64 {
    let (sin, cos) = (t / f64::from(freedom).sqrt()).atan().sin_cos();
    let odd = freedom % 2 == 1;
    // 1 + 1/2 cos^2 + (1 3)/(2 4) cos^4 .. for even ones; cos + 2/3 cos^3 + .. for odd ones.
    let (mut term, mut sum) = (if odd { cos } else { 1.0 }, 0.0);
    for k in (u32::from(odd)..=freedom.saturating_sub(2)).step_by(2) {
        sum += term;
        term *= cos * cos * f64::from(k + 1) / f64::from(k + 2);
    }
    let inside = if odd { (sin.atan2(cos) + sin * sum) / FRAC_PI_2 } else { sin * sum };
    1.0 - inside
}

/// The t that |t| exceeds with probability `p` (from 1e-12 to 1), by bisection.
pub fn quantile(p: f64, freedom: u32) -> f64 {
    let p = p.clamp(LEAST, 1.0);
    let (mut low, mut high) = (0.0, 1.0);
    // Ends: the tails fall to 0 within the range of f64.
    while tails(high, freedom) > p {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if tails(middle, freedom) > p { low = middle } else { high = middle }
    }
    high
}

/// The level of one of `tests` independent tests that together are wrong with probability `p` (Sidak 1967).
pub fn sidak(p: f64, tests: f64) -> f64 {
    // 1 - (1 - p)^(1 / tests), without the loss of digits.
    -((-p).ln_1p() / tests).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the distribution (Abramowitz and Stegun 1964, table 26.10), and the closed forms of one
    /// and two degrees: P(|t| > x) = 1 - 2/pi atan x and 1 - x / sqrt(2 + x^2).
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (p, freedom, expected) in [
            (0.05, 1, 12.706),
            (0.05, 2, 4.303),
            (0.05, 15, 2.131),
            (0.01, 15, 2.947),
            (0.001, 15, 4.073),
            (0.05, 30, 2.042),
            (0.001, 30, 3.646),
            (0.01, 31, 2.744),
        ] {
            let found = quantile(p, freedom);
            assert!((found - expected).abs() < 6e-4, "{p} {freedom}: {found}");
        }
        assert!((tails(7.0, 1) - (1.0 - 7.0f64.atan() / FRAC_PI_2)).abs() < 1e-14);
        assert!((tails(7.0, 2) - (1.0 - 7.0 / 51.0f64.sqrt())).abs() < 1e-14);
        assert!((sidak(0.01, 1.0) - 0.01).abs() < 1e-16);
        assert!(((1.0 - sidak(0.01, 500.0)).powi(500) - 0.99).abs() < 1e-12);
    }

    /// The density integrated by Simpson's rule is a second way to the tails: with 15 degrees it is
    /// c (1 + x^2 / 15)^-8, whose factor c = G(8) / (sqrt(15 pi) G(7.5)) follows from products.
    #[test]
    fn tails_are_what_the_density_leaves() {
        // G(8) = 7!, G(7.5) = 6.5 * 5.5 * .. * 0.5 * sqrt(pi).
        let half: f64 = (0..7).map(|k| f64::from(k) + 0.5).product();
        let c = 5040.0 / (15.0f64.sqrt() * std::f64::consts::PI * half);
        let density = |x: f64| c * (1.0 + x * x / 15.0).powi(-8);
        for t in [0.5, 2.131, 6.5] {
            let (n, mut sum) = (2000, 0.0);
            for k in 0..=n {
                let weight = if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
                sum += weight * density(t * f64::from(k) / f64::from(n));
            }
            let inside = 2.0 * sum * t / f64::from(n) / 3.0;
            assert!((tails(t, 15) - (1.0 - inside)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn nothing_from_outside_makes_it_go_on_for_ever() {
        for freedom in [1, 2, 15, 255] {
            for p in [0.0, -1.0, 1.0, 2.0] {
                assert!(quantile(p, freedom).is_finite(), "{p} {freedom}");
            }
        }
    }
}
