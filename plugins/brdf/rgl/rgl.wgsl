// RGL's adaptive parameterization: light over the square from which the viewer's visible normals are drawn.
//
// u of a direction is (sqrt(2 theta / pi), phi / 2 pi + 1/2), s the point of the square that draws u. Between
// viewers everything is mixed linearly, also the integrals that draws are looked up in, so that the mixture of
// two angles has a draw of its own. Of two azimuths one is drawn from, by its share.

/// The least u.x: half vectors within 1.4e-7 of the normal, where u has no density, count as that far away.
const LEAST_U: f32 = 3e-4;

/// The viewer among the file's: a step of azimuths and one of angles, with the share of the second end.
struct Viewer {
    column: u32,
    around: f32,
    row: u32,
    down: f32,
}

/// A step between nodes of a table, how far into it, and how far from its end along x.
struct Place {
    row: u32,
    column: u32,
    part: vec2f,
    rest: f32,
}

/// What is looked up of the normals about a place of u, for an azimuth, mixed to its row: the densities at both ends
/// of the step, the row's integral, what of it lies before the step and what behind, each with its own digits, and
/// the integral of the rows above.
struct Normals {
    left: f32,
    right: f32,
    whole: f32,
    before: f32,
    behind: f32,
    down: f32,
}

/// A point of the square with 1 - x, and the density of normals there.
struct Drawn {
    at: vec2f,
    rest: f32,
    density: f32,
}

fn isotropic() -> bool {
    return normal_ends_size(0u) == 1u;
}

/// The file has a part of the turn: what folds the viewer there.
fn fold_of(wo: vec3f) -> vec2f {
    let reduction = facts_at(1u);
    let by_y = select(1.0, -1.0, wo.y > 0.0);
    if reduction == 2u {
        return vec2f(by_y);
    }
    if reduction == 4u {
        return vec2f(select(1.0, -1.0, wo.x > 0.0), by_y);
    }
    return vec2f(1.0);
}

fn folded(w: vec3f, fold: vec2f) -> vec3f {
    return vec3f(w.xy * fold, w.z);
}

/// Where the azimuths of an isotropic material count from. At the normal, which has none, it is half a turn, as
/// in Mitsuba 3, so that both read the same values there.
fn axis_of(wo: vec3f) -> vec2f {
    let across = length(wo.xy);
    if across == 0.0 {
        return vec2f(-1.0, 0.0);
    }
    return wo.xy / across;
}

/// A step between ascending numbers, and the share of its second end.
struct Step {
    low: u32,
    part: f32,
}

/// The step that holds `value`; `list` is 0 for the viewer's angles from the normal and 1 for its azimuths.
fn step_of(list: u32, value: f32) -> Step {
    let count = facts_at(2u + list);
    let fives = angles_at(6u * list);
    let five = dot(select(vec4f(0.0), vec4f(1.0), fives <= vec4f(value)), vec4f(1.0));
    let own = angles_at(6u * list + 1u + u32(five));
    let passed = own <= vec4f(value);
    let below = 5u * u32(five) + u32(dot(select(vec4f(0.0), vec4f(1.0), passed), vec4f(1.0)));
    if below == 0u {
        return Step(0u, 0.0);
    }
    if below >= count {
        return Step(count - 2u, 1.0);
    }
    let begins = max(select(vec4f(-1e9), own, passed), select(vec4f(-1e9), fives, fives <= vec4f(value)));
    let ends = min(select(own, vec4f(1e9), passed), select(fives, vec4f(1e9), fives <= vec4f(value)));
    let begin = max(max(begins.x, begins.y), max(begins.z, begins.w));
    let end = min(min(ends.x, ends.y), min(ends.z, ends.w));
    return Step(below - 1u, clamp((value - begin) / (end - begin), 0.0, 1.0));
}

fn viewer_of(wo: vec3f) -> Viewer {
    let down = step_of(0u, angle_of_half(0.5 * dot(wo.xy, wo.xy) / (1.0 + wo.z)));
    if isotropic() {
        return Viewer(0u, 0.0, down.low, down.part);
    }
    let around = step_of(1u, precise_atan2(wo.y, wo.x));
    return Viewer(around.low, around.part, down.low, down.part);
}

/// The slice of normals for an azimuth and a step of angles.
fn normals_of(viewer: Viewer, k: u32) -> u32 {
    return (viewer.column + k) * normal_ends_size(1u) + viewer.row;
}

/// The slice of light and colours for an azimuth and an angle.
fn light_of(viewer: Viewer, k: u32, lower: u32) -> u32 {
    return (viewer.column + k) * (normal_ends_size(1u) + 1u) + viewer.row + lower;
}

/// Where a point of the unit square lies among so many nodes.
fn place(at: vec2f, rows: u32, columns: u32) -> Place {
    let steps = at * vec2f(f32(columns - 1u), f32(rows - 1u));
    let column = min(u32(steps.x), columns - 2u);
    let row = min(u32(steps.y), rows - 2u);
    let part = steps - vec2f(f32(column), f32(row));
    return Place(row, column, part, 1.0 - part.x);
}

/// The same of a point that was drawn: near the end of x by its distance from there, since light fades towards
/// it by powers of ten, and 1 - x has no digits left.
fn place_of(drawn: Drawn, rows: u32, columns: u32) -> Place {
    let far = drawn.at.x > 0.5;
    let p = place(vec2f(select(drawn.at.x, drawn.rest, far), drawn.at.y), rows, columns);
    let column = select(p.column, columns - 2u - p.column, far);
    let x = select(p.part.x, p.rest, far);
    return Place(p.row, column, vec2f(x, p.part.y), select(p.rest, p.part.x, far));
}

/// The shares of the corners of a step at a place in it.
fn shares_of_corners(p: Place) -> vec4f {
    return vec4f(p.rest, p.part.x, p.rest, p.part.x) * vec4f(vec2f(1.0 - p.part.y), vec2f(p.part.y));
}

/// Where in a step a linear density from `a` to `b` has the share `u` below it.
fn ramp(a: f32, b: f32, u: f32) -> f32 {
    let root = sqrt(mix(a * a, b * b, u));
    if a + root == 0.0 {
        return u;
    }
    return clamp(u * (a + b) / (a + root), 0.0, 1.0);
}

/// The share of a step that lies below `key`; half where the step has nothing.
fn share_below(key: f32, begin: f32, end: f32) -> f32 {
    if end <= begin {
        return 0.5;
    }
    return clamp((key - begin) / (end - begin), 0.0, 1.0);
}

// Draws from one slice of the light: a node by its tree, and a place under its hat.

/// The node that holds `key`, by the tree that begins at a texel.
fn light_node(tree: u32, key: f32) -> TreeNode {
    let group = tree_child(light_trees_at(tree), key, 25u, tree_root());
    let five = tree_child(light_trees_at(tree + 1u + group.index / 25u), key, 5u, group);
    return tree_child(light_trees_at(tree + 6u + five.index / 5u), key, 1u, five);
}

/// A place under the hat of a node among `last` steps.
fn under_hat(node: TreeNode, last: u32, key: f32) -> f32 {
    let rise = select(1.0, 0.0, node.index == 0u);
    let fall = select(1.0, 0.0, node.index == last);
    return f32(node.index) + hat_sample(rise, fall, tree_left(node, key));
}

/// A point of the square, drawn from a slice.
fn draw_light(slice: u32, u: vec2f) -> vec2f {
    let nodes = light_trees_size(1u);
    let texels = light_trees_size(2u);
    let last = vec2u(light_size(2u), light_size(1u));
    let first = slice * nodes * texels;
    let row = light_node(first, u.y);
    let column = light_node(first + (1u + row.index) * texels, u.x);
    let at = vec2f(under_hat(column, last.x, u.x), under_hat(row, last.y, u.y));
    return clamp(at / vec2f(last), vec2f(0.0), vec2f(1.0));
}

/// The first of the texels of a step of the light, for an azimuth and an angle of the viewer.
fn light_at_step(viewer: Viewer, k: u32, lower: u32, p: Place) -> u32 {
    return 4u * ((light_of(viewer, k, lower) * light_size(1u) + p.row) * light_size(2u) + p.column);
}

/// The density of light at a point of the square, for an azimuth.
fn light_density(viewer: Viewer, k: u32, drawn: Drawn) -> f32 {
    let p = light_place(drawn);
    let shares = shares_of_corners(p);
    let upper = dot(light_at(light_at_step(viewer, k, 0u, p) + 3u), shares);
    let lower = dot(light_at(light_at_step(viewer, k, 1u, p) + 3u), shares);
    return mix(upper, lower, viewer.down) * f32(light_size(1u)) * f32(light_size(2u));
}

fn light_place(drawn: Drawn) -> Place {
    return place_of(drawn, light_size(1u) + 1u, light_size(2u) + 1u);
}

// Draws of normals, for one azimuth, between two angles.

fn row_step(slice: u32, down: f32, key: f32, low: u32, stride: u32) -> u32 {
    let probe = low + stride;
    let rows = normal_ends_size(2u);
    let end = normal_ends_at(slice * rows + probe);
    return select(low, probe, (probe < rows - 1u) & (mix(end.x, end.y, down) <= key));
}

fn column_step(first: u32, shares: vec4f, whole: f32, key: f32, low: u32, stride: u32) -> u32 {
    let probe = low + stride;
    return select(low, probe, (probe < normal_cells_size(3u) - 1u) & (cell_of(first + probe, shares, whole) <= key));
}

/// The shares of what a texel of a node holds: two rows at the viewer's upper angle, and two at the lower one.
fn shares_of_rows(down: f32, part: f32) -> vec4f {
    return vec4f(1.0 - part, part, 1.0 - part, part) * vec4f(vec2f(1.0 - down), vec2f(down));
}

fn draw_normal(slice: u32, down: f32, u: vec2f) -> vec2f {
    let rows = normal_ends_size(2u);
    var row = 0u;
    if rows > 65u {
        row = row_step(slice, down, u.y, row, 64u);
    }
    row = row_step(slice, down, u.y, row, 32u);
    row = row_step(slice, down, u.y, row, 16u);
    row = row_step(slice, down, u.y, row, 8u);
    row = row_step(slice, down, u.y, row, 4u);
    row = row_step(slice, down, u.y, row, 2u);
    row = row_step(slice, down, u.y, row, 1u);
    let above = normal_ends_at(slice * rows + row);
    let below = normal_ends_at(slice * rows + row + 1u);
    let begin = mix(above.xz, above.yw, down);
    let end = mix(below.xz, below.yw, down);
    let y = ramp(begin.y, end.y, share_below(u.y, begin.x, end.x));

    let columns = normal_cells_size(3u);
    let first = (slice * (rows - 1u) + row) * columns;
    let shares = shares_of_rows(down, y);
    let whole = mix(begin.y, end.y, y);
    let key = u.x * whole;
    var column = 0u;
    if columns > 65u {
        column = column_step(first, shares, whole, key, column, 64u);
    }
    column = column_step(first, shares, whole, key, column, 32u);
    column = column_step(first, shares, whole, key, column, 16u);
    column = column_step(first, shares, whole, key, column, 8u);
    column = column_step(first, shares, whole, key, column, 4u);
    column = column_step(first, shares, whole, key, column, 2u);
    column = column_step(first, shares, whole, key, column, 1u);
    let cells = vec2f(cell_of(first + column, shares, whole), cell_of(first + column + 1u, shares, whole));
    let left = dot(normal_densities_at(first + column), shares);
    let right = dot(normal_densities_at(first + column + 1u), shares);
    let x = ramp(left, right, share_below(key, cells.x, cells.y));
    return vec2f(f32(column) + x, f32(row) + y) / vec2f(f32(columns - 1u), f32(rows - 1u));
}

/// The integral up to a node along a row whose integral is `whole`; below 0 the table says what is left.
fn cell_of(at: u32, shares: vec4f, whole: f32) -> f32 {
    let value = dot(normal_cells_at(at), shares);
    return select(value, whole + value, value < 0.0);
}

/// What is looked up of the normals about a place, for an azimuth.
fn normals_at(viewer: Viewer, k: u32, p: Place) -> Normals {
    let slice = normals_of(viewer, k);
    let rows = normal_ends_size(2u);
    let above = normal_ends_at(slice * rows + p.row);
    let below = normal_ends_at(slice * rows + p.row + 1u);
    let node = (slice * (rows - 1u) + p.row) * normal_cells_size(3u) + p.column;
    let part = p.part.y;
    let shares = shares_of_rows(viewer.down, part);
    let begin = dot(normal_cells_at(node), shares);
    let end = dot(normal_cells_at(node + 1u), shares);
    let wholes = mix(vec2f(above.z, below.z), vec2f(above.w, below.w), viewer.down);
    let whole = mix(wholes.x, wholes.y, part);
    return Normals(
        dot(normal_densities_at(node), shares),
        dot(normal_densities_at(node + 1u), shares),
        whole,
        select(begin, whole + begin, begin < 0.0),
        select(whole - end, -end, end < 0.0),
        mix(above.x, above.y, viewer.down) + part * (wholes.x + 0.5 * part * (wholes.y - wholes.x)),
    );
}

fn normals_place(u: vec2f) -> Place {
    return place(u, normal_ends_size(2u), normal_cells_size(3u));
}

/// The point that draws a place, and the density there.
fn drawn_from(n: Normals, p: Place) -> Drawn {
    let x = p.part.x;
    let before = n.before + x * (n.left + 0.5 * x * (n.right - n.left));
    let behind = n.behind + p.rest * (n.right + 0.5 * p.rest * (n.left - n.right));
    let parts = clamp(vec2f(before, behind) / n.whole, vec2f(0.0), vec2f(1.0));
    let along = select(vec2f(0.0, 1.0), parts, n.whole > 0.0);
    let steps = f32(normal_ends_size(2u) - 1u) * f32(normal_cells_size(3u) - 1u);
    return Drawn(vec2f(along.x, clamp(n.down, 0.0, 1.0)), along.y, (p.rest * n.left + x * n.right) * steps);
}

fn mixed_normals(a: Normals, b: Normals, share: f32) -> Normals {
    return Normals(
        mix(a.left, b.left, share),
        mix(a.right, b.right, share),
        mix(a.whole, b.whole, share),
        mix(a.before, b.before, share),
        mix(a.behind, b.behind, share),
        mix(a.down, b.down, share),
    );
}

/// What is drawn for the first azimuth about a place: `eval` and `pdf` of an isotropic material need no more.
fn first_drawn(viewer: Viewer, p: Place) -> Drawn {
    return drawn_from(normals_at(viewer, 0u, p), p);
}

/// The colours that begin at a texel.
fn colours_at(first: u32, shares: vec4f) -> vec3f {
    return vec3f(
        dot(light_at(first), shares),
        dot(light_at(first + 1u), shares),
        dot(light_at(first + 2u), shares),
    );
}

/// The colours at a place of the light, for an azimuth.
fn colours_of(viewer: Viewer, k: u32, p: Place) -> vec3f {
    let shares = shares_of_corners(p);
    let upper = colours_at(light_at_step(viewer, k, 0u, p), shares);
    let lower = colours_at(light_at_step(viewer, k, 1u, p), shares);
    return mix(upper, lower, viewer.down);
}

/// u of an angle from the normal and a vector that has the azimuth. Data need not go on where the turn ends; half a
/// turn itself is where it begins, as in Mitsuba 3.
fn u_of(theta: f32, along: vec2f) -> vec2f {
    let turns = -precise_atan2(-along.y, along.x) * INV_TWO_PI;
    return vec2f(sqrt(theta * (2.0 * INV_PI)), clamp(turns + 0.5, 0.0, 1.0));
}

/// u of the half vector; where the material is isotropic its azimuth counts from the viewer's.
fn normal_of(wo: vec3f, wi: vec3f) -> vec2f {
    let m = wo + wi;
    let length_of_m = length(m);
    // The part of `wo` has no side: what lies in the viewer's plane is told from what lies beside it. A select, since
    // `eval` and `pdf` share what stands in no branch.
    let axis = axis_of(wo);
    let from_viewer = vec2f(dot(axis, m.xy), axis.x * wi.y - axis.y * wi.x);
    let along = select(m.xy, from_viewer, isotropic());
    let theta = angle_of_half(0.5 * dot(m.xy, m.xy) / (length_of_m * (length_of_m + m.z)));
    let u = u_of(theta, along);
    return vec2f(max(u.x, LEAST_U), u.y);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let fold = fold_of(wo);
    let at = folded(wo, fold);
    let viewer = viewer_of(at);
    let u = normal_of(at, folded(wi, fold));
    let normal_place = normals_place(u);
    var drawn = first_drawn(viewer, normal_place);
    if !isotropic() {
        let first = normals_at(viewer, 0u, normal_place);
        let second = normals_at(viewer, 1u, normal_place);
        drawn = drawn_from(mixed_normals(first, second, viewer.around), normal_place);
    }
    let lit = light_place(drawn);
    var colour = colours_of(viewer, 0u, lit);
    if !isotropic() {
        colour = mix(colour, colours_of(viewer, 1u, lit), viewer.around);
    }
    if facts_at(0u) != 0u {
        let columns = distribution_size(1u);
        let of_normal = place(u, distribution_size(0u) + 1u, columns + 1u);
        let ndf = dot(distribution_at(of_normal.row * columns + of_normal.column), shares_of_corners(of_normal));
        let theta = angle_of_half(0.5 * dot(at.xy, at.xy) / (1.0 + at.z));
        let wide = areas_size(1u);
        let of_viewer = place(u_of(theta, at.xy), areas_size(0u) + 1u, wide + 1u);
        let area = dot(areas_at(of_viewer.row * wide + of_viewer.column), shares_of_corners(of_viewer));
        colour *= ndf / (4.0 * area);
    }
    if CLAMP {
        colour = max(colour, vec3f(0.0));
    }
    return colour / wi.z;
}

/// Sine and cosine of an angle in [0, pi/2], the sine to 2e-7 of itself: WGSL's may be off by 2^-11 anywhere, and
/// cards have 0 for small angles. The series of half the angle's sine ends below 2e-9 of it.
fn sine_and_cosine(theta: f32) -> vec2f {
    let half = 0.5 * theta;
    let z = half * half;
    let series = 1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0));
    let s = half + half * z * (-1.0 / 6.0 + z * series);
    return vec2f(2.0 * s * sqrt(1.0 - s * s), 1.0 - 2.0 * s * s);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let fold = fold_of(wo);
    let at = folded(wo, fold);
    let viewer = viewer_of(at);
    // The third number chooses the azimuth, and what is left of it the light's angle. What is left of the others
    // would do, too, and costs a tenth more noise.
    let is_second = u.z < viewer.around;
    let left = select(u.z - viewer.around, u.z, is_second)
        / select(1.0 - viewer.around, viewer.around, is_second);
    let k = select(0u, 1u, is_second);
    let light = light_of(viewer, k, select(0u, 1u, left < viewer.down));
    let normal = draw_normal(normals_of(viewer, k), viewer.down, draw_light(light, u.xy));
    let theta = 0.5 * PI * normal.x * normal.x;
    let phi = (2.0 * normal.y - 1.0) * PI;
    var along = vec2f(cos(phi), sin(phi));
    if isotropic() {
        let axis = axis_of(at);
        along = vec2f(axis.x * along.x - axis.y * along.y, axis.y * along.x + axis.x * along.y);
    }
    let polar = sine_and_cosine(theta);
    let m = vec3f(polar.x * along, polar.y);
    return folded(2.0 * dot(at, m) * m - at, fold);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let fold = fold_of(wo);
    let at = folded(wo, fold);
    let viewer = viewer_of(at);
    let u = normal_of(at, folded(wi, fold));
    let normal_place = normals_place(u);
    let first = first_drawn(viewer, normal_place);
    var density = first.density * light_density(viewer, 0u, first);
    if !isotropic() {
        let second = drawn_from(normals_at(viewer, 1u, normal_place), normal_place);
        density = mix(density, second.density * light_density(viewer, 1u, second), viewer.around);
    }
    // Solid angle of half vectors over a step of u, times that of directions over one of half vectors.
    let theta = 0.5 * PI * u.x * u.x;
    return density / (2.0 * PI * PI * u.x * sine_and_cosine(theta).x * 2.0 * length(wo + wi));
}
