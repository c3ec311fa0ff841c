//! Which part, layer and channels of an OpenEXR file are the map, and where they lie.

use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::EnvironmentMap;
use exr::meta::header::Header;
use exr::prelude::SampleType;

use brdf_sdk::{Problem, Result};

use super::CONVERT;
use crate::environment::Arrangement;
use crate::environment::arrangement::check_size;
use crate::environment::colour::Chromaticities;

/// The largest single block that is decompressed [bytes].
const MAX_BLOCK: usize = 1 << 29;

/// The chosen part of a file.
#[derive(Debug)]
pub struct Part {
    /// Its index among the file's parts.
    pub index: usize,
    /// Width and height of the picture: the display window, or the data window of an environment map.
    pub size: (u32, u32),
    /// The data window's corner, seen from the picture's.
    pub offset: (i64, i64),
    /// Where red, green and blue come from; all three from the same channel for a grey picture.
    pub channels: [Source; 3],
    /// Of all channels of the part together.
    pub bytes_per_texel: usize,
    pub chromaticities: Option<Chromaticities>,
    /// What the `envmap` attribute says.
    pub declared: Option<Arrangement>,
    pub notes: Vec<String>,
}

/// One channel inside a block's line.
#[derive(Debug, Clone, Copy)]
pub struct Source {
    pub kind: SampleType,
    /// Bytes of the channels before it, for each texel of the line.
    pub offset: usize,
}

impl Part {
    /// Chooses the first part with R, G and B, else the first with Y, and checks that it can be read.
    pub fn choose(name: &str, headers: &[Header], file_length: usize) -> Result<Self> {
        let rgb = headers.iter().enumerate().find_map(|(i, part)| Some((i, part, rgb(part)?)));
        let grey = || headers.iter().enumerate().find_map(|(i, part)| Some((i, part, grey(part)?)));
        let Some((index, header, chosen)) = rgb.or_else(grey) else {
            let known = headers.iter().flat_map(|part| &part.channels.list);
            let known: Vec<String> =
                known.take(12).map(|channel| channel.name.to_string()).collect();
            return Err(Problem::new(
                name,
                format!("it has no channels R, G and B, nor Y (it has {})", known.join(", ")),
                "write it with those channel names",
            ));
        };
        let attributes = &header.shared_attributes;
        let data = header.own_attributes.layer_position;
        let declared = header.own_attributes.environment_map.as_ref().map(|map| match map {
            EnvironmentMap::LatitudeLongitude => Arrangement::OpenExrLatLong,
            EnvironmentMap::Cube => Arrangement::OpenExrCube,
        });
        // ImfEnvmap.h puts directions on the data window, whatever is displayed.
        let (window, corner) = match declared {
            Some(_) => (header.layer_size, data),
            None => (attributes.display_window.size, attributes.display_window.position),
        };
        let size = check_size(name, window.0 as u64, window.1 as u64)?;
        refuse(name, header, &chosen, file_length)?;

        let offset = |data: i32, corner: i32| i64::from(data) - i64::from(corner);
        let offset = (offset(data.0, corner.0), offset(data.1, corner.1));
        let mut notes = Vec::new();
        if offset != (0, 0) || header.layer_size != window {
            notes.push("data and display window differ: outside the data is black".to_owned());
        }
        if chosen.names[0] != "R" {
            notes.push(format!("read from the channels {}", chosen.shown()));
        }
        Ok(Self {
            index,
            size,
            offset,
            channels: chosen.sources,
            bytes_per_texel: header.channels.bytes_per_pixel,
            chromaticities: attributes.chromaticities.map(|c| {
                let all = [c.red, c.green, c.blue, c.white];
                let [[rx, ry], [gx, gy], [bx, by], [wx, wy]] =
                    all.map(|c| [f64::from(c.0), f64::from(c.1)]);
                Chromaticities::from_numbers([rx, ry, gx, gy, bx, by, wx, wy])
            }),
            declared,
            notes,
        })
    }
}

/// Channels found for red, green and blue.
struct Chosen {
    names: Vec<String>,
    sources: [Source; 3],
}

impl Chosen {
    fn shown(&self) -> String {
        self.names.join(", ")
    }
}

/// R, G and B without a layer's name, else those of the first layer that has all three.
fn rgb(header: &Header) -> Option<Chosen> {
    let names = || header.channels.list.iter().map(|channel| channel.name.to_string());
    let plain = std::iter::once(String::new());
    let layers =
        names().filter_map(|name| name.strip_suffix(".R").map(|layer| format!("{layer}.")));
    plain.chain(layers).find_map(|layer| {
        let names: Vec<String> = ["R", "G", "B"].map(|c| format!("{layer}{c}")).into();
        let sources =
            [source(header, &names[0])?, source(header, &names[1])?, source(header, &names[2])?];
        Some(Chosen { names, sources })
    })
}

/// Y without a layer's name, else that of the first layer that has one.
fn grey(header: &Header) -> Option<Chosen> {
    let names = || header.channels.list.iter().map(|channel| channel.name.to_string());
    let name = names().find(|name| name == "Y").or_else(|| names().find(|n| n.ends_with(".Y")))?;
    let sources = [source(header, &name)?; 3];
    Some(Chosen { names: vec![name], sources })
}

fn source(header: &Header, name: &str) -> Option<Source> {
    let mut offset = 0;
    for channel in &header.channels.list {
        if channel.name.to_string() == name {
            return Some(Source { kind: channel.sample_type, offset });
        }
        offset += channel.sample_type.bytes_per_sample();
    }
    None
}

/// What a part may be that this reader does not take.
fn refuse(name: &str, header: &Header, chosen: &Chosen, file_length: usize) -> Result<()> {
    if header.deep {
        return Err(Problem::new(
            name,
            "it holds deep data",
            "flatten it with `oiiotool in.exr --flatten -o out.exr`",
        ));
    }
    let has = |wanted: &str| header.channels.list.iter().any(|c| c.name.to_string() == wanted);
    let one = exr::math::Vec2(1, 1);
    let subsampled = header.channels.list.iter().any(|channel| channel.sampling != one);
    if subsampled || (chosen.names[0] == "Y" && (has("RY") || has("BY"))) {
        return Err(Problem::new(
            name,
            "it holds luminance and chroma, or subsampled channels",
            "write it with channels R, G and B in full resolution",
        ));
    }
    // HTJ2K is the one family that the exr crate names but does not decode.
    if matches!(header.compression, Compression::HTJ2K32 | Compression::HTJ2K256) {
        return Err(Problem::new(name, "its HTJ2K compression is not read", CONVERT));
    }
    implausible(name, header, file_length)
}

/// Refuses sizes that a file of this length cannot hold, before anything of that size is allocated.
fn implausible(name: &str, header: &Header, file_length: usize) -> Result<()> {
    let size = header.layer_size;
    let bytes = header.channels.bytes_per_pixel;
    let (block_width, block_height) = match header.blocks {
        BlockDescription::ScanLines => (size.0, header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => (tiles.tile_size.0, tiles.tile_size.1),
    };
    let product = |a: usize, b: usize| a.saturating_mul(b).saturating_mul(bytes);
    let block = product(block_width.min(size.0), block_height.min(size.1));
    // Deflate shrinks 1032 times at most, run lengths less; DWA keeps one value of an 8x8 square and
    // deflates those.
    let ratio = match header.compression {
        Compression::Uncompressed => 1,
        Compression::DWAA(_) | Compression::DWAB(_) => 100_000,
        _ => 1_100,
    };
    let most = file_length.saturating_mul(ratio);
    // A column of faces is as long as the widest map.
    let largest = crate::environment::MAX_SIZE.0 as usize;
    if size.0 > largest || size.1 > largest || block > MAX_BLOCK || product(size.0, size.1) > most {
        return Err(Problem::new(
            name,
            format!(
                "its header claims {}x{} texels in blocks of {block_width}x{block_height}, \
                 more than a file of {file_length} bytes can hold or this program reads",
                size.0, size.1
            ),
            "fetch the file again, or make it smaller",
        ));
    }
    Ok(())
}
