//! Stations on a real interface.

use std::any::Any;
use std::collections::BTreeMap;
use std::time::Duration;

use profinet::{Deadlines, Instant, MAX_FRAME, MacAddress};

use super::filter::Wanted;
use super::packet::PacketSocket;
use super::watch::Watch;
use crate::ethernet::{Lateness, PacketStatistics, Turn};
use crate::host::{Audience, Interest, Station, StationId, addresses};
use crate::segment::{Tap, finish_all};
use crate::system::linux::sharpen_timers;
use crate::system::{Bell, Error, InterfaceInfo, Stop, now};

/// Most frames handled before deadlines get their turn, and most deadlines before frames get theirs: with more to do than there
/// is time for, neither keeps the other waiting. Stations that only send would lose the connections that they send for.
const MAX_EACH: usize = 64;
/// Most frames taken from one station in one turn; what is left follows a moment later.
const MAX_BURST: usize = 256;
/// Delay of a station that requests to be called again at once.
const SHORTEST_WAIT: Duration = Duration::from_micros(1);
/// A deadline met later than this counts as late: a cycle of the fastest drives.
const LATE: Duration = Duration::from_millis(1);
/// With so many stations frames and deadlines are handled in batches: waking up for each costs more than the work itself.
const FLEET: usize = 32;
/// Shortest time between the batches of a fleet, an eighth of the shortest update time.
const PAUSE: Duration = Duration::from_micros(125);

/// Runs any number of [`Station`]s on one interface, in the thread of its owner.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # fn stations() -> Vec<Box<dyn profidrive_network::host::Station>> { Vec::new() }
/// use profidrive_network::ethernet::{Runner, Turn};
/// use profidrive_network::system::{Stop, now};
/// let mut runner = Runner::open("eth0")?;
/// runner.set_stop(Stop::on_signals()?)?;
/// for station in stations() {
///     runner.attach(station)?;
/// }
/// while runner.step(now() + std::time::Duration::from_secs(1))? != Turn::Stopped {
///     for id in runner.touched() {
///         // look at the events of that station
///     }
/// }
/// # Ok(()) }
/// ```
pub struct Runner {
    socket: PacketSocket,
    watch: Watch,
    stations: Vec<Option<Box<dyn Station>>>,
    by_mac: BTreeMap<MacAddress, usize>,
    deadlines: Deadlines,
    dirty: Vec<usize>,
    /// Which frames for a group each station receives; `None` for one that had a turn since it was asked.
    interests: Vec<Option<Interest>>,
    /// The stations that one received frame is for.
    concerned: Vec<usize>,
    touched: Vec<StationId>,
    /// The turn in which each station was last put into `touched`.
    touched_in: Vec<u64>,
    turn: u64,
    buffer: Box<[u8]>,
    taps: Vec<Box<dyn Tap>>,
    stop: Option<Stop>,
    bell: Option<Bell>,
    sharpened: bool,
    lateness: Lateness,
    /// Frames arrive from or for so many stations that they are handled in batches.
    batches: bool,
    /// Not before this time is there another batch.
    next_batch: Instant,
    /// False from the moment the interface failed until it was opened again.
    online: bool,
    failure: Option<Error>,
}

impl std::fmt::Debug for Runner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Runner")
            .field("interface", &self.socket.interface().name)
            .field("stations", &self.stations.len())
            .finish_non_exhaustive()
    }
}

impl Runner {
    /// Opens an interface.
    ///
    /// # Errors
    /// No such interface, interface down, no Ethernet, no right to raw sockets.
    pub fn open(interface: &str) -> Result<Self, Error> {
        Self::open_for(interface, 1)
    }

    /// Opens an interface for so many stations, or for a controller of so many: the receive ring has room for what arrives
    /// while this process does not run, and from 32 on frames are handled in batches. Any number can be attached.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_for(interface: &str, stations: usize) -> Result<Self, Error> {
        let socket = PacketSocket::open(interface, Wanted::Stations, stations)?;
        let watch = Watch::new().map_err(Error::system("cannot wait for frames"))?;
        watch
            .add(socket.fd())
            .map_err(Error::system("cannot wait for frames"))?;
        Ok(Self {
            socket,
            watch,
            stations: Vec::new(),
            by_mac: BTreeMap::new(),
            deadlines: Deadlines::default(),
            dirty: Vec::new(),
            interests: Vec::new(),
            concerned: Vec::new(),
            touched: Vec::new(),
            touched_in: Vec::new(),
            turn: 0,
            buffer: vec![0; 2 * MAX_FRAME].into_boxed_slice(),
            taps: Vec::new(),
            stop: None,
            bell: None,
            sharpened: false,
            lateness: Lateness::default(),
            batches: stations >= FLEET,
            next_batch: Instant::ZERO,
            online: true,
            failure: None,
        })
    }

    /// Opens the interface once more, after [`step`](Self::step) reported that it is down or gone. Until this succeeds
    /// the stations continue in steps, but receive no frames, and the frames they send are lost.
    ///
    /// # Errors
    /// As [`open`](Self::open); it may be tried again.
    pub fn reopen(&mut self) -> Result<(), Error> {
        let mut socket = PacketSocket::open(
            &self.socket.interface().name,
            Wanted::Stations,
            self.stations.len(),
        )?;
        for station in self.stations.iter().flatten() {
            socket.add_address(station.mac())?;
        }
        self.watch
            .add(socket.fd())
            .map_err(Error::system("cannot wait for frames"))?;
        self.socket = socket;
        self.online = true;
        Ok(())
    }

    /// Returns the interface as it was when opened.
    #[must_use]
    pub fn interface(&self) -> &InterfaceInfo {
        self.socket.interface()
    }

    /// Returns the counters of the socket.
    #[must_use]
    pub fn statistics(&mut self) -> PacketStatistics {
        self.socket.statistics()
    }

    /// Returns how late it did what was due.
    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        self.lateness
    }

    /// Adds a station; it is drained by the next [`step`](Self::step).
    ///
    /// # Errors
    /// When the interface cannot be switched to receive for a further address.
    pub fn attach(&mut self, station: Box<dyn Station>) -> Result<StationId, Error> {
        let mac = station.mac();
        self.socket.add_address(mac)?;
        let index = self.deadlines.push();
        self.by_mac.insert(mac, index);
        self.stations.push(Some(station));
        self.batches |= self.stations.len() >= FLEET;
        self.touched_in.push(0);
        self.interests.push(None);
        self.dirty.push(index);
        Ok(StationId(index))
    }

    /// Takes a station away.
    pub fn detach(&mut self, id: StationId) -> Option<Box<dyn Station>> {
        self.deadlines.set(id.0, None);
        self.by_mac.retain(|_, index| *index != id.0);
        self.stations.get_mut(id.0)?.take()
    }

    /// Returns the station in its own type, to look at; `None` if it is of another type.
    #[must_use]
    pub fn station<T: Station>(&self, id: StationId) -> Option<&T> {
        let station: &dyn Any = self.stations.get(id.0)?.as_deref()?;
        station.downcast_ref()
    }

    /// Returns the station in its own type, to take its events and give it work; the next [`step`](Self::step) drains
    /// it.
    #[must_use]
    pub fn station_mut<T: Station>(&mut self, id: StationId) -> Option<&mut T> {
        let station: &mut dyn Any = self.stations.get_mut(id.0)?.as_deref_mut()?;
        if self.dirty.last() != Some(&id.0) {
            self.dirty.push(id.0);
        }
        station.downcast_mut()
    }

    /// Returns the stations that handled something in the last [`step`](Self::step), each once.
    #[must_use]
    pub fn touched(&self) -> &[StationId] {
        &self.touched
    }

    /// Lets this flag end a step early.
    ///
    /// # Errors
    /// When the system has no room to watch it.
    pub fn set_stop(&mut self, stop: Stop) -> Result<(), Error> {
        if let Some(former) = self.stop.take() {
            self.watch.remove(former.event().fd());
        }
        self.watch
            .add(stop.event().fd())
            .map_err(Error::system("cannot wait for the end of the program"))?;
        self.stop = Some(stop);
        Ok(())
    }

    /// Lets this bell end a step with [`Turn::Rung`].
    ///
    /// # Errors
    /// When the system has no room to watch it.
    pub fn set_bell(&mut self, bell: Bell) -> Result<(), Error> {
        if let Some(former) = self.bell.take() {
            self.watch.remove(former.event().fd());
        }
        self.watch
            .add(bell.event().fd())
            .map_err(Error::system("cannot wait for requests"))?;
        self.bell = Some(bell);
        Ok(())
    }

    /// Lets `tap` see every frame received for the stations and sent by them; times are those of [`now`](crate::system::now),
    /// tags that the kernel took out are put in again.
    pub fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.taps.push(tap);
    }

    /// Ends all taps: buffers are flushed and the first failure is reported.
    ///
    /// # Errors
    /// When a tap could not write what it saw.
    pub fn finish_taps(&mut self) -> std::io::Result<()> {
        finish_all(&mut self.taps)
    }

    /// Works until at least one station has handled a frame or a deadline, `until` is reached, the bell rings, or the
    /// stop flag is set. Sleeps in between.
    ///
    /// # Errors
    /// When the interface is down or gone, or the system refuses to wait. The failure is reported once; further steps
    /// run the stations without a network until [`reopen`](Self::reopen) succeeds.
    pub fn step(&mut self, until: Instant) -> Result<Turn, Error> {
        if !self.sharpened {
            sharpen_timers();
            self.sharpened = true;
        }
        self.touched.clear();
        self.turn += 1;
        self.rest(until);
        loop {
            if self.stop.as_ref().is_some_and(Stop::is_stopped) {
                self.work(now())?;
                return Ok(Turn::Stopped);
            }
            let at = now();
            self.work(at)?;
            if self.bell.as_ref().is_some_and(Bell::was_rung) {
                return Ok(Turn::Rung);
            }
            if !self.touched.is_empty() {
                return Ok(Turn::Worked);
            }
            if at >= until {
                return Ok(Turn::Idle);
            }
            let wake = self
                .deadlines
                .earliest()
                .map_or(until, |deadline| deadline.min(until));
            let woken = self
                .watch
                .wait(self.socket.fd(), wake - now())
                .map_err(Error::system("cannot wait for frames"))?;
            if let (true, Some(bell)) = (woken.by_another, &self.bell) {
                bell.quiet();
            }
            if self.online {
                let checked = self.socket.check(woken.events);
                self.note(checked);
            }
            self.take_failure()?;
        }
    }

    /// Sleeps until the next batch of a fleet is due. A stop or a bell waits as long: at most 125 us.
    fn rest(&mut self, until: Instant) {
        if !self.batches {
            return;
        }
        let at = now();
        let left = self.next_batch.min(until) - at;
        if !left.is_zero() {
            std::thread::sleep(left);
        }
        self.next_batch = at + left + PAUSE;
    }

    /// What is there to do at `now`, frames and deadlines in equal parts, without waiting.
    fn work(&mut self, now: Instant) -> Result<(), Error> {
        while let Some(index) = self.dirty.pop() {
            self.drain(index, now);
            self.schedule(index, Instant::ZERO);
        }
        let received = (0..MAX_EACH)
            .take_while(|_| self.online && self.receive(now))
            .count();
        let met = (0..MAX_EACH).take_while(|_| self.meet(now)).count();
        if received.max(met) == MAX_EACH {
            // there is more
            self.next_batch = Instant::ZERO;
        }
        if self.online {
            let flushed = self.socket.flush();
            self.note(flushed);
        }
        self.take_failure()
    }

    /// Lets the station with the earliest deadline do what is due; false if nothing is.
    fn meet(&mut self, now: Instant) -> bool {
        let Some(due) = self.deadlines.earliest().filter(|due| *due <= now) else {
            return false;
        };
        let Some(index) = self.deadlines.earliest_index() else {
            return false;
        };
        // the time of a station that wants its turn at once, as when it is new, says nothing about a delay
        if due > Instant::ZERO {
            self.note_delay(now - due);
        }
        self.turn(index, now, now + SHORTEST_WAIT);
        true
    }

    /// Stores a failure of the interface. It does not interrupt a station; it is reported after all had their turn.
    fn note(&mut self, result: Result<(), Error>) {
        if let Err(error) = result {
            self.fail(error);
        }
    }

    /// A socket that failed would wake the runner for ever.
    fn fail(&mut self, error: Error) {
        self.watch.remove(self.socket.fd());
        self.online = false;
        self.failure.get_or_insert(error);
    }

    fn take_failure(&mut self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Passes on one received frame; false if there is none.
    fn receive(&mut self, now: Instant) -> bool {
        let Self {
            socket,
            stations,
            by_mac,
            interests,
            concerned,
            taps,
            buffer,
            ..
        } = self;
        let Some((received, frame)) = socket.peek() else {
            return false;
        };
        if let Some((destination, _)) = addresses(frame) {
            let multicast = destination.is_multicast();
            let single = by_mac.get(&destination).copied();
            if !taps.is_empty() && (multicast || single.is_some()) {
                let whole = received.on_the_wire(frame, buffer);
                taps.iter_mut().for_each(|tap| tap.frame(now, whole));
            }
            if multicast {
                let audience = Audience::of(frame);
                for (index, (station, interest)) in stations.iter().zip(interests).enumerate() {
                    if let Some(station) = station
                        && interest
                            .get_or_insert_with(|| station.interest())
                            .covers(audience)
                    {
                        concerned.push(index);
                    }
                }
            } else {
                concerned.extend(single);
            }
            for index in concerned.iter() {
                if let Some(Some(station)) = stations.get_mut(*index) {
                    station.handle_frame(now, frame);
                }
            }
        }
        socket.release();
        let mut concerned = std::mem::take(&mut self.concerned);
        for index in concerned.drain(..) {
            self.turn(index, now, Instant::ZERO);
        }
        self.concerned = concerned;
        true
    }

    /// Lets a station do what is due, sends its frames and takes note of its deadline, which is not before `earliest`.
    fn turn(&mut self, index: usize, now: Instant, earliest: Instant) {
        if let Some(Some(station)) = self.stations.get_mut(index)
            && station.poll_timeout().is_some_and(|due| due <= now)
        {
            station.handle_timeout(now);
        }
        self.touch(index);
        self.drain(index, now);
        self.schedule(index, earliest);
    }

    fn drain(&mut self, index: usize, now: Instant) {
        if let Some(interest) = self.interests.get_mut(index) {
            *interest = None;
        }
        let queued = self.queue_all(index, now);
        self.note(queued);
    }

    /// Puts all frames of a station into the batch; what follows a failure of the socket is lost.
    fn queue_all(&mut self, index: usize, now: Instant) -> Result<(), Error> {
        let mut result = Ok(());
        let Some(Some(station)) = self.stations.get_mut(index) else {
            return Ok(());
        };
        for _ in 0..MAX_BURST {
            let Some(length) = station.poll_transmit(now, &mut self.buffer) else {
                break;
            };
            let Some(frame) = self.buffer.get(..length) else {
                break;
            };
            if !self.online || result.is_err() {
                continue;
            }
            self.taps.iter_mut().for_each(|tap| tap.frame(now, frame));
            result = self.socket.queue(frame);
        }
        result
    }

    /// Takes note of a station's deadline, not before `earliest`.
    fn schedule(&mut self, index: usize, earliest: Instant) {
        let next = self
            .stations
            .get(index)
            .and_then(Option::as_ref)
            .and_then(|station| station.poll_timeout());
        self.deadlines.set(index, next.map(|at| at.max(earliest)));
    }

    fn note_delay(&mut self, delay: Duration) {
        if delay > LATE {
            self.lateness.late += 1;
        }
        self.lateness.longest = self.lateness.longest.max(delay);
    }

    fn touch(&mut self, index: usize) {
        if let Some(last) = self.touched_in.get_mut(index).filter(|last| **last != self.turn) {
            *last = self.turn;
            self.touched.push(StationId(index));
        }
    }
}
