// The kernel behind expected values: integrals over rectangles of (theta, phi) by two rules of Gauss, the
// difference of which tells the error. It runs in f64.

/// A rectangle of directions about the normal [radians], and what it is seen from.
struct Cell {
    /// A unit vector in f32, and what it is short of one in f64: at grazing angles |wo + wi|^2 shows it.
    wo: vec3f,
    wo_rest: vec3f,
    /// The azimuth at which phi is 0, in two parts.
    zero: vec2f,
    low: vec2f,
    high: vec2f,
}

/// Integrals over solid angle.
struct Integral {
    /// Of the density.
    pdf: f32,
    /// Of f cos: light that leaves towards `wo` in a furnace.
    light: vec3f,
    /// Of (f cos)^2 / pdf: second moment of the weights.
    own: vec3f,
    /// The same for draws by the cosine.
    cosine: vec3f,
    /// The same for draws by solid angle.
    uniform: vec3f,
    /// How far the smaller rule is from the larger one, in `pdf` and in `light`.
    pdf_error: f32,
    light_error: vec3f,
    /// The largest density that the larger rule met [1/sr].
    peak: f32,
}

/// What both rules add up.
struct Sums {
    pdf: f32,
    light: vec3f,
    own: vec3f,
    cosine: vec3f,
    uniform: vec3f,
    peak: f32,
}

/// Places and weights on [-1, 1], each in two parts so that f64 has all digits: first those of the
/// larger rule.
@group(0) @binding(4) var<storage, read> nodes: array<vec4f>;
@group(0) @binding(5) var<storage, read> cells: array<Cell>;
@group(0) @binding(6) var<storage, read_write> integrals: array<Integral>;

const LARGE: u32 = 8u;
const SMALL: u32 = 5u;

fn over_rule(cell: Cell, first: u32, count: u32) -> Sums {
    let middle = 0.5 * (cell.low + cell.high);
    let reach = 0.5 * (cell.high - cell.low);
    let wo = cell.wo + cell.wo_rest;
    var sums = Sums(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0);
    for (var i = 0u; i < count; i++) {
        let row = nodes[first + i];
        let theta = middle.x + reach.x * (row.x + row.y);
        let sine = sin(theta);
        let height = cos(theta);
        for (var j = 0u; j < count; j++) {
            let column = nodes[first + j];
            let phi = cell.zero.x + (cell.zero.y + middle.y + reach.y * (column.x + column.y));
            let wi = vec3f(sine * cos(phi), sine * sin(phi), height);
            let area = (row.z + row.w) * (column.z + column.w) * sine;
            let at = brdf_at(wo, wi);
            let light = at.cos;
            let pdf = at.pdf;
            sums.peak = max(sums.peak, pdf);
            sums.pdf += area * pdf;
            sums.light += area * light;
            sums.uniform += area * (light * light * TWO_PI);
            if pdf > 0.0 {
                sums.own += area * (light * light / pdf);
            }
            if above_horizon(wo, wi) {
                sums.cosine += area * (light * light / cosine_pdf(wi));
            }
        }
    }
    let scale = reach.x * reach.y;
    return Sums(
        sums.pdf * scale, sums.light * scale, sums.own * scale, sums.cosine * scale, sums.uniform * scale,
        sums.peak,
    );
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&integrals) {
        return;
    }
    let cell = cells[i];
    let large = over_rule(cell, 0u, LARGE);
    let small = over_rule(cell, LARGE, SMALL);
    integrals[i] = Integral(
        large.pdf, large.light, large.own, large.cosine, large.uniform,
        abs(large.pdf - small.pdf), abs(large.light - small.light), large.peak,
    );
}
