//! What there is to know about a map before it is rendered with.

use rayon::prelude::*;
use serde::Serialize;

use super::{Environment, Layout};
use crate::tone::luminance;

/// The largest value of a 16-bit float.
const F16_MAX: f32 = 65_504.0;

/// Facts about a map; luminances in the map's own units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// How its texels lie: `lat-long` or `cube`.
    pub layout: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The side of a cube's faces.
    pub face: Option<u32>,
    /// The smallest luminance of a texel.
    pub min: f64,
    /// The mean luminance over the sphere, by solid angle.
    pub mean: f64,
    /// The largest luminance of a texel.
    pub max: f64,
    /// Mean radiance over the sphere by solid angle, per channel.
    pub mean_radiance: [f64; 3],
    /// The share of the energy (luminance times solid angle) in the 1, 10, 100 and 1000 texels that have most of it.
    pub brightest: [f64; 4],
    /// Texels with a channel above 65504, the range of 16-bit floats.
    pub above_f16: usize,
    /// Texels without radiance.
    pub black: usize,
    /// From the first access to the file until the map was ready [s].
    pub seconds: f64,
}

impl Environment {
    /// Reads the facts off the texels.
    pub fn facts(&self) -> Facts {
        let columns = self.width as usize;
        let value = |texel: &[f32; 4]| luminance([texel[0], texel[1], texel[2]].map(f64::from));
        let range = |texels: &[[f32; 4]]| {
            texels.iter().map(value).fold((f64::INFINITY, 0.0), |range: (f64, f64), value| {
                (range.0.min(value), range.1.max(value))
            })
        };
        let (min, max) = self
            .texels
            .par_chunks(columns)
            .map(range)
            .reduce(|| (f64::INFINITY, 0.0), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let mut energies: Vec<f64> = self
            .texels
            .par_chunks(columns)
            .enumerate()
            .flat_map_iter(|(row, texels)| {
                let angles = self.solid_angles(row as u32);
                texels.iter().zip(angles).map(move |(texel, angle)| value(texel) * angle)
            })
            .collect();
        let energy = self.energy();
        let whole = luminance(energy);
        let count = energies.len().min(1000);
        let falling = |a: &f64, b: &f64| b.total_cmp(a);
        if count < energies.len() {
            energies.select_nth_unstable_by(count, falling);
        }
        energies.truncate(count);
        energies.sort_unstable_by(falling);
        let share = |count: usize| match whole > 0.0 {
            true => energies.iter().take(count).sum::<f64>() / whole,
            false => 0.0,
        };
        let above = |texel: &&[f32; 4]| texel[..3].iter().any(|value| *value > F16_MAX);
        let black = |texel: &&[f32; 4]| texel[..3].iter().all(|value| *value == 0.0);
        let sphere = 4.0 * std::f64::consts::PI;
        Facts {
            layout: crate::layout::word(&self.layout),
            width: self.width,
            height: self.height,
            face: (self.layout == Layout::Cube).then_some(self.width),
            min,
            mean: whole / sphere,
            max,
            mean_radiance: energy.map(|sum| sum / sphere),
            brightest: [1, 10, 100, 1000].map(share),
            above_f16: self.texels.par_iter().filter(above).count(),
            black: self.texels.par_iter().filter(black).count(),
            seconds: self.seconds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::orientation;

    /// A 4x2 map: all texels see pi/2; luminance 1 but for one of 9, one of 70000 in green and one black.
    #[test]
    fn facts_are_read_off_the_texels() {
        assert!(
            (orientation::texel_solid_angle(0, 4, 2) - std::f64::consts::FRAC_PI_2).abs() < 1e-15
        );
        let mut map = Environment::constant(1.0);
        let mut texels = vec![[1.0, 1.0, 1.0, 0.0]; 8];
        texels[1] = [9.0, 9.0, 9.0, 0.0];
        texels[2] = [0.0, 70_000.0, 0.0, 0.0];
        texels[7] = [0.0; 4];
        (map.width, map.height, map.texels) = (4, 2, std::sync::Arc::new(texels));
        let facts = map.facts();
        let green = 0.7152 * 70_000.0;
        let near =
            |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} is not {b}");
        near(facts.min, 0.0);
        near(facts.max, green);
        near(facts.mean, (green + 9.0 + 5.0) / 8.0);
        near(facts.mean_radiance[0], 14.0 / 8.0);
        near(facts.brightest[0], green / (green + 14.0));
        near(facts.brightest[3], 1.0);
        assert_eq!((facts.above_f16, facts.black, facts.face), (1, 1, None));
        assert_eq!((facts.layout.as_str(), facts.width), ("lat-long", 4));
        // Nothing at all: no shares, no NaN.
        let black = Environment::constant(0.0).facts();
        assert_eq!((black.brightest, black.mean, black.black), ([0.0; 4], 0.0, 2));
    }
}
