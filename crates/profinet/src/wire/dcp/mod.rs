//! Discovery and basic configuration (DCP): who is there, and giving names and addresses.
//!
//! Source: IEC 61158-6-10, DCP-PDU. Everything here starts behind the FrameID. A PDU is parsed as a [`Pdu`]; its blocks
//! have five forms, one per use, and each form has a reader on [`Block`] and a writer on [`PduWriter`].

mod address;
mod code;
mod name;
mod value;

pub use address::{IpRule, check_ip};
pub use code::{BlockError, BlockInfo, DcpOption, Qualifier, ServiceId, ServiceType, role};
pub use name::{MAX_NAME, NameRule, check_name, legal_name};
pub use value::Value;

use core::time::Duration;

use super::{DecodeError, Problem, Reader, Writer};
use crate::MacAddress;

/// Octets of the DCP header behind the FrameID.
pub const HEADER: usize = 10;

/// Octets of option, suboption and length in front of the value of a block.
pub const BLOCK_HEADER: usize = 4;

/// Largest ResponseDelayFactor of an Identify request.
pub const MAX_DELAY_FACTOR: u16 = 6400;

/// One DCP PDU, its length field checked.
///
/// ```
/// use profidrive_profinet::wire::dcp::{Pdu, ServiceId, Value};
/// // Identify by name
/// let bytes = [
///     5, 0, 0, 0, 0, 2, 0, 1, 0, 12, 2, 2, 0, 7, b'd', b'r', b'i', b'v', b'e', b'-', b'1', 0,
/// ];
/// let pdu = Pdu::parse(&bytes).unwrap();
/// assert_eq!((pdu.service, pdu.xid), (ServiceId::Identify, 2));
/// let block = pdu.blocks().next().unwrap().unwrap();
/// assert_eq!(block.filter(), Ok(Value::Name(b"drive-1")));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pdu<'a> {
    /// Service of the request or answer.
    pub service: ServiceId,
    /// Request or kind of response.
    pub kind: ServiceType,
    /// Chosen by the requester, repeated by the answer.
    pub xid: u32,
    /// ResponseDelayFactor of an Identify request; reserved otherwise.
    pub delay_factor: u16,
    /// All blocks with their padding.
    pub data: &'a [u8],
}

impl<'a> Pdu<'a> {
    /// Reads header and length. What follows the declared length is padding of the frame.
    ///
    /// # Errors
    /// When the octets end inside the header or before the declared length.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        Self::decode(Reader::new(bytes))
    }

    /// The same from a reader.
    ///
    /// # Errors
    /// When the octets end inside the header or before the declared length.
    pub fn decode(mut reader: Reader<'a>) -> Result<Self, DecodeError> {
        let service = ServiceId::from(reader.u8("DCP ServiceID")?);
        let kind = ServiceType::from(reader.u8("DCP ServiceType")?);
        let xid = reader.u32("DCP Xid")?;
        let delay_factor = reader.u16("DCP ResponseDelay")?;
        let length = reader.u16("DCPDataLength")?;
        let data = reader.bytes(usize::from(length), "DCP blocks")?;
        Ok(Self {
            service,
            kind,
            xid,
            delay_factor,
            data,
        })
    }

    /// Returns the blocks one by one. The iterator ends after the first error.
    #[must_use]
    pub fn blocks(&self) -> Blocks<'a> {
        Blocks::new(Reader::with_base(self.data, HEADER))
    }

    /// Returns the options of a Get request: pairs without length.
    ///
    /// # Errors
    /// An odd octet is left over (reported as the iterator's last item).
    pub fn requested(&self) -> impl Iterator<Item = Result<DcpOption, DecodeError>> + 'a {
        let mut reader = Reader::with_base(self.data, HEADER);
        core::iter::from_fn(move || {
            if reader.is_empty() {
                return None;
            }
            let pair = reader.array::<2>("DCP requested option");
            if pair.is_err() {
                reader.rest("DCP block value");
            }
            Some(pair.map(|[option, suboption]| DcpOption { option, suboption }))
        })
    }
}

/// Iterator over the blocks of a [`Pdu`].
#[derive(Debug, Clone)]
pub struct Blocks<'a> {
    reader: Reader<'a>,
}

impl<'a> Blocks<'a> {
    /// Walks over what `reader` has left.
    #[must_use]
    pub const fn new(reader: Reader<'a>) -> Self {
        Self { reader }
    }
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Result<Block<'a>, DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_empty() {
            return None;
        }
        let block = next_block(&mut self.reader);
        if block.is_err() {
            self.reader.rest("DCP block value");
        }
        Some(block)
    }
}

fn next_block<'a>(reader: &mut Reader<'a>) -> Result<Block<'a>, DecodeError> {
    let start = reader.position();
    let option = reader.u8("DCP Option")?;
    let suboption = reader.u8("DCP Suboption")?;
    let length = usize::from(reader.u16("DCPBlockLength")?);
    let offset = reader.offset();
    let body = reader.bytes(length, "DCP block value")?;
    reader.enclose("DCP block", start);
    if length % 2 == 1 && !reader.is_empty() {
        reader.skip(1, "DCP block padding")?;
    }
    Ok(Block {
        option: DcpOption { option, suboption },
        body,
        offset,
    })
}

/// One block, its form not decided yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block<'a> {
    /// What it is about.
    pub option: DcpOption,
    /// Its octets without length and padding.
    pub body: &'a [u8],
    /// Offset of the body behind the FrameID.
    pub offset: usize,
}

impl<'a> Block<'a> {
    /// As a filter of an Identify request: only the value.
    ///
    /// # Errors
    /// When the value has a wrong length.
    pub fn filter(&self) -> Result<Value<'a>, DecodeError> {
        Value::decode(self.option, Reader::with_base(self.body, self.offset))
    }

    /// As part of a Get or Identify response or of a Hello: BlockInfo and value.
    ///
    /// # Errors
    /// When BlockInfo is cut or the value has a wrong length.
    pub fn info(&self) -> Result<(BlockInfo, Value<'a>), DecodeError> {
        let (info, rest) = self.prefix("DCP BlockInfo")?;
        Ok((
            BlockInfo(info),
            Value::decode(self.option, Reader::with_base(rest, self.offset + 2))?,
        ))
    }

    /// As part of a Set request: BlockQualifier and value.
    ///
    /// # Errors
    /// When BlockQualifier is cut or the value has a wrong length: answer [`BlockError::NotSet`].
    pub fn set(&self) -> Result<(Qualifier, Value<'a>), DecodeError> {
        let (qualifier, rest) = self.prefix("DCP BlockQualifier")?;
        Ok((
            Qualifier(qualifier),
            Value::decode(self.option, Reader::with_base(rest, self.offset + 2))?,
        ))
    }

    /// As a result (option 5/4): which block it is about and how it ended.
    ///
    /// # Errors
    /// When it is not a result block or shorter than three octets.
    pub fn result(&self) -> Result<(DcpOption, BlockError), DecodeError> {
        if self.option != DcpOption::RESPONSE {
            return Err(DecodeError {
                what: "DCP result block",
                offset: self.offset.saturating_sub(4),
                problem: Problem::Expected {
                    expected: u64::from(DcpOption::RESPONSE.number()),
                    found: u64::from(self.option.number()),
                },
            });
        }
        let mut reader = Reader::with_base(self.body, self.offset);
        let [option, suboption, error] = reader.array("DCP result block")?;
        Ok((DcpOption { option, suboption }, BlockError::from(error)))
    }

    fn prefix(&self, what: &'static str) -> Result<(u16, &'a [u8]), DecodeError> {
        let mut reader = Reader::with_base(self.body, self.offset);
        Ok((reader.u16(what)?, reader.rest("DCP block value")))
    }
}

/// Writes a DCP PDU block by block; [`finish`](Self::finish) fills in the length.
///
/// ```
/// use profidrive_profinet::wire::dcp::{PduWriter, ServiceId, ServiceType, Value};
/// let mut bytes = Vec::new();
/// let mut pdu = PduWriter::new(&mut bytes, ServiceId::Identify, ServiceType::Request, 2, 1);
/// pdu.filter(&Value::Name(b"drive-1"));
/// pdu.finish();
/// assert_eq!(bytes[8..14], [0, 12, 2, 2, 0, 7]);
/// ```
#[derive(Debug)]
pub struct PduWriter<'w, W: Writer> {
    out: &'w mut W,
    start: usize,
}

impl<'w, W: Writer> PduWriter<'w, W> {
    /// Writes the header; `delay_factor` is 0 except in Identify requests.
    pub fn new(out: &'w mut W, service: ServiceId, kind: ServiceType, xid: u32, delay_factor: u16) -> Self {
        let start = out.position();
        out.u8(service.into());
        out.u8(kind.into());
        out.u32(xid);
        out.u16(delay_factor);
        out.u16(0);
        Self { out, start }
    }

    /// A filter of an Identify request.
    pub fn filter(&mut self, value: &Value<'_>) {
        self.block(value.option(), None, value);
    }

    /// One thing a Get request requests.
    pub fn request(&mut self, option: DcpOption) {
        self.out.bytes(&[option.option, option.suboption]);
    }

    /// A block of a Get or Identify response or of a Hello.
    pub fn info(&mut self, info: BlockInfo, value: &Value<'_>) {
        self.block(value.option(), Some(info.0), value);
    }

    /// A block of a Set request.
    pub fn set(&mut self, qualifier: Qualifier, value: &Value<'_>) {
        self.block(value.option(), Some(qualifier.0), value);
    }

    /// The result of one block of a Set request, or a refused block of a Get request.
    pub fn result(&mut self, option: DcpOption, error: BlockError) {
        let DcpOption {
            option: response,
            suboption: sub,
        } = DcpOption::RESPONSE;
        self.out.bytes(&[
            response,
            sub,
            0,
            3,
            option.option,
            option.suboption,
            error.into(),
            0,
        ]);
    }

    fn block(&mut self, option: DcpOption, prefix: Option<u16>, value: &Value<'_>) {
        self.out.bytes(&[option.option, option.suboption]);
        let length_at = self.out.position();
        self.out.u16(0);
        if let Some(prefix) = prefix {
            self.out.u16(prefix);
        }
        value.encode(self.out);
        let length = self.out.position() - length_at - 2;
        let field = u16::try_from(length).unwrap_or(u16::MAX);
        self.out.patch(length_at, &field.to_be_bytes());
        self.out.align(length_at, 2);
    }

    /// Fills in DCPDataLength.
    pub fn finish(self) {
        let length = self.out.position().saturating_sub(self.start + HEADER);
        let field = u16::try_from(length).unwrap_or(u16::MAX);
        self.out.patch(self.start + 8, &field.to_be_bytes());
    }
}

/// Returns the delay before a device answers an Identify request.
///
/// Source: IEC 61158-6-10, ResponseDelay: the last two octets of the MAC address modulo the factor, times 10 ms. A
/// factor of 0 or above 6400 means no delay.
#[must_use]
pub fn response_delay(mac: MacAddress, factor: u16) -> Duration {
    if factor == 0 || factor > MAX_DELAY_FACTOR {
        return Duration::ZERO;
    }
    let [.., high, low] = mac.0;
    let spread = u16::from_be_bytes([high, low]) % factor;
    Duration::from_millis(u64::from(spread) * 10)
}

#[cfg(test)]
mod tests;
