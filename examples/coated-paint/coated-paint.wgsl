// Coated paint: two lobes, each sampled on its own. u.z picks the lobe, the pdf is that of the mixture.

fn fresnel(p: Params, cosine: f32) -> f32 {
    if COAT {
        return p.f0 + (1.0 - p.f0) * pow5(1.0 - min(cosine, 1.0));
    }
    return 0.0;
}

/// What the coat lets through, 1 - fresnel: 1 - (1 - c)^5 written out, since at the horizon its difference has no digits.
fn passed(p: Params, cosine: f32) -> f32 {
    if COAT {
        let c = min(cosine, 1.0);
        return (1.0 - p.f0) * c * (5.0 - c * (10.0 - c * (10.0 - c * (5.0 - c))));
    }
    return 1.0;
}

/// GGX around m = wo + wi, the half vector before it is normalised.
fn distribution(p: Params, m: vec3f) -> f32 {
    let a2 = p.alpha * p.alpha;
    let stretched = vec3f(m.xy / p.alpha, m.z);
    let ratio = dot(m, m) / dot(stretched, stretched);
    return INV_PI * ratio * ratio / a2;
}

/// |(alpha w.x, alpha w.y, w.z)|: Smith's G1 is 2 w.z / (w.z + this).
fn stretched_length(p: Params, w: vec3f) -> f32 {
    return length(vec3f(p.alpha * w.xy, w.z));
}

/// Chance that a sample goes to the coat: what it reflects, against what reaches the base.
fn coat_share(p: Params, wo: vec3f) -> f32 {
    if COAT {
        return clamp(2.0 * fresnel(p, wo.z), 0.1, 0.9);
    }
    return 0.0;
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let g = 0.5 / (wi.z * stretched_length(p, wo) + wo.z * stretched_length(p, wi));
    let coat = fresnel(p, 0.5 * length(m)) * distribution(p, m) * g;
    let through = passed(p, wo.z) * passed(p, wi.z);
    return vec3f(coat) + p.base * (INV_PI * through);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z < coat_share(p, wo) {
        // Visible normals by spherical caps (Dupuy and Benyoub 2023).
        let stretched = normalize(vec3f(p.alpha * wo.xy, wo.z));
        let half_std = direction_below_pole(u.y * (1.0 + stretched.z), TWO_PI * u.x) + stretched;
        let h = normalize(vec3f(p.alpha * half_std.xy, half_std.z));
        return 2.0 * dot(wo, h) * h - wo;
    }
    let r = sqrt(u.x);
    return vec3f(r * cos(TWO_PI * u.y), r * sin(TWO_PI * u.y), sqrt(1.0 - u.x));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let share = coat_share(p, wo);
    let coat = 0.5 * distribution(p, wo + wi) / (wo.z + stretched_length(p, wo));
    return share * coat + (1.0 - share) * wi.z * INV_PI;
}
