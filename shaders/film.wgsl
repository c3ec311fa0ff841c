// The kernel that renders: one invocation is one covered pixel, its samples loop inside.
//
// A block is a fixed run of samples of one pass. A dispatch does whole blocks, or a part of one and
// adds to its sum, so the bits do not depend on how the work was cut.

/// What one dispatch does.
struct Work {
    /// Rows of the hit list: the first, how many in this dispatch, how many in all.
    first_row: u32,
    row_count: u32,
    rows: u32,
    /// Blocks: the first of the picture, and how many; the first fills slot 0 of the sums.
    first_block: u32,
    block_count: u32,
    /// Samples of a full block and of a pass.
    block_size: u32,
    pass_size: u32,
    /// Samples inside each block: the first and how many at most.
    first_sample: u32,
    sample_count: u32,
    seed: u32,
}

/// The sum of a block at one pixel, with what the host checks.
struct Sum {
    r: f32,
    g: f32,
    b: f32,
    /// Samples done; a wrong count is an error.
    samples: u32,
    /// Samples with a channel that is Inf or NaN; they count as zero in the sum.
    nonfinite: u32,
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
    let hit = hit_at(row);
    let blocks_per_pass = (work.pass_size + work.block_size - 1u) / work.block_size;
    for (var b = 0u; b < work.block_count; b++) {
        // Where this block lies in its pass. Each pass is one scramble of the sequence.
        let block = work.first_block + b;
        let begin = (block % blocks_per_pass) * work.block_size;
        let end = min(begin + work.block_size, work.pass_size);
        let seed = hash_combine(hash_combine(work.seed, hit.pixel), block / blocks_per_pass);

        // Continue the block's sum, or start it.
        let slot = b * work.rows + row;
        var radiance = vec3f(0.0);
        var nonfinite = 0u;
        var samples = 0u;
        var exhausted = 0u;
        if work.first_sample > 0u {
            radiance = vec3f(sums[slot].r, sums[slot].g, sums[slot].b);
            nonfinite = sums[slot].nonfinite;
            samples = sums[slot].samples;
            exhausted = sums[slot].exhausted;
        }
        let first = begin + work.first_sample;
        let last = min(first + work.sample_count, end);
        for (var i = first; i < last; i++) {
            var s = sampler_begin(seed, i);
            let estimated = plugin_estimate(hit, &s);
            if is_finite(estimated) {
                radiance += estimated;
            } else {
                nonfinite += 1u;
            }
            samples += 1u;
        }
        exhausted |= loops_exhausted();
        sums[slot] = Sum(radiance.x, radiance.y, radiance.z, samples, nonfinite, exhausted);
    }
}
