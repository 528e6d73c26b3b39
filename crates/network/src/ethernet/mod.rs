//! Raw Ethernet: stations and clients on a real interface. For Linux, by the feature `raw-ethernet`; without it the types are
//! here and none of them can be opened ([`Error::NoRawEthernet`](crate::system::Error::NoRawEthernet)).
//!
//! | wish | type |
//! |---|---|
//! | virtual devices on an interface, beside the host's own addresses | [`Runner`] |
//! | a client with everything, using the host's own addresses | [`PacketMedium`] |
//! | every frame on an interface, nothing sent | [`Capture`] |
//!
//! Frames of one runner do not reach the other stations of the same runner, nor the host it runs on, as with any
//! packet socket: the other side must be at the other end of the wire, or of a `veth` pair.

#[cfg(not(all(feature = "raw-ethernet", target_os = "linux")))]
mod absent;
#[cfg(all(feature = "raw-ethernet", target_os = "linux"))]
#[allow(unsafe_code)] // system calls that std does not offer; each block states why it is sound
mod linux;

#[cfg(not(all(feature = "raw-ethernet", target_os = "linux")))]
use absent as raw;
#[cfg(all(feature = "raw-ethernet", target_os = "linux"))]
use linux as raw;

use std::time::Duration;

/// Whether this build has raw Ethernet.
pub const AVAILABLE: bool = cfg!(all(feature = "raw-ethernet", target_os = "linux"));

pub use raw::{Capture, PacketMedium, Runner};

/// A frame on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Captured<'c> {
    /// Calendar time since 1970 at which the kernel received it.
    pub time: Duration,
    /// Its octets, from the destination on.
    pub frame: &'c [u8],
    /// Frames may have been lost between the one before and this one, because they were not read in time.
    pub after_gap: bool,
    /// Frames that were lost so since this was counted last. The kernel counts all gaps of its ring together: of several of them the
    /// first one has the count of all, and the others have 0.
    pub missed: u64,
}

/// How a [`Runner::step`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Stations did something: see [`Runner::touched`].
    Worked,
    /// Nothing happened until the time given.
    Idle,
    /// The stop flag is set.
    Stopped,
    /// The bell has rung.
    Rung,
}

/// How late a [`Runner`] did what was due.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lateness {
    /// Deadlines that were met more than 1 ms late.
    pub late: u64,
    /// Longest delay.
    pub longest: Duration,
}

/// What a raw socket has counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PacketStatistics {
    /// Frames received, after the filter.
    pub received: u64,
    /// Frames sent.
    pub sent: u64,
    /// Frames the kernel did not take: queue full, interface down, frame too long.
    pub unsent: u64,
    /// Frames lost before we saw them because we were too slow.
    pub missed: u64,
}
