//! What was made lately, kept for whoever asks for the same again; the oldest goes first.
//!
//! Whoever waits here waits for one thing at a time: two of the same would be twice the work, two of others twice the
//! memory. What is made, and when there is too much of it, is the caller's part.

use std::sync::{Mutex, PoisonError};

use brdf_sdk::Result;

/// Things under their keys, the last used at the end.
pub struct Held<K, V>(Mutex<Vec<(K, V)>>);

impl<K, V: Clone> Held<K, V> {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// The thing of this key, or the one that `make` makes; where there is `too_much`, old ones go, and this one stays.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn get(
        &self,
        key: K,
        same: impl Fn(&K, &K) -> bool,
        make: impl FnOnce(&K) -> Result<V>,
        too_much: impl Fn(&[(K, V)]) -> bool,
    ) -> Result<V> {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = held.iter().position(|(known, _)| same(known, &key)) {
            let found = held.remove(place);
            let thing = found.1.clone();
            held.push(found);
            return Ok(thing);
        }
        let thing = make(&key)?;
        held.push((key, thing.clone()));
        while held.len() > 1 && too_much(&held) {
            held.remove(0);
        }
        Ok(thing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_goes_and_what_was_asked_for_again_is_not_the_oldest() {
        let held = Held::new();
        let made = std::cell::Cell::new(0);
        let get = |key: u32| {
            let make = |key: &u32| {
                made.set(made.get() + 1);
                Ok(10 * key)
            };
            held.get(key, |a, b| a == b, make, |all| all.len() > 2).unwrap()
        };
        assert_eq!([1, 2, 1, 3, 1].map(get), [10, 20, 10, 30, 10]);
        assert_eq!(made.get(), 3, "1 was used after 2, and stays");
        assert_eq!((get(2), made.get()), (20, 4));
        let refused: Result<u32> =
            held.get(7, |a, b| a == b, |_| Err(brdf_sdk::Problem::new("7", "no", "6")), |_| false);
        assert!(refused.is_err());
        assert_eq!((get(2), made.get()), (20, 4), "a failure takes nothing away");
    }
}
