//! The host's shaders, each under the name that messages give it. In which order they are linked, `text` and `form` say.

pub const PRELUDE: (&str, &str) =
    ("shaders/prelude.wgsl", include_str!("../../../shaders/prelude.wgsl"));
/// In the scope of every plugin, after `PRELUDE`.
pub const COSINE: (&str, &str) =
    ("shaders/cosine.wgsl", include_str!("../../../shaders/cosine.wgsl"));
/// Sampling by the tables of a native library.
pub const LOBES: (&str, &str) = ("shaders/lobes.wgsl", include_str!("../../../shaders/lobes.wgsl"));
pub const SCATTER: (&str, &str) =
    ("shaders/scatter.wgsl", include_str!("../../../shaders/scatter.wgsl"));
pub const LOOPS: (&str, &str) = ("shaders/loops.wgsl", include_str!("../../../shaders/loops.wgsl"));
pub const NUMBERS: (&str, &str) =
    ("shaders/sampler/numbers.wgsl", include_str!("../../../shaders/sampler/numbers.wgsl"));
pub const OWEN_SOBOL: (&str, &str) =
    ("shaders/sampler/owen_sobol.wgsl", include_str!("../../../shaders/sampler/owen_sobol.wgsl"));
pub const INDEPENDENT: (&str, &str) =
    ("shaders/sampler/independent.wgsl", include_str!("../../../shaders/sampler/independent.wgsl"));
pub const SETS: (&str, &str) =
    ("shaders/sampler/sets.wgsl", include_str!("../../../shaders/sampler/sets.wgsl"));
pub const MAP: (&str, &str) =
    ("shaders/environment/map.wgsl", include_str!("../../../shaders/environment/map.wgsl"));
pub const TABLE: (&str, &str) =
    ("shaders/environment/table.wgsl", include_str!("../../../shaders/environment/table.wgsl"));
pub const CELLS: (&str, &str) =
    ("shaders/environment/cells.wgsl", include_str!("../../../shaders/environment/cells.wgsl"));
/// What integrators may call, beside `SCATTER`.
pub const OF_INTEGRATORS: [(&str, &str); 8] =
    [LOOPS, NUMBERS, OWEN_SOBOL, SETS, MAP, TABLE, HIT, CELLS];
pub const TERMS: (&str, &str) = ("shaders/terms.wgsl", include_str!("../../../shaders/terms.wgsl"));
pub const HIT: (&str, &str) = ("shaders/hit.wgsl", include_str!("../../../shaders/hit.wgsl"));
pub const FILM: (&str, &str) = ("shaders/film.wgsl", include_str!("../../../shaders/film.wgsl"));
pub const BACKGROUND: (&str, &str) =
    ("shaders/views/background.wgsl", include_str!("../../../shaders/views/background.wgsl"));
pub const EVAL: (&str, &str) =
    ("shaders/views/eval.wgsl", include_str!("../../../shaders/views/eval.wgsl"));
pub const TABLE_FILL: (&str, &str) =
    ("shaders/table.wgsl", include_str!("../../../shaders/table.wgsl"));
pub const NUMERICS: (&str, &str) =
    ("shaders/views/numerics.wgsl", include_str!("../../../shaders/views/numerics.wgsl"));
pub const DRAWS: (&str, &str) =
    ("shaders/laws/draws.wgsl", include_str!("../../../shaders/laws/draws.wgsl"));
pub const CELLS_OF_LAWS: (&str, &str) =
    ("shaders/laws/cells.wgsl", include_str!("../../../shaders/laws/cells.wgsl"));
pub const LIGHT_DRAWS: (&str, &str) =
    ("shaders/laws/light_draws.wgsl", include_str!("../../../shaders/laws/light_draws.wgsl"));
pub const LIGHT_DENSITIES: (&str, &str) = (
    "shaders/laws/light_densities.wgsl",
    include_str!("../../../shaders/laws/light_densities.wgsl"),
);
