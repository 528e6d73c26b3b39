//! Codes in the upper four bits of PKE: requests of the master and replies of the slave, as tables.

use core::fmt;

/// Action that a request demands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Nothing: the channel is at rest.
    Nothing,
    /// A value.
    Read,
    /// A new value.
    Change,
    /// An element of the description.
    ReadDescription,
    /// A new element of the description.
    ChangeDescription,
    /// The number of elements of an array.
    CountElements,
    /// A text, read or written.
    Text,
    /// No meaning known.
    Reserved,
}

/// How a value fills PWE.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Width {
    /// 16 bits in PWE low; PWE high counts for nothing.
    Word,
    /// 32 bits in PWE high and PWE low.
    DoubleWord,
}

/// Where a change goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Memory {
    /// Gone with the next power cycle.
    Ram,
    /// Retained over a power cycle.
    Eeprom,
}

/// One row of the table of requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RequestInfo {
    /// AK of the request.
    pub code: RequestCode,
    /// Name for people.
    pub name: &'static str,
    /// Action that it demands.
    pub action: Action,
    /// Width of the value it brings.
    pub width: Option<Width>,
    /// True when it means an element of an array.
    pub array: bool,
    /// Where a change goes.
    pub memory: Option<Memory>,
    /// AKs of a positive reply.
    pub replies: &'static [ReplyCode],
    /// AKs of a negative reply.
    pub refusals: &'static [ReplyCode],
}

impl RequestInfo {
    /// Returns true when the request needs the right to change parameters.
    #[must_use]
    pub const fn changes(&self) -> bool {
        matches!(self.action, Action::Change | Action::ChangeDescription)
    }
}

/// One row of the table of replies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReplyInfo {
    /// AK of the reply.
    pub code: ReplyCode,
    /// Name for people.
    pub name: &'static str,
    /// Width of the value it brings.
    pub width: Option<Width>,
    /// True when the value is an element of an array.
    pub array: bool,
    /// True for a message that no request requested.
    pub spontaneous: bool,
}

/// AK of a request.
///
/// ```
/// use profidrive_profile::pkw::{Memory, ReplyCode, RequestCode, Width};
/// let store = RequestCode::STORE_DOUBLE_WORD.info();
/// assert_eq!(store.name, "change value (double word) in RAM and EEPROM");
/// assert_eq!((store.width, store.memory), (Some(Width::DoubleWord), Some(Memory::Eeprom)));
/// assert_eq!(store.replies, [ReplyCode::DOUBLE_WORD]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RequestCode(pub u8);

impl RequestCode {
    /// 0: no request.
    pub const NONE: Self = Self(0);
    /// 1: request value.
    pub const READ: Self = Self(1);
    /// 2: change value (word), RAM.
    pub const CHANGE_WORD: Self = Self(2);
    /// 3: change value (double word), RAM.
    pub const CHANGE_DOUBLE_WORD: Self = Self(3);
    /// 4: request description element.
    pub const READ_DESCRIPTION: Self = Self(4);
    /// 5: change description element.
    pub const CHANGE_DESCRIPTION: Self = Self(5);
    /// 6: request value of an array.
    pub const READ_ARRAY: Self = Self(6);
    /// 7: change value of an array (word), RAM.
    pub const CHANGE_ARRAY_WORD: Self = Self(7);
    /// 8: change value of an array (double word), RAM.
    pub const CHANGE_ARRAY_DOUBLE_WORD: Self = Self(8);
    /// 9: request number of array elements.
    pub const COUNT_ELEMENTS: Self = Self(9);
    /// 10: reserved.
    pub const RESERVED: Self = Self(10);
    /// 11: change value of an array (double word), RAM and EEPROM.
    pub const STORE_ARRAY_DOUBLE_WORD: Self = Self(11);
    /// 12: change value of an array (word), RAM and EEPROM.
    pub const STORE_ARRAY_WORD: Self = Self(12);
    /// 13: change value (double word), RAM and EEPROM.
    pub const STORE_DOUBLE_WORD: Self = Self(13);
    /// 14: change value (word), RAM and EEPROM.
    pub const STORE_WORD: Self = Self(14);
    /// 15: read or write text.
    pub const TEXT: Self = Self(15);

    /// Returns the row of the table; only the low four bits count.
    #[must_use]
    pub fn info(self) -> &'static RequestInfo {
        &REQUESTS[usize::from(self.0 & 0x0F)]
    }
}

impl fmt::Display for RequestCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AK {} {}", self.0 & 0x0F, self.info().name)
    }
}

/// AK of a reply.
///
/// ```
/// use profidrive_profile::pkw::ReplyCode;
/// assert_eq!(ReplyCode(7).to_string(), "AK 7 request not executable");
/// assert!(ReplyCode(9).info().spontaneous);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ReplyCode(pub u8);

impl ReplyCode {
    /// 0: no reply.
    pub const NONE: Self = Self(0);
    /// 1: value (word).
    pub const WORD: Self = Self(1);
    /// 2: value (double word).
    pub const DOUBLE_WORD: Self = Self(2);
    /// 3: description element.
    pub const DESCRIPTION: Self = Self(3);
    /// 4: value of an array (word).
    pub const ARRAY_WORD: Self = Self(4);
    /// 5: value of an array (double word).
    pub const ARRAY_DOUBLE_WORD: Self = Self(5);
    /// 6: number of array elements.
    pub const ELEMENTS: Self = Self(6);
    /// 7: not executable, error number in PWE low.
    pub const REFUSED: Self = Self(7);
    /// 8: no change rights.
    pub const NO_RIGHTS: Self = Self(8);
    /// 15: text.
    pub const TEXT: Self = Self(15);

    /// Returns the row of the table; only the low four bits count.
    #[must_use]
    pub fn info(self) -> &'static ReplyInfo {
        &REPLIES[usize::from(self.0 & 0x0F)]
    }
}

impl fmt::Display for ReplyCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AK {} {}", self.0 & 0x0F, self.info().name)
    }
}

const VALUE: &[ReplyCode] = &[ReplyCode::WORD, ReplyCode::DOUBLE_WORD];
const ARRAY_VALUE: &[ReplyCode] = &[ReplyCode::ARRAY_WORD, ReplyCode::ARRAY_DOUBLE_WORD];
const REFUSED: &[ReplyCode] = &[ReplyCode::REFUSED];
const REFUSED_OR_NO_RIGHTS: &[ReplyCode] = &[ReplyCode::REFUSED, ReplyCode::NO_RIGHTS];

const fn request(
    code: u8,
    name: &'static str,
    action: Action,
    replies: &'static [ReplyCode],
    refusals: &'static [ReplyCode],
) -> RequestInfo {
    RequestInfo {
        code: RequestCode(code),
        name,
        action,
        width: None,
        array: false,
        memory: None,
        replies,
        refusals,
    }
}

const fn change(
    code: u8,
    name: &'static str,
    width: Width,
    array: bool,
    memory: Memory,
    replies: &'static [ReplyCode],
) -> RequestInfo {
    RequestInfo {
        width: Some(width),
        array,
        memory: Some(memory),
        ..request(code, name, Action::Change, replies, REFUSED_OR_NO_RIGHTS)
    }
}

/// All requests; the place is the AK.
/// Source: Siemens CU240S manual p. 123 and 156, Kollmorgen S300 PROFIBUS p. 18, Danfoss MCA 101 p. 34.
#[rustfmt::skip]
pub static REQUESTS: [RequestInfo; 16] = [
    request(0, "no request", Action::Nothing, &[ReplyCode::NONE], &[]),
    request(1, "request value", Action::Read, VALUE, REFUSED),
    change(2, "change value (word)", Width::Word, false, Memory::Ram, &[ReplyCode::WORD]),
    change(3, "change value (double word)", Width::DoubleWord, false, Memory::Ram, &[ReplyCode::DOUBLE_WORD]),
    request(4, "request description element", Action::ReadDescription, &[ReplyCode::DESCRIPTION], REFUSED),
    request(5, "change description element", Action::ChangeDescription, &[ReplyCode::DESCRIPTION], REFUSED_OR_NO_RIGHTS),
    RequestInfo { array: true, ..request(6, "request value (array)", Action::Read, ARRAY_VALUE, REFUSED) },
    change(7, "change value (array word)", Width::Word, true, Memory::Ram, &[ReplyCode::ARRAY_WORD]),
    change(8, "change value (array double word)", Width::DoubleWord, true, Memory::Ram, &[ReplyCode::ARRAY_DOUBLE_WORD]),
    request(9, "request number of array elements", Action::CountElements, &[ReplyCode::ELEMENTS], REFUSED),
    request(10, "reserved", Action::Reserved, &[], REFUSED),
    change(11, "change value (array double word) in RAM and EEPROM", Width::DoubleWord, true, Memory::Eeprom, &[ReplyCode::ARRAY_DOUBLE_WORD]),
    change(12, "change value (array word) in RAM and EEPROM", Width::Word, true, Memory::Eeprom, &[ReplyCode::ARRAY_WORD]),
    change(13, "change value (double word) in RAM and EEPROM", Width::DoubleWord, false, Memory::Eeprom, &[ReplyCode::DOUBLE_WORD]),
    change(14, "change value (word) in RAM and EEPROM", Width::Word, false, Memory::Eeprom, &[ReplyCode::WORD]),
    request(15, "read or write text", Action::Text, &[ReplyCode::TEXT], REFUSED),
];

const fn reply(
    code: u8,
    name: &'static str,
    width: Option<Width>,
    array: bool,
    spontaneous: bool,
) -> ReplyInfo {
    ReplyInfo {
        code: ReplyCode(code),
        name,
        width,
        array,
        spontaneous,
    }
}

/// All replies; the place is the AK.
/// Source: Siemens CU240S manual p. 124 and 157, Danfoss MCA 101 p. 34.
#[rustfmt::skip]
pub static REPLIES: [ReplyInfo; 16] = [
    reply(0, "no reply", None, false, false),
    reply(1, "value (word)", Some(Width::Word), false, false),
    reply(2, "value (double word)", Some(Width::DoubleWord), false, false),
    reply(3, "description element", None, false, false),
    reply(4, "value (array word)", Some(Width::Word), true, false),
    reply(5, "value (array double word)", Some(Width::DoubleWord), true, false),
    reply(6, "number of array elements", None, false, false),
    reply(7, "request not executable", None, false, false),
    reply(8, "no change rights", None, false, false),
    reply(9, "spontaneous message (word)", Some(Width::Word), false, true),
    reply(10, "spontaneous message (double word)", Some(Width::DoubleWord), false, true),
    reply(11, "spontaneous message (array word)", Some(Width::Word), true, true),
    reply(12, "spontaneous message (array double word)", Some(Width::DoubleWord), true, true),
    reply(13, "reserved", None, false, false),
    reply(14, "reserved", None, false, false),
    reply(15, "text", None, false, false),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_stands_at_its_number() {
        for (place, row) in REQUESTS.iter().enumerate() {
            assert_eq!(usize::from(row.code.0), place);
            assert_eq!(row.code.info(), row);
            assert_eq!(
                row.changes() && row.action == Action::Change,
                row.memory.is_some()
            );
        }
        for (place, row) in REPLIES.iter().enumerate() {
            assert_eq!(usize::from(row.code.0), place);
            assert_eq!(row.code.info(), row);
        }
    }

    /// A change is answered with a value of its own width, and only with that.
    #[test]
    fn replies_fit_their_requests() {
        for row in REQUESTS.iter().filter(|row| row.action == Action::Change) {
            let [reply] = row.replies else {
                panic!("{}", row.code)
            };
            assert_eq!((reply.info().width, reply.info().array), (row.width, row.array));
        }
        for row in REQUESTS.iter().filter(|row| row.action == Action::Read) {
            assert!(row.replies.iter().all(|reply| reply.info().array == row.array));
        }
    }
}
