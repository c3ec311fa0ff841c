//! Ptex files written here, by the specification, in every encoding; and what damaged ones get.

use exr::prelude::f16;
use miniz_oxide::deflate::compress_to_vec_zlib;

use super::*;
use crate::layout::Layout;

const ZIPPED: u32 = 1;
const DIFFERENCES: u32 = 2;
const TILED: u32 = 3;

/// A file to be written.
#[derive(Clone, Copy)]
struct Spec {
    kind: Kind,
    channels: usize,
    log_side: u8,
    /// For each face: `None` for one among the constants, else its encoding.
    encodings: [Option<u32>; 6],
}

impl Spec {
    fn new(kind: Kind, encoding: u32) -> Self {
        Self { kind, channels: 3, log_side: 2, encodings: [Some(encoding); 6] }
    }

    fn side(self) -> usize {
        1 << self.log_side
    }

    /// A value that each data type holds exactly, in units of one step; v counts from below.
    fn step(self, face: usize, u: usize, v: usize, channel: usize) -> u8 {
        match self.encodings[face] {
            None | Some(0) => (face * 10 + channel) as u8,
            _ => ((face * 31 + v * 17 + u * 5 + channel * 97) % 251) as u8,
        }
    }

    fn bytes_of(self, step: u8) -> Vec<u8> {
        match self.kind {
            Kind::U8 => vec![step],
            Kind::U16 => (u16::from(step) * 257).to_le_bytes().to_vec(),
            Kind::F16 => f16::from_f32(f32::from(step) * 0.5).to_le_bytes().to_vec(),
            Kind::F32 => (f32::from(step) * 1000.5).to_le_bytes().to_vec(),
        }
    }

    fn value(self, step: u8) -> f32 {
        match self.kind {
            Kind::U8 | Kind::U16 => f32::from(step) / 255.0,
            Kind::F16 => f32::from(step) * 0.5,
            Kind::F32 => f32::from(step) * 1000.5,
        }
    }

    /// A rectangle of a face in an encoding.
    fn block(self, face: usize, corner: [usize; 2], size: [usize; 2], encoding: u32) -> Vec<u8> {
        if encoding == 0 {
            return (0..self.channels)
                .flat_map(|c| self.bytes_of(self.step(face, 0, 0, c)))
                .collect();
        }
        if encoding == TILED {
            let tile = [size[0] / 2, size[1] / 4];
            let mut table = Vec::new();
            let mut data = Vec::new();
            for v in 0..4 {
                for u in 0..2 {
                    let encoding = [ZIPPED, DIFFERENCES][(u + v) % 2];
                    let block = self.block(face, [u * tile[0], v * tile[1]], tile, encoding);
                    table.extend((block.len() as u32 | (encoding << 30)).to_le_bytes());
                    data.extend(block);
                }
            }
            let table = compress_to_vec_zlib(&table, 6);
            let mut block = vec![self.log_side - 1, self.log_side - 2];
            block.extend((table.len() as u32).to_le_bytes());
            block.extend(table);
            block.extend(data);
            return block;
        }
        let mut plain = Vec::new();
        let mut last = 0_u8;
        for channel in 0..self.channels {
            for v in 0..size[1] {
                for u in 0..size[0] {
                    let step = self.step(face, corner[0] + u, corner[1] + v, channel);
                    let difference = encoding == DIFFERENCES;
                    match self.kind {
                        Kind::U8 if difference => plain.push(step.wrapping_sub(last)),
                        Kind::U16 if difference => {
                            let wide = |step: u8| u16::from(step) * 257;
                            plain.extend(wide(step).wrapping_sub(wide(last)).to_le_bytes());
                        }
                        _ => plain.extend(self.bytes_of(step)),
                    }
                    last = step;
                }
            }
        }
        compress_to_vec_zlib(&plain, 6)
    }

    fn file(self) -> Vec<u8> {
        let mut infos = Vec::new();
        let mut constants = Vec::new();
        let mut table = Vec::new();
        let mut data = Vec::new();
        for (face, encoding) in self.encodings.into_iter().enumerate() {
            infos.extend([self.log_side, self.log_side, 0, u8::from(encoding.is_none())]);
            infos.extend([0xff; 16]);
            constants
                .extend((0..self.channels).flat_map(|c| self.bytes_of(self.step(face, 0, 0, c))));
            let block =
                encoding.map(|encoding| self.block(face, [0, 0], [self.side(); 2], encoding));
            let block = block.unwrap_or_default();
            table.extend((block.len() as u32 | (encoding.unwrap_or(0) << 30)).to_le_bytes());
            data.extend(block);
        }
        let [infos, constants, table] =
            [infos, constants, table].map(|part| compress_to_vec_zlib(&part, 6));
        let level = (table.len() + data.len()) as u64;
        let kind = [Kind::U8, Kind::U16, Kind::F16, Kind::F32].iter().position(|k| *k == self.kind);
        let mut file = MAGIC.to_vec();
        file.extend([1, 1, kind.unwrap() as u32, u32::MAX].into_iter().flat_map(u32::to_le_bytes));
        file.extend([self.channels as u16, 1].into_iter().flat_map(u16::to_le_bytes));
        let sizes = [6, 40, infos.len() as u32, constants.len() as u32, 16, 4];
        file.extend(sizes.into_iter().flat_map(u32::to_le_bytes));
        file.extend(level.to_le_bytes());
        file.extend([0; 8]);
        file.extend([0; 40]);
        file.extend(infos);
        file.extend(constants);
        file.extend(level.to_le_bytes());
        file.extend([table.len() as u32, 6].into_iter().flat_map(u32::to_le_bytes));
        file.extend(table);
        file.extend(data);
        file.extend([0; 8]);
        file
    }

    fn assert_decodes(self) {
        let (side, texels, _) = decode("m.ptx", &self.file()).unwrap();
        let side = side as usize;
        assert_eq!((side, texels.len()), (self.side(), 6 * self.side() * self.side()));
        for (index, texel) in texels.iter().enumerate() {
            let (face, row, column) = (index / side / side, index / side % side, index % side);
            // The first row of the cube is the highest of the face.
            let expected = [0, 1, 2].map(|channel| {
                let channel = if self.channels == 1 { 0 } else { channel };
                self.value(self.step(face, column, side - 1 - row, channel))
            });
            assert_eq!(texel[..3], expected, "{:?} face {face} {column} {row}", self.kind);
            assert_eq!(texel[3], 0.0);
        }
    }
}

fn told(bytes: &[u8]) -> String {
    decode("m.ptx", bytes).unwrap_err().to_string()
}

#[test]
fn every_encoding_and_data_type() {
    for kind in [Kind::U8, Kind::U16, Kind::F16, Kind::F32] {
        for encoding in [0, ZIPPED, DIFFERENCES, TILED] {
            Spec::new(kind, encoding).assert_decodes();
        }
        let mixed = [None, Some(ZIPPED), Some(TILED), Some(DIFFERENCES), None, Some(0)];
        Spec { encodings: mixed, ..Spec::new(kind, 0) }.assert_decodes();
        Spec { encodings: [None; 6], ..Spec::new(kind, 0) }.assert_decodes();
        Spec { channels: 1, ..Spec::new(kind, ZIPPED) }.assert_decodes();
        Spec { channels: 5, ..Spec::new(kind, TILED) }.assert_decodes();
    }
}

#[test]
fn a_probe_looks_as_opengl_looks_it_up() {
    // BRDF Explorer turns v over and asks OpenGL: +x at s = -z, +z at s = x, +y at t = z; v is up.
    let spec = Spec::new(Kind::F32, ZIPPED);
    let (side, texels, _) = decode("m.ptx", &spec.file()).unwrap();
    let map = crate::environment::Environment {
        layout: Layout::Cube,
        width: side,
        height: 6 * side,
        texels: std::sync::Arc::new(texels),
        ..crate::environment::Environment::constant(0.0)
    };
    let red = |x: f64, y: f64, z: f64| map.radiance(glam::DVec3::new(x, y, z))[0];
    let at = |face: usize, u: usize, v: usize| spec.value(spec.step(face, u, v, 0));
    // Texels 0 to 3 from -1 to 1: 0.25 lies in texel 2, -0.75 in texel 0.
    assert_eq!(red(1.0, 0.25, 0.75), at(0, 0, 2));
    assert_eq!(red(-1.0, 0.25, 0.75), at(1, 3, 2));
    assert_eq!(red(-0.75, 1.0, 0.25), at(2, 0, 1));
    assert_eq!(red(-0.75, -1.0, 0.25), at(3, 0, 2));
    assert_eq!(red(0.75, -0.25, 1.0), at(4, 3, 1));
    assert_eq!(red(0.75, -0.25, -1.0), at(5, 0, 1));
}

#[test]
fn a_probe_lights_by_each_of_its_endings_with_floats_and_halves() {
    let folder = tempfile::tempdir().unwrap();
    for kind in [Kind::F16, Kind::F32] {
        let spec = Spec::new(kind, ZIPPED);
        let (side, texels, _) = decode("m", &spec.file()).unwrap();
        for name in ["m.penv", "m.ptex", "m.ptx", "M.PTX"] {
            let path = folder.path().join(name);
            std::fs::write(&path, spec.file()).unwrap();
            let map = crate::environment::load(&path, &Default::default()).unwrap();
            assert_eq!((map.layout, map.width, map.height), (Layout::Cube, side, 6 * side));
            assert_eq!(*map.texels, texels, "{name}");
        }
    }
}

#[test]
fn what_is_no_cube_is_refused() {
    let file = Spec::new(Kind::F32, ZIPPED).file();
    let with = |at: usize, value: u32| {
        let mut file = file.clone();
        file[at..at + 4].copy_from_slice(&value.to_le_bytes());
        told(&file)
    };
    let cure = "give a Ptex file of six square quad faces with red, green and blue";
    assert_eq!(with(4, 2), format!("m.ptx: it has version 2 of Ptex, and 1 is read; {cure}"));
    assert_eq!(with(8, 0), format!("m.ptx: it is made of triangles; {cure}"));
    assert_eq!(with(12, 4), format!("m.ptx: its data type 4 is not known; {cure}"));
    assert_eq!(with(24, 7), format!("m.ptx: it has 7 faces; {cure}"));
    assert!(with(16, 1).contains("its 3 channels do not begin with red, green and blue"));
    assert!(with(20, 2 | (1 << 16)).contains("its 2 channels do not"));
    assert!(with(20, 3).contains("it holds no level"));
    // Edits: told by the extended header (size at 64 + 24, place at 64 + 32), or behind older files.
    let mut edited = file.clone();
    edited[64 + 24] = 1;
    edited[64 + 32] = 1;
    assert!(told(&edited).contains("it holds edits"));
    let old = [&file[..], &[1, 9, 0, 0, 0, 0]].concat();
    assert!(told(&old).contains("it holds edits"));
    let ended = [&file[..], &[1, 0, 0, 0, 0]].concat();
    assert!(decode("m.ptx", &ended).is_ok());
    // A side of 2^13, of 2^4 against 2^3 and of 2^200, in a file of some hundred bytes.
    for (log_u, log_v, part) in [
        (13, 13, "claims faces of 8192x8192"),
        (3, 4, "faces are 8x16"),
        (200, 200, "claims faces of 2^200"),
    ] {
        let mut infos = Vec::new();
        for _ in 0..6 {
            infos.extend([log_u, log_v, 0, 0]);
            infos.extend([0; 16]);
        }
        let infos = compress_to_vec_zlib(&infos, 6);
        let mut head = file[..104].to_vec();
        head[32..36].copy_from_slice(&(infos.len() as u32).to_le_bytes());
        head.extend(infos);
        assert!(told(&head).contains(part), "{}", told(&head));
    }
}

#[test]
fn cut_or_damaged_files_are_told_in_one_line() {
    let mixed = [None, Some(ZIPPED), Some(TILED), Some(DIFFERENCES), Some(TILED), Some(0)];
    let file = Spec { encodings: mixed, ..Spec::new(Kind::U16, 0) }.file();
    // The last eight bytes are the barrier.
    for length in 4..file.len() - 8 {
        let told = told(&file[..length]);
        assert!(told.starts_with("m.ptx: ") && !told.contains('\n'), "{told}");
    }
    for at in 4..file.len() {
        for flip in [0x55, 0xff, 0x01, 0x80] {
            let mut damaged = file.clone();
            damaged[at] ^= flip;
            if let Err(problem) = decode("m.ptx", &damaged) {
                assert!(!problem.to_string().contains('\n'), "{problem}");
            }
        }
    }
}
