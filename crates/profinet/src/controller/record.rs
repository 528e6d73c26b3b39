//! Record requests and control blocks: built, and their answers checked.

use alloc::vec::Vec;

use super::error::ServiceError;
use crate::rpc::{CallError, PathCount, Reply};
use crate::wire::block::{
    Block, BlockType, ControlBlock, ControlCommand, RECORD_HEADER, ReadRequest, ReadResponse, RecordAddress,
    WriteRequest, WriteResponse,
};
use crate::wire::rpc::{HEADER_LENGTH, NDR_LENGTH, NdrRequest, NdrResponse};
use crate::wire::{ByteOrder, DecodeError, PnioStatus, Reader, Uuid, Writer};

/// Largest record requested or written in one request.
pub const MAX_RECORD: u32 = 32 * 1024;

/// Room offered for the blocks of an answer without record data.
const ROOM: u32 = 4096;

/// Puts the NDR header in front of `blocks`; `room` octets may come back.
pub(super) fn stub(room: u32, blocks: &[u8]) -> Vec<u8> {
    let length = u32::try_from(blocks.len()).unwrap_or(u32::MAX);
    let mut out = Vec::with_capacity(NDR_LENGTH + blocks.len());
    NdrRequest {
        args_maximum: room.max(length).max(ROOM),
        args_length: length,
    }
    .encode(&mut out, ByteOrder::Big);
    out.bytes(blocks);
    out
}

/// Decodes the result of a call: names RPC errors, checks the NDR header, returns refusals.
pub(super) fn open<'a>(
    what: &'static str,
    reply: &'a Result<Reply, CallError>,
) -> Result<Reader<'a>, ServiceError> {
    let reply = match reply {
        Ok(reply) => reply,
        Err(CallError::Timeout { path, .. }) => return Err(ServiceError::Timeout { what, path: *path }),
        Err(CallError::NeverFinished { .. }) => {
            let path = PathCount::default();
            return Err(ServiceError::Timeout { what, path });
        }
        Err(error) => return Err(ServiceError::Call { what, error: *error }),
    };
    let mut reader = Reader::with_base(&reply.stub, HEADER_LENGTH);
    let ndr = NdrResponse::decode(&mut reader, reply.order).map_err(malformed(what))?;
    if ndr.status.is_ok() {
        Ok(reader)
    } else {
        Err(ServiceError::Refused {
            what,
            status: ndr.status,
        })
    }
}

pub(super) fn malformed(what: &'static str) -> impl Fn(DecodeError) -> ServiceError {
    move |error| ServiceError::Malformed { what, error }
}

/// The first of `checks` that does not hold names the field.
pub(super) fn matching(what: &'static str, checks: &[(bool, &'static str)]) -> Result<(), ServiceError> {
    match checks.iter().find(|check| !check.0) {
        Some((_, field)) => Err(ServiceError::Mismatch { what, field }),
        None => Ok(()),
    }
}

/// Initiator of a record request.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asker {
    pub sequence: u16,
    pub ar_uuid: Uuid,
}

pub(super) fn read_request(asker: Asker, at: RecordAddress, length: u32, target: Uuid) -> ReadRequest {
    ReadRequest {
        sequence: asker.sequence,
        ar_uuid: asker.ar_uuid,
        api: at.api,
        slot: at.slot,
        subslot: at.subslot,
        index: at.index,
        length,
        target_ar_uuid: target,
    }
}

pub(super) fn read_stub(request: &ReadRequest) -> Vec<u8> {
    let mut blocks = Vec::with_capacity(RECORD_HEADER);
    request.encode(&mut blocks);
    stub(request.length.saturating_add(64), &blocks)
}

pub(super) fn check_read(
    reply: &Result<Reply, CallError>,
    request: &ReadRequest,
) -> Result<Vec<u8>, ServiceError> {
    const WHAT: &str = "record read";
    let mut reader = open(WHAT, reply)?;
    let (header, data) = ReadResponse::decode(&mut reader).map_err(malformed(WHAT))?;
    matching(
        WHAT,
        &[
            (header.ar_uuid == request.ar_uuid, "ARUUID"),
            (header.api == request.api, "API"),
            (header.slot == request.slot, "slot"),
            (header.subslot == request.subslot, "subslot"),
            (header.index == request.index, "index"),
            (header.sequence == request.sequence, "sequence number"),
            (header.length <= request.length, "length"),
        ],
    )?;
    Ok(data.to_vec())
}

pub(super) fn write_request(asker: Asker, at: RecordAddress, length: usize) -> WriteRequest {
    WriteRequest {
        sequence: asker.sequence,
        ar_uuid: asker.ar_uuid,
        api: at.api,
        slot: at.slot,
        subslot: at.subslot,
        index: at.index,
        length: u32::try_from(length).unwrap_or(u32::MAX),
    }
}

pub(super) fn write_stub(request: &WriteRequest, data: &[u8]) -> Vec<u8> {
    let mut blocks = Vec::with_capacity(RECORD_HEADER + data.len());
    request.encode(&mut blocks);
    blocks.bytes(data);
    stub(64, &blocks)
}

fn write_header(
    reader: &mut Reader<'_>,
    what: &'static str,
    request: &WriteRequest,
) -> Result<PnioStatus, ServiceError> {
    let header = WriteResponse::decode(reader).map_err(malformed(what))?;
    matching(
        what,
        &[
            (header.ar_uuid == request.ar_uuid, "ARUUID"),
            (header.api == request.api, "API"),
            (header.slot == request.slot, "slot"),
            (header.subslot == request.subslot, "subslot"),
            (header.index == request.index, "index"),
            (header.sequence == request.sequence, "sequence number"),
        ],
    )?;
    Ok(header.status)
}

pub(super) fn check_write(
    reply: &Result<Reply, CallError>,
    request: &WriteRequest,
) -> Result<(), ServiceError> {
    const WHAT: &str = "record write";
    let mut reader = open(WHAT, reply)?;
    let status = write_header(&mut reader, WHAT, request)?;
    if status.is_ok() {
        Ok(())
    } else {
        Err(ServiceError::Refused { what: WHAT, status })
    }
}

/// Returns the stub of a multiple write and the headers in it, the container's first.
pub(super) fn multiple_stub(
    asker: Asker,
    records: &[(RecordAddress, Vec<u8>)],
) -> (Vec<u8>, Vec<WriteRequest>) {
    let mut inner = Vec::new();
    let mut headers = Vec::with_capacity(records.len() + 1);
    for (number, (at, data)) in (0u16..).zip(records) {
        let sequence = asker.sequence.wrapping_add(number).wrapping_add(1);
        let request = write_request(Asker { sequence, ..asker }, *at, data.len());
        request.encode(&mut inner);
        inner.bytes(data);
        if usize::from(number) + 1 < records.len() {
            inner.align(0, 4);
        }
        headers.push(request);
    }
    let length = u32::try_from(inner.len()).unwrap_or(u32::MAX);
    let outer = WriteRequest::multiple(asker.sequence, asker.ar_uuid, length);
    headers.insert(0, outer);
    let room = u32::try_from(headers.len().saturating_mul(RECORD_HEADER)).unwrap_or(u32::MAX);
    let mut blocks = Vec::with_capacity(RECORD_HEADER + inner.len());
    outer.encode(&mut blocks);
    blocks.bytes(&inner);
    (stub(room, &blocks), headers)
}

/// Returns the result of each record of a multiple write; `None` for those without a result from the device.
pub(super) fn check_multiple(
    reply: &Result<Reply, CallError>,
    headers: &[WriteRequest],
) -> Result<Vec<Option<PnioStatus>>, ServiceError> {
    const WHAT: &str = "multiple write";
    let mut reader = open(WHAT, reply)?;
    let Some((outer, inner)) = headers.split_first() else {
        return Ok(Vec::new());
    };
    write_header(&mut reader, WHAT, outer)?;
    let mut results = Vec::with_capacity(inner.len());
    for request in inner {
        results.push(if reader.is_empty() {
            None
        } else {
            Some(write_header(&mut reader, WHAT, request)?)
        });
    }
    reader.finish(WHAT).map_err(malformed(WHAT))?;
    Ok(results)
}

pub(super) fn control_stub(block: &ControlBlock) -> Vec<u8> {
    let mut blocks = Vec::with_capacity(32);
    block.encode(&mut blocks);
    stub(0, &blocks)
}

pub(super) fn check_control(
    what: &'static str,
    reply: &Result<Reply, CallError>,
    request: &ControlBlock,
) -> Result<(), ServiceError> {
    let mut reader = open(what, reply)?;
    let expected: BlockType = request.block_type.response();
    let body = Block::expect(&mut reader, expected).map_err(malformed(what))?;
    let block = ControlBlock::decode(expected, body).map_err(malformed(what))?;
    matching(
        what,
        &[
            (block.ar_uuid == request.ar_uuid, "ARUUID"),
            (block.session_key == request.session_key, "session key"),
            (block.command == ControlCommand::DONE, "command"),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    const AT: RecordAddress = RecordAddress {
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 0xB02E,
    };
    const ASKER: Asker = Asker {
        sequence: 5,
        ar_uuid: Uuid([7; 16]),
    };

    fn reply(status: PnioStatus, blocks: &[u8]) -> Result<Reply, CallError> {
        let mut stub = vec![];
        let length = u32::try_from(blocks.len()).unwrap();
        NdrResponse {
            status,
            args_length: length,
            args_maximum: 4096,
        }
        .encode(&mut stub, ByteOrder::Little);
        stub.bytes(blocks);
        Ok(Reply {
            order: ByteOrder::Little,
            stub,
        })
    }

    fn read_answer(request: &ReadRequest, data: &[u8]) -> Vec<u8> {
        let mut blocks = vec![];
        request
            .response(u32::try_from(data.len()).unwrap())
            .encode(&mut blocks);
        blocks.bytes(data);
        blocks
    }

    #[test]
    fn the_golden_parameter_write() {
        let request = write_request(ASKER, AT, 10);
        let data = [1, 1, 1, 1, 0x10, 1, 3, 0xC4, 0, 0];
        let stub = write_stub(&request, &data);
        let mut golden = vec![0, 0, 0x10, 0, 0, 0, 0, 74, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0, 74];
        golden.extend_from_slice(&[0x00, 0x08, 0x00, 0x3c, 0x01, 0x00, 0x00, 0x05]);
        golden.extend_from_slice(&[7; 16]);
        golden.extend_from_slice(&[0, 0, 0x3a, 0, 0, 1, 0, 1, 0, 0, 0xb0, 0x2e, 0, 0, 0, 0x0a]);
        golden.extend_from_slice(&[0; 24]);
        golden.extend_from_slice(&data);
        assert_eq!(stub, golden);
    }

    #[test]
    fn reads_are_checked_field_by_field() {
        let request = read_request(ASKER, AT, 100, Uuid::NIL);
        let good = read_answer(&request, &[1, 2, 3]);
        assert_eq!(
            check_read(&reply(PnioStatus::OK, &good), &request),
            Ok(vec![1, 2, 3])
        );
        for (octet, field) in [
            (7, "sequence number"),
            (8, "ARUUID"),
            (27, "API"),
            (29, "slot"),
            (31, "subslot"),
            (35, "index"),
        ] {
            let mut bad = good.clone();
            bad[octet] ^= 1;
            let error = check_read(&reply(PnioStatus::OK, &bad), &request).unwrap_err();
            assert_eq!(
                error,
                ServiceError::Mismatch {
                    what: "record read",
                    field
                }
            );
        }
        let long = read_answer(&request, &[0; 101]);
        let error = check_read(&reply(PnioStatus::OK, &long), &request).unwrap_err();
        assert_eq!(
            error,
            ServiceError::Mismatch {
                what: "record read",
                field: "length"
            }
        );
        let refused = check_read(&reply(PnioStatus::read(0xB5), &[]), &request).unwrap_err();
        assert!(matches!(refused, ServiceError::Refused { status, .. } if status.is_state_conflict()));
    }

    #[test]
    fn every_cut_of_an_answer_is_an_error() {
        let request = read_request(ASKER, AT, 100, Uuid::NIL);
        let good = read_answer(&request, &[1, 2, 3]);
        for cut in 0..good.len() {
            assert!(check_read(&reply(PnioStatus::OK, &good[..cut]), &request).is_err());
        }
        let Ok(whole) = reply(PnioStatus::OK, &good) else {
            panic!()
        };
        for cut in 0..whole.stub.len() {
            let cut = Ok(Reply {
                order: whole.order,
                stub: whole.stub[..cut].to_vec(),
            });
            assert!(matches!(
                check_read(&cut, &request),
                Err(ServiceError::Malformed { .. })
            ));
        }
    }

    #[test]
    fn a_multiple_write_is_padded_and_its_answers_counted() {
        let records = [
            (AT, vec![1, 2, 3]),
            (RecordAddress { index: 7, ..AT }, vec![4; 5]),
        ];
        let (stub, headers) = multiple_stub(ASKER, &records);
        assert_eq!(stub.len(), 20 + 64 + 64 + 4 + 64 + 5);
        assert_eq!(headers[0].length, 64 + 4 + 64 + 5);
        let refused = PnioStatus::write(0xB0);
        let mut blocks = vec![];
        headers[0].response(PnioStatus::OK).encode(&mut blocks);
        headers[1].response(PnioStatus::OK).encode(&mut blocks);
        let short = check_multiple(&reply(PnioStatus::OK, &blocks), &headers);
        assert_eq!(short, Ok(vec![Some(PnioStatus::OK), None]));
        headers[2].response(refused).encode(&mut blocks);
        let full = check_multiple(&reply(PnioStatus::OK, &blocks), &headers);
        assert_eq!(full, Ok(vec![Some(PnioStatus::OK), Some(refused)]));
        blocks.push(0);
        assert!(check_multiple(&reply(PnioStatus::OK, &blocks), &headers).is_err());
    }

    #[test]
    fn control_answers() {
        let request = ControlBlock::new(BlockType::PRM_END, Uuid([7; 16]), 2, ControlCommand::PRM_END);
        let mut blocks = vec![];
        request.done().encode(&mut blocks);
        assert_eq!(
            check_control("PrmEnd", &reply(PnioStatus::OK, &blocks), &request),
            Ok(())
        );
        for (octet, field) in [(8, "ARUUID"), (25, "session key"), (29, "command")] {
            let mut bad = blocks.clone();
            bad[octet] ^= 1;
            let error = check_control("PrmEnd", &reply(PnioStatus::OK, &bad), &request).unwrap_err();
            assert_eq!(
                error,
                ServiceError::Mismatch {
                    what: "PrmEnd",
                    field
                }
            );
        }
        let error = check_control(
            "PrmEnd",
            &Err(CallError::Timeout {
                sends: 3,
                path: PathCount::default(),
            }),
            &request,
        )
        .unwrap_err();
        assert_eq!(
            error,
            ServiceError::Timeout {
                what: "PrmEnd",
                path: PathCount::default()
            }
        );
    }

    proptest! {
        #[test]
        fn hostile_answers_end_in_an_error_or_a_value(bytes in proptest::collection::vec(any::<u8>(), 0..200), little: bool) {
            let order = if little { ByteOrder::Little } else { ByteOrder::Big };
            let request = read_request(ASKER, AT, 100, Uuid::NIL);
            let reply = Ok(Reply { order, stub: bytes });
            let _ = check_read(&reply, &request);
            let _ = check_multiple(&reply, &multiple_stub(ASKER, &[(AT, vec![1])]).1);
        }

        #[test]
        fn flipped_bits(flips in proptest::collection::vec((0usize..256, 0u8..8), 1..6)) {
            let request = read_request(ASKER, AT, 100, Uuid::NIL);
            let Ok(mut whole) = reply(PnioStatus::OK, &read_answer(&request, &[1, 2, 3])) else { panic!() };
            for (at, bit) in flips {
                let at = at % whole.stub.len();
                whole.stub[at] ^= 1 << bit;
            }
            let _ = check_read(&Ok(whole), &request);
        }
    }
}
