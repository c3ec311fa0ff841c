// Phong, normalised and reciprocal: one lobe around the mirror direction, sampled as it is.
//
// A large exponent multiplies every error of the cosine's logarithm, so no cosine near 1 enters: it is
// 1 - |r - wi|^2 / 2 there, of which the logarithm is taken as a series, and `sample` draws 1 - cos directly.

/// max(cos(r, wi), 0)^n, r the mirror direction of `wo`.
fn lobe(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let r = vec3f(-wo.xy, wo.z);
    let cosine = max(dot(r, wi), 0.0);
    if cosine == 0.0 {
        return 0.0;
    }
    if cosine < 0.5 {
        return exp(p.n * log(cosine));
    }
    let chord = r - wi;
    return exp(p.n * log1p(-0.5 * dot(chord, chord)));
}

/// Lafortune and Willems 1994, eq. 6: the factor (n + 2) / (2 pi) makes the albedo at normal incidence ks.
fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.ks * ((p.n + 2.0) * INV_TWO_PI * lobe(p, wo, wi));
}

/// cos = xi^(1 / (n + 1)) around the mirror direction, with xi = 1 - u.x, which is never 0.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let one_minus_cosine = -expm1(log1p(-u.x) / (p.n + 1.0));
    let local = direction_below_pole(one_minus_cosine, TWO_PI * u.y);
    // The rotation that takes +z to r the shortest way; 1 + r.z is never small.
    let r = vec3f(-wo.xy, wo.z);
    let along = dot(local.xy, r.xy);
    return vec3f(local.xy + r.xy * (local.z - along / (1.0 + r.z)), local.z * r.z - along);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return (p.n + 1.0) * INV_TWO_PI * lobe(p, wo, wi);
}

/// The lobe has cancelled.
fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.ks * ((p.n + 2.0) / (p.n + 1.0) * wi.z);
}
