//! The report of decoding.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::capture::{Counts, DeviceSummary, Event};
use crate::tree::Node;

/// What decoding reports: the events of a capture, its devices and the end; or what octets contain.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum DecodeReport<'a> {
    /// Something that happened.
    Event(&'a Event),
    /// A device with cyclic connections.
    Device {
        /// `summary`.
        kind: &'static str,
        /// The device.
        data: &'a DeviceSummary,
    },
    /// The capture has ended; nothing follows.
    End {
        /// `end`.
        kind: &'static str,
        /// True.
        end: bool,
        /// What was seen.
        #[serde(flatten)]
        counts: Counts,
        /// Why the capture was not read to its end.
        damage: Option<&'a str>,
    },
    /// One frame with all its fields.
    Frame {
        /// `frame`.
        kind: &'static str,
        /// What happened in it.
        events: &'a [Event],
        /// Its fields.
        tree: &'a Node,
    },
    /// What octets contain: a parameter job, a telegram or a parameter channel, each with fields of its own.
    Octets(&'a Map<String, Value>),
}
