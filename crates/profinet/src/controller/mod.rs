//! A PROFINET IO controller without I/O: finds and names devices, connects to them, exchanges cyclic data, reads and
//! writes records, acknowledges alarms.
//!
//! Every request returns a number at once; its result comes as an [`Event`]. See [`Endpoint`](crate::Endpoint) for how to drive it.

mod ar;
mod config;
mod connect;
mod dcp;
mod engine;
mod error;
mod event;
mod job;
mod lookup;
mod phase;
mod record;

pub use config::{
    ConnectConfig, ControllerConfig, ModuleConfig, Resolve, RtClass, StartUp, StartupRecord, SubmoduleConfig,
    Target, Timeouts,
};
pub use dcp::{Filter, IdentifyOptions};
pub use error::{DcpError, LostCause, Misuse, ServiceError};
pub use event::{ArId, CallId, DcpId, DcpReply, Event, Station};
pub use phase::Phase;
pub use record::{MAX_RECORD, RecordAddress};

use alloc::boxed::Box;
use alloc::collections::{BTreeMap, VecDeque};
use alloc::vec::Vec;

use ar::{Ar, Op, Owner, Purpose};
use connect::ArIdentity;
use dcp::{DcpClient, Setting};
use job::Job;

use crate::cyclic::{CyclicStatistics, Provider};
use crate::rpc::{self, ClientConfig, Interface, Server, ServerLimits};
use crate::wire::dcp::{DcpOption, Qualifier, check_ip, check_name};
use crate::wire::rpc::{Header, operation};
use crate::wire::rt::{DataStatus, Iops};
use crate::wire::{Uuid, UuidSource};
use crate::{Instant, IpSuite, MacAddress, RPC_PORT};

/// A controller.
///
/// ```
/// use profinet::controller::{Controller, ControllerConfig, Event, Filter};
/// use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};
///
/// let mac = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);
/// let mut controller = Controller::new(ControllerConfig::new(mac, IpSuite::NONE, "plc", 1));
/// let id = controller.identify(Instant::ZERO, Filter::name("drive-1")).unwrap();
/// let mut buffer = [0; 1518];
/// let Some(Transmit::Frame { length }) = controller.poll_transmit(Instant::ZERO, &mut buffer) else { panic!() };
/// assert_eq!(buffer[..6], [0x01, 0x0E, 0xCF, 0, 0, 0]);
/// // nobody answers
/// while let Some(due) = controller.poll_timeout() {
///     controller.handle_timeout(due);
///     while controller.poll_transmit(due, &mut buffer).is_some() {}
/// }
/// assert_eq!(controller.poll_event(), Some(Event::IdentifyDone { id, count: 0 }));
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
    due: Vec<Instant>,
    /// Places of `ars` that may have a frame to send.
    senders: VecDeque<u16>,
    events: VecDeque<Event>,
    uuids: UuidSource,
    session: u16,
    next_call: u32,
}

impl Controller {
    /// A controller without connections.
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
        // every device calls with an activity of its own when it becomes ready
        let limits = ServerLimits {
            activities: usize::from(config.max_connections) * 2 + 16,
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
            due: Vec::new(),
            senders: VecDeque::new(),
            events: VecDeque::new(),
            session: u16::from_be_bytes([a, d]),
            next_call: 0,
            uuids,
            config,
        }
    }

    /// Its configuration.
    #[must_use]
    pub const fn config(&self) -> &ControllerConfig {
        &self.config
    }

    /// Gives it another IP configuration; open connections keep the old one.
    pub const fn set_ip(&mut self, ip: IpSuite) {
        self.config.ip = ip;
    }

    /// The next thing that happened.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    // ---- discovery and basic configuration

    /// Asks who is there, for 400 ms if one name is asked for, else for 1 s with spread answers.
    ///
    /// # Errors
    /// When the name is illegal or too many requests are open.
    pub fn identify(&mut self, now: Instant, filter: Filter) -> Result<DcpId, Misuse> {
        let one = filter.name.is_some() || filter.alias.is_some() || filter.mac.is_some();
        let options = if one {
            IdentifyOptions::ONE
        } else {
            IdentifyOptions::MANY
        };
        self.identify_with(now, filter, options)
    }

    /// The same with a window of the caller's choice.
    ///
    /// # Errors
    /// When the name is longer than a name can be, or too many requests are open. An illegal name may be looked for:
    /// somebody may have it.
    pub fn identify_with(
        &mut self,
        now: Instant,
        filter: Filter,
        options: IdentifyOptions,
    ) -> Result<DcpId, Misuse> {
        let too_long = [&filter.name, &filter.alias, &filter.station_type];
        if too_long.into_iter().flatten().any(|text| text.len() > 255) {
            return Err(Misuse::Range("length of the filter"));
        }
        self.dcp
            .identify(now, filter, options)
            .ok_or(Misuse::TooMany("DCP requests"))
    }

    /// Ends an Identify, Get or Set request; no further event will come for it.
    pub fn cancel_dcp(&mut self, id: DcpId) {
        self.dcp.cancel(id);
        self.events.retain(|event| {
            !matches!(event, Event::Identified { id: other, .. } | Event::IdentifyDone { id: other, .. }
                | Event::DcpDone { id: other, .. } if *other == id)
        });
    }

    /// Reads settings of the station `mac`.
    ///
    /// # Errors
    /// When the address is no station's, or too many requests are open.
    pub fn dcp_get(&mut self, now: Instant, mac: MacAddress, options: &[DcpOption]) -> Result<DcpId, Misuse> {
        if options.is_empty() || options.len() > 64 {
            return Err(Misuse::Range("number of options"));
        }
        unicast(mac)?;
        self.dcp
            .get(now, mac, options.to_vec())
            .ok_or(Misuse::TooMany("DCP requests"))
    }

    /// Gives the station `mac` a name, for good or until power-off. An empty name takes it away.
    ///
    /// # Errors
    /// When the name breaks a rule, the address is no station's, or too many requests are open.
    pub fn dcp_set_name(
        &mut self,
        now: Instant,
        mac: MacAddress,
        name: &str,
        permanent: bool,
    ) -> Result<DcpId, Misuse> {
        if !name.is_empty() {
            check_name(name.as_bytes())?;
        }
        self.set(now, mac, Setting::Name(qualifier(permanent)), Some(name))
    }

    /// Gives the station `mac` an IP configuration, for good or until power-off. All zero takes it away.
    ///
    /// # Errors
    /// When the configuration breaks a rule, the address is no station's, or too many requests are open.
    pub fn dcp_set_ip(
        &mut self,
        now: Instant,
        mac: MacAddress,
        ip: IpSuite,
        permanent: bool,
    ) -> Result<DcpId, Misuse> {
        check_ip(&ip)?;
        self.set(now, mac, Setting::Ip(qualifier(permanent), ip), None)
    }

    /// Lets the station `mac` blink.
    ///
    /// # Errors
    /// When the address is no station's, or too many requests are open.
    pub fn dcp_signal(&mut self, now: Instant, mac: MacAddress) -> Result<DcpId, Misuse> {
        self.set(now, mac, Setting::Signal, None)
    }

    /// Resets the station `mac`: mode 1 application data, 2 communication parameters, 3 engineering, 4 all stored
    /// data, 8 device, 9 reset and restore; mode 0 is the old form without mode, which resets everything.
    ///
    /// # Errors
    /// When there is no such mode, the address is no station's, or too many requests are open.
    pub fn dcp_reset(&mut self, now: Instant, mac: MacAddress, mode: u8) -> Result<DcpId, Misuse> {
        let setting = match mode {
            0 => Setting::LegacyReset,
            1..=4 | 8 | 9 => Setting::Reset(Qualifier::reset(mode)),
            _ => return Err(Misuse::Range("reset mode")),
        };
        self.set(now, mac, setting, None)
    }

    fn set(
        &mut self,
        now: Instant,
        mac: MacAddress,
        setting: Setting,
        name: Option<&str>,
    ) -> Result<DcpId, Misuse> {
        unicast(mac)?;
        self.dcp
            .set(now, mac, setting, name.map(Into::into))
            .ok_or(Misuse::TooMany("DCP requests"))
    }

    // ---- connections

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

    /// Opens a connection for records only (device access), beside whatever controller runs the device. It is kept
    /// alive until released. Events: `Connected` or `Lost`.
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
        let identity = ArIdentity {
            ar_uuid: self.uuids.uuid(),
            session_key: self.session,
            mac: self.config.mac,
            object: Uuid::object(self.config.instance, self.config.device_id, self.config.vendor_id),
            station_name,
        };
        let mut ar = Ar::new(now, id, target, identity, self.uuids.uuid(), purpose);
        ar.lookup.resolve = resolve;
        let index = usize::from(id.slot);
        match self.ars.get_mut(index) {
            Some(place) => *place = ar,
            None => {
                self.ars.push(ar);
                self.due.push(Instant::MAX);
            }
        }
        self.with(now, index, Ar::start);
        Ok(id)
    }

    /// A free place: that of the connection closed longest ago is as good as a new one.
    fn place(&self) -> Result<ArId, Misuse> {
        let closed = self.ars.iter().find(|ar| ar.phase == Phase::Closed && !ar.queued);
        if let Some(ar) = closed {
            return Ok(ArId {
                slot: ar.id.slot,
                generation: ar.id.generation.wrapping_add(1),
            });
        }
        let slot = u16::try_from(self.ars.len()).unwrap_or(u16::MAX);
        if slot >= self.config.max_connections.min(0x0FFF) {
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

    /// Ends a connection at once; the device is told by an ERR PDU. Event: `Lost`.
    ///
    /// # Errors
    /// When there is no such connection.
    pub fn abort(&mut self, now: Instant, ar: ArId) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        self.with(now, index, |ar, shared| ar.lose(shared, LostCause::Aborted));
        Ok(())
    }

    /// Where a connection stands; `None` if it never was or its place is taken again.
    #[must_use]
    pub fn phase(&self, ar: ArId) -> Option<Phase> {
        self.get(ar).map(|ar| ar.phase)
    }

    /// The device of a connection, with what was found out about it.
    #[must_use]
    pub fn target(&self, ar: ArId) -> Option<&Target> {
        self.get(ar).map(|ar| &ar.target)
    }

    // ---- records

    /// Reads a record of at most `length` octets. Event: `RecordDone`.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn read(&mut self, now: Instant, ar: ArId, at: RecordAddress, length: u32) -> Result<CallId, Misuse> {
        if length > MAX_RECORD {
            return Err(Misuse::Range("record length"));
        }
        self.call(now, ar, |call| Op::Read { call, at, length })
    }

    /// Writes a record. Event: `RecordDone` without data.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn write(
        &mut self,
        now: Instant,
        ar: ArId,
        at: RecordAddress,
        data: &[u8],
    ) -> Result<CallId, Misuse> {
        if data.len() > MAX_RECORD as usize {
            return Err(Misuse::Range("record length"));
        }
        self.call(now, ar, |call| Op::Write {
            call,
            at,
            data: data.to_vec(),
        })
    }

    /// Writes several records in one request. Event: `WritesDone`.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too much is to be written at once.
    pub fn write_multiple(
        &mut self,
        now: Instant,
        ar: ArId,
        records: &[(RecordAddress, Vec<u8>)],
    ) -> Result<CallId, Misuse> {
        let octets: usize = records.iter().map(|(_, data)| data.len() + 64 + 3).sum();
        if records.is_empty() || octets > MAX_RECORD as usize {
            return Err(Misuse::Range("length of all records"));
        }
        self.call(now, ar, |call| Op::WriteMany {
            call,
            records: records.to_vec(),
        })
    }

    fn call(&mut self, now: Instant, ar: ArId, op: impl FnOnce(CallId) -> Op) -> Result<CallId, Misuse> {
        let index = self.records_index(ar)?;
        let call = self.new_call();
        let op = op(call);
        let taken = self.with(now, index, |ar, shared| ar.push(shared, op));
        if taken {
            Ok(call)
        } else {
            Err(Misuse::TooMany("record requests"))
        }
    }

    /// Does one job on a parameter channel: writes `request` to the record, reads the answer from it, waits and
    /// repeats as long as the device says "not ready" (10 to 50 ms apart, 10 s altogether unless configured
    /// otherwise). Jobs of a connection are done one after the other. Event: `RecordDone` with the answer.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn parameter_job(
        &mut self,
        now: Instant,
        ar: ArId,
        at: RecordAddress,
        request: &[u8],
    ) -> Result<CallId, Misuse> {
        if request.len() > MAX_RECORD as usize {
            return Err(Misuse::Range("record length"));
        }
        let index = self.records_index(ar)?;
        let call = self.new_call();
        let job = Job::new(
            now,
            call,
            at,
            request.to_vec(),
            self.config.timeouts.parameter_job,
        );
        let taken = self.with(now, index, |ar, shared| ar.push_job(shared, job));
        if taken {
            Ok(call)
        } else {
            Err(Misuse::TooMany("parameter jobs"))
        }
    }

    /// Reads a record without a connection. Event: `RecordDone`.
    ///
    /// # Errors
    /// When the target has no IP address, or too many requests are open.
    pub fn read_implicit(
        &mut self,
        now: Instant,
        target: &Target,
        at: RecordAddress,
        length: u32,
    ) -> Result<CallId, Misuse> {
        if !target.ip.is_set() {
            return Err(Misuse::Incomplete("IP address"));
        }
        if length > MAX_RECORD {
            return Err(Misuse::Range("record length"));
        }
        if self.owners.len() >= 4096 {
            return Err(Misuse::TooMany("record requests"));
        }
        let call = self.new_call();
        let asker = record::Asker {
            sequence: 0,
            ar_uuid: Uuid::NIL,
        };
        let request = record::read_request(asker, at, length, Uuid::NIL);
        let object = Uuid::object(target.instance, target.device_id, target.vendor_id);
        let header = Header::request(
            object,
            Uuid::DEVICE_INTERFACE,
            self.uuids.uuid(),
            0,
            operation::READ_IMPLICIT,
        );
        let server = core::net::SocketAddrV4::new(target.ip.address, RPC_PORT);
        let id = self.rpc.call(now, server, header, record::read_stub(&request));
        self.owners.insert(
            id,
            Owner::Implicit {
                call,
                request: Box::new(request),
            },
        );
        Ok(call)
    }

    // ---- cyclic data

    /// Sets a submodule's output for the next frames.
    ///
    /// # Errors
    /// When there is no such connection, or `data` has another length than agreed.
    pub fn set_output(&mut self, ar: ArId, slot: u16, subslot: u16, data: &[u8]) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        let ar = self.ars.get_mut(index).ok_or(Misuse::UnknownConnection)?;
        let state = ar.output_state();
        let provider = ar.provider.as_mut().ok_or(Misuse::NoSuchData)?;
        if provider.set_data(slot, subslot, data, state) {
            Ok(())
        } else {
            Err(Misuse::NoSuchData)
        }
    }

    /// Lets the outputs be valid (run) or not (stop): DataStatus bit 4 and the IOPS of all outputs. Frames continue.
    ///
    /// # Errors
    /// When there is no such connection.
    pub fn set_run(&mut self, ar: ArId, run: bool) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        let ar = self.ars.get_mut(index).ok_or(Misuse::UnknownConnection)?;
        ar.run = run;
        ar.apply_run();
        Ok(())
    }

    /// Latest input of a submodule with its IOPS. After the connection ended: the last data, IOPS bad.
    #[must_use]
    pub fn input(&self, ar: ArId, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        let ar = self.get(ar)?;
        let (data, iops) = ar.consumer.as_ref()?.data(slot, subslot)?;
        Some((
            data,
            if ar.phase == Phase::Closed {
                Iops::BAD_CONTROLLER
            } else {
                iops
            },
        ))
    }

    /// What a submodule's next frame carries as output.
    #[must_use]
    pub fn output(&self, ar: ArId, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        self.get(ar)?.provider.as_ref()?.data(slot, subslot)
    }

    /// Whether the device takes the outputs of a submodule: its IOCS.
    #[must_use]
    pub fn output_taken(&self, ar: ArId, slot: u16, subslot: u16) -> Option<Iops> {
        self.get(ar)?.consumer.as_ref()?.iocs(slot, subslot)
    }

    /// Status the device sent last.
    #[must_use]
    pub fn input_status(&self, ar: ArId) -> Option<DataStatus> {
        self.get(ar)?
            .consumer
            .as_ref()
            .map(crate::cyclic::Consumer::status)
    }

    /// What was received; stays readable after the connection ended.
    #[must_use]
    pub fn statistics(&self, ar: ArId) -> Option<CyclicStatistics> {
        self.get(ar)?
            .consumer
            .as_ref()
            .map(crate::cyclic::Consumer::statistics)
    }

    /// Frames sent, and intervals in which none was.
    #[must_use]
    pub fn sent(&self, ar: ArId) -> Option<(u64, u64)> {
        self.get(ar)?.provider.as_ref().map(|p| (p.sent(), p.skipped()))
    }

    /// When the next output frame leaves: outputs set before are in it.
    #[must_use]
    pub fn next_cycle(&self, ar: ArId) -> Option<Instant> {
        let ar = self.get(ar)?;
        ar.provider
            .as_ref()
            .filter(|_| ar.phase.is_cyclic())
            .map(Provider::next_send)
    }

    // ---- inside

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

/// Everything else asks one station.
fn unicast(mac: MacAddress) -> Result<(), Misuse> {
    if mac.is_multicast() || mac == MacAddress::default() {
        Err(Misuse::Address(mac))
    } else {
        Ok(())
    }
}

const fn qualifier(permanent: bool) -> Qualifier {
    if permanent {
        Qualifier::PERMANENT
    } else {
        Qualifier::TEMPORARY
    }
}

#[cfg(test)]
mod tests;
