//! A figure that was measured several times.

use serde::{Deserialize, Serialize};

/// Median and ends of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The least.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

impl Spread {
    /// Of some values; `None` without any.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let (low, high) = (*values.first()?, *values.last()?);
        let middle = values.len() / 2;
        let median = match values.len() % 2 {
            1 => values[middle],
            _ => 0.5 * (values[middle - 1] + values[middle]),
        };
        Some(Self { median, low, high })
    }

    /// The distance of its ends as a part of the median.
    pub fn relative(&self) -> f64 {
        if self.high == self.low { 0.0 } else { (self.high - self.low) / self.median }
    }

    /// The same figure in another unit, or its reciprocal in another: `f` may fall.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        let [a, b] = [f(self.low), f(self.high)];
        Self { median: f(self.median), low: a.min(b), high: a.max(b) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_lies_in_the_middle() {
        assert_eq!(Spread::of([]), None);
        let three = Spread::of([3.0, 1.0, 2.0]).unwrap();
        assert_eq!(three, Spread { median: 2.0, low: 1.0, high: 3.0 });
        assert_eq!(three.relative(), 1.0);
        assert_eq!(Spread::of([4.0, 1.0, 2.0, 3.0]).unwrap().median, 2.5);
        // Rates of times: the least time is the largest rate.
        assert_eq!(three.map(|s| 6.0 / s), Spread { median: 3.0, low: 2.0, high: 6.0 });
        assert_eq!(Spread::of([0.0]).unwrap().relative(), 0.0);
    }
}
