//! Pointers and what stands behind them: names of registers, words of a buffer, a lane's own memory.
//!
//! Pointers are resolved while lowering. A variable's components are registers; a variable with an
//! array lies in the lane's own memory, where an index may differ by lane.

use std::rc::Rc;

use naga::{AddressSpace, Handle, Scalar, StorageAccess, Type};

use super::shape::{Step, Ty};
use super::{Lowering, MAX_MEMORY, Result};
use crate::op::{AtomicOp, Bank, NONE, Op, Reg, U2};

/// What a pointer points to.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// Components of a variable in registers, from `first` on.
    Var { var: usize, first: u32, ty: Ty },
    /// One of several runs of components: the mask says which, exactly one is set in each lane.
    OneOf { var: usize, options: Vec<(Reg, u32)>, ty: Ty },
    /// Elements of the lane's own memory; `index` is added to `first`.
    Memory { first: u32, index: Option<Reg>, end: u32, ty: Ty },
    /// Words of a buffer; `index` is added to `first`.
    Buffer { resource: u32, first: u32, index: Option<Reg>, ty: Ty, writable: bool },
    /// A texture.
    Texture(u32),
}

impl<'a> Lowering<'a> {
    /// A new variable of call `owner` with its initial value, zero without.
    pub(super) fn variable(
        &mut self,
        owner: usize,
        ty: Handle<Type>,
        init: Option<Vec<Reg>>,
    ) -> Result<Place> {
        let parts = self.parts(Ty::Handle(ty))?;
        if !self.shapes.has_array(ty) {
            let values = match init {
                Some(values) => values,
                None => self.zeros(&parts.banks),
            };
            let var = self.new_var(owner, values);
            return Ok(Place::Var { var, first: 0, ty: Ty::Handle(ty) });
        }
        let first = self.reserve(parts.banks.len() as u32)?;
        let end = self.memory;
        let place = Place::Memory { first, index: None, end, ty: Ty::Handle(ty) };
        match init {
            Some(values) => self.store(&place, &values)?,
            None => {
                let exec = self.build.varying(self.env.exec);
                for bank in [Bank::Float, Bank::Word] {
                    if parts.banks.contains(&bank) {
                        self.build.raw(Op::Clear(bank), [exec, NONE, NONE], first, end - first);
                    }
                }
            }
        }
        Ok(place)
    }

    pub(super) fn new_var(&mut self, owner: usize, values: Vec<Reg>) -> usize {
        self.env.vars.push(Rc::new(values));
        self.owners.push(owner);
        self.env.vars.len() - 1
    }

    fn reserve(&mut self, count: u32) -> Result<u32> {
        let first = self.memory;
        if count > MAX_MEMORY - first {
            return self.build.refuse(format!(
                "more than {MAX_MEMORY} scalars in arrays of functions that call each other"
            ));
        }
        self.memory += count;
        self.memory_peak = self.memory_peak.max(self.memory);
        Ok(first)
    }

    /// A module's variable.
    pub(super) fn global(&mut self, handle: Handle<naga::GlobalVariable>) -> Result<Place> {
        if let Some(place) = self.privates.get(&handle) {
            return Ok(place.clone());
        }
        let variable = &self.module.global_variables[handle];
        let known = self.resources.iter().position(|known| *known == handle);
        let resource = known.unwrap_or(self.resources.len()) as u32;
        let place = match variable.space {
            AddressSpace::Uniform | AddressSpace::Storage { .. } => Place::Buffer {
                resource,
                first: 0,
                index: None,
                ty: Ty::Handle(variable.ty),
                writable: matches!(
                    variable.space,
                    AddressSpace::Storage { access } if access.contains(StorageAccess::STORE)
                ),
            },
            AddressSpace::Handle => {
                let inner = &self.module.types[variable.ty].inner;
                if !is_plain_texture(inner) {
                    return self
                        .build
                        .refuse("textures other than texture_2d<f32> and <u32>, and samplers");
                }
                Place::Texture(resource)
            }
            space => {
                return self.build.refuse(format!("variables of address space {space:?}"));
            }
        };
        if known.is_none() {
            self.resources.push(handle);
        }
        Ok(place)
    }

    /// The part of a place at a fixed index.
    pub(super) fn part(&mut self, place: Place, index: u32) -> Result<Place> {
        let ty = self.place_type(&place)?;
        let child = self.shapes.child(ty, index).or_else(|reason| self.build.refuse(reason))?;
        let (components, words, child) = child;
        Ok(match place {
            Place::Var { var, first, .. } => {
                Place::Var { var, first: first + components, ty: child }
            }
            Place::OneOf { var, options, .. } => {
                let options =
                    options.into_iter().map(|(mask, first)| (mask, first + components)).collect();
                Place::OneOf { var, options, ty: child }
            }
            Place::Memory { first, index, end, .. } => {
                Place::Memory { first: first + components, index, end, ty: child }
            }
            Place::Buffer { resource, first, index, writable, .. } => {
                let first = first.saturating_add(words);
                Place::Buffer { resource, first, index, ty: child, writable }
            }
            Place::Texture(_) => return self.build.refuse("an index into a texture"),
        })
    }

    /// The part of a place at an index that is known when the program runs; it is clamped.
    pub(super) fn part_at(&mut self, place: Place, index: Reg) -> Result<Place> {
        let ty = self.place_type(&place)?;
        let step = self.shapes.step(ty).or_else(|reason| self.build.refuse(reason))?;
        let child = step.child;
        Ok(match place {
            Place::Var { var, first, .. } => {
                Place::OneOf { var, options: self.options(first, index, &step), ty: child }
            }
            Place::OneOf { var, options, .. } => {
                let mut nested = Vec::new();
                for (outer, first) in options {
                    for (inner, first) in self.options(first, index, &step) {
                        nested.push((self.build.u2(U2::And, outer, inner), first));
                    }
                }
                Place::OneOf { var, options: nested, ty: child }
            }
            Place::Memory { first, index: before, end, .. } => {
                let offset = self.offset(index, step.count, step.components)?;
                let index = Some(self.sum(before, offset));
                Place::Memory { first, index, end, ty: child }
            }
            Place::Buffer { resource, first, index: before, writable, .. } => {
                let offset = match step.count {
                    Some(count) => self.offset(index, Some(count), step.words)?,
                    None => {
                        let count = self.runtime_length(resource, first, step.words);
                        let one = self.build.word(1);
                        let last = self.build.u2(U2::Sub, count, one);
                        let index = self.build.u2(U2::MinU, index, last);
                        let stride = self.build.word(step.words);
                        self.build.u2(U2::Mul, index, stride)
                    }
                };
                let index = Some(self.sum(before, offset));
                Place::Buffer { resource, first, index, ty: child, writable }
            }
            Place::Texture(_) => return self.build.refuse("an index into a texture"),
        })
    }

    fn sum(&mut self, before: Option<Reg>, offset: Reg) -> Reg {
        match before {
            Some(before) => self.build.u2(U2::Add, before, offset),
            None => offset,
        }
    }

    /// min(index, count - 1) x stride.
    fn offset(&mut self, index: Reg, count: Option<u32>, stride: u32) -> Result<Reg> {
        let Some(count) = count else {
            return self.build.refuse("a runtime-sized array outside a storage buffer");
        };
        let last = self.build.word(count.saturating_sub(1));
        let index = self.build.u2(U2::MinU, index, last);
        let stride = self.build.word(stride);
        Ok(self.build.u2(U2::Mul, index, stride))
    }

    /// For each child the mask of the lanes whose index names it; beyond the last one, the last.
    fn options(&mut self, first: u32, index: Reg, step: &Step) -> Vec<(Reg, u32)> {
        let count = step.count.unwrap_or(1);
        (0..count)
            .map(|child| {
                let value = self.build.word(child);
                let mask = if child + 1 == count {
                    self.build.u2(U2::LessEqualU, value, index)
                } else {
                    self.build.u2(U2::Equal, value, index)
                };
                (mask, first + child * step.components)
            })
            .collect()
    }

    fn place_type(&self, place: &Place) -> Result<Ty> {
        match place {
            Place::Var { ty, .. }
            | Place::OneOf { ty, .. }
            | Place::Memory { ty, .. }
            | Place::Buffer { ty, .. } => Ok(*ty),
            Place::Texture(_) => self.build.refuse("a texture where a value is expected"),
        }
    }

    /// Elements of the runtime-sized array that begins at word `first` of a buffer.
    fn runtime_length(&mut self, resource: u32, first: u32, stride: u32) -> Reg {
        let words = self.build.emit(Op::BufferWords, [NONE; 3], 0, resource);
        let before = self.build.word(first);
        // A buffer that is too short holds no element; it must not wrap around.
        let before = self.build.u2(U2::MinU, before, words);
        let rest = self.build.u2(U2::Sub, words, before);
        let stride = self.build.word(stride);
        self.build.u2(U2::DivU, rest, stride)
    }

    /// `arrayLength` of a pointer to a runtime-sized array.
    pub(super) fn array_length(&mut self, place: &Place) -> Result<Reg> {
        let ty = self.place_type(place)?;
        let step = self.shapes.step(ty).or_else(|reason| self.build.refuse(reason))?;
        match (place, step.count) {
            (Place::Buffer { resource, first, index: None, .. }, None) => {
                Ok(self.runtime_length(*resource, *first, step.words))
            }
            _ => self.build.refuse("arrayLength of this"),
        }
    }

    /// The value at a place.
    pub(super) fn load(&mut self, place: &Place) -> Result<Vec<Reg>> {
        let ty = self.place_type(place)?;
        let parts = self.parts(ty)?;
        let count = parts.banks.len();
        match place {
            Place::Var { var, first, .. } => {
                let first = *first as usize;
                Ok(self.env.vars[*var][first..first + count].to_vec())
            }
            Place::OneOf { var, options, .. } => {
                let vars = Rc::clone(&self.env.vars[*var]);
                let value = |component: usize, first: u32| vars[first as usize + component];
                Ok((0..count)
                    .map(|component| {
                        let mut picked = value(component, options[0].1);
                        for (mask, first) in &options[1..] {
                            picked = self.build.select(*mask, value(component, *first), picked);
                        }
                        picked
                    })
                    .collect())
            }
            Place::Memory { first, index, end, .. } => {
                let zero = self.build.word(0);
                let index = self.build.varying(index.unwrap_or(zero));
                let at = |component: usize| first + component as u32;
                Ok(parts
                    .banks
                    .iter()
                    .enumerate()
                    .map(|(component, bank)| {
                        let operands = [index, NONE, NONE];
                        self.build.raw(Op::Recall(*bank), operands, at(component), *end)
                    })
                    .collect())
            }
            Place::Buffer { resource, first, index, writable, .. } => {
                let zero = self.build.word(0);
                let index = index.unwrap_or(zero);
                let mut values = Vec::with_capacity(count);
                for (bank, word) in parts.banks.iter().zip(&parts.words) {
                    let at = first.saturating_add(*word);
                    values.push(if *writable {
                        let index = self.build.varying(index);
                        let op = Op::LoadOrdered(*bank);
                        self.build.raw(op, [index, NONE, NONE], at, *resource)
                    } else {
                        self.build.emit(Op::Load(*bank), [index, NONE, NONE], at, *resource)
                    });
                }
                Ok(values)
            }
            Place::Texture(_) => self.build.refuse("loading a texture as a value"),
        }
    }

    /// Stores a value in the lanes that are here.
    pub(super) fn store(&mut self, place: &Place, values: &[Reg]) -> Result<()> {
        match place {
            Place::Var { var, first, .. } => {
                self.assign(*var, *first, values, None);
            }
            Place::OneOf { var, options, .. } => {
                for (mask, first) in options {
                    self.assign(*var, *first, values, Some(*mask));
                }
            }
            Place::Memory { first, index, end, .. } => {
                let zero = self.build.word(0);
                let index = self.build.varying(index.unwrap_or(zero));
                let exec = self.build.varying(self.env.exec);
                for (component, value) in values.iter().enumerate() {
                    let op = Op::Keep(self.build.info(*value).bank);
                    let value = self.build.varying(*value);
                    self.build.raw(op, [index, value, exec], first + component as u32, *end);
                }
            }
            Place::Buffer { resource, first, index, ty, writable: true } => {
                let zero = self.build.word(0);
                let index = self.build.varying(index.unwrap_or(zero));
                let exec = self.build.varying(self.env.exec);
                let parts = self.parts(*ty)?;
                for (value, word) in values.iter().zip(&parts.words) {
                    let op = Op::Store(self.build.info(*value).bank);
                    let value = self.build.varying(*value);
                    let at = first.saturating_add(*word);
                    self.build.raw(op, [index, value, exec], at, *resource);
                }
            }
            _ => return self.build.refuse("a store to this"),
        }
        Ok(())
    }

    /// New components of a variable, in the lanes of `mask` alone where there is one.
    fn assign(&mut self, var: usize, first: u32, values: &[Reg], mask: Option<Reg>) {
        // Lanes that have left this point are held apart by the branch around it.
        for (component, value) in values.iter().enumerate() {
            let at = first as usize + component;
            let before = self.env.vars[var][at];
            let value = match mask {
                Some(mask) if before != NONE => self.build.select(mask, *value, before),
                _ => *value,
            };
            Rc::make_mut(&mut self.env.vars[var])[at] = value;
        }
    }

    /// An atomic operation on one word of a buffer; the value before.
    pub(super) fn atomic(&mut self, place: &Place, op: AtomicOp, value: Reg) -> Result<Reg> {
        let Place::Buffer { resource, first, index, ty, writable: true } = place else {
            return self.build.refuse("atomics outside storage buffers");
        };
        if self.parts(*ty)?.banks != [Bank::Word] {
            return self.build.refuse("atomics on floats");
        }
        let zero = self.build.word(0);
        let index = self.build.varying(index.unwrap_or(zero));
        let exec = self.build.varying(self.env.exec);
        let value = self.build.varying(value);
        Ok(self.build.raw(Op::Atomic(op), [index, value, exec], *first, *resource))
    }
}

fn is_plain_texture(inner: &naga::TypeInner) -> bool {
    use naga::{ImageClass, ImageDimension, ScalarKind, TypeInner};
    matches!(
        inner,
        TypeInner::Image {
            dim: ImageDimension::D2,
            arrayed: false,
            class: ImageClass::Sampled { kind: ScalarKind::Float | ScalarKind::Uint, multi: false },
        }
    )
}

/// The scalar kind behind a pointer to an atomic.
pub(super) fn signed(scalar: Scalar) -> bool {
    scalar.kind == naga::ScalarKind::Sint
}
