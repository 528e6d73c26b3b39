//! An Ethernet segment in memory: a switch, stations, virtual time, seeded faults.
//!
//! Time is virtual: it jumps from event to event, so an hour passes in seconds and nothing depends on the machine.
//! The same seed and the same calls give the same frames at the same times, which
//! [`Segment::trace_hash`] makes easy to compare.

mod conditions;
mod fabric;
mod frames;
mod medium;
mod tap;

use std::any::Any;

use profinet::{Deadlines, Endpoint, Instant, MAX_FRAME, MacAddress};
use std::time::Duration;

use crate::host::{Stack, Station};

pub use crate::host::StationId;

pub use conditions::Conditions;
pub use fabric::SegmentStatistics;
use fabric::{Delivery, Fabric};
pub(crate) use fabric::{chance, jitter};
pub use medium::{Pace, SegmentMedium};
pub use tap::Tap;
#[cfg(all(feature = "raw-ethernet", target_os = "linux"))]
pub(crate) use tap::finish_all;

/// Most frames taken from one station in one turn; what is left follows a microsecond later.
const MAX_BURST: usize = 1024;
/// Delay of a station that requests to be called again at once, so that time always goes on.
const SHORTEST_WAIT: Duration = Duration::from_micros(1);

/// An endpoint that is lent for one call, with its IP part.
struct Guest<'a> {
    port: usize,
    stack: &'a mut Stack,
    endpoint: &'a mut dyn Endpoint,
}

/// The in-memory segment.
///
/// ```
/// use profidrive_network::segment::{Conditions, Segment};
/// use profinet::Instant;
/// let mut segment = Segment::new(42);
/// segment.set_all_conditions(Conditions { loss: 0.01, ..Conditions::default() });
/// // segment.attach(Box::new(Host::new(engine))) ...
/// segment.run_until(Instant::from_millis(3_600_000));
/// assert_eq!(segment.now(), Instant::from_millis(3_600_000));
/// assert_eq!(segment.statistics().sent, 0);
/// ```
pub struct Segment {
    now: Instant,
    stations: Vec<Option<Box<dyn Station>>>,
    deadlines: Deadlines,
    /// Stations to be drained before time goes on: new, or touched by the owner.
    dirty: Vec<usize>,
    fabric: Fabric,
    buffer: Box<[u8]>,
}

impl std::fmt::Debug for Segment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Segment")
            .field("now", &self.now)
            .field("stations", &self.stations.len())
            .field("statistics", &self.statistics())
            .finish_non_exhaustive()
    }
}

impl Segment {
    /// Creates an empty segment at time zero; `seed` determines all random faults.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            now: Instant::ZERO,
            stations: Vec::new(),
            deadlines: Deadlines::default(),
            dirty: Vec::new(),
            fabric: Fabric::new(seed),
            buffer: vec![0; 2 * MAX_FRAME].into_boxed_slice(),
        }
    }

    /// Returns the present virtual time.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.now
    }

    /// Plugs a station in. It is drained before time goes on.
    pub fn attach(&mut self, station: Box<dyn Station>) -> StationId {
        let port = self.add_port(station.mac());
        self.stations.push(Some(station));
        self.dirty.push(port);
        StationId(port)
    }

    /// Takes a station away, as if it had lost its power; its place stays and can be filled again.
    pub fn detach(&mut self, id: StationId) -> Option<Box<dyn Station>> {
        self.deadlines.set(id.0, None);
        self.stations.get_mut(id.0)?.take()
    }

    /// Puts a station into an empty place, for example the same drive after a restart. Gives it back if the place
    /// is taken or does not exist.
    ///
    /// # Errors
    /// The station, when there is no empty place `id`.
    pub fn insert(&mut self, id: StationId, station: Box<dyn Station>) -> Result<(), Box<dyn Station>> {
        match self.stations.get_mut(id.0) {
            Some(place @ None) => {
                self.fabric.set_mac(id.0, station.mac());
                *place = Some(station);
                self.dirty.push(id.0);
                Ok(())
            }
            _ => Err(station),
        }
    }

    /// Returns the station in its own type, to look at; `None` if it is of another type.
    #[must_use]
    pub fn station<T: Station>(&self, id: StationId) -> Option<&T> {
        let station: &dyn Any = self.stations.get(id.0)?.as_deref()?;
        station.downcast_ref()
    }

    /// Returns the station in its own type, to give it work; it is drained before time goes on.
    #[must_use]
    pub fn station_mut<T: Station>(&mut self, id: StationId) -> Option<&mut T> {
        let station: &mut dyn Any = self.stations.get_mut(id.0)?.as_deref_mut()?;
        self.dirty.push(id.0);
        station.downcast_mut()
    }

    /// The faults on the way to one station.
    pub fn set_conditions(&mut self, id: StationId, conditions: Conditions) {
        self.fabric.set_conditions(id.0, conditions);
    }

    /// The faults on the way to every station, present and to come.
    pub fn set_all_conditions(&mut self, conditions: Conditions) {
        self.fabric.set_all_conditions(conditions);
    }

    /// Pulls the cable of a station: nothing gets there, nothing comes from there, what is under way is lost.
    pub fn cut(&mut self, id: StationId) {
        self.fabric.set_cut(id.0, true);
    }

    /// Plugs the cable in again.
    pub fn uncut(&mut self, id: StationId) {
        self.fabric.set_cut(id.0, false);
    }

    /// Puts a foreign frame on the segment, without an attached sender.
    pub fn inject(&mut self, frame: &[u8]) {
        self.fabric.send(self.now, None, frame);
    }

    /// Lets `tap` see every frame that reaches the switch, before any fault on its further way.
    pub fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.fabric.add_tap(tap);
    }

    /// Ends all taps: buffers are flushed and the first failure is reported.
    ///
    /// # Errors
    /// When a tap could not write what it saw.
    pub fn finish_taps(&mut self) -> std::io::Result<()> {
        self.fabric.finish_taps()
    }

    /// Returns the counters.
    #[must_use]
    pub fn statistics(&self) -> SegmentStatistics {
        self.fabric.statistics()
    }

    /// Returns a hash over every delivery so far: time, receiver and octets. Equal for equal seeds and equal calls.
    #[must_use]
    pub fn trace_hash(&self) -> u64 {
        self.fabric.trace_hash()
    }

    /// Returns the time when the next thing happens; `None` when nothing ever will.
    #[must_use]
    pub fn next_event(&self) -> Option<Instant> {
        if !self.dirty.is_empty() {
            return Some(self.now);
        }
        Instant::earliest([self.fabric.next_delivery(), self.deadlines.earliest()]).map(|at| at.max(self.now))
    }

    /// Jumps to the next event and does it; returns the new time, or `None` when nothing ever happens again.
    pub fn step(&mut self) -> Option<Instant> {
        self.drain_dirty(&mut None);
        let at = self.next_event()?;
        self.turn(at, &mut None);
        Some(self.now)
    }

    /// Does everything that is due up to and including `until`, then stands at `until`.
    pub fn run_until(&mut self, until: Instant) {
        self.drain_dirty(&mut None);
        while let Some(at) = self.next_event().filter(|at| *at <= until) {
            self.turn(at, &mut None);
        }
        self.now = self.now.max(until);
    }

    fn add_port(&mut self, mac: MacAddress) -> usize {
        let port = self.deadlines.push();
        self.fabric.add_port(mac);
        port
    }

    /// Returns a place without a station, for a [`Guest`].
    fn add_guest_port(&mut self, mac: MacAddress) -> usize {
        let port = self.add_port(mac);
        self.stations.push(None);
        self.fabric.keep_for_guest(port);
        port
    }

    /// Does one event, at `at`; true if the guest took part.
    fn turn(&mut self, at: Instant, guest: &mut Option<Guest<'_>>) -> bool {
        self.now = self.now.max(at);
        self.drain_dirty(guest);
        if let Some(delivery) = self.fabric.pop_delivery(self.now) {
            return self.deliver(delivery, guest);
        }
        let due = self
            .deadlines
            .earliest()
            .is_some_and(|deadline| deadline <= self.now);
        let Some(port) = self.deadlines.earliest_index().filter(|_| due) else {
            return false;
        };
        let guests = match (self.stations.get_mut(port), &mut *guest) {
            (Some(Some(station)), _) => {
                station.handle_timeout(self.now);
                false
            }
            (_, Some(guest)) if guest.port == port => {
                guest.stack.handle_timeout(self.now, guest.endpoint);
                true
            }
            _ => false,
        };
        self.drain(port, guest);
        // A station due again at once is called a moment later, as virtual time must advance.
        let next = self
            .poll_timeout(port, guest)
            .map(|at| at.max(self.now + SHORTEST_WAIT));
        self.deadlines.set(port, next);
        guests
    }

    fn deliver(&mut self, delivery: Delivery, guest: &mut Option<Guest<'_>>) -> bool {
        let port = delivery.port;
        let guests = match (self.stations.get_mut(port), &mut *guest) {
            (Some(Some(station)), _) => {
                station.handle_frame(self.now, self.fabric.bytes(&delivery));
                false
            }
            (_, Some(guest)) if guest.port == port => {
                guest
                    .stack
                    .handle_frame(self.now, self.fabric.bytes(&delivery), guest.endpoint);
                true
            }
            _ => {
                self.fabric.keep_or_drop(delivery);
                return false;
            }
        };
        self.fabric.release(delivery);
        self.drain(port, guest);
        let next = self.poll_timeout(port, guest);
        self.deadlines.set(port, next);
        guests
    }

    fn drain_dirty(&mut self, guest: &mut Option<Guest<'_>>) {
        while let Some(port) = self.dirty.pop() {
            self.drain(port, guest);
            let next = self.poll_timeout(port, guest);
            self.deadlines.set(port, next);
        }
    }

    /// Sends what a station has to send.
    fn drain(&mut self, port: usize, guest: &mut Option<Guest<'_>>) {
        for _ in 0..MAX_BURST {
            let length = match (self.stations.get_mut(port), &mut *guest) {
                (Some(Some(station)), _) => station.poll_transmit(self.now, &mut self.buffer),
                (_, Some(guest)) if guest.port == port => {
                    guest
                        .stack
                        .poll_transmit(self.now, &mut self.buffer, guest.endpoint)
                }
                _ => None,
            };
            let Some(length) = length else { return };
            if let Some(frame) = self.buffer.get(..length) {
                self.fabric.send(self.now, Some(port), frame);
            }
        }
    }

    fn poll_timeout(&self, port: usize, guest: &Option<Guest<'_>>) -> Option<Instant> {
        match (self.stations.get(port), guest) {
            (Some(Some(station)), _) => station.poll_timeout(),
            (_, Some(guest)) if guest.port == port => guest.stack.poll_timeout(&*guest.endpoint),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
