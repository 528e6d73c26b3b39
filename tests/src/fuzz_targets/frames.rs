//! What one frame may hold: cyclic data, DCP, alarms; and the blocks of connect, control and records.

use profinet::wire::ethernet::{self, Frame};
use profinet::wire::{Reader, dcp as wire_dcp, rt as wire_rt};

use crate::rewrite;

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
        if let Some(cyclic) = wire_rt::Cyclic::parse(payload, length) {
            assert_eq!(cyclic.data.len(), length);
            assert_eq!(cyclic.trailer.to_bytes()[..], payload[length..length + 4]);
        }
    }
    let _ = wire_rt::Cyclic::parse_to_end(payload);
}

/// DCP frames, names and addresses.
pub fn dcp(data: &[u8]) {
    let _ = wire_dcp::check_name(data);
    if let Ok(text) = std::str::from_utf8(data) {
        let _ = wire_dcp::legal_name(text);
    }
    let payload = Frame::parse(data).map_or(data, |frame| frame.payload);
    // a decoded frame must decode again after encoding, to the same value
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

/// Alarm PDUs.
pub fn alarm(data: &[u8]) {
    let payload = Frame::parse(data).map_or(data, |frame| frame.payload);
    if let Ok(once) = rewrite::alarm(payload) {
        assert_eq!(rewrite::alarm(&once).as_ref(), Ok(&once));
    }
}
