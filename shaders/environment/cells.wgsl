// The map as a sum of cells: its texels, one after the other, and the places inside of them.

@group(0) @binding(10) var<storage, read> env_order: array<u32>;

/// One texel of the map as a part of the sphere.
struct EnvCell {
    texel: vec2u,
    /// Its middle, world frame.
    dir: vec3f,
    /// No direction in it is farther from `dir` than this, as a chord.
    radius: f32,
    /// [sr]; of a cube's texel as at its middle.
    solid_angle: f32,
}

/// A place in a cell: what arrives from there, and the solid angle [sr] that the cell would have if all of
/// it were like this place.
struct EnvCellLight {
    dir: vec3f,
    radiance: vec3f,
    solid_angle: f32,
}

/// A sum over texels, as far as it has come. `term` may take a texel in several calls: while it sets
/// `more`, it is called again for the same texel and finds here what it left.
struct Quadrature {
    /// All terms so far, the mean of their channels: a lower bound of the whole where none is negative.
    so_far: f32,
    /// A term adds its estimated error here, the mean of the channels.
    error: f32,
    /// A term adds here how often it evaluated the integrand.
    evaluations: u32,
    /// For the term's own use; zero at its first call.
    node: u32,
    depth: u32,
    whole: f32,
    /// Whether the term needs another call.
    more: bool,
}

/// The cell of rank `k`, below `env_cells()`, in the order that the host chose.
fn env_cell(k: u32) -> EnvCell {
    let index = env_order[k];
    let size = environment.size;
    let texel = vec2u(index % size.x, index / size.x);
    var cell = EnvCell(texel, vec3f(0.0), 1.4142136 / f32(size.x), 0.0);
    let middle = env_cell_light(cell, vec2f(0.5));
    cell.dir = middle.dir;
    cell.solid_angle = middle.solid_angle;
    if !ENV_CUBE {
        let half = 0.5 * PI / f32(size.y);
        let at_middle = sin(half * f32(2u * texel.y + 1u));
        cell.radius = half + PI / f32(size.x) * min(at_middle + half, 1.0);
        // The mean of the sine over the row.
        cell.solid_angle *= sin(half) / half;
    }
    return cell;
}

/// The light at a place of a cell; `at` in [0, 1]^2 runs linearly in the map's own coordinates.
fn env_cell_light(cell: EnvCell, at: vec2f) -> EnvCellLight {
    let place = EnvPlace(cell.texel, at);
    let size = vec2f(environment.size);
    var d: vec3f;
    var solid_angle: f32;
    if ENV_CUBE {
        let st = env_face_coordinates(place);
        let square = 1.0 + dot(st, st);
        d = env_face_direction(cell.texel.y / environment.size.x, st) * inverseSqrt(square);
        solid_angle = 4.0 / (size.x * size.x * square * sqrt(square));
    } else {
        // The angle to the nearer pole, small where the sine is small.
        let south = 2u * cell.texel.y >= environment.size.y;
        let row = select(f32(cell.texel.y) + at.y, f32(environment.size.y - cell.texel.y) - at.y, south);
        let theta = PI * row / size.y;
        let phi = env_longitude(f32(cell.texel.x) + at.x);
        let sine = sin(theta);
        d = vec3f(sine * sin(phi), select(cos(theta), -cos(theta), south), sine * cos(phi));
        solid_angle = TWO_PI / size.x * (PI / size.y) * sine;
    }
    return EnvCellLight(d * environment.map_from_world, env_light_at(place).radiance, solid_angle);
}

/// Where a line through a cell lies above the horizon of `up`, a world direction: the column at `at`, or
/// the row if it is `level`. From `x` to `y` in the cell's other coordinate; where `x` is greater the
/// line is above up to `y` and from `x` on.
fn env_cell_above(cell: EnvCell, at: f32, level: bool, up: vec3f) -> vec2f {
    let u = environment.map_from_world * up;
    let size = vec2f(environment.size);
    if ENV_CUBE {
        // Linear along both.
        let first = env_face_coordinates(EnvPlace(cell.texel, select(vec2f(at, 0.0), vec2f(0.0, at), level)));
        let last = env_face_coordinates(EnvPlace(cell.texel, select(vec2f(at, 1.0), vec2f(1.0, at), level)));
        let face = cell.texel.y / environment.size.x;
        let begin = dot(u, env_face_direction(face, first));
        let end = dot(u, env_face_direction(face, last));
        if begin <= 0.0 && end <= 0.0 {
            return vec2f(0.0);
        }
        let crossing = begin / (begin - end);
        return vec2f(select(0.0, crossing, begin < 0.0), select(1.0, crossing, end < 0.0));
    }
    // u.y cos theta + h sin theta cos(phi - phi_u) is the cosine to `up`.
    let phi_u = atan2(u.x, u.z);
    let h = length(u.xz);
    let step = TWO_PI / size.x;
    if level {
        let theta = PI * (f32(cell.texel.y) + at) / size.y;
        // Above is what is nearer to phi_u than this. Where the row is a pole, or `up` is one, all of it or
        // nothing is, and rounding must not turn the sign.
        let reach = acos(clamp(-u.y * cos(theta) / max(h * sin(theta), 1e-20), -1.0, 1.0));
        // Longitude falls along a row. From the cell's middle to phi_u, the shorter way.
        let turns = (env_longitude(f32(cell.texel.x) + 0.5) - phi_u) * INV_TWO_PI;
        let away = (turns - round(turns)) * size.x + 0.5;
        let reached = reach / step;
        let other = select(away - size.x, away + size.x, away < 0.5);
        // The nearest stretch, and where the next one begins on the far side, or ends on the near one.
        let stretch = vec2f(away - reached, away + reached);
        if other > away && other - reached < 1.0 {
            return clamp(vec2f(other - reached, stretch.y), vec2f(0.0), vec2f(1.0));
        }
        if other < away && other + reached > 0.0 {
            return clamp(vec2f(stretch.x, other + reached), vec2f(0.0), vec2f(1.0));
        }
        return clamp(stretch, vec2f(0.0), vec2f(1.0));
    }
    // One zero in (0, pi).
    let b = h * cos(env_longitude(f32(cell.texel.x) + at) - phi_u);
    let from_pole = u.y >= 0.0;
    let theta = atan2(abs(u.y), select(b, -b, from_pole));
    let crossing = clamp(theta * INV_PI * size.y - f32(cell.texel.y), 0.0, 1.0);
    return select(vec2f(crossing, 1.0), vec2f(0.0, crossing), from_pole);
}

/// How many cells the sum has.
fn env_cells() -> u32 {
    return environment.terms;
}

/// The largest solid angle of a cell [sr].
fn env_largest_cell() -> f32 {
    let size = environment.size;
    if ENV_CUBE {
        return 4.0 / f32(size.x * size.x);
    }
    return 2.0 * TWO_PI / f32(size.x) * sin(0.5 * PI / f32(size.y));
}
