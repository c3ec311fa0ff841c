//! Shares as whole numbers of slots, by which WGSL draws an owner with one look: `lobe_owner` in shaders/lobes.wgsl.
//!
//! A number in [0, 1) times the slots lies in one of them, whose entry names its owner, the owner's first slot and how
//! many it has; so owners lie in their order, and well-spread numbers give well-spread owners. Who takes the slots for
//! the shares, and not the masses they came from, has exact probabilities.

/// The most owners and slots that an entry's bits hold.
const MOST_OWNERS: usize = 256;
const MOST_SLOTS: usize = 4095;

/// How many of `slots` each owner gets: by its share of the masses, and one at the least where it has any. Where none
/// has, they count alike, since nobody comes there.
///
/// # Panics
/// No owners, more than 256 or than slots, or more than 4,095 slots.
pub fn shared(masses: &[f64], slots: usize) -> Vec<u32> {
    let fits = (1..=MOST_OWNERS.min(slots)).contains(&masses.len()) && slots <= MOST_SLOTS;
    assert!(fits, "{} owners, {slots} slots", masses.len());
    let total: f64 = masses.iter().sum();
    let fair = |mass: f64| match total > 0.0 && total.is_finite() {
        true => mass / total * slots as f64,
        false => slots as f64 / masses.len() as f64,
    };
    let fair: Vec<f64> = masses.iter().map(|mass| fair(*mass)).collect();
    let least = |fair: &f64| if *fair > 0.0 { fair.floor().max(1.0) as u32 } else { 0 };
    let mut own: Vec<u32> = fair.iter().map(least).collect();
    // One by one to whoever lacks most, or from whoever has most too many.
    loop {
        let given: u32 = own.iter().sum();
        let lacks = |owner: &usize| fair[*owner] - f64::from(own[*owner]);
        let by_lack = |a: &usize, b: &usize| lacks(a).total_cmp(&lacks(b));
        if (given as usize) < slots {
            let owner = (0..own.len()).max_by(by_lack).unwrap_or(0);
            own[owner] += 1;
        } else if given as usize > slots {
            let owner = (0..own.len()).filter(|owner| own[*owner] > 1).min_by(by_lack).unwrap_or(0);
            own[owner] -= 1;
        } else {
            return own;
        }
    }
}

/// The entry of each slot: the owner in bits 0 to 7, its first slot in bits 8 to 19, and how many it has above.
pub fn entries(shares: &[u32]) -> Vec<u32> {
    let mut entries = Vec::new();
    for (owner, share) in shares.iter().enumerate() {
        let entry = owner as u32 | (entries.len() as u32) << 8 | share << 20;
        entries.extend((0..*share).map(|_| entry));
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each share is off by less than a slot where all have many, the least mass has one, and none has none.
    #[test]
    fn slots_are_shared_by_the_masses() {
        let masses = [3.0, 0.0, 1e-9, 5.0, 0.7, 1.3];
        let shares = shared(&masses, 128);
        assert_eq!(shares.iter().sum::<u32>(), 128);
        assert_eq!((shares[1], shares[2]), (0, 1));
        for (share, mass) in shares.iter().zip(masses) {
            assert!((f64::from(*share) - 12.8 * mass).abs() < 1.0 || *share == 1, "{shares:?}");
        }
        assert_eq!(shared(&[0.0; 8], 16), [2; 8]);
        assert_eq!(shared(&[1e-9, 1.0, 1e-9], 3), [1, 1, 1]);
        assert_eq!(shared(&[f64::INFINITY, 1.0], 4), [2, 2]);
    }

    /// Every slot is its owner's, and entries come back from their bits.
    #[test]
    fn entries_name_their_owners() {
        let shares = shared(&[1.0, 0.0, 2.0, 4090.0], 4095);
        let entries = entries(&shares);
        assert_eq!(entries.len(), 4095);
        for (slot, entry) in entries.iter().enumerate() {
            let (owner, first, own) = (entry & 255, (entry >> 8) & 4095, entry >> 20);
            assert_eq!(own, shares[owner as usize]);
            assert!((first..first + own).contains(&(slot as u32)));
        }
    }
}
