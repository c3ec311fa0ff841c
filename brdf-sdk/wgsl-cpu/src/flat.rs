//! A lowered program laid out flat: dead code dropped, short regions dissolved, instructions joined, registers given
//! slots by liveness.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use crate::fuse::Fusion;
use crate::lower::{Lowered, RegInfo};
use crate::op::{Bank, Inst, NONE, Node, Op, Reg};
use crate::prune::{dissolve, drop_dead};
use crate::refusal::Refusal;

/// Slots of a bank: what a worker's memory is bounded by.
const MAX_SLOTS: usize = 1 << 14;

/// How control flows between runs of instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Flow {
    /// Instructions from the first up to the second.
    Run(u32, u32),
    /// On to step `to` where the mask is set in no lane.
    SkipNone { mask: Reg, to: u32 },
    /// On to step `to` where the uniform mask is not set.
    Skip { test: Reg, to: u32 },
    /// On to step `to`.
    Jump(u32),
    /// Back to step `to` while a lane of the mask is left, or always.
    Back { mask: Option<Reg>, to: u32, cost: u32, span: u32 },
}

/// An instruction with its slots, and which of them are uniform.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    pub inst: Inst,
    /// Of d, a, b and c.
    pub uniform: [bool; 4],
}

/// A program ready for a machine.
#[derive(Debug, Default)]
pub(crate) struct Flat {
    /// Once for each worker.
    pub once: Vec<Placed>,
    /// For each batch.
    pub code: Vec<Placed>,
    pub flow: Vec<Flow>,
    /// Slots of floats and of words.
    pub slots: [usize; 2],
    /// Uniform floats and words.
    pub uniforms: [usize; 2],
}

/// What an instruction takes of the budget: one, but where it does many.
pub(crate) fn fuel(inst: &Inst) -> u32 {
    match inst.op {
        Op::Clear(_) => inst.extra,
        _ => 1,
    }
}

/// Lays a program out; `keep_apart` where it matters which lanes execute an instruction, and which
/// one made a result, and not only which results are used.
pub(crate) fn flatten(lowered: &mut Lowered, keep_apart: bool) -> Result<Flat, Refusal> {
    let regs = std::mem::take(&mut lowered.regs);
    drop_dead(&mut lowered.once, &mut lowered.batch, regs.len());
    let mut batch = std::mem::take(&mut lowered.batch);
    if !keep_apart {
        batch = dissolve(batch, &regs);
    }
    let mut layout = Layout { regs, ..Layout::default() };
    for node in &lowered.once {
        if let Node::Inst(inst) = node {
            layout.code.push(*inst);
        }
    }
    layout.once = layout.code.len();
    layout.walk(&batch);
    if !keep_apart {
        layout.fuse();
        layout.join_fetches();
    }
    layout.place()
}

#[derive(Default)]
struct Layout {
    regs: Vec<RegInfo>,
    code: Vec<Inst>,
    /// Instructions before the batch.
    once: usize,
    flow: Vec<Flow>,
    /// First and last instruction of each loop.
    loops: Vec<(usize, usize)>,
    /// Registers that control reads, and before which instruction.
    tests: Vec<(usize, Reg)>,
    /// Jumps that wait for their target: step, loop, whether to its `next` part.
    jumps: Vec<(usize, u32, bool)>,
}

impl Layout {
    fn walk(&mut self, nodes: &[Node]) {
        let mut start = self.code.len();
        for node in nodes {
            if let Node::Inst(inst) = node {
                self.code.push(*inst);
                continue;
            }
            self.run_from(start);
            match node {
                Node::Inst(_) => {}
                Node::Region { test, body } => {
                    self.tests.push((self.code.len(), *test));
                    let at = self.flow.len();
                    self.flow.push(Flow::Jump(0));
                    self.walk(body);
                    let to = self.flow.len() as u32;
                    self.flow[at] = if self.regs[*test as usize].uniform {
                        Flow::Skip { test: *test, to }
                    } else {
                        Flow::SkipNone { mask: *test, to }
                    };
                }
                Node::Loop { id, live, body, next, span } => {
                    let (first, to) = (self.code.len(), self.flow.len() as u32);
                    if let Some(live) = *live {
                        // Nobody may be left from the start.
                        self.tests.push((self.code.len(), live));
                        self.flow.push(Flow::Jump(0));
                        self.walk(body);
                        let end = self.flow.len() as u32;
                        self.flow[to as usize] = Flow::SkipNone { mask: live, to: end };
                    } else {
                        self.walk(body);
                    }
                    self.land(*id, true);
                    self.walk(next);
                    let cost = self.code[first..].iter().map(fuel).fold(1, u32::saturating_add);
                    self.tests.extend(live.map(|live| (self.code.len(), live)));
                    self.loops.push((first, self.code.len()));
                    self.flow.push(Flow::Back { mask: *live, to, cost, span: *span });
                    self.land(*id, false);
                }
                Node::Exit(id) | Node::Next(id) => {
                    self.jumps.push((self.flow.len(), *id, matches!(node, Node::Next(_))));
                    self.flow.push(Flow::Jump(0));
                }
            }
            start = self.code.len();
        }
        self.run_from(start);
    }

    fn run_from(&mut self, start: usize) {
        if self.code.len() > start {
            self.flow.push(Flow::Run(start as u32, self.code.len() as u32));
        }
    }

    /// Jumps of a loop to its `next` part, or to its end, come down here.
    fn land(&mut self, id: u32, next: bool) {
        let to = self.flow.len() as u32;
        let flow = &mut self.flow;
        self.jumps.retain(|(step, target, to_next)| {
            let here = *target == id && *to_next == next;
            if here {
                flow[*step] = Flow::Jump(to);
            }
            !here
        });
    }

    fn fuse(&mut self) {
        let runs = self.runs();
        let tests = self.tests.iter().map(|(_, reg)| *reg);
        let dead = Fusion::new(&mut self.code, &self.regs, &runs, tests).run(self.once);
        self.drop_dead(&dead);
    }

    /// Of each instruction the run that it belongs to: what lies between two may be passed over or repeated.
    fn runs(&self) -> Vec<u32> {
        let mut runs = vec![0u32; self.code.len()];
        for (number, flow) in self.flow.iter().enumerate() {
            if let Flow::Run(start, end) = flow {
                runs[*start as usize..*end as usize].fill(number as u32 + 1);
            }
        }
        runs
    }

    /// Fetches of one texel in one run become one, where the first of them stands: a texel is one load of 16
    /// bytes, and four loads of 4 took nearly half of the time of a program that lives on tables.
    fn join_fetches(&mut self) {
        let run = self.runs();
        let mut texels: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (at, inst) in self.code.iter().enumerate().skip(self.once) {
            if let Op::Fetch(bank, counted) = inst.op
                && !self.regs[inst.a as usize].mutable
            {
                texels.entry((run[at], inst.a, inst.extra, bank, counted)).or_default().push(at);
            }
        }
        let mut dead = vec![false; self.code.len()];
        for ((_, _, _, bank, counted), fetches) in
            texels.into_iter().filter(|(_, all)| all.len() > 1)
        {
            let first = self.code[fetches[0]];
            let mut components = [NONE; 4];
            for at in &fetches {
                let component = &mut components[self.code[*at].imm as usize % 4];
                // Two regions that run always may each have fetched the same: the second keeps its own.
                if *component == NONE {
                    *component = self.code[*at].d;
                    dead[*at] = true;
                }
            }
            for component in components.iter_mut().filter(|component| **component == NONE) {
                self.regs.push(self.regs[first.d as usize]);
                *component = self.regs.len() as Reg - 1;
            }
            let [d, b, c, imm] = components;
            self.code[fetches[0]] = Inst { op: Op::FetchAll(bank, counted), d, b, c, imm, ..first };
            dead[fetches[0]] = false;
        }
        self.drop_dead(&dead);
    }

    fn drop_dead(&mut self, dead: &[bool]) {
        let mut new = Vec::with_capacity(dead.len() + 1);
        let mut count = 0;
        for dead in dead {
            new.push(count);
            count += usize::from(!dead);
        }
        new.push(count);
        let mut at = 0;
        self.code.retain(|_| {
            at += 1;
            !dead[at - 1]
        });
        for flow in &mut self.flow {
            if let Flow::Run(start, end) = flow {
                (*start, *end) = (new[*start as usize] as u32, new[*end as usize] as u32);
            }
        }
        for (first, last) in &mut self.loops {
            (*first, *last) = (new[*first], new[*last]);
        }
        for (at, _) in &mut self.tests {
            *at = new[*at];
        }
    }

    /// Slots by linear scan over live ranges.
    fn place(mut self) -> Result<Flat, Refusal> {
        let ranges = self.ranges();
        let mut flat = Flat::default();
        let mut slots = vec![NONE; self.regs.len()];
        let bank = |reg: usize| (self.regs[reg].bank == Bank::Word) as usize;
        let mut order: Vec<(usize, usize, usize)> = Vec::new();
        for (reg, range) in ranges.iter().enumerate() {
            let Some((start, end)) = *range else { continue };
            if self.regs[reg].uniform {
                slots[reg] = flat.uniforms[bank(reg)] as Reg;
                flat.uniforms[bank(reg)] += 1;
            } else {
                order.push((start, end, reg));
            }
        }
        order.sort_unstable();
        let mut busy: [BinaryHeap<Reverse<(usize, Reg)>>; 2] = Default::default();
        let mut free: [Vec<Reg>; 2] = Default::default();
        for (start, end, reg) in order {
            let bank = bank(reg);
            while let Some(Reverse((until, slot))) = busy[bank].peek().copied() {
                // An instruction may not write where it reads.
                if until >= start {
                    break;
                }
                busy[bank].pop();
                free[bank].push(slot);
            }
            let slot = free[bank].pop().unwrap_or_else(|| {
                flat.slots[bank] += 1;
                flat.slots[bank] as Reg - 1
            });
            slots[reg] = slot;
            busy[bank].push(Reverse((end, slot)));
        }
        if flat.slots.iter().any(|count| *count > MAX_SLOTS) {
            return Err(Refusal {
                reason: format!("programs with more than {MAX_SLOTS} values at once"),
                span: naga::Span::UNDEFINED,
            });
        }
        let slot = |reg: Reg| if reg == NONE { NONE } else { slots[reg as usize] };
        let uniform = |reg: Reg| reg == NONE || self.regs[reg as usize].uniform;
        let mut placed: Vec<Placed> = self
            .code
            .iter()
            .map(|inst| Placed {
                uniform: [inst.d, inst.a, inst.b, inst.c].map(uniform),
                inst: Inst {
                    d: slot(inst.d),
                    a: slot(inst.a),
                    b: slot(inst.b),
                    c: slot(inst.c),
                    imm: match inst.op {
                        Op::FetchAll(..) => slot(inst.imm),
                        _ => inst.imm,
                    },
                    ..*inst
                },
            })
            .collect();
        for flow in &mut self.flow {
            match flow {
                Flow::SkipNone { mask: test, .. }
                | Flow::Skip { test, .. }
                | Flow::Back { mask: Some(test), .. } => *test = slots[*test as usize],
                Flow::Run(start, end) => {
                    *start -= self.once as u32;
                    *end -= self.once as u32;
                }
                _ => {}
            }
        }
        flat.code = placed.split_off(self.once);
        flat.once = placed;
        flat.flow = self.flow;
        Ok(flat)
    }

    /// From the instruction that first writes a register to the last one that reads it; what a loop
    /// finds ready it needs until its last round is over.
    fn ranges(&self) -> Vec<Option<(usize, usize)>> {
        let mut ranges: Vec<Option<(usize, usize)>> = vec![None; self.regs.len()];
        let mut touch = |reg: Reg, at: usize| {
            if reg != NONE {
                let range = ranges[reg as usize].get_or_insert((at, at));
                *range = (range.0.min(at), range.1.max(at));
            }
        };
        for (at, inst) in self.code.iter().enumerate() {
            inst.reads().chain(inst.writes()).for_each(|reg| touch(reg, at));
        }
        for (at, reg) in &self.tests {
            touch(*reg, *at);
        }
        // Loops come innermost first, so that a range grows outwards in one sweep.
        let batch = (self.once, self.code.len());
        let loops: Vec<_> = self.loops.iter().chain([&batch]).copied().collect();
        for range in ranges.iter_mut().flatten() {
            for (first, last) in &loops {
                if range.0 < *first && range.1 >= *first && range.1 < *last {
                    range.1 = *last;
                }
            }
        }
        ranges
    }
}
