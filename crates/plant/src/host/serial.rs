//! Virtual drives at a serial line, in real time.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use network::serial::{Error as SerialError, Line, Port, Settings, Talker};
use network::system::{Bell, Stop, now};
use profinet::Instant;
use uss::{Protocol, SlaveConfig};
use virtual_drive::serial::{SerialConfig, SerialStation};

use super::error::HostError;
use super::event::{DriveEvent, Event, EventSender};
use super::fleet::Fleet;
use super::persistence::Persistence;
use super::serial_line::SerialLine;
use super::state_folder::StateFolder;
use super::{HostedDrive, RETRY, StatePlace, open_control_socket, open_state};
use crate::control_socket::{ControlSocket, Request, Response};

/// Octets of one telegram may come so far apart: adapters hand them over in lumps.
const GAP: Duration = Duration::from_millis(30);
/// Interval for polling requests of other processes, which do not end a wait for the port.
const POLL: Duration = Duration::from_millis(100);
/// Time between two steps while there is no port.
const STEP: Duration = Duration::from_millis(10);

/// How drives are simulated at a serial line.
#[derive(Debug)]
pub struct SerialHostConfig {
    /// Path of the serial port.
    pub port: String,
    /// Protocol of the line.
    pub protocol: Protocol,
    /// Speed and parity.
    pub settings: Settings,
    /// Address of the first drive; the others follow.
    pub address: u8,
    /// The drives.
    pub fleet: Fleet,
    /// Where their state is kept; `None` to discard it at the end.
    pub state: Option<StatePlace>,
    /// How long the simulation goes on; `None` until it is stopped.
    pub time: Option<Duration>,
    /// Ends the simulation.
    pub stop: Stop,
}

/// A running simulation at a serial line.
pub struct SerialHost {
    line: SerialLine,
    /// `None` while the port is away.
    port: Option<Line>,
    /// When to look again for a port that is away.
    next_try: Instant,
    name: String,
    settings: Settings,
    stop: Stop,
    persistence: Persistence,
    control_socket: Option<ControlSocket>,
    events: EventSender,
    start: Instant,
    end: Option<Instant>,
    /// Holds the lock of the folder.
    _state: Option<StateFolder>,
}

impl SerialHost {
    /// Opens the port and starts the drives.
    ///
    /// # Errors
    /// When the drives, the port or the state folder cannot be used.
    pub fn open(config: SerialHostConfig, events: EventSender) -> Result<Self, HostError> {
        let state = open_state(config.state.as_ref())?;
        let bell = Bell::new().map_err(HostError::Bell)?;
        let drives = drives(&config, state.as_ref(), &events)?;
        let start = now();
        let mut host = Self {
            line: SerialLine::new(config.protocol, config.port.clone(), drives),
            port: Some(open(&config.port, config.settings, &config.stop)?),
            next_try: start,
            name: config.port,
            settings: config.settings,
            stop: config.stop,
            persistence: Persistence::new(events.clone(), bell.clone()),
            control_socket: None,
            events,
            start,
            end: config.time.map(|time| start + time),
            _state: state,
        };
        // who waits for the drives to be ready may use the control socket at once
        host.control_socket = open_control_socket(bell, &host.events);
        for (drive, station) in &host.line.drives {
            let ready = DriveEvent::ReadyAtLine(station.number());
            host.events.drive(&drive.key, now() - start, ready);
        }
        host.events.send(Event::Running {
            drives: host.line.drives.len(),
            place: host.name.clone(),
            serial: true,
        });
        Ok(host)
    }

    /// Runs the drives until the time is over or the simulation is stopped, then saves what is still to be saved.
    ///
    /// # Errors
    /// When the port fails for good.
    pub fn run(mut self) -> Result<(), HostError> {
        while !self.stop.is_stopped() && self.end.is_none_or(|end| now() < end) {
            self.step()?;
            self.answer_requests();
            self.deliver_saves();
            for (drive, event) in self.line.end(now()) {
                let ended = DriveEvent::Ended(event);
                self.events.drive(&drive, now() - self.start, ended);
            }
            self.handle_events();
        }
        for (_, station) in &mut self.line.drives {
            station.switch_off();
        }
        self.handle_events();
        self.persistence.finish();
        Ok(())
    }

    /// Carries octets until something is due.
    fn step(&mut self) -> Result<(), HostError> {
        let until = self.end.unwrap_or(Instant::MAX).min(now() + POLL);
        let Some(port) = &mut self.port else {
            sleep(STEP);
            self.line.handle_timeout(now());
            self.reopen();
            return Ok(());
        };
        match port.step(&mut self.line, until) {
            Err(error @ (SerialError::Gone { .. } | SerialError::Stuck { .. })) => {
                self.events.send(Event::CarrierLost(error.to_string()));
                self.port = None;
                self.next_try = now() + RETRY;
                Ok(())
            }
            other => Ok(other?),
        }
    }

    /// Opens the port again that went away.
    fn reopen(&mut self) {
        if now() < self.next_try {
            return;
        }
        self.next_try = now() + RETRY;
        self.port = open(&self.name, self.settings, &self.stop).ok();
        if self.port.is_some() {
            self.events.send(Event::CarrierBack(self.name.clone()));
        }
    }

    fn answer_requests(&mut self) {
        while let Some((request, response)) = self.control_socket.as_ref().and_then(ControlSocket::take) {
            let answer = match request {
                Request::Drives(_) => Response::Drives(Vec::new()),
                Request::Inject(request) => {
                    let (answer, happened) = self.line.inject(&request, now());
                    if let Some((drive, what)) = happened {
                        self.events.drive(&drive, now() - self.start, what);
                    }
                    answer
                }
            };
            // the sender may be gone
            let _ = response.send(answer);
        }
    }

    fn deliver_saves(&mut self) {
        while let Some(report) = self.persistence.report() {
            let mut drives = self.line.drives.iter_mut();
            if let Some((_, station)) = drives.find(|(drive, _)| Arc::ptr_eq(drive, &report.drive)) {
                station.report_save(report.save, report.stored);
            }
        }
    }

    fn handle_events(&mut self) {
        for (drive, station) in &mut self.line.drives {
            while let Some(event) = station.poll_event() {
                self.persistence.handle(drive, now() - self.start, event);
            }
        }
    }
}

fn open(port: &str, settings: Settings, stop: &Stop) -> Result<Line, SerialError> {
    let mut line = Line::new(Port::open(port, settings)?);
    line.set_stop(stop.clone());
    Ok(line)
}

/// Returns the drives of the line, with consecutive addresses.
fn drives(
    config: &SerialHostConfig,
    state: Option<&StateFolder>,
    events: &EventSender,
) -> Result<Vec<(Arc<HostedDrive>, SerialStation)>, HostError> {
    let plans = config.fleet.plans(None)?;
    let numbered = plans.iter().zip(u16::from(config.address)..);
    numbered
        .map(|(plan, number)| {
            let slave = slave(config, number)?;
            let drive = HostedDrive::new(plan, state);
            let mut serial = SerialConfig::new(drive.model, slave).with_gap(GAP);
            serial.parameters = drive.saved_parameters(events)?;
            let mut station = SerialStation::new(serial);
            if drive.state.is_kept() {
                station.confirm_saves();
            }
            Ok((Arc::new(drive), station))
        })
        .collect()
}

/// Returns the slave of a drive, if there is such an address.
fn slave(config: &SerialHostConfig, number: u16) -> Result<SlaveConfig, HostError> {
    let (range, slave): (_, fn(u8, u32) -> SlaveConfig) = match config.protocol {
        Protocol::Fc => (1..=126, SlaveConfig::fc),
        Protocol::Uss => (0..=31, SlaveConfig::uss),
    };
    match u8::try_from(number) {
        Ok(number) if range.contains(&number) => Ok(slave(number, config.settings.baud)),
        _ => Err(HostError::LineAddress {
            number,
            lowest: *range.start(),
            highest: *range.end(),
        }),
    }
}
