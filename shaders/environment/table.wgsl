// Draws directions in proportion to the map: a row, and then a column of it, each by inversion.
//
// A list of n entries is stored as the ends of their shares of [0, 2^32), the last one, 2^32, left out.
// Rows come first, then the columns of each row. A guide says for equal parts of [0, 2^32) between
// which entries they lie, so that few steps are left (Chen and Asau 1974). Integers throughout: the
// rarest rows of real maps are drawn with probabilities below 2^-24.

@group(0) @binding(8) var<storage, read> env_ends: array<u32>;
@group(0) @binding(9) var<storage, read> env_guides: array<u32>;

/// A direction drawn from the map, world frame; no sample where `pdf` is 0.
struct EnvSample {
    dir: vec3f,
    radiance: vec3f,
    /// [1/sr]
    pdf: f32,
}

/// An entry of a list, and where in its share the number fell, in (0, 1).
struct EnvEntry {
    index: u32,
    offset: f32,
}

/// Where the lists of a row's columns begin: `x` in `env_ends`, `y` in `env_guides`.
fn env_columns_of(row: u32) -> vec2u {
    let size = environment.size;
    return vec2u(size.y - 1u + row * (size.x - 1u), (1u << environment.guide_bits.x) + (row << environment.guide_bits.y));
}

/// Where `x` lies in a share, in (0, 1); the end of a share of all 2^32 numbers has wrapped to 0.
fn env_offset(begin: u32, end: u32, x: u32) -> f32 {
    let share = f32(end - begin - 1u) + 1.0;
    return min((f32(x - begin) + 0.5) / share, 0x1.fffffep-1);
}

/// The share of an entry: its beginning and its end, where 2^32 has wrapped to 0.
fn env_share(index: u32, lists: vec2u, count: u32) -> vec2u {
    var begin = 0u;
    if index > 0u {
        begin = env_ends[lists.x + index - 1u];
    }
    var end = 0u;
    if index + 1u < count {
        end = env_ends[lists.x + index];
    }
    return vec2u(begin, end);
}

/// The entry, of `count` that begin at `lists`, whose share holds `x`.
fn env_find(x: u32, lists: vec2u, count: u32, guide_bits: u32) -> EnvEntry {
    let guide = env_guides[lists.y + (x >> (32u - guide_bits))];
    var index = guide & 0xffffu;
    var left = guide >> 16u;
    while left > 0u {
        let half = left >> 1u;
        if env_ends[lists.x + index + half] <= x {
            index += half + 1u;
            left -= half + 1u;
        } else {
            left = half;
        }
    }
    let share = env_share(index, lists, count);
    return EnvEntry(index, env_offset(share.x, share.y, x));
}

/// The light and the world direction at a place; `offset.y` runs uniformly in solid angle on a lat-long
/// map. Nothing is looked up by the direction again.
fn env_sample_at(texel: vec2u, offset: vec2f) -> EnvSample {
    var place = EnvPlace(texel, offset);
    var d: vec3f;
    if ENV_CUBE {
        d = normalize(env_face_direction(texel.y / environment.size.x, env_face_coordinates(place)));
    } else {
        let size = vec2f(environment.size);
        // From the nearer pole: 1 - cos t, and it is 2 sin^2(t / 2) at the row's edge.
        let south = 2u * texel.y >= environment.size.y;
        let row = select(texel.y, environment.size.y - 1u - texel.y, south);
        let down = select(offset.y, 1.0 - offset.y, south);
        let half = 0.5 * PI / size.y;
        let edge = sin(half * f32(row));
        let one_minus_cos =
            2.0 * (edge * edge + down * sin(half * f32(2u * row + 1u)) * sin(half));
        let r = sqrt(max(one_minus_cos * (2.0 - one_minus_cos), 0.0));
        let cos_theta = 1.0 - one_minus_cos;
        let phi = env_longitude(f32(texel.x) + offset.x);
        d = vec3f(r * sin(phi), select(cos_theta, -cos_theta, south), r * cos(phi));
        if ENV_LINEAR {
            // The filter runs in the angle.
            let v = atan2(r, d.y) * INV_PI * size.y - f32(texel.y);
            place.offset.y = clamp(v, 0.0, 0x1.fffffep-1);
        }
    }
    let light = env_light_at(place);
    return EnvSample(d * environment.map_from_world, light.radiance, light.pdf);
}

/// Draws a direction in proportion to the map's radiance; `u` from `next_2d_bits`.
fn env_sample(u: vec2u) -> EnvSample {
    let size = environment.size;
    let row = env_find(u.y, vec2u(0u), size.y, environment.guide_bits.x);
    let column = env_find(u.x, env_columns_of(row.index), size.x, environment.guide_bits.y);
    return env_sample_at(vec2u(column.index, row.index), vec2f(column.offset, row.offset));
}

/// The number in a share at `offset` in [0, 1] of it.
fn env_number(share: vec2u, offset: f32) -> u32 {
    let most = share.y - share.x - 1u;
    return share.x + min(u32(offset * f32(most)), most);
}

/// The `u` that `env_sample` takes to the world direction `dir`, up to rounding.
fn env_unsampled(dir: vec3f) -> vec2u {
    let size = environment.size;
    let d = environment.map_from_world * dir;
    var place = env_place_of(d);
    if !ENV_CUBE {
        // From equal angles to equal areas.
        let half = 0.5 * PI / f32(size.y);
        let top = cos(2.0 * half * f32(place.texel.y));
        let high = 2.0 * sin(half * f32(2u * place.texel.y + 1u)) * sin(half);
        place.offset.y = clamp((top - d.y) / high, 0.0, 1.0);
    }
    let row = env_share(place.texel.y, vec2u(0u), size.y);
    let column = env_share(place.texel.x, env_columns_of(place.texel.y), size.x);
    return vec2u(env_number(column, place.offset.x), env_number(row, place.offset.y));
}

/// Density of `env_sample` [1/sr] for the world direction `dir`.
fn env_pdf(dir: vec3f) -> f32 {
    return env_light(dir).pdf;
}
