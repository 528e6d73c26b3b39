//! The earliest of many deadlines, at a cost that grows with the logarithm of their number.

use alloc::vec;
use alloc::vec::Vec;

use crate::Instant;

/// One optional deadline per index; the earliest is known at once.
///
/// A complete binary tree in an array: the leaves are the deadlines, each inner node is the earlier of its two
/// children. Nothing is allocated after [`push`](Self::push).
#[derive(Debug, Default)]
pub struct Deadlines {
    /// `tree[1]` is the root, the leaves start at `tree[leaves]`.
    tree: Vec<Instant>,
    leaves: usize,
    used: usize,
}

/// Stands for "no deadline"; 584 years ahead.
const NEVER: Instant = Instant::MAX;

impl Deadlines {
    /// Adds an index without a deadline and returns it.
    pub fn push(&mut self) -> usize {
        if self.used == self.leaves {
            let leaves = (self.leaves * 2).max(4);
            let mut tree = vec![NEVER; 2 * leaves];
            for index in 0..self.used {
                if let (Some(new), Some(old)) =
                    (tree.get_mut(leaves + index), self.tree.get(self.leaves + index))
                {
                    *new = *old;
                }
            }
            self.tree = tree;
            self.leaves = leaves;
            for node in (1..leaves).rev() {
                self.refresh(node);
            }
        }
        self.used += 1;
        self.used - 1
    }

    /// Sets or clears the deadline of `index`.
    pub fn set(&mut self, index: usize, deadline: Option<Instant>) {
        let mut node = self.leaves + index;
        let value = deadline.unwrap_or(NEVER);
        match self.tree.get_mut(node) {
            Some(leaf) if *leaf != value => *leaf = value,
            _ => return,
        }
        while node > 1 {
            node /= 2;
            self.refresh(node);
        }
    }

    /// Returns the earliest deadline.
    #[must_use]
    pub fn earliest(&self) -> Option<Instant> {
        self.tree.get(1).copied().filter(|at| *at != NEVER)
    }

    /// Returns the lowest index whose deadline is the earliest.
    #[must_use]
    pub fn earliest_index(&self) -> Option<usize> {
        let at = self.earliest()?;
        let mut node = 1;
        while node < self.leaves {
            node *= 2;
            if self.tree.get(node) != Some(&at) {
                node += 1;
            }
        }
        Some(node - self.leaves)
    }

    fn refresh(&mut self, node: usize) {
        let child = |n: usize| self.tree.get(n).copied().unwrap_or(NEVER);
        let earlier = child(2 * node).min(child(2 * node + 1));
        if let Some(value) = self.tree.get_mut(node) {
            *value = earlier;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_a_linear_search(
            count in 1usize..40,
            changes in prop::collection::vec((0usize..40, prop::option::of(0u64..50)), 0..200),
        ) {
            let mut tree = Deadlines::default();
            let mut plain = vec![None; count];
            for expected in 0..count {
                prop_assert_eq!(tree.push(), expected);
            }
            for (index, at) in changes {
                let index = index % count;
                plain[index] = at.map(Instant::from_nanos);
                tree.set(index, plain[index]);
                let best = plain.iter().enumerate().filter_map(|(i, at)| at.map(|at| (at, i))).min();
                prop_assert_eq!(tree.earliest(), best.map(|b| b.0));
                prop_assert_eq!(tree.earliest_index(), best.map(|b| b.1));
            }
        }

        #[test]
        fn growing_keeps_what_is_set(count in 1usize..100) {
            let mut tree = Deadlines::default();
            for i in 0..count {
                let index = tree.push();
                tree.set(index, Some(Instant::from_nanos(1000 - i as u64)));
                prop_assert_eq!(tree.earliest_index(), Some(i));
            }
        }
    }
}
