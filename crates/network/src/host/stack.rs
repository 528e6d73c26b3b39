//! ARP, IPv4, ICMP echo and UDP, without an endpoint of its own.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use profinet::{Endpoint, Instant, IpSuite, MacAddress, RPC_PORT, Traffic, Transmit};
use smoltcp::phy::ChecksumCapabilities;
use smoltcp::wire::{
    ArpOperation, ArpPacket, ArpRepr, EthernetAddress, EthernetFrame, EthernetProtocol, EthernetRepr,
    Icmpv4Message, Icmpv4Packet, Icmpv4Repr, IpProtocol, Ipv4Packet, Ipv4Repr, TcpControl, TcpPacket,
    TcpRepr, UdpPacket, UdpRepr,
};

use super::acquire::{Acquire, Action};
use super::address::{NextHop, is_broadcast, is_unicast, next_hop};
use super::neighbours::{Due, Neighbours, Resolution};
use super::{ETHERTYPE_LLDP, ETHERTYPE_PROFINET, MINIMUM_FRAME, addresses, ethertype, within};

const ETHERNET: usize = 14;
const IPV4: usize = 20;
const UDP: usize = 8;
/// Where the payload of a sent datagram starts.
const DATAGRAM: usize = ETHERNET + IPV4 + UDP;
/// Largest IPv4 packet on Ethernet.
const MTU: usize = 1500;
/// Most frames of its own (ARP, echo, datagrams that waited) ready to be sent; beyond, new ones are dropped.
const MAX_READY: usize = 128;
/// Maximum number of local ports stored as used by the endpoint, beside [`RPC_PORT`].
const MAX_PORTS: usize = 64;
/// Announcements of a new address and the pause between them (RFC 5227, 2.3).
const ANNOUNCEMENTS: u8 = 2;
const ANNOUNCE_INTERVAL: Duration = Duration::from_secs(2);
const HOP_LIMIT: u8 = 64;

/// What a [`Stack`] has counted since it was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StackStatistics {
    /// PROFINET and LLDP frames passed to the endpoint.
    pub frames: u64,
    /// Datagrams passed to the endpoint.
    pub datagrams: u64,
    /// Echo requests answered.
    pub echoes: u64,
    /// ARP, IPv4, ICMP and UDP for this station that was malformed or not supported (fragments).
    pub malformed: u64,
    /// Datagrams of the endpoint lost because the neighbour did not answer, a queue was full, there was no way
    /// to the address, or they were longer than an Ethernet frame holds.
    pub unsent: u64,
}

/// The IP part of a station; the endpoint is lent to every call.
///
/// [`Host`](super::Host) owns one together with an endpoint. Use it alone where the endpoint is only borrowed, as
/// [`Medium::step`](profinet::Medium::step) does.
#[derive(Debug)]
pub struct Stack {
    mac: MacAddress,
    suite: IpSuite,
    announcements: u8,
    announce_at: Option<Instant>,
    neighbours: Neighbours,
    ready: VecDeque<Vec<u8>>,
    spare: Vec<Vec<u8>>,
    ports: VecDeque<u16>,
    acquire: Option<Box<Acquire>>,
    statistics: StackStatistics,
}

impl Stack {
    /// Creates a stack for the station `mac`, without an IP address until the endpoint has one.
    #[must_use]
    pub fn new(mac: MacAddress) -> Self {
        Self {
            mac,
            suite: IpSuite::NONE,
            announcements: 0,
            announce_at: None,
            neighbours: Neighbours::default(),
            ready: VecDeque::new(),
            spare: Vec::new(),
            ports: VecDeque::new(),
            acquire: None,
            statistics: StackStatistics::default(),
        }
    }

    /// Sets how many Ethernet addresses of neighbours are stored, at least 512. A station that works with more of them
    /// at once would request addresses again and again.
    pub fn set_neighbours(&mut self, most: usize) {
        self.neighbours.set_limit(most);
    }

    /// Own Ethernet address.
    #[must_use]
    pub fn mac(&self) -> MacAddress {
        self.mac
    }

    /// Returns the counters.
    #[must_use]
    pub fn statistics(&self) -> StackStatistics {
        self.statistics
    }

    /// Returns the address of the endpoint, unspecified without one; `None` while it is being found or is about to change.
    pub(super) fn settled_address<E: Endpoint + ?Sized>(&self, endpoint: &E) -> Option<Ipv4Addr> {
        let settled = !endpoint.acquires_address() && self.acquire.is_none() && endpoint.ip() == self.suite;
        settled.then_some(self.suite.address)
    }

    /// Takes one received frame and passes its contents to the endpoint.
    pub fn handle_frame<E: Endpoint + ?Sized>(&mut self, now: Instant, frame: &[u8], endpoint: &mut E) {
        let Some((destination, source)) = addresses(frame) else {
            return;
        };
        let for_us = destination == self.mac || destination.is_multicast();
        if !for_us || source == self.mac || source.is_multicast() {
            return;
        }
        let Some((kind, offset)) = ethertype(frame) else {
            return;
        };
        endpoint.note_traffic(Traffic::Received, frame);
        if kind == ETHERTYPE_PROFINET || kind == ETHERTYPE_LLDP {
            self.statistics.frames += 1;
            endpoint.handle_frame(now, frame);
            return;
        }
        self.follow(now, endpoint.ip());
        let Some(payload) = frame.get(offset..) else {
            return;
        };
        if let Some(acquire) = &mut self.acquire {
            acquire.handle_frame(now, frame, payload);
            self.seek(now, endpoint);
        }
        if !self.suite.is_set() {
            return;
        }
        let understood = match EthernetProtocol::from(kind) {
            EthernetProtocol::Arp => self.handle_arp(now, payload),
            EthernetProtocol::Ipv4 => self.handle_ipv4(now, source, payload, endpoint),
            _ => Some(()),
        };
        if understood.is_none() {
            self.statistics.malformed += 1;
        }
    }

    /// Does what is due: requests to neighbours, announcements, and the endpoint's own.
    pub fn handle_timeout<E: Endpoint + ?Sized>(&mut self, now: Instant, endpoint: &mut E) {
        endpoint.handle_timeout(now);
        self.seek(now, endpoint);
        self.follow(now, endpoint.ip());
        if self.announce_at.is_some_and(|at| at <= now) {
            self.announce(now);
        }
        while let Some(due) = self.neighbours.poll_due(now) {
            match due {
                Due::Request(ip) => self.send_arp(ArpOperation::Request, MacAddress::BROADCAST, ip),
                Due::GivenUp(lost) => self.statistics.unsent += lost as u64,
            }
        }
    }

    /// Returns the next frame to send: the endpoint's or the stack's own.
    #[must_use]
    pub fn poll_transmit<E: Endpoint + ?Sized>(
        &mut self,
        now: Instant,
        buffer: &mut [u8],
        endpoint: &mut E,
    ) -> Option<usize> {
        let length = self.next_frame(now, buffer, endpoint)?;
        endpoint.note_traffic(Traffic::Sent, buffer.get(..length).unwrap_or_default());
        Some(length)
    }

    fn next_frame<E: Endpoint + ?Sized>(
        &mut self,
        now: Instant,
        buffer: &mut [u8],
        endpoint: &mut E,
    ) -> Option<usize> {
        if self.acquire.is_some() != endpoint.acquires_address() {
            self.seek(now, endpoint);
        }
        self.follow(now, endpoint.ip());
        loop {
            if let Some(length) = self.pop_ready(buffer) {
                return Some(length);
            }
            let transmit = endpoint.poll_transmit(now, buffer)?;
            match within(transmit, buffer.len()) {
                Some(Transmit::Frame { length }) => return Some(length),
                Some(Transmit::Datagram {
                    destination,
                    source_port,
                    length,
                }) => {
                    if let Some(length) = self.send_datagram(now, destination, source_port, length, buffer) {
                        return Some(length);
                    }
                }
                None => self.statistics.unsent += 1,
            }
        }
    }

    /// Returns the time when [`handle_timeout`](Self::handle_timeout) must be called at the latest.
    #[must_use]
    pub fn poll_timeout<E: Endpoint + ?Sized>(&self, endpoint: &E) -> Option<Instant> {
        Instant::earliest([
            endpoint.poll_timeout(),
            self.neighbours.next_due(),
            self.announce_at,
            self.acquire.as_ref().and_then(|acquire| acquire.poll_timeout()),
        ])
    }

    /// Finds an address for an endpoint that has none of its own.
    fn seek<E: Endpoint + ?Sized>(&mut self, now: Instant, endpoint: &mut E) {
        if !endpoint.acquires_address() {
            self.acquire = None;
            return;
        }
        let mac = self.mac;
        let mut acquire = self
            .acquire
            .take()
            .unwrap_or_else(|| Box::new(Acquire::new(now, mac)));
        while let Some(action) = acquire.poll(now) {
            match action {
                Action::Send(frame) => {
                    if let Some(mut place) = self.take_buffer(frame.len()) {
                        place.clear();
                        place.extend_from_slice(&frame);
                        self.ready.push_back(place);
                    }
                }
                Action::Probe(address) => {
                    let all = MacAddress::BROADCAST;
                    self.send_arp_as(Ipv4Addr::UNSPECIFIED, ArpOperation::Request, all, address);
                }
                Action::Announce => {
                    let own = self.suite.address;
                    self.send_arp(ArpOperation::Request, MacAddress::BROADCAST, own);
                }
                Action::Use(suite) => {
                    endpoint.take_address(now, suite);
                    self.follow(now, endpoint.ip());
                }
            }
        }
        self.acquire = Some(acquire);
    }

    /// Applies a changed IP configuration: announces it and removes the neighbours.
    fn follow(&mut self, now: Instant, suite: IpSuite) {
        if suite == self.suite {
            return;
        }
        self.suite = suite;
        self.statistics.unsent += self.neighbours.clear() as u64;
        self.announce_at = None;
        if is_unicast(suite.address) {
            self.announcements = ANNOUNCEMENTS;
            self.announce(now);
        }
    }

    fn announce(&mut self, now: Instant) {
        self.send_arp(ArpOperation::Request, MacAddress::BROADCAST, self.suite.address);
        self.announcements = self.announcements.saturating_sub(1);
        self.announce_at = (self.announcements > 0).then(|| now + ANNOUNCE_INTERVAL);
    }

    /// `None` for what is malformed.
    fn handle_arp(&mut self, now: Instant, payload: &[u8]) -> Option<()> {
        let packet = ArpPacket::new_checked(payload).ok()?;
        let ArpRepr::EthernetIpv4 {
            operation,
            source_hardware_addr,
            source_protocol_addr: sender,
            target_protocol_addr: target,
            ..
        } = ArpRepr::parse(&packet).ok()?
        else {
            return None;
        };
        let mac = MacAddress(source_hardware_addr.0);
        if mac.is_multicast() || mac == self.mac || mac == MacAddress::default() {
            return Some(());
        }
        let asked = operation == ArpOperation::Request && target == self.suite.address;
        if is_unicast(sender) && sender != self.suite.address && !is_broadcast(&self.suite, sender) {
            let local = self.suite.is_local(sender);
            let waited = self.neighbours.learn(now, sender, mac, asked && local);
            self.release(waited, mac);
        } else if !(asked && sender.is_unspecified()) {
            // Another station claims our address, or an invalid address: no answer. A probe from 0.0.0.0 gets one.
            return Some(());
        }
        if asked {
            self.send_arp(ArpOperation::Reply, mac, sender);
        }
        Some(())
    }

    fn handle_ipv4<E: Endpoint + ?Sized>(
        &mut self,
        now: Instant,
        source: MacAddress,
        payload: &[u8],
        endpoint: &mut E,
    ) -> Option<()> {
        let packet = Ipv4Packet::new_checked(payload).ok()?;
        let destination = packet.dst_addr();
        let broadcast = is_broadcast(&self.suite, destination);
        if destination != self.suite.address && !broadcast {
            return Some(());
        }
        let header = Ipv4Repr::parse(&packet, &ChecksumCapabilities::default()).ok()?;
        let sender = header.src_addr;
        if !is_unicast(sender) || sender == self.suite.address || is_broadcast(&self.suite, sender) {
            return Some(());
        }
        match header.next_header {
            IpProtocol::Udp => {
                let datagram = UdpPacket::new_checked(packet.payload()).ok()?;
                let checks = ChecksumCapabilities::default();
                let ports = UdpRepr::parse(&datagram, &sender.into(), &destination.into(), &checks).ok()?;
                if !endpoint.serves(ports.dst_port) && !self.ports.contains(&ports.dst_port) {
                    return Some(());
                }
                if self.suite.is_local(sender) {
                    let waited = self.neighbours.confirm(now, sender, source);
                    self.release(waited, source);
                }
                self.statistics.datagrams += 1;
                let from = SocketAddrV4::new(sender, ports.src_port);
                endpoint.handle_datagram(now, from, ports.dst_port, datagram.payload());
            }
            IpProtocol::Icmp if !broadcast => {
                let packet = Icmpv4Packet::new_checked(packet.payload()).ok()?;
                if packet.msg_type() == Icmpv4Message::EchoRequest {
                    let message = Icmpv4Repr::parse(&packet, &ChecksumCapabilities::default()).ok()?;
                    self.send_echo_reply(source, sender, &message);
                }
            }
            IpProtocol::Tcp if !broadcast => {
                let packet = TcpPacket::new_checked(packet.payload()).ok()?;
                let checks = ChecksumCapabilities::default();
                let segment = TcpRepr::parse(&packet, &sender.into(), &destination.into(), &checks).ok()?;
                self.refuse_connection(source, sender, &segment);
            }
            _ => {}
        }
        Some(())
    }

    /// Answers a TCP segment by a reset: nothing listens here (RFC 9293, 3.5.2).
    fn refuse_connection(&mut self, to: MacAddress, destination: Ipv4Addr, segment: &TcpRepr<'_>) {
        if segment.control == TcpControl::Rst {
            return;
        }
        let reset = TcpRepr {
            src_port: segment.dst_port,
            dst_port: segment.src_port,
            control: TcpControl::Rst,
            seq_number: segment.ack_number.unwrap_or_default(),
            ack_number: match segment.ack_number {
                Some(_) => None,
                None => Some(segment.seq_number + segment.segment_len()),
            },
            window_len: 0,
            window_scale: None,
            max_seg_size: None,
            sack_permitted: false,
            sack_ranges: [None; 3],
            timestamp: None,
            payload: &[],
        };
        let length = IPV4 + reset.buffer_len();
        let Some(mut frame) = self.take_buffer(ETHERNET + length) else {
            return;
        };
        self.emit_ethernet(&mut frame, to, EthernetProtocol::Ipv4);
        self.emit_ipv4(&mut frame, destination, IpProtocol::Tcp, reset.buffer_len());
        if let Some(body) = frame.get_mut(ETHERNET + IPV4..ETHERNET + length) {
            reset.emit(
                &mut TcpPacket::new_unchecked(body),
                &self.suite.address.into(),
                &destination.into(),
                &ChecksumCapabilities::default(),
            );
        }
        self.ready.push_back(frame);
    }

    fn send_arp(&mut self, operation: ArpOperation, to: MacAddress, target: Ipv4Addr) {
        self.send_arp_as(self.suite.address, operation, to, target);
    }

    fn send_arp_as(&mut self, sender: Ipv4Addr, operation: ArpOperation, to: MacAddress, target: Ipv4Addr) {
        let known = if operation == ArpOperation::Reply {
            to
        } else {
            MacAddress::default()
        };
        let message = ArpRepr::EthernetIpv4 {
            operation,
            source_hardware_addr: EthernetAddress(self.mac.0),
            source_protocol_addr: sender,
            target_hardware_addr: EthernetAddress(known.0),
            target_protocol_addr: target,
        };
        let Some(mut frame) = self.take_buffer(ETHERNET + message.buffer_len()) else {
            return;
        };
        self.emit_ethernet(&mut frame, to, EthernetProtocol::Arp);
        if let Some(body) = frame.get_mut(ETHERNET..) {
            message.emit(&mut ArpPacket::new_unchecked(body));
        }
        self.ready.push_back(frame);
    }

    fn send_echo_reply(&mut self, to: MacAddress, destination: Ipv4Addr, request: &Icmpv4Repr<'_>) {
        let &Icmpv4Repr::EchoRequest { ident, seq_no, data } = request else {
            return;
        };
        let reply = Icmpv4Repr::EchoReply { ident, seq_no, data };
        let length = IPV4 + reply.buffer_len();
        if length > MTU {
            return;
        }
        let Some(mut frame) = self.take_buffer(ETHERNET + length) else {
            return;
        };
        self.emit_ethernet(&mut frame, to, EthernetProtocol::Ipv4);
        self.emit_ipv4(&mut frame, destination, IpProtocol::Icmp, reply.buffer_len());
        if let Some(body) = frame.get_mut(ETHERNET + IPV4..ETHERNET + length) {
            reply.emit(
                &mut Icmpv4Packet::new_unchecked(body),
                &ChecksumCapabilities::default(),
            );
        }
        self.statistics.echoes += 1;
        self.ready.push_back(frame);
    }

    /// Turns the payload at the start of `buffer` into a frame there; `None` if it waits for an answer to ARP or is lost.
    fn send_datagram(
        &mut self,
        now: Instant,
        destination: SocketAddrV4,
        source_port: u16,
        length: usize,
        buffer: &mut [u8],
    ) -> Option<usize> {
        self.remember_port(source_port);
        let packet = IPV4 + UDP + length;
        let frame_length = (ETHERNET + packet).max(MINIMUM_FRAME);
        let hop = next_hop(&self.suite, *destination.ip());
        if packet > MTU || frame_length > buffer.len() || hop == NextHop::None {
            self.statistics.unsent += 1;
            return None;
        }
        let (mac, unresolved) = match hop {
            NextHop::Mac(mac) => (mac, None),
            NextHop::Neighbour(ip) => match self.neighbours.resolve(now, ip) {
                Resolution::Known(mac) => (mac, None),
                Resolution::Unknown => (MacAddress::default(), Some(ip)),
            },
            NextHop::None => return None,
        };
        buffer.copy_within(..length, DATAGRAM);
        let frame = buffer.get_mut(..frame_length)?;
        frame.get_mut(DATAGRAM + length..)?.fill(0);
        self.emit_ethernet(frame, mac, EthernetProtocol::Ipv4);
        self.emit_ipv4(frame, *destination.ip(), IpProtocol::Udp, UDP + length);
        let body = frame.get_mut(ETHERNET + IPV4..DATAGRAM + length)?;
        let ports = UdpRepr {
            src_port: source_port,
            dst_port: destination.port(),
        };
        ports.emit(
            &mut UdpPacket::new_unchecked(body),
            &self.suite.address.into(),
            &(*destination.ip()).into(),
            length,
            |_payload_is_there| {},
            &ChecksumCapabilities::default(),
        );
        let Some(ip) = unresolved else {
            return Some(frame_length);
        };
        let copy = frame.to_vec();
        self.statistics.unsent += self.neighbours.wait(ip, copy) as u64;
        // The request is due now; sending it here saves the caller a turn.
        while let Some(due) = self.neighbours.poll_due(now) {
            match due {
                Due::Request(ip) => self.send_arp(ArpOperation::Request, MacAddress::BROADCAST, ip),
                Due::GivenUp(lost) => self.statistics.unsent += lost as u64,
            }
        }
        self.pop_ready(buffer)
    }

    fn emit_ethernet(&self, frame: &mut [u8], to: MacAddress, kind: EthernetProtocol) {
        let header = EthernetRepr {
            src_addr: EthernetAddress(self.mac.0),
            dst_addr: EthernetAddress(to.0),
            ethertype: kind,
        };
        header.emit(&mut EthernetFrame::new_unchecked(frame));
    }

    fn emit_ipv4(&self, frame: &mut [u8], to: Ipv4Addr, protocol: IpProtocol, payload_len: usize) {
        let header = Ipv4Repr {
            src_addr: self.suite.address,
            dst_addr: to,
            next_header: protocol,
            payload_len,
            hop_limit: HOP_LIMIT,
        };
        if let Some(body) = frame.get_mut(ETHERNET..) {
            header.emit(
                &mut Ipv4Packet::new_unchecked(body),
                &ChecksumCapabilities::default(),
            );
        }
    }

    /// Sends frames that waited for `mac`.
    fn release(&mut self, waited: VecDeque<Vec<u8>>, mac: MacAddress) {
        for mut frame in waited {
            if self.ready.len() >= MAX_READY {
                self.statistics.unsent += 1;
                continue;
            }
            if let Some(destination) = frame.get_mut(..6) {
                destination.copy_from_slice(&mac.0);
            }
            self.ready.push_back(frame);
        }
    }

    /// Returns a zeroed buffer for a frame, or `None` when too many are ready already.
    fn take_buffer(&mut self, length: usize) -> Option<Vec<u8>> {
        if self.ready.len() >= MAX_READY {
            return None;
        }
        let mut buffer = self.spare.pop().unwrap_or_default();
        buffer.clear();
        buffer.resize(length.max(MINIMUM_FRAME), 0);
        Some(buffer)
    }

    fn pop_ready(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let frame = self.ready.pop_front()?;
        let length = frame.len();
        let sent = buffer
            .get_mut(..length)
            .map(|target| target.copy_from_slice(&frame));
        if self.spare.is_empty() {
            self.spare.push(frame);
        }
        sent.map(|()| length)
    }

    fn remember_port(&mut self, port: u16) {
        if port == RPC_PORT || self.ports.contains(&port) {
            return;
        }
        if self.ports.len() >= MAX_PORTS {
            self.ports.pop_front();
        }
        self.ports.push_back(port);
    }
}
