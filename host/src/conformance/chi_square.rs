//! Whether counts are what a density expects: Pearson's chi-square test with pooled cells.

use statrs::function::gamma::checked_gamma_ur;

/// Cells that expect fewer draws are put together (Cochran 1952).
const LEAST_EXPECTED: f64 = 5.0;

/// The test's outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquare {
    /// Sum of (counted - expected)^2 / expected over the cells.
    pub statistic: f64,
    /// Cells after pooling, less the one that follows from the others.
    pub freedom: f64,
    /// Probability of a sum this large where the density is right.
    pub p: f64,
}

/// Compares counts with what is expected. Cells that expect too little are put together, with the next one
/// where they are still too few; draws where nothing at all is expected are another test's business.
pub fn chi_square(counts: &[u64], expected: &[f64]) -> ChiSquare {
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut statistic, mut cells) = (0.0, 0u32);
    let mut take = |count: f64, expected: f64| {
        statistic += match expected > 0.0 {
            true => (count - expected).powi(2) / expected,
            false if count > 0.0 => f64::INFINITY,
            false => 0.0,
        };
        cells += 1;
    };
    // The cells that expect least come first and fill the pool.
    let (mut pooled, mut pool, mut any) = (0.0, 0.0, false);
    let mut rest = order.as_slice();
    while let [cell, others @ ..] = rest
        && (expected[*cell] < LEAST_EXPECTED || (any && pool < LEAST_EXPECTED))
    {
        pooled += counts[*cell] as f64;
        pool += expected[*cell];
        any = true;
        rest = others;
    }
    if any {
        take(pooled, pool);
    }
    for cell in rest {
        take(counts[*cell] as f64, expected[*cell]);
    }
    let freedom = f64::from(cells.max(1) - 1);
    let p = match () {
        () if statistic.is_nan() || statistic == f64::INFINITY => 0.0,
        () if statistic == 0.0 => 1.0,
        // A single cell follows from nothing when it is not what all draws make.
        () => checked_gamma_ur(0.5 * freedom.max(1.0), 0.5 * statistic).unwrap_or(0.0),
    };
    ChiSquare { statistic, freedom, p }
}

/// The two-sided probability of a standard normal number as far out as `z`.
pub fn normal_tails(z: f64) -> f64 {
    if z.is_nan() { 0.0 } else { statrs::function::erf::erfc(z.abs() / std::f64::consts::SQRT_2) }
}

#[cfg(test)]
mod tests {
    use statrs::function::gamma::gamma_ur;

    use super::*;

    /// Tables of the distribution: Abramowitz and Stegun 1964, table 26.8; with two degrees it is exp(-x / 2).
    #[test]
    fn the_probability_is_that_of_the_tables() {
        for (freedom, x, p) in
            [(1.0, 3.841_46, 0.05), (10.0, 23.2093, 0.01), (100.0, 135.807, 0.01)]
        {
            let found: f64 = gamma_ur(0.5 * freedom, 0.5 * x);
            assert!((found / p - 1.0).abs() < 1e-3, "{found}");
        }
        let two = chi_square(&[120, 100, 80], &[100.0; 3]);
        assert!((two.statistic - 8.0).abs() < 1e-12 && two.freedom == 2.0);
        assert!((two.p - (-4.0f64).exp()).abs() < 1e-12);
        // Thousands of cells: by Wilson and Hilferty's approximation, good to 1e-3 there.
        let (k, x) = (4000.0f64, 4300.0f64);
        let z = ((x / k).cbrt() - (1.0 - 2.0 / (9.0 * k))) / (2.0 / (9.0 * k)).sqrt();
        let approximate = 0.5 * normal_tails(z);
        assert!((gamma_ur(0.5 * k, 0.5 * x) / approximate - 1.0).abs() < 1e-2);
        assert!((normal_tails(1.959_964) - 0.05).abs() < 1e-7);
    }

    #[test]
    fn cells_that_expect_little_are_one() {
        // 1 + 2 and then 4 of the poor cells: expected 7 together; the others stand alone.
        let found = chi_square(&[2, 1, 5, 100, 50], &[1.0, 2.0, 4.0, 101.0, 50.0]);
        assert_eq!(found.freedom, 2.0);
        assert!((found.statistic - (1.0 / 7.0 + 1.0 / 101.0)).abs() < 1e-12);
        // A pool that expects too little takes the next cell in.
        assert_eq!(chi_square(&[1, 6, 90], &[1.0, 6.0, 90.0]).freedom, 1.0);
    }

    #[test]
    fn draws_where_few_are_expected_fail() {
        assert_eq!(chi_square(&[50, 100], &[1e-9, 1e-9]).p, 0.0);
        assert!(chi_square(&[50, 100, 100], &[0.0, 100.0, 100.0]).p < 1e-5);
        assert_eq!(chi_square(&[0, 100, 50], &[0.0, 100.0, 50.0]).p, 1.0);
        // Both cells together have what they should: nothing is left to compare.
        assert_eq!(chi_square(&[3, 97], &[0.0, 100.0]).freedom, 0.0);
    }
}
