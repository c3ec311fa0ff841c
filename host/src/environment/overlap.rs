//! How much of each lat-long texel a texel of a cube covers, by solid angle.
//!
//! Everything is cut along meridians. With the azimuth a = 2 pi u and z the cosine of the polar angle, solid
//! angle is da dz. A meridian meets a texel of a cube in one stretch of z, known in closed form, and the rows
//! of a lat-long map in known steps of z: the integral over z is exact. What is left is smooth in a between
//! the corners of the texel, the edges of columns, and the places where the stretch's ends pass from row to
//! row; each such piece gets Gauss points.
//!
//! On the four side faces s = -tan(a - a of the face's middle), so that columns of a face are meridians
//! too; at (s, t) z = -t / sqrt(1 + s^2 + t^2). On the polar faces a meridian is a ray from the middle of the
//! face, on which z = ±1 / sqrt(1 + r^2) at the distance r.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// No piece is wider than this [radians].
const WIDEST: f64 = TAU / 192.0;
/// Gauss points in a piece where only the smooth bounds in z remain, and their weights.
const GAUSS: [(f64, f64); 2] = [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)];

/// A cube of `side` x `side` faces over a lat-long map of `columns` x `rows`.
#[derive(Debug)]
pub struct Overlap {
    side: usize,
    columns: usize,
    /// z at the rows' edges, from 1 down to -1.
    edges: Vec<f64>,
    /// For each side face (+x, -x, +z, -z) and each of its columns: the meridians that stand for it.
    meridians: Vec<Vec<Meridian>>,
}

/// One meridian across a side face.
#[derive(Debug, Clone, Copy)]
struct Meridian {
    /// Column of the lat-long map.
    column: usize,
    /// The azimuth that it stands for [radians].
    width: f64,
    /// 1 + s^2.
    stretch: f64,
}

impl Overlap {
    /// Prepares what all texels share.
    pub fn new(side: u32, columns: u32, rows: u32) -> Self {
        let edges =
            (0..=rows).map(|row| (PI * f64::from(row) / f64::from(rows)).cos()).collect::<Vec<_>>();
        let mut overlap =
            Self { side: side as usize, columns: columns as usize, edges, meridians: Vec::new() };
        for (middle, axis) in [(FRAC_PI_2, 0), (3.0 * FRAC_PI_2, 0), (PI, 1), (0.0, 1)] {
            for column in 0..overlap.side {
                let from = middle - overlap.edge(column + 1).atan();
                let to = middle - overlap.edge(column).atan();
                let mut meridians = Vec::new();
                // 1 + s^2 is one over the square of the cosine to the middle, which lies on an axis.
                let stretch = |heading: [f64; 2]| heading[axis].powi(-2);
                // The rows of a face share their meridians, so that what one loses to a row of the map the
                // next gains; only at the polar faces is the end of the stretch nobody's gain.
                let end = |heading: [f64; 2]| [1.0 / (1.0 + stretch(heading)).sqrt(); 2];
                overlap.pieces(from, to, end, |column, heading, width| {
                    meridians.push(Meridian { column, width, stretch: stretch(heading) });
                });
                overlap.meridians.push(meridians);
            }
        }
        overlap
    }

    /// Calls `add` with indices of lat-long texels and the solid angles [sr] that the texel at `column` and
    /// `row` of `face` covers of them; an index may come more than once.
    pub fn each(&self, face: usize, column: usize, row: usize, add: &mut impl FnMut(usize, f64)) {
        let (top, bottom) = (self.edge(row), self.edge(row + 1));
        let side_face = match face {
            2 => return self.polar(column, [top, bottom], 1.0, add),
            // On -y the same with t turned over and z negated.
            3 => return self.polar(column, [-bottom, -top], -1.0, add),
            4 | 5 => face - 2,
            _ => face,
        };
        for meridian in &self.meridians[side_face * self.side + column] {
            let z = |t: f64| -t / (meridian.stretch + t * t).sqrt();
            self.rows(meridian.column, meridian.width, [z(bottom), z(top)], add);
        }
    }

    /// The texel on the other side of the equator: what the texel of +y at a column and row covers of `index`, that
    /// of -y at the same column, rows counted from below, covers of this.
    pub fn mirrored(&self, index: usize) -> usize {
        let row = index / self.columns;
        index + self.columns * (self.edges.len() - 2) - 2 * row * self.columns
    }

    /// A texel of +y between two values of t, where (s, t) = r (sin a, -cos a).
    fn polar(&self, column: usize, t: [f64; 2], sign: f64, add: &mut impl FnMut(usize, f64)) {
        let s = [self.edge(column), self.edge(column + 1)];
        let azimuth = |s: f64, t: f64| s.atan2(-t);
        let (mut cuts, count, middle) = self.corners(s, t, azimuth);
        cuts[..count].sort_unstable_by(f64::total_cmp);
        let stretch = |[sin, cos]: [f64; 2]| {
            let [near, far] = crossing([sin, -cos], [s, t]);
            [far.max(near), near].map(|r| 1.0 / (1.0 + r * r).sqrt())
        };
        for pair in cuts[..count].windows(2) {
            let (from, to) = (middle + pair[0], middle + pair[1]);
            self.pieces(from, to, stretch, |column, heading, width| {
                let z = stretch(heading);
                let z = if sign > 0.0 { z } else { [-z[1], -z[0]] };
                self.rows(column, width, z, add);
            });
        }
    }

    /// Azimuths of a texel's corners, seen from that of its middle: the cuts, how many, and that of the middle.
    fn corners(
        &self,
        s: [f64; 2],
        t: [f64; 2],
        azimuth: impl Fn(f64, f64) -> f64,
    ) -> ([f64; 6], usize, f64) {
        let mut cuts = [0.0; 6];
        let mut count = 0;
        let around = s[0] < 0.0 && s[1] > 0.0 && t[0] < 0.0 && t[1] > 0.0;
        let middle = if around { 0.0 } else { azimuth(s[0] + s[1], t[0] + t[1]) };
        let mut cut = |at: f64| {
            cuts[count] = at;
            count += 1;
        };
        for (s, t) in [(s[0], t[0]), (s[0], t[1]), (s[1], t[0]), (s[1], t[1])] {
            // A corner on the pole itself lies on all meridians.
            if s != 0.0 || t != 0.0 {
                let off = azimuth(s, t) - middle;
                cut(off - TAU * (off / TAU).round());
            }
        }
        if around {
            cut(-PI);
            cut(PI);
        }
        (cuts, count, middle)
    }

    /// Cuts the azimuths between `from` and `to` where columns end and where an end of the `stretch` of z passes
    /// from row to row, and calls `visit` with the column, the heading (sine and cosine of the azimuth) and the
    /// weight [radians] of each Gauss point. Rows lie alike on both hemispheres, so the upper stretch
    /// serves for both.
    fn pieces(
        &self,
        from: f64,
        to: f64,
        stretch: impl Fn([f64; 2]) -> [f64; 2],
        mut visit: impl FnMut(usize, [f64; 2], f64),
    ) {
        let step = TAU / self.columns as f64;
        let first = (from / step).floor() as i64;
        let last = (to / step).ceil() as i64;
        let mut heading = from.sin_cos().into();
        let mut before = stretch(heading).map(|z| self.row_of(z));
        for k in first..last {
            let a = from.max(k as f64 * step);
            let b = to.min((k + 1) as f64 * step);
            if b <= a {
                continue;
            }
            let parts = ((b - a) / WIDEST).ceil().max(1.0);
            let width = (b - a) / parts;
            let column = k.rem_euclid(self.columns as i64) as usize;
            for _ in 0..parts as u32 {
                let end = turned(heading, width);
                let after = stretch(end).map(|z| self.row_of(z));
                let mut from = 0.0;
                let mut piece = |to: f64| {
                    let share = (to - from) * width;
                    for (place, weight) in GAUSS {
                        let at = turned(heading, from * width + place * share);
                        visit(column, at, weight * share);
                    }
                    from = to;
                };
                // Between two ends so near, the row runs in a straight line.
                Passages::new(before, after).for_each(&mut piece);
                piece(1.0);
                (heading, before) = (end, after);
            }
        }
    }

    /// The row at z with its fraction, to 1e-8 of all rows: it decides where pieces are cut and where a search
    /// begins, and needs no more. Abramowitz and Stegun 1964, equation 4.4.46.
    fn row_of(&self, z: f64) -> f64 {
        const TERMS: [f64; 8] = [
            -0.001_262_491_1,
            0.006_670_090_1,
            -0.017_088_125_6,
            0.030_891_881_0,
            -0.050_174_304_6,
            0.088_978_987_4,
            -0.214_598_801_6,
            1.570_796_305_0,
        ];
        let x = z.abs().min(1.0);
        let angle = (1.0 - x).sqrt() * TERMS.into_iter().fold(0.0, |sum, term| sum * x + term);
        let angle = if z < 0.0 { PI - angle } else { angle };
        angle * ((self.edges.len() - 1) as f64 / PI)
    }

    /// Shares a stretch of z among the rows of a column.
    fn rows(&self, column: usize, width: f64, z: [f64; 2], add: &mut impl FnMut(usize, f64)) {
        let rows = self.edges.len() - 1;
        let guess = self.row_of(z[1]) as usize;
        let mut row = guess.min(rows - 1);
        // The guess may be off by one where an edge is hit.
        while row > 0 && self.edges[row] < z[1] {
            row -= 1;
        }
        while row < rows && self.edges[row] > z[0] {
            let share = z[1].min(self.edges[row]) - z[0].max(self.edges[row + 1]);
            if share > 0.0 {
                add(row * self.columns + column, share * width);
            }
            row += 1;
        }
    }

    /// s or t at the edge `i` of the texels.
    fn edge(&self, i: usize) -> f64 {
        2.0 * i as f64 / self.side as f64 - 1.0
    }
}

/// The places in (0, 1) where two values that run straight from `before` to `after` pass whole numbers, in order.
#[derive(Debug, Clone, Copy)]
struct Passages {
    before: [f64; 2],
    slope: [f64; 2],
    /// The next whole number that each passes, and how many are left.
    next: [f64; 2],
    left: [u32; 2],
}

impl Passages {
    fn new(before: [f64; 2], after: [f64; 2]) -> Self {
        let mut passages = Self { before, slope: [0.0; 2], next: [0.0; 2], left: [0; 2] };
        for i in 0..2 {
            let (low, high) = (before[i].min(after[i]), before[i].max(after[i]));
            let (first, last) = (low.floor() + 1.0, high.ceil() - 1.0);
            passages.slope[i] = after[i] - before[i];
            passages.next[i] = if after[i] > before[i] { first } else { last };
            passages.left[i] = (last - first + 1.0).max(0.0) as u32;
        }
        passages
    }
}

impl Iterator for Passages {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let place = |i: usize| match self.left[i] {
            0 => f64::INFINITY,
            _ => (self.next[i] - self.before[i]) / self.slope[i],
        };
        let places = [place(0), place(1)];
        let i = usize::from(places[1] < places[0]);
        if self.left[i] == 0 {
            return None;
        }
        self.left[i] -= 1;
        self.next[i] += self.slope[i].signum();
        Some(places[i])
    }
}

/// Sine and cosine after a turn by an angle of at most [`WIDEST`], by Taylor's series: what is left out is below
/// 0.033^8 / 8! = 4e-17.
fn turned([sin, cos]: [f64; 2], angle: f64) -> [f64; 2] {
    let square = angle * angle;
    let s = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)));
    let c = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
    [sin * c + cos * s, cos * c - sin * s]
}

/// Where a ray from the origin enters and leaves a rectangle that it meets.
fn crossing(direction: [f64; 2], bounds: [[f64; 2]; 2]) -> [f64; 2] {
    let mut range = [0.0, f64::INFINITY];
    for (d, [low, high]) in direction.into_iter().zip(bounds) {
        if d != 0.0 {
            let scale = 1.0 / d;
            let (a, b) = (low * scale, high * scale);
            range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
        }
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{cube, orientation};

    /// Every texel of either map is covered exactly once, for all proportions of the two.
    #[test]
    fn overlaps_fill_both_maps() {
        for (side, width) in
            [(1, 2), (1, 64), (2, 8), (3, 12), (5, 64), (16, 64), (32, 16), (33, 50)]
        {
            let height = width / 2;
            let overlap = Overlap::new(side, width, height);
            let mut covered = vec![0.0; (width * height) as usize];
            let mut worst = 0.0_f64;
            for face in 0..6 {
                for row in 0..side {
                    for column in 0..side {
                        let mut sum = 0.0;
                        overlap.each(face, column as usize, row as usize, &mut |index, part| {
                            sum += part;
                            covered[index] += part;
                        });
                        let exact = cube::texel_solid_angle(side, column, row);
                        worst = worst.max((sum / exact - 1.0).abs());
                    }
                }
            }
            // What Gauss points leave of smooth bounds.
            assert!(worst < 2e-5, "{side} over {width}: a texel of the cube is off by {worst}");
            let mut worst = 0.0_f64;
            for (index, sum) in covered.iter().enumerate() {
                let row = index as u32 / width;
                worst = worst
                    .max((sum / orientation::texel_solid_angle(row, width, height) - 1.0).abs());
            }
            // And the straight lines between rows.
            assert!(worst < 5e-6, "{side} over {width}: a lat-long texel is off by {worst}");
        }
    }

    #[test]
    fn the_polar_faces_are_mirror_images() {
        let (side, columns, rows) = (5, 12, 6);
        let overlap = Overlap::new(side, columns, rows);
        assert_eq!([0, 13, 71].map(|i| overlap.mirrored(i)), [60, 49, 11]);
        for row in 0..side as usize {
            for column in 0..side as usize {
                let [mut up, mut down] = [[0.0; 72]; 2];
                overlap
                    .each(2, column, row, &mut |index, part| up[overlap.mirrored(index)] += part);
                overlap.each(3, column, side as usize - 1 - row, &mut |index, part| {
                    down[index] += part;
                });
                // Columns are sixteen widest pieces: rounding makes some of them seventeen, which moves the sum
                // by the error of the Gauss points.
                let off = up.iter().zip(down).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-8, "{column} {row}: {off}");
            }
        }
    }

    /// The overlaps beside those of random directions: a thousand points in each of many texels.
    #[test]
    fn overlaps_are_where_directions_say() {
        let (side, width, height) = (7_u32, 24_u32, 12_u32);
        let overlap = Overlap::new(side, width, height);
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for face in 0..6 {
            for cell in [0, 3, 10, 17, 24, 31, 48_u32] {
                let (column, row) = (cell % side, cell / side);
                let mut exact = vec![0.0; (width * height) as usize];
                overlap.each(face, column as usize, row as usize, &mut |index, part| {
                    exact[index] += part;
                });
                let total = cube::texel_solid_angle(side, column, row);
                let mut found = vec![0.0; exact.len()];
                let count = 20_000;
                for _ in 0..count {
                    let place = |i: u32, r: f64| 2.0 * (f64::from(i) + r) / f64::from(side) - 1.0;
                    let (s, t) = (place(column, random()), place(row, random()));
                    let (u, v) = orientation::uv_of(cube::direction_of(face, s, t));
                    let at = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n - 1);
                    let index = at(v, height) * width + at(u, width);
                    found[index as usize] +=
                        1.0 / (cube::uniform_density(side, s, t) * f64::from(count));
                }
                for (index, (exact, found)) in exact.iter().zip(&found).enumerate() {
                    // Five standard errors of a share p: 5 sqrt(p (1 - p) / n) <= 0.0177.
                    let off = (exact - found) / total;
                    assert!(
                        off.abs() < 0.0177,
                        "face {face} cell {cell} texel {index}: {exact} {found}"
                    );
                }
            }
        }
    }
}
