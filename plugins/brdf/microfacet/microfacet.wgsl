// The terms D, F and G of microfacet models, alone or as f = D F G / (4 cos(wo) cos(wi)).
//
// Everything is written in m = wo + wi: the half vector is m / |m|, (wo.h) is |m| / 2, and the slope of
// the facet is |m.xy| / m.z. Sampling needs no term in particular: GGX's visible normals with a width
// that suits D, which have the heavier tail; the lobe itself for Phong's; the cosine for F and G.

/// GGX, Walter 2007 eq. 33, in the form without a difference.
fn ggx(alpha: f32, m: vec3f) -> f32 {
    let ratio = dot(m, m) / (dot(m.xy, m.xy) / alpha + alpha * m.z * m.z);
    return INV_PI * ratio * ratio;
}

/// cos^n of the angle between `wi` and the mirror direction of `wo`.
fn phong_lobe(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let cosine = wo.z * wi.z - dot(wo.xy, wi.xy);
    if cosine <= 0.0 {
        return 0.0;
    }
    let difference = vec3f(wi.xy + wo.xy, wi.z - wo.z);
    let one_minus_cosine = 0.5 * dot(difference, difference);
    return exp(p.exponent * select(log(cosine), log1p(-one_minus_cosine), one_minus_cosine < 0.5));
}

fn distribution(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let slope2 = dot(m.xy, m.xy) / (m.z * m.z);
    let secant2 = dot(m, m) / (m.z * m.z);
    let angle = atan2(length(m.xy), m.z);
    let gauss = INV_PI * exp(-(slope2 / p.alpha) / p.alpha) / (p.alpha * p.alpha);
    let power = exp(-0.5 * p.exponent * log1p(slope2));
    switch DISTRIBUTION {
        case DISTRIBUTION_BECKMANN: {
            return gauss * secant2 * secant2;
        }
        case DISTRIBUTION_WARD: {
            return gauss;
        }
        case DISTRIBUTION_GAUSSIAN: {
            return exp(-(angle / p.alpha) * (angle / p.alpha));
        }
        case DISTRIBUTION_EXPONENTIAL: {
            // Over the integral of exp(-angle / alpha) cos on the hemisphere.
            let area = TWO_PI * p.alpha * p.alpha * (1.0 + exp(-0.5 * PI / p.alpha)) / (1.0 + 4.0 * p.alpha * p.alpha);
            return exp(-angle / p.alpha) / area;
        }
        case DISTRIBUTION_TROWBRIDGE_REITZ: {
            return PI * p.alpha * p.alpha * ggx(p.alpha, m);
        }
        case DISTRIBUTION_BLINN_PHONG: {
            return (p.exponent + 2.0) * INV_TWO_PI * power;
        }
        case DISTRIBUTION_PHONG: {
            return 2.0 * (p.exponent + 1.0) * INV_PI * phong_lobe(p, wo, wi);
        }
        case DISTRIBUTION_NISHINO: {
            return expm1(p.kappa * power);
        }
        default: {
            return ggx(p.alpha, m);
        }
    }
}

/// 2 cos / G1 of Smith's term for GGX.
fn smith(p: Params, w: vec3f) -> f32 {
    return w.z + length(vec3f(p.alpha * w.xy, w.z));
}

/// cos / G1 of Schlick's approximation to Smith's term for Beckmann's facets.
fn schlick_mask(p: Params, w: vec3f) -> f32 {
    let k = p.alpha * 0.797884560802865;
    return w.z * (1.0 - k) + k;
}

/// G / (4 cos(wo) cos(wi)).
fn visibility(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let m2 = dot(m, m);
    let both = wo.z * wi.z;
    let higher = max(wo.z, wi.z);
    switch MASKING {
        case MASKING_IMPLICIT: {
            return 0.25;
        }
        case MASKING_COOK_TORRANCE: {
            return min(0.25 / both, m.z / (m2 * higher));
        }
        case MASKING_SCHLICK: {
            return 0.25 / (schlick_mask(p, wo) * schlick_mask(p, wi));
        }
        case MASKING_WARD: {
            return 0.25 / sqrt(both);
        }
        case MASKING_NEUMANN: {
            return 0.25 / higher;
        }
        case MASKING_KELEMEN: {
            return 1.0 / m2;
        }
        case MASKING_ASHIKHMIN_SHIRLEY: {
            return 0.5 / (sqrt(m2) * higher);
        }
        case MASKING_ASHIKHMIN_PREMOZE: {
            return 0.25 / (higher + min(wo.z, wi.z) * (1.0 - higher));
        }
        case MASKING_DUER: {
            return (m2 / (m.z * m.z)) / (m.z * m.z);
        }
        case MASKING_KURT: {
            return 0.5 / (sqrt(m2) * pow(both, p.kurt));
        }
        default: {
            return 1.0 / (smith(p, wo) * smith(p, wi));
        }
    }
}

/// F at the angle between `wo` and the half vector: its cosine is c = |wo + wi| / 2, its sine |wo - wi| / 2.
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let difference = wo - wi;
    let c = 0.5 * length(wo + wi);
    let s2 = 0.25 * dot(difference, difference);
    let excess = (p.ior - 1.0) * (p.ior + 1.0);
    if FRESNEL == FRESNEL_NONE {
        return vec3f(1.0);
    }
    if FRESNEL == FRESNEL_DIELECTRIC {
        // (c - g) / (c + g) and (n^2 c - g) / (n^2 c + g), their differences from those of the squares.
        let n2 = p.ior * p.ior;
        let g = sqrt(excess + c * c);
        let across = excess / ((c + g) * (c + g));
        let along = excess * (n2 * c * c - s2) / ((n2 * c + g) * (n2 * c + g));
        return vec3f(0.5 * (across * across + along * along));
    }
    let root = (p.ior - 1.0) / (p.ior + 1.0);
    let f0 = select(p.f0, vec3f(root * root), FRESNEL == FRESNEL_SCHLICK_IOR);
    return f0 + (1.0 - f0) * pow5(min(s2 / (1.0 + c), 1.0));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    if SHOWN == SHOWN_D {
        return vec3f(distribution(p, wo, wi));
    }
    if SHOWN == SHOWN_F {
        return fresnel(p, wo, wi);
    }
    if SHOWN == SHOWN_G {
        return vec3f(4.0 * visibility(p, wo, wi) * (wo.z * wi.z));
    }
    if SHOWN == SHOWN_VISIBILITY {
        return vec3f(visibility(p, wo, wi));
    }
    return fresnel(p, wo, wi) * (distribution(p, wo, wi) * visibility(p, wo, wi));
}

/// The alpha of a GGX as wide as D: of the same curvature at the peak, and for the exponential, which
/// has a cusp there, the one that keeps D / GGX between 0 and 1.5.
fn lobe_alpha(p: Params) -> f32 {
    switch DISTRIBUTION {
        case DISTRIBUTION_EXPONENTIAL: {
            return min(1.5 * p.alpha, 1.0);
        }
        case DISTRIBUTION_BLINN_PHONG: {
            return sqrt(2.0 / (p.exponent + 2.0));
        }
        case DISTRIBUTION_NISHINO: {
            return min(sqrt(-2.0 * expm1(-p.kappa) / (p.kappa * p.exponent)), 1.0);
        }
        default: {
            return p.alpha;
        }
    }
}

/// x: k of the cap z > -k wo.z that holds all directions above the horizon; y: 1 - k
/// (Eto and Tokuyoshi 2023, eq. 5).
fn cap_bound(alpha: f32, wo: vec3f) -> vec2f {
    let s = 1.0 + length(wo.xy);
    let a2 = alpha * alpha;
    let scale = 1.0 / (s * s + a2 * wo.z * wo.z);
    return vec2f((1.0 - alpha) * (1.0 + alpha) * s * s, a2 * (s * s + wo.z * wo.z)) * scale;
}

/// Visible normals of GGX by the spherical cap (Dupuy and Benyoub 2023), bounded.
fn sample_ggx(alpha: f32, wo: vec3f, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(alpha * wo.xy, wo.z));
    let bound = cap_bound(alpha, wo);
    let depth = 1.0 + bound.x * stretched.z;
    let rest = (1.0 - u.y) * depth;
    let lift = bound.y * stretched.z;
    let rim2 = dot(stretched.xy, stretched.xy) + lift * (1.0 + bound.x) * stretched.z;
    let r = sqrt(u.y * (rim2 + rest * depth));
    let phi = TWO_PI * u.x;
    let half_std = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest + lift);
    let h = normalize(vec3f(alpha * half_std.xy, half_std.z));
    return 2.0 * dot(wo, h) * h - wo;
}

/// A direction with density cos^n around the mirror direction r of `wo`; the tangents are
/// those of Duff et al. 2017 for r.z > 0.
fn sample_phong(p: Params, wo: vec3f, u: vec2f) -> vec3f {
    let local = direction_below_pole(-expm1(log1p(-u.y) / (p.exponent + 1.0)), TWO_PI * u.x);
    let r = vec3f(-wo.xy, wo.z);
    let a = -1.0 / (1.0 + r.z);
    let tangent = vec3f(1.0 + a * r.x * r.x, a * r.x * r.y, -r.x);
    let bitangent = vec3f(a * r.x * r.y, 1.0 + a * r.y * r.y, -r.y);
    return local.x * tangent + local.y * bitangent + local.z * r;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if SHOWN != SHOWN_PRODUCT && SHOWN != SHOWN_D {
        return cosine_sample(u.yx);
    }
    if DISTRIBUTION == DISTRIBUTION_PHONG {
        return sample_phong(p, wo, u.xy);
    }
    return sample_ggx(lobe_alpha(p), wo, u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    if SHOWN != SHOWN_PRODUCT && SHOWN != SHOWN_D {
        return cosine_pdf(wi);
    }
    if DISTRIBUTION == DISTRIBUTION_PHONG {
        return (p.exponent + 1.0) * INV_TWO_PI * phong_lobe(p, wo, wi);
    }
    let alpha = lobe_alpha(p);
    return 0.5 * ggx(alpha, wo + wi) / (cap_bound(alpha, wo).x * wo.z + length(vec3f(alpha * wo.xy, wo.z)));
}
