//! Undo and redo over a whole value.

/// A value and its past. Changes are made freely; [`History::settle`] makes a step of all since the last one.
#[derive(Debug, Clone)]
pub struct History<T> {
    past: Vec<T>,
    future: Vec<T>,
    settled: T,
}

/// Steps that are remembered.
const MOST: usize = 500;

impl<T: Clone + PartialEq> History<T> {
    /// No past.
    pub fn new(value: &T) -> Self {
        Self { past: Vec::new(), future: Vec::new(), settled: value.clone() }
    }

    /// Remembers the value as it is now, if it is another than the last one.
    pub fn settle(&mut self, value: &T) {
        if *value == self.settled {
            return;
        }
        self.past.push(std::mem::replace(&mut self.settled, value.clone()));
        if self.past.len() > MOST {
            self.past.remove(0);
        }
        self.future.clear();
    }

    /// Takes changes on that nobody made, such as a reloaded file: they are no step of their own.
    pub fn absorb(&mut self, value: &T) {
        self.settled = value.clone();
    }

    /// Back by one step; false where there is none.
    pub fn undo(&mut self, value: &mut T) -> bool {
        self.settle(value);
        let Some(earlier) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.settled, earlier));
        value.clone_from(&self.settled);
        true
    }

    /// Forward again by one step; false where there is none.
    pub fn redo(&mut self, value: &mut T) -> bool {
        if *value != self.settled {
            return false;
        }
        let Some(later) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.settled, later));
        value.clone_from(&self.settled);
        true
    }

    /// Whether there is a step back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a step forward.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_go_back_and_forth_until_something_else_is_done() {
        let mut value = 1;
        let mut history = History::new(&value);
        for next in [2, 3, 3] {
            value = next;
            history.settle(&value);
        }
        assert!(history.undo(&mut value) && value == 2);
        assert!(history.undo(&mut value) && value == 1);
        assert!(!history.undo(&mut value) && value == 1);
        assert!(history.redo(&mut value) && value == 2);
        // What was not settled yet is a step, too.
        value = 7;
        assert!(!history.redo(&mut value));
        assert!(history.undo(&mut value) && value == 2);
        assert!(history.redo(&mut value) && value == 7);
        assert!(!history.can_redo() && history.can_undo());
    }

    #[test]
    fn what_is_absorbed_is_no_step() {
        let mut value = 1;
        let mut history = History::new(&value);
        value = 2;
        history.absorb(&value);
        assert!(!history.undo(&mut value) && value == 2);
    }
}
