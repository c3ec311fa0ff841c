// MERL: bins of theta_h (finer towards the mirror direction), theta_d and phi_d.
//
// The angles come from m = wo + wi and d = wi - wo, which are at right angles; exchanging the directions turns
// d around, which is half a turn of phi_d, and files of 180 bins hold half a turn.

/// Bins of theta_h from one texel to the next; the fourth bin of a texel is the first of the next.
const RUN: u32 = 3u;

/// theta_h and theta_d as parts of 90 degrees, theta_h by its square root, and phi_d as a part of the bins' turn: 1
/// is 0 again.
fn place(wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let d = wi - wo;
    let length_of_m = length(m);
    let across = dot(m.xy, m.xy);
    // Around the half vector: where theta_h grows, and at right angles to it; both times |m| and the root of `across`.
    let down = dot(d.xy, m.xy) * m.z - d.z * across;
    let aside = (m.x * d.y - m.y * d.x) * length_of_m;
    // Of both ways around the one with `aside` above 0: to the last bit the same for exchanged directions.
    let is_half = reflectance_size(2u) < 361u;
    let is_behind = aside < 0.0;
    let angle = precise_atan2_above(abs(aside), select(down, -down, is_half && is_behind)) * INV_PI;
    let turns = select(0.5 * select(angle, 2.0 - angle, is_behind), angle, is_half);
    let s = 0.5 * across / (length_of_m * (length_of_m + m.z));
    let theta_d = angle_of_half(0.25 * dot(d, d) / (2.0 + length_of_m)) * (2.0 * INV_PI);
    return vec3f(root_of_angle(s), theta_d, turns);
}

/// Four colours, each times its share: three times nine bits and an exponent for all, turned by one bit.
fn mixed(colours: vec4f, shares: vec4f) -> vec3f {
    let bits = bitcast<vec4u>(colours);
    let words = (bits << vec4u(1u)) | (bits >> vec4u(31u));
    let exponents = ((words >> vec4u(4u)) & vec4u(31u << 23u)) + (103u << 23u);
    let steps = shares * bitcast<vec4f>(exponents);
    return vec3f(
        dot(steps, vec4f(words & vec4u(511u))),
        dot(steps, vec4f((words >> vec4u(9u)) & vec4u(511u))),
        dot(steps, vec4f((words >> vec4u(18u)) & vec4u(511u))),
    );
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let rows = reflectance_size(0u);
    let runs = reflectance_size(1u);
    // Of each run behind the last column the first comes again.
    let columns = reflectance_size(2u) - 1u;
    let sizes = vec3f(f32(RUN * runs), f32(rows - 1u), f32(columns));
    let part_of = place(wo, wi);
    if INTERPOLATION == INTERPOLATION_NEAREST {
        let cell = min(vec3u(vec3f(part_of.xy, fract(part_of.z)) * sizes), vec3u(sizes) - 1u);
        // Row 0 is theta_d = 0.
        let texel = reflectance_at(cell.z + (columns + 1u) * (cell.x / RUN + runs * (cell.y + 1u)));
        return unit_at(0u) * mixed(vec4f(texel[cell.x % RUN]), vec4f(1.0, 0.0, 0.0, 0.0));
    }
    let x = clamp(part_of.x * sizes.x - 0.5, 0.0, sizes.x - 1.0);
    let bin = u32(x);
    // A third, rounded down.
    let run = (bin * 21846u) >> 16u;
    let h = bin - RUN * run;
    // Bins' middles are a step apart, theta_d = 0 half a step before the first one's.
    let row = part_of.y * sizes.y;
    let y = min(row + min(row, 0.5), sizes.y);
    let d = min(u32(y), rows - 2u);
    // phi_d goes around: before the first bin lies the last one.
    let z = fract(part_of.z - 0.5 / sizes.z) * sizes.z;
    let column = min(u32(z), columns - 1u);

    let part = vec3f(x - f32(bin), y - f32(d), z - f32(column));
    let across = vec2f(1.0 - part.z, part.z);
    let shares = vec4f((1.0 - part.y) * across, part.y * across);
    let first = column + (columns + 1u) * (run + runs * d);
    let next = first + (columns + 1u) * runs;
    let a = reflectance_at(first);
    let b = reflectance_at(first + 1u);
    let c = reflectance_at(next);
    let e = reflectance_at(next + 1u);
    let is_first = h == 0u;
    let is_second = h == 1u;
    let one = vec4f(a.y, b.y, c.y, e.y);
    let two = vec4f(a.z, b.z, c.z, e.z);
    let low = select(select(two, one, is_second), vec4f(a.x, b.x, c.x, e.x), is_first);
    let high = select(select(vec4f(a.w, b.w, c.w, e.w), two, is_second), one, is_first);
    return unit_at(0u) * (mixed(low, (1.0 - part.x) * shares) + mixed(high, part.x * shares));
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return lobe_sample(wo, u);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return lobe_pdf(wo, wi);
}
