//! RGL: materials of the database of EPFL's Realistic Graphics Lab (Dupuy and Jakob 2018, An Adaptive
//! Parameterization for Efficient Material Acquisition and Rendering).
//!
//! For directions of the viewer, here the file's "incident" one, a file has the density of visible normals
//! (`vndf`), and over the square that it is drawn from the light that is left (`luminance`, `rgb` or `spectra`).
//! With m the half vector, u = (sqrt(2 theta_m / pi), phi_m / 2 pi + 1/2) and s the point from which `vndf` draws
//! u, f cos = rgb(s) ndf(u) / (4 sigma), or rgb(s) alone where the file has no `jacobian`. phi_m counts from the
//! viewer's azimuth where the material is isotropic.

mod container;
mod made_up;
mod spectrum;
mod warp;

use brdf_sdk::native::{Array, Loaded};

use crate::file;
use container::Container;
use warp::{TREE, Warps, corners};

/// Bytes of a file at the most; the largest of the database has a quarter of it.
const MOST_BYTES: u64 = 1 << 30;

/// Nodes along an axis of the normals and of the light, as far as the WGSL's searches go, and directions of the
/// viewer along an angle. Files of the database have 128, 32 and 8.
const MOST_NORMALS: usize = 128;
const MOST_LIGHT: usize = 64;
const MOST_DIRECTIONS: usize = 24;
/// Nodes of what is only looked up.
const MOST_NODES: usize = 1024;

/// The least that is left of a row behind a node: what is left is told from what came before by its sign, and cards
/// take products below 1.2e-38 for 0, which has none.
const LEAST_REST: f32 = 1e-30;

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Angles of the viewer from the normal [radians], ascending.
    pub theta: Vec<f32>,
    /// Azimuths of the viewer [radians], ascending; one where the material is isotropic.
    pub phi: Vec<f32>,
    /// Normals by their density in u, a slice for each azimuth and angle of the viewer.
    normals: Warps,
    /// The light over s, likewise.
    light: Warps,
    /// Colours over s: nodes along y and x, then red, green, blue in each, a slice for each viewer.
    colours: Table,
    /// The distribution of normals over u, and the projected area over the viewer's u.
    ndf: Table,
    sigma: Table,
    /// Whether values are multiplied by ndf / (4 sigma).
    jacobian: bool,
    /// How often the azimuths fit into the turn: by a half turn (2), or by mirrors along both axes (4).
    reduction: u32,
}

#[derive(Debug, Clone, PartialEq)]
struct Table {
    /// Nodes along y and x.
    size: [usize; 2],
    values: Vec<f32>,
}

/// The arrays of a file, or of a satin that is made up.
pub fn load(path: Option<&str>) -> Result<Loaded, String> {
    Ok(match path {
        None => made_up::satin().arrays(),
        Some(path) => parse(&file::whole(path, MOST_BYTES)?)?.arrays(),
    })
}

/// Reads a file's bytes.
pub fn parse(bytes: &[u8]) -> Result<Material, String> {
    let file = Container::parse(bytes)?;
    let theta = angles(&file, "theta_i")?;
    let phi = angles(&file, "phi_i")?;
    if theta.len() < 2 {
        return Err("its field `theta_i` has one angle, and views need two; fetch the file again"
            .to_owned());
    }
    if theta[0] < 0.0 || theta[theta.len() - 1] > 1.6 {
        return Err(format!(
            "its angles of the viewer go from {} to {}, and radians of a quarter of the turn are read; fetch the \
             file again",
            theta[0],
            theta[theta.len() - 1]
        ));
    }
    let isotropic = phi.len() <= 2;
    let phis = if isotropic { 1 } else { phi.len() };
    let views = |name: &str, behind: usize| -> Result<(Vec<usize>, Vec<f32>), String> {
        let (shape, mut values) = file.floats(name, 2 + behind)?;
        if shape[..2] != [phi.len(), theta.len()] {
            return Err(format!(
                "its field `{name}` is for {} x {} directions, and it has {} x {}; fetch the file again",
                shape[0],
                shape[1],
                phi.len(),
                theta.len()
            ));
        }
        // Both azimuths of an isotropic material hold the same.
        values.truncate(values.len() / phi.len() * phis);
        Ok((shape[2..].to_vec(), values))
    };
    let warps = |name: &str, most: usize| -> Result<Warps, String> {
        let (shape, values) = views(name, 2)?;
        Ok(Warps::new(nodes(name, &shape, most)?, &values))
    };
    let table = |name: &str| -> Result<Table, String> {
        let (shape, values) = file.floats(name, 2)?;
        Ok(Table { size: nodes(name, &shape, MOST_NODES)?, values })
    };
    let sigma = table("sigma")?;
    if sigma.values.iter().any(|value| *value <= 0.0) {
        return Err(
            "its field `sigma` is not above 0 everywhere; the file is damaged, so fetch it again"
                .to_owned(),
        );
    }
    let jacobian = file.has("jacobian") && file.byte("jacobian")? != 0;
    let (light, colours) = (warps("luminance", MOST_LIGHT)?, colours(&file, &views)?);
    if light.size != colours.size {
        return Err(format!(
            "its colours have {:?} nodes and its field `luminance` {:?}, and they are of the same points; fetch the \
             file again",
            colours.size, light.size
        ));
    }
    Ok(Material {
        normals: warps("vndf", MOST_NORMALS)?,
        light,
        colours,
        ndf: table("ndf")?,
        sigma,
        jacobian,
        reduction: if isotropic { 1 } else { reduction(&phi)? },
        phi: phi[..phis].to_vec(),
        theta,
    })
}

/// A field of ascending angles [radians].
fn angles(file: &Container, name: &str) -> Result<Vec<f32>, String> {
    let (_, angles) = file.floats(name, 1)?;
    if angles.len() > MOST_DIRECTIONS || angles.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(format!(
            "the {} angles of its field `{name}` do not ascend or are more than {MOST_DIRECTIONS}; the file is \
             damaged, so fetch it again",
            angles.len()
        ));
    }
    Ok(angles)
}

fn nodes(name: &str, shape: &[usize], most: usize) -> Result<[usize; 2], String> {
    match *shape {
        [y, x] if (2..=most).contains(&y) && (2..=most).contains(&x) => Ok([y, x]),
        _ => Err(format!(
            "its field `{name}` has {shape:?} nodes, and 2 to {most} an axis are read; store it with others"
        )),
    }
}

type Views<'a> = dyn Fn(&str, usize) -> Result<(Vec<usize>, Vec<f32>), String> + 'a;

/// `rgb` as it is, or `spectra` turned into it; colours of a node together.
fn colours(file: &Container, views: &Views) -> Result<Table, String> {
    let name = if file.has("rgb") { "rgb" } else { "spectra" };
    let (shape, values) = views(name, 3)?;
    let size = nodes(name, &shape[1..], MOST_NODES)?;
    let weights = match (name, shape[0]) {
        ("rgb", 3) => [0, 1, 2].map(|c| [0, 1, 2].map(|k| f64::from(u8::from(c == k)))).to_vec(),
        ("rgb", channels) => {
            return Err(format!("its field `rgb` has {channels} channels; store it with 3"));
        }
        (_, bands) => {
            let (_, wavelengths) = file.floats("wavelengths", 1)?;
            let ascend = wavelengths.windows(2).all(|pair| pair[0] < pair[1]);
            let weights =
                (wavelengths.len() == bands && ascend).then(|| spectrum::weights(&wavelengths));
            weights.flatten().ok_or_else(|| {
                format!(
                    "its {} wavelengths do not ascend, are not the {bands} of its spectra, or lie beyond what is \
                     seen; fetch the file again",
                    wavelengths.len()
                )
            })?
        }
    };
    let nodes = size[0] * size[1];
    let mut colours = Vec::with_capacity(values.len() / weights.len() * 3);
    for view in values.chunks(weights.len() * nodes) {
        for node in 0..nodes {
            let colour = weights.iter().enumerate().fold([0.0; 3], |sum, (band, weight)| {
                let value = f64::from(view[band * nodes + node]);
                [0, 1, 2].map(|c| sum[c] + weight[c] * value)
            });
            colours.extend(colour.map(|c| c as f32));
        }
    }
    if colours.iter().any(|c| !c.is_finite()) {
        return Err("its field `spectra` holds numbers that are too large for colours; the file is damaged, so fetch \
                    it again"
            .to_owned());
    }
    Ok(Table { size, values: colours })
}

/// How often the azimuths fit into a turn. They begin at -pi, as the folds of the WGSL expect.
fn reduction(phi: &[f32]) -> Result<u32, String> {
    use std::f32::consts::{PI, TAU};
    let range = phi[phi.len() - 1] - phi[0];
    let times = TAU / range;
    let whole = times.round();
    let fits = matches!(whole as i64, 1 | 2 | 4) && (times - whole).abs() < 0.1;
    if !fits || (phi[0] + PI).abs() > 0.1 {
        return Err(format!(
            "its azimuths go from {} to {}, which is no turn, half or quarter from -pi on; fetch the file again",
            phi[0],
            phi[phi.len() - 1]
        ));
    }
    Ok(whole as u32)
}

impl Material {
    /// Of each slice and step of the light the four nodes of red, of green, of blue and of its density.
    fn lit(&self) -> Vec<f32> {
        let size = self.light.size;
        let nodes = size[0] * size[1];
        let slices = self.colours.values.chunks(3 * nodes).zip(self.light.densities.chunks(nodes));
        let of_slice = |(colours, densities): (&[f32], &[f32])| {
            let [red, green, blue] = [0, 1, 2].map(|c| corners(size, colours, 3, c));
            let planes = [red, green, blue, corners(size, densities, 1, 0)];
            let texel = |i: usize| &planes[i % 4][i / 4 * 4..][..4];
            (0..planes[0].len()).flat_map(texel).copied().collect::<Vec<f32>>()
        };
        slices.flat_map(of_slice).collect()
    }

    /// The arrays that the WGSL reads: neighbours that are mixed lie in one texel.
    fn arrays(self) -> Loaded {
        let (views, steps) = (self.phi.len(), self.theta.len() - 1);
        let [rows, columns] = self.normals.size;
        // Of the angles t and t + 1 of the viewer, an entry of each at the nodes `a` and `b`.
        let of_angles = |values: &[f32], size: usize, view: [usize; 2], a: usize, b: usize| {
            let slice = view[0] * (steps + 1) + view[1];
            [slice, slice + 1]
                .map(|slice| [values[slice * size + a], values[slice * size + b]])
                .concat()
        };
        let last = |row: usize| (row + 1) * columns - 1;
        let (mut ends, mut cells, mut densities) = (Vec::new(), Vec::new(), Vec::new());
        for view in (0..views).flat_map(|phi| (0..steps).map(move |theta| [phi, theta])) {
            let size = rows * columns;
            for row in 0..rows {
                let integral = of_angles(&self.normals.rows, rows, view, row, row);
                let whole = of_angles(&self.normals.cells, size, view, last(row), last(row));
                ends.extend([integral[0], integral[2], whole[0], whole[2]]);
            }
            for node in 0..(rows - 1) * columns {
                let from = |values| of_angles(values, size, view, node, node + columns);
                let (up_to, rests) = (from(&self.normals.cells), from(&self.normals.rests));
                // The smaller of the two has the digits.
                let beyond = up_to.iter().zip(&rests).all(|(up_to, rest)| up_to > rest);
                match beyond {
                    true => cells.extend(rests.iter().map(|rest| -rest.max(LEAST_REST))),
                    false => cells.extend(up_to),
                }
                densities.extend(of_angles(
                    &self.normals.densities,
                    size,
                    view,
                    node,
                    node + columns,
                ));
            }
        }
        let [views, steps, rows, columns] = [views, steps, rows, columns].map(|n| n as u64);
        let slices = self.theta.len() as u64 * views;
        let [y, x] = self.light.size.map(|n| n as u64);
        let facts = [
            u32::from(self.jacobian),
            self.reduction,
            self.theta.len() as u32,
            self.phi.len() as u32,
        ];
        let angles = [&self.theta, &self.phi].map(|angles| fives(angles)).concat();
        Loaded::new([
            Array::u32("facts", [4], facts.to_vec()),
            Array::f32("angles", [2, 6, 4], angles.into_flattened()),
            Array::f32("normal_ends", [views, steps, rows, 4], ends),
            Array::f32("normal_cells", [views, steps, rows - 1, columns, 4], cells),
            Array::f32("normal_densities", [views, steps, rows - 1, columns, 4], densities),
            Array::f32("light_trees", [slices, y + 1, TREE as u64, 4], self.light.trees()),
            Array::f32("light", [slices, y - 1, x - 1, 4, 4], self.lit()),
            self.ndf.corners("distribution"),
            self.sigma.corners("areas"),
        ])
    }
}

/// Up to 24 ascending numbers: a texel that parts them in fives, and those of the fives.
fn fives(values: &[f32]) -> Vec<[f32; 4]> {
    let value = |index: usize| values.get(index).copied().unwrap_or(f32::MAX);
    let texel = |first: usize, step: usize| [0, 1, 2, 3].map(|i| value(first + i * step));
    std::iter::once(texel(4, 5)).chain((0..5).map(|five| texel(5 * five, 1))).collect()
}

impl Table {
    /// The four nodes of each step together.
    fn corners(&self, name: &str) -> Array {
        let [rows, columns] = self.size.map(|n| n as u64 - 1);
        Array::f32(name, [rows, columns, 4], corners(self.size, &self.values, 1, 0))
    }
}
