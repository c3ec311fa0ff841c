//! Calls of the code's own functions, and values made of a type's name.
//!
//! Which function of a name is meant follows from the arguments' types. GLSL's own functions are asked for last, in
//! `builtin.rs`.

use brdf_sdk::Result;

use super::value::{Value, bind, f32_text};
use super::{Emitter, names::Kind};
use crate::ast::{Expr, ExprKind, Passed, Span, TypeName};
use crate::builtins::REFUSED;
use crate::types::{FLOAT, Scalar, Ty};

impl Emitter<'_> {
    pub(super) fn call(
        &mut self,
        callee: &TypeName,
        arguments: &[Expr],
        span: &Span,
    ) -> Result<Value> {
        let name = &callee.name;
        let base = self.named(name);
        let own = self.functions.iter().any(|function| function.name == *name);
        if let Some(base) = base.filter(|_| !own) {
            return self.made(&base, callee, arguments, span);
        }
        if let Some((index, values)) = self.own_function(name, arguments, span)? {
            return self.own_call(index, arguments, &values, span);
        }
        let values = arguments.iter().map(|one| self.expr(one)).collect::<Result<Vec<_>>>()?;
        if let Some(value) = self.builtin(name, &values, span)? {
            return Ok(value.at(span.start));
        }
        let types: Vec<String> = values.iter().map(|value| value.ty.glsl()).collect();
        let cure = REFUSED.iter().find(|(known, _)| known == name).map_or_else(
            || match own {
                true => "convert the arguments".to_owned(),
                false => "declare it, or mend its name".to_owned(),
            },
            |(_, why)| (*why).to_owned(),
        );
        Err(self.source.problem(
            span.clone(),
            format!("there is no function {name}({})", types.join(", ")),
            cure,
        ))
    }

    /// The function of that name which takes these arguments, and the arguments' values.
    fn own_function(
        &mut self,
        name: &str,
        arguments: &[Expr],
        span: &Span,
    ) -> Result<Option<(usize, Vec<Value>)>> {
        let named: Vec<usize> = (0..self.functions.len())
            .filter(|index| {
                let function = &self.functions[*index];
                function.name == name && function.arguments.len() == arguments.len()
            })
            .collect();
        if named.is_empty() {
            return Ok(None);
        }
        // Where there is no choice, its arguments are written once.
        let hands_back = |index: usize| {
            let arguments = &self.functions[index].arguments;
            arguments.iter().any(|(passed, _)| *passed != Passed::In)
        };
        if let [index] = named[..]
            && hands_back(index)
            && self.functions[index].is_defined
        {
            return Ok(Some((index, Vec::new())));
        }
        // Types alone, to choose by: nothing of it is written.
        let kept = (self.pre.clone(), self.post.clone(), self.temporaries);
        let values = arguments.iter().map(|one| self.expr(one)).collect::<Result<Vec<_>>>()?;
        let fits = |index: &usize, exact: bool| {
            let takes = |(argument, value): (&(Passed, Ty), &Value)| match argument.0 {
                Passed::Out => value.ty.takes(&argument.1),
                _ if exact => argument.1 == value.ty,
                _ => argument.1.takes(&value.ty),
            };
            std::iter::zip(&self.functions[*index].arguments, &values).all(takes)
        };
        let found = named
            .iter()
            .find(|index| fits(index, true))
            .or_else(|| named.iter().find(|index| fits(index, false)));
        let Some(index) = found.copied() else {
            (self.pre, self.post, self.temporaries) = kept;
            return Ok(None);
        };
        if !self.functions[index].is_defined {
            return Err(self.source.problem(
                span.clone(),
                format!("`{name}` is announced and never written"),
                "write its body",
            ));
        }
        // Those that are handed back are written again, as places.
        if self.functions[index].arguments.iter().any(|(passed, _)| *passed != Passed::In) {
            (self.pre, self.post, self.temporaries) = kept;
            return Ok(Some((index, Vec::new())));
        }
        Ok(Some((index, values)))
    }

    fn own_call(
        &mut self,
        index: usize,
        arguments: &[Expr],
        values: &[Value],
        span: &Span,
    ) -> Result<Value> {
        let function = self.functions[index].clone();
        self.learning.calls.insert((self.current, index));
        let mut texts = Vec::new();
        let mut acts = values.iter().any(|value| value.acts);
        if self.learned.reads_parameters.contains(&index) {
            texts.push("p".to_owned());
        }
        if self.learned.reads_globals.contains(&index) {
            acts = true;
            texts.push("globals".to_owned());
        }
        for (place, (passed, ty)) in function.arguments.iter().enumerate() {
            let argument = &arguments[place];
            if *passed == Passed::In {
                let value = match values.get(place) {
                    Some(value) => value.clone(),
                    None => self.expr(argument)?,
                };
                let converted = value.converted(ty).ok_or_else(|| {
                    self.source.problem(
                        argument.span.clone(),
                        format!("a {} is wanted, and this is a {}", ty.glsl(), value.ty.glsl()),
                        "convert it",
                    )
                })?;
                texts.push(converted.within(bind::COMPARE + 1));
            } else {
                acts = true;
                texts.push(self.handed_back(argument, *passed, ty)?);
            }
        }
        let text = format!("{}({})", function.wgsl, texts.join(", "));
        Ok(Value { acts, ..Value::single(text, function.result) }.at(span.start))
    }

    /// The pointer for an argument that is handed back: to a variable, or to a copy that goes where it belongs
    /// afterwards.
    fn handed_back(&mut self, argument: &Expr, passed: Passed, ty: &Ty) -> Result<String> {
        if let ExprKind::Name(name) = &argument.kind
            && let Some(variable) = self.variable(name)
            && variable.ty == *ty
        {
            match variable.kind {
                Kind::Local { name, number, is_const: false, .. } => {
                    self.learning.assigned.insert(number);
                    return Ok(format!("&{name}"));
                }
                Kind::Pointer { name } => return Ok(name),
                _ => {}
            }
        }
        self.only_effect(&argument.span)?;
        if self.changes(argument) {
            return Err(
                self.untranslated("a place that changes while it is looked for", &argument.span)
            );
        }
        let name = self.temporary();
        let begin = match passed {
            Passed::Out => format!("var {name}: {};", ty.wgsl()),
            _ => format!("var {name} = {};", self.expr(argument)?.plain()),
        };
        self.pre.push(begin);
        let value = Value::single(name.clone(), ty.clone());
        let back = self.assigned("=", argument, &value, &argument.span)?;
        self.post.push(back);
        Ok(format!("&{name}"))
    }

    /// A value of a type by its name.
    fn made(
        &mut self,
        base: &Ty,
        callee: &TypeName,
        arguments: &[Expr],
        span: &Span,
    ) -> Result<Value> {
        let values = arguments.iter().map(|one| self.expr(one)).collect::<Result<Vec<_>>>()?;
        if !callee.lengths.is_empty() {
            let ty = self.array_type(base.clone(), &callee.lengths, Some(values.len()))?;
            let Ty::Array(of, n) = &ty else { return Err(self.untranslated("this array", span)) };
            if values.len() != *n {
                return Err(self.source.problem(
                    span.clone(),
                    format!("the array has {n} elements and is given {}", values.len()),
                    "give it as many",
                ));
            }
            return self.all_as(&ty, &vec![(**of).clone(); *n], &values, span);
        }
        if let Ty::Struct(index, _) = base {
            let types: Vec<Ty> =
                self.structs[*index].members.iter().map(|(_, ty, _)| ty.clone()).collect();
            return self.all_as(base, &types, &values, span);
        }
        let value = match base {
            Ty::Vector(scalar, n) => self.vector(*scalar, *n, &values),
            Ty::Matrix(c, r) => self.matrix(*c, *r, &values),
            _ => None,
        };
        value.map(|value| value.at(span.start)).ok_or_else(|| {
            let types: Vec<String> = values.iter().map(|value| value.ty.glsl()).collect();
            self.source.problem(
                span.clone(),
                format!("no {} is made of ({})", base.glsl(), types.join(", ")),
                "give it as many numbers as it has",
            )
        })
    }

    /// `ty(...)` of values that become these types.
    pub(super) fn all_as(
        &self,
        ty: &Ty,
        types: &[Ty],
        values: &[Value],
        span: &Span,
    ) -> Result<Value> {
        let wrong = || {
            self.source.problem(
                span.clone(),
                format!("the values are not those of a {}", ty.glsl()),
                "give one of the right type for each member",
            )
        };
        if types.len() != values.len() {
            return Err(wrong());
        }
        let converted =
            std::iter::zip(types, values).map(|(ty, value)| value.converted(ty).ok_or_else(wrong));
        let converted = converted.collect::<Result<Vec<_>>>()?;
        let is_constant = converted.iter().all(|value| value.is_constant);
        let made = Value::call(&ty.wgsl(), &converted.iter().collect::<Vec<_>>(), ty.clone());
        Ok(Value { is_constant, ..made }.at(span.start))
    }

    /// A number or vector of these.
    fn vector(&mut self, scalar: Scalar, n: usize, values: &[Value]) -> Option<Value> {
        let ty = Ty::Vector(scalar, n);
        let is_constant = values.iter().all(|value| value.is_constant);
        if let [one] = values {
            let (own, m) = one.ty.vector()?;
            if (own, m) == (scalar, n) {
                return Some(Value { is_literal: false, ..one.clone() });
            }
            if m == 1 {
                let number = one.number.filter(|_| scalar == Scalar::Float);
                let one = self.component(one, scalar);
                if n == 1 {
                    return Some(Value { is_constant, number, ..one });
                }
                return Some(Value { is_constant, number, ..Value::call(&ty.wgsl(), &[&one], ty) });
            }
            if m < n {
                return None;
            }
            let mut text = one.text.clone();
            if m > n {
                text = format!("{}.{}", one.within(bind::SINGLE), &"xyzw"[..n]);
            }
            let value = Value { acts: one.acts, ..Value::single(text, Ty::Vector(own, n)) };
            return Some(match own == scalar {
                true => value,
                false => Value::call(&ty.wgsl(), &[&value], ty),
            });
        }
        let mut left = n;
        let mut parts = Vec::new();
        for value in values {
            let (own, m) = value.ty.vector()?;
            if left == 0 {
                return None;
            }
            let used = m.min(left);
            left -= used;
            let mut part = value.clone();
            if used < m {
                part.text = format!("{}.{}", value.within(bind::SINGLE), &"xyzw"[..used]);
                part.ty = Ty::Vector(own, used);
            }
            parts.push(match used {
                1 => self.component(&part, scalar),
                _ if own == scalar => part,
                _ => Value::call(
                    &Ty::Vector(scalar, used).wgsl(),
                    &[&part],
                    Ty::Vector(scalar, used),
                ),
            });
        }
        let made = Value::call(&ty.wgsl(), &parts.iter().collect::<Vec<_>>(), ty);
        (left == 0).then_some(Value { is_constant, ..made })
    }

    /// One number as another kind, as constructors make it of any.
    fn component(&self, value: &Value, scalar: Scalar) -> Value {
        let ty = Ty::Vector(scalar, 1);
        match value.converted(&ty) {
            Some(converted) => converted,
            None => Value::call(scalar.wgsl(), &[value], ty),
        }
    }

    fn matrix(&mut self, c: usize, r: usize, values: &[Value]) -> Option<Value> {
        let ty = Ty::Matrix(c, r);
        let is_constant = values.iter().all(|value| value.is_constant);
        let is_numbers = |value: &Value| value.ty.vector().is_some_and(|(_, n)| n > 1);
        if let [one] = values
            && !is_numbers(one)
        {
            let one = match one.is_simple() || one.is_constant {
                true => one.clone(),
                false => self.kept(one),
            };
            let cell = |column: usize, row: usize| match &one.ty {
                Ty::Matrix(c, r) if column < *c && row < *r => {
                    Some(format!("{}[{column}][{row}]", one.within(bind::SINGLE)))
                }
                Ty::Matrix(..) => Some(f32_text(f64::from(u8::from(column == row)))),
                Ty::Vector(_, 1) if column != row => Some("0.0".to_owned()),
                Ty::Vector(_, 1) => Some(one.converted(&FLOAT)?.plain()),
                _ => None,
            };
            let cells = (0..c).flat_map(|column| (0..r).map(move |row| (column, row)));
            let cells = cells.map(|(column, row)| cell(column, row)).collect::<Option<Vec<_>>>()?;
            let text = format!("{}({})", ty.wgsl(), cells.join(", "));
            return Some(Value { is_constant, ..Value::single(text, ty) });
        }
        let column = Ty::Vector(Scalar::Float, r);
        let is_column = |value: &Value| value.ty.vector().is_some_and(|v| v.1 == r);
        let parts: Option<Vec<Value>> = match values.len() {
            n if n == c && values.iter().all(is_column) => {
                values.iter().map(|value| value.converted(&column)).collect()
            }
            _ => self.numbers_of(values).filter(|numbers| numbers.len() == c * r),
        };
        let made = Value::call(&ty.wgsl(), &parts?.iter().collect::<Vec<_>>(), ty);
        Some(Value { is_constant, ..made })
    }

    /// The numbers that values have, one by one.
    fn numbers_of(&mut self, values: &[Value]) -> Option<Vec<Value>> {
        let mut numbers = Vec::new();
        for value in values {
            let (_, n) = value.ty.vector()?;
            if n == 1 {
                numbers.push(value.converted(&FLOAT)?);
                continue;
            }
            let value = match value.is_simple() || value.is_constant {
                true => value.clone(),
                false => self.kept(value),
            };
            let (scalar, _) = value.ty.vector()?;
            for letter in "xyzw"[..n].chars() {
                let text = format!("{}.{letter}", value.within(bind::SINGLE));
                let part = Value {
                    is_constant: value.is_constant,
                    ..Value::single(text, Ty::Vector(scalar, 1))
                };
                numbers.push(part.converted(&FLOAT)?);
            }
        }
        Some(numbers)
    }
}
