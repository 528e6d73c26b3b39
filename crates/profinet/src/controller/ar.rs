//! One connection of a controller: its calls, one after the other, and its cyclic side.

use alloc::boxed::Box;
use alloc::collections::{BTreeMap, VecDeque};
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::time::Duration;

use super::config::{ConnectConfig, StartUp, Target, Timeouts};
use super::connect::ArIdentity;
use super::dcp::DcpClient;
use super::error::{LostCause, ServiceError};
use super::event::{ArId, CallId, Event};
use super::job::{self, Job, Step};
use super::lookup::Lookup;
use super::phase::{Phase, Trigger};
use super::record::{self, Asker, RecordAddress};
use crate::alarm::{AlarmEvent, Alarms};
use crate::cyclic::{Consumer, ConsumerState, Layout, Provider};
use crate::rpc::{self, CallError, Reply};
use crate::wire::alarm::{AlarmType, Notification};
use crate::wire::block::{BlockType, ControlBlock, ControlCommand, ModuleDiff, ReadRequest, WriteRequest};
use crate::wire::ethernet::Frame;
use crate::wire::rpc::{Header, operation};
use crate::wire::rt::{DataStatus, Iops};
use crate::wire::status::abort;
use crate::wire::{PnioStatus, Uuid};
use crate::{Instant, RPC_PORT};

/// Record calls waiting per connection at most.
pub(super) const MAX_WAITING: usize = 1024;
/// Record a device answers with nothing: keeps a connection alive.
const KEEP_ALIVE: RecordAddress = RecordAddress {
    api: 0,
    slot: 0,
    subslot: 1,
    index: 0xFBFF,
};
/// How long after becoming ready the first input frame may take at least.
const FIRST_FRAME: Duration = Duration::from_secs(2);

/// What all connections share, handed in by the controller.
pub(super) struct Shared<'a> {
    pub now: Instant,
    pub rpc: &'a mut rpc::Client,
    pub dcp: &'a mut DcpClient,
    pub owners: &'a mut BTreeMap<rpc::CallId, Owner>,
    pub events: &'a mut VecDeque<Event>,
    pub timeouts: &'a Timeouts,
}

/// Who waits for a call.
#[derive(Debug, Clone)]
pub(super) enum Owner {
    /// The connection in this place.
    Ar(ArId),
    /// A read without connection.
    Implicit { call: CallId, request: Box<ReadRequest> },
}

/// A call a connection wants to make.
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
enum Sent {
    Connect,
    Read(ReadRequest),
    Write(WriteRequest),
    WriteMany(Vec<WriteRequest>),
    Control(ControlBlock),
}

#[derive(Debug)]
struct Inflight {
    id: rpc::CallId,
    op: Op,
    sent: Sent,
}

/// What a connection is for.
#[derive(Debug)]
pub(super) enum Purpose {
    Cyclic {
        config: Box<ConnectConfig>,
        input: Layout,
        output: Layout,
    },
    Access {
        activity_timeout_factor: u16,
    },
}

/// One connection.
#[derive(Debug)]
pub(super) struct Ar {
    pub id: ArId,
    pub phase: Phase,
    pub target: Target,
    pub identity: ArIdentity,
    pub purpose: Purpose,
    pub object: Uuid,
    pub lookup: Lookup,
    pub activity: Uuid,
    sequence: u32,
    record_sequence: u16,
    ops: VecDeque<Op>,
    jobs: VecDeque<Job>,
    inflight: Option<Inflight>,
    last_call: Instant,
    /// End of the present phase, where it has one.
    pub until: Option<Instant>,
    pub provider: Option<Provider>,
    pub consumer: Option<Consumer>,
    pub alarms: Option<Alarms>,
    pub run: bool,
    early_ready: Option<Option<ModuleDiff>>,
    running: bool,
    /// Waits in the queue of those that have a frame to send.
    pub queued: bool,
}

impl Ar {
    pub(super) fn new(
        now: Instant,
        id: ArId,
        target: Target,
        identity: ArIdentity,
        activity: Uuid,
        purpose: Purpose,
    ) -> Self {
        let run = matches!(&purpose, Purpose::Cyclic { config, .. } if config.run);
        Self {
            id,
            phase: Phase::Resolve,
            object: Uuid::object(target.instance, target.device_id, target.vendor_id),
            target,
            identity,
            purpose,
            lookup: Lookup::default(),
            activity,
            sequence: 0,
            record_sequence: 0,
            ops: VecDeque::new(),
            jobs: VecDeque::new(),
            inflight: None,
            last_call: now,
            until: None,
            provider: None,
            consumer: None,
            alarms: None,
            run,
            early_ready: None,
            running: false,
            queued: false,
        }
    }

    /// Moves on by the table; false if that cannot happen here.
    pub(super) fn advance(&mut self, trigger: Trigger) -> bool {
        match self.phase.after(trigger) {
            Some(next) => {
                self.phase = next;
                self.until = None;
                true
            }
            None => false,
        }
    }

    pub(super) const fn ip(&self) -> Ipv4Addr {
        self.target.ip.address
    }

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

    /// When a sign of life is due; only where the device counts the time without one.
    fn keep_alive_due(&self) -> Option<Instant> {
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
        let op = if let Some(op) = self.ops.pop_front() {
            op
        } else if let Some(job) = self.jobs.front_mut().filter(|job| now >= job.due) {
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
                Err(error @ (ServiceError::Timeout { .. } | ServiceError::Call { .. })) => {
                    self.lose(shared, LostCause::Service(error));
                }
                Err(error) if is_gone(&error) => self.lose(shared, LostCause::Service(error)),
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
            // whatever the device says, it is over
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

    /// The start-up records are through after the last one; PrmEnd follows.
    fn startup_written(&mut self, number: usize) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        if self.phase == Phase::Parameterize && number + 1 == config.records.len() {
            self.ops.push_back(Op::PrmEnd);
        }
    }

    /// Queues all start-up records, or PrmEnd where there are none.
    pub(super) fn parameterize(&mut self) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        self.ops.extend((0..config.records.len()).map(Op::Startup));
        if config.records.is_empty() {
            self.ops.push_back(Op::PrmEnd);
        }
    }

    fn parameterized(&mut self, shared: &mut Shared<'_>) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        let limit = config.ready_limit;
        if self.advance(Trigger::PrmEnd) {
            self.until = Some(shared.now + limit);
            if let Some(diff) = self.early_ready.take() {
                self.become_ready(shared, diff);
            }
        }
    }

    /// ApplicationReady came. True if it is to be confirmed.
    pub(super) fn application_ready(&mut self, shared: &mut Shared<'_>, diff: Option<ModuleDiff>) -> bool {
        match self.phase {
            // it overtook the confirmation of PrmEnd
            Phase::Parameterize if matches!(&self.inflight, Some(Inflight { op: Op::PrmEnd, .. })) => {
                self.early_ready = Some(diff);
                true
            }
            Phase::AwaitReady => {
                self.become_ready(shared, diff);
                true
            }
            Phase::Data | Phase::Release => true,
            _ => false,
        }
    }

    fn become_ready(&mut self, shared: &mut Shared<'_>, diff: Option<ModuleDiff>) {
        if !self.advance(Trigger::Ready) {
            return;
        }
        shared.events.push_back(Event::Ready { ar: self.id, diff });
        self.apply_run();
        let running = self
            .consumer
            .as_ref()
            .is_some_and(|c| c.state() == ConsumerState::Running);
        if running {
            self.now_running(shared);
        } else {
            let hold = self.consumer.as_ref().map_or(Duration::ZERO, Consumer::hold_time);
            self.until = Some(shared.now + hold.max(FIRST_FRAME));
        }
    }

    fn now_running(&mut self, shared: &mut Shared<'_>) {
        if !self.running && self.phase == Phase::Data {
            self.running = true;
            self.until = None;
            shared.events.push_back(Event::Running { ar: self.id });
        }
    }

    /// IOPS a submodule's output has now.
    pub(super) const fn output_state(&self) -> Iops {
        if self.run && matches!(self.phase, Phase::Data) {
            Iops::GOOD
        } else {
            Iops::BAD_CONTROLLER
        }
    }

    /// Brings frame and state of the outputs in line with [`Self::run`].
    pub(super) fn apply_run(&mut self) {
        let (run, state) = (self.run, self.output_state());
        if let Some(provider) = &mut self.provider {
            provider.set_status(DataStatus::GOOD.with_run(run));
            provider.set_all_iops(state);
        }
    }

    /// Takes a cyclic frame.
    pub(super) fn handle_cyclic(&mut self, shared: &mut Shared<'_>, frame: &Frame<'_>) {
        if !self.phase.is_cyclic() {
            return;
        }
        let Some(consumer) = &mut self.consumer else {
            return;
        };
        let Ok(accepted) = consumer.handle(shared.now, frame) else {
            return;
        };
        let (old, new) = (accepted.previous_status, accepted.status);
        if accepted.first {
            self.now_running(shared);
        }
        let good = new.is_run() && !new.has_problem();
        if old != new || (accepted.first && !good) {
            let event = Event::ProviderState {
                ar: self.id,
                run: new.is_run(),
                problem: new.has_problem(),
            };
            shared.events.push_back(event);
        }
    }

    /// Takes an alarm frame.
    pub(super) fn handle_alarm(&mut self, shared: &mut Shared<'_>, frame: &Frame<'_>) {
        let event = self
            .alarms
            .as_mut()
            .and_then(|alarms| alarms.handle_frame(shared.now, frame));
        match event {
            // a device may still do so in the middle of a release
            Some(AlarmEvent::Raised(_) | AlarmEvent::AbortedByPeer(_)) if self.phase == Phase::Release => {}
            Some(AlarmEvent::Raised(alarm)) => self.raised(shared, alarm),
            Some(AlarmEvent::AbortedByPeer(status)) => self.lose(shared, LostCause::AbortedByPeer(status)),
            _ => {}
        }
    }

    fn raised(&mut self, shared: &mut Shared<'_>, alarm: Notification<'static>) {
        if let Some(alarms) = &mut self.alarms {
            alarms.acknowledge(&alarm, PnioStatus::OK);
        }
        if alarm.alarm_type == AlarmType::PLUG && self.phase == Phase::Data {
            self.parameterize_plugged(&alarm);
        }
        shared.events.push_back(Event::Alarm { ar: self.id, alarm });
        self.next_call(shared);
    }

    /// A submodule was plugged: its start-up records are written again.
    fn parameterize_plugged(&mut self, alarm: &Notification<'_>) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        if self.ops.len() + config.records.len() >= MAX_WAITING {
            return;
        }
        let same = |r: &super::config::StartupRecord| (r.slot, r.subslot) == (alarm.slot, alarm.subslot);
        let records = config.records.iter().enumerate().filter(|(_, r)| same(r));
        self.ops.extend(records.map(|(number, _)| Op::Startup(number)));
        self.ops.push_back(Op::PrmEndPlug {
            sequence: alarm.specifier.sequence(),
        });
    }

    /// Ends the connection with an error; the device is told where that helps.
    pub(super) fn lose(&mut self, shared: &mut Shared<'_>, cause: LostCause) {
        if !self.advance(Trigger::End) {
            return;
        }
        let status = match &cause {
            LostCause::AbortedByPeer(_) => None,
            LostCause::Watchdog { .. } => Some(abort::DATA_HOLD),
            LostCause::AlarmChannel => Some(abort::ALARM_SEND),
            LostCause::ReadyTimeout { .. } => Some(abort::READY_TIMEOUT),
            LostCause::StartupRecord { .. } => Some(WRITE_ERROR),
            LostCause::Service(_) => Some(abort::CONTROL_ERROR),
            _ => Some(abort::ABORT_REQUEST),
        };
        if let (Some(alarms), Some(code)) = (&mut self.alarms, status) {
            alarms.abort(PnioStatus::aborted(code));
        }
        self.shut(shared);
        shared.events.push_back(Event::Lost { ar: self.id, cause });
    }

    /// Ends the connection in order.
    pub(super) fn close(&mut self, shared: &mut Shared<'_>) {
        if self.advance(Trigger::End) {
            self.shut(shared);
            shared.events.push_back(Event::Released { ar: self.id });
        }
    }

    fn shut(&mut self, shared: &mut Shared<'_>) {
        self.cancel_calls(shared);
        if let Some(consumer) = &mut self.consumer {
            consumer.stop();
        }
        if let Some(id) = self.lookup.dcp.take() {
            shared.dcp.cancel(id);
        }
    }

    /// Ends all calls with an error.
    fn cancel_calls(&mut self, shared: &mut Shared<'_>) {
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

    /// The caller wants to end it.
    pub(super) fn release(&mut self, shared: &mut Shared<'_>) {
        if !self.advance(Trigger::Release) {
            return;
        }
        self.cancel_calls(shared);
        if self.phase == Phase::Closed {
            self.shut(shared);
            shared.events.push_back(Event::Released { ar: self.id });
        } else {
            // a device that is busy for longer has lost its chance to answer
            let timeouts = shared.timeouts;
            self.until = Some(shared.now + timeouts.call * u32::from(timeouts.call_sends));
            self.ops.push_back(Op::Release);
            self.next_call(shared);
        }
    }

    /// Does what is due.
    pub(super) fn handle_timeout(&mut self, shared: &mut Shared<'_>) {
        let now = shared.now;
        if self.phase == Phase::Closed {
            return;
        }
        self.lookup_due(shared);
        self.watch(shared);
        let event = self.alarms.as_mut().and_then(|alarms| alarms.handle_timeout(now));
        if matches!(event, Some(AlarmEvent::Failed(_))) {
            self.lose(shared, LostCause::AlarmChannel);
        }
        if self.until.is_some_and(|until| now >= until) {
            self.until = None;
            match (self.phase, &self.purpose) {
                (Phase::AwaitReady, Purpose::Cyclic { config, .. }) => {
                    let limit = config.ready_limit;
                    self.lose(shared, LostCause::ReadyTimeout { limit });
                }
                (Phase::Data, _) => {
                    let hold = self.consumer.as_ref().map_or(Duration::ZERO, Consumer::hold_time);
                    self.lose(
                        shared,
                        LostCause::Watchdog {
                            hold: hold.max(FIRST_FRAME),
                        },
                    );
                }
                (Phase::Release, _) => self.close(shared),
                _ => {}
            }
        }
        self.next_call(shared);
    }

    /// Looks after the watchdog.
    fn watch(&mut self, shared: &mut Shared<'_>) {
        let Some(consumer) = &mut self.consumer else {
            return;
        };
        if !consumer.expire(shared.now) {
            return;
        }
        let hold = consumer.hold_time();
        let advanced =
            matches!(&self.purpose, Purpose::Cyclic { config, .. } if config.start_up == StartUp::Advanced);
        match self.phase {
            // advanced start-up tolerates gaps until data counts
            Phase::Parameterize | Phase::AwaitReady if advanced => consumer.restart(),
            Phase::Release => {}
            _ => self.lose(shared, LostCause::Watchdog { hold }),
        }
    }

    /// When something is due.
    pub(super) fn poll_timeout(&self) -> Option<Instant> {
        if self.phase == Phase::Closed {
            return None;
        }
        let cyclic = self.phase.is_cyclic();
        let idle = self.inflight.is_none();
        [
            self.until,
            self.lookup.settle,
            self.provider.as_ref().filter(|_| cyclic).map(Provider::next_send),
            self.consumer.as_ref().and_then(Consumer::deadline),
            self.alarms.as_ref().and_then(Alarms::poll_timeout),
            self.jobs.front().filter(|_| idle).map(|job| job.due),
            self.keep_alive_due().filter(|_| idle),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Writes the next frame of this connection.
    pub(super) fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        let alarms = self.alarms.as_mut()?;
        if self.phase == Phase::Closed {
            return alarms.poll_error(buffer);
        }
        if let Some(length) = alarms.poll_transmit(now, buffer) {
            return Some(length);
        }
        self.provider.as_mut()?.emit(now, buffer)
    }
}

/// ErrorCode2 of an abort after a refused write.
const WRITE_ERROR: u8 = 0x17;

fn ended(shared: &mut Shared<'_>, call: CallId, what: &'static str) {
    shared.events.push_back(Event::RecordDone {
        call,
        result: Err(ServiceError::Closed { what }),
    });
}

/// The device says that it does not know the connection.
fn is_gone(error: &ServiceError) -> bool {
    matches!(error, ServiceError::Refused { status, .. }
        if (status.decode, status.code1, status.code2) == (0x81, 0x40, 0x05))
}
