// The unit square that `env_sample` maps to directions is cut into 8 x 8 cells of equal energy. In
// each the BRDF is evaluated once, towards the middle; cells are then drawn in proportion, a row of
// cells first. What follows the BRDF closer than a cell is left to the BRDF's own samples.

/// Shares of the rows of cells, and of the cells in each row.
struct Prepared {
    rows: array<f32, 8>,
    cells: array<f32, 64>,
}

/// A cell drawn by a number, and where in its share the number fell.
struct Drawn {
    index: u32,
    offset: f32,
}

fn prepare(q: Settings, hit: Hit) -> Prepared {
    var prepared: Prepared;
    var whole = 0.0;
    for (var cell = 0u; cell < 64u; cell++) {
        let middle = (vec2u(cell & 7u, cell >> 3u) * 2u + 1u) << vec2u(28u);
        let f = brdf_cos(hit.wo, to_local(hit, env_sample(middle).dir));
        let weight = max(f.x + f.y + f.z, 0.0);
        prepared.cells[cell] = weight;
        whole += weight;
    }
    // A part of the warp is uniform; all of it where nothing usable is known.
    let known = whole > 0.0 && is_finite(vec3f(1.0 / whole));
    for (var row = 0u; row < 8u; row++) {
        var sum = 0.0;
        for (var cell = row * 8u; cell < row * 8u + 8u; cell++) {
            var share = 0.015625;
            if known {
                share = mix(prepared.cells[cell] / whole, 0.015625, q.floor);
            }
            prepared.cells[cell] = share;
            sum += share;
        }
        prepared.rows[row] = sum;
        for (var cell = row * 8u; cell < row * 8u + 8u; cell++) {
            prepared.cells[cell] /= sum;
        }
    }
    return prepared;
}

fn draw_row(prepared: ptr<function, Prepared>, u: f32) -> Drawn {
    var left = u;
    for (var i = 0u; i < 7u; i++) {
        let own = (*prepared).rows[i];
        if left < own {
            return Drawn(i, left / own);
        }
        left -= own;
    }
    return Drawn(7u, left / (*prepared).rows[7]);
}

fn draw_cell(prepared: ptr<function, Prepared>, row: u32, u: f32) -> Drawn {
    var left = u;
    for (var i = 0u; i < 7u; i++) {
        let own = (*prepared).cells[row * 8u + i];
        if left < own {
            return Drawn(i, left / own);
        }
        left -= own;
    }
    return Drawn(7u, left / (*prepared).cells[row * 8u + 7u]);
}

/// 32 bits in a cell of eight. A share has a few hundredths of the numbers at the least, so 16 bits of its
/// offset are good; the others are fresh, since rare rows of real maps have a few counts of 2^32.
fn into_cell(drawn: Drawn, fresh: u32) -> u32 {
    let upper = u32(clamp(drawn.offset, 0.0, 0.9999999) * 65536.0);
    return (drawn.index << 29u) | (upper << 13u) | (fresh >> 19u);
}

/// How often a cell is drawn, against the environment's own sampling.
fn boost(prepared: ptr<function, Prepared>, u: vec2u) -> f32 {
    let cell = u >> vec2u(29u);
    return 64.0 * (*prepared).rows[cell.y] * (*prepared).cells[cell.y * 8u + cell.x];
}

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>, prepared: ptr<function, Prepared>) -> vec3f {
    let by_brdf = brdf_sample(hit.wo, next_3d(s));
    var radiance = by_brdf.weight;
    if by_brdf.pdf > 0.0 {
        let dir = to_world(hit, by_brdf.wi);
        let light = env_light(dir);
        let p_product = light.pdf * boost(prepared, env_unsampled(dir));
        radiance *= light.radiance * balance_heuristic(by_brdf.pdf, p_product);
    }

    let choice = next_2d(s);
    let fresh = next_2d_bits(s);
    let row = draw_row(prepared, choice.y);
    let column = draw_cell(prepared, row.index, choice.x);
    let u = vec2u(into_cell(column, fresh.x), into_cell(row, fresh.y));
    let by_light = env_sample(u);
    if by_light.pdf > 0.0 {
        let wi = to_local(hit, by_light.dir);
        let p_product = by_light.pdf * boost(prepared, u);
        let at = brdf_at(hit.wo, wi);
        let w = balance_heuristic(p_product, at.pdf);
        radiance += at.cos * by_light.radiance * (w / p_product);
    }
    return radiance;
}
