//! Where a map's texels look, how much they see, and what all of them together send.

use glam::DVec3;
use rayon::prelude::*;

use super::{Environment, Layout, cube, orientation};

/// Luminance of linear Rec. 709 (ITU-R BT.709, the row of Y).
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

impl Environment {
    /// The direction (map space, any length) of the centre of a texel.
    pub fn direction(&self, column: u32, row: u32) -> DVec3 {
        let place = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
        match self.layout {
            Layout::LatLong => {
                orientation::direction_of(place(column, self.width), place(row, self.height))
            }
            Layout::Cube => {
                let side = self.width;
                let on_face = |i: u32| 2.0 * place(i, side) - 1.0;
                cube::direction_of((row / side) as usize, on_face(column), on_face(row % side))
            }
        }
    }

    /// Column and row of the texel that a direction (map space, any length) meets.
    pub fn texel_at(&self, direction: DVec3) -> (u32, u32) {
        let cell = |place: f64, n: u32| ((place * f64::from(n)) as u32).min(n - 1);
        match self.layout {
            Layout::LatLong => {
                let (u, v) = orientation::uv_of(direction);
                (cell(u, self.width), cell(v, self.height))
            }
            Layout::Cube => {
                let (face, s, t) = cube::face_of(direction);
                let on_face = |place: f64| cell(0.5 * (place + 1.0), self.width);
                (on_face(s), face as u32 * self.width + on_face(t))
            }
        }
    }

    /// Linear Rec. 709 radiance in a direction (map space, any length), of the nearest texel.
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let (column, row) = self.texel_at(direction);
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
