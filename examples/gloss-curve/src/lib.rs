//! The library of the plugin beside it: a curve in a text file becomes an array, and tables to sample by.

use std::f64::consts::FRAC_PI_2;

use brdf_sdk::native::directions::HalfDifference;
use brdf_sdk::native::lobes::{self, Grid};
use brdf_sdk::native::{Array, Loaded, Native, Request};

/// Entries of the array, at equal steps of sqrt(theta_h) from 0 to 90 degrees.
const ENTRIES: usize = 256;

struct GlossCurve;

impl Native for GlossCurve {
    fn load(request: &Request) -> Result<Loaded, String> {
        let text = std::fs::read_to_string(request.text("curve")?)
            .map_err(|error| format!("the curve cannot be read ({error}); name a text file"))?;
        let curve = Curve::parse(&text)?;
        // The WGSL draws by these tables; where the base outshines the gloss, the cosine in them serves it.
        let grid = Grid { theta_o: 32, phi_o: 1, theta_h: 32, phi_h: 16 };
        let tables = lobes::tables(grid, |wo, wi| curve.at(HalfDifference::of(wo, wi).theta_h));
        let entry = |i: usize| {
            let root = i as f64 / (ENTRIES - 1) as f64;
            curve.at(root * root * FRAC_PI_2) as f32
        };
        let gloss = Array::f32("gloss", [ENTRIES as u64], (0..ENTRIES).map(entry).collect());
        Ok(Loaded::new(tables.into_iter().chain([gloss])))
    }
}

/// Values of f over theta_h, linear between points.
struct Curve {
    /// Angle [degrees] and value [1/sr], by ascending angle.
    points: Vec<[f64; 2]>,
}

impl Curve {
    /// A line for each point, `degrees value`; what stands behind `#` is a comment.
    fn parse(text: &str) -> Result<Self, String> {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let numbers: Vec<&str> =
                line.split('#').next().unwrap_or_default().split_whitespace().collect();
            if numbers.is_empty() {
                continue;
            }
            let point = match numbers[..] {
                [angle, value] => angle.parse().ok().zip(value.parse().ok()),
                _ => None,
            };
            match point {
                Some((angle, value)) if (0.0..=90.0).contains(&angle) && value >= 0.0 && value < 1e6 => {
                    points.push([angle, value]);
                }
                _ => {
                    return Err(format!(
                        "line {}: `{}` is no point of the curve; write an angle from 0 to 90 and a value",
                        number + 1,
                        line.trim()
                    ));
                }
            }
        }
        if points.is_empty() {
            return Err("the curve has no points; write some, such as `0 2.5` and `20 0`".to_owned());
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(Self { points })
    }

    /// f [1/sr] at an angle [radians].
    fn at(&self, theta_h: f64) -> f64 {
        let angle = theta_h.to_degrees();
        let next = self.points.partition_point(|[known, _]| *known < angle);
        let point = |index: usize| self.points.get(index).copied();
        match (next.checked_sub(1).and_then(point), point(next)) {
            (Some([a, from]), Some([b, to])) => from + (to - from) * (angle - a) / (b - a),
            (Some([_, value]), None) | (None, Some([_, value])) => value,
            (None, None) => 0.0,
        }
    }
}

brdf_sdk::export_plugin!(GlossCurve, concat!("gloss-curve ", env!("CARGO_PKG_VERSION")));
