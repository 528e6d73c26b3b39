//! Linux: stations and clients on a real interface.
//!
//! | wish | type |
//! |---|---|
//! | virtual devices on an interface, beside the host's own addresses | [`Runner`] |
//! | a client with everything, using the host's own addresses | [`PacketMedium`] |
//! | a client without the right to raw sockets: records only, no discovery, no cyclic data | [`UdpMedium`] |
//! | every frame on an interface, nothing sent | [`Capture`] |
//! | what interfaces there are | [`InterfaceInfo`] |
//! | Ctrl-C | [`Stop`] |
//! | a folder that one program uses at a time | [`FolderLock`] |
//!
//! Frames of one runner do not reach the other stations of the same runner, nor the host it runs on, as with any
//! packet socket: the other side must be at the other end of the wire, or of a `veth` pair.

mod capture;
mod error;
mod filter;
mod interface;
mod lock;
mod medium;
mod packet;
mod poll;
mod ring;
mod runner;
mod stop;
mod udp;

pub use capture::Capture;
pub use error::Error;
pub use interface::InterfaceInfo;
pub use lock::{FolderLock, LockError};
pub use medium::{PacketMedium, ServerPort, UdpMedium};
pub use packet::PacketStatistics;
pub use poll::{now, raise_priority};
pub(crate) use poll::{wait_for_octets, wait_for_room};
pub use runner::{Runner, Turn};
pub use stop::{Bell, Patience, Stop};
