//! Measured materials: bins are read where the formats have them, values agree with another program's, and what
//! is exported as a MERL file comes back.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fs;
use std::path::Path;
use std::sync::Arc;

use brdf_host::environment::Environment;
use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::{Executor, Precision};
use brdf_host::link::{View, link};
use brdf_host::plugin::Configured;
use brdf_host::render::evaluate::{Pair, Scattered, evaluate};
use brdf_host::session::Chosen;
use brdf_sdk::Kind;
use common::program::{folder, refused, run, text};
use common::shot::{Shot, map, sphere};
use common::{brdf, data, devices, integrator, registry};
use serde_json::Value;

/// The BRDF that opens a file, with some parameters set.
fn opened(file: &Path, set: &[&str]) -> Configured {
    let found = Chosen::find(&registry(), Kind::Brdf, file.to_str().unwrap());
    let mut brdf = found.unwrap_or_else(|problem| panic!("{problem}")).configured;
    let manifest = brdf.plugin.manifest.clone();
    set.iter().for_each(|set| brdf.values.set_text(&manifest, set).unwrap());
    brdf
}

fn values(executor: &mut dyn Executor, brdf: &Configured, pairs: &[Pair]) -> Vec<Scattered> {
    let program = Arc::new(link(&View::Eval { brdf: brdf.clone() }).unwrap());
    evaluate(executor, &program, brdf, pairs).unwrap()
}

/// A direction by its angles from the normal and the tangent [radians].
fn at(theta: f64, phi: f64) -> [f64; 3] {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

fn pair(wo: [f64; 3], wi: [f64; 3]) -> Pair {
    Pair { wo: wo.map(|c| c as f32), wi: wi.map(|c| c as f32) }
}

/// The directions of half and difference angles, by rotations as Rusinkiewicz 1998 has them: the difference
/// vector is turned about y by theta_h, then about z by phi_h.
fn half_difference(theta_h: f64, phi_h: f64, theta_d: f64, phi_d: f64) -> Pair {
    let turned = |[x, y, z]: [f64; 3]| {
        let (x, z) = (x * theta_h.cos() + z * theta_h.sin(), z * theta_h.cos() - x * theta_h.sin());
        [x * phi_h.cos() - y * phi_h.sin(), x * phi_h.sin() + y * phi_h.cos(), z]
    };
    let wi = turned(at(theta_d, phi_d));
    let h = turned([0.0, 0.0, 1.0]);
    let along = 2.0 * (0..3).map(|i| wi[i] * h[i]).sum::<f64>();
    pair([0, 1, 2].map(|i| along * h[i] - wi[i]), wi)
}

/// A MERL file with one bright bin is bright where the format says, and dark in the neighbours along every axis.
/// Directions on a border of the bins, as those of round degrees are, lie in one bin whatever the last digit says.
#[test]
fn borders_of_csail_bins_are_the_same_in_f32_and_f64() {
    let brdf = brdf("csail", &["interpolation=nearest"]);
    let direction = |theta: f64, phi: f64| {
        let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
        [sin * x, sin * y, cos]
    };
    let angles = [10.0, 15.0, 30.0, 45.0, 60.0, 75.0];
    let azimuths = [0.0, 30.0, 90.0, 135.0, 180.0, 300.0];
    let pairs: Vec<Pair> = angles
        .into_iter()
        .flat_map(|wo| {
            azimuths.map(|phi| Pair::new(direction(wo, 0.0), direction(33.3, phi + 7.7)))
        })
        .collect();
    let [narrow, wide] = [Precision::F32, Precision::F64]
        .map(|precision| values(&mut Cpu::new(precision), &brdf, &pairs));
    for ((pair, a), b) in pairs.iter().zip(&narrow).zip(&wide) {
        for (a, b) in a.f.iter().zip(&b.f) {
            assert!((a - b).abs() <= 1e-5 * b.abs(), "{pair:?}: {a} in f32, {b} in f64");
        }
    }
}

#[test]
fn one_bin_of_a_merl_file() {
    let folder = folder();
    for columns in [180usize, 360] {
        let bin = [30usize, 12, 100];
        let index = bin[2] + columns * (bin[1] + 90 * bin[0]);
        let count = 90 * 90 * columns;
        let mut bytes = Vec::new();
        for size in [90i32, 90, columns as i32] {
            bytes.extend(size.to_le_bytes());
        }
        for colour in [3.0f64, 5.0, 7.0] {
            let plane =
                (0..count).flat_map(|i| (if i == index { colour } else { 0.0 }).to_le_bytes());
            bytes.extend(plane);
        }
        let file = folder.path().join("bin.binary");
        fs::write(&file, bytes).unwrap();
        let brdf = opened(&file, &["interpolation=nearest"]);
        // The bin of theta_h is floor(sqrt(theta_h 2 / pi) 90), the others are cut evenly.
        let turn = if columns == 360 { TAU } else { PI };
        let middle = |bin: [usize; 3]| {
            let part = |n: usize, of: usize| (n as f64 + 0.5) / of as f64;
            let root = part(bin[0], 90);
            (root * root * FRAC_PI_2, part(bin[1], 90) * FRAC_PI_2, part(bin[2], columns) * turn)
        };
        let mut pairs = Vec::new();
        for phi_h in [0.0, 0.7, 4.0] {
            let (theta_h, theta_d, phi_d) = middle(bin);
            pairs.push(half_difference(theta_h, phi_h, theta_d, phi_d));
            for axis in 0..3 {
                for step in [-1i64, 1] {
                    let mut other = bin;
                    other[axis] = (other[axis] as i64 + step) as usize;
                    let (theta_h, theta_d, phi_d) = middle(other);
                    pairs.push(half_difference(theta_h, phi_h, theta_d, phi_d));
                }
            }
        }
        // Exchanged directions are half a turn of phi_d away: the same bin of 180, another one of 360.
        let exchanged = Pair { wo: pairs[0].wi, wi: pairs[0].wo };
        pairs.push(exchanged);
        for mut device in devices() {
            let found = values(device.as_mut(), &brdf, &pairs);
            for (i, found) in found.iter().enumerate() {
                let bright = if i == 21 { columns == 180 } else { i % 7 == 0 };
                let scales = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
                for (c, stored) in [3.0, 5.0, 7.0].into_iter().enumerate() {
                    let expected = if bright { stored * scales[c] } else { 0.0 };
                    // Held in steps of 1/256 to 1/511 of the largest colour, so half of one may be lost.
                    let largest = if bright { 7.0 * scales[2] } else { 0.0 };
                    assert!(
                        (found.f[c] - expected).abs() <= largest / 512.0,
                        "{columns} {i}: {found:?}"
                    );
                }
            }
        }
    }
}

/// Between the middles of two bins the value is half of both, on every axis, and phi_d goes around.
#[test]
fn a_merl_file_is_interpolated_between_middles() {
    let folder = folder();
    let file = folder.path().join("bin.binary");
    let write = |bright: usize| {
        let mut bytes: Vec<u8> = [90i32, 90, 180].iter().flat_map(|n| n.to_le_bytes()).collect();
        for _ in 0..3 {
            let plane = (0..90 * 90 * 180)
                .flat_map(|i| (f64::from(u8::from(i == bright)) * 1500.0).to_le_bytes());
            bytes.extend(plane);
        }
        fs::write(&file, bytes).unwrap();
    };
    let pair = |[h, d, p]: [f64; 3]| {
        let root = h / 90.0;
        half_difference(root * root * FRAC_PI_2, 0.3, d / 90.0 * FRAC_PI_2, p / 180.0 * PI)
    };
    let mut cpu = Cpu::new(Precision::F64);
    let mut red = |bin: [usize; 3], places: &[[f64; 3]]| -> Vec<f64> {
        write(bin[2] + 180 * (bin[1] + 90 * bin[0]));
        let pairs: Vec<Pair> = places.iter().map(|place| pair(*place)).collect();
        values(&mut cpu, &opened(&file, &[]), &pairs).iter().map(|value| value.f[0]).collect()
    };
    let near = |found: &[f64], expected: &[f64]| {
        // Directions in f32 move a place by some 1e-5 of a bin.
        let apart = found.iter().zip(expected).any(|(a, b)| (a - b).abs() > 1e-3);
        assert!(!apart, "{found:?} instead of {expected:?}");
    };
    let middle = [20.5, 30.5, 60.5];
    let places = [
        middle,
        [21.0, 30.5, 60.5],
        [20.5, 31.0, 60.5],
        [20.5, 30.5, 61.0],
        [20.5, 30.5, 60.0],
        [20.0, 30.0, 60.0],
        [20.5, 30.5, 61.5],
    ];
    near(&red([20, 30, 60], &places), &[1.0, 0.5, 0.5, 0.5, 0.5, 0.125, 0.0]);
    // The last bin of phi_d and the first are neighbours.
    near(&red([20, 30, 179], &[[20.5, 30.5, 180.0], [20.5, 30.5, 0.25]]), &[0.5, 0.25]);
    // At theta_d = 0 phi_d means nothing: the mean of the first row, whatever it is.
    near(
        &red([20, 0, 60], &[[20.5, 0.0, 10.0], [20.5, 0.25, 60.5]]),
        &[1.0 / 180.0, 0.5 * (1.0 + 1.0 / 180.0)],
    );
}

/// The same for MIT CSAIL's bins, with whole and with half data, where exchanged directions stand for the rest.
#[test]
fn one_bin_of_a_csail_file() {
    let folder = folder();
    let bins = [6usize, 5, 8, 12];
    let bin = [2usize, 3, 5, 7];
    for half in [false, true] {
        let index = bin[3] + bins[3] * (bin[2] + bins[2] * (bin[1] + bins[1] * bin[0]));
        let mut header = [0i32; 16];
        header[..4].copy_from_slice(&bins.map(|n| n as i32));
        (header[9], header[10]) = (i32::from(half), 3);
        let mut bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
        for colour in [0.5f32, 0.25, 0.125] {
            let count = bins.iter().product::<usize>();
            bytes.extend(
                (0..count).flat_map(|i| (if i == index { colour } else { 0.0 }).to_le_bytes()),
            );
        }
        let file = folder.path().join("bin.dat");
        fs::write(&file, bytes).unwrap();
        let brdf = opened(&file, &["interpolation=nearest"]);
        let turn = if half { PI } else { TAU };
        let directions = |bin: [usize; 4]| {
            let part = |axis: usize| (bin[axis] as f64 + 0.5) / bins[axis] as f64;
            let phi_in = part(3) * TAU;
            let wi = at(part(0) * FRAC_PI_2, phi_in);
            pair(at(part(1) * FRAC_PI_2, phi_in + part(2) * turn), wi)
        };
        let mut pairs = vec![directions(bin)];
        for axis in 0..4 {
            for step in [-1i64, 1] {
                let mut other = bin;
                other[axis] = (other[axis] as i64 + step) as usize;
                pairs.push(directions(other));
            }
        }
        pairs.push(Pair { wo: pairs[0].wi, wi: pairs[0].wo });
        for mut device in devices() {
            for (i, found) in values(device.as_mut(), &brdf, &pairs).iter().enumerate() {
                let bright = i == 0 || (i == 9 && half);
                for (c, stored) in [0.5, 0.25, 0.125].into_iter().enumerate() {
                    // 10 is the scale of BRDF Explorer.
                    let expected = if bright { 10.0 * stored } else { 0.0 };
                    assert!((found.f[c] - expected).abs() <= 1e-6, "{half} {i}: {found:?}");
                }
            }
        }
    }
}

/// An image slice from text and its axes: theta_h to the right, theta_d upwards.
#[test]
fn an_image_slice_has_its_axes() {
    let folder = folder();
    let file = folder.path().join("slice.txt");
    // Three columns and two rows, the upper row first.
    fs::write(&file, "3 2\n10 20 30\n1 2 3\n").unwrap();
    let brdf = opened(&file, &["square=false"]);
    let place = |column: f64, row: f64| {
        half_difference(column / 3.0 * FRAC_PI_2, 0.0, row / 2.0 * FRAC_PI_2, FRAC_PI_2)
    };
    // The middles of the lower row; right of it theta_h and theta_d leave no light above the horizon.
    let pairs =
        [place(0.5, 0.5), place(1.5, 0.5), place(1.0, 0.5), place(0.5, 1.0), place(0.25, 1.25)];
    for mut device in devices() {
        let found = values(device.as_mut(), &brdf, &pairs);
        for (found, expected) in found.iter().zip([1.0, 2.0, 1.5, 5.5, 7.75]) {
            assert!((found.f[0] - expected).abs() < 1e-4, "{} instead of {expected}", found.f[0]);
        }
    }
}

/// Mitsuba 3's values of three files of the RGL database, unclamped: f cos to 1e-4 where it is above 1e-3 of its
/// peak, and the density there. Its albedos within four standard errors.
#[test]
fn rgl_files_agree_with_mitsuba() {
    let Some(data) = data() else { return };
    let golden = fs::read_to_string(data.join("brdf/mitsuba_golden.json")).unwrap();
    let golden: Value = serde_json::from_str(&golden).unwrap();
    for name in ["cc_ibiza_sunset_rgb", "paper_white_rgb", "vch_golden_yellow_rgb"] {
        let file = data.join(format!("brdf/{name}.bsdf"));
        let brdf = opened(&file, &["clamp=false"]);
        let golden = &golden["materials"][format!("{name}.bsdf")];
        let rows: Vec<Vec<f64>> = serde_json::from_value(golden["table"].clone()).unwrap();
        for mut device in devices() {
            agree_with_golden(device.as_mut(), &brdf, &rows);
        }
        let albedos: Vec<Vec<f64>> = serde_json::from_value(golden["albedo"].clone()).unwrap();
        let angles = albedos.iter().map(|row| row[0].to_string()).collect::<Vec<_>>().join(",");
        let folder = folder();
        let file = file.to_str().unwrap();
        let arguments = [
            "eval",
            file,
            "--set",
            "clamp=false",
            "--albedo",
            "--angles",
            &angles,
            "--device",
            "cpu",
        ];
        let csv = text(&run(folder.path(), &arguments).stdout);
        for (line, golden) in csv.lines().skip(1).zip(&albedos) {
            let found: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
            for c in 1..4 {
                let error = 4.0 * golden[c + 3].hypot(found[c + 3]);
                assert!((found[c] - golden[c]).abs() <= error, "{name}: {line}, {golden:?}");
            }
        }
        assert_eq!(csv.lines().count(), albedos.len() + 1);
    }
}

fn agree_with_golden(device: &mut dyn Executor, brdf: &Configured, rows: &[Vec<f64>]) {
    let directions = |row: &[f64], aside: f64| {
        let [theta_i, phi_i, theta_o, phi_o] = [0, 1, 2, 3].map(|i| row[i].to_radians());
        // The program's `i` is the given direction, as our wo is.
        pair(at(theta_i, phi_i), at(theta_o, phi_o + aside))
    };
    // The data has a seam where the half vector lies opposite to the given direction. There the other program's
    // rounding takes either side, so either side's value will do.
    let sides = [0.0, -1e-6, 1e-6].map(|aside| {
        let pairs: Vec<Pair> = rows.iter().map(|row| directions(row, aside)).collect();
        values(device, brdf, &pairs)
    });
    let peak = rows.iter().flat_map(|row| row[4..7].to_vec()).fold(0.0, f64::max);
    let mut judged = 0;
    for (i, row) in rows.iter().enumerate() {
        let cosine = row[2].to_radians().cos();
        let opposite = ((row[1] - row[3]).rem_euclid(360.0) - 180.0).abs() < 1e-9;
        // The half vector is the normal and has no azimuth: data that depends on it has no value there, and the
        // other program's density is 0.
        if row[0] == row[2] && (row[0] == 0.0 || opposite) {
            continue;
        }
        let on_seam = row[0] == 0.0 || opposite;
        let tried = if on_seam { &sides[..] } else { &sides[..1] };
        let off = |side: &Vec<Scattered>| {
            let of_f = (0..3).filter(|c| row[4 + c] > 1e-3 * peak);
            let of_f = of_f.map(|c| (side[i].f[c] * cosine / row[4 + c] - 1.0).abs());
            let bright = (0..3).any(|c| row[4 + c] > 1e-3 * peak);
            let of_pdf = bright.then(|| (side[i].pdf / row[7] - 1.0).abs());
            of_f.chain(of_pdf).fold(0.0, f64::max)
        };
        let best = tried.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(best <= 1e-4, "{}: {row:?} is off by {best:.1e}", device.name());
        judged += (0..3).filter(|c| row[4 + c] > 1e-3 * peak).count();
    }
    assert!(judged > 300, "{judged} values were looked at");
}

/// A tensor file without warps (their densities are even, so s = u) whose colours are linear in the indices of
/// viewer and place: its values are linear in the angles, which is worked out here by hand.
fn linear_file(phi: &[f32], spectral: bool) -> Vec<u8> {
    let theta = [0.0f32, 0.5, 1.0, 1.5];
    let bands = if spectral { 5 } else { 3 };
    let (p, t) = (phi.len() as u64, theta.len() as u64);
    let even = |count: u64| vec![1.0f32; count as usize];
    let mut colours = Vec::new();
    for i in 0..p {
        for j in 0..t {
            for band in 0..bands {
                for y in 0..5u32 {
                    for x in 0..3u32 {
                        let place = 0.125 * y as f32 + 0.25 * x as f32;
                        let colour = if spectral { 1.0 } else { 1.0 + band as f32 };
                        colours.push(colour * (1.0 + 0.5 * i as f32 + 0.25 * j as f32 + place));
                    }
                }
            }
        }
    }
    let wavelengths: Vec<f32> = (0..bands).map(|band| 400.0 + 75.0 * band as f32).collect();
    let mut fields = vec![
        ("theta_i", vec![t], theta.to_vec()),
        ("phi_i", vec![p], phi.to_vec()),
        ("sigma", vec![2, 2], even(4)),
        ("ndf", vec![2, 2], even(4)),
        ("vndf", vec![p, t, 2, 2], even(p * t * 4)),
        ("luminance", vec![p, t, 5, 3], even(p * t * 15)),
        (if spectral { "spectra" } else { "rgb" }, vec![p, t, bands as u64, 5, 3], colours),
    ];
    if spectral {
        fields.push(("wavelengths", vec![bands as u64], wavelengths));
    }
    let mut header = b"tensor_file\0\x01\0".to_vec();
    header.extend((fields.len() as u32).to_le_bytes());
    let size: usize =
        fields.iter().map(|(name, shape, _)| 2 + name.len() + 11 + 8 * shape.len()).sum();
    let mut begin = header.len() + size;
    for (name, shape, values) in &fields {
        header.extend((name.len() as u16).to_le_bytes());
        header.extend(name.as_bytes());
        header.extend((shape.len() as u16).to_le_bytes());
        header.push(10);
        header.extend((begin as u64).to_le_bytes());
        shape.iter().for_each(|n| header.extend(n.to_le_bytes()));
        begin += 4 * values.len();
    }
    let values =
        fields.iter().flat_map(|(_, _, values)| values.iter().flat_map(|v| v.to_le_bytes()));
    header.into_iter().chain(values).collect()
}

/// Files of a whole, a half and a quarter turn, and spectra: f cos is what the indices say.
#[test]
fn rgl_files_of_parts_of_the_turn_are_folded() {
    let folder = folder();
    let pi = std::f32::consts::PI;
    let turns: [(&[f32], bool); 5] = [
        (&[0.0], false),
        (&[0.0], true),
        (&[-pi, -0.5 * pi, 0.0, 0.5 * pi, pi], false),
        (&[-pi, -0.5 * pi, 0.0], false),
        (&[-pi, -0.75 * pi, -0.5 * pi], false),
    ];
    for (phi, spectral) in turns {
        let file = folder.path().join("linear.bsdf");
        fs::write(&file, linear_file(phi, spectral)).unwrap();
        let brdf = opened(&file, &[]);
        let mut pairs = Vec::new();
        let mut expected = Vec::new();
        for (theta_o, phi_o) in
            [(0.2, 0.3), (0.7, 1.2), (1.1, 2.0), (1.4, -0.4), (0.9, -2.8), (0.3, -1.7)]
        {
            for (theta_i, phi_i) in [(0.4, 0.1), (1.2, 2.5), (0.8, -1.0)] {
                let (wo, wi) = (at(theta_o, phi_o), at(theta_i, phi_i));
                pairs.push(pair(wo, wi));
                // What the file has a part of the turn for: a half turn about the normal, or mirrors in both axes.
                let fold = |w: [f64; 3]| match phi.len() {
                    3 if phi[2] == 0.0 && wo[1] > 0.0 => [-w[0], -w[1], w[2]],
                    3 if phi[2] < 0.0 => {
                        let [x, y] =
                            [wo[0] > 0.0, wo[1] > 0.0].map(|above| if above { -1.0 } else { 1.0 });
                        [x * w[0], y * w[1], w[2]]
                    }
                    _ => w,
                };
                let (wo, wi) = (fold(wo), fold(wi));
                let m = [0, 1, 2].map(|i| wo[i] + wi[i]);
                let theta_m = m[0].hypot(m[1]).atan2(m[2]);
                let azimuth = |w: [f64; 3]| w[1].atan2(w[0]);
                let isotropic = phi.len() == 1;
                let phi_m = if isotropic { azimuth(m) - azimuth(wo) } else { azimuth(m) };
                let u = [(theta_m / FRAC_PI_2).sqrt(), (phi_m / TAU + 0.5).rem_euclid(1.0)];
                let step = |first: f64, step: f64, value: f64| (value - first) / step;
                let around = if isotropic {
                    0.0
                } else {
                    step(f64::from(phi[0]), f64::from(phi[1] - phi[0]), azimuth(wo))
                };
                let down = step(0.0, 0.5, wo[0].hypot(wo[1]).atan2(wo[2]));
                let value =
                    1.0 + 0.5 * around + 0.25 * down + 0.125 * 4.0 * u[1] + 0.25 * 2.0 * u[0];
                expected.push(value / wi[2]);
            }
        }
        for mut device in devices() {
            for (found, expected) in values(device.as_mut(), &brdf, &pairs).iter().zip(&expected) {
                for c in 0..3 {
                    let colour = if spectral { 1.0 } else { 1.0 + c as f64 };
                    let off = found.f[c] / (colour * expected) - 1.0;
                    assert!(off.abs() < 2e-5, "{phi:?}: {found:?} instead of {expected}");
                }
            }
        }
    }
}

/// GGX as a MERL file, read again: values within what the bins take, and a picture that is GGX's to 1 %.
#[test]
fn ggx_comes_back_from_a_merl_file() {
    let folder = folder();
    let set = ["alpha_x=0.3", "alpha_y=0.3"];
    let output = run(
        folder.path(),
        &[
            "export-merl",
            "ggx",
            "--set",
            set[0],
            "--set",
            set[1],
            "-o",
            "g.binary",
            "--device",
            "cpu",
        ],
    );
    let report = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(fs::metadata(folder.path().join("g.binary")).unwrap().len(), 34_992_012);
    // The figures of the report: the median and the 95th percentile of trilinear and nearest.
    let figures: Vec<f64> = report
        .split("less than ")
        .skip(1)
        .map(|rest| rest.split(' ').next().unwrap().parse().unwrap())
        .collect();
    let [median, most, nearest_median, nearest_most] = figures[..] else { panic!("{report}") };
    // Nine bits alone take up to 0.2 %, and half of all values 0.07 %.
    assert!(median < 0.15 && most < 0.6, "{report}");
    assert!(nearest_median > median && nearest_most > most && nearest_most < 6.0, "{report}");

    let merl = opened(&folder.path().join("g.binary"), &[]);
    let ggx = brdf("ggx", &set);
    let soft = map(32, 16, |x, y| [1.0 + (x % 4) as f32, 1.0 + (y % 3) as f32, 2.0]);
    let furnace = Arc::new(Environment::constant(1.0));
    for (light, allowed) in [(furnace, 0.01), (soft, 0.01)] {
        // The same points and numbers: what is apart is the table's doing.
        let shot = Shot::new(sphere(48), light, 64, 4);
        let mut cpu = Cpu::new(Precision::F32);
        let uniform = integrator("cosine", &[]);
        let one = shot.take(&mut cpu, &ggx, &uniform).unwrap();
        let other = shot.take(&mut cpu, &merl, &uniform).unwrap();
        let (mut apart, mut whole) = (0.0, 0.0);
        for (a, b) in one.means().zip(other.means()) {
            for c in 0..3 {
                apart += (a[c] - b[c]).abs();
                whole += a[c];
            }
        }
        assert!(apart / whole < allowed, "the pictures differ by {:.4}", apart / whole);
    }
}

/// A file is opened by what it begins with; what only has the ending is refused in one line.
#[test]
fn files_are_told_by_their_content() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("other.bsdf", b"{\"type\": \"principled\"}");
    write("cut.bsdf", b"tensor_file\0\x01\0\x07\0\0\0");
    write("odd.binary", &[1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
    write("short.binary", &[0x5a, 0, 0, 0, 0x5a, 0, 0, 0, 0xb4, 0, 0, 0, 1, 2, 3]);
    write("huge.dat", &[0x7f; 64]);
    write("notes.xyz", b"hello");
    write("scene.toml", b"format = 1");
    write("mesh.OBJ", b"v 0 0 0");
    write("empty.bsdf", b"");
    for (name, expected) in [
        ("other.bsdf", "its first bytes are not those of a file for RGL"),
        ("cut.bsdf", "its table of fields ends early; the file is damaged"),
        ("odd.binary", "its first bytes are not those of a file for MERL"),
        ("short.binary", "it has 15 bytes and its header asks for 34992012; it was cut off"),
        ("huge.dat", "its header asks for 2139062143 bins of an angle; it is no file of MIT's"),
        (
            "notes.xyz",
            "no plugin opens such a file; name a plugin, a plugin folder, or a file that ends in .brdf",
        ),
        ("scene.toml", "no plugin opens such a file; give a scene to --session"),
        ("mesh.OBJ", "no plugin opens such a file; give a mesh to --shape"),
        ("absent.binary", "absent.binary: there is no such file; name one that is there"),
        ("empty.bsdf", "the file is empty; name one with data"),
    ] {
        let line = refused(
            folder.path(),
            &["render", &format!("./{name}"), "--resolution", "8", "--device", "cpu"],
        );
        assert!(line.contains(expected), "{line}");
    }
    // A picture of this program is no image slice.
    let small = common::program::small(&["lambert", "--ibl", "furnace", "--device", "cpu"]);
    assert!(run(folder.path(), &small).status.success());
    let line = refused(folder.path(), &["render", "lambert.exr", "--device", "cpu"]);
    assert!(line.contains("this is a picture with its scene"), "{line}");
    // Pictures of files are named after them; a scene finds its file beside itself.
    fs::write(folder.path().join("leaf.txt"), "2 1\n0.5 0.25\n").unwrap();
    let small = common::program::small(&["leaf.txt", "--ibl", "furnace", "--device", "cpu"]);
    assert!(run(folder.path(), &small).status.success());
    fs::create_dir(folder.path().join("away")).unwrap();
    fs::copy(folder.path().join("leaf.txt"), folder.path().join("away/leaf.txt")).unwrap();
    let scene = "[brdf]\nplugin = \"image-slice\"\nparams = { file = \"leaf.txt\" }\n[environment]\nmap = \"furnace\"\n";
    fs::write(folder.path().join("away/scene.toml"), scene).unwrap();
    fs::remove_file(folder.path().join("leaf.txt")).unwrap();
    let output = run(
        folder.path(),
        &[
            "render",
            "--session",
            "away/scene.toml",
            "--resolution",
            "24",
            "--samples",
            "4",
            "--passes",
            "2",
            "--device",
            "cpu",
            "--export",
            "b",
        ],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let picture = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(picture("leaf.png") == picture("b.png"));
    // Nor is what is read ever written over.
    let picture = fs::read(folder.path().join("lambert.exr")).unwrap();
    fs::write(folder.path().join("map.exr"), &picture).unwrap();
    let line = refused(
        folder.path(),
        &["render", "--ibl", "map.exr", "--export", "map", "--device", "cpu"],
    );
    assert!(line.contains("would replace the environment map"), "{line}");
    let set = ["image-slice", "--set", "file=map.exr", "--device", "cpu"];
    let line = refused(folder.path(), &[&["render"][..], &set].concat());
    assert!(line.contains("map: the new picture would replace the data file"), "{line}");
    assert!(fs::read(folder.path().join("map.exr")).unwrap() == picture);
}
