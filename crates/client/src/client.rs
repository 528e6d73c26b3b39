//! The controller with drive functions: its results, and the axes that it controls between two inputs.

mod axis;
mod line;
mod stop;

use std::collections::{HashMap, VecDeque};
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::Arc;
use std::time::Duration;

use profile::state::Stw1;
use profinet::controller::{
    ArId, CallId, Controller, ControllerConfig, DcpError, DcpId, DcpReply, Event, LostCause, ServiceError,
    Station,
};
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};

use uss::SlaveId;

use crate::axis::{AxisControl, Goal, Octets, Sample, SampleQueue, StopKind, Travel, Wiring};
use crate::line::{Line, LineConfig};
use crate::mapper::{Mapper, QueryId, Registered};
use axis::AxisLink;

pub use axis::AxisView;

/// Maximum number of results that are kept without a waiting caller.
const MAX_RESULTS: usize = 4096;

/// What became of a connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Connection {
    /// Under way.
    Opening,
    /// Records can be read and written.
    Open,
    /// Cyclic data flows.
    Running,
    /// Ended without a request, or was never established.
    Lost(LostCause),
    /// The drive at the serial line does not answer any more.
    Silent,
    /// Released as requested.
    Released,
}

/// A connection that a client has: an application relationship (AR), or a drive at a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Link {
    /// On the network.
    ArListEntry(ArId),
    /// At the line.
    Slave(SlaveId),
}

impl From<ArId> for Link {
    fn from(ar: ArId) -> Self {
        Self::ArListEntry(ar)
    }
}

impl From<SlaveId> for Link {
    fn from(slave: SlaveId) -> Self {
        Self::Slave(slave)
    }
}

/// A PROFINET controller with drive functions; an [`Endpoint`], driven by any [`Medium`](profinet::Medium).
///
/// Axes under control are stepped here, right after each input: a caller that blocks on a parameter read does not
/// hold up the axis beside it.
///
/// One made with [`on_line`](Self::on_line) is the master of a serial line too.
///
/// ```
/// use profidrive_client::Client;
/// use profinet::controller::{ControllerConfig, Filter};
/// use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};
///
/// let own = MacAddress([2, 0, 0, 0, 0, 9]);
/// let mut client = Client::new(ControllerConfig::new(own, IpSuite::NONE, "tool", 1));
/// let id = client.controller().identify(Instant::ZERO, Filter::default()).unwrap();
/// let mut buffer = [0; MAX_FRAME];
/// let sent = client.poll_transmit(Instant::ZERO, &mut buffer);
/// assert!(matches!(sent, Some(Transmit::Frame { .. }))); // who is there?
/// // what comes back goes to `handle_frame`; without an answer the time runs out
/// while let Some(wake) = client.poll_timeout() {
///     client.handle_timeout(wake);
///     while client.poll_transmit(wake, &mut buffer).is_some() {}
/// }
/// assert!(client.take_stations(id).unwrap().stations.is_empty());
/// ```
#[derive(Debug)]
pub struct Client {
    controller: Controller,
    mapper: Mapper,
    line: Option<Line>,
    connections: HashMap<ArId, Connection>,
    axes: Vec<AxisLink>,
    stations: HashMap<DcpId, Vec<Station>>,
    /// Requests whose time is over, and whether more stations answered than were taken.
    identified: VecDeque<(DcpId, bool)>,
    dcp: HashMap<DcpId, Result<DcpReply, DcpError>>,
    records: HashMap<CallId, Result<Vec<u8>, ServiceError>>,
    /// When all axes were stepped last.
    stepped: Instant,
    news: News,
    /// A stop waits for its frame.
    stops_wait: bool,
}

/// The stations that answered a search.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Discovered {
    /// Those that were taken.
    pub stations: Vec<Station>,
    /// Whether more stations answered than one search takes: who they are is not known.
    pub more: bool,
}

/// What callers may have to look at.
#[derive(Debug, Default)]
pub(crate) struct News {
    /// An event: it may concern anyone.
    pub everything: bool,
    /// Axes with new inputs, or whose control did something.
    pub axes: Vec<Link>,
}

impl News {
    fn add(&mut self, link: Link) {
        if !self.axes.contains(&link) {
            self.axes.push(link);
        }
    }
}

/// How often axes are stepped between their inputs: their time limits are no finer.
const STEP: Duration = Duration::from_millis(2);

impl Client {
    /// Creates a client; nothing is sent before something is requested.
    #[must_use]
    pub fn new(config: ControllerConfig) -> Self {
        Self {
            mapper: Mapper::new(config.seed ^ MAPPER_SEED, mapper_port(config.client_port)),
            controller: Controller::new(config),
            line: None,
            connections: HashMap::new(),
            axes: Vec::new(),
            stations: HashMap::new(),
            identified: VecDeque::new(),
            dcp: HashMap::new(),
            records: HashMap::new(),
            stepped: Instant::ZERO,
            news: News::default(),
            stops_wait: false,
        }
    }

    /// Returns the master of a serial line. Its controller has no network and sends nothing.
    #[must_use]
    pub fn on_line(line: LineConfig) -> Self {
        let nowhere = ControllerConfig::new(MacAddress::default(), IpSuite::NONE, "", 0);
        Self {
            line: Some(Line::new(line)),
            ..Self::new(nowhere)
        }
    }

    /// Returns the controller, to start requests with.
    pub fn controller(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// Returns the controller, to look at.
    #[must_use]
    pub const fn controller_ref(&self) -> &Controller {
        &self.controller
    }

    /// Queries the endpoint mapper at `address` which device it belongs to.
    pub fn ask_mapper(&mut self, now: Instant, address: Ipv4Addr) -> QueryId {
        self.mapper.ask(now, address)
    }

    /// Returns the answer to a query of an endpoint mapper, once there is one; `None` inside when it has no device.
    pub fn take_registered(&mut self, query: QueryId) -> Option<Option<Registered>> {
        self.mapper.take(query)
    }

    /// Returns the stations that answered an Identify request, once its time is over.
    pub fn take_stations(&mut self, id: DcpId) -> Option<Discovered> {
        let position = self.identified.iter().position(|(done, _)| *done == id)?;
        let (_, more) = self.identified.remove(position)?;
        let stations = self.stations.remove(&id).unwrap_or_default();
        Some(Discovered { stations, more })
    }

    /// Returns the stations that answered so far, in the order of their answers.
    #[must_use]
    pub fn stations_so_far(&self, id: DcpId) -> &[Station] {
        self.stations.get(&id).map_or(&[], Vec::as_slice)
    }

    /// Returns the stations that answered so far, for a request that was cancelled.
    pub fn take_stations_so_far(&mut self, id: DcpId) -> Vec<Station> {
        self.identified.retain(|(done, _)| *done != id);
        self.stations.remove(&id).unwrap_or_default()
    }

    /// Returns the end of a DCP Get or Set.
    pub fn take_dcp(&mut self, id: DcpId) -> Option<Result<DcpReply, DcpError>> {
        self.dcp.remove(&id)
    }

    /// Returns the end of a record request.
    pub fn take_record(&mut self, call: CallId) -> Option<Result<Vec<u8>, ServiceError>> {
        self.records.remove(&call)
    }

    /// Returns the state of a connection.
    #[must_use]
    pub fn connection(&self, link: impl Into<Link>) -> Connection {
        match link.into() {
            Link::ArListEntry(ar) => self.connections.get(&ar).cloned().unwrap_or(Connection::Opening),
            Link::Slave(slave) => match self.line.as_ref() {
                Some(line) if line.is_cyclic(slave) => match line.answers(slave) {
                    None => Connection::Opening,
                    Some(true) => Connection::Running,
                    Some(false) => Connection::Silent,
                },
                _ => Connection::Released,
            },
        }
    }

    /// Forgets a connection that ended.
    pub fn forget(&mut self, link: impl Into<Link>) {
        let link = link.into();
        match link {
            Link::ArListEntry(ar) => {
                self.connections.remove(&ar);
            }
            Link::Slave(slave) => {
                if let Some(line) = &mut self.line {
                    line.set_cyclic(slave, false);
                }
            }
        }
        self.end_axis(link);
    }

    /// Those who record an axis are reported that no more comes.
    fn end_axis(&mut self, link: Link) {
        for axis in self.axes.extract_if(.., |axis| axis.link == link) {
            axis.taps.iter().for_each(|tap| tap.end());
        }
    }

    /// Keeps the telegram of `slot`/`subslot` of a cyclic connection from now on; control is not taken yet. `control`
    /// knows the mode of the drive, `wiring` where its signals are.
    pub fn attach_axis(&mut self, ar: ArId, slot: u16, subslot: u16, wiring: Wiring, control: AxisControl) {
        self.attach(Link::ArListEntry(ar), (slot, subslot), wiring, control);
    }

    /// Exchanges process data with a drive at the line from now on; control is not taken yet.
    pub(crate) fn attach_slave(&mut self, slave: SlaveId, wiring: Wiring, control: AxisControl) {
        if let Some(line) = &mut self.line {
            line.set_cyclic(slave, true);
        }
        self.attach(Link::Slave(slave), (0, 0), wiring, control);
    }

    fn attach(&mut self, link: Link, (slot, subslot): (u16, u16), wiring: Wiring, control: AxisControl) {
        self.axes.retain(|axis| axis.link != link);
        let control_operates = control.goal() == Goal::Keep;
        self.axes.push(AxisLink {
            link,
            slot,
            subslot,
            wiring,
            control,
            seen: None,
            sent: None,
            answered: Stw1(0),
            since: (0, None),
            operated: control_operates,
            travel: None,
            travel_ended: false,
            stepped: 0,
            sampled: 0,
            taps: Vec::new(),
            stop: None,
        });
        self.take_over();
    }

    /// An axis that is taken over in operation is commanded from the first output on, not from the first input.
    fn take_over(&mut self) {
        for axis in &mut self.axes {
            if axis.control.goal() == Goal::Keep && axis.sent.is_none() {
                axis.send(&mut self.controller, self.line.as_mut());
            }
        }
    }

    /// Sets the goal of the axis of a connection.
    pub fn pursue(&mut self, now: Instant, link: impl Into<Link>, goal: Goal) {
        let link = link.into();
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.pursue(now, goal);
            axis.travel_ended &= !goal.moves();
            axis.operated |= axis.control.goal().operates();
        }
        self.work(now);
    }

    /// Nothing but the stop and the release of an axis is pursued from now on.
    pub(crate) fn only_stop(&mut self, link: Link) {
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.end();
        }
    }

    /// Turns a stop under way into a quick stop (OFF3) or a coast stop (OFF2).
    pub fn hurry(&mut self, now: Instant, link: impl Into<Link>, way: StopKind) {
        let link = link.into();
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.hurry(now, way);
        }
        self.work(now);
    }

    /// Gives every input of an axis to `tap` from now on.
    pub(crate) fn tap(&mut self, link: Link, tap: Arc<SampleQueue>) {
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.taps.push(tap);
        } else {
            tap.end();
        }
    }

    /// Returns where the signals of an axis are.
    pub(crate) fn wiring(&self, link: Link) -> Option<&Wiring> {
        let axis = self.axes.iter().find(|axis| axis.link == link);
        axis.map(|axis| &axis.wiring)
    }

    /// Sets the deadline at which the operation of an axis ends by a ramp stop, unless it is extended.
    pub fn set_deadline(&mut self, link: impl Into<Link>, deadline: Option<Instant>) {
        let link = link.into();
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.set_deadline(deadline);
        }
    }

    /// Sets the time at which a motion of an axis is halted, unless it is extended.
    pub(crate) fn set_beat(&mut self, link: Link, beat: Option<Instant>) {
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.set_beat(beat);
        }
    }

    /// Limits how far an axis may go from where it is.
    pub(crate) fn set_travel(&mut self, link: Link, travel: Option<Travel>) {
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.travel = travel;
        }
    }

    /// Returns how far an axis is and may go, where that is limited.
    pub(crate) fn travel(&self, link: Link) -> Option<Travel> {
        self.axes.iter().find(|axis| axis.link == link)?.travel
    }

    /// Notes that an axis is in operation, though nothing was commanded yet.
    pub(crate) fn note_operated(&mut self, link: impl Into<Link>) {
        let link = link.into();
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.operated = true;
        }
    }

    /// Sets the time limit of the ramp stop of an axis.
    pub fn allow_stop(&mut self, link: impl Into<Link>, limit: Duration) {
        let link = link.into();
        if let Some(axis) = self.axes.iter_mut().find(|axis| axis.link == link) {
            axis.control.allow_stop(limit);
        }
    }

    /// Returns the axis of a connection.
    #[must_use]
    pub fn axis(&self, link: impl Into<Link>) -> Option<AxisView> {
        let link = link.into();
        let axis = self.axes.iter().find(|axis| axis.link == link)?;
        Some(AxisView {
            goal: axis.control.goal(),
            progress: axis.control.progress(),
            command: axis.control.command(),
            sent: axis.wiring.sent(),
            seen: axis.seen,
            answered: axis.answered,
            stays_away: axis.control.stays_away(),
            at_rest: axis.control.is_at_rest(),
            quick_stop: axis.control.stops_quickly(),
            hurried: axis.control.was_hurried(),
            turns: axis.seen.is_some_and(|seen| axis.control.turns(seen)),
            accepted: axis.control.is_accepted(),
            held: axis.control.held(),
            mode: axis.control.mode(),
            operated: axis.operated,
            travel_ended: axis.travel_ended,
        })
    }

    /// Returns what happened since it was asked last.
    pub(crate) fn take_news(&mut self) -> News {
        std::mem::take(&mut self.news)
    }

    /// Handles the events of the controller, then steps the axes.
    fn work(&mut self, now: Instant) {
        self.take_events();
        self.take_over();
        self.stepped = now;
        for at in 0..self.axes.len() {
            self.step(at, now);
        }
    }

    /// Handles the events of the controller; false if there were none.
    fn take_events(&mut self) -> bool {
        let mut happened = false;
        while let Some(event) = self.controller.poll_event() {
            happened = true;
            self.take(event);
        }
        self.news.everything |= happened;
        happened
    }

    /// Steps one axis by its latest inputs.
    fn step(&mut self, at: usize, now: Instant) {
        let Some(axis) = self.axes.get_mut(at) else { return };
        let (received, missed) = match axis.link {
            Link::ArListEntry(ar) => self
                .controller
                .statistics(ar)
                .map_or((0, 0), |counts| (counts.received, counts.missed)),
            Link::Slave(slave) => (self.line.as_ref().map_or(0, |line| line.replies(slave)), 0),
        };
        let answered = axis.control.command();
        let before = (answered, axis.control.progress());
        let tapped = !axis.taps.is_empty();
        let copy = |data: &[u8]| if tapped { Octets::new(data) } else { Octets::NONE };
        let mut bad = false;
        let (seen, data) = match axis.link {
            Link::ArListEntry(ar) => match self.controller.input(ar, axis.slot, axis.subslot) {
                Some((data, provider)) => {
                    bad = !provider.is_good();
                    match bad {
                        true => (None, Octets::NONE),
                        false => (axis.wiring.decode(data), copy(data)),
                    }
                }
                None => return,
            },
            Link::Slave(slave) => {
                let Some(line) = &mut self.line else { return };
                match line.take_inputs(slave) {
                    Some(data) => (axis.wiring.decode(&data), copy(&data)),
                    None if line.answers(slave) == Some(false) => (None, Octets::NONE),
                    None => return,
                }
            }
        };
        let command = match seen {
            Some(seen) => {
                axis.seen = Some(seen);
                axis.note_answer(received);
                axis.keep_within(now, seen);
                axis.control.step(now, seen)
            }
            // nothing is switched on by a drive that reports nothing valid
            None => axis.control.step_blind(now),
        };
        if received != axis.stepped {
            axis.stepped = received;
            self.news.add(axis.link);
        }
        if tapped
            && received != axis.sampled
            && let Some(seen) = seen.or_else(|| axis.seen.filter(|_| bad))
        {
            axis.sampled = received;
            let sample = Sample {
                at: now,
                number: received,
                missed,
                seen,
                valid: !bad,
                command: answered,
                inputs: data,
                outputs: Octets::new(axis.wiring.image()),
            };
            axis.taps.iter().for_each(|tap| tap.push(sample));
        }
        if command.stw1 != answered.stw1 {
            axis.since = (received, axis.seen.map(|seen| seen.zsw1));
        }
        if (command, axis.control.progress()) != before {
            self.news.add(axis.link);
        }
        axis.send(&mut self.controller, self.line.as_mut());
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Identified { id, station } => self.stations.entry(id).or_default().push(station),
            Event::IdentifyDone { id, more, .. } => {
                if self.identified.len() >= MAX_RESULTS
                    && let Some((old, _)) = self.identified.pop_front()
                {
                    self.stations.remove(&old);
                }
                self.identified.push_back((id, more));
            }
            Event::DcpDone { id, result } => {
                bound(&mut self.dcp);
                self.dcp.insert(id, result);
            }
            Event::Connected { ar, .. } | Event::Ready { ar, .. } => {
                self.connections.insert(ar, Connection::Open);
            }
            Event::Running { ar } => {
                self.connections.insert(ar, Connection::Running);
            }
            Event::Lost { ar, cause } => {
                self.connections.insert(ar, Connection::Lost(cause));
            }
            Event::Released { ar } => {
                self.connections.insert(ar, Connection::Released);
            }
            Event::RecordDone { call, result } => {
                bound(&mut self.records);
                self.records.insert(call, result);
            }
            Event::Hello { .. }
            | Event::ProviderState { .. }
            | Event::Alarm { .. }
            | Event::WritesDone { .. } => {}
        }
    }
}

/// Keeps the mapper's UUIDs apart from the controller's.
const MAPPER_SEED: u64 = 0x6D61_7070_6572;

/// Returns the port beside the controller's.
const fn mapper_port(client_port: u16) -> u16 {
    if client_port == u16::MAX {
        client_port - 1
    } else {
        client_port + 1
    }
}

/// Drops results that no caller fetches, so that they do not pile up.
fn bound<K, V>(results: &mut HashMap<K, V>) {
    if results.len() >= MAX_RESULTS {
        results.clear();
    }
}

impl Endpoint for Client {
    fn mac(&self) -> MacAddress {
        self.controller.mac()
    }

    fn ip(&self) -> IpSuite {
        self.controller.ip()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.controller.handle_frame(now, frame);
        let input = self.controller.take_input().map(Link::ArListEntry);
        match self.axes.iter().position(|axis| Some(axis.link) == input) {
            // what one drive reports concerns no other
            Some(at) if !self.controller.has_event() => self.step(at, now),
            _ => self.work(now),
        }
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        if local_port == self.mapper.port() {
            self.mapper.handle_datagram(now, source, payload);
            self.news.everything = true;
        } else {
            self.controller.handle_datagram(now, source, local_port, payload);
        }
        self.work(now);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.controller.handle_timeout(now);
        self.news.everything |= self.mapper.poll_timeout().is_some();
        self.mapper.handle_timeout(now);
        if self.controller.has_event() || now >= self.stepped + STEP {
            self.work(now);
        }
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let sent = self.controller.poll_transmit(now, buffer);
        if self.stops_wait && sent.is_some() {
            self.note_stops(now);
        }
        sent.or_else(|| self.mapper.poll_transmit(now, buffer))
    }

    fn poll_timeout(&self) -> Option<Instant> {
        Instant::earliest([self.controller.poll_timeout(), self.mapper.poll_timeout()])
    }

    fn may_wait(&self) -> Duration {
        self.controller.may_wait()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_that_no_caller_fetches_are_bounded() {
        let own = MacAddress([2, 0, 0, 0, 0, 9]);
        let mut client = Client::new(ControllerConfig::new(own, IpSuite::NONE, "tool", 1));
        let mut now = Instant::ZERO;
        let mut buffer = [0; profinet::MAX_FRAME];
        let mut ids = Vec::new();
        for _ in 0..5 {
            for _ in 0..1000 {
                let id = client.controller().identify(now, Default::default()).unwrap();
                let station = Station::default();
                client.take(Event::Identified { id, station });
                ids.push(id);
            }
            while let Some(due) = client.poll_timeout() {
                now = due;
                client.handle_timeout(now);
                while client.poll_transmit(now, &mut buffer).is_some() {}
            }
        }
        assert_eq!(client.stations.len(), MAX_RESULTS);
        let (gone, kept) = ids.split_at(ids.len() - MAX_RESULTS);
        assert!(gone.iter().all(|id| client.take_stations(*id).is_none()));
        assert!(kept.iter().all(|id| client.take_stations(*id).is_some()));
    }

    #[test]
    fn results_that_no_caller_fetches_are_bounded() {
        let mut results = HashMap::new();
        for number in 0..10_000 {
            bound(&mut results);
            results.insert(number, ());
            assert!(results.len() <= MAX_RESULTS);
        }
        assert!(results.contains_key(&9999));
    }
}
