//! The master side: one request at a time, and no reply taken for another's.

use core::time::Duration;

use super::code::{Action, ReplyCode, Width};
use super::dialect::{IndLayout, PkwDialect};
use super::error::PkwErrorNumber;
use super::job::{Answer, Job, JobError, PkwValue, StartError};
use super::words::{MAX_BLOCK, PKW_LEN, Pkw, PkwAddress, TEXT_AT};

/// How long a client waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClientTiming {
    /// For the zero telegram, and then again for the reply.
    pub reply: Duration,
    /// Longest time a telegram needs to the drive and its reply back, everything that delays included. After a time-out
    /// or a loss the channel rests for that long, so that nothing of the old request can still be under way.
    pub round_trip: Duration,
}

impl ClientTiming {
    /// For PPO words in cyclic data.
    pub const CYCLIC: Self = Self {
        reply: Duration::from_secs(2),
        round_trip: Duration::from_millis(250),
    };
    /// For a serial line.
    pub const SERIAL: Self = Self {
        reply: Duration::from_secs(3),
        round_trip: Duration::from_millis(500),
    };
}

/// How a job ended.
pub type Outcome = Result<Answer, JobError>;

/// A message that no request requested (AK 9 to 12).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spontaneous {
    /// Parameter number.
    pub pnu: u16,
    /// Element of an array.
    pub subindex: u8,
    /// Its value.
    pub value: PkwValue,
}

/// The parameter channel of a master. Time is counted from an origin the caller chose.
///
/// In every cycle send what [`Client::request`] gives and hand what came to [`Client::handle`]; the outcome of a job is
/// reported once, by [`Client::handle`] or, when it ran out of time, by [`Client::handle_timeout`].
///
/// * A request stands until a reply with its parameter number, its IND and one of the AKs of its row comes.
/// * A reply does not show to which of two equal requests it belongs. So before a request for the parameter, element
///   and text code of the one before, or where a refusal does not name the parameter, the client sends AK 0 and waits
///   for the zero telegram.
/// * At the start, after a time-out and after a loss it does so too, after a time-out and a loss for
///   [`ClientTiming::round_trip`] at least.
/// * At rest it sends AK 0. Spontaneous messages are kept aside.
///
/// That no reply is ever taken for another's holds when the carrier keeps the order of telegrams and none is older than
/// `round_trip`; loss, repetition and a slave that starts again do no harm.
/// Source: Parker Compax3 p. 358, Kollmorgen S300 PROFIBUS p. 46.
///
/// ```
/// use core::time::Duration;
/// use profidrive_profile::pkw::{Answer, Client, ClientTiming, Job, PkwDialect, PkwValue};
///
/// let mut client = Client::new(PkwDialect::STANDARD, ClientTiming::CYCLIC);
/// let now = Duration::ZERO;
/// client.start(now, Job::Read { pnu: 930, element: None }).unwrap();
/// assert_eq!(client.request(now), [0; 8]); // first the channel comes to rest
/// assert_eq!(client.handle(now, &[0; 8]), None);
/// assert_eq!(client.request(now), [0x13, 0xA2, 0, 0, 0, 0, 0, 0]);
/// let outcome = client.handle(now, &[0x13, 0xA2, 0, 0, 0, 0, 0, 2]);
/// assert_eq!(outcome, Some(Ok(Answer::Value(PkwValue::Word(2)))));
/// ```
#[derive(Debug, Clone)]
pub struct Client {
    dialect: PkwDialect,
    timing: ClientTiming,
    /// The job's block, kept while it waits for the channel to rest.
    block: [u8; MAX_BLOCK],
    length: usize,
    text: [u8; MAX_BLOCK],
    text_length: usize,
    job: Option<Stage>,
    rest: Rest,
    spontaneous: Option<Spontaneous>,
}

/// Where the job is.
#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Waits for the zero telegram.
    Resting { until: Duration },
    /// Stands in the channel.
    Asking { until: Duration },
}

/// What may still come out of the channel.
#[derive(Debug, Clone, Copy)]
enum Rest {
    /// Nothing but zero telegrams.
    Zero,
    /// The reply to this address, which was taken already.
    Answered(PkwAddress),
    /// Anything, until a zero telegram comes after this time. `None`: counted from the next AK 0 sent.
    Anything { after: Option<Duration> },
}

impl Client {
    /// Creates a channel of which nothing is known yet.
    #[must_use]
    pub const fn new(dialect: PkwDialect, timing: ClientTiming) -> Self {
        Self {
            dialect,
            timing,
            block: [0; MAX_BLOCK],
            length: PKW_LEN,
            text: [0; MAX_BLOCK],
            text_length: 0,
            job: None,
            rest: Rest::Anything {
                after: Some(Duration::ZERO),
            },
            spontaneous: None,
        }
    }

    /// Returns the dialect that it uses.
    #[must_use]
    pub const fn dialect(&self) -> &PkwDialect {
        &self.dialect
    }

    /// Returns true while a job is under way.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// Starts a job; its outcome is reported within twice [`ClientTiming::reply`] and [`ClientTiming::round_trip`].
    ///
    /// # Errors
    /// When another job is under way or the dialect has no such request; nothing has changed then.
    pub fn start(&mut self, now: Duration, job: Job<'_>) -> Result<(), StartError> {
        if self.is_busy() {
            return Err(StartError::Busy);
        }
        let order = job.order(&self.dialect)?;
        let number = StartError::Number {
            pnu: order.address.pnu,
            dialect: self.dialect.name,
        };
        let pkw = Pkw::new(&self.dialect, order.code.0, order.address, order.pwe).ok_or(number)?;
        let head = pkw.to_octets();
        // a text block to write is PKE, IND and the characters, everything else eight octets
        let characters = (order.address.text == super::words::TEXT_WRITE).then_some(order.text);
        let tail = head.get(TEXT_AT..).unwrap_or_default();
        let octets = head.iter().take(TEXT_AT).chain(characters.unwrap_or(tail));
        self.length = 0;
        for (place, octet) in self.block.iter_mut().zip(octets) {
            *place = *octet;
            self.length += 1;
        }
        let direct = match self.rest {
            Rest::Zero => true,
            Rest::Answered(before) => self.dialect.refusal_names_pnu && before != order.address,
            Rest::Anything { .. } => false,
        };
        self.text_length = 0;
        self.job = Some(if direct {
            self.asking(now)
        } else {
            self.resting(now)
        });
        Ok(())
    }

    /// Returns the octets to send now: eight, or another number in a text block.
    pub fn request(&mut self, now: Duration) -> &[u8] {
        if let Rest::Anything {
            after: after @ None, ..
        } = &mut self.rest
        {
            *after = Some(now + self.timing.round_trip);
        }
        match self.job {
            Some(Stage::Asking { .. }) => self.block.get(..self.length).unwrap_or_default(),
            _ => &[0; PKW_LEN],
        }
    }

    /// Takes what the slave sent; a text block may be longer than eight octets.
    pub fn handle(&mut self, now: Duration, reply: &[u8]) -> Option<Outcome> {
        let (pkw, text) = parse(reply)?;
        let code = pkw.reply_code();
        if code.info().spontaneous {
            self.keep(pkw, code);
            return self.handle_timeout(now);
        }
        if code == ReplyCode::NONE {
            self.rested(now);
            return self.handle_timeout(now);
        }
        if matches!(self.job, Some(Stage::Asking { .. }))
            && let Some(outcome) = self.judge(pkw)
        {
            if outcome == Ok(Answer::Text) {
                for (place, octet) in self.text.iter_mut().zip(text) {
                    *place = *octet;
                }
                self.text_length = text.len().min(self.text.len());
            }
            self.job = None;
            // a request whose address cannot be encoded was never sent
            self.rest = self
                .standing()
                .address(&self.dialect)
                .map_or(Rest::Anything { after: None }, Rest::Answered);
            return Some(outcome);
        }
        self.handle_timeout(now)
    }

    /// Ends a job whose time is over.
    pub fn handle_timeout(&mut self, now: Duration) -> Option<Outcome> {
        let error = match self.job? {
            Stage::Resting { until } if now >= until => JobError::NotAtRest,
            Stage::Asking { until } if now >= until => JobError::NoReply,
            _ => return None,
        };
        if error == JobError::NoReply {
            self.rest = Rest::Anything { after: None };
        }
        self.job = None;
        Some(Err(error))
    }

    /// Returns the time when [`Client::handle_timeout`] is due, if ever.
    #[must_use]
    pub const fn poll_timeout(&self) -> Option<Duration> {
        match self.job {
            Some(Stage::Resting { until } | Stage::Asking { until }) => Some(until),
            None => None,
        }
    }

    /// Handles the loss of the slave: ends the job under way and ignores later replies.
    pub fn lost(&mut self) -> Option<Outcome> {
        self.rest = Rest::Anything { after: None };
        self.job.take().map(|_| Err(JobError::Lost))
    }

    /// Returns the text of the last answer [`Answer::Text`].
    #[must_use]
    pub fn text(&self) -> &[u8] {
        self.text.get(..self.text_length).unwrap_or_default()
    }

    /// Returns the last spontaneous message since the last call.
    pub fn take_spontaneous(&mut self) -> Option<Spontaneous> {
        self.spontaneous.take()
    }

    fn asking(&self, now: Duration) -> Stage {
        Stage::Asking {
            until: now + self.timing.reply,
        }
    }

    fn resting(&self, now: Duration) -> Stage {
        Stage::Resting {
            until: now + self.timing.reply + self.timing.round_trip,
        }
    }

    /// A zero telegram came.
    fn rested(&mut self, now: Duration) {
        match (self.rest, self.job) {
            // it is from before the request, or the slave does not follow it yet
            (_, Some(Stage::Asking { .. })) => return,
            (Rest::Anything { after }, _) if after.is_none_or(|after| now < after) => return,
            _ => self.rest = Rest::Zero,
        }
        if let Some(Stage::Resting { .. }) = self.job {
            self.job = Some(self.asking(now));
        }
    }

    fn standing(&self) -> Pkw {
        let mut octets = [0; PKW_LEN];
        for (place, octet) in octets.iter_mut().zip(self.block.iter().take(self.length)) {
            *place = *octet;
        }
        Pkw::from_octets(octets)
    }

    /// Returns the outcome if this reply belongs to the standing request.
    fn judge(&self, reply: Pkw) -> Option<Outcome> {
        let request = self.standing();
        let info = request.request_code().info();
        let code = reply.reply_code();
        let (asked, replied) = (request.address(&self.dialect)?, reply.address(&self.dialect)?);
        let nameless = !self.dialect.refusal_names_pnu
            && code == ReplyCode::REFUSED
            && reply.pke & self.dialect.pnu_mask() == 0;
        if !nameless && !same(&self.dialect, asked, replied) {
            return None;
        }
        if info.refusals.contains(&code) {
            return Some(Err(match code {
                ReplyCode::NO_RIGHTS => JobError::NoRights,
                _ => JobError::Refused(PkwErrorNumber(reply.pwe_low())),
            }));
        }
        if !info.replies.contains(&code) {
            return None;
        }
        Some(Ok(match info.action {
            Action::ReadDescription => Answer::Description(reply.pwe),
            Action::CountElements => Answer::Elements(reply.pwe_low()),
            Action::Text => Answer::Text,
            _ => Answer::Value(PkwValue::new(code.info().width?, reply.pwe)),
        }))
    }

    fn keep(&mut self, pkw: Pkw, code: ReplyCode) {
        let width = code.info().width.unwrap_or(Width::Word);
        if let Some(address) = pkw.address(&self.dialect) {
            self.spontaneous = Some(Spontaneous {
                pnu: address.pnu,
                subindex: address.subindex,
                value: PkwValue::new(width, pkw.pwe),
            });
        }
    }
}

/// Returns whether a reply mirrors PNU and IND; of the text code only what the layout has.
fn same(dialect: &PkwDialect, asked: PkwAddress, replied: PkwAddress) -> bool {
    asked.pnu == replied.pnu
        && asked.subindex == replied.subindex
        && (dialect.ind != IndLayout::TextIndex || asked.text == replied.text)
}

/// Returns the fixed part and the characters.
fn parse(reply: &[u8]) -> Option<(Pkw, &[u8])> {
    let (head, text) = reply.split_first_chunk::<TEXT_AT>()?;
    let [a, b, c, d] = *head;
    let short = Pkw::from_octets([a, b, c, d, 0, 0, 0, 0]);
    if short.reply_code() == ReplyCode::TEXT {
        return Some((short, text));
    }
    let octets = reply.first_chunk().filter(|_| reply.len() == PKW_LEN)?;
    Some((Pkw::from_octets(*octets), &[]))
}
