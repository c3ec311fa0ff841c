//! Lists of vec4f and vec4u as buffers, for graphics cards.
//!
//! Programs read a list as a texture of rows, since software drivers and the CPU executor fetch a texel for what one
//! word of a buffer costs. Cards have four texels of 16 bytes a cycle where their caches give eight times as many, so
//! a program of theirs reads the same list, by the same numbers, from a storage buffer.

use std::collections::HashSet;

use brdf_sdk::{Problem, Result};
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Expression, GlobalVariable, Handle, ImageClass,
    Literal, Module, Scalar, StorageAccess, Type, TypeInner, VectorSize,
};

use crate::link::{Binding, BindingKind, Program};

/// Where lists lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lists {
    /// In textures of rows.
    Textures,
    /// In storage buffers.
    Buffers,
}

impl Lists {
    /// Where a device reads them best, and has room for all that a program may have.
    pub(super) fn best(info: &wgpu::AdapterInfo, limits: &wgpu::Limits) -> Self {
        // A texture of 4,096 by 8,192 texels, which every device has, and no list is longer.
        const LONGEST: u64 = 16 * 4096 * 8192;
        const MOST_BUFFERS: u32 = 64;
        let buffer = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let fits = buffer >= LONGEST && limits.max_storage_buffers_per_shader_stage >= MOST_BUFFERS;
        match info.device_type {
            wgpu::DeviceType::Cpu => Self::Textures,
            _ if fits => Self::Buffers,
            _ => Self::Textures,
        }
    }

    /// A program's module for a device whose lists lie there.
    pub(super) fn module_of(self, program: &Program) -> Result<Module> {
        let module = match self {
            Self::Textures => Some(program.module.clone()),
            Self::Buffers => in_buffers(&program.module, &program.lists()),
        };
        module.ok_or_else(|| {
            let reason = "a list of vec4f or vec4u is read in another way than by its numbers";
            Problem::new("the program", reason, "read it by the functions of its name alone")
        })
    }

    /// What a binding of a program is on such a device.
    pub(super) fn kind_of(self, program: &Program, binding: &Binding) -> BindingKind {
        match self {
            Self::Buffers if program.lists().contains(&binding.name) => BindingKind::Read,
            _ => binding.kind,
        }
    }
}

/// The module with the textures of these names as buffers; `None` where one of them is read in another way than by
/// numbers of texels in rows.
fn in_buffers(module: &Module, names: &HashSet<String>) -> Option<Module> {
    let mut module = module.clone();
    let is_list =
        |global: &GlobalVariable| global.name.as_deref().is_some_and(|name| names.contains(name));
    let lists: HashSet<Handle<GlobalVariable>> = module
        .global_variables
        .iter()
        .filter(|(_, global)| is_list(global))
        .map(|(handle, _)| handle)
        .collect();
    let span = naga::Span::UNDEFINED;
    for handle in &lists {
        let scalar = match module.types[module.global_variables[*handle].ty].inner {
            TypeInner::Image { class: ImageClass::Sampled { kind, .. }, .. } => {
                Scalar { kind, width: 4 }
            }
            _ => return None,
        };
        let vector = TypeInner::Vector { size: VectorSize::Quad, scalar };
        let base = module.types.insert(Type { name: None, inner: vector }, span);
        let inner = TypeInner::Array { base, size: ArraySize::Dynamic, stride: 16 };
        let list = module.types.insert(Type { name: None, inner }, span);
        let global = &mut module.global_variables[*handle];
        global.space = AddressSpace::Storage { access: StorageAccess::LOAD };
        global.ty = list;
    }
    let named = module.functions.iter_mut().map(|(_, function)| function);
    for function in named.chain(module.entry_points.iter_mut().map(|entry| &mut entry.function)) {
        let expressions = &mut function.expressions;
        let means_list = |expressions: &naga::Arena<Expression>, image: Handle<Expression>| {
            let Expression::GlobalVariable(global) = expressions[image] else { return false };
            lists.contains(&global)
        };
        let reads: Vec<_> = expressions
            .iter()
            .filter_map(|(handle, expression)| match *expression {
                Expression::ImageLoad { image, coordinate, .. }
                    if means_list(expressions, image) =>
                {
                    Some((handle, image, coordinate))
                }
                _ => None,
            })
            .collect();
        for (read, image, coordinate) in reads {
            let index = number(expressions, coordinate)?;
            // The pointer takes the coordinates' place: all that it names stands before them.
            expressions[coordinate] = Expression::Access { base: image, index };
            expressions[read] = Expression::Load { pointer: coordinate };
        }
        let asks = |(_, expression): (Handle<Expression>, &Expression)| match *expression {
            Expression::ImageQuery { image, .. } | Expression::ImageSample { image, .. } => {
                means_list(expressions, image)
            }
            _ => false,
        };
        if expressions.iter().any(asks) {
            return None;
        }
    }
    Some(module)
}

/// The number whose low bits and others these coordinates are.
fn number(
    expressions: &naga::Arena<Expression>,
    coordinate: Handle<Expression>,
) -> Option<Handle<Expression>> {
    let literal = |handle: Handle<Expression>| match expressions[handle] {
        Expression::Literal(Literal::U32(value)) => Some(value),
        _ => None,
    };
    let Expression::Compose { components, .. } = &expressions[coordinate] else { return None };
    let [x, y] = components[..] else { return None };
    let Expression::Binary { op: BinaryOperator::And, left: number, right: mask } = expressions[x]
    else {
        return None;
    };
    let Expression::Binary { op: BinaryOperator::ShiftRight, left: same, right: bits } =
        expressions[y]
    else {
        return None;
    };
    let (mask, bits) = (literal(mask)?, literal(bits)?);
    (same == number && bits < 32 && mask == (1 << bits) - 1).then_some(number)
}
