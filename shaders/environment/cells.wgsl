// The map as a sum of cells: its texels, one after the other, and the places inside of them.

@group(0) @binding(10) var<storage, read> env_order: array<u32>;

/// One texel of the map as a part of the sphere.
struct EnvCell {
    texel: vec2u,
    /// Its middle, world frame.
    dir: vec3f,
    /// No direction in it is farther from `dir` than this, as a chord.
    radius: f32,
    /// [sr]; of a cube's texel at its middle.
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

/// The solid angle of a texel [sr]; for a cube's at `offset` in it.
fn env_solid_angle(texel: vec2u, offset: vec2f) -> f32 {
    let size = vec2f(environment.size);
    if ENV_CUBE {
        let st = env_face_coordinates(EnvPlace(texel, offset));
        let square = 1.0 + dot(st, st);
        return 4.0 / (size.x * size.x * square * sqrt(square));
    }
    let half = 0.5 * PI / size.y;
    return 2.0 * TWO_PI / size.x * sin(half * f32(2u * texel.y + 1u)) * sin(half);
}

/// The cell of rank `k`, below `environment.terms`, in the order that the host chose.
fn env_cell(k: u32) -> EnvCell {
    let index = env_order[k];
    let size = environment.size;
    let texel = vec2u(index % size.x, index / size.x);
    let middle = vec2f(0.5);
    var radius = 1.4142136 / f32(size.x);
    if !ENV_CUBE {
        // The middle of a row at a pole, by area, lies 1.42 of its half height from the pole.
        let half = 0.5 * PI / f32(size.y);
        let wide = min(sin(half * f32(2u * texel.y + 1u)) + half, 1.0);
        radius = 1.5 * half + PI / f32(size.x) * wide;
    }
    return EnvCell(texel, env_sample_at(texel, middle).dir, radius, env_solid_angle(texel, middle));
}

/// The light at a place of a cell; `at` in [0, 1)^2, on a lat-long map uniform in solid angle. With a
/// linear filter that holds in the upper and in the lower half: filtered radiance has its crease where
/// they meet, at the middle of the row's angle.
fn env_cell_light(cell: EnvCell, at: vec2f) -> EnvCellLight {
    var offset = at;
    var stretch = 1.0;
    if ENV_LINEAR && !ENV_CUBE {
        let half = 0.5 * PI / f32(environment.size.y);
        // The part of the row's area above its middle: sin(t0 + h/2) sin(h/2) / (sin(t0 + h) sin(h)), of
        // rows of height 2 h.
        let top = 2.0 * half * f32(cell.texel.y);
        let above = 0.5 * sin(top + 0.5 * half) / (sin(top + half) * cos(0.5 * half));
        let lower = at.y >= 0.5;
        stretch = 2.0 * select(above, 1.0 - above, lower);
        offset.y = select(at.y * stretch, 1.0 - (1.0 - at.y) * stretch, lower);
    }
    let sample = env_sample_at(cell.texel, offset);
    return EnvCellLight(sample.dir, sample.radiance, env_solid_angle(cell.texel, offset) * stretch);
}

/// The largest solid angle of a cell [sr].
fn env_largest_cell() -> f32 {
    let size = environment.size;
    if ENV_CUBE {
        return 4.0 / f32(size.x * size.x);
    }
    return 2.0 * TWO_PI / f32(size.x) * sin(0.5 * PI / f32(size.y));
}
