//! Walks over the frames of a capture and says what happened: discovery, connects, parameter jobs, state changes,
//! errors. Decoding is done by `profinet::wire` and `profidrive::parameter`; here are only the words and what belongs
//! together.
//!
//! A capture may be damaged, cut or hostile: whatever does not decode is counted or noted, memory is bounded.

mod alarms;
mod calls;
mod channel;
mod connect;
mod cyclic;
mod dcp;
mod drives;
mod jobs;
mod names;
mod neighbours;
mod records;
mod udp;

use std::time::Duration;

use drive_client::Model;
use profinet::wire::ethernet::{Frame, FrameKind};
use profinet::wire::lldp;

use calls::Calls;
use cyclic::Relations;
use drives::Drives;
use names::Names;
use neighbours::Neighbours;

/// How much a note matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// What is to be expected.
    Normal,
    /// Worth a look.
    Warning,
    /// A refusal, a fault, a malformed PDU.
    Error,
}

/// One thing that happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Time since the first frame.
    pub at: Duration,
    /// Who sent it.
    pub from: String,
    /// Who was meant; empty for everybody.
    pub to: String,
    /// DCP, LLDP, connect, record, parameter, cyclic, alarm.
    pub topic: &'static str,
    /// What it says.
    pub text: String,
    /// How much it matters.
    pub weight: Weight,
}

/// What was seen, in numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// All frames.
    pub frames: u64,
    /// Cyclic frames of known connections.
    pub cyclic: u64,
    /// Cyclic frames whose connect is not in the capture.
    pub cyclic_unknown: u64,
    /// DCP frames.
    pub dcp: u64,
    /// RPC packets.
    pub rpc: u64,
    /// Alarm frames.
    pub alarms: u64,
    /// PDUs that could not be decoded.
    pub malformed: u64,
}

/// Reads frames in order and tells what they mean.
#[derive(Debug, Default)]
pub struct Walker {
    names: Names,
    calls: Calls,
    relations: Relations,
    neighbours: Neighbours,
    counts: Counts,
}

/// Where the notes of one frame are collected.
struct Sink<'a> {
    at: Duration,
    from: String,
    to: String,
    notes: &'a mut Vec<Note>,
}

impl Sink<'_> {
    fn note(&mut self, weight: Weight, topic: &'static str, text: impl Into<String>) {
        self.notes.push(Note {
            at: self.at,
            from: self.from.clone(),
            to: self.to.clone(),
            topic,
            text: text.into(),
            weight,
        });
    }
}

impl Walker {
    /// Drives that do not say what they are, are taken for this model; without one for an AKD.
    pub fn new(model: Option<Model>) -> Self {
        let mut walker = Self::default();
        walker.names.drives = Drives::new(model);
        walker
    }

    /// What was seen so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Looks at one Ethernet frame.
    pub fn frame(&mut self, at: Duration, bytes: &[u8]) -> Vec<Note> {
        let mut notes = Vec::new();
        self.counts.frames += 1;
        if let Some(frame) = Frame::parse(bytes) {
            self.profinet(at, &frame, &mut notes);
        } else if let Some((source, payload)) = lldp::payload(bytes) {
            let mut sink = Sink {
                at,
                from: self.names.mac(source),
                to: String::new(),
                notes: &mut notes,
            };
            if let Err(error) = self.neighbours.pdu(source, payload, &mut self.names, &mut sink) {
                self.counts.malformed += 1;
                sink.note(Weight::Error, "malformed", format!("LLDP: {error}"));
            }
        } else if let Some(datagram) = udp::datagram(bytes) {
            let mut sink = Sink {
                at,
                from: self.names.ip(*datagram.source.ip()),
                to: self.names.ip(*datagram.destination.ip()),
                notes: &mut notes,
            };
            let before = self.calls.seen();
            if let Err(error) =
                self.calls
                    .datagram(&datagram, &mut self.relations, &mut self.names, &mut sink)
            {
                self.counts.malformed += 1;
                sink.note(Weight::Error, "malformed", error.to_string());
            }
            self.counts.rpc += self.calls.seen() - before;
        }
        notes
    }

    fn profinet(&mut self, at: Duration, frame: &Frame<'_>, notes: &mut Vec<Note>) {
        let everybody = frame.destination.is_multicast();
        let mut sink = Sink {
            at,
            from: self.names.mac(frame.source),
            to: if everybody {
                String::new()
            } else {
                self.names.mac(frame.destination)
            },
            notes,
        };
        match frame.frame_id.kind() {
            FrameKind::DcpHello
            | FrameKind::DcpGetSet
            | FrameKind::DcpIdentifyRequest
            | FrameKind::DcpIdentifyResponse => {
                self.counts.dcp += 1;
                if let Err(error) = dcp::pdu(frame, &mut self.names, &mut sink) {
                    self.counts.malformed += 1;
                    sink.note(Weight::Error, "malformed", format!("DCP: {error}"));
                }
            }
            _ if frame.frame_id.is_cyclic() => {
                if self.relations.cyclic(frame, &mut self.names, &mut sink) {
                    self.counts.cyclic += 1;
                } else {
                    self.counts.cyclic_unknown += 1;
                }
            }
            FrameKind::AlarmHigh | FrameKind::AlarmLow => {
                self.counts.alarms += 1;
                if let Err(error) = alarms::pdu(frame, &mut sink) {
                    self.counts.malformed += 1;
                    sink.note(Weight::Error, "malformed", format!("alarm: {error}"));
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_frame_gives_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..200), ether in 0..3_usize) {
            let mut frame = vec![2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2];
            frame.extend([[0x88, 0x92], [0x08, 0x00], [0x81, 0x00]][ether]);
            frame.extend(&bytes);
            let mut walker = Walker::default();
            walker.frame(Duration::ZERO, &frame);
            walker.frame(Duration::ZERO, &bytes);
        }

        #[test]
        fn any_rpc_packet_gives_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..300), operation in 0..7_u8) {
            let mut walker = Walker::default();
            walker.frame(Duration::ZERO, &udp::tests::rpc_frame(operation, &bytes));
        }
    }
}
