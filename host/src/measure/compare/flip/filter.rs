//! Filters over planes of numbers; beyond the edge the edge's value goes on.
//!
//! Every filter of FLIP is a sum of products of a row's and a column's weights, so that a pixel costs
//! two short sums in place of a square.

use rayon::prelude::*;

/// One number a pixel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Pixels in a row.
    pub width: usize,
    /// Row by row from the top.
    pub values: Vec<f64>,
}

impl Plane {
    /// The plane weighted along x by `across` and along y by `down`.
    pub fn filtered(&self, across: &[f64], down: &[f64]) -> Self {
        self.along_rows(across).along_columns(down)
    }

    fn along_rows(&self, weights: &[f64]) -> Self {
        let mut values = vec![0.0; self.values.len()];
        let rows = values.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width));
        rows.for_each(|(target, row)| {
            for (x, value) in target.iter_mut().enumerate() {
                let taps = weights.iter().enumerate();
                *value = taps.map(|(i, w)| w * row[place(x, i, weights, self.width)]).sum();
            }
        });
        Self { width: self.width, values }
    }

    fn along_columns(&self, weights: &[f64]) -> Self {
        let height = self.values.len() / self.width;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).enumerate().for_each(|(y, target)| {
            for (i, weight) in weights.iter().enumerate() {
                let row = &self.values[place(y, i, weights, height) * self.width..][..self.width];
                target.iter_mut().zip(row).for_each(|(value, source)| *value += weight * source);
            }
        });
        Self { width: self.width, values }
    }
}

/// Where tap `i` of a filter at `centre` reads, on a line of `length` numbers.
fn place(centre: usize, i: usize, weights: &[f64], length: usize) -> usize {
    (centre + i).saturating_sub(weights.len() / 2).min(length - 1)
}

/// f at the whole numbers from -radius to radius.
pub fn weights(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i64;
    (-radius..=radius).map(|offset| f(offset as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_goes_on_beyond_the_edge() {
        let plane = Plane { width: 3, values: vec![1.0, 2.0, 4.0, 10.0, 20.0, 40.0] };
        // Left neighbour minus right neighbour: 1 - 2, 1 - 4, 2 - 4 in the first row.
        let across = plane.filtered(&[1.0, 0.0, -1.0], &[1.0]);
        assert_eq!(across.values, [-1.0, -3.0, -2.0, -10.0, -30.0, -20.0]);
        // The pixel above plus twice itself; above the first row it is itself.
        let down = plane.filtered(&[1.0], &[1.0, 2.0, 0.0]);
        assert_eq!(down.values, [3.0, 6.0, 12.0, 21.0, 42.0, 84.0]);
        // Wider than the picture.
        let wide = plane.filtered(&weights(9, |x| if x == 9.0 { 1.0 } else { 0.0 }), &[1.0]);
        assert_eq!(wide.values, [4.0, 4.0, 4.0, 40.0, 40.0, 40.0]);
    }
}
