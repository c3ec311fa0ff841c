//! OpenEXR pictures, decoded with the exr crate: R, G and B of the one part that has them.

use std::io::Cursor;

use brdf_sdk::{Problem, Result};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::Chromaticities;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};

use super::{Stored, check_size, damaged};
use crate::picture::STD_ERROR;
use crate::tone::{PRIMARIES, WHITE};

/// The channels of radiance.
const RGB: [&str; 3] = ["R", "G", "B"];

/// Chromaticities may be off by this and still be Rec. 709's.
const ROUNDED: f32 = 1e-3;

/// Decodes a whole file that starts with OpenEXR's magic number.
pub fn decode(name: &str, bytes: &[u8]) -> Result<Stored> {
    let meta =
        MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| wrong(name, &e))?;
    let header = choose(name, &meta.headers)?;
    let [has_coverage, has_std_error] = check_channels(name, header)?;
    check_kind(name, header)?;
    let size = [header.layer_size.0, header.layer_size.1].map(|side| side as u64);
    // Deflate shrinks 1032 times at most, run lengths less; DWA keeps one value of an 8x8 square and
    // deflates those.
    let shrinks = match header.compression {
        Compression::Uncompressed => 1,
        Compression::DWAA(_) | Compression::DWAB(_) => 100_000,
        _ => 1_100,
    };
    let per_pixel = header.channels.bytes_per_pixel as u64;
    let resolution = check_size(name, size, per_pixel, shrinks, bytes.len())?;

    let width = header.layer_size.0;
    let [red, green, blue] = STD_ERROR;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(RGB[0])
        .required(RGB[1])
        .required(RGB[2])
        .optional("A", 0.0_f32)
        .optional(red, f32::NAN)
        .optional(green, f32::NAN)
        .optional(blue, f32::NAN)
        .collect_pixels(
            // A pixel that no block brings stays NaN, which is counted.
            move |size, _| Planes::new(size.area(), [has_coverage, has_std_error]),
            move |planes: &mut Planes, at: Vec2<usize>, (r, g, b, a, er, eg, eb): Seven| {
                let pixel = at.y() * width + at.x();
                planes.rgb[pixel] = [r, g, b];
                if has_coverage {
                    planes.coverage[pixel] = a;
                }
                if has_std_error {
                    planes.std_error[pixel] = [er, eg, eb];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        // The crate's own threads would end the program where a damaged file makes them panic.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| wrong(name, &error))?;
    let Planes { rgb, coverage, std_error } = image.layer_data.channel_data.pixels;
    Ok(Stored {
        resolution,
        rgb,
        coverage: has_coverage.then_some(coverage),
        std_error: has_std_error.then_some(std_error),
        for_display: false,
    })
}

type Seven = (f32, f32, f32, f32, f32, f32, f32);

/// The channels while they are read; those that the file does not have stay empty.
struct Planes {
    rgb: Vec<[f32; 3]>,
    coverage: Vec<f32>,
    std_error: Vec<[f32; 3]>,
}

impl Planes {
    fn new(pixels: usize, [has_coverage, has_std_error]: [bool; 2]) -> Self {
        let count = |has: bool| if has { pixels } else { 0 };
        Self {
            rgb: vec![[f32::NAN; 3]; pixels],
            coverage: vec![f32::NAN; count(has_coverage)],
            std_error: vec![[f32::NAN; 3]; count(has_std_error)],
        }
    }
}

fn has(header: &Header, wanted: &str) -> bool {
    header.channels.list.iter().any(|channel| channel.name == *wanted)
}

/// The one part with R, G and B.
fn choose<'a>(name: &str, headers: &'a [Header]) -> Result<&'a Header> {
    let fit = |header: &&Header| RGB.iter().all(|wanted| has(header, wanted));
    let mut found = headers.iter().filter(fit);
    let Some(header) = found.next() else {
        let known = headers.iter().flat_map(|header| &header.channels.list);
        let known: Vec<String> = known.take(12).map(|channel| channel.name.to_string()).collect();
        return Err(Problem::new(
            name,
            format!("it has no channels R, G and B (it has {})", known.join(", ")),
            "write it with those channel names, in one part",
        ));
    };
    match found.count() {
        0 => Ok(header),
        more => Err(Problem::new(
            name,
            format!("it holds {} parts with R, G and B: which is the picture?", more + 1),
            "write the one that is meant to a file of its own",
        )),
    }
}

/// Whether there are coverage and standard errors, the latter for all channels or for none.
fn check_channels(name: &str, header: &Header) -> Result<[bool; 2]> {
    let missing = STD_ERROR.iter().filter(|wanted| !has(header, wanted)).count();
    if missing % STD_ERROR.len() != 0 {
        return Err(Problem::new(
            name,
            format!("it has not all of the channels {}", STD_ERROR.join(", ")),
            "write all three, or none",
        ));
    }
    let read = |channel: &str| RGB.iter().chain(&["A"]).chain(&STD_ERROR).any(|c| *c == channel);
    let channels = header.channels.list.iter();
    if let Some(channel) = channels
        .filter(|channel| read(&channel.name.to_string()))
        .find(|channel| channel.sampling != Vec2(1, 1))
    {
        return Err(Problem::new(
            name,
            format!("its channel {} is subsampled", channel.name),
            "write it in full resolution",
        ));
    }
    Ok([has(header, "A"), missing == 0])
}

/// What a part may be that has no numbers to compare.
fn check_kind(name: &str, header: &Header) -> Result<()> {
    if header.deep {
        return Err(Problem::new(
            name,
            "it holds deep data",
            "flatten it with `oiiotool in.exr --flatten -o out.exr`",
        ));
    }
    let display = header.shared_attributes.display_window;
    if header.own_attributes.layer_position != display.position || header.layer_size != display.size
    {
        return Err(Problem::new(
            name,
            "its data window is not its display window: part of the picture is missing or hidden",
            "write it whole, for instance with `oiiotool in.exr --croptofull -o out.exr`",
        ));
    }
    match header.shared_attributes.chromaticities {
        Some(other) if !are_rec709(&other) => Err(Problem::new(
            name,
            "its chromaticities are not those of Rec. 709",
            "convert it to linear Rec. 709 first",
        )),
        _ => Ok(()),
    }
}

fn are_rec709(given: &Chromaticities) -> bool {
    let rec709 = PRIMARIES.into_iter().chain([WHITE]).map(|place| place.map(|c| c as f32));
    let given = [given.red, given.green, given.blue, given.white];
    let near = |a: f32, b: f32| (a - b).abs() <= ROUNDED;
    given.iter().zip(rec709).all(|(given, [x, y])| near(given.0, x) && near(given.1, y))
}

fn wrong(name: &str, error: &exr::error::Error) -> Problem {
    match error {
        exr::error::Error::NotSupported(what) => Problem::new(
            name,
            format!("it uses a feature of OpenEXR that is not read ({what})"),
            "convert it, for instance with `oiiotool in.exr --compression zip -o out.exr`",
        ),
        exr::error::Error::Invalid(what) => damaged(name, what),
        other => damaged(name, &other.to_string()),
    }
}
