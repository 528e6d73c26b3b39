//! The calls of a connection, one after the other: queued ones, the parameter job, the sign of life.

use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use super::ar::{Ar, Owner, Purpose, Shared};
use super::error::{LostCause, ServiceError};
use super::event::{CallId, Event};
use super::job::{self, Job, Step};
use super::phase::Phase;
use super::record::{self, Asker};
use crate::rpc::{self, CallError, Reply};
use crate::wire::Uuid;
use crate::wire::block::RecordAddress;
use crate::wire::block::{BlockType, ControlBlock, ControlCommand, ReadRequest, WriteRequest};
use crate::wire::rpc::{Header, operation};
use crate::{Instant, RPC_PORT};

/// Record calls waiting per connection at most.
pub(super) const MAX_WAITING: usize = 1024;

/// Record without content: reading it keeps a connection alive.
const KEEP_ALIVE: RecordAddress = RecordAddress {
    api: 0,
    slot: 0,
    subslot: 1,
    index: 0xFBFF,
};

/// A call that a connection has queued.
#[derive(Debug, Clone)]
pub(super) enum Op {
    Connect,
    Read {
        call: CallId,
        at: RecordAddress,
        length: u32,
    },
    Write {
        call: CallId,
        at: RecordAddress,
        data: Vec<u8>,
    },
    WriteMany {
        call: CallId,
        records: Vec<(RecordAddress, Vec<u8>)>,
    },
    /// Start-up record of this number.
    Startup(usize),
    PrmEnd,
    PrmEndPlug {
        sequence: u16,
    },
    Release,
    JobWrite,
    JobRead,
    KeepAlive,
}

/// What is needed to check the answer.
#[derive(Debug, Clone)]
pub(super) enum Sent {
    Connect,
    Read(ReadRequest),
    Write(WriteRequest),
    WriteMany(Vec<WriteRequest>),
    Control(ControlBlock),
}

#[derive(Debug)]
pub(super) struct Inflight {
    id: rpc::CallId,
    pub op: Op,
    sent: Sent,
}

impl Ar {
    /// Queues a call; false if too many wait.
    pub(super) fn push(&mut self, shared: &mut Shared<'_>, op: Op) -> bool {
        if self.ops.len() >= MAX_WAITING {
            return false;
        }
        self.ops.push_back(op);
        self.next_call(shared);
        true
    }

    /// Queues a parameter job; false if too many wait.
    pub(super) fn push_job(&mut self, shared: &mut Shared<'_>, job: Job) -> bool {
        if self.jobs.len() >= MAX_WAITING {
            return false;
        }
        self.jobs.push_back(job);
        self.next_call(shared);
        true
    }

    fn factor(&self) -> u16 {
        match &self.purpose {
            Purpose::Cyclic { config, .. } => config.activity_timeout_factor,
            Purpose::Access {
                activity_timeout_factor,
            } => *activity_timeout_factor,
        }
    }

    /// Returns the time when a sign of life is due; only where the device counts the time without one.
    pub(super) fn keep_alive_due(&self) -> Option<Instant> {
        let counted = matches!(
            self.phase,
            Phase::Access | Phase::Parameterize | Phase::AwaitReady
        );
        counted.then(|| self.last_call + Duration::from_millis(100) * u32::from(self.factor()) / 3)
    }

    /// Starts the next call if none is open: queued ones, then the parameter job, then the sign of life.
    pub(super) fn next_call(&mut self, shared: &mut Shared<'_>) {
        if self.inflight.is_some() || self.phase == Phase::Closed {
            return;
        }
        let now = shared.now;
        self.writes_from = self.writes_from.filter(|from| now < *from);
        let held = self.writes_from.is_some();
        // what was requested later does not overtake
        if held && matches!(self.ops.front(), Some(Op::Write { .. } | Op::WriteMany { .. })) {
            return;
        }
        let op = if let Some(op) = self.ops.pop_front() {
            op
        } else if let Some(job) = self.jobs.front_mut().filter(|job| now >= job.due && !held) {
            job.begin(now);
            match job.step {
                Step::Write => Op::JobWrite,
                Step::Read => Op::JobRead,
            }
        } else if self.keep_alive_due().is_some_and(|due| now >= due) {
            Op::KeepAlive
        } else {
            return;
        };
        let Some((operation, stub, sent)) = self.prepare(&op) else {
            return;
        };
        let header = Header::request(
            self.object,
            Uuid::DEVICE_INTERFACE,
            self.activity,
            self.sequence,
            operation,
        );
        self.sequence = self.sequence.wrapping_add(1);
        self.last_call = now;
        let id = shared
            .rpc
            .call(now, SocketAddrV4::new(self.ip(), RPC_PORT), header, stub);
        shared.owners.insert(id, Owner::Ar(self.id));
        self.inflight = Some(Inflight { id, op, sent });
    }

    fn asker(&mut self, records: usize) -> Asker {
        let sequence = self.record_sequence;
        let used = u16::try_from(records).unwrap_or(u16::MAX);
        self.record_sequence = sequence.wrapping_add(used);
        Asker {
            sequence,
            ar_uuid: self.identity.ar_uuid,
        }
    }

    fn control(&self, block_type: BlockType, command: ControlCommand) -> ControlBlock {
        ControlBlock::new(
            block_type,
            self.identity.ar_uuid,
            self.identity.session_key,
            command,
        )
    }

    fn prepare(&mut self, op: &Op) -> Option<(u16, Vec<u8>, Sent)> {
        let write = |asker, at, data: &[u8]| {
            let request = record::write_request(asker, at, data.len());
            (
                operation::WRITE,
                record::write_stub(&request, data),
                Sent::Write(request),
            )
        };
        let read = |asker, at, length| {
            let request = record::read_request(asker, at, length, Uuid::NIL);
            (operation::READ, record::read_stub(&request), Sent::Read(request))
        };
        let control =
            |block: ControlBlock, operation| (operation, record::control_stub(&block), Sent::Control(block));
        Some(match op {
            Op::Connect => (operation::CONNECT, self.connect_stub(), Sent::Connect),
            Op::Read { at, length, .. } => read(self.asker(1), *at, *length),
            Op::KeepAlive => read(self.asker(1), KEEP_ALIVE, 0),
            Op::Write { at, data, .. } => write(self.asker(1), *at, data),
            Op::WriteMany { records, .. } => {
                let (stub, headers) = record::multiple_stub(self.asker(records.len() + 1), records);
                (operation::WRITE, stub, Sent::WriteMany(headers))
            }
            Op::Startup(number) => {
                let asker = self.asker(1);
                let Purpose::Cyclic { config, .. } = &self.purpose else {
                    return None;
                };
                let record = config.records.get(*number)?;
                let super::config::StartupRecord {
                    api,
                    slot,
                    subslot,
                    index,
                    ..
                } = *record;
                write(
                    asker,
                    RecordAddress {
                        api,
                        slot,
                        subslot,
                        index,
                    },
                    &record.data,
                )
            }
            Op::JobWrite => {
                let asker = self.asker(1);
                let job = self.jobs.front()?;
                write(asker, job.at, &job.request)
            }
            Op::JobRead => {
                let asker = self.asker(1);
                read(asker, self.jobs.front()?.at, job::ANSWER)
            }
            Op::PrmEnd => control(
                self.control(BlockType::PRM_END, ControlCommand::PRM_END),
                operation::CONTROL,
            ),
            Op::PrmEndPlug { sequence } => {
                let mut block = self.control(BlockType::PRM_END_PLUG, ControlCommand::PRM_END);
                block.alarm_sequence = *sequence;
                control(block, operation::CONTROL)
            }
            Op::Release => control(
                self.control(BlockType::RELEASE, ControlCommand::RELEASE),
                operation::RELEASE,
            ),
        })
    }

    /// Takes the result of the call `id`.
    pub(super) fn handle_reply(
        &mut self,
        shared: &mut Shared<'_>,
        id: rpc::CallId,
        reply: &Result<Reply, CallError>,
    ) {
        let Some(Inflight { op, sent, .. }) = self.inflight.take_if(|inflight| inflight.id == id) else {
            return;
        };
        match (op, sent) {
            (Op::Connect, _) => self.connected(shared, reply),
            (Op::Read { call, .. }, Sent::Read(request)) => {
                let result = record::check_read(reply, &request);
                self.finish(shared, call, result);
            }
            (Op::Write { call, .. }, Sent::Write(request)) => {
                let result = record::check_write(reply, &request).map(|()| Vec::new());
                self.finish(shared, call, result);
            }
            (Op::WriteMany { call, .. }, Sent::WriteMany(headers)) => {
                let result = record::check_multiple(reply, &headers);
                let gone = result
                    .as_ref()
                    .err()
                    .is_some_and(is_gone)
                    .then(|| result.clone().err());
                shared.events.push_back(Event::WritesDone { call, result });
                if let Some(Some(error)) = gone {
                    self.lose(shared, LostCause::Service(error));
                }
            }
            (Op::JobWrite, Sent::Write(request)) => {
                let result = record::check_write(reply, &request);
                self.job_step(shared, result.map(|()| None));
            }
            (Op::JobRead, Sent::Read(request)) => {
                let result = record::check_read(reply, &request);
                self.job_step(shared, result.map(Some));
            }
            (Op::Startup(number), Sent::Write(request)) => {
                if let Err(error) = record::check_write(reply, &request) {
                    let WriteRequest {
                        slot, subslot, index, ..
                    } = request;
                    self.lose(
                        shared,
                        LostCause::StartupRecord {
                            slot,
                            subslot,
                            index,
                            error,
                        },
                    );
                } else {
                    self.startup_written(number);
                }
            }
            (Op::KeepAlive, Sent::Read(request)) => match record::check_read(reply, &request) {
                // any answer is a sign of life, even "no such record"
                Err(error) if is_gone(&error) || matches!(error, ServiceError::Timeout { .. }) => {
                    self.lose(shared, LostCause::Service(error));
                }
                _ => {}
            },
            (Op::PrmEnd, Sent::Control(block)) => match record::check_control("PrmEnd", reply, &block) {
                Ok(()) => self.parameterized(shared),
                Err(error) => self.lose(shared, LostCause::Service(error)),
            },
            (Op::PrmEndPlug { .. }, Sent::Control(block)) => {
                if let Err(error) = record::check_control("PrmEnd after plug", reply, &block) {
                    self.lose(shared, LostCause::Service(error));
                }
            }
            // the connection is over with any answer of the device
            (Op::Release, _) => self.close(shared),
            _ => {}
        }
        self.next_call(shared);
    }

    fn finish(&mut self, shared: &mut Shared<'_>, call: CallId, result: Result<Vec<u8>, ServiceError>) {
        let gone = result.as_ref().err().filter(|error| is_gone(error)).cloned();
        shared.events.push_back(Event::RecordDone { call, result });
        if let Some(error) = gone {
            self.lose(shared, LostCause::Service(error));
        }
    }

    fn job_step(&mut self, shared: &mut Shared<'_>, result: Result<Option<Vec<u8>>, ServiceError>) {
        let Some(job) = self.jobs.front_mut() else { return };
        let result = match result {
            Ok(None) => {
                job.written(shared.now);
                return;
            }
            Ok(Some(data)) => Ok(data),
            Err(mut error) => {
                if job.again(shared.now, &mut error) {
                    return;
                }
                Err(error)
            }
        };
        let call = job.call;
        self.jobs.pop_front();
        self.finish(shared, call, result);
    }

    /// Ends all calls with an error.
    pub(super) fn cancel_calls(&mut self, shared: &mut Shared<'_>) {
        let inflight = self.inflight.take().map(|inflight| {
            shared.rpc.cancel(inflight.id);
            shared.owners.remove(&inflight.id);
            inflight.op
        });
        for op in inflight.into_iter().chain(self.ops.drain(..)) {
            match op {
                Op::Read { call, .. } => ended(shared, call, "record read"),
                Op::Write { call, .. } => ended(shared, call, "record write"),
                Op::WriteMany { call, .. } => {
                    let result = Err(ServiceError::Closed {
                        what: "multiple write",
                    });
                    shared.events.push_back(Event::WritesDone { call, result });
                }
                _ => {}
            }
        }
        for job in self.jobs.drain(..) {
            ended(shared, job.call, "parameter access");
        }
    }
}

fn ended(shared: &mut Shared<'_>, call: CallId, what: &'static str) {
    shared.events.push_back(Event::RecordDone {
        call,
        result: Err(ServiceError::Closed { what }),
    });
}

/// Returns true if the device reports that the connection does not exist.
fn is_gone(error: &ServiceError) -> bool {
    matches!(error, ServiceError::Refused { status, .. }
        if (status.decode, status.code1, status.code2) == (0x81, 0x40, 0x05))
}
