//! Client and server against each other over a pipe that loses, repeats and reorders.

use alloc::vec;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::time::Duration;

use proptest::prelude::*;

use super::*;
use crate::wire::rpc::{Flags, Header, MAX_PDU, PacketType, operation, reject};
use crate::wire::{ByteOrder, Uuid, UuidSource};
use crate::{Instant, RPC_PORT};

const SERVER: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 2), RPC_PORT);
const CLIENT: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 1), 50_000);

fn server() -> Server {
    let interface = Interface {
        uuid: Uuid::DEVICE_INTERFACE,
        operations: operation::COUNT,
    };
    Server::new(vec![interface], ServerLimits::default())
}

fn header(activity: u8, sequence: u32) -> Header {
    Header::request(
        Uuid::NIL,
        Uuid::DEVICE_INTERFACE,
        Uuid([activity; 16]),
        sequence,
        operation::WRITE,
    )
}

fn pdu(header: &Header, body: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    header.encode(&mut out, body.len());
    out.extend_from_slice(body);
    out
}

fn sent(server: &mut Server, now: Instant) -> Vec<(SocketAddrV4, Header, Vec<u8>)> {
    let mut buffer = [0; 1518];
    let mut all = Vec::new();
    while let Some((to, length)) = server.poll_transmit(now, &mut buffer) {
        assert!(length <= MAX_PDU);
        let (header, body) = Header::decode(&buffer[..length]).unwrap();
        all.push((to, header, body.to_vec()));
        assert!(all.len() < 100);
    }
    all
}

fn kinds(server: &mut Server) -> Vec<PacketType> {
    sent(server, Instant::ZERO)
        .iter()
        .map(|s| s.1.packet_type)
        .collect()
}

#[test]
fn a_repeated_call_is_executed_once() {
    let (mut server, now) = (server(), Instant::ZERO);
    let request = pdu(&header(1, 5), b"do it");
    let call = server.handle(now, CLIENT, &request).unwrap();
    assert_eq!(call.stub, b"do it");
    // still executing: working, on a repetition as on a ping
    assert_eq!(server.handle(now, CLIENT, &request), None);
    let ping = Header {
        packet_type: PacketType::Ping,
        ..header(1, 5)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&ping, b"")), None);
    assert_eq!(kinds(&mut server), [PacketType::Working, PacketType::Working]);
    server.respond(now, call.key, b"done".to_vec());
    assert_eq!(kinds(&mut server), [PacketType::Response]);
    // answered: the same answer, from whatever port the client now uses
    let other_port = SocketAddrV4::new(*CLIENT.ip(), 50_001);
    assert_eq!(server.handle(now, other_port, &request), None);
    let again = sent(&mut server, now);
    assert_eq!((again[0].0, &again[0].2[..]), (other_port, &b"done"[..]));
    assert_eq!(server.handle(now, CLIENT, &pdu(&ping, b"")), None);
    assert_eq!(kinds(&mut server), [PacketType::Response]);
    // an older one is dropped, a newer one executed
    assert_eq!(server.handle(now, CLIENT, &pdu(&header(1, 4), b"")), None);
    assert!(kinds(&mut server).is_empty());
    assert!(server.handle(now, CLIENT, &pdu(&header(1, 6), b"")).is_some());
    // the old answer can no longer be given
    server.respond(now, call.key, b"late".to_vec());
    assert!(kinds(&mut server).is_empty());
}

#[test]
fn the_same_activity_from_elsewhere_is_another_client() {
    let (mut server, now) = (server(), Instant::ZERO);
    let request = pdu(&header(1, 5), b"mine");
    let call = server.handle(now, CLIENT, &request).unwrap();
    let stranger = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 9), 1);
    assert!(
        server
            .handle(now, stranger, &pdu(&header(1, 9), b"theirs"))
            .is_some()
    );
    server.respond(now, call.key, b"done".to_vec());
    assert_eq!(sent(&mut server, now)[0].0, CLIENT);
}

#[test]
fn unknown_things_are_refused() {
    let (mut server, now) = (server(), Instant::ZERO);
    let ping = Header {
        packet_type: PacketType::Ping,
        ..header(1, 5)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&ping, b"")), None);
    assert_eq!(kinds(&mut server), [PacketType::NoCall]);
    let cancel = Header {
        packet_type: PacketType::Cancel,
        ..header(1, 5)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&cancel, b"")), None);
    assert_eq!(kinds(&mut server), [PacketType::CancelAck]);
    for (bad, body, status) in [
        (
            Header {
                interface: Uuid::NIL,
                ..header(1, 0)
            },
            0,
            reject::UNKNOWN_INTERFACE,
        ),
        (
            Header {
                operation: 6,
                ..header(1, 0)
            },
            0,
            reject::OP_RANGE,
        ),
        (header(1, 0), 1385, reject::PROTOCOL_ERROR),
    ] {
        for order in [ByteOrder::Big, ByteOrder::Little] {
            let bad = Header { order, ..bad };
            assert_eq!(server.handle(now, CLIENT, &pdu(&bad, &vec![0; body])), None);
            let answer = &sent(&mut server, now)[0];
            assert_eq!(answer.1.packet_type, PacketType::Reject);
            let status = if order == ByteOrder::Big {
                status.to_be_bytes()
            } else {
                status.to_le_bytes()
            };
            assert_eq!(answer.2, status);
        }
    }
}

#[test]
fn fragments_back_to_back_need_no_acknowledgement() {
    let (mut server, now) = (server(), Instant::ZERO);
    let mut result = None;
    for (fragment, flags) in [(0, 0x0C), (1, 0x0C), (2, 0x0E)] {
        assert_eq!(result, None);
        let header = Header {
            fragment,
            flags: Flags(flags),
            ..header(1, 0)
        };
        result = server.handle(now, CLIENT, &pdu(&header, &[fragment as u8; 100]));
    }
    assert_eq!(result.unwrap().stub.len(), 300);
    assert!(kinds(&mut server).is_empty());
}

#[test]
fn a_change_of_byte_order_breaks_a_request() {
    let (mut server, now) = (server(), Instant::ZERO);
    let first = Header {
        flags: Flags(0x04),
        ..header(1, 0)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&first, b"a")), None);
    let second = Header {
        fragment: 1,
        flags: Flags(0x06),
        order: ByteOrder::Little,
        ..header(1, 0)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&second, b"b")), None);
    assert_eq!(kinds(&mut server), [PacketType::Fack, PacketType::Reject]);
}

#[test]
fn reassembly_is_bounded_in_size_and_time() {
    let mut server = server();
    let mut now = Instant::ZERO;
    for fragment in 0..60 {
        let header = Header {
            fragment,
            flags: Flags(0x04),
            ..header(1, 0)
        };
        assert_eq!(server.handle(now, CLIENT, &pdu(&header, &[0; 1384])), None);
    }
    assert_eq!(
        kinds(&mut server)
            .iter()
            .filter(|k| **k == PacketType::Reject)
            .count(),
        0
    );
    // the queue of short answers is bounded too; the state reports that the request was dropped
    assert!(matches!(server.poll_timeout(), Some(at) if at == Instant::from_millis(60_000)));
    let first = Header {
        flags: Flags(0x04),
        ..header(2, 0)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&first, b"a")), None);
    now += Duration::from_secs(5);
    server.handle_timeout(now);
    let second = Header {
        fragment: 1,
        flags: Flags(0x06),
        ..header(2, 0)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&second, b"b")), None);
    now += Duration::from_secs(60);
    server.handle_timeout(now);
    assert_eq!(server.poll_timeout(), None);
}

#[test]
fn a_flood_from_one_address_leaves_room_for_others() {
    let (mut server, now) = (server(), Instant::ZERO);
    let kept = server.handle(now, CLIENT, &pdu(&header(1, 0), b"")).unwrap();
    server.respond(now, kept.key, b"kept".to_vec());
    let flood = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 66), 1);
    let mut uuids = UuidSource::new(7);
    let mut executed = 0;
    for _ in 0..1000 {
        let header = Header {
            activity: uuids.uuid(),
            ..header(0, 0)
        };
        executed += usize::from(server.handle(now, flood, &pdu(&header, b"")).is_some());
    }
    assert_eq!(executed, ServerLimits::default().activities_per_address);
    let _ = kinds(&mut server);
    assert_eq!(server.handle(now, CLIENT, &pdu(&header(1, 0), b"")), None);
    assert_eq!(kinds(&mut server), [PacketType::Response]);
}

/// Runs calls over a bad pipe until they end; returns the results and the number of executions by the server.
fn run(
    seed: u64,
    loss: u64,
    request: usize,
    answer: usize,
    order: ByteOrder,
) -> (Result<Reply, CallError>, u32) {
    let mut server = server();
    let mut client = Client::new(ClientConfig::default());
    let mut chance = UuidSource::new(seed);
    let mut now = Instant::ZERO;
    let header = Header {
        order,
        ..header(3, 0)
    };
    let stub: Vec<u8> = (0..request).map(|i| i as u8).collect();
    let id = client.call(now, SERVER, header, stub.clone());
    let mut executed = 0;
    let mut buffer = [0; 1518];
    let mut wire: Vec<(bool, Vec<u8>)> = Vec::new();
    for _ in 0..100_000 {
        if let Some((ended, result)) = client.poll_event() {
            assert_eq!(ended, id);
            return (result, executed);
        }
        while let Some((_, length)) = client.poll_transmit(now, &mut buffer) {
            wire.push((true, buffer[..length].to_vec()));
        }
        while let Some((_, length)) = server.poll_transmit(now, &mut buffer) {
            wire.push((false, buffer[..length].to_vec()));
        }
        if wire.is_empty() {
            let due = [client.poll_timeout(), server.poll_timeout()]
                .into_iter()
                .flatten()
                .min();
            now = due.unwrap();
            client.handle_timeout(now);
            server.handle_timeout(now);
            continue;
        }
        let index = chance.bits() as usize % wire.len();
        let (to_server, pdu) = wire.remove(index);
        if chance.bits() % 100 < loss {
            continue;
        }
        if chance.bits() % 100 < loss {
            wire.push((to_server, pdu.clone()));
        }
        if !to_server {
            client.handle(now, SERVER, &pdu);
        } else if let Some(call) = server.handle(now, CLIENT, &pdu) {
            executed += 1;
            assert_eq!(call.stub, stub);
            assert_eq!(call.order, order);
            server.respond(now, call.key, vec![0x5A; answer]);
        }
    }
    panic!("the call never ended");
}

proptest! {
    #[test]
    fn long_calls_get_through_a_bad_pipe(
        seed: u64, loss in 0u64..15, request in 0usize..9000, answer in 0usize..9000, little: bool,
    ) {
        let order = if little { ByteOrder::Little } else { ByteOrder::Big };
        let (result, executed) = run(seed, loss, request, answer, order);
        prop_assert!(executed <= 1);
        match result {
            Ok(reply) => prop_assert_eq!((executed, reply.order, reply.stub), (1, order, vec![0x5A; answer])),
            Err(error) => prop_assert!(loss > 0, "{}", error),
        }
    }

    #[test]
    fn damaged_pdus_never_panic(seed: u64, bytes in proptest::collection::vec(any::<u8>(), 0..200), kind in 0u8..11) {
        let mut server = server();
        let mut client = Client::new(ClientConfig::default());
        client.call(Instant::ZERO, SERVER, header(1, 0), vec![0; 3000]);
        let mut chance = UuidSource::new(seed);
        for _ in 0..20 {
            let mut pdu = pdu(&Header { packet_type: PacketType::from_code(kind), ..header(1, 0) }, &bytes);
            for _ in 0..3 {
                let at = chance.bits() as usize % pdu.len();
                pdu[at] = chance.bits() as u8;
            }
            let _ = server.handle(Instant::ZERO, CLIENT, &pdu);
            client.handle(Instant::ZERO, SERVER, &pdu);
            let _ = sent(&mut server, Instant::ZERO);
        }
    }
}

#[test]
fn a_server_that_works_for_long_is_waited_for_but_not_for_ever() {
    let mut client = Client::new(ClientConfig::default());
    let request = header(1, 0);
    let id = client.call(Instant::ZERO, SERVER, request, vec![]);
    let mut buffer = [0; 1518];
    let mut now = Instant::ZERO;
    let mut seen = Vec::new();
    let result = loop {
        while let Some((_, length)) = client.poll_transmit(now, &mut buffer) {
            let (header, _) = Header::decode(&buffer[..length]).unwrap();
            seen.push(header.packet_type);
            let working = header.reply(PacketType::Working);
            assert!(client.handle(now, SERVER, &pdu(&working, b"")));
        }
        if let Some(event) = client.poll_event() {
            break event;
        }
        now = client.poll_timeout().unwrap();
        client.handle_timeout(now);
    };
    assert_eq!(
        result,
        (
            id,
            Err(CallError::NeverFinished {
                limit: Duration::from_secs(60)
            })
        )
    );
    assert_eq!(seen[0], PacketType::Request);
    assert!(seen.len() > 20 && seen[1..].iter().all(|kind| *kind == PacketType::Ping));
}

#[test]
fn acknowledgements_that_are_not_sent_are_bounded() {
    let mut client = Client::new(ClientConfig::default());
    let id = client.call(Instant::ZERO, SERVER, header(1, 0), vec![]);
    let mut buffer = [0; 1518];
    assert!(client.poll_transmit(Instant::ZERO, &mut buffer).is_some());
    let first = Header {
        flags: Flags(0x04),
        ..header(1, 0).reply(PacketType::Response)
    };
    for _ in 0..1000 {
        assert!(client.handle(Instant::ZERO, SERVER, &pdu(&first, b"a")));
    }
    let mut sent = 0;
    while client.poll_transmit(Instant::ZERO, &mut buffer).is_some() {
        sent += 1;
    }
    assert_eq!(sent, 32);
    assert!(client.is_open(id));
}

#[test]
fn answers_from_elsewhere_are_no_answers() {
    let mut client = Client::new(ClientConfig::default());
    let id = client.call(Instant::ZERO, SERVER, header(1, 0), vec![]);
    let response = pdu(&header(1, 0).reply(PacketType::Response), b"forged");
    assert!(!client.handle(Instant::ZERO, CLIENT, &response));
    assert!(!client.handle(
        Instant::ZERO,
        SERVER,
        &pdu(&header(1, 1).reply(PacketType::Response), b"")
    ));
    assert!(client.is_open(id));
    let fault = pdu(
        &header(1, 0).reply(PacketType::Fault),
        &reject::OP_RANGE.to_be_bytes(),
    );
    assert!(client.handle(Instant::ZERO, SERVER, &fault));
    assert_eq!(
        client.poll_event(),
        Some((id, Err(CallError::Fault(reject::OP_RANGE))))
    );
}

/// The pnio device derives its activity from its address and counts from 0 after every start.
#[test]
fn a_client_that_started_again_with_the_same_number_is_not_given_its_old_answer() {
    let mut server = server();
    let first = pdu(&header(1, 0), b"ready, connection 1");
    let call = server.handle(Instant::ZERO, CLIENT, &first).unwrap();
    server.respond(Instant::ZERO, call.key, b"done 1".to_vec());
    assert_eq!(sent(&mut server, Instant::ZERO)[0].2, b"done 1");
    // a repetition is answered from memory
    assert_eq!(server.handle(Instant::ZERO, CLIENT, &first), None);
    assert_eq!(sent(&mut server, Instant::ZERO)[0].2, b"done 1");
    // the same number with another content is another call
    let second = pdu(&header(1, 0), b"ready, connection 2");
    let call = server.handle(Instant::ZERO, CLIENT, &second).unwrap();
    assert_eq!(call.stub, b"ready, connection 2");
    server.respond(Instant::ZERO, call.key, b"done 2".to_vec());
    assert_eq!(sent(&mut server, Instant::ZERO)[0].2, b"done 2");
    assert_eq!(server.handle(Instant::ZERO, CLIENT, &second), None);
    assert_eq!(sent(&mut server, Instant::ZERO)[0].2, b"done 2");
}

/// Returns the first, or another, fragment of a call in activity 1.
fn piece(fragment: u16, flags: u8) -> Vec<u8> {
    let header = Header {
        fragment,
        flags: Flags(flags),
        ..header(1, 0)
    };
    pdu(&header, &[fragment as u8; 100])
}

#[test]
fn a_request_that_broke_off_may_come_again() {
    for broken in [false, true] {
        let (mut server, mut now) = (server(), Instant::ZERO);
        assert_eq!(server.handle(now, CLIENT, &piece(0, 0x04)), None);
        if broken {
            let other_order = Header {
                fragment: 1,
                flags: Flags(0x04),
                order: ByteOrder::Little,
                ..header(1, 0)
            };
            assert_eq!(server.handle(now, CLIENT, &pdu(&other_order, b"x")), None);
        } else {
            now += Duration::from_secs(6);
            server.handle_timeout(now);
        }
        // the client receives `unknown call` and starts again with the same number
        let ping = Header {
            packet_type: PacketType::Ping,
            ..header(1, 0)
        };
        let _ = kinds(&mut server);
        assert_eq!(server.handle(now, CLIENT, &pdu(&ping, b"")), None);
        assert_eq!(kinds(&mut server), [PacketType::NoCall]);
        assert_eq!(server.handle(now, CLIENT, &piece(0, 0x04)), None);
        assert_eq!(kinds(&mut server), [PacketType::Fack], "broken: {broken}");
        let call = server.handle(now, CLIENT, &piece(1, 0x06)).expect("a whole call");
        assert_eq!(call.stub.len(), 200);
        assert_eq!(server.handle(now, CLIENT, &piece(0, 0x04)), None, "executed once");
    }
}

#[test]
fn a_long_request_may_take_long_as_long_as_it_goes_on() {
    let mut server = server();
    let mut now = Instant::ZERO;
    for fragment in 0..5 {
        assert_eq!(server.handle(now, CLIENT, &piece(fragment, 0x04)), None);
        now += Duration::from_secs(4);
        server.handle_timeout(now);
    }
    let call = server.handle(now, CLIENT, &piece(5, 0x06)).expect("a whole call");
    assert_eq!(call.stub.len(), 600);
}

#[test]
fn an_unacknowledged_answer_is_kept_for_repeated_requests() {
    let (mut server, mut now) = (server(), Instant::ZERO);
    let call = server.handle(now, CLIENT, &pdu(&header(1, 0), b"")).unwrap();
    server.respond(now, call.key, vec![1; 3000]);
    for _ in 0..3 {
        assert_eq!(sent(&mut server, now).len(), 1);
        now += Duration::from_secs(2);
        server.handle_timeout(now);
    }
    assert!(sent(&mut server, now).is_empty(), "three times are enough");
    now += Duration::from_secs(20);
    server.handle_timeout(now);
    assert!(sent(&mut server, now).is_empty());
    let ping = Header {
        packet_type: PacketType::Ping,
        ..header(1, 0)
    };
    assert_eq!(server.handle(now, CLIENT, &pdu(&ping, b"")), None);
    let again = sent(&mut server, now);
    assert_eq!(
        (again[0].1.packet_type, again[0].1.fragment),
        (PacketType::Response, 0)
    );
    assert_eq!(again[0].2.len(), 1384);
}

#[test]
fn an_acknowledgement_counts_for_all_fragments_before_it() {
    let mut client = Client::new(ClientConfig::default());
    client.call(Instant::ZERO, SERVER, header(1, 0), vec![0; 5000]);
    let mut buffer = [0; 1518];
    let mut fragments = Vec::new();
    // the server lost the call after two fragments, then reports that it has them
    let answers: [(PacketType, u16); 4] = [
        (PacketType::Fack, 0),
        (PacketType::NoCall, 0),
        (PacketType::Fack, 1),
        (PacketType::Fack, 2),
    ];
    for (kind, fragment) in answers {
        let (_, length) = client.poll_transmit(Instant::ZERO, &mut buffer).expect("a PDU");
        fragments.push(Header::decode(&buffer[..length]).unwrap().0.fragment);
        let answer = Header {
            fragment,
            ..header(1, 0).reply(kind)
        };
        assert!(client.handle(Instant::ZERO, SERVER, &pdu(&answer, b"")));
    }
    let (_, length) = client.poll_transmit(Instant::ZERO, &mut buffer).expect("a PDU");
    fragments.push(Header::decode(&buffer[..length]).unwrap().0.fragment);
    assert_eq!(fragments, [0, 1, 0, 2, 3]);
}

#[test]
fn an_answer_that_never_ends_ends_the_call() {
    let mut client = Client::new(ClientConfig::default());
    let id = client.call(Instant::ZERO, SERVER, header(1, 0), vec![]);
    for fragment in 0..60 {
        let part = Header {
            fragment,
            // a fragment that is not to be acknowledged
            flags: Flags(0x0C),
            ..header(1, 0).reply(PacketType::Response)
        };
        client.handle(Instant::ZERO, SERVER, &pdu(&part, &[0; 1384]));
    }
    assert_eq!(client.poll_event(), Some((id, Err(CallError::BadAnswer))));
    assert!(!client.is_open(id));
}

/// The activities of what a client sends now.
fn calls_out(client: &mut Client, now: Instant) -> Vec<u8> {
    let mut buffer = [0; 1518];
    let mut all = Vec::new();
    while let Some((_, length)) = client.poll_transmit(now, &mut buffer) {
        let (header, _) = Header::decode(&buffer[..length]).unwrap();
        all.push(header.activity.0[0]);
    }
    all
}

#[test]
fn many_calls_at_once_do_not_bring_all_their_answers_at_once() {
    let mut client = Client::new(ClientConfig::default());
    for activity in 0..200 {
        client.call(Instant::ZERO, SERVER, header(activity, 0), vec![1]);
    }
    let first = calls_out(&mut client, Instant::ZERO);
    assert_eq!(first.len(), 32);
    // each answer makes room for another call
    for activity in &first[..5] {
        let mut answer = header(*activity, 0).reply(PacketType::Response);
        answer.flags = Flags(0);
        assert!(client.handle(Instant::ZERO, SERVER, &pdu(&answer, &[7])));
    }
    assert_eq!(calls_out(&mut client, Instant::ZERO).len(), 5);
    // the others do not wait for servers that are silent
    let mut now = Instant::ZERO;
    let mut sent = 37;
    while sent < 200 {
        now = client.poll_timeout().unwrap();
        client.handle_timeout(now);
        sent += calls_out(&mut client, now).len();
    }
    assert!(now <= Instant::from_millis(120), "{now:?}");
    assert_eq!(
        client.poll_timeout(),
        Some(Instant::from_millis(2000)),
        "then only repetitions are due"
    );
    // and each of them fails in its own time
    let mut failed = 0;
    while let Some(due) = client.poll_timeout() {
        now = due;
        client.handle_timeout(now);
        calls_out(&mut client, now);
        while let Some((_, result)) = client.poll_event() {
            failed += usize::from(matches!(result, Err(CallError::Timeout { sends: 3, .. })));
        }
    }
    assert_eq!(failed, 195);
    assert!(now <= Instant::from_millis(6500), "{now:?}");
}
