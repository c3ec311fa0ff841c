//! Densities over the unit square, bilinear between nodes, as tables to draw from.
//!
//! x goes along a row. Each slice of a stack is normalised by itself; what is drawn between slices is their
//! mixture (Dupuy and Jakob 2018, section 4.3).

use brdf_sdk::native::tree;

/// A stack of densities, ready to be drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct Warps {
    /// Nodes along y and x.
    pub size: [usize; 2],
    /// Values at nodes, as parts of the whole over a step of both axes; x fastest, then y, then slices.
    pub densities: Vec<f32>,
    /// Along each row of nodes, the integral up to each node.
    pub cells: Vec<f32>,
    /// Along each row of nodes, the integral from each node on: near a row's end it has digits that `cells` lost.
    pub rests: Vec<f32>,
    /// Of each slice, the integral up to each row of nodes.
    pub rows: Vec<f32>,
}

impl Warps {
    /// Of slices of `size` nodes each; negative values count as 0, and a slice of zeros is even.
    pub fn new(size: [usize; 2], values: &[f32]) -> Self {
        let [_, columns] = size;
        let mut warps = Self {
            size,
            densities: Vec::new(),
            cells: Vec::new(),
            rests: Vec::new(),
            rows: Vec::new(),
        };
        for slice in values.chunks(size[0] * columns) {
            let mut values: Vec<f64> =
                slice.iter().map(|value| f64::from(value.max(0.0))).collect();
            let mut total = whole(&values, columns);
            if total <= 0.0 {
                values.fill(1.0);
                total = whole(&values, columns);
            }
            values.iter_mut().for_each(|value| *value /= total);
            let cells: Vec<Vec<f64>> = values.chunks(columns).map(up_to).collect();
            let ends: Vec<f64> = cells.iter().map(|row| row[columns - 1]).collect();
            warps.rows.extend(up_to(&ends).into_iter().map(|end| end as f32));
            for (row, whole) in cells.iter().zip(&ends) {
                warps.cells.extend(row.iter().map(|end| *end as f32));
                warps.rests.extend(row.iter().map(|end| (whole - end) as f32));
            }
            warps.densities.extend(values.into_iter().map(|value| value as f32));
        }
        warps
    }

    /// Of each slice a tree of its rows of nodes, and one of the nodes of each row: who draws chooses a node, by
    /// the integral of the hat function that its value has in the bilinear density, and then a place under it.
    pub fn trees(&self) -> Vec<f32> {
        let [rows, columns] = self.size;
        let mut texels = Vec::new();
        for slice in 0..self.rows.len() / rows {
            let row = |row: usize| (slice * rows + row) * columns;
            let wholes: Vec<f32> = (0..rows).map(|r| self.cells[row(r) + columns - 1]).collect();
            texels.extend(nodes(&wholes));
            for r in 0..rows {
                texels.extend(nodes(&self.densities[row(r)..][..columns]));
            }
        }
        texels.into_flattened()
    }

    /// The point of the unit square that a slice draws for `u`: (x, y).
    pub fn draw(&self, slice: usize, u: [f64; 2]) -> [f64; 2] {
        let [rows, columns] = self.size;
        let ends = &self.rows[slice * rows..][..rows];
        let (row, key) = step(|i| f64::from(ends[i]), rows, u[1]);
        let at = |row: usize, column: usize| (slice * rows + row) * columns + column;
        let [above, below] = [row, row + 1].map(|r| f64::from(self.cells[at(r, columns - 1)]));
        let y = ramp(above, below, key);
        let mixed = |of: &[f32], c: usize| {
            let [a, b] = [row, row + 1].map(|r| f64::from(of[at(r, c)]));
            a + (b - a) * y
        };
        let wanted = u[0] * (above + (below - above) * y);
        let (column, key) = step(|c| mixed(&self.cells, c), columns, wanted);
        let x = ramp(mixed(&self.densities, column), mixed(&self.densities, column + 1), key);
        [(column as f64 + x) / (columns - 1) as f64, (row as f64 + y) / (rows - 1) as f64]
    }
}

/// Levels of a tree of nodes.
const LEVELS: usize = 3;

/// Texels of it.
pub const TREE: usize = tree::texels(LEVELS);

/// The tree of nodes along an axis: those at the ends have half a hat.
fn nodes(values: &[f32]) -> Vec<[f32; 4]> {
    let last = values.len() - 1;
    let mass =
        |(i, value): (usize, &f32)| f64::from(*value) * if i == 0 || i == last { 0.5 } else { 1.0 };
    tree::tree(&values.iter().enumerate().map(mass).collect::<Vec<_>>(), LEVELS)
}

/// The four corners of each step of a table, of one of the numbers that each node has.
pub fn corners(
    [rows, columns]: [usize; 2],
    values: &[f32],
    numbers: usize,
    number: usize,
) -> Vec<f32> {
    let mut all = Vec::with_capacity((rows - 1) * (columns - 1) * 4);
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let at = row * columns + column;
            let below = at + columns;
            all.extend([at, at + 1, below, below + 1].map(|node| values[node * numbers + number]));
        }
    }
    all
}

/// Integrals of a linear function up to each node.
fn up_to(nodes: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = nodes.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    std::iter::once(0.0)
        .chain(steps)
        .map(|part| {
            sum += part;
            sum
        })
        .collect()
}

fn whole(values: &[f64], columns: usize) -> f64 {
    let ends: Vec<f64> = values.chunks(columns).map(|row| up_to(row)[columns - 1]).collect();
    up_to(&ends)[ends.len() - 1]
}

/// The step whose ends hold `key`, and the part of it that lies below.
fn step(ends: impl Fn(usize) -> f64, count: usize, key: f64) -> (usize, f64) {
    let at = (1..count - 1).take_while(|i| ends(*i) <= key).count();
    let (begin, end) = (ends(at), ends(at + 1));
    (at, if end > begin { ((key - begin) / (end - begin)).clamp(0.0, 1.0) } else { 0.5 })
}

/// Where in a step a linear density from `a` to `b` has the share `u` below it.
fn ramp(a: f64, b: f64, u: f64) -> f64 {
    let root = (a * a + (b * b - a * a) * u).sqrt();
    if a + root > 0.0 { u * (a + b) / (a + root) } else { u }
}
