//! The functions of the contract, checked on the parsed module before linking, so that a wrong
//! `eval` is blamed on the author's line and not on the host's call of it.

use brdf_sdk::{Kind, Problem, Result};
use naga::{AddressSpace, Module, ScalarKind, Type, TypeInner, VectorSize};

use super::declarations::Cut;
use crate::plugin::Plugin;

/// A type that the contract uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ty {
    F32,
    Vec3f,
    Params,
    Settings,
    Hit,
    Sampler,
}

/// One function of the contract.
struct Signature {
    name: &'static str,
    arguments: &'static [(&'static str, Ty)],
    result: Ty,
    required: bool,
}

const BRDF: [Signature; 4] = [
    Signature {
        name: "eval",
        arguments: &[("p", Ty::Params), ("wo", Ty::Vec3f), ("wi", Ty::Vec3f)],
        result: Ty::Vec3f,
        required: true,
    },
    Signature {
        name: "sample",
        arguments: &[("p", Ty::Params), ("wo", Ty::Vec3f), ("u", Ty::Vec3f)],
        result: Ty::Vec3f,
        required: false,
    },
    Signature {
        name: "pdf",
        arguments: &[("p", Ty::Params), ("wo", Ty::Vec3f), ("wi", Ty::Vec3f)],
        result: Ty::F32,
        required: false,
    },
    Signature {
        name: "weight",
        arguments: &[("p", Ty::Params), ("wo", Ty::Vec3f), ("wi", Ty::Vec3f)],
        result: Ty::Vec3f,
        required: false,
    },
];

const INTEGRATOR: [Signature; 1] = [Signature {
    name: "estimate",
    arguments: &[("q", Ty::Settings), ("hit", Ty::Hit), ("s", Ty::Sampler)],
    result: Ty::Vec3f,
    required: true,
}];

impl Ty {
    fn wgsl(self) -> &'static str {
        match self {
            Ty::F32 => "f32",
            Ty::Vec3f => "vec3f",
            Ty::Params => "Params",
            Ty::Settings => "Settings",
            Ty::Hit => "Hit",
            Ty::Sampler => "ptr<function, Sampler>",
        }
    }

    fn matches(self, module: &Module, ty: &Type, prefix: &str) -> bool {
        let named = |ty: &Type, name: &str| ty.name.as_deref() == Some(name);
        match self {
            Ty::F32 => matches!(ty.inner, TypeInner::Scalar(s) if s.kind == ScalarKind::Float),
            Ty::Vec3f => matches!(
                ty.inner,
                TypeInner::Vector { size: VectorSize::Tri, scalar } if scalar.kind == ScalarKind::Float
            ),
            Ty::Params | Ty::Settings => named(ty, &format!("{prefix}{}", self.wgsl())),
            Ty::Hit => named(ty, "Hit"),
            Ty::Sampler => match ty.inner {
                TypeInner::Pointer { base, space: AddressSpace::Function } => {
                    named(&module.types[base], "Sampler")
                }
                _ => false,
            },
        }
    }
}

impl Signature {
    fn wgsl(&self) -> String {
        let arguments: Vec<_> =
            self.arguments.iter().map(|(name, ty)| format!("{name}: {}", ty.wgsl())).collect();
        format!("fn {}({}) -> {}", self.name, arguments.join(", "), self.result.wgsl())
    }
}

fn contract(kind: Kind) -> &'static [Signature] {
    match kind {
        Kind::Brdf => &BRDF,
        Kind::Integrator => &INTEGRATOR,
    }
}

/// Checks that what must be there is there; needs no parsed module, and so comes before naga's word.
pub fn check_presence(plugin: &Plugin, cut: &Cut) -> Result<()> {
    for signature in contract(plugin.manifest.kind).iter().filter(|signature| signature.required) {
        if !cut.declarations.iter().any(|d| d.keyword == "fn" && d.name == signature.name) {
            return Err(Problem::new(
                &plugin.wgsl_file,
                format!("`{}` is missing", signature.name),
                format!("add `{}`", signature.wgsl()),
            ));
        }
    }
    Ok(())
}

/// Checks the types of every function of the contract that the plugin defines.
pub fn check_types(plugin: &Plugin, cut: &Cut, module: &Module, prefix: &str) -> Result<()> {
    for signature in contract(plugin.manifest.kind) {
        let Some(declaration) = cut.declaration(signature.name) else { continue };
        let linked_name = format!("{prefix}{}", signature.name);
        let function =
            module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(&linked_name));
        let fits = function.is_some_and(|(_, function)| {
            let arguments = function.arguments.len() == signature.arguments.len()
                && function.arguments.iter().zip(signature.arguments).all(|(argument, (_, ty))| {
                    ty.matches(module, &module.types[argument.ty], prefix)
                });
            let result = function.result.as_ref().is_some_and(|result| {
                signature.result.matches(module, &module.types[result.ty], prefix)
            });
            arguments && result
        });
        if !fits {
            return Err(Problem::at(
                &plugin.wgsl_file,
                &plugin.source,
                declaration.name_span.clone(),
                format!("`{}` has another signature than the contract's", signature.name),
                format!("write `{}`", signature.wgsl()),
            ));
        }
    }
    Ok(())
}
