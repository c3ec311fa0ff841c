//! Which parameters a BRDF is measured at: both ends of each range, its default, and powers of ten
//! between them.

use brdf_sdk::{ParamType, ParamValue, ParamValues};

use crate::plugin::Configured;

/// Powers of ten that a number takes, where its range has them.
const LADDER: [f64; 9] = [1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4];
/// The dark grey of a colour, as a part of its upper limit.
const DARK: f64 = 1e-4;

/// The BRDF with its switches and choices as they are, and with one of them changed at a time: each
/// is a program of its own. Parameters named in `fixed` stay.
pub fn variants(brdf: &Configured, fixed: &[String]) -> Vec<Configured> {
    let others = brdf.switched().filter(|(param, _)| !fixed.contains(&param.key));
    std::iter::once(brdf.clone()).chain(others.map(|(_, other)| other)).collect()
}

/// At most `limit` settings of the numbers and colours. Where all combinations are more, then the
/// values as they are, each alone at its other values, all at their first and last, and a fixed
/// draw from the rest.
pub fn settings(brdf: &Configured, fixed: &[String], limit: usize) -> Vec<ParamValues> {
    let ladders: Vec<(&str, Vec<ParamValue>)> = brdf
        .plugin
        .manifest
        .params
        .iter()
        .filter(|param| !fixed.contains(&param.key))
        .filter_map(|param| {
            Some((param.key.as_str(), ladder(&param.ty, brdf.values.get(&param.key)?)))
        })
        .filter(|(_, ladder)| !ladder.is_empty())
        .collect();
    let all = ladders.iter().try_fold(1usize, |product, (_, l)| product.checked_mul(l.len()));
    let chosen = match all {
        Some(all) if all <= limit => (0..all).map(|index| digits(index, &ladders)).collect(),
        _ => spread(&ladders, limit),
    };
    let with = |indices: Vec<usize>| {
        let mut values = brdf.values.clone();
        for ((key, ladder), index) in ladders.iter().zip(indices) {
            values.set(key, ladder[index].clone());
        }
        values
    };
    chosen.into_iter().map(with).collect()
}

type Ladders<'a> = [(&'a str, Vec<ParamValue>)];

fn digits(mut index: usize, ladders: &Ladders<'_>) -> Vec<usize> {
    ladders
        .iter()
        .map(|(_, ladder)| {
            let digit = index % ladder.len();
            index /= ladder.len();
            digit
        })
        .collect()
}

fn spread(ladders: &Ladders<'_>, limit: usize) -> Vec<Vec<usize>> {
    let own = vec![0; ladders.len()];
    let mut chosen = vec![own.clone()];
    let mut add = |indices: Vec<usize>| {
        if chosen.len() < limit && !chosen.contains(&indices) {
            chosen.push(indices);
        }
    };
    for (position, (_, ladder)) in ladders.iter().enumerate() {
        for index in 0..ladder.len() {
            let mut one = own.clone();
            one[position] = index;
            add(one);
        }
    }
    add(ladders.iter().map(|(_, ladder)| 1.min(ladder.len() - 1)).collect());
    add(ladders.iter().map(|(_, ladder)| ladder.len() - 1).collect());
    // More than `limit` combinations exist: few of the draws come twice.
    for draw in 0..2 * limit as u64 {
        let index = |position: usize, ladder: &Vec<ParamValue>| {
            (mixed(draw << 8 | position as u64) % ladder.len() as u64) as usize
        };
        add(ladders.iter().enumerate().map(|(p, (_, ladder))| index(p, ladder)).collect());
    }
    chosen
}

/// SplitMix64's output function (Steele, Lea, Flood 2014): choices that look random and never change.
pub fn mixed(counter: u64) -> u64 {
    let mut z = counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The values that a number or a colour takes, its own first, so that of equal errors the one nearest
/// to it is told; none for all else.
fn ladder(ty: &ParamType, own: &ParamValue) -> Vec<ParamValue> {
    let mut ladder = ascending(ty, own);
    // Stable: the others stay in order.
    ladder.sort_by_key(|value| value != own);
    ladder
}

fn ascending(ty: &ParamType, own: &ParamValue) -> Vec<ParamValue> {
    match (ty, own) {
        (ParamType::Float { range, .. }, ParamValue::Float(value)) => {
            rungs(*range, *value).into_iter().map(ParamValue::Float).collect()
        }
        (ParamType::Int { range, .. }, ParamValue::Int(value)) => {
            let rungs = rungs(range.map(|bound| bound as f64), *value as f64);
            let whole = rungs.into_iter().filter(|rung| rung.fract() == 0.0);
            whole.map(|rung| ParamValue::Int(rung as i64)).collect()
        }
        (ParamType::Color { range: [min, max], .. }, ParamValue::Color(value)) => {
            let greys = [*min, (DARK * max).clamp(*min, *max), *max].map(|grey| [grey; 3]);
            let mut colours: Vec<[f64; 3]> = greys.into_iter().chain([*value]).collect();
            colours.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
            colours.dedup();
            colours.into_iter().map(ParamValue::Color).collect()
        }
        _ => Vec::new(),
    }
}

fn rungs([min, max]: [f64; 2], own: f64) -> Vec<f64> {
    let powers = LADDER.into_iter().flat_map(|power| [power, -power]);
    let inside = powers.filter(|power| min < *power && *power < max);
    let mut rungs: Vec<f64> = inside.chain([min, max, own]).collect();
    rungs.sort_by(f64::total_cmp);
    rungs.dedup();
    rungs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_takes_the_ends_of_its_range_and_powers_of_ten() {
        assert_eq!(rungs([1e-4, 1.0], 0.2), [1e-4, 1e-3, 1e-2, 1e-1, 0.2, 1.0]);
        assert_eq!(rungs([-2.0, 0.5], 0.5)[..3], [-2.0, -1.0, -0.1]);
    }
}
