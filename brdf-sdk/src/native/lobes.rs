//! Tables to sample a material by: for views, the distribution of the half vector.
//!
//! A library that returns them for a manifest with `lobes = "isotropic"` or `"anisotropic"` gives its WGSL
//! `lobe_sample` and `lobe_pdf` (shaders/lobes.wgsl), which are exact for each other whatever the tables hold.
//!
//! For each view the density of the half vector stands at nodes and is bilinear between them; a `wo` has the density
//! of the nearest view. So it is continuous in `wi`, and a node's density times the measure of its hat function is
//! the share of draws that begin at the node: who draws chooses a node, and then a place under its hat. A node's
//! density follows the root of the mean square of f cos_i dwi, with dwi = 4 (wo . h) dh, over points and views about
//! it: of all constants that gives weights of the least variance.
//!
//! Nodes stand where roots and quotients find them. Those of theta_h at s = (i / n)^4 / 2, s = sin^2(theta_h / 2), in
//! which equal steps are equal solid angles, so they are densest at the mirror direction; views at equal steps of
//! sqrt(1 - cos); the azimuth from `wo`'s at equal steps of t = y / (|x| + |y|), which goes from 0 to 1 in each
//! quarter of the turn. With t for the azimuth a density is per dt, and dt = dphi / (|x| + |y|)^2.
//!
//! Shares are whole numbers of slots ([`slots`]), and the densities are those of the slots: so a draw takes one look
//! for the row and one for the node, and is exact all the same.

use std::f64::consts::TAU;

use super::directions::{Vec3, direction, dot, mirrored};
use super::slots;
use super::{Array, in_parallel};

/// How many views and nodes there are.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Views from the normal to the horizon, both included: two or more.
    pub theta_o: usize,
    /// Views around, of equal steps of phi; 1 for an isotropic material, whose half vectors are mirrored about `wo`.
    pub phi_o: usize,
    /// Nodes of theta_h, from the normal to the horizon: 2 to 128.
    pub theta_h: usize,
    /// Nodes of the half vector's azimuth, from `wo`'s to the opposite one where phi_o is 1, else around: 2 to 32.
    pub phi_h: usize,
}

/// The tables' names as `lobes` declares them: two of u32, and one of vec4f.
pub const NAMES: [&str; 3] = ["lobe_rows", "lobe_columns", "lobe_densities"];

/// Slots that rows of nodes share, and those that a row's nodes do.
const SLOTS: [usize; 2] = [1024, 128];

/// Where about a node a material is looked at [steps].
const POINTS: [[f64; 2]; 5] = [[0.0, 0.0], [-0.4, -0.4], [0.4, -0.4], [-0.4, 0.4], [0.4, 0.4]];

impl Grid {
    fn isotropic(&self) -> bool {
        self.phi_o == 1
    }

    fn views(&self) -> usize {
        self.theta_o * self.phi_o
    }

    /// Steps between nodes along the azimuth: around, the last one leads to the first node.
    fn turns(&self) -> usize {
        if self.isotropic() { self.phi_h - 1 } else { self.phi_h }
    }

    /// s at a number of steps of theta_h.
    fn s(&self, steps: f64) -> f64 {
        0.5 * (steps / (self.theta_h - 1) as f64).clamp(0.0, 1.0).powi(4)
    }

    /// cos and sin of the azimuth at a number of steps of t.
    fn azimuth(&self, steps: f64) -> [f64; 2] {
        let quarters = if self.isotropic() { 2.0 } else { 4.0 };
        let t = (steps * quarters / self.turns() as f64).rem_euclid(4.0);
        let folded = if t > 2.0 { 4.0 - t } else { t };
        let (x, y) = (1.0 - folded, 1.0 - (1.0 - folded).abs());
        let length = x.hypot(y);
        [x / length, if t > 2.0 { -y } else { y } / length]
    }

    /// dphi / dt at a number of steps of t.
    fn stretch(&self, steps: f64) -> f64 {
        self.azimuth(steps).iter().map(|c| c.abs()).sum::<f64>().powi(2)
    }

    /// The integral of a node's hat function over s, and of one over 2 t in quarters of the turn and both sides.
    fn hats(&self, row: usize, column: usize) -> [f64; 2] {
        let height = 0.5 * (self.s(row as f64 + 1.0) - self.s(row as f64 - 1.0));
        let at_end = self.isotropic() && (column == 0 || column + 1 == self.phi_h);
        let width = 8.0 / self.turns() as f64;
        [height, if at_end { 0.5 * width } else { width }]
    }
}

/// Views that are looked at together where values come in lists.
const AT_ONCE: usize = 16;

/// The tables of a material whose value is `f(wo, wi)`, one number for its colours: the slots of each view's rows,
/// those of each row's nodes, and the densities [1 / (2 ds dt)] at the four corners of each step.
///
/// # Panics
/// A grid that is not as [`Grid`] says.
pub fn tables(grid: Grid, f: impl Fn(Vec3, Vec3) -> f64 + Sync) -> [Array; 3] {
    let spots = spots(grid);
    let made = in_parallel(grid.views(), |view| View::new(grid, &weights(grid, view, &spots, &f)));
    written(grid, &made)
}

/// The same of a material that gives its values for lists of `[wo, wi]`, such as one that runs on a device, and of
/// which nothing is known: weights fade away from nodes that have one, as its lobe may have been met by its edge alone.
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
    let mut weights = weights_by(grid, &spots(grid), f)?;
    weights.iter_mut().for_each(|weights| fade(grid, weights));
    let made = in_parallel(weights.len(), |view| View::new(grid, &weights[view]));
    Ok(written(grid, &made))
}

fn written(grid: Grid, views: &[View]) -> [Array; 3] {
    let (rows, columns) = (grid.theta_h - 1, grid.turns());
    let mut corners = Vec::with_capacity(views.len() * rows * columns * 4);
    for view in views {
        for row in 0..rows {
            for column in 0..columns {
                let next = (column + 1) % grid.phi_h;
                let at = [[row, column], [row, next], [row + 1, column], [row + 1, next]];
                corners.extend(at.map(|[row, column]| view.densities[row * grid.phi_h + column]));
            }
        }
    }
    let all = |of: fn(&View) -> &Vec<u32>| views.iter().flat_map(of).copied().collect();
    let [o, p] = [grid.theta_o, grid.phi_o].map(|n| n as u64);
    let [of_rows, of_columns] = SLOTS.map(|n| n as u64);
    let [rows, columns] = [rows, columns].map(|n| n as u64);
    [
        Array::u32(NAMES[0], [o, p, of_rows], all(|view| &view.rows)),
        Array::u32(NAMES[1], [o, p, rows + 1, of_columns], all(|view| &view.columns)),
        Array::f32(NAMES[2], [o, p, rows, columns, 4], corners),
    ]
}

struct View {
    /// Slots of its rows, and of each row's nodes.
    rows: Vec<u32>,
    columns: Vec<u32>,
    /// At each node [1 / (2 ds dt)].
    densities: Vec<f32>,
}

impl View {
    fn new(grid: Grid, weights: &[f64]) -> Self {
        let hat =
            |node: usize| grid.hats(node / grid.phi_h, node % grid.phi_h).iter().product::<f64>();
        let masses: Vec<f64> =
            weights.iter().enumerate().map(|(node, weight)| weight * hat(node)).collect();
        let sums: Vec<f64> = masses.chunks(grid.phi_h).map(|row| row.iter().sum()).collect();
        let of_rows = slots::shared(&sums, SLOTS[0]);
        let mut columns = Vec::with_capacity(grid.theta_h * SLOTS[1]);
        let mut densities = Vec::with_capacity(masses.len());
        for (row, (masses, of_row)) in masses.chunks(grid.phi_h).zip(&of_rows).enumerate() {
            let of_columns = slots::shared(masses, SLOTS[1]);
            columns.extend(slots::entries(&of_columns));
            densities.extend(of_columns.iter().enumerate().map(|(column, of_column)| {
                let share = (of_row * of_column) as f64 / (SLOTS[0] * SLOTS[1]) as f64;
                (share / hat(row * grid.phi_h + column)) as f32
            }));
        }
        Self { rows: slots::entries(&of_rows), columns, densities }
    }
}

/// A half vector about a node, at which a material is looked at.
struct Spot {
    node: usize,
    /// sin(theta_h) and cos(theta_h).
    across: f64,
    z: f64,
    /// cos and sin of the azimuth.
    azimuth: [f64; 2],
}

/// The spots of every node, the same for each view.
///
/// # Panics
/// A grid that is not as [`Grid`] says.
fn spots(grid: Grid) -> Vec<Spot> {
    let fits = grid.theta_o >= 2
        && grid.phi_o >= 1
        && (2..=128).contains(&grid.theta_h)
        && (2..=32).contains(&grid.phi_h);
    assert!(fits, "{grid:?}");
    let of_node = |node: usize| {
        let (i, j) = ((node / grid.phi_h) as f64, (node % grid.phi_h) as f64);
        POINTS.map(|[u, v]| {
            let s = grid.s(i + u);
            let across = 2.0 * (s * (1.0 - s)).sqrt();
            Spot { node, across, z: 1.0 - 2.0 * s, azimuth: grid.azimuth(j + v) }
        })
    };
    (0..grid.theta_h * grid.phi_h).flat_map(of_node).collect()
}

/// The light that half vectors about each node send to a view [1 / (ds dt)], in any unit.
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
    let mut weights = vec![0.0f64; grid.theta_h * grid.phi_h];
    for theta_o in thetas {
        for part in around {
            let phi_o = (column as f64 + part) * TAU / grid.phi_o as f64;
            let wo = direction(theta_o, if grid.isotropic() { 0.0 } else { phi_o });
            let length = wo[0].hypot(wo[1]);
            let axis = if length > 0.0 { [wo[0] / length, wo[1] / length] } else { [1.0, 0.0] };
            for spot in spots {
                weights[spot.node] += sent(grid, wo, axis, spot, &mut f);
            }
        }
    }
    // At the pole the azimuth means nothing.
    let pole = weights[..grid.phi_h].iter().sum::<f64>() / grid.phi_h as f64;
    weights[..grid.phi_h].fill(pole);
    for (node, weight) in weights.iter_mut().enumerate() {
        *weight = weight.sqrt() * grid.stretch((node % grid.phi_h) as f64);
    }
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

/// Gives each node at least a part of its neighbours' weights: the densities of a lobe that ends at once, as that of
/// a cone, do so over several steps.
fn fade(grid: Grid, weights: &mut [f64]) {
    const PART: f64 = 1.0 / 32.0;
    let columns = grid.phi_h;
    let mut raise = |node: usize, by: usize| weights[node] = weights[node].max(PART * weights[by]);
    for node in columns..columns * grid.theta_h {
        raise(node, node - columns);
    }
    for node in (0..columns * (grid.theta_h - 1)).rev() {
        raise(node, node + columns);
    }
    for row in (0..grid.theta_h).map(|row| row * columns) {
        // Where nodes go around, the second turn brings what began behind the seam.
        let steps = if grid.isotropic() { columns - 1 } else { 2 * columns };
        for step in 0..steps {
            raise(row + (step + 1) % columns, row + step % columns);
        }
        for step in (0..steps).rev() {
            raise(row + step % columns, row + (step + 1) % columns);
        }
    }
}

/// The mean square over both sides of the light that a half vector sends [1 / solid angle of the half vector]; the
/// azimuth counts from `axis`.
fn sent(
    grid: Grid,
    wo: Vec3,
    [ax, ay]: [f64; 2],
    spot: &Spot,
    f: &mut impl FnMut(Vec3, Vec3) -> f64,
) -> f64 {
    let Spot { across, z, azimuth: [x, y], .. } = *spot;
    let mut of_side = |side: f64| {
        let y = side * y;
        let h = [across * (ax * x - ay * y), across * (ay * x + ax * y), z];
        let wi = mirrored(wo, h);
        if wi[2] <= 0.0 {
            return 0.0;
        }
        let light = f(wo, wi).max(0.0) * wi[2] * 4.0 * dot(wo, h).max(0.0);
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

    /// The densities of every view integrate to 1, whatever the material: over a step the mean of its corners.
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
                for of_view in values.chunks(4 * (grid.theta_h - 1) * grid.turns()) {
                    let of_step = |(step, corners): (usize, &[f32])| {
                        let row = (step / grid.turns()) as f64;
                        let measure = (grid.s(row + 1.0) - grid.s(row)) * 8.0 / grid.turns() as f64;
                        corners.iter().map(|c| f64::from(*c)).sum::<f64>() / 4.0 * measure
                    };
                    let sum: f64 = of_view.chunks(4).enumerate().map(of_step).sum();
                    assert!((sum - 1.0).abs() < 1e-6, "{sum}");
                }
            }
        }
    }

    /// Values that come in lists are those of their nodes.
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

    /// One node's weight, at its neighbours, across the seam where nodes go around, and nowhere.
    #[test]
    fn weights_fade_away_from_their_nodes() {
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
