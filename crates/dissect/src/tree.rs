//! A frame as a tree of nodes: name, value, octets, weight.

use std::ops::Range;

use profinet::MacAddress;
use profinet::wire::alarm::AlarmType;
use profinet::wire::block::BlockType;
use profinet::wire::ethernet::FrameId;
use profinet::wire::rt::DataStatus;
use profinet::wire::{Field, PnioStatus, Uuid};
use serde::Serialize;

use crate::{Weight, hex_bytes};

/// Most octets of a field without a form of its own that are shown.
const SHOWN: usize = 32;

/// A part of a frame.
///
/// The octets of a node contain those of its children. What no child covers is padding, or has no meaning here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "FrameNode")
)]
pub struct Node {
    /// Name of the field, of the block, or of the signal.
    pub name: String,
    /// Its value in words; empty where the children give it.
    pub value: String,
    /// First octet, from the start of the frame.
    pub start: usize,
    /// Octet behind the last one.
    pub end: usize,
    /// How much it matters: that of the gravest child at least.
    pub weight: Weight,
    /// Its parts, in the order of their octets.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Node>,
}

impl Node {
    /// Returns a node without children.
    #[must_use]
    pub fn new(name: impl Into<String>, octets: Range<usize>, value: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
            start: octets.start,
            end: octets.end,
            weight: Weight::Normal,
            children: Vec::new(),
        }
    }

    /// Returns its octets.
    #[must_use]
    pub const fn octets(&self) -> Range<usize> {
        self.start..self.end
    }

    /// Returns the nodes that an octet belongs to, the whole frame first.
    #[must_use]
    pub fn path(&self, octet: usize) -> Vec<&Self> {
        let mut path = Vec::new();
        let mut next = Some(self).filter(|node| node.octets().contains(&octet));
        while let Some(node) = next {
            path.push(node);
            next = node.children.iter().find(|child| child.octets().contains(&octet));
        }
        path
    }

    /// Puts nodes into this one, each into the smallest that contains its octets.
    #[must_use]
    pub fn with(mut self, mut nodes: Vec<Self>) -> Self {
        // of the same octets the first is the outer one
        nodes.sort_by_key(|node| (node.start, std::cmp::Reverse(node.end)));
        nodes.dedup_by(|next, node| {
            let same = (&next.name, next.octets()) == (&node.name, node.octets());
            if same && node.value.is_empty() {
                node.value = std::mem::take(&mut next.value);
            }
            same
        });
        let mut open: Vec<Self> = Vec::new();
        for node in nodes {
            while open.last().is_some_and(|outer| outer.end < node.end) {
                self.close(&mut open);
            }
            open.push(node);
        }
        while !open.is_empty() {
            self.close(&mut open);
        }
        self
    }

    /// Gives leaves without a value their octets.
    pub(crate) fn show_octets(&mut self, frame: &[u8]) {
        if self.children.is_empty() && self.value.is_empty() {
            self.value = plain(&self.name, frame.get(self.octets()).unwrap_or_default());
        }
        for child in &mut self.children {
            child.show_octets(frame);
        }
    }

    /// The last open node is complete: it is a child of the one before.
    fn close(&mut self, open: &mut Vec<Self>) {
        if let Some(node) = open.pop() {
            let outer = open.last_mut().unwrap_or(self);
            outer.weight = outer.weight.max(node.weight);
            outer.children.push(node);
        }
    }
}

/// Returns a field that a decoder read as a node; `frame` is the frame that it is in.
pub fn field(field: &Field, frame: &[u8]) -> Node {
    let octets = frame.get(field.octets.clone()).unwrap_or_default();
    let mut node = Node::new(field.what, field.octets.clone(), value(field, octets));
    if let Some(problem) = &field.problem {
        node.value = problem.to_string();
        node.weight = Weight::Error;
    }
    node
}

fn value(field: &Field, octets: &[u8]) -> String {
    let Some(number) = field.number else {
        return String::new();
    };
    let word = u16::try_from(number).unwrap_or_default();
    let meaning = match (field.what, octets.len()) {
        (_, 16) => return Uuid(number.to_be_bytes()).to_string(),
        ("BlockType", _) => BlockType(word).to_string(),
        ("FrameID", _) => FrameId(word).to_string(),
        ("AlarmType", _) => AlarmType(word).to_string(),
        ("Index", _) => crate::capture::record_name(word),
        ("DataStatus", _) => DataStatus(number.to_le_bytes()[0]).to_string(),
        ("PNIOStatus", _) => PnioStatus::from_u32(u32::try_from(number).unwrap_or_default()).to_string(),
        _ => String::new(),
    };
    let digits = 2 * octets.len();
    if meaning.is_empty() {
        format!("{number} (0x{number:0digits$X})")
    } else {
        meaning
    }
}

/// Octets that were not read as a number.
fn plain(what: &str, octets: &[u8]) -> String {
    let is_station = ["destination", "source", "sender", "target"].contains(&what);
    if let Ok(mac) = <[u8; 6]>::try_from(octets)
        && (is_station || what.to_ascii_lowercase().contains("mac"))
    {
        return MacAddress(mac).to_string();
    }
    if let Ok(ip) = <[u8; 4]>::try_from(octets)
        && (what.contains("address") || what.contains("gateway") || what.contains("mask"))
    {
        return std::net::Ipv4Addr::from(ip).to_string();
    }
    let text = octets.trim_ascii_end();
    if text.len() > 1 && text.iter().all(|octet| matches!(octet, b' '..=b'~')) {
        return format!("\"{}\"", String::from_utf8_lossy(text));
    }
    match octets.split_at_checked(SHOWN) {
        Some((shown, rest)) if !rest.is_empty() => {
            format!("{} .. ({} octets)", hex_bytes(shown), octets.len())
        }
        _ => hex_bytes(octets),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octets_are_shown_as_what_their_name_is() {
        for (what, octets, shown) in [
            ("name of station", &b"akd-10"[..], "\"akd-10\""),
            ("chassis MAC", &b"akd-10"[..], "61:6b:64:2d:31:30"),
            ("destination", &[2, 0, 0, 0, 0, 1], "02:00:00:00:00:01"),
            ("value", &[2, 0, 0, 0, 0, 1], "02 00 00 00 00 01"),
            ("source address", &[10, 0, 0, 1], "10.0.0.1"),
            ("IOCS", &[0x80], "80"),
        ] {
            assert_eq!(plain(what, octets), shown, "{what}");
        }
    }

    #[test]
    fn each_node_is_in_the_smallest_that_contains_it() {
        let node = |name: &str, octets| Node::new(name, octets, "");
        // as decoders note them: a block behind its fields, a field that was read twice
        let tree = node("frame", 0..20).with(vec![
            node("header", 0..4),
            node("type", 0..2),
            node("length", 6..8),
            Node {
                weight: Weight::Error,
                ..node("value", 8..12)
            },
            node("block", 6..12),
            node("length", 6..8),
            node("behind", 12..20),
        ]);
        let names =
            |node: &Node| -> Vec<String> { node.children.iter().map(|child| child.name.clone()).collect() };
        assert_eq!(names(&tree), ["header", "block", "behind"]);
        assert_eq!(names(&tree.children[1]), ["length", "value"]);
        let path: Vec<&str> = tree.path(9).iter().map(|node| node.name.as_str()).collect();
        assert_eq!(path, ["frame", "block", "value"]);
        assert_eq!(
            (tree.weight, tree.children[0].weight),
            (Weight::Error, Weight::Normal)
        );
        assert_eq!(tree.path(20), Vec::<&Node>::new());
    }
}
