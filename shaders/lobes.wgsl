// Directions drawn by the tables that a native library made of its material, or the host of a BRDF without sampling
// (brdf_sdk::native::lobes): for a view, the density of the half vector at nodes of s = sin^2(theta_h / 2) and of
// the azimuth from `wo`'s, bilinear between them; the azimuth counts in quarters, t = y / (|x| + |y|) in each. A
// node is drawn by its share, and then a place under its hat. Each `wo` has the tables of the nearest view.
//
// The linker says whether views go around (`lobe_around`), and which share of the samples is drawn by the cosine,
// whatever the tables hold (LOBE_COSINES): no direction is left out.

/// A place among nodes: the lower one, and the share of the one above.
struct LobePlace {
    low: u32,
    part: f32,
}

/// The place at `steps` steps of `count`; not below 0.
fn lobe_place(steps: f32, count: u32) -> LobePlace {
    let low = min(u32(steps), count - 1u);
    return LobePlace(low, min(steps - f32(low), 1.0));
}

/// Steps between nodes along s and the azimuth.
fn lobe_steps() -> vec2u {
    return vec2u(lobe_densities_size(2u), lobe_densities_size(3u));
}

/// The view whose tables serve `wo`: the nearest by sqrt(1 - cos), and where views go around by the azimuth.
fn lobe_view(wo: vec3f) -> u32 {
    let last = f32(lobe_rows_size(0u) - 1u);
    let row = u32(min(sqrt(max(1.0 - wo.z, 0.0)) * last + 0.5, last));
    if lobe_around() {
        let columns = lobe_rows_size(1u);
        let turns = precise_atan2(wo.y, wo.x) * INV_TWO_PI + 1.0;
        return row * columns + u32(turns * f32(columns) + 0.5) % columns;
    }
    return row;
}

/// Where the azimuth of half vectors is measured from: `wo`'s, or the tangent where it has none.
fn lobe_axis(wo: vec3f) -> vec2f {
    let across = length(wo.xy);
    if across == 0.0 {
        return vec2f(1.0, 0.0);
    }
    return wo.xy / across;
}

/// s at a number of steps, in units of its part at the first: whole numbers.
fn lobe_fourth(step: f32) -> f32 {
    return (step * step) * (step * step);
}

/// s at the first step.
fn lobe_unit(steps: u32) -> f32 {
    return 0.5 / lobe_fourth(f32(steps));
}

/// A node that was drawn, and what is left of the number that drew it, in [0, 1).
struct LobeNode {
    index: u32,
    left: f32,
}

/// The node of a slot (brdf_sdk::native::slots) that holds the place `at` among the slots.
fn lobe_node(slot: u32, at: f32) -> LobeNode {
    let first = (slot >> 8u) & 4095u;
    return LobeNode(slot & 255u, (at - f32(first)) / f32(slot >> 20u));
}

/// A direction drawn for the view `wo`; `u` in [0, 1)^3, of which the third is not needed: the first number also
/// chooses how to draw, the second also the side, and what is left of them is as even as they were.
fn lobe_sample(wo: vec3f, u: vec3f) -> vec3f {
    if u.x < LOBE_COSINES {
        return cosine_sample(vec2f(u.x / LOBE_COSINES, u.y));
    }
    let steps = lobe_steps();
    let view = lobe_view(wo);
    let rows = f32(lobe_rows_size(2u));
    let of_rows = min((u.x - LOBE_COSINES) * (rows / (1.0 - LOBE_COSINES)), rows * 0x1.fffffep-1);
    let along = lobe_node(lobe_rows_at(view * lobe_rows_size(2u) + u32(of_rows)), of_rows);
    let slots = lobe_columns_size(3u);
    let is_mirrored = !lobe_around() && u.y < 0.5;
    let of_columns = select(fract(2.0 * u.y), u.y, lobe_around()) * f32(slots);
    let first = (view * lobe_columns_size(2u) + along.index) * slots;
    let around = lobe_node(lobe_columns_at(first + u32(of_columns)), of_columns);

    let node = f32(along.index);
    let low = lobe_fourth(max(node - 1.0, 0.0));
    let here = lobe_fourth(node);
    let high = lobe_fourth(min(node + 1.0, f32(steps.x)));
    let s = clamp(lobe_unit(steps.x) * (here + hat_sample(here - low, high - here, along.left)), 0.0, 0.5);
    var rise = 1.0;
    var fall = 1.0;
    if !lobe_around() {
        rise = select(1.0, 0.0, around.index == 0u);
        fall = select(1.0, 0.0, around.index == steps.y);
    }
    let t = (f32(around.index) + hat_sample(rise, fall, around.left)) / f32(steps.y);
    var side = select(1.0, -1.0, is_mirrored);
    var quarters = clamp(2.0 * t, 0.0, 2.0);
    if lobe_around() {
        // Before the first node lies the last step.
        let turns = select(t, t + 1.0, t < 0.0);
        side = select(1.0, -1.0, turns > 0.5);
        quarters = clamp(min(4.0 * turns, 4.0 - 4.0 * turns), 0.0, 2.0);
    }
    let x = 1.0 - quarters;
    let y = side * (1.0 - abs(x));
    let axis = lobe_axis(wo);
    let r = 2.0 * sqrt(s * (1.0 - s) / (x * x + y * y));
    let h = vec3f(r * (axis.x * x - axis.y * y), r * (axis.y * x + axis.x * y), 1.0 - 2.0 * s);
    return 2.0 * dot(wo, h) * h - wo;
}

/// The density of a view, at places among its nodes [1 / (2 ds dt)].
fn lobe_density(view: u32, along: LobePlace, around: LobePlace) -> f32 {
    let steps = lobe_steps();
    let corners = lobe_densities_at((view * steps.x + along.low) * steps.y + around.low);
    let both = mix(corners.xz, corners.yw, around.part);
    return mix(both.x, both.y, along.part);
}

/// Density of `lobe_sample` [1/sr].
fn lobe_pdf(wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let length_of_m = length(m);
    let across = dot(m.xy, m.xy);
    let steps = lobe_steps();
    // s = (1 - cos) / 2, without the difference.
    let s = 0.5 * across / (length_of_m * (length_of_m + m.z));
    var along = lobe_place(sqrt(sqrt(2.0 * s)) * f32(steps.x), steps.x);
    let low = lobe_fourth(f32(along.low));
    let high = lobe_fourth(f32(along.low) + 1.0);
    along.part = clamp((s * (2.0 * lobe_fourth(f32(steps.x))) - low) / (high - low), 0.0, 1.0);

    let axis = lobe_axis(wo);
    let x = dot(axis, m.xy);
    let y = axis.x * m.y - axis.y * m.x;
    let sum = abs(x) + abs(y);
    let inverse = 1.0 / max(sum, 1e-30);
    var quarters = abs(y) * inverse;
    // dt / dphi, which at the pole is any between a half and 1.
    let squeeze = select(1.0, across * inverse * inverse, sum > 1e-18);
    quarters = select(quarters, 2.0 - quarters, x < 0.0);
    if lobe_around() {
        quarters = 0.5 * select(quarters, 4.0 - quarters, y < 0.0);
    }
    let around = lobe_place(0.5 * quarters * f32(steps.y), steps.y);
    let density = lobe_density(lobe_view(wo), along, around);
    // dh = dwi / (4 wo.h), and wo.h = |m| / 2.
    let by_tables = squeeze * density / (2.0 * length_of_m);
    return LOBE_COSINES * cosine_pdf(wi) + (1.0 - LOBE_COSINES) * by_tables;
}
