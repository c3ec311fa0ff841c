//! The hard cases: where BRDFs divide by little, subtract close numbers or leave their range.
//!
//! Grazing directions, lights at and near the viewer and its mirror direction, opposite azimuths; for
//! `sample`, points in the corners of the cube. The grid is fixed: no randomness.

use std::collections::BTreeSet;

use crate::link::Function;

/// What one call gets: `sample` takes `wo` and `u`, the others `wo` and `wi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// To the viewer: a unit vector above the horizon, local frame.
    pub wo: [f32; 3],
    /// To the light, likewise.
    pub wi: [f32; 3],
    /// A point of [0, 1)^3.
    pub u: [f32; 3],
}

/// Cosines with the normal, from the pole to where a degree is left to the 10^-6th part.
const HEIGHTS: [f64; 10] = [1.0, 0.9999, 0.97, 0.7, 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-6];
/// Azimuths of `wo` [degrees]: along both axes, where components are 0, and between them.
const AZIMUTHS: [f64; 3] = [0.0, 37.0, 90.0];
/// Azimuths of `wi` from that of `wo` [degrees].
const TURNS: [f64; 5] = [0.0, 90.0, 143.0, 179.99, 180.0];
/// Distances from `wo` and from its mirror direction [radians].
const OFFSETS: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// Where around it [degrees].
const SIDES: [f64; 3] = [0.0, 100.0, 215.0];
/// The largest f32 below 1 that a sampler gives.
const BELOW_ONE: f64 = 1.0 - 1.0 / (1 << 24) as f64;
const TINY: f64 = 1.0 / (1 << 24) as f64;
/// Coordinates of `u`.
const POINTS: [f64; 8] = [0.0, TINY, 1e-3, 0.25, 0.5, 0.8, 0.999, BELOW_ONE];
/// Its third coordinate, which picks a lobe.
const LOBES: [f64; 3] = [0.0, 0.5, BELOW_ONE];

/// The cases of a function.
pub fn cases_of(function: Function) -> Vec<Case> {
    match function {
        Function::Sample => points(),
        Function::Eval | Function::Pdf | Function::Weight => pairs(),
    }
}

fn views() -> Vec<[f64; 3]> {
    HEIGHTS.iter().flat_map(|z| AZIMUTHS.map(|azimuth| direction(*z, azimuth))).collect()
}

fn pairs() -> Vec<Case> {
    let mut found = Found::default();
    for (index, wo) in views().into_iter().enumerate() {
        let mirror = [-wo[0], -wo[1], wo[2]];
        for target in [wo, mirror] {
            found.add(wo, target, [0.0; 3]);
            for (offset, side) in OFFSETS.iter().flat_map(|offset| SIDES.map(|s| (*offset, s))) {
                found.add(wo, beside(target, offset, side), [0.0; 3]);
            }
        }
        let azimuth = AZIMUTHS[index % AZIMUTHS.len()];
        for (z, turn) in HEIGHTS.iter().flat_map(|z| TURNS.map(|turn| (*z, turn))) {
            found.add(wo, direction(z, azimuth + turn), [0.0; 3]);
        }
    }
    found.cases
}

fn points() -> Vec<Case> {
    let mut found = Found::default();
    for wo in views() {
        for (x, y) in POINTS.iter().flat_map(|x| POINTS.map(|y| (*x, y))) {
            LOBES.iter().for_each(|z| found.add(wo, [0.0, 0.0, 1.0], [x, y, *z]));
        }
    }
    found.cases
}

/// Cases that are there once each, in f32, and above the horizon.
#[derive(Default)]
struct Found {
    cases: Vec<Case>,
    known: BTreeSet<[u32; 9]>,
}

impl Found {
    fn add(&mut self, wo: [f64; 3], wi: [f64; 3], u: [f64; 3]) {
        let (Some(wo), Some(wi)) = (settled(wo), settled(wi)) else { return };
        let u = u.map(|coordinate| coordinate as f32);
        let mut bits = [0; 9];
        let all = wo.iter().chain(&wi).chain(&u);
        bits.iter_mut().zip(all).for_each(|(word, number)| *word = number.to_bits());
        if wo[2] > 0.0 && wi[2] > 0.0 && self.known.insert(bits) {
            self.cases.push(Case { wo, wi, u });
        }
    }
}

/// A unit vector of a height and an azimuth [degrees].
fn direction(z: f64, azimuth: f64) -> [f64; 3] {
    let r = ((1.0 - z) * (1.0 + z)).sqrt();
    let (sin, cos) = exact_sin_cos(azimuth);
    [r * cos, r * sin, z]
}

/// Sine and cosine of an angle [degrees]: 0 and 1 along the axes, where radians would leave 1e-17.
pub fn exact_sin_cos(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).rem_euclid(4.0);
    match quarters {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        3.0 => (-1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    }
}

/// A direction at an angle [radians] from another one, on one side of it [degrees].
fn beside(target: [f64; 3], angle: f64, side: f64) -> [f64; 3] {
    let [x, y, z] = target;
    // Any two directions across the target: down its meridian, and along its circle of latitude.
    let r = x.hypot(y);
    let (cos, sin) = if r > 0.0 { (x / r, y / r) } else { (1.0, 0.0) };
    let (down, along) = ([z * cos, z * sin, -r], [-sin, cos, 0.0]);
    let (side_sin, side_cos) = exact_sin_cos(side);
    let (angle_sin, angle_cos) = angle.sin_cos();
    let across = |i: usize| side_cos * down[i] + side_sin * along[i];
    [0, 1, 2].map(|i| angle_cos * target[i] + angle_sin * across(i))
}

/// The nearest f32 vector of length 1, or `None` for the zero vector.
pub fn unit(v: [f64; 3]) -> Option<[f32; 3]> {
    // Scaled first, so that no square leaves the range of f64.
    let largest = v.iter().fold(0.0f64, |largest, c| largest.max(c.abs()));
    let scaled = v.map(|c| c / largest);
    let length = scaled.iter().map(|c| c * c).sum::<f64>().sqrt();
    (largest > 0.0).then(|| scaled.map(|c| (c / length) as f32))
}

/// A unit vector that stays what it is when it is printed, read again and normalised, so that a
/// reported row reproduces its case; the few that go in circles are left out.
fn settled(v: [f64; 3]) -> Option<[f32; 3]> {
    const ROUNDS: usize = 8;
    let mut settled = unit(v)?;
    for _ in 0..ROUNDS {
        let read = settled.map(|c| c.to_string().parse().unwrap_or(f64::from(c)));
        let next = unit(read)?;
        if next == settled {
            return Some(settled);
        }
        settled = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_lie_in_the_domain_and_reach_its_corners() {
        for function in Function::ALL {
            let cases = cases_of(function);
            let unit_length = |w: [f32; 3]| {
                let length = w.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
                (length - 1.0).abs() < 1e-7 && w[2] > 0.0
            };
            assert!(cases.iter().all(|case| unit_length(case.wo) && unit_length(case.wi)));
            assert!(cases.iter().all(|case| case.u.iter().all(|u| (0.0..1.0).contains(u))));
            assert!(cases.iter().any(|case| case.wo[2] < 1.1e-6));
            assert!(cases.len() > 2000, "{}", cases.len());
        }
        let pairs = cases_of(Function::Eval);
        assert!(pairs.iter().any(|case| case.wi == case.wo && case.wo[2] < 1.0));
        let mirrored = |case: &&Case| case.wi == [-case.wo[0], -case.wo[1], case.wo[2]];
        assert!(pairs.iter().filter(mirrored).count() > 20);
        assert!(pairs.iter().any(|case| case.wo[2] < 1.1e-6 && case.wi[2] < 1.1e-6));
    }

    /// A row that is pasted into `brdf eval` is read as f64 and normalised.
    #[test]
    fn a_printed_row_is_read_as_the_same_case() {
        for case in cases_of(Function::Eval) {
            for w in [case.wo, case.wi] {
                let read = w.map(|c| c.to_string().parse::<f64>().unwrap());
                assert_eq!(unit(read), Some(w));
            }
        }
    }
}
