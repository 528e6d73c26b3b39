//! What the system does on Linux: descriptors to wait for, signals, abstract sockets.

mod event;
mod interfaces;
mod link;
mod memory;
mod neighbours;
mod processes;
mod processor;
mod wait;

use std::io;
use std::net::Ipv4Addr;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};

pub use event::Event;
pub use interfaces::interfaces;
pub use link::link;
pub use memory::free_memory;
pub use neighbours::neighbour_table;
pub use processes::{holders, permissions};
pub use processor::thread_time;
pub use wait::{
    Waiting, now, readable, run_first, sharpen_timers, thread_ran, timespec, wait, wait_for_octets,
    wait_for_room,
};

/// Whether a UDP port can be shared, only with programs that request sharing too.
pub const PORTS_ARE_SHARED: bool = true;

/// What keeps other programs of this library from requiring a UDP port too: a name in the network namespace that is free
/// again with its program.
pub type Claim = UnixDatagram;

/// Claims a UDP port of an address.
pub fn claim(address: Ipv4Addr, port: u16) -> io::Result<Claim> {
    let name = SocketAddr::from_abstract_name(format!("profidrive/{address}:{port}"))?;
    UnixDatagram::bind_addr(&name)
}
