// The kernel that adds up terms, one for each texel of the map: one invocation is one covered pixel.
//
// Terms come in blocks of a fixed length. A dispatch goes on from the sum that is stored, a given number
// of steps in one block, so the bits do not depend on how the work was cut.

/// What one dispatch does.
struct Work {
    /// Rows of the hit list: the first, and how many.
    first_row: u32,
    row_count: u32,
    /// The band of rows whose sums are held: its first row.
    first_band_row: u32,
    /// Terms: where the block under way begins and ends.
    block_begin: u32,
    block_end: u32,
    /// Calls of `term` in this dispatch at the most; 1 where it begins the block.
    steps: u32,
    begins: u32,
    /// A power of two: sums are stored times this.
    scale: f32,
}

/// What the calls for one term have given, thousands of them where it is looked at closely. Few are added
/// to one number, so that rounding does not grow with them: 32 calls, 32 of those, and the rest. (Rounding kept
/// in a second number is what compilers simplify away.)
struct Part {
    few: vec3f,
    more: vec3f,
    most: vec3f,
    calls: u32,
}

fn part_add(part: ptr<function, Part>, value: vec3f) {
    (*part).few += value;
    (*part).calls += 1u;
    if (*part).calls % 32u == 0u {
        (*part).more += (*part).few;
        (*part).few = vec3f(0.0);
    }
    if (*part).calls % 1024u == 0u {
        (*part).most += (*part).more;
        (*part).more = vec3f(0.0);
    }
}

/// The sum of a block at one pixel, what is known of all blocks so far, and where it goes on.
struct Sum {
    r: f32,
    g: f32,
    b: f32,
    /// Estimated error of the block's sum.
    error: f32,
    /// The mean of the channels of all terms so far.
    so_far: f32,
    /// Of the block: terms done, evaluations of the integrand, calls that gave Inf or NaN.
    terms: u32,
    evaluations: u32,
    nonfinite: u32,
    /// Where the next call finds the term under way.
    node: u32,
    depth: u32,
    whole: f32,
    /// What the calls for the term under way have given.
    part: Part,
    /// 1 where the plugins' loops used up their budget.
    exhausted: u32,
}

@group(0) @binding(5) var<uniform> work: Work;
@group(0) @binding(6) var<storage, read_write> sums: array<Sum>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= work.row_count {
        return;
    }
    let row = work.first_row + id.x;
    let slot = row - work.first_band_row;
    let hit = hit_of(row);
    var prepared = plugin_prepare(hit);
    var held = sums[slot];
    if work.begins == 1u {
        held = Sum(0.0, 0.0, 0.0, 0.0, held.so_far, 0u, 0u, 0u, 0u, 0u, 0.0, Part(), 0u);
    }
    var radiance = vec3f(held.r, held.g, held.b);
    var part = held.part;
    var nonfinite = held.nonfinite;
    var k = work.block_begin + held.terms;
    var sum = Quadrature(held.so_far, held.error, held.evaluations, held.node, held.depth, held.whole, false);
    // One loop over all calls: pixels that look closer at a texel do not hold up the others.
    for (var i = 0u; i < work.steps; i++) {
        if k >= work.block_end {
            break;
        }
        let value = plugin_term(hit, k, &sum, &prepared) * work.scale;
        if is_finite(value) {
            part_add(&part, value);
        } else {
            nonfinite += 1u;
        }
        if !sum.more {
            let whole = part.few + part.more + part.most;
            radiance += whole;
            sum.so_far += (whole.x + whole.y + whole.z) / (3.0 * work.scale);
            part = Part();
            k += 1u;
            sum.node = 0u;
            sum.depth = 0u;
            sum.whole = 0.0;
        }
        sum.more = false;
    }
    let exhausted = held.exhausted | loops_exhausted();
    sums[slot] = Sum(
        radiance.x, radiance.y, radiance.z, sum.error, sum.so_far, k - work.block_begin, sum.evaluations,
        nonfinite, sum.node, sum.depth, sum.whole, part, exhausted,
    );
}
