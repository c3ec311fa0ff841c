//! WGSL's builtin functions in terms of the machine's instructions, by the definitions of the
//! language's specification.

use std::rc::Rc;

use naga::{MathFunction, ScalarKind, TypeInner};

use super::{Lowering, Result};
use crate::op::{Compare, F1, F2, F3, FromWord, NONE, Op, Reg, ToWord, U2};

type Arguments<'b> = &'b [Rc<Vec<Reg>>];

impl Lowering<'_> {
    pub(super) fn math(
        &mut self,
        fun: MathFunction,
        kind: ScalarKind,
        ty: &TypeInner,
        arguments: Arguments<'_>,
    ) -> Result<Vec<Reg>> {
        use MathFunction as M;
        let float = kind == ScalarKind::Float;
        if let Some(op) = float_function(fun).filter(|_| float) {
            return Ok(arguments[0].iter().map(|x| self.build.unary(Op::F1(op), *x)).collect());
        }
        let x = &arguments[0][..];
        Ok(match fun {
            M::Dot4I8Packed | M::Dot4U8Packed => vec![self.dot_packed(fun, x[0], arguments[1][0])],
            M::Dot => vec![self.dot(float, x, &arguments[1])],
            M::Cross => self.cross(x, &arguments[1]),
            M::Length => vec![self.length(x)],
            M::Distance => {
                let between = self.zip(F2::Sub, x, &arguments[1]);
                vec![self.length(&between)]
            }
            M::Normalize => {
                let length = self.length(x);
                x.iter().map(|x| self.f2(F2::Div, *x, length)).collect()
            }
            M::FaceForward => {
                let product = self.dot(true, &arguments[2], &arguments[1]);
                let zero = self.build.float(0.0);
                let keep = self.build.binary(Op::Compare(Compare::Less), product, zero);
                let turn = |x: &Reg| {
                    let negative = self.build.unary(Op::F1(F1::Neg), *x);
                    self.build.select(keep, *x, negative)
                };
                x.iter().map(turn).collect()
            }
            M::Reflect => self.reflect(x, &arguments[1]),
            M::Refract => self.refract(x, &arguments[1], arguments[2][0]),
            M::Transpose => self.transpose(ty, x)?,
            M::Determinant => vec![self.determinant(x)?],
            M::Modf => {
                let whole: Vec<Reg> =
                    x.iter().map(|x| self.build.unary(Op::F1(F1::Trunc), *x)).collect();
                let mut both = self.zip(F2::Sub, x, &whole);
                both.extend(whole);
                both
            }
            M::Frexp => {
                let fract = Op::F1(F1::FrexpFract);
                let exponent = Op::ToWord(ToWord::FrexpExponent);
                let mut both: Vec<Reg> = x.iter().map(|x| self.build.unary(fract, *x)).collect();
                both.extend(x.iter().map(|x| self.build.unary(exponent, *x)));
                both
            }
            _ if super::packing::is_packing(fun) => self.packing(fun, x)?,
            _ => {
                let count = arguments.iter().map(|values| values.len()).max().unwrap_or(0);
                let mut values = Vec::with_capacity(count);
                for index in 0..count {
                    let scalars: Vec<Reg> =
                        arguments.iter().map(|values| values[index % values.len()]).collect();
                    values.push(self.math_one(fun, kind, &scalars)?);
                }
                values
            }
        })
    }

    /// A function that works component by component.
    fn math_one(&mut self, fun: MathFunction, kind: ScalarKind, x: &[Reg]) -> Result<Reg> {
        use MathFunction as M;
        let a = x[0];
        if kind != ScalarKind::Float {
            return self.integer_math(fun, kind == ScalarKind::Sint, x);
        }
        Ok(match fun {
            M::Min => self.f2(F2::Min, a, x[1]),
            M::Max => self.f2(F2::Max, a, x[1]),
            M::Atan2 => self.f2(F2::Atan2, a, x[1]),
            M::Pow => {
                self.watch_base(a);
                self.f2(F2::Pow, a, x[1])
            }
            M::Clamp => {
                let least = self.f2(F2::Max, a, x[1]);
                self.f2(F2::Min, least, x[2])
            }
            M::Saturate => {
                let (zero, one) = (self.build.float(0.0), self.build.float(1.0));
                let least = self.f2(F2::Max, a, zero);
                self.f2(F2::Min, least, one)
            }
            M::Fma => self.build.emit(Op::F3(F3::Fma), [a, x[1], x[2]], 0, 0),
            M::Mix => {
                // a (1 - t) + b t
                let one = self.build.float(1.0);
                let rest = self.f2(F2::Sub, one, x[2]);
                let first = self.f2(F2::Mul, a, rest);
                let second = self.f2(F2::Mul, x[1], x[2]);
                self.f2(F2::Add, first, second)
            }
            M::Step => {
                let mask = self.build.binary(Op::Compare(Compare::LessEqual), a, x[1]);
                let (zero, one) = (self.build.float(0.0), self.build.float(1.0));
                self.build.select(mask, one, zero)
            }
            M::SmoothStep => {
                let (zero, one) = (self.build.float(0.0), self.build.float(1.0));
                let (above, width) = (self.f2(F2::Sub, x[2], a), self.f2(F2::Sub, x[1], a));
                let ratio = self.f2(F2::Div, above, width);
                let least = self.f2(F2::Max, ratio, zero);
                let t = self.f2(F2::Min, least, one);
                let (two, three) = (self.build.float(2.0), self.build.float(3.0));
                let twice = self.f2(F2::Mul, two, t);
                let slope = self.f2(F2::Sub, three, twice);
                let square = self.f2(F2::Mul, t, t);
                self.f2(F2::Mul, square, slope)
            }
            M::Ldexp => {
                // In two steps, so that neither power leaves the range while the result is in it.
                let one = self.build.word(1);
                let half = self.build.u2(U2::ShiftRightI, x[1], one);
                let rest = self.build.u2(U2::Sub, x[1], half);
                let power = Op::FromWord(FromWord::PowerOfTwo);
                let (half, rest) = (self.build.unary(power, half), self.build.unary(power, rest));
                let first = self.f2(F2::Mul, a, half);
                self.f2(F2::Mul, first, rest)
            }
            other => return self.build.refuse(format!("the builtin function {other:?}")),
        })
    }

    /// `pow` of a negative base is NaN here and anything on a device: it is worth a word.
    fn watch_base(&mut self, base: Reg) {
        // Known to be positive or zero: nothing to watch.
        if self.build.constant_value(base).is_some_and(|bits| f32::from_bits(bits) >= 0.0) {
            return;
        }
        let span = self.build.span();
        let known = self.watches.iter().position(|known| *known == span);
        let watch = known.unwrap_or_else(|| {
            self.watches.push(span);
            self.watches.len() - 1
        });
        let (base, exec) = (self.build.varying(base), self.build.varying(self.env.exec));
        self.build.raw(Op::WatchNegative, [base, exec, NONE], watch as u32, 0);
    }

    pub(super) fn f2(&mut self, op: F2, a: Reg, b: Reg) -> Reg {
        self.build.binary(Op::F2(op), a, b)
    }

    fn zip(&mut self, op: F2, a: &[Reg], b: &[Reg]) -> Vec<Reg> {
        a.iter().zip(b).map(|(a, b)| self.f2(op, *a, *b)).collect()
    }

    pub(super) fn dot(&mut self, float: bool, a: &[Reg], b: &[Reg]) -> Reg {
        let (add, mul) = if float {
            (Op::F2(F2::Add), Op::F2(F2::Mul))
        } else {
            (Op::U2(U2::Add), Op::U2(U2::Mul))
        };
        let mut sum = self.build.binary(mul, a[0], b[0]);
        for (a, b) in a.iter().zip(b).skip(1) {
            let product = self.build.binary(mul, *a, *b);
            sum = self.build.binary(add, sum, product);
        }
        sum
    }

    fn length(&mut self, x: &[Reg]) -> Reg {
        if let [x] = x {
            return self.build.unary(Op::F1(F1::Abs), *x);
        }
        let square = self.dot(true, x, x);
        self.build.unary(Op::F1(F1::Sqrt), square)
    }

    fn cross(&mut self, a: &[Reg], b: &[Reg]) -> Vec<Reg> {
        let term = |lowering: &mut Self, i: usize, j: usize| {
            let first = lowering.f2(F2::Mul, a[i], b[j]);
            let second = lowering.f2(F2::Mul, a[j], b[i]);
            lowering.f2(F2::Sub, first, second)
        };
        vec![term(self, 1, 2), term(self, 2, 0), term(self, 0, 1)]
    }

    /// e1 - 2 dot(e2, e1) e2
    fn reflect(&mut self, incident: &[Reg], normal: &[Reg]) -> Vec<Reg> {
        let product = self.dot(true, normal, incident);
        let two = self.build.float(2.0);
        let twice = self.f2(F2::Mul, two, product);
        let along = |(e, n): (&Reg, &Reg)| {
            let part = self.f2(F2::Mul, twice, *n);
            self.f2(F2::Sub, *e, part)
        };
        incident.iter().zip(normal).map(along).collect()
    }

    /// k = 1 - e3^2 (1 - dot(e2, e1)^2); zero where k < 0, else e3 e1 - (e3 dot(e2, e1) + sqrt(k)) e2.
    fn refract(&mut self, incident: &[Reg], normal: &[Reg], ratio: Reg) -> Vec<Reg> {
        let product = self.dot(true, normal, incident);
        let (zero, one) = (self.build.float(0.0), self.build.float(1.0));
        let square = self.f2(F2::Mul, product, product);
        let sine = self.f2(F2::Sub, one, square);
        let ratio_square = self.f2(F2::Mul, ratio, ratio);
        let bent = self.f2(F2::Mul, ratio_square, sine);
        let k = self.f2(F2::Sub, one, bent);
        let none = self.build.binary(Op::Compare(Compare::Less), k, zero);
        let root = self.build.unary(Op::F1(F1::Sqrt), k);
        let along = self.f2(F2::Mul, ratio, product);
        let along = self.f2(F2::Add, along, root);
        let each = |(e, n): (&Reg, &Reg)| {
            let (first, second) = (self.f2(F2::Mul, ratio, *e), self.f2(F2::Mul, along, *n));
            let value = self.f2(F2::Sub, first, second);
            self.build.select(none, zero, value)
        };
        incident.iter().zip(normal).map(each).collect()
    }

    fn transpose(&mut self, ty: &TypeInner, x: &[Reg]) -> Result<Vec<Reg>> {
        let TypeInner::Matrix { columns, rows, .. } = *ty else {
            return self.build.refuse("transpose of this");
        };
        let (columns, rows) = (columns as usize, rows as usize);
        let at = |row: usize| (0..columns).map(move |column| x[column * rows + row]);
        Ok((0..rows).flat_map(at).collect())
    }

    /// By minors along the first column.
    fn determinant(&mut self, x: &[Reg]) -> Result<Reg> {
        let size = match x.len() {
            4 => 2,
            9 => 3,
            16 => 4,
            _ => return self.build.refuse("the determinant of this"),
        };
        let columns: Vec<Vec<Reg>> = x.chunks(size).map(<[Reg]>::to_vec).collect();
        Ok(self.minor(&columns))
    }

    fn minor(&mut self, columns: &[Vec<Reg>]) -> Reg {
        if let [column] = columns {
            return column[0];
        }
        let mut sum = NONE;
        for (row, factor) in columns[0].clone().into_iter().enumerate() {
            let without = |column: &Vec<Reg>| {
                let mut column = column.clone();
                column.remove(row);
                column
            };
            let rest: Vec<Vec<Reg>> = columns[1..].iter().map(without).collect();
            let minor = self.minor(&rest);
            let term = self.f2(F2::Mul, factor, minor);
            sum = match (sum, row % 2) {
                (NONE, _) => term,
                (sum, 0) => self.f2(F2::Add, sum, term),
                (sum, _) => self.f2(F2::Sub, sum, term),
            };
        }
        sum
    }

    /// A product with a matrix in it; `None` where components multiply one by one.
    pub(super) fn matrix_product(
        &mut self,
        left_type: &TypeInner,
        right_type: &TypeInner,
        left: &[Reg],
        right: &[Reg],
    ) -> Option<Vec<Reg>> {
        let size = |ty: &TypeInner| match *ty {
            TypeInner::Matrix { columns, rows, .. } => Some((columns as usize, rows as usize)),
            _ => None,
        };
        let is_vector = |ty: &TypeInner| matches!(ty, TypeInner::Vector { .. });
        let row = |row: usize, (columns, rows): (usize, usize)| -> Vec<Reg> {
            (0..columns).map(|column| left[column * rows + row]).collect()
        };
        match (size(left_type), size(right_type)) {
            (Some(left_size), Some((columns, rows))) => {
                let mut product = Vec::new();
                for column in right.chunks(rows).take(columns) {
                    for index in 0..left_size.1 {
                        product.push(self.dot(true, &row(index, left_size), column));
                    }
                }
                Some(product)
            }
            (Some(left_size), None) if is_vector(right_type) => Some(
                (0..left_size.1)
                    .map(|index| self.dot(true, &row(index, left_size), right))
                    .collect(),
            ),
            (None, Some((_, rows))) if is_vector(left_type) => {
                Some(right.chunks(rows).map(|column| self.dot(true, left, column)).collect())
            }
            _ => None,
        }
    }
}

/// The functions that are one instruction on floats.
fn float_function(fun: MathFunction) -> Option<F1> {
    use MathFunction as M;
    Some(match fun {
        M::Abs => F1::Abs,
        M::Sign => F1::Sign,
        M::Sqrt => F1::Sqrt,
        M::InverseSqrt => F1::InverseSqrt,
        M::Floor => F1::Floor,
        M::Ceil => F1::Ceil,
        M::Trunc => F1::Trunc,
        M::Round => F1::Round,
        M::Fract => F1::Fract,
        M::Sin => F1::Sin,
        M::Cos => F1::Cos,
        M::Tan => F1::Tan,
        M::Asin => F1::Asin,
        M::Acos => F1::Acos,
        M::Atan => F1::Atan,
        M::Sinh => F1::Sinh,
        M::Cosh => F1::Cosh,
        M::Tanh => F1::Tanh,
        M::Asinh => F1::Asinh,
        M::Acosh => F1::Acosh,
        M::Atanh => F1::Atanh,
        M::Exp => F1::Exp,
        M::Exp2 => F1::Exp2,
        M::Log => F1::Ln,
        M::Log2 => F1::Log2,
        M::Radians => F1::Radians,
        M::Degrees => F1::Degrees,
        M::QuantizeToF16 => F1::QuantizeF16,
        _ => return None,
    })
}
