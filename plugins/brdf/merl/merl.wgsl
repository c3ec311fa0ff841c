// MERL: bins of theta_h (finer towards the mirror direction), theta_d and phi_d.
//
// The angles come from m = wo + wi and d = wi - wo, which are at right angles; exchanging the directions turns
// d around, which is half a turn of phi_d, and files of 180 bins hold half a turn.

/// theta_h and theta_d as parts of 90 degrees, theta_h by its square root, and phi_d as a part of the bins' turn.
fn place(wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let d = wi - wo;
    let length_of_m = length(m);
    let across_squared = dot(m.xy, m.xy);
    let across = sqrt(across_squared);
    var axis = vec2f(1.0, 0.0);
    if across > 0.0 {
        axis = m.xy / across;
    }
    // Around the half vector: where theta_h grows, and at right angles to it.
    let down = (dot(d.xy, axis) * m.z - d.z * across) / length_of_m;
    let aside = axis.x * d.y - axis.y * d.x;
    var turns = 0.0;
    if reflectance_size(1u) < 360u {
        // Of both ways around the one with `aside` above 0: to the last bit the same for exchanged directions.
        turns = fract(precise_atan2(abs(aside), select(down, -down, aside < 0.0)) * INV_PI);
    } else {
        turns = fract(precise_atan2(aside, down) * INV_TWO_PI + 1.0);
    }
    let theta_h = angle_of_half(0.5 * across_squared / (length_of_m * (length_of_m + m.z))) * (2.0 * INV_PI);
    let theta_d = angle_of_half(0.25 * dot(d, d) / (2.0 + length_of_m)) * (2.0 * INV_PI);
    return vec3f(sqrt(theta_h), theta_d, turns);
}

/// Four colours, each times its share: three times nine bits and an exponent for all, turned by one bit.
fn mixed(colours: vec4f, shares: vec4f) -> vec3f {
    let bits = bitcast<vec4u>(colours);
    let words = (bits << vec4u(1u)) | (bits >> vec4u(31u));
    let steps = shares * bitcast<vec4f>(((words >> vec4u(27u)) + 103u) << vec4u(23u));
    return vec3f(
        dot(steps, vec4f(words & vec4u(511u))),
        dot(steps, vec4f((words >> vec4u(9u)) & vec4u(511u))),
        dot(steps, vec4f((words >> vec4u(18u)) & vec4u(511u))),
    );
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let rows = reflectance_size(0u);
    let columns = reflectance_size(1u);
    let bins = reflectance_size(2u);
    let sizes = vec3f(f32(bins), f32(rows - 1u), f32(columns));
    let at = place(wo, wi) * sizes;
    if INTERPOLATION == INTERPOLATION_NEAREST {
        let cell = min(vec3u(at), vec3u(sizes) - 1u);
        // Row 0 is theta_d = 0.
        let texel = reflectance_at(cell.x + bins * (cell.z + columns * (cell.y + 1u)));
        return unit_at(0u) * mixed(texel, vec4f(1.0, 0.0, 0.0, 0.0));
    }
    let x = clamp(at.x - 0.5, 0.0, sizes.x - 1.0);
    let h = u32(x);
    // Bins' middles are a step apart, theta_d = 0 half a step before the first one's.
    let y = min(select(at.y + 0.5, 2.0 * at.y, at.y < 0.5), sizes.y);
    let d = u32(y);
    // phi_d goes around: before the first bin lies the last one.
    let z = select(at.z - 0.5, at.z + sizes.z - 0.5, at.z < 0.5);
    let column = min(u32(z), columns - 1u);

    let part = vec3f(x - f32(h), y - f32(d), z - f32(column));
    let along = vec2f(1.0 - part.z, part.z);
    let shares = vec4f((1.0 - part.y) * along, part.y * along);
    let first = bins * (column + columns * d);
    let low = mixed(reflectance_at(first + h), (1.0 - part.x) * shares);
    let high = mixed(reflectance_at(first + min(h + 1u, bins - 1u)), part.x * shares);
    return unit_at(0u) * (low + high);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return lobe_sample(wo, u);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return lobe_pdf(wo, wi);
}
