//! The master of a serial line and the requests for each of its drives.

mod bridge;

use std::time::Duration;

use profile::parameter::DecodeError;
use profile::pkw::{Client as Channel, ClientTiming, JobError, PkwDialect};
use profinet::Instant;
use uss::{
    Address, Event, Layout, MAX_DATA, Master, MasterConfig, Parts, PkwPart, Protocol, ReceiverStatistics,
    SlaveId,
};

pub use bridge::{Answered, Bridge, Shape};

/// Octets of the process data: control word and setpoint, status word and actual value.
pub const PROCESS: usize = 4;
/// Time between two octets of a telegram that is still one: adapters hand them over in lumps.
const GAP: Duration = Duration::from_millis(30);
/// How often a telegram is repeated. Five tries end before the second after which a drive counts its master as lost.
const RETRIES: u8 = 4;
/// Most drives at a line.
const MOST_SLAVES: usize = 126;

/// What a line is like.
///
/// ```
/// use profidrive_client::LineConfig;
/// let line = LineConfig::new(uss::Protocol::Fc, 9600);
/// assert_eq!(line.exchange().as_millis(), 41); // a whole telegram there and one back
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineConfig {
    /// How telegrams are addressed and laid out.
    pub protocol: Protocol,
    /// Bits per second.
    pub baud: u32,
    /// Octets of one telegram may come so far apart.
    pub gap: Duration,
}

impl LineConfig {
    /// Creates a line behind an ordinary adapter.
    #[must_use]
    pub const fn new(protocol: Protocol, baud: u32) -> Self {
        Self {
            protocol,
            baud,
            gap: GAP,
        }
    }

    fn master(self) -> MasterConfig {
        let config = match self.protocol {
            Protocol::Fc => MasterConfig::fc(self.baud),
            Protocol::Uss => MasterConfig::uss(self.baud),
        };
        MasterConfig {
            retries: RETRIES,
            timing: config.timing.with_gap(self.gap),
            ..config
        }
    }

    /// Returns the dialect of the parameter channel for this vendor; for an unknown vendor, or one without a dialect,
    /// that of the protocol.
    pub(crate) fn dialect(self, vendor: Option<u16>) -> PkwDialect {
        PkwDialect::of_line(vendor, self.layout().pkw == PkwPart::Variable)
    }

    fn layout(self) -> Layout {
        self.master().layout
    }

    /// Returns the time of a telegram with parameter and process part and of its reply, when no slave delays.
    #[must_use]
    pub fn exchange(self) -> Duration {
        const OCTETS: usize = 16;
        let timing = self.master().timing;
        (timing.telegram(OCTETS) + timing.start_delay) * 2
    }

    fn address(self, number: u8) -> Option<Address> {
        match self.protocol {
            Protocol::Fc => Address::fc(number),
            Protocol::Uss => Address::uss(number),
        }
    }
}

/// One drive at the line.
#[derive(Debug)]
struct Slave {
    number: u8,
    id: SlaveId,
    channel: Channel,
    job: Option<Bridge>,
    done: Option<Result<Answered, JobError>>,
    /// A caller waits for its answer.
    asked: bool,
    /// `None` until that is known.
    answers: Option<bool>,
    /// Process data is wanted, not only parameters.
    cyclic: bool,
    /// Process data sent to it: without control until a client takes control.
    outputs: [u8; PROCESS],
    /// What came last, until it is taken.
    inputs: Option<[u8; PROCESS]>,
    /// What came last: status word and actual value, which are in every reply.
    latest: Option<[u8; PROCESS]>,
}

/// The master of a line: polls only drives with pending requests, and is otherwise silent.
#[derive(Debug)]
pub struct Line {
    config: LineConfig,
    layout: Layout,
    master: Master,
    slaves: Vec<Slave>,
}

impl Line {
    pub fn new(config: LineConfig) -> Self {
        let master = config.master();
        Self {
            config,
            layout: master.layout,
            master: Master::new(master),
            slaves: Vec::new(),
        }
    }

    pub const fn config(&self) -> LineConfig {
        self.config
    }

    /// Returns the counters of the line.
    pub const fn counters(&self) -> &ReceiverStatistics {
        self.master.line()
    }

    /// Returns the drive with this number; `None` for a number that no drive can have.
    pub fn slave(&mut self, number: u8) -> Option<SlaveId> {
        if let Some(slave) = self.slaves.iter().find(|slave| slave.number == number) {
            return Some(slave.id);
        }
        if self.slaves.len() >= MOST_SLAVES {
            return None;
        }
        let mut data = [0; MAX_DATA];
        let length = compose(self.layout, &[], &[0; PROCESS], &mut data)?;
        let address = self.config.address(number)?;
        let id = self.master.add(address, data.get(..length)?).ok()?;
        self.slaves.push(Slave {
            number,
            id,
            channel: Channel::new(self.config.dialect(None), ClientTiming::SERIAL),
            job: None,
            done: None,
            asked: false,
            answers: None,
            cyclic: false,
            outputs: [0; PROCESS],
            inputs: None,
            latest: None,
        });
        Some(id)
    }

    fn get(&self, id: SlaveId) -> Option<&Slave> {
        self.slaves.iter().find(|slave| slave.id == id)
    }

    fn get_mut(&mut self, id: SlaveId) -> Option<&mut Slave> {
        self.slaves.iter_mut().find(|slave| slave.id == id)
    }

    /// Polls the drive once.
    pub fn ask(&mut self, id: SlaveId) {
        if let Some(slave) = self.get_mut(id) {
            slave.asked = true;
            slave.answers = None;
        }
    }

    /// Returns whether the drive answers, once that is known.
    pub fn answers(&self, id: SlaveId) -> Option<bool> {
        self.get(id)?.answers
    }

    /// Sets the dialect of the parameter channel of a drive. Not while a job is under way.
    pub fn set_dialect(&mut self, id: SlaveId, dialect: PkwDialect) {
        if let Some(slave) = self.get_mut(id)
            && slave.job.is_none()
            && *slave.channel.dialect() != dialect
        {
            slave.channel = Channel::new(dialect, ClientTiming::SERIAL);
        }
    }

    /// Returns the assumed dialect of a drive.
    pub fn dialect_of(&self, id: SlaveId) -> Option<&PkwDialect> {
        self.get(id).map(|slave| slave.channel.dialect())
    }

    /// Begins a parameter job.
    ///
    /// # Errors
    /// When the request makes no sense.
    pub fn start(
        &mut self,
        now: Instant,
        id: SlaveId,
        job: Result<Bridge, DecodeError>,
    ) -> Result<(), DecodeError> {
        let job = job?;
        if let Some(slave) = self.get_mut(id) {
            slave.job = Some(job);
            slave.done = None;
            slave.advance(time(now));
        }
        Ok(())
    }

    /// Returns the number of exchanges of its job that a drive has answered; `None` without a job.
    pub fn progress(&self, id: SlaveId) -> Option<usize> {
        self.get(id)?.job.as_ref().map(Bridge::progress)
    }

    /// Returns the end of a parameter job.
    pub fn take(&mut self, id: SlaveId) -> Option<Result<Answered, JobError>> {
        self.get_mut(id)?.done.take()
    }

    /// Drops a job whose result no caller waits for.
    pub fn drop_job(&mut self, id: SlaveId) {
        if let Some(slave) = self.get_mut(id) {
            slave.job = None;
            slave.done = None;
            let _ = slave.channel.lost();
        }
    }

    /// Exchanges process data with the drive from now on, or no longer.
    pub fn set_cyclic(&mut self, id: SlaveId, cyclic: bool) {
        if let Some(slave) = self.get_mut(id) {
            slave.cyclic = cyclic;
            slave.outputs = [0; PROCESS];
            slave.inputs = None;
            slave.answers = None;
        }
    }

    /// Returns true while process data is exchanged.
    pub fn is_cyclic(&self, id: SlaveId) -> bool {
        self.get(id).is_some_and(|slave| slave.cyclic)
    }

    /// Process data to send from now on.
    pub fn set_outputs(&mut self, id: SlaveId, outputs: [u8; PROCESS]) {
        if let Some(slave) = self.get_mut(id).filter(|slave| slave.cyclic) {
            slave.outputs = outputs;
        }
    }

    /// Replies that came so far.
    pub fn replies(&self, id: SlaveId) -> u64 {
        self.master.statistics(id).replies
    }

    /// Process data that came since it was last taken.
    pub fn take_inputs(&mut self, id: SlaveId) -> Option<[u8; PROCESS]> {
        self.get_mut(id)?.inputs.take()
    }

    /// Status word and actual value of the last reply.
    pub fn latest(&self, id: SlaveId) -> Option<[u16; 2]> {
        let [high, low, rest @ ..] = self.get(id)?.latest?;
        Some([u16::from_be_bytes([high, low]), u16::from_be_bytes(rest)])
    }

    pub fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        self.master.handle_octets(time(now), octets);
        self.work(time(now));
    }

    pub fn handle_timeout(&mut self, now: Instant) {
        self.master.handle_timeout(time(now));
        self.work(time(now));
    }

    fn work(&mut self, now: Duration) {
        while let Some(event) = self.master.poll_event() {
            let (Event::Reply(id) | Event::Lost(id)) = event;
            let Some(slave) = self.slaves.iter_mut().find(|slave| slave.id == id) else {
                continue;
            };
            slave.asked = false;
            slave.answers = Some(matches!(event, Event::Reply(_)));
            let outcome = match event {
                Event::Lost(_) => slave.channel.lost(),
                Event::Reply(_) => {
                    let Some(parts) = self.layout.split(self.master.reply(id)) else {
                        continue;
                    };
                    slave.inputs = parts.pzd.try_into().ok();
                    slave.latest = slave.inputs;
                    match parts.pkw {
                        [] => None,
                        pkw => slave.channel.handle(now, pkw),
                    }
                }
            };
            slave.end(now, outcome);
        }
        for slave in &mut self.slaves {
            let outcome = slave.channel.handle_timeout(now);
            slave.end(now, outcome);
        }
    }

    /// Returns the next telegram, if there is one to send.
    pub fn poll_octets(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        if !self.is_wanted() {
            return None;
        }
        let now = time(now);
        for slave in &mut self.slaves {
            let with_parameters = slave.channel.is_busy() || !self.layout.process_only;
            let pkw = if with_parameters {
                slave.channel.request(now)
            } else {
                &[]
            };
            let mut data = [0; MAX_DATA];
            if let Some(length) = compose(self.layout, pkw, &slave.outputs, &mut data) {
                // the layout is the master's own
                let _ = self
                    .master
                    .set_data(slave.id, data.get(..length).unwrap_or_default());
            }
        }
        self.master.poll_transmit(now, buffer)
    }

    /// Returns the time when something is due.
    pub fn poll_timeout(&self) -> Option<Instant> {
        if !self.is_wanted() {
            return None;
        }
        let channels = self
            .slaves
            .iter()
            .filter_map(|slave| slave.channel.poll_timeout());
        let due = channels.chain(self.master.poll_timeout()).min()?;
        Some(Instant::ZERO + due)
    }

    fn is_wanted(&self) -> bool {
        let wanted = |slave: &Slave| slave.job.is_some() || slave.cyclic || slave.asked;
        self.slaves.iter().any(wanted)
    }
}

impl Slave {
    /// Takes how an exchange ended, and begins the next one.
    fn end(&mut self, now: Duration, outcome: Option<profile::pkw::Outcome>) {
        let (Some(outcome), Some(job)) = (outcome, &mut self.job) else {
            return;
        };
        match job.take(outcome, self.channel.text()) {
            Ok(()) => self.advance(now),
            Err(error) => {
                self.job = None;
                self.done = Some(Err(error));
            }
        }
    }

    fn advance(&mut self, now: Duration) {
        let Some(bridge) = &mut self.job else { return };
        while let Some(job) = bridge.job() {
            match self.channel.start(now, job) {
                Ok(()) => return,
                Err(error) => bridge.cannot(error),
            }
        }
        self.done = Some(Ok(bridge.answered()));
        self.job = None;
    }
}

/// Returns the data of a telegram.
fn compose(layout: Layout, pkw: &[u8], pzd: &[u8], data: &mut [u8]) -> Option<usize> {
    const REST: [u8; 8] = [0; 8];
    let pkw = if pkw.is_empty() && !layout.process_only {
        &REST
    } else {
        pkw
    };
    layout.join(Parts { pkw, pzd }, data).ok()
}

fn time(now: Instant) -> Duration {
    now - Instant::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_one_place_for_each_drive_that_it_can_have() {
        let mut line = Line::new(LineConfig::new(Protocol::Fc, 9600));
        for _ in 0..2 {
            let slaves: Vec<u8> = (0..=255).filter(|number| line.slave(*number).is_some()).collect();
            assert_eq!(slaves, (1..=126).collect::<Vec<_>>());
            assert_eq!(line.slaves.len(), MOST_SLAVES);
        }
    }
}
