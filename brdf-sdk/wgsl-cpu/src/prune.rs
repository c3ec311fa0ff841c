//! What a lowered program does not need: instructions that nobody reads, and regions that are not
//! worth asking for.

use std::collections::HashMap;

use crate::lower::RegInfo;
use crate::op::{F1, F2, Inst, Node, Op, Reg};

/// A region of pure instructions that costs less than this runs always: asking costs as much.
const MIN_REGION: u32 = 12;

/// Drops instructions whose results nobody reads, from what runs once and from the batch.
pub(crate) fn drop_dead(once: &mut Vec<Node>, batch: &mut Vec<Node>, registers: usize) {
    // What is dropped may make a region empty, and then its test is of no use either.
    for _ in 0..3 {
        let live = live_registers(once, batch, registers);
        sweep(once, &live);
        sweep(batch, &live);
    }
}

fn live_registers(once: &[Node], batch: &[Node], count: usize) -> Vec<bool> {
    fn gather(nodes: &[Node], insts: &mut Vec<Inst>, roots: &mut Vec<Reg>) {
        for node in nodes {
            match node {
                Node::Inst(inst) => {
                    if inst.op.has_effect() {
                        roots.extend(inst.reads());
                    }
                    insts.push(*inst);
                }
                Node::Region { test, body } => {
                    roots.push(*test);
                    gather(body, insts, roots);
                }
                Node::Loop { live, body, next, .. } => {
                    roots.extend(live);
                    gather(body, insts, roots);
                    gather(next, insts, roots);
                }
                Node::Exit(_) | Node::Next(_) => {}
            }
        }
    }
    let (mut insts, mut roots) = (Vec::new(), Vec::new());
    gather(once, &mut insts, &mut roots);
    gather(batch, &mut insts, &mut roots);
    let mut writers: HashMap<Reg, Vec<usize>> = HashMap::new();
    for (index, inst) in insts.iter().enumerate() {
        writers.entry(inst.d).or_default().push(index);
    }
    let mut live = vec![false; count];
    while let Some(reg) = roots.pop() {
        if std::mem::replace(&mut live[reg as usize], true) {
            continue;
        }
        for index in writers.get(&reg).into_iter().flatten() {
            roots.extend(insts[*index].reads());
        }
    }
    live
}

fn sweep(nodes: &mut Vec<Node>, live: &[bool]) {
    nodes.retain_mut(|node| match node {
        Node::Inst(inst) => inst.op.has_effect() || live[inst.d as usize],
        Node::Region { body, .. } => {
            sweep(body, live);
            !body.is_empty()
        }
        Node::Loop { body, next, .. } => {
            sweep(body, live);
            sweep(next, live);
            true
        }
        Node::Exit(_) | Node::Next(_) => true,
    });
}

/// Roughly what an instruction takes, in units of an addition.
fn cost(op: Op) -> u32 {
    match op {
        Op::F1(
            F1::Neg | F1::Abs | F1::Sign | F1::Floor | F1::Ceil | F1::Trunc | F1::Round | F1::Fract,
        ) => 1,
        Op::F1(F1::Sqrt | F1::InverseSqrt) | Op::F2(F2::Div) => 3,
        Op::F1(_) | Op::F2(F2::Atan2 | F2::Pow) => 10,
        Op::Load(_) | Op::Fetch(..) | Op::LoadOrdered(_) | Op::Recall(_) | Op::Table(_) => 4,
        _ => 1,
    }
}

/// Lets short regions run always.
pub(crate) fn dissolve(nodes: Vec<Node>, regs: &[RegInfo]) -> Vec<Node> {
    let mut kept = Vec::with_capacity(nodes.len());
    for node in nodes {
        match node {
            Node::Region { test, body } => {
                let body = dissolve(body, regs);
                let cheap = body.iter().try_fold(0, |sum, node| match node {
                    Node::Inst(inst) if inst.op.is_pure() => Some(sum + cost(inst.op)),
                    _ => None,
                });
                match cheap {
                    Some(cost) if cost < MIN_REGION && !regs[test as usize].uniform => {
                        kept.extend(body);
                    }
                    _ => kept.push(Node::Region { test, body }),
                }
            }
            Node::Loop { id, live, body, next, span } => {
                let (body, next) = (dissolve(body, regs), dissolve(next, regs));
                kept.push(Node::Loop { id, live, body, next, span });
            }
            other => kept.push(other),
        }
    }
    kept
}
