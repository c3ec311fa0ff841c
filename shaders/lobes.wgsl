// Directions drawn by the tables that a native library made of its material, or the host of a BRDF without sampling
// (brdf_sdk::native::lobes): for a view, the density of the half vector in cells of s = sin^2(theta_h / 2) and of
// the azimuth from `wo`'s, which counts in quarters, t = y / (|x| + |y|) in each. A cell is drawn by its share, and then
// a place in it. Each `wo` has the tables of the nearest view, and they leave no direction out. The linker says whether
// views go around (`lobe_around`).

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

/// The fourth power.
fn lobe_fourth(x: f32) -> f32 {
    return (x * x) * (x * x);
}

/// A row or a cell that was drawn, and what is left of the number that drew it, in [0, 1).
struct LobeDraw {
    index: f32,
    left: f32,
}

/// Who owns a slot (brdf_sdk::native::slots) that holds the place `at` among the slots.
fn lobe_owner(slot: u32, at: f32) -> LobeDraw {
    let first = (slot >> 8u) & 4095u;
    return LobeDraw(f32(slot & 255u), (at - f32(first)) / f32(slot >> 20u));
}

/// A direction drawn for the view `wo`; `u` in [0, 1)^3, of which the third is not needed: the first number also
/// chooses how to draw, the second also the side, and what is left of them is as even as they were.
fn lobe_sample(wo: vec3f, u: vec3f) -> vec3f {
    let view = lobe_view(wo);
    let row_slots = lobe_rows_size(2u);
    let of_rows = u.x * f32(row_slots);
    let row = lobe_owner(lobe_rows_at(view * row_slots + u32(of_rows)), of_rows);
    let rows = lobe_columns_size(2u);
    let slots = lobe_columns_size(3u);
    let is_mirrored = !lobe_around() && u.y < 0.5;
    let of_columns = select(fract(2.0 * u.y), u.y, lobe_around()) * f32(slots);
    let first = (view * rows + u32(row.index)) * slots;
    let column = lobe_owner(lobe_columns_at(first + u32(of_columns)), of_columns);

    let low = lobe_fourth(row.index);
    let s = (0.5 / lobe_fourth(f32(rows))) * (low + (lobe_fourth(row.index + 1.0) - low) * row.left);
    let t = (column.index + column.left) * (2.0 / f32(lobe_densities_size(3u)));
    var side = select(1.0, -1.0, is_mirrored);
    var quarters = t;
    if lobe_around() {
        // The middle of the first cell is `wo`'s azimuth; before it lies the last one's second half.
        let turned = 2.0 * t - 2.0 / f32(lobe_densities_size(3u));
        let turn = select(turned, turned + 4.0, turned < 0.0);
        side = select(1.0, -1.0, turn > 2.0);
        quarters = min(turn, 4.0 - turn);
    }
    let x = 1.0 - quarters;
    let y = side * (1.0 - abs(x));
    let axis = lobe_axis(wo);
    let r = 2.0 * sqrt(s * (1.0 - s) / (x * x + y * y));
    let h = vec3f(r * (axis.x * x - axis.y * y), r * (axis.y * x + axis.x * y), 1.0 - 2.0 * s);
    return 2.0 * dot(wo, h) * h - wo;
}

/// Density of `lobe_sample` [1/sr].
fn lobe_pdf(wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let length_of_m = length(m);
    let across = dot(m.xy, m.xy);
    let rows = lobe_densities_size(2u);
    let columns = lobe_densities_size(3u);
    // s = (1 - cos) / 2, without the difference.
    let s = 0.5 * across / (length_of_m * (length_of_m + m.z));
    let row = min(u32(sqrt(sqrt(2.0 * s)) * f32(rows)), rows - 1u);

    let axis = lobe_axis(wo);
    let x = dot(axis, m.xy);
    let y = axis.x * m.y - axis.y * m.x;
    let sum = abs(x) + abs(y);
    let inverse = 1.0 / max(sum, 1e-30);
    var quarters = abs(y) * inverse;
    // dt / dphi, which at the pole is any between a half and 1.
    let squeeze = select(1.0, across * inverse * inverse, sum > 1e-18);
    quarters = select(quarters, 2.0 - quarters, x < 0.0);
    var column = min(u32(quarters * (0.5 * f32(columns))), columns - 1u);
    if lobe_around() {
        let turn = select(quarters, 4.0 - quarters, y < 0.0);
        column = u32(turn * (0.25 * f32(columns)) + 0.5) % columns;
    }
    let density = lobe_densities_at((lobe_view(wo) * rows + row) * columns + column);
    // dh = dwi / (4 wo.h), and wo.h = |m| / 2.
    return squeeze * density / (2.0 * length_of_m);
}
