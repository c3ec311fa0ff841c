//! Texels that are no radiance: NaN, infinite or negative. Counted always, replaced only on request.

use rayon::prelude::*;

use brdf_sdk::{Problem, Result};

/// How many texels of each kind a map had. A texel counts once in each kind that it shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BadTexels {
    /// Texels with a NaN in some channel.
    pub nan: usize,
    /// Texels with an infinity of either sign in some channel.
    pub infinite: usize,
    /// Texels with a negative, finite value in some channel.
    pub negative: usize,
}

impl BadTexels {
    /// Whether every texel is a radiance.
    pub fn is_clean(&self) -> bool {
        *self == Self::default()
    }

    fn add(self, other: Self) -> Self {
        Self {
            nan: self.nan + other.nan,
            infinite: self.infinite + other.infinite,
            negative: self.negative + other.negative,
        }
    }
}

impl std::fmt::Display for BadTexels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} NaN, {} infinite and {} negative", self.nan, self.infinite, self.negative)
    }
}

/// Counts the texels that are no radiance; a problem unless there are none or `replace` is set.
///
/// Replacing works channel by channel: NaN, negative values and -infinity become 0, +infinity
/// becomes the largest finite value of the whole map.
pub fn settle(name: &str, texels: &mut [[f32; 4]], replace: bool) -> Result<BadTexels> {
    let (found, largest) = survey(texels);
    if !found.is_clean() && !replace {
        return Err(Problem::new(
            name,
            format!("the map has {found} texels"),
            "mend the file, or replace them with --replace-bad-texels",
        ));
    }
    if !found.is_clean() {
        texels.par_iter_mut().with_min_len(1 << 14).for_each(|texel| {
            for value in &mut texel[..3] {
                // `max` also turns a NaN into 0.
                *value = value.max(0.0).min(largest);
            }
        });
    }
    Ok(found)
}

/// The counts, and the largest finite value (0 if there is none).
fn survey(texels: &[[f32; 4]]) -> (BadTexels, f32) {
    let one = |texel: &[f32; 4]| {
        let rgb = &texel[..3];
        let bad = BadTexels {
            nan: usize::from(rgb.iter().any(|value| value.is_nan())),
            infinite: usize::from(rgb.iter().any(|value| value.is_infinite())),
            negative: usize::from(rgb.iter().any(|value| value.is_finite() && *value < 0.0)),
        };
        (bad, rgb.iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max))
    };
    texels
        .par_chunks(1 << 14)
        .map(|chunk| chunk.iter().map(one).fold(Default::default(), merge))
        .reduce(Default::default, merge)
}

fn merge(a: (BadTexels, f32), b: (BadTexels, f32)) -> (BadTexels, f32) {
    (a.0.add(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bad_map() -> Vec<[f32; 4]> {
        vec![
            [f32::NAN, -1.0, 3.0, 0.0],
            [f32::INFINITY, 0.5, 7.0, 0.0],
            [f32::NEG_INFINITY, 0.0, -0.0, 0.0],
            [-2.0, -2.0, 1.0, 0.0],
        ]
    }

    #[test]
    fn bad_texels_are_a_problem_with_counts_and_cure() {
        let problem = settle("map.exr", &mut bad_map(), false).unwrap_err().to_string();
        assert_eq!(
            problem,
            "map.exr: the map has 1 NaN, 2 infinite and 2 negative texels; \
             mend the file, or replace them with --replace-bad-texels"
        );
    }

    #[test]
    fn replacing_works_by_channel() {
        let mut texels = bad_map();
        let found = settle("map.exr", &mut texels, true).unwrap();
        assert_eq!(found, BadTexels { nan: 1, infinite: 2, negative: 2 });
        assert_eq!(
            texels,
            [[0.0, 0.0, 3.0, 0.0], [7.0, 0.5, 7.0, 0.0], [0.0; 4], [0.0, 0.0, 1.0, 0.0]]
        );
    }

    #[test]
    fn a_clean_map_is_left_alone() {
        let mut texels = vec![[0.0, 1e30, f32::MIN_POSITIVE / 4.0, 0.0]; 3];
        let before = texels.clone();
        assert!(settle("map.exr", &mut texels, true).unwrap().is_clean());
        assert_eq!(texels, before);
    }
}
