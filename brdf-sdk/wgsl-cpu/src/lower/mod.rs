//! From naga's tree to instructions: calls are written out, values taken apart into scalars, branches
//! turned into masks and selects.
//!
//! What is the same in all lanes is found by assuming it: the first attempt takes every loop and every
//! variable that a loop carries for uniform, notes where that proves wrong, and the lowering starts
//! again with what it has learned, until nothing new is found.

mod branch;
mod builder;
mod control;
mod effects;
mod frames;
mod function;
mod integers;
mod math;
mod operator;
mod packing;
mod place;
mod shape;
mod value;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use naga::valid::ModuleInfo;
use naga::{AddressSpace, EntryPoint, GlobalVariable, Handle, Module, ShaderStage};

use crate::op::{Bank, Node, Reg};
use crate::refusal::Refusal;
use builder::Builder;
pub(crate) use builder::RegInfo;
use place::Place;
use shape::{Parts, Shapes, Ty};

type Result<T> = std::result::Result<T, Refusal>;

/// Rounds that learn; after them nothing is taken for uniform that a loop touches.
const ROUNDS: usize = 12;

/// Elements of a lane's own memory.
const MAX_MEMORY: u32 = 1 << 15;

/// A program as instructions, before it is laid out flat.
pub(crate) struct Lowered {
    /// Once for each worker.
    pub once: Vec<Node>,
    /// For each batch of lanes.
    pub batch: Vec<Node>,
    pub regs: Vec<RegInfo>,
    pub spans: Vec<naga::Span>,
    /// Tables of constants: of floats by their bits, and of words.
    pub tables: [Vec<Vec<u32>>; 2],
    /// Elements of a lane's own memory.
    pub memory: u32,
    /// The buffers and textures that it reaches; instructions name them by index.
    pub resources: Vec<Handle<GlobalVariable>>,
    /// Places of `pow`, whose base is watched.
    pub watches: Vec<naga::Span>,
}

/// What a round found not to be uniform.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Fact {
    /// Lanes leave this loop at different times.
    Divergent(u32),
    /// A component that this loop carries differs by lane.
    Varying { frame: u32, var: usize, component: usize },
}

#[derive(Default)]
struct Facts {
    known: HashSet<Fact>,
    /// Found in this round.
    new: bool,
    /// Nothing is assumed any more.
    pessimistic: bool,
}

impl Facts {
    fn holds(&self, fact: Fact) -> bool {
        self.pessimistic || self.known.contains(&fact)
    }

    fn learn(&mut self, fact: Fact) {
        self.new |= self.known.insert(fact);
    }
}

/// Lowers the module's only compute entry point.
pub(crate) fn lower(module: &Module, info: &ModuleInfo) -> Result<Lowered> {
    let nowhere =
        |reason: &str| Err(Refusal { reason: reason.to_owned(), span: naga::Span::UNDEFINED });
    let [entry] = &module.entry_points[..] else {
        return nowhere("modules without exactly one entry point");
    };
    if entry.stage != ShaderStage::Compute {
        return nowhere("entry points other than compute");
    }
    let mut facts = Facts::default();
    for round in 0.. {
        facts.new = false;
        facts.pessimistic = round >= ROUNDS;
        let lowered = Lowering::new(module, info, &mut facts).run(entry)?;
        if !facts.new || facts.pessimistic {
            return Ok(lowered);
        }
    }
    unreachable!("the last round is pessimistic")
}

/// The variables' components at a point of the program, and who is there to see them.
#[derive(Clone)]
struct Env {
    vars: Vec<Rc<Vec<Reg>>>,
    /// A mask of the lanes that execute this point.
    exec: Reg,
    /// Nobody gets here.
    dead: bool,
    /// It died by a jump, so that control does not come to what follows.
    jumped: bool,
}

struct Lowering<'a> {
    module: &'a Module,
    info: &'a ModuleInfo,
    shapes: Shapes<'a>,
    build: Builder,
    facts: &'a mut Facts,
    env: Env,
    /// For each variable the call that it belongs to; 0 for private variables.
    owners: Vec<usize>,
    privates: HashMap<Handle<GlobalVariable>, Place>,
    resources: Vec<Handle<GlobalVariable>>,
    watches: Vec<naga::Span>,
    calls: usize,
    loops: u32,
    /// Elements of the lanes' own memory in use, and the most that were.
    memory: u32,
    memory_peak: u32,
}

impl<'a> Lowering<'a> {
    fn new(module: &'a Module, info: &'a ModuleInfo, facts: &'a mut Facts) -> Self {
        let mut build = Builder::new();
        let exec = build.mask(true);
        Self {
            module,
            info,
            shapes: Shapes::new(module),
            build,
            facts,
            env: Env { vars: Vec::new(), exec, dead: false, jumped: false },
            owners: Vec::new(),
            privates: HashMap::new(),
            resources: Vec::new(),
            watches: Vec::new(),
            calls: 0,
            loops: 0,
            memory: 0,
            memory_peak: 0,
        }
    }

    fn run(mut self, entry: &'a EntryPoint) -> Result<Lowered> {
        self.env.exec = self.active();
        for (handle, variable) in self.module.global_variables.iter() {
            if variable.space == AddressSpace::Private {
                let outer = self.build.set_span(self.module.global_variables.get_span(handle));
                let init = match variable.init {
                    Some(init) => Some(self.global_constant(init)?),
                    None => None,
                };
                let place = self.variable(0, variable.ty, init)?;
                self.privates.insert(handle, place);
                self.build.restore_span(outer);
            }
        }
        self.entry_call(entry)?;
        let (once, batch, build) = self.build.finish();
        Ok(Lowered {
            once,
            batch,
            regs: build.regs,
            spans: build.spans,
            tables: build.tables,
            memory: self.memory_peak,
            resources: self.resources,
            watches: self.watches,
        })
    }

    fn parts(&mut self, ty: Ty) -> Result<Rc<Parts>> {
        self.shapes.parts(ty).or_else(|reason| self.build.refuse(reason))
    }

    fn zeros(&mut self, banks: &[Bank]) -> Vec<Reg> {
        banks.iter().map(|bank| self.build.zero(*bank)).collect()
    }
}
