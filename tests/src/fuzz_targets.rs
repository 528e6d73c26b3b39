//! What the fuzzers call, one plain function for each parser of foreign bytes. `tests/tests/corpus.rs` replays the
//! committed corpus through them; `make fuzz` looks for more.
//!
//! A target fails by panicking. Beyond "does not panic" each checks what must hold for every input that is accepted:
//! what was decoded encodes to something that decodes to the same.

mod backup;
mod controller;
mod descriptions;
mod neighbourhood;
mod records;

pub use backup::backup;
pub use controller::controller;
pub use descriptions::gsdml;
pub use neighbourhood::{lldp, snmp};
pub use records::records;

use std::net::SocketAddrV4;
use std::time::Duration;

use network::host::{Host, Station};
use profidrive::notation::{ParameterReference, Quantity};
use profidrive::parameter::{
    Answer, Attributes, Description, Dialect, ErrorNumber, Format, ParameterAccess, ParameterAddress,
    Request, RequestId, Response, serve,
};
use profinet::rpc::{Client, ClientConfig, Interface, Server, ServerLimits};
use profinet::wire::ethernet::{self, Frame};
use profinet::wire::rpc::{
    EpmEntry, FackBody, Header, LookupRequest, LookupResponse, NdrRequest, NdrResponse, PacketType, operation,
};
use profinet::wire::{ByteOrder, Reader, Uuid, dcp as wire_dcp, rt};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};
use virtual_drive::drive::{Disconnect, Drive};
use virtual_drive::model;
use virtual_drive::store::Image;

use crate::rewrite;

/// A target: takes any bytes, must not panic.
pub type Target = fn(&[u8]);

/// All targets by name. `fuzz/fuzz_targets/<name>.rs` and `fuzz/corpus/<name>/` exist for each.
pub const TARGETS: &[(&str, Target)] = &[
    ("alarm", alarm),
    ("backup", backup),
    ("blocks", blocks),
    ("capture", capture),
    ("controller", controller),
    ("dcp", dcp),
    ("description", description),
    ("drive", drive),
    ("gsdml", gsdml),
    ("host", host),
    ("lldp", lldp),
    ("notation", notation),
    ("parameter_request", parameter_request),
    ("parameter_response", parameter_response),
    ("pcap", pcap),
    ("records", records),
    ("rpc", rpc),
    ("rpc_client", rpc_client),
    ("rpc_server", rpc_server),
    ("rt", rt),
    ("snmp", snmp),
    ("state", state),
];

/// Parameters and values as people type them: what is printed is read back as the same.
pub fn notation(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    if let Ok(reference) = text.parse::<ParameterReference>() {
        let printed = reference.to_string();
        assert_eq!(
            printed.parse::<ParameterReference>().as_ref(),
            Ok(&reference),
            "{text:?} as {printed:?}"
        );
    }
    if let Ok(quantity) = text.parse::<Quantity>() {
        let _ = quantity.in_unit("rpm");
        let _ = quantity.number.as_f64();
    }
}

/// PROFINET frames and cyclic data.
pub fn rt(data: &[u8]) {
    let Some(frame) = Frame::parse(data) else { return };
    let mut buffer = vec![0; data.len() + 64];
    let Frame {
        destination,
        source,
        tag,
        frame_id,
        payload,
    } = frame;
    let length = ethernet::emit(&mut buffer, destination, source, tag, frame_id, payload).unwrap();
    assert_eq!(&buffer[..data.len()], data);
    assert_eq!(length, data.len().max(ethernet::MIN_FRAME));
    for length in [0, 40, payload.len().saturating_sub(4), 1440] {
        if let Some(cyclic) = rt::Cyclic::parse(payload, length) {
            assert_eq!(cyclic.data.len(), length);
            assert_eq!(cyclic.trailer.to_bytes()[..], payload[length..length + 4]);
        }
    }
    let _ = rt::Cyclic::parse_to_end(payload);
}

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

/// DCP frames, names and addresses.
pub fn dcp(data: &[u8]) {
    let _ = wire_dcp::check_name(data);
    if let Ok(text) = std::str::from_utf8(data) {
        let _ = wire_dcp::legal_name(text);
    }
    let payload = Frame::parse(data).map_or(data, |frame| frame.payload);
    // what was understood must be understood again, and then be the same
    if let Ok(once) = rewrite::dcp(payload) {
        assert_eq!(rewrite::dcp(&once).as_ref(), Ok(&once));
    }
}

/// Blocks of connect, control and records.
pub fn blocks(data: &[u8]) {
    let mut once = Vec::new();
    if rewrite::blocks(&mut Reader::new(data), &mut once).is_ok() && once.len() <= usize::from(u16::MAX) {
        let mut twice = Vec::new();
        assert_eq!(rewrite::blocks(&mut Reader::new(&once), &mut twice), Ok(()));
        assert_eq!(once, twice);
    }
}

/// The saved state of a drive.
pub fn state(data: &[u8]) {
    if let Ok(image) = Image::decode(data) {
        // comments are not kept, so the text may differ; what it says may not
        let again = Image::decode(image.encode().as_bytes()).unwrap();
        assert!(image.entries().eq(again.entries()));
        assert_eq!(image.model(), again.model());
    }
}

/// Alarm PDUs.
pub fn alarm(data: &[u8]) {
    let payload = Frame::parse(data).map_or(data, |frame| frame.payload);
    if let Ok(once) = rewrite::alarm(payload) {
        assert_eq!(rewrite::alarm(&once).as_ref(), Ok(&once));
    }
}

/// ARP, IPv4, ICMP and UDP around an engine that echoes datagrams.
pub fn host(data: &[u8]) {
    let mut host = Host::new(Echo::default());
    let mut buffer = [0; MAX_FRAME];
    let mut now = Instant::ZERO;
    // a seed is one frame; anything else may also be several steps
    host.handle_frame(now, data);
    for step in Steps(data) {
        match step {
            Step::Frame(frame) | Step::Datagram(frame) => host.handle_frame(now, frame),
            Step::Wait(time) => now += time,
        }
        host.handle_timeout(now);
        for round in 0.. {
            let Some(length) = host.poll_transmit(now, &mut buffer) else {
                break;
            };
            assert!((60..=MAX_FRAME).contains(&length));
            assert!(round < 1000, "it never stops sending");
        }
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

/// RPC client with one open call: answers of a server that may be anybody.
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

/// One step of a fuzzed life.
#[derive(Debug, Clone, Copy)]
enum Step<'a> {
    Frame(&'a [u8]),
    Datagram(&'a [u8]),
    Wait(Duration),
}

/// Cuts fuzzed octets into steps: kind, length in two octets, content. Kind 0 modulo 3 is a frame, 1 a datagram, 2 a
/// pause of as many milliseconds as the length says.
struct Steps<'a>(&'a [u8]);

impl<'a> Iterator for Steps<'a> {
    type Item = Step<'a>;

    fn next(&mut self) -> Option<Step<'a>> {
        let ([kind, high, low], rest) = self.0.split_first_chunk::<3>()?;
        let length = u16::from_be_bytes([*high, *low]);
        let (content, after) = rest.split_at(usize::from(length).min(rest.len()));
        match kind % 3 {
            2 => {
                self.0 = rest;
                Some(Step::Wait(Duration::from_millis(length.into())))
            }
            0 => {
                self.0 = after;
                Some(Step::Frame(content))
            }
            _ => {
                self.0 = after;
                Some(Step::Datagram(content))
            }
        }
    }
}

#[derive(Default)]
struct Echo {
    pending: Option<(SocketAddrV4, u16, usize)>,
}

impl Endpoint for Echo {
    fn mac(&self) -> MacAddress {
        MacAddress([2, 0x50, 0x4E, 0, 0, 1])
    }

    fn ip(&self) -> IpSuite {
        IpSuite {
            address: [192, 168, 77, 50].into(),
            mask: [255, 255, 255, 0].into(),
            gateway: [0; 4].into(),
        }
    }

    fn handle_frame(&mut self, _: Instant, _: &[u8]) {}

    fn handle_datagram(&mut self, _: Instant, source: SocketAddrV4, port: u16, payload: &[u8]) {
        self.pending = Some((source, port, payload.len().min(1400)));
    }

    fn handle_timeout(&mut self, _: Instant) {}

    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let (destination, source_port, length) = self.pending.take()?;
        buffer[..length].fill(0xA5);
        Some(Transmit::Datagram {
            destination,
            source_port,
            length,
        })
    }

    fn poll_timeout(&self) -> Option<Instant> {
        None
    }
}

/// Capture files, damaged ones included: bounded in what they make us hold, and they end.
pub fn pcap(data: &[u8]) {
    let Ok(reader) = network::pcap::Reader::new(std::io::Cursor::new(data.to_vec())) else {
        return;
    };
    let mut frames = 0;
    for captured in reader {
        let Ok(captured) = captured else { break };
        assert!(captured.frame.len() <= data.len());
        frames += 1;
        assert!(frames <= data.len(), "more frames than octets");
    }
}

/// What `decode` says about a capture whose frames may be anybody's: one note at most in a bounded number of octets, and
/// the same capture always gives the same words.
pub fn capture(data: &[u8]) {
    let mut now = Duration::ZERO;
    let mut frames = Vec::new();
    for step in Steps(data) {
        match step {
            Step::Frame(frame) | Step::Datagram(frame) => frames.push((now, frame)),
            Step::Wait(time) => now += time,
        }
    }
    frames.push((now, data));
    let notes = profidrive_cli::decode_frames(frames.iter().copied());
    let length: usize = notes.iter().map(String::len).sum();
    assert!(
        length <= 4096 + 200 * data.len(),
        "{length} octets of notes for {}",
        data.len()
    );
    assert_eq!(notes, profidrive_cli::decode_frames(frames));
}

/// The virtual AKD: control words and setpoints (frames), parameter jobs (datagrams), connections lost and found (pauses).
pub fn drive(data: &[u8]) {
    let mut drive = Drive::new(&model::AKD);
    let mut now = Instant::ZERO;
    let mut out = [0; 512];
    let mut connected = false;
    for step in Steps(data) {
        match step {
            Step::Frame(outputs) => {
                now += Duration::from_millis(16);
                let mut inputs = [0; 4];
                let outputs = outputs.first_chunk::<4>();
                drive.tick(now, outputs.map(<[u8; 4]>::as_slice), &mut inputs);
            }
            Step::Datagram(job) => {
                if let Ok(length) = drive.serve(job, &mut out) {
                    assert!(length <= Dialect::AKD.max_block);
                    assert_eq!(out[0], job[0]);
                }
            }
            Step::Wait(time) => {
                if connected {
                    let cause = if time.as_millis() % 2 == 0 {
                        Disconnect::Lost
                    } else {
                        Disconnect::Released
                    };
                    drive.disconnect(cause);
                } else {
                    let _ = drive.connect(1, Duration::from_millis(48));
                }
                connected = !connected;
                now += time;
                drive.tick(now, None, &mut []);
            }
        }
        let speed = drive.axis().speed();
        assert!(
            speed.is_finite() && speed.abs() < 1e5,
            "the axis turns at {speed}"
        );
        let mut events = 0;
        while drive.poll_event().is_some() {
            events += 1;
            assert!(events < 1000);
        }
    }
}

const DIALECTS: [Dialect; 4] = [Dialect::STANDARD, Dialect::AKD, Dialect::VLT, Dialect::VACON];

/// A request block as a drive gets it: the answer is one that a client accepts for that request.
pub fn parameter_request(data: &[u8]) {
    let mut out = [0; 1024];
    for dialect in &DIALECTS {
        let Ok(length) = serve(data, dialect, &mut SomeDrive, &mut out) else {
            continue;
        };
        assert!(length <= dialect.max_block);
        assert_eq!(out[0], data[0], "the reference is mirrored");
        let Ok(request) = Request::parse(data, dialect.code_space) else {
            continue;
        };
        // a client always asks the axis of its drive's dialect
        if request.axis() != dialect.axis {
            continue;
        }
        let addresses: Vec<ParameterAddress> = request.addresses().collect();
        let parsed = Response::parse(
            &out[..length],
            request.id(),
            request.reference(),
            &addresses,
            dialect,
        );
        match (request.id(), parsed) {
            (RequestId::Other(_), _) | (_, Err(profidrive::parameter::ResponseError::Refused(_))) => {}
            (id, Ok(response)) => {
                assert_eq!(response.answers().count(), addresses.len());
                let failed = response
                    .answers()
                    .any(|answer| matches!(answer, Answer::Error(_)));
                assert_eq!(failed, response.is_negative(), "{id:?}");
            }
            (id, Err(error)) => {
                panic!(
                    "{}: we do not accept our own answer to {id:?}: {error}: {data:02x?}",
                    dialect.name
                )
            }
        }
    }
}

/// A response block as a client gets it: length of the request in one octet, the request, the response.
pub fn parameter_response(data: &[u8]) {
    let Some((length, rest)) = data.split_first() else {
        return;
    };
    let Some((request, response)) = rest.split_at_checked(usize::from(*length)) else {
        return;
    };
    for dialect in &DIALECTS {
        let Ok(request) = Request::parse(request, dialect.code_space) else {
            continue;
        };
        for value in request.values() {
            if value.is_err() {
                break;
            }
        }
        let addresses: Vec<ParameterAddress> = request.addresses().collect();
        let Ok(response) = Response::parse(response, request.id(), request.reference(), &addresses, dialect)
        else {
            continue;
        };
        assert_eq!(response.answers().count(), addresses.len());
        for answer in response.answers() {
            if let Answer::Values(block) = answer {
                for index in 0..300 {
                    let _ = (
                        block.raw(index),
                        block.signed(index),
                        block.value(index, dialect.code_space),
                    );
                }
            }
        }
    }
}

/// Parameter descriptions.
pub fn description(data: &[u8]) {
    let Some(description) = Description::decode(data) else {
        return;
    };
    let again = description.encode();
    let twice = Description::decode(&again).unwrap();
    assert_eq!(twice.encode(), again);
    let _: String = description.name().collect();
}

/// Some of everything: PNU ending in 0 simple word, 1 array of 8 double words, 2 octet string of 20, 3 read-only byte, 4
/// double word that is never accepted, 5 is not there.
struct SomeDrive;

impl ParameterAccess for SomeDrive {
    fn attributes(&self, pnu: u16) -> Option<Attributes> {
        let (format, octets, elements, writable) = match pnu % 6 {
            0 => (Format::UNSIGNED16, 2, 0, true),
            1 => (Format::UNSIGNED32, 4, 8, true),
            2 => (Format::OCTET_STRING, 1, 20, true),
            3 => (Format::UNSIGNED8, 1, 0, false),
            4 => (Format::INTEGER32, 4, 0, true),
            _ => return None,
        };
        Some(Attributes {
            format,
            octets,
            elements,
            writable,
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        assert!(
            self.attributes(pnu).is_some_and(|a| subindex < a.elements.max(1)),
            "PNU {pnu}.{subindex}"
        );
        Ok(u64::from(pnu) ^ u64::from(subindex))
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64) -> Result<(), ErrorNumber> {
        let attributes = self.attributes(pnu).unwrap();
        assert!(
            attributes.writable && subindex < attributes.elements.max(1),
            "PNU {pnu}.{subindex}"
        );
        assert!(attributes.octets == 8 || raw >> (8 * attributes.octets) == 0);
        if pnu % 6 == 4 { Err(ErrorNumber(2)) } else { Ok(()) }
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        (pnu % 12 < 6).then(|| Description::decode(&[0x41; 46]).unwrap())
    }

    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        (pnu % 12 < 6 && index < 4).then_some([0x41; 16])
    }
}
