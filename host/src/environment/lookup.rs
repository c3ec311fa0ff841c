//! Where a map's texels look, how much they see, and what all of them together send.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::{Environment, Layout, cube, orientation};

impl Environment {
    /// The direction (map space, any length) of the centre of a texel.
    pub fn direction(&self, column: u32, row: u32) -> DVec3 {
        self.direction_at((column, row), [0.5, 0.5])
    }

    /// The direction (map space, any length) of a place in a texel, `at` in [0, 1] from its upper left corner.
    pub fn direction_at(&self, (column, row): (u32, u32), at: [f64; 2]) -> DVec3 {
        let place = |i: u32, at: f64, n: u32| (f64::from(i) + at) / f64::from(n);
        match self.layout {
            Layout::LatLong => orientation::direction_of(
                place(column, at[0], self.width),
                place(row, at[1], self.height),
            ),
            Layout::Cube => {
                let on_face = |i: u32, at: f64| 2.0 * place(i, at, self.width) - 1.0;
                let (face, row) = ((row / self.width) as usize, row % self.width);
                cube::direction_of(face, on_face(column, at[0]), on_face(row, at[1]))
            }
        }
    }

    /// Where a direction (map space, any length) meets the map: column and row of a texel, and the place
    /// in it, in [0, 1] from its upper left corner.
    pub fn place_of(&self, direction: DVec3) -> ((u32, u32), [f64; 2]) {
        let split = |place: f64, n: u32| {
            let at = place * f64::from(n);
            let cell = (at as u32).min(n - 1);
            (cell, at - f64::from(cell))
        };
        let (face, u, v, rows) = match self.layout {
            Layout::LatLong => {
                let (u, v) = orientation::uv_of(direction);
                (0, u, v, self.height)
            }
            Layout::Cube => {
                let (face, s, t) = cube::face_of(direction);
                (face as u32, 0.5 * (s + 1.0), 0.5 * (t + 1.0), self.width)
            }
        };
        let ((column, x), (row, y)) = (split(u, self.width), split(v, rows));
        ((column, face * rows + row), [x, y])
    }

    /// Linear Rec. 709 radiance in a direction (map space, any length), of the nearest texel.
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let ((column, row), _) = self.place_of(direction);
        let [r, g, b, _] = self.texels[row as usize * self.width as usize + column as usize];
        [r, g, b]
    }

    /// The solid angle of a texel [sr].
    pub fn solid_angle(&self, column: u32, row: u32) -> f64 {
        match self.layout {
            Layout::LatLong => orientation::texel_solid_angle(row, self.width, self.height),
            Layout::Cube => cube::texel_solid_angle(self.width, column, row % self.width),
        }
    }

    /// Solid angle [sr] over area of the texel at a place in it, the texel's own area being 1.
    pub fn solid_angle_at(&self, texel: (u32, u32), at: [f64; 2]) -> f64 {
        match self.layout {
            Layout::LatLong => {
                let polar = PI * (f64::from(texel.1) + at[1]) / f64::from(self.height);
                TAU / f64::from(self.width) * (PI / f64::from(self.height)) * polar.sin()
            }
            Layout::Cube => {
                let side = self.width;
                let on_face = |i: u32, at: f64| 2.0 * (f64::from(i) + at) / f64::from(side) - 1.0;
                let (s, t) = (on_face(texel.0, at[0]), on_face(texel.1 % side, at[1]));
                1.0 / cube::uniform_density(side, s, t)
            }
        }
    }

    /// The solid angles of a row of texels [sr].
    pub(super) fn solid_angles(&self, row: u32) -> Vec<f64> {
        match self.layout {
            Layout::LatLong => vec![self.solid_angle(0, row); self.width as usize],
            Layout::Cube => cube::row_solid_angles(self.width, row % self.width),
        }
    }

    /// Radiance integrated over the sphere, per channel [radiance x sr].
    ///
    /// Rows are added in order, so that the digits do not depend on the number of threads.
    pub fn energy(&self) -> [f64; 3] {
        let faces = match self.layout {
            Layout::LatLong => 1,
            Layout::Cube => 6,
        };
        // The rows of the six faces see the same.
        let (columns, rows) = (self.width as usize, self.height / faces);
        let rows_energy = |row: u32| {
            let angles = self.solid_angles(row);
            let mut sum = [0.0; 3];
            for face in 0..faces {
                let texels = &self.texels[(face * rows + row) as usize * columns..][..columns];
                for (texel, angle) in texels.iter().zip(&angles) {
                    for (sum, value) in sum.iter_mut().zip(texel) {
                        *sum += f64::from(*value) * angle;
                    }
                }
            }
            sum
        };
        let rows: Vec<[f64; 3]> = (0..rows).into_par_iter().map(rows_energy).collect();
        rows.into_iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
    }
}
