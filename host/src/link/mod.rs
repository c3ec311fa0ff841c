//! Plugins and the host's shaders become one WGSL program, or one problem in the author's own file.
//!
//! `link` is a pure function: no files, no devices, no clock. It concatenates text, prefixes each
//! plugin's own names, parses and validates with naga, decides branches on constants, bounds the
//! plugins' loops and drops what nothing reaches. Both executors run the module that comes out.
//!
//! It may name brdf-sdk, naga, `plugin`, and of `native` how arrays lie in buffers; it knows nothing of how a program
//! is run.

mod alone;
mod arrays;
mod budget;
mod constants;
mod declarations;
mod fold;
mod form;
mod function;
mod generated;
mod layout;
mod left_out;
mod messages;
mod program;
mod purity;
mod sampling;
mod shader;
mod signatures;
mod source_map;
mod text;
mod tokens;
mod view;

use brdf_sdk::{Problem, Result};
use naga::compact::{KeepUnused, compact};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

pub use budget::{LOOP_ITERATIONS, endless_loop};
pub use form::{Form, Sampler, Sum};
pub use function::{Function, functions, unused_parameters};
pub use layout::{Binding, BindingKind, StructLayout};
pub use program::{Origin, Program};
pub use sampling::{Sampling, sampling};
pub use view::View;

use declarations::Cut;
use source_map::SourceMap;
use text::Text;

/// Links one program.
///
/// # Errors
/// The first problem, in the author's file where an author can mend it.
pub fn link(view: &View) -> Result<Program> {
    // naga recurses along expressions; its stack is sized for the longest text that is let in.
    const STACK: usize = 512 << 20;
    std::thread::scope(|scope| {
        let linking =
            std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || link_here(view));
        match linking.map(|thread| thread.join()) {
            Ok(Ok(linked)) => linked,
            Ok(Err(_)) => Err(Problem::new(
                "the linker",
                "the shader compiler failed on this program",
                "simplify the plugin's last change, and report the text that causes this",
            )),
            Err(error) => {
                Err(Problem::new("the linker", error.to_string(), "free memory and try again"))
            }
        }
    })
}

fn link_here(view: &View) -> Result<Program> {
    let Text { map, prefixes, sampling, arrays, sum, compensated, notes } = Text::of(view)?;
    let mut module = parse_and_validate(&map)?;
    fold::fold_constant_branches(&mut module);
    let has_loops = budget::bound_loops(&mut module, &prefixes);
    compact(&mut module, KeepUnused::No);
    validate(&module, &map)?;
    let cut = Cut::unbounded("the linked program", &map.text)?;
    Ok(Program {
        bindings: layout::bindings(&module),
        reached: left_out::reached(&map.text, &cut, &module),
        module,
        sampling,
        arrays,
        sum,
        compensated,
        has_loops,
        notes,
        map,
    })
}

fn parse_and_validate(map: &SourceMap) -> Result<naga::Module> {
    let module = naga::front::wgsl::parse_str(&map.text)
        .map_err(|error| messages::parse_problem(map, &error))?;
    validate(&module, map)?;
    Ok(module)
}

fn validate(module: &naga::Module, map: &SourceMap) -> Result<ModuleInfo> {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map_err(|error| messages::validation_problem(map, &error))
}
