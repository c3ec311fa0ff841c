//! Types taken apart: every value is a list of scalar components, in the order of its members.
//!
//! Beside its index each component has its place in a buffer, in words, as naga lays it out; no layout is thought up
//! here. What is behind a pointer is `place.rs`'s.

use std::collections::HashMap;
use std::rc::Rc;

use naga::{ArraySize, Handle, Module, Scalar, ScalarKind, Type, TypeInner, VectorSize};

use crate::op::Bank;

/// Components that one value may have.
const MAX_COMPONENTS: usize = 1 << 15;

/// A type, or the part of a vector or matrix that has no handle of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Ty {
    Handle(Handle<Type>),
    Vector(VectorSize, Scalar),
    Scalar(Scalar),
    /// Columns and rows.
    Matrix(VectorSize, VectorSize, Scalar),
}

/// A type's components.
#[derive(Debug)]
pub(super) struct Parts {
    /// Bank of each component.
    pub banks: Vec<Bank>,
    /// Where each component lies in a buffer, in 32-bit words.
    pub words: Vec<u32>,
}

/// One step into a type.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// How many children of this kind there are; `None` in a runtime-sized array.
    pub count: Option<u32>,
    /// Components from one child to the next.
    pub components: u32,
    /// Words from one child to the next.
    pub words: u32,
    pub child: Ty,
}

/// Looks types up, and remembers.
pub(super) struct Shapes<'a> {
    module: &'a Module,
    known: HashMap<Ty, Result<Rc<Parts>, String>>,
}

impl<'a> Shapes<'a> {
    pub(super) fn new(module: &'a Module) -> Self {
        Self { module, known: HashMap::new() }
    }

    /// The components of a type; an error names what is not covered.
    pub(super) fn parts(&mut self, ty: Ty) -> Result<Rc<Parts>, String> {
        if let Some(known) = self.known.get(&ty) {
            return known.clone();
        }
        let parts = self.take_apart(ty).map(Rc::new);
        self.known.insert(ty, parts.clone());
        parts
    }

    fn take_apart(&mut self, ty: Ty) -> Result<Parts, String> {
        let mut parts = Parts { banks: Vec::new(), words: Vec::new() };
        match ty {
            Ty::Scalar(scalar) => parts.add(bank(scalar)?, 0),
            Ty::Vector(size, scalar) => {
                for word in 0..size as u32 {
                    parts.add(bank(scalar)?, word);
                }
            }
            // A value: it never lies in a buffer under this name.
            Ty::Matrix(columns, rows, scalar) => {
                for word in 0..columns as u32 * rows as u32 {
                    parts.add(bank(scalar)?, word);
                }
            }
            Ty::Handle(handle) => match self.module.types[handle].inner {
                TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
                    parts.add(bank(scalar)?, 0);
                }
                TypeInner::Struct { ref members, .. } => {
                    for member in members {
                        let inner = self.parts(Ty::Handle(member.ty))?;
                        parts.extend(&inner, member.offset / 4)?;
                    }
                }
                _ => {
                    let step = self.step(ty)?;
                    let Some(count) = step.count else {
                        return Err("values of a runtime-sized array".to_owned());
                    };
                    let inner = self.parts(step.child)?;
                    for index in 0..count {
                        parts.extend(&inner, index * step.words)?;
                    }
                }
            },
        }
        Ok(parts)
    }

    /// What an index into a vector, matrix or array does.
    pub(super) fn step(&mut self, ty: Ty) -> Result<Step, String> {
        let step = match ty {
            Ty::Vector(size, scalar) => vector_step(size, scalar),
            Ty::Matrix(columns, rows, scalar) => matrix_step(columns, rows, scalar),
            Ty::Scalar(_) => return Err("an index into a scalar".to_owned()),
            Ty::Handle(handle) => match self.module.types[handle].inner {
                TypeInner::Vector { size, scalar } => vector_step(size, scalar),
                TypeInner::Matrix { columns, rows, scalar } => matrix_step(columns, rows, scalar),
                TypeInner::Array { base, size, stride } => Step {
                    count: match size {
                        ArraySize::Constant(count) => Some(count.get()),
                        ArraySize::Dynamic => None,
                        ArraySize::Pending(_) => {
                            return Err("arrays sized by an override".to_owned());
                        }
                    },
                    components: self.parts(Ty::Handle(base))?.banks.len() as u32,
                    words: stride / 4,
                    child: Ty::Handle(base),
                },
                _ => return Err("an index into this type".to_owned()),
            },
        };
        Ok(step)
    }

    /// The child at a fixed index: components and words before it, and its type.
    pub(super) fn child(&mut self, ty: Ty, index: u32) -> Result<(u32, u32, Ty), String> {
        if let Ty::Handle(handle) = ty
            && let TypeInner::Struct { ref members, .. } = self.module.types[handle].inner
        {
            let Some(member) = members.get(index as usize) else {
                return Err("a member that does not exist".to_owned());
            };
            let mut before = 0;
            for earlier in &members[..index as usize] {
                // A runtime-sized array is the last member, so those before it have parts.
                before += self.parts(Ty::Handle(earlier.ty))?.banks.len() as u32;
            }
            return Ok((before, member.offset / 4, Ty::Handle(member.ty)));
        }
        let step = self.step(ty)?;
        // Fixed indices lie inside: the validator has seen to it, but for runtime-sized arrays.
        Ok((index.wrapping_mul(step.components), index.wrapping_mul(step.words), step.child))
    }

    /// Whether a type holds an array anywhere.
    pub(super) fn has_array(&self, ty: Handle<Type>) -> bool {
        match self.module.types[ty].inner {
            TypeInner::Array { .. } => true,
            TypeInner::Struct { ref members, .. } => {
                members.iter().any(|member| self.has_array(member.ty))
            }
            _ => false,
        }
    }
}

impl Parts {
    fn add(&mut self, bank: Bank, word: u32) {
        self.banks.push(bank);
        self.words.push(word);
    }

    fn extend(&mut self, inner: &Parts, first: u32) -> Result<(), String> {
        if self.banks.len() + inner.banks.len() > MAX_COMPONENTS {
            return Err(format!("values of more than {MAX_COMPONENTS} scalars"));
        }
        self.banks.extend(&inner.banks);
        self.words.extend(inner.words.iter().map(|word| first + word));
        Ok(())
    }
}

fn matrix_step(columns: VectorSize, rows: VectorSize, scalar: Scalar) -> Step {
    Step {
        count: Some(columns as u32),
        components: rows as u32,
        words: if rows == VectorSize::Bi { 2 } else { 4 },
        child: Ty::Vector(rows, scalar),
    }
}

fn vector_step(size: VectorSize, scalar: Scalar) -> Step {
    Step { count: Some(size as u32), components: 1, words: 1, child: Ty::Scalar(scalar) }
}

/// The bank of a scalar type.
pub(super) fn bank(scalar: Scalar) -> Result<Bank, String> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Ok(Bank::Float),
        (ScalarKind::Sint | ScalarKind::Uint, 4) | (ScalarKind::Bool, _) => Ok(Bank::Word),
        (kind, width) => Err(format!("scalars of {} bits ({kind:?})", u32::from(width) * 8)),
    }
}

/// The scalar type of a scalar, vector or matrix.
pub(super) fn scalar_of(inner: &TypeInner) -> Option<Scalar> {
    match *inner {
        TypeInner::Scalar(scalar)
        | TypeInner::Vector { scalar, .. }
        | TypeInner::Matrix { scalar, .. }
        | TypeInner::Atomic(scalar) => Some(scalar),
        _ => None,
    }
}
