// MIT CSAIL: bins of the angles of both directions; in is the light's, out the viewer's.

/// The azimuth as a part of the turn, in [0, 1).
fn turns(w: vec3f) -> f32 {
    return fract(precise_atan2(w.y, w.x) * INV_TWO_PI + 1.0);
}

/// The angle from the normal as a part of 90 degrees.
fn height(w: vec3f) -> f32 {
    return angle_of_half(0.5 * dot(w.xy, w.xy) / (1.0 + w.z)) * (2.0 * INV_PI);
}

/// theta_in, theta_out, phi_diff, phi_in, each as a part of its range.
fn place(wo: vec3f, wi: vec3f) -> vec4f {
    let difference = fract(turns(wo) - turns(wi) + 1.0);
    if halves_at(0u) == 0u {
        return vec4f(height(wi), height(wo), difference, turns(wi));
    }
    // The other half of the differences, with both directions exchanged.
    if difference > 0.5 {
        return vec4f(height(wo), height(wi), 2.0 - 2.0 * difference, turns(wo));
    }
    return vec4f(height(wi), height(wo), 2.0 * difference, turns(wi));
}

/// A bin's colour: three times nine bits, and an exponent for all.
fn bin(a: u32, b: u32, c: u32, d: u32) -> vec3f {
    let word = bins_at(d + bins_size(3u) * (c + bins_size(2u) * (b + bins_size(1u) * a)));
    let step = bitcast<f32>(((word >> 27u) + 103u) << 23u);
    return vec3f(f32(word & 511u), f32((word >> 9u) & 511u), f32((word >> 18u) & 511u)) * step;
}

/// Two bins of an axis and the share of the second.
struct Step {
    low: u32,
    high: u32,
    part: f32,
}

/// Along an axis that ends.
fn step_of(part: f32, count: u32) -> Step {
    let at = clamp(part * f32(count) - 0.5, 0.0, f32(count) - 1.0);
    let low = u32(at);
    return Step(low, min(low + 1u, count - 1u), at - f32(low));
}

/// Along an axis that goes around.
fn step_around(part: f32, count: u32) -> Step {
    let at = part * f32(count) + f32(count) - 0.5;
    let low = floor(at);
    let first = u32(low) % count;
    return Step(first, (first + 1u) % count, at - low);
}

fn along_phi_in(a: u32, b: u32, c: u32, d: Step) -> vec3f {
    return mix(bin(a, b, c, d.low), bin(a, b, c, d.high), d.part);
}

fn along_phi_diff(a: u32, b: u32, c: Step, d: Step) -> vec3f {
    return mix(along_phi_in(a, b, c.low, d), along_phi_in(a, b, c.high, d), c.part);
}

fn along_theta_out(a: u32, b: Step, c: Step, d: Step) -> vec3f {
    return mix(along_phi_diff(a, b.low, c, d), along_phi_diff(a, b.high, c, d), b.part);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let at = place(wo, wi);
    let sizes = vec4u(bins_size(0u), bins_size(1u), bins_size(2u), bins_size(3u));
    if INTERPOLATION == INTERPOLATION_NEAREST {
        // On a border, as 60 degrees often are, it is the bin above, whatever the last digit says.
        let cell = min(vec4u(at * vec4f(sizes) + 1e-4), sizes - 1u);
        return p.scale * bin(cell.x, cell.y, cell.z, cell.w);
    }
    let a = step_of(at.x, sizes.x);
    let b = step_of(at.y, sizes.y);
    var c = step_around(at.z, sizes.z);
    if halves_at(0u) != 0u {
        c = step_of(at.z, sizes.z);
    }
    let d = step_around(at.w, sizes.w);
    return p.scale * mix(along_theta_out(a.low, b, c, d), along_theta_out(a.high, b, c, d), a.part);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return lobe_sample(wo, u);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return lobe_pdf(wo, wi);
}
