//! Floats, vectors and matrices, against f64.

use super::{Case, close, exact, rounded, scaled};

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The sum of the products' sizes.
fn size(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum()
}

/// Columns of 3 times columns of 3.
fn product(m: &[f64], n: &[f64]) -> (Vec<f64>, f64) {
    let entry = |i: usize| {
        let (column, row) = (i / 3, i % 3);
        (0..3).map(|k| m[k * 3 + row] * n[column * 3 + k]).sum()
    };
    ((0..n.len()).map(entry).collect(), 150.0)
}

fn determinant(m: &[f64], n: usize) -> f64 {
    if n == 1 {
        return m[0];
    }
    let without =
        |row: usize| -> Vec<f64> { (n..n * n).filter(|i| i % n != row).map(|i| m[i]).collect() };
    (0..n).map(|row| [1.0, -1.0][row % 2] * m[row] * determinant(&without(row), n - 1)).sum()
}

pub fn floats() -> Vec<Case> {
    vec![
        exact("ee", "a + b", |x| vec![x[0] + x[1]]),
        exact("ee", "a - b", |x| vec![x[0] - x[1]]),
        exact("ee", "a * b", |x| vec![x[0] * x[1]]),
        exact("ee", "a / b", |x| vec![x[0] / x[1]]),
        exact("e", "-a", |x| vec![-x[0]]),
        exact("e", "abs(a)", |x| vec![x[0].abs()]),
        exact("e", "floor(a)", |x| vec![x[0].floor()]),
        exact("e", "ceil(a)", |x| vec![x[0].ceil()]),
        exact("e", "trunc(a)", |x| vec![x[0].trunc()]),
        exact("e", "round(a)", |x| vec![x[0].round_ties_even()]),
        exact("e", "sqrt(a)", |x| vec![x[0].sqrt()]),
        exact("e", "sign(a)", |x| {
            vec![if x[0] == 0.0 || x[0].is_nan() { x[0] } else { x[0].signum() }]
        }),
        rounded("e", "fract(a)", |x| vec![x[0] - x[0].floor()]),
        rounded("ee", "min(a, b)", |x| vec![x[0].min(x[1])]),
        rounded("ee", "max(a, b)", |x| vec![x[0].max(x[1])]),
        rounded("eee", "clamp(a, b, c)", |x| vec![x[0].max(x[1]).min(x[2])]),
        rounded("e", "saturate(a)", |x| vec![1f64.min(x[0].max(0.0))]),
        rounded("eee", "fma(a, b, c)", |x| vec![x[0].mul_add(x[1], x[2])]),
        rounded("ee", "step(a, b)", |x| vec![f64::from(u8::from(x[0] <= x[1]))]),
        rounded("eeu", "select(a, b, c % 2u == 1u)", |x| vec![x[(x[2] % 2.0) as usize]]),
        Case {
            // The factor's rounding and the product's.
            ulps: [2.0, 2.0],
            ..close("m", "radians(a)", |x| vec![x[0].to_radians()])
        },
        Case { ulps: [2.0, 2.0], ..close("m", "degrees(a)", |x| vec![x[0].to_degrees()]) },
        rounded("e", "let v = modf(a) => v.fract; v.whole", |x| {
            vec![x[0] - x[0].trunc(), x[0].trunc()]
        }),
        rounded("mi", "let v = frexp(a) => ldexp(v.fract, v.exp); 1.0 / v.fract", |x| {
            let exponent = if x[0] == 0.0 { 0.0 } else { x[0].abs().log2().floor() + 1.0 };
            vec![x[0], 1.0 / (x[0] / exponent.exp2())]
        }),
        rounded("mi", "ldexp(a, b % 120)", |x| vec![x[0] * (x[1] % 120.0).exp2()]),
        close("e", "sin(a)", |x| vec![x[0].sin()]),
        close("e", "cos(a)", |x| vec![x[0].cos()]),
        close("e", "tan(a)", |x| vec![x[0].tan()]),
        close("e", "asin(a)", |x| vec![x[0].asin()]),
        close("e", "acos(a)", |x| vec![x[0].acos()]),
        close("e", "atan(a)", |x| vec![x[0].atan()]),
        close("e", "sinh(a)", |x| vec![x[0].sinh()]),
        close("e", "cosh(a)", |x| vec![x[0].cosh()]),
        close("e", "tanh(a)", |x| vec![x[0].tanh()]),
        close("e", "asinh(a)", |x| vec![x[0].asinh()]),
        close("e", "acosh(a)", |x| vec![x[0].acosh()]),
        close("e", "atanh(a)", |x| {
            // Rust's own is off by more than 4 units in the last place.
            vec![0.5 * (x[0].ln_1p() - (-x[0]).ln_1p())]
        }),
        close("e", "exp(a)", |x| vec![x[0].exp()]),
        close("e", "exp2(a)", |x| vec![x[0].exp2()]),
        close("e", "log(a)", |x| vec![x[0].ln()]),
        close("e", "log2(a)", |x| vec![x[0].log2()]),
        Case {
            // Two roundings.
            ulps: [1.5, 1.5],
            ..close("e", "inverseSqrt(a)", |x| vec![1.0 / x[0].sqrt()])
        },
        close("ee", "atan2(a, b)", |x| vec![x[0].atan2(x[1])]),
        close("ee", "pow(a, b)", |x| {
            vec![if x[0] < 0.0 { f64::NAN } else { x[0].abs().powf(x[1]) }]
        }),
        exact("i", "f32(a)", |x| vec![x[0]]),
        exact("u", "f32(a)", |x| vec![x[0]]),
        exact("u", "f32(a > 5u)", |x| vec![f64::from(u8::from(x[0] > 5.0))]),
        exact("e", "bitcast<f32>(bitcast<u32>(a)); bitcast<f32>(bitcast<i32>(a)); f32(a)", |x| {
            vec![x[0]; 3]
        }),
        exact("e", "0.1 * a", |x| vec![f64::from(0.1f32) * x[0]]),
        rounded("e", "quantizeToF16(a)", |x| vec![half::f16::from_f64(x[0]).to_f64()]),
        scaled("ee", "a % b", |x| {
            // An infinite quotient times b is what the definition says, whatever the precision.
            let (a, b) = (x[0], x[1]);
            let quotient = (a / b).trunc();
            let far = quotient.abs() > 1e3 || (a / b - (a / b).round()).abs() < 1e-4;
            (vec![a - b * quotient], if far { f64::INFINITY } else { a.abs() })
        }),
        scaled("mmm", "mix(a, b, c)", |x| (vec![x[0] * (1.0 - x[2]) + x[1] * x[2]], 25.0)),
        scaled("mmm", "smoothstep(a, a + 3.0 + abs(b), c)", |x| {
            let t = ((x[2] - x[0]) / (3.0 + x[1].abs())).clamp(0.0, 1.0);
            (vec![t * t * (3.0 - 2.0 * t)], 6.0)
        }),
    ]
}

pub fn vectors() -> Vec<Case> {
    vec![
        scaled("mmmmmm", "dot(vec3f(a, b, c), vec3f(d, e, f))", |x| {
            (vec![dot(&x[..3], &x[3..])], size(&x[..3], &x[3..]))
        }),
        scaled("mmm", "length(vec3f(a, b, c)); length(a)", |x| {
            (vec![dot(x, x).sqrt(), x[0].abs()], dot(x, x).sqrt())
        }),
        scaled("mmmm", "distance(vec2f(a, b), vec2f(c, d))", |x| {
            (vec![(x[0] - x[2]).hypot(x[1] - x[3])], 4.0)
        }),
        scaled("mmmm", "let v = normalize(vec4f(a, b, c, d)) => v.x; v.y; v.z; v.w", |x| {
            (x.iter().map(|c| c / dot(x, x).sqrt()).collect(), 1.0)
        }),
        scaled("mmmmmm", "let v = cross(vec3f(a, b, c), vec3f(d, e, f)) => v.x; v.y; v.z", |x| {
            let at = |i: usize, j: usize| x[i] * x[3 + j] - x[j] * x[3 + i];
            (vec![at(1, 2), at(2, 0), at(0, 1)], 32.0)
        }),
        scaled(
            "mmmmmm",
            "let v = faceForward(vec2f(a, b), vec2f(c, d), vec2f(e, f)) => v.x; v.y",
            |x| {
                let turn = if dot(&x[2..4], &x[4..6]) < 0.0 { 1.0 } else { -1.0 };
                (vec![turn * x[0], turn * x[1]], 4.0)
            },
        ),
        scaled("mmmm", "let v = reflect(vec2f(a, b), vec2f(c, d)) => v.x; v.y", |x| {
            let twice = 2.0 * dot(&x[..2], &x[2..]);
            (vec![x[0] - twice * x[2], x[1] - twice * x[3]], 260.0)
        }),
        scaled(
            "mm",
            "let v = refract(vec2f(sin(a), cos(a)), vec2f(0.6, 0.8), 0.4 + 0.05 * b) => v.x; v.y",
            |x| {
                let ratio = f64::from(0.4f32) + f64::from(0.05f32) * x[1];
                let (e, n) = ([x[0].sin(), x[0].cos()], [f64::from(0.6f32), f64::from(0.8f32)]);
                let d = dot(&e, &n);
                let along = ratio * d + (1.0 - ratio * ratio * (1.0 - d * d)).sqrt();
                (vec![ratio * e[0] - along * n[0], ratio * e[1] - along * n[1]], 2.0)
            },
        ),
        scaled(
            "mmmmmmmmmmmm",
            "let v = mat3x3f(a, b, c, d, e, f, g, h, i) * vec3f(j, k, l) => v.x; v.y; v.z",
            |x| product(&x[..9], &x[9..]),
        ),
        scaled(
            "mmmmmmmmm",
            "let v = vec3f(a, b, c) * mat2x3f(d, e, f, g, h, i) => v.x; v.y",
            |x| (vec![dot(&x[..3], &x[3..6]), dot(&x[..3], &x[6..])], 48.0),
        ),
        scaled(
            "mmmmmmmmmmmmmmm",
            "let v = mat3x3f(a, b, c, d, e, f, g, h, i) * mat2x3f(j, k, l, m, n, o) => v[0].x; v[0].y; v[0].z; v[1].x; v[1].y; v[1].z",
            |x| product(&x[..9], &x[9..]),
        ),
        exact(
            "mmmmmmmm",
            "let v = mat2x2f(a, b, c, d) + mat2x2f(e, f, g, h) => v[0].x; v[0].y; v[1].x; v[1].y",
            |x| (0..4).map(|i| x[i] + x[i + 4]).collect(),
        ),
        exact(
            "mmmmm",
            "let v = mat2x2f(a, b, c, d) - e * mat2x2f(1.0, 0.0, 0.0, 1.0) => v[0].y; v[1].x",
            |x| vec![x[1] - 0.0 * x[4], x[2] - 0.0 * x[4]],
        ),
        exact(
            "mmmmmmm",
            "let v = mat3x2f(a, b, c, d, e, f) * g => v[0].x; v[0].y; v[1].x; v[1].y; v[2].x; v[2].y",
            |x| x[..6].iter().map(|c| c * x[6]).collect(),
        ),
        exact(
            "mmmmmm",
            "let v = transpose(mat3x2f(a, b, c, d, e, f)) => v[0].x; v[0].y; v[0].z; v[1].x; v[1].y; v[1].z",
            |x| [0, 2, 4, 1, 3, 5].iter().map(|i| x[*i]).collect(),
        ),
        scaled("mmmm", "determinant(mat2x2f(a, b, c, d))", |x| (vec![determinant(x, 2)], 32.0)),
        scaled("mmmmmmmmm", "determinant(mat3x3f(a, b, c, d, e, f, g, h, i))", |x| {
            (vec![determinant(x, 3)], 384.0)
        }),
        scaled(
            "mmmmmmmmmmmmmmmm",
            "determinant(mat4x4f(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p))",
            |x| (vec![determinant(x, 4)], 6144.0),
        ),
        exact(
            "mmmm",
            "let v = vec4f(a, b, c, d).wzyx.yx => v.x; v.y; vec4f(a, b, c, d).bgr.x",
            |x| vec![x[2], x[3], x[2]],
        ),
        exact("mmu", "vec2f(a, b)[c]; vec2f(a, b)[i32(c)]; array<f32, 2>(a, b)[c]", |x| {
            vec![x[(x[2] as usize).min(1)]; 3]
        }),
    ]
}
