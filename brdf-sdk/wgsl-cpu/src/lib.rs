//! Runs the compute entry point of a validated naga module on plain threads: no GPU, no driver.
//!
//! The module is lowered once to a flat program over registers that hold a value for each of many
//! lanes; each instruction then works on a whole batch of invocations in a loop that the compiler
//! turned into vectors. In f32 the results are a GPU's within rounding, in f64 they are an oracle for
//! the same text, and with both side by side ([`Program::errors`]) they say where digits are lost.
//!
//! What is not covered is refused with its place ([`Refusal`]), never computed wrongly. Indices are
//! clamped, integer division by zero and shifts are as WGSL defines them, and a loop without an end
//! uses up a budget. The crate knows naga's tree and nothing of BRDFs.

mod flat;
mod lower;
mod machine;
mod op;
mod program;
mod prune;
mod refusal;
mod storage;

pub use machine::{Site, Stopped, VectorSet};
pub use program::{Failure, Precision, Program, Run};
pub use refusal::Refusal;
pub use storage::{Resource, Storage};
