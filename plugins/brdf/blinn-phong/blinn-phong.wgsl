// Blinn-Phong: a power of the half vector's cosine; sampled by the half vector, or by the cosine where the lobe
// is broad.
//
// A large exponent multiplies every error of that cosine's logarithm, so cos^2 = 1 - sin^2 enters as sin^2,
// which the components of m = wo + wi, the half vector before it is normalised, give without cancellation.

/// cos(h)^n.
fn lobe(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let sine2 = dot(m.xy, m.xy) / dot(m, m);
    if sine2 > 0.5 {
        return exp(p.n * log(m.z / length(m)));
    }
    return exp(0.5 * p.n * log1p(-sine2));
}

/// What makes the albedo at normal incidence ks: exactly (Giesen 2009), or by up to 8 % more than that.
fn norm(p: Params) -> f32 {
    if NORMALISATION == NORMALISATION_APPROXIMATE {
        return (p.n + 8.0) * (0.125 * INV_PI);
    }
    return (p.n + 2.0) * 0.125 * INV_PI * ((p.n + 4.0) / (exp2(-0.5 * p.n) + p.n));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.ks * (norm(p) * lobe(p, wo, wi));
}

/// x^8.
fn pow8(x: f32) -> f32 {
    let x2 = x * x;
    let x4 = x2 * x2;
    return x4 * x4;
}

/// How often the half vector and the cosine are drawn: equally at n = 8. At small exponents half of the
/// former's draws lie below the horizon while f is nearly constant, and the cosine is the better choice.
fn shares(p: Params) -> vec2f {
    let breadth = pow8(8.0 / p.n);
    return vec2f(1.0, breadth) / (1.0 + breadth);
}

/// hz = xi^(1 / (n + 1)), with xi = 1 - u.x, which is never 0; then `wo` is mirrored at h.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z >= shares(p).x {
        return cosine_sample(u.xy);
    }
    let one_minus_cosine = -expm1(log1p(-u.x) / (p.n + 1.0));
    let h = direction_below_pole(one_minus_cosine, TWO_PI * u.y);
    return 2.0 * dot(wo, h) * h - wo;
}

/// (n + 1) / (2 pi) cos(h)^n / (4 wo.h), where wo.h = |m| / 2.
fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let density = (p.n + 1.0) * INV_FOUR_PI * lobe(p, wo, wi) / length(wo + wi);
    return dot(shares(p), vec2f(density, cosine_pdf(wi)));
}
