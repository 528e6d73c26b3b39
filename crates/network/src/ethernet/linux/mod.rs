//! Packet sockets of Linux.

mod capture;
mod filter;
mod medium;
mod packet;
mod ring;
mod runner;
mod watch;

pub use capture::Capture;
pub use medium::PacketMedium;
pub use runner::Runner;
