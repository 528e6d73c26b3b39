//! A plant in virtual time.

mod controller;
mod goal;
mod keep;
mod look;

use std::convert::Infallible;
use std::time::Duration;

use network::host::Host;
use network::segment::{Pace, Segment, SegmentMedium, StationId, Tap};
use profile::state::Zsw1;
use profinet::controller::{Controller, ControllerConfig};
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium};
use virtual_drive::drive::Drive;
use virtual_drive::model::Model;
use virtual_drive::station::{Station, StationEvent};

use controller::ControllerSeat;
pub use goal::{NotMet, Pursuit};
use keep::Watchers;

use crate::event::{PlantEvent, Unit};
use crate::expect::{Expectation, ExpectationResult, Monitor, revolutions};
use crate::lasting::Lasting;
use crate::plan::{DrivePlan, PlantPlan, WorldError};
use crate::text::derived_mac;
use crate::timeline::Timeline;
use crate::trace::{DriveMessage, Event, EventKind, Sample};

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
    watchers: Watchers,
    seed: u64,
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
    /// Torque that works against positive rotation, Nm.
    pub load: f64,
    /// The hard stops, negative and positive, in turns as the position counts; `None` where nothing stops it.
    pub stops: (Option<f64>, Option<f64>),
    /// The limit switches, likewise.
    pub switches: (Option<f64>, Option<f64>),
}

/// A drive in its place.
struct Seat {
    id: StationId,
    name: String,
    mac: MacAddress,
    model: &'static Model,
    line: Timeline,
    lasting: Lasting,
    status: u16,
    /// Numbers of the faults that came and were not acknowledged.
    faults: Vec<u16>,
    /// Whether a controller exchanges data with it; `None` before the first one did.
    connected: Option<bool>,
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
                lasting: Lasting::default(),
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
            watchers: Watchers::default(),
            seed: plant.seed,
        })
    }

    /// Calls `observer` with what happens while a client carries the plant. Replaces the observer before.
    pub fn observe(&mut self, observer: impl FnMut(Event) + Send + 'static) {
        self.observer = Some(Box::new(observer));
    }

    /// Checks these expectations from now on, at each tick of the drives; the time of an expectation counts from the start of
    /// the plant. Replaces those before.
    pub fn expect(&mut self, expectations: &[Expectation], seed: u64) {
        let monitor = Monitor::new(expectations, self.drives.len(), seed);
        let watchers = self.shown(Watchers {
            monitor: Some(Box::new(monitor)),
            ..Watchers::default()
        });
        self.watchers.monitor = watchers.monitor;
    }

    /// Ends the checks at the present time; returns what came of each expectation for each of its drives.
    pub fn finish_expectations(&mut self) -> Vec<ExpectationResult> {
        let end = self.now() - Instant::ZERO;
        let monitor = self.watchers.monitor.take();
        let name = |drive: usize| self.drives.get(drive).map_or("", |seat| &seat.name);
        monitor.map_or_else(Vec::new, |monitor| monitor.finish(end, name))
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
        let travel = axis.plant().travel.unwrap_or_default();
        // homing moves what a position is counted from, and no place of the travel
        let shift = axis.position().wrapping_sub(axis.true_position());
        let place = |at: i64| {
            let is_free = at == i64::MIN || at == i64::MAX;
            (!is_free).then(|| revolutions(at.wrapping_add(shift)))
        };
        Some(Shaft {
            name: &seat.name,
            mac: seat.mac,
            position: revolutions(axis.position()),
            speed: axis.speed(),
            load: axis.load(),
            stops: (place(travel.negative_stop), place(travel.positive_stop)),
            switches: (place(travel.negative_switch), place(travel.positive_switch)),
        })
    }

    /// Returns what has happened to the drive of that number and has not ended, in the order in which it happened:
    /// [`PlantEvent::undo`] ends each.
    ///
    /// ```
    /// use profidrive_plant::{PlantPlan, World};
    /// use profinet::Instant;
    /// let plant = "[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"1s\", do = \"sto=on\", for = \"2s\" }]";
    /// let mut world = World::new(&plant.parse::<PlantPlan>()?)?;
    /// world.run_until(Instant::from_millis(1500), &mut |_| {});
    /// assert_eq!(world.lasting(0).iter().map(ToString::to_string).collect::<Vec<_>>(), ["sto=on"]);
    /// world.run_until(Instant::from_millis(3500), &mut |_| {});
    /// assert!(world.lasting(0).is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn lasting(&self, number: usize) -> &[PlantEvent] {
        self.drives.get(number).map_or(&[], |seat| seat.lasting.events())
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
                seat.lasting.note(played.what);
                let event = Event::at(now, &seat.name, played.into());
                self.watchers.note(number, &event);
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
                    let kind = EventKind::note(&format!("controller: {text}"));
                    let event = Event::at(now, drive, kind);
                    self.watchers.note(seat.drive, &event);
                    record(event);
                }
            }
        }
        if let Some((period, at)) = &mut self.sample
            && *at <= now
        {
            *at += *period;
            for (number, seat) in self.drives.iter().enumerate() {
                if let Some(unit) = self.medium.segment().station::<Unit>(seat.id) {
                    let sample = sample(seat.status, unit.inner().endpoint().drive());
                    let event = Event::at(now, &seat.name, EventKind::Sample(sample));
                    self.watchers.note(number, &event);
                    record(event);
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
        self.show_drives();
    }

    fn look_at_drive(&mut self, number: usize, now: Instant, record: &mut dyn FnMut(Event)) {
        let Some(seat) = self.drives.get_mut(number) else {
            return;
        };
        let mut record = |seat: &Seat, kind: EventKind| {
            let event = Event::at(now, &seat.name, kind);
            self.watchers.note(number, &event);
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
                    let kind = EventKind::note(&format!("controller: {text}"));
                    let event = Event::at(now, drive, kind);
                    self.watchers.note(seat.drive, &event);
                    record(event);
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
