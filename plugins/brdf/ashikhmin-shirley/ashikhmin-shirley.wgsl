// Ashikhmin-Shirley: an anisotropic power of the half vector's cosine with Schlick's Fresnel term, over a
// diffuse part that gets what the lobe leaves; each sampled as it is.
//
// A large exponent multiplies every error of that cosine's logarithm, so cos^2 = 1 - sin^2 enters as sin^2,
// which the components of m = wo + wi, the half vector before it is normalised, give without cancellation.

/// The density of half vectors (eq. 6) [1/sr]: hz to the power of (nu hx^2 + nv hy^2) / (hx^2 + hy^2).
fn half_vector_density(p: Params, m: vec3f) -> f32 {
    let len2 = dot(m, m);
    let sine2 = dot(m.xy, m.xy) / len2;
    // log(hz^2) / sin^2, which tends to -1 at the pole, where the azimuth is 0 / 0.
    var log_ratio = -1.0;
    if sine2 > 0.5 {
        log_ratio = log(m.z * (m.z / len2)) / sine2;
    } else if sine2 > 0.0 {
        log_ratio = log1p(-sine2) / sine2;
    }
    let exponent = 0.5 * log_ratio * ((p.nu * m.x * m.x + p.nv * m.y * m.y) / len2);
    return sqrt((p.nu + 1.0) * (p.nv + 1.0)) * INV_TWO_PI * exp(exponent);
}

/// Schlick's Fresnel term; 1 - c comes from 1 - c^2 = |wo - wi|^2 / 4, which keeps its digits at c = 1.
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let difference = wo - wi;
    let one_minus_c = min(dot(difference, difference) / (4.0 + 2.0 * length(wo + wi)), 1.0);
    return p.rs + (1.0 - p.rs) * pow5(one_minus_c);
}

/// 1 - (1 - z / 2)^5, multiplied out: small z keep their digits.
fn diffuse_rise(z: f32) -> f32 {
    let x = 0.5 * z;
    return x * (5.0 + x * (-10.0 + x * (10.0 + x * (-5.0 + x))));
}

/// rd as far as the lobe leaves light to it.
fn diffuse_colour(p: Params) -> vec3f {
    return select(p.rd, p.rd * (1.0 - p.rs), COUPLED_DIFFUSE);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    // eq. 4: the density / (4 h.k max(cos, cos)), where h.k = |m| / 2.
    let lobe = 0.5 * half_vector_density(p, m) / (length(m) * max(wo.z, wi.z));
    // eq. 5.
    let diffuse = 28.0 / 23.0 * INV_PI * diffuse_rise(wo.z) * diffuse_rise(wi.z);
    return diffuse_colour(p) * diffuse + fresnel(p, wo, wi) * lobe;
}

/// How often the half vector and the cosine are drawn: by the two parts of the albedo at `wo`, except that far
/// from grazing a broad lobe, which reaches below the horizon, is the cosine's as well: half of it at exponents
/// of 8.
fn shares(p: Params, wo: vec3f) -> vec2f {
    // Exactly the albedo of eq. 5; for the lobe the Fresnel term at the mean wo.h of the half vectors.
    let diffuse = dot(diffuse_colour(p), vec3f(diffuse_rise(wo.z)));
    let spread = dot(wo.xy * wo.xy, 2.0 / (vec2f(p.nu, p.nv) + 2.0));
    let c = min(0.5 * (wo.z + sqrt(wo.z * wo.z + INV_PI * spread)), 1.0);
    let lobe = dot(p.rs + (1.0 - p.rs) * pow5(1.0 - c), vec3f(1.0));
    if lobe <= 0.0 {
        return vec2f(0.0, 1.0);
    }
    let breadth = 64.0 / (p.nu * p.nv) * (wo.z * wo.z);
    let parts = vec2f(lobe, diffuse + lobe * (breadth * breadth));
    return parts / (parts.x + parts.y);
}

/// The half vector by eq. 9 and 10; the azimuth of eq. 9 is that of a circle scaled along its axes, and the
/// exponent of eq. 10 the scaled circle's radius.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z >= shares(p, wo).x {
        return cosine_sample(u.xy);
    }
    let phi = TWO_PI * u.y;
    let scaled = vec2f(cos(phi), sin(phi)) * inverseSqrt(vec2f(p.nu, p.nv) + 1.0);
    let one_minus_cosine = -expm1(log1p(-u.x) * dot(scaled, scaled));
    let sine = sqrt(one_minus_cosine * (2.0 - one_minus_cosine));
    let h = vec3f(sine * normalize(scaled), 1.0 - one_minus_cosine);
    return 2.0 * dot(wo, h) * h - wo;
}

/// eq. 8: the density of half vectors / (4 h.k).
fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    return dot(shares(p, wo), vec2f(0.5 * half_vector_density(p, m) / length(m), cosine_pdf(wi)));
}
