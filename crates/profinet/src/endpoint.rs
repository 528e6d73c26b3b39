//! What an engine and its carrier agree on: bytes in, bytes out, next deadline.

use core::fmt;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::str::FromStr;
use core::time::Duration;

use crate::Instant;

/// UDP port of every PROFINET RPC server (device, controller and endpoint mapper), 0x8894.
pub const RPC_PORT: u16 = 34964;

/// Largest Ethernet frame without FCS that an endpoint sends or takes, 802.1Q tag included.
pub const MAX_FRAME: usize = 1518;

/// An Ethernet address.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct MacAddress(pub [u8; 6]);

impl MacAddress {
    /// FF-FF-FF-FF-FF-FF.
    pub const BROADCAST: Self = Self([0xFF; 6]);

    /// Returns true for multicast and broadcast addresses.
    #[must_use]
    pub const fn is_multicast(self) -> bool {
        self.0[0] & 1 == 1
    }
}

impl fmt::Display for MacAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c, d, e, g] = self.0;
        write!(f, "{a:02x}:{b:02x}:{c:02x}:{d:02x}:{e:02x}:{g:02x}")
    }
}

impl fmt::Debug for MacAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The text is not six hexadecimal octets separated by `:` or `-`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a MAC address is six hexadecimal octets, for example 02:50:4e:00:00:01")]
pub struct MacAddressError;

impl FromStr for MacAddress {
    type Err = MacAddressError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut mac = [0; 6];
        let mut parts = text.split([':', '-']);
        for octet in &mut mac {
            let part = parts.next().ok_or(MacAddressError)?;
            if part.len() != 2 || !part.bytes().all(|b| b.is_ascii_hexdigit()) {
                return Err(MacAddressError);
            }
            *octet = u8::from_str_radix(part, 16).map_err(|_| MacAddressError)?;
        }
        if parts.next().is_some() {
            Err(MacAddressError)
        } else {
            Ok(Self(mac))
        }
    }
}

/// Address, subnet mask and gateway of an endpoint; all zero while none is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct IpSuite {
    /// Own address, `0.0.0.0` while none is set.
    pub address: Ipv4Addr,
    /// Subnet mask.
    pub mask: Ipv4Addr,
    /// Gateway, `0.0.0.0` for none.
    pub gateway: Ipv4Addr,
}

impl IpSuite {
    /// No address.
    pub const NONE: Self = Self {
        address: Ipv4Addr::UNSPECIFIED,
        mask: Ipv4Addr::UNSPECIFIED,
        gateway: Ipv4Addr::UNSPECIFIED,
    };

    /// Returns true when an address is set.
    #[must_use]
    pub fn is_set(&self) -> bool {
        !self.address.is_unspecified()
    }

    /// Returns true when `other` is reached without a gateway.
    #[must_use]
    pub fn is_local(&self, other: Ipv4Addr) -> bool {
        let mask = u32::from(self.mask);
        u32::from(self.address) & mask == u32::from(other) & mask
    }
}

impl Default for IpSuite {
    fn default() -> Self {
        Self::NONE
    }
}

/// Which way a frame went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Traffic {
    /// To this station, or to all.
    Received,
    /// From this station.
    Sent,
}

/// What [`Endpoint::poll_transmit`] put into the buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transmit {
    /// A whole Ethernet frame without FCS of this length (PROFINET EtherType, tagged as the standard requires).
    Frame {
        /// Octets written.
        length: usize,
    },
    /// The payload of one UDP datagram.
    Datagram {
        /// Where to.
        destination: SocketAddrV4,
        /// The local port it leaves from.
        source_port: u16,
        /// Octets written.
        length: usize,
    },
}

/// A protocol engine: a PROFINET device or controller, with or without its application.
///
/// The rule is *feed, drain, sleep*: call one `handle_*`, then [`poll_transmit`](Endpoint::poll_transmit) until it
/// is empty, then sleep until [`poll_timeout`](Endpoint::poll_timeout). Nothing calls back, nothing blocks, no clock
/// is read. Time never goes backwards between calls.
pub trait Endpoint {
    /// Own Ethernet address.
    fn mac(&self) -> MacAddress;

    /// Own IP configuration; may change after any `handle_*` call (DCP Set).
    fn ip(&self) -> IpSuite;

    /// Returns the name of station by which Identify requests select it; `None` for an endpoint that is to receive the
    /// requests for all names.
    fn name(&self) -> Option<&str> {
        None
    }

    /// Returns true while the carrier must find an address: from a DHCP server, else a link-local one (AutoIP). A
    /// carrier of whole Ethernet frames does so and reports it by [`take_address`](Endpoint::take_address).
    fn acquires_address(&self) -> bool {
        false
    }

    /// Takes the address that the carrier found, [`IpSuite::NONE`] when it is lost.
    fn take_address(&mut self, now: Instant, suite: IpSuite) {
        let _ = (now, suite);
    }

    /// Returns true for a local UDP port whose datagrams the endpoint handles, in addition to those it sends from.
    fn serves(&self, port: u16) -> bool {
        port == RPC_PORT
    }

    /// Counts a frame that concerns this station, ARP and IPv4 included. Called by carriers of whole Ethernet frames.
    /// Does nothing if the endpoint counts no traffic.
    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        let _ = (traffic, frame);
    }

    /// Takes one received Ethernet frame with the EtherType of PROFINET (0x8892) or LLDP (0x88CC), 802.1Q tag present or stripped.
    /// Other frames and frames for others are ignored.
    fn handle_frame(&mut self, now: Instant, frame: &[u8]);

    /// Takes the payload of one UDP datagram that arrived at `local_port`.
    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]);

    /// Does what is due at `now`. Calling it early does nothing; calling it late does what was due.
    fn handle_timeout(&mut self, now: Instant);

    /// Writes the next frame to send into `buffer` (at least [`MAX_FRAME`] octets).
    #[must_use]
    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit>;

    /// Returns the time when [`handle_timeout`](Endpoint::handle_timeout) must be called at the latest; may change
    /// after every `handle_*` and `poll_transmit` call.
    #[must_use]
    fn poll_timeout(&self) -> Option<Instant>;

    /// Returns for how long what arrives and what is due may wait, so that it is handled together with what follows: waking up for
    /// each frame of many drives costs more than the work itself. Zero: at once. A carrier need not make use of it.
    #[must_use]
    fn may_wait(&self) -> Duration {
        Duration::ZERO
    }
}

/// A carrier of an endpoint's bytes: a network interface, or a simulated segment in virtual time.
///
/// Blocking programs (the command line, examples, tests) are written against this, so that the same code runs on a
/// wire, on an in-memory segment at wall-clock speed, and in virtual time.
pub trait Medium {
    /// Why the medium failed.
    type Error: core::error::Error;

    /// Returns the present time of this medium.
    fn now(&self) -> Instant;

    /// Carries bytes to and from `endpoint` until at least one input or deadline was handled or `until` is reached,
    /// whichever is first; then returns so that the caller can drain the endpoint's events.
    ///
    /// # Errors
    /// When the medium itself fails (interface gone, permission lost); never because of received bytes.
    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error>;
}
