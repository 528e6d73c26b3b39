//! A plant in virtual time.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::time::Duration;

use network::host::Host;
use network::segment::{Pace, Segment, SegmentMedium, StationId, Tap};
use profile::state::Zsw1;
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event as ControllerEvent, ModuleConfig, Resolve,
    SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::device::ModuleDescription;
use profinet::wire::block::ModuleState;
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium};
use virtual_drive::description::Description;
use virtual_drive::drive::Drive;
use virtual_drive::model::Model;
use virtual_drive::station::{Station, StationEvent};

use crate::event::{PlantEvent, Unit};
use crate::expect::{Expectation, ExpectationResult, Live, Monitor, revolutions};
use crate::plan::{Action, ControllerPlan, DrivePlan, PlantPlan, Step, WorldError};
use crate::text::derived_mac;
use crate::timeline::Timeline;
use crate::trace::{DriveMessage, Event, EventKind, Sample};

/// How long a controller waits before it connects again.
const RECONNECT_DELAY: Duration = Duration::from_millis(500);

/// A plant in virtual time: an in-memory segment with its drives and controllers.
///
/// ```
/// use profidrive_plant::{PlantPlan, World};
/// use profinet::Instant;
/// let plant: PlantPlan = r#"
///     [[drive]]
///     name = "akd-1"
///     ip = "10.0.0.1/24"
///     event = [{ at = "2s", do = "fault=439" }]
///     [[controller]]
///     drive = "akd-1"
///     telegram = 1
///     step = [
///         { at = "0.5s", send = { STW1 = "0x047E" } },
///         { at = "0.6s", send = { STW1 = "0x047F", NSOLL_A = "60rpm" } },
///     ]
/// "#.parse()?;
/// let mut lines = Vec::new();
/// let mut world = World::new(&plant)?;
/// world.run_until(Instant::from_millis(3000), &mut |entry| lines.push(entry.to_string()));
/// assert!(lines.iter().any(|line| line.contains("fault F439")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// It is a [`Medium`] too: a client joins the plant and carries it along, see [`PlantPlan::client_address`].
pub struct World {
    medium: SegmentMedium,
    drives: Vec<Seat>,
    controllers: Vec<ControllerSeat>,
    sample: Option<(Duration, Instant)>,
    observer: Option<Box<dyn FnMut(Event) + Send>>,
    /// Checks what is expected of the drives.
    monitor: Option<Box<Monitor>>,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World")
            .field("medium", &self.medium)
            .finish_non_exhaustive()
    }
}

/// The shaft of a drive of a plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaft<'w> {
    /// What the plant calls the drive.
    pub name: &'w str,
    /// Its Ethernet address.
    pub mac: MacAddress,
    /// Its position in turns.
    pub position: f64,
    /// Its speed, rpm.
    pub speed: f64,
}

/// A drive in its place.
struct Seat {
    id: StationId,
    name: String,
    mac: MacAddress,
    model: &'static Model,
    line: Timeline,
    status: u16,
    /// Numbers of the faults that came and were not acknowledged.
    faults: Vec<u16>,
    /// Whether a controller exchanges data with it; `None` before the first one did.
    connected: Option<bool>,
}

/// A controller in its place.
struct ControllerSeat {
    id: StationId,
    drive: usize,
    target: Target,
    connect: ConnectConfig,
    ar: Option<ArId>,
    /// When it connects next; `None` while it has a connection or is not to have one.
    connect_at: Option<Instant>,
    /// What it does, by the time after the start and the place in the program.
    steps: BTreeMap<(Duration, usize), Step>,
    outputs: Vec<u8>,
    /// Subslot of the telegram.
    subslot: u16,
}

impl World {
    /// Returns the world of a plan at its start.
    ///
    /// # Errors
    /// When a drive refuses its first parameters.
    pub fn new(plant: &PlantPlan) -> Result<Self, WorldError> {
        let mut segment = Segment::new(plant.seed);
        let mut drives = Vec::new();
        for (number, plan) in plant.drives.iter().enumerate() {
            let seed = plant.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ number as u64;
            let unit = plan.build(plan.config(), seed)?;
            let status = unit.inner().endpoint().drive().status_word().0;
            drives.push(Seat {
                id: segment.attach(Box::new(unit)),
                name: plan.name.clone(),
                mac: plan.mac,
                model: plan.model,
                line: Timeline::new(&plan.cues, Instant::ZERO),
                status,
                faults: Vec::new(),
                connected: None,
            });
        }
        let mut controllers = Vec::new();
        for (number, plan) in plant.controllers.iter().enumerate() {
            let Some(drive) = plant.drives.get(plan.drive) else {
                continue;
            };
            let ip = free_address(plant, drive, number)?;
            let name = format!("plc-{}", number + 1);
            // the text decides the address: another would change every trace
            let mac = derived_mac(&format!("{name} of a scenario"));
            let seed = plant.seed ^ (number as u64) << 32;
            let controller = Controller::new(ControllerConfig::new(mac, ip, &name, seed));
            let id = segment.attach(Box::new(Host::new(controller)));
            controllers.push(ControllerSeat::new(id, plan, drive));
        }
        Ok(Self {
            medium: SegmentMedium::new(segment, Pace::Virtual),
            drives,
            controllers,
            sample: plant.sample.map(|sample| (sample, Instant::ZERO + sample)),
            observer: None,
            monitor: None,
        })
    }

    /// Calls `observer` with what happens while a client carries the plant. Replaces the observer before.
    pub fn observe(&mut self, observer: impl FnMut(Event) + Send + 'static) {
        self.observer = Some(Box::new(observer));
    }

    /// Checks these expectations from now on, at each tick of the drives; the time of an expectation counts from the start of
    /// the plant. Replaces those before.
    pub fn expect(&mut self, expectations: &[Expectation], seed: u64) {
        self.monitor = Some(Box::new(Monitor::new(expectations, self.drives.len(), seed)));
        self.check(self.now());
    }

    /// Ends the checks at the present time; returns what came of each expectation for each of its drives.
    pub fn finish_expectations(&mut self) -> Vec<ExpectationResult> {
        let end = self.now() - Instant::ZERO;
        let monitor = self.monitor.take();
        let name = |drive: usize| self.drives.get(drive).map_or("", |seat| &seat.name);
        monitor.map_or_else(Vec::new, |monitor| monitor.finish(end, name))
    }

    /// Shows all drives to the monitor.
    fn check(&mut self, now: Instant) {
        let Some(mut monitor) = self.monitor.take() else {
            return;
        };
        for (number, seat) in self.drives.iter().enumerate() {
            if let Some(unit) = self.medium.segment().station::<Unit>(seat.id) {
                let drive = unit.inner().endpoint().drive();
                let live = Live {
                    drive,
                    connected: seat.connected,
                };
                monitor.observe(number, now - Instant::ZERO, &live);
            }
        }
        self.monitor = Some(monitor);
    }

    /// Sets how time passes while a client carries the plant.
    pub fn set_pace(&mut self, pace: Pace) {
        self.medium.set_pace(pace);
    }

    /// Lets something happen to the drive of this name now; `lasts` as `for` in the file.
    ///
    /// # Errors
    /// When there is no such drive, or it cannot happen to it ([`PlantEvent::fits`]).
    pub fn inject(
        &mut self,
        drive: &str,
        what: PlantEvent,
        lasts: Option<Duration>,
    ) -> Result<(), WorldError> {
        let now = self.now();
        let seat = self.drives.iter_mut().find(|seat| seat.name == drive);
        let seat = seat.ok_or_else(|| WorldError::NoDrive {
            drive: drive.to_owned(),
        })?;
        what.fits(seat.model)?;
        seat.line.add(now, what, lasts);
        Ok(())
    }

    /// Lets `tap` see all frames.
    pub fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.medium.segment_mut().add_tap(tap);
    }

    /// Ends all taps.
    ///
    /// # Errors
    /// When one could not write what it saw.
    pub fn finish_taps(&mut self) -> std::io::Result<()> {
        self.medium.segment_mut().finish_taps()
    }

    /// Virtual time.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.medium.segment().now()
    }

    /// Returns a number that is the same for the same frames at the same times.
    #[must_use]
    pub fn trace_hash(&self) -> u64 {
        self.medium.segment().trace_hash()
    }

    /// Returns the drive of that number in the plant.
    #[must_use]
    pub fn drive(&self, number: usize) -> Option<&Station> {
        let unit: &Unit = self.medium.segment().station(self.drives.get(number)?.id)?;
        Some(unit.inner().endpoint())
    }

    /// Returns where the shaft of the drive of that number is.
    #[must_use]
    pub fn shaft(&self, number: usize) -> Option<Shaft<'_>> {
        let seat = self.drives.get(number)?;
        let axis = self.drive(number)?.drive().axis();
        Some(Shaft {
            name: &seat.name,
            mac: seat.mac,
            position: revolutions(axis.position()),
            speed: axis.speed(),
        })
    }

    /// Runs from event to event until `until`; `record` receives the events.
    pub fn run_until(&mut self, until: Instant, record: &mut dyn FnMut(Event)) {
        loop {
            self.act(record);
            let next = self.next_event().min(until);
            let segment = self.medium.segment_mut();
            // all that was due until now is done, also what the time line had for this moment
            if segment.now() >= until && segment.next_event().is_none_or(|at| at > until) {
                return;
            }
            segment.run_until(next);
            self.look(record);
        }
    }

    /// Returns when something happens next: of a time line, a program or a sample, or on the segment.
    #[must_use]
    pub fn next_event(&self) -> Instant {
        Instant::earliest([
            self.next_cue(),
            self.next_step(),
            self.sample.map(|(_, at)| at),
            self.medium.segment().next_event(),
        ])
        .unwrap_or(Instant::MAX)
    }

    fn next_cue(&self) -> Option<Instant> {
        self.drives.iter().filter_map(|seat| seat.line.next()).min()
    }

    fn next_step(&self) -> Option<Instant> {
        let next = |seat: &ControllerSeat| Instant::earliest([seat.next_step(), seat.connect_at]);
        self.controllers.iter().filter_map(next).min()
    }

    /// Everything of time lines and programs that is due.
    fn act(&mut self, record: &mut dyn FnMut(Event)) {
        let now = self.now();
        for (number, seat) in self.drives.iter_mut().enumerate() {
            let due = seat.line.next().is_some_and(|at| at <= now)
                || seat.line.watches_position()
                    && self
                        .medium
                        .segment()
                        .station::<Unit>(seat.id)
                        .is_some_and(|unit| seat.line.is_due(now, unit));
            if !due {
                continue;
            }
            let Some(unit) = self.medium.segment_mut().station_mut::<Unit>(seat.id) else {
                continue;
            };
            for played in seat.line.play(now, unit) {
                let event = Event::at(now, &seat.name, played.into());
                if let Some(monitor) = &mut self.monitor {
                    monitor.note(number, &event);
                }
                record(event);
            }
        }
        for seat in &mut self.controllers {
            let drive = self.drives.get(seat.drive).map_or("", |seat| &seat.name);
            while seat.is_due(now) {
                let Some(host) = self.medium.segment_mut().station_mut::<Host<Controller>>(seat.id) else {
                    break;
                };
                if let Some(text) = seat.act(now, host.endpoint_mut()) {
                    record(Event::at(
                        now,
                        drive,
                        EventKind::note(&format!("controller: {text}")),
                    ));
                }
            }
        }
        if let Some((period, at)) = &mut self.sample
            && *at <= now
        {
            *at += *period;
            for seat in &self.drives {
                if let Some(unit) = self.medium.segment().station::<Unit>(seat.id) {
                    let sample = sample(seat.status, unit.inner().endpoint().drive());
                    record(Event::at(now, &seat.name, EventKind::Sample(sample)));
                }
            }
        }
    }

    /// Records the events of drives and controllers, and checks what is expected.
    fn look(&mut self, record: &mut dyn FnMut(Event)) {
        let now = self.now();
        for number in 0..self.drives.len() {
            self.look_at_drive(number, now, record);
        }
        self.look_at_controllers(now, record);
        self.check(now);
    }

    fn look_at_drive(&mut self, number: usize, now: Instant, record: &mut dyn FnMut(Event)) {
        let Some(seat) = self.drives.get_mut(number) else {
            return;
        };
        let mut record = |seat: &Seat, kind: EventKind| {
            let event = Event::at(now, &seat.name, kind);
            if let Some(monitor) = &mut self.monitor {
                monitor.note(number, &event);
            }
            record(event);
        };
        let Some(unit) = self.medium.segment().station::<Unit>(seat.id) else {
            return;
        };
        let station = unit.inner().endpoint();
        let status = station.drive().status_word();
        if station.has_event() {
            let Some(unit) = self.medium.segment_mut().station_mut::<Unit>(seat.id) else {
                return;
            };
            while let Some(event) = unit.inner_mut().endpoint_mut().poll_event() {
                for kind in seat.kinds(&event) {
                    record(seat, kind);
                }
            }
        }
        if status.0 == seat.status {
            return;
        }
        let before = Zsw1(std::mem::replace(&mut seat.status, status.0));
        if let Some(unit) = self.medium.segment().station::<Unit>(seat.id) {
            let drive = unit.inner().endpoint().drive();
            if drive.is_positioning() {
                for kind in EventKind::of_positioning(before, status, revolutions(drive.axis().position())) {
                    record(seat, kind);
                }
            }
            record(seat, EventKind::Sample(sample(seat.status, drive)));
        }
    }

    fn look_at_controllers(&mut self, now: Instant, record: &mut dyn FnMut(Event)) {
        for seat in &mut self.controllers {
            let waiting = self
                .medium
                .segment()
                .station::<Host<Controller>>(seat.id)
                .is_some_and(|host| host.endpoint().has_event());
            if !waiting {
                continue;
            }
            let drive = self.drives.get(seat.drive).map_or("", |seat| &seat.name);
            let Some(host) = self.medium.segment_mut().station_mut::<Host<Controller>>(seat.id) else {
                continue;
            };
            while let Some(event) = host.endpoint_mut().poll_event() {
                if let Some(text) = seat.take(now, event, host.endpoint_mut()) {
                    record(Event::at(
                        now,
                        drive,
                        EventKind::note(&format!("controller: {text}")),
                    ));
                }
            }
        }
    }
}

impl Seat {
    /// Returns an event of the station as events of a trace: an acknowledge is one for each fault.
    fn kinds(&mut self, event: &StationEvent) -> Vec<EventKind> {
        let catalogue = self.model.catalogue;
        match event {
            StationEvent::Fault { number } => self.faults.push(*number),
            StationEvent::Exchanging { .. } => self.connected = Some(true),
            StationEvent::Disconnected { .. } => self.connected = Some(false),
            StationEvent::Acknowledged if !self.faults.is_empty() => {
                let faults = std::mem::take(&mut self.faults).into_iter();
                let cleared = faults.map(|number| EventKind::FaultCleared {
                    fault: DriveMessage::of(number, false, catalogue),
                });
                return cleared.collect();
            }
            _ => {}
        }
        EventKind::of_station(event, catalogue).into_iter().collect()
    }
}

impl Medium for World {
    type Error = Infallible;

    fn now(&self) -> Instant {
        self.medium.now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Infallible> {
        let mut observer = self.observer.take();
        let mut record = |entry| {
            if let Some(observer) = &mut observer {
                observer(entry);
            }
        };
        loop {
            self.act(&mut record);
            // from event to event: a time line may wait for the place that an axis reaches
            let next = self.next_event().min(until);
            let handled = self.medium.advance(endpoint, next);
            self.look(&mut record);
            if handled || self.now() >= until {
                break;
            }
        }
        self.observer = observer;
        Ok(())
    }
}

impl PlantPlan {
    /// Returns the IP address of a client in the plant: a free one beside the first drive that has an address, or
    /// 192.168.0.254/24 where none has.
    ///
    /// # Errors
    /// When no address is left there.
    pub fn client_address(&self) -> Result<IpSuite, WorldError> {
        match self.drives.iter().find(|drive| drive.ip.is_set()) {
            Some(drive) => free_address(self, drive, self.controllers.len()),
            None => Ok(IpSuite {
                address: [192, 168, 0, 254].into(),
                mask: [255, 255, 255, 0].into(),
                gateway: [0; 4].into(),
            }),
        }
    }
}

fn sample(status: u16, drive: &Drive) -> Sample {
    let axis = drive.axis();
    Sample {
        stw1: drive.control_word().0,
        zsw1: status,
        speed: axis.speed(),
        position: revolutions(axis.position()),
        current: axis.current(),
    }
}

/// Returns an address in the subnet of a drive that no drive has, from its upper end down.
fn free_address(plant: &PlantPlan, beside: &DrivePlan, number: usize) -> Result<IpSuite, WorldError> {
    let mask = u32::from(beside.ip.mask);
    let broadcast = u32::from(beside.ip.address) | !mask;
    let network = broadcast & mask;
    let free = (network + 1..broadcast).rev().filter(|address| {
        let taken = |plan: &DrivePlan| u32::from(plan.ip.address) == *address;
        !plant.drives.iter().any(taken)
    });
    let address = free.take(1024).nth(number).ok_or_else(|| WorldError::NoAddress {
        drive: beside.name.clone(),
    })?;
    Ok(IpSuite {
        address: address.into(),
        ..beside.ip
    })
}

/// Returns the modules that a controller expects in a drive of this model with this telegram.
fn expected_modules(model: &'static Model, telegram: u16) -> Vec<ModuleConfig> {
    let description = Description::of(model);
    let access_point = description.access_points.first().map(|module| (0, module));
    let mut telegrams = description.telegrams.iter();
    let chosen = telegrams
        .find(|module| module.telegram == telegram)
        .map(|module| (module.slot, &module.module));
    access_point.into_iter().chain(chosen).map(expected).collect()
}

fn expected((slot, module): (u16, &ModuleDescription)) -> ModuleConfig {
    let submodules = module.submodules.iter().map(|submodule| SubmoduleConfig {
        subslot: submodule.subslot,
        ident: submodule.ident,
        input_length: submodule.input_length,
        output_length: submodule.output_length,
    });
    ModuleConfig {
        api: module.submodules.first().map_or(0, |submodule| submodule.api),
        slot,
        ident: module.ident,
        submodules: submodules.collect(),
    }
}

impl ControllerSeat {
    fn new(id: StationId, plan: &ControllerPlan, drive: &DrivePlan) -> Self {
        let device = &drive.model.catalogue.device;
        // the file was checked: only telegrams of the model come here
        let module = device.telegram(plan.telegram);
        let modules = expected_modules(drive.model, plan.telegram);
        let outputs = module.map_or(0, |module| module.outputs);
        // the file was checked: only update times that exist come here
        let timing = Timing::for_interval(plan.cycle).unwrap_or(Timing {
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
        });
        let mut connect = ConnectConfig::new(modules, timing);
        connect.resolve = Resolve::Check;
        connect.watchdog_factor = plan.watchdog;
        connect.data_hold_factor = plan.watchdog;
        let steps = plan.steps.iter().cloned().enumerate();
        Self {
            id,
            drive: plan.drive,
            target: Target {
                name: drive.name.clone(),
                mac: None,
                ip: drive.ip,
                vendor_id: device.vendor_id,
                device_id: device.device_id,
                instance: 1,
            },
            connect,
            ar: None,
            connect_at: Some(Instant::ZERO),
            steps: steps.map(|(number, step)| ((step.at, number), step)).collect(),
            outputs: vec![0; usize::from(outputs)],
            subslot: device.layout.telegram,
        }
    }

    fn next_step(&self) -> Option<Instant> {
        let (at, _) = self.steps.first_key_value()?.0;
        Some(Instant::ZERO + *at)
    }

    fn is_due(&self, now: Instant) -> bool {
        Instant::earliest([self.next_step(), self.connect_at]).is_some_and(|at| at <= now)
    }

    /// Executes one due action. Returns the resulting message.
    fn act(&mut self, now: Instant, controller: &mut Controller) -> Option<String> {
        if self.connect_at.is_some_and(|at| at <= now) {
            self.connect_at = None;
            match controller.connect(now, self.target.clone(), self.connect.clone()) {
                Ok(ar) => self.ar = Some(ar),
                Err(misuse) => return Some(format!("cannot connect: {misuse}")),
            }
            return None;
        }
        let ((at, number), step) = self.steps.pop_first()?;
        if let Some(every) = step.every {
            self.steps.insert((at + every, number), step.clone());
        }
        match step.action {
            Action::Send(signals) => {
                for (field, value) in signals {
                    // the file was checked: the signal is in the telegram, the value fits
                    let _ = field.set(&mut self.outputs, value);
                }
            }
            Action::Words(words) => {
                let (places, _) = self.outputs.as_chunks_mut::<2>();
                for (place, word) in places.iter_mut().zip(words) {
                    *place = word.to_be_bytes();
                }
            }
            Action::Release => {
                self.connect_at = None;
                let released = self.ar.map(|ar| controller.release(now, ar));
                return matches!(released, Some(Err(_)) | None).then(|| "nothing to release".into());
            }
            Action::Connect => {
                if self.ar.is_none() {
                    self.connect_at = Some(now);
                }
                return None;
            }
            Action::Stop | Action::Run => {
                let run = step.action == Action::Run;
                if let Some(ar) = self.ar {
                    let _ = controller.set_run(ar, run);
                }
                return Some(if run { "RUN" } else { "STOP" }.into());
            }
        }
        self.send(controller);
        None
    }

    fn send(&self, controller: &mut Controller) {
        if let Some(ar) = self.ar {
            // before the connection is there it is set again when it is
            let _ = controller.set_output(ar, 1, self.subslot, &self.outputs);
        }
    }

    /// Handles an event of the controller. Returns the resulting message.
    fn take(&mut self, now: Instant, event: ControllerEvent, controller: &mut Controller) -> Option<String> {
        let own = self.ar;
        match event {
            ControllerEvent::Connected { ar, diff } if own == Some(ar) => {
                self.send(controller);
                // a drive may name a module of which nothing differs
                let wrong = diff.is_some_and(|diff| {
                    diff.modules
                        .iter()
                        .any(|module| module.state != ModuleState::PROPER)
                });
                let differs = if wrong { ", the modules differ" } else { "" };
                Some(format!("connected{differs}"))
            }
            ControllerEvent::Running { ar } if own == Some(ar) => Some("exchanges data".into()),
            ControllerEvent::Lost { ar, cause } if own == Some(ar) => {
                self.ar = None;
                self.connect_at = Some(now + RECONNECT_DELAY);
                Some(format!("connection lost: {cause}"))
            }
            ControllerEvent::Released { ar } if own == Some(ar) => {
                self.ar = None;
                Some("released".into())
            }
            _ => None,
        }
    }
}
