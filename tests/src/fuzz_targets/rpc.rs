//! RPC: its bodies, and a server and a client that survive all input.

use std::net::SocketAddrV4;
use std::time::Duration;

use profinet::rpc::{Client, ClientConfig, Interface, Server, ServerLimits};
use profinet::wire::rpc::{
    EpmEntry, FackBody, Header, LookupRequest, LookupResponse, NdrRequest, NdrResponse, PacketType, operation,
};
use profinet::wire::{ByteOrder, Reader, Uuid};
use profinet::{Instant, MAX_FRAME};

use super::steps::{Step, Steps};

/// RPC headers, NDR headers, fragment acknowledgements and endpoint mapper bodies.
pub fn rpc(data: &[u8]) {
    if let Ok((header, body)) = Header::decode(data) {
        let mut again = Vec::new();
        header.encode(&mut again, body.len());
        again.extend_from_slice(body);
        assert_eq!(Header::decode(&again), Ok((header, body)));
        stub(body, header.order);
    }
    for order in [ByteOrder::Big, ByteOrder::Little] {
        stub(data, order);
    }
}

fn stub(body: &[u8], order: ByteOrder) {
    let mut out = Vec::new();
    if let Ok(ndr) = NdrRequest::decode(&mut Reader::new(body), order) {
        ndr.encode(&mut out, order);
        out.extend_from_slice(&body[20..]);
        assert_eq!(NdrRequest::decode(&mut Reader::new(&out), order), Ok(ndr));
    }
    out.clear();
    if let Ok(ndr) = NdrResponse::decode(&mut Reader::new(body), order) {
        ndr.encode(&mut out, order);
        out.extend_from_slice(&body[20..]);
        assert_eq!(NdrResponse::decode(&mut Reader::new(&out), order), Ok(ndr));
    }
    let _ = FackBody::decode(body, order);
    if let Ok(lookup) = LookupRequest::decode(&mut Reader::new(body), order) {
        out.clear();
        lookup.encode(&mut out, order);
        assert_eq!(LookupRequest::decode(&mut Reader::new(&out), order), Ok(lookup));
    }
    if let Ok(found) = LookupResponse::decode(&mut Reader::new(body), order) {
        let _: &[EpmEntry] = &found.entries;
        out.clear();
        found.encode(&mut out, order);
        assert_eq!(LookupResponse::decode(&mut Reader::new(&out), order), Ok(found));
    }
}

/// RPC server with endpoint mapper: datagrams of three clients; every call is answered at once.
pub fn rpc_server(data: &[u8]) {
    let interface = Interface {
        uuid: Uuid::DEVICE_INTERFACE,
        operations: operation::COUNT,
    };
    let limits = ServerLimits {
        activities: 4,
        activities_per_address: 2,
        stub: 8192,
    };
    let mut server = Server::new(vec![interface], limits);
    let mut buffer = [0; MAX_FRAME];
    let mut now = Instant::ZERO;
    for (i, step) in Steps(data).enumerate() {
        match step {
            Step::Frame(pdu) | Step::Datagram(pdu) => {
                let source = SocketAddrV4::new([10, 0, 0, (i % 3) as u8].into(), 0x8894);
                if let Some(call) = server.handle(now, source, pdu) {
                    assert!(call.stub.len() <= 8192);
                    server.respond(now, call.key, vec![0xA5; call.stub.len() * 3 % 6000]);
                }
            }
            Step::Wait(time) => now += time,
        }
        server.handle_timeout(now);
        assert!(
            server.poll_timeout().is_none_or(|at| at > now),
            "a deadline that passed stays"
        );
        for round in 0.. {
            if server.poll_transmit(now, &mut buffer).is_none() {
                break;
            }
            assert!(round < 1000, "it never stops sending");
        }
    }
}

/// RPC client with one open call: answers of an untrusted server.
pub fn rpc_client(data: &[u8]) {
    let server = SocketAddrV4::new([10, 0, 0, 1].into(), 0x8894);
    let mut client = Client::new(ClientConfig {
        stub: 8192,
        ..ClientConfig::default()
    });
    let mut now = Instant::ZERO;
    let header = Header::request(
        Uuid::NIL,
        Uuid::DEVICE_INTERFACE,
        Uuid([7; 16]),
        0,
        operation::READ,
    );
    let call = client.call(now, server, header, vec![1; 3000]);
    let mut buffer = [0; MAX_FRAME];
    let mut ended = 0;
    for step in Steps(data) {
        match step {
            Step::Frame(pdu) => {
                // as the server would begin: an answer to the right call
                let mut reply = Vec::new();
                let kind = PacketType::from_code(pdu.first().copied().unwrap_or(2));
                let mut answer = header.reply(kind);
                answer.flags.0 = pdu.get(1).copied().unwrap_or(0);
                answer.fragment = pdu.get(2).copied().unwrap_or(0).into();
                answer.encode(&mut reply, pdu.len());
                reply.extend_from_slice(pdu);
                let _ = client.handle(now, server, &reply);
            }
            Step::Datagram(pdu) => {
                let _ = client.handle(now, server, pdu);
            }
            Step::Wait(time) => now += time,
        }
        client.handle_timeout(now);
        assert!(
            client.poll_timeout().is_none_or(|at| at > now),
            "a deadline that passed stays"
        );
        for round in 0.. {
            if client.poll_transmit(now, &mut buffer).is_none() {
                break;
            }
            assert!(round < 1000, "it never stops sending");
        }
        while let Some((id, outcome)) = client.poll_event() {
            assert_eq!(id, call);
            if let Ok(reply) = outcome {
                assert!(reply.stub.len() <= 8192);
            }
            ended += 1;
        }
    }
    // whatever came, the call ends once, at the latest when its time is over
    client.handle_timeout(now + Duration::from_secs(1000));
    while let Some((id, _)) = client.poll_event() {
        assert_eq!(id, call);
        ended += 1;
    }
    assert!(ended <= 1, "one call ended {ended} times");
}
