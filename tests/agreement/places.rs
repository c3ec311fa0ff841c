//! Where a picture is compared: as a whole and in tiles, by the spread of its replicates.

use std::sync::LazyLock;

use brdf_host::scene::ShadingPoint;

use crate::maps::size_from;

/// Pixels along a side of the picture; it has three by three tiles.
pub static RESOLUTION: LazyLock<u32> =
    LazyLock::new(|| size_from("BRDF_AGREEMENT_RESOLUTION", 12) as u32);
const TILES: u32 = 3;

/// A set of pixels whose mean is compared.
pub struct Place {
    pub name: String,
    pub rows: Vec<usize>,
}

/// The whole picture first, then its tiles.
pub fn places(points: &[ShadingPoint]) -> Vec<Place> {
    let whole = Place { name: "the picture".to_owned(), rows: (0..points.len()).collect() };
    let tile_of = |row: &usize| {
        let pixel = points[*row].pixel;
        (pixel % *RESOLUTION * TILES / *RESOLUTION, pixel / *RESOLUTION * TILES / *RESOLUTION)
    };
    let tiles = (0..TILES * TILES).map(|i| (i % TILES, i / TILES)).map(|tile| Place {
        name: format!("tile {},{}", tile.0, tile.1),
        rows: (0..points.len()).filter(|row| tile_of(row) == tile).collect(),
    });
    std::iter::once(whole).chain(tiles.filter(|tile| !tile.rows.is_empty())).collect()
}

/// Every pixel by itself.
pub fn pixels(count: usize) -> Vec<Place> {
    (0..count).map(|row| Place { name: format!("point {row}"), rows: vec![row] }).collect()
}

/// What the replicates say of one channel of one place.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spread {
    pub mean: f64,
    pub std_error: f64,
    /// The share of the variance that comes from one replicate alone, the largest.
    pub share: f64,
}

impl Spread {
    /// From a place's mean in each replicate; a sum over texels has one, and no spread.
    pub fn of(means: &[f64]) -> Self {
        if let [mean] = means {
            return Self { mean: *mean, std_error: 0.0, share: 0.0 };
        }
        let count = means.len() as f64;
        let mean = means.iter().sum::<f64>() / count;
        let squares = || means.iter().map(|m| (m - mean).powi(2));
        let sum: f64 = squares().sum();
        let share = if sum > 0.0 { squares().fold(0.0, f64::max) / sum } else { 0.0 };
        Self { mean, std_error: (sum / (count - 1.0) / count).sqrt(), share }
    }

    /// The standard error as a share of the mean.
    pub fn relative(&self) -> f64 {
        if self.std_error == 0.0 { 0.0 } else { self.std_error / self.mean.abs() }
    }

    /// Why this says nothing, if so: one replicate in 32 holds half of a normal spread's variance
    /// with a probability of 1e-4.
    pub fn doubt(&self) -> Option<String> {
        if self.share >= 0.5 {
            return Some(format!(
                "one replicate holds {:.0} % of the variance",
                100.0 * self.share
            ));
        }
        let relative = self.relative();
        (relative >= 0.01)
            .then(|| format!("the standard error is {:.1} % of the mean", 100.0 * relative))
    }
}

#[test]
fn the_spread_is_that_of_its_replicates() {
    // Deviations -1, 1, 0, 0: variance 2/3, of the mean 1/6; half of it from each of two replicates.
    let spread = Spread::of(&[1.0, 3.0, 2.0, 2.0]);
    assert!((spread.std_error - (1.0f64 / 6.0).sqrt()).abs() < 1e-15 && spread.mean == 2.0);
    assert!(spread.share == 0.5 && spread.doubt().is_some());
    // Deviations -1, 1, -1, 1: variance 4/3, of the mean 1/3.
    let spread = Spread::of(&[99.0, 101.0, 99.0, 101.0]);
    assert!((spread.relative() - (1.0f64 / 3.0).sqrt() / 100.0).abs() < 1e-15);
    assert!(spread.share == 0.25 && spread.doubt().is_none());
    let wide = Spread { std_error: 1.0, ..spread };
    assert!(wide.doubt().is_some());
    assert!(Spread::of(&[0.0; 4]).doubt().is_none());
}
