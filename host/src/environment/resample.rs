//! The same layout with other texels: another size, or OpenEXR's pixels on the limits made into areas.
//!
//! Texels are cells of constant radiance. A new texel is the mean over its solid angle, from the exact overlap
//! of old and new cells, which are rectangles of each other here: the energy stays, to rounding.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::cube;

/// Where the cells of a row or column of pixels lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pixels {
    /// All of one width: pixel i of n from i / n to (i + 1) / n.
    Areas,
    /// Centres from limit to limit, as in OpenEXR's environment maps: the first and the last cell are half.
    OnLimits,
}

impl Pixels {
    /// Edges of `n` cells in [0, 1].
    fn edges(self, n: u32) -> Vec<f64> {
        let last = f64::from(n);
        match self {
            Self::OnLimits if n > 1 => {
                (0..=n).map(|i| ((f64::from(i) - 0.5) / (last - 1.0)).clamp(0.0, 1.0)).collect()
            }
            _ => (0..=n).map(|i| f64::from(i) / last).collect(),
        }
    }
}

/// A part of a new cell that lies in one old cell.
#[derive(Debug, Clone, Copy)]
struct Part {
    old: usize,
    from: f64,
    to: f64,
}

/// The parts of each new cell.
fn parts(old: &[f64], new: &[f64]) -> Vec<Vec<Part>> {
    let mut first = 0;
    let part = |cell: &[f64]| {
        while first + 2 < old.len() && old[first + 1] <= cell[0] {
            first += 1;
        }
        let mut parts = Vec::new();
        for index in first..old.len() - 1 {
            let (from, to) = (cell[0].max(old[index]), cell[1].min(old[index + 1]));
            if to > from {
                parts.push(Part { old: index, from, to });
            }
            if old[index + 1] >= cell[1] {
                break;
            }
        }
        parts
    };
    new.windows(2).map(part).collect()
}

/// A lat-long map of `old` columns and half as many rows at `new` columns and half as many rows.
pub fn lat_long(texels: &[[f32; 4]], old: u32, pixels: Pixels, new: u32) -> Vec<[f32; 4]> {
    let columns = parts(&pixels.edges(old), &Pixels::Areas.edges(new));
    let rows = parts(&pixels.edges(old / 2), &Pixels::Areas.edges(new / 2));
    let mean = |row: &Vec<Part>, column: &Vec<Part>| {
        let mut mean = Mean::default();
        for y in row {
            // cos t0 - cos t1 as a product, which keeps its digits at the poles.
            let height =
                2.0 * (PI * (y.from + y.to) / 2.0).sin() * (PI * (y.to - y.from) / 2.0).sin();
            for x in column {
                mean.add(texels[y.old * old as usize + x.old], height * (x.to - x.from));
            }
        }
        mean.texel()
    };
    rows.par_iter()
        .flat_map_iter(|row| columns.iter().map(move |column| mean(row, column)))
        .collect()
}

/// A cube with faces of `old` x `old` with faces of `new` x `new`.
pub fn cube(texels: &[[f32; 4]], old: u32, pixels: Pixels, new: u32) -> Vec<[f32; 4]> {
    let parts = parts(&pixels.edges(old), &Pixels::Areas.edges(new));
    let side = old as usize;
    let on_face = |part: &Part| [part.from, part.to].map(|place| 2.0 * place - 1.0);
    let mean = |face: usize, row: &Vec<Part>, column: &Vec<Part>| {
        let mut mean = Mean::default();
        for y in row {
            for x in column {
                let texel = texels[(face * side + y.old) * side + x.old];
                mean.add(texel, cube::solid_angle(on_face(x), on_face(y)));
            }
        }
        mean.texel()
    };
    (0..6 * new as usize)
        .into_par_iter()
        .flat_map_iter(|line| {
            let (face, row) = (line / new as usize, &parts[line % new as usize]);
            parts.iter().map(move |column| mean(face, row, column))
        })
        .collect()
}

/// A weighted mean of radiance.
#[derive(Debug, Clone, Copy, Default)]
pub struct Mean {
    sum: [f64; 3],
    weight: f64,
}

impl Mean {
    /// Adds a texel's radiance with a weight.
    pub fn add(&mut self, texel: [f32; 4], weight: f64) {
        for (sum, value) in self.sum.iter_mut().zip(texel) {
            *sum += weight * f64::from(value);
        }
        self.weight += weight;
    }

    /// The mean as a texel; black where nothing was added.
    pub fn texel(self) -> [f32; 4] {
        let scale = if self.weight > 0.0 { 1.0 / self.weight } else { 0.0 };
        let [r, g, b] = self.sum.map(|sum| (sum * scale) as f32);
        [r, g, b, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Vec<[f32; 4]> {
        values.iter().map(|value| [*value, *value, *value, 0.0]).collect()
    }

    #[test]
    fn pixels_on_the_limits_are_half_at_the_ends() {
        assert_eq!(Pixels::OnLimits.edges(4), [0.0, 0.5 / 3.0, 0.5, 2.5 / 3.0, 1.0]);
        assert_eq!(Pixels::OnLimits.edges(1), [0.0, 1.0]);
        assert_eq!(Pixels::Areas.edges(2), [0.0, 0.5, 1.0]);
        // Two rows on the limits are the two hemispheres; four columns: the first quarter is 1/6 of the
        // first pixel and 1/12 of the second, thirds: (2 a + b) / 3.
        let new =
            lat_long(&grey(&[3.0, 0.0, 0.0, 0.0, 6.0, 6.0, 6.0, 6.0]), 4, Pixels::OnLimits, 4);
        let reds: Vec<f32> = new.iter().map(|texel| texel[0]).collect();
        assert_eq!(reds, [2.0, 0.0, 0.0, 0.0, 6.0, 6.0, 6.0, 6.0]);
    }

    /// A texel that is twice as large is the mean of four by their solid angles; a row at 0 to 45 degrees
    /// beside one at 45 to 90 degrees weighs (1 - c) : c with c = cos 45.
    #[test]
    fn other_sizes_are_means_by_solid_angle() {
        let mut values = vec![0.0; 32];
        values[..8].fill(1.0);
        let new = lat_long(&grey(&values), 8, Pixels::Areas, 4);
        let share = 1.0 - (PI / 4.0).cos();
        assert!(new[..4].iter().all(|texel| (f64::from(texel[0]) - share).abs() < 1e-7));
        assert!(new[4..].iter().all(|texel| texel[0] == 0.0));
        let finer = lat_long(&grey(&[1.0, 2.0]), 2, Pixels::Areas, 6);
        let reds: Vec<f32> = finer.iter().take(6).map(|texel| texel[0]).collect();
        assert_eq!(reds, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);

        // A cube's own energy: the sum of radiance times solid angle.
        let energy = |texels: &[[f32; 4]], side: u32| -> f64 {
            let solid = |i: u32| cube::texel_solid_angle(side, i % side, i / side % side);
            texels.iter().enumerate().map(|(i, t)| f64::from(t[0]) * solid(i as u32)).sum()
        };
        let values: Vec<f32> = (0..6 * 25).map(|i| ((i * 37) % 101) as f32).collect();
        let old = grey(&values);
        for side in [1, 3, 4, 12] {
            let new = cube(&old, 5, Pixels::Areas, side);
            assert!((energy(&new, side) / energy(&old, 5) - 1.0).abs() < 1e-6, "{side}");
        }
        // Corner pixels on the limits are a quarter: a 2x2 face is its four quarters, as with areas.
        let two = grey(&(0..24).map(|i| i as f32).collect::<Vec<_>>());
        assert_eq!(cube(&two, 2, Pixels::OnLimits, 2), two);
    }
}
