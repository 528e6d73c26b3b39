//! Record access: who may, which record, by the engine or by the application, answered at once or later.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::Device;
use super::check::RPC;
use super::event::{ArKey, Event, Token};
use crate::Instant;
use crate::rpc::{Call, CallKey};
use crate::wire::block::RecordAddress;
use crate::wire::block::{MULTIPLE_WRITE, ReadRequest, WriteItems, WriteRequest, WriteResponse};
use crate::wire::rpc::{NdrResponse, operation};
use crate::wire::status::record;
use crate::wire::{ByteOrder, DecodeError, PnioStatus, Reader, Uuid, Writer};

/// ErrorCode1: faulty record header.
const RECORD_HEADER_FAULT: u8 = 0x08;
/// Record accesses that may wait for the application at once.
const JOBS: usize = 16;

/// Whether the engine implements a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    /// The engine has done it.
    Engine,
    /// The application must do it.
    Application,
}

/// A call that waits for the application.
#[derive(Debug)]
pub(super) struct Job {
    token: Token,
    key: CallKey,
    order: ByteOrder,
    args_maximum: u32,
    ar: Option<ArKey>,
    pub(super) deadline: Instant,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Read(ReadRequest),
    Write(Writes),
}

/// Writes of one call: a single one, or those of a multiple write.
#[derive(Debug)]
struct Writes {
    outer: Option<WriteRequest>,
    waiting: VecDeque<(WriteRequest, Vec<u8>)>,
    done: Vec<WriteResponse>,
}

fn header_fault(code: u8, error: &DecodeError) -> PnioStatus {
    let code2 = match error.what {
        "BlockType" => 0,
        "BlockVersionHigh" => 2,
        "record data" => 11,
        _ => 1,
    };
    PnioStatus::new(code, 0x81, RECORD_HEADER_FAULT, code2)
}

/// ErrorCode of an operation of the device interface.
pub(super) const fn service_code(number: u16) -> u8 {
    match number {
        operation::CONNECT => 0xDB,
        operation::RELEASE => 0xDC,
        operation::CONTROL => 0xDD,
        operation::WRITE => 0xDF,
        _ => 0xDE,
    }
}

/// Returns true for records the application answers: user-defined and profile indices.
const fn is_application_index(index: u16) -> bool {
    index < 0x8000 || (index >= 0xB000 && index < 0xC000)
}

impl Device {
    /// Executes Read and ReadImplicit.
    pub(super) fn read(
        &mut self,
        now: Instant,
        call: &Call,
        args_maximum: u32,
        mut reader: Reader<'_>,
        implicit: bool,
    ) {
        let request = match ReadRequest::decode(&mut reader) {
            Ok(request) => request,
            Err(error) => return self.answer(now, call, args_maximum, Err(header_fault(0xDE, &error))),
        };
        let refused = self.config.refusals.implicit_read.filter(|_| implicit);
        let ar = match (refused, self.access(now, call, request.ar_uuid, implicit)) {
            (None, Ok((ar, _))) => ar,
            (refused, other) => {
                let (code1, code2) = other.err().unwrap_or_default();
                let status = refused.unwrap_or(PnioStatus::new(0xDE, 0x81, code1, code2));
                return self.answer_read_call(now, call.key, call.order, args_maximum, &request, Err(status));
            }
        };
        let target = if implicit {
            request.target_ar_uuid
        } else {
            request.ar_uuid
        };
        let mut data = Vec::new();
        let result = match self.content(now, target, &request, &mut data) {
            Ok(Owner::Engine) => Ok(&data[..]),
            Ok(Owner::Application) => {
                let address = address_of(request.api, request.slot, request.subslot, request.index);
                let length = usize::try_from(request.length).unwrap_or(usize::MAX);
                let work = Work::Read(request);
                let token = self.job(now, call.key, call.order, args_maximum, ar, work);
                if let Some(token) = token {
                    self.event(Event::RecordRead {
                        token,
                        ar,
                        address,
                        length,
                    });
                    return;
                }
                Err(PnioStatus::read(record::RESOURCE_BUSY))
            }
            Err(code1) => Err(PnioStatus::read(code1)),
        };
        self.answer_read_call(now, call.key, call.order, args_maximum, &request, result);
    }

    /// Finds the AR of a record access and restarts its activity time. The second value is why the AR takes no writes
    /// now, if it does not.
    fn access(
        &mut self,
        now: Instant,
        call: &Call,
        ar_uuid: Uuid,
        implicit: bool,
    ) -> Result<(Option<ArKey>, Option<PnioStatus>), (u8, u8)> {
        let conflict = Some(PnioStatus::write(record::STATE_CONFLICT));
        let start_up = self.config.refusals.start_up_write;
        match (implicit, ar_uuid.is_nil()) {
            (true, true) => return Ok((None, conflict)),
            (true, false) => return Err((RPC, 5)),
            (false, true) => return Err((RECORD_HEADER_FAULT, 5)),
            (false, false) => {}
        }
        if let Some(tool) = self.tool(ar_uuid, call) {
            tool.activity.restart(now);
            return Ok((Some(tool.key), None));
        }
        let io = self.io_ar(ar_uuid, call).ok_or((RPC, 5))?;
        io.activity.restart(now);
        let refused = start_up.filter(|_| io.phase.is_start_up());
        Ok((
            Some(io.key),
            refused.or(conflict.filter(|_| !io.phase.takes_writes())),
        ))
    }

    fn job(
        &mut self,
        now: Instant,
        key: CallKey,
        order: ByteOrder,
        args_maximum: u32,
        ar: Option<ArKey>,
        work: Work,
    ) -> Option<Token> {
        if self.jobs.len() >= JOBS {
            return None;
        }
        self.next_token = self.next_token.wrapping_add(1);
        let token = Token(self.next_token);
        let deadline = now + self.config.answer_limit;
        self.jobs.push(Job {
            token,
            key,
            order,
            args_maximum,
            ar,
            deadline,
            work,
        });
        Some(token)
    }

    /// Executes Write, single or multiple.
    pub(super) fn write(&mut self, now: Instant, call: &Call, args_maximum: u32, mut reader: Reader<'_>) {
        let (request, data) = match WriteRequest::decode(&mut reader) {
            Ok(decoded) => decoded,
            Err(error) => return self.answer(now, call, args_maximum, Err(header_fault(0xDF, &error))),
        };
        let mut writes = Writes {
            outer: None,
            waiting: VecDeque::new(),
            done: Vec::new(),
        };
        let refused = match self.access(now, call, request.ar_uuid, false) {
            Err((code1, code2)) => Some(PnioStatus::new(0xDF, 0x81, code1, code2)),
            Ok((_, Some(refused))) => Some(refused),
            Ok((ar, None)) if request.index == MULTIPLE_WRITE => {
                writes.outer = Some(request);
                let items: Result<VecDeque<_>, _> = WriteItems::new(Reader::new(data))
                    .map(|item| item.map(|(item, data)| (item, data.to_vec())))
                    .collect();
                match items {
                    Ok(items) => {
                        writes.waiting = items;
                        return self.go_on_writing(now, call.key, call.order, args_maximum, ar, writes);
                    }
                    Err(_) => Some(PnioStatus::write(record::LENGTH)),
                }
            }
            Ok((ar, None)) => {
                writes.waiting.push_back((request, data.to_vec()));
                return self.go_on_writing(now, call.key, call.order, args_maximum, ar, writes);
            }
        };
        let status = refused.unwrap_or_default();
        writes.done.push(request.response(status));
        self.answer_writes(now, call.key, call.order, args_maximum, &writes);
    }

    /// Writes one record after the other until one needs the application, or all are done.
    fn go_on_writing(
        &mut self,
        now: Instant,
        key: CallKey,
        order: ByteOrder,
        args_maximum: u32,
        ar: Option<ArKey>,
        mut writes: Writes,
    ) {
        while let Some((request, data)) = writes.waiting.pop_front() {
            let foreign = writes.outer.is_some_and(|outer| outer.ar_uuid != request.ar_uuid);
            let status = if foreign {
                PnioStatus::new(0xDF, 0x81, RECORD_HEADER_FAULT, 5)
            } else {
                match (self.store(&request, &data), ar) {
                    (Ok(Owner::Application), Some(ar)) => {
                        let address = address_of(request.api, request.slot, request.subslot, request.index);
                        writes.waiting.push_front((request, Vec::new()));
                        let work = Work::Write(writes);
                        // the list of jobs has room for every activity of the server
                        if let Some(token) = self.job(now, key, order, args_maximum, Some(ar), work) {
                            self.event(Event::RecordWrite {
                                token,
                                ar,
                                address,
                                data,
                            });
                        } else {
                            let status = PnioStatus::write(record::RESOURCE_BUSY);
                            let stub = stub(0xDF, order, args_maximum, status, &[]);
                            self.server.respond(now, key, stub);
                        }
                        return;
                    }
                    (Ok(_), _) => PnioStatus::OK,
                    (Err(code1), _) => PnioStatus::write(code1),
                }
            };
            writes.done.push(request.response(status));
        }
        self.answer_writes(now, key, order, args_maximum, &writes);
    }

    fn answer_writes(
        &mut self,
        now: Instant,
        key: CallKey,
        order: ByteOrder,
        args_maximum: u32,
        writes: &Writes,
    ) {
        let mut blocks = Vec::new();
        let mut status = PnioStatus::OK;
        match writes.outer {
            Some(outer) => outer.response(PnioStatus::OK).encode(&mut blocks),
            None => status = writes.done.first().map_or(PnioStatus::OK, |done| done.status),
        }
        for done in &writes.done {
            done.encode(&mut blocks);
        }
        let stub = stub(0xDF, order, args_maximum, status, &blocks);
        self.server.respond(now, key, stub);
    }

    fn answer_read_call(
        &mut self,
        now: Instant,
        key: CallKey,
        order: ByteOrder,
        args_maximum: u32,
        request: &ReadRequest,
        result: Result<&[u8], PnioStatus>,
    ) {
        let (status, data) = match result {
            Ok(data) => {
                let wanted = usize::try_from(request.length).unwrap_or(usize::MAX);
                (PnioStatus::OK, data.get(..wanted).unwrap_or(data))
            }
            Err(status) => (status, &[][..]),
        };
        let mut blocks = Vec::with_capacity(64 + data.len());
        request
            .response(u32::try_from(data.len()).unwrap_or(u32::MAX))
            .encode(&mut blocks);
        blocks.extend_from_slice(data);
        let stub = stub(0xDE, order, args_maximum, status, &blocks);
        self.server.respond(now, key, stub);
    }

    /// Answers a call with blocks or a refusal.
    pub(super) fn answer(
        &mut self,
        now: Instant,
        call: &Call,
        args_maximum: u32,
        result: Result<Vec<u8>, PnioStatus>,
    ) {
        let code = service_code(call.operation);
        let stub = match result {
            Ok(blocks) => stub(code, call.order, args_maximum, PnioStatus::OK, &blocks),
            Err(status) => stub(code, call.order, args_maximum, status, &[]),
        };
        self.server.respond(now, call.key, stub);
    }

    /// Returns true while the application works on a record for this AR.
    pub(super) fn has_job(&self, ar: ArKey) -> bool {
        self.jobs.iter().any(|job| job.ar == Some(ar))
    }

    fn take_job(&mut self, token: Token) -> Option<Job> {
        let index = self.jobs.iter().position(|job| job.token == token)?;
        Some(self.jobs.swap_remove(index))
    }

    /// Returns true while a record request waits for the answer of the application: not yet answered, and not too old.
    #[must_use]
    pub fn awaits(&self, token: Token) -> bool {
        self.jobs.iter().any(|job| job.token == token)
    }

    /// Answers [`Event::RecordRead`]. Returns false if no request waits for this answer.
    pub fn answer_read(&mut self, now: Instant, token: Token, result: Result<&[u8], PnioStatus>) -> bool {
        self.quiet_until = None;
        let Some(job) = self.take_job(token) else {
            return false;
        };
        self.restart_activity(now, job.ar);
        let Work::Read(request) = job.work else {
            return false;
        };
        self.answer_read_call(now, job.key, job.order, job.args_maximum, &request, result);
        true
    }

    /// Answers [`Event::RecordWrite`]. Returns false if no request waits for this answer.
    pub fn answer_write(&mut self, now: Instant, token: Token, result: Result<(), PnioStatus>) -> bool {
        self.quiet_until = None;
        let Some(job) = self.take_job(token) else {
            return false;
        };
        self.restart_activity(now, job.ar);
        let Work::Write(mut writes) = job.work else {
            return false;
        };
        if let Some((request, _)) = writes.waiting.pop_front() {
            writes
                .done
                .push(request.response(result.err().unwrap_or_default()));
        }
        self.go_on_writing(now, job.key, job.order, job.args_maximum, job.ar, writes);
        true
    }

    fn restart_activity(&mut self, now: Instant, ar: Option<ArKey>) {
        if let Some(io) = self.controller.as_mut().filter(|io| Some(io.key) == ar) {
            io.activity.restart(now);
        }
        if let Some(tool) = self.tools.iter_mut().find(|tool| Some(tool.key) == ar) {
            tool.activity.restart(now);
        }
    }

    /// Refuses what the application did not answer in time.
    pub(super) fn expire_jobs(&mut self, now: Instant) {
        while let Some(job) = self.jobs.iter().find(|job| job.deadline <= now) {
            let token = job.token;
            match job.work {
                Work::Read(_) => {
                    self.answer_read(now, token, Err(PnioStatus::read(record::BUSY)));
                }
                Work::Write(_) => {
                    self.answer_write(now, token, Err(PnioStatus::write(record::BUSY)));
                }
            }
        }
    }

    /// Checks that API, slot and subslot exist and belong together.
    ///
    /// # Errors
    /// ErrorCode1.
    pub(super) fn check_subslot(&self, api: u32, slot: u16, subslot: u16) -> Result<(), u8> {
        let catalogue = &self.config.modules;
        match self.slots.submodule(catalogue, slot, subslot) {
            Some(submodule) if submodule.api == api => Ok(()),
            Some(_) => Err(record::INVALID_AREA),
            None if self.slots.apis(catalogue).contains(&api) => Err(record::INVALID_SLOT),
            None => Err(record::INVALID_AREA),
        }
    }

    /// Returns the owner of an index that no table lists.
    pub(super) fn other_record(&self, api: u32, slot: u16, subslot: u16, index: u16) -> Result<Owner, u8> {
        self.check_subslot(api, slot, subslot)?;
        if is_application_index(index) {
            Ok(Owner::Application)
        } else {
            Err(record::INVALID_INDEX)
        }
    }
}

const fn address_of(api: u32, slot: u16, subslot: u16, index: u16) -> RecordAddress {
    RecordAddress {
        api,
        slot,
        subslot,
        index,
    }
}

/// Returns a whole response stub; blocks that do not fit what the client allows are left out with an error.
fn stub(code: u8, order: ByteOrder, args_maximum: u32, status: PnioStatus, blocks: &[u8]) -> Vec<u8> {
    let fits = u32::try_from(blocks.len()).is_ok_and(|length| length <= args_maximum);
    let (status, blocks) = if fits {
        (status, blocks)
    } else if status.is_ok() {
        (PnioStatus::new(code, 0x81, RPC, 0), &[][..])
    } else {
        (status, &[][..])
    };
    let args_length = u32::try_from(blocks.len()).unwrap_or(0);
    let mut out = Vec::with_capacity(20 + blocks.len());
    NdrResponse {
        status,
        args_length,
        args_maximum,
    }
    .encode(&mut out, order);
    out.bytes(blocks);
    out
}
