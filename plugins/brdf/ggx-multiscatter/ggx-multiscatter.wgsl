// GGX plus a lobe that gives back what single scattering loses (Kulla and Conty 2017).
//
// The first lobe is that of the plugin ggx, with one width. The second one has the shape (1 - E(wo))
// (1 - E(wi)), so that where nothing is absorbed the albedo is 1 for every wo; E is in tables.

const COLUMNS: u32 = 96u;
const ROWS: u32 = 64u;
/// Points of the tables' quadrature in [0, 1)^2, of which half of the azimuths do, and over cosines.
const POINTS_X: u32 = 32u;
const POINTS_Y: u32 = 128u;
const COSINES: u32 = 32u;

/// |(alpha w.x, alpha w.y, w.z)|, from which Smith's G1 = 2 w.z / (w.z + len).
fn stretched_length(alpha: f32, w: vec3f) -> f32 {
    return length(vec3f(alpha * w.xy, w.z));
}

/// D of m = wo + wi [1/sr], Walter 2007 eq. 33 without NoH.
fn distribution(alpha: f32, m: vec3f) -> f32 {
    let stretched = vec3f(m.xy / alpha, m.z);
    let ratio = dot(m, m) / dot(stretched, stretched) / alpha;
    return INV_PI * ratio * ratio;
}

/// A direction reflected about a visible normal (Dupuy and Benyoub 2023).
fn reflected(alpha: f32, wo: vec3f, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(alpha * wo.xy, wo.z));
    let depth = 1.0 + stretched.z;
    let rest = (1.0 - u.y) * depth;
    let r = sqrt(u.y * (dot(stretched.xy, stretched.xy) + rest * depth));
    let phi = TWO_PI * u.x;
    let cap = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest);
    let h = normalize(vec3f(alpha * cap.xy, cap.z));
    return 2.0 * dot(wo, h) * h - wo;
}

/// 1 - E: of light reflected about visible normals G2 / G1 leaves, and nothing of what goes below. What is
/// lost comes of steep facets, u.y near 1: there the points of u.y = 1 - t^3 are dense.
fn lost_at_cosine(alpha: f32, cosine: f32) -> f32 {
    let wo = vec3f(sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine);
    let len_o = stretched_length(alpha, wo);
    var sum = 0.0;
    for (var i = 0u; i < POINTS_X; i++) {
        for (var j = 0u; j < POINTS_Y; j++) {
            let t = (f32(j) + 0.5) / f32(POINTS_Y);
            let u = vec2f((f32(i) + 0.5) / f32(2u * POINTS_X), 1.0 - t * t * t);
            let wi = reflected(alpha, wo, u);
            var gone = 1.0;
            if wi.z > 0.0 {
                let len_i = stretched_length(alpha, wi);
                gone = 1.0 - wi.z * (wo.z + len_o) / (wi.z * len_o + wo.z * len_i);
            }
            sum += 3.0 * t * t * gone;
        }
    }
    return sum / f32(POINTS_X * POINTS_Y);
}

fn fill_lost(at: vec2f) -> f32 {
    return lost_at_cosine(max(at.y * at.y, 1e-4), max(at.x * at.x, 1e-6));
}

/// The integral of 2 cos (1 - E) over cos = x^2, d cos = 2 x dx, by Gauss's two points in each part.
fn fill_lost_on_average(at: vec2f) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k < COSINES; k++) {
        let side = select(-0.288675135, 0.288675135, k % 2u == 0u);
        let x = (f32(k / 2u) + 0.5 + side) / f32(COSINES / 2u);
        sum += 4.0 * x * x * x * lost_at_cosine(max(at.y * at.y, 1e-4), x * x);
    }
    return sum / f32(COSINES);
}

/// The table between its entries.
fn lost(alpha: f32, cosine: f32) -> f32 {
    let place = vec2f(sqrt(cosine) * f32(COLUMNS - 1u), sqrt(alpha) * f32(ROWS - 1u));
    let first = min(vec2u(place), vec2u(COLUMNS - 2u, ROWS - 2u));
    let part = place - vec2f(first);
    let i = first.x + COLUMNS * first.y;
    let below = mix(lost_at(i), lost_at(i + 1u), part.x);
    let above = mix(lost_at(i + COLUMNS), lost_at(i + COLUMNS + 1u), part.x);
    return mix(below, above, part.y);
}

fn lost_on_average(alpha: f32) -> f32 {
    let place = sqrt(alpha) * f32(ROWS - 1u);
    let first = min(u32(place), ROWS - 2u);
    let part = place - f32(first);
    return mix(lost_on_average_at(2u * first), lost_on_average_at(2u * first + 2u), part);
}

/// Schlick's term of the angle between wo and h, its 1 - c from |wo - wi|^2 (as in the plugin ggx).
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let difference = wo - wi;
    let one_minus_c = min(dot(difference, difference) / (4.0 + 2.0 * length(wo + wi)), 1.0);
    return p.f0 + (1.0 - p.f0) * pow5(one_minus_c);
}

/// Fresnel's part of light that left after two reflections or more: with the mean F of Schlick's term,
/// f0 + (1 - f0) / 21, and E in place of it at every bounce, a geometric series.
fn fresnel_of_rest(p: Params, average: f32) -> vec3f {
    let f = p.f0 + (1.0 - p.f0) / 21.0;
    return f * f * (1.0 - average) / (1.0 - f * average);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let g = 0.5 / (wi.z * stretched_length(p.alpha, wo) + wo.z * stretched_length(p.alpha, wi));
    let once = fresnel(p, wo, wi) * (distribution(p.alpha, wo + wi) * g);
    if !COMPENSATED {
        return once;
    }
    let average = lost_on_average(p.alpha);
    let rest = lost(p.alpha, wo.z) * (lost(p.alpha, wi.z) / average) * INV_PI;
    return once + fresnel_of_rest(p, average) * rest;
}

/// The part of the samples that are drawn from the cosine: the second lobe's part of the light where F
/// is 1, and more of them the rougher it is, since both lobes together come near to Lambert's.
fn share_of_rest(p: Params, wo: vec3f) -> f32 {
    if !COMPENSATED {
        return 0.0;
    }
    let square = p.alpha * p.alpha;
    return mix(lost(p.alpha, wo.z), 1.0, square * square);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z >= share_of_rest(p, wo) {
        return reflected(p.alpha, wo, u.xy);
    }
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let share = share_of_rest(p, wo);
    let once = 0.5 * distribution(p.alpha, wo + wi) / (wo.z + stretched_length(p.alpha, wo));
    return (1.0 - share) * once + share * cosine_pdf(wi);
}
