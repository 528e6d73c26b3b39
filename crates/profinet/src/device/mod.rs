//! An IO device: found and named by DCP, connected by a controller, read by tools, exchanging cyclic data.
//!
//! IEC 61158-6-10, CMDEV and the machines around it. [`Device`] is a protocol engine: bytes and time in, bytes, events
//! and the next deadline out. The application gives the data a meaning: it sets inputs with
//! [`set_input`](Device::set_input), reads outputs with [`output`](Device::output) and answers the records that the
//! engine does not implement.

mod ar;
mod check;
mod config;
mod connect;
mod content;
mod dcp;
mod event;
mod history;
mod image;
mod limit;
mod mib;
mod port;
mod records;
mod slots;

pub use crate::wire::block::RecordAddress;
pub use config::{
    DeviceConfig, Identity, ImRecords, ModuleDescription, Refusals, ResetMode, Stored, StoredError,
    SubmoduleDescription,
};
pub use event::{ArKey, ArKind, Event, SetRefusal, Token};
pub use image::RaiseError;
pub use mib::COMMUNITY;
pub use port::DirectionCounts;

use alloc::collections::VecDeque;
use alloc::string::String;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};

use ar::{AccessAr, IoAr, Trigger};
use content::PortRecord;
use dcp::DcpState;
use history::{Diagnoses, LogBook};
use port::Port;
use records::Job;
use slots::Slots;

use crate::alarm::AlarmEvent;
use crate::cyclic::{Consumer, Timing};
use crate::rpc::{
    Call, Client, ClientConfig, EndpointMapper, Interface, Registration, Server, ServerLimits, annotation,
};
use crate::wire::alarm::Notification;
use crate::wire::ethernet::{DCP_IDENTIFY, Frame, FrameId, FrameKind};
use crate::wire::lldp;
use crate::wire::rpc::{EPM_LOOKUP_FREE, NdrRequest, operation};
use crate::wire::snmp::PORT as SNMP_PORT;
use crate::wire::status::abort;
use crate::wire::{PnioStatus, Reader, Uuid, UuidSource};
use crate::{Endpoint, Instant, IpSuite, MacAddress, RPC_PORT, Traffic, Transmit};

/// Local UDP port of the device's own calls (ApplicationReady).
pub const CLIENT_PORT: u16 = 0xC0DE;
/// Number of queued events for a slow application; the oldest are dropped.
const EVENTS: usize = 256;
/// Frames that may wait to be sent besides cyclic ones.
const FRAMES: usize = 16;

/// The protocol engine of an IO device.
///
/// Rule of use: `handle_*`, then [`poll_event`](Self::poll_event) and `poll_transmit` until both are empty, then
/// sleep until `poll_timeout`. When [`next_cycle`](Self::next_cycle) is reached, step the application and set the
/// inputs first, then call `handle_timeout`: the input frame then goes out with the next `poll_transmit`.
///
/// ```
/// use profidrive_profinet::device::{Device, DeviceConfig, Identity, ModuleDescription, Stored, SubmoduleDescription};
/// use profidrive_profinet::{Endpoint, MacAddress};
///
/// let identity = Identity {
///     vendor_id: 0x0105, device_id: 1, instance: 1, station_type: "AKD".into(), order_id: "AKD-P00306".into(),
///     serial_number: "0001".into(), hardware_revision: 1, software_prefix: 'V', software_revision: [1, 0, 0],
///     profile_id: 0x3A00, profile_specific_type: 0,
/// };
/// let submodule = |subslot, ident| SubmoduleDescription { subslot, ident, api: 0, input_length: 0, output_length: 0 };
/// let access_point = ModuleDescription {
///     ident: 1, slots: vec![0], submodules: vec![submodule(1, 1), submodule(0x8000, 2), submodule(0x8001, 3)],
/// };
/// let config = DeviceConfig::new(MacAddress([2, 0, 0, 0, 0, 1]), identity, vec![access_point]);
/// let device = Device::new(config, Stored { name: "akd-1".into(), ..Stored::default() });
/// assert_eq!(device.name(), "akd-1");
/// // a device announces itself to its neighbour without a request
/// assert_eq!(device.poll_timeout(), Some(profidrive_profinet::Instant::ZERO));
/// ```
#[derive(Debug)]
pub struct Device {
    config: DeviceConfig,
    name: String,
    name_permanent: bool,
    ip: IpSuite,
    ip_permanent: bool,
    im: ImRecords,
    slots: Slots,
    controller: Option<IoAr>,
    tools: Vec<AccessAr>,
    jobs: Vec<Job>,
    diagnoses: Diagnoses,
    log: LogBook,
    interface_adjust: Vec<u8>,
    port_records: Vec<PortRecord>,
    port: Port,
    /// Answers to SNMP that wait to be sent.
    answers: VecDeque<(SocketAddrV4, Vec<u8>)>,
    /// First time that was reported.
    started: Option<Instant>,
    server: Server,
    client: Client,
    mapper: EndpointMapper,
    uuids: UuidSource,
    dcp: DcpState,
    events: VecDeque<Event>,
    frames: VecDeque<Vec<u8>>,
    /// Identify answers that wait for their time, earliest first.
    delayed: VecDeque<(Instant, Vec<u8>)>,
    cycle_due: bool,
    /// Until this time nothing but cyclic data is to be done; `None` when that has to be looked at. Of thousands of devices in
    /// one process each finds its memory cold in every cycle, so what it does not look at counts.
    quiet_until: Option<Instant>,
    /// The application moves something.
    operating: bool,
    next_ar: u32,
    next_token: u32,
}

impl Device {
    /// Creates a device as after a restart: with its non-volatile data, without ARs.
    #[must_use]
    pub fn new(config: DeviceConfig, stored: Stored) -> Self {
        let mut uuids = UuidSource::new(config.seed);
        let interfaces = alloc::vec![
            Interface {
                uuid: Uuid::DEVICE_INTERFACE,
                operations: operation::COUNT
            },
            Interface {
                uuid: Uuid::ENDPOINT_MAPPER,
                operations: EPM_LOOKUP_FREE + 1
            },
        ];
        Self {
            slots: Slots::new(&config),
            mapper: EndpointMapper::new(uuids.bits()),
            uuids,
            config,
            name: stored.name,
            name_permanent: true,
            ip: stored.ip,
            ip_permanent: true,
            im: stored.im,
            controller: None,
            tools: Vec::new(),
            jobs: Vec::new(),
            diagnoses: Diagnoses::default(),
            log: LogBook::default(),
            interface_adjust: Vec::new(),
            port_records: Vec::new(),
            port: Port::default(),
            answers: VecDeque::new(),
            started: None,
            server: Server::new(interfaces, ServerLimits::default()),
            client: Client::new(ClientConfig::default()),
            dcp: DcpState::default(),
            events: VecDeque::new(),
            frames: VecDeque::new(),
            delayed: VecDeque::new(),
            cycle_due: false,
            quiet_until: None,
            operating: false,
            next_ar: 0,
            next_token: 0,
        }
    }

    /// Returns the next event for the application.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Returns the configuration, fixed at the start.
    #[must_use]
    pub const fn config(&self) -> &DeviceConfig {
        &self.config
    }

    /// Returns the name of station, empty for none.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Takes an address that no DCP set: of switches, of a DHCP server, a link-local one. A change ends every connection.
    pub fn take_address(&mut self, now: Instant, suite: IpSuite) {
        self.quiet_until = None;
        if self.ip != suite {
            self.close_all(now, PnioStatus::aborted(abort::CLOSED));
            self.ip = suite;
            self.ip_permanent = false;
            self.port.announce();
        }
    }

    /// I&M1 to 4.
    #[must_use]
    pub const fn im(&self) -> &ImRecords {
        &self.im
    }

    /// Returns the module in a slot.
    #[must_use]
    pub fn plugged_module(&self, slot: u16) -> Option<&ModuleDescription> {
        self.slots.module(&self.config.modules, slot)
    }

    /// ModuleIdentNumber of what is plugged in a slot.
    #[must_use]
    pub fn plugged(&self, slot: u16) -> Option<u32> {
        self.slots
            .module(&self.config.modules, slot)
            .map(|module| module.ident)
    }

    fn event(&mut self, event: Event) {
        if self.events.len() >= EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    fn send_frame(&mut self, frame: Vec<u8>) {
        if self.frames.len() < FRAMES {
            self.frames.push_back(frame);
        }
    }

    fn call(&mut self, now: Instant, call: &Call) {
        if call.interface == Uuid::ENDPOINT_MAPPER {
            let identity = &self.config.identity;
            let station = Registration {
                interface: Uuid::DEVICE_INTERFACE,
                object: Uuid::object(identity.instance, identity.device_id, identity.vendor_id),
                annotation: annotation(
                    &identity.station_type,
                    &identity.order_id,
                    identity.hardware_revision,
                    u8::try_from(identity.software_prefix).unwrap_or(b'V'),
                    identity.software_revision,
                ),
                address: self.ip.address,
            };
            match self
                .mapper
                .call(now, call.operation, call.order, &call.stub, &station)
            {
                Ok(stub) => self.server.respond(now, call.key, stub),
                Err(status) => self.server.reject(now, call.key, call.order, status),
            }
            return;
        }
        let mut reader = Reader::new(&call.stub);
        let Ok(ndr) = NdrRequest::decode(&mut reader, call.order) else {
            let status = PnioStatus::new(records::service_code(call.operation), 0x81, check::RPC, 0);
            return self.answer(now, call, 0, Err(status));
        };
        let room = ndr.args_maximum;
        let result = match call.operation {
            operation::CONNECT => self.connect(now, call.source, room, reader),
            operation::RELEASE => self.release(now, call, reader),
            operation::CONTROL => self.control(now, call, reader),
            operation::WRITE => return self.write(now, call, room, reader),
            operation => {
                return self.read(now, call, room, reader, operation == operation::READ_IMPLICIT);
            }
        };
        self.answer(now, call, room, result);
    }

    fn handle_cyclic(&mut self, now: Instant, frame: &Frame<'_>) {
        let Some(io) = &mut self.controller else { return };
        let Ok(accepted) = io.consumer.handle(now, frame) else {
            return;
        };
        if self.config.follow_controller && io.same_interval {
            io.provider.follow(now);
        }
        let key = io.key;
        let run = accepted.status.is_run();
        let run_changed = io.run != Some(run);
        io.run = Some(run);
        let next = io.phase.after(Trigger::ValidOutput);
        if let Some(next) = next {
            io.phase = next;
            io.activity.stop();
            self.quiet_until = None;
        }
        if next.is_some() {
            self.event(Event::DataExchange { ar: key });
        }
        if run_changed {
            self.event(Event::ProviderState { ar: key, run });
        }
    }

    fn handle_alarm(&mut self, now: Instant, event: AlarmEvent) {
        let Some(io) = &mut self.controller else { return };
        match event {
            AlarmEvent::Raised(alarm) => refuse_alarm(io, &alarm),
            AlarmEvent::Acknowledged(ack) => {
                let event = Event::AlarmAcknowledged {
                    ar: io.key,
                    alarm_type: ack.alarm_type,
                    sequence: ack.specifier.sequence(),
                    status: ack.status,
                };
                self.event(event);
            }
            AlarmEvent::Unanswered { .. } => {}
            AlarmEvent::AbortedByPeer(status) => self.close_controller(now, status, false),
            AlarmEvent::Failed(status) => self.close_controller(now, status, true),
        }
    }

    /// Ends or revives what did not get its data or its calls in time.
    fn supervise(&mut self, now: Instant) {
        let Some(io) = &mut self.controller else { return };
        if io.consumer.expire(now) {
            let starting = io.phase != ar::Phase::Data;
            if starting && io.request.properties.advanced() {
                // in advanced start-up outputs may pause until data is exchanged
                let timing = Timing {
                    send_clock_factor: io.output.send_clock_factor,
                    reduction_ratio: io.output.reduction_ratio,
                    phase: io.output.phase,
                };
                io.consumer = Consumer::new(
                    io.consumer.source(),
                    io.consumer.frame_id(),
                    timing,
                    io.output.data_hold_factor,
                    io.consumer.layout().clone(),
                );
            } else {
                return self.close_controller(now, PnioStatus::aborted(abort::DATA_HOLD), true);
            }
        }
        if io.activity.is_over(now) {
            return self.close_controller(now, PnioStatus::aborted(abort::ACTIVITY_TIMEOUT), true);
        }
        while let Some(event) = self
            .controller
            .as_mut()
            .and_then(|io| io.alarms.handle_timeout(now))
        {
            self.handle_alarm(now, event);
        }
    }
}

/// A controller has nothing to alarm a device about.
fn refuse_alarm(io: &mut IoAr, alarm: &Notification<'_>) {
    io.alarms.acknowledge(alarm, PnioStatus::new(0xDA, 0x81, 0x3C, 0));
}

impl Endpoint for Device {
    fn mac(&self) -> MacAddress {
        self.config.mac
    }

    fn ip(&self) -> IpSuite {
        // the own address as gateway means none
        let own = self.ip.gateway == self.ip.address;
        let gateway = if own {
            Ipv4Addr::UNSPECIFIED
        } else {
            self.ip.gateway
        };
        IpSuite { gateway, ..self.ip }
    }

    fn name(&self) -> Option<&str> {
        Some(&self.name)
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        let Some(frame) = Frame::parse(frame) else {
            self.quiet_until = None;
            if self.config.neighbourhood
                && let Some((source, payload)) = lldp::payload(frame)
                && source != self.config.mac
            {
                self.port.neighbours.receive(now, source, payload);
            }
            return;
        };
        let mine = frame.destination == self.config.mac;
        if !(mine || frame.destination == DCP_IDENTIFY) || frame.source == self.config.mac {
            return;
        }
        if mine && frame.frame_id.is_cyclic() {
            return self.handle_cyclic(now, &frame);
        }
        if frame.frame_id == FrameId::DCP_IDENTIFY_REQUEST {
            // every device of a plant gets those for all others
            return self.handle_dcp(now, &frame);
        }
        self.quiet_until = None;
        match frame.frame_id {
            FrameId::DCP_GET_SET => self.handle_dcp(now, &frame),
            id if mine && matches!(id.kind(), FrameKind::AlarmHigh | FrameKind::AlarmLow) => {
                let event = self
                    .controller
                    .as_mut()
                    .and_then(|io| io.alarms.handle_frame(now, &frame));
                if let Some(event) = event {
                    self.handle_alarm(now, event);
                }
            }
            _ => {}
        }
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.quiet_until = None;
        match local_port {
            RPC_PORT => {
                if let Some(call) = self.server.handle(now, source, payload) {
                    self.call(now, &call);
                }
            }
            CLIENT_PORT => {
                self.client.handle(now, source, payload);
                self.take_answers(now);
            }
            SNMP_PORT if self.config.neighbourhood => self.handle_snmp(now, source, payload),
            _ => {}
        }
    }

    fn serves(&self, port: u16) -> bool {
        port == RPC_PORT || (port == SNMP_PORT && self.config.neighbourhood)
    }

    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        self.count(traffic, frame);
    }

    fn handle_timeout(&mut self, now: Instant) {
        if self.controller.as_ref().is_some_and(|io| io.provider.is_due(now)) {
            self.cycle_due = true;
        }
        let lost = self.controller.as_ref().and_then(|io| io.consumer.deadline());
        if self.quiet_until.is_some_and(|until| now < until) && lost.is_none_or(|lost| now < lost) {
            return;
        }
        self.quiet_until = None;
        while let Some((due, _)) = self.delayed.front() {
            if *due > now {
                break;
            }
            if let Some((_, frame)) = self.delayed.pop_front() {
                self.send_frame(frame);
            }
        }
        self.started.get_or_insert(now);
        if self.config.neighbourhood {
            self.port.handle_timeout(now, self.config.mac);
        }
        self.supervise(now);
        while let Some(index) = self.tools.iter().position(|tool| tool.activity.is_over(now)) {
            if let Some(key) = self.tools.get(index).map(|tool| tool.key) {
                self.abort(now, key, abort::ACTIVITY_TIMEOUT);
            }
        }
        self.expire_jobs(now);
        self.server.handle_timeout(now);
        self.client.handle_timeout(now);
        self.take_answers(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        if self.cycle_due {
            self.cycle_due = false;
            let io = self.controller.as_mut();
            if let Some(length) = io.and_then(|io| io.provider.emit(now, buffer)) {
                return Some(Transmit::Frame { length });
            }
        }
        if self.quiet_until.is_some() {
            return None;
        }
        let transmit = self.transmit_acyclic(now, buffer);
        if transmit.is_none() {
            self.quiet_until = Some(self.next_acyclic().unwrap_or(Instant::MAX));
        }
        transmit
    }

    fn poll_timeout(&self) -> Option<Instant> {
        let acyclic = match self.quiet_until {
            Some(until) => {
                debug_assert_eq!(self.next_acyclic().unwrap_or(Instant::MAX), until);
                Some(until).filter(|until| *until != Instant::MAX)
            }
            None => self.next_acyclic(),
        };
        let io = self.controller.as_ref();
        Instant::earliest([
            io.map(|io| io.provider.next_send()),
            io.and_then(|io| io.consumer.deadline()),
            acyclic,
        ])
    }
}

impl Device {
    /// Writes the next frame or datagram that is not cyclic.
    fn transmit_acyclic(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        if let Some(frame) = self.frames.pop_front()
            && let Some(place) = buffer.get_mut(..frame.len())
        {
            place.copy_from_slice(&frame);
            return Some(Transmit::Frame { length: frame.len() });
        }
        if let Some(length) = self
            .controller
            .as_mut()
            .and_then(|io| io.alarms.poll_transmit(now, buffer))
        {
            return Some(Transmit::Frame { length });
        }
        if let Some((destination, length)) = self.server.poll_transmit(now, buffer) {
            return Some(Transmit::Datagram {
                destination,
                source_port: RPC_PORT,
                length,
            });
        }
        if let Some((destination, length)) = self.client.poll_transmit(now, buffer) {
            return Some(Transmit::Datagram {
                destination,
                source_port: CLIENT_PORT,
                length,
            });
        }
        // what is not urgent comes last
        if let Some((destination, length)) = self.emit_snmp(buffer) {
            return Some(Transmit::Datagram {
                destination,
                source_port: SNMP_PORT,
                length,
            });
        }
        let length = self.emit_lldp(buffer).filter(|_| self.config.neighbourhood)?;
        Some(Transmit::Frame { length })
    }

    /// Returns the time when something other than cyclic data is due.
    fn next_acyclic(&self) -> Option<Instant> {
        let io = self.controller.as_ref();
        Instant::earliest([
            io.and_then(|io| io.activity.deadline()),
            io.and_then(|io| io.alarms.poll_timeout()),
            self.delayed.front().map(|(due, _)| *due),
            self.tools
                .iter()
                .filter_map(|tool| tool.activity.deadline())
                .min(),
            self.jobs.iter().map(|job| job.deadline).min(),
            self.server.poll_timeout(),
            self.client.poll_timeout(),
            self.port.poll_timeout().filter(|_| self.config.neighbourhood),
        ])
    }

    fn take_answers(&mut self, now: Instant) {
        while let Some((call, result)) = self.client.poll_event() {
            if self
                .controller
                .as_ref()
                .is_some_and(|io| io.ready_call == Some(call))
            {
                self.ready_answered(now, result);
            }
        }
    }
}

#[cfg(test)]
mod tests;
