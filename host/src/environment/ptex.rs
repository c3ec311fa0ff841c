//! Ptex cubes (.penv, .ptx, .ptex): six square faces in the order px nx py ny pz nz, as BRDF Explorer has them.
//!
//! After the "Ptex File Format Specification" 1.3 (Walt Disney Animation Studios 2009). Read is what a cube
//! needs: the full resolution of quad faces in all four encodings and data types. Refused are triangles, other
//! numbers of faces, faces of different sizes and pending edits; metadata and smaller levels are passed over.
//! A face's first row is its lowest (v runs up), so rows are turned over; beyond that BRDF Explorer
//! looks faces up by OpenGL's table with directions of its right-handed world, which is the cube's own order
//! (`cube`): a probe looks here as it does there, from an eye on +z. No crate reads Ptex without its C++ library.

mod face;

use brdf_sdk::{Problem, Result};
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use rayon::prelude::*;

use super::MAX_FACE;
use face::{Face, Kind};

/// How every Ptex file starts.
pub const MAGIC: &[u8] = b"Ptex";

const FACES: usize = 6;
/// Bytes of one entry of the face info: two logarithms, edges, flags, four neighbours.
const FACE_INFO: usize = 20;
/// Cubes up to this size [bytes] are taken from any file: six constant faces need few bytes.
const ALWAYS: u64 = 64 << 20;
/// The most that deflate shrinks.
const RATIO: u64 = 1_100;

/// What the header says that a cube needs.
#[derive(Debug, Clone, Copy)]
struct Header {
    kind: Kind,
    channels: usize,
    ext_header: usize,
    face_info: usize,
    const_data: usize,
    level_info: usize,
    level_data: u64,
    metadata: u64,
}

/// Decodes a whole file that starts with [`MAGIC`]: the side of the faces, their texels in the cube's order,
/// and notes.
pub fn decode(name: &str, bytes: &[u8]) -> Result<(u32, Vec<[f32; 4]>, Vec<String>)> {
    let file = File { name, bytes };
    let header = file.header()?;
    let infos_at = 64 + header.ext_header;
    let infos =
        file.inflated(file.part(infos_at, header.face_info)?, FACES * FACE_INFO, "face info")?;
    let infos: Vec<&[u8]> = infos.chunks_exact(FACE_INFO).collect();
    let side = file.side(&infos, &header)?;

    let constants_at = infos_at + header.face_info;
    let pixel = header.kind.bytes() * header.channels;
    let constants =
        file.inflated(file.part(constants_at, header.const_data)?, FACES * pixel, "constants")?;
    let levels_at = constants_at + header.const_data;
    let levels = file.part(levels_at, header.level_info)?;
    let level_size = levels.first_chunk().map(|size| u64::from_le_bytes(*size));
    let table_size = levels.get(8..12).and_then(|size| size.first_chunk());
    let (Some(level_size), Some(table_size)) = (level_size, table_size) else {
        return Err(file.damaged("level info"));
    };
    let data_at = levels_at + header.level_info;
    file.refuse_edits(&header, data_at)?;
    let level = file.part(data_at, usize::try_from(level_size).unwrap_or(usize::MAX))?;
    let table_size = u32::from_le_bytes(*table_size) as usize;
    let table = level.get(..table_size).ok_or_else(|| file.damaged("level"))?;
    let table = file.inflated(table, FACES * 4, "level")?;

    let mut blocks = Vec::new();
    let mut at = table_size;
    for entry in table.as_chunks::<4>().0 {
        let entry = u32::from_le_bytes(*entry);
        let end = at + (entry & 0x3fff_ffff) as usize;
        blocks.push((entry >> 30, level.get(at..end).ok_or_else(|| file.damaged("level"))?));
        at = end;
    }
    let shape = Face { kind: header.kind, channels: header.channels, columns: side, rows: side };
    let faces = (0..FACES).into_par_iter().map(|index| {
        // Bit 0: a constant face lies among the constants alone.
        let decoded = if infos[index][3] & 1 == 1 {
            shape.constant(&constants[index * pixel..])
        } else {
            let (encoding, block) = blocks[index];
            shape.decode(encoding, block)
        };
        decoded.ok_or_else(|| file.damaged(&format!("face {}", index + 1)))
    });
    let mut texels = Vec::new();
    for face in faces.collect::<Result<Vec<_>>>()? {
        texels.extend(face.chunks(side).rev().flatten());
    }
    let mut notes = Vec::new();
    if header.channels == 1 {
        notes.push("read as grey from its one channel".to_owned());
    }
    Ok((side as u32, texels, notes))
}

/// The file with its name, for messages.
#[derive(Clone, Copy)]
struct File<'a> {
    name: &'a str,
    bytes: &'a [u8],
}

impl<'a> File<'a> {
    fn header(self) -> Result<Header> {
        let head: &[u8; 64] = self.bytes.first_chunk().ok_or_else(|| self.damaged("header"))?;
        let word =
            |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let refused = |reason: String| {
            Err(Problem::new(
                self.name,
                reason,
                "give a Ptex file of six square quad faces with red, green and blue",
            ))
        };
        if word(4) != 1 {
            return refused(format!("it has version {} of Ptex, and 1 is read", word(4)));
        }
        if word(8) != 1 {
            return refused("it is made of triangles".to_owned());
        }
        let Some(kind) = Kind::of(word(12)) else {
            return refused(format!("its data type {} is not known", word(12)));
        };
        let channels = usize::from(u16::from_le_bytes([head[20], head[21]]));
        let alpha = word(16);
        if channels == 0 || channels == 2 || alpha < 3.min(channels as u32) {
            return refused(format!(
                "its {channels} channels do not begin with red, green and blue"
            ));
        }
        if word(24) != FACES as u32 {
            return refused(format!("it has {} faces", word(24)));
        }
        if u16::from_le_bytes([head[22], head[23]]) == 0 {
            return refused("it holds no level of texels".to_owned());
        }
        Ok(Header {
            kind,
            channels,
            ext_header: word(28) as usize,
            face_info: word(32) as usize,
            const_data: word(36) as usize,
            level_info: word(40) as usize,
            level_data: u64::from(word(48)) | (u64::from(word(52)) << 32),
            metadata: u64::from(word(56)),
        })
    }

    /// The side that all faces have; constant faces fit any.
    fn side(self, infos: &[&[u8]], header: &Header) -> Result<usize> {
        let constant = |info: &&[u8]| info[3] & 1 == 1;
        let varying: Vec<&[u8]> = infos.iter().copied().filter(|info| !constant(info)).collect();
        let sizes = if varying.is_empty() { infos } else { &varying };
        let size = [sizes[0][0], sizes[0][1]];
        let shown =
            |log: u8| if log < 32 { (1_u64 << log).to_string() } else { format!("2^{log}") };
        if size[0] != size[1] || sizes.iter().any(|other| other[..2] != size) {
            let shapes: Vec<String> =
                sizes.iter().map(|size| format!("{}x{}", shown(size[0]), shown(size[1]))).collect();
            return Err(Problem::new(
                self.name,
                format!("its faces are {}, not six squares of one size", shapes.join(", ")),
                "give a cube map of equal square faces",
            ));
        }
        let side = 1_u64.checked_shl(u32::from(size[0])).unwrap_or(u64::MAX);
        let texels = side.saturating_mul(side).saturating_mul(FACES as u64);
        let stored = texels.saturating_mul((header.kind.bytes() * header.channels) as u64);
        if side > u64::from(MAX_FACE)
            || (stored > (self.bytes.len() as u64).saturating_mul(RATIO)
                && texels.saturating_mul(16) > ALWAYS)
        {
            return Err(Problem::new(
                self.name,
                format!(
                    "its header claims faces of {0}x{0}, more than a file of {1} bytes can hold or this \
                     program reads",
                    shown(size[0]),
                    self.bytes.len()
                ),
                "fetch the file again, or make it smaller",
            ));
        }
        Ok(side as usize)
    }

    /// Edits stand behind everything else: where the extended header says, or in older files at the end.
    fn refuse_edits(self, header: &Header, data_at: usize) -> Result<()> {
        let ext = self.part(64, header.ext_header.min(40))?;
        let number = |at: usize| {
            ext.get(at..at + 8)
                .and_then(|bytes| bytes.first_chunk())
                .map_or(0, |b| u64::from_le_bytes(*b))
        };
        let (lmd_header, lmd_data) = (number(8) & 0xffff_ffff, number(16));
        let (edit_size, edit_at) = (number(24), number(32));
        let edited = if edit_at > 0 {
            edit_size > 0
        } else {
            // Eight bytes of zero part the metadata from what later versions added.
            let end = [header.level_data, header.metadata, 8, lmd_header, lmd_data]
                .into_iter()
                .fold(data_at as u64, u64::saturating_add);
            let size = usize::try_from(end).ok().and_then(|end| self.bytes.get(end..)?.get(1..5));
            size.is_some_and(|size| size != [0; 4])
        };
        match edited {
            true => Err(Problem::new(
                self.name,
                "it holds edits that are not applied yet",
                "let Ptex's own tools write it as a whole",
            )),
            false => Ok(()),
        }
    }

    fn part(self, at: usize, length: usize) -> Result<&'a [u8]> {
        let end = at.checked_add(length);
        end.and_then(|end| self.bytes.get(at..end)).ok_or_else(|| {
            Problem::new(self.name, "the file ends too early", "it was cut short: fetch it again")
        })
    }

    fn inflated(self, part: &[u8], length: usize, what: &str) -> Result<Vec<u8>> {
        inflate(part, length).ok_or_else(|| self.damaged(what))
    }

    fn damaged(self, what: &str) -> Problem {
        Problem::new(self.name, format!("the file is damaged in its {what}"), "fetch it again")
    }
}

/// Inflates zlib data of a known length; nothing beyond it is allocated.
fn inflate(data: &[u8], length: usize) -> Option<Vec<u8>> {
    decompress_to_vec_zlib_with_limit(data, length).ok().filter(|data| data.len() == length)
}

#[cfg(test)]
mod tests;
