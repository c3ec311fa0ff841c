// One-sample estimator: pick a technique, divide by the mixture's density.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let square = next_2d_bits(s);
    let fresh = next_1d(s);
    let way = pick_way(square.x, q.c, fresh);
    var wi: vec3f;
    var light: EnvLight;
    var p_brdf = 0.0;
    if way.first {
        let drawn = brdf_sample(hit.wo, vec3f(unit_f32(way.bits), unit_f32(square.y), fresh));
        if !(drawn.pdf > 0.0) {
            // None drawn, or one that was not finite: then the weight says so.
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
    var p = q.c * p_brdf + (1.0 - q.c) * light.pdf;
    if HEURISTIC == HEURISTIC_NONE {
        p = select(light.pdf, p_brdf, way.first);
    }
    return brdf_cos(hit.wo, wi) * light.radiance / p;
}
