//! Golden frames, damaged frames, and the ways a datagram takes.

use std::net::{Ipv4Addr, SocketAddrV4};

use profinet::wire::dcp::{PduWriter, ServiceId, ServiceType, Value};
use profinet::{IpSuite, MAX_FRAME, RPC_PORT, Traffic};
use proptest::prelude::*;

use super::*;

const MAC: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 0x01]);
const PEER: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 0x99]);
const IP: IpSuite = IpSuite {
    address: Ipv4Addr::new(10, 0, 0, 1),
    mask: Ipv4Addr::new(255, 255, 255, 0),
    gateway: Ipv4Addr::new(10, 0, 0, 254),
};
const PEER_IP: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 9);

/// Records what it gets, sends what the test prepared.
#[derive(Default)]
struct Probe {
    ip: IpSuite,
    frames: Vec<Vec<u8>>,
    datagrams: Vec<(SocketAddrV4, u16, Vec<u8>)>,
    outbox: Vec<(SocketAddrV4, u16, Vec<u8>)>,
    /// A port for which it receives datagrams, beside the usual ones.
    extra: Option<u16>,
    traffic: Vec<(Traffic, Vec<u8>)>,
}

impl Endpoint for Probe {
    fn mac(&self) -> MacAddress {
        MAC
    }
    fn ip(&self) -> IpSuite {
        self.ip
    }
    fn handle_frame(&mut self, _: Instant, frame: &[u8]) {
        self.frames.push(frame.to_vec());
    }
    fn handle_datagram(&mut self, _: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.datagrams.push((source, local_port, payload.to_vec()));
    }
    fn serves(&self, port: u16) -> bool {
        port == RPC_PORT || Some(port) == self.extra
    }
    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        self.traffic.push((traffic, frame.to_vec()));
    }
    fn handle_timeout(&mut self, _: Instant) {}
    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let (destination, source_port, payload) = self.outbox.pop()?;
        buffer[..payload.len()].copy_from_slice(&payload);
        Some(Transmit::Datagram {
            destination,
            source_port,
            length: payload.len(),
        })
    }
    fn poll_timeout(&self) -> Option<Instant> {
        None
    }
}

fn hex(text: &str) -> Vec<u8> {
    let digits: String = text.split_whitespace().collect();
    (0..digits.len() / 2)
        .map(|i| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).unwrap())
        .collect()
}

fn padded(text: &str) -> Vec<u8> {
    let mut frame = hex(text);
    frame.resize(frame.len().max(60), 0);
    frame
}

fn at(millis: u64) -> Instant {
    Instant::from_millis(millis)
}

fn drain(host: &mut Host<Probe>, now: Instant) -> Vec<Vec<u8>> {
    let mut buffer = [0xA5; MAX_FRAME];
    let mut out = Vec::new();
    while let Some(length) = host.poll_transmit(now, &mut buffer) {
        out.push(buffer[..length].to_vec());
        assert!(out.len() < 1000, "endless transmission");
    }
    out
}

/// Returns a host with an address whose announcements are over.
fn settled() -> Host<Probe> {
    let mut host = Host::new(Probe {
        ip: IP,
        ..Probe::default()
    });
    assert_eq!(drain(&mut host, at(0)).len(), 1);
    host.handle_timeout(at(2000));
    assert_eq!(drain(&mut host, at(2000)).len(), 1);
    assert_eq!(host.poll_timeout(), None);
    host
}

const ARP_REQUEST: &str =
    "ffffffffffff 02504e000099 0806 0001 0800 06 04 0001 02504e000099 0a000009 000000000000 0a000001";
const ARP_REPLY: &str =
    "02504e000099 02504e000001 0806 0001 0800 06 04 0002 02504e000001 0a000001 02504e000099 0a000009";
const ECHO_REQUEST: &str = "02504e000001 02504e000099 0800 4500 0024 1234 0000 40 01 549c 0a000009 0a000001 0800 6667 0001 0002 6162636465666768";
/// 10.0.0.9:49152 to 10.0.0.1:34964, "hello"; the checksums are those of an independent calculation.
const DATAGRAM: &str = "02504e000001 02504e000099 0800 4500 0021 0000 4000 40 11 26c3 0a000009 0a000001 c000 8894 000d 5f63 68656c6c6f";

#[test]
fn announces_its_address_twice_and_on_change() {
    let announcement = padded(
        "ffffffffffff 02504e000001 0806 0001 0800 06 04 0001 02504e000001 0a000001 000000000000 0a000001",
    );
    let mut host = Host::new(Probe::default());
    assert_eq!(drain(&mut host, at(0)), Vec::<Vec<u8>>::new());
    host.endpoint_mut().ip = IP;
    assert_eq!(drain(&mut host, at(5)), std::slice::from_ref(&announcement));
    assert_eq!(host.poll_timeout(), Some(at(2005)));
    host.handle_timeout(at(2005));
    assert_eq!(drain(&mut host, at(2005)), [announcement]);
    assert_eq!(host.poll_timeout(), None);
    host.endpoint_mut().ip = IpSuite::NONE;
    assert_eq!(drain(&mut host, at(3000)), Vec::<Vec<u8>>::new());
    host.handle_frame(at(3001), &hex(ARP_REQUEST));
    assert_eq!(
        drain(&mut host, at(3001)),
        Vec::<Vec<u8>>::new(),
        "no address, no answer"
    );
}

#[test]
fn answers_arp_for_its_own_address_only() {
    let mut host = settled();
    host.handle_frame(at(3000), &hex(ARP_REQUEST));
    assert_eq!(drain(&mut host, at(3000)), [padded(ARP_REPLY)]);
    let mut other = hex(ARP_REQUEST);
    *other.last_mut().unwrap() = 2;
    host.handle_frame(at(3001), &other);
    assert_eq!(drain(&mut host, at(3001)), Vec::<Vec<u8>>::new());
    // RFC 5227 probe: sender address zero
    let probe = hex(
        "ffffffffffff 02504e000099 0806 0001 0800 06 04 0001 02504e000099 00000000 000000000000 0a000001",
    );
    host.handle_frame(at(3002), &probe);
    assert_eq!(drain(&mut host, at(3002)).len(), 1);
    // another station with our address
    let thief = hex(
        "ffffffffffff 02504e000099 0806 0001 0800 06 04 0001 02504e000099 0a000001 000000000000 0a000001",
    );
    host.handle_frame(at(3003), &thief);
    assert_eq!(drain(&mut host, at(3003)), Vec::<Vec<u8>>::new());
    // a priority tag makes no difference
    let mut tagged = hex(ARP_REQUEST);
    tagged.splice(12..12, [0x81, 0, 0, 0]);
    host.handle_frame(at(3004), &tagged);
    assert_eq!(drain(&mut host, at(3004)), [padded(ARP_REPLY)]);
}

#[test]
fn answers_echo_requests() {
    let mut host = settled();
    host.handle_frame(at(3000), &hex(ECHO_REQUEST));
    let replies = drain(&mut host, at(3000));
    assert_eq!(
        replies,
        [padded(
            "02504e000099 02504e000001 0800 4500 0024 0000 4000 40 01 26d0 0a000001 0a000009 0000 6e67 0001 0002 6162636465666768"
        )]
    );
    for (offset, what) in [(24, "IPv4 checksum"), (36, "ICMP checksum")] {
        let mut bad = hex(ECHO_REQUEST);
        bad[offset] ^= 1;
        host.handle_frame(at(3001), &bad);
        assert_eq!(drain(&mut host, at(3001)), Vec::<Vec<u8>>::new(), "{what}");
    }
    assert_eq!((host.statistics().echoes, host.statistics().malformed), (1, 2));
}

#[test]
fn hands_over_datagrams_for_its_ports_only() {
    let mut host = settled();
    host.handle_frame(at(3000), &hex(DATAGRAM));
    let from = SocketAddrV4::new(PEER_IP, 49152);
    assert_eq!(host.endpoint().datagrams, [(from, RPC_PORT, b"hello".to_vec())]);
    // another port: only after the endpoint has sent from it
    let mut other = hex(DATAGRAM);
    other[36..38].copy_from_slice(&0xC123u16.to_be_bytes());
    other[40..42].fill(0); // no checksum
    host.handle_frame(at(3001), &other);
    assert_eq!(host.endpoint().datagrams.len(), 1);
    host.endpoint_mut().outbox.push((from, 0xC123, vec![1]));
    let sent = drain(&mut host, at(3002));
    assert_eq!(sent.len(), 1, "the sender's address was learnt from its datagram");
    assert_eq!(sent[0][..6], PEER.0);
    host.handle_frame(at(3003), &other);
    assert_eq!(host.endpoint().datagrams.len(), 2);
}

#[test]
fn drops_wrong_checksums_fragments_and_what_is_for_others() {
    let mut host = settled();
    let mut wrong = hex(DATAGRAM);
    wrong[40..42].copy_from_slice(&[0x12, 0x34]);
    let mut fragment = hex(DATAGRAM);
    fragment[20..22].copy_from_slice(&[0x20, 0x00]);
    fragment[24..26].copy_from_slice(&[0x46, 0xC3]);
    let mut other_mac = hex(DATAGRAM);
    other_mac[5] = 7;
    let mut other_ip = hex(DATAGRAM);
    other_ip[33] = 7;
    other_ip[25] -= 6;
    let own_echo = {
        let mut frame = hex(DATAGRAM);
        frame[6..12].copy_from_slice(&MAC.0);
        frame
    };
    for frame in [wrong, fragment, other_mac, other_ip, own_echo] {
        host.handle_frame(at(3000), &frame);
        assert!(host.endpoint().datagrams.is_empty(), "{frame:02x?}");
    }
    assert_eq!(host.statistics().malformed, 2);
}

#[test]
fn profinet_frames_pass_straight_through_tagged_or_not() {
    let mut host = Host::new(Probe::default());
    let mut plain = vec![0; 60];
    plain[..6].copy_from_slice(&MAC.0);
    plain[6..12].copy_from_slice(&PEER.0);
    plain[12..14].copy_from_slice(&[0x88, 0x92]);
    let mut tagged = plain.clone();
    tagged.splice(12..12, [0x81, 0x00, 0xC0, 0x00]);
    let mut multicast = plain.clone();
    multicast[..6].copy_from_slice(&[0x01, 0x0E, 0xCF, 0, 0, 0]);
    let mut foreign = plain.clone();
    foreign[5] ^= 1;
    for frame in [&plain, &tagged, &multicast, &foreign] {
        host.handle_frame(at(0), frame);
    }
    assert_eq!(host.endpoint().frames, [plain, tagged, multicast]);
}

#[test]
fn resolves_then_sends_what_waited() {
    let mut host = settled();
    let to = SocketAddrV4::new(PEER_IP, RPC_PORT);
    host.endpoint_mut().outbox.push((to, 0xC000, b"hello".to_vec()));
    let request = padded(
        "ffffffffffff 02504e000001 0806 0001 0800 06 04 0001 02504e000001 0a000001 000000000000 0a000009",
    );
    assert_eq!(drain(&mut host, at(3000)), std::slice::from_ref(&request));
    assert_eq!(host.poll_timeout(), Some(at(3200)));
    host.handle_timeout(at(3200));
    assert_eq!(drain(&mut host, at(3200)), [request]);
    host.handle_frame(
        at(3210),
        &hex(
            "02504e000001 02504e000099 0806 0001 0800 06 04 0002 02504e000099 0a000009 02504e000001 0a000001",
        ),
    );
    assert_eq!(
        drain(&mut host, at(3210)),
        [padded(
            "02504e000099 02504e000001 0800 4500 0021 0000 4000 40 11 26c3 0a000001 0a000009 c000 8894 000d 5f63 68656c6c6f"
        )]
    );
    assert_eq!(host.poll_timeout(), None);
}

#[test]
fn sends_remote_traffic_to_the_gateway() {
    let mut host = settled();
    host.endpoint_mut().outbox.push((
        SocketAddrV4::new(Ipv4Addr::new(192, 168, 1, 1), 1),
        0xC000,
        vec![0],
    ));
    let out = drain(&mut host, at(3000));
    assert_eq!(out.len(), 1);
    assert_eq!(out[0][38..42], IP.gateway.octets());
    host.endpoint_mut().ip.gateway = Ipv4Addr::UNSPECIFIED;
    host.endpoint_mut().outbox.push((
        SocketAddrV4::new(Ipv4Addr::new(192, 168, 1, 1), 1),
        0xC000,
        vec![0],
    ));
    let out = drain(&mut host, at(3001));
    assert_eq!(out.len(), 1, "only the announcement of the changed suite");
    assert_eq!(
        host.statistics().unsent,
        2,
        "one waited for the old gateway, one had no way"
    );
}

#[test]
fn a_datagram_longer_than_a_frame_is_not_sent() {
    let mut host = settled();
    let to = SocketAddrV4::new(Ipv4Addr::BROADCAST, RPC_PORT);
    for (length, frames) in [(1472, 1), (1473, 0)] {
        host.endpoint_mut().outbox.push((to, 0xC000, vec![0x55; length]));
        let out = drain(&mut host, at(3000));
        assert_eq!(out.len(), frames, "{length}");
    }
}

proptest! {
    #[test]
    fn survives_any_frame(mut frame in prop::collection::vec(any::<u8>(), 0..200), kind in 0..4usize) {
        let mut host = settled();
        if frame.len() >= 14 {
            frame[..6].copy_from_slice(&MAC.0);
            frame[6] &= 0xFE;
            frame[12..14].copy_from_slice(&[[0x08, 0x00], [0x08, 0x06], [0x81, 0x00], [0x88, 0x92]][kind]);
        }
        host.handle_frame(at(3000), &frame);
        prop_assert!(drain(&mut host, at(3000)).len() <= 1);
    }

    #[test]
    fn survives_damage(which in 0..3usize, flips in prop::collection::vec((0..80usize, 0..8u8), 0..6), cut in 0..80usize) {
        let mut host = settled();
        let mut frame = hex([ARP_REQUEST, ECHO_REQUEST, DATAGRAM][which]);
        for (index, bit) in flips {
            let index = index % frame.len();
            frame[index] ^= 1 << bit;
        }
        frame.truncate(cut);
        host.handle_frame(at(3000), &frame);
        prop_assert!(drain(&mut host, at(3000)).len() <= 1);
    }

    #[test]
    fn one_host_receives_what_another_sends(payload in prop::collection::vec(any::<u8>(), 0..=1472), port in 1u16..) {
        let mut sender = settled();
        sender.handle_frame(at(3000), &hex(DATAGRAM));
        sender.endpoint_mut().outbox.push((SocketAddrV4::new(PEER_IP, RPC_PORT), port, payload.clone()));
        let mut frames = drain(&mut sender, at(3000));
        prop_assert_eq!(frames.len(), 1);
        let mut receiver = Host::new(Probe { ip: IpSuite { address: PEER_IP, ..IP }, ..Probe::default() });
        frames[0][..6].copy_from_slice(&MAC.0);
        frames[0][6..12].copy_from_slice(&PEER.0);
        receiver.handle_frame(at(0), &frames[0]);
        prop_assert_eq!(&receiver.endpoint().datagrams, &[(SocketAddrV4::new(IP.address, port), RPC_PORT, payload)]);
    }
}

#[test]
fn neighbours_are_received_without_an_address() {
    let mut host = Host::new(Probe::default());
    let lldp = padded("0180c200000e 02504e000099 88cc 0202 0761 0402 0762 0602 0014 0000");
    host.handle_frame(at(0), &lldp);
    assert_eq!(host.endpoint().frames, [lldp]);
}

#[test]
fn a_port_is_open_while_the_endpoint_uses_it() {
    let mut host = settled();
    // to port 161, without a checksum
    let mut question = hex(DATAGRAM);
    question[36..38].copy_from_slice(&161_u16.to_be_bytes());
    question[40..42].copy_from_slice(&[0, 0]);
    host.handle_frame(at(3000), &question);
    assert!(host.endpoint().datagrams.is_empty());
    host.endpoint_mut().extra = Some(161);
    host.handle_frame(at(3000), &question);
    assert_eq!(host.endpoint().datagrams[0].1, 161);
}

#[test]
fn the_endpoint_is_notified_of_every_sent_frame() {
    let mut host = settled();
    host.endpoint_mut().traffic.clear();
    let echo = hex(ECHO_REQUEST);
    host.handle_frame(at(3000), &echo);
    let mut other = echo.clone();
    other[5] = 0x77;
    host.handle_frame(at(3000), &other);
    let answers = drain(&mut host, at(3000));
    assert_eq!(
        host.endpoint().traffic,
        [(Traffic::Received, echo), (Traffic::Sent, answers[0].clone())]
    );
}

/// An endpoint without an address.
#[derive(Default)]
struct Seeker {
    ip: IpSuite,
    taken: Vec<IpSuite>,
}

impl Endpoint for Seeker {
    fn mac(&self) -> MacAddress {
        MAC
    }
    fn ip(&self) -> IpSuite {
        self.ip
    }
    fn acquires_address(&self) -> bool {
        true
    }
    fn take_address(&mut self, _: Instant, suite: IpSuite) {
        self.ip = suite;
        self.taken.push(suite);
    }
    fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
    fn handle_datagram(&mut self, _: Instant, _: SocketAddrV4, _: u16, _: &[u8]) {}
    fn handle_timeout(&mut self, _: Instant) {}
    fn poll_transmit(&mut self, _: Instant, _: &mut [u8]) -> Option<Transmit> {
        None
    }
    fn poll_timeout(&self) -> Option<Instant> {
        None
    }
}

/// Returns a DHCP server at PEER that leases 10.0.0.1 for an hour: the answer to a frame, `None` for what is not a
/// request.
fn served(frame: &[u8]) -> Option<Vec<u8>> {
    const DHCP: usize = 14 + 20 + 8;
    if ethertype(frame)?.0 != 0x0800 || frame[23] != 17 || frame[36..38] != [0, 67] {
        return None;
    }
    let request = &frame[DHCP..];
    let kind = request[240..].windows(3).find(|option| option[..2] == [53, 1])?[2];
    let mut reply = vec![2, 1, 6, 0];
    reply.extend(&request[4..8]); // transaction
    reply.extend([0; 8]);
    reply.extend(IP.address.octets());
    reply.extend(PEER_IP.octets());
    reply.extend([0; 4]);
    reply.extend(&request[28..44]); // hardware address
    reply.extend([0; 192]);
    reply.extend([99, 130, 83, 99, 53, 1, if kind == 1 { 2 } else { 5 }, 54, 4]);
    reply.extend(PEER_IP.octets());
    reply.extend([51, 4, 0, 0, 0x0E, 0x10, 1, 4, 255, 255, 255, 0, 3, 4]);
    reply.extend(IP.gateway.octets());
    reply.push(255);
    let mut answer = Vec::new();
    answer.extend(MAC.0);
    answer.extend(PEER.0);
    answer.extend([8, 0, 0x45, 0]);
    answer.extend((28 + reply.len() as u16).to_be_bytes());
    answer.extend([0, 0, 0, 0, 64, 17, 0, 0]);
    answer.extend(PEER_IP.octets());
    answer.extend(IP.address.octets());
    let sum: u32 = answer[14..34]
        .chunks(2)
        .map(|pair| u32::from(u16::from_be_bytes([pair[0], pair[1]])))
        .sum();
    let sum = !((sum & 0xFFFF) + (sum >> 16)) as u16;
    answer[24..26].copy_from_slice(&sum.to_be_bytes());
    answer.extend([0, 67, 0, 68]);
    answer.extend((8 + reply.len() as u16).to_be_bytes());
    answer.extend([0, 0]); // no checksum
    answer.extend(reply);
    Some(answer)
}

/// Runs a host to `until`, or until it has an address; `serve` answers its frames.
fn seek(host: &mut Host<Seeker>, from: u64, until: u64, serve: impl Fn(&[u8]) -> Option<Vec<u8>>) -> u64 {
    let mut now = at(from);
    let mut buffer = [0; MAX_FRAME];
    loop {
        host.handle_timeout(now);
        let mut answers = Vec::new();
        while let Some(length) = host.poll_transmit(now, &mut buffer) {
            answers.extend(serve(&buffer[..length]));
        }
        for answer in answers.drain(..) {
            host.handle_frame(now, &answer);
        }
        while let Some(length) = host.poll_transmit(now, &mut buffer) {
            answers.extend(serve(&buffer[..length]));
        }
        for answer in answers {
            host.handle_frame(now, &answer);
        }
        let next = host.poll_timeout().unwrap_or(at(until));
        if next >= at(until) {
            return until;
        }
        now = next.max(now);
    }
}

#[test]
fn an_endpoint_without_an_address_gets_the_lease_of_a_server() {
    let mut host = Host::new(Seeker::default());
    seek(&mut host, 0, 3000, served);
    assert_eq!(host.endpoint().taken, [IP]);
    // kept up as long as the server is there
    seek(&mut host, 3000, 7_300_000, served);
    assert_eq!(host.endpoint().taken, [IP]);
    // and lost with it, then link-local
    seek(&mut host, 7_300_000, 15_000_000, |_| None);
    let taken = &host.endpoint().taken;
    assert_eq!(taken[1], IpSuite::NONE, "{taken:?}");
    assert!(taken[2].address.is_link_local(), "{taken:?}");
}

#[test]
fn a_server_that_comes_late_replaces_the_link_local_address() {
    let mut host = Host::new(Seeker::default());
    seek(&mut host, 0, 20_000, |_| None);
    assert!(
        host.endpoint().ip.address.is_link_local(),
        "{:?}",
        host.endpoint().ip
    );
    seek(&mut host, 20_000, 60_000, served);
    assert_eq!(host.endpoint().ip, IP);
}

#[test]
fn a_link_local_address_in_use_is_not_chosen() {
    let mut host = Host::new(Seeker::default());
    let mut first = None;
    let owned = std::cell::Cell::new(None::<[u8; 4]>);
    seek(&mut host, 0, 20_000, |frame| {
        // the owner of the first address that is probed answers
        let arp = frame.get(14..42).filter(|_| frame[12..14] == [8, 6])?;
        let target: [u8; 4] = arp[24..28].try_into().ok()?;
        if owned.get().is_none() {
            owned.set(Some(target));
        }
        (owned.get() == Some(target)).then(|| {
            let mut answer = Vec::new();
            answer.extend(MAC.0);
            answer.extend(PEER.0);
            answer.extend([8, 6, 0, 1, 8, 0, 6, 4, 0, 2]);
            answer.extend(PEER.0);
            answer.extend(target);
            answer.extend(MAC.0);
            answer.extend([0; 4]);
            answer
        })
    });
    first.replace(owned.get().expect("probed"));
    let found = host.endpoint().ip.address;
    assert!(found.is_link_local() && Some(found.octets()) != first, "{found}");
}

/// Manual 4.2.5: no Modbus (502), and no Telnet (23): every connection is refused with a reset.
#[test]
fn tcp_connections_are_refused_with_a_reset() {
    use smoltcp::phy::ChecksumCapabilities;
    use smoltcp::wire::{TcpControl, TcpPacket, TcpRepr, TcpSeqNumber};
    for port in [23, 502] {
        let mut host = settled();
        let connect = TcpRepr {
            src_port: 40_000,
            dst_port: port,
            control: TcpControl::Syn,
            seq_number: TcpSeqNumber(1000),
            ack_number: None,
            window_len: 1000,
            window_scale: None,
            max_seg_size: None,
            sack_permitted: false,
            sack_ranges: [None; 3],
            timestamp: None,
            payload: &[],
        };
        let checks = ChecksumCapabilities::default();
        let mut segment = vec![0; connect.buffer_len()];
        let mut packet = TcpPacket::new_unchecked(&mut segment[..]);
        connect.emit(&mut packet, &PEER_IP.into(), &IP.address.into(), &checks);
        let mut frame =
            hex("02504e000001 02504e000099 0800 4500 0028 0000 4000 40 06 26c7 0a000009 0a000001");
        frame.extend(&segment);
        frame.resize(60, 0);
        host.handle_frame(at(3000), &frame);
        let sent = drain(&mut host, at(3000));
        assert_eq!(sent.len(), 1, "{port}");
        let packet = TcpPacket::new_checked(&sent[0][34..54]).unwrap();
        let reset = TcpRepr::parse(&packet, &IP.address.into(), &PEER_IP.into(), &checks).unwrap();
        assert_eq!(
            (reset.control, reset.src_port, reset.ack_number),
            (TcpControl::Rst, port, Some(TcpSeqNumber(1001)))
        );
        // a reset is not answered
        let again = &sent[0];
        let mut echo = again.clone();
        echo[..6].copy_from_slice(&MAC.0);
        echo[6..12].copy_from_slice(&PEER.0);
        host.handle_frame(at(3001), &echo);
        assert!(drain(&mut host, at(3001)).is_empty());
    }
}

#[test]
fn ports_in_use_are_bounded_and_the_oldest_goes() {
    let mut host = settled();
    for source_port in 1000..1065 {
        let to = SocketAddrV4::new(PEER_IP, 7);
        host.endpoint_mut().outbox.push((to, source_port, vec![0]));
        drain(&mut host, at(3000));
    }
    for port in 1000..1066_u16 {
        let mut datagram = hex(DATAGRAM);
        datagram[36..38].copy_from_slice(&port.to_be_bytes());
        datagram[40..42].fill(0); // no checksum
        host.handle_frame(at(3000), &datagram);
    }
    let served: Vec<u16> = host
        .endpoint()
        .datagrams
        .iter()
        .map(|(_, port, _)| *port)
        .collect();
    assert_eq!(served, (1001..1065).collect::<Vec<_>>());
}

#[test]
fn answers_that_nobody_fetches_are_bounded() {
    let mut host = settled();
    for _ in 0..1000 {
        host.handle_frame(at(3000), &hex(ECHO_REQUEST));
    }
    assert_eq!(drain(&mut host, at(3000)).len(), 128);
}

/// An Identify request with these filters.
fn identify(filters: &[Value<'_>]) -> Vec<u8> {
    let mut frame = [&[1, 0x0E, 0xCF, 0, 0, 0][..], &PEER.0, &[0x88, 0x92, 0xFE, 0xFE]].concat();
    let mut pdu = PduWriter::new(&mut frame, ServiceId::Identify, ServiceType::Request, 7, 0);
    for filter in filters {
        pdu.filter(filter);
    }
    pdu.finish();
    frame
}

#[test]
fn a_station_is_interested_in_requests_for_it_and_for_everybody() {
    let covers = |host: &Host<Probe>, frame: &[u8]| host.interest().covers(Audience::of(frame));
    let mut host = settled();
    let mine = padded(ARP_REQUEST);
    let mut other = mine.clone();
    other[41] = 7;
    assert!(covers(&host, &mine) && !covers(&host, &other));
    // the tag of a priority changes nothing; an announcement and an answer to all are for everybody
    other.splice(12..12, [0x81, 0, 0xC0, 0]);
    assert!(!covers(&host, &other));
    let mut announcement = mine.clone();
    announcement[41] = announcement[31];
    assert_eq!(Audience::of(&announcement), Audience::Everybody);
    assert_eq!(Audience::of(&padded(ARP_REPLY)), Audience::Everybody);
    // what is not understood is for everybody
    assert_eq!(Audience::of(&mine[..30]), Audience::Everybody);
    // an address that is about to change
    host.endpoint_mut().ip.address = Ipv4Addr::new(10, 0, 0, 7);
    assert!(covers(&host, &mine) && covers(&host, &other));
    assert_eq!(drain(&mut host, at(2500)).len(), 1);
    assert!(!covers(&host, &mine) && covers(&host, &other));
    // one that is being found
    let seeker = Host::new(Seeker {
        ip: IP,
        taken: Vec::new(),
    });
    assert!(seeker.interest().covers(Audience::of(&other)));

    let named = Interest::new(None, Some("drive-1"));
    assert!(named.covers(Audience::of(&identify(&[Value::Name(b"drive-1")]))));
    assert!(!named.covers(Audience::of(&identify(&[Value::Name(b"drive-10")]))));
    assert!(!named.covers(Audience::of(&identify(&[Value::Name(b"")]))));
    assert!(Interest::new(None, Some("")).covers(Audience::of(&identify(&[Value::Name(b"")]))));
    assert!(named.covers(Audience::of(&identify(&[Value::Alias(b"port-001.plc")]))));
    // one that has no name of its own hears all
    assert!(covers(&host, &identify(&[Value::Name(b"drive-1")])));
}
