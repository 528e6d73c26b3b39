//! Frames under way, each stored once for all its receivers, in buffers that are used again.

use profinet::MAX_FRAME;

/// A stored frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameId(u32);

#[derive(Debug, Default)]
struct Slot {
    bytes: Vec<u8>,
    users: u32,
}

/// Buffers made at the start, so that quiet segments never make one later.
const READY: u32 = 64;

/// The store. Grows to the largest number of frames under way at once, then allocates no more.
#[derive(Debug)]
pub(super) struct Frames {
    slots: Vec<Slot>,
    free: Vec<u32>,
}

impl Frames {
    pub(super) fn new() -> Self {
        let slot = |_| Slot {
            bytes: Vec::with_capacity(MAX_FRAME),
            users: 0,
        };
        Self {
            slots: (0..READY).map(slot).collect(),
            free: (0..READY).rev().collect(),
        }
    }

    /// Stores a frame with one user.
    pub(super) fn put(&mut self, bytes: &[u8]) -> Option<FrameId> {
        let index = match self.free.pop() {
            Some(index) => index,
            None => {
                let index = u32::try_from(self.slots.len()).ok()?;
                // Room for every buffer to be given back: releasing never allocates.
                self.free.reserve(self.slots.len() + 1);
                self.slots.push(Slot {
                    bytes: Vec::with_capacity(MAX_FRAME),
                    users: 0,
                });
                index
            }
        };
        let slot = self.slots.get_mut(index as usize)?;
        slot.bytes.clear();
        slot.bytes.extend_from_slice(bytes);
        slot.users = 1;
        Some(FrameId(index))
    }

    /// One more user.
    pub(super) fn share(&mut self, id: FrameId) {
        if let Some(slot) = self.slots.get_mut(id.0 as usize) {
            slot.users += 1;
        }
    }

    /// One user less; the last one frees the buffer.
    pub(super) fn release(&mut self, id: FrameId) {
        if let Some(slot) = self.slots.get_mut(id.0 as usize) {
            slot.users = slot.users.saturating_sub(1);
            if slot.users == 0 {
                self.free.push(id.0);
            }
        }
    }

    /// Returns the octets.
    pub(super) fn bytes(&self, id: FrameId) -> &[u8] {
        self.slots.get(id.0 as usize).map_or(&[], |slot| &slot.bytes)
    }

    /// Buffers in use, for tests.
    #[cfg(test)]
    pub(super) fn in_use(&self) -> usize {
        self.slots.len() - self.free.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_are_used_again_after_the_last_user() {
        let mut frames = Frames::new();
        let a = frames.put(&[1, 2]).unwrap();
        frames.share(a);
        frames.release(a);
        assert_eq!(frames.bytes(a), [1, 2]);
        frames.release(a);
        let b = frames.put(&[3]).unwrap();
        assert_eq!((b, frames.bytes(b)), (a, &[3][..]));
        assert_eq!(frames.in_use(), 1);
        let more: Vec<_> = (0..READY).map(|_| frames.put(&[4]).unwrap()).collect();
        assert_eq!(frames.in_use(), READY as usize + 1);
        more.into_iter().for_each(|id| frames.release(id));
        assert_eq!(frames.in_use(), 1);
    }
}
