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
    Vec2f,
    Vec3f,
    Params,
    Settings,
    Hit,
    U32,
    /// What `prepare` returns: a struct of the author's.
    Prepared,
    PreparedPointer,
    State,
    Sampler,
    Quadrature,
}

/// One function of the contract.
struct Signature {
    name: String,
    arguments: Vec<(&'static str, Ty)>,
    result: Option<Ty>,
    required: bool,
}

/// A BRDF's functions, and those that fill its tables.
fn of_brdf(plugin: &Plugin) -> Vec<Signature> {
    let pair = vec![("p", Ty::Params), ("wo", Ty::Vec3f), ("wi", Ty::Vec3f)];
    let function = |name: &str, arguments: &[_], result| Signature {
        name: name.to_owned(),
        arguments: arguments.to_vec(),
        result: Some(result),
        required: name == "eval",
    };
    let fills = plugin.manifest.tables.iter().map(|table| Signature {
        name: format!("fill_{}", table.name),
        arguments: vec![("at", Ty::Vec2f)],
        result: Some(Ty::F32),
        required: true,
    });
    let own = [
        function("eval", &pair, Ty::Vec3f),
        function("sample", &[pair[0], pair[1], ("u", Ty::Vec3f)], Ty::Vec3f),
        function("pdf", &pair, Ty::F32),
        function("weight", &pair, Ty::Vec3f),
    ];
    own.into_iter().chain(fills).collect()
}

/// An integrator's functions: `estimate` or `term`, which get what `prepare` made and the state where
/// there are such.
fn of_integrator(plugin: &Plugin, cut: &Cut) -> Vec<Signature> {
    let begin = [("q", Ty::Settings), ("hit", Ty::Hit)];
    let learns = !plugin.manifest.state.is_empty();
    let sums = cut.declares("term");
    let prepares = cut.declares("prepare");
    let prepared = prepares.then_some(("prepared", Ty::PreparedPointer));
    let state = learns.then_some(("state", Ty::State));
    let estimate = begin.into_iter().chain([("s", Ty::Sampler)]).chain(prepared).chain(state);
    let term = begin.into_iter().chain([("k", Ty::U32), ("sum", Ty::Quadrature)]).chain(prepared);
    let main = match sums {
        true => ("term", term.collect::<Vec<_>>()),
        false => ("estimate", estimate.collect()),
    };
    let mut functions = vec![Signature {
        name: main.0.to_owned(),
        arguments: main.1,
        result: Some(Ty::Vec3f),
        required: true,
    }];
    if prepares {
        functions.push(Signature {
            name: "prepare".to_owned(),
            arguments: begin.to_vec(),
            result: Some(Ty::Prepared),
            required: true,
        });
    }
    if learns {
        functions.push(Signature {
            name: "learn".to_owned(),
            arguments: vec![begin[0], ("state", Ty::State)],
            result: None,
            required: true,
        });
    }
    functions
}

impl Ty {
    fn wgsl(self) -> &'static str {
        match self {
            Ty::F32 => "f32",
            Ty::Vec2f => "vec2f",
            Ty::Vec3f => "vec3f",
            Ty::Params => "Params",
            Ty::Settings => "Settings",
            Ty::Hit => "Hit",
            Ty::U32 => "u32",
            Ty::Prepared => "Prepared",
            Ty::PreparedPointer => "ptr<function, Prepared>",
            Ty::State => "ptr<function, State>",
            Ty::Sampler => "ptr<function, Sampler>",
            Ty::Quadrature => "ptr<function, Quadrature>",
        }
    }

    fn matches(self, module: &Module, ty: &Type, prefix: &str) -> bool {
        let named = |ty: &Type, name: &str| ty.name.as_deref() == Some(name);
        let points_to = |name: &str| match ty.inner {
            TypeInner::Pointer { base, space: AddressSpace::Function } => {
                named(&module.types[base], name)
            }
            _ => false,
        };
        match self {
            Ty::F32 => matches!(ty.inner, TypeInner::Scalar(s) if s.kind == ScalarKind::Float),
            Ty::Vec2f => matches!(
                ty.inner,
                TypeInner::Vector { size: VectorSize::Bi, scalar } if scalar.kind == ScalarKind::Float
            ),
            Ty::Vec3f => matches!(
                ty.inner,
                TypeInner::Vector { size: VectorSize::Tri, scalar } if scalar.kind == ScalarKind::Float
            ),
            Ty::Params | Ty::Settings => named(ty, &format!("{prefix}{}", self.wgsl())),
            Ty::U32 => matches!(ty.inner, TypeInner::Scalar(s) if s.kind == ScalarKind::Uint),
            Ty::Prepared => named(ty, &format!("{prefix}Prepared")),
            Ty::Hit => named(ty, "Hit"),
            Ty::PreparedPointer => points_to(&format!("{prefix}Prepared")),
            Ty::State => points_to(&format!("{prefix}State")),
            Ty::Sampler => points_to("Sampler"),
            Ty::Quadrature => points_to("Quadrature"),
        }
    }
}

impl Signature {
    fn wgsl(&self) -> String {
        let arguments: Vec<_> =
            self.arguments.iter().map(|(name, ty)| format!("{name}: {}", ty.wgsl())).collect();
        let result = self.result.map(|ty| format!(" -> {}", ty.wgsl())).unwrap_or_default();
        format!("fn {}({}){result}", self.name, arguments.join(", "))
    }
}

fn contract(plugin: &Plugin, cut: &Cut) -> Vec<Signature> {
    match plugin.manifest.kind {
        Kind::Brdf => of_brdf(plugin),
        Kind::Integrator => of_integrator(plugin, cut),
    }
}

/// Checks that what must be there is there; needs no parsed module, and so comes before naga's word.
pub fn check_presence(plugin: &Plugin, cut: &Cut) -> Result<()> {
    let both = ["estimate", "term"].map(|name| cut.declaration(name));
    if let (Kind::Integrator, [Some(_), Some(term)]) = (plugin.manifest.kind, both) {
        return Err(Problem::at(
            &plugin.wgsl_file,
            &plugin.source,
            term.name_span.clone(),
            "an integrator averages estimates or adds terms, and this one has both functions",
            "remove `estimate` or `term`",
        ));
    }
    for signature in contract(plugin, cut).iter().filter(|signature| signature.required) {
        let declared =
            |d: &super::declarations::Declaration| d.keyword == "fn" && d.name == signature.name;
        if !cut.declarations.iter().any(declared) {
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
    for signature in contract(plugin, cut) {
        let Some(declaration) = cut.declaration(&signature.name) else { continue };
        let linked_name = format!("{prefix}{}", signature.name);
        let function =
            module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(&linked_name));
        let fits = function.is_some_and(|(_, function)| {
            let arguments = function.arguments.len() == signature.arguments.len()
                && function.arguments.iter().zip(&signature.arguments).all(
                    |(argument, (_, ty))| ty.matches(module, &module.types[argument.ty], prefix),
                );
            let result = match (&function.result, signature.result) {
                (Some(found), Some(ty)) => ty.matches(module, &module.types[found.ty], prefix),
                (None, None) => true,
                _ => false,
            };
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
