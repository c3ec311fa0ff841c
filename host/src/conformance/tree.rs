//! Cells of directions that follow a density: small where it is high, so that they align with a lobe
//! however narrow it is.
//!
//! The hemisphere in (theta, phi) is halved at medians of pilot points until each cell holds few of them.
//! Cells thus have about equal mass, as equal cells in a sampler's own (u, v) domain would have.

use super::cell::{Cell, LEAST_SIDE};

/// A tree of cells.
#[derive(Debug, Clone)]
pub struct Tree {
    nodes: Vec<Node>,
    /// The cells, neighbours near each other.
    pub leaves: Vec<Cell>,
    /// For each cell the number of the large cell that it lies in.
    pub group: Vec<usize>,
    /// How many large cells there are.
    pub groups: usize,
    rim: f32,
    /// What is integrated: the cells, or parts of them where the points fill only a band.
    pub parts: Vec<Part>,
}

/// A draw and the density there: what an integral has to see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Theta and phi [radians].
    pub at: [f32; 2],
    /// The density [1/sr].
    pub pdf: f32,
}

/// A part of a cell that is integrated by itself.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// The number of the cell that it belongs to.
    pub leaf: usize,
    /// Where it is.
    pub cell: Cell,
    /// The draws in it: where they lie in the list that [`Tree::put`] gives.
    pub draws: (usize, usize),
    /// How many times it has to be quartered before rules of Gauss can be believed: points that lie along
    /// a line make a ridge that a rule may step over.
    pub ridge: usize,
}

impl Part {
    /// Its quarters, with the draws in each, which are put in their order.
    pub fn quarters(self, draws: &mut [Seen]) -> [Part; 4] {
        let [low, _, _, high] = self.cell.quarters();
        let [theta, phi] = low.high;
        debug_assert_eq!(low.high, high.low);
        let below = below_of(draws, |draw| draw.at[0] < theta);
        let (lower, upper) = draws.split_at_mut(below);
        let first = self.draws.0;
        let ends = [
            first,
            first + below_of(lower, |draw| draw.at[1] < phi),
            first + below,
            first + below + below_of(upper, |draw| draw.at[1] < phi),
            self.draws.1,
        ];
        let quarters = self.cell.quarters();
        [0, 1, 2, 3].map(|i| Part { cell: quarters[i], draws: (ends[i], ends[i + 1]), ..self })
    }
}

/// The axis of a leaf in the list of nodes.
const LEAF: u32 = 2;

/// A cell that was halved, or a leaf: then both children are the leaf's number.
#[derive(Debug, Clone, Copy)]
struct Node {
    axis: u32,
    at: f32,
    children: [u32; 2],
}

/// Where the layers near the horizon end, in units of the rim.
const LAYERS: [f32; 4] = [0.25, 1.0, 4.0, 16.0];
/// Halvings to a large cell: at most 64 of them.
const GROUP_DEPTH: usize = 6;

impl Tree {
    /// Cells of about equal numbers of pilot points, at most `1 << depth` of them. Near the horizon, layers
    /// as thin as `rim` [radians] are integrated apart: what is seen at a grazing angle changes there.
    pub fn grow(points: &mut [[f32; 2]], depth: usize, rim: f32) -> Self {
        let mut tree = Tree {
            nodes: Vec::new(),
            leaves: Vec::new(),
            group: Vec::new(),
            groups: 0,
            parts: Vec::new(),
            rim,
        };
        tree.halve(Cell::HEMISPHERE, points, depth, 0, None);
        tree
    }

    fn halve(
        &mut self,
        cell: Cell,
        points: &mut [[f32; 2]],
        left: usize,
        depth: usize,
        group: Option<usize>,
    ) -> usize {
        const FEWEST: usize = 8;
        let group = group.or_else(|| (depth == GROUP_DEPTH).then(|| self.new_group()));
        let index = self.nodes.len();
        self.nodes.push(Node { axis: LEAF, at: 0.0, children: [self.leaves.len() as u32; 2] });
        let axis = if left > 0 && points.len() >= FEWEST { axis_of(cell, points) } else { None };
        let place = axis.and_then(|axis| Some((axis, median(cell, points, axis)?)));
        let Some((axis, at)) = place else {
            let group = group.unwrap_or_else(|| self.new_group());
            self.leaves.push(cell);
            self.group.push(group);
            self.add_parts(cell, points);
            return index;
        };
        let [mut below, mut above] = [cell; 2];
        below.high[axis] = at;
        above.low[axis] = at;
        let middle = below_of(points, |point| point[axis] < at);
        let (lower, upper) = points.split_at_mut(middle);
        let children = [
            self.halve(below, lower, left - 1, depth + 1, group) as u32,
            self.halve(above, upper, left - 1, depth + 1, group) as u32,
        ];
        self.nodes[index] = Node { axis: axis as u32, at, children };
        index
    }

    /// The parts of the last leaf, cut where its points fill only a narrow band of it.
    fn add_parts(&mut self, cell: Cell, points: &mut [[f32; 2]]) {
        let ridge = ridge(points);
        let leaf = self.leaves.len() - 1;
        let [thetas, phis] = [0, 1].map(|axis| {
            let mut all = vec![cell.low[axis], cell.high[axis]];
            all.extend(cuts(cell, points, axis));
            if axis == 0 && cell.high[0] == Cell::HEMISPHERE.high[0] {
                let layers = LAYERS.map(|part| Cell::HEMISPHERE.high[0] - part * self.rim);
                all.extend(layers.into_iter().filter(|at| cell.low[0] < *at && *at < cell.high[0]));
            }
            all.sort_unstable_by(f32::total_cmp);
            all
        });
        for theta in thetas.windows(2) {
            for phi in phis.windows(2) {
                let cell = Cell { low: [theta[0], phi[0]], high: [theta[1], phi[1]] };
                self.parts.push(Part { leaf, cell, draws: (0, 0), ridge });
            }
        }
    }

    fn new_group(&mut self) -> usize {
        self.groups += 1;
        self.groups - 1
    }

    /// Puts draws into their parts, and lists them part by part.
    pub fn put(&mut self, draws: &[Seen]) -> Vec<Seen> {
        let part_of = |draw: &Seen| {
            let leaf = self.find(draw.at.map(f64::from));
            let first = self.parts.partition_point(|part| part.leaf < leaf);
            let mut own = self.parts[first..].iter().take_while(|part| part.leaf == leaf);
            own.position(|part| part.cell.holds(draw.at)).map(|index| first + index)
        };
        let mut placed: Vec<(usize, Seen)> =
            draws.iter().filter_map(|draw| Some((part_of(draw)?, *draw))).collect();
        placed.sort_by_key(|(part, _)| *part);
        let mut first = 0;
        for of_part in placed.chunk_by(|a, b| a.0 == b.0) {
            self.parts[of_part[0].0].draws = (first, first + of_part.len());
            first += of_part.len();
        }
        placed.into_iter().map(|(_, draw)| draw).collect()
    }

    /// The cell of a direction above the horizon.
    pub fn find(&self, angles: [f64; 2]) -> usize {
        let mut node = self.nodes[0];
        while node.axis != LEAF {
            let above = angles[node.axis as usize] >= f64::from(node.at);
            node = self.nodes[node.children[usize::from(above)] as usize];
        }
        node.children[0] as usize
    }
}

/// The axis along which the points are spread widest, where the cell may still be halved across it.
fn axis_of(cell: Cell, points: &[[f32; 2]]) -> Option<usize> {
    let n = points.len() as f64;
    let sides = cell.sides();
    let spread = |axis: usize| {
        let mean = points.iter().map(|p| f64::from(p[axis])).sum::<f64>() / n;
        points.iter().map(|p| (f64::from(p[axis]) - mean).abs()).sum::<f64>() / n
    };
    let sine = points.iter().map(|p| f64::from(p[0]).sin()).sum::<f64>() / n;
    let spreads = [spread(0), spread(1) * sine];
    let best = usize::from(spreads[1] > spreads[0]);
    [best, 1 - best].into_iter().find(|axis| sides[*axis] >= 2.0 * LEAST_SIDE)
}

/// Where to cut a cell across an axis so that rules of Gauss see what its points do: about the points' median,
/// at first as far from it as half of them are, then ever farther. Nowhere where they fill the cell. A sliver
/// with too few points is cut ever nearer to both of its ends: it is a tail.
fn cuts(cell: Cell, points: &mut [[f32; 2]], axis: usize) -> Vec<f32> {
    const FEWEST: usize = 5;
    const GROWTH: f32 = 4.0;
    const SLIVER: f64 = 16.0;
    let [low, high] = [cell.low[axis], cell.high[axis]];
    let mut found = Vec::new();
    if points.len() < FEWEST {
        let sides = cell.sides();
        let mut reach = 0.25 * (high - low);
        while sides[axis] > SLIVER * sides[1 - axis] && reach > 1e-6 {
            found.extend([low + reach, high - reach]);
            reach /= GROWTH;
        }
        return found;
    }
    let mut places: Vec<f32> = points.iter().map(|point| point[axis]).collect();
    let half = places.len() / 2;
    let middle = *places.select_nth_unstable_by(half, f32::total_cmp).1;
    places.iter_mut().for_each(|place| *place = (*place - middle).abs());
    let deviation = *places.select_nth_unstable_by(half, f32::total_cmp).1;
    let mut reach = deviation.max(8.0 * f32::EPSILON * middle.abs());
    if 10.0 * reach > high - low {
        return Vec::new();
    }
    while middle - reach > low || middle + reach < high {
        let sides = [middle - reach, middle + reach];
        found.extend(sides.into_iter().filter(|at| low < *at && *at < high));
        reach *= GROWTH;
    }
    found
}

/// Brings those that are below a place to the front, and says how many they are.
fn below_of<T>(points: &mut [T], is_below: impl Fn(&T) -> bool) -> usize {
    let mut count = 0;
    for index in 0..points.len() {
        if is_below(&points[index]) {
            points.swap(index, count);
            count += 1;
        }
    }
    count
}

/// How many quarterings points along a line ask for.
fn ridge(points: &[[f32; 2]]) -> usize {
    let n = points.len().max(1) as f64;
    let mean = |axis: usize| points.iter().map(|p| f64::from(p[axis])).sum::<f64>() / n;
    let means = [mean(0), mean(1)];
    let moment = |i: usize, j: usize| {
        let product = |p: &[f32; 2]| (f64::from(p[i]) - means[i]) * (f64::from(p[j]) - means[j]);
        points.iter().map(product).sum::<f64>() / n
    };
    let scale = (moment(0, 0) * moment(1, 1)).sqrt();
    let correlation = if scale > 0.0 { moment(0, 1).abs() / scale } else { 0.0 };
    match correlation {
        c if c > 0.98 => 3,
        c if c > 0.9 => 2,
        c if c > 0.8 => 1,
        _ => 0,
    }
}

/// The median along an axis, inside of the cell by at least the least side; smaller points come to lie in
/// the first half.
fn median(cell: Cell, points: &mut [[f32; 2]], axis: usize) -> Option<f32> {
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
    let per_side = cell.sides()[axis] / f64::from(cell.high[axis] - cell.low[axis]);
    let margin = (LEAST_SIDE / per_side) as f32;
    let [low, high] = [cell.low[axis] + margin, cell.high[axis] - margin];
    let at = points[middle][axis].clamp(low.min(high), high.max(low));
    (cell.low[axis] < at && at < cell.high[axis]).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<[f32; 2]> {
        // A narrow lobe and a wide one.
        (0..8192u32)
            .map(|i| {
                let [x, y] = [0.754_877_666, 0.569_840_291].map(|k| (f64::from(i) * k).fract());
                match i % 2 {
                    0 => [0.7 + 1e-3 * x as f32, 0.3 + 1e-3 * y as f32],
                    _ => [1.5 * x as f32, 6.2 * y as f32 - 3.1],
                }
            })
            .collect()
    }

    #[test]
    fn cells_cover_the_hemisphere_once_and_follow_the_points() {
        let tree = Tree::grow(&mut points(), 8, 0.01);
        assert!((240..=256).contains(&tree.leaves.len()) && tree.groups == 64);
        let area: f64 = tree
            .leaves
            .iter()
            .map(|c| f64::from(c.high[0] - c.low[0]) * f64::from(c.high[1] - c.low[1]))
            .sum();
        assert!((area - std::f64::consts::PI.powi(2)).abs() < 1e-4, "{area}");
        let mut counts = vec![0; tree.leaves.len()];
        points().iter().for_each(|p| counts[tree.find(p.map(f64::from))] += 1);
        assert!(counts.iter().all(|n| (24..=40).contains(n)), "{counts:?}");
        for (leaf, cell) in tree.leaves.iter().enumerate() {
            let inside = [0, 1].map(|i| 0.5 * f64::from(cell.low[i] + cell.high[i]));
            assert_eq!(tree.find(inside), leaf);
        }
        assert!(tree.group.is_sorted() && tree.group.last() == Some(&63));
        parts_fill_their_cells(&tree);
    }

    fn parts_fill_their_cells(tree: &Tree) {
        let area = |c: &Cell| f64::from(c.high[0] - c.low[0]) * f64::from(c.high[1] - c.low[1]);
        for (leaf, cell) in tree.leaves.iter().enumerate() {
            let parts = tree.parts.iter().filter(|part| part.leaf == leaf);
            let sum: f64 = parts.map(|part| area(&part.cell)).sum();
            assert!((sum / area(cell) - 1.0).abs() < 1e-3, "{cell:?}: {sum}");
        }
    }

    /// Each draw lies in the part that it is listed with, and in the quarter after that.
    #[test]
    fn draws_are_listed_with_what_they_lie_in() {
        let mut tree = Tree::grow(&mut points(), 8, 0.01);
        let all: Vec<Seen> = points().into_iter().map(|at| Seen { at, pdf: at[0] }).collect();
        let mut draws = tree.put(&all);
        let listed: usize = tree.parts.iter().map(|part| part.draws.1 - part.draws.0).sum();
        assert_eq!([listed, draws.len()], [all.len(); 2]);
        for part in &tree.parts {
            let own = &mut draws[part.draws.0..part.draws.1];
            assert!(own.iter().all(|draw| part.cell.holds(draw.at)));
            let quarters = part.quarters(own);
            let inside = |quarter: &Part| {
                let own = &draws[quarter.draws.0..quarter.draws.1];
                assert!(own.iter().all(|draw| quarter.cell.holds(draw.at)), "{quarter:?}");
                own.len()
            };
            let of_quarters: usize = quarters.iter().map(inside).sum();
            assert_eq!(of_quarters, part.draws.1 - part.draws.0);
        }
    }

    #[test]
    fn cells_do_not_become_smaller_than_the_grid_of_f32_allows() {
        let mut all = vec![[0.5f32, 0.25]; 4096];
        let tree = Tree::grow(&mut all, 12, 0.01);
        assert!(
            tree.leaves.iter().all(|c| c.sides().iter().all(|side| *side >= LEAST_SIDE * 0.99))
        );
        assert!(tree.leaves.len() < 200);
        assert_eq!(tree.group.len(), tree.leaves.len());
        parts_fill_their_cells(&tree);
        // Clusters narrower than a cell may be, beside a few points far away.
        let near = |i: usize, at: f32| [at + 1e-6 * (i % 64) as f32, 0.3 + 1e-3 * (i / 64) as f32];
        let mut all: Vec<[f32; 2]> = (0..4096).map(|i| near(i, [1.5, 0.2, 1.3][i % 3])).collect();
        all.extend((0..64).map(|i| [0.02 * i as f32, 0.09 * i as f32 - 3.0]));
        parts_fill_their_cells(&Tree::grow(&mut all, 12, 1e-3));
        assert_eq!(tree.group.last(), Some(&(tree.groups - 1)));
    }
}
