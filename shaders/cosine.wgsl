// Sampling by the cosine: the host's where a BRDF brings none of its own, and in reach of those that do.

/// Cosine-weighted direction: r^2 = u.x by Malley's method.
fn cosine_sample(u: vec2f) -> vec3f {
    let r = sqrt(u.x);
    let phi = TWO_PI * u.y;
    return vec3f(r * cos(phi), r * sin(phi), sqrt(1.0 - u.x));
}

/// Density of `cosine_sample` [1/sr].
fn cosine_pdf(wi: vec3f) -> f32 {
    return wi.z * INV_PI;
}
