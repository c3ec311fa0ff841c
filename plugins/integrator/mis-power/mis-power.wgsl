// Multi-sample estimator: one sample of each technique, weighted by the power heuristic.

/// own^beta / (own^beta + other^beta), as a ratio: powers of densities overflow.
fn heuristic(own: f32, other: f32, beta: f32) -> f32 {
    return 1.0 / (1.0 + pow(other / own, beta));
}

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let by_brdf = brdf_sample(hit.wo, next_3d(s));
    let by_light = env_sample(next_2d_bits(s));
    // Where none was drawn the weight is zero, and NaN for a direction that was not finite.
    var radiance = by_brdf.weight;
    if by_brdf.pdf > 0.0 {
        let light = env_light(to_world(hit, by_brdf.wi));
        radiance *= light.radiance * heuristic(by_brdf.pdf, light.pdf, q.beta);
    }
    if by_light.pdf > 0.0 {
        let wi = to_local(hit, by_light.dir);
        let at = brdf_at(hit.wo, wi);
        let w = heuristic(by_light.pdf, at.pdf, q.beta);
        radiance += at.cos * by_light.radiance * (w / by_light.pdf);
    }
    return radiance;
}
