//! A picture on its way to the screen, and what is known of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::picture::Picture;
use crate::render::Estimate;
use crate::session::Session;

/// A number that was not given before, whichever thread asks: whoever keeps what was made of a picture knows by it
/// whether this is another one.
pub fn fresh_number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// A picture and its figures.
#[derive(Debug, Clone)]
pub struct Frame {
    /// No other picture has it.
    pub number: u64,
    /// Linear radiance.
    pub picture: Picture,
    /// What it shows; its plugins may be older than those ordered, where these do not work.
    pub session: Arc<Session>,
    /// Whether it was made small and quickly, to be replaced at once.
    pub preview: bool,
    /// Samples of a pixel so far and in all; of a sum its texels.
    pub done: u64,
    /// All there are.
    pub of: u64,
    /// Whether it is a sum over texels.
    pub sum: bool,
    /// Time of rendering [s].
    pub seconds: f64,
    /// Million samples, or texels, of all pixels in a second.
    pub rate: f64,
    /// Samples that were Inf or NaN.
    pub nonfinite: u64,
    /// The error where the samples had last doubled.
    pub estimate: Option<Estimate>,
    /// Estimated relMSE where the samples had doubled: samples of a pixel, time [s], relMSE.
    pub convergence: Vec<[f64; 3]>,
    /// Whether nothing is left to do.
    pub complete: bool,
}

/// How long a program took, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Linking and validating.
    pub link: f64,
    /// The device's compiler, and what the program reads brought there.
    pub compile: f64,
    /// From the order to the first picture; from the file that was saved, where it follows one.
    pub first_pixel: f64,
    /// Whether it follows a file that was saved.
    pub saved: bool,
}
