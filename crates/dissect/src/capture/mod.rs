//! Reads the frames of a capture in order and reports what happened: discovery, connects, parameter jobs, state changes,
//! alarms, errors, and what is missing. Decoding is done by `profinet::wire` and `profile::parameter`; here are only
//! the words, the numbers, and what belongs together.
//!
//! A capture may be damaged, cut or hostile: whatever does not decode is counted and reported, memory is bounded.

mod alarms;
mod arp;
mod assembly;
mod calls;
mod channel;
mod connect;
pub(crate) mod contents;
mod cyclic;
mod dcp;
mod diagnosis;
mod diff;
mod drive_data;
mod drives;
pub mod event;
mod jobs;
mod names;
mod neighbours;
mod pending;
mod records;
mod services;
mod summary;
#[cfg(test)]
mod tests;
mod timing;
mod tree;
mod udp;
mod view;

use std::collections::HashMap;
use std::time::Duration;

use profile::model::Model;
use profinet::MacAddress;
use profinet::wire::DecodeError;
use profinet::wire::ethernet::{Frame, FrameKind};
use profinet::wire::lldp;
use serde::Serialize;

use crate::Weight;
use crate::tree::Node;
use alarms::Alarms;
use arp::Arp;
use calls::Calls;
use cyclic::{Belongs, CyclicArs};
use dcp::Services;
use drives::Drives;
use event::{Detail, Sink, Trouble};
use names::Names;
use neighbours::Neighbours;

pub use drive_data::DriveWords;
pub use event::{Event, Party};
pub use names::seconds;
pub use records::name as record_name;
pub use summary::{DeviceSummary, StreamSummary};
pub use view::{Selection, Summary, View};

/// What was seen, in numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// Most stations whose alarms and faults are counted.
const MAX_STATIONS: usize = 4096;

/// Reads frames in order and reports what they mean.
#[derive(Debug, Default)]
pub struct Walker {
    names: Names,
    services: Services,
    calls: Calls,
    ars: CyclicArs,
    alarms: Alarms,
    neighbours: Neighbours,
    arp: Arp,
    counts: Counts,
    /// Alarms and faults of each station.
    incidents: HashMap<MacAddress, Incidents>,
    now: Duration,
}

/// What a station reported that is wrong.
#[derive(Debug, Clone, Copy, Default)]
struct Incidents {
    alarms: u32,
    faults: u32,
}

impl Walker {
    /// Drives whose identity is not in the capture are decoded as this model; without one as an AKD.
    pub fn new(model: Option<Model>) -> Self {
        let mut walker = Self::default();
        walker.names.drives = Drives::new(model);
        walker
    }

    /// Returns the statistics so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Looks at one Ethernet frame, `at` after the first one.
    pub fn frame(&mut self, at: Duration, bytes: &[u8]) -> Vec<Event> {
        let mut events = Vec::new();
        self.counts.frames += 1;
        // a clock that was put back does not give time for answers again
        self.now = self.now.max(at);
        let mut sink = Sink {
            frame: self.counts.frames,
            at,
            source: Party::default(),
            target: Party::default(),
            events: &mut events,
        };
        self.give_up(self.now, &mut sink);
        self.ars.look(&mut sink);
        if let Err((protocol, error)) = self.dispatch(bytes, &mut sink) {
            self.counts.malformed += 1;
            let trouble = Trouble::Malformed { offset: error.offset };
            let text = format!("{protocol}{error}");
            sink.report(Weight::Error, "malformed", text, Detail::Trouble(trouble));
        }
        self.finish(&mut events);
        events
    }

    /// Goes on at this time after the first frame, without the frames before it, which the computer that captured was too slow for: a
    /// cyclic frame among them is not reported as lost, nor a connection as silent.
    pub fn skip_to(&mut self, at: Duration) {
        self.ars.skip_to(at);
    }

    /// Returns a frame as a tree of its fields. Names of parameters, telegrams and the layout of cyclic data are those that
    /// the frames so far showed: to have the names in a response, look at its frame last.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use profidrive_dissect::capture::Walker;
    ///
    /// let mut walker = Walker::new(None);
    /// // Get of the name of station
    /// let mut frame = [[0x02; 12].as_slice(), &[0x88, 0x92, 0xFE, 0xFD, 3, 0, 0, 0, 0, 7, 0, 0, 0, 2, 2, 2]].concat();
    /// walker.frame(Duration::ZERO, &frame);
    /// let path = walker.tree(&frame);
    /// let path = path.path(26);
    /// let names: Vec<&str> = path.iter().map(|node| node.name.as_str()).collect();
    /// assert_eq!(names, ["frame", "DCP blocks", "DCP requested option", "2/2 name of station"]);
    /// ```
    #[must_use]
    pub fn tree(&self, frame: &[u8]) -> Node {
        tree::of(self, frame)
    }

    /// Ends the capture: reports what is still without an answer.
    pub fn end(&mut self) -> Vec<Event> {
        let mut events = Vec::new();
        let mut sink = Sink {
            frame: self.counts.frames,
            at: self.now,
            source: Party::default(),
            target: Party::default(),
            events: &mut events,
        };
        self.give_up(Duration::MAX, &mut sink);
        self.ars.end(&mut sink);
        self.finish(&mut events);
        events
    }

    /// Forgets the times that were measured: the summary is about what follows.
    pub fn restart_summary(&mut self) {
        self.ars.restart();
        self.incidents.clear();
    }

    /// Returns true when an event is from or to the station with this name or address, or about it.
    pub fn is_about(&self, event: &Event, station: &str) -> bool {
        let named = match &event.detail {
            Detail::Dcp(dcp) => dcp.name.as_deref() == Some(station),
            Detail::Trouble(Trouble::DuplicateName { name, .. }) => name == station,
            Detail::Trouble(Trouble::DuplicateAddress { ip, .. }) => ip.to_string() == station,
            _ => false,
        };
        named || self.names.is(event.source, station) || self.names.is(event.target, station)
    }

    /// Returns the devices with cyclic connections, and how regular their frames are.
    pub fn summary(&self) -> Vec<DeviceSummary> {
        summary::devices(self)
    }

    /// Returns the words of the drive with this address, as its cyclic frames had them last. `None` while it has no cyclic
    /// connection whose connect was seen.
    pub fn words(&self, device: MacAddress) -> Option<DriveWords> {
        self.ars.words(device, &self.names.drives)
    }

    /// Returns how far the cyclic frames to (`output`) or from a device were from their cycle: in steps that double, each
    /// with the deviation that it does not reach and how many frames are in it.
    pub fn deviations(&self, device: MacAddress, output: bool) -> Vec<(Duration, u64)> {
        let mut tracks = self.ars.tracks().map(|(_, track)| track);
        let track = tracks.find(|track| track.device == device && track.output == Some(output));
        track.map_or_else(Vec::new, |track| track.timing.deviations())
    }

    fn give_up(&mut self, now: Duration, sink: &mut Sink<'_>) {
        self.services.give_up(now, sink);
        self.calls.give_up(now, sink);
        self.alarms.give_up(now, sink);
    }

    /// Names the parties of new events and counts what is wrong with a station.
    fn finish(&mut self, events: &mut [Event]) {
        for event in events {
            event.from = self.names.label(event.source);
            event.to = self.names.label(event.target);
            let Some(mac) = event.source.mac else { continue };
            let (alarm, fault) = match &event.detail {
                Detail::Alarm(alarm) => (alarm.step == "notification", false),
                Detail::Fault(_) => (false, true),
                _ => continue,
            };
            if self.incidents.len() < MAX_STATIONS || self.incidents.contains_key(&mac) {
                let incidents = self.incidents.entry(mac).or_default();
                incidents.alarms += u32::from(alarm);
                incidents.faults += u32::from(fault);
            }
        }
    }

    /// Decodes one frame. An error comes with the name of the protocol.
    fn dispatch(&mut self, bytes: &[u8], sink: &mut Sink<'_>) -> Result<(), (&'static str, DecodeError)> {
        if let Some(frame) = Frame::parse(bytes) {
            sink.source.mac = Some(frame.source);
            sink.target.mac = Some(frame.destination).filter(|mac| !mac.is_multicast());
            return self.profinet(&frame, sink);
        }
        if let Some((source, payload)) = lldp::payload(bytes) {
            sink.source.mac = Some(source);
            let Self {
                neighbours, names, ..
            } = self;
            return neighbours
                .pdu(source, payload, names, sink)
                .map_err(|error| ("LLDP: ", error));
        }
        if let Some(arp) = arp::frame(bytes) {
            sink.source.mac = Some(arp.source);
            self.arp.frame(&arp, &mut self.names, sink);
        } else if let Some(datagram) = udp::datagram(bytes) {
            let (source, target) = datagram.macs;
            sink.source = Party {
                mac: Some(source),
                ip: Some(*datagram.source.ip()),
            };
            sink.target = Party {
                mac: Some(target),
                ip: Some(*datagram.destination.ip()),
            };
            let before = self.calls.seen();
            let result = self
                .calls
                .datagram(&datagram, &mut self.ars, &mut self.names, sink);
            self.counts.rpc += self.calls.seen() - before;
            return result.map_err(|error| ("", error));
        }
        Ok(())
    }

    fn profinet(
        &mut self,
        frame: &Frame<'_>,
        sink: &mut Sink<'_>,
    ) -> Result<(), (&'static str, DecodeError)> {
        match frame.frame_id.kind() {
            FrameKind::DcpHello
            | FrameKind::DcpGetSet
            | FrameKind::DcpIdentifyRequest
            | FrameKind::DcpIdentifyResponse => {
                self.counts.dcp += 1;
                self.services
                    .pdu(frame, &mut self.names, sink)
                    .map_err(|error| ("DCP: ", error))
            }
            _ if frame.frame_id.is_cyclic() => {
                match self.ars.cyclic(frame, &mut self.names, sink) {
                    Some(Belongs::Known) => self.counts.cyclic += 1,
                    Some(Belongs::Earlier) | None => self.counts.cyclic_unknown += 1,
                }
                Ok(())
            }
            FrameKind::AlarmHigh | FrameKind::AlarmLow => {
                self.counts.alarms += 1;
                self.alarms.pdu(frame, sink).map_err(|error| ("alarm: ", error))?;
                let ends =
                    |event: &&Event| matches!(&event.detail, Detail::Alarm(alarm) if alarm.step == "abort");
                if let Some(event) = sink.events.last().filter(ends) {
                    let lost = event.weight == Weight::Error;
                    self.ars.aborted(frame.source, frame.destination, lost);
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }
}
