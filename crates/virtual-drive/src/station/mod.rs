//! A drive on its PROFINET device: the one thing a network carrier runs.

mod channel;
pub(crate) mod describe;
mod event;
mod network;
mod record;
#[cfg(test)]
mod saving_tests;
#[cfg(test)]
mod tests;

pub use event::StationEvent;

use std::collections::VecDeque;
use std::net::SocketAddrV4;
use std::time::Duration;

use profile::catalogue::RecordView;
use profile::parameter::{ParameterAccess, SaveId, SaveState};
use profinet::device::{
    ArKey, ArKind, Device, Event as DeviceEvent, RecordAddress, Refusals, ResetMode, Stored, Token,
};
use profinet::wire::PnioStatus;
use profinet::wire::rt::Iops;
use profinet::wire::status::{abort, record as code1};
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Traffic, Transmit};

use crate::axis::Plant;
use crate::description::{self, Description};
use crate::drive::{AddressSource, Disconnect, Drive, Event as DriveEvent};
use crate::model::Model;
pub use channel::{AnswerFault, NoAnswerFault};
use channel::{Channels, INDICES};
use network::NetworkSaves;

/// Longest telegram of any model, in octets.
const LONGEST_TELEGRAM: usize = description::LONGEST_TELEGRAM as usize;

/// Records below this one can be parameters themselves.
const FIRST_OTHER_RECORD: u16 = 0x8000;

/// From a command that ends the connections until it is done: the answer to it is fetched meanwhile.
pub(crate) const ANSWERED: Duration = Duration::from_millis(200);

/// Most events that wait; older ones are dropped.
const MOST_EVENTS: usize = 256;

/// How a station is made.
#[derive(Debug, Clone)]
pub struct StationConfig {
    /// The drive model.
    pub model: &'static Model,
    /// Identity and modules: those of the model, or of a vendor's device description.
    pub description: Description,
    /// Own Ethernet address.
    pub mac: MacAddress,
    /// Shortest update time in steps of 31.25 us; `None` for that of the description.
    pub min_device_interval: Option<u16>,
    /// Sends each input frame right behind the controller's frame: saves a wake-up in each cycle on a real network.
    pub follow_controller: bool,
    /// Refuses another name and a reset by DCP while the motor turns, or may turn, under a controller.
    pub refuses_in_operation: bool,
    /// Position of the rotary switches of an AKD, which then give the address (IP.MODE 0) unless saved parameters say
    /// otherwise; `None`: the address is set by DCP (IP.MODE 1).
    pub rotary: Option<u8>,
    /// Motor, load and travel; `None` for those of the model.
    pub plant: Option<Plant>,
    /// Name, address and I&M data from the last run, or given by the user.
    pub network: Stored,
    /// Text of the saved parameters from the last run.
    pub parameters: Option<Vec<u8>>,
    /// Services that its device refuses.
    pub refusals: Refusals,
}

impl StationConfig {
    /// Creates a new station without name and address.
    #[must_use]
    pub fn new(model: &'static Model, mac: MacAddress) -> Self {
        Self {
            model,
            description: Description::of(model),
            mac,
            min_device_interval: None,
            follow_controller: false,
            refuses_in_operation: true,
            rotary: None,
            plant: None,
            network: Stored::default(),
            parameters: None,
            refusals: Refusals::default(),
        }
    }
}

/// A virtual drive with its field bus.
///
/// ```
/// use profinet::{Endpoint, MacAddress};
/// use profidrive_virtual_drive::{model, station::{Station, StationConfig}};
/// let station = Station::new(StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1])));
/// // it announces itself to its neighbour, and waits for a request
/// assert_eq!(station.poll_timeout(), Some(profinet::Instant::ZERO));
/// ```
#[derive(Debug)]
pub struct Station {
    device: Device,
    drive: Drive,
    /// What it is made with; its network is what is to be kept.
    config: StationConfig,
    /// Slot and subslot of the telegram in use.
    place: (u16, u16),
    /// No address is stored: the carrier finds one.
    finding: bool,
    /// What is to be done after the answer to the command.
    later: Option<(Instant, Later)>,
    channels: Channels<ArKey>,
    /// Writes of records that are answered when their save has ended.
    unanswered: Vec<(Token, SaveId)>,
    network_saves: NetworkSaves,
    controller: Option<ArKey>,
    inputs: [u8; LONGEST_TELEGRAM],
    input_length: usize,
    events: VecDeque<StationEvent>,
}

/// What a command does after its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Later {
    Restart,
    ApplyAddress,
}

impl Station {
    /// Creates a station as it starts.
    #[must_use]
    pub fn new(config: StationConfig) -> Self {
        let mut drive = Drive::new(config.model);
        let started = config.parameters.as_ref().map(|text| drive.start_with(text));
        if let Some(number) = config.rotary {
            drive.set_rotary(number);
        }
        let (stored, finding) = begin(&config, &mut drive);
        let mut station = Self {
            device: Device::new(describe::device_config(&config), stored),
            drive,
            config,
            place: (0, 0),
            finding,
            later: None,
            channels: Channels::default(),
            unanswered: Vec::new(),
            network_saves: NetworkSaves::default(),
            controller: None,
            inputs: [0; LONGEST_TELEGRAM],
            input_length: 0,
            events: VecDeque::new(),
        };
        station.plug_longest();
        if let Some(plant) = station.config.plant {
            station.drive.set_plant(plant);
        }
        if let Some(Err(error)) = started {
            station.emit(StationEvent::ParametersIgnored(error));
        }
        station
    }

    /// A free telegram can be mapped before it is plugged: as far as its longest module allows.
    fn plug_longest(&mut self) {
        let telegrams = &self.config.description.telegrams;
        for module in telegrams {
            let same = telegrams.iter().filter(|other| other.telegram == module.telegram);
            let (outputs, inputs) = same.fold((0, 0), |(outputs, inputs), other| {
                let (more_outputs, more_inputs) = other.lengths();
                (more_outputs.max(outputs), more_inputs.max(inputs))
            });
            self.drive.plug(module.telegram, outputs, inputs);
        }
    }

    /// Restarts: connections end without a frame; name, address and values are the saved ones. How
    /// long a start takes is in no source: no time.
    fn restart(&mut self) {
        self.drive.restart();
        let (stored, finding) = begin(&self.config, &mut self.drive);
        self.device = Device::new(describe::device_config(&self.config), stored);
        self.finding = finding;
        self.confirm_stores();
        self.channels.forget_all();
        // the connections that waited for these answers are gone
        self.unanswered.clear();
        self.controller = None;
        self.place = (0, 0);
        self.input_length = 0;
        self.plug_longest();
    }

    /// Takes the address by the settings of now.
    fn apply_address(&mut self, now: Instant) {
        let (ip, finding) = address(&self.config, &self.drive);
        self.finding = finding;
        self.device.take_address(now, ip);
        self.settle(now);
    }

    /// Power goes in order: what is to be kept of it comes as events.
    pub fn switch_off(&mut self) {
        self.drive.switch_off();
        while let Some(event) = self.drive.poll_event() {
            self.emit(event.into());
        }
    }

    /// Takes one event.
    pub fn poll_event(&mut self) -> Option<StationEvent> {
        self.events.pop_front()
    }

    /// Returns true while [`poll_event`](Self::poll_event) has an event.
    #[must_use]
    pub fn has_event(&self) -> bool {
        !self.events.is_empty()
    }

    /// Returns the drive behind the field bus.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Returns the drive, to put a load on it or to make it fail.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }

    /// Lets the parameter manager answer wrongly, late or not at all, from the next request on. The parameter channel of a
    /// PPO type has [`AnswerFault::Error`] only.
    pub fn set_answer_fault(&mut self, fault: AnswerFault) {
        self.channels.set_fault(fault);
        self.drive.refuse_in_channel(fault.in_channel());
    }

    /// Makes the drive wait for its owner: changes that are to be saved are answered only when
    /// [`report_save`](Self::report_save) reports the result, and a name or address by DCP only after
    /// [`report_network`](Self::report_network). Without this call they are answered at once.
    pub fn confirm_saves(&mut self) {
        self.drive.confirm_saves();
        self.network_saves.confirmed = true;
        self.confirm_stores();
    }

    /// Reports that the text of a [`StationEvent::PersistParameters`] is stored, or that it could not be; the report counts
    /// for every earlier save too. Answers that waited for it are ready then; those to a save that failed are errors.
    pub fn report_save(&mut self, now: Instant, save: SaveId, stored: bool) {
        self.drive.report_save(save, stored);
        self.channels.settle(&self.drive);
        let ended: Vec<(Token, SaveState)> = self
            .unanswered
            .extract_if(.., |(_, save)| self.drive.save_state(*save) != SaveState::Pending)
            .map(|(token, save)| (token, self.drive.save_state(save)))
            .collect();
        for (token, state) in ended {
            let refused = PnioStatus::write(code1::WRITE_ERROR);
            let written = if state == SaveState::Failed {
                Err(refused)
            } else {
                Ok(())
            };
            self.device.answer_write(now, token, written);
        }
        // an image may have waited for this report
        self.settle(now);
    }

    /// Returns the PROFINET device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// Returns the name of station, empty while none is set.
    #[must_use]
    pub fn name(&self) -> &str {
        self.device.name()
    }

    fn emit(&mut self, event: StationEvent) {
        if self.events.len() >= MOST_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// Steps the drive with the present outputs and sets its inputs. Allocates nothing.
    fn tick(&mut self, now: Instant) {
        let usable = self.device.is_exchanging() && self.device.provider_running();
        let (slot, subslot) = self.place;
        let outputs = self
            .device
            .output(slot, subslot)
            .filter(|(_, iops)| usable && iops.is_good());
        let inputs = self.inputs.get_mut(..self.input_length).unwrap_or_default();
        self.drive.tick(now, outputs.map(|(data, _)| data), inputs);
        self.device.set_operating(self.drive.is_operating());
        if self.controller.is_some() {
            self.device.set_input(slot, subslot, inputs, Iops::GOOD);
        }
    }

    /// Handles the events of the device and the drive.
    fn settle(&mut self, now: Instant) {
        while let Some(event) = self.device.poll_event() {
            self.device_event(now, event);
        }
        while let Some(event) = self.drive.poll_event() {
            self.drive_event(now, event);
        }
    }

    fn drive_event(&mut self, now: Instant, event: DriveEvent) {
        match event {
            DriveEvent::Restart => self.later = Some((now + ANSWERED, Later::Restart)),
            DriveEvent::ApplyAddress => self.later = Some((now + ANSWERED, Later::ApplyAddress)),
            DriveEvent::AddressReset => {
                self.config.network.ip = IpSuite::NONE;
                self.store_network();
            }
            _ => {}
        }
        self.emit(event.into());
    }

    fn device_event(&mut self, now: Instant, event: DeviceEvent) {
        match event {
            DeviceEvent::NameChanged { name, permanent } => {
                let before = self.before();
                self.config.network.name = if permanent { name } else { String::new() };
                self.store_set(before);
            }
            DeviceEvent::IpChanged { suite, permanent } => {
                let mut before = self.before();
                before.overruled = permanent;
                self.finding = false;
                self.config.network.ip = if permanent { suite } else { IpSuite::NONE };
                self.store_set(before);
            }
            DeviceEvent::ImChanged(im) => {
                self.config.network.im = im;
                self.store_network();
            }
            DeviceEvent::SetRefused { source, refusal } => {
                self.emit(StationEvent::SetRefused { source, refusal });
            }
            DeviceEvent::Signal => self.emit(StationEvent::Blink),
            DeviceEvent::FactoryReset { mode } => self.reset(mode),
            DeviceEvent::Connected { ar, kind, station } => {
                let controller = kind == ArKind::IoController;
                if controller {
                    self.controller = Some(ar);
                }
                self.emit(StationEvent::Connected { controller, station });
            }
            DeviceEvent::ParameterEnd { ar } => self.parameter_end(now, ar),
            DeviceEvent::DataExchange { .. } => {
                self.drive.data_exchange();
                let telegram = self.telegram().map_or(0, |module| module.telegram);
                self.emit(StationEvent::Exchanging { telegram });
            }
            DeviceEvent::Disconnected { ar, cause } => {
                self.channels.forget(ar);
                if self.controller == Some(ar) {
                    self.controller = None;
                    let released = cause == PnioStatus::aborted(abort::RELEASED);
                    self.drive.disconnect(if released {
                        Disconnect::Released
                    } else {
                        Disconnect::Lost
                    });
                    self.tick(now);
                    self.emit(StationEvent::Disconnected { cause });
                }
            }
            DeviceEvent::RecordRead {
                token,
                ar,
                address,
                length,
            } => {
                let answer = match self.record_view(address) {
                    Some(view) => self.drive.read_record(view, address.index),
                    None => self
                        .check(address, PnioStatus::read)
                        .and_then(|()| self.channels.read(now, ar, length)),
                };
                let answer = answer.as_deref().map_err(|status| *status);
                self.device.answer_read(now, token, answer);
            }
            DeviceEvent::RecordWrite {
                token,
                ar,
                address,
                data,
            } => {
                let written = match self.record_view(address) {
                    Some(view) => self.drive.write_record(view, address.index, &data),
                    None => self
                        .check(address, PnioStatus::write)
                        .and_then(|()| self.channels.write(now, ar, &data, &mut self.drive))
                        .map(|()| None),
                };
                if let Ok(Some(save)) = written {
                    // a save may never end: the device has answered the writes that waited too long
                    let device = &self.device;
                    self.unanswered.retain(|(token, _)| device.awaits(*token));
                    self.unanswered.push((token, save));
                } else {
                    self.device.answer_write(now, token, written.map(|_| ()));
                }
            }
            DeviceEvent::ProviderState { .. } | DeviceEvent::AlarmAcknowledged { .. } => {}
        }
    }

    /// Returns the telegram that is plugged.
    fn telegram(&self) -> Option<&description::TelegramModule> {
        self.config
            .description
            .plugged(|slot| self.device.plugged_module(slot))
    }

    /// Returns the view of a record that is a parameter itself; `None` for every other record.
    fn record_view(&self, address: RecordAddress) -> Option<RecordView> {
        let views = self.drive.model().catalogue.device.layout.records;
        let here = address.slot == self.slot() && address.index < FIRST_OTHER_RECORD;
        let view = views.iter().find(|view| view.subslot == address.subslot)?;
        here.then_some(*view)
    }

    /// Returns the slot of the drive.
    fn slot(&self) -> u16 {
        self.telegram().map_or(1, |module| module.slot)
    }

    /// Refuses records that are not the parameter channel, which every submodule of the drive's API gives access to.
    fn check(&self, address: RecordAddress, refuse: fn(u8) -> PnioStatus) -> Result<(), PnioStatus> {
        if address.api != self.config.description.api || !INDICES.contains(&address.index) {
            return Err(refuse(code1::INVALID_INDEX));
        }
        Ok(())
    }

    /// The controller has sent its parameters: provide the first inputs and report ready.
    fn parameter_end(&mut self, now: Instant, ar: ArKey) {
        if let Some(module) = self.telegram() {
            let (telegram, place) = (module.telegram, (module.slot, module.subslot));
            let (outputs, inputs) = module.lengths();
            self.place = place;
            self.input_length = usize::from(inputs).min(LONGEST_TELEGRAM);
            self.inputs = [0; LONGEST_TELEGRAM];
            let watchdog = self.device.watchdog().unwrap_or_default();
            self.drive.plug(telegram, outputs, inputs);
            // Every telegram module of the description carries a telegram of the model.
            let _ = self.drive.connect(telegram, watchdog);
        }
        self.tick(now);
        self.device.application_ready(now, ar);
    }

    /// Name, address and I&M data are reset by the device already.
    fn reset(&mut self, mode: ResetMode) {
        if mode.clears_address() {
            self.finding = false;
            self.config.network.name.clear();
            self.config.network.ip = IpSuite::NONE;
            self.drive.address_set();
        }
        if mode.clears_im() {
            self.config.network.im = profinet::device::ImRecords::default();
            self.drive.reset_to_delivery();
        }
        self.store_network();
    }
}

/// Returns the address of the device after power-on, and whether the carrier is to find one.
fn begin(config: &StationConfig, drive: &mut Drive) -> (Stored, bool) {
    // an address that is kept was set by DCP, which overrules the switches
    if config.rotary.is_some() && !config.network.ip.is_set() {
        drive.follow_switches();
    }
    let (ip, finding) = address(config, drive);
    let mut stored = config.network.clone();
    stored.ip = ip;
    (stored, finding)
}

/// Returns the address by the settings of the drive, and whether the carrier is to find one.
fn address(config: &StationConfig, drive: &Drive) -> (IpSuite, bool) {
    match drive.address_source() {
        AddressSource::Stored => (config.network.ip, false),
        AddressSource::Switches(suite) => (suite, false),
        AddressSource::Found => (IpSuite::NONE, true),
    }
}

impl Endpoint for Station {
    fn mac(&self) -> MacAddress {
        self.device.mac()
    }

    fn ip(&self) -> IpSuite {
        self.device.ip()
    }

    fn name(&self) -> Option<&str> {
        Endpoint::name(&self.device)
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.device.handle_frame(now, frame);
        self.settle(now);
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.device.handle_datagram(now, source, local_port, payload);
        self.settle(now);
    }

    fn acquires_address(&self) -> bool {
        self.finding
    }

    fn take_address(&mut self, now: Instant, suite: IpSuite) {
        self.device.take_address(now, suite);
        self.emit(StationEvent::AddressFound(suite));
        self.settle(now);
    }

    fn serves(&self, port: u16) -> bool {
        self.device.serves(port)
    }

    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        self.device.note_traffic(traffic, frame);
    }

    fn handle_timeout(&mut self, now: Instant) {
        match self.later.take_if(|(due, _)| *due <= now) {
            Some((_, Later::Restart)) => self.restart(),
            Some((_, Later::ApplyAddress)) => self.apply_address(now),
            None => {}
        }
        let cycle = self.device.next_cycle().is_some_and(|due| due <= now);
        if cycle || self.drive.next_tick().is_some_and(|due| due <= now) {
            self.tick(now);
        }
        self.device.handle_timeout(now);
        self.settle(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        self.device.poll_transmit(now, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        let later = self.later.map(|(due, _)| due);
        Instant::earliest([self.device.poll_timeout(), self.drive.next_tick(), later])
    }
}
