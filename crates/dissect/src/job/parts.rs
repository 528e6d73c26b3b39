//! The parts of a parameter job or of cyclic data, each with its octets.

use std::ops::Range;

use profile::parameter::{Attribute, ParameterAddress, Request, RequestId, ValueBlock};
use serde_json::Map;

use super::response::{answer, blocks};
use super::{ADDRESS, HEADER, JobDrive, Side, block_text, format_name, label, verb};
use crate::{Weight, hex_bytes};

/// A part of cyclic data or of a parameter job in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Name of the signal or of the word.
    pub name: String,
    /// Its octets in the data.
    pub octets: Range<usize>,
    /// Its value and what it means.
    pub text: String,
    /// How much it matters.
    pub weight: Weight,
    /// The text does not contain the octets.
    pub(super) is_value: bool,
}

impl Part {
    /// Returns the part with another weight.
    pub(crate) fn weighing(self, weight: Weight) -> Self {
        Self { weight, ..self }
    }

    pub(crate) fn new(name: &str, octets: Range<usize>, text: String) -> Self {
        Self {
            name: name.to_owned(),
            octets,
            text,
            weight: Weight::Normal,
            is_value: false,
        }
    }

    pub(super) fn value(name: &str, octets: Range<usize>, text: String) -> Self {
        Self {
            is_value: true,
            ..Self::new(name, octets, text)
        }
    }

    pub(super) fn line(&self, data: &[u8]) -> String {
        let Self { name, text, .. } = self;
        let line = format!("  {name:<8} {text}");
        if self.is_value {
            let octets = data.get(self.octets.clone()).unwrap_or_default();
            return format!("{line}   [{}]", hex_bytes(octets));
        }
        line
    }
}

/// Returns the parts of a parameter job; `request` is what a response answers. Nothing behind what is malformed.
pub fn parts(drive: &JobDrive, data: &[u8], side: Side, request: Option<&[u8]>) -> Vec<Part> {
    let &[reference, id, axis, count, ..] = data else {
        return Vec::new();
    };
    let octet = |at: usize, name: &str, text: String| Part::new(name, at..at + 1, text);
    let kind = match side {
        Side::Request => verb(RequestId::from_octet(id)).to_owned(),
        Side::Response => format!("0x{id:02X}"),
    };
    let mut parts = vec![
        octet(0, "reference", reference.to_string()),
        octet(
            1,
            if side == Side::Request {
                "RequestID"
            } else {
                "ResponseID"
            },
            kind,
        ),
        octet(2, "axis", axis.to_string()),
        octet(3, "number of parameters", count.to_string()),
    ];
    let job = |data| Request::parse(data, drive.code_space()).ok();
    match side {
        Side::Request => {
            let Some(job) = job(data) else { return parts };
            addresses(drive, job.addresses(), &mut parts);
            if job.id().is_change() {
                for (address, block) in job.addresses().zip(job.values()) {
                    let Ok(block) = block else { break };
                    let (of, is) = (label(drive, address), block_text(drive, Some(address), &block));
                    let part = Part::new("value", 0..0, format!("{of} = {is}"));
                    value(drive, data, &block, part, &mut parts);
                }
            }
        }
        Side::Response => {
            let asked = request.and_then(job);
            let mut named: Vec<Option<ParameterAddress>> =
                asked.iter().flat_map(Request::addresses).map(Some).collect();
            named.resize(count.into(), None);
            let Ok((blocks, _)) = blocks(drive, data, &mut named) else {
                return parts;
            };
            let first = blocks.first().and_then(|block| place(data, block));
            if first.is_some_and(|place| place.start > HEADER) {
                addresses(drive, named.iter().flatten().copied(), &mut parts);
            }
            let is_change = RequestId::from_octet(id & 0x7F).is_change();
            for (address, block) in named.iter().zip(&blocks) {
                let (weight, text) = answer(drive, *address, block, is_change, &mut Map::new());
                let part = Part::new("value", 0..0, text.trim().to_owned()).weighing(weight);
                value(drive, data, block, part, &mut parts);
            }
        }
    }
    parts
}

fn addresses(drive: &JobDrive, addresses: impl Iterator<Item = ParameterAddress>, parts: &mut Vec<Part>) {
    for (nth, address) in addresses.enumerate() {
        let start = HEADER + nth * ADDRESS;
        parts.push(Part::new(
            "parameter",
            start..start + ADDRESS,
            label(drive, address),
        ));
        let attribute = match address.attribute {
            Attribute::Value => "value".to_owned(),
            Attribute::Description => "description".to_owned(),
            Attribute::Text => "text".to_owned(),
            Attribute::Other(code) => format!("0x{code:02X}"),
        };
        parts.push(Part::new("attribute", start..start + 1, attribute));
        let elements = address.elements.to_string();
        parts.push(Part::new("number of elements", start + 1..start + 2, elements));
        parts.push(Part::new("PNU", start + 2..start + 4, address.pnu.to_string()));
        parts.push(Part::new(
            "subindex",
            start + 4..start + 6,
            address.subindex.to_string(),
        ));
    }
}

/// A value block: the whole as `part`, then format, number of values and values.
fn value(drive: &JobDrive, data: &[u8], block: &ValueBlock<'_>, part: Part, parts: &mut Vec<Part>) {
    let Some(octets) = place(data, block) else { return };
    let start = octets.start;
    let format = Part::new("format", start..start + 1, format_name(drive, block.format));
    let count = Part::new("number of values", start + 1..start + 2, block.count.to_string());
    let values = Part::new("octets", start + 2..octets.end, hex_bytes(block.data));
    parts.push(Part { octets, ..part });
    parts.extend([format, count, values]);
}

/// Returns the octets of a value block in the job it was taken from.
fn place(data: &[u8], block: &ValueBlock<'_>) -> Option<Range<usize>> {
    let start = block.data.as_ptr().addr().checked_sub(data.as_ptr().addr())?;
    Some(start.checked_sub(2)?..start + block.data.len())
}
