//! What the fuzzers call, one plain function for each parser of foreign bytes. `tests/tests/corpus.rs` replays the
//! committed corpus through them; `make fuzz` looks for more.
//!
//! A target fails by panicking. Beyond "does not panic" each checks what must hold for every input that is accepted:
//! what was decoded encodes to something that decodes to the same.

use profidrive::notation::{ParameterReference, Quantity};
use profinet::wire::ethernet::{self, Frame};
use profinet::wire::rpc::{
    EpmEntry, FackBody, Header, LookupRequest, LookupResponse, NdrRequest, NdrResponse,
};
use profinet::wire::{ByteOrder, Reader, rt};

/// A target: takes any bytes, must not panic.
pub type Target = fn(&[u8]);

/// All targets by name. `fuzz/fuzz_targets/<name>.rs` and `fuzz/corpus/<name>/` exist for each.
pub const TARGETS: &[(&str, Target)] = &[("notation", notation), ("rpc", rpc), ("rt", rt)];

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
