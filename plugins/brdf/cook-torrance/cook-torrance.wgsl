// Cook and Torrance 1982: f = F D G / (4 cos(wo) cos(wi)) with Beckmann's D. Their eq. 4 has pi for 4
// and another D; with this D and 4 the facets mirror all light.
//
// m2 = |wo + wi|^2 is 4 (wo.h)^2, and m.z / |wo + wi| is h.z: neither h nor an angle is needed.

const INV_SQRT_PI: f32 = 0.564189583547756;

/// Beckmann's D(h) [1/sr], eq. 9 as Walter 2007 normalises it (eq. 25): exp(-tan^2 / m^2) / (pi m^2 cos^4).
fn distribution(p: Params, m: vec3f) -> f32 {
    let slope = m.xy / (m.z * p.m);
    let secant2 = dot(m, m) / (m.z * m.z);
    return INV_PI * exp(-dot(slope, slope)) * (secant2 / p.m) * (secant2 / p.m);
}

/// Schlick's term, or Fresnel's for the index that gives F0 at normal incidence; e is its reciprocal,
/// (1 - sqrt(F0)) / (1 + sqrt(F0)), which stays finite at F0 = 1.
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let sum = wo + wi;
    let difference = wo - wi;
    let c = 0.5 * length(sum);
    let s2 = 0.25 * dot(difference, difference);
    if FRESNEL == FRESNEL_SCHLICK {
        return p.f0 + (1.0 - p.f0) * pow5(min(s2 / (1.0 + c), 1.0));
    }
    // With g = sqrt(1 - e^2 s2), Fresnel's ratios (e c - g) / (e c + g) and (c - e g) / (c + e g);
    // the differences follow from those of the squares, which both hold 1 - e^2.
    let root = sqrt(p.f0);
    let e = (1.0 - root) / (1.0 + root);
    let rest = 4.0 * root / ((1.0 + root) * (1.0 + root));
    let g = sqrt(e * e * c * c + rest);
    let across = rest / ((e * c + g) * (e * c + g));
    let along = rest * (c * c - e * e * s2) / ((c + e * g) * (c + e * g));
    return 0.5 * (across * across + along * along);
}

/// Smith's Lambda of Beckmann's slopes, at a = 1 / (m tan): (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi)).
fn lambda(p: Params, w: vec3f) -> f32 {
    let across = p.m * length(w.xy);
    if w.z > 5.0 * across {
        return 0.0;
    }
    let a = w.z / across;
    if MASKING == MASKING_SMITH_RATIONAL {
        // Walter 2007, eq. 27, as Lambda = 1 / G1 - 1.
        return max(1.0 - 1.259 * a + 0.396 * a * a, 0.0) / (a * (3.535 + 2.181 * a)) * select(0.0, 1.0, a < 1.6);
    }
    // erfc(a) / exp(-a^2) to 1.5e-7 of exp(a^2) (Abramowitz and Stegun 7.1.26); what counts is 1 + Lambda.
    let t = 1.0 / (1.0 + 0.3275911 * a);
    let erfc = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return 0.5 * exp(-a * a) * (INV_SQRT_PI / a - erfc);
}

/// G / (4 cos(wo) cos(wi)).
fn visibility(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    if MASKING == MASKING_IMPLICIT {
        return 0.25;
    }
    let facing = 0.25 / (wo.z * wi.z);
    if MASKING == MASKING_V_CAVITIES {
        // The paper's minimum of 1 and 2 h.z cos / (wo.h), for the lower of both directions.
        let m = wo + wi;
        return min(facing, m.z / (dot(m, m) * max(wo.z, wi.z)));
    }
    return facing / (1.0 + lambda(p, wo) + lambda(p, wi));
}

/// The part of D beyond the slope (1 + sin) / cos of the steepest facet that reflects `wo` above the
/// horizon; no draw is spent on it.
fn steeper(p: Params, wo: vec3f) -> f32 {
    let steepest = (1.0 + length(wo.xy)) / (wo.z * p.m);
    return exp(-steepest * steepest);
}

/// Whether the facet of this slope reflects `wo` above the horizon; then it also faces `wo`.
fn reflects(wo: vec3f, slope: vec2f) -> bool {
    return wo.z * (1.0 - dot(slope, slope)) + 2.0 * dot(wo.xy, slope) > 0.0;
}

/// pdf / D. A cavity's sides are drawn with 2 D h.z; of that the facet gets its part (wo.h) / (2 wo.z h.z)
/// of the area that the viewer sees, or all where the other side reflects below the horizon.
fn share(p: Params, wo: vec3f, m: vec3f) -> f32 {
    let both = reflects(wo, -m.xy / m.z);
    return select(m.z / dot(m, m), 0.25 / wo.z, both) / (1.0 - steeper(p, wo));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return fresnel(p, wo, wi) * (distribution(p, wo + wi) * visibility(p, wo, wi));
}

/// A cavity drawn by D, and of its two sides one in proportion to the area that the viewer sees: the
/// visible normals of V-cavities (Heitz and d'Eon 2014, 4.2), for each masking term.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let drawn = u.y * (1.0 - steeper(p, wo));
    // -log(1 - drawn), by the series of 2 artanh where 1 - drawn would lose the digits of a small one.
    let z = drawn / (2.0 - drawn);
    let z2 = z * z;
    let series = 2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 / 7.0)));
    let slope = p.m * sqrt(select(-log((1.0 - u.y) + u.y * steeper(p, wo)), series, drawn < 0.1));
    let phi = TWO_PI * u.x;
    let side = vec2f(slope * cos(phi), slope * sin(phi));
    let lean = dot(wo.xy, side);
    let area = select(0.0, wo.z + lean, reflects(wo, side));
    let other_area = select(0.0, wo.z - lean, reflects(wo, -side));
    let picked = select(-side, side, u.z * (area + other_area) < area);
    let h = normalize(vec3f(picked, 1.0));
    return 2.0 * dot(wo, h) * h - wo;
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    return distribution(p, m) * share(p, wo, m);
}

/// F G cos(wi) over the share: D has cancelled.
fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return fresnel(p, wo, wi) * (visibility(p, wo, wi) * wi.z / share(p, wo, wo + wi));
}
