// Minnaert: f ~ (cos(wo) cos(wi))^(k - 1). It brings no sampling: the host draws from the cosine.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * ((p.k + 1.0) * INV_TWO_PI * pow(wo.z * wi.z, p.k - 1.0));
}
