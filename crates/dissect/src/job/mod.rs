//! Parameter jobs as text: contents of requests and responses.

mod description;
mod drive;
mod explain;
mod parts;
pub mod pkw;
mod response;
pub mod serial;
pub mod telegram;

use std::fmt;

use profile::catalogue::WordKind;
use profile::parameter::{
    Attribute, CodeSpace, Description, ErrorNumber, Forbidden, Format, Objection, ParameterAddress, Request,
    RequestId, ValueBlock,
};
use profile::value::Reading;
use serde_json::{Map, Value};

use crate::Weight;
use crate::fields;
use crate::{hex_bytes, value, words};

use response::decode_response;

pub use drive::JobDrive;
pub use explain::{explain_error, explain_format};
pub use parts::{Part, parts};

/// Octets in front of the addresses or blocks.
const HEADER: usize = 4;
/// Octets of an address.
const ADDRESS: usize = 6;

/// Direction of a parameter job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// From the controller to the drive.
    Request,
    /// From the drive to the controller.
    Response,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Request => "request",
            Self::Response => "response",
        })
    }
}

/// Octets that are not a valid parameter job in this direction.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not a valid parameter {side}: {reason}")]
pub struct NoJob {
    /// What they were taken for.
    pub side: Side,
    /// Why they are none.
    pub reason: String,
}

/// A job in words and for programs.
#[derive(Debug)]
pub struct Decoded {
    /// In words; the first line says what it is.
    pub lines: Vec<(Weight, String)>,
    /// For programs.
    pub fields: Map<String, Value>,
    /// What an answer refuses, by its place in the lines.
    pub refused: Vec<(usize, RefusedParameter)>,
}

/// A parameter that a drive refuses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RefusedParameter {
    /// Number of the parameter.
    pub pnu: u16,
    /// Error number of the answer.
    pub error: ErrorNumber,
}

/// Decodes one job; guesses its direction when `side` is not given.
///
/// # Errors
/// When the octets are not a valid job.
pub fn decode(
    drive: &mut JobDrive,
    data: &[u8],
    side: Option<Side>,
    request: Option<&[u8]>,
) -> Result<Decoded, NoJob> {
    let side = side.unwrap_or_else(|| {
        if request.is_some() {
            Side::Response
        } else {
            guess(data, drive)
        }
    });
    match side {
        Side::Request => decode_request(drive, data),
        Side::Response => decode_response(drive, data, request),
    }
    .map_err(|reason| NoJob { side, reason })
}

/// Request or response? A response carries no addresses unless the drive can repeat them, a read request nothing else.
fn guess(data: &[u8], drive: &JobDrive) -> Side {
    let space = drive.code_space();
    let repeats = drive.dialect().repeats_addresses;
    let id = data.get(1).copied().unwrap_or(0);
    let addresses = HEADER + ADDRESS * usize::from(data.get(3).copied().unwrap_or(0));
    match id {
        // an attribute in the place of the first format code, unless values follow: a drive that repeats the address
        1 if has_attribute(data)
            && Request::parse(data, space).is_ok_and(|job| !repeats || has_no_values(&job)) =>
        {
            Side::Request
        }
        // what would be its first format code is none
        1 if !looks_like_values(data, space) && (data.len() <= addresses || !has_attribute(data)) => {
            Side::Request
        }
        // the head alone, padded or not: a change that was carried out
        2 if matches!(data.get(HEADER..), Some([] | [0, 0])) => Side::Response,
        2 if data.len() > HEADER + 2 && Request::parse(data, space).is_ok_and(|job| values_fit(&job)) => {
            Side::Request
        }
        // too short for its addresses and no value block: a request that was cut off
        2 if data.len() < addresses && !looks_like_values(data, space) => Side::Request,
        // values behind an address, cut off: an answer to a change has none where all of it was written
        2 if data.len() >= addresses && has_attribute(data) => Side::Request,
        3..0x80 => Side::Request,
        _ => Side::Response,
    }
}

/// Returns true where a response has its first format code, and an attribute is none of them.
fn looks_like_values(data: &[u8], space: CodeSpace) -> bool {
    let is_format = |code: u8| Format(code).data_len(space, 1, 1).is_some();
    let first = data.get(HEADER).filter(|_| !has_attribute(data));
    first.is_some_and(|code| *code != Format::ZERO.0 && is_format(*code))
}

/// Returns true where a request would have the attribute of its first address.
fn has_attribute(data: &[u8]) -> bool {
    matches!(data.get(HEADER), Some(0x10 | 0x20 | 0x30))
}

/// Returns true where only a buffer's zeros follow the addresses, or what is not a value.
fn has_no_values(job: &Request<'_>) -> bool {
    job.trailing() == 0 || !values_fit(job)
}

fn values_fit(job: &Request<'_>) -> bool {
    job.values().all(|block| block.is_ok())
}

fn label(drive: &JobDrive, address: ParameterAddress) -> String {
    let text = drive.label(address);
    match address.attribute {
        Attribute::Value => text,
        Attribute::Description => {
            let element = description::element(address.subindex);
            format!("{element} of {}", drive.whole_label(address.pnu))
        }
        Attribute::Text => format!("texts of {text}"),
        Attribute::Other(code) => format!("attribute 0x{code:02X} of {text}"),
    }
}

fn address_json(drive: &JobDrive, address: ParameterAddress) -> Map<String, Value> {
    let name = drive.select(address).parameter.map(|parameter| parameter.name);
    let whole = drive.tables().and_then(|tables| tables.by_high(address.pnu));
    let mut fields = fields! {
        "pnu": address.pnu, "index": address.subindex, "elements": address.elements,
        "attribute": address.attribute.octet(), "name": name,
    };
    if let Some(whole) = whole {
        fields.insert("high_half_of".into(), whole.name.into());
    }
    fields
}

fn format_name(drive: &JobDrive, format: Format) -> String {
    format
        .info(drive.code_space())
        .map_or_else(|| format!("format 0x{:02X}", format.0), |row| row.name.to_owned())
}

fn block_text(drive: &JobDrive, address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> String {
    if address.is_some_and(|address| address.attribute == Attribute::Description)
        && let Some(description) = Description::decode(block.data)
    {
        return description::words(&description, drive.code_space());
    }
    if address.is_some_and(|address| address.attribute == Attribute::Text)
        && let Some(texts) = description::texts(block.data)
    {
        return texts;
    }
    let readings = drive.readings(address, block);
    let assumed = address.and_then(|address| drive.assumption(address));
    if let ([one], Some(assumed)) = (readings.as_slice(), &assumed) {
        let raw = one.raw().map_or_else(String::new, |raw| format!("raw {raw}, "));
        return format!("{raw}{} if {assumed}", value::full(one));
    }
    let texts: Vec<String> = match readings.as_slice() {
        [one] => vec![format!("{} {}", value::full(one), state(drive, one))],
        many => many.iter().map(value::value).collect(),
    };
    let unit = readings
        .first()
        .filter(|_| readings.len() > 1)
        .map_or("", |reading| reading.unit);
    let condition = assumed.map_or_else(String::new, |assumed| format!(" if {assumed}"));
    format!("{} {unit}", texts.join(", ")).trim_end().to_owned() + &condition
}

/// Returns the meaning of a control or status word as a whole.
fn state(drive: &JobDrive, reading: &Reading) -> String {
    let kind = drive
        .tables()
        .and_then(|tables| tables.word(reading.pnu))
        .map(|word| word.kind);
    // not for a model whose control and status words are unknown
    let raw = reading.raw().filter(|_| reading.word.is_some());
    let word = raw.and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
    match (kind, word) {
        (Some(WordKind::Control), Some(word)) => words::stw1_meaning_in(drive.mode(), word).to_owned(),
        (Some(WordKind::Status), Some(word)) => words::state(word, None),
        _ => String::new(),
    }
}

fn block_json(
    drive: &JobDrive,
    address: Option<ParameterAddress>,
    block: &ValueBlock<'_>,
) -> Map<String, Value> {
    let assumed = address.and_then(|address| drive.assumption(address));
    let mut values: Vec<Value> = drive
        .readings(address, block)
        .iter()
        .map(|reading| {
            let mut value = value::json(reading);
            if let (Value::Object(fields), Some(assumed)) = (&mut value, &assumed) {
                fields.insert("assumed".into(), assumed.as_str().into());
            }
            value
        })
        .collect();
    if address.is_some_and(|address| address.attribute != Attribute::Value) {
        for value in &mut values {
            value["writable"] = false.into();
        }
    }
    let mut fields = fields! {
        "format": block.format.0, "format_name": format_name(drive, block.format), "count": block.count,
        "hex": hex_bytes(block.data), "values": values,
    };
    if let Some(assumed) = assumed {
        fields.insert("assumed".into(), assumed.into());
    }
    fields
}

fn raw_text(drive: &JobDrive, block: &ValueBlock<'_>) -> String {
    const SHOWN: usize = 16;
    let (start, more) = block
        .data
        .split_at_checked(SHOWN)
        .map_or((block.data, ""), |(start, rest)| {
            (start, if rest.is_empty() { "" } else { " .." })
        });
    format!("{} {}{more}", format_name(drive, block.format), hex_bytes(start))
}

const fn verb(id: RequestId) -> &'static str {
    match id {
        RequestId::Read => "read request",
        RequestId::Change => "change request",
        RequestId::ChangePermanent => "change request (kept)",
        RequestId::ReadWide => "read request (double words)",
        RequestId::ChangeWide => "change request (double words)",
        RequestId::Other(_) => "request of an unknown kind",
    }
}

/// Returns a request with what is in it, also where it ends too early: a drive answers such a request with an error
/// number.
fn decode_request(drive: &JobDrive, data: &[u8]) -> Result<Decoded, String> {
    let parsed = Request::parse(data, drive.code_space());
    let (&[reference, id, axis, count], rest) = data
        .split_first_chunk::<HEADER>()
        .ok_or_else(|| parsed.map_or_else(|error| error.to_string(), |_| String::new()))?;
    let id = RequestId::from_octet(id);
    let head = format!(
        "{} {reference}, axis {axis}, {}",
        verb(id),
        plural(count.into(), "parameter")
    );
    let mut lines = vec![(Weight::Normal, head)];
    let mut parameters = Vec::new();
    let objections = drive.objections(data);
    let name = drive.dialect().name;
    let objected = |place: Option<usize>| {
        let these = objections
            .iter()
            .filter(move |one| one.parameter == place && one.what != Forbidden::Unknown);
        these.map(|one| (Weight::Error, format!("  not allowed ({name}): {one}")))
    };
    lines.extend(objected(None));
    // a refusal by the drive was handled above
    let reserved = reference == 0 && drive.dialect().bad_reference.is_none();
    let warnings: Vec<&str> = reserved
        .then_some("reference 0 is reserved")
        .into_iter()
        .collect();
    lines.extend(
        warnings
            .iter()
            .map(|warning| (Weight::Warning, format!("  ! {warning}"))),
    );
    let mut values = parsed.iter().flat_map(Request::values);
    let (addresses, _) = rest.as_chunks();
    let addresses = addresses.iter().take(count.into());
    for (place, address) in addresses
        .map(|octets| ParameterAddress::from_octets(*octets))
        .enumerate()
    {
        let mut fields = address_json(drive, address);
        let mut text = label(drive, address);
        if id.is_change() {
            match values.next() {
                Some(Ok(block)) => {
                    text = format!(
                        "{text} = {}   [{}]",
                        block_text(drive, Some(address), &block),
                        raw_text(drive, &block)
                    );
                    fields.extend(block_json(drive, Some(address), &block));
                }
                Some(Err(error)) => {
                    text = format!("{text} = (no value: {error})");
                    fields.insert("malformed".into(), error.to_string().into());
                }
                None => text.push_str(" = (no value)"),
            }
        }
        let mut here = objections.iter().filter(|one| one.parameter == Some(place));
        if let Some(unknown) = here.find(|one| one.what == Forbidden::Unknown) {
            text = format!("{text}   ({unknown})");
        }
        lines.push((Weight::Normal, format!("  {text}")));
        lines.extend(objected(Some(place)).map(|(weight, text)| (weight, format!("  {text}"))));
        parameters.push(Value::Object(fields));
    }
    let mut fields = fields! {
        "side": "request", "reference": reference, "id": id.octet(), "axis": axis, "parameters": parameters,
        "warnings": warnings,
    };
    if let Err(error) = parsed {
        lines.push((Weight::Error, format!("  {error}")));
        fields.insert("malformed".into(), error.to_string().into());
    }
    for (name, unknown) in [("not_allowed", false), ("not_in_tables", true)] {
        let mut these = objections
            .iter()
            .filter(|one| (one.what == Forbidden::Unknown) == unknown)
            .peekable();
        if these.peek().is_some() {
            fields.insert(name.into(), these.map(objection_json).collect());
        }
    }
    Ok(Decoded {
        lines,
        fields,
        refused: Vec::new(),
    })
}

fn objection_json(objection: &Objection) -> Value {
    Value::Object(fields! {
        "parameter": objection.parameter, "text": objection.to_string(),
        "error": objection.answer.map(|number| number.0),
    })
}

fn prefix(drive: &JobDrive, address: Option<ParameterAddress>, link: &str) -> String {
    address.map_or_else(String::new, |address| label(drive, address) + link)
}

fn plural(count: usize, what: &str) -> String {
    if count == 1 {
        format!("1 {what}")
    } else {
        format!("{count} {what}s")
    }
}

/// Returns a request in a few words, for the line of a capture.
pub fn request_job(drive: &JobDrive, data: &[u8]) -> Decoded {
    joined(decode_request(drive, data), data)
}

/// Returns a response in a few words, with the request it answers where that is known. What it says of the drive is
/// taken over.
pub fn response_job(drive: &mut JobDrive, data: &[u8], request: Option<&[u8]>) -> Decoded {
    // a request without a header has no answer of its own
    let request = request.filter(|request| request.len() >= HEADER);
    joined(decode_response(drive, data, request), data)
}

/// One parameter on the line of the head, several below it.
fn joined(decoded: Result<Decoded, String>, data: &[u8]) -> Decoded {
    let mut decoded = decoded.unwrap_or_else(|reason| Decoded {
        lines: vec![(
            Weight::Error,
            format!("malformed job ({reason}): {}", hex_bytes(data)),
        )],
        fields: fields! { "malformed": reason, "hex": hex_bytes(data) },
        refused: Vec::new(),
    });
    if let [(_, head), (weight, only)] = decoded.lines.as_slice() {
        decoded.lines = vec![(*weight, format!("{head}: {}", only.trim_start()))];
        decoded.refused.iter_mut().for_each(|(line, _)| *line = 0);
    }
    decoded
}

#[cfg(test)]
mod tests;
