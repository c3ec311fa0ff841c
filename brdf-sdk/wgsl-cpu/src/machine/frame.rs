//! The registers of one batch of lanes.
//!
//! Two banks, floats and 32-bit words, each with slots for all lanes and uniform values beside them. Which slot
//! holds what is decided in `flat.rs`; no instruction is known here.

/// Slots of one bank, each with a value for every lane, and its uniform registers.
pub(crate) struct Registers<T> {
    values: Vec<T>,
    /// Where slot 0 begins, so that slots lie on cache lines.
    first: usize,
    lanes: usize,
    pub uniform: Vec<T>,
}

impl<T: Copy + Default> Registers<T> {
    pub(crate) fn new(slots: usize, uniform: usize, lanes: usize) -> Self {
        const LINE: usize = 64;
        let values = vec![T::default(); slots * lanes + LINE];
        let first = values.as_ptr().align_offset(LINE);
        Self {
            values,
            first: if first > LINE { 0 } else { first },
            lanes,
            uniform: vec![T::default(); uniform],
        }
    }

    fn at(&self, slot: u32) -> usize {
        self.first + slot as usize * self.lanes
    }

    #[inline]
    pub(crate) fn slot(&self, slot: u32) -> &[T] {
        let at = self.at(slot);
        &self.values[at..at + self.lanes]
    }

    #[inline]
    pub(crate) fn slot_mut(&mut self, slot: u32) -> &mut [T] {
        let at = self.at(slot);
        &mut self.values[at..at + self.lanes]
    }

    /// Slots of one instruction, of which it writes some; no two are the same.
    #[inline(always)]
    pub(crate) fn slots_mut<const N: usize>(&mut self, slots: [u32; N]) -> [&mut [T]; N] {
        let ranges = slots.map(|slot| self.at(slot)..self.at(slot) + self.lanes);
        // The layout gives what one instruction writes slots of its own.
        self.values.get_disjoint_mut(ranges).unwrap_or_else(|_| [(); N].map(|()| &mut [][..]))
    }

    /// A slot to write and others to read; the layout never writes where it reads.
    #[inline(always)]
    pub(crate) fn split<const N: usize>(
        &mut self,
        write: u32,
        read: [u32; N],
    ) -> (&mut [T], [&[T]; N]) {
        let (at, lanes, first) = (self.at(write), self.lanes, self.first);
        let (below, rest) = self.values.split_at_mut(at);
        let (target, above) = rest.split_at_mut(lanes);
        let mut sources: [&[T]; N] = [&[]; N];
        for (source, slot) in sources.iter_mut().zip(read) {
            let begin = first + slot as usize * lanes;
            *source = if slot < write {
                &below[begin..begin + lanes]
            } else {
                let begin = begin - at - lanes;
                &above[begin..begin + lanes]
            };
        }
        (target, sources)
    }
}

/// All that a batch of lanes holds.
pub(crate) struct Frame<S> {
    pub floats: Registers<S>,
    pub words: Registers<u32>,
    /// The lanes' own memory, element by element, each with a value for every lane.
    pub own_floats: Vec<S>,
    pub own_words: Vec<u32>,
    /// Number of lanes.
    pub lanes: usize,
    /// The invocation that lane 0 stands for.
    pub first: u32,
}
