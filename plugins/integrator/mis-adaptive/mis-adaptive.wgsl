// One-sample mixture p = c p_brdf + (1 - c) p_env whose c is learned from the samples.
//
// The second moment of x = f cos L / p as a function of c has, by samples of p, the derivatives
// -E[x^2 (p_brdf - p_env) / p] and 2 E[x^2 (p_brdf - p_env)^2 / p^2], the second never negative: it
// is convex, and a Newton step leads towards its minimum.

/// Probability of picking the BRDF's technique; the state holds it less one half.
fn brdf_share(state: ptr<function, State>) -> f32 {
    return 0.5 + (*state).shift;
}

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>, state: ptr<function, State>) -> vec3f {
    let c = brdf_share(state);
    let square = next_2d_bits(s);
    let fresh = next_1d(s);
    let way = pick_way(square.x, c, fresh);
    var wi: vec3f;
    var light: EnvLight;
    var p_brdf = 0.0;
    if way.first {
        let drawn = brdf_sample(hit.wo, vec3f(unit_f32(way.bits), unit_f32(square.y), fresh));
        if !(drawn.pdf > 0.0) {
            return drawn.weight;
        }
        wi = drawn.wi;
        p_brdf = drawn.pdf;
        light = env_light(to_world(hit, wi));
    } else {
        let drawn = env_sample(vec2u(way.bits, square.y));
        if drawn.pdf <= 0.0 {
            return vec3f(0.0);
        }
        wi = to_local(hit, drawn.dir);
        light = EnvLight(drawn.radiance, drawn.pdf);
        p_brdf = brdf_pdf(hit.wo, wi);
    }
    let p = c * p_brdf + (1.0 - c) * light.pdf;
    let x = brdf_cos(hit.wo, wi) * light.radiance / p;
    // Near 1 in any unit of radiance, so that its square holds.
    let size = (x.x + x.y + x.z) * environment_scale();
    let difference = (p_brdf - light.pdf) / p;
    (*state).slope -= size * size * difference;
    (*state).curvature += 2.0 * size * size * difference * difference;
    return x;
}

/// After a round: one step, and the next round learns afresh.
fn learn(q: Settings, state: ptr<function, State>) {
    let c = brdf_share(state) - (*state).slope / (*state).curvature;
    if (*state).curvature > 0.0 && is_finite(vec3f(c)) {
        (*state).shift = clamp(c, q.least, 1.0 - q.least) - 0.5;
    }
    (*state).slope = 0.0;
    (*state).curvature = 0.0;
}
