//! Tables to sample a material by: for views, the distribution of the half vector.
//!
//! A library that returns them for a manifest with `lobes = "isotropic"` or `"anisotropic"` gives its WGSL
//! `lobe_sample` and `lobe_pdf` (shaders/lobes.wgsl), which are exact for each other whatever the tables hold.
//!
//! For each view the density of the half vector is constant in each cell of its angle and its azimuth; a `wo` has the
//! density of the nearest view. A cell's share of the draws follows the root of the mean square of f cos_i dwi, with
//! dwi = 4 (wo . h) dh, over points and views in it: of all constants that gives weights of the least variance. A part
//! of every density follows the cosine. Linear between nodes it would fit some materials better, and cost four numbers a
//! look and a root a draw.
//!
//! Cells end where roots and quotients find it. Those of theta_h at s = (i / n)^4 / 2, s = sin^2(theta_h / 2), in
//! which equal steps are equal solid angles, so they are finest at the mirror direction; views at equal steps of
//! sqrt(1 - cos); the azimuth from `wo`'s at equal steps of t = y / (|x| + |y|), which goes from 0 to 1 in each
//! quarter of the turn. With t for the azimuth a density is per dt, and dt = dphi / (|x| + |y|)^2. Where cells go around,
//! `wo`'s own azimuth lies in the middle of the first.
//!
//! Shares are whole numbers of slots ([`slots`]), and the densities are those of the slots: so a draw takes one look
//! for the row of cells and one for the cell, and is exact all the same.

use std::f64::consts::TAU;

use super::directions::{Vec3, direction, dot, mirrored};
use super::slots;
use super::{Array, in_parallel};

/// How many views and cells there are.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Views from the normal to the horizon, both included: two or more.
    pub theta_o: usize,
    /// Views around, of equal steps of phi; 1 for an isotropic material, whose half vectors are mirrored about `wo`.
    pub phi_o: usize,
    /// Cells of theta_h, from the normal to the horizon: 2 to 128.
    pub theta_h: usize,
    /// Cells of the half vector's azimuth, from `wo`'s to the opposite one where phi_o is 1, else around: 2 to 32.
    pub phi_h: usize,
}

/// The tables' names as `lobes` declares them: two of u32, and one of f32.
pub const NAMES: [&str; 3] = ["lobe_rows", "lobe_columns", "lobe_densities"];

/// Slots that rows of cells share, and those that a row's cells do.
const SLOTS: [usize; 2] = [1024, 128];

/// The part of the draws that follows the cosine whatever was seen, so that no direction is left out: of materials whose
/// values are known, and of those that were looked at here and there. What was missed costs the part's inverse, at about
/// the most, of the second moment that the cosine alone has.
const COSINES: [f64; 2] = [0.0625, 0.25];

/// Where in a cell a material is looked at, as parts of its sides: also at its corners, since a lobe that ends in a cell
/// may be met nowhere else.
const POINTS: [[f64; 2]; 5] = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

impl Grid {
    fn isotropic(&self) -> bool {
        self.phi_o == 1
    }

    fn views(&self) -> usize {
        self.theta_o * self.phi_o
    }

    fn cells(&self) -> usize {
        self.theta_h * self.phi_h
    }

    /// s at a number of cells of theta_h.
    fn s(&self, cells: f64) -> f64 {
        0.5 * (cells / self.theta_h as f64).powi(4)
    }

    /// cos and sin of the azimuth at a number of cells of t.
    fn azimuth(&self, cells: f64) -> [f64; 2] {
        let t = match self.isotropic() {
            true => 2.0 * cells / self.phi_h as f64,
            false => (4.0 * (cells - 0.5) / self.phi_h as f64).rem_euclid(4.0),
        };
        let folded = if t > 2.0 { 4.0 - t } else { t };
        let (x, y) = (1.0 - folded, 1.0 - (1.0 - folded).abs());
        let length = x.hypot(y);
        [x / length, if t > 2.0 { -y } else { y } / length]
    }

    /// The measure of a row's cells: of s and of 2 t, t in quarters of the turn and on both sides.
    fn measure(&self, row: usize) -> f64 {
        (self.s(row as f64 + 1.0) - self.s(row as f64)) * 8.0 / self.phi_h as f64
    }
}

/// Views that are looked at together where values come in lists.
const AT_ONCE: usize = 16;

/// The tables of a material whose value is `f(wo, wi)`, one number for its colours: the slots of each view's rows,
/// those of each row's cells, and the densities of the cells [1 / (2 ds dt)].
///
/// # Panics
/// A grid that is not as [`Grid`] says.
pub fn tables(grid: Grid, f: impl Fn(Vec3, Vec3) -> f64 + Sync) -> [Array; 3] {
    let spots = spots(grid);
    let made = in_parallel(grid.views(), |view| {
        let own = weights(grid, view, &spots, &f);
        View::new(grid, &with_cosine(grid, &own, view, &spots, COSINES[0]))
    });
    written(grid, &made)
}

/// The same of a material that gives its values for lists of `[wo, wi]`, such as one that runs on a device, and of
/// which nothing is known: weights fade away from cells that have one, as its lobe may have been met by its edge alone.
///
/// # Errors
/// The first that `f` reports.
///
/// # Panics
/// A grid that is not as [`Grid`] says.
pub fn tables_by<E>(
    grid: Grid,
    f: impl FnMut(&[[Vec3; 2]]) -> Result<Vec<f64>, E>,
) -> Result<[Array; 3], E> {
    let spots = spots(grid);
    let mut weights = weights_by(grid, &spots, f)?;
    weights.iter_mut().for_each(|weights| fade(grid, weights));
    let made = in_parallel(weights.len(), |view| {
        View::new(grid, &with_cosine(grid, &weights[view], view, &spots, COSINES[1]))
    });
    Ok(written(grid, &made))
}

fn written(grid: Grid, views: &[View]) -> [Array; 3] {
    let words = |of: fn(&View) -> &Vec<u32>| views.iter().flat_map(of).copied().collect();
    let densities = views.iter().flat_map(|view| &view.densities).copied().collect();
    let Grid { theta_o, phi_o, theta_h, phi_h } = grid;
    let [o, p, rows, columns] = [theta_o, phi_o, theta_h, phi_h].map(|n| n as u64);
    let [of_rows, of_columns] = SLOTS.map(|n| n as u64);
    [
        Array::u32(NAMES[0], [o, p, of_rows], words(|view| &view.rows)),
        Array::u32(NAMES[1], [o, p, rows, of_columns], words(|view| &view.columns)),
        Array::f32(NAMES[2], [o, p, rows, columns], densities),
    ]
}

struct View {
    /// Slots of its rows, and of each row's cells.
    rows: Vec<u32>,
    columns: Vec<u32>,
    /// Of each cell [1 / (2 ds dt)].
    densities: Vec<f32>,
}

impl View {
    fn new(grid: Grid, weights: &[f64]) -> Self {
        let of_rows: Vec<&[f64]> = weights.chunks(grid.phi_h).collect();
        let mass =
            |(row, weights): (usize, &&[f64])| weights.iter().sum::<f64>() * grid.measure(row);
        let masses: Vec<f64> = of_rows.iter().enumerate().map(mass).collect();
        let shares = slots::shared(&masses, SLOTS[0]);
        let mut columns = Vec::with_capacity(grid.theta_h * SLOTS[1]);
        let mut densities = Vec::with_capacity(grid.cells());
        for (row, (weights, of_row)) in of_rows.iter().zip(&shares).enumerate() {
            let of_columns = slots::shared(weights, SLOTS[1]);
            columns.extend(slots::entries(&of_columns));
            densities.extend(of_columns.iter().map(|of_column| {
                let share = (of_row * of_column) as f64 / (SLOTS[0] * SLOTS[1]) as f64;
                (share / grid.measure(row)) as f32
            }));
        }
        Self { rows: slots::entries(&shares), columns, densities }
    }
}

/// A half vector in a cell, at which a material is looked at.
struct Spot {
    cell: usize,
    /// sin(theta_h) and cos(theta_h).
    across: f64,
    z: f64,
    /// cos and sin of the azimuth, and dphi / dt there.
    azimuth: [f64; 2],
    stretch: f64,
}

/// The spots of every cell, the same for each view.
///
/// # Panics
/// A grid that is not as [`Grid`] says.
fn spots(grid: Grid) -> Vec<Spot> {
    let fits = grid.theta_o >= 2
        && grid.phi_o >= 1
        && (2..=128).contains(&grid.theta_h)
        && (2..=32).contains(&grid.phi_h);
    assert!(fits, "{grid:?}");
    let of_cell = |cell: usize| {
        let (i, j) = ((cell / grid.phi_h) as f64, (cell % grid.phi_h) as f64);
        POINTS.map(|[u, v]| {
            let s = grid.s(i + u);
            let azimuth = grid.azimuth(j + v);
            Spot {
                cell,
                across: 2.0 * (s * (1.0 - s)).sqrt(),
                z: 1.0 - 2.0 * s,
                azimuth,
                stretch: azimuth.iter().map(|c| c.abs()).sum::<f64>().powi(2),
            }
        })
    };
    (0..grid.cells()).flat_map(of_cell).collect()
}

/// The light that half vectors in each cell send to a view [1 / (ds dt)], in any unit.
fn weights(
    grid: Grid,
    view: usize,
    spots: &[Spot],
    mut f: impl FnMut(Vec3, Vec3) -> f64,
) -> Vec<f64> {
    let (row, column) = (view / grid.phi_o, view % grid.phi_o);
    // The range of views that this one stands for, but not the horizon itself, where nothing is seen.
    let last = (grid.theta_o - 1) as f64;
    let thetas = [-0.5, 0.0, 0.5].map(|part| {
        let root = (row as f64 + part).clamp(0.0, last - 0.02) / last;
        (1.0 - root * root).acos()
    });
    let around: &[f64] = if grid.isotropic() { &[0.0] } else { &[-0.4, 0.4] };
    let mut weights = vec![0.0f64; grid.cells()];
    for theta_o in thetas {
        for part in around {
            let phi_o = (column as f64 + part) * TAU / grid.phi_o as f64;
            let wo = direction(theta_o, if grid.isotropic() { 0.0 } else { phi_o });
            let length = wo[0].hypot(wo[1]);
            let axis = if length > 0.0 { [wo[0] / length, wo[1] / length] } else { [1.0, 0.0] };
            for spot in spots {
                weights[spot.cell] += sent(grid, wo, axis, spot, &mut f);
            }
        }
    }
    weights.iter_mut().for_each(|weight| *weight = weight.sqrt());
    weights
}

/// The same for every view, of values that come in lists.
fn weights_by<E>(
    grid: Grid,
    spots: &[Spot],
    mut f: impl FnMut(&[[Vec3; 2]]) -> Result<Vec<f64>, E>,
) -> Result<Vec<Vec<f64>>, E> {
    let mut all = Vec::with_capacity(grid.views());
    for first in (0..grid.views()).step_by(AT_ONCE) {
        let count = AT_ONCE.min(grid.views() - first);
        let asked = in_parallel(count, |view| {
            let mut asked = Vec::new();
            weights(grid, first + view, spots, |wo, wi| {
                asked.push([wo, wi]);
                0.0
            });
            asked
        });
        let values = f(&asked.concat())?;
        let ends = asked.iter().scan(0, |end, asked| {
            *end += asked.len();
            Some(*end)
        });
        let begins: Vec<usize> = std::iter::once(0).chain(ends).collect();
        all.extend(in_parallel(count, |view| {
            let mut given = values[begins[view]..].iter();
            weights(grid, first + view, spots, |_, _| given.next().copied().unwrap_or(0.0))
        }));
    }
    Ok(all)
}

/// Weights of which a part follows the cosine: where a view may see light, a corner of the cell lies above the horizon.
fn with_cosine(grid: Grid, own: &[f64], view: usize, spots: &[Spot], part: f64) -> Vec<f64> {
    let cosine = weights(grid, view, spots, |_, _| 1.0);
    let total = |weights: &[f64]| {
        let rows = weights.chunks(grid.phi_h).enumerate();
        rows.map(|(row, weights)| weights.iter().sum::<f64>() * grid.measure(row)).sum::<f64>()
    };
    let [of_own, of_cosine] = [total(own), total(&cosine)];
    let of_own = if of_own > 0.0 && of_own.is_finite() { (1.0 - part) / of_own } else { 0.0 };
    own.iter().zip(&cosine).map(|(own, cosine)| of_own * own + part / of_cosine * cosine).collect()
}

/// Gives each cell at least a part of its neighbours' weights: the densities of a lobe that ends at once, as that of
/// a cone, do so over several cells.
fn fade(grid: Grid, weights: &mut [f64]) {
    const PART: f64 = 1.0 / 32.0;
    let columns = grid.phi_h;
    let mut raise = |cell: usize, by: usize| weights[cell] = weights[cell].max(PART * weights[by]);
    for cell in columns..grid.cells() {
        raise(cell, cell - columns);
    }
    for cell in (0..grid.cells() - columns).rev() {
        raise(cell, cell + columns);
    }
    for row in (0..grid.theta_h).map(|row| row * columns) {
        // Where cells go around, the second turn brings what began behind the seam.
        let steps = if grid.isotropic() { columns - 1 } else { 2 * columns };
        for step in 0..steps {
            raise(row + (step + 1) % columns, row + step % columns);
        }
        for step in (0..steps).rev() {
            raise(row + step % columns, row + (step + 1) % columns);
        }
    }
}

/// The mean square over both sides of the light that a half vector sends [1 / (ds dt)]; the azimuth counts from `axis`.
fn sent(
    grid: Grid,
    wo: Vec3,
    [ax, ay]: [f64; 2],
    spot: &Spot,
    f: &mut impl FnMut(Vec3, Vec3) -> f64,
) -> f64 {
    let Spot { across, z, azimuth: [x, y], stretch, .. } = *spot;
    let mut of_side = |side: f64| {
        let y = side * y;
        let h = [across * (ax * x - ay * y), across * (ay * x + ax * y), z];
        let wi = mirrored(wo, h);
        if wi[2] <= 0.0 {
            return 0.0;
        }
        let light = f(wo, wi).max(0.0) * wi[2] * 4.0 * dot(wo, h).max(0.0) * stretch;
        light * light
    };
    match grid.isotropic() {
        true => 0.5 * (of_side(1.0) + of_side(-1.0)),
        false => of_side(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The densities of every view integrate to 1, whatever the material.
    #[test]
    fn densities_are_normalised() {
        let spike = |wo: Vec3, wi: Vec3| f64::from(u8::from(wo[2] * wi[2] > 0.8));
        for (phi_o, f) in [(1, &spike as &(dyn Fn(Vec3, Vec3) -> f64 + Sync)), (4, &|_, _| 0.0)] {
            let grid = Grid { theta_o: 3, phi_o, theta_h: 16, phi_h: 8 };
            let made = tables(grid, f);
            let by_lists = tables_by(grid, |pairs| {
                Ok::<_, ()>(pairs.iter().map(|[wo, wi]| f(*wo, *wi)).collect())
            });
            for [_, _, densities] in [made, by_lists.unwrap()] {
                let super::super::Data::F32(values) = &densities.data else { panic!("floats") };
                for of_view in values.chunks(grid.cells()) {
                    let of_cell = |(cell, density): (usize, &f32)| {
                        f64::from(*density) * grid.measure(cell / grid.phi_h)
                    };
                    let sum: f64 = of_view.iter().enumerate().map(of_cell).sum();
                    assert!((sum - 1.0).abs() < 1e-6, "{sum}");
                }
            }
        }
    }

    /// The cell of a pair of directions as the WGSL finds it.
    fn cell_of(grid: Grid, wo: Vec3, wi: Vec3) -> usize {
        let m = [0, 1, 2].map(|c| wo[c] + wi[c]);
        let last = (grid.theta_o - 1) as f64;
        let row = ((1.0 - wo[2]).max(0.0).sqrt() * last + 0.5).min(last) as usize;
        let turns = wo[1].atan2(wo[0]) / TAU + 1.0;
        let view = row * grid.phi_o + (turns * grid.phi_o as f64 + 0.5) as usize % grid.phi_o;
        let s = 0.5 * (1.0 - m[2] / dot(m, m).sqrt());
        let along = ((2.0 * s).max(0.0).powf(0.25) * grid.theta_h as f64) as usize;
        let length = wo[0].hypot(wo[1]);
        let [x, y] = [wo[0] * m[0] + wo[1] * m[1], wo[0] * m[1] - wo[1] * m[0]].map(|c| c / length);
        let quarter = y.abs() / (x.abs() + y.abs());
        let quarters = if x < 0.0 { 2.0 - quarter } else { quarter };
        let columns = grid.phi_h as f64;
        let around = match grid.isotropic() {
            true => (quarters * 0.5 * columns) as usize,
            false => {
                let turn = if y < 0.0 { 4.0 - quarters } else { quarters };
                (turn * 0.25 * columns + 0.5) as usize % grid.phi_h
            }
        };
        let row = view * grid.theta_h + along.min(grid.theta_h - 1);
        row * grid.phi_h + around.min(grid.phi_h - 1)
    }

    /// Whatever the material, every pair of directions above the horizon has a density, down to 1e-5 above it.
    #[test]
    fn no_direction_is_left_out() {
        let mut state = 7u64;
        let mut number = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut above = || {
            let height = if number() < 0.5 { number() } else { 10f64.powf(-5.0 * number()) };
            direction(height.clamp(1e-5, 1.0 - 1e-9).acos(), TAU * number())
        };
        let pairs: Vec<[Vec3; 2]> = (0..200_000).map(|_| [above(), above()]).collect();
        for (phi_o, theta_h, phi_h) in
            [(1, 64, 25), (1, 2, 2), (1, 7, 3), (24, 40, 24), (5, 9, 8), (2, 128, 32)]
        {
            let grid = Grid { theta_o: 12, phi_o, theta_h, phi_h };
            let [_, _, densities] = tables(grid, |wo, wi| f64::from(u8::from(wo[2] * wi[2] > 0.8)));
            let super::super::Data::F32(densities) = densities.data else { panic!("floats") };
            for [wo, wi] in &pairs {
                assert!(densities[cell_of(grid, *wo, *wi)] > 0.0, "{grid:?}: {wo:?} {wi:?}");
            }
        }
    }

    /// Values that come in lists are those of their cells.
    #[test]
    fn lists_are_asked_in_their_order() {
        let f = |wo: Vec3, wi: Vec3| 1.0 + wo[0] * wi[0] - 0.5 * wo[1] * wi[1] * wi[2];
        for phi_o in [1, 4] {
            let grid = Grid { theta_o: 9, phi_o, theta_h: 8, phi_h: 6 };
            let by_lists = weights_by(grid, &spots(grid), |pairs| {
                Ok::<_, ()>(pairs.iter().map(|[wo, wi]| f(*wo, *wi)).collect())
            });
            let one_by_one = (0..grid.views()).map(|view| weights(grid, view, &spots(grid), f));
            assert_eq!(by_lists, Ok(one_by_one.collect()));
        }
    }

    /// One cell's weight, at its neighbours, across the seam where cells go around, and nowhere.
    #[test]
    fn weights_fade_away_from_their_cells() {
        for (phi_o, behind) in [(1, 1f64), (4, 1024.0)] {
            let grid = Grid { theta_o: 2, phi_o, theta_h: 5, phi_h: 4 };
            let mut weights = vec![0.0; 20];
            fade(grid, &mut weights);
            assert_eq!(weights, [0.0; 20]);
            weights[2 * 4 + 3] = 32f64.powi(4);
            fade(grid, &mut weights);
            assert_eq!(weights[12..16], [behind, 32.0, 1024.0, 32f64.powi(3)]);
        }
    }
}
