// The sum over the environment's texels, each integrated by itself.
//
// In a texel the radiance is constant (or bilinear in each quarter) and the BRDF may still vary: a node is
// the texel or a quarter of a quarter of it. Four Gauss points give its value, its middle the doubt.

/// Quarters of quarters at the most.
const DEEPEST: u32 = 12u;

/// Directions of the BRDF's own samples whose lobe is narrow against a texel.
struct Prepared {
    count: u32,
    /// World direction; `w`: nodes of a smaller solid angle resolve the lobe there.
    peaks: array<vec4f, 8>,
}

/// Where to look closer whatever a node's few points say: lobes may be far smaller than a texel.
fn prepare(q: Settings, hit: Hit) -> Prepared {
    var prepared: Prepared;
    if QUADRATURE == QUADRATURE_CENTRE {
        return prepared;
    }
    let largest = env_largest_cell();
    for (var i = 0u; i < 8u; i++) {
        // Points of the golden ratio and its powers (Roberts 2018).
        let u = fract(vec3f(0.5) + f32(i) * vec3f(0.8191725, 0.6710436, 0.5497005));
        let drawn = brdf_sample(hit.wo, u);
        let resolving = 0.05 / drawn.pdf;
        if drawn.pdf > 0.0 && resolving < largest {
            prepared.peaks[prepared.count] = vec4f(to_world(hit, drawn.wi), resolving);
            prepared.count += 1u;
        }
    }
    return prepared;
}

/// Whether a node about `dir` must be cut for a narrow lobe: it is not small against it and not
/// farther from its peak than three of its widths.
fn holds_peak(prepared: ptr<function, Prepared>, dir: vec3f, radius: f32, solid_angle: f32) -> bool {
    var holds = false;
    for (var i = 0u; i < (*prepared).count; i++) {
        let peak = (*prepared).peaks[i];
        let away = dir - peak.xyz;
        let reach = radius + 3.0 * sqrt(20.0 * peak.w * INV_PI);
        holds = holds || (solid_angle > peak.w && dot(away, away) < reach * reach);
    }
    return holds;
}

/// The integrand at a place of the cell, per unit of the cell's area.
fn integrand(hit: Hit, cell: EnvCell, at: vec2f) -> vec3f {
    let light = env_cell_light(cell, at);
    return brdf_cos(hit.wo, to_local(hit, light.dir)) * light.radiance * light.solid_angle;
}

/// Every second bit, from the lowest.
fn even_bits(x: u32) -> u32 {
    var y = x & 0x55555555u;
    y = (y | (y >> 1u)) & 0x33333333u;
    y = (y | (y >> 2u)) & 0x0f0f0f0fu;
    y = (y | (y >> 4u)) & 0x00ff00ffu;
    return (y | (y >> 8u)) & 0x0000ffffu;
}

fn mean_of(v: vec3f) -> f32 {
    return (v.x + v.y + v.z) / 3.0;
}

fn term(q: Settings, hit: Hit, k: u32, sum: ptr<function, Quadrature>, prepared: ptr<function, Prepared>) -> vec3f {
    let cell = env_cell(k);
    let middle = to_local(hit, cell.dir);
    if cone_is_below_horizon(middle, cell.radius) {
        return vec3f(0.0);
    }
    if QUADRATURE == QUADRATURE_CENTRE {
        (*sum).evaluations += 1u;
        return integrand(hit, cell, vec2f(0.5));
    }
    var first_depth = 0u;
    if ENV_LINEAR {
        // Bilinear radiance has its creases along the texel's middle lines.
        first_depth = 1u;
    }
    // The node of this depth, two bits a level; none before the texel's first call.
    let depth = max((*sum).depth, first_depth);
    let node = (*sum).node;
    let width = exp2(-f32(depth));
    let corner = vec2f(f32(even_bits(node)), f32(even_bits(node >> 1u))) * width;
    let area = width * width;
    let light = env_cell_light(cell, corner + 0.5 * width);
    let local = to_local(hit, light.dir);
    let at_middle = brdf_cos(hit.wo, local) * light.radiance * (light.solid_angle * area);
    // Gauss points of two a side: (1 -+ 1 / sqrt(3)) / 2.
    let near = corner + 0.21132487 * width;
    let far = corner + 0.78867513 * width;
    var value = integrand(hit, cell, near) + integrand(hit, cell, far);
    value += integrand(hit, cell, vec2f(near.x, far.y)) + integrand(hit, cell, vec2f(far.x, near.y));
    value *= 0.25 * area;
    (*sum).evaluations += 5u;

    // The middle's error goes with the second derivatives, that of four points with the fourth:
    // about the square of the former where the integrand is smooth.
    let size = mean_of(value);
    let difference = mean_of(abs(value - at_middle));
    var error = min(difference, 4.0 * difference * difference / max(abs(size), 1e-37));
    let radius = cell.radius * width;
    var held = size;
    var share = light.solid_angle * area;
    if cone_meets_horizon(local, radius) {
        error = difference;
        // Such nodes lie along a line of length 2 pi; theirs is a share of that.
        share = radius;
        if size == 0.0 {
            // All points may lie below the horizon and a corner or an edge of the node above it, which they
            // cannot tell. That part is at most 0.21 of the node, on average half as high as it reaches,
            // and the node's radius is larger than it: an eighth is more than it can hold.
            let highest = normalize(vec3f(local.xy, max(local.z + radius, 1e-6)));
            let most = brdf_cos(hit.wo, highest) * light.radiance * (light.solid_angle * area);
            held = mean_of(most);
            error = max(error, 0.125 * held);
            (*sum).evaluations += 1u;
        }
    }
    // Half of the tolerance by a node's own value, or by its part of the line where the horizon cuts the
    // texel; half by its share of the hemisphere, or of the horizon.
    (*sum).whole = max((*sum).whole, held);
    let fair = max(size, (*sum).whole * width) + (*sum).so_far * share * INV_TWO_PI;
    let resolved = error <= 0.5 * q.tolerance * fair
        && !holds_peak(prepared, light.dir, radius, light.solid_angle * area);
    if !resolved && depth < DEEPEST {
        (*sum).node = node << 2u;
        (*sum).depth = depth + 1u;
        (*sum).more = true;
        return vec3f(0.0);
    }
    (*sum).error += error;
    // Up as long as this was the last of four.
    let up = min(countTrailingZeros(node + 1u) >> 1u, depth - first_depth);
    (*sum).node = (node + 1u) >> (2u * up);
    (*sum).depth = depth - up;
    (*sum).more = (*sum).depth > first_depth || (*sum).node < 1u << (2u * first_depth);
    return value;
}
