//! A whole Ethernet station around a protocol engine.
//!
//! [`Host`] puts ARP, IPv4, ICMP echo and UDP around an [`Endpoint`] and offers the result as a [`Station`]: whole
//! frames in, whole frames out, next deadline. PROFINET frames (EtherType 0x8892) pass straight through, without a
//! copy and without allocation.
//!
//! An endpoint that [has none](Endpoint::acquires_address) gets its address from a DHCP server, or a link-local one.
//!
//! Left out, on purpose: IPv4 fragments (dropped, PROFINET fragments in RPC), TCP (every connection is refused with a
//! reset), ICMP errors, conflict detection of addresses that were set.

mod acquire;
mod address;
mod audience;
mod dhcp;
mod link_local;
mod neighbours;
mod stack;

use std::any::Any;

use profinet::{Endpoint, Instant, MacAddress, Transmit};

pub use audience::{Audience, Interest};
pub use stack::{Stack, StackStatistics};

/// Smallest Ethernet frame without FCS; shorter ones are padded with zeros (IEEE 802.3).
pub const MINIMUM_FRAME: usize = 60;

/// EtherType of PROFINET real-time, DCP and alarm frames.
pub const ETHERTYPE_PROFINET: u16 = 0x8892;

/// EtherType of LLDP frames.
pub const ETHERTYPE_LLDP: u16 = 0x88CC;

/// An Ethernet station: whole frames in, whole frames out, next deadline.
///
/// The rule is the same as for [`Endpoint`]: *feed, drain, sleep*. [`Segment`](crate::segment::Segment) and the Linux
/// runner run any number of `Box<dyn Station>`; the owner gets its own type back by its index.
///
/// Frames are without FCS, at most [`MAX_FRAME`](profinet::MAX_FRAME) octets, the 802.1Q tag present or absent.
pub trait Station: Any + Send {
    /// Own Ethernet address, by which unicast frames are dispatched. Does not change.
    fn mac(&self) -> MacAddress;

    /// Returns which frames for a group it is to receive. May change after every other call. A carrier of many stations
    /// may keep the others from it.
    fn interest(&self) -> Interest {
        Interest::ALL
    }

    /// Takes one received frame. Frames for others are ignored.
    fn handle_frame(&mut self, now: Instant, frame: &[u8]);

    /// Does what is due at `now`; early calls do nothing.
    fn handle_timeout(&mut self, now: Instant);

    /// Writes the next frame to send into `buffer` (at least [`MAX_FRAME`](profinet::MAX_FRAME) octets) and returns its length.
    #[must_use]
    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize>;

    /// Returns the time when [`handle_timeout`](Station::handle_timeout) must be called at the latest; may change after
    /// every `handle_*` and `poll_transmit` call.
    #[must_use]
    fn poll_timeout(&self) -> Option<Instant>;
}

/// Which of many stations: given by whoever runs them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StationId(pub(crate) usize);

/// An [`Endpoint`] with ARP, IPv4, ICMP echo and UDP around it.
///
/// The Ethernet address is the endpoint's when the host is made; the IP address is followed: when the endpoint's
/// [`Endpoint::ip`] changes, the change is announced by gratuitous ARP and all that was known of neighbours is
/// forgotten.
///
/// ```
/// use profidrive_network::host::{Host, Station};
/// use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};
/// # use std::net::{Ipv4Addr, SocketAddrV4};
/// # struct Nothing;
/// # impl Endpoint for Nothing {
/// #     fn mac(&self) -> MacAddress { MacAddress([2, 0x50, 0x4e, 0, 0, 1]) }
/// #     fn ip(&self) -> IpSuite {
/// #         IpSuite { address: Ipv4Addr::new(10, 0, 0, 1), mask: Ipv4Addr::new(255, 255, 255, 0), gateway: Ipv4Addr::UNSPECIFIED }
/// #     }
/// #     fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
/// #     fn handle_datagram(&mut self, _: Instant, _: SocketAddrV4, _: u16, _: &[u8]) {}
/// #     fn handle_timeout(&mut self, _: Instant) {}
/// #     fn poll_transmit(&mut self, _: Instant, _: &mut [u8]) -> Option<Transmit> { None }
/// #     fn poll_timeout(&self) -> Option<Instant> { None }
/// # }
/// # let engine = Nothing;
/// let mut host = Host::new(engine);
/// let mut buffer = [0; profinet::MAX_FRAME];
/// // The engine has an address: the first thing the host sends is its announcement by ARP.
/// let length = host.poll_transmit(Instant::ZERO, &mut buffer).expect("announcement");
/// assert_eq!(length, 60);
/// assert_eq!(buffer[..6], [0xFF; 6]);
/// assert_eq!(buffer[12..14], [0x08, 0x06]);
/// ```
#[derive(Debug)]
pub struct Host<E> {
    endpoint: E,
    stack: Stack,
}

impl<E: Endpoint> Host<E> {
    /// Puts a station around `endpoint`.
    #[must_use]
    pub fn new(endpoint: E) -> Self {
        let stack = Stack::new(endpoint.mac());
        Self { endpoint, stack }
    }

    /// Returns the same with room for so many neighbours, as a controller of a large plant needs it: see
    /// [`Stack::set_neighbours`].
    #[must_use]
    pub fn with_neighbours(mut self, most: usize) -> Self {
        self.stack.set_neighbours(most);
        self
    }

    /// Returns the engine inside.
    #[must_use]
    pub fn endpoint(&self) -> &E {
        &self.endpoint
    }

    /// Returns the engine inside, to take its events and to give it work. Drain the host afterwards; the segment and
    /// the runner do so for a station taken with their `station_mut`.
    #[must_use]
    pub fn endpoint_mut(&mut self) -> &mut E {
        &mut self.endpoint
    }

    /// Takes the engine out.
    #[must_use]
    pub fn into_endpoint(self) -> E {
        self.endpoint
    }

    /// Returns the counters of the IP stack.
    #[must_use]
    pub fn statistics(&self) -> StackStatistics {
        self.stack.statistics()
    }
}

impl<E: Endpoint + Send + 'static> Station for Host<E> {
    fn mac(&self) -> MacAddress {
        self.stack.mac()
    }

    fn interest(&self) -> Interest {
        Interest::new(self.stack.settled_address(&self.endpoint), self.endpoint.name())
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.stack.handle_frame(now, frame, &mut self.endpoint);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.stack.handle_timeout(now, &mut self.endpoint);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        self.stack.poll_transmit(now, buffer, &mut self.endpoint)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.stack.poll_timeout(&self.endpoint)
    }
}

/// Returns the EtherType of a frame and where its payload starts, one 802.1Q tag skipped; `None` for a stump.
#[must_use]
pub fn ethertype(frame: &[u8]) -> Option<(u16, usize)> {
    let at = |offset: usize| -> Option<u16> {
        Some(u16::from_be_bytes([*frame.get(offset)?, *frame.get(offset + 1)?]))
    };
    match at(12)? {
        0x8100 => Some((at(16)?, 18)),
        other => Some((other, 14)),
    }
}

/// Destination and source address of a frame; `None` for a stump.
#[must_use]
pub fn addresses(frame: &[u8]) -> Option<(MacAddress, MacAddress)> {
    let destination: [u8; 6] = frame.get(..6)?.try_into().ok()?;
    let source: [u8; 6] = frame.get(6..12)?.try_into().ok()?;
    Some((MacAddress(destination), MacAddress(source)))
}

/// Returns an output of an endpoint if it fits `capacity`. Used by the stack, kept here beside the trait it serves.
fn within(transmit: Transmit, capacity: usize) -> Option<Transmit> {
    let length = match transmit {
        Transmit::Frame { length } | Transmit::Datagram { length, .. } => length,
    };
    (length <= capacity).then_some(transmit)
}

#[cfg(test)]
mod tests;
