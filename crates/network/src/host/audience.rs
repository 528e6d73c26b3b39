//! Whom a group frame is for, as far as its first octets show: in a plant of thousands each station receives the ARP and
//! Identify requests for all others, and looking into each costs far more than the frame.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::net::Ipv4Addr;

use profinet::wire::dcp::{Pdu, ServiceId, ServiceType, Value};
use profinet::wire::ethernet::{Frame, FrameId};
use smoltcp::wire::{ArpOperation, ArpPacket, ArpRepr, EthernetProtocol};

use super::ethertype;

/// Whom a group frame is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Audience {
    /// All stations.
    Everybody,
    /// The station with this IP address: an ARP request.
    Address(Ipv4Addr),
    /// Stations with a name of this hash: an Identify request.
    Name(u64),
}

/// What a station is to receive of the frames for a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interest {
    /// ARP requests for this address; `None` for all.
    address: Option<Ipv4Addr>,
    /// Identify requests for a name of this hash; `None` for all.
    name: Option<u64>,
}

impl Audience {
    /// Reads whom a frame is for.
    #[must_use]
    pub fn of(frame: &[u8]) -> Self {
        arp(frame).or_else(|| identify(frame)).unwrap_or(Self::Everybody)
    }
}

impl Interest {
    /// Receives everything.
    pub const ALL: Self = Self {
        address: None,
        name: None,
    };

    /// Receives the ARP requests for `address` and the Identify requests for `name`; `None` for all of them.
    #[must_use]
    pub fn new(address: Option<Ipv4Addr>, name: Option<&str>) -> Self {
        let name = name.map(|name| hash(name.as_bytes()));
        Self { address, name }
    }

    /// Returns true if a frame for `audience` is to be received.
    #[must_use]
    pub fn covers(&self, audience: Audience) -> bool {
        match audience {
            Audience::Everybody => true,
            Audience::Address(address) => self.address.is_none_or(|own| own == address),
            Audience::Name(name) => self.name.is_none_or(|own| own == name),
        }
    }
}

fn hash(name: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    hasher.finish()
}

/// An ARP request; an announcement, which requests the address of its sender, is for everybody.
fn arp(frame: &[u8]) -> Option<Audience> {
    let (kind, offset) = ethertype(frame)?;
    if EthernetProtocol::from(kind) != EthernetProtocol::Arp {
        return None;
    }
    let ArpRepr::EthernetIpv4 {
        operation: ArpOperation::Request,
        source_protocol_addr: sender,
        target_protocol_addr: target,
        ..
    } = ArpRepr::parse(&ArpPacket::new_checked(frame.get(offset..)?).ok()?).ok()?
    else {
        return None;
    };
    (sender != target).then_some(Audience::Address(target))
}

/// An Identify request whose first filter is a name: a station has to fit every filter.
fn identify(frame: &[u8]) -> Option<Audience> {
    let frame = Frame::parse(frame)?;
    let pdu = Pdu::parse(frame.payload).ok()?;
    let request = frame.frame_id == FrameId::DCP_IDENTIFY_REQUEST
        && (pdu.service, pdu.kind) == (ServiceId::Identify, ServiceType::Request);
    match pdu.blocks().next()?.ok()?.filter() {
        Ok(Value::Name(name)) if request => Some(Audience::Name(hash(name))),
        _ => None,
    }
}
