//! What GLSL means, construct by construct: each translation beside the same arithmetic by hand, in f64.

use crate::common::{file, run, translated};

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: V) -> V {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Pairs (wo, wi) above the horizon, some grazing.
fn pairs() -> Vec<[V; 2]> {
    let mut state = 7u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        f64::from(state >> 8) / f64::from(1u32 << 24)
    };
    let mut direction = |lowest: f64| {
        let (z, phi) = (lowest + (1.0 - lowest) * next(), std::f64::consts::TAU * next());
        let r = (1.0 - z * z).sqrt();
        [r * phi.cos(), r * phi.sin(), z]
    };
    (0..60)
        .map(|index| [direction(0.02), direction(if index % 2 == 0 { 0.02 } else { 0.5 })])
        .collect()
}

/// Holds `BRDF` of this code, L = wi and V = wo, against what is computed by hand; negative values count as 0.
#[track_caller]
fn holds(
    parameters: &str,
    values: &[(&str, &str)],
    switches: &[(&str, bool)],
    code: &str,
    by_hand: impl Fn(V, V) -> V,
) {
    let pairs = pairs();
    let translated = translated(&file(parameters, code)).unwrap();
    let got = run(&translated, values, switches, "eval(p, wo, wi)", &pairs);
    for ([wo, wi], got) in pairs.iter().zip(got) {
        let expected = by_hand(*wi, *wo).map(|value| if value > 0.0 { value } else { 0.0 });
        for channel in 0..3 {
            let (got, expected) = (got[channel], expected[channel]);
            assert!(
                (got - expected).abs() <= 1e-5 * expected.abs().max(1e-3),
                "{got} and not {expected} at wo {wo:?}, wi {wi:?} of\n{}",
                translated.wgsl
            );
        }
    }
}

const HEAD: &str = "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n";

/// The same of a function's body alone.
#[track_caller]
fn body(code: &str, by_hand: impl Fn(V, V) -> V) {
    holds("", &[], &[], &format!("{HEAD}{code}\n}}"), by_hand);
}

#[test]
fn the_frame_is_the_surfaces() {
    body("return vec3(dot(L, X) + 1.0, dot(V, Y) + 2.0, dot(L, N) * dot(V, N));", |l, v| {
        [l[0] + 1.0, v[1] + 2.0, l[2] * v[2]]
    });
}

#[test]
fn arguments_shadow_parameters() {
    let code = "float Beckmann(float m, float t) { return m * t + 1.0; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { float n = 3.0; return vec3(Beckmann(2.0, L.z), m, n + Cs.y); }";
    let parameters = "float m 0 1 .5\nfloat n 0 1 .25\ncolor Cs 1 .5 .25";
    let values = [("m", "0.5"), ("n", "0.25"), ("cs", "vec3f(1.0, 0.5, 0.25)")];
    holds(parameters, &values, &[], code, |l, _| [2.0 * l[2] + 1.0, 0.5, 3.5]);
}

#[test]
fn choices_nest_ten_deep() {
    let mut text = "-1.0".to_owned();
    for step in 0..10 {
        text = format!("L.z < {}.0 / 10. ? {step} + V.z : ({text})", 10 - step);
    }
    let code = format!("return vec3({text}, L.z > 0.5 ? 1 : 2, L.z > .5 ? V : vec3(0.5).xyz);");
    let code = code.replace("V : vec3(0.5).xyz)", "V.z : 3.)");
    body(&code, |l, v| {
        let mut value = -1.0;
        for step in 0..10 {
            if l[2] < f64::from(10 - step) / 10.0 {
                value = f64::from(step) + v[2];
            }
        }
        [value, if l[2] > 0.5 { 1.0 } else { 2.0 }, if l[2] > 0.5 { v[2] } else { 3.0 }]
    });
}

#[test]
fn ifs_need_no_braces_and_declarations_no_value() {
    let code = "float a = L.z, b, c = 2.;\n    b = 1;\n    if (a > .5) b = a;\n    else if (a > 0.25) { b = 2*a; }\n    else\n        b += 3;\n    \
                vec3 r; r.x = a; r.yz = vec2(b, c);\n    if (V.z < 0.3) return r + 1.;\n    return r;";
    body(code, |l, v| {
        let a = l[2];
        let b = if a > 0.5 {
            a
        } else if a > 0.25 {
            2.0 * a
        } else {
            4.0
        };
        let more = if v[2] < 0.3 { 1.0 } else { 0.0 };
        [a + more, b + more, 2.0 + more]
    });
}

#[test]
fn functions_may_bear_builtins_names() {
    let code = "vec3 reflect(vec3 I, vec3 N) { return 2.0 * dot(I, N) * N - I; }\n\
                float smoothstep(float a, float b, float x) { if (x < a) return 0; x = x * a + b; return x; }\n\
                float length(float x) { return 2 * x; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                float mix = 3.0; float select = length(L.xyz.z) + length(V);\n\
                return vec3(dot(reflect(L, N), V) + 2.0, smoothstep(.5, 2., L.z), mix * select);\n}";
    holds("", &[], &[], code, |l, v| {
        let r = [-l[0], -l[1], l[2]];
        let s = if l[2] < 0.5 { 0.0 } else { l[2] * 0.5 + 2.0 };
        [dot(r, v) + 2.0, s, 3.0 * (2.0 * l[2] + dot(v, v).sqrt())]
    });
}

#[test]
fn whole_powers_are_products_whatever_the_base() {
    let code = "const float FIVE = 5.0;\n#define SQUARE 2\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                float x = L.x;\n\
                return vec3(pow(x, 2) + pow(x * 1.0, SQUARE) + pow(x - 1.0, FIVE) + pow(2.0 + x, -4) + 40.0,\n\
                    pow(L.z, n) + pow(x, 0) + pow(-2.0, 3.0) + 10., pow(vec3(x, V.y, 2.0), vec3(3.0)).y + 1. + pow(2.0, x));\n}";
    holds("float n 1 10 2.5", &[("n", "2.5")], &[], code, |l, v| {
        let x = l[0];
        [
            2.0 * x * x + (x - 1.0).powi(5) + (2.0 + x).powi(-4) + 40.0,
            l[2].powf(2.5) + 1.0 - 8.0 + 10.0,
            v[1].powi(3) + 1.0 + 2f64.powf(x),
        ]
    });
}

#[test]
fn powers_of_nothing_or_less_are_nothing() {
    holds(
        "float n 1 10 3",
        &[("n", "3.0")],
        &[],
        &format!("{HEAD}return vec3(1.0 + pow(L.x, n), 1.0 + pow(0.0, n), 1.0);\n}}"),
        |l, _| [1.0 + l[0].max(0.0).powi(3), 1.0, 1.0],
    );
}

#[test]
fn whole_numbers_mix_with_floats() {
    body(
        "float u = L.z; int i = 7; return vec3(max(0, 1-u) + 2*u*u/3, i/2 + 1/2 + u, clamp(3*u, 0, 1) + min(V, 0.5).z) + vec3(1);",
        |l, v| {
            let u = l[2];
            [
                2.0 - u + 2.0 * u * u / 3.0,
                3.0 + u + 1.0,
                (3.0 * u).clamp(0.0, 1.0) + v[2].min(0.5) + 1.0,
            ]
        },
    );
}

#[test]
fn a_local_may_be_called_as_the_function_it_begins_with() {
    let code = "float G(float v, float k) { return v / (v - k * v + k); }\n\
                float phi(float x) { float phi = x * 2.; return phi < 1.0 ? phi : 1. - phi * .1; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n    float G = G(L.z, .5) * G(V.z, .5);\n    G *= 2;\n    return vec3(G, phi(L.z), 1.0);\n}";
    holds("", &[], &[], code, |l, v| {
        let g = |v: f64| v / (v - 0.5 * v + 0.5);
        let phi = 2.0 * l[2];
        [2.0 * g(l[2]) * g(v[2]), if phi < 1.0 { phi } else { 1.0 - 0.1 * phi }, 1.0]
    });
}

#[test]
fn globals_are_constants_functions_or_members() {
    let code = "const float PI = 3.14159265358979323846;\nfloat HALF_PI = acos(0.0), ROOT = sqrt(2.0);\n\
                float scaled = 2.0 * rough;\nvec3 tint = vec3(scaled, 1, 0.5);\nint calls = 0;\nfloat sum;\n\
                float add(float x) { calls++; sum += x; return sum; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                float a = add(L.z); float b = add(V.z);\n\
                return tint * vec3(PI, HALF_PI * ROOT, a + 10. * b + 100 * calls);\n}";
    holds("float rough 0 1 .3", &[("rough", "0.3")], &[], code, |l, v| {
        let pi = std::f64::consts::PI;
        [0.6 * pi, pi / 2.0 * 2f64.sqrt(), 0.5 * (l[2] + 10.0 * (l[2] + v[2]) + 200.0)]
    });
}

#[test]
fn functions_are_chosen_by_what_they_take() {
    let code = "float sqr(float x) { return x * x; }\nvec3 sqr(vec3 v) { return v * v; }\nfloat sqr(float x, int n) { return x * n; }\n\
                float later(vec2 v);\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return vec3(sqr(L).z + sqr(2), sqr(V.z, 3), later(L.xz)); }\n\
                float later(vec2 v) { return v.y + 1.; }";
    holds("", &[], &[], code, |l, v| [l[2] * l[2] + 4.0, 3.0 * v[2], l[2] + 1.0]);
}

#[test]
fn arguments_are_handed_back() {
    let code = "void frame(in vec3 n, out vec3 t, inout float s) { t = n.zyx; s = s * 2. + n.z; }\n\
                float twice(inout float x) { x *= 2.; return x + 1.; }\n\
                void both(inout float a) { twice(a); a += 1.; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                vec3 t; float s = 1.; frame(L, t, s);\n\
                vec3 r = vec3(1, 2, 3); float y = twice(r.y); both(r.z);\n\
                float k = V.z > .5 ? twice(s) : 3.;\n\
                return vec3(t.x + s, y + r.y, r.z + k);\n}";
    holds("", &[], &[], code, |l, v| {
        let s = 2.0 + l[2];
        let (s, k) = if v[2] > 0.5 { (2.0 * s, 2.0 * s + 1.0) } else { (s, 3.0) };
        [l[2] + s, 9.0, 7.0 + k]
    });
}

#[test]
fn loops_run_as_long_as_they_should() {
    let code = "float a = 0.; for (int i = 0; i < 5; i++) a += L.z * float(i);\n\
                float b = 1.; int n = 0; while (b < 10.) { b *= 1. + V.z; n++; if (n > 6) break; }\n\
                float c = 0.; int k = 0; do { k += 1; if (k == 2) continue; c += float(k); } while (k < 5);\n\
                float d = 0.; for (int i = 0, j = 8; i < j; i++, j--) { if (i == 1) continue; d += float(j - i); }\n\
                for (;;) { d += 1.; if (d > 20.) break; }\n\
                int q = 3; while (q-- > 0) d += .5;\n\
                return vec3(a, b, c + d);";
    body(code, |l, v| {
        let (mut b, mut n) = (1.0, 0);
        while b < 10.0 {
            b *= 1.0 + v[2];
            n += 1;
            if n > 6 {
                break;
            }
        }
        // 1 + 3 + 4 + 5; 8 + 4 + 2 and then up to 21, and three halves.
        [10.0 * l[2], b, 13.0 + 21.0 + 1.5]
    });
}

#[test]
fn mod_mix_and_fract_are_glsls() {
    body(
        "return vec3(mod(L.x, 0.3) + fract(V.x), mix(1.0, L.z, V.z) + mix(vec2(1, 2), vec2(3.0), 0.25).y, mix(1., 2., L.z > .5) + mod(vec3(-1.5), 1.).x);",
        |l, v| {
            let modulo = |x: f64, y: f64| x - y * (x / y).floor();
            let chosen = if l[2] > 0.5 { 2.0 } else { 1.0 };
            [modulo(l[0], 0.3) + modulo(v[0], 1.0), 1.0 + (l[2] - 1.0) * v[2] + 2.25, chosen + 0.5]
        },
    );
}

#[test]
fn matrices_multiply_as_columns() {
    let code = "mat3 m = mat3(L, V, vec3(0, 0, 1)); mat2 d = mat2(2); mat3 e = mat3(1, 2, 3, 4, 5, 6, 7, 8, 10);\n\
                m[2][0] = 0.5; vec3 a = m * vec3(1, 2, 3); vec3 b = vec3(1, 2, 3) * m;\n\
                mat3 one = e * inverse(e); mat3 t = transpose(e) / 2.0; mat3 p = matrixCompMult(e, e); mat3 o = outerProduct(L, V);\n\
                e[1] = vec3(0); e -= mat3(1.0);\n\
                return vec3(a.x + b.y + d[0].x + 20., one[1][1] + t[0].y + p[2][2] + float(mat2(e)[0][1]), o[2].x + determinant(m) + 20. + e[2].z + mat4(m)[3].w);";
    body(code, |l, v| {
        let m = [l, v, [0.5, 0.0, 1.0]];
        let a = l[0] + 2.0 * v[0] + 3.0 * 0.5;
        let b = dot([1.0, 2.0, 3.0], v);
        let det = dot(m[0], cross(m[1], m[2]));
        [a + b + 22.0, 1.0 + 2.0 + 100.0 + 2.0, v[2] * l[0] + det + 20.0 + 9.0 + 1.0]
    });
}

#[test]
fn components_bear_any_of_their_names() {
    let code = "vec4 c = vec4(L.rgb, 1); c.bg = c.gb; c.st *= 2.0; float s = V.p; vec3 w = s.xxx; w.x++; ivec2 i = ivec2(V.xy * 10.0);\n\
                return vec3(c.r + c.a, c.z + w.x, float(i.y - i.x) + 30.0 + w.z) + 3.0;";
    body(code, |l, v| {
        // g and b change places; r and g are doubled.
        let i = [v[0], v[1]].map(|x| (x * 10.0).trunc());
        [2.0 * l[0] + 4.0, l[1] + v[2] + 4.0, i[1] - i[0] + 33.0 + v[2]]
    });
}

#[test]
fn arrays_and_structs_hold_values() {
    let code = "struct Lobe { vec3 axis; float width[2]; };\nconst float TABLE[4] = float[4](1., 2, 3., 4.);\n\
                Lobe make(vec3 a, float w) { Lobe l; l.axis = a; l.width[0] = w; l.width[1] = 2. * w; return l; }\n\
                float eval(Lobe l, vec3 v) { return dot(l.axis, v) + l.width[1]; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                Lobe lobes[2]; lobes[0] = make(N, .5); lobes[1] = Lobe(V, float[](1., 3.));\n\
                float local[] = { L.z, 2.0, 3 }; int index = int(L.z * 3.99);\n\
                return vec3(eval(lobes[0], L), eval(lobes[1], L) + 2., TABLE[index] + local[0] + float(local.length1()));\n}"
        .replace(" + float(local.length1())", "");
    holds("", &[], &[], &code, |l, v| {
        [l[2] + 1.0, dot(v, l) + 5.0, (l[2] * 3.99).trunc() + 1.0 + l[2]]
    });
}

#[test]
fn switches_choose() {
    let code = "float f(int n) { switch (n) { case 0: return 1.; case 1: case 2: { float x = 2.; return x; } default: break; } return 3.; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                int n = int(L.z * 4.); float a = 0.; switch (n) { case 0: a = 1.; break; case 3: a = V.z; break; }\n\
                return vec3(f(n), a, 1.0); }";
    holds("", &[], &[], code, |l, v| {
        let n = (l[2] * 4.0).trunc();
        let f = if n == 0.0 {
            1.0
        } else if n < 3.0 {
            2.0
        } else {
            3.0
        };
        [
            f,
            if n == 0.0 {
                1.0
            } else if n == 3.0 {
                v[2]
            } else {
                0.0
            },
            1.0,
        ]
    });
}

#[test]
fn preprocessor_lines_do_what_they_say() {
    let code = "#version 410 core\n# a comment as this format has them\n#define HALF 0.5\n#define SQR(x) ((x) * (x))\n#define LERP(a, b, t) \\\n    mix(a, b, t)\n\
                #ifdef HALF\n#define K 3\n#else\nthis is not read\n#endif\n\
                #if defined(K) && K > 2 && !defined(NOTHING)\nconst float big = 1.0;\n#elif 1\nconst float big = 2.0;\n#endif\n\
                #if 0\nconst float big = 7.0;\n#endif\n#undef HALF\nfloat HALF = .25;\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n    return vec3(SQR(L.z + HALF), LERP(1.0,\n        V.z, .5), big * K);\n}";
    holds("", &[], &[], code, |l, v| [(l[2] + 0.25).powi(2), 0.5 + 0.5 * v[2], 3.0]);
}

#[test]
fn spellings_of_es_and_of_desktops_are_one() {
    let code = "precision highp float;\nhighp float f(const in mediump float x) { lowp float y = x; return y; }\n\
                vec3 BRDF(const in vec3 L, in vec3 V, vec3 N, vec3, vec3 Y) { return vec3(f(L.z), 1.f * V.z, 1.0F + .5); }";
    holds("", &[], &[], code, |l, v| [l[2], v[2], 1.5]);
}

#[test]
fn values_change_in_place() {
    let code = "float a, b, c; a = b = c = L.z; int i = 3; float d = float(i++); d += float(--i); vec3 v = V; v *= 2; v += L; v.x -= 1.; v /= 2.0;\n\
                i <<= 2; i |= 1; i %= 5; b = (c += 1.0) * 2.0;\n\
                return vec3(a + b + c, d + float(i), v.z) + vec3(0, 0, v.x) * 0.;";
    body(code, |l, v| {
        // 3 + 3; (3 << 2 | 1) % 5 = 3.
        [l[2] + 3.0 * (l[2] + 1.0), 6.0 + 3.0, v[2] + l[2] / 2.0]
    });
}

#[test]
fn conditions_combine() {
    let code = "bool a = L.z > 0.5, b = V.z > .5; bvec3 g = greaterThan(L, V);\n\
                float x = a && b || !a && !b ? 1. : 2.; float y = a ^^ b ? 1. : 3.; if (a != b) y += 1.;\n\
                float z = any(g) ? 1. : 0.; z += all(lessThanEqual(L, vec3(1))) ? 2. : 0.; z += L == L ? 4. : 0.; z += L != V ? 8. : 0.; z += float(not(g).x) + float(bool(1));\n\
                return vec3(x, y, z);";
    body(code, |l, v| {
        let (a, b) = (l[2] > 0.5, v[2] > 0.5);
        let any = (0..3).any(|c| l[c] > v[c]);
        let z = if any { 1.0 } else { 0.0 } + 14.0 + if l[0] > v[0] { 0.0 } else { 1.0 } + 1.0;
        [if a == b { 1.0 } else { 2.0 }, if a == b { 3.0 } else { 2.0 }, z]
    });
}

#[test]
fn whole_numbers_have_bits() {
    let code = "uint u = uint(L.z * 100.0); uint h = (u ^ (u >> 2)) & 0xFFu; h = h | 1u; int i = int(h) % 7; i = ~i + 8; uint w = h * 2654435761u;\n\
                return vec3(float(h), float(i), float(w >> 24) + float(-i) + 20.);";
    body(code, |l, _| {
        let u = (l[2] as f32 * 100.0) as u32;
        let h = ((u ^ (u >> 2)) & 0xff) | 1;
        let i = !((h % 7) as i32) + 8;
        let w = h.wrapping_mul(2_654_435_761);
        [f64::from(h), f64::from(i), f64::from(w >> 24) - f64::from(i) + 20.0]
    });
}

#[test]
fn functions_may_end_without_saying_so() {
    let code = "float f(float x) { if (x > .5) return 1.; else return 2.; }\nfloat g(float x) { if (x > 2.0) { return 1.; } }\n\
                float h(float x) { return x; x = 2.; }\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return vec3(f(L.z), g(L.z) + 1., h(V.z)); }";
    holds("", &[], &[], code, |l, v| [if l[2] > 0.5 { 1.0 } else { 2.0 }, 1.0, v[2]]);
}

#[test]
fn switches_and_colours_are_parameters() {
    let parameters = "bool useFresnel 1\nbool _x 0 # the first axis\ncolor baseColor .82 .67 .16\nfloat Rs 0 1 .1";
    let code = format!(
        "{HEAD}vec3 c = baseColor; if (_x) c = X; return useFresnel ? c * Rs : vec3(0);\n}}"
    );
    let values = [("base_color", "vec3f(0.82, 0.67, 0.16)"), ("rs", "0.1")];
    let all = [("USE_FRESNEL", true), ("X", false)];
    holds(parameters, &values, &all, &code.replace("X;", "vec3(1, 0, 0);"), |_, _| {
        [0.082, 0.067, 0.016]
    });
}

#[test]
fn names_that_wgsl_keeps_become_others() {
    let code = "float fn(float let, float var) { return let + var; }\nfloat eval(float x) { return x; }\nfloat sample = 2.0;\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n\
                float p = 1.0, wo = L.z, wi = V.z, f32 = 2., array = 3., loop = 4., u = 5., ptr = 6., target = 1.;\n\
                for (int match = 0; match < 2; ++match) p += rough;\n\
                return vec3(fn(wo, wi), p + f32 + array + loop, eval(u) + ptr + sample + target); }";
    holds("float rough 0 1 .3", &[("rough", "0.3")], &[], code, |l, v| [l[2] + v[2], 10.6, 14.0]);
}

#[test]
fn builtins_give_what_glsl_says() {
    // x in (0, 1), and its reference.
    type Case = (&'static str, fn(f64) -> f64);
    let all: [Case; 34] = [
        ("sin(x)", f64::sin),
        ("cos(x)", f64::cos),
        ("tan(x)", f64::tan),
        ("asin(x)", f64::asin),
        ("acos(x)", f64::acos),
        ("atan(x)", f64::atan),
        ("atan(x, 0.5)", |x| x.atan2(0.5)),
        ("sinh(x)", f64::sinh),
        ("cosh(x)", f64::cosh),
        ("tanh(x)", f64::tanh),
        ("exp(x)", f64::exp),
        ("log(x + 1.)", f64::ln_1p),
        ("exp2(x)", f64::exp2),
        ("log2(x + 1.)", |x| (x + 1.0).log2()),
        ("sqrt(x)", f64::sqrt),
        ("inversesqrt(x)", |x| 1.0 / x.sqrt()),
        ("radians(x * 180.)", |x| (x * 180.0).to_radians()),
        ("degrees(x)", f64::to_degrees),
        ("abs(-x)", |x| x),
        ("sign(x - 2.) + 2.", |_| 1.0),
        ("floor(x * 5.) + ceil(x * 3.) + trunc(x * 7.)", |x| {
            (x * 5.0).floor() + (x * 3.0).ceil() + (x * 7.0).trunc()
        }),
        ("round(x * 5. + .25)", |x| (x * 5.0 + 0.25).round()),
        ("fract(x * 5.) + 1.", |x| (x * 5.0).fract() + 1.0),
        ("min(x, .5) + max(x, .5) + clamp(x, .25, .75)", |x| {
            x.min(0.5) + x.max(0.5) + x.clamp(0.25, 0.75)
        }),
        ("step(.5, x) + smoothstep(0., 1., x)", |x| {
            f64::from(u8::from(x >= 0.5)) + x * x * (3.0 - 2.0 * x)
        }),
        ("length(vec3(x, 1, 2)) + length(x)", |x| (x * x + 5.0).sqrt() + x),
        ("distance(vec2(x, 1), vec2(0)) + distance(x, 1.)", |x| (x * x + 1.0).sqrt() + 1.0 - x),
        ("dot(vec2(x, 2), vec2(3)) + dot(x, 2.)", |x| 3.0 * x + 6.0 + 2.0 * x),
        ("normalize(vec3(x, 2, 3)).y + normalize(-x) + 1.", |x| 2.0 / (x * x + 13.0).sqrt()),
        ("cross(vec3(x, 1, 0), vec3(0, 1, 2)).z", |x| x),
        (
            "reflect(vec2(x, -1), vec2(0, 1)).y + faceforward(vec2(x, 1), vec2(0, -1), vec2(0, 1)).x",
            |x| 1.0 + x,
        ),
        ("refract(vec2(0, -1), vec2(0, 1), .5).y + 2. + x", |x| 1.0 + x),
        ("float(isnan(x)) + float(isinf(x / 0.0)) + x", |x| 1.0 + x),
        ("uintBitsToFloat(floatBitsToUint(x) + 0u) + float(bitCount(7)) + fma(x, 2., 1.)", |x| {
            x + 3.0 + 2.0 * x + 1.0
        }),
    ];
    for (text, by_hand) in all {
        let text = text.replace("x / 0.0", "1.0 / (x - x)");
        body(&format!("float x = L.z; return vec3({text});"), |l, _| [by_hand(l[2]); 3]);
    }
}

#[test]
fn half_vectors_are_those_of_the_ancestor() {
    let code = "float sqr(float x) { return x*x; }\n\
                float GGX(float alpha, float cosThetaM)\n{\n    float CosSquared = cosThetaM*cosThetaM;\n    float TanSquared = (1-CosSquared)/CosSquared;\n    \
                return (1.0/3.14159265) * sqr(alpha/(CosSquared * (alpha*alpha + TanSquared)));\n}\n\
                vec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y )\n{\n    vec3 H = normalize( L + V );\n    float D = GGX(alpha, dot(N,H));\n    return vec3(D);\n}";
    holds("float alpha 0.001 1 .1", &[("alpha", "0.3")], &[], code, |l, v| {
        let h = unit([l[0] + v[0], l[1] + v[1], l[2] + v[2]]);
        let c2 = h[2] * h[2];
        [(0.3 / (c2 * (0.09 + (1.0 - c2) / c2))).powi(2) / std::f64::consts::PI; 3]
    });
}

#[test]
fn what_stands_behind_a_loop_does_not_see_its_names() {
    body(
        "float x=1.; int n=0; do { float x=100.; n++; } while (n<3 && x<50.); return vec3(n,x,1);",
        |_, _| [3.0, 1.0, 1.0],
    );
}

#[test]
fn names_of_the_translations_own_do_not_get_in_the_way() {
    let code = "float f(inout float x, float x_in){x=10. + x_in;return 20.;}\nfloat power_3 = 4.;\n\
                vec3 BRDF(vec3 L, vec3 V, vec3, vec3, vec3) {\n\
                float t_1=5., power_5 = 1.; vec2 v=vec2(1.); if (L.z>-1.) { float r = f(v.x, 1.) + t_1; return vec3(r, v.x + pow(L.x, 5) + power_3, power_5); }\nreturn L; }";
    holds("", &[], &[], code, |l, _| [25.0, 15.0 + l[0].powi(5), 1.0]);
}

#[test]
fn numbers_alone_keep_their_meaning() {
    let code = "const float q = 2.; const int Z = 5/2; const int n = 2; float t[n]; t[1] = 3.; float m = -2. + 0.*L.z; uint u = 0xFFFFFFFF; int w = 2147483647 + 1;\n\
                float r = pow(m, q) + pow(vec2(m), vec2(2.)).x + pow(m, Z) + pow(m, 7/3);\n\
                return vec3(r + t.length() + t[1], - -1 + -(-1) + float(~(-3)) + mix(1.,2.,.25) + smoothstep(0.,1.,.5) + mix(0,1,.5), (u > 5u ? 1. : 0.) + (w < 0 ? 2. : 0.));";
    body(code, |_, _| [16.0 + 5.0, 2.0 + 2.0 + 1.25 + 0.5 + 0.5, 3.0]);
}

#[test]
fn rare_spellings_are_read() {
    let code = "/*////////*/ void nothing(float x) { }\nfloat g(bool a, bool b) { return a == b ? 1. : 2.; }\n#define X 1 /* two\nlines */\n\
                # define the lobe of it\nconst mat3 K = mat3(2.0*0.5); mat2 M = mat2(vec4(1, 2, 3, 4));\nfloat[] T = float[](1., 2., 3.);\n\
                vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X_, vec3 Y) {\n\
                nothing(1.); float a = L.z, b = V.z; return vec3(g(a < b, b > (a)), M[1][0] + K[2][2], T[2] + X);\nreturn L; /* never */ }";
    holds("", &[], &[], code, |_, _| [1.0, 4.0, 4.0]);
    let with_returns = code_with_returns();
    holds("", &[], &[], &with_returns, |l, _| [l[2], 2.0, 3.0]);
}

/// Lines end by CR LF, also inside of a macro, and comments have bytes that end lines elsewhere.
fn code_with_returns() -> String {
    "#define LERP(a, b, t) \\\r\n    mix(a, b, t)\r\n// old \u{c} x = 2.; \u{2028} y\r\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)\r\n{\r\n    return vec3(L.z, LERP(1., 3., .5), 3); // é\r\n}\r\n".to_owned()
}
