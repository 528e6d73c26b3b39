//! What the fuzzers call, one plain function for each parser of foreign bytes. `tests/tests/corpus.rs` replays the
//! committed corpus through them; `make fuzz` looks for more.
//!
//! A target fails by panicking. Beyond "does not panic" each checks what must hold for every input that is accepted:
//! what was decoded encodes to something that decodes to the same.

use std::net::SocketAddrV4;

use network::host::{Host, Station};
use profidrive::notation::{ParameterReference, Quantity};
use profinet::wire::ethernet::{self, Frame};
use profinet::wire::rpc::{
    EpmEntry, FackBody, Header, LookupRequest, LookupResponse, NdrRequest, NdrResponse,
};
use profinet::wire::{ByteOrder, Reader, dcp as wire_dcp, rt};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};
use virtual_drive::store::Image;

use crate::rewrite;

/// A target: takes any bytes, must not panic.
pub type Target = fn(&[u8]);

/// All targets by name. `fuzz/fuzz_targets/<name>.rs` and `fuzz/corpus/<name>/` exist for each.
pub const TARGETS: &[(&str, Target)] = &[
    ("blocks", blocks),
    ("dcp", dcp),
    ("host", host),
    ("notation", notation),
    ("pcap", pcap),
    ("rpc", rpc),
    ("rt", rt),
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

/// ARP, IPv4, ICMP and UDP around an engine that echoes datagrams.
pub fn host(data: &[u8]) {
    let mut host = Host::new(Echo::default());
    let mut buffer = [0; MAX_FRAME];
    let mut now = Instant::ZERO;
    // several frames: each with its length in front; the seeds are one frame without
    let mut rest = data;
    host.handle_frame(now, rest);
    for _ in 0..64 {
        let Some((length, after)) = rest.split_first_chunk::<2>() else {
            break;
        };
        let length = usize::from(u16::from_be_bytes(*length)).min(after.len());
        host.handle_frame(now, &after[..length]);
        rest = &after[length..];
        for _ in 0..8 {
            let Some(length) = host.poll_transmit(now, &mut buffer) else {
                break;
            };
            assert!((60..=MAX_FRAME).contains(&length));
        }
        now += std::time::Duration::from_millis(100);
        host.handle_timeout(now);
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
