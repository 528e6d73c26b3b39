//! The receive ring of a packet socket (TPACKET_V2): frames arrive in shared memory, without a call per frame.

use std::io;
use std::os::fd::RawFd;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// A slot; holds the largest frame, its header and what the kernel puts before it.
const SLOT: usize = 2048;
/// Slots of a ring for each station that is served: a station that is late by three update times has lost its connection, so
/// more than these are of no use.
const SLOTS_EACH: usize = 4;
/// Slots of the smallest ring and of the largest one.
const SLOTS: std::ops::RangeInclusive<usize> = 512..=1 << 15;
const BLOCK: usize = 1 << 15;
/// A capture has room for as much as this many stations need: half a second of what 64 drives send and receive at 16 ms, as its
/// reader has no rank before other programs.
pub(super) const OF_CAPTURE: usize = 1 << 10;

const TP_STATUS_KERNEL: u32 = 0;
const TP_STATUS_USER: u32 = 1;
const TP_STATUS_LOSING: u32 = 1 << 2;
const TP_STATUS_CSUM_NOT_READY: u32 = 1 << 3;
const TP_STATUS_VLAN_VALID: u32 = 1 << 4;

/// Metadata of a received frame from the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Received {
    /// The UDP or TCP checksum is left to a network card that never saw the frame.
    pub(super) checksum_missing: bool,
    /// The tag that was taken out of the frame.
    pub(super) tag: Option<u16>,
    /// Calendar time since 1970 at which the kernel received it.
    pub(super) time: Duration,
    /// Frames before it found no room, since the kernel was asked for their number.
    pub(super) losing: bool,
}

impl Received {
    /// Returns the frame as it was on the wire: with the tag the kernel took out, put in again in `buffer`.
    pub(super) fn on_the_wire<'a>(&self, frame: &'a [u8], buffer: &'a mut [u8]) -> &'a [u8] {
        let Some(tag) = self.tag else { return frame };
        let parts = (frame.split_at_checked(12), buffer.get_mut(..frame.len() + 4));
        let (Some((addresses, rest)), Some(target)) = parts else {
            return frame;
        };
        let [high, low] = tag.to_be_bytes();
        for (to, from) in target
            .iter_mut()
            .zip(addresses.iter().chain(&[0x81, 0x00, high, low]).chain(rest))
        {
            *to = *from;
        }
        target
    }
}

/// The ring of one socket.
#[derive(Debug)]
pub(super) struct Ring {
    base: NonNull<u8>,
    next: usize,
    slots: usize,
}

// SAFETY: the mapping belongs to this value alone and is reached through `&mut self` only.
unsafe impl Send for Ring {}

impl Ring {
    /// Requests a ring on `fd`, which must be a packet socket and outlive it, for the traffic of so many stations.
    pub(super) fn new(fd: RawFd, stations: usize) -> io::Result<Self> {
        let wanted = stations.saturating_mul(SLOTS_EACH).max(*SLOTS.start());
        let slots = wanted.min(*SLOTS.end()).next_multiple_of(BLOCK / SLOT);
        set_option(
            fd,
            libc::PACKET_VERSION,
            &(libc::tpacket_versions::TPACKET_V2 as libc::c_int),
        )?;
        let request = libc::tpacket_req {
            tp_block_size: BLOCK as u32,
            tp_block_nr: (SLOT * slots / BLOCK) as u32,
            tp_frame_size: SLOT as u32,
            tp_frame_nr: slots as u32,
        };
        set_option(fd, libc::PACKET_RX_RING, &request)?;
        let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_SHARED);
        // SAFETY: a new mapping at an address the kernel chooses; no existing memory is touched.
        let base = unsafe { libc::mmap(std::ptr::null_mut(), SLOT * slots, protection, flags, fd, 0) };
        if base == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        let base = NonNull::new(base.cast::<u8>()).ok_or(io::ErrorKind::OutOfMemory)?;
        Ok(Self { base, next: 0, slots })
    }

    /// Returns the oldest frame that has arrived, if any; [`release`](Self::release) gives its slot back.
    pub(super) fn peek(&mut self) -> Option<(Received, &mut [u8])> {
        let status = self.status().load(Ordering::Acquire);
        if status & TP_STATUS_USER == 0 {
            return None;
        }
        // SAFETY: `next` is below `slots`, so the header lies within the mapping, aligned to the slot size. While the
        // status is USER the kernel does not touch the slot.
        let header: libc::tpacket2_hdr = unsafe { self.slot().cast::<libc::tpacket2_hdr>().read() };
        let offset = usize::from(header.tp_mac);
        // A frame longer than the slot is cut by the kernel: what is left is not a whole frame, so none is returned.
        let whole = header.tp_snaplen == header.tp_len;
        let length = (header.tp_snaplen as usize).min(SLOT.saturating_sub(offset));
        let length = if whole { length } else { 0 };
        // SAFETY: offset + length <= SLOT, so the range is inside the slot, which is ours until released; the
        // lifetime is that of `&mut self`, so it cannot be released meanwhile.
        let frame = unsafe { std::slice::from_raw_parts_mut(self.slot().add(offset.min(SLOT)), length) };
        let received = Received {
            checksum_missing: status & TP_STATUS_CSUM_NOT_READY != 0,
            tag: (status & TP_STATUS_VLAN_VALID != 0).then_some(header.tp_vlan_tci),
            time: Duration::new(header.tp_sec.into(), header.tp_nsec.min(999_999_999)),
            losing: status & TP_STATUS_LOSING != 0,
        };
        Some((received, frame))
    }

    /// Gives the slot of the frame peeked at back to the kernel.
    pub(super) fn release(&mut self) {
        self.status().store(TP_STATUS_KERNEL, Ordering::Release);
        self.next = (self.next + 1) % self.slots;
    }

    fn slot(&self) -> *mut u8 {
        // SAFETY: `next` is below `slots`, so the result is inside the mapping of SLOT * `slots` octets.
        unsafe { self.base.as_ptr().add(self.next * SLOT) }
    }

    fn status(&self) -> &AtomicU32 {
        // SAFETY: the status is the first field of the slot's header, a u32 aligned to the slot size; the kernel
        // changes it at any time, hence the atomic. It lives as long as the mapping, that is, as `self`.
        unsafe { AtomicU32::from_ptr(self.slot().cast::<u32>()) }
    }
}

impl Drop for Ring {
    fn drop(&mut self) {
        // SAFETY: the mapping was made by `new` with this length and no reference into it outlives `self`.
        unsafe { libc::munmap(self.base.as_ptr().cast(), SLOT * self.slots) };
    }
}

/// Sets a packet socket option.
pub(super) fn set_option<T>(fd: RawFd, option: libc::c_int, value: &T) -> io::Result<()> {
    let length = size_of::<T>() as libc::socklen_t;
    // SAFETY: `value` is valid for `length` octets during the call and only read.
    match unsafe {
        libc::setsockopt(
            fd,
            libc::SOL_PACKET,
            option,
            std::ptr::from_ref(value).cast(),
            length,
        )
    } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_put_back_where_it_was() {
        let frame: Vec<u8> = (0..60).collect();
        let mut buffer = [0xA5; 128];
        let tagged = Received {
            checksum_missing: false,
            tag: Some(0xC000),
            time: Duration::ZERO,
            losing: false,
        };
        let plain = Received { tag: None, ..tagged };
        let expected = [&frame[..12], &[0x81, 0, 0xC0, 0], &frame[12..]].concat();
        assert_eq!(tagged.on_the_wire(&frame, &mut buffer), expected);
        assert_eq!(plain.on_the_wire(&frame, &mut buffer), frame);
        assert_eq!(tagged.on_the_wire(&[1], &mut buffer), [1]);
    }
}
