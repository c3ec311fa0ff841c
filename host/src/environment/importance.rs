//! Importance tables: the map's radiance as shares of 2^32, for inversion on the device.
//!
//! A marginal list of rows and a conditional list of columns for each row, accumulated in f64. An entry of
//! positive radiance has at least one count and one of none has none, so that every direction that
//! sends light can be drawn and no other is. The density of a texel follows from the counts that the
//! device draws by, not from the radiance that they were made of. Layout of the lists: shaders/environment/table.wgsl.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::filter::Filter;
use super::orientation::texel_solid_angle;
use super::texels::texel_radiance;
use super::{Environment, Layout};
use crate::tone::luminance;

/// What a texel's probability is proportional to, beside its solid angle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Weighting {
    /// Its luminance (Rec. 709)
    #[default]
    Luminance,
    /// Its largest channel: saturated colours are drawn as often as white
    Largest,
}

impl Weighting {
    /// The weight of a radiance.
    pub fn of(self, rgb: [f64; 3]) -> f64 {
        match self {
            Self::Luminance => luminance(rgb),
            Self::Largest => rgb[0].max(rgb[1]).max(rgb[2]),
        }
    }
}

/// What a table is made for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Purpose {
    /// How radiance is read: the table covers every direction whose filtered radiance is positive.
    pub filter: Filter,
    /// What probability follows.
    pub weighting: Weighting,
    /// Whether the map's mean is subtracted (Karlik, Sik, Vevoda, Skrivan, Krivanek 2019, MIS
    /// Compensation, section 5): what the other technique samples well anyway is left to it. A constant map, of
    /// which nothing would be left, keeps its plain table.
    pub compensated: bool,
}

/// The tables of one map.
#[derive(Debug, Clone, PartialEq)]
pub struct Importance {
    /// Ends of shares: of the rows, then of each row's columns; the last end of each list, 2^32, is left out.
    pub ends: Vec<u32>,
    /// Guides to the rows, then to each row's columns: the first entry of a part of [0, 2^32) in the
    /// low half, how many more the part touches in the high half.
    pub guides: Vec<u32>,
    /// Entries of a guide to rows and of one to columns, as powers of two.
    pub guide_bits: [u32; 2],
    /// Density of each texel: per solid angle [1/sr] of a lat-long map, per area (s, t in [-1, 1]) of a cube's face.
    pub densities: Vec<f32>,
}

impl Importance {
    /// The density over solid angle [1/sr] with which a direction (map space, any length) is drawn from `map`, whose
    /// tables these are.
    pub fn density(&self, map: &Environment, direction: DVec3) -> f64 {
        let ((column, row), at) = map.place_of(direction);
        let own = f64::from(self.densities[(row * map.width + column) as usize]);
        match map.layout {
            Layout::LatLong => own,
            // A face has the area 4, a texel the 4 / side^2 of it.
            Layout::Cube => {
                let texel = 4.0 / f64::from(map.width).powi(2);
                own * texel / map.solid_angle_at((column, row), at)
            }
        }
    }
}

/// Makes the tables of a map.
pub fn importance(map: &Environment, purpose: Purpose) -> Importance {
    let weights = weights(map, purpose);
    tables(map, &weights)
}

/// The weight of every texel, times its solid angle.
fn weights(map: &Environment, purpose: Purpose) -> Vec<f64> {
    let columns = map.width as usize;
    let radiance = texel_radiance(map, purpose.filter);
    let values: Vec<f64> = radiance.into_par_iter().map(|rgb| purpose.weighting.of(rgb)).collect();
    let energy = |subtracted: f64| {
        let mut weights = values.clone();
        weights.par_chunks_mut(columns).enumerate().for_each(|(row, weights)| {
            for (column, weight) in weights.iter_mut().enumerate() {
                *weight =
                    (*weight - subtracted).max(0.0) * map.solid_angle(column as u32, row as u32);
            }
        });
        weights
    };
    let plain = energy(0.0);
    if !purpose.compensated {
        return plain;
    }
    let mean = total(&plain, columns) / (4.0 * PI);
    let compensated = energy(mean);
    // Rounding of the mean alone leaves next to nothing of a constant map.
    if total(&compensated, columns) > 1e-6 * total(&plain, columns) { compensated } else { plain }
}

/// Sums in a fixed order, whatever the number of threads.
fn total(weights: &[f64], columns: usize) -> f64 {
    let rows: Vec<f64> = weights.par_chunks(columns).map(|row| row.iter().sum()).collect();
    rows.iter().sum()
}

/// Parts of the guides to columns, all rows together, at the most.
const MOST_PARTS: u32 = 1 << 25;

fn tables(map: &Environment, weights: &[f64]) -> Importance {
    let (columns, rows) = (map.width as usize, map.height as usize);
    // Twice as many parts as columns, so that a part hardly ever holds more than one end; half as many at
    // 8192 x 4096, where the guides as the ends just fit a binding of 128 MiB.
    let most = MOST_PARTS.ilog2() - rows.ilog2() - 1;
    let guide_bits = [rows.ilog2() + 3, (columns.ilog2() + 1).min(most).max(1)];
    let mut ends = vec![0; rows - 1 + rows * (columns - 1)];
    let mut guides = vec![0; (1 << guide_bits[0]) + (rows << guide_bits[1])];
    let mut densities = vec![0.0; rows * columns];

    let sums: Vec<f64> = weights.par_chunks(columns).map(|row| row.iter().sum()).collect();
    let (row_ends, column_ends) = ends.split_at_mut(rows - 1);
    let (row_guide, column_guides) = guides.split_at_mut(1 << guide_bits[0]);
    let row_shares = shares(&sums);
    fill(&row_shares, row_ends, row_guide);

    // A map of one column has no ends of columns; chunks of none are refused, so the rows go by index.
    let mut ends_of_rows: Vec<&mut [u32]> = Vec::with_capacity(rows);
    let mut rest = column_ends;
    for _ in 0..rows {
        let (own, others) = rest.split_at_mut(columns - 1);
        ends_of_rows.push(own);
        rest = others;
    }
    ends_of_rows
        .into_par_iter()
        .zip(column_guides.par_chunks_mut(1 << guide_bits[1]))
        .zip(densities.par_chunks_mut(columns))
        .zip(weights.par_chunks(columns))
        .enumerate()
        .for_each(|(row, (((ends, guide), densities), weights))| {
            let column_shares = shares(weights);
            fill(&column_shares, ends, guide);
            let measure = match map.layout {
                Layout::LatLong => texel_solid_angle(row as u32, map.width, map.height),
                Layout::Cube => (2.0 / columns as f64).powi(2),
            };
            for (density, share) in densities.iter_mut().zip(&column_shares) {
                *density = (part(row_shares[row]) * part(*share) / measure) as f32;
            }
        });
    Importance { ends, guides, guide_bits, densities }
}

/// A share as a part of the whole.
fn part(share: u64) -> f64 {
    share as f64 / WHOLE as f64
}

/// What the shares of a list add up to.
const WHOLE: u64 = 1 << 32;

/// Shares of 2^32 in proportion to the weights: at least 1 where a weight is positive, 0 elsewhere. All 0
/// where no weight is positive.
fn shares(weights: &[f64]) -> Vec<u64> {
    let positive = weights.iter().filter(|weight| **weight > 0.0).count() as u64;
    let total: f64 = weights.iter().sum();
    if positive == 0 {
        return vec![0; weights.len()];
    }
    let free = (WHOLE - positive) as f64;
    let last = weights.iter().rposition(|weight| *weight > 0.0);
    let mut sum = 0.0;
    let mut before = 0;
    weights
        .iter()
        .enumerate()
        .map(|(index, weight)| {
            if *weight <= 0.0 {
                return 0;
            }
            sum += weight;
            let after = match Some(index) == last {
                true => WHOLE - positive,
                false => (sum / total * free).min(free) as u64,
            };
            let share = after - before + 1;
            before = after;
            share
        })
        .collect()
}

/// Writes the ends of shares and the guide to them.
fn fill(shares: &[u64], ends: &mut [u32], guide: &mut [u32]) {
    let mut end = 0;
    for (slot, share) in ends.iter_mut().zip(shares) {
        end += share;
        // Behind the last positive entry the end is 2^32 itself, which no number reaches; it is stored
        // as the largest, and the guide never leads there.
        *slot = u32::try_from(end).unwrap_or(u32::MAX);
    }
    let step = WHOLE / guide.len() as u64;
    let mut entry = 0;
    let mut end = shares[0];
    let mut at = |x: u64| {
        while end <= x && entry + 1 < shares.len() {
            entry += 1;
            end += shares[entry];
        }
        entry as u32
    };
    for (index, slot) in guide.iter_mut().enumerate() {
        let first = at(index as u64 * step);
        let last = at((index as u64 + 1) * step - 1);
        *slot = first | (last - first) << 16;
    }
}

/// A power of two by which the map's mean radiance comes near 1, and 1 for a black map.
pub fn scale(map: &Environment) -> f32 {
    let columns = map.width as usize;
    let rows: Vec<f64> = map
        .texels
        .par_chunks(columns)
        .enumerate()
        .map(|(row, texels)| {
            let weight = |(column, texel): (usize, &[f32; 4])| {
                let rgb = [texel[0], texel[1], texel[2]].map(f64::from);
                rgb.iter().sum::<f64>() / 3.0 * map.solid_angle(column as u32, row as u32)
            };
            texels.iter().enumerate().map(weight).sum()
        })
        .collect();
    let mean = rows.iter().sum::<f64>() / (2.0 * TAU);
    if mean > 0.0 { (-mean.log2().round()).clamp(-120.0, 120.0).exp2() as f32 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn map(
        layout: Layout,
        width: u32,
        height: u32,
        texel: impl Fn(u32, u32) -> f32,
    ) -> Environment {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels: Vec<_> =
            places.map(|(x, y)| [texel(x, y), texel(x, y), texel(x, y), 0.0]).collect();
        let texels = Arc::new(texels);
        Environment { layout, width, height, texels, ..Environment::constant(0.0) }
    }

    /// Over a sphere that is cut finely, by angles, a density adds up to 1, whatever the map's layout.
    #[test]
    fn densities_over_directions_add_up_to_one() {
        use crate::environment::orientation::direction_of;
        let bright = |x: u32, y: u32| 1.0 + (x * 7 + y * 3) as f32 % 11.0;
        for map in [map(Layout::LatLong, 16, 8, bright), map(Layout::Cube, 8, 48, bright)] {
            let tables = importance(&map, Purpose::default());
            let (columns, rows) = (720, 360);
            let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
            let sum: f64 = cells
                .map(|(x, y)| {
                    let part = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
                    let direction = direction_of(part(x, columns), part(y, rows));
                    tables.density(&map, direction) * texel_solid_angle(y, columns, rows)
                })
                .sum();
            // Cells on the texels' edges belong to one of them.
            assert!((sum - 1.0).abs() < 2e-3, "{:?} {sum}", map.layout);
        }
    }

    /// The entry that holds `x`, by the guide and the ends as table.wgsl does it, and by the ends alone.
    fn find(x: u32, ends: &[u32], guide: &[u32]) -> [usize; 2] {
        let part = guide[((u64::from(x) * guide.len() as u64) >> 32) as usize];
        let first = (part & 0xffff) as usize;
        let guided =
            first + ends[first..first + (part >> 16) as usize].partition_point(|end| *end <= x);
        [guided, ends.partition_point(|end| *end <= x)]
    }

    /// Checks a list of shares against the weights it was made of: at least one count for each positive
    /// weight, none for the others, proportional up to the counts that were given away, and found.
    fn check(weights: &[f64]) {
        let shares = shares(weights);
        let positive = weights.iter().filter(|weight| **weight > 0.0).count() as u64;
        assert_eq!(shares.iter().sum::<u64>(), if positive > 0 { WHOLE } else { 0 });
        let total: f64 = weights.iter().sum();
        for (share, weight) in shares.iter().zip(weights) {
            assert_eq!(*share > 0, *weight > 0.0);
            let ideal = weight / total * WHOLE as f64;
            assert!(positive == 0 || (*share as f64 - ideal).abs() <= positive as f64 + 2.0);
        }
        let mut ends = vec![0; weights.len() - 1];
        let mut guide = vec![0; 1 << weights.len().ilog2().max(1)];
        fill(&shares, &mut ends, &mut guide);
        if positive == 0 {
            return;
        }
        let borders = ends.iter().flat_map(|end| [end.wrapping_sub(1), *end]);
        for x in borders.chain([0, 1, 1 << 31, u32::MAX - 1]).chain((0..999).map(|i| i * 4_300_001))
        {
            let [guided, searched] = find(x, &ends, &guide);
            // Behind the last positive weight all ends are 2^32, which is stored as one less.
            let last = weights.iter().rposition(|weight| *weight > 0.0).unwrap();
            assert_eq!(guided, searched.min(last), "{x}");
            assert!(weights[guided] > 0.0, "{x} finds an entry of no weight");
        }
    }

    #[test]
    fn shares_keep_every_positive_weight_and_no_other() {
        check(&[1.0]);
        check(&[0.0; 5]);
        check(&[0.0, 0.0, 3.0, 0.0]);
        check(&[1e-300, 1e30, 0.0, 1e-30]);
        check(&[1.0; 4096]);
        // A sun of 1e6 among dim texels, and dim ones that it would leave nothing of.
        let sun: Vec<f64> =
            (0..1000).map(|i| if i == 700 { 1e6 } else { 1e-9 * f64::from(i % 7) }).collect();
        check(&sun);
        let many: Vec<f64> = (0..8192).map(|i| f64::from(i % 97).powi(6)).collect();
        check(&many);
    }

    /// Densities integrate to 1 over the sphere, and are positive where filtered radiance is.
    #[test]
    fn densities_integrate_to_one() {
        let spots = |x: u32, y: u32| ((x * 7 + y * 3) % 11 / 9) as f32 * (1.0 + x as f32);
        for (layout, width, height) in [
            (Layout::LatLong, 64, 32),
            (Layout::LatLong, 2, 1),
            (Layout::Cube, 8, 48),
            (Layout::Cube, 1, 6),
        ] {
            let map = map(layout, width, height, |x, y| spots(x, y) + ((x + y) % 2) as f32 * 0.01);
            for filter in [Filter::Nearest, Filter::Linear] {
                for compensated in [false, true] {
                    let purpose = Purpose { filter, compensated, ..Purpose::default() };
                    let tables = importance(&map, purpose);
                    let integral: f64 = (0..tables.densities.len())
                        .map(|i| {
                            let (column, row) = (i as u32 % width, i as u32 / width);
                            let measure = match layout {
                                Layout::LatLong => map.solid_angle(column, row),
                                Layout::Cube => (2.0 / f64::from(width)).powi(2),
                            };
                            f64::from(tables.densities[i]) * measure
                        })
                        .sum();
                    assert!((integral - 1.0).abs() < 1e-6, "{layout:?} {filter:?}: {integral}");
                    let radiance = texel_radiance(&map, filter);
                    for (density, rgb) in tables.densities.iter().zip(radiance) {
                        assert!(compensated || (*density > 0.0) == (rgb[0] > 0.0));
                    }
                }
            }
        }
    }

    #[test]
    fn constant_maps_are_not_compensated_away_and_black_ones_have_no_density() {
        let purpose = Purpose { compensated: true, ..Purpose::default() };
        let constant = importance(&map(Layout::LatLong, 64, 32, |_, _| 3.0), purpose);
        let uniform = 1.0 / (4.0 * PI);
        assert!(constant.densities.iter().all(|d| (f64::from(*d) - uniform).abs() < 1e-6));
        let black = importance(&map(Layout::LatLong, 64, 32, |_, _| 0.0), purpose);
        assert!(black.densities.iter().all(|density| *density == 0.0));
    }

    #[test]
    fn the_largest_channel_sees_what_luminance_does_not() {
        let mut blue = map(Layout::LatLong, 4, 2, |_, _| 0.0);
        blue.texels = Arc::new(
            (0..8)
                .map(|i| if i < 4 { [0.0, 0.0, 1.0, 0.0] } else { [1.0, 1.0, 1.0, 0.0] })
                .collect(),
        );
        let of = |weighting| {
            let tables = importance(&blue, Purpose { weighting, ..Purpose::default() });
            f64::from(tables.densities[0] / tables.densities[4])
        };
        assert!((of(Weighting::Luminance) - 0.0722).abs() < 1e-6);
        assert!((of(Weighting::Largest) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn scales_are_powers_of_two_near_the_mean() {
        for radiance in [1e-20, 1.0, 3.0e4, 1e20] {
            let scale = f64::from(scale(&Environment::constant(radiance)));
            assert_eq!(scale.log2().fract(), 0.0);
            assert!((0.7..1.42).contains(&(scale * f64::from(radiance))));
        }
        assert_eq!(scale(&Environment::constant(0.0)), 1.0);
    }
}
