//! What lies across the edges of a map: the neighbours that a linear filter needs.
//!
//! A lat-long map goes round, and across a pole to the row itself half a turn away, so that filtered
//! radiance is continuous on the sphere. A cube's face goes on into the next face; at its corners,
//! where three texels meet, stands their mean.

use super::{Environment, Layout};

/// How radiance is read between texel centres.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Filter {
    /// A texel is constant
    #[default]
    Nearest,
    /// Bilinear between texel centres
    Linear,
}

/// One picture with a border of one texel all round: a lat-long map, or a face of a cube.
pub(super) struct Bordered {
    /// Columns without the border.
    width: usize,
    texels: Vec<[f32; 4]>,
}

impl Bordered {
    /// A texel; column and row begin at -1.
    pub fn at(&self, column: i64, row: i64) -> [f32; 4] {
        self.texels[(row + 1) as usize * (self.width + 2) + (column + 1) as usize]
    }

    /// A row with its border, from -1.
    pub fn row(&self, row: i64) -> &[[f32; 4]] {
        let start = (row + 1) as usize * (self.width + 2);
        &self.texels[start..start + self.width + 2]
    }
}

/// The map's pictures with their borders: one, or a cube's six.
pub(super) fn bordered(map: &Environment) -> Vec<Bordered> {
    match map.layout {
        Layout::LatLong => vec![latlong(map)],
        Layout::Cube => (0..6).map(|face| cube_face(map, face)).collect(),
    }
}

fn latlong(map: &Environment) -> Bordered {
    let (width, height) = (i64::from(map.width), i64::from(map.height));
    let texel = |x: i64, y: i64| {
        // Across a pole the same latitude goes on half a turn away.
        let across = y < 0 || y >= height;
        let x = (x + if across { width / 2 } else { 0 }).rem_euclid(width);
        map.texels[(y.clamp(0, height - 1) * width + x) as usize]
    };
    let rows = (-1..=height).flat_map(|y| (-1..=width).map(move |x| texel(x, y)));
    Bordered { width: map.width as usize, texels: rows.collect() }
}

fn cube_face(map: &Environment, face: usize) -> Bordered {
    let side = i64::from(map.width);
    let own = |x: i64, y: i64| map.texels[((face as i64 * side + y) * side + x) as usize];
    let across = |x: i64, y: i64| {
        // One step over the edge, as a direction, lies on the neighbour's edge texel.
        let place = |i: i64| match i {
            _ if i < 0 => -1.0 - 1e-6,
            _ if i >= side => 1.0 + 1e-6,
            _ => (2 * i + 1) as f64 / side as f64 - 1.0,
        };
        let (other, s, t) =
            super::cube::face_of(super::cube::direction_of(face, place(x), place(y)));
        let index = |at: f64| (((at + 1.0) * 0.5 * side as f64) as i64).clamp(0, side - 1);
        map.texels[((other as i64 * side + index(t)) * side + index(s)) as usize]
    };
    let inside = |i: i64| (0..side).contains(&i);
    let texel = |x: i64, y: i64| match (inside(x), inside(y)) {
        (true, true) => own(x, y),
        (true, false) | (false, true) => across(x, y),
        (false, false) => {
            let (cx, cy) = (x.clamp(0, side - 1), y.clamp(0, side - 1));
            let three = [own(cx, cy), across(x, cy), across(cx, y)];
            std::array::from_fn(|c| three.iter().map(|texel| texel[c] / 3.0).sum())
        }
    };
    let rows = (-1..=side).flat_map(|y| (-1..=side).map(move |x| texel(x, y)));
    Bordered { width: map.width as usize, texels: rows.collect() }
}

/// The mean of the filtered radiance over each texel of a row, from the row and those beside it: weights
/// 1/8, 6/8, 1/8 either way, the integrals of a bilinear hat over a texel and its neighbours.
pub(super) fn filtered_row(map: &Bordered, row: i64) -> impl Iterator<Item = [f64; 3]> + '_ {
    let rows = [map.row(row - 1), map.row(row), map.row(row + 1)];
    (1..=map.width).map(move |x| {
        std::array::from_fn(|channel| {
            let mut sum = 0.0;
            for (texels, down) in rows.iter().zip([1.0, 6.0, 1.0]) {
                for (texel, across) in texels[x - 1..=x + 1].iter().zip([1.0, 6.0, 1.0]) {
                    sum += down * across * f64::from(texel[channel]);
                }
            }
            sum / 64.0
        })
    })
}
