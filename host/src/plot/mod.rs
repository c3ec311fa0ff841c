//! What plots of BRDFs show: values along a line of directions ([`lines`]), over both angles of half and difference
//! ([`slice`]), and over the hemisphere ([`hemisphere`]); [`shown`] asks for what a view needs. Numbers in, numbers
//! out: drawings are `figure`'s.
//!
//! Everywhere light comes from `wi` at given angles, and `wo` is what moves, or both move with the half vector.

mod digits;
pub mod hemisphere;
pub mod lines;
mod rows;
mod settings;
mod shown;
pub mod slice;
pub mod trace;

use std::sync::Arc;

use brdf_sdk::Result;
use brdf_sdk::native::directions::direction;

pub use digits::{angle, digits};
pub use rows::rows;
pub use settings::{Channels, Settings, View};
pub use shown::{Named, Plot, Series, shown, told_apart};

use crate::exec::Executor;
use crate::link::{View as Program, link};
use crate::plugin::Configured;
use crate::render::evaluate::{Pair, Scattered, evaluate_rows};
use crate::render::rows::Rows;
use crate::tone::luminance;

/// A direction by its angles [degrees].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angles {
    /// From the normal; on the other side of it where it is negative.
    pub theta: f64,
    /// From the tangent.
    pub phi: f64,
}

impl Angles {
    /// The unit direction, in f64.
    pub fn direction(&self) -> [f64; 3] {
        direction(self.theta.to_radians(), self.phi.to_radians())
    }
}

/// One number of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// The first one.
    Red,
    /// The second one.
    Green,
    /// The third one.
    Blue,
    /// Rec. 709's.
    Luminance,
}

impl Channel {
    /// The number.
    pub fn of(self, rgb: [f64; 3]) -> f64 {
        match self {
            Self::Red => rgb[0],
            Self::Green => rgb[1],
            Self::Blue => rgb[2],
            Self::Luminance => luminance(rgb),
        }
    }
}

/// What is plotted: f, or f times the cosine of `wi`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    /// The number of its colour.
    pub channel: Channel,
    /// Whether f is multiplied by the cosine of `wi`.
    pub cosine: bool,
}

impl Quantity {
    fn of(self, pair: &Pair, found: &Scattered) -> f64 {
        let cosine = if self.cosine { f64::from(pair.wi[2]).max(0.0) } else { 1.0 };
        self.channel.of(found.f) * cosine
    }
}

/// A BRDF on a device, ready to be asked for values; how it would be sampled is not told, for nothing is.
pub struct Subject<'a> {
    brdf: &'a Configured,
    executor: &'a mut dyn Executor,
    rows: Rows,
}

impl<'a> Subject<'a> {
    /// Links and compiles it.
    ///
    /// # Errors
    /// What is wrong with the plugin.
    pub fn new(executor: &'a mut dyn Executor, brdf: &'a Configured) -> Result<Self> {
        let program = Arc::new(link(&Program::Eval { brdf: brdf.clone() })?);
        let rows = Rows::new(executor, program)?;
        Ok(Self { brdf, executor, rows })
    }

    /// The quantity at each pair; NaN where a direction lies below the horizon.
    ///
    /// # Errors
    /// What the plugin does that ends a program.
    pub fn values(&mut self, quantity: Quantity, pairs: &[Pair]) -> Result<Vec<f64>> {
        let found = self.scattered(pairs)?;
        let value = |(pair, found): (&Pair, &Scattered)| match pair.is_above_horizon() {
            true => quantity.of(pair, found),
            false => f64::NAN,
        };
        Ok(pairs.iter().zip(&found).map(value).collect())
    }

    pub(crate) fn scattered(&mut self, pairs: &[Pair]) -> Result<Vec<Scattered>> {
        evaluate_rows(self.executor, &mut self.rows, self.brdf, pairs)
    }

    /// Leaves the device.
    pub fn free(self) {
        self.rows.free(self.executor);
    }
}
