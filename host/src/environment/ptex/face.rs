//! One face of a Ptex file, or one tile of it, from its encoding.

use exr::prelude::f16;

use super::inflate;

/// What a channel's value is stored as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    U8,
    U16,
    F16,
    F32,
}

impl Kind {
    /// The kind with this number in a header.
    pub fn of(number: u32) -> Option<Self> {
        [Self::U8, Self::U16, Self::F16, Self::F32].get(number as usize).copied()
    }

    /// Bytes of one value.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }

    /// A value; whole numbers reach from 0 to 1.
    fn value(self, bytes: &[u8]) -> Option<f32> {
        match self {
            Self::U8 => bytes.first().map(|byte| f32::from(*byte) / 255.0),
            Self::U16 => bytes.first_chunk().map(|b| f32::from(u16::from_le_bytes(*b)) / 65535.0),
            Self::F16 => bytes.first_chunk().map(|b| f16::from_le_bytes(*b).to_f32()),
            Self::F32 => bytes.first_chunk().map(|b| f32::from_le_bytes(*b)),
        }
    }
}

/// The shape of a face or tile.
#[derive(Debug, Clone, Copy)]
pub struct Face {
    pub kind: Kind,
    pub channels: usize,
    pub columns: usize,
    pub rows: usize,
}

impl Face {
    /// All texels alike: `pixel` holds the channels of one.
    pub fn constant(self, pixel: &[u8]) -> Option<Vec<[f32; 4]>> {
        let step = self.kind.bytes();
        let texel = self.texel(|channel| pixel.get(channel * step..))?;
        Some(vec![texel; self.columns * self.rows])
    }

    /// Decodes a block, rows from below; none where it is damaged.
    pub fn decode(self, encoding: u32, block: &[u8]) -> Option<Vec<[f32; 4]>> {
        match encoding {
            0 => self.constant(block),
            1 => self.planes(&inflate(block, self.bytes())?),
            2 => {
                let mut data = inflate(block, self.bytes())?;
                self.undo_differences(&mut data);
                self.planes(&data)
            }
            _ => self.tiled(block),
        }
    }

    fn bytes(self) -> usize {
        self.columns * self.rows * self.channels * self.kind.bytes()
    }

    /// Channels lie one behind the other.
    fn planes(self, data: &[u8]) -> Option<Vec<[f32; 4]>> {
        let step = self.kind.bytes();
        let count = self.columns * self.rows;
        (0..count)
            .map(|index| self.texel(|channel| data.get((channel * count + index) * step..)))
            .collect()
    }

    /// The first three channels, or the only one three times.
    fn texel<'a>(self, bytes: impl Fn(usize) -> Option<&'a [u8]>) -> Option<[f32; 4]> {
        let last = if self.channels < 3 { 0 } else { 2 };
        let mut texel = [0.0; 4];
        for (channel, value) in texel.iter_mut().take(3).enumerate() {
            *value = self.kind.value(bytes(channel.min(last))?)?;
        }
        Some(texel)
    }

    /// Whole numbers are stored as the difference from the one before, modulo their range.
    fn undo_differences(self, data: &mut [u8]) {
        match self.kind {
            Kind::U8 => {
                let mut last = 0_u8;
                for byte in data {
                    last = last.wrapping_add(*byte);
                    *byte = last;
                }
            }
            Kind::U16 => {
                let mut last = 0_u16;
                for bytes in data.as_chunks_mut::<2>().0 {
                    last = last.wrapping_add(u16::from_le_bytes(*bytes));
                    *bytes = last.to_le_bytes();
                }
            }
            Kind::F16 | Kind::F32 => {}
        }
    }

    /// Tiles of one size, row by row, behind a table of their sizes and encodings.
    fn tiled(self, block: &[u8]) -> Option<Vec<[f32; 4]>> {
        let &[log_columns, log_rows, a, b, c, d] = block.first_chunk()?;
        let columns = 1_usize.checked_shl(u32::from(log_columns))?;
        let rows = 1_usize.checked_shl(u32::from(log_rows))?;
        if columns > self.columns || rows > self.rows {
            return None;
        }
        let (across, down) = (self.columns / columns, self.rows / rows);
        let table_end = 6_usize.checked_add(u32::from_le_bytes([a, b, c, d]) as usize)?;
        let table = inflate(block.get(6..table_end)?, across * down * 4)?;
        let tile = Self { columns, rows, ..self };
        let mut texels = vec![[0.0; 4]; self.columns * self.rows];
        let mut at = table_end;
        for (index, entry) in table.as_chunks::<4>().0.iter().enumerate() {
            let entry = u32::from_le_bytes(*entry);
            let end = at.checked_add((entry & 0x3fff_ffff) as usize)?;
            let encoding = entry >> 30;
            if encoding > 2 {
                return None;
            }
            let part = tile.decode(encoding, block.get(at..end)?)?;
            at = end;
            let corner = index / across * rows * self.columns + index % across * columns;
            for (row, line) in part.chunks(columns).enumerate() {
                texels[corner + row * self.columns..][..columns].copy_from_slice(line);
            }
        }
        Some(texels)
    }
}
