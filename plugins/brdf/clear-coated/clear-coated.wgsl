// Clear-coated diffuse: a Lambertian base under a dielectric coat, each sampled on its own; u.z picks.
//
// f = F D G2 / (4 cos(wo) cos(wi)) + T(wo) T(wi) base / (pi (eta^2 (1 - base) + base mean T))
//
// Light enters by T(wi), goes to and fro between base and coat, and leaves by T(wo). Each time that it
// comes from the base, the part R = 1 - mean T / eta^2 is kept inside: the interface transmits the same both
// ways, but inside the light fills eta^2 times as much (Saunderson 1942). The bounces' sum
// base / (1 - base R), by eta^2 for the way out, gives the denominator. With T = 1 - albedo of the coat a white
// base returns T(wo), and nothing is lost.

/// T at a smooth interface, the mean of both polarisations: 1 - F without subtracting.
fn smooth_transmittance(p: Params, c: f32) -> f32 {
    let n2 = p.eta * p.eta;
    let g = sqrt((p.eta - 1.0) * (p.eta + 1.0) + c * c);
    let s = c + g;
    let t = n2 * c + g;
    return 2.0 * c * g * (1.0 / (s * s) + n2 / (t * t));
}

/// Fresnel's reflectance, exact for a dielectric: both amplitudes with eta^2 - 1 as a factor.
fn fresnel(p: Params, c: f32) -> f32 {
    let n2 = p.eta * p.eta;
    let excess = (p.eta - 1.0) * (p.eta + 1.0);
    let g = sqrt(excess + c * c);
    let s = (c + g) * (c + g);
    let t = (n2 * c + g) * (n2 * c + g);
    let across = excess / s;
    let along = excess * ((n2 + 1.0) * c * c - 1.0) / t;
    return 0.5 * (across * across + along * along);
}

/// What the facets of a coat that reflects everything would take from a direction at this cosine:
/// 1 - albedo of GGX without F. A fit from below.
fn masked(p: Params, cosine: f32) -> f32 {
    let a = p.alpha;
    let t = cosine / a;
    let normal = a * a / (1.134 - 0.947 * a + 1.603 * a * a);
    return normal * 1.171 * cosine / (cosine + 0.171) + t / (5.207 + 4.694 * t + 2.298 * t * t * t);
}

/// The cosine at which a smooth coat would reflect as much of the light as the facets that can be seen:
/// at grazing angles most of them are turned to the viewer. A fit.
fn facet_cosine(p: Params, cosine: f32) -> f32 {
    let a = p.alpha;
    let grazing = a / (0.2566 + 0.8288 * sqrt(a) + 0.9856 * a);
    let normal = 1.0 - a / (0.4873 + 1.986 * a);
    let knee = 3.332 * a;
    // A hyperbola from 0 to 1, straight beyond the knee.
    let bend = cosine * cosine * (sqrt(1.0 + knee * knee) + knee) / (sqrt(cosine * cosine + knee * knee) + knee);
    let rise = bend + 3.704 * a * cosine * (1.0 - cosine);
    let x = 1.0 / p.eta - 0.6;
    return min(mix(grazing, normal, rise) * (1.0 - 1.146 * (1.0 - cosine) * x * x), 1.0);
}

/// T: what of a direction's light the coat does not reflect. Both fits lean so that coat and base together
/// return never more than 1; over the whole range of eta and alpha they lose 0.022 at most, 0.006 in the mean.
fn transmittance(p: Params, cosine: f32) -> f32 {
    let taken = masked(p, cosine);
    return taken + (1.0 - taken) * smooth_transmittance(p, facet_cosine(p, cosine));
}

/// The mean of T over the cosine, by Gauss's rule of five points; right to 3e-4.
fn mean_transmittance(p: Params) -> f32 {
    return 0.0111140873 * transmittance(p, 0.0469100770)
        + 0.1104599446 * transmittance(p, 0.2307653449)
        + 0.2844444444 * transmittance(p, 0.5)
        + 0.3681767254 * transmittance(p, 0.7692346551)
        + 0.2258047983 * transmittance(p, 0.9530899230);
}

/// The base's part of f is T(wo) T(wi) times this.
fn underneath(p: Params) -> vec3f {
    let n2 = p.eta * p.eta;
    return INV_PI * p.base / (n2 * (1.0 - p.base) + p.base * mean_transmittance(p));
}

/// |(alpha w.x, alpha w.y, w.z)|, from which Smith's G1 = 2 w.z / (w.z + len).
fn stretched_length(p: Params, w: vec3f) -> f32 {
    return length(vec3f(p.alpha * w.xy, w.z));
}

/// D(h) of GGX from m = wo + wi: no 1 - cos^2, and so no digits lost at small alpha.
fn distribution(p: Params, m: vec3f) -> f32 {
    let stretched = vec3f(m.xy / p.alpha, m.z);
    let ratio = dot(m, m) / (p.alpha * dot(stretched, stretched));
    return INV_PI * ratio * ratio;
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let g2 = 0.5 / (wi.z * stretched_length(p, wo) + wo.z * stretched_length(p, wi));
    let coat = fresnel(p, min(0.5 * length(m), 1.0)) * distribution(p, m) * g2;
    return vec3f(coat) + underneath(p) * (transmittance(p, wo.z) * transmittance(p, wi.z));
}

/// Chances of the base and of the coat: the albedo of the base's largest channel, against the coat's; more of it
/// under a rough coat where it is bright, since both together are then so close to Lambert that the cosine fits best.
/// The coat's may be 0, which 1 less the base's is not where division is not exact.
fn shares(p: Params, wo: vec3f) -> vec2f {
    let brightest = max(p.base.x, max(p.base.y, p.base.z));
    let inside = underneath(p);
    let under = max(inside.x, max(inside.y, inside.z)) * PI * mean_transmittance(p) * transmittance(p, wo.z);
    let coat = (1.0 - masked(p, wo.z)) * fresnel(p, facet_cosine(p, wo.z));
    let over = coat * (1.0 - p.alpha * p.alpha * brightest);
    return vec2f(under, over) / (under + over);
}

/// 1 - k: the part of the cap below the equator that gives no direction above the horizon, and is not
/// drawn from (Eto and Tokuyoshi 2023 eq. 5, with 1 - k written without subtracting).
fn spare(p: Params, wo: vec3f) -> f32 {
    let a2 = p.alpha * p.alpha;
    let s = 1.0 + length(wo.xy);
    return 2.0 * a2 * s / (s * s + a2 * wo.z * wo.z);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z >= shares(p, wo).x {
        // Visible normals: where alpha is 1, the reflected direction is uniform on a cap down to
        // -k stretched.z, and the half vector is the sum of both. Its point has the height
        // 1 - u.y depth; neither its radius nor the sum's height, `rest`, subtracts close numbers.
        let stretched = normalize(vec3f(p.alpha * wo.xy, wo.z));
        let unused = spare(p, wo) * stretched.z;
        let depth = 1.0 + stretched.z - unused;
        let rest = (1.0 - u.y) * depth + unused;
        let below = dot(stretched.xy, stretched.xy) / (1.0 + stretched.z);
        let r = sqrt(u.y * depth * (rest + below));
        let phi = TWO_PI * u.x;
        let half_std = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest);
        let h = normalize(vec3f(p.alpha * half_std.xy, half_std.z));
        return 2.0 * dot(wo, h) * h - wo;
    }
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let chances = shares(p, wo);
    let k = 1.0 - spare(p, wo);
    let coat = 0.5 * distribution(p, wo + wi) / (k * wo.z + stretched_length(p, wo));
    return chances.y * coat + chances.x * cosine_pdf(wi);
}
