//! One connection of a controller: its calls, one after the other, and its cyclic side.

use alloc::boxed::Box;
use alloc::collections::{BTreeMap, VecDeque};
use core::net::Ipv4Addr;
use core::time::Duration;

use super::calls::{Inflight, MAX_WAITING, Op};
use super::config::{ConnectConfig, StartUp, Target, Timeouts};
use super::connect::ArIdentity;
use super::dcp::DcpClient;
use super::error::LostCause;
use super::event::{ArId, CallId, Event};
use super::job::Job;
use super::lookup::Lookup;
use super::phase::{Phase, Trigger};
use crate::Instant;
use crate::alarm::{AlarmEvent, Alarms};
use crate::cyclic::{Consumer, ConsumerState, Layout, Provider};
use crate::rpc;
use crate::wire::alarm::{AlarmType, Notification};
use crate::wire::block::{ModuleDiff, ReadRequest};
use crate::wire::ethernet::Frame;
use crate::wire::rt::{DataStatus, Iops};
use crate::wire::status::abort;
use crate::wire::{PnioStatus, Uuid};

/// How long after becoming ready the first input frame may take at least.
const FIRST_FRAME: Duration = Duration::from_secs(2);

/// What all connections share, provided by the controller.
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
    pub sequence: u32,
    pub record_sequence: u16,
    pub ops: VecDeque<Op>,
    pub jobs: VecDeque<Job>,
    pub inflight: Option<Inflight>,
    pub last_call: Instant,
    /// End of the present phase, where it has one.
    pub until: Option<Instant>,
    pub provider: Option<Provider>,
    pub consumer: Option<Consumer>,
    pub alarms: Option<Alarms>,
    pub run: bool,
    /// PrmEnd waits for a request of the caller.
    held: bool,
    early_ready: Option<Option<ModuleDiff>>,
    running: bool,
    /// Writes wait until then: the outputs that end the start-up are on their way first.
    pub writes_from: Option<Instant>,
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
        let held = matches!(&purpose, Purpose::Cyclic { config, .. } if config.hold_start_up);
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
            held,
            early_ready: None,
            running: false,
            writes_from: None,
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

    /// The start-up records are through after the last one; PrmEnd follows.
    pub(super) fn startup_written(&mut self, number: usize) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        if self.phase == Phase::Parameterize && number + 1 == config.records.len() && !self.held {
            self.ops.push_back(Op::PrmEnd);
        }
    }

    /// Returns true while the start-up is held and records travel in it.
    pub(super) const fn is_held(&self) -> bool {
        self.held && matches!(self.phase, Phase::Parameterize)
    }

    /// Ends a start-up that is held: PrmEnd goes out behind what waits already.
    pub(super) fn end_start_up(&mut self, shared: &mut Shared<'_>) {
        if self.is_held() {
            self.held = false;
            self.ops.push_back(Op::PrmEnd);
            self.next_call(shared);
        }
    }

    /// Queues all start-up records, or PrmEnd where there are none.
    pub(super) fn parameterize(&mut self) {
        let Purpose::Cyclic { config, .. } = &self.purpose else {
            return;
        };
        self.ops.extend((0..config.records.len()).map(Op::Startup));
        if config.records.is_empty() && !self.held {
            self.ops.push_back(Op::PrmEnd);
        }
    }

    pub(super) fn parameterized(&mut self, shared: &mut Shared<'_>) {
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
        // a device refuses records (DF 80 B5 00) until it has valid outputs after ApplicationReady
        self.writes_from = self.provider.as_ref().map(Provider::next_send);
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

    /// Takes a cyclic frame. Returns true when it brought inputs.
    pub(super) fn handle_cyclic(&mut self, shared: &mut Shared<'_>, frame: &Frame<'_>) -> bool {
        if !self.phase.is_cyclic() {
            return false;
        }
        let Some(consumer) = &mut self.consumer else {
            return false;
        };
        let Ok(accepted) = consumer.handle(shared.now, frame) else {
            return false;
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
        true
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

    /// Ends the connection with an error; notifies the device where that helps.
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
    }

    /// Ends the connection on request of the caller.
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

    /// Returns the time of the next timeout.
    pub(super) fn poll_timeout(&self) -> Option<Instant> {
        if self.phase == Phase::Closed {
            return None;
        }
        let cyclic = self.phase.is_cyclic();
        let idle = self.inflight.is_none();
        Instant::earliest([
            self.until,
            self.lookup.settle,
            self.provider.as_ref().filter(|_| cyclic).map(Provider::next_send),
            self.consumer.as_ref().and_then(Consumer::deadline),
            self.alarms.as_ref().and_then(Alarms::poll_timeout),
            self.writes_from
                .filter(|_| idle && !(self.ops.is_empty() && self.jobs.is_empty())),
            self.jobs
                .front()
                .filter(|_| idle)
                .map(|job| job.due.max(self.writes_from.unwrap_or(job.due))),
            self.keep_alive_due().filter(|_| idle),
        ])
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
