//! Recipes against closed forms, and their rejections with the whole message.

use std::f64::consts::PI;

use super::super::orientation::{direction_of, texel_solid_angle, uv_of};
use super::*;

fn recipe(body: &str) -> String {
    format!("kind = \"recipe\"\nformat = 1\nabout = \"A test.\"\n{body}")
}

fn map(body: &str, width: u32) -> Picture {
    evaluate("r.toml", &recipe(body), Some(width)).unwrap()
}

/// The integral of the first channel over all directions.
fn energy(picture: &Picture) -> f64 {
    let rows = picture.texels.chunks(picture.width as usize).enumerate();
    rows.map(|(y, row)| {
        let solid_angle = texel_solid_angle(y as u32, picture.width, picture.height);
        row.iter().map(|texel| f64::from(texel[0])).sum::<f64>() * solid_angle
    })
    .sum()
}

fn assert_energy(body: &str, widths: &[u32], expected: f64, tolerance: f64) {
    for &width in widths {
        let got = energy(&map(body, width));
        assert!((got / expected - 1.0).abs() < tolerance, "{width}: {got}, not {expected}\n{body}");
    }
}

const WIDTHS: [u32; 5] = [64, 66, 256, 1000, 2048];

#[test]
fn a_sun_has_its_energy_at_every_resolution() {
    // A cap of half angle a subtends 2 pi (1 - cos a) = 4 pi sin^2(a / 2).
    for (polar, azimuth, diameter) in [
        (50.0, -48.0, 0.5_f64),
        (0.3, 10.0, 0.5),
        (180.0, 0.0, 0.5),
        (90.0, 180.0, 0.5),
        (70.0, 33.0, 0.05),
        (60.0, 0.0, 40.0),
        (90.0, 90.0, 180.0),
    ] {
        let body = format!(
            "[[disk]]\npolar = {polar}\nazimuth = {azimuth}\ndiameter = {diameter}\nradiance = [1e5, 0, 0]\n"
        );
        let solid_angle = 4.0 * PI * (diameter.to_radians() / 4.0).sin().powi(2);
        assert_energy(&body, &WIDTHS, 1e5 * solid_angle, 0.01);
    }
}

#[test]
fn a_sun_has_its_energy_at_the_finest_resolution() {
    let body = "[[disk]]\npolar = 50.0\nazimuth = -48.0\ndiameter = 0.5\nradiance = [1e5, 0, 0]\n";
    let solid_angle = 4.0 * PI * (0.5_f64.to_radians() / 4.0).sin().powi(2);
    assert_energy(body, &[8192], 1e5 * solid_angle, 0.01);
}

#[test]
fn a_softbox_has_the_solid_angle_of_its_rectangle() {
    // A rectangle at distance 1, half sides a and b: 4 atan(a b / sqrt(1 + a^2 + b^2)).
    for (polar, azimuth, width, height) in [
        (52.0, -48.0, 46.0_f64, 46.0_f64),
        (3.0, 20.0, 70.0, 44.0),
        (90.0, 179.0, 9.0, 60.0),
        (120.0, 90.0, 0.4, 0.2),
        (90.0, 0.0, 150.0, 120.0),
    ] {
        let body = format!(
            "[[softbox]]\npolar = {polar}\nazimuth = {azimuth}\nwidth = {width}\nheight = {height}\nradiance = [2, 0, 0]\n"
        );
        let (a, b) = ((width.to_radians() / 2.0).tan(), (height.to_radians() / 2.0).tan());
        let solid_angle = 4.0 * (a * b / (1.0 + a * a + b * b).sqrt()).atan();
        assert_energy(&body, &WIDTHS, 2.0 * solid_angle, 0.01);
    }
}

#[test]
fn a_soft_disk_has_the_integral_of_its_profile() {
    // Fully soft, radius R: 2 pi times the integral of smoothstep(1 - a/R) sin a, by midpoints.
    let radius = 20.0_f64.to_radians();
    let steps = 100_000;
    let integral: f64 = (0..steps)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let s = 1.0 - t;
            s * s * (3.0 - 2.0 * s) * (t * radius).sin() * radius / f64::from(steps)
        })
        .sum();
    let body = "[[disk]]\npolar = 60.0\nazimuth = 70.0\ndiameter = 40.0\nedge = 1.0\nradiance = [1, 0, 0]\n";
    assert_energy(body, &WIDTHS, 2.0 * PI * integral, 0.005);
}

#[test]
fn the_background_has_its_closed_form() {
    // The mean of s^p over a hemisphere's sines is 1 / (p + 1), so each half is 2 pi (h + (e - h) / (p + 1)).
    let body = "[background]\nzenith = [3, 0, 0]\nhorizon = [1, 0, 0]\nground = [0.5, 0, 0]\nsky_power = 0.5\nground_power = 0.0\n";
    let expected = 2.0 * PI * (1.0 + 2.0 / 1.5) + 2.0 * PI * 0.5;
    assert_energy(body, &[64, 66, 256, 2048], expected, 0.002);
    let furnace = map("[background]\nconstant = [1, 1, 1]\n", 16);
    assert!(furnace.texels.iter().all(|texel| *texel == [1.0, 1.0, 1.0, 0.0]));
}

#[test]
fn lights_stand_where_their_angles_say() {
    // Azimuth grows from +z towards +x: 90 degrees on the horizon is +x, u = 0.25.
    for (polar, azimuth, dir) in [
        (90.0, 0.0, glam::DVec3::Z),
        (90.0, 90.0, glam::DVec3::X),
        (90.0, -90.0, glam::DVec3::NEG_X),
        (0.0, 12.0, glam::DVec3::Y),
    ] {
        for kind in ["disk]]\ndiameter = 8", "softbox]]\nwidth = 8\nheight = 8"] {
            let body =
                format!("[[{kind}\npolar = {polar}\nazimuth = {azimuth}\nradiance = [1, 2, 3]\n");
            let picture = map(&body, 360);
            let mut sum = glam::DVec3::ZERO;
            for (i, texel) in picture.texels.iter().enumerate() {
                let (x, y) = (i as u32 % 360, i as u32 / 360);
                let at = direction_of((f64::from(x) + 0.5) / 360.0, (f64::from(y) + 0.5) / 180.0);
                sum += at * f64::from(texel[0]) * texel_solid_angle(y, 360, 180);
                assert!((texel[1] - 2.0 * texel[0]).abs() < 1e-5);
            }
            assert!((sum.normalize() - dir).length() < 1e-3, "{body}: {}", sum.normalize());
        }
    }
    // A box wider than high is wider along the horizon.
    let wide = map(
        "[[softbox]]\npolar = 90\nazimuth = 0\nwidth = 60\nheight = 10\nradiance = [1, 1, 1]\n",
        360,
    );
    let lit = |azimuth: f64, polar: f64| {
        let (u, v) = uv_of(glam::DVec3::new(
            polar.to_radians().sin() * azimuth.to_radians().sin(),
            polar.to_radians().cos(),
            polar.to_radians().sin() * azimuth.to_radians().cos(),
        ));
        wide.texels[(v * 180.0) as usize * 360 + (u * 360.0) as usize][0]
    };
    assert_eq!((lit(25.0, 90.0), lit(0.0, 70.0), lit(35.0, 90.0)), (1.0, 0.0, 0.0));
}

#[test]
fn a_texel_is_one_texel_at_every_resolution() {
    let by_index = "width = 8\n[background]\nconstant = [5, 5, 5]\n[[texel]]\nx = 7\ny = 0\nradiance = [1, 2, 3]\n";
    for (width, expected) in [(8, 7), (16, 15 + 16), (2, 1)] {
        let picture = map(by_index, width);
        let found: Vec<usize> = (0..picture.texels.len())
            .filter(|i| picture.texels[*i] == [1.0, 2.0, 3.0, 0.0])
            .collect();
        assert_eq!(found, [expected], "at {width}");
    }
    let by_fraction = "[[texel]]\nu = 0.5\nv = 0.25\nradiance = [9, 9, 9]\n";
    assert_eq!(map(by_fraction, 8).texels[8 + 4], [9.0, 9.0, 9.0, 0.0]);
}

#[test]
fn faults_are_told_with_their_place() {
    let told = |body: &str| evaluate("r.toml", &recipe(body), None).unwrap_err().to_string();
    assert_eq!(
        told("[[disk]]\npolar = 10\nazimuth = 0\ndiametre = 1\nradiance = [1, 1, 1]\n"),
        "r.toml:4:1: the key `diameter` is missing in [disk]; add it: degrees across\n \
         4 | [[disk]]\n   | ^^^^^^^^"
    );
    assert_eq!(
        told("[[disk]]\npolar = 10\nazimuth = 0\ndiameter = 1\nedgy = 1\nradiance = [1, 1, 1]\n"),
        "r.toml:8:1: unknown key `edgy` in [disk]; did you mean `edge`?\n 8 | edgy = 1\n   | ^^^^"
    );
    assert_eq!(
        told("[[softbox]]\npolar = 190\nazimuth = 0\n"),
        "r.toml:5:9: `polar` is 190; write a number from 0 to 180\n 5 | polar = 190\n   |         ^^^"
    );
    assert_eq!(
        told("[background]\nconstant = [1, -1, 1]\n"),
        "r.toml:5:12: this is no radiance; write three numbers from 0 to 1e30\n \
         5 | constant = [1, -1, 1]\n   |            ^^^^^^^^^^"
    );
    assert_eq!(
        told("[background]\nconstant = [1, 1, 1]\nzenith = [1, 1, 1]\n"),
        "r.toml:6:1: unknown key `zenith` in [background]; known are: constant\n 6 | zenith = [1, 1, 1]\n   | ^^^^^^"
    );
    assert_eq!(
        told("width = 63\n"),
        "r.toml:4:9: this width is odd; give an even number from 2 to 32768\n 4 | width = 63\n   |         ^^"
    );
    assert_eq!(
        told("width = 8\n[[texel]]\nx = 8\ny = 0\n"),
        "r.toml:6:5: `x` is 8; write a whole number from 0 to 7\n 6 | x = 8\n   |     ^"
    );
    assert_eq!(
        told("[[texel]]\nu = 1.0\n"),
        "r.toml:5:5: `u` is 1; write a number from 0 to below 1\n 5 | u = 1.0\n   |     ^^^"
    );
    let plugin = evaluate("r.toml", "kind = \"brdf\"\n", None).unwrap_err().to_string();
    assert_eq!(
        plugin,
        "r.toml:1:8: this is no recipe of a map; write `kind = \"recipe\"`\n 1 | kind = \"brdf\"\n   |        ^^^^^^"
    );
    let format =
        evaluate("r.toml", "kind = \"recipe\"\nformat = 2\n", None).unwrap_err().to_string();
    assert_eq!(
        format,
        "r.toml:2:10: this format of recipes is not known; write `format = 1`\n 2 | format = 2\n   |          ^"
    );
    let wide = evaluate("r.toml", &recipe(""), Some(40_000)).unwrap_err().to_string();
    assert_eq!(
        wide,
        "r.toml: a width of 40000 is out of range; give an even number from 2 to 32768"
    );
}
