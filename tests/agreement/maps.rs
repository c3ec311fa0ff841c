//! The maps of the matrix, small: every texel counts in a picture of few samples.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::LazyLock;

use brdf_host::environment::{Options, load};

use crate::oracle::map::{face_of, mean, on_face, on_lat_long};
use crate::oracle::{Filter, Layout, Map};

/// Columns of a lat-long map, a power of two; a cube's face has a quarter of them.
pub static WIDTH: LazyLock<usize> = LazyLock::new(|| size_from("BRDF_AGREEMENT_WIDTH", 16));

/// What the environment asks for in place of the sizes that every run has.
pub fn size_from(variable: &str, usual: usize) -> usize {
    let asked = std::env::var(variable).ok();
    asked.map_or(usual, |size| {
        size.parse().unwrap_or_else(|_| panic!("{variable}={size}: a number is wanted"))
    })
}

/// A map by name, or nothing where outside data is not there.
pub fn map(name: &str, data: Option<&Path>) -> Option<Map> {
    match name {
        "furnace" => Some(lat_long(|_, _| [1.0; 3])),
        // In the sky before the sphere, to the right: seen by most of it, and mirrored by a part.
        "single-texel" => Some(lat_long(|x, y| {
            [if (x, y) == (*WIDTH * 3 / 8, *WIDTH / 8) { 100.0 } else { 0.0 }; 3]
        })),
        "structured" => Some(lat_long(structured)),
        _ => Some(reduced(&data?.join(format!("hdri/{name}_1k.hdr")))),
    }
}

fn lat_long(texel: impl Fn(usize, usize) -> [f32; 3]) -> Map {
    Map::new(Layout::LatLong, *WIDTH, *WIDTH / 2, texel)
}

/// A sky over a dark ground, a sun of one texel, a lamp in the pole row and one on the seam.
fn structured(x: usize, y: usize) -> [f32; 3] {
    match (x, y) {
        (5, 2) => [400.0, 380.0, 300.0],
        (3, 0) => [20.0, 60.0, 10.0],
        (15, 4) => [3.0, 8.0, 50.0],
        (_, 0..=3) => [0.4 + 0.04 * x as f32, 0.7, 1.5 - 0.2 * y as f32],
        _ => [0.2, 0.15 + 0.005 * ((x * 7) % 5) as f32, 0.1],
    }
}

/// A lat-long picture of twice as many columns as rows, reduced by boxes weighted by solid angle.
fn reduced(path: &Path) -> Map {
    let full = load(path, &Options::default()).unwrap();
    let (width, height) = (full.width as usize, full.height as usize);
    let side = width / *WIDTH;
    assert!(width == side * *WIDTH && height == side * *WIDTH / 2, "{}", path.display());
    let line = |y: usize| (PI * y as f64 / height as f64).cos();
    lat_long(|x, y| {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for row in y * side..(y + 1) * side {
            let weight = line(row) - line(row + 1);
            for column in x * side..(x + 1) * side {
                let texel = full.texels[row * width + column];
                (0..3).for_each(|c| sum[c] += weight * f64::from(texel[c]));
                weights += weight;
            }
        }
        sum.map(|sum| (sum / weights) as f32)
    })
}

/// The same light on a cube's faces, each texel a mean of 4 x 4 places. The layouts are not compared
/// with each other, so this only has to look alike.
pub fn on_cube(map: &Map) -> Map {
    let n = *WIDTH / 4;
    Map::new(Layout::Cube, n, 6 * n, |x, y| {
        let place =
            |i: usize, sub: usize| 2.0 * (i as f64 + (sub as f64 + 0.5) / 4.0) / n as f64 - 1.0;
        let places: Vec<[f64; 3]> = (0..16)
            .map(|sub| {
                let dir = on_face(y / n, place(x, sub % 4), place(y % n, sub / 4));
                map.radiance(dir, Filter::Nearest)
            })
            .collect();
        mean(&places).map(|value| value as f32)
    })
}

/// The cube has one lit texel too where the lat-long map has one: its neighbours would get a share.
pub fn single_texel_cube(map: &Map) -> Map {
    let n = *WIDTH / 4;
    let brightest =
        (0..map.texels.len()).max_by(|a, b| map.texels[*a][0].total_cmp(&map.texels[*b][0]));
    let index = brightest.unwrap_or(0);
    let (u, v) = ((index % *WIDTH) as f64 + 0.5, (index / *WIDTH) as f64 + 0.5);
    let (face, s, t) = face_of(on_lat_long(u / *WIDTH as f64, 2.0 * PI * v / *WIDTH as f64));
    let place = |s: f64| (0.5 * (s + 1.0) * n as f64) as usize;
    let lit = (place(s), face * n + place(t));
    Map::new(Layout::Cube, n, 6 * n, |x, y| [if (x, y) == lit { 100.0 } else { 0.0 }; 3])
}
