//! PROFIdrive parameter frames of a capture as *we* read them, to be put beside what the dissector reads.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use profile::parameter::{Answer, Dialect, ParameterAddress, Request, RequestId, Response, ResponseError};
use profile::telegram::{DANFOSS, VACON};
use profinet::wire::Reader;
use profinet::wire::block::{ReadResponse, WriteRequest};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType, operation};

use crate::judge::{self, ParameterFrame};
use crate::traffic::{Content, content, frames};

/// Records that carry parameter jobs.
const PARAMETER_RECORDS: [u16; 3] = [0x002F, 0xB02E, 0xB02F];

/// What the present answer of a record belongs to.
type Asked = (RequestId, u8, Vec<ParameterAddress>);

/// Returns all PROFIdrive parameter frames of a capture as our decoders read them.
#[must_use]
#[track_caller]
pub fn parameter_frames(capture: &Path, dialect: &Dialect) -> Vec<ParameterFrame> {
    decoded(capture, dialect)
        .into_iter()
        .map(|(number, frame)| frame.unwrap_or_else(|error| panic!("frame {number}: {error}")))
        .collect()
}

/// Frames in which the dissector is known to err, by what *we* find in them. A frame that we cannot read to its end is in
/// neither set.
#[derive(Debug, Clone, Default)]
pub struct Misread {
    /// A value block with an odd number of octets, so that a pad octet follows it.
    pub padded: BTreeSet<usize>,
    /// A positive change answer, which some drives end with a value-less block.
    pub written: BTreeSet<usize>,
}

/// Looks for the frames that the dissector misreads.
#[must_use]
pub fn misread(capture: &Path) -> Misread {
    let mut found = Misread::default();
    // the AKD dialect accepts both forms of the positive change answer
    for (number, frame) in decoded(capture, &Dialect::AKD) {
        let Ok(frame) = frame else { continue };
        let change = frame.request_id == Some(RequestId::Change.octet());
        let whole = !change || frame.blocks.len() == usize::from(frame.count);
        if whole && frame.blocks.iter().any(|&(format, count)| padded(format, count)) {
            found.padded.insert(number);
        }
        if frame.response_id == Some(RequestId::Change.octet()) {
            found.written.insert(number);
        }
    }
    found
}

/// Returns the dialect of the drive that the object of a call names; vendors that are not distinguished have that of
/// the test.
fn of_call<'a>(header: &Header, dialect: &'a Dialect) -> &'a Dialect {
    match header.object.object_parts().map(|(_, _, vendor)| vendor) {
        Some(DANFOSS) => &Dialect::VLT,
        Some(VACON) => &Dialect::VACON,
        _ => dialect,
    }
}

fn decoded(capture: &Path, dialect: &Dialect) -> Vec<(usize, Result<ParameterFrame, ResponseError>)> {
    let mut open: HashMap<([u8; 16], u16), Asked> = HashMap::new();
    let mut found = Vec::new();
    for (number, bytes) in frames(capture) {
        let Content::Rpc { payload, .. } = content(&bytes) else {
            continue;
        };
        let Ok((header, body)) = Header::decode(payload) else {
            continue;
        };
        let dialect = of_call(&header, dialect);
        // fragments are joined by the dissector only in the last one; our jobs fit one PDU
        let mut reader = Reader::new(body);
        match (header.packet_type, header.operation) {
            (PacketType::Request, operation::WRITE) => {
                if NdrRequest::decode(&mut reader, header.order).is_err() {
                    continue;
                }
                let Ok((write, data)) = WriteRequest::decode(&mut reader) else {
                    continue;
                };
                if !PARAMETER_RECORDS.contains(&write.index) {
                    continue;
                }
                let Ok(request) = Request::parse(data, dialect.code_space) else {
                    continue;
                };
                let addresses: Vec<ParameterAddress> = request.addresses().collect();
                let frame = ParameterFrame {
                    frame: number,
                    reference: request.reference(),
                    request_id: Some(request.id().octet()),
                    response_id: None,
                    axis: request.axis(),
                    count: request.parameters(),
                    addresses: addresses
                        .iter()
                        .map(|a| (a.attribute.octet(), a.elements, a.pnu, a.subindex))
                        .collect(),
                    blocks: match request.id() {
                        RequestId::Change => request
                            .values()
                            .flatten()
                            .map(|block| (block.format.0, block.count))
                            .collect(),
                        _ => Vec::new(),
                    },
                };
                found.push((number, Ok(frame)));
                let key = (write.ar_uuid.0, write.index);
                open.insert(key, (request.id(), request.reference(), addresses));
            }
            (PacketType::Response, operation::READ) => {
                if NdrResponse::decode(&mut reader, header.order).is_err() {
                    continue;
                }
                let Ok((read, data)) = ReadResponse::decode(&mut reader) else {
                    continue;
                };
                let Some((id, reference, addresses)) = open.get(&(read.ar_uuid.0, read.index)) else {
                    continue;
                };
                if data.is_empty() {
                    continue;
                }
                let (negative, blocks) = match Response::parse(data, *id, *reference, addresses, dialect) {
                    Ok(response) => (response.is_negative(), response_blocks(&response)),
                    // one error block for the request as a whole
                    Err(ResponseError::Refused(error)) => {
                        (true, vec![(0x44, 1 + u8::from(error.info.is_some()))])
                    }
                    Err(error) => {
                        found.push((number, Err(error)));
                        continue;
                    }
                };
                let frame = ParameterFrame {
                    frame: number,
                    reference: *reference,
                    request_id: None,
                    response_id: Some(id.octet() | if negative { 0x80 } else { 0 }),
                    axis: data[2],
                    count: data[3],
                    addresses: Vec::new(),
                    blocks,
                };
                found.push((number, Ok(frame)));
            }
            _ => {}
        }
    }
    found
}

fn response_blocks(response: &Response<'_>) -> Vec<(u8, u8)> {
    response
        .answers()
        .filter_map(|answer| match answer {
            Answer::Values(block) => Some((block.format.0, block.count)),
            Answer::Written => response.is_negative().then_some((0x40, 0)),
            Answer::Error(error) => Some((0x44, 1 + u8::from(error.info.is_some()))),
        })
        .collect()
}

/// Fails the test unless the dissector and we read the same parameter jobs; returns the number of frames.
#[track_caller]
pub fn same_parameters(capture: &Path, dialect: &Dialect) -> usize {
    let theirs = judge::parameter_frames(capture);
    let ours = parameter_frames(capture, dialect);
    let numbers = |all: &[ParameterFrame]| all.iter().map(|f| f.frame).collect::<Vec<_>>();
    assert_eq!(
        numbers(&theirs),
        numbers(&ours),
        "frames with parameter jobs in {}",
        capture.display()
    );
    for (theirs, ours) in theirs.iter().zip(&ours) {
        // behind a block with a pad octet the dissector is out of step (tshark does not expect the pad octet), so only
        // what stands before it is compared
        let known = ours
            .blocks
            .iter()
            .position(|&(format, count)| padded(format, count))
            .map_or(ours.blocks.len(), |at| at + 1);
        let mut theirs = theirs.clone();
        let mut ours = ours.clone();
        if known < ours.blocks.len() || padded_last(&ours.blocks) {
            theirs.blocks.truncate(known);
            ours.blocks.truncate(known);
        }
        assert_eq!(theirs, ours, "{}", capture.display());
    }
    ours.len()
}

fn padded(format: u8, count: u8) -> bool {
    matches!(format, 0x01 | 0x02 | 0x05 | 0x09 | 0x0A | 0x41) && count % 2 == 1
}

fn padded_last(blocks: &[(u8, u8)]) -> bool {
    blocks
        .last()
        .is_some_and(|&(format, count)| padded(format, count))
}
