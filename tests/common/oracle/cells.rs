//! The sphere cut into pieces on which radiance is bilinear in the layout's own coordinates.
//!
//! With the nearest filter a piece is a texel. With the linear one it lies between four texel
//! centres, and what is left at a pole or at a face's edge are halves and quarters of such pieces.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::map::{Filter, Layout, Map, mix, on_face, on_lat_long};

/// A rectangle of coordinates: (u, polar angle [radians]) of a lat-long map, (s, t) on a cube's face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    pub face: usize,
    pub a: [f64; 2],
    pub b: [f64; 2],
}

/// A piece of the map with the radiance at its corners: (a0, b0), (a1, b0), (a0, b1), (a1, b1).
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    pub rect: Rect,
    pub corners: [[f64; 3]; 4],
}

/// The unit direction of a place, and the solid angle of an area there: dw = density da db [sr].
pub fn direction(layout: Layout, face: usize, a: f64, b: f64) -> (DVec3, f64) {
    match layout {
        Layout::LatLong => (on_lat_long(a, b), TAU * b.sin()),
        Layout::Cube => {
            let r2 = 1.0 + a * a + b * b;
            (on_face(face, a, b) / r2.sqrt(), 1.0 / (r2 * r2.sqrt()))
        }
    }
}

impl Rect {
    /// The middle of the rectangle.
    pub fn centre(&self) -> [f64; 2] {
        [0.5 * (self.a[0] + self.a[1]), 0.5 * (self.b[0] + self.b[1])]
    }

    /// Half the lengths [radians] of the two ways across, each at most what is returned.
    fn extent(&self, layout: Layout) -> [f64; 2] {
        let (da, db) = (0.5 * (self.a[1] - self.a[0]), 0.5 * (self.b[1] - self.b[0]));
        match layout {
            Layout::LatLong => {
                let widest = if self.b[0] <= 0.5 * PI && self.b[1] >= 0.5 * PI {
                    1.0
                } else {
                    self.b[0].sin().max(self.b[1].sin())
                };
                [TAU * da * widest, db]
            }
            // The projection of a face onto the sphere lengthens nothing.
            Layout::Cube => [da, db],
        }
    }

    /// An angle [radians] within which all of the rectangle lies around its middle: across, then along.
    pub fn radius(&self, layout: Layout) -> f64 {
        let [across, along] = self.extent(layout);
        across + along
    }

    /// Both halves, cut across the longer way.
    pub fn halves(&self, layout: Layout) -> [Self; 2] {
        let ([across, along], [a, b]) = (self.extent(layout), self.centre());
        if across > along {
            [Self { a: [self.a[0], a], ..*self }, Self { a: [a, self.a[1]], ..*self }]
        } else {
            [Self { b: [self.b[0], b], ..*self }, Self { b: [b, self.b[1]], ..*self }]
        }
    }
}

impl Cell {
    /// Radiance at a place of this piece.
    pub fn radiance(&self, a: f64, b: f64) -> [f64; 3] {
        let [p, q, r, s] = self.corners;
        let x = (a - self.rect.a[0]) / (self.rect.a[1] - self.rect.a[0]);
        let y = (b - self.rect.b[0]) / (self.rect.b[1] - self.rect.b[0]);
        mix(mix(p, q, x), mix(r, s, x), y)
    }

    /// Whether no light comes from here.
    fn is_black(&self) -> bool {
        self.corners.iter().flatten().all(|value| *value == 0.0)
    }
}

/// Cuts an axis of `n` texels at their borders, or at their centres too where it ends at an edge
/// (`closed`): from, to, and the two texels beside, counted from -1 to n.
fn cuts(n: usize, filter: Filter, closed: bool) -> Vec<([f64; 2], [i64; 2])> {
    let n = n as i64;
    match filter {
        Filter::Nearest => (0..n).map(|i| ([i as f64, (i + 1) as f64], [i, i])).collect(),
        // A ring: from each centre to the next.
        Filter::Linear if !closed => {
            (0..n).map(|i| ([i as f64 + 0.5, i as f64 + 1.5], [i, i + 1])).collect()
        }
        Filter::Linear => (-1..n)
            .map(|i| {
                let (from, to) = (i as f64 + 0.5, i as f64 + 1.5);
                ([from.max(0.0), to.min(n as f64)], [i, i + 1])
            })
            .collect(),
    }
}

/// All pieces of a map that are not black.
pub fn cells(map: &Map, filter: Filter) -> Vec<Cell> {
    let cube = map.layout == Layout::Cube;
    let (faces, rows) = if cube { (6, map.width) } else { (1, map.height) };
    let mut cells = Vec::new();
    for face in 0..faces {
        for (y, beside_y) in cuts(rows, filter, true) {
            for (x, beside_x) in cuts(map.width, filter, cube) {
                let scale = |x: f64, n: usize| match cube {
                    true => 2.0 * x / n as f64 - 1.0,
                    false => x / n as f64,
                };
                let rect = Rect {
                    face,
                    a: x.map(|x| scale(x, map.width)),
                    b: y.map(|y| scale(y, rows) * if cube { 1.0 } else { PI }),
                };
                // The filter's value at a corner: between the four texels around this piece.
                let corner = |i: usize, j: usize| {
                    if filter == Filter::Nearest {
                        return map.beyond(face, beside_x[0], beside_y[0]);
                    }
                    let value = |k: usize, l: usize| map.beyond(face, beside_x[k], beside_y[l]);
                    let along_x = x[i] - (beside_x[0] as f64 + 0.5);
                    let along_y = y[j] - (beside_y[0] as f64 + 0.5);
                    let upper = mix(value(0, 0), value(1, 0), along_x);
                    mix(upper, mix(value(0, 1), value(1, 1), along_x), along_y)
                };
                let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
                cells.push(Cell { rect, corners });
            }
        }
    }
    cells.retain(|cell| !cell.is_black());
    cells
}
