//! Requests: taking them apart and writing them.

use super::address::{ADDRESS, DecodeError, HEADER, ParameterAddress, RequestId, Wrong};
use super::block::{BlockWriter, ValueBlock};
use super::dialect::Dialect;
use super::format::{CodeSpace, Format};

/// A view over a request block.
///
/// ```
/// use profidrive_profile::parameter::{CodeSpace, ParameterAddress, Request, RequestId};
/// // AKD manual 3.6.2: operation mode := 2
/// let bytes = [5, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
/// let request = Request::parse(&bytes, CodeSpace::V4).unwrap();
/// assert_eq!((request.reference(), request.id(), request.axis()), (5, RequestId::Change, 0));
/// assert_eq!(request.addresses().next(), Some(ParameterAddress::value(930, 0)));
/// assert_eq!(request.values().next().unwrap().unwrap().raw(0), Some(2));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request<'a> {
    bytes: &'a [u8],
    addresses: &'a [[u8; ADDRESS]],
    space: CodeSpace,
}

impl<'a> Request<'a> {
    /// Takes header and parameter addresses apart; value blocks follow with [`values`](Self::values).
    ///
    /// # Errors
    /// When the block ends before the addresses do.
    #[inline]
    pub fn parse(bytes: &'a [u8], space: CodeSpace) -> Result<Self, DecodeError> {
        let &[_, _, _, parameters, ref rest @ ..] = bytes else {
            return Err(DecodeError {
                wrong: Wrong::Header,
                offset: 0,
                expected: HEADER,
                found: bytes.len(),
            });
        };
        let parameters = usize::from(parameters);
        let (addresses, _) = rest.as_chunks();
        let Some(addresses) = addresses.get(..parameters) else {
            let expected = ADDRESS * parameters;
            return Err(DecodeError {
                wrong: Wrong::Addresses,
                offset: HEADER,
                expected,
                found: rest.len(),
            });
        };
        Ok(Self {
            bytes,
            addresses,
            space,
        })
    }

    fn header(&self) -> [u8; HEADER] {
        self.bytes.first_chunk().copied().unwrap_or_default()
    }

    /// Request reference; 0 is reserved.
    #[must_use]
    pub fn reference(&self) -> u8 {
        self.header()[0]
    }

    /// Read or change.
    #[must_use]
    pub fn id(&self) -> RequestId {
        RequestId::from_octet(self.header()[1])
    }

    /// Axis or drive object number.
    #[must_use]
    pub fn axis(&self) -> u8 {
        self.header()[2]
    }

    /// Returns the number of parameters.
    #[must_use]
    pub fn parameters(&self) -> u8 {
        self.header()[3]
    }

    /// Returns the parameter addresses in order.
    pub fn addresses(&self) -> impl ExactSizeIterator<Item = ParameterAddress> + 'a {
        self.addresses
            .iter()
            .map(|octets| ParameterAddress::from_octets(*octets))
    }

    /// Returns the octets behind the addresses.
    #[must_use]
    pub fn tail(&self) -> &'a [u8] {
        self.bytes.get(self.tail_offset()..).unwrap_or(&[])
    }

    fn tail_offset(&self) -> usize {
        HEADER + ADDRESS * self.addresses.len()
    }

    /// Returns the octets behind the end of the request. Empty too when a value block cannot be
    /// taken apart, which is reported by [`values`](Self::values).
    #[must_use]
    pub fn behind(&self) -> &'a [u8] {
        let mut end = self.tail_offset();
        if self.id().is_change() {
            for _ in self.addresses {
                match ValueBlock::parse(self.bytes, end, self.space) {
                    Ok((_, used)) => end += used,
                    Err(_) => return &[],
                }
            }
        }
        self.bytes.get(end..).unwrap_or(&[])
    }

    /// Octets [`behind`](Self::behind) the request up to the last one that is not zero: programs that send a buffer of
    /// fixed length fill it with zeros.
    #[must_use]
    pub fn trailing(&self) -> usize {
        self.behind()
            .iter()
            .rposition(|&octet| octet != 0)
            .map_or(0, |last| last + 1)
    }

    /// Returns the value blocks of a change request in order, one for each address. After a block that cannot be taken
    /// apart the place of the next is unknown, so every further one gives the same error.
    pub fn values(&self) -> impl Iterator<Item = Result<ValueBlock<'a>, DecodeError>> + use<'a> {
        let (bytes, space, mut offset) = (self.bytes, self.space, self.tail_offset());
        let mut broken = None;
        (0..self.addresses.len()).map(move |_| match broken {
            Some(error) => Err(error),
            None => ValueBlock::parse(bytes, offset, space)
                .map(|(block, used)| {
                    offset += used;
                    block
                })
                .inspect_err(|error| broken = Some(*error)),
        })
    }
}

/// A request that cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    /// The drive does not support the request, or the ID is that of a response.
    #[error("the drive does not support request ID 0x{:02X}", id.octet())]
    Request {
        /// ID of the request.
        id: RequestId,
    },
    /// None, or more than the drive takes.
    #[error("{found} parameters in one request, 1 to {allowed} are possible")]
    Parameters {
        /// Parameters given.
        found: usize,
        /// Limit of the dialect.
        allowed: u8,
    },
    /// More values than the drive takes in one frame.
    #[error("{found} values in one request, {allowed} are possible")]
    ValueCount {
        /// Values given, all parameters together.
        found: usize,
        /// Limit of the dialect.
        allowed: u16,
    },
    /// Longer than the buffer or the largest block of the drive.
    #[error("the request needs more than {allowed} octets")]
    Length {
        /// The limit.
        allowed: usize,
    },
    /// Number of values and octets do not fit the format.
    #[error("{found} octets are not {count} values of format {format}")]
    Values {
        /// The format.
        format: Format,
        /// The number of values.
        count: u8,
        /// Octets given.
        found: usize,
    },
    /// The reference 0 is reserved.
    #[error("the request reference 0 is reserved")]
    Reference,
}

/// Values for one address of a change request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NewValue<'a> {
    /// Where to.
    pub address: ParameterAddress,
    /// How each value is coded.
    pub format: Format,
    /// Number of values (of octets for strings).
    pub count: u8,
    /// The values, big-endian, without a pad octet.
    pub data: &'a [u8],
}

/// Writes a read request; gives its length, which is `4 + 6 * addresses`.
///
/// # Errors
/// When there are too many parameters for the dialect or `out` is too small.
pub fn encode_read(
    reference: u8,
    dialect: &Dialect,
    addresses: &[ParameterAddress],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    encode_read_as(RequestId::Read, reference, dialect, addresses, out)
}

/// Writes a read request with an ID of its own: Danfoss has [`RequestId::ReadWide`].
///
/// # Errors
/// As [`encode_read`], and when the drive does not support the read request.
pub fn encode_read_as(
    id: RequestId,
    reference: u8,
    dialect: &Dialect,
    addresses: &[ParameterAddress],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    if id.is_change() {
        return Err(EncodeError::Request { id });
    }
    let limit = out.len().min(dialect.max_block);
    let mut writer = BlockWriter::new(out.get_mut(..limit).unwrap_or_default());
    put_head(&mut writer, reference, id, dialect, addresses.iter().copied())?;
    Ok(writer.position())
}

/// Writes a change request: all addresses, then all value blocks, each padded to an even length.
///
/// # Errors
/// When there are too many parameters for the dialect, values do not fit their format, or `out` is too small.
///
/// ```
/// use profidrive_profile::parameter::{Dialect, Format, NewValue, ParameterAddress, encode_change};
/// let value = NewValue {
///     address: ParameterAddress::value(930, 0),
///     format: Format::WORD,
///     count: 1,
///     data: &[0, 2],
/// };
/// let mut out = [0; 240];
/// let length = encode_change(5, &Dialect::AKD, &[value], &mut out).unwrap();
/// assert_eq!(out[..length], [5, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2]);
/// ```
pub fn encode_change(
    reference: u8,
    dialect: &Dialect,
    values: &[NewValue<'_>],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    encode_change_as(RequestId::Change, reference, dialect, values, out)
}

/// Writes a change request with an ID of its own, see [`Dialect::change_id`].
///
/// # Errors
/// As [`encode_change`], and when the drive does not support the change request.
///
/// ```
/// use profidrive_profile::parameter::{Dialect, Format, NewValue, ParameterAddress, RequestId, encode_change_as};
/// let value = NewValue {
///     address: ParameterAddress::value(341, 0),
///     format: Format::UNSIGNED32,
///     count: 1,
///     data: &[0, 0, 1, 0x2C],
/// };
/// let mut out = [0; 240];
/// let length = encode_change_as(RequestId::ChangePermanent, 5, &Dialect::VLT, &[value], &mut out).unwrap();
/// assert_eq!(out[..length], [5, 0x42, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 7, 1, 0, 0, 1, 0x2C]);
/// assert!(encode_change_as(RequestId::ChangePermanent, 5, &Dialect::AKD, &[value], &mut out).is_err());
/// ```
pub fn encode_change_as(
    id: RequestId,
    reference: u8,
    dialect: &Dialect,
    values: &[NewValue<'_>],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    if !id.is_change() {
        return Err(EncodeError::Request { id });
    }
    let found = values.iter().map(|value| usize::from(value.count)).sum();
    let allowed = dialect.max_values;
    if found > usize::from(allowed) {
        return Err(EncodeError::ValueCount { found, allowed });
    }
    let limit = out.len().min(dialect.max_block);
    let mut writer = BlockWriter::new(out.get_mut(..limit).unwrap_or_default());
    put_head(
        &mut writer,
        reference,
        id,
        dialect,
        values.iter().map(|value| value.address),
    )?;
    for &NewValue {
        format, count, data, ..
    } in values
    {
        if format.data_len(dialect.code_space, count, data.len()) != Some(data.len()) {
            return Err(EncodeError::Values {
                format,
                count,
                found: data.len(),
            });
        }
        let block = [format.0, count];
        writer
            .put(&block)
            .and(writer.put(data))
            .ok_or(EncodeError::Length { allowed: limit })?;
        if data.len() % 2 == 1 {
            writer.put(&[0]).ok_or(EncodeError::Length { allowed: limit })?;
        }
    }
    Ok(writer.position())
}

fn put_head(
    writer: &mut BlockWriter<'_>,
    reference: u8,
    id: RequestId,
    dialect: &Dialect,
    addresses: impl ExactSizeIterator<Item = ParameterAddress>,
) -> Result<(), EncodeError> {
    if !dialect.knows(id) {
        return Err(EncodeError::Request { id });
    }
    let found = addresses.len();
    let allowed = dialect.max_parameters;
    let parameters = u8::try_from(found)
        .ok()
        .filter(|count| (1..=allowed).contains(count));
    let parameters = parameters.ok_or(EncodeError::Parameters { found, allowed })?;
    if reference == 0 {
        return Err(EncodeError::Reference);
    }
    let too_long = EncodeError::Length {
        allowed: dialect.max_block,
    };
    writer
        .put(&[reference, id.octet(), dialect.axis, parameters])
        .ok_or(too_long)?;
    for address in addresses {
        writer.put(&address.to_octets()).ok_or(too_long)?;
    }
    Ok(())
}
