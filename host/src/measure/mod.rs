//! How far two pictures are apart, in f64: numbers in, numbers out.
//!
//! Of the host it names the colour space alone (`tone`); it reads no files, renders nothing and prints nothing.

pub mod agreement;
pub mod compare;
pub mod student;
