//! Texels as devices hold them: in one picture, with a border for the filter, each with its density;
//! and the order in which sums visit them.

use std::cmp::Ordering;
use std::sync::Arc;

use rayon::prelude::*;

use super::filter::{Filter, bordered, filtered_row};
use super::{Environment, Layout};
use crate::tone::luminance;

/// Size and texels of the texture that shaders/environment/map.wgsl reads: the fourth value is a texel's
/// density, 0 where none are given.
pub fn texture(
    map: &Environment,
    filter: Filter,
    densities: Option<&[f32]>,
) -> ([u32; 2], Arc<Vec<[f32; 4]>>) {
    let size = [map.width, map.height];
    if filter == Filter::Nearest && map.layout == Layout::LatLong && densities.is_none() {
        return (size, Arc::clone(&map.texels));
    }
    let border = match filter {
        Filter::Nearest => 0,
        Filter::Linear => 1,
    };
    let pictures = match filter {
        Filter::Nearest => Vec::new(),
        Filter::Linear => bordered(map),
    };
    // A cube's faces stand three to a row.
    let across = if map.layout == Layout::Cube { 3 } else { 1 };
    let faces = if map.layout == Layout::Cube { 6 } else { 1 };
    let (columns, rows) = (map.width as usize, map.height as usize / faces);
    let (wide, high) = (columns + 2 * border, rows + 2 * border);
    let width = across * wide;
    let mut texels = vec![[0.0; 4]; width * (faces / across) * high];
    texels.par_chunks_mut(width).enumerate().for_each(|(y, line)| {
        for (x, slot) in line.iter_mut().enumerate() {
            let face = y / high * across + x / wide;
            let (column, row) =
                ((x % wide) as i64 - border as i64, (y % high) as i64 - border as i64);
            let inside = (0..columns as i64).contains(&column) && (0..rows as i64).contains(&row);
            let index = (face * rows + row.max(0) as usize) * columns + column.max(0) as usize;
            let [r, g, b, _] = match pictures.get(face) {
                Some(picture) => picture.at(column, row),
                None => map.texels[index],
            };
            let density = match densities {
                Some(densities) if inside => densities[index],
                _ => 0.0,
            };
            *slot = [r, g, b, density];
        }
    });
    ([width as u32, ((faces / across) * high) as u32], Arc::new(texels))
}

/// The radiance of every texel, or the mean of the filtered radiance over it.
pub fn texel_radiance(map: &Environment, filter: Filter) -> Vec<[f64; 3]> {
    match filter {
        Filter::Nearest => {
            map.texels.par_iter().map(|t| [t[0], t[1], t[2]].map(f64::from)).collect()
        }
        Filter::Linear => {
            let pictures = bordered(map);
            let rows = map.height as usize / pictures.len();
            let row = |row: usize| {
                filtered_row(&pictures[row / rows], (row % rows) as i64).collect::<Vec<_>>()
            };
            (0..map.height as usize).into_par_iter().flat_map_iter(row).collect()
        }
    }
}

/// The texels that send light, in the order of the map or by falling luminance times solid angle.
pub fn order(map: &Environment, filter: Filter, by_luminance: bool) -> Vec<u32> {
    let columns = map.width as usize;
    let radiance = texel_radiance(map, filter);
    let light: Vec<f64> = radiance.into_par_iter().map(luminance).collect();
    let mut order: Vec<u32> =
        (0..light.len() as u32).filter(|index| light[*index as usize] > 0.0).collect();
    if by_luminance {
        let energy: Vec<f64> = light
            .par_iter()
            .enumerate()
            .map(|(index, light)| {
                light * map.solid_angle((index % columns) as u32, (index / columns) as u32)
            })
            .collect();
        let falling = |a: &u32, b: &u32| {
            let both = energy[*b as usize].partial_cmp(&energy[*a as usize]);
            both.unwrap_or(Ordering::Equal).then(a.cmp(b))
        };
        order.par_sort_unstable_by(falling);
    }
    order
}
