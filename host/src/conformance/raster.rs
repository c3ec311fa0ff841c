//! Densities as pixels: the window of directions that holds nearly all draws, and what the cells say of each
//! pixel of it.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Densities;
use super::cell::Cell;

/// A rectangle of directions [radians].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Smallest and largest angle from the normal.
    pub theta: [f64; 2],
    /// Smallest and largest azimuth from `wo`, in [-pi/2, 3 pi/2]: a mirror's lobe is at pi. Where `wo` is the
    /// normal it counts from the tangent.
    pub azimuth: [f64; 2],
}

impl Window {
    /// How large it is in its two angles [square radians].
    pub fn area(&self) -> f64 {
        (self.theta[1] - self.theta[0]) * (self.azimuth[1] - self.azimuth[0])
    }
}

/// Densities in a window, pixel by pixel: along the azimuth, row by row from the smallest theta.
#[derive(Debug, Clone)]
pub struct Raster {
    /// The density drawn [1/sr].
    pub drawn: Vec<f64>,
    /// The density expected [1/sr].
    pub expected: Vec<f64>,
    /// Drawn less expected, in standard deviations of what is counted.
    pub deviations: Vec<f64>,
}

/// A window of more than this part of the hemisphere shows all of it.
const NEARLY_ALL: f64 = 0.8;
/// Room around what is held, as a part of a side.
const ROOM: f64 = 0.04;
/// Places between which a side is looked for.
const PLACES: usize = 512;
/// From the chart's phi to the azimuth from `wo`: see [`Chart`](super::cell::Chart).
const TO_AZIMUTH: f64 = FRAC_PI_2;

impl Densities {
    /// The smallest window that holds this part of what is drawn and expected.
    pub fn window(&self, held: f64) -> Window {
        // What one side leaves out and what the other does.
        let held = 0.5 * (1.0 + held);
        let side = |axis: usize, whole: [f64; 2]| {
            let piece = |(cell, [drawn, expected]): &(Cell, [f64; 2])| {
                let mass = (drawn + expected) * cell.solid_angle();
                let mass = if mass.is_finite() { mass } else { 0.0 };
                ([cell.low[axis], cell.high[axis]].map(f64::from), mass)
            };
            let pieces: Vec<([f64; 2], f64)> = self.cells.iter().map(piece).collect();
            let [low, high] = shortest(&pieces, held).unwrap_or(whole);
            let room = (ROOM * (high - low)).max(1e-6);
            if high - low > NEARLY_ALL * (whole[1] - whole[0]) {
                whole
            } else {
                [(low - room).max(whole[0]), (high + room).min(whole[1])]
            }
        };
        let [theta, phi] = [side(0, [0.0, FRAC_PI_2]), side(1, [-PI, PI])];
        Window { theta, azimuth: phi.map(|phi| phi + TO_AZIMUTH) }
    }

    /// A window as pixels. A pixel of many cells takes the sum of their counts, one within a cell its
    /// density; so no cell is passed over, however small.
    pub fn raster(&self, window: Window, size: [usize; 2]) -> Raster {
        let [columns, rows] = [
            Sides::new(window.azimuth.map(|azimuth| azimuth - TO_AZIMUTH), size[0]),
            Sides::new(window.theta, size[1]),
        ];
        let mut sums = vec![Sums::default(); size[0] * size[1]];
        for (cell, [drawn, expected]) in &self.cells {
            let [theta, phi] = [0, 1].map(|axis| [cell.low[axis], cell.high[axis]].map(f64::from));
            let draws = cell.solid_angle() * self.draws as f64;
            let [drawn, expected] = [drawn * draws, expected * draws];
            for (row, low, high) in rows.overlap(theta) {
                let along = band(low, high) / band(theta[0], theta[1]);
                for (column, low, high) in columns.overlap(phi) {
                    let part = along * (high - low) / (phi[1] - phi[0]);
                    sums[row * size[0] + column].add(part, drawn, expected);
                }
            }
        }
        let area = |pixel: usize| {
            let [low, high] = rows.ends(pixel / size[0]);
            band(low, high) * columns.step * self.draws as f64
        };
        let of = |value: fn(&Sums) -> f64| sums.iter().map(value).enumerate();
        Raster {
            drawn: of(|sums| sums.drawn).map(|(pixel, count)| count / area(pixel)).collect(),
            expected: of(|sums| sums.expected).map(|(pixel, count)| count / area(pixel)).collect(),
            deviations: of(Sums::deviation).map(|(_, deviation)| deviation).collect(),
        }
    }
}

/// What the cells give a pixel.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    drawn: f64,
    expected: f64,
    variance: f64,
}

impl Sums {
    /// Adds a part of a cell.
    fn add(&mut self, part: f64, drawn: f64, expected: f64) {
        self.drawn += part * drawn;
        self.expected += part * expected;
        // A count's variance is what is expected. Where that is less than 1, one draw would look like many
        // deviations.
        self.variance += part * part * expected.max(1.0);
    }

    /// Of a pixel within a cell that of the cell, of many cells that of their sum.
    fn deviation(&self) -> f64 {
        let off = self.drawn - self.expected;
        if off == 0.0 { 0.0 } else { off / self.variance.sqrt() }
    }
}

/// Equal steps from one number to another.
struct Sides {
    low: f64,
    step: f64,
    count: usize,
}

impl Sides {
    fn new([low, high]: [f64; 2], count: usize) -> Self {
        Self { low, step: (high - low) / count as f64, count }
    }

    /// Where a step begins and ends.
    fn ends(&self, index: usize) -> [f64; 2] {
        [index, index + 1].map(|index| self.low + index as f64 * self.step)
    }

    /// The steps that an interval meets, each with the part of it that lies inside.
    fn overlap(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = (usize, f64, f64)> {
        let step = |at: f64| ((at - self.low) / self.step).max(0.0);
        let first = step(low) as usize;
        let last = (step(high).ceil() as usize).min(self.count);
        (first..last).filter_map(move |index| {
            let [from, to] = self.ends(index);
            let [from, to] = [from.max(low), to.min(high)];
            (from < to).then_some((index, from, to))
        })
    }
}

/// The cosine at one angle less that at a larger one: a band's solid angle for each radian of azimuth.
fn band(low: f64, high: f64) -> f64 {
    2.0 * (0.5 * (high + low)).sin() * (0.5 * (high - low)).sin()
}

/// The shortest interval that holds this part of the mass, which is even in each piece; its ends are among
/// the ends of pieces.
fn shortest(pieces: &[([f64; 2], f64)], part: f64) -> Option<[f64; 2]> {
    let total: f64 = pieces.iter().map(|(_, mass)| mass).sum();
    let mut ends: Vec<f64> = pieces.iter().flat_map(|(piece, _)| *piece).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let last = ends.len().checked_sub(1)?;
    let places = PLACES.min(last);
    let places: Vec<f64> = (0..=places).map(|i| ends[i * last / places.max(1)]).collect();
    let below = |at: f64| -> f64 {
        let part = |[low, high]: [f64; 2]| ((at - low) / (high - low)).clamp(0.0, 1.0);
        pieces.iter().map(|(piece, mass)| mass * part(*piece)).sum()
    };
    let masses: Vec<f64> = places.iter().map(|at| below(*at)).collect();
    let held = |first: usize, last: usize| masses[last] - masses[first] >= part * total;
    let mut best: Option<[f64; 2]> = None;
    let mut first = 0;
    for last in 0..places.len() {
        while first < last && held(first + 1, last) {
            first += 1;
        }
        let found = [places[first], places[last]];
        let shorter = best.is_none_or(|best| found[1] - found[0] < best[1] - best[0]);
        if total > 0.0 && held(first, last) && shorter {
            best = Some(found);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 16 by 32 cells with a density of 1/sr and the same of draws; `more` is drawn in one of them.
    fn even(low: [f32; 2], high: [f32; 2], more: f64) -> Densities {
        let step = [0, 1].map(|axis| (high[axis] - low[axis]) / [16.0, 32.0][axis]);
        let cell = |index: usize| {
            let place = [index / 32, index % 32].map(|i| i as f32);
            let at = |add: f32| [0, 1].map(|axis| low[axis] + (place[axis] + add) * step[axis]);
            let drawn = if index == 200 { 1.0 + more } else { 1.0 };
            (Cell { low: at(0.0), high: at(1.0) }, [drawn, 1.0])
        };
        Densities {
            view: [0.0; 2],
            at: String::new(),
            failed: false,
            draws: 1_000_000,
            cells: (0..512).map(cell).collect(),
        }
    }

    #[test]
    fn a_window_is_as_small_as_what_it_holds() {
        let whole = Cell::HEMISPHERE;
        let window = even(whole.low, whole.high, 0.0).window(0.999);
        assert_eq!(window, Window { theta: [0.0, FRAC_PI_2], azimuth: [-FRAC_PI_2, 1.5 * PI] });
        // A lobe of 0.16 by 0.32 with nothing around it: all of it, and 4 % of room.
        let window = even([0.6, 1.0], [0.76, 1.32], 0.0).window(0.999);
        let near = |found: [f64; 2], wanted: [f64; 2]| {
            assert!((0..2).all(|i| (found[i] - wanted[i]).abs() < 1e-5), "{found:?} {wanted:?}");
        };
        near(window.theta, [0.6 - 0.0064, 0.76 + 0.0064]);
        near(window.azimuth.map(|a| a - FRAC_PI_2), [1.0 - 0.0128, 1.32 + 0.0128]);
    }

    /// A piece of mass 1 between two wide ones of 1e-4 holds 0.9998 of all.
    #[test]
    fn little_mass_is_left_outside() {
        let pieces = [([0.0, 0.4], 1e-4), ([0.4, 0.5], 1.0), ([0.5, 1.0], 1e-4)];
        assert_eq!(shortest(&pieces, 0.9995), Some([0.4, 0.5]));
        assert_eq!(shortest(&pieces, 0.9999), Some([0.0, 0.5]));
        assert_eq!(shortest(&[([0.0, 1.0], 0.0)], 0.9), None);
        assert_eq!(shortest(&[], 0.9), None);
    }

    /// A pixel of many cells and many pixels of a cell show the same density; deviations are those of a
    /// cell's count, or of the sum of counts.
    #[test]
    fn pixels_keep_density_and_deviation() {
        let densities = even([0.0, -3.0], [1.5, 3.0], 0.5);
        let (cell, [drawn, _]) = densities.cells[200];
        let expected = cell.solid_angle() * 1e6;
        let deviation = 0.5 * expected / expected.sqrt();
        for size in [[7, 5], [32, 16], [300, 200]] {
            let raster = densities.raster(densities.window(0.999), size);
            assert!(raster.expected.iter().all(|pdf| *pdf < 1.0 + 1e-4), "{size:?}");
            let inside = raster.expected.iter().filter(|pdf| **pdf > 1.0 - 1e-4).count();
            assert!(inside * 2 > size[0] * size[1], "{inside} of {size:?}");
            let most = raster.drawn.iter().copied().fold(0.0, f64::max);
            let far = raster.deviations.iter().copied().fold(0.0, f64::max);
            if size[0] == 300 {
                assert!((most - drawn).abs() < 1e-3 && (far - deviation).abs() < 1e-3 * far);
            } else {
                assert!(1.0 < most && most < drawn && far <= deviation * (1.0 + 1e-6));
            }
        }
    }
}
