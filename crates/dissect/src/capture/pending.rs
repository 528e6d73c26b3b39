//! What waits for an answer: bounded, and given up after a while.

use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;
use std::time::Duration;

/// Maximum number of entries; a further one replaces the entry that expires next.
const MAX: usize = 1024;

/// What waited for a shorter time when the capture ended is not reported: its answer may have come right after.
pub const CUT_OFF: Duration = Duration::from_millis(200);

/// Entries by key, each with the time at which it is given up.
#[derive(Debug)]
pub struct Pending<K, V> {
    open: HashMap<K, Entry<V>>,
    /// Keys by deadline. The number keeps entries with the same deadline apart.
    order: BTreeMap<(Duration, u64), K>,
    count: u64,
}

#[derive(Debug)]
struct Entry<V> {
    place: (Duration, u64),
    value: V,
}

impl<K, V> Default for Pending<K, V> {
    fn default() -> Self {
        Self {
            open: HashMap::new(),
            order: BTreeMap::new(),
            count: 0,
        }
    }
}

impl<K: Clone + Eq + Hash, V> Pending<K, V> {
    /// Puts an entry in the place of one with the same key.
    pub fn insert(&mut self, key: K, deadline: Duration, value: V)
    where
        V: Default,
    {
        *self.renew(key, deadline) = value;
    }

    /// Returns the entry of a key.
    pub fn get_mut(&mut self, key: &K) -> Option<&mut V> {
        self.open.get_mut(key).map(|entry| &mut entry.value)
    }

    /// Returns the entry of a key, to be given up at `deadline`; a new one where there is none.
    pub fn renew(&mut self, key: K, deadline: Duration) -> &mut V
    where
        V: Default,
    {
        let place = (deadline, self.count);
        self.count += 1;
        match self.open.get(&key) {
            Some(entry) => {
                self.order.remove(&entry.place);
            }
            None if self.open.len() >= MAX => {
                if let Some((_, first)) = self.order.pop_first() {
                    self.open.remove(&first);
                }
            }
            None => {}
        }
        self.order.insert(place, key.clone());
        let entry = self.open.entry(key).or_insert_with(|| Entry {
            place,
            value: V::default(),
        });
        entry.place = place;
        &mut entry.value
    }

    /// Takes the entry of a key out.
    pub fn remove(&mut self, key: &K) -> Option<V> {
        let entry = self.open.remove(key)?;
        self.order.remove(&entry.place);
        Some(entry.value)
    }

    /// Gives an entry until `deadline`.
    pub fn postpone(&mut self, key: &K, deadline: Duration) {
        if let Some(entry) = self.open.get_mut(key) {
            self.order.remove(&entry.place);
            entry.place.0 = deadline;
            self.order.insert(entry.place, key.clone());
        }
    }

    /// Takes an entry out whose deadline has passed, the oldest first.
    pub fn due(&mut self, now: Duration) -> Option<(Duration, V)> {
        let (&(deadline, _), _) = self.order.first_key_value()?;
        if deadline > now {
            return None;
        }
        let (_, key) = self.order.pop_first()?;
        Some((deadline, self.open.remove(&key)?.value))
    }

    /// Returns the number of entries.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.open.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn s(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn entries_are_given_up_in_the_order_of_their_deadlines() {
        let mut pending = Pending::default();
        pending.insert("a", s(3), 1);
        pending.insert("b", s(2), 2);
        pending.insert("c", s(2), 3);
        pending.postpone(&"b", s(4));
        assert_eq!(pending.due(s(1)), None);
        assert_eq!(pending.due(s(9)), Some((s(2), 3)));
        assert_eq!(pending.due(s(9)), Some((s(3), 1)));
        assert_eq!(pending.remove(&"b"), Some(2));
        assert_eq!(
            (pending.due(s(9)), pending.len(), pending.order.len()),
            (None, 0, 0)
        );
    }

    #[test]
    fn memory_is_bounded() {
        let mut pending = Pending::default();
        for key in 0..5000_u64 {
            pending.insert(key, s(key), ());
        }
        assert_eq!((pending.open.len(), pending.order.len()), (MAX, MAX));
        assert!(pending.get_mut(&4999).is_some());
    }
}
