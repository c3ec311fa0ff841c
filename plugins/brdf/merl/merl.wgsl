// MERL: bins of theta_h (finer towards the mirror direction), theta_d and phi_d.
//
// The angles come from m = wo + wi and d = wi - wo, which are at right angles; exchanging the directions turns
// d around, which is half a turn of phi_d, and files of 180 bins hold half a turn.

const DEGREES: f32 = 180.0 * INV_PI;

/// Bins of theta_h from one texel to the next; the fourth bin of a texel is the first of the next.
const RUN: f32 = 3.0;

/// theta_h, theta_d and phi_d in bins: 90 of theta_h by its square root, of the others each a degree.
fn place(wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let d = wi - wo;
    let length_of_m = length(m);
    let across = dot(m.xy, m.xy);
    // Around the half vector: where theta_h grows, and at right angles to it; both times |m| and the root of `across`.
    let down = dot(d.xy, m.xy) * m.z - d.z * across;
    let aside = (m.x * d.y - m.y * d.x) * length_of_m;
    // Exchanging the directions turns both signs: to the last bit the same where half a turn is all there is.
    let is_behind = aside < 0.0;
    let quarter = precise_atan2_within(abs(aside), abs(down)) * DEGREES;
    let half = select(quarter, 180.0 - quarter, (down < 0.0) != is_behind);
    let other_half = select(0.0, 180.0, reflectance_size(2u) > 300u);
    let s = 0.5 * across / (length_of_m * (length_of_m + m.z));
    let theta_d = angle_of_half(0.25 * dot(d, d) / (2.0 + length_of_m)) * DEGREES;
    return vec3f(root_of_angle(s) * 90.0, theta_d, half + select(0.0, other_half, is_behind));
}

/// A bin's colour in steps of its exponent: three times nine bits.
fn steps_of(bin: u32) -> vec3f {
    return vec3f(f32(bin & 511u), f32((bin >> 9u) & 511u), f32((bin >> 18u) & 511u));
}

/// The sum and four bins, each times its share: above their colours bins have the exponent of their steps, which is
/// also that of an f32, less what the shares have more.
fn with_bins(sum: vec3f, bins: vec4u, shares: vec4f) -> vec3f {
    let steps = shares * bitcast<vec4f>((bins >> vec4u(4u)) & vec4u(31u << 23u));
    let two = sum + steps.x * steps_of(bins.x) + steps.y * steps_of(bins.y);
    return two + steps.z * steps_of(bins.z) + steps.w * steps_of(bins.w);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let runs = reflectance_size(1u);
    let columns = reflectance_size(2u);
    let bins = place(wo, wi);
    // The table has one bin more at every end: below the first of theta_h and behind the last of both angles the same
    // once more, of phi_d, which goes around, those of the other end. So row 1 is the first bin of theta_d; row 0 is
    // theta_d = 0.
    if INTERPOLATION == INTERPOLATION_NEAREST {
        let last = vec3f(89.0, 89.0, f32(columns) - 3.0);
        let cell = vec3u(min(bins, last)) + 1u;
        let texel = reflectance_at(cell.z + columns * (cell.x / u32(RUN) + runs * cell.y));
        return with_bins(vec3f(0.0), vec4u(texel[cell.x % u32(RUN)]), vec4f(unit_at(0u), 0.0, 0.0, 0.0));
    }
    // Bins' middles are a step apart, theta_d = 0 half a step before the first one's.
    let at = bins + vec3f(0.5, min(bins.y, 0.5), 0.5);
    let low = floor(at);
    let part = at - low;
    let run = floor(low.x * (1.0 / RUN) + 0.5 / RUN);
    let in_run = low.x - RUN * run;
    // Whole numbers below 2^24.
    let first = u32(low.z + f32(columns) * (run + f32(runs) * low.y));
    let next = first + columns * runs;
    let a = reflectance_at(first);
    let b = reflectance_at(first + 1u);
    let c = reflectance_at(next);
    let e = reflectance_at(next + 1u);
    let is_first = in_run == 0.0;
    let is_second = in_run == 1.0;
    let one = vec4u(a.y, b.y, c.y, e.y);
    let two = vec4u(a.z, b.z, c.z, e.z);
    let nearer = select(select(two, one, is_second), vec4u(a.x, b.x, c.x, e.x), is_first);
    let farther = select(select(vec4u(a.w, b.w, c.w, e.w), two, is_second), one, is_first);

    let across = unit_at(0u) * vec2f(1.0 - part.z, part.z);
    let shares = vec4f((1.0 - part.y) * across, part.y * across);
    return with_bins(with_bins(vec3f(0.0), nearer, (1.0 - part.x) * shares), farther, part.x * shares);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return lobe_sample(wo, u);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return lobe_pdf(wo, wi);
}
