//! Jobs of a client for the channel, and their results.

use super::code::{Action, Memory, REQUESTS, RequestCode, RequestInfo, Width};
use super::dialect::PkwDialect;
use super::error::{PkwErrorNames, PkwErrorNumber};
use super::words::{MAX_TEXT, PkwAddress, TEXT_READ, TEXT_WRITE};

/// A value in the width in which it travels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PkwValue {
    /// 16 bits; whether there is a sign only a table knows.
    Word(u16),
    /// 32 bits.
    DoubleWord(u32),
}

impl PkwValue {
    /// Word or double word.
    #[must_use]
    pub const fn width(self) -> Width {
        match self {
            Self::Word(_) => Width::Word,
            Self::DoubleWord(_) => Width::DoubleWord,
        }
    }

    /// Returns the number without a sign.
    #[must_use]
    pub const fn raw(self) -> u32 {
        match self {
            Self::Word(word) => word as u32,
            Self::DoubleWord(double) => double,
        }
    }

    /// Returns the number in two's complement of its width.
    ///
    /// ```
    /// use profidrive_profile::pkw::PkwValue;
    /// assert_eq!(PkwValue::Word(0xFFFF).signed(), -1);
    /// assert_eq!(PkwValue::DoubleWord(0xFFFF).signed(), 65_535);
    /// ```
    #[must_use]
    pub const fn signed(self) -> i32 {
        match self {
            Self::Word(word) => word.cast_signed() as i32,
            Self::DoubleWord(double) => double.cast_signed(),
        }
    }

    pub(super) const fn new(width: Width, pwe: u32) -> Self {
        match width {
            Width::Word => {
                let [_, _, high, low] = pwe.to_be_bytes();
                Self::Word(u16::from_be_bytes([high, low]))
            }
            Width::DoubleWord => Self::DoubleWord(pwe),
        }
    }
}

/// One request of a client. `element` is `None` for a parameter that is not an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job<'a> {
    /// A value.
    Read {
        /// Parameter number.
        pnu: u16,
        /// Element of an array.
        element: Option<u8>,
    },
    /// A new value, in the width of the parameter.
    Change {
        /// Parameter number.
        pnu: u16,
        /// Element of an array.
        element: Option<u8>,
        /// What it shall be.
        value: PkwValue,
        /// How long it shall last.
        memory: Memory,
    },
    /// How many elements an array has.
    CountElements {
        /// Parameter number.
        pnu: u16,
    },
    /// One element (1 to 12) of the description; those of up to four octets can travel.
    Description {
        /// Parameter number.
        pnu: u16,
        /// Which.
        element: u8,
    },
    /// A text, in a serial text block.
    ReadText {
        /// Parameter number.
        pnu: u16,
        /// Which of its texts.
        index: u8,
    },
    /// A new text, in a serial text block.
    ChangeText {
        /// Parameter number.
        pnu: u16,
        /// Which of its texts.
        index: u8,
        /// The characters, [`MAX_TEXT`] at most.
        text: &'a [u8],
    },
}

/// What a drive answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// A value: what was requested, or what is there after a change.
    Value(PkwValue),
    /// An element of the description, right-aligned.
    Description(u32),
    /// Number of elements.
    Elements(u16),
    /// A text, kept in [`Client::text`](super::Client::text).
    Text,
}

/// Why a job has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum JobError {
    /// The drive refused: AK 7.
    #[error("the drive refuses: {0}")]
    Refused(PkwErrorNumber),
    /// The drive refused: AK 8.
    #[error("no change rights for the parameter channel: another interface holds them")]
    NoRights,
    /// The channel did not come to rest before the request: the drive does not answer at all, or not the zero telegram.
    #[error("the parameter channel does not answer the zero telegram")]
    NotAtRest,
    /// No reply to this request.
    #[error("no reply to the request")]
    NoReply,
    /// The connection was lost while the request stood; a change may or may not be done.
    #[error("the connection was lost before the reply came")]
    Lost,
}

impl JobError {
    /// Returns the remedy.
    #[must_use]
    pub fn remedy(self, names: PkwErrorNames) -> &'static str {
        match self {
            Self::Refused(number) => match number.info(names) {
                Some(info) => info.remedy,
                None => "look for the number in the manual of the drive",
            },
            Self::NoRights => "release the rights there, or set PNU 927",
            Self::NotAtRest => {
                "check that the drive runs its parameter channel and that no other master uses it"
            }
            Self::NoReply => "check the parameter number; a drive that is busy may need a longer time-out",
            Self::Lost => "read the value again before relying on it",
        }
    }
}

/// A job that was not started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StartError {
    /// Another job is under way: one at a time.
    #[error("the parameter channel is busy with another request")]
    Busy,
    /// The channel has no such request.
    #[error("{dialect} has no request to {}", .request.info().name)]
    NoRequest {
        /// The request that would be needed.
        request: RequestCode,
        /// Name of the dialect.
        dialect: &'static str,
    },
    /// The parameter number does not fit PKE and IND.
    #[error("parameter number {pnu} cannot be named in the parameter channel of {dialect}")]
    Number {
        /// The number.
        pnu: u16,
        /// Name of the dialect.
        dialect: &'static str,
    },
    /// The text is longer than a telegram.
    #[error("a text of {0} characters, {MAX_TEXT} are possible")]
    TextLength(usize),
}

/// A job as it stands in the channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Order<'a> {
    pub code: RequestCode,
    pub address: PkwAddress,
    pub pwe: u32,
    pub text: &'a [u8],
}

impl<'a> Job<'a> {
    /// Returns the AK the job needs in this dialect: for elements of arrays the array requests, or the plain ones where
    /// those are all there is.
    pub(super) fn order(&self, dialect: &PkwDialect) -> Result<Order<'a>, StartError> {
        let plain = |code, pnu, subindex| Order {
            code,
            address: PkwAddress {
                pnu,
                subindex,
                text: 0,
            },
            pwe: 0,
            text: &[],
        };
        let order = match *self {
            Job::Read { pnu, element } => {
                let code = choose(dialect, element.is_some(), |row| row.action == Action::Read);
                plain(code, pnu, element.unwrap_or(0))
            }
            Job::Change {
                pnu,
                element,
                value,
                memory,
            } => {
                let code = choose(dialect, element.is_some(), |row| {
                    row.action == Action::Change
                        && row.width == Some(value.width())
                        && row.memory == Some(memory)
                });
                Order {
                    pwe: value.raw(),
                    ..plain(code, pnu, element.unwrap_or(0))
                }
            }
            Job::CountElements { pnu } => plain(RequestCode::COUNT_ELEMENTS, pnu, 0),
            Job::Description { pnu, element } => plain(RequestCode::READ_DESCRIPTION, pnu, element),
            Job::ReadText { pnu, index } | Job::ChangeText { pnu, index, .. } => {
                let mut order = plain(RequestCode::TEXT, pnu, index);
                order.address.text = TEXT_READ;
                if let Job::ChangeText { text, .. } = *self {
                    order.address.text = TEXT_WRITE;
                    order.text = text;
                }
                order
            }
        };
        if !dialect.knows(order.code) {
            return Err(StartError::NoRequest {
                request: order.code,
                dialect: dialect.name,
            });
        }
        if order.text.len() > MAX_TEXT {
            return Err(StartError::TextLength(order.text.len()));
        }
        if dialect.split(order.address.pnu).is_none() {
            return Err(StartError::Number {
                pnu: order.address.pnu,
                dialect: dialect.name,
            });
        }
        Ok(order)
    }
}

/// Returns the request that fits, the array form first when an element is meant.
fn choose(dialect: &PkwDialect, array: bool, fits: impl Fn(&RequestInfo) -> bool) -> RequestCode {
    let form = |array| REQUESTS.iter().find(|row| row.array == array && fits(row));
    let fallback = form(false).map_or(RequestCode::RESERVED, |row| row.code);
    form(true)
        .filter(|row| array && dialect.knows(row.code))
        .map_or(fallback, |row| row.code)
}
