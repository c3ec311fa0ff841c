fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    var table: array<f32, 60000>;
    return vec3f(table[i32(wo.z)]);
}
