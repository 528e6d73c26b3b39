//! A drive at a serial line: behind a slave of the Danfoss FC protocol or of USS.
//!
//! What the master sends comes to the same places as on a network: process data to the telegram of the line, the parameter
//! channel to the drive's parameters. A control word without control (bit 10) is not acted on.

use std::collections::VecDeque;
use std::time::Duration;

use profile::parameter::SaveId;
use profile::pkw::{PkwDialect, PkwErrorNumber, Server};
use profile::state::Stw1;
use profile::telegram::Telegram;
use profinet::Instant;
use uss::{Layout, MAX_DATA, Parts, PkwPart, ReceiverStatistics, Slave, SlaveConfig, SlaveCounters};

use crate::axis::Plant;
use crate::drive::{Disconnect, Drive, Event as DriveEvent, WriteChannel};
use crate::model::Model;
use crate::station::{ANSWERED, StationEvent};

/// Octets of process data: control word and setpoint, status word and actual value.
const PROCESS: usize = 4;
/// How often the drive is stepped while a master has control.
const TICK: Duration = Duration::from_millis(4);
/// Most events that wait; older ones are dropped.
const MOST_EVENTS: usize = 256;

/// How a drive at a line is made.
#[derive(Debug, Clone)]
pub struct SerialConfig {
    /// The drive model.
    pub model: &'static Model,
    /// Protocol, address and times of the line.
    pub slave: SlaveConfig,
    /// A master that has control and is silent for so long is lost; a drive with a parameter for that goes by it (8-03).
    pub timeout: Duration,
    /// Motor, load and travel; `None` for those of the model.
    pub plant: Option<Plant>,
    /// Text of the saved parameters from the last run.
    pub parameters: Option<Vec<u8>>,
}

impl SerialConfig {
    /// Creates a new drive. Its master counts as lost after a second.
    #[must_use]
    pub const fn new(model: &'static Model, slave: SlaveConfig) -> Self {
        Self {
            model,
            slave,
            timeout: Duration::from_secs(1),
            plant: None,
            parameters: None,
        }
    }

    /// Longest time from one octet to the next of a telegram, for ports that hand them over in lumps.
    #[must_use]
    pub fn with_gap(mut self, gap: Duration) -> Self {
        self.slave.timing = self.slave.timing.with_gap(gap);
        self
    }
}

/// What the master is to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Master {
    /// Not there, or it only reads.
    None,
    /// It has, or had, control; `since` is the time of its last telegram, `controls` the value of its last word.
    Present { since: Instant, controls: bool },
}

/// A virtual drive behind a slave.
///
/// ```
/// use profinet::Instant;
/// use uss::SlaveConfig;
/// use profidrive_virtual_drive::{model, serial::{SerialConfig, SerialStation}};
///
/// let mut station = SerialStation::new(SerialConfig::new(&model::AKD, SlaveConfig::fc(1, 9600)));
/// let now = Instant::from_millis(1000);
/// // process data without control: the drive only reports its status
/// station.handle_octets(now, &[0x02, 0x06, 0x81, 0x00, 0x00, 0x00, 0x00, 0x85]);
/// let now = station.poll_timeout().unwrap();
/// station.handle_timeout(now);
/// let mut reply = [0; uss::MAX_TELEGRAM];
/// let length = station.poll_transmit(now, &mut reply).unwrap();
/// assert_eq!(reply[..length], [0x02, 0x06, 0x81, 0x02, 0x40, 0x00, 0x00, 0xC7]); // S1, speed 0
/// ```
#[derive(Debug)]
pub struct SerialStation {
    drive: Drive,
    /// What the process data of the line are.
    telegram: u16,
    slave: Slave,
    layout: Layout,
    server: Server,
    master: Master,
    timeout: Duration,
    outputs: [u8; PROCESS],
    inputs: [u8; PROCESS],
    ticked: Instant,
    /// When it restarts, after the answer to the command.
    restart: Option<Instant>,
    events: VecDeque<StationEvent>,
}

impl SerialStation {
    /// Creates a drive as it starts.
    #[must_use]
    pub fn new(config: SerialConfig) -> Self {
        let mut drive = Drive::new(config.model);
        drive.set_aside_telegram();
        let started = config.parameters.as_ref().map(|text| drive.start_with(text));
        if let Some(plant) = config.plant {
            drive.set_plant(plant);
        }
        let vendor = config.model.catalogue.device.vendor_id;
        let layout = config.slave.layout;
        let dialect = PkwDialect::of_line(Some(vendor), layout.pkw == PkwPart::Variable);
        let telegram = Telegram::of_line(vendor).map_or(1, |telegram| telegram.number);
        let mut station = Self {
            drive,
            telegram,
            layout,
            slave: Slave::new(config.slave),
            server: Server::new(dialect),
            master: Master::None,
            timeout: config.timeout,
            outputs: [0; PROCESS],
            inputs: [0; PROCESS],
            ticked: Instant::ZERO,
            restart: None,
            events: VecDeque::new(),
        };
        station.wait_for_master();
        if let Some(Err(error)) = started {
            station.emit(StationEvent::ParametersIgnored(error));
        }
        station
    }

    /// Before a master has control, the drive already reports in the format of the line.
    fn wait_for_master(&mut self) {
        self.connect();
        self.drive.disconnect(Disconnect::Released);
    }

    /// Restarts: values as saved, no master. How long a start takes is in no source: no time. The request that stands in the
    /// channel stays: a master that repeats it does not restart the drive again.
    fn restart(&mut self) {
        self.drive.restart();
        self.master = Master::None;
        self.outputs = [0; PROCESS];
        self.wait_for_master();
    }

    fn connect(&mut self) {
        // a model has the telegram of its vendor
        let _ = self.drive.connect(self.telegram, self.control_timeout());
    }

    /// Returns the time after which a silent master that has control is lost.
    fn control_timeout(&self) -> Duration {
        self.drive.control_timeout().unwrap_or(self.timeout)
    }

    /// Power goes in order: what is to be kept of it comes as events.
    pub fn switch_off(&mut self) {
        self.drive.switch_off();
        self.settle(self.ticked);
    }

    /// Takes one event.
    pub fn poll_event(&mut self) -> Option<StationEvent> {
        self.events.pop_front()
    }

    /// Returns the drive behind the line.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Returns the drive, to put a load on it or to make it fail.
    pub const fn drive_mut(&mut self) -> &mut Drive {
        &mut self.drive
    }

    /// Refuses every parameter request of the line with this number, or none any more: see [`Server::refuse_all`].
    pub const fn refuse_all(&mut self, number: Option<PkwErrorNumber>) {
        self.server.refuse_all(number);
    }

    /// Makes the drive wait for its owner: changes that are to be saved are answered only when
    /// [`report_save`](Self::report_save) reports the result. Until then the reply is AK 0. Without this call they are
    /// answered at once.
    pub fn confirm_saves(&mut self) {
        self.drive.confirm_saves();
    }

    /// Reports that the text of a [`StationEvent::PersistParameters`] is stored, or that it could not be; the report counts
    /// for every earlier save too.
    pub fn report_save(&mut self, save: SaveId, stored: bool) {
        self.drive.report_save(save, stored);
    }

    /// Returns its address.
    #[must_use]
    pub const fn number(&self) -> u8 {
        self.slave.config().number
    }

    /// Returns its counters at the line.
    #[must_use]
    pub const fn counters(&self) -> &SlaveCounters {
        self.slave.counters()
    }

    /// Returns the counters of its receiver.
    #[must_use]
    pub const fn line(&self) -> &ReceiverStatistics {
        self.slave.line()
    }

    /// Takes octets from the line, those that other slaves send too.
    pub fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        self.slave.handle_octets(time(now), octets);
        self.serve(now);
        self.settle(now);
    }

    /// Does what is due at `now`.
    pub fn handle_timeout(&mut self, now: Instant) {
        self.slave.handle_timeout(time(now));
        self.serve(now);
        if let Master::Present { since, controls } = self.master
            && now >= since + self.control_timeout()
        {
            self.master = Master::None;
            self.drive.disconnect(if controls {
                Disconnect::Silent
            } else {
                Disconnect::Released
            });
            self.tick(now);
            self.emit(StationEvent::MasterGone { lost: controls });
        }
        if self.restart.take_if(|due| *due <= now).is_some() {
            self.restart();
        }
        if self.next_tick().is_some_and(|due| due <= now) {
            self.tick(now);
        }
        self.settle(now);
    }

    /// Returns the reply, when it is due: its length in `buffer`, which has [`uss::MAX_TELEGRAM`] octets.
    pub fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        self.slave.poll_transmit(time(now), buffer)
    }

    /// Returns the time when [`handle_timeout`](Self::handle_timeout) or [`poll_transmit`](Self::poll_transmit) is due.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Instant> {
        let line = self.slave.poll_timeout().map(|due| Instant::ZERO + due);
        let lost = match self.master {
            Master::Present { since, .. } => Some(since + self.control_timeout()),
            Master::None => None,
        };
        Instant::earliest([line, lost, self.restart, self.next_tick()])
    }

    fn next_tick(&self) -> Option<Instant> {
        match self.master {
            Master::Present { .. } => Some(self.ticked + TICK),
            Master::None => self.drive.next_tick(),
        }
    }

    fn tick(&mut self, now: Instant) {
        self.ticked = now;
        let outputs = match self.master {
            Master::Present { .. } => Some(&self.outputs[..]),
            Master::None => None,
        };
        self.drive.tick(now, outputs, &mut self.inputs);
    }

    /// Answers the request that came, if one did.
    fn serve(&mut self, now: Instant) {
        let Some(request) = self.slave.poll_request() else {
            return;
        };
        let Some(parts) = self.layout.split(request.data) else {
            return;
        };
        let mut reply = [0; MAX_DATA];
        let mut length = 0;
        if !parts.pkw.is_empty() {
            self.server.clear_refusal();
            let server = &mut self.server;
            let handled = self.drive.written_through(WriteChannel::Pkw, |drive| {
                server.handle_block(parts.pkw, drive, &mut reply)
            });
            match handled {
                Ok(written) => length = written,
                // no request of this channel: left without an answer
                Err(_) => return,
            }
        }
        if let Ok(outputs) = parts.pzd.try_into() {
            self.take(now, outputs);
        }
        self.tick(now);
        let mut data = [0; MAX_DATA];
        let parts = Parts {
            pkw: reply.get(..length).unwrap_or_default(),
            pzd: &self.inputs,
        };
        if let Ok(length) = self.layout.join(parts, &mut data) {
            // the layout is the slave's own; a broadcast is not answered
            let _ = self.slave.respond(data.get(..length).unwrap_or_default());
        }
    }

    /// Process data of the master. It has the drive from its first word with control on, until it is silent.
    fn take(&mut self, now: Instant, outputs: [u8; PROCESS]) {
        let [high, low, ..] = outputs;
        let controls = Stw1(u16::from_be_bytes([high, low])).has(Stw1::CONTROL_BY_PLC);
        match self.master {
            Master::None if !controls => return,
            Master::None => {
                self.connect();
                self.drive.data_exchange();
                self.emit(StationEvent::MasterTook);
            }
            Master::Present { .. } => {}
        }
        self.outputs = outputs;
        self.master = Master::Present { since: now, controls };
    }

    fn settle(&mut self, now: Instant) {
        while let Some(event) = self.drive.poll_event() {
            if event == DriveEvent::Restart {
                self.restart = Some(now + ANSWERED);
            }
            self.emit(event.into());
        }
    }

    fn emit(&mut self, event: StationEvent) {
        if self.events.len() >= MOST_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }
}

fn time(now: Instant) -> Duration {
    now - Instant::ZERO
}

#[cfg(test)]
mod tests;
