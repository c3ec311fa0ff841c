// Multi-sample estimator: one sample of each technique, weighted by the balance heuristic.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let by_brdf = brdf_sample(hit.wo, next_3d(s));
    let by_light = env_sample(next_2d_bits(s));
    // Where none was drawn the weight is zero, and NaN for a direction that was not finite.
    var radiance = by_brdf.weight;
    if by_brdf.pdf > 0.0 {
        let light = env_light(to_world(hit, by_brdf.wi));
        radiance *= light.radiance * balance_heuristic(by_brdf.pdf, light.pdf);
    }
    if by_light.pdf > 0.0 {
        let wi = to_local(hit, by_light.dir);
        let at = brdf_at(hit.wo, wi);
        let w = balance_heuristic(by_light.pdf, at.pdf);
        radiance += at.cos * by_light.radiance * (w / by_light.pdf);
    }
    return radiance;
}
