//! The devices of a capture and how regular their cyclic frames were.

use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::MacAddress;
use serde::Serialize;

use super::cyclic::Track;
use super::{Party, Walker};

/// A device with cyclic connections.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DeviceSummary {
    /// Name or address.
    pub device: String,
    /// Ethernet address.
    #[serde(serialize_with = "text")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub mac: MacAddress,
    /// IP address, where the capture shows it.
    pub ip: Option<Ipv4Addr>,
    /// Connections after the first one.
    pub restarts: u32,
    /// Times that its connection was silent for longer than the watchdog, or ended by an error PDU.
    pub connection_losses: u32,
    /// Alarms.
    pub alarms: u32,
    /// Faults that its status words report.
    pub faults: u32,
    /// Its cyclic frames, each direction.
    pub streams: Vec<StreamSummary>,
}

impl DeviceSummary {
    /// Returns true for the device with this name or address, and for one that it exchanges data with.
    pub fn is(&self, wanted: &str) -> bool {
        let ends = |stream: &StreamSummary| stream.from == wanted || stream.to == wanted;
        self.device == wanted
            || self.mac.to_string().eq_ignore_ascii_case(wanted)
            || self.ip.is_some_and(|ip| ip.to_string() == wanted)
            || self.streams.iter().any(ends)
    }
}

/// The cyclic frames of one direction. Times are in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StreamSummary {
    /// Name or address of the sender.
    pub from: String,
    /// Name or address of the receiver.
    pub to: String,
    /// `input`, `output`, or `unknown` where no connect is in the capture.
    pub direction: &'static str,
    /// Frames.
    pub frames: u64,
    /// Time between two frames as agreed, or as the cycle counter shows.
    #[serde(serialize_with = "seconds")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub cycle: Duration,
    /// Deviation from the cycle that half of the frames do not exceed.
    #[serde(serialize_with = "option_seconds")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub jitter_p50: Option<Duration>,
    /// Deviation from the cycle that 99 % of the frames do not exceed.
    #[serde(serialize_with = "option_seconds")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub jitter_p99: Option<Duration>,
    /// Frames missing by the cycle counter.
    pub lost: u64,
    /// Frames received twice, or out of order.
    pub repeated: u64,
    /// Longest time between two frames of one connection.
    #[serde(serialize_with = "seconds")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub longest_gap: Duration,
}

fn text<S: serde::Serializer>(mac: &MacAddress, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(mac)
}

fn seconds<S: serde::Serializer>(time: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(time.as_secs_f64())
}

fn option_seconds<S: serde::Serializer>(time: &Option<Duration>, serializer: S) -> Result<S::Ok, S::Error> {
    time.map(|time| time.as_secs_f64()).serialize(serializer)
}

/// One row for each device that sends or receives cyclic frames.
pub(super) fn devices(walker: &Walker) -> Vec<DeviceSummary> {
    let label = |mac| {
        walker.names.label(Party {
            mac: Some(mac),
            ip: None,
        })
    };
    let mut rows: Vec<DeviceSummary> = Vec::new();
    for (&(sender, receiver, _), track) in walker.ars.tracks() {
        let mac = track.device;
        let at = rows.iter().position(|row| row.mac == mac).unwrap_or_else(|| {
            let device = walker.ars.device(mac);
            let incidents = walker.incidents.get(&mac).copied().unwrap_or_default();
            rows.push(DeviceSummary {
                device: label(mac),
                mac,
                ip: walker.names.ip_of(mac),
                restarts: device.restarts(),
                connection_losses: device.losses,
                alarms: incidents.alarms,
                faults: incidents.faults,
                streams: Vec::new(),
            });
            rows.len() - 1
        });
        if let Some(row) = rows.get_mut(at) {
            row.streams.push(stream(track, label(sender), label(receiver)));
        }
    }
    rows.sort_by(|a, b| a.device.cmp(&b.device));
    rows
}

fn stream(track: &Track, from: String, to: String) -> StreamSummary {
    let timing = &track.timing;
    StreamSummary {
        from,
        to,
        direction: match track.output {
            Some(true) => "output",
            Some(false) => "input",
            None => "unknown",
        },
        frames: timing.frames,
        cycle: timing.cycle,
        jitter_p50: timing.jitter(50),
        jitter_p99: timing.jitter(99),
        lost: timing.lost,
        repeated: timing.repeated,
        longest_gap: timing.longest_gap,
    }
}
