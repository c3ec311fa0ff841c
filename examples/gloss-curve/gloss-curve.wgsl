// A curve over theta_h above Lambert; the native library beside it reads the curve.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let length_of_m = length(m);
    let theta_h = angle_of_half(0.5 * dot(m.xy, m.xy) / (length_of_m * (length_of_m + m.z)));
    let entries = gloss_size(0u);
    let at = clamp(sqrt(theta_h * (2.0 * INV_PI)), 0.0, 1.0) * f32(entries - 1u);
    let low = min(u32(at), entries - 2u);
    let gloss = mix(gloss_at(low), gloss_at(low + 1u), at - f32(low));
    return p.base * INV_PI + vec3f(p.strength * gloss);
}

/// Half of the directions are drawn from the gloss, the others by the cosine for the base.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z < 0.5 {
        return lobe_sample(wo, u);
    }
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return 0.5 * (lobe_pdf(wo, wi) + cosine_pdf(wi));
}
