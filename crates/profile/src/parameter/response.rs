//! Responses as a client reads them.

use super::address::{ADDRESS, Attribute, DecodeError, HEADER, ParameterAddress, RequestId, Wrong};
use super::block::ValueBlock;
use super::dialect::Dialect;
use super::error::{ErrorNumber, ParameterError};
use super::format::{CodeSpace, Format, Octets};

/// The answer to one parameter of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer<'a> {
    /// What was requested.
    Values(ValueBlock<'a>),
    /// The value was changed.
    Written,
    /// Refused.
    Error(ParameterError),
}

/// A response that does not answer the request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ResponseError {
    /// The block cannot be taken apart.
    #[error("malformed parameter response: {0}")]
    Malformed(#[from] DecodeError),
    /// The answer to another request: keep waiting.
    #[error("the response answers request {found}, not {expected}")]
    Reference {
        /// Reference that was sent.
        expected: u8,
        /// Reference that came back.
        found: u8,
    },
    /// Not one of those that answer the request ([`RequestId::is_answered_by`]).
    #[error("response ID 0x{found:02X} does not answer a request with ID 0x{request:02X}")]
    Id {
        /// ID of the request.
        request: u8,
        /// ID of the response.
        found: u8,
    },
    /// The drive refuses the request as a whole.
    #[error("the drive refuses the whole request: {0}")]
    Refused(ParameterError),
    /// The answer comes from another axis.
    #[error("the response comes from axis {found}, asked was axis {expected}")]
    Axis {
        /// Axis of the request.
        expected: u8,
        /// Axis that answered.
        found: u8,
    },
    /// Number of values of a parameter differs from the number of requested elements.
    #[error("PNU {pnu} was answered with {found} values, asked were {expected}")]
    Values {
        /// The parameter.
        pnu: u16,
        /// Requested elements.
        expected: u8,
        /// Values answered.
        found: u8,
    },
    /// Number of parameters differs from the request.
    #[error("the response has {found} parameters, asked were {expected}")]
    Parameters {
        /// Requested parameters.
        expected: usize,
        /// Parameters answered.
        found: usize,
    },
}

/// A checked view over a response block.
///
/// Takes what drives really send: the positive change response of four octets and the AKD's of six, blocks without a
/// last pad octet, and a read response that repeats the parameter address before the value (AKD parameter access note).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Response<'a> {
    bytes: &'a [u8],
    offset: usize,
    parameters: usize,
    written: bool,
    change: bool,
    space: CodeSpace,
}

impl<'a> Response<'a> {
    /// Checks `bytes` against the request that was sent.
    ///
    /// # Errors
    /// When it does not answer that request, or cannot be taken apart to its last octet.
    pub fn parse(
        bytes: &'a [u8],
        id: RequestId,
        reference: u8,
        addresses: &[ParameterAddress],
        dialect: &Dialect,
    ) -> Result<Self, ResponseError> {
        let &[found_reference, found_id, axis, parameters, ref rest @ ..] = bytes else {
            let found = bytes.len();
            return Err(DecodeError {
                wrong: Wrong::Header,
                offset: 0,
                expected: HEADER,
                found,
            }
            .into());
        };
        if found_reference != reference {
            return Err(ResponseError::Reference {
                expected: reference,
                found: found_reference,
            });
        }
        if found_id & 0x80 != 0
            && let Some(error) = Self::whole_refusal(bytes, found_id, id, addresses.len(), dialect)
        {
            return Err(ResponseError::Refused(error));
        }
        if !id.is_answered_by(found_id) {
            return Err(ResponseError::Id {
                request: id.octet(),
                found: found_id,
            });
        }
        if axis != dialect.axis {
            return Err(ResponseError::Axis {
                expected: dialect.axis,
                found: axis,
            });
        }
        if usize::from(parameters) != addresses.len() {
            return Err(ResponseError::Parameters {
                expected: addresses.len(),
                found: usize::from(parameters),
            });
        }
        let space = dialect.code_space;
        let mut response = Self {
            bytes,
            offset: HEADER,
            parameters: addresses.len(),
            written: false,
            change: id.is_change(),
            space,
        };
        if response.change && found_id & 0x80 == 0 && matches!(rest, [] | [0, 0]) {
            response.written = true;
            return Ok(response);
        }
        let plain = response.check();
        if plain.is_err() && repeats_addresses(bytes, addresses) {
            response.offset = HEADER + ADDRESS * addresses.len();
            response.check()?;
        } else {
            plain?;
        }
        if !response.change {
            response.check_counts(addresses)?;
        }
        Ok(response)
    }

    /// Returns a negative response that answers the request itself instead of its parameters: one error block for
    /// several of them, a response ID of no request (Vacon: 0x80), or that of another kind to a request which only some
    /// drives know.
    fn whole_refusal(
        bytes: &[u8],
        found_id: u8,
        id: RequestId,
        parameters: usize,
        dialect: &Dialect,
    ) -> Option<ParameterError> {
        let (block, used) = ValueBlock::parse(bytes, HEADER, dialect.code_space).ok()?;
        let single = HEADER + used == bytes.len();
        let whole = (single && parameters != 1) || !id.is_answered_by(found_id);
        let is_request_id = matches!(RequestId::from_octet(found_id & 0x7F), RequestId::Other(_))
            || !matches!(id, RequestId::Read | RequestId::Change);
        (block.format == Format::ERROR && whole && (single || is_request_id)).then(|| error_of(&block))
    }

    fn check(&self) -> Result<(), DecodeError> {
        let mut offset = self.offset;
        for _ in 0..self.parameters {
            offset += ValueBlock::parse(self.bytes, offset, self.space)?.1;
        }
        match self.bytes.len() - offset {
            0 => Ok(()),
            found => Err(DecodeError {
                wrong: Wrong::Trailing,
                offset,
                expected: 0,
                found,
            }),
        }
    }

    /// Every value that was read has as many elements as were requested. Strings may be of any length, descriptions and
    /// texts have their own.
    fn check_counts(&self, addresses: &[ParameterAddress]) -> Result<(), ResponseError> {
        for (answer, address) in self.answers().zip(addresses) {
            let Answer::Values(block) = answer else { continue };
            let info = block.format.info(self.space);
            let is_string = info.is_some_and(|info| info.octets == Octets::Counted);
            let expected = address.elements.max(1);
            if address.attribute == Attribute::Value && !is_string && block.count != expected {
                return Err(ResponseError::Values {
                    pnu: address.pnu,
                    expected,
                    found: block.count,
                });
            }
        }
        Ok(())
    }

    /// Returns true when at least one parameter was refused.
    #[must_use]
    pub fn is_negative(&self) -> bool {
        self.bytes.get(1).is_some_and(|id| id & 0x80 != 0)
    }

    /// Returns the answers in the order of the request.
    #[must_use]
    pub fn answers(&self) -> Answers<'a> {
        Answers {
            response: *self,
            offset: self.offset,
            left: self.parameters,
        }
    }
}

/// Returns true when the octets behind the header of a response are the addresses of its request. The values follow
/// them then.
///
/// ```
/// use profidrive_profile::parameter::{ParameterAddress, repeats_addresses};
/// let response = [5, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
/// assert!(repeats_addresses(&response, &[ParameterAddress::value(930, 0)]));
/// assert!(!repeats_addresses(&response, &[ParameterAddress::value(947, 0)]));
/// ```
#[must_use]
pub fn repeats_addresses(response: &[u8], addresses: &[ParameterAddress]) -> bool {
    let sent = addresses.iter().flat_map(|address| address.to_octets());
    let found = response.get(HEADER..).unwrap_or(&[]);
    found.len() >= ADDRESS * addresses.len() && sent.eq(found.iter().copied().take(ADDRESS * addresses.len()))
}

fn error_of(block: &ValueBlock<'_>) -> ParameterError {
    let word = |index| block.raw(index).and_then(|raw| u16::try_from(raw).ok());
    ParameterError {
        number: ErrorNumber(word(0).unwrap_or(0x12)),
        info: word(1),
    }
}

/// Iterator over the answers of a [`Response`].
#[derive(Debug, Clone)]
pub struct Answers<'a> {
    response: Response<'a>,
    offset: usize,
    left: usize,
}

impl<'a> Iterator for Answers<'a> {
    type Item = Answer<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        if self.response.written {
            return Some(Answer::Written);
        }
        let (block, used) = ValueBlock::parse(self.response.bytes, self.offset, self.response.space).ok()?;
        self.offset += used;
        Some(match block.format {
            Format::ERROR => Answer::Error(error_of(&block)),
            Format::ZERO | Format::RESERVED if self.response.change && block.count == 0 => Answer::Written,
            _ => Answer::Values(block),
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Answers<'_> {}
