// Environment importance sampling: what is bright is drawn often.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let light = env_sample(next_2d_bits(s));
    if light.pdf <= 0.0 {
        return vec3f(0.0);
    }
    return brdf_cos(hit.wo, to_local(hit, light.dir)) * light.radiance / light.pdf;
}
