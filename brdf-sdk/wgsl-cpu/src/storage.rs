//! What a program reads and writes: buffers of 32-bit words, and textures.
//!
//! Words go by their index; how a struct lies in them is the caller's to know. Resources outlive the run, and are
//! read back by who made them.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// A buffer that a program may write. Invocations run on several threads, so its words are atomic;
/// beside each word stands the f64 that a program of higher precision stored there.
#[derive(Debug, Default)]
pub struct Storage {
    pub(crate) words: Vec<AtomicU32>,
    /// As long as `words`, or empty where only f32 is asked for.
    pub(crate) wide: Vec<AtomicU64>,
}

impl Storage {
    /// A buffer of `words` zeros; `wide` where f64 or shadow programs shall keep their digits in it.
    pub fn new(words: usize, wide: bool) -> Self {
        Self {
            words: (0..words).map(|_| AtomicU32::new(0)).collect(),
            wide: (0..if wide { words } else { 0 }).map(|_| AtomicU64::new(0)).collect(),
        }
    }

    /// How many 32-bit words it has.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Replaces the first words; what is beyond the end is dropped.
    pub fn write(&mut self, words: &[u32]) {
        for (target, word) in self.words.iter_mut().zip(words) {
            *target.get_mut() = *word;
        }
        for (target, word) in self.wide.iter_mut().zip(words) {
            *target.get_mut() = f64::from(f32::from_bits(*word)).to_bits();
        }
    }

    /// The first words as they stand now, as many as there are of `count`.
    pub fn words(&self, count: usize) -> Vec<u32> {
        self.words[..count.min(self.words.len())].iter().map(|word| word.load(Relaxed)).collect()
    }

    /// The first floats with all the digits that the program stored, as many as there are of `count`.
    pub fn floats(&self, count: usize) -> Vec<f64> {
        (0..count.min(self.words.len())).filter_map(|index| self.float(index)).collect()
    }

    /// A word as it stands now.
    pub fn word(&self, index: usize) -> Option<u32> {
        self.words.get(index).map(|word| word.load(Relaxed))
    }

    /// A float with all the digits that the program stored.
    pub fn float(&self, index: usize) -> Option<f64> {
        match self.wide.get(index) {
            Some(wide) => Some(f64::from_bits(wide.load(Relaxed))),
            None => self.word(index).map(|word| f64::from(f32::from_bits(word))),
        }
    }
}

/// What stands behind a binding.
#[derive(Debug, Clone, Copy)]
pub enum Resource<'a> {
    /// A uniform or read-only storage buffer.
    Words(&'a [u32]),
    /// A storage buffer that the program may write.
    Storage(&'a Storage),
    /// A `texture_2d<f32>` with one level, row by row from the top, or a `texture_2d<u32>` of the floats' bits.
    Texture {
        /// Width and height.
        size: [u32; 2],
        /// Width x height texels.
        texels: &'a [[f32; 4]],
    },
}
