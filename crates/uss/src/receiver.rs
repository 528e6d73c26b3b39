//! Finds telegrams in what a line brings.

use core::time::Duration;

use super::layout::Layout;
use super::telegram::{MAX_TELEGRAM, STX, Telegram, bcc, total};
use super::timing::Timing;

/// Whether a station receives its own telegrams.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Echo {
    /// Never: what is received was sent by another.
    No,
    /// Always: the first telegram equal to the one sent is its echo.
    Yes,
    /// Not known: found out on the way.
    #[default]
    Detect,
}

/// Statistics of a receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReceiverStatistics {
    /// Whole telegrams.
    pub telegrams: u64,
    /// Octets where no telegram was.
    pub noise: u64,
    /// Telegrams that broke off.
    pub broken: u64,
    /// Telegrams with an impossible length.
    pub lengths: u64,
    /// Telegrams with a wrong check octet.
    pub checksums: u64,
    /// Telegrams with something close behind their check octet that was not a telegram.
    pub trailing: u64,
}

/// Takes octets with the time they came and gives whole, undamaged telegrams.
///
/// * A telegram begins with STX after silence, or right behind another telegram (a port that hands octets over in lumps
///   hides silence).
/// * It counts when the start delay has passed behind its check octet, or STX follows: a damaged length octet that
///   shortens a telegram is detected by the octets that follow.
/// * It is dropped when an octet is late, the length cannot be, or the check octet is wrong. From then on everything
///   up to the next silence is noise, also what looks like a telegram: it may be the inside of one.
///
/// ```
/// use core::time::Duration;
/// use profidrive_uss::{Layout, Receiver, Timing};
/// let timing = Timing::fc(9600);
/// let mut receiver = Receiver::new(timing, Layout::FC);
/// let mut now = Duration::from_secs(1);
/// for octet in [0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD] {
///     now += timing.character;
///     receiver.handle_octet(now, octet);
/// }
/// assert!(receiver.take().is_none());
/// now = receiver.poll_timeout().unwrap();
/// receiver.handle_timeout(now);
/// assert_eq!(receiver.take().unwrap().data, [0x04, 0x7C, 0x20, 0x00]);
/// ```
#[derive(Debug, Clone)]
pub struct Receiver {
    timing: Timing,
    layout: Layout,
    buffer: [u8; MAX_TELEGRAM],
    length: usize,
    state: State,
    /// When the last octet came.
    last: Option<Duration>,
    ready: [u8; MAX_TELEGRAM],
    ready_length: usize,
    statistics: ReceiverStatistics,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// The next octet has to be STX.
    Start,
    /// Waits for silence.
    Lost,
    /// Inside of a telegram of so many octets, if LGE is there.
    Inside(Option<usize>),
    /// A whole telegram; accepted or rejected by what follows.
    Complete,
}

impl Receiver {
    /// Creates a receiver of a silent line. Telegrams whose data the layout cannot divide are noise.
    #[must_use]
    pub const fn new(timing: Timing, layout: Layout) -> Self {
        Self {
            timing,
            layout,
            buffer: [0; MAX_TELEGRAM],
            length: 0,
            state: State::Start,
            last: None,
            ready: [0; MAX_TELEGRAM],
            ready_length: 0,
            statistics: ReceiverStatistics {
                telegrams: 0,
                noise: 0,
                broken: 0,
                lengths: 0,
                checksums: 0,
                trailing: 0,
            },
        }
    }

    /// Takes one octet. [`Receiver::take`] after each: a telegram that is not taken is replaced by the next.
    pub fn handle_octet(&mut self, now: Duration, octet: u8) {
        let pause = self.last.map(|last| now.saturating_sub(last));
        self.last = Some(now);
        let silence = pause.is_none_or(|pause| pause >= self.timing.start_delay);
        match self.state {
            State::Complete if silence || octet == STX => self.deliver(),
            State::Complete => {
                self.statistics.trailing += 1;
                self.state = State::Lost;
            }
            State::Inside(_) if pause.is_some_and(|pause| pause > self.timing.gap) => {
                self.statistics.broken += 1;
                self.state = State::Start;
            }
            State::Lost if silence => self.state = State::Start,
            _ => {}
        }
        match self.state {
            State::Start if octet == STX => {
                self.length = 0;
                self.keep(octet);
                self.state = State::Inside(None);
            }
            State::Start | State::Lost | State::Complete => {
                self.statistics.noise += 1;
                self.state = State::Lost;
            }
            State::Inside(None) => {
                self.keep(octet);
                let total = total(octet).filter(|total| self.layout.accepts(total - 4));
                self.state = match total {
                    Some(total) => State::Inside(Some(total)),
                    None => {
                        self.statistics.lengths += 1;
                        State::Lost
                    }
                };
            }
            State::Inside(Some(total)) => {
                self.keep(octet);
                if self.length >= total {
                    // the check octet makes the sum of all zero
                    self.state = if bcc(self.buffer.get(..self.length).unwrap_or_default()) == 0 {
                        State::Complete
                    } else {
                        self.statistics.checksums += 1;
                        State::Lost
                    };
                }
            }
        }
    }

    /// Time passed without an octet.
    pub fn handle_timeout(&mut self, now: Duration) {
        if self.poll_timeout().is_none_or(|due| now < due) {
            return;
        }
        if self.state == State::Complete {
            self.deliver();
        } else {
            self.statistics.broken += 1;
            self.state = State::Start;
        }
    }

    /// Returns the time when [`Receiver::handle_timeout`] is due, if ever.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        let last = self.last?;
        match self.state {
            State::Complete => Some(last + self.timing.start_delay),
            State::Inside(_) => Some(last + self.timing.gap),
            State::Start | State::Lost => None,
        }
    }

    /// Returns the telegram that became whole.
    pub fn take(&mut self) -> Option<Telegram<'_>> {
        let length = core::mem::take(&mut self.ready_length);
        Telegram::decode(self.ready.get(..length)?).ok()
    }

    /// From when on the line has been silent for the start delay, as far as octets came.
    #[must_use]
    pub fn silent_from(&self) -> Option<Duration> {
        self.last.map(|last| last + self.timing.start_delay)
    }

    /// Returns its counters.
    #[must_use]
    pub const fn statistics(&self) -> &ReceiverStatistics {
        &self.statistics
    }

    fn keep(&mut self, octet: u8) {
        if let Some(place) = self.buffer.get_mut(self.length) {
            *place = octet;
            self.length += 1;
        }
    }

    fn deliver(&mut self) {
        self.ready = self.buffer;
        self.ready_length = self.length;
        self.statistics.telegrams += 1;
        self.state = State::Start;
    }
}
