fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.color * dot(wo.z, wi);
}
