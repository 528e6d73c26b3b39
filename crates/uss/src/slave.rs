//! The slave: answers what is for it, and nothing else.

use core::time::Duration;

use super::address::{Address, Addressee, Protocol};
use super::layout::Layout;
use super::receiver::{Echo, Receiver, ReceiverStatistics};
use super::telegram::{EncodeError, MAX_DATA, MAX_TELEGRAM, Telegram};
use super::timing::Timing;

/// Configuration of a slave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlaveConfig {
    /// How addresses are read.
    pub protocol: Protocol,
    /// Its number: 0 to 31 of USS, 1 to 126 of the FC protocol.
    pub number: u8,
    /// Times of the line.
    pub timing: Timing,
    /// What the telegrams look like.
    pub layout: Layout,
    /// Whether it receives its own telegrams.
    pub echo: Echo,
}

impl SlaveConfig {
    /// Creates a slave of the Danfoss FC protocol.
    #[must_use]
    pub const fn fc(number: u8, baud: u32) -> Self {
        Self {
            protocol: Protocol::Fc,
            number,
            timing: Timing::fc(baud),
            layout: Layout::FC,
            echo: Echo::Detect,
        }
    }

    /// Creates a slave of USS with the usual telegram.
    #[must_use]
    pub const fn uss(number: u8, baud: u32) -> Self {
        Self {
            protocol: Protocol::Uss,
            number,
            timing: Timing::uss(baud),
            layout: Layout::USS,
            echo: Echo::Detect,
        }
    }
}

/// What a slave has done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SlaveCounters {
    /// Telegrams for this slave, mirror telegrams included.
    pub requests: u64,
    /// Telegrams for all.
    pub broadcasts: u64,
    /// Telegrams for others, and special ones.
    pub foreign: u64,
    /// Echoes of its own telegrams.
    pub echoes: u64,
    /// Replies sent.
    pub replies: u64,
    /// Replies not sent: too late, or the line was busy again.
    pub dropped: u64,
}

/// A request of the master.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request<'a> {
    /// Parameter and process part; [`Layout::split`] divides them, it always can.
    pub data: &'a [u8],
    /// True for a telegram to all: it is executed and not answered.
    pub broadcast: bool,
}

/// A slave at the line: feed octets, take the request, respond, drain.
///
/// A reply goes out after the start delay and before the response delay is over, or not at all. The address octet goes
/// back as it came. A USS mirror telegram is sent back without a call of the application.
///
/// ```
/// use core::time::Duration;
/// use profidrive_uss::{Slave, SlaveConfig};
/// let mut slave = Slave::new(SlaveConfig::fc(1, 9600));
/// let now = Duration::from_secs(1);
/// slave.handle_octets(now, &[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD]);
/// let now = slave.poll_timeout().unwrap();
/// slave.handle_timeout(now);
/// assert_eq!(slave.poll_request().unwrap().data, [0x04, 0x7C, 0x20, 0x00]);
/// slave.respond(&[0x06, 0x03, 0x00, 0x00]).unwrap();
/// let mut out = [0; profidrive_uss::MAX_TELEGRAM];
/// let length = slave.poll_transmit(now, &mut out).unwrap();
/// assert_eq!(out[..length], [0x02, 0x06, 0x81, 0x06, 0x03, 0x00, 0x00, 0x80]);
/// ```
#[derive(Debug, Clone)]
pub struct Slave {
    config: SlaveConfig,
    receiver: Receiver,
    data: [u8; MAX_DATA],
    length: usize,
    /// A request that the application has not fetched yet; true for a broadcast.
    request: Option<bool>,
    /// Address octet and end of the request that may be answered.
    open: Option<(Address, Duration)>,
    out: [u8; MAX_TELEGRAM],
    out_length: usize,
    /// Time until which an echo of the last reply is possible.
    echo_until: Option<Duration>,
    counters: SlaveCounters,
}

impl Slave {
    /// Creates a slave that has received nothing yet.
    #[must_use]
    pub const fn new(config: SlaveConfig) -> Self {
        Self {
            receiver: Receiver::new(config.timing, config.layout),
            config,
            data: [0; MAX_DATA],
            length: 0,
            request: None,
            open: None,
            out: [0; MAX_TELEGRAM],
            out_length: 0,
            echo_until: None,
            counters: SlaveCounters {
                requests: 0,
                broadcasts: 0,
                foreign: 0,
                echoes: 0,
                replies: 0,
                dropped: 0,
            },
        }
    }

    /// Returns its configuration.
    #[must_use]
    pub const fn config(&self) -> &SlaveConfig {
        &self.config
    }

    /// Takes octets from the line. An unanswered request is dropped when the master sends again.
    pub fn handle_octets(&mut self, now: Duration, octets: &[u8]) {
        for &octet in octets {
            let before = self.receiver.silent_from();
            self.receiver.handle_octet(now, octet);
            if self.open.take().is_some() {
                self.counters.dropped += 1;
            }
            // the octet in hand began a telegram behind this one
            self.accept(now, before);
            if self.open.take().is_some() {
                self.counters.dropped += 1;
            }
        }
    }

    /// Time passed.
    pub fn handle_timeout(&mut self, now: Duration) {
        self.receiver.handle_timeout(now);
        let end = self.receiver.silent_from();
        self.accept(now, end);
        if self.late(now) {
            self.open = None;
            self.counters.dropped += 1;
        }
    }

    /// Returns the request that came, once.
    pub fn poll_request(&mut self) -> Option<Request<'_>> {
        let broadcast = self.request.take()?;
        Some(Request {
            data: self.data.get(..self.length)?,
            broadcast,
        })
    }

    /// The reply to the request just taken. Not sent for a broadcast, or when the master does not wait any more.
    ///
    /// # Errors
    /// When the data do not fit the layout.
    pub fn respond(&mut self, data: &[u8]) -> Result<(), EncodeError> {
        if !self.config.layout.accepts(data.len()) {
            return Err(EncodeError::Layout(data.len()));
        }
        if let Some((address, _)) = self.open {
            self.out_length = Telegram { address, data }.encode(&mut self.out)?;
        }
        Ok(())
    }

    /// Returns the reply, when it is due: its length in `buffer`.
    pub fn poll_transmit(&mut self, now: Duration, buffer: &mut [u8]) -> Option<usize> {
        if self.late(now) {
            self.open = None;
            self.counters.dropped += 1;
        }
        let (_, due) = self.open?;
        if now < due || self.out_length == 0 {
            return None;
        }
        let reply = self.out.get(..self.out_length)?;
        buffer.get_mut(..reply.len())?.copy_from_slice(reply);
        self.open = None;
        self.counters.replies += 1;
        let timing = self.config.timing;
        self.echo_until = Some(now + timing.telegram(reply.len()) + timing.start_delay + timing.gap);
        Some(reply.len())
    }

    /// Returns the time when [`Slave::handle_timeout`] or [`Slave::poll_transmit`] is due, if ever.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        let reply = self.open.map(|(_, due)| match self.out_length {
            0 => due + self.config.timing.response,
            _ => due,
        });
        [reply, self.receiver.poll_timeout()].into_iter().flatten().min()
    }

    /// Returns its counters.
    #[must_use]
    pub const fn counters(&self) -> &SlaveCounters {
        &self.counters
    }

    /// Returns the counters of its receiver.
    #[must_use]
    pub const fn line(&self) -> &ReceiverStatistics {
        self.receiver.statistics()
    }

    /// Returns true when the reply would begin after the response delay; the start delay is part of it.
    fn late(&self, now: Duration) -> bool {
        let timing = self.config.timing;
        self.open
            .is_some_and(|(_, due)| now > due + timing.response.saturating_sub(timing.start_delay))
    }

    /// Takes a telegram of the receiver, if there is one; `due` is when a reply may begin.
    fn accept(&mut self, now: Duration, due: Option<Duration>) {
        let Some(telegram) = self.receiver.take() else {
            return;
        };
        if let Some(until) = self.echo_until.take() {
            let same = Telegram::decode(self.out.get(..self.out_length).unwrap_or_default()) == Ok(telegram);
            let echoed = match self.config.echo {
                Echo::No => false,
                Echo::Yes => true,
                Echo::Detect => now <= until,
            };
            if same && echoed {
                self.counters.echoes += 1;
                return;
            }
        }
        let due = due.unwrap_or(now);
        self.out_length = 0;
        match telegram.address.addressee(self.config.protocol) {
            Addressee::Slave(number) if number == self.config.number => {
                self.counters.requests += 1;
                self.open = Some((telegram.address, due));
                self.request = Some(false);
            }
            Addressee::Mirror(number) if number == self.config.number => {
                self.counters.requests += 1;
                self.open = Some((telegram.address, due));
                self.out_length = telegram.encode(&mut self.out).unwrap_or(0);
                return;
            }
            Addressee::Broadcast => {
                self.counters.broadcasts += 1;
                self.request = Some(true);
            }
            _ => {
                self.counters.foreign += 1;
                return;
            }
        }
        self.length = telegram.data.len();
        for (place, octet) in self.data.iter_mut().zip(telegram.data) {
            *place = *octet;
        }
    }
}
