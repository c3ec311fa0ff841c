//! Bytes of files, read with their lengths in mind.
//!
//! No more is read than a format may have, and memory is taken for what is there, never for what a header claims.
//! What the bytes mean is the formats' own.

use std::fs::File;
use std::io::{BufReader, Error, ErrorKind, Read};

/// Opens a file.
pub fn open(path: &str) -> Result<File, String> {
    File::open(path).map_err(|error| unreadable(&error))
}

/// A file's length [bytes].
pub fn length(path: &str) -> Result<u64, String> {
    let known = std::fs::metadata(path).map_err(|error| unreadable(&error))?;
    Ok(known.len())
}

/// All of a file of up to `most` bytes.
pub fn whole(path: &str, most: u64) -> Result<Vec<u8>, String> {
    let length = length(path)?;
    if length > most {
        return Err(format!(
            "it has {length} bytes, and {most} are the most that is read; name a smaller file"
        ));
    }
    std::fs::read(path).map_err(|error| unreadable(&error))
}

/// The sentence for what the system says.
pub fn unreadable(error: &Error) -> String {
    format!("the file cannot be read ({error}); check its path and permissions")
}

/// What a file says, fit for a message: its beginning, up to `most` characters, without any that would break it.
pub fn shown(text: &str, most: usize) -> String {
    let rest = if text.chars().nth(most).is_some() { "..." } else { "" };
    text.chars().take(most).flat_map(char::escape_debug).chain(rest.chars()).collect()
}

/// A file that is read from some place on, in little-endian words.
pub struct Words<R> {
    reader: R,
    length: u64,
}

impl Words<BufReader<File>> {
    /// Opens a file.
    pub fn open(path: &str) -> Result<Self, String> {
        let length = length(path)?;
        Ok(Self::new(BufReader::with_capacity(1 << 20, open(path)?), length))
    }
}

impl<R: Read> Words<R> {
    /// Reads on from where the reader is; the whole file has `length` bytes.
    pub fn new(reader: R, length: u64) -> Self {
        Self { reader, length }
    }

    /// The file's length [bytes].
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Fills a buffer.
    pub fn fill(&mut self, bytes: &mut [u8]) -> Result<(), String> {
        self.reader.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => {
                format!("it ends after {} bytes; it was cut off, so fetch it again", self.length)
            }
            _ => unreadable(&error),
        })
    }

    /// The next signed word.
    pub fn i32(&mut self) -> Result<i32, String> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Ok(i32::from_le_bytes(bytes))
    }

    /// Hands over `count` numbers of `N` bytes each, a piece at a time.
    pub fn each<const N: usize>(
        &mut self,
        count: usize,
        mut take: impl FnMut(usize, [u8; N]) -> Result<(), String>,
    ) -> Result<(), String> {
        const PIECE: usize = 1 << 16;
        let mut buffer = vec![0; PIECE.min(count.max(1)) * N];
        let mut index = 0;
        while index < count {
            let some = (count - index).min(PIECE);
            let bytes = &mut buffer[..some * N];
            self.fill(bytes)?;
            for number in bytes.as_chunks::<N>().0 {
                take(index, *number)?;
                index += 1;
            }
        }
        Ok(())
    }
}
