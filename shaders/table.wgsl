// The kernel that fills a plugin's table: one invocation an entry. It runs on the cores in f64, once.
//
// The linker supplies `author_fill`, TABLE_WIDTH and TABLE_HEIGHT.

struct Entry {
    value: f32,
}

@group(0) @binding(5) var<storage, read_write> entries: array<Entry>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&entries) {
        return;
    }
    let place = vec2f(vec2u(i % TABLE_WIDTH, i / TABLE_WIDTH));
    let last = vec2f(vec2u(TABLE_WIDTH - 1u, TABLE_HEIGHT - 1u));
    entries[i].value = author_fill(place / last);
}
