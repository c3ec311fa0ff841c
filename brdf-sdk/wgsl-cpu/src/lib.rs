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
//!
//! ```
//! use naga::valid::{Capabilities, ValidationFlags, Validator};
//! use wgsl_cpu::{Precision, Program, Resource, Run, Storage};
//!
//! let module = naga::front::wgsl::parse_str(
//!     "@group(0) @binding(0) var<storage, read_write> roots: array<f32>;
//!      @compute @workgroup_size(64)
//!      fn main(@builtin(global_invocation_id) id: vec3u) {
//!          if id.x < arrayLength(&roots) { roots[id.x] = sqrt(f32(id.x)); }
//!      }",
//! )?;
//! let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)?;
//! let program = Program::new(&module, &info)?;
//! let roots = Storage::new(3, true);
//! let binding = naga::ResourceBinding { group: 0, binding: 0 };
//! let resources = [(binding, Resource::Storage(&roots))];
//! let run = Run { resources: &resources, groups: [1; 3], fuel: 1000, set: None, lanes: None };
//! program.run(Precision::F64, &run)?;
//! assert_eq!(roots.float(2), Some(2f64.sqrt()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod flat;
mod fuse;
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
