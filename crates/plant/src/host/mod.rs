//! The simulation host: runs virtual drives on a network interface ([`Host`]) or at a serial line ([`SerialHost`]) in
//! real time, until it is stopped or its time is over.
//!
//! A host keeps what drives save in a [`StateFolder`], written by a thread of its own, checks whether names and addresses
//! are in use, plays time lines and serves the [control socket](crate::control_socket). It prints nothing: whatever
//! happens is an [`Event`].

mod description;
mod duplicate_check;
mod error;
mod event;
mod expected;
mod fleet;
mod hosted;
mod injection;
mod kept;
mod load;
mod persistence;
mod save_queue;
mod serial;
mod serial_line;
mod state_folder;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::ethernet::{Runner, Turn};
use network::files::create;
use network::host::StationId;
use network::pcap::Writer;
use network::system::{Bell, Error as NetworkError, First, Rank, Stop, free_memory, now, thread_time};
use profinet::{Endpoint, Instant};
use virtual_drive::station::StationConfig;

use crate::control_socket::{ControlSocket, Request};
use crate::event::Unit;
use crate::expect::{Expectation, ExpectationResult};
use crate::plan::DrivePlan;
use crate::timeline::Timeline;

pub use description::{DescriptionError, ForeignDescription};
pub use duplicate_check::Duplicate;
pub use error::HostError;
pub use event::{DriveEvent, Event, EventSender, Events, SaveResult, Saved, events};
pub use fleet::{Fleet, FleetError, MacChoice, interval};
pub use kept::{HostPursuit, HostTrace};
pub use load::{Load, Overload};
pub use serial::{SerialHost, SerialHostConfig};
pub use state_folder::{DriveState, Found, StateFolder};

use description::description_of;
use duplicate_check::{DuplicateCheck, Wanted};
use expected::Expected;
use fleet::Plan;
use hosted::HostedDrive;
use load::{Judge, Tally};
use persistence::Persistence;

/// How long to sleep while nothing happens.
const LONGEST_SLEEP: Duration = Duration::from_secs(3600);
/// When a trace at which another thread looked is looked after.
const SOON: Duration = Duration::from_millis(5);
/// Time between two attempts to open an interface or a port that went away.
const RETRY: Duration = Duration::from_secs(1);

/// Time between two warnings of too many drives.
const BETWEEN_WARNINGS: Duration = Duration::from_secs(10);

/// Memory of one drive in octets, with its connection, its saved state and its part of the receive ring; a test holds it.
pub const DRIVE_MEMORY: u64 = 64 * 1024;

/// Where the state of drives is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatePlace {
    /// The folder.
    pub folder: PathBuf,
    /// What another program reads that wants the folder meanwhile.
    pub holder: String,
}

/// The drives of a simulation.
#[derive(Debug, Clone)]
pub enum Drives {
    /// Equal drives.
    Fleet(Fleet),
    /// Those of a plant, with their time lines.
    Plans(Vec<DrivePlan>),
}

impl Drives {
    /// Returns how many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Fleet(fleet) => fleet.count as usize,
            Self::Plans(plans) => plans.len(),
        }
    }
}

/// How drives are simulated on a network interface.
#[derive(Debug)]
pub struct HostConfig {
    /// Name of the interface.
    pub interface: String,
    /// The drives.
    pub drives: Drives,
    /// Seed of all random events.
    pub seed: u64,
    /// Where their state is kept; `None` to discard it at the end.
    pub state: Option<StatePlace>,
    /// Instead of the device description of its model.
    pub description: Option<ForeignDescription>,
    /// Drives refuse a new name and a reset by DCP while their motors run under a controller.
    pub refuses_in_operation: bool,
    /// File for the traffic of the drives.
    pub capture: Option<PathBuf>,
    /// What is expected of the drives of a plant. Times count from the first connection of a controller.
    pub expectations: Vec<Expectation>,
    /// A trace of the drives, and the most octets that it may take, about; `None` where none is kept.
    pub trace: Option<(HostTrace, usize)>,
    /// How long the simulation goes on; `None` until it is stopped.
    pub time: Option<Duration>,
    /// Time between two reports of its [`Load`]; `None` for no reports.
    pub load_every: Option<Duration>,
    /// Ends the simulation.
    pub stop: Stop,
}

/// A drive as it runs.
#[derive(Debug)]
struct Running {
    drive: Arc<HostedDrive>,
    timeline: Timeline,
    exchanging: bool,
    /// Time between two input frames while it exchanges data.
    cycle: Option<Duration>,
}

/// A running simulation on a network interface.
pub struct Host {
    runner: Runner,
    drives: BTreeMap<StationId, Running>,
    /// Those to which something is still to happen: few of many, looked at in every turn.
    timed: BTreeSet<StationId>,
    persistence: Persistence,
    control_socket: Option<ControlSocket>,
    duplicate_check: Option<DuplicateCheck>,
    events: EventSender,
    expected: Expected,
    start: Instant,
    end: Option<Instant>,
    tally: Tally,
    /// Time between two reports of the load, and when the next is due.
    load: Option<(Duration, Instant)>,
    reported: Load,
    judge: Judge,
    /// Not before this time is there another warning of too many drives.
    next_warning: Instant,
    /// When to look again for the interface that went away.
    next_try: Option<Instant>,
    /// Holds the lock of the folder.
    _state: Option<StateFolder>,
}

impl Host {
    /// Opens the interface and starts the drives.
    ///
    /// # Errors
    /// When the drives, the interface, the state folder or the capture file cannot be used, or when another simulation
    /// has the MAC address of a drive.
    pub fn open(config: HostConfig, events: EventSender) -> Result<Self, HostError> {
        check_memory(config.drives.count(), free_memory())?;
        let mut runner = Runner::open_for(&config.interface, config.drives.count())?;
        let plans = match &config.drives {
            Drives::Fleet(fleet) => fleet.plans(runner.interface().mac)?,
            Drives::Plans(plans) => plans.iter().cloned().map(Plan::from).collect(),
        };
        let state = open_state(config.state.as_ref())?;
        runner.set_stop(config.stop.clone())?;
        let mut stations = Vec::new();
        for plan in plans {
            let drive = HostedDrive::new(&plan, state.as_ref());
            let station = station(&config, &plan, &drive, &events)?;
            stations.push((plan, drive, station));
        }
        let wanted = stations
            .iter()
            .map(|(plan, drive, station)| Wanted::new(&drive.key, plan.drive.mac, &station.network))
            .collect();
        let duplicate_check = DuplicateCheck::start(&mut runner, wanted)?;
        if let Some(path) = &config.capture {
            runner.add_tap(Box::new(capture(path, &config.interface)?));
        }
        let start = now();
        let bell = Bell::new().map_err(HostError::Bell)?;
        runner.set_bell(bell.clone())?;
        let mut host = Self {
            runner,
            drives: BTreeMap::new(),
            timed: BTreeSet::new(),
            persistence: Persistence::new(events.clone(), bell.clone()),
            control_socket: None,
            duplicate_check: Some(duplicate_check),
            events,
            expected: Expected::new(config.expectations, config.seed),
            start,
            end: config.time.map(|time| start + time),
            tally: Tally::default(),
            load: config.load_every.map(|every| (every, start + every)),
            reported: Load::default(),
            judge: Judge::default(),
            next_warning: start,
            next_try: None,
            _state: state,
        };
        let mut ready = Vec::new();
        for (number, (plan, drive, station)) in stations.into_iter().enumerate() {
            let seed = config.seed.wrapping_add(number as u64);
            ready.push(host.attach(&plan.drive, drive, station, seed)?);
        }
        if let Some((kept, limit)) = config.trace {
            host.expected.keep(kept, limit, start, &host.runner);
        }
        // who waits for the drives to be ready may use the control socket at once
        host.control_socket = open_control_socket(bell, &host.events);
        let all = Event::Running {
            drives: host.drives.len(),
            place: config.interface,
            serial: false,
        };
        let at = now() - start;
        let ready = ready.into_iter().map(|(drive, what)| Event::of(&drive, at, what));
        host.events.begin(ready.chain([all]));
        Ok(host)
    }

    /// Puts a drive on the network; returns its name and that it is ready.
    fn attach(
        &mut self,
        plan: &DrivePlan,
        drive: HostedDrive,
        config: StationConfig,
        seed: u64,
    ) -> Result<(Arc<str>, DriveEvent), HostError> {
        let mut unit = plan.build(config, seed)?;
        let station = unit.inner_mut().endpoint_mut();
        if drive.state.is_kept() {
            station.confirm_saves();
        }
        let ready = DriveEvent::Ready {
            name: station.name().to_owned(),
            mac: station.mac(),
            ip: station.ip(),
            acquires_address: station.acquires_address(),
        };
        let id = self.runner.attach(Box::new(unit))?;
        let key = Arc::clone(&drive.key);
        let running = Running {
            drive: Arc::new(drive),
            timeline: Timeline::new(&plan.cues, self.start),
            exchanging: false,
            cycle: None,
        };
        if !running.timeline.is_over() {
            self.timed.insert(id);
        }
        self.expected.add(id, &key);
        self.drives.insert(id, running);
        Ok((key, ready))
    }

    /// Runs the drives until the time is over or the simulation is stopped, then saves what is still to be saved. Returns what came
    /// of each expectation for each of its drives. The calling thread runs before those of other programs meanwhile, where that is permitted
    /// and as long as it needs little of a processor ([`First`]).
    ///
    /// # Errors
    /// When the interface fails for good, when a station on the segment has the MAC address of a drive, or when the
    /// capture file is not complete.
    pub fn run(mut self) -> Result<Vec<ExpectationResult>, HostError> {
        // a controller gives up drives that are late, whatever else this computer has to do
        let mut first = First::new(Rank::Frames);
        loop {
            first.turn(now());
            let turn = self.step()?;
            self.reopen()?;
            self.finish_duplicate_check()?;
            if turn == Turn::Rung {
                self.deliver_saves();
                self.answer_requests();
            }
            self.handle_events();
            self.play_timelines();
            self.expected.look(now(), &self.runner);
            self.report_load();
            if turn == Turn::Stopped || self.end.is_some_and(|end| now() >= end) {
                let results = self.expected.finish(now());
                return self.finish().map(|()| results);
            }
        }
    }

    /// Carries frames until something is due.
    fn step(&mut self) -> Result<Turn, HostError> {
        let timed = self.timed.iter().filter_map(|id| self.drives.get(id));
        let timelines = timed.filter_map(|drive| drive.timeline.next());
        let sleep = if self.next_try.is_some() {
            RETRY
        } else {
            LONGEST_SLEEP
        };
        let check = self.duplicate_check.as_ref().map(DuplicateCheck::due);
        let load = self.load.map(|(_, due)| due);
        let behind = self.expected.is_behind().then(|| now() + SOON);
        let until = [
            Some(now() + sleep),
            timelines.min(),
            self.end,
            check,
            load,
            behind,
        ];
        match self
            .runner
            .step(until.into_iter().flatten().min().unwrap_or(Instant::MAX))
        {
            Err(error @ (NetworkError::InterfaceDown { .. } | NetworkError::InterfaceGone { .. })) => {
                self.events.send(Event::CarrierLost(error.to_string()));
                self.next_try = Some(now() + RETRY);
                Ok(Turn::Worked)
            }
            other => Ok(other?),
        }
    }

    /// Opens the interface again that went away.
    fn reopen(&mut self) -> Result<(), HostError> {
        if self.next_try.is_none_or(|next| now() < next) {
            return Ok(());
        }
        self.next_try = Some(now() + RETRY);
        if is_back(self.runner.reopen())? {
            self.next_try = None;
            let interface = self.runner.interface().name.clone();
            self.events.send(Event::CarrierBack(interface));
        }
        Ok(())
    }

    fn finish_duplicate_check(&mut self) -> Result<(), HostError> {
        match self.duplicate_check.take_if(|check| check.due() <= now()) {
            Some(check) => check.finish(&mut self.runner, &self.events),
            None => Ok(()),
        }
    }

    fn deliver_saves(&mut self) {
        while let Some(report) = self.persistence.report() {
            let id = self
                .drives
                .iter()
                .find(|(_, running)| Arc::ptr_eq(&running.drive, &report.drive));
            if let Some(unit) = id.and_then(|(id, _)| self.runner.station_mut::<Unit>(*id)) {
                report.deliver(unit.inner_mut().endpoint_mut(), now());
            }
        }
    }

    fn answer_requests(&mut self) {
        while let Some((request, response)) = self.control_socket.as_ref().and_then(ControlSocket::take) {
            // the sender may be gone
            let _ = response.send(match request {
                Request::Inject(request) => self.inject(&request),
                Request::Drives(segment) => self.drives_on(&segment),
            });
        }
    }

    fn handle_events(&mut self) {
        for turn in 0..self.runner.touched().len() {
            let Some(id) = self.runner.touched().get(turn).copied() else {
                continue;
            };
            // most turns have no event: looking first leaves the station undisturbed
            let waiting = self
                .runner
                .station::<Unit>(id)
                .is_some_and(|unit| unit.inner().endpoint().has_event());
            if waiting {
                self.handle_events_of(id);
            }
        }
    }

    fn handle_events_of(&mut self, id: StationId) {
        let unit = self.runner.station_mut::<Unit>(id);
        let Some((running, unit)) = self.drives.get_mut(&id).zip(unit) else {
            return;
        };
        let station = unit.inner_mut().endpoint_mut();
        while let Some(event) = station.poll_event() {
            self.tally.note(&event, &mut running.exchanging);
            let catalogue = running.drive.model.catalogue;
            self.expected.take(id, now(), &event, catalogue);
            self.persistence.handle(&running.drive, now() - self.start, event);
        }
        let cycle = station.device().send_interval().filter(|_| running.exchanging);
        self.tally.change(running.cycle, cycle);
        running.cycle = cycle;
    }

    fn report_load(&mut self) {
        let at = now();
        let Some((every, _)) = self.load.filter(|(_, due)| *due <= at) else {
            return;
        };
        // a report that comes at once after a late one would judge a moment in which everything is made up for
        self.load = Some((every, at + every));
        let passed = self.send_load(at);
        if let Some(overload) = self.judge.take(&passed)
            && at >= self.next_warning
        {
            self.next_warning = at + BETWEEN_WARNINGS;
            self.events.send(Event::Overload(overload));
        }
    }

    /// Reports the load; what happened since the last report.
    fn send_load(&mut self, at: Instant) -> Load {
        let load = self.measure(at);
        let passed = load.since(&self.reported);
        self.reported = load;
        self.events.send(Event::Load(load));
        passed
    }

    fn measure(&mut self, at: Instant) -> Load {
        let mut load = Load {
            time: at - self.start,
            drives: self.drives.len(),
            frames: self.runner.statistics(),
            lateness: self.runner.lateness(),
            processor: thread_time(),
            ..Load::default()
        };
        self.tally.fill(&mut load);
        load
    }

    fn play_timelines(&mut self) {
        if self.timed.is_empty() {
            return;
        }
        let at = now();
        let Self {
            timed,
            drives,
            runner,
            events,
            expected,
            start,
            ..
        } = self;
        timed.retain(|id| {
            let Some(Running { drive, timeline, .. }) = drives.get_mut(id) else {
                return false;
            };
            let due = timeline.next().is_some_and(|next| next <= at)
                || timeline.watches_position()
                    && runner
                        .station::<Unit>(*id)
                        .is_some_and(|unit| timeline.is_due(at, unit));
            if due && let Some(unit) = runner.station_mut::<Unit>(*id) {
                for played in timeline.play(at, unit) {
                    expected.note(*id, at, played.into());
                    events.drive(&drive.key, at - *start, DriveEvent::Played(played));
                }
            }
            !timeline.is_over()
        });
    }

    /// Switches the drives off and saves their pending values.
    fn finish(mut self) -> Result<(), HostError> {
        if self.load.is_some() {
            self.send_load(now());
        }
        let all: Vec<StationId> = self.drives.keys().copied().collect();
        for id in all {
            if let Some(unit) = self.runner.station_mut::<Unit>(id) {
                unit.inner_mut().endpoint_mut().switch_off();
            }
            self.handle_events_of(id);
        }
        self.persistence.finish();
        self.runner.finish_taps().map_err(HostError::IncompleteCapture)
    }
}

/// Returns the settings of a drive's station.
fn station(
    config: &HostConfig,
    plan: &Plan,
    drive: &HostedDrive,
    events: &EventSender,
) -> Result<StationConfig, HostError> {
    let mut station = plan.drive.config();
    station.description = description_of(plan.drive.model, config.description.as_ref());
    station.follow_controller = true;
    station.refuses_in_operation = config.refuses_in_operation;
    if let Drives::Fleet(fleet) = &config.drives {
        station.rotary = fleet.rotary;
    }
    station.network = drive.network(station.network, events)?;
    station.parameters = drive.saved_parameters(events)?;
    Ok(station)
}

fn open_state(state: Option<&StatePlace>) -> Result<Option<StateFolder>, HostError> {
    let open = |state: &StatePlace| StateFolder::open(&state.folder, &state.holder);
    state.map(open).transpose().map_err(HostError::StateFolder)
}

/// Refuses drives for which there is no memory: the system would end some program, and not necessarily this one.
fn check_memory(wanted: usize, free: Option<u64>) -> Result<(), HostError> {
    let needed = DRIVE_MEMORY.saturating_mul(wanted as u64);
    match free.filter(|free| needed > *free) {
        None => Ok(()),
        Some(free) => Err(HostError::Memory {
            wanted,
            needed,
            free,
            fit: free / DRIVE_MEMORY,
        }),
    }
}

/// Without a control socket everything else works.
fn open_control_socket(bell: Bell, events: &EventSender) -> Option<ControlSocket> {
    ControlSocket::open(bell)
        .map_err(|error| events.send(Event::NoControlSocket(error.to_string())))
        .ok()
}

/// Returns whether the interface could be opened again; down and not there are no failures.
fn is_back(reopened: Result<(), NetworkError>) -> Result<bool, NetworkError> {
    match reopened {
        Ok(()) => Ok(true),
        Err(
            NetworkError::InterfaceDown { .. }
            | NetworkError::InterfaceGone { .. }
            | NetworkError::NoSuchInterface { .. },
        ) => Ok(false),
        Err(error) => Err(error),
    }
}

fn capture(path: &Path, interface: &str) -> Result<Writer<File>, HostError> {
    let file = create(path).map_err(HostError::CreateCapture)?;
    let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let origin = wall.saturating_sub(now() - Instant::ZERO);
    Writer::new(file, interface, origin).map_err(|source| HostError::WriteCapture {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_without_memory_are_refused_with_the_number_that_fits() {
        assert!(check_memory(2000, Some(200_000_000)).is_ok());
        assert!(check_memory(60_000, None).is_ok());
        let error = check_memory(2000, Some(100_000_000)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "2000 drives need about 131 MB of memory and 100 MB are free: 1525 drives would fit"
        );
    }
}
