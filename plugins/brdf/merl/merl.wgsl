// MERL: bins of theta_h (finer towards the mirror direction), theta_d and phi_d.
//
// The angles come from m = wo + wi and d = wi - wo, which are at right angles; exchanging the directions turns
// d around, which is half a turn of phi_d, and files of 180 bins hold half a turn.

/// theta_h and theta_d as parts of 90 degrees, theta_h by its square root, and phi_d as a part of the bins' turn.
fn place(wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let d = wi - wo;
    let length_of_m = length(m);
    let across = length(m.xy);
    var axis = vec2f(1.0, 0.0);
    if across > 0.0 {
        axis = m.xy / across;
    }
    // Around the half vector: where theta_h grows, and at right angles to it.
    let down = (dot(d.xy, axis) * m.z - d.z * across) / length_of_m;
    let aside = axis.x * d.y - axis.y * d.x;
    var turns = 0.0;
    if reflectance_size(2u) < 360u {
        // Of both ways around the one with `aside` above 0: to the last bit the same for exchanged directions.
        turns = fract(precise_atan2(abs(aside), select(down, -down, aside < 0.0)) * INV_PI);
    } else {
        turns = fract(precise_atan2(aside, down) * INV_TWO_PI + 1.0);
    }
    let theta_h = angle_of_half(0.5 * across * across / (length_of_m * (length_of_m + m.z))) * (2.0 * INV_PI);
    let theta_d = angle_of_half(0.25 * dot(d, d) / (2.0 + length_of_m)) * (2.0 * INV_PI);
    return vec3f(sqrt(theta_h), theta_d, turns);
}

/// Where the bins of phi_d begin; row 0 of `d` is theta_d = 0, the first bin's middle is row 1.
fn row(h: u32, d: u32) -> u32 {
    return reflectance_size(2u) * (d + reflectance_size(1u) * h);
}

/// The colours of a bin and of the next phi_d, as whole numbers of units and a little more (`LEAST`).
struct Pair {
    own: vec3f,
    next: vec3f,
}

/// What the numbers were raised by, so that none is subnormal: 2^-14.
const LEAST: f32 = 6.1035156e-5;

/// Floats of five bits of exponent and ten of mantissa, moved to where an f32 has them.
fn pair(at: u32) -> Pair {
    let bits = bitcast<vec3u>(reflectance_at(at).rgb);
    let own = ((bits & vec3u(0x7fffu)) << vec3u(13u)) + vec3u(0x38000000u);
    let next = ((bits >> vec3u(16u)) << vec3u(13u)) + vec3u(0x38000000u);
    return Pair(bitcast<vec3f>(own), bitcast<vec3f>(next));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let rows = reflectance_size(1u);
    let columns = reflectance_size(2u);
    let sizes = vec3f(f32(reflectance_size(0u)), f32(rows - 1u), f32(columns));
    let at = place(wo, wi) * sizes;
    if INTERPOLATION == INTERPOLATION_NEAREST {
        let cell = min(vec3u(at), vec3u(sizes) - 1u);
        return unit_at(0u) * (pair(row(cell.x, cell.y + 1u) + cell.z).own - LEAST);
    }
    let x = clamp(at.x - 0.5, 0.0, sizes.x - 1.0);
    let h = u32(x);
    // Bins' middles are a step apart, theta_d = 0 half a step before the first one's.
    let y = min(select(at.y + 0.5, 2.0 * at.y, at.y < 0.5), sizes.y);
    let d = u32(y);
    // phi_d goes around: before the first bin lies the last one.
    let z = select(at.z - 0.5, at.z + sizes.z - 0.5, at.z < 0.5);
    let column = min(u32(z), columns - 1u);

    let next_h = min(h + 1u, reflectance_size(0u) - 1u);
    let next_d = min(d + 1u, rows - 1u);
    let part = vec2f(x - f32(h), y - f32(d));
    let shares = vec4f((1.0 - part.x) * vec2f(1.0 - part.y, part.y), part.x * vec2f(1.0 - part.y, part.y));
    let a = pair(row(h, d) + column);
    let b = pair(row(h, next_d) + column);
    let c = pair(row(next_h, d) + column);
    let e = pair(row(next_h, next_d) + column);
    let own = shares.x * a.own + shares.y * b.own + shares.z * c.own + shares.w * e.own;
    let next = shares.x * a.next + shares.y * b.next + shares.z * c.next + shares.w * e.next;
    // The shares add up to 1 but for rounding.
    return unit_at(0u) * max(mix(own, next, z - f32(column)) - LEAST, vec3f(0.0));
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return lobe_sample(wo, u);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return lobe_pdf(wo, wi);
}
