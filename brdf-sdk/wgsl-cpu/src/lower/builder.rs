//! Appends instructions: shares equal ones, hoists what a loop does not change, keeps track of what is
//! the same in all lanes.
//!
//! Lists stand for the nesting of regions and loops. List 0 runs once for each worker, list 1 is the
//! batch; a pure instruction goes as far out as its operands allow without leaving a region that is
//! not inside a loop. That is sound because every instruction is total: nothing traps.

use std::collections::HashMap;

use naga::Span;

use crate::op::{Bank, Inst, NONE, Node, Op, Reg, U2};
use crate::refusal::Refusal;

/// Instructions that a program may have: bounds what inlining and unrolled accesses can grow to.
const MAX_INSTRUCTIONS: usize = 1 << 20;

/// What is known of a register.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegInfo {
    pub bank: Bank,
    /// The same in all lanes.
    pub uniform: bool,
    /// Written more than once.
    pub mutable: bool,
    /// The list that it is defined in.
    depth: u32,
}

type Key = (Op, Reg, Reg, Reg, u32, u32);

/// Which part of a word another one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cut {
    Low,
    Above,
}

#[derive(Default)]
struct List {
    nodes: Vec<Node>,
    is_loop: bool,
    shared: HashMap<Key, Reg>,
}

/// The program while it grows.
pub(super) struct Builder {
    pub regs: Vec<RegInfo>,
    lists: Vec<List>,
    constants: HashMap<Reg, u32>,
    /// Words that are the low bits of another, or what is above some of them: the word, and how many bits.
    cuts: HashMap<Reg, (Cut, Reg, u32)>,
    pub spans: Vec<Span>,
    span_ids: HashMap<std::ops::Range<usize>, u32>,
    span: u32,
    count: usize,
    /// Tables of constants: of floats by their bits, and of words.
    pub tables: [Vec<Vec<u32>>; 2],
}

impl Builder {
    pub(super) fn new() -> Self {
        let batch = List { is_loop: true, ..List::default() };
        Self {
            regs: Vec::new(),
            lists: vec![List::default(), batch],
            constants: HashMap::new(),
            cuts: HashMap::new(),
            spans: vec![Span::UNDEFINED],
            span_ids: HashMap::new(),
            span: 0,
            count: 0,
            tables: Default::default(),
        }
    }

    /// The nodes of the two outermost lists: once for each worker, and for each batch.
    pub(super) fn finish(mut self) -> (Vec<Node>, Vec<Node>, Self) {
        let batch = self.close();
        let once = self.close();
        (once, batch, self)
    }

    /// Instructions that follow come from `span`; the previous one is returned.
    pub(super) fn set_span(&mut self, span: Span) -> u32 {
        let before = self.span;
        if let Some(range) = span.to_range() {
            let next = self.spans.len() as u32;
            self.span = *self.span_ids.entry(range).or_insert(next);
            if self.span == next {
                self.spans.push(span);
            }
        }
        before
    }

    pub(super) fn restore_span(&mut self, span: u32) {
        self.span = span;
    }

    /// Where the instructions that follow come from.
    pub(super) fn span(&self) -> Span {
        self.spans[self.span as usize]
    }

    pub(super) fn span_id(&self) -> u32 {
        self.span
    }

    pub(super) fn refuse<T>(&self, reason: impl Into<String>) -> Result<T, Refusal> {
        Err(Refusal { reason: reason.into(), span: self.spans[self.span as usize] })
    }

    /// Fails once the program has grown too large.
    pub(super) fn check_size(&self) -> Result<(), Refusal> {
        if self.count > MAX_INSTRUCTIONS {
            return self.refuse(format!(
                "programs of more than {MAX_INSTRUCTIONS} instructions, with all calls written out"
            ));
        }
        Ok(())
    }

    /// Counts a call, which may add nothing else.
    pub(super) fn count_call(&mut self) {
        self.count += 1;
    }

    pub(super) fn level(&self) -> u32 {
        self.lists.len() as u32 - 1
    }

    pub(super) fn open(&mut self, is_loop: bool) {
        self.lists.push(List { is_loop, ..List::default() });
    }

    pub(super) fn close(&mut self) -> Vec<Node> {
        self.lists.pop().map(|list| list.nodes).unwrap_or_default()
    }

    pub(super) fn push(&mut self, node: Node) {
        self.count += 1;
        if let Some(list) = self.lists.last_mut() {
            list.nodes.push(node);
        }
    }

    fn define(&mut self, bank: Bank, uniform: bool, mutable: bool, depth: u32) -> Reg {
        self.regs.push(RegInfo { bank, uniform, mutable, depth });
        self.regs.len() as Reg - 1
    }

    /// A register that is written by moves; it belongs to the list at `depth`.
    pub(super) fn mutable(&mut self, bank: Bank, uniform: bool, depth: u32) -> Reg {
        self.define(bank, uniform, true, depth)
    }

    /// A mutable register of an inner list belongs to the current one from now on.
    pub(super) fn settle(&mut self, reg: Reg) {
        self.regs[reg as usize].depth = self.level();
    }

    pub(super) fn info(&self, reg: Reg) -> RegInfo {
        self.regs[reg as usize]
    }

    pub(super) fn uniform(&self, reg: Reg) -> bool {
        self.info(reg).uniform
    }

    pub(super) fn constant_value(&self, reg: Reg) -> Option<u32> {
        self.constants.get(&reg).copied()
    }

    fn constant(&mut self, bank: Bank, bits: u32) -> Reg {
        let reg = self.emit_at(Op::Constant(bank), [NONE; 3], bits, 0);
        self.constants.insert(reg, bits);
        reg
    }

    pub(super) fn float(&mut self, value: f32) -> Reg {
        self.constant(Bank::Float, value.to_bits())
    }

    pub(super) fn word(&mut self, value: u32) -> Reg {
        self.constant(Bank::Word, value)
    }

    pub(super) fn mask(&mut self, value: bool) -> Reg {
        self.word(if value { !0 } else { 0 })
    }

    pub(super) fn zero(&mut self, bank: Bank) -> Reg {
        self.constant(bank, 0)
    }

    /// The register with its value in every lane.
    pub(super) fn varying(&mut self, reg: Reg) -> Reg {
        if reg == NONE || !self.uniform(reg) {
            return reg;
        }
        let bank = self.info(reg).bank;
        self.emit_at(Op::Splat(bank), [reg, NONE, NONE], 0, 0)
    }

    pub(super) fn unary(&mut self, op: Op, a: Reg) -> Reg {
        self.emit(op, [a, NONE, NONE], 0, 0)
    }

    pub(super) fn binary(&mut self, op: Op, a: Reg, b: Reg) -> Reg {
        self.emit(op, [a, b, NONE], 0, 0)
    }

    pub(super) fn u2(&mut self, op: U2, a: Reg, b: Reg) -> Reg {
        self.binary(Op::U2(op), a, b)
    }

    pub(super) fn select(&mut self, mask: Reg, accept: Reg, reject: Reg) -> Reg {
        if accept == reject {
            return accept;
        }
        match self.constant_value(mask) {
            Some(0) => reject,
            Some(_) => accept,
            None => {
                let bank = self.info(accept).bank;
                self.emit(Op::Select(bank), [mask, accept, reject], 0, 0)
            }
        }
    }

    /// Appends an instruction and returns its result, or an earlier register that holds the same.
    pub(super) fn emit(&mut self, op: Op, [a, b, c]: [Reg; 3], imm: u32, extra: u32) -> Reg {
        if let Some(reg) = self.simplified(op, a, b) {
            return reg;
        }
        let all_uniform =
            [a, b, c].iter().all(|reg| *reg == NONE || self.uniform(*reg)) && may_be_uniform(op);
        let operands = if all_uniform || op.mixes() {
            [a, b, c]
        } else {
            [a, b, c].map(|reg| self.varying(reg))
        };
        self.emit_at(op, operands, imm, extra)
    }

    /// Masks meet constants often; the rest is left as the author wrote it.
    fn simplified(&mut self, op: Op, a: Reg, b: Reg) -> Option<Reg> {
        let Op::U2(op) = op else { return None };
        let (first, second) = (self.constant_value(a), self.constant_value(b));
        match op {
            U2::And if a == b || second == Some(!0) => Some(a),
            U2::And if first == Some(!0) => Some(b),
            U2::And if first == Some(0) || second == Some(0) => Some(self.word(0)),
            U2::Or if a == b || second == Some(0) => Some(a),
            U2::Or if first == Some(0) => Some(b),
            U2::AndNot if second == Some(0) => Some(a),
            U2::AndNot if a == b || second == Some(!0) => Some(self.word(0)),
            U2::Add if second == Some(0) => Some(a),
            U2::Add if first == Some(0) => Some(b),
            U2::Mul if second == Some(1) => Some(a),
            U2::Mul if first == Some(1) => Some(b),
            _ => None,
        }
    }

    fn emit_at(&mut self, op: Op, [a, b, c]: [Reg; 3], imm: u32, extra: u32) -> Reg {
        let (a, b) = if op.commutes() && a > b { (b, a) } else { (a, b) };
        let span = self.span;
        let Some(bank) = op.result() else {
            self.push(Node::Inst(Inst { op, d: NONE, a, b, c, imm, extra, span }));
            return NONE;
        };
        let operands = [a, b, c].into_iter().filter(|reg| *reg != NONE);
        let depth = operands.clone().map(|reg| self.info(reg).depth).max().unwrap_or(0);
        let uniform = may_be_uniform(op) && operands.clone().all(|reg| self.uniform(reg));
        let pure = op.is_pure();
        // What differs by batch does not leave the batch.
        let depth = if matches!(op, Op::Builtin(_)) { depth.max(1) } else { depth };
        let key = (op, a, b, c, imm, extra);
        let mut target = self.lists.len() - 1;
        if pure {
            if let Some(shared) = self.lists.iter().find_map(|list| list.shared.get(&key)) {
                return *shared;
            }
            let outside = depth as usize + 1..self.lists.len();
            if let Some(level) = outside.into_iter().find(|level| self.lists[*level].is_loop) {
                target = level - 1;
            }
        }
        let d = self.define(bank, uniform, false, target as u32);
        self.count += 1;
        self.lists[target].nodes.push(Node::Inst(Inst { op, d, a, b, c, imm, extra, span }));
        // What a switch carries is written again in the list that it stands in; until it belongs to
        // that list, nothing that reads it is shared there.
        let steady = |reg: Reg| {
            let info = self.info(reg);
            !info.mutable || info.depth as usize <= target
        };
        if pure && operands.clone().all(steady) {
            self.lists[target].shared.insert(key, d);
        }
        if let Some(cut) = self.cut(op, a, b) {
            self.cuts.insert(d, cut);
        }
        d
    }

    fn cut(&self, op: Op, a: Reg, b: Reg) -> Option<(Cut, Reg, u32)> {
        let Op::U2(op) = op else { return None };
        let whole = |word: Reg| !self.info(word).mutable;
        match (op, self.constant_value(a), self.constant_value(b)) {
            (U2::ShiftRightU, _, Some(bits)) if whole(a) => Some((Cut::Above, a, bits)),
            (U2::And, _, Some(mask)) if whole(a) => Some((Cut::Low, a, mask.trailing_ones())),
            (U2::And, Some(mask), _) if whole(b) => Some((Cut::Low, b, mask.trailing_ones())),
            _ => None,
        }
        .filter(|(cut, _, bits)| {
            let mask = self.constant_value(a).or(self.constant_value(b));
            (1..32).contains(bits) && (*cut == Cut::Above || mask == Some((1 << bits) - 1))
        })
    }

    /// The word that two others are cut from: its low bits, so many, and those above.
    pub(super) fn cut_from(&self, low: Reg, above: Reg) -> Option<(Reg, u8)> {
        match (self.cuts.get(&low)?, self.cuts.get(&above)?) {
            ((Cut::Low, word, bits), (Cut::Above, same, shift))
                if (word, bits) == (same, shift) =>
            {
                Some((*word, *bits as u8))
            }
            _ => None,
        }
    }

    /// An instruction that writes a mutable register, for the end of the current list or another one.
    pub(super) fn write(&mut self, d: Reg, source: Reg, mask: Option<Reg>) -> Inst {
        let bank = self.info(d).bank;
        let span = self.span;
        let inst = |op, a, b| Inst { op, d, a, b, c: NONE, imm: 0, extra: 0, span };
        match mask {
            Some(mask) => {
                let (source, mask) = (self.varying(source), self.varying(mask));
                inst(Op::Merge(bank), source, mask)
            }
            None if self.uniform(source) && !self.uniform(d) => inst(Op::Splat(bank), source, NONE),
            None => inst(Op::Move(bank), source, NONE),
        }
    }

    /// `d` op= `b`, d mutable.
    pub(super) fn update(&mut self, op: U2, d: Reg, b: Reg) {
        let b = if self.uniform(d) { b } else { self.varying(b) };
        let value = self.raw(Op::U2(op), [d, b, NONE], 0, 0);
        let inst = self.write(d, value, None);
        self.push(Node::Inst(inst));
    }

    /// The register, or a copy of it where it will be written again.
    pub(super) fn steady(&mut self, reg: Reg) -> Reg {
        if reg == NONE || !self.info(reg).mutable {
            return reg;
        }
        let bank = self.info(reg).bank;
        self.raw(Op::Move(bank), [reg, NONE, NONE], 0, 0)
    }

    /// The table of these constants, f32 by their bits.
    pub(super) fn table(&mut self, bank: Bank, constants: Vec<u32>) -> u32 {
        let tables = &mut self.tables[(bank == Bank::Word) as usize];
        let known = tables.iter().position(|known| *known == constants);
        known.unwrap_or_else(|| {
            tables.push(constants);
            tables.len() - 1
        }) as u32
    }

    /// Appends an instruction here, shared with nobody.
    pub(super) fn raw(&mut self, op: Op, [a, b, c]: [Reg; 3], imm: u32, extra: u32) -> Reg {
        let uniform =
            may_be_uniform(op) && [a, b, c].iter().all(|reg| *reg == NONE || self.uniform(*reg));
        let depth = self.level();
        let d = match op.result() {
            Some(bank) => self.define(bank, uniform, false, depth),
            None => NONE,
        };
        let span = self.span;
        self.push(Node::Inst(Inst { op, d, a, b, c, imm, extra, span }));
        d
    }
}

/// Whether equal operands in all lanes give one result, and the machine can compute it once.
fn may_be_uniform(op: Op) -> bool {
    op.mixes()
        || matches!(
            op,
            Op::F3(_)
                | Op::Select(_)
                | Op::Constant(_)
                | Op::Move(_)
                | Op::GroupCount
                | Op::Load(_)
                | Op::BufferWords
                | Op::TextureSize
        )
}
