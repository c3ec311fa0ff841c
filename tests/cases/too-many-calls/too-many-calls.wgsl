fn f0(x: f32) -> f32 {
    return sin(f1(x + 1.0)) + f1(x * 2.0);
}

fn f1(x: f32) -> f32 {
    return sin(f2(x + 1.0)) + f2(x * 2.0);
}

fn f2(x: f32) -> f32 {
    return sin(f3(x + 1.0)) + f3(x * 2.0);
}

fn f3(x: f32) -> f32 {
    return sin(f4(x + 1.0)) + f4(x * 2.0);
}

fn f4(x: f32) -> f32 {
    return sin(f5(x + 1.0)) + f5(x * 2.0);
}

fn f5(x: f32) -> f32 {
    return sin(f6(x + 1.0)) + f6(x * 2.0);
}

fn f6(x: f32) -> f32 {
    return sin(f7(x + 1.0)) + f7(x * 2.0);
}

fn f7(x: f32) -> f32 {
    return sin(f8(x + 1.0)) + f8(x * 2.0);
}

fn f8(x: f32) -> f32 {
    return sin(f9(x + 1.0)) + f9(x * 2.0);
}

fn f9(x: f32) -> f32 {
    return sin(f10(x + 1.0)) + f10(x * 2.0);
}

fn f10(x: f32) -> f32 {
    return sin(f11(x + 1.0)) + f11(x * 2.0);
}

fn f11(x: f32) -> f32 {
    return sin(f12(x + 1.0)) + f12(x * 2.0);
}

fn f12(x: f32) -> f32 {
    return sin(f13(x + 1.0)) + f13(x * 2.0);
}

fn f13(x: f32) -> f32 {
    return sin(f14(x + 1.0)) + f14(x * 2.0);
}

fn f14(x: f32) -> f32 {
    return sin(f15(x + 1.0)) + f15(x * 2.0);
}

fn f15(x: f32) -> f32 {
    return sin(f16(x + 1.0)) + f16(x * 2.0);
}

fn f16(x: f32) -> f32 {
    return sin(f17(x + 1.0)) + f17(x * 2.0);
}

fn f17(x: f32) -> f32 {
    return sin(f18(x + 1.0)) + f18(x * 2.0);
}

fn f18(x: f32) -> f32 {
    return sin(f19(x + 1.0)) + f19(x * 2.0);
}

fn f19(x: f32) -> f32 {
    return sin(f20(x + 1.0)) + f20(x * 2.0);
}

fn f20(x: f32) -> f32 {
    return sin(f21(x + 1.0)) + f21(x * 2.0);
}

fn f21(x: f32) -> f32 {
    return sin(f22(x + 1.0)) + f22(x * 2.0);
}

fn f22(x: f32) -> f32 {
    return sin(f23(x + 1.0)) + f23(x * 2.0);
}

fn f23(x: f32) -> f32 {
    return sin(f24(x + 1.0)) + f24(x * 2.0);
}

fn f24(x: f32) -> f32 {
    return x;
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(f0(wo.z));
}
