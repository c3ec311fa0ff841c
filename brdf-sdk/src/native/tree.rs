//! Trees of fives, by which WGSL draws a node by its share: `tree_child` in shaders/prelude.wgsl goes down a level.
//!
//! A texel of four floats has the ends of four of a node's five children, as parts of the whole; the fifth ends
//! where the node does. So five nodes take one look, 25 take two and 125 three.

/// Texels of a tree of that many levels.
pub const fn texels(levels: usize) -> usize {
    match levels {
        1 => 1,
        2 => 6,
        _ => 31,
    }
}

/// The tree of nodes with these masses, none of which is below 0: level after level. Where all are 0 they count
/// alike, since nobody comes there.
///
/// # Panics
/// No nodes, or more than the levels hold: 5, 25 or 125.
pub fn tree(masses: &[f64], levels: usize) -> Vec<[f32; 4]> {
    let most = 5usize.pow(levels as u32);
    assert!((1..=3).contains(&levels) && (1..=most).contains(&masses.len()), "{levels} levels");
    let mut ends = vec![0.0];
    for mass in masses {
        ends.push(ends[ends.len() - 1] + mass);
    }
    let total = ends[masses.len()];
    // The last node ends where no key comes, and so does what is not there.
    let end = |node: usize| match total > 0.0 {
        _ if node >= masses.len() => 2.0,
        true => (ends[node] / total) as f32,
        false => node as f32 / masses.len() as f32,
    };
    let mut all = Vec::with_capacity(texels(levels));
    let (mut nodes, mut width) = (1, most / 5);
    for _ in 0..levels {
        let texel = |node: usize| [1, 2, 3, 4].map(|child| end((5 * node + child) * width));
        all.extend((0..nodes).map(texel));
        (nodes, width) = (5 * nodes, width / 5);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goes down as `tree_child` does.
    fn found(tree: &[[f32; 4]], levels: usize, key: f32) -> usize {
        let (mut first, mut node, mut nodes) = (0, 0, 1);
        for _ in 0..levels {
            let passed = tree[first + node].iter().filter(|end| **end <= key).count();
            (first, node, nodes) = (first + nodes, 5 * node + passed, 5 * nodes);
        }
        node
    }

    /// Every key finds the node whose share holds it, and nodes without a mass are found by none.
    #[test]
    fn keys_find_their_nodes() {
        for (count, levels) in [(1, 1), (5, 1), (3, 2), (25, 2), (32, 3), (64, 3), (125, 3)] {
            let masses: Vec<f64> = (0..count)
                .map(|i| if count > 2 && i % 3 == 1 { 0.0 } else { 1.0 + i as f64 })
                .collect();
            let tree = tree(&masses, levels);
            assert_eq!(tree.len(), texels(levels));
            let total: f64 = masses.iter().sum();
            let mut before = 0.0;
            for (node, mass) in masses.iter().enumerate() {
                for part in [0.01, 0.5, 0.99] {
                    let key = ((before + part * mass) / total) as f32;
                    if *mass > 0.0 {
                        assert_eq!(found(&tree, levels, key), node, "{count} nodes, key {key}");
                    }
                }
                before += mass;
            }
            assert!(found(&tree, levels, 0.999_999_94) < count);
        }
        assert_eq!(found(&tree(&[0.0; 8], 2), 2, 0.5), 4);
    }
}
