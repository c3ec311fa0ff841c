//! What was read back from a buffer, by byte offset.

/// 32-bit words, and the f64 behind each where the executor computed in f64.
#[derive(Debug, Clone, PartialEq)]
pub struct Readout {
    words: Vec<u32>,
    wide: Vec<f64>,
}

impl Readout {
    /// Words alone.
    pub fn new(words: Vec<u32>) -> Self {
        Self { words, wide: Vec::new() }
    }

    /// Words with the digits that do not fit them.
    pub(crate) fn with_wide(self, wide: Vec<f64>) -> Self {
        Self { wide, ..self }
    }

    /// The u32 at a byte offset.
    ///
    /// # Panics
    /// Beyond the end.
    pub fn word(&self, at: usize) -> u32 {
        self.words[at / 4]
    }

    /// The float at a byte offset, with all digits that there are.
    ///
    /// # Panics
    /// Beyond the end.
    pub fn float(&self, at: usize) -> f64 {
        match self.wide.get(at / 4) {
            Some(wide) => *wide,
            None => f64::from(f32::from_bits(self.words[at / 4])),
        }
    }
}
