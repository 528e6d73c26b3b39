//! Checks whether an IPv4 address is in use before it is assigned (RFC 5227, 2.1).

use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::{Instant, MacAddress};
use smoltcp::wire::{ArpOperation, ArpPacket, ArpRepr, EthernetAddress, EthernetProtocol};

use crate::host::{MINIMUM_FRAME, Station, ethertype};

/// How often each address is requested.
const ROUNDS: u8 = 2;
/// Pause between two rounds.
const PAUSE: Duration = Duration::from_millis(100);
/// Most pairs of an address and a station that are kept; further ones are left out.
const MAX_FOUND: usize = 4096;
const ETHERNET: usize = 14;

/// Finds the holder of an address, and other stations that probe for it, by ARP probes. A probe has no sender address,
/// so it changes nothing in the tables of neighbours.
///
/// ```
/// use profidrive_network::host::{Host, Station};
/// use profidrive_network::probe::Probe;
/// # use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};
/// # use std::net::{Ipv4Addr, SocketAddrV4};
/// # struct Engine;
/// # impl Endpoint for Engine {
/// #     fn mac(&self) -> MacAddress { MacAddress([2, 0x50, 0x4e, 0, 0, 1]) }
/// #     fn ip(&self) -> IpSuite { IpSuite::NONE }
/// #     fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
/// #     fn handle_datagram(&mut self, _: Instant, _: SocketAddrV4, _: u16, _: &[u8]) {}
/// #     fn handle_timeout(&mut self, _: Instant) {}
/// #     fn poll_transmit(&mut self, _: Instant, _: &mut [u8]) -> Option<Transmit> { None }
/// #     fn poll_timeout(&self) -> Option<Instant> { None }
/// # }
/// let mut probe = Probe::new(Host::new(Engine), vec![Ipv4Addr::new(10, 0, 0, 11)]);
/// let mut buffer = [0; profinet::MAX_FRAME];
/// assert_eq!(probe.poll_transmit(Instant::ZERO, &mut buffer), Some(60));
/// assert!(probe.found().is_empty(), "no answer yet");
/// ```
#[derive(Debug)]
pub struct Probe<S> {
    inner: S,
    wanted: Vec<Ipv4Addr>,
    /// Next address of the present round.
    next: usize,
    /// Rounds begun.
    rounds: u8,
    /// When the next round begins.
    due: Option<Instant>,
    found: Vec<(Ipv4Addr, MacAddress)>,
}

impl<S: Station> Probe<S> {
    /// Requests these addresses, beside what `inner` does.
    #[must_use]
    pub fn new(inner: S, wanted: Vec<Ipv4Addr>) -> Self {
        Self {
            inner,
            wanted,
            next: 0,
            rounds: 1,
            due: None,
            found: Vec::new(),
        }
    }

    /// Returns the station inside.
    #[must_use]
    pub const fn inner(&self) -> &S {
        &self.inner
    }

    /// Returns the station inside, to take its events and give it work.
    #[must_use]
    pub const fn inner_mut(&mut self) -> &mut S {
        &mut self.inner
    }

    /// Returns each station that has one of the addresses, or is about to take it, once; at most 4096.
    #[must_use]
    pub fn found(&self) -> &[(Ipv4Addr, MacAddress)] {
        &self.found
    }

    fn receive(&mut self, frame: &[u8]) -> Option<()> {
        let (kind, start) = ethertype(frame)?;
        if EthernetProtocol::from(kind) != EthernetProtocol::Arp {
            return None;
        }
        let packet = ArpPacket::new_checked(frame.get(start..)?).ok()?;
        let ArpRepr::EthernetIpv4 {
            source_hardware_addr,
            source_protocol_addr: sender,
            target_protocol_addr: target,
            ..
        } = ArpRepr::parse(&packet).ok()?
        else {
            return None;
        };
        let owner = MacAddress(source_hardware_addr.0);
        // a probing station names itself as the target
        let address = if sender.is_unspecified() { target } else { sender };
        let new = self.found.len() < MAX_FOUND
            && owner != self.inner.mac()
            && self.wanted.contains(&address)
            && !self.found.contains(&(address, owner));
        if new {
            self.found.push((address, owner));
        }
        Some(())
    }

    fn write(&self, address: Ipv4Addr, buffer: &mut [u8]) -> Option<usize> {
        let mac = self.inner.mac();
        let message = ArpRepr::EthernetIpv4 {
            operation: ArpOperation::Request,
            source_hardware_addr: EthernetAddress(mac.0),
            source_protocol_addr: Ipv4Addr::UNSPECIFIED,
            target_hardware_addr: EthernetAddress([0; 6]),
            target_protocol_addr: address,
        };
        let frame = buffer.get_mut(..MINIMUM_FRAME)?;
        frame.fill(0);
        frame.get_mut(..6)?.copy_from_slice(&MacAddress::BROADCAST.0);
        frame.get_mut(6..12)?.copy_from_slice(&mac.0);
        frame
            .get_mut(12..ETHERNET)?
            .copy_from_slice(&u16::from(EthernetProtocol::Arp).to_be_bytes());
        let body = frame.get_mut(ETHERNET..)?;
        message.emit(&mut ArpPacket::new_unchecked(body));
        Some(MINIMUM_FRAME)
    }
}

impl<S: Station> Station for Probe<S> {
    fn mac(&self) -> MacAddress {
        self.inner.mac()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        let _ = self.receive(frame);
        self.inner.handle_frame(now, frame);
    }

    fn handle_timeout(&mut self, now: Instant) {
        if self.due.is_some_and(|due| due <= now) {
            self.due = None;
            self.next = 0;
            self.rounds += 1;
        }
        self.inner.handle_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        if let Some(address) = self.wanted.get(self.next).copied() {
            self.next += 1;
            if self.next == self.wanted.len() && self.rounds < ROUNDS {
                self.due = Some(now + PAUSE);
            }
            return self.write(address, buffer);
        }
        self.inner.poll_transmit(now, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        let inner = self.inner.poll_timeout();
        self.due.into_iter().chain(inner).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::Host;
    use crate::segment::{Pace, Segment, SegmentMedium};
    use profinet::controller::{Controller, ControllerConfig};
    use profinet::{IpSuite, Medium};

    const MASK: Ipv4Addr = Ipv4Addr::new(255, 255, 255, 0);

    fn engine(last: u8, address: Option<u8>) -> Controller {
        let ip = address.map_or(IpSuite::NONE, |host| IpSuite {
            address: [10, 0, 0, host].into(),
            mask: MASK,
            ..IpSuite::NONE
        });
        Controller::new(ControllerConfig::new(
            MacAddress([2, 0, 0, 0, 0, last]),
            ip,
            "plc",
            1,
        ))
    }

    #[test]
    fn holders_of_an_address_and_competing_probes_are_found() {
        let mut segment = Segment::new(1);
        segment.attach(Box::new(Host::new(engine(1, Some(11)))));
        let wanted = |hosts: &[u8]| hosts.iter().map(|host| [10, 0, 0, *host].into()).collect();
        let one = segment.attach(Box::new(Probe::new(
            Host::new(engine(2, None)),
            wanted(&[10, 11, 12]),
        )));
        let other = segment.attach(Box::new(Probe::new(
            Host::new(engine(3, None)),
            wanted(&[12, 13]),
        )));
        let mut medium = SegmentMedium::new(segment, Pace::Virtual);
        let end = medium.now() + Duration::from_millis(400);
        let mut idle = engine(9, None);
        while medium.now() < end {
            medium.step(&mut idle, end).unwrap();
        }
        let found = |id| {
            let probe: &Probe<Host<Controller>> = medium.segment().station(id).unwrap();
            let mut found: Vec<_> = probe
                .found()
                .iter()
                .map(|(ip, mac)| (ip.octets()[3], mac.0[5]))
                .collect();
            found.sort_unstable();
            found
        };
        assert_eq!(found(one), [(11, 1), (12, 3)]);
        assert_eq!(found(other), [(12, 2)]);
    }

    #[test]
    fn claims_of_ever_new_stations_are_bounded() {
        let wanted: Vec<Ipv4Addr> = vec![[10, 0, 0, 11].into()];
        let mut probe = Probe::new(Host::new(engine(2, None)), wanted.clone());
        let mut frame = [0; profinet::MAX_FRAME];
        let mut other = Probe::new(Host::new(engine(3, None)), wanted);
        let length = other.poll_transmit(Instant::ZERO, &mut frame).unwrap();
        for number in 0..MAX_FOUND as u32 + 100 {
            // the last octets of the sender's Ethernet address
            frame[24..28].copy_from_slice(&(number + 100).to_be_bytes());
            probe.handle_frame(Instant::ZERO, &frame[..length]);
        }
        assert_eq!(probe.found().len(), MAX_FOUND);
    }

    #[test]
    fn each_address_is_probed_twice_without_a_sender_address() {
        let mut probe = Probe::new(Host::new(engine(2, None)), vec![[10, 0, 0, 11].into()]);
        let mut buffer = [0xFF; profinet::MAX_FRAME];
        let mut now = Instant::ZERO;
        for _ in 0..2 {
            assert_eq!(probe.poll_transmit(now, &mut buffer), Some(60));
            assert_eq!(
                buffer[..14],
                [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 2, 0, 0, 0, 0, 2, 8, 6]
            );
            assert_eq!(
                buffer[14..32],
                [0, 1, 8, 0, 6, 4, 0, 1, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0]
            );
            assert_eq!(buffer[32..42], [0, 0, 0, 0, 0, 0, 10, 0, 0, 11]);
            assert_eq!(probe.poll_transmit(now, &mut buffer), None);
            now = probe.poll_timeout().unwrap_or(now);
            probe.handle_timeout(now);
        }
        assert_eq!(probe.poll_transmit(now, &mut buffer), None);
        for cut in 0..60 {
            probe.handle_frame(now, &buffer[..cut]);
        }
        assert!(probe.found().is_empty(), "its own words say nothing");
    }
}
