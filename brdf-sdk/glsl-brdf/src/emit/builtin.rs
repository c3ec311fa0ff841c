//! Calls of GLSL's own functions.
//!
//! By WGSL's functions where they mean the same, else by operators or a helper that is written behind the code. A
//! function for which there is neither is no function here, and `call.rs` says so.

use brdf_sdk::Result;

use super::Emitter;
use super::value::{Value, bind, f32_text};
use crate::ast::Span;
use crate::builtins::{COMPARISONS, OF_FLOATS, OF_NUMBERS, known};
use crate::types::{BOOL, FLOAT, INT, Scalar, Ty};

/// Exponents up to this are products.
const MOST_FACTORS: f64 = 4096.0;

impl Emitter<'_> {
    /// A call of a function of GLSL's; `None` where it has none of that name for these arguments.
    pub(super) fn builtin(
        &mut self,
        name: &str,
        arguments: &[Value],
        span: &Span,
    ) -> Result<Option<Value>> {
        let numbers: Option<Vec<f64>> = arguments.iter().map(|value| value.number).collect();
        let number = numbers.and_then(|numbers| known(name, &numbers));
        let value = match self.shaped(name, arguments) {
            Some(value) => Some(value),
            None => self.special(name, arguments, span)?,
        };
        // Of numbers alone the shader compiler makes nothing of these two.
        let folded = matches!(name, "mix" | "smoothstep");
        Ok(value.map(|value| match number {
            Some(number) if folded && value.ty == FLOAT => Value {
                number: Some(number),
                is_constant: true,
                ..Value::single(f32_text(number), FLOAT)
            },
            _ => Value { number: number.filter(|_| value.ty == FLOAT), ..value },
        }))
    }

    /// Functions of each component.
    fn shaped(&mut self, name: &str, arguments: &[Value]) -> Option<Value> {
        let count = arguments.len();
        if let Some((_, wgsl, _)) =
            OF_FLOATS.iter().find(|(glsl, _, n)| *glsl == name && *n == count)
        {
            let (arguments, ty) = alike(arguments, true)?;
            return Some(Value::call(wgsl, &arguments.iter().collect::<Vec<_>>(), ty));
        }
        if OF_NUMBERS.contains(&(name, count)) {
            let (arguments, ty) = alike(arguments, false)?;
            return Some(Value::call(name, &arguments.iter().collect::<Vec<_>>(), ty));
        }
        let (_, operator) = COMPARISONS.iter().find(|(glsl, _)| *glsl == name)?;
        let [a, b] = arguments else { return None };
        let n = a.ty.vector()?.1;
        let (a, b) = match a.ty.vector()?.0 {
            Scalar::Bool => (a.clone(), b.clone()),
            _ => {
                let (both, _) = alike(&[a.clone(), b.clone()], false)?;
                (both[0].clone(), both[1].clone())
            }
        };
        let text = format!("{} {operator} {}", a.within(bind::PLUS), b.within(bind::PLUS));
        let acts = a.acts || b.acts;
        Some(Value {
            bind: bind::COMPARE,
            acts,
            ..Value::single(text, Ty::Vector(Scalar::Bool, n))
        })
    }

    #[allow(clippy::too_many_lines, reason = "a table of functions, each in a line or two")]
    fn special(&mut self, name: &str, arguments: &[Value], span: &Span) -> Result<Option<Value>> {
        let floats = || alike(arguments, true);
        let call = |wgsl: &str, arguments: &[Value], ty: Ty| {
            Some(Value::call(wgsl, &arguments.iter().collect::<Vec<_>>(), ty))
        };
        Ok(match (name, arguments) {
            ("pow", [_, _]) => floats().map(|(both, ty)| self.power(&both[0], &both[1], ty)),
            ("mod", [_, _]) => floats().and_then(|(both, ty)| {
                let (name, t) = (format!("mod_{}", ty.word()), ty.wgsl());
                let body = "return x - y * floor(x / y);";
                let name =
                    self.helper(&name, &format!("(x: {t}, y: {t}) -> {t} {{\n    {body}\n}}"));
                call(&name, &both, ty)
            }),
            ("modf", [_, _]) => {
                return Err(self.source.problem(
                    span.clone(),
                    "`modf` is not translated",
                    "write trunc(x) and x - trunc(x)",
                ));
            }
            ("mix", [a, b, c]) => match c.ty.vector() {
                // A choice of each component.
                Some((Scalar::Bool, n)) if a.ty.vector().is_some_and(|(_, m)| m == n) => b
                    .converted(&a.ty)
                    .and_then(|b| call("select", &[a.clone(), b, c.clone()], a.ty.clone())),
                Some((Scalar::Float | Scalar::Int | Scalar::Uint, _)) => {
                    floats().and_then(|(three, ty)| call("mix", &three, ty))
                }
                _ => None,
            },
            ("length", [_]) => floats().and_then(|(one, ty)| {
                call(if ty == FLOAT { "abs" } else { "length" }, &one, FLOAT)
            }),
            ("distance", [_, _]) => floats().and_then(|(two, _)| call("distance", &two, FLOAT)),
            ("dot", [_, _]) => floats().and_then(|(two, ty)| match ty == FLOAT {
                true => {
                    let text =
                        format!("{} * {}", two[0].within(bind::TIMES), two[1].within(bind::UNARY));
                    Some(Value { bind: bind::TIMES, ..Value::single(text, FLOAT) })
                }
                false => call("dot", &two, FLOAT),
            }),
            ("cross", [a, b]) if a.ty == b.ty => call("cross", arguments, a.ty.clone()),
            ("normalize", [_]) => floats().and_then(|(one, ty)| {
                call(if ty == FLOAT { "sign" } else { "normalize" }, &one, ty)
            }),
            ("reflect", [a, b]) if a.ty == b.ty && a.ty != FLOAT && a.ty.is_float() => {
                call("reflect", arguments, a.ty.clone())
            }
            ("faceforward", [a, b, c]) if a.ty == b.ty && b.ty == c.ty && a.ty != FLOAT => {
                call("faceForward", arguments, a.ty.clone())
            }
            ("refract", [a, b, eta]) if a.ty == b.ty && a.ty != FLOAT && a.ty.is_float() => eta
                .converted(&FLOAT)
                .and_then(|eta| call("refract", &[a.clone(), b.clone(), eta], a.ty.clone())),
            ("any" | "all", [a]) if matches!(a.ty, Ty::Vector(Scalar::Bool, _)) => {
                call(name, arguments, BOOL)
            }
            ("not", [a]) if matches!(a.ty, Ty::Vector(Scalar::Bool, _)) => {
                let text = format!("!{}", a.within(bind::UNARY));
                Some(Value { bind: bind::UNARY, ..Value::single(text, a.ty.clone()) })
            }
            ("isnan" | "isinf", [a]) => a.ty.vector().and_then(|(_, n)| {
                let test = if name == "isnan" { ">" } else { "==" };
                let (t, b, u) = (
                    Ty::Vector(Scalar::Float, n),
                    Ty::Vector(Scalar::Bool, n),
                    Ty::Vector(Scalar::Uint, n),
                );
                let all = |word: &str| {
                    if n == 1 { word.to_owned() } else { format!("{}({word})", u.wgsl()) }
                };
                // Comparisons with itself are what compilers fold away.
                let body = format!(
                    "(x: {}) -> {} {{\n    return (bitcast<{}>(x) & {}) {test} {};\n}}",
                    t.wgsl(),
                    b.wgsl(),
                    u.wgsl(),
                    all("0x7fffffffu"),
                    all("0x7f800000u"),
                );
                let helper = self.helper(&format!("{name}_{}", t.word()), &body);
                a.converted(&t).and_then(|a| call(&helper, &[a], b))
            }),
            ("floatBitsToInt" | "floatBitsToUint" | "intBitsToFloat" | "uintBitsToFloat", [a]) => {
                a.ty.vector().and_then(|(_, n)| {
                    let scalar = match name {
                        "floatBitsToInt" => Scalar::Int,
                        "floatBitsToUint" => Scalar::Uint,
                        _ => Scalar::Float,
                    };
                    let ty = Ty::Vector(scalar, n);
                    call(&format!("bitcast<{}>", ty.wgsl()), arguments, ty)
                })
            }
            ("ldexp", [a, b]) if a.ty == FLOAT && b.ty == INT => call("ldexp", arguments, FLOAT),
            ("bitCount", [a]) => call("countOneBits", arguments, a.ty.clone()),
            ("bitfieldReverse", [a]) => call("reverseBits", arguments, a.ty.clone()),
            ("findLSB", [a]) => call("firstTrailingBit", arguments, a.ty.clone()),
            ("findMSB", [a]) => call("firstLeadingBit", arguments, a.ty.clone()),
            ("transpose", [a]) => match a.ty {
                Ty::Matrix(c, r) => call("transpose", arguments, Ty::Matrix(r, c)),
                _ => None,
            },
            ("determinant", [a]) => match a.ty {
                Ty::Matrix(c, r) if c == r => call("determinant", arguments, FLOAT),
                _ => None,
            },
            ("inverse", [a]) => match a.ty {
                Ty::Matrix(n @ (2 | 3), r) if n == r => {
                    let name = self.helper(&format!("inverse_mat{n}"), inverse(n));
                    call(&name, arguments, a.ty.clone())
                }
                Ty::Matrix(..) => {
                    return Err(self.source.problem(
                        span.clone(),
                        "`inverse` of this matrix is not translated",
                        "mat2 and mat3 have inverses here; write it out for others",
                    ));
                }
                _ => None,
            },
            ("matrixCompMult", [a, b]) if a.ty == b.ty => match a.ty {
                Ty::Matrix(c, r) => {
                    let t = a.ty.wgsl();
                    let columns: Vec<String> = (0..c).map(|i| format!("a[{i}] * b[{i}]")).collect();
                    let body = format!(
                        "(a: {t}, b: {t}) -> {t} {{\n    return {t}({});\n}}",
                        columns.join(", ")
                    );
                    let name = self.helper(&format!("product_mat{c}x{r}"), &body);
                    call(&name, arguments, a.ty.clone())
                }
                _ => None,
            },
            ("outerProduct", [a, b]) => match (a.ty.vector(), b.ty.vector()) {
                (Some((Scalar::Float, r @ 2..)), Some((Scalar::Float, c @ 2..))) => {
                    let ty = Ty::Matrix(c, r);
                    let columns: Vec<String> = (0..c).map(|i| format!("a * b[{i}]")).collect();
                    let body = format!(
                        "(a: {}, b: {}) -> {t} {{\n    return {t}({});\n}}",
                        a.ty.wgsl(),
                        b.ty.wgsl(),
                        columns.join(", "),
                        t = ty.wgsl(),
                    );
                    let name = self.helper(&format!("outer_mat{c}x{r}"), &body);
                    call(&name, arguments, ty)
                }
                _ => None,
            },
            _ => None,
        })
    }

    /// x^y. GLSL leaves it open for a negative x, where authors mean products of x for whole y; of other powers of
    /// nothing or less they mean none.
    fn power(&mut self, x: &Value, y: &Value, ty: Ty) -> Value {
        let whole = y.number.filter(|y| y.fract() == 0.0 && y.abs() <= MOST_FACTORS);
        let Some(exponent) = whole else {
            let zero = if ty == FLOAT { "0.0".to_owned() } else { format!("{}(0.0)", ty.wgsl()) };
            let base = match x.number {
                Some(number) if number > 0.0 => x.clone(),
                _ => Value {
                    acts: x.acts,
                    ..Value::single(format!("max({}, {zero})", x.text), ty.clone())
                },
            };
            return Value::call("pow", &[&base, y], ty);
        };
        if exponent == 2.0 && x.is_simple() {
            let text = format!("{} * {}", x.text, x.plain());
            return Value { bind: bind::TIMES, ..Value::single(text, ty) };
        }
        let factors = exponent.abs() as u32;
        let t = ty.wgsl();
        let one = if ty == FLOAT { "1.0".to_owned() } else { format!("{t}(1.0)") };
        let mut lines = Vec::new();
        let mut product: Vec<String> = Vec::new();
        let mut square = "x".to_owned();
        let mut power = 1;
        while power <= factors {
            if factors & power != 0 {
                product.push(square.clone());
            }
            power *= 2;
            if power <= factors {
                lines.push(format!("    let x{power} = {square} * {square};\n"));
                square = format!("x{power}");
            }
        }
        if factors == 2 {
            (lines, product) = (Vec::new(), vec!["x".to_owned(), "x".to_owned()]);
        }
        let mut result = if product.is_empty() { one.clone() } else { product.join(" * ") };
        if exponent < 0.0 {
            result = format!("{one} / ({result})");
        }
        let sign = if exponent < 0.0 { "minus_" } else { "" };
        let of = if ty == FLOAT { String::new() } else { format!("_{}", ty.word()) };
        let body = format!("(x: {t}) -> {t} {{\n{}    return {result};\n}}", lines.concat());
        let name = self.helper(&format!("power_{sign}{factors}{of}"), &body);
        Value::call(&name, &[x], ty)
    }
}

/// Arguments as one shape: the longest vector, floats where any is one or `floats` asks for them.
fn alike(arguments: &[Value], floats: bool) -> Option<(Vec<Value>, Ty)> {
    let mut scalar = if floats { Scalar::Float } else { Scalar::Int };
    let mut length = 1;
    for value in arguments {
        let (own, n) = value.ty.vector().filter(|(own, _)| *own != Scalar::Bool)?;
        scalar = scalar.max(own);
        length = length.max(n);
    }
    let ty = Ty::Vector(scalar, length);
    let single = Ty::Vector(scalar, 1);
    let shaped = |value: &Value| {
        if value.ty.vector()?.1 == length {
            return value.converted(&ty);
        }
        let one = value.converted(&single)?;
        Some(Value {
            acts: one.acts,
            number: one.number,
            ..Value::single(format!("{}({})", ty.wgsl(), one.text), ty.clone())
        })
    };
    Some((arguments.iter().map(shaped).collect::<Option<_>>()?, ty))
}

fn inverse(n: usize) -> &'static str {
    match n {
        2 => {
            "(m: mat2x2f) -> mat2x2f {\n    let scale = 1.0 / determinant(m);\n    \
             return mat2x2f(m[1][1] * scale, -m[0][1] * scale, -m[1][0] * scale, m[0][0] * scale);\n}"
        }
        _ => {
            "(m: mat3x3f) -> mat3x3f {\n    let rows = mat3x3f(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));\n    \
             return transpose(rows) * (1.0 / dot(m[0], rows[0]));\n}"
        }
    }
}
