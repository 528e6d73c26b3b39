//! Dispatch, faults, determinism.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::{Arc, Mutex};

use profinet::{IpSuite, Medium, RPC_PORT, Transmit};

use super::*;
use crate::host::Host;

/// Sends a frame to `peer` every `every`; counts what comes; answers datagrams.
struct Talker {
    mac: MacAddress,
    ip: Ipv4Addr,
    peer: Option<(MacAddress, Duration)>,
    next: Option<Instant>,
    sequence: u32,
    received: Vec<(Instant, u32)>,
    to_send: Vec<(SocketAddrV4, Vec<u8>)>,
    datagrams: Vec<(Instant, Vec<u8>)>,
    echo: bool,
}

impl Talker {
    fn new(number: u8) -> Self {
        Self {
            mac: mac(number),
            ip: Ipv4Addr::new(10, 0, 0, number),
            peer: None,
            next: None,
            sequence: 0,
            received: Vec::new(),
            to_send: Vec::new(),
            datagrams: Vec::new(),
            echo: false,
        }
    }

    fn sending(number: u8, to: MacAddress, every: Duration) -> Self {
        Self {
            peer: Some((to, every)),
            next: Some(Instant::ZERO + every),
            ..Self::new(number)
        }
    }
}

fn mac(number: u8) -> MacAddress {
    MacAddress([2, 0, 0, 0, 0, number])
}

impl Endpoint for Talker {
    fn mac(&self) -> MacAddress {
        self.mac
    }
    fn ip(&self) -> IpSuite {
        IpSuite {
            address: self.ip,
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        }
    }
    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        let sequence = u32::from_be_bytes(frame[14..18].try_into().unwrap());
        self.received.push((now, sequence));
    }
    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, _: u16, payload: &[u8]) {
        self.datagrams.push((now, payload.to_vec()));
        if self.echo {
            self.to_send.push((source, payload.to_vec()));
        }
    }
    fn handle_timeout(&mut self, _: Instant) {}
    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        if let Some((destination, payload)) = self.to_send.pop() {
            buffer[..payload.len()].copy_from_slice(&payload);
            return Some(Transmit::Datagram {
                destination,
                source_port: RPC_PORT,
                length: payload.len(),
            });
        }
        let (peer, every) = self.peer?;
        let next = self.next.filter(|at| *at <= now)?;
        self.next = Some(next + every);
        self.sequence += 1;
        buffer[..60].fill(0);
        buffer[..6].copy_from_slice(&peer.0);
        buffer[6..12].copy_from_slice(&self.mac.0);
        buffer[12..14].copy_from_slice(&[0x88, 0x92]);
        buffer[14..18].copy_from_slice(&self.sequence.to_be_bytes());
        Some(Transmit::Frame { length: 60 })
    }
    fn poll_timeout(&self) -> Option<Instant> {
        self.next
    }
}

const CYCLE: Duration = Duration::from_millis(16);

fn ms(millis: u64) -> Instant {
    Instant::from_millis(millis)
}

fn pair(seed: u64, conditions: Conditions) -> (Segment, StationId, StationId) {
    let mut segment = Segment::new(seed);
    segment.set_all_conditions(conditions);
    let a = segment.attach(Box::new(Host::new(Talker::sending(1, mac(2), CYCLE))));
    let b = segment.attach(Box::new(Host::new(Talker::sending(2, mac(1), CYCLE))));
    (segment, a, b)
}

fn talker(segment: &Segment, id: StationId) -> &Talker {
    segment.station::<Host<Talker>>(id).unwrap().endpoint()
}

#[test]
fn frames_arrive_after_the_delay_and_in_order() {
    let (mut segment, a, b) = pair(1, Conditions::default());
    segment.run_until(ms(1600) + Duration::from_micros(10));
    for id in [a, b] {
        let received = &talker(&segment, id).received;
        assert_eq!(received.len(), 100);
        assert_eq!(received[0], (ms(16) + Duration::from_micros(10), 1));
        assert!(received.iter().map(|h| h.1).eq(1..=100));
    }
    assert_eq!(segment.fabric.buffers_in_use(), 0);
}

#[test]
fn unicast_reaches_one_multicast_all_but_the_sender() {
    let mut segment = Segment::new(1);
    let all = MacAddress([1, 0x0E, 0xCF, 0, 0, 0]);
    let a = segment.attach(Box::new(Host::new(Talker::sending(1, all, CYCLE))));
    let b = segment.attach(Box::new(Host::new(Talker::sending(2, mac(3), CYCLE))));
    let c = segment.attach(Box::new(Host::new(Talker::new(3))));
    segment.run_until(ms(17));
    let received = [a, b, c].map(|id| talker(&segment, id).received.len());
    assert_eq!(received, [0, 1, 2]);
}

#[test]
fn same_seed_same_trace_other_seed_other_trace() {
    let faults = Conditions {
        loss: 0.05,
        duplicate: 0.05,
        reorder: 0.05,
        reorder_by: Duration::from_millis(40),
        jitter: Duration::from_millis(2),
        ..Conditions::default()
    };
    let run = |seed| {
        let (mut segment, ..) = pair(seed, faults);
        segment.run_until(ms(100_000));
        (segment.trace_hash(), segment.statistics())
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7).0, run(8).0);
}

#[test]
fn faults_occur_at_the_configured_rate() {
    let faults = Conditions {
        loss: 0.01,
        duplicate: 0.02,
        reorder: 0.03,
        reorder_by: Duration::from_millis(20),
        ..Conditions::default()
    };
    let (mut segment, a, _) = pair(3, faults);
    segment.run_until(ms(16 * 50_000));
    let counted = segment.statistics();
    assert!(counted.sent >= 99_999, "{counted:?}");
    let share = |n: u64| n as f64 / counted.sent as f64;
    for (what, count, asked) in [
        ("loss", counted.lost, 0.01),
        ("twice", counted.duplicated, 0.02),
        ("late", counted.reordered, 0.03),
    ] {
        let deviation = (share(count) - asked).abs();
        assert!(
            deviation < 4.0 * (asked / counted.sent as f64).sqrt(),
            "{what}: {count} of {}",
            counted.sent
        );
    }
    let received = &talker(&segment, a).received;
    let backwards = received.windows(2).filter(|pair| pair[1].1 < pair[0].1).count();
    assert!(
        backwards > 1000,
        "frames 20 ms late are overtaken at 16 ms: {backwards}"
    );
}

#[test]
fn jitter_alone_keeps_the_order() {
    let faults = Conditions {
        jitter: Duration::from_millis(100),
        ..Conditions::default()
    };
    let (mut segment, a, _) = pair(4, faults);
    segment.run_until(ms(160_000));
    let received = &talker(&segment, a).received;
    assert!(received.len() > 9_900);
    assert!(
        received
            .windows(2)
            .all(|pair| pair[0].1 < pair[1].1 && pair[0].0 <= pair[1].0)
    );
    let spread: Vec<_> = received
        .iter()
        .map(|(at, n)| *at - ms(16 * u64::from(*n)))
        .collect();
    assert!(spread.iter().max().unwrap() > &Duration::from_millis(95));
    assert!(spread.iter().min().unwrap() < &Duration::from_millis(30));
}

#[test]
fn a_cut_cable_carries_nothing_either_way() {
    let (mut segment, a, b) = pair(1, Conditions::default());
    segment.run_until(ms(100));
    segment.cut(a);
    segment.run_until(ms(1000));
    let count = |segment: &Segment| {
        (
            talker(segment, a).received.len(),
            talker(segment, b).received.len(),
        )
    };
    assert_eq!(count(&segment), (6, 6));
    segment.uncut(a);
    segment.run_until(ms(1600));
    assert_eq!(count(&segment), (6 + 37, 6 + 37));
}

#[test]
fn a_detached_station_can_come_back() {
    let (mut segment, a, b) = pair(1, Conditions::default());
    segment.run_until(ms(100));
    let station = segment.detach(a).unwrap();
    assert!(segment.station::<Host<Talker>>(a).is_none());
    segment.run_until(ms(1000));
    assert!(
        segment.insert(b, Box::new(Host::new(Talker::new(9)))).is_err(),
        "taken"
    );
    assert!(segment.insert(a, station).is_ok());
    segment.run_until(ms(1100));
    assert!(talker(&segment, a).received.len() > 6);
}

#[test]
fn a_station_that_is_always_due_does_not_stop_time() {
    struct Restless;
    impl Station for Restless {
        fn mac(&self) -> MacAddress {
            mac(7)
        }
        fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
        fn handle_timeout(&mut self, _: Instant) {}
        fn poll_transmit(&mut self, _: Instant, _: &mut [u8]) -> Option<usize> {
            None
        }
        fn poll_timeout(&self) -> Option<Instant> {
            Some(Instant::ZERO)
        }
    }
    let mut segment = Segment::new(1);
    segment.attach(Box::new(Restless));
    segment.run_until(ms(1));
    assert_eq!(segment.now(), ms(1));
}

#[test]
fn the_tap_sees_each_frame_once_with_its_time() {
    let (mut segment, a, _) = pair(
        1,
        Conditions {
            loss: 1.0,
            ..Conditions::default()
        },
    );
    let seen = Arc::new(Mutex::new(Vec::new()));
    segment.add_tap(Box::new(Arc::clone(&seen)));
    segment.cut(a);
    segment.run_until(ms(32));
    let cyclic: Vec<_> = seen
        .lock()
        .unwrap()
        .iter()
        .filter(|(_, f)| f[12] == 0x88)
        .map(|(at, _)| at.as_millis())
        .collect();
    assert_eq!(
        cyclic,
        [16, 32],
        "what the cut station sends never reaches the switch"
    );
}

#[test]
fn the_medium_steps_to_its_own_events_and_no_further() {
    let mut segment = Segment::new(1);
    let server = segment.attach(Box::new(Host::new(Talker {
        echo: true,
        ..Talker::new(2)
    })));
    segment.attach(Box::new(Host::new(Talker::sending(3, mac(2), CYCLE))));
    let mut medium = SegmentMedium::new(segment, Pace::Virtual);
    let mut client = Talker::new(1);
    client.to_send.push((
        SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 2), RPC_PORT),
        b"ping".to_vec(),
    ));
    while client.datagrams.is_empty() {
        assert!(medium.now() < ms(1), "no answer");
        medium.step(&mut client, ms(1)).unwrap();
    }
    // The server's own announcement answers the ARP request; then the datagram there and back: 10 us each.
    assert_eq!(
        client.datagrams,
        [(Instant::from_nanos(30_000), b"ping".to_vec())]
    );
    assert_eq!(medium.now(), Instant::from_nanos(30_000));
    while medium.now() < ms(1) {
        medium.step(&mut client, ms(1)).unwrap();
    }
    // Frames that arrive while the endpoint is not stepped are queued.
    let id = medium.place(client.mac);
    medium.segment_mut().inject(&frame_to(client.mac, 5));
    medium.segment_mut().run_until(ms(20));
    assert!(client.received.is_empty());
    medium.step(&mut client, ms(30)).unwrap();
    assert_eq!(
        (client.received.as_slice(), medium.now()),
        (&[(ms(20), 5)][..], ms(20))
    );
    medium.segment_mut().cut(id);
    medium.segment_mut().inject(&frame_to(client.mac, 6));
    while medium.now() < ms(3000) {
        medium.step(&mut client, ms(3000)).unwrap();
    }
    assert_eq!(client.received.len(), 1);
    assert_eq!(talker(medium.segment(), server).received.len(), 187);
}

fn frame_to(to: MacAddress, sequence: u32) -> Vec<u8> {
    let mut frame = vec![0; 60];
    frame[..6].copy_from_slice(&to.0);
    frame[6..12].copy_from_slice(&mac(0x77).0);
    frame[12..14].copy_from_slice(&[0x88, 0x92]);
    frame[14..18].copy_from_slice(&sequence.to_be_bytes());
    frame
}

#[test]
fn the_wall_pace_follows_the_clock() {
    let (segment, ..) = pair(1, Conditions::default());
    let mut medium = SegmentMedium::new(segment, Pace::Wall);
    let mut client = Talker::new(9);
    let started = std::time::Instant::now();
    while medium.now() < ms(40) {
        medium.step(&mut client, ms(40)).unwrap();
    }
    let took = started.elapsed();
    assert!(
        took >= Duration::from_millis(40) && took < Duration::from_secs(2),
        "{took:?}"
    );
}

#[test]
fn an_hour_of_cycles_takes_seconds() {
    let (mut segment, a, b) = pair(
        5,
        Conditions {
            loss: 0.01,
            ..Conditions::default()
        },
    );
    segment.run_until(ms(3_600_001));
    assert_eq!(segment.statistics().sent, 450_000 + 4, "and four announcements");
    for id in [a, b] {
        assert!(talker(&segment, id).received.len() > 220_000);
    }
    assert_eq!(segment.fabric.buffers_in_use(), 0);
}

#[test]
fn a_switch_keeps_what_is_for_the_next_bridge() {
    let group = |last| MacAddress([0x01, 0x80, 0xC2, 0, 0, last]);
    let received = |to| {
        let mut segment = Segment::new(1);
        segment.attach(Box::new(Host::new(Talker::sending(1, to, CYCLE))));
        let other = segment.attach(Box::new(Host::new(Talker::new(2))));
        segment.run_until(ms(100));
        segment
            .station::<Host<Talker>>(other)
            .unwrap()
            .endpoint()
            .received
            .len()
    };
    assert_eq!((received(group(0x0E)), received(group(0x00))), (0, 0));
    assert_eq!((received(group(0x10)), received(mac(2))), (6, 6));
}

#[test]
fn frames_for_a_guest_that_is_away_are_bounded_and_the_oldest_go() {
    let mut medium = SegmentMedium::new(Segment::new(1), Pace::Virtual);
    let (mut away, mut present) = (Talker::new(1), Talker::new(2));
    let step = |medium: &mut SegmentMedium, talker: &mut Talker, until| {
        while medium.now() < until {
            medium.step(talker, until).unwrap();
        }
    };
    // both have announced themselves
    step(&mut medium, &mut present, ms(5));
    step(&mut medium, &mut away, ms(10));
    for sequence in 0..1100 {
        medium.segment_mut().inject(&frame_to(away.mac, sequence));
    }
    step(&mut medium, &mut present, ms(20));
    assert_eq!(medium.segment().statistics().discarded, 1100 - 1024);
    step(&mut medium, &mut away, ms(30));
    let received: Vec<u32> = away.received.iter().map(|(_, sequence)| *sequence).collect();
    assert_eq!(received, (1100 - 1024..1100).collect::<Vec<_>>());
}

#[test]
fn frames_under_way_are_bounded() {
    let mut segment = Segment::new(1);
    for number in 1..=64 {
        segment.attach(Box::new(Host::new(Talker::new(number))));
    }
    let group = MacAddress([0x01, 0x0E, 0xCF, 0, 0, 0]);
    for sequence in 0..1100 {
        segment.inject(&frame_to(group, sequence));
    }
    assert_eq!(segment.statistics().discarded, 64 * 1100 - (1 << 16));
}
