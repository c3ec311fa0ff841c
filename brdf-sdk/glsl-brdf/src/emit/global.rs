//! What stands outside of functions: structs, constants, variables; and which functions there are.
//!
//! WGSL has no variables outside of functions that a plugin may use: those that change become members of a struct
//! that functions are handed, those that read parameters become functions. The bodies are `stmt.rs`'s.

use brdf_sdk::Result;

use super::names::{Kind, Variable};
use super::value::{Value, f32_text};
use super::{Emitter, Global, OwnFunction, Structure};
use crate::ast::{Argument, Declaration, Function, Item, Passed, Struct};
use crate::types::{FLOAT, Ty};

impl Emitter<'_> {
    /// Learns of everything by name before anything is written: functions may stand in any order.
    pub(super) fn announce(&mut self, tree: &[Item]) -> Result<()> {
        for item in tree {
            if let Item::Struct(found) = item {
                self.announce_structure(found)?;
            }
        }
        for item in tree {
            if let Item::Function(function) = item {
                self.announce_function(function)?;
            }
        }
        self.globals_name = self.module_name("Globals");
        Ok(())
    }

    fn announce_structure(&mut self, found: &Struct) -> Result<()> {
        let mut members = Vec::new();
        for (ty, names) in &found.members {
            let base = self.type_of(ty)?;
            for one in names {
                let ty = self.array_type(base.clone(), &one.lengths, None)?;
                let name = self.local_name(&one.name);
                members.push((one.name.clone(), ty, name));
            }
        }
        let wgsl = self.module_name(&found.name);
        self.structs.push(Structure { name: found.name.clone(), wgsl, members });
        Ok(())
    }

    fn announce_function(&mut self, function: &Function) -> Result<()> {
        let arguments = self.arguments_of(function)?;
        let result = self.type_of(&function.result)?;
        let name = function.name.clone();
        let known = self
            .functions
            .iter_mut()
            .find(|known| known.name == name && known.arguments == arguments);
        if let Some(known) = known {
            if known.is_defined && function.body.is_some() {
                return Err(self.source.problem(
                    function.name_span.clone(),
                    format!("the function `{name}` stands twice"),
                    "remove one",
                ));
            }
            known.is_defined |= function.body.is_some();
            return Ok(());
        }
        // WGSL has one function of a name: others are called by what they take.
        let words = arguments.iter().map(|(_, ty)| ty.word()).collect::<Vec<_>>().join("_");
        let wgsl = match self.functions.iter().any(|known| known.name == name) {
            true => self.module_name(&format!("{name}_{words}")),
            false => self.module_name(&name),
        };
        let names = function.arguments.iter().map(|argument| argument.name.clone()).collect();
        let is_defined = function.body.is_some();
        self.functions.push(OwnFunction { name, wgsl, arguments, names, result, is_defined });
        Ok(())
    }

    fn arguments_of(&mut self, function: &Function) -> Result<Vec<(Passed, Ty)>> {
        let of = |argument: &Argument| Ok((argument.passed, self.type_of(&argument.ty)?));
        function.arguments.iter().map(of).collect()
    }

    /// The place of one among functions: announced ones share it with their body.
    pub(super) fn function_of(&mut self, function: &Function) -> Result<usize> {
        let arguments = self.arguments_of(function)?;
        let same =
            |known: &OwnFunction| known.name == function.name && known.arguments == arguments;
        Ok(self.functions.iter().position(same).unwrap_or_default())
    }

    pub(super) fn write_structure(&mut self, found: &Struct) -> Result<()> {
        let Some(known) = self.structs.iter().find(|known| known.name == found.name) else {
            return Ok(());
        };
        let members: Vec<String> =
            known.members.iter().map(|(_, ty, name)| format!("{name}: {}", ty.wgsl())).collect();
        let text = format!("struct {} {{ {} }}", known.wgsl, members.join(", "));
        self.out.begin(found.span.start);
        self.out.put(&text);
        Ok(())
    }

    /// Writes variables outside of functions; the first of them is the `first`-th of all.
    pub(super) fn write_globals(&mut self, declaration: &Declaration, first: usize) -> Result<()> {
        for (index, one) in declaration.names.iter().enumerate() {
            let place = first + index;
            self.current = self.functions.len() + place;
            let ty = self.declared_type(&declaration.ty, one)?;
            let wgsl = self.module_name(&one.name);
            let value = one.value.as_ref().map(|value| self.initial(&ty, value)).transpose()?;
            if !self.pre.is_empty() || !self.post.is_empty() {
                return Err(self.untranslated("what this begins with", &one.span));
            }
            if value.as_ref().is_some_and(|value| value.text.contains("(*globals)") || value.acts) {
                return Err(self.untranslated("a first value that reads what changes", &one.span));
            }
            let changes = self.learned.assigned_globals.contains(&place);
            let number = value.as_ref().and_then(|value| value.number).filter(|_| !changes);
            let is_constant = self.write_global(&wgsl, &ty, value, one.span.start, changes);
            self.globals.push(Global {
                wgsl,
                ty: ty.clone(),
                is_const: declaration.is_const,
                is_constant,
                number,
            });
            self.outer.insert(one.name.clone(), Variable { ty, kind: Kind::Global(place) });
        }
        Ok(())
    }

    /// A constant where its value is known, a function where it is not; says which. One that changes is a member of what
    /// functions hand around, and its first value waits for that.
    fn write_global(
        &mut self,
        wgsl: &str,
        ty: &Ty,
        value: Option<Value>,
        place: usize,
        changes: bool,
    ) -> bool {
        let zero =
            || Value { is_constant: true, ..Value::single(format!("{}()", ty.wgsl()), ty.clone()) };
        let mut value = value.unwrap_or_else(zero);
        if let Some(number) = value.number.filter(|_| *ty == FLOAT && !value.is_constant) {
            let text = f32_text(number);
            value = Value { text, is_constant: true, ..value };
        }
        if changes {
            self.first_values.push(value.plain());
            return false;
        }
        self.out.begin(place);
        if value.is_constant {
            self.out.put(&format!("const {wgsl}: {} = {};", ty.wgsl(), value.text));
            return true;
        }
        let p =
            if self.learned.reads_parameters.contains(&self.current) { "p: Params" } else { "" };
        self.out.put(&format!("fn {wgsl}({p}) -> {} {{ return {}; }}", ty.wgsl(), value.text));
        false
    }

    /// A global's value where it is read.
    pub(super) fn global(&mut self, index: usize, ty: Ty) -> Value {
        let node = self.functions.len() + index;
        self.learning.calls.insert((self.current, node));
        self.learning.touched_globals.insert((self.current, index));
        let global = &self.globals[index];
        if self.learned.assigned_globals.contains(&index) {
            return Value::single(format!("(*globals).{}", global.wgsl), ty);
        }
        let number = global.number;
        if global.is_constant {
            return Value { is_constant: true, number, ..Value::single(global.wgsl.clone(), ty) };
        }
        let p = if self.learned.reads_parameters.contains(&node) { "p" } else { "" };
        Value { number, ..Value::single(format!("{}({p})", global.wgsl), ty) }
    }
}
