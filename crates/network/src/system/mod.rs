//! This computer: its clock, its interfaces, its UDP, the signals that end a program, folders. Raw Ethernet apart
//! ([`ethernet`](crate::ethernet)), for any system.
//!
//! | wish | type |
//! |---|---|
//! | a client without permission for raw sockets: records only, no discovery, no cyclic data | [`UdpMedium`] |
//! | what interfaces there are | [`InterfaceInfo`] |
//! | Ctrl-C | [`Stop`] |
//! | what decides how well this computer works as a controller | [`Permissions`], [`Link`], [`PortHolder`], [`NeighbourTable`], [`lateness`] |
//! | frames that are on time while other programs compute | [`First`] |
//! | a folder that one program uses at a time | [`FolderLock`] |

mod diagnosis;
#[cfg(any(test, not(target_os = "linux")))]
#[cfg_attr(target_os = "linux", allow(dead_code))]
mod elsewhere;
mod error;
mod first;
mod interface;
#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // system calls that std does not offer; each block states why it is sound
#[cfg_attr(not(feature = "raw-ethernet"), allow(dead_code, unused_imports))]
pub(crate) mod linux;
mod lock;
pub(crate) mod medium;
mod neighbours;
mod stop;
#[cfg_attr(not(all(feature = "raw-ethernet", target_os = "linux")), allow(dead_code))]
pub(crate) mod udp;

use std::time::Duration;

#[cfg(not(target_os = "linux"))]
use elsewhere as os;
#[cfg(target_os = "linux")]
use linux as os;

pub use diagnosis::{Link, Permissions, PortHolder, lateness};
pub use error::{Error, grant_raw_ethernet};
pub use first::First;
pub use interface::InterfaceInfo;
pub use lock::{FolderLock, LockError};
pub use medium::{ServerPort, UdpMedium};
pub use neighbours::NeighbourTable;
pub use os::{free_memory, now, thread_time};
pub(crate) use os::{wait_for_octets, wait_for_room};
pub(crate) use stop::Calls;
pub use stop::{Bell, ForcedExit, Stop, StopRequests};

/// Processor time of a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ThreadTime {
    /// On a processor.
    pub ran: Duration,
    /// Ready to run while every processor did something else.
    pub waited: Duration,
}

/// What is done first, where several threads are to be first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// Answers to people: a stop that someone requests.
    Answers,
    /// Frames: a drive ends its connection, and stops its axis, when they are late.
    Frames,
    /// What measures the computer itself.
    Clock,
}
