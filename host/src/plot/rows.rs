//! A plot's numbers as CSV, a row each.

use std::fmt::Write as _;

use super::shown::{Plot, Series};

/// The file.
pub fn rows(plot: &Plot) -> String {
    let mut text = String::new();
    let mut line = |fields: &[String]| {
        let _ = writeln!(text, "{}", fields.join(","));
    };
    let words = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    match plot {
        Plot::Polar(series) | Plot::Lines(series, ..) => {
            line(&words(&["brdf", "angle", "value"]));
            for Series { name, points, .. } in series {
                for point in points.iter().filter(|point| point[1].is_finite()) {
                    line(&[quoted(name), point[0].to_string(), short(point[1])]);
                }
            }
        }
        Plot::Albedo(series) => {
            line(&words(&["brdf", "angle", "albedo", "standard_error"]));
            for Series { name, points, errors, .. } in series {
                for ([angle, albedo], error) in points.iter().zip(errors) {
                    line(&[quoted(name), angle.to_string(), short(*albedo), short(*error)]);
                }
            }
        }
        Plot::Slices(slice, all) => {
            line(&words(&["brdf", "theta_h", "theta_d", "f_r", "f_g", "f_b"]));
            for (name, values) in all {
                for (index, f) in values.iter().enumerate().filter(|(_, f)| !f[0].is_nan()) {
                    let [theta_h, theta_d] = slice.angles(index % slice.size, index / slice.size);
                    let mut fields = vec![quoted(name), theta_h.to_string(), theta_d.to_string()];
                    fields.extend(f.map(short));
                    line(&fields);
                }
            }
        }
        Plot::Lobes(all) => {
            line(&words(&["brdf", "wo_x", "wo_y", "wo_z", "value"]));
            for (name, lobe) in all {
                for (direction, value) in std::iter::zip(&lobe.directions, &lobe.values) {
                    let mut fields = vec![quoted(name)];
                    fields.extend(direction.map(|c| format!("{c:.7}")));
                    fields.push(short(*value));
                    line(&fields);
                }
            }
        }
    }
    text
}

/// The digits that an f32 has.
fn short(value: f64) -> String {
    (value as f32).to_string()
}

/// A name as a field (RFC 4180).
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}
