//! The words for how an environment map lies: on the sphere while it lights, and in the file it comes from.
//!
//! The command line, `scene.toml` and `environment` share them; what they mean for a texel is
//! `environment`'s part.

use clap::ValueEnum;

/// How a map's texels lie on the sphere.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, ValueEnum)]
pub enum Layout {
    /// Rows of equal latitude, row 0 at +y; twice as wide as high.
    #[default]
    LatLong,
    /// Six square faces, one below the other: +x, -x, +y, -y, +z, -z; six times as high as wide.
    Cube,
}

/// How a map lies in a picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, ValueEnum)]
pub enum Arrangement {
    /// A lat-long panorama, 2:1, whose pixels are small areas.
    LatLong,
    /// Six faces as a cross that lies, 4:3: nx pz px nz in a row, py above pz, ny below.
    CrossH,
    /// Six faces as a cross that stands, 3:4: nx pz px in a row, py above pz, below it ny and nz, which stands on
    /// its head.
    CrossV,
    /// Six faces in a row, 6:1: px nx py ny pz nz.
    StripRow,
    /// Six faces in a column, 1:6: px nx py ny pz nz.
    #[value(alias = "cube")]
    StripCol,
    /// OpenEXR's `envmap` LATLONG, 2:1: the first and last pixel centres lie on the limits.
    #[value(name = "openexr-lat-long")]
    OpenExrLatLong,
    /// OpenEXR's `envmap` CUBE, 1:6: OpenEXR's own turn of each face, pixel centres on the edges.
    #[value(name = "openexr-cube")]
    OpenExrCube,
}

impl Arrangement {
    /// How its texels lie on the sphere.
    pub fn layout(self) -> Layout {
        match self {
            Self::LatLong | Self::OpenExrLatLong => Layout::LatLong,
            _ => Layout::Cube,
        }
    }
}

/// How a file is to be read, as it is typed: `auto`, or an arrangement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading(pub Option<Arrangement>);

impl std::str::FromStr for Reading {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self(None)),
            _ => Arrangement::from_str(text, false).map(Some).map(Self).map_err(|_| {
                let words: Vec<String> = Arrangement::value_variants().iter().map(word).collect();
                format!("known are auto, {}", words.join(", "))
            }),
        }
    }
}

/// The word for a value, as it is typed and as files hold it.
pub fn word(value: &impl ValueEnum) -> String {
    value.to_possible_value().map(|word| word.get_name().to_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_their_values() {
        for arrangement in Arrangement::value_variants() {
            assert_eq!(Arrangement::from_str(&word(arrangement), false), Ok(*arrangement));
        }
        assert_eq!(word(&Arrangement::OpenExrCube), "openexr-cube");
        assert_eq!(word(&Layout::LatLong), "lat-long");
        assert_eq!(Arrangement::from_str("cube", false), Ok(Arrangement::StripCol));
    }
}
