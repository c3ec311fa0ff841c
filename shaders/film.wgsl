// The kernel that renders by samples: one invocation is one covered pixel, its samples loop inside; or several
// invocations share a pixel's replicates, where a device has more lanes than there are pixels.
//
// The picture is several replicates: independent scrambles, each one continuing sequence. A replicate is cut
// into blocks by the settings alone; a dispatch does a part of the same block of several
// replicates and goes on from the sum that is stored, so the bits do not depend on how the work was cut.

/// What one dispatch does.
struct Work {
    /// Rows of the hit list: the first, and how many.
    first_row: u32,
    row_count: u32,
    /// The band of rows whose sums are held: its first row, and how many.
    first_band_row: u32,
    band_rows: u32,
    /// Replicates: the first, and how many.
    first_replicate: u32,
    replicate_count: u32,
    /// Invocations that share the replicates of a row.
    shares: u32,
    /// Samples of each replicate: the first, how many at the most, and where their block begins.
    first_sample: u32,
    sample_count: u32,
    block_begin: u32,
    /// Replicates of the picture, the samples that each has, and how many have one more.
    replicates: u32,
    replicate_samples: u32,
    longer_replicates: u32,
    seed: u32,
    /// A power of two: sums are stored times this.
    scale: f32,
}

/// The sum of a block of one replicate at one pixel, with what the host checks.
struct Sum {
    r: f32,
    g: f32,
    b: f32,
    /// Samples done (11 bits; a wrong count is an error), those of them with a channel that is Inf or NaN
    /// (11 bits; they count as zero in the sum), and 1 where the plugins' loops used up their budget.
    counts: u32,
}

@group(0) @binding(5) var<uniform> work: Work;
@group(0) @binding(6) var<storage, read_write> sums: array<Sum>;

/// Samples of the first round of an integrator that learns; each later round is as long as all before it.
const FIRST_ROUND: u32 = 8u;

/// Where the round of a replicate's sample begins.
fn round_begin(i: u32) -> u32 {
    return select(1u << firstLeadingBit(i), 0u, i < FIRST_ROUND);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= work.row_count * work.shares {
        return;
    }
    // Neighbours do the same replicate of neighbouring pixels: their sums lie side by side.
    let share = id.x / work.row_count;
    let row = work.first_row + id.x % work.row_count;
    let hit = hit_of(row);
    let pixel_seed = hash_combine(work.seed, hit.pixel);
    var prepared = plugin_prepare(hit);
    for (var r = share; r < work.replicate_count; r += work.shares) {
        let replicate = work.first_replicate + r;
        let slot = replicate * work.band_rows + row - work.first_band_row;
        var radiance = vec3f(0.0);
        var counts = 0u;
        if work.first_sample > work.block_begin {
            radiance = vec3f(sums[slot].r, sums[slot].g, sums[slot].b);
            counts = sums[slot].counts;
        }
        var state = plugin_load(slot);
        let seed = hash_combine(pixel_seed, replicate);
        let samples = work.replicate_samples + select(0u, 1u, replicate < work.longer_replicates);
        let last = min(work.first_sample + work.sample_count, samples);
        for (var i = work.first_sample; i < last; i++) {
            var s: Sampler;
            if LEARNS {
                // What was learned is used on points that do not depend on those it was learned
                // from: every round is a scramble of its own.
                let begin = round_begin(i);
                if i == begin && i > 0u {
                    plugin_learn(&state);
                }
                s = sampler_begin(hash_combine(seed, begin), i - begin);
            } else {
                s = sampler_begin(seed, i);
            }
            let estimated = plugin_estimate(hit, &s, &prepared, &state) * work.scale;
            if is_finite(estimated) {
                radiance += estimated;
                counts += 1u;
            } else {
                counts += 0x801u;
            }
        }
        plugin_store(slot, state);
        counts |= loops_exhausted() << 22u;
        sums[slot] = Sum(radiance.x, radiance.y, radiance.z, counts);
    }
}
