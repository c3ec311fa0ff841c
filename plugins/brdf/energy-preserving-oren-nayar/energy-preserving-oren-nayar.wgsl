// Energy-preserving Oren-Nayar: Fujii's rough diffuse lobe, and in a second term all that it loses.
//
// With s the dot product of the horizontal parts, r the roughness and A = 1 / (1 + C1 r), Fujii's lobe is
// A (1 + r s/t) / pi, where t is the larger cosine for s > 0, else 1. At albedo 1 it returns
// E(w) = A (1 + r gain(w)) and lacks 1 - E(w) = A r loss(w); gain + loss = C1. Both are written so that
// nothing close is subtracted: white is white to the last digits.

const C1: f32 = 0.287793409210806; // 1/2 - 2/(3 pi)
const MEAN_LOSS: f32 = 0.215305196753882; // 6/(5 pi) - 1/6: the mean of loss(w) over the cosine

/// What s/t returns of light that comes from everywhere; 0 at the pole.
fn gain(w: vec3f) -> f32 {
    let sine = length(w.xy);
    let rest = w.z * (1.0 + sine + sine * sine) / (1.0 + sine) - 1.0;
    return max(INV_PI * sine * (atan2(sine, w.z) - sine * w.z + rest * (2.0 / 3.0)), 0.0);
}

/// C1 - gain(w), which near the horizon is w.z / pi.
fn loss(w: vec3f) -> f32 {
    let sine = length(w.xy);
    let level = (0.5 * PI - 2.0 / 3.0) * w.z * w.z - (2.0 / 3.0) * sine * w.z * (1.0 + sine + sine * sine);
    return INV_PI * (level / (1.0 + sine) + sine * (atan2(w.z, sine) + sine * w.z));
}

/// 1 + r (more + s). Where wo and wi graze the surface from opposite sides, s is close to -1:
/// 1 + s = (|(wo + wi).xy|^2 + wo.z^2 + wi.z^2) / 2 has the digits.
fn tilted(p: Params, wo: vec3f, wi: vec3f, more: f32) -> f32 {
    let s = dot(wo.xy, wi.xy);
    if s > 0.0 {
        return 1.0 + p.roughness * (more + s);
    }
    let m = wo + wi;
    let rise = 0.5 * (dot(m.xy, m.xy) + wo.z * wo.z + wi.z * wi.z);
    return (1.0 - p.roughness) + p.roughness * (more + rise);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let a = 1.0 / (1.0 + C1 * p.roughness);
    let s = dot(wo.xy, wi.xy);
    var once = 1.0 + p.roughness * s / max(wo.z, wi.z);
    if s <= 0.0 {
        once = tilted(p, wo, wi, 0.0);
    }
    // What the first lobe lacks leaves after more bounces: shared out by loss(wo) loss(wi), and
    // tinted by a geometric series of the albedo.
    let mean_lost = a * p.roughness * MEAN_LOSS;
    let tint = p.albedo * (1.0 - mean_lost) / (1.0 - p.albedo * mean_lost);
    let often = p.roughness * loss(wo) * loss(wi) / MEAN_LOSS;
    return p.albedo * (once + tint * often) * (INV_PI * a);
}

/// Chance of the lobe towards the viewer: what of the white albedo comes from s (1/t - 1), where s > 0.
fn towards_share(p: Params, wo: vec3f) -> f32 {
    return p.roughness * gain(wo) / (1.0 + C1 * p.roughness);
}

/// The rest of f cos is close to cos(wi) (1 + tilt s), and this is sampled exactly: of a direction by the
/// cosine and its mirror image in azimuth one is taken, in proportion to 1 + tilt s and 1 - tilt s.
/// s (1/t - 1) cos(wi) is a triangle over the height of wi, with its top at wo's, times cos(dphi).
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let sine = length(wo.xy);
    let towards = wo.xy / max(sine, 1e-30);
    let share = towards_share(p, wo);
    if u.z < share {
        var z = sqrt(u.y * wo.z);
        var one_minus_z = 1.0 - z;
        if u.y >= wo.z {
            one_minus_z = sine * sqrt((1.0 - u.y) / (1.0 + wo.z));
            z = 1.0 - one_minus_z;
        }
        let aside = 2.0 * u.x - 1.0;
        let along = 2.0 * sqrt(u.x * (1.0 - u.x));
        let r = sqrt(one_minus_z * (1.0 + z));
        return vec3f(r * (along * towards + aside * vec2f(-towards.y, towards.x)), z);
    }
    let wi = cosine_sample(u.xy);
    let more = loss(wo);
    let kept = 0.5 * tilted(p, wo, wi, more) / (1.0 + p.roughness * more);
    if u.z - share < kept * (1.0 - share) {
        return wi;
    }
    return vec3f(wi.xy - 2.0 * dot(wi.xy, towards) * towards, wi.z);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let share = towards_share(p, wo);
    let more = loss(wo);
    var density = (1.0 - share) * cosine_pdf(wi) * tilted(p, wo, wi, more) / (1.0 + p.roughness * more);
    let s = dot(wo.xy, wi.xy);
    if s > 0.0 {
        // 1 - z = sine^2 / (1 + z).
        let sine_o = length(wo.xy);
        let sine_i = length(wi.xy);
        let fall = sine_i * sine_i * (1.0 + wo.z) / (sine_o * sine_o * (1.0 + wi.z));
        density += share * min(wi.z / wo.z, fall) * s / max(sine_o * sine_i, 1e-30);
    }
    return density;
}
