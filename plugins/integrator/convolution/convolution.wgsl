// The sum over the environment's texels, each integrated by itself.
//
// In a texel the radiance is constant (or bilinear in each quarter) and the BRDF may still vary: a node is
// the texel or a quarter of a quarter of it. Four Gauss points, two in each of two columns, give its
// value, its middle the doubt. Where the horizon cuts the node its columns end there, so that no
// point lies on the other side of the kink.

/// Quarters of quarters at the most.
const DEEPEST: u32 = 12u;

/// Gauss points of two on [0, 1]: (1 -+ 1 / sqrt(3)) / 2; the outer ones of three: (1 -+ sqrt(3 / 5)) / 2.
const TWO_LOW: f32 = 0.21132487;
const TWO_HIGH: f32 = 0.78867513;
const THREE_LOW: f32 = 0.11270167;
const THREE_HIGH: f32 = 0.88729833;

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

/// How the horizon cuts a node: not at all, its columns, its rows, or so that neither vary smoothly.
const WHOLE: u32 = 0u;
const COLUMNS: u32 = 1u;
const ROWS: u32 = 2u;
const KINKED: u32 = 3u;

/// A line across a node, as far as it lies above the horizon.
struct Line {
    start: vec2f,
    length: f32,
    is_row: bool,
    /// 1 and 2 where the horizon cuts its beginning and its end, 4 where nothing is left, 8 where it takes
    /// a piece from the middle and the shorter end is missing here.
    cut: u32,
}

/// The line at `at`, in parts of the width, of a node.
fn line(hit: Hit, cell: EnvCell, corner: vec2f, width: f32, at: f32, cut: u32) -> Line {
    let is_row = cut == ROWS;
    let across = select(corner.x, corner.y, is_row) + at * width;
    let low = select(corner.y, corner.x, is_row);
    var piece = vec2f(low, low + width);
    var state = 0u;
    if cut != WHOLE {
        let above = env_cell_above(cell, across, is_row, to_world(hit, vec3f(0.0, 0.0, 1.0)));
        if above.x <= above.y {
            piece = vec2f(max(low, above.x), min(low + width, above.y));
        } else {
            let before = vec2f(low, min(low + width, above.y));
            let after = vec2f(max(low, above.x), low + width);
            piece = select(after, before, before.y - before.x >= after.y - after.x);
            if before.y > before.x && after.y > after.x {
                state = 8u;
            }
        }
        if piece.y <= piece.x {
            piece = vec2f(low);
            state = 4u;
        } else {
            state |= select(0u, 1u, piece.x > low) | select(0u, 2u, piece.y < low + width);
        }
    }
    return Line(select(vec2f(across, piece.x), vec2f(piece.x, across), is_row), piece.y - piece.x, is_row, state);
}

/// Whether the horizon cuts a node's columns, or rows, all in the same way, and passes through no
/// side that it would not pass through then.
fn is_smooth(hit: Hit, cell: EnvCell, corner: vec2f, width: f32, cut: u32) -> bool {
    let state = line(hit, cell, corner, width, 0.5, cut).cut;
    let other = ROWS + COLUMNS - cut;
    let first = line(hit, cell, corner, width, 0.0, other).cut;
    let last = line(hit, cell, corner, width, 1.0, other).cut;
    return state < 8u && first == select(state & 4u, 4u, (state & 1u) != 0u)
        && last == select(state & 4u, 4u, (state & 2u) != 0u)
        && line(hit, cell, corner, width, 0.0, cut).cut == state
        && line(hit, cell, corner, width, TWO_LOW, cut).cut == state
        && line(hit, cell, corner, width, TWO_HIGH, cut).cut == state
        && line(hit, cell, corner, width, 1.0, cut).cut == state;
}

/// A part of the line's integral: its length times the integrand at `at` of it.
fn along(hit: Hit, cell: EnvCell, line: Line, at: f32) -> vec3f {
    if line.length == 0.0 {
        return vec3f(0.0);
    }
    let way = select(vec2f(0.0, at), vec2f(at, 0.0), line.is_row);
    return line.length * integrand(hit, cell, line.start + line.length * way);
}

/// A line's integral by three Gauss points.
fn three_along(hit: Hit, cell: EnvCell, line: Line) -> vec3f {
    let outer = along(hit, cell, line, THREE_LOW) + along(hit, cell, line, THREE_HIGH);
    return (5.0 * outer + 8.0 * along(hit, cell, line, 0.5)) / 18.0;
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

/// The largest relative difference of a channel.
fn doubt_of(value: vec3f, other: vec3f) -> f32 {
    let relative = select(vec3f(0.0), abs(value - other) / value, value > vec3f(0.0));
    return max(relative.x, max(relative.y, relative.z));
}

/// f cos at the azimuth of `about`, a local direction, and the height z.
fn at_height(hit: Hit, about: vec3f, z: f32) -> vec3f {
    return brdf_cos(hit.wo, vec3f(about.xy * sqrt((1.0 - z * z) / max(dot(about.xy, about.xy), 1e-12)), z));
}

/// How far two Gauss points are off, relative, over f cos from the horizon to a height. Shadowing may
/// happen in a layer far thinner than a node: four points that crowd there, z = height t^3, see it.
fn shadowing(hit: Hit, about: vec3f, height: f32) -> f32 {
    let two = at_height(hit, about, TWO_LOW * height) + at_height(hit, about, TWO_HIGH * height);
    // Gauss points and weights of four, the weights times 3 t^2.
    let four = 0.0025153980 * at_height(hit, about, 0.00033471571 * height)
        + 0.10653403 * at_height(hit, about, 0.035940097 * height)
        + 0.43910952 * at_height(hit, about, 0.30075024 * height)
        + 0.45184106 * at_height(hit, about, 0.80583209 * height);
    return doubt_of(four, 0.5 * two);
}

fn term(q: Settings, hit: Hit, k: u32, sum: ptr<function, Quadrature>, prepared: ptr<function, Prepared>) -> vec3f {
    let cell = env_cell(k);
    let middle = to_local(hit, cell.dir);
    if cone_is_below_horizon(middle, cell.radius) {
        return vec3f(0.0);
    }
    if QUADRATURE == QUADRATURE_CENTRE {
        (*sum).evaluations += 1u;
        return brdf_cos(hit.wo, middle) * env_cell_light(cell, vec2f(0.5)).radiance * cell.solid_angle;
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
    let centre = env_cell_light(cell, corner + 0.5 * width);
    let local = to_local(hit, centre.dir);
    let radius = cell.radius * width;
    var cut = WHOLE;
    let meets_horizon = cone_meets_horizon(local, radius);
    if meets_horizon {
        cut = COLUMNS;
        if !is_smooth(hit, cell, corner, width, COLUMNS) {
            cut = select(KINKED, ROWS, is_smooth(hit, cell, corner, width, ROWS));
        }
    }
    let near = line(hit, cell, corner, width, TWO_LOW, cut);
    let half_way = line(hit, cell, corner, width, 0.5, cut);
    let far = line(hit, cell, corner, width, TWO_HIGH, cut);
    let at_middle = along(hit, cell, half_way, 0.5) * width;
    let near_low = along(hit, cell, near, TWO_LOW);
    let near_high = along(hit, cell, near, TWO_HIGH);
    let far_low = along(hit, cell, far, TWO_LOW);
    let far_high = along(hit, cell, far, TWO_HIGH);
    let falling = (near_low + far_high) * (0.5 * width);
    var value = 0.5 * falling + (near_high + far_low) * (0.25 * width);
    (*sum).evaluations += 5u;

    // The middle's error goes with the second derivatives, that of four points with the fourth:
    // about the square of the former where the integrand is smooth. The worst channel counts. So do the
    // two diagonals, and the square of the slopes: by chance the one agrees, hardly all.
    let size = mean_of(value);
    let slopes = max(abs(near_low + near_high - far_low - far_high), abs(near_low + far_low - near_high - far_high));
    let slope = mean_of(slopes) * 0.25 * width;
    var doubt = max(doubt_of(value, at_middle), doubt_of(value, falling));
    if size > 0.0 {
        doubt = max(doubt, 0.25 * (slope / size) * (slope / size));
    }
    var error = 4.0 * size * doubt * min(doubt, 0.25);
    // A node may be off by a part of the tolerance of its own value, of its share of the hemisphere, and of
    // one node's share of all of them. Most are far better than that, each cut gains a factor of eight or
    // more, so the sum stays below the tolerance.
    let solid_angle = centre.solid_angle * area;
    let node_share = 1.0 / (f32(env_cells()) + 4096.0);
    var fair = size + (*sum).so_far * (solid_angle * INV_TWO_PI + node_share);
    (*sum).whole = max((*sum).whole, size);
    let forced = holds_peak(prepared, centre.dir, radius, solid_angle);
    if cut == KINKED {
        // The horizon passes through a corner: two columns are no better than one. What they may miss
        // shows at the edges (Simpson's rule).
        let left = line(hit, cell, corner, width, 0.0, COLUMNS);
        let right = line(hit, cell, corner, width, 1.0, COLUMNS);
        let edges = (along(hit, cell, left, 0.5) + along(hit, cell, right, 0.5)) * width;
        let other = (edges + 4.0 * at_middle) / 6.0;
        error = 2.0 * max(size * max(doubt, doubt_of(value, other)), abs(mean_of(other) - size));
        (*sum).evaluations += 2u;
        if size == 0.0 {
            // Nor do columns see where it bends into the node between them; the sides do.
            let top = line(hit, cell, corner, width, 0.0, ROWS);
            let bottom = line(hit, cell, corner, width, 1.0, ROWS);
            error += 0.1 * mean_of(along(hit, cell, top, 0.5) + along(hit, cell, bottom, 0.5)) * width;
            (*sum).evaluations += 2u;
        }
        // Such nodes are few: each may be off by a part of the texel, and of the horizon's texels.
        fair += 0.1 * (*sum).whole + 0.2 * (*sum).so_far * sqrt(cell.solid_angle) * INV_TWO_PI;
    }
    let allowed = 0.25 * q.tolerance * fair;
    if error > allowed && cut != KINKED && !forced {
        let first = line(hit, cell, corner, width, THREE_LOW, cut);
        let last = line(hit, cell, corner, width, THREE_HIGH, cut);
        let sides = (three_along(hit, cell, first) + three_along(hit, cell, last)) * width;
        let between = along(hit, cell, half_way, THREE_LOW) + along(hit, cell, half_way, THREE_HIGH);
        let better = (5.0 * sides + 8.0 * (5.0 * between * width + 8.0 * at_middle) / 18.0) / 18.0;
        (*sum).evaluations += 8u;
        error = mean_of(better) * doubt_of(better, value);
        value = better;
    }
    if error <= allowed && meets_horizon && size > 0.0 {
        error += size * shadowing(hit, local, min(2.0 * radius, 1.0));
        (*sum).evaluations += 6u;
    }
    let resolved = error <= allowed && !forced;
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
