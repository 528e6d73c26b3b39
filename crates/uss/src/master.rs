//! The master: polls its slaves in turn, one telegram at a time.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::time::Duration;

use super::address::{Address, Addressee, Protocol};
use super::layout::Layout;
use super::receiver::{Echo, Receiver, ReceiverStatistics};
use super::telegram::{EncodeError, MAX_DATA, MAX_TELEGRAM, Telegram};
use super::timing::Timing;

/// Configuration of a master.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MasterConfig {
    /// How addresses are read.
    pub protocol: Protocol,
    /// Times of the line.
    pub timing: Timing,
    /// What the telegrams look like.
    pub layout: Layout,
    /// Whether it receives its own telegrams.
    pub echo: Echo,
    /// How often a telegram is repeated before its slave counts as lost. A lost slave is polled once in each round.
    pub retries: u8,
    /// Time from one round to the next at least.
    pub round: Duration,
}

impl MasterConfig {
    /// For slaves of the Danfoss FC protocol.
    #[must_use]
    pub const fn fc(baud: u32) -> Self {
        Self {
            protocol: Protocol::Fc,
            timing: Timing::fc(baud),
            layout: Layout::FC,
            echo: Echo::Detect,
            retries: 2,
            round: Duration::ZERO,
        }
    }

    /// For slaves of USS with the usual telegram.
    #[must_use]
    pub const fn uss(baud: u32) -> Self {
        Self {
            protocol: Protocol::Uss,
            timing: Timing::uss(baud),
            layout: Layout::USS,
            ..Self::fc(baud)
        }
    }
}

/// A slave of a master, as [`Master::add`] numbered it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SlaveId(usize);

/// What happened at the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A reply came: [`Master::reply`] has it, [`Master::set_data`] sets the next request.
    Reply(SlaveId),
    /// A slave does not answer after all repetitions. Reported again only after it answered.
    Lost(SlaveId),
}

/// How one slave behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SlaveStatistics {
    /// Telegrams sent, repetitions included.
    pub sent: u64,
    /// Replies taken.
    pub replies: u64,
    /// Repetitions among the telegrams sent.
    pub repeated: u64,
    /// Telegrams without a reply in time.
    pub timeouts: u64,
}

#[derive(Debug)]
struct Entry {
    address: Address,
    data: [u8; MAX_DATA],
    length: usize,
    reply: [u8; MAX_DATA],
    reply_length: usize,
    /// Telegrams without a reply since the last reply.
    failures: u32,
    statistics: SlaveStatistics,
}

#[derive(Debug, Clone, Copy)]
enum State {
    /// Nothing under way.
    Idle,
    /// A reply has to begin until then, and to be whole until the second time.
    Waiting {
        slave: usize,
        begin: Duration,
        end: Duration,
        /// The telegram sent was received once: its echo, or a reply like it.
        echoed: bool,
    },
}

/// A master at the line: feed octets, drain events and the telegram, sleep until the deadline.
///
/// Each slave has its data, which are sent in each round until others are set; what it answered last is kept. After an
/// event set the next data before draining the telegram.
///
/// With [`Echo::Detect`] a telegram equal to the one sent is an echo, and from then on all are; but one that can be its own
/// reply, a mirror telegram or data all zero, counts as echo only when another follows, and as the reply else. On a line
/// that echoes what comes before the echo belongs to an earlier try and is not taken.
///
/// ```
/// use core::time::Duration;
/// use profidrive_uss::{Address, Event, Master, MasterConfig};
/// let mut master = Master::new(MasterConfig::fc(9600));
/// let drive = master.add(Address::fc(1).unwrap(), &[0x04, 0x7C, 0x20, 0x00]).unwrap();
/// let mut out = [0; profidrive_uss::MAX_TELEGRAM];
/// let now = Duration::from_secs(1);
/// let length = master.poll_transmit(now, &mut out).unwrap();
/// assert_eq!(out[..length], [0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD]);
///
/// master.handle_octets(now + Duration::from_millis(20), &[0x02, 0x06, 0x81, 0x06, 0x03, 0x00, 0x00, 0x80]);
/// master.handle_timeout(master.poll_timeout().unwrap());
/// assert_eq!(master.poll_event(), Some(Event::Reply(drive)));
/// assert_eq!(master.reply(drive), [0x06, 0x03, 0x00, 0x00]);
/// ```
#[derive(Debug)]
pub struct Master {
    config: MasterConfig,
    receiver: Receiver,
    slaves: Vec<Entry>,
    next: usize,
    state: State,
    events: VecDeque<Event>,
    /// Telegram on the line, to recognise its echo.
    sent: Box<[u8; MAX_TELEGRAM]>,
    sent_length: usize,
    /// Telegram to all that waits for its turn.
    broadcast: Box<[u8; MAX_TELEGRAM]>,
    broadcast_length: usize,
    /// The next telegram may not begin before.
    quiet: Duration,
    /// The next round may not begin before.
    round: Duration,
    echoes: bool,
    /// Telegrams received on an echoing line since the last echo.
    without_echo: u8,
}

/// So many without an echo between them, and the line does not echo after all.
const MOST_WITHOUT_ECHO: u8 = 4;

impl Master {
    /// Creates a master without slaves.
    #[must_use]
    pub fn new(config: MasterConfig) -> Self {
        Self {
            config,
            receiver: Receiver::new(config.timing, config.layout),
            slaves: Vec::new(),
            next: 0,
            state: State::Idle,
            events: VecDeque::new(),
            sent: Box::new([0; MAX_TELEGRAM]),
            sent_length: 0,
            broadcast: Box::new([0; MAX_TELEGRAM]),
            broadcast_length: 0,
            quiet: Duration::ZERO,
            round: Duration::ZERO,
            echoes: config.echo == Echo::Yes,
            without_echo: 0,
        }
    }

    /// Adds a slave with the data to send to it.
    ///
    /// # Errors
    /// When the data do not fit the layout.
    pub fn add(&mut self, address: Address, data: &[u8]) -> Result<SlaveId, EncodeError> {
        let id = SlaveId(self.slaves.len());
        if !self.config.layout.accepts(data.len()) {
            return Err(EncodeError::Layout(data.len()));
        }
        self.slaves.push(Entry {
            address,
            data: [0; MAX_DATA],
            length: 0,
            reply: [0; MAX_DATA],
            reply_length: 0,
            failures: 0,
            statistics: SlaveStatistics::default(),
        });
        // an event of each kind for each slave is the most there can be
        self.events.reserve(2 * self.slaves.len());
        self.set_data(id, data)?;
        Ok(id)
    }

    /// What to send to a slave from its next telegram on.
    ///
    /// # Errors
    /// When the data do not fit the layout; the data from before stay.
    pub fn set_data(&mut self, slave: SlaveId, data: &[u8]) -> Result<(), EncodeError> {
        if !self.config.layout.accepts(data.len()) {
            return Err(EncodeError::Layout(data.len()));
        }
        if let Some(entry) = self.slaves.get_mut(slave.0) {
            entry.length = data.len();
            for (place, octet) in entry.data.iter_mut().zip(data) {
                *place = *octet;
            }
        }
        Ok(())
    }

    /// Sends data to all slaves, once, as soon as the line is free. One that still waits is replaced.
    ///
    /// # Errors
    /// When the data do not fit the layout.
    pub fn broadcast(&mut self, address: Address, data: &[u8]) -> Result<(), EncodeError> {
        if !self.config.layout.accepts(data.len()) {
            return Err(EncodeError::Layout(data.len()));
        }
        self.broadcast_length = Telegram { address, data }.encode(&mut self.broadcast[..])?;
        Ok(())
    }

    /// Returns the last answer of a slave; empty before its first reply.
    #[must_use]
    pub fn reply(&self, slave: SlaveId) -> &[u8] {
        self.slaves
            .get(slave.0)
            .and_then(|entry| entry.reply.get(..entry.reply_length))
            .unwrap_or_default()
    }

    /// Returns the counters of a slave.
    #[must_use]
    pub fn statistics(&self, slave: SlaveId) -> SlaveStatistics {
        self.slaves
            .get(slave.0)
            .map(|entry| entry.statistics)
            .unwrap_or_default()
    }

    /// Returns the counters of the receiver.
    #[must_use]
    pub const fn line(&self) -> &ReceiverStatistics {
        self.receiver.statistics()
    }

    /// Returns true when the master has detected that it receives its own telegrams.
    #[must_use]
    pub const fn hears_itself(&self) -> bool {
        self.echoes
    }

    /// Takes octets from the line.
    pub fn handle_octets(&mut self, now: Duration, octets: &[u8]) {
        for &octet in octets {
            self.receiver.handle_octet(now, octet);
            self.accept();
        }
    }

    /// Time passed.
    pub fn handle_timeout(&mut self, now: Duration) {
        self.receiver.handle_timeout(now);
        self.accept();
        let State::Waiting {
            slave,
            begin,
            end,
            echoed,
        } = self.state
        else {
            return;
        };
        let begun = self.receiver.poll_timeout().is_some();
        if now < begin || (begun && now < end) {
            return;
        }
        if echoed && !self.echoes && self.may_be_reply() {
            self.take_sent(slave);
        } else {
            self.fail(slave);
        }
    }

    /// Returns the events, in order.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Returns the next telegram, when its time has come: its length in `buffer`, which has [`MAX_TELEGRAM`] octets.
    pub fn poll_transmit(&mut self, now: Duration, buffer: &mut [u8]) -> Option<usize> {
        if now < self.due()? {
            return None;
        }
        let timing = self.config.timing;
        if self.broadcast_length > 0 {
            let length = core::mem::take(&mut self.broadcast_length);
            let telegram = self.broadcast.get(..length)?;
            buffer.get_mut(..length)?.copy_from_slice(telegram);
            self.quiet = now + timing.telegram(length) + timing.start_delay;
            return Some(length);
        }
        if self.next >= self.slaves.len() {
            self.next = 0;
        }
        if self.next == 0 {
            self.round = now + self.config.round;
        }
        let slave = self.next;
        let entry = self.slaves.get_mut(slave)?;
        let data = entry.data.get(..entry.length)?;
        let address = entry.address;
        let length = Telegram { address, data }.encode(&mut self.sent[..]).ok()?;
        buffer
            .get_mut(..length)?
            .copy_from_slice(self.sent.get(..length)?);
        entry.statistics.sent += 1;
        if entry.failures > 0 && entry.failures <= u32::from(self.config.retries) {
            entry.statistics.repeated += 1;
        }
        self.sent_length = length;
        let sent = now + timing.telegram(length);
        // a reply begins late at most, is as long as a telegram can be, and the start delay passes behind it
        let begin = sent + timing.response + timing.gap;
        let end = begin + timing.telegram(MAX_TELEGRAM) + timing.gap + timing.start_delay;
        self.state = State::Waiting {
            slave,
            begin,
            end,
            echoed: false,
        };
        Some(length)
    }

    /// Returns the time when [`Master::handle_timeout`] or [`Master::poll_transmit`] is due, if ever.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        let line = self.receiver.poll_timeout();
        let own = match self.state {
            State::Idle => self.due(),
            State::Waiting { end, .. } if line.is_some() => Some(end),
            State::Waiting { begin, .. } => Some(begin),
        };
        [own, line].into_iter().flatten().min()
    }

    /// Returns the time when the next telegram may begin, if there is one.
    fn due(&self) -> Option<Duration> {
        if !matches!(self.state, State::Idle) || self.receiver.poll_timeout().is_some() {
            return None;
        }
        let line = self.receiver.silent_from().unwrap_or(Duration::ZERO);
        let quiet = self.quiet.max(line);
        if self.broadcast_length > 0 {
            return Some(quiet);
        }
        if self.slaves.is_empty() {
            return None;
        }
        let first = self.next == 0 || self.next >= self.slaves.len();
        Some(if first { quiet.max(self.round) } else { quiet })
    }

    /// Takes a telegram of the receiver, if there is one.
    fn accept(&mut self) {
        let Some(telegram) = self.receiver.take() else {
            return;
        };
        let State::Waiting { slave, echoed, .. } = &mut self.state else {
            return;
        };
        let same = Telegram::decode(self.sent.get(..self.sent_length).unwrap_or_default()) == Ok(telegram);
        if same && !*echoed && self.config.echo != Echo::No {
            *echoed = true;
            self.without_echo = 0;
            self.echoes |= !mirrors(telegram, self.config.protocol);
            return;
        }
        let (slave, echoed) = (*slave, *echoed);
        // the echo of the try before, which an adapter handed over late
        if same && echoed && !mirrors(telegram, self.config.protocol) {
            return;
        }
        // on a line that echoes nothing of this try can come before its echo
        if self.echoes && !echoed {
            self.without_echo += 1;
            if self.config.echo == Echo::Yes || self.without_echo < MOST_WITHOUT_ECHO {
                return;
            }
            self.echoes = false;
        }
        let Some(entry) = self.slaves.get_mut(slave) else {
            return;
        };
        if telegram.address != entry.address {
            return;
        }
        self.echoes |= echoed;
        entry.reply_length = telegram.data.len();
        for (place, octet) in entry.reply.iter_mut().zip(telegram.data) {
            *place = *octet;
        }
        self.replied(slave);
    }

    /// Returns true when the telegram sent may come back as it is.
    fn may_be_reply(&self) -> bool {
        let sent = self.sent.get(..self.sent_length).unwrap_or_default();
        Telegram::decode(sent).is_ok_and(|telegram| mirrors(telegram, self.config.protocol))
    }

    fn take_sent(&mut self, slave: usize) {
        if let Some(entry) = self.slaves.get_mut(slave) {
            // the data may have been replaced since: the echo equals the octets sent
            let sent = self.sent.get(..self.sent_length).unwrap_or_default();
            if let Ok(telegram) = Telegram::decode(sent) {
                entry.reply_length = telegram.data.len();
                for (place, octet) in entry.reply.iter_mut().zip(telegram.data) {
                    *place = *octet;
                }
            }
        }
        self.replied(slave);
    }

    fn replied(&mut self, slave: usize) {
        if let Some(entry) = self.slaves.get_mut(slave) {
            entry.failures = 0;
            entry.statistics.replies += 1;
        }
        self.push_event(Event::Reply(SlaveId(slave)));
        self.next = slave + 1;
        self.state = State::Idle;
    }

    fn fail(&mut self, slave: usize) {
        self.state = State::Idle;
        let retries = u32::from(self.config.retries);
        let Some(entry) = self.slaves.get_mut(slave) else {
            return;
        };
        entry.statistics.timeouts += 1;
        entry.failures = entry.failures.saturating_add(1);
        let failures = entry.failures;
        if failures > retries {
            self.next = slave + 1;
        }
        if failures == retries + 1 {
            self.push_event(Event::Lost(SlaveId(slave)));
        }
    }

    /// Queues an event unless an equal one waits already.
    fn push_event(&mut self, event: Event) {
        if !self.events.contains(&event) {
            self.events.push_back(event);
        }
    }
}

/// Returns true for a telegram that may look like its reply: a mirror telegram, or data all zero.
fn mirrors(telegram: Telegram<'_>, protocol: Protocol) -> bool {
    matches!(telegram.address.addressee(protocol), Addressee::Mirror(_))
        || telegram.data.iter().all(|&octet| octet == 0)
}
