//! MERL: isotropic materials tabulated over half and difference angles (Matusik et al. 2003).
//!
//! A file holds three 32-bit sizes (theta_h, theta_d, phi_d), then the planes red, green and blue in 64-bit
//! floats, phi_d fastest. Bin i of theta_h begins at (i / 90)^2 of 90 degrees; the other angles are cut evenly.
//! A negative value says that nothing was measured there.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::io::Read;

use brdf_sdk::native::directions::{HalfDifference, Vec3};
use brdf_sdk::native::lobes::{self, Grid};
use brdf_sdk::native::{Array, Loaded, in_parallel};

use crate::LUMINANCE;
use crate::file::Words;
use crate::made_up::Lacquer;
use crate::shared_exponent::{BIAS, MOST, packed};

/// Bins of theta_h, theta_d and phi_d over 180 degrees.
pub const BINS: [usize; 3] = [90, 90, 180];

/// Bins from one run of theta_h to the next.
const RUN: usize = 3;

/// What a stored number stands for, by colour [1/sr].
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// The largest value [1/sr], which no material comes near: its unit times [`BIAS`] is 2^127, and twice that is no f32.
const LARGEST: f32 = MOST * 16_777_216.0;

/// A material: f_r [1/sr] in bins, colours together.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Bins of theta_h, theta_d, phi_d.
    pub bins: [usize; 3],
    /// Whether phi_d goes over the whole turn, and not over half of it.
    pub whole_turn: bool,
    /// Red, green, blue of each bin, phi_d fastest.
    pub values: Vec<[f32; 3]>,
    /// Bins without a measurement, which hold 0.
    pub invalid: usize,
}

/// The arrays of a file, or of a lacquer that is made up.
pub fn load(file: Option<&str>) -> Result<Loaded, String> {
    match file {
        Some(path) => arrays(&read(&mut Words::open(path)?)?),
        None => arrays(&made_up()),
    }
}

/// Reads bytes, as fuzzers give them.
pub fn parse(bytes: &[u8]) -> Result<Table, String> {
    read(&mut Words::new(bytes, bytes.len() as u64))
}

fn read<R: Read>(words: &mut Words<R>) -> Result<Table, String> {
    let sizes = [words.i32()?, words.i32()?, words.i32()?];
    let whole_turn = match sizes {
        [90, 90, 180] => false,
        [90, 90, 360] => true,
        [h, d, p] => {
            return Err(format!(
                "its bins are {h} x {d} x {p} and not 90 x 90 x 180; it is no MERL file, so name another"
            ));
        }
    };
    let bins = sizes.map(|size| size as usize);
    let count = bins[0] * bins[1] * bins[2];
    let wanted = 12 + 24 * count as u64;
    if words.length() != wanted {
        return Err(format!(
            "it has {} bytes and its header asks for {wanted}; it was cut off or is another format, so fetch it again",
            words.length()
        ));
    }
    let mut table = Table { bins, whole_turn, values: vec![[0.0; 3]; count], invalid: 0 };
    let mut missing = vec![false; count];
    for (colour, scale) in SCALES.into_iter().enumerate() {
        words.each(count, |index, bytes| {
            let value = f64::from_le_bytes(bytes);
            let scaled = (value * scale) as f32;
            if !scaled.is_finite() || scaled > LARGEST {
                let plane = ["red", "green", "blue"][colour];
                return Err(format!(
                    "bin {index} of the {plane} plane holds {value}; the file is damaged, so fetch it again"
                ));
            }
            match value < 0.0 {
                true => missing[index] = true,
                false => table.values[index][colour] = scaled,
            }
            Ok(())
        })?;
    }
    for (value, _) in table.values.iter_mut().zip(&missing).filter(|(_, missing)| **missing) {
        *value = [0.0; 3];
    }
    table.invalid = missing.iter().filter(|missing| **missing).count();
    if table.invalid == count {
        return Err("not one of its bins was measured; name a file with data".to_owned());
    }
    Ok(table)
}

impl Table {
    /// The bin of two directions.
    pub fn bin(&self, wo: Vec3, wi: Vec3) -> usize {
        let angles = HalfDifference::of(wo, wi);
        let bin = |part: f64, bins: usize| ((part * bins as f64) as usize).min(bins - 1);
        let [h, d, p] = self.bins;
        let turn = if self.whole_turn { TAU } else { PI };
        bin(angles.phi_d % turn / turn, p)
            + p * (bin(angles.theta_d / FRAC_PI_2, d)
                + d * bin((angles.theta_h / FRAC_PI_2).sqrt(), h))
    }

    fn luminance(&self, wo: Vec3, wi: Vec3) -> f64 {
        let value = self.values[self.bin(wo, wi)];
        (0..3).map(|c| LUMINANCE[c] * f64::from(value[c])).sum()
    }

    /// The bins as the WGSL reads them: rows of theta_d, in them runs of four bins of theta_h, of which the last is
    /// also the next run's first, and of each run its texel for every phi_d. So four texels, side by side in twos, hold
    /// a trilinear look, in a third of the memory that pairs along all axes take. Every axis has one bin more at both
    /// ends, so that looks need no ends: of theta_h and behind the last row the outermost bins once more, of phi_d those
    /// of the other end, and before the rows one at theta_d = 0, where phi_d means nothing, which holds the mean over
    /// phi_d of the first row.
    fn texels(&self, unit: f32) -> Vec<u32> {
        let [h, d, p] = self.bins;
        let bins: Vec<u32> = self.values.iter().map(|rgb| packed(rgb.map(|c| c / unit))).collect();
        let at_zero = |i: usize| {
            let first = &self.values[i * d * p..][..p];
            let mean = |c| first.iter().map(|value| f64::from(value[c])).sum::<f64>() / p as f64;
            packed([0, 1, 2].map(|c| mean(c) as f32 / unit))
        };
        let at_zero: Vec<u32> = (0..h).map(at_zero).collect();
        let value = |i: usize, row: usize, column: usize| {
            let i = i.saturating_sub(1).min(h - 1);
            match row {
                0 => at_zero[i],
                _ => bins[(column + p - 1) % p + p * ((row - 1).min(d - 1) + d * i)],
            }
        };
        let [_, runs, _] = self.texel_counts();
        let mut texels = Vec::with_capacity(4 * self.texel_counts().iter().product::<usize>());
        for row in 0..d + 2 {
            for run in 0..runs {
                for column in 0..p + 2 {
                    texels.extend((0..=RUN).map(|i| value(RUN * run + i, row, column)));
                }
            }
        }
        texels
    }

    /// Rows, runs and columns of the texels.
    fn texel_counts(&self) -> [usize; 3] {
        let [h, d, p] = self.bins;
        [d + 2, (h + 1).div_ceil(RUN), p + 2]
    }

    /// The power of two by which the largest value fits.
    fn unit(&self) -> f32 {
        let largest = self.values.iter().flatten().copied().fold(f32::MIN_POSITIVE, f32::max);
        (largest / MOST).log2().ceil().exp2()
    }
}

fn arrays(table: &Table) -> Result<Loaded, String> {
    let grid = Grid { theta_o: 48, phi_o: 1, theta_h: 64, phi_h: 25 };
    let mut loaded = Loaded::new(lobes::tables(grid, |wo, wi| table.luminance(wo, wi)));
    let unit = table.unit();
    let [rows, runs, columns] = table.texel_counts().map(|count| count as u64);
    loaded.arrays.push(Array::u32("reflectance", [rows, runs, columns, 4], table.texels(unit)));
    loaded.arrays.push(Array::f32("unit", [1], vec![unit * BIAS]));
    if table.invalid > 0 {
        let share = 100.0 * table.invalid as f64 / table.values.len() as f64;
        loaded.notes.push(format!(
            "{} of {} bins ({share:.1} %) hold no measurement and reflect nothing",
            table.invalid,
            table.values.len()
        ));
    }
    Ok(loaded)
}

/// The pairs of directions that stand for a bin: its middle where both lie above the horizon, else those of
/// `across`^3 points inside it that do; none where the bin cannot be seen.
pub fn pairs(bin: usize, across: usize) -> Vec<(Vec3, Vec3)> {
    let [_, d, p] = BINS;
    let (h, d, p) = (bin / (d * p), bin / p % d, bin % p);
    let at = |u: f64, v: f64, w: f64| {
        let root = (h as f64 + u) / BINS[0] as f64;
        let angles = HalfDifference {
            theta_h: root * root * FRAC_PI_2,
            phi_h: 0.0,
            theta_d: (d as f64 + v) / BINS[1] as f64 * FRAC_PI_2,
            phi_d: (p as f64 + w) / BINS[2] as f64 * PI,
        };
        let (wo, wi) = angles.directions();
        (wo[2] > 0.0 && wi[2] > 0.0).then_some((wo, wi))
    };
    if let Some(middle) = at(0.5, 0.5, 0.5) {
        return vec![middle];
    }
    let part = |i: usize| ((i % across) as f64 + 0.5) / across as f64;
    let points =
        (0..across.pow(3)).filter_map(|i| at(part(i / across / across), part(i / across), part(i)));
    points.collect()
}

/// The bytes of a file with these values [1/sr] in its bins, phi_d fastest; `None` where nothing is seen.
pub fn bytes(values: &[Option<[f64; 3]>]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(12 + 24 * values.len());
    for size in BINS {
        bytes.extend((size as i32).to_le_bytes());
    }
    for (colour, scale) in SCALES.into_iter().enumerate() {
        for value in values {
            let stored = value.map_or(-1.0, |value| value[colour] / scale);
            bytes.extend(stored.to_le_bytes());
        }
    }
    bytes
}

/// A red lacquer in the bins of a file.
fn made_up() -> Table {
    let lacquer = Lacquer { alpha: [0.15; 2], base: [0.45, 0.06, 0.03], coat: [0.05; 3] };
    let value = |bin: usize| {
        let pairs = pairs(bin, 2);
        let sum = pairs.iter().fold([0.0; 3], |sum, (wo, wi)| {
            let f = lacquer.f(*wo, *wi);
            [0, 1, 2].map(|c| sum[c] + f[c])
        });
        sum.map(|c| (c / pairs.len().max(1) as f64) as f32)
    };
    let values = in_parallel(BINS.iter().product(), value);
    Table { bins: BINS, whole_turn: false, values, invalid: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is read has a unit that an f32 holds with its bias, and what is larger has none.
    #[test]
    fn the_largest_value_has_a_unit() {
        let with_bias = |value: f32| {
            let table =
                Table { bins: [1; 3], whole_turn: false, values: vec![[value; 3]], invalid: 0 };
            table.unit() * BIAS
        };
        assert_eq!(with_bias(LARGEST), 127f32.exp2());
        assert_eq!(with_bias(1.001 * LARGEST), f32::INFINITY);
        assert!(with_bias(0.0) > 0.0);
    }
}
