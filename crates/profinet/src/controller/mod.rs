//! A PROFINET IO controller without I/O: finds and names devices, connects to them, exchanges cyclic data, reads and
//! writes records, acknowledges alarms.
//!
//! Every request returns a number at once; its result comes as an [`Event`]. See [`Endpoint`](crate::Endpoint) for how to drive it.

mod ar;
mod calls;
mod config;
mod connect;
mod dcp;
mod discovery;
mod engine;
mod error;
mod event;
mod exchange;
mod job;
mod lookup;
mod phase;
mod record;

pub use crate::wire::block::RecordAddress;
use config::MAX_CONNECTIONS;
pub use config::{
    ConnectConfig, ControllerConfig, ModuleConfig, Resolve, RtClass, StartUp, StartupRecord, SubmoduleConfig,
    Target, Timeouts,
};
pub use dcp::{Filter, IdentifyOptions};
pub use error::{DcpError, LostCause, Misuse, ServiceError};
pub use event::{ArId, CallId, DcpId, DcpReply, Event, Station};
pub use phase::Phase;
pub use record::MAX_RECORD;

use alloc::boxed::Box;
use alloc::collections::{BTreeMap, BTreeSet, VecDeque};
use alloc::vec::Vec;
use core::time::Duration;

use ar::{Ar, Owner, Purpose};
use connect::ArIdentity;
use dcp::DcpClient;
use discovery::unicast;

use crate::rpc::{self, ClientConfig, Interface, Server, ServerLimits};
use crate::wire::dcp::{check_ip, check_name};
use crate::wire::rpc::operation;
use crate::wire::{Uuid, UuidSource};
use crate::{Deadlines, Instant, IpSuite};

/// What makes the initiator of a connection for records another one than that of a controller.
const RECORDS_INSTANCE: u16 = 0x8000;

/// A controller.
///
/// ```
/// use profidrive_profinet::controller::{Controller, ControllerConfig, Event, Filter};
/// use profidrive_profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};
///
/// let mac = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);
/// let mut controller = Controller::new(ControllerConfig::new(mac, IpSuite::NONE, "plc", 1));
/// let id = controller.identify(Instant::ZERO, Filter::name("drive-1")).unwrap();
/// let mut buffer = [0; 1518];
/// let Some(Transmit::Frame { length }) = controller.poll_transmit(Instant::ZERO, &mut buffer) else { panic!() };
/// assert_eq!(buffer[..6], [0x01, 0x0E, 0xCF, 0, 0, 0]);
/// // no device answers
/// while let Some(due) = controller.poll_timeout() {
///     controller.handle_timeout(due);
///     while controller.poll_transmit(due, &mut buffer).is_some() {}
/// }
/// assert_eq!(controller.poll_event(), Some(Event::IdentifyDone { id, count: 0, more: false }));
/// ```
#[derive(Debug)]
pub struct Controller {
    config: ControllerConfig,
    dcp: DcpClient,
    dcp_owners: BTreeMap<DcpId, ArId>,
    rpc: rpc::Client,
    server: Server,
    owners: BTreeMap<rpc::CallId, Owner>,
    ars: Vec<Ar>,
    /// When something is due per place of `ars`.
    due: Deadlines,
    /// Connections whose start-up is under way, by their places.
    starting: BTreeSet<u16>,
    /// Those that wait until another start-up is over.
    waiting: VecDeque<ArId>,
    /// Places that are due in this turn; kept for its memory.
    ready: Vec<usize>,
    /// Places of `ars` that may have a frame to send.
    senders: VecDeque<u16>,
    events: VecDeque<Event>,
    /// The connection whose inputs came last.
    last_input: Option<ArId>,
    /// Connections that exchange cyclic data, and the shortest of their update times.
    exchanging: (usize, Duration),
    uuids: UuidSource,
    session: u16,
    next_call: u32,
}

/// Start-ups at once: each takes some ten datagrams, and a device that waits too long for the next one, or for cyclic data
/// from a controller that is busy with all the others, gives up.
const MAX_STARTING: usize = 64;

/// Activities of devices that are stored: each device calls with one of its own when it becomes ready, and may start
/// again.
const fn activities(connections: usize) -> usize {
    connections * 2 + 16
}

impl Controller {
    /// Creates a controller without connections.
    #[must_use]
    pub fn new(config: ControllerConfig) -> Self {
        let mut uuids = UuidSource::new(config.seed);
        let [a, b, c, d, ..] = uuids.uuid().0;
        let client = ClientConfig {
            wait: config.timeouts.call,
            sends: config.timeouts.call_sends,
            limit: config.timeouts.call_limit,
            ..ClientConfig::default()
        };
        let limits = ServerLimits {
            activities: activities(0),
            activities_per_address: 8,
            stub: 64 * 1024,
        };
        let interface = Interface {
            uuid: Uuid::CONTROLLER_INTERFACE,
            operations: operation::CONTROL + 1,
        };
        Self {
            dcp: DcpClient::new(config.timeouts, u32::from_be_bytes([a, b, c, d])),
            dcp_owners: BTreeMap::new(),
            rpc: rpc::Client::new(client),
            server: Server::new(alloc::vec![interface], limits),
            owners: BTreeMap::new(),
            ars: Vec::new(),
            due: Deadlines::default(),
            starting: BTreeSet::new(),
            waiting: VecDeque::new(),
            ready: Vec::new(),
            senders: VecDeque::new(),
            events: VecDeque::new(),
            last_input: None,
            exchanging: (0, Duration::ZERO),
            session: u16::from_be_bytes([a, d]),
            next_call: 0,
            uuids,
            config,
        }
    }

    /// Returns its configuration.
    #[must_use]
    pub const fn config(&self) -> &ControllerConfig {
        &self.config
    }

    /// Sets another IP configuration; open connections keep the old one.
    pub const fn set_ip(&mut self, ip: IpSuite) {
        self.config.ip = ip;
    }

    /// Returns true while [`poll_event`](Self::poll_event) has an event.
    #[must_use]
    pub fn has_event(&self) -> bool {
        !self.events.is_empty()
    }

    /// Returns the connection whose inputs the last frame brought, once. Inputs are no events: with hundreds of connections
    /// whoever follows one of them need not look at all.
    pub const fn take_input(&mut self) -> Option<ArId> {
        self.last_input.take()
    }

    /// Returns the next thing that happened.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Connects cyclically. Events: `Connected`, `Ready`, `Running`, or `Lost` at any point.
    ///
    /// # Errors
    /// When the configuration cannot be, the target is incomplete, or too many connections are open.
    pub fn connect(&mut self, now: Instant, target: Target, config: ConnectConfig) -> Result<ArId, Misuse> {
        let (input, output) = connect::check_config(&config)?;
        let resolve = config.resolve;
        let purpose = Purpose::Cyclic {
            config: Box::new(config),
            input,
            output,
        };
        self.open(now, target, purpose, resolve)
    }

    /// Opens a connection for records only (device access), independent of the controller that runs the device. It is
    /// kept alive until released. Events: `Connected` or `Lost`.
    ///
    /// # Errors
    /// When the target is incomplete or too many connections are open.
    pub fn connect_device_access(
        &mut self,
        now: Instant,
        target: Target,
        resolve: Resolve,
    ) -> Result<ArId, Misuse> {
        self.open(
            now,
            target,
            Purpose::Access {
                activity_timeout_factor: 100,
            },
            resolve,
        )
    }

    /// Ends a start-up that is [held](ConnectConfig::hold_start_up). Events: `Ready`, `Running`, or `Lost`.
    ///
    /// # Errors
    /// When there is no such connection, or its start-up is not held.
    pub fn end_start_up(&mut self, now: Instant, ar: ArId) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        if !self.get(ar).is_some_and(Ar::is_held) {
            return Err(Misuse::NotOpenYet);
        }
        self.with(now, index, Ar::end_start_up);
        Ok(())
    }

    /// Returns the ARUUID of a connection, as the device lists it in ARData.
    #[must_use]
    pub fn ar_uuid(&self, ar: ArId) -> Option<Uuid> {
        self.get(ar).map(|ar| ar.identity.ar_uuid)
    }

    fn open(
        &mut self,
        now: Instant,
        target: Target,
        purpose: Purpose,
        resolve: Resolve,
    ) -> Result<ArId, Misuse> {
        match resolve {
            Resolve::Trust if !target.ip.is_set() => return Err(Misuse::Incomplete("IP address")),
            Resolve::Trust => {}
            Resolve::Check | Resolve::SetIp if target.name.is_empty() => {
                return Err(Misuse::Incomplete("name"));
            }
            Resolve::SetIp => check_ip(&target.ip)?,
            Resolve::Check => {}
        }
        if let Some(mac) = target.mac {
            unicast(mac)?;
        }
        let station_name = self.config.station_name.as_bytes().to_vec();
        check_name(&station_name)?;
        let id = self.place()?;
        self.session = self.session.wrapping_add(1);
        // a device ends the AR of an initiator that connects again: another program on this computer may control it
        let records = matches!(&purpose, Purpose::Cyclic { config, .. } if config.hold_start_up);
        let instance = self.config.instance ^ if records { RECORDS_INSTANCE } else { 0 };
        let identity = ArIdentity {
            ar_uuid: self.uuids.uuid(),
            session_key: self.session,
            mac: self.config.mac,
            object: Uuid::object(instance, self.config.device_id, self.config.vendor_id),
            station_name,
        };
        let mut ar = Ar::new(now, id, target, identity, self.uuids.uuid(), purpose);
        ar.lookup.resolve = resolve;
        let index = usize::from(id.slot);
        match self.ars.get_mut(index) {
            Some(place) => *place = ar,
            None => {
                self.ars.push(ar);
                self.due.push();
                self.server.set_activities(activities(self.ars.len()));
            }
        }
        self.waiting.push_back(id);
        self.start_waiting(now);
        Ok(id)
    }

    /// Lets connections begin their start-up, as many as there may be at once.
    fn start_waiting(&mut self, now: Instant) {
        while self.starting.len() < MAX_STARTING {
            let Some(id) = self.waiting.pop_front() else {
                return;
            };
            // released meanwhile, or its place is taken again
            if self.phase(id) == Some(Phase::Resolve) && self.starting.insert(id.slot) {
                self.with(now, usize::from(id.slot), Ar::start);
            }
        }
    }

    /// Returns a free place: that of the connection closed longest ago is as good as a new one.
    fn place(&self) -> Result<ArId, Misuse> {
        let closed = self.ars.iter().find(|ar| ar.phase == Phase::Closed && !ar.queued);
        if let Some(ar) = closed {
            return Ok(ArId {
                slot: ar.id.slot,
                generation: ar.id.generation.wrapping_add(1),
            });
        }
        let slot = u16::try_from(self.ars.len()).unwrap_or(u16::MAX);
        if slot >= self.config.max_connections.min(MAX_CONNECTIONS) {
            return Err(Misuse::TooMany("connections"));
        }
        Ok(ArId { slot, generation: 0 })
    }

    /// Ends a connection in order. Event: `Released`, at the latest when the device does not answer.
    ///
    /// # Errors
    /// When there is no such connection.
    pub fn release(&mut self, now: Instant, ar: ArId) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        self.with(now, index, Ar::release);
        Ok(())
    }

    /// Ends a connection at once and notifies the device by an ERR PDU. Event: `Lost`.
    ///
    /// # Errors
    /// When there is no such connection.
    pub fn abort(&mut self, now: Instant, ar: ArId) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        self.with(now, index, |ar, shared| ar.lose(shared, LostCause::Aborted));
        Ok(())
    }

    /// Returns the state of a connection; `None` if it never was or its place is taken again.
    #[must_use]
    pub fn phase(&self, ar: ArId) -> Option<Phase> {
        self.get(ar).map(|ar| ar.phase)
    }

    /// Returns the device of a connection, with what was found out about it.
    #[must_use]
    pub fn target(&self, ar: ArId) -> Option<&Target> {
        self.get(ar).map(|ar| &ar.target)
    }

    fn new_call(&mut self) -> CallId {
        self.next_call = self.next_call.wrapping_add(1);
        CallId(self.next_call)
    }

    fn get(&self, id: ArId) -> Option<&Ar> {
        self.ars.get(usize::from(id.slot)).filter(|ar| ar.id == id)
    }

    /// Place of an open connection.
    fn index(&self, id: ArId) -> Result<usize, Misuse> {
        match self.get(id) {
            Some(ar) if ar.phase != Phase::Closed => Ok(usize::from(id.slot)),
            _ => Err(Misuse::UnknownConnection),
        }
    }

    fn records_index(&self, id: ArId) -> Result<usize, Misuse> {
        let index = self.index(id)?;
        match self.get(id) {
            Some(ar) if ar.phase.takes_records() => Ok(index),
            _ => Err(Misuse::NotOpenYet),
        }
    }
}

#[cfg(test)]
mod tests;
