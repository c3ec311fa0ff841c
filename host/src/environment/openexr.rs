//! OpenEXR pictures, decoded block by block with the exr crate.
//!
//! The display window is the picture; what the data window does not cover is black, what it covers
//! beyond is cropped; an `envmap` attribute speaks of the data window alone. The first part and layer with R, G
//! and B are taken, or else a lone Y. Alpha is ignored. Deep data, subsampled channels and HTJ2K are refused.

mod part;

use std::collections::HashSet;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::block::chunk::Chunk;
use exr::block::{self, UncompressedBlock};
use exr::meta::MetaData;
use exr::prelude::{SampleType, f16};
use rayon::prelude::*;

use brdf_sdk::{Problem, Result};

use super::Picture;
use super::colour::{self, Chromaticities};
use part::{Part, Source};

/// Chunks that are decompressed between two copies; bounds the memory for decompressed data.
const BATCH: usize = 64;

/// The way to a file that this reader takes.
const CONVERT: &str =
    "convert it, for instance with `oiiotool in.exr --compression zip -o out.exr`";

/// Decodes a whole file that starts with OpenEXR's magic number.
pub fn decode(name: &str, bytes: &[u8]) -> Result<Picture> {
    // The exr crate asserts on some contradictions in damaged files. Those panics end here, since
    // a file must never take the program down.
    catch_unwind(AssertUnwindSafe(|| decode_unguarded(name, bytes))).unwrap_or_else(|_| {
        Err(Problem::new(name, "the file is damaged (its decoder gave up)", "fetch it again"))
    })
}

fn decode_unguarded(name: &str, bytes: &[u8]) -> Result<Picture> {
    let wrong = |error: exr::error::Error| problem(name, &error);
    let reader = block::read(Cursor::new(bytes), false).map_err(wrong)?;
    let part = Part::choose(name, reader.headers(), bytes.len())?;
    let (width, height) = part.size;

    let full_size = exr::math::Vec2(0, 0);
    let chunks = reader
        .filter_chunks(false, |_, tile, block| {
            block.layer == part.index && tile.level_index == full_size
        })
        .map_err(wrong)?;
    let meta = block::reader::ChunksReader::meta_data(&chunks).clone();
    // All chunks are found before the picture is allocated: the file has to hold what it claims.
    let mut chunks: Vec<Chunk> = chunks.collect::<Result<_, _>>().map_err(wrong)?;

    let mut texels = vec![[0.0_f32; 4]; width as usize * height as usize];
    let mut seen = HashSet::new();
    while !chunks.is_empty() {
        let batch: Vec<Chunk> = chunks.drain(..chunks.len().min(BATCH)).collect();
        let blocks = decompress(batch, &meta).map_err(wrong)?;
        for block in blocks {
            let place = (block.index.pixel_position, block.index.level);
            if block.index.layer != part.index
                || block.index.level != full_size
                || !seen.insert(place)
            {
                return Err(Problem::new(
                    name,
                    "the file is damaged (its table of blocks contradicts the blocks)",
                    "fetch it again",
                ));
            }
            copy(&part, &block, &mut texels);
        }
    }

    let mut notes = part.notes;
    if let Some(from) = part.chromaticities.filter(|from| !from.are_rec709()) {
        let Chromaticities { red: [rx, ry], green: [gx, gy], blue: [bx, by], white: [wx, wy] } =
            from;
        let shown = format!("{rx:.4} {ry:.4} {gx:.4} {gy:.4} {bx:.4} {by:.4} {wx:.4} {wy:.4}");
        let matrix = from.rec709_from_rgb().ok_or_else(|| {
            Problem::new(
                name,
                format!("its chromaticities {shown} are no usable primaries"),
                "correct that attribute, or remove it for Rec. 709",
            )
        })?;
        colour::convert(&mut texels, matrix);
        notes.push(format!("converted from chromaticities {shown} to linear Rec. 709"));
    }
    Ok(Picture { width, height, texels, declared: part.declared, notes })
}

/// Decompresses on all threads. Not the crate's own pool: there, a panic would abort the program.
fn decompress(batch: Vec<Chunk>, meta: &MetaData) -> exr::error::Result<Vec<UncompressedBlock>> {
    batch
        .into_par_iter()
        .map(|chunk| UncompressedBlock::decompress_chunk(chunk, meta, false))
        .collect()
}

/// Copies the part of a block that lies inside the display window.
fn copy(part: &Part, block: &UncompressedBlock, texels: &mut [[f32; 4]]) {
    let (width, height) = (i64::from(part.size.0), i64::from(part.size.1));
    let columns = block.index.pixel_size.0;
    let left = part.offset.0 + block.index.pixel_position.0 as i64;
    let top = part.offset.1 + block.index.pixel_position.1 as i64;
    let (from, to) = (left.clamp(0, width), (left + columns as i64).clamp(0, width));
    if from >= to {
        return;
    }
    let skipped = (from - left) as usize;
    let length = (to - from) as usize;
    for (row, line) in block.data.chunks_exact(columns * part.bytes_per_texel).enumerate() {
        let y = top + row as i64;
        if !(0..height).contains(&y) {
            continue;
        }
        let target = &mut texels[(y * width + from) as usize..][..length];
        for (channel, source) in part.channels.iter().enumerate() {
            fill(target, channel, source, &line[source.offset * columns..], skipped);
        }
    }
}

/// Writes one channel of a stretch of texels from the samples (native byte order) of its line.
fn fill(target: &mut [[f32; 4]], channel: usize, source: &Source, line: &[u8], skipped: usize) {
    let samples4 = || line.as_chunks::<4>().0[skipped..].iter();
    match source.kind {
        SampleType::F32 => target
            .iter_mut()
            .zip(samples4())
            .for_each(|(texel, bytes)| texel[channel] = f32::from_ne_bytes(*bytes)),
        SampleType::U32 => target
            .iter_mut()
            .zip(samples4())
            .for_each(|(texel, bytes)| texel[channel] = u32::from_ne_bytes(*bytes) as f32),
        SampleType::F16 => target
            .iter_mut()
            .zip(&line.as_chunks::<2>().0[skipped..])
            .for_each(|(texel, bytes)| texel[channel] = f16::from_ne_bytes(*bytes).to_f32()),
    }
}

fn problem(name: &str, error: &exr::error::Error) -> Problem {
    match error {
        exr::error::Error::NotSupported(what) if what.contains("deep") => Problem::new(
            name,
            "it holds deep data",
            "flatten it with `oiiotool in.exr --flatten -o out.exr`",
        ),
        exr::error::Error::NotSupported(what) => Problem::new(
            name,
            format!("it uses a feature of OpenEXR that is not read ({what})"),
            CONVERT,
        ),
        exr::error::Error::Invalid(what) => Problem::new(
            name,
            format!("the file is cut short or damaged ({what})"),
            "fetch it again",
        ),
        other => Problem::new(name, format!("it cannot be read ({other})"), "fetch it again"),
    }
}

#[cfg(test)]
mod tests;
