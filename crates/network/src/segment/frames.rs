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

/// The store. Grows to the largest number of frames under way at once, then allocates no more.
#[derive(Debug, Default)]
pub(super) struct Frames {
    slots: Vec<Slot>,
    free: Vec<u32>,
}

impl Frames {
    /// Stores a frame with one user.
    pub(super) fn put(&mut self, bytes: &[u8]) -> Option<FrameId> {
        let index = match self.free.pop() {
            Some(index) => index,
            None => {
                let index = u32::try_from(self.slots.len()).ok()?;
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

    /// The octets.
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
        let mut frames = Frames::default();
        let a = frames.put(&[1, 2]).unwrap();
        frames.share(a);
        frames.release(a);
        assert_eq!(frames.bytes(a), [1, 2]);
        frames.release(a);
        let b = frames.put(&[3]).unwrap();
        assert_eq!((b, frames.bytes(b)), (a, &[3][..]));
        assert_eq!((frames.slots.len(), frames.in_use()), (1, 1));
    }
}
