// Constants and helpers that every plugin may use; all that is in a BRDF's scope beside its parameters.

const PI: f32 = 3.14159265358979;
const TWO_PI: f32 = 6.28318530717959;
const INV_PI: f32 = 0.318309886183791;
const INV_TWO_PI: f32 = 0.159154943091895;
const INV_FOUR_PI: f32 = 0.0795774715459477;

/// x^5, as in Schlick's Fresnel approximation; `pow` is inexact and undefined for x < 0.
fn pow5(x: f32) -> f32 {
    let x2 = x * x;
    return x2 * x2 * x;
}

/// A unit vector from its height `z` and the azimuth `phi` in radians; 1 - z is given, and exact near the pole.
fn direction_below_pole(one_minus_z: f32, phi: f32) -> vec3f {
    let r = sqrt(max(one_minus_z * (2.0 - one_minus_z), 0.0));
    return vec3f(r * cos(phi), r * sin(phi), 1.0 - one_minus_z);
}

/// log(1 + x) for x > -1, without the digits that 1 + x loses. Near 0 by 2 artanh(z) = log((1 + z) / (1 - z)) with
/// z = x / (2 + x), whose series needs no 1 + x; the first term left out is below 2e-8 of the result.
fn log1p(x: f32) -> f32 {
    if x < -0.5 || x > 1.0 {
        return log(1.0 + x);
    }
    let z = x / (2.0 + x);
    let q = z * z;
    let tail = 1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 + q / 13.0));
    return 2.0 * z * (1.0 + q * (1.0 / 3.0 + q * (0.2 + q * tail)));
}

/// exp(x) - 1, without the digits that the difference loses; near 0 by the series x + x^2/2 + x^3/6 + ..., nested.
fn expm1(x: f32) -> f32 {
    if abs(x) > 0.5 {
        return exp(x) - 1.0;
    }
    let tail = 1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0 * (1.0 + x / 8.0)));
    return x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * tail)));
}

/// The angle of (x, y) from the x axis in [-pi, pi], to 3e-7 of itself; 0 at the origin. WGSL lets `atan2` be off
/// by 4096 units in the last place, and software drivers are off by 5e-5: too much for what is read from tables.
fn precise_atan2(y: f32, x: f32) -> f32 {
    let quarter = precise_atan2_within(abs(y), abs(x));
    let half = select(quarter, PI - quarter, x < 0.0);
    return select(half, -half, y < 0.0);
}

/// `precise_atan2` of a point neither of whose coordinates is below 0, in [0, pi/2]: by a polynomial that is fitted to
/// atan(t) / t over t^2 in [0, 1], to 1.7e-8 of it, t the smaller coordinate over the larger one.
fn precise_atan2_within(y: f32, x: f32) -> f32 {
    let t = min(x, y) / max(max(x, y), 1.2e-38);
    let z = t * t;
    let tail = -0.075522138 + z * (0.043211855 + z * (-0.016367924 + z * 0.0029206913));
    let series = -0.33333153 + z * (0.19993773 + z * (-0.14211055 + z * (0.10666004 + z * tail)));
    let eighth = t + t * z * series;
    return select(eighth, 0.5 * PI - eighth, y > x);
}

/// The angle in [0, pi/2] whose half has the squared sine `s`, to 2e-7 of itself: 2 asin(sqrt(s)), by a
/// polynomial that is fitted to asin(x) / x over x^2 in [0, 1/2]. With s = sin^2 / (2 (1 + cos)) small angles keep
/// their digits, and no quadrant is asked for as with `precise_atan2`.
fn angle_of_half(s: f32) -> f32 {
    let x = sqrt(s);
    let tail = 0.06053089 + s * (-0.05472254 + s * 0.10091158);
    let series = 0.16665374 + s * (0.07547095 + s * (0.03900927 + s * tail));
    return 2.0 * (x + x * s * series);
}

/// The root of the angle in [0, pi/2] whose half has the squared sine `s`, of which pi/2 is 1, to 1e-7 of itself:
/// sqrt(angle_of_half(s) / (pi/2)), by a polynomial that is fitted to its quotient by the fourth root of 2 s.
fn root_of_angle(s: f32) -> f32 {
    let tail = 0.025126219 + s * (-0.022845611 + s * 0.04063217);
    let series = 0.94885004 + s * (0.07906324 + s * (0.032513797 + s * (0.015988067 + s * tail)));
    return sqrt(sqrt(2.0 * s)) * series;
}

/// Where a number in [0, 1) falls under a hat, a density that rises over `rise` before 0 and falls over `fall`
/// behind it; either may be 0. Hats at nodes, by their shares, make up a density that is linear between nodes.
fn hat_sample(rise: f32, fall: f32, u: f32) -> f32 {
    let share = rise / (rise + fall);
    let below = u < share;
    // 1 - sqrt(1 - q) without the differences, q of the side's own part from the top on.
    let inverse = 1.0 / select(1.0 - share, share, below);
    let left = select(1.0 - u, u, below) * inverse;
    return select(fall, rise, below) * ((u - share) * inverse) / (1.0 + sqrt(left));
}

/// A node of a tree of fives (brdf_sdk::native::tree), and the ends of its share.
struct TreeNode {
    index: u32,
    begin: f32,
    end: f32,
}

/// The root.
fn tree_root() -> TreeNode {
    return TreeNode(0u, 0.0, 1.0);
}

/// The child of a node that holds `key`; its texel has four of the children's ends, and each child has `width` leaves.
fn tree_child(ends: vec4f, key: f32, width: u32, node: TreeNode) -> TreeNode {
    let passed = ends <= vec4f(key);
    // The ends ascend: what is passed is passed from the first on.
    let counted = select(vec4u(0u), vec4u(width), passed);
    let two = select(select(node.begin, ends.x, passed.x), ends.y, passed.y);
    let four = select(ends.z, select(ends.w, node.end, passed.w), passed.z);
    return TreeNode(
        node.index + counted.x + counted.y + counted.z + counted.w,
        select(select(two, ends.z, passed.z), ends.w, passed.w),
        min(node.end, select(ends.x, select(ends.y, four, passed.y), passed.x)),
    );
}

/// What is left of a key that chose a node, in [0, 1); half where the node has no share.
fn tree_left(node: TreeNode, key: f32) -> f32 {
    if node.end <= node.begin {
        return 0.5;
    }
    return clamp((key - node.begin) / (node.end - node.begin), 0.0, 0.99999994);
}
