//! Walks over a capture with our own decoders.

use std::collections::HashMap;
use std::fs::File;
use std::net::Ipv4Addr;
use std::path::Path;

use network::pcap::Reader;
use profinet::wire::ethernet::{Frame, FrameId};
use profinet::{MacAddress, RPC_PORT};

/// What a frame carries, as far as PROFINET is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content<'a> {
    /// EtherType 0x8892.
    Profinet(Frame<'a>),
    /// A UDP datagram with the RPC port at one end.
    Rpc {
        /// Sender.
        source: Ipv4Addr,
        /// Its port.
        source_port: u16,
        /// Receiver.
        destination: Ipv4Addr,
        /// Its port.
        destination_port: u16,
        /// The datagram.
        payload: &'a [u8],
    },
    /// Anything else: ARP, ICMP, LLDP, UDP of others.
    Other,
}

/// Sorts a frame.
#[must_use]
pub fn content(frame: &[u8]) -> Content<'_> {
    if let Some(profinet) = Frame::parse(frame) {
        return Content::Profinet(profinet);
    }
    rpc(frame).unwrap_or(Content::Other)
}

fn rpc(frame: &[u8]) -> Option<Content<'_>> {
    let ip = frame.get(12..)?.strip_prefix(&[0x08, 0x00])?;
    let header = usize::from(ip.first()? & 0x0F) * 4;
    if *ip.get(9)? != 17 {
        return None;
    }
    let address =
        |at: usize| -> Option<Ipv4Addr> { Some(Ipv4Addr::from(*ip.get(at..)?.first_chunk::<4>()?)) };
    let udp = ip.get(header..)?;
    let word = |at: usize| -> Option<u16> { Some(u16::from_be_bytes(*udp.get(at..)?.first_chunk::<2>()?)) };
    let (source_port, destination_port) = (word(0)?, word(2)?);
    let payload = udp.get(8..usize::from(word(4)?))?;
    let (source, destination) = (address(12)?, address(16)?);
    let ours = source_port == RPC_PORT || destination_port == RPC_PORT || payload.starts_with(&[4]);
    ours.then_some(Content::Rpc {
        source,
        source_port,
        destination,
        destination_port,
        payload,
    })
}

/// Returns all frames of a capture with their number, counted from 1 as the dissector does.
#[must_use]
#[track_caller]
pub fn frames(capture: &Path) -> Vec<(usize, Vec<u8>)> {
    let file = File::open(capture).unwrap_or_else(|e| panic!("{}: {e}", capture.display()));
    Reader::new(file)
        .unwrap_or_else(|e| panic!("{}: {e}", capture.display()))
        .enumerate()
        .map(|(i, captured)| {
            (
                i + 1,
                captured
                    .unwrap_or_else(|e| panic!("{}: {e}", capture.display()))
                    .frame,
            )
        })
        .collect()
}

/// FrameID, sender and receiver of cyclic frames.
pub type StreamKey = (FrameId, MacAddress, MacAddress);

/// Cyclic frames of a capture by their FrameID: how many, and how many cycle counter steps are missing between them.
///
/// The provider counts every send interval, so a step of twice the usual one is a lost frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stream {
    /// Frames.
    pub frames: usize,
    /// Intervals without a frame.
    pub lost: usize,
    last: Option<u16>,
}

/// Counts the cyclic frames of a capture. `interval` is the send interval in units of 31.25 us.
#[must_use]
pub fn streams(capture: &Path, interval: u16) -> HashMap<StreamKey, Stream> {
    let mut streams: HashMap<StreamKey, Stream> = HashMap::new();
    for (_, bytes) in frames(capture) {
        let Content::Profinet(frame) = content(&bytes) else {
            continue;
        };
        if !(0x8000..=0xF7FF).contains(&frame.frame_id.0) {
            continue;
        }
        // all streams of our tests have a data length that needs no padding behind the trailer
        let Some(at) = frame.payload.len().checked_sub(4) else {
            continue;
        };
        let counter = u16::from_be_bytes([frame.payload[at], frame.payload[at + 1]]);
        let stream = streams
            .entry((frame.frame_id, frame.source, frame.destination))
            .or_default();
        if let Some(last) = stream.last {
            let steps = usize::from(counter.wrapping_sub(last) / interval);
            stream.lost += steps.saturating_sub(1);
        }
        stream.last = Some(counter);
        stream.frames += 1;
    }
    streams
}
