//! Any text, read as a plugin's WGSL (see `brdf_fuzz::plugin`): linked for every view that a BRDF alone has, and run
//! on the CPU executor. It links or is refused in one line; what links gives the same bits in every vector set, in
//! batches of any size, and with f64 at its side.
#![no_main]

use brdf_fuzz::{panics, plugin, refused, rows};
use brdf_host::link::{View, functions, link};
use brdf_host::plugin::Configured;
use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    brdf_fuzz::mutate(data, size, max_size, seed)
});

fuzz_target!(init: panics::of_others_pass(), |data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    panics::caught(|| match plugin::read(text) {
        Err(problem) => refused(&problem),
        Ok(brdf) => check(&brdf),
    });
});

fn check(brdf: &Configured) {
    match link(&View::Eval { brdf: brdf.clone() }) {
        Ok(program) => rows::agree(&program, brdf),
        Err(problem) => return refused(&problem),
    }
    let (functions, _) =
        functions(brdf).unwrap_or_else(|problem| panic!("it links, but {problem}"));
    let tables = 0..brdf.plugin.manifest.tables.len();
    let views =
        functions.into_iter().map(|function| View::Numerics { brdf: brdf.clone(), function });
    let views = views.chain(tables.map(|table| View::Table { brdf: brdf.clone(), table }));
    let views =
        views.chain([View::Draws { brdf: brdf.clone() }, View::Cells { brdf: brdf.clone() }]);
    for problem in views.filter_map(|view| link(&view).err()) {
        refused(&problem);
    }
}
