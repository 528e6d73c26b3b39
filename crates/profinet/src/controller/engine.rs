//! The controller as an endpoint: frames and datagrams sorted to whom they concern, deadlines, things to send.

use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use super::ar::{Ar, Owner, Shared};
use super::connect::slot_of;
use super::dcp::DcpEvent;
use super::event::Event;
use super::phase::Phase;
use super::{Controller, record};
use crate::cyclic::Provider;
use crate::rpc::{Call, Reply};
use crate::wire::block::{Block, BlockType, Blocks, ControlBlock, ControlCommand, ModuleDiff};
use crate::wire::ethernet::{Frame, FrameKind};
use crate::wire::rpc::{HEADER_LENGTH, NdrRequest, NdrResponse, operation, reject};
use crate::wire::{DecodeError, PnioStatus, Reader, Writer};
use crate::{Endpoint, Instant, IpSuite, MacAddress, RPC_PORT, Transmit};

/// With so many connections that exchange cyclic data, frames are handled together.
const TOGETHER: usize = 16;
/// They wait for this part of the shortest update time.
const PARTS: u32 = 16;
/// They wait no longer: a send clock.
const LONGEST_WAIT: Duration = Duration::from_millis(1);

impl Controller {
    /// Runs an operation on a connection, then updates its deadline and lets it send.
    pub(super) fn with<T>(
        &mut self,
        now: Instant,
        index: usize,
        what: impl FnOnce(&mut Ar, &mut Shared<'_>) -> T,
    ) -> T
    where
        T: Default,
    {
        let Some(ar) = self.ars.get_mut(index) else {
            return T::default();
        };
        let mut shared = Shared {
            now,
            rpc: &mut self.rpc,
            dcp: &mut self.dcp,
            owners: &mut self.owners,
            events: &mut self.events,
            timeouts: &self.config.timeouts,
        };
        let before = ar.lookup.dcp;
        let exchanged = ar.phase.is_cyclic();
        let result = what(ar, &mut shared);
        let exchanges = ar.phase.is_cyclic();
        // who answers to its name later changes nothing any more
        if !ar.phase.is_starting()
            && let Some(id) = ar.lookup.dcp.take()
        {
            shared.dcp.cancel(id);
        }
        if ar.lookup.dcp != before {
            if let Some(dcp) = before {
                self.dcp_owners.remove(&dcp);
            }
            if let Some(dcp) = ar.lookup.dcp {
                self.dcp_owners.insert(dcp, ar.id);
            }
        }
        self.settle(index);
        self.note_start_up(now, index);
        if exchanged != exchanges {
            self.count_exchanging();
        }
        result
    }

    fn count_exchanging(&mut self) {
        let cyclic = self.ars.iter().filter(|ar| ar.phase.is_cyclic());
        let intervals = cyclic
            .filter_map(|ar| ar.provider.as_ref())
            .map(Provider::interval);
        self.exchanging = intervals.fold((0, Duration::MAX), |(count, shortest), interval| {
            (count + 1, shortest.min(interval))
        });
    }

    /// Lets another connection begin when the start-up of this one is over.
    fn note_start_up(&mut self, now: Instant, index: usize) {
        let Some(ar) = self.ars.get(index) else { return };
        let over = !ar.phase.is_starting() || ar.is_held();
        if over && self.starting.remove(&ar.id.slot) {
            self.start_waiting(now);
        }
    }

    /// Notes a connection's deadline, and that it may have something to send.
    fn settle(&mut self, index: usize) {
        let Some(ar) = self.ars.get_mut(index) else {
            return;
        };
        self.due.set(index, ar.poll_timeout());
        if !ar.queued {
            ar.queued = true;
            self.senders.push_back(ar.id.slot);
        }
    }

    fn handle_cyclic(&mut self, now: Instant, frame: &Frame<'_>) {
        let index = slot_of(frame.frame_id);
        let Some(ar) = self.ars.get_mut(index) else { return };
        let mut shared = Shared {
            now,
            rpc: &mut self.rpc,
            dcp: &mut self.dcp,
            owners: &mut self.owners,
            events: &mut self.events,
            timeouts: &self.config.timeouts,
        };
        if ar.handle_cyclic(&mut shared, frame) {
            self.last_input = Some(ar.id);
        }
        // a frame only moves the watchdog: nothing to send
        self.due.set(index, ar.poll_timeout());
    }

    /// An alarm's destination reference names the place of the connection.
    fn handle_alarm(&mut self, now: Instant, frame: &Frame<'_>) {
        let reference = frame.payload.first_chunk::<2>().map(|b| u16::from_be_bytes(*b));
        if let Some(index) = reference.and_then(|r| r.checked_sub(1)) {
            self.with(now, usize::from(index), |ar, shared| {
                ar.handle_alarm(shared, frame)
            });
        }
    }

    /// Passes DCP events to the connections that requested them, the others to the application.
    fn drain_dcp(&mut self, now: Instant) {
        while let Some(event) = self.dcp.poll_event() {
            let (id, last) = match &event {
                DcpEvent::Identified(id, ..) => (Some(*id), false),
                DcpEvent::IdentifyDone(id, ..) | DcpEvent::Done(id, _) => (Some(*id), true),
                DcpEvent::Hello(_) => (None, false),
            };
            if let DcpEvent::Identified(_, station, Some(sends)) = &event
                && station.ip.is_set()
            {
                self.rpc.note_answered(station.ip.address, *sends);
            }
            let owner = id.and_then(|id| {
                if last {
                    self.dcp_owners.remove(&id)
                } else {
                    self.dcp_owners.get(&id).copied()
                }
            });
            if let Some(owner) = owner {
                if self.get(owner).is_some_and(|ar| ar.lookup.dcp == id) {
                    self.with(now, usize::from(owner.slot), |ar, shared| {
                        ar.handle_dcp(shared, event)
                    });
                }
                continue;
            }
            self.events.push_back(match event {
                DcpEvent::Identified(id, station, _) => Event::Identified { id, station },
                DcpEvent::IdentifyDone(id, count, more) => Event::IdentifyDone { id, count, more },
                DcpEvent::Hello(station) => Event::Hello { station },
                DcpEvent::Done(id, result) => Event::DcpDone { id, result },
            });
        }
    }

    /// Passes results of calls to the connection or the application.
    fn drain_rpc(&mut self, now: Instant) {
        while let Some((id, reply)) = self.rpc.poll_event() {
            match self.owners.remove(&id) {
                Some(Owner::Ar(ar)) if self.get(ar).is_some() => {
                    self.with(now, usize::from(ar.slot), |ar, shared| {
                        ar.handle_reply(shared, id, &reply)
                    });
                }
                Some(Owner::Implicit { call, request }) => {
                    let result = record::check_read(&reply, &request);
                    self.events.push_back(Event::RecordDone { call, result });
                }
                _ => {}
            }
        }
    }

    /// Answers a call of a device: ApplicationReady.
    fn serve(&mut self, now: Instant, call: Call) {
        let reply = Reply {
            order: call.order,
            stub: call.stub,
        };
        let Call {
            key, source, order, ..
        } = call;
        let ready = if call_is_control(call.operation) {
            read_control(&reply).ok()
        } else {
            None
        };
        let Some((ndr, block, diff)) = ready else {
            self.server.reject(now, key, order, reject::UNSPECIFIED);
            return;
        };
        let status = self.application_ready(now, source, &block, diff);
        let mut blocks = Vec::new();
        if status.is_ok() {
            block.done().encode(&mut blocks);
        }
        let mut stub = Vec::new();
        let args_length = u32::try_from(blocks.len()).unwrap_or(u32::MAX);
        NdrResponse {
            status,
            args_length,
            args_maximum: ndr.args_maximum,
        }
        .encode(&mut stub, order);
        stub.bytes(&blocks);
        self.server.respond(now, key, stub);
    }

    fn application_ready(
        &mut self,
        now: Instant,
        source: SocketAddrV4,
        block: &ControlBlock,
        diff: Option<ModuleDiff>,
    ) -> PnioStatus {
        let found = self.ars.iter().position(|ar| {
            ar.phase != Phase::Closed && ar.identity.ar_uuid == block.ar_uuid && ar.ip() == *source.ip()
        });
        let Some(index) = found else { return UNKNOWN_AR };
        let expected = self.ars.get(index).map(|ar| ar.identity.session_key);
        if expected != Some(block.session_key) {
            return FAULTY_SESSION_KEY;
        }
        match (block.block_type, block.command) {
            (BlockType::APPLICATION_READY, ControlCommand::APPLICATION_READY) => {
                let taken = self.with(now, index, |ar, shared| ar.application_ready(shared, diff));
                if taken { PnioStatus::OK } else { WRONG_STATE }
            }
            (BlockType::APPLICATION_READY_PLUG, ControlCommand::APPLICATION_READY) => PnioStatus::OK,
            _ => FAULTY_COMMAND,
        }
    }
}

/// DD 81 40 05.
const UNKNOWN_AR: PnioStatus = PnioStatus::control(0x40, 0x05);
/// DD 81 16 06.
const FAULTY_SESSION_KEY: PnioStatus = PnioStatus::control(0x16, 0x06);
/// DD 81 16 08.
const FAULTY_COMMAND: PnioStatus = PnioStatus::control(0x16, 0x08);
/// DD 81 3E 00.
const WRONG_STATE: PnioStatus = PnioStatus::control(0x3E, 0x00);

const fn call_is_control(number: u16) -> bool {
    number == operation::CONTROL
}

/// NDR header, control block, and the module difference behind it if there is one.
fn read_control(call: &Reply) -> Result<(NdrRequest, ControlBlock, Option<ModuleDiff>), DecodeError> {
    let mut reader = Reader::with_base(&call.stub, HEADER_LENGTH);
    let ndr = NdrRequest::decode(&mut reader, call.order)?;
    let first = Block::decode(&mut reader)?;
    let block = ControlBlock::decode(first.block_type, first.body)?;
    let mut diff = None;
    for block in Blocks::new(reader) {
        let block = block?;
        if block.block_type == BlockType::MODULE_DIFF {
            diff = Some(ModuleDiff::decode(block.body)?);
        }
    }
    Ok((ndr, block, diff))
}

impl Endpoint for Controller {
    fn mac(&self) -> MacAddress {
        self.config.mac
    }

    fn ip(&self) -> IpSuite {
        self.config.ip
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        let Some(frame) = Frame::parse(frame) else { return };
        let for_us = frame.destination == self.config.mac || frame.destination.is_multicast();
        if !for_us || frame.source == self.config.mac {
            return;
        }
        match frame.frame_id.kind() {
            FrameKind::RtClass1 | FrameKind::RtClass2 => self.handle_cyclic(now, &frame),
            FrameKind::AlarmHigh | FrameKind::AlarmLow => self.handle_alarm(now, &frame),
            FrameKind::DcpHello | FrameKind::DcpGetSet | FrameKind::DcpIdentifyResponse => {
                self.dcp.handle_frame(&frame);
                self.drain_dcp(now);
            }
            _ => {}
        }
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        if local_port == RPC_PORT {
            if let Some(call) = self.server.handle(now, source, payload) {
                self.serve(now, call);
            }
        } else if local_port == self.config.client_port && self.rpc.handle(now, source, payload) {
            self.drain_rpc(now);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.dcp.handle_timeout(now);
        self.drain_dcp(now);
        self.rpc.handle_timeout(now);
        self.drain_rpc(now);
        self.server.handle_timeout(now);
        // each once: what is due stays due until it is sent
        let mut due = core::mem::take(&mut self.ready);
        while self.due.earliest().is_some_and(|at| at <= now) {
            let Some(index) = self.due.earliest_index() else {
                break;
            };
            self.due.set(index, None);
            due.push(index);
        }
        for index in due.drain(..) {
            self.with(now, index, |ar, shared| ar.handle_timeout(shared));
        }
        self.ready = due;
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        while let Some(slot) = self.senders.front() {
            let index = usize::from(*slot);
            let Some(ar) = self.ars.get_mut(index) else {
                self.senders.pop_front();
                continue;
            };
            if let Some(length) = ar.poll_transmit(now, buffer) {
                return Some(Transmit::Frame { length });
            }
            ar.queued = false;
            // the alarm channel counts from the moment of sending, the provider to its next interval
            self.due.set(index, ar.poll_timeout());
            self.senders.pop_front();
        }
        if let Some(length) = self.dcp.poll_transmit(now, self.config.mac, buffer) {
            return Some(Transmit::Frame { length });
        }
        let (source_port, (destination, length)) = match self.rpc.poll_transmit(now, buffer) {
            Some(datagram) => (self.config.client_port, datagram),
            None => (RPC_PORT, self.server.poll_transmit(now, buffer)?),
        };
        Some(Transmit::Datagram {
            destination,
            source_port,
            length,
        })
    }

    fn poll_timeout(&self) -> Option<Instant> {
        Instant::earliest([
            self.due.earliest(),
            self.dcp.poll_timeout(),
            self.rpc.poll_timeout(),
            self.server.poll_timeout(),
        ])
    }

    fn may_wait(&self) -> Duration {
        match self.exchanging {
            (TOGETHER.., shortest) => (shortest / PARTS).min(LONGEST_WAIT),
            _ => Duration::ZERO,
        }
    }
}
