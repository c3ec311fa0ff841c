//! The oracle: what a pixel must be, by deterministic f64 quadrature, in code of its own.
//!
//! [`Oracle::new`] takes a map and a filter, [`Oracle::radiance`] gives the light that leaves one
//! shading point, with the error that it claims. Nothing here calls the host's estimators, its
//! shaders or its notion of a map: directions, filters and BRDFs are written down again from their
//! definitions, so that one mistake is not made on both sides. `tests/oracle` shows by closed
//! forms and by other quadratures that the oracle is right.
//!
//! | file | idea |
//! |---|---|
//! | `map` | texels on the sphere; radiance of a direction, by definition |
//! | `cells` | the sphere cut into pieces on which radiance is bilinear |
//! | `horizon` | a piece cut along the horizon into pieces without a kink |
//! | `models` | the BRDFs, from their papers |
//! | `cubature` | an integral over a rectangle with an estimate of its error |
//! | `quadrature` | the light that leaves a point |

#![allow(dead_code, reason = "each test target uses its own part of this")]

pub mod cells;
pub mod cubature;
pub mod horizon;
pub mod map;
pub mod models;
pub mod quadrature;

pub use map::{Filter, Layout, Map};
pub use models::Model;
pub use quadrature::{Oracle, Point};
