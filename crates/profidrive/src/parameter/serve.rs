//! The parameter manager: request block in, response block out.

use super::address::{Attribute, HEADER, MAX_ELEMENTS, ParameterAddress, RequestId};
use super::block::{BlockWriter, ValueBlock};
use super::description::{Description, LENGTH as DESCRIPTION_LENGTH};
use super::dialect::{ChangeResponse, Dialect};
use super::error::{ErrorNames, ErrorNumber, ParameterError};
use super::format::{Format, Octets};
use super::request::Request;

/// Facts about one parameter that decide which requests for it are legal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attributes {
    /// Type of the value. Answers carry it, or the substitution code of its size where the dialect has only those.
    pub format: Format,
    /// Octets of one element; 1 for strings.
    pub octets: usize,
    /// Elements of an array (octets of a string), 0 for a simple parameter.
    pub elements: u16,
    /// False for a parameter that can only be read.
    pub writable: bool,
}

/// What the parameter manager needs of a drive. Values pass as plain numbers of one, two, four or eight octets, sign
/// extension is the drive's business.
pub trait ParameterAccess {
    /// Facts about the parameter, `None` if there is no such PNU.
    fn attributes(&self, pnu: u16) -> Option<Attributes>;

    /// Value of one element, in the low octets. Only called for elements that exist.
    ///
    /// # Errors
    /// An error number of the profile when the value cannot be read now.
    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber>;

    /// Changes one element. Only called for elements that exist, with a value of the right size.
    ///
    /// # Errors
    /// An error number of the profile when the value is not accepted.
    fn write(&mut self, pnu: u16, subindex: u16, raw: u64) -> Result<(), ErrorNumber>;

    /// Changes one element and keeps it over a power cycle (the PKW channel has requests of its own for that). Without
    /// another word of the drive it is an ordinary write.
    ///
    /// # Errors
    /// An error number of the profile when the value is not accepted.
    fn write_kept(&mut self, pnu: u16, subindex: u16, raw: u64) -> Result<(), ErrorNumber> {
        self.write(pnu, subindex, raw)
    }

    /// Changes a whole text (format VisibleString, [`Attributes::elements`] octets); `text` is not longer than that,
    /// blanks fill the rest. Without another word of the drive the octets are written one by one.
    ///
    /// # Errors
    /// An error number of the profile when an octet is not accepted; those before it are written.
    fn write_text(&mut self, pnu: u16, text: &[u8]) -> Result<(), ErrorNumber> {
        let elements = self
            .attributes(pnu)
            .ok_or(ErrorNumber::UNKNOWN_PARAMETER)?
            .elements;
        let octets = text.iter().chain(core::iter::repeat(&b' '));
        (0..elements)
            .zip(octets)
            .try_for_each(|(place, &octet)| self.write(pnu, place, octet.into()))
    }

    /// False while another interface holds the right to change parameters (error 0x0B).
    fn may_change(&self, pnu: u16) -> bool {
        let _ = pnu;
        true
    }

    /// Description block of the parameter, `None` if it has none (error 0x09).
    fn description(&self, pnu: u16) -> Option<Description> {
        let _ = pnu;
        None
    }

    /// Text number `index` of the parameter, `None` if there is none (error 0x0F).
    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        let _ = (pnu, index);
        None
    }
}

/// A request that gets no response block: the record write is refused instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Shorter than its own header says, or followed by something: refuse with ErrorCode1 0xB1.
    #[error("the length of the parameter request does not fit its header")]
    Length,
    /// Number of parameters not possible: refuse with ErrorCode1 0xB7.
    #[error("{found} parameters in one request, 1 to {allowed} are possible")]
    Parameters {
        /// Found in the header.
        found: u8,
        /// Limit of the dialect.
        allowed: u8,
    },
    /// The buffer for the response is smaller than the smallest answer.
    #[error("no room for the response")]
    Room,
}

/// Answers `request` from `drive`; writes the response block into `out` and gives its length. Nothing is allocated.
///
/// The response is never longer than the dialect's largest block: what does not fit is answered with 0x15. Order of the
/// checks (our choice, no public text tells one): request ID, number of parameters, axis; then for each parameter attribute, PNU,
/// elements and subindex, and for a change: rights, read-only, format, number of values, size, and what the drive
/// itself says (state, limits).
///
/// Elements of an array are written in order up to the first that is refused; the additional information of that error
/// is its subindex.
///
/// # Errors
/// When the block is not a request at all; the caller refuses the record write.
pub fn serve(
    request: &[u8],
    dialect: &Dialect,
    drive: &mut (impl ParameterAccess + ?Sized),
    out: &mut [u8],
) -> Result<usize, Refusal> {
    let &[reference, id, axis, parameters, ..] = request else {
        return Err(Refusal::Length);
    };
    let limit = out.len().min(dialect.max_block);
    let mut job = Job {
        dialect,
        out: BlockWriter::new(out.get_mut(..limit).unwrap_or_default()),
        failed: false,
    };
    if parameters == 0 || parameters > dialect.max_parameters {
        let allowed = dialect.max_parameters;
        let number = dialect.bad_count.ok_or(Refusal::Parameters {
            found: parameters,
            allowed,
        })?;
        return job.whole([reference, id | 0x80, axis, parameters], number);
    }
    let parsed = Request::parse(request, dialect.code_space).map_err(|_| Refusal::Length)?;
    if let Some(number) = dialect.bad_reference.filter(|_| reference == 0) {
        return job.whole([reference, id | 0x80, axis, parameters], number);
    }
    let id = match RequestId::from_octet(id) {
        RequestId::Other(_) => {
            let (response_id, number) = dialect.bad_request;
            return job.whole([reference, response_id, axis, parameters], number);
        }
        known => known,
    };
    if parsed.trailing() > 0 {
        return Err(Refusal::Length);
    }
    job.out
        .put(&[reference, id.octet(), axis, parameters])
        .ok_or(Refusal::Room)?;
    let axis_exists = !dialect.axis_checked || axis == dialect.axis;
    let mut left = usize::from(parameters);
    match id {
        RequestId::Change => {
            // An empty tail cannot be a change; one that lacks only some values gets error numbers.
            let mut values = parsed.values();
            for address in parsed.addresses() {
                left -= 1;
                let block = values.next().unwrap_or(Err(super::DecodeError {
                    wrong: super::Wrong::Values,
                    offset: request.len(),
                    expected: 2,
                    found: 0,
                }));
                let result = if axis_exists {
                    job.change(address, block, drive)
                } else {
                    Err(ErrorNumber::NO_AXIS.into())
                };
                match result {
                    Ok(()) => job.out.put(&[Format::ZERO.0, 0]).ok_or(Refusal::Room)?,
                    Err(error) => job.error(error, left)?,
                }
            }
        }
        _ => {
            for address in parsed.addresses() {
                left -= 1;
                let start = job.out.position();
                let result = if axis_exists {
                    job.read(address, left, drive)
                } else {
                    Err(ErrorNumber::NO_AXIS.into())
                };
                if let Err(error) = result {
                    job.out.truncate(start);
                    job.error(error, left)?;
                }
            }
        }
    }
    Ok(job.finish(id))
}

/// Octets of the shortest error block; reserved for every parameter that is still to be answered.
const ERROR_BLOCK: usize = 4;

struct Job<'a> {
    dialect: &'a Dialect,
    out: BlockWriter<'a>,
    failed: bool,
}

impl Job<'_> {
    /// A negative response that answers the request itself: every parameter gets the error, so that there are as many
    /// answers as the header says. A number of parameters that cannot be is mirrored with one answer.
    fn whole(mut self, header: [u8; HEADER], number: ErrorNumber) -> Result<usize, Refusal> {
        self.out.put(&header).ok_or(Refusal::Room)?;
        let [_, _, _, parameters] = header;
        let answers = match parameters {
            possible if possible <= self.dialect.max_parameters => possible.max(1),
            _ => 1,
        };
        for left in (0..answers).rev() {
            self.error(number.into(), left.into())?;
        }
        Ok(self.out.position())
    }

    fn error(&mut self, error: ParameterError, left: usize) -> Result<(), Refusal> {
        self.failed = true;
        let [high, low] = error.number.0.to_be_bytes();
        let fits = self.room(left) >= 6;
        match error.info.filter(|_| fits) {
            Some(info) => {
                let [info_high, info_low] = info.to_be_bytes();
                self.out
                    .put(&[Format::ERROR.0, 2, high, low, info_high, info_low])
            }
            None => self.out.put(&[Format::ERROR.0, 1, high, low]),
        }
        .ok_or(Refusal::Room)
    }

    /// Octets free for this answer when `left` more answers must find room for an error.
    fn room(&self, left: usize) -> usize {
        self.out.free().saturating_sub(ERROR_BLOCK * left)
    }

    /// Room for a value block of `data` octets, header and pad octet done.
    fn block(
        &mut self,
        format: Format,
        count: u8,
        data: usize,
        left: usize,
    ) -> Result<&mut [u8], ErrorNumber> {
        let whole = 2 + data + (data & 1);
        if whole > self.room(left) {
            return Err(ErrorNumber::TOO_LONG);
        }
        let room = self.out.reserve(whole).ok_or(ErrorNumber::TOO_LONG)?;
        let [block_format, block_count, values @ ..] = room else {
            return Err(ErrorNumber::TOO_LONG);
        };
        (*block_format, *block_count) = (format.0, count);
        values.get_mut(..data).ok_or(ErrorNumber::TOO_LONG)
    }

    fn read(
        &mut self,
        address: ParameterAddress,
        left: usize,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), ParameterError> {
        let ParameterAddress {
            attribute,
            elements,
            pnu,
            subindex,
        } = address;
        match attribute {
            Attribute::Value => {
                let facts = drive.attributes(pnu).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
                let count = checked_elements(&facts, elements, subindex)?;
                let octets = facts.octets;
                let data = self.block(
                    self.answer_format(&facts),
                    count,
                    octets * usize::from(count),
                    left,
                )?;
                for (values, index) in data.chunks_exact_mut(octets.max(1)).zip(subindex..) {
                    let raw = drive
                        .read(pnu, index)
                        .map_err(|number| at(number, index))?
                        .to_be_bytes();
                    for (place, octet) in values.iter_mut().rev().zip(raw.iter().rev()) {
                        *place = *octet;
                    }
                }
            }
            Attribute::Description => {
                drive.attributes(pnu).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
                let octets = drive
                    .description(pnu)
                    .ok_or(ErrorNumber::NO_DESCRIPTION)?
                    .encode();
                if elements > 1 && subindex != 0 {
                    return Err(ErrorNumber::ADDRESS.into());
                }
                let element = Description::element(subindex).ok_or(at(ErrorNumber::SUBINDEX, subindex))?;
                let element = octets.get(element).unwrap_or(&octets);
                let length = u8::try_from(element.len()).unwrap_or(DESCRIPTION_LENGTH);
                self.block(Format::OCTET_STRING, length, element.len(), left)?
                    .copy_from_slice(element);
            }
            Attribute::Text => {
                drive.attributes(pnu).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
                let count = elements.clamp(1, MAX_ELEMENTS / 16);
                if count < elements {
                    return Err(ErrorNumber::TOO_LONG.into());
                }
                let data = self.block(Format::VISIBLE_STRING, 16 * count, 16 * usize::from(count), left)?;
                let mut index = Some(subindex);
                for text in data.chunks_exact_mut(16) {
                    let found = index.and_then(|index| drive.text(pnu, index));
                    text.copy_from_slice(&found.ok_or(ErrorNumber::NO_TEXT)?);
                    index = index.and_then(|index| index.checked_add(1));
                }
            }
            Attribute::Other(_) => return Err(self.dialect.bad_attribute.into()),
        }
        Ok(())
    }

    fn answer_format(&self, facts: &Attributes) -> Format {
        if self.dialect.substitution_only {
            Format::for_octets(facts.octets).unwrap_or(facts.format)
        } else {
            facts.format
        }
    }

    fn change(
        &self,
        address: ParameterAddress,
        block: Result<ValueBlock<'_>, super::DecodeError>,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), ParameterError> {
        let ParameterAddress {
            attribute,
            elements,
            pnu,
            subindex,
        } = address;
        match attribute {
            Attribute::Value => {}
            Attribute::Description => return Err(ErrorNumber::DESCRIPTION_FIXED.into()),
            Attribute::Text => return Err(ErrorNumber::TEXT_FIXED.into()),
            Attribute::Other(_) => return Err(self.dialect.bad_attribute.into()),
        }
        let facts = drive.attributes(pnu).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        let count = checked_elements(&facts, elements, subindex)?;
        if !drive.may_change(pnu) {
            return Err(ErrorNumber::NO_RIGHTS.into());
        }
        if !facts.writable {
            return Err(at(ErrorNumber::NOT_CHANGEABLE, subindex));
        }
        let block = block.map_err(|error| match error.wrong {
            super::Wrong::Format => ErrorNumber::FORMAT,
            _ => self.dialect.too_short,
        })?;
        if matches!(block.format, Format::ZERO | Format::ERROR | Format::RESERVED) {
            return Err(ErrorNumber::FORMAT.into());
        }
        if block.count != count {
            return Err(ErrorNumber::VALUE_COUNT.into());
        }
        let substituted = matches!(block.format, Format::BYTE | Format::WORD | Format::DOUBLE_WORD);
        let same_kind = substituted
            || block.format == facts.format
            || block
                .format
                .info(self.dialect.code_space)
                .is_some_and(|info| matches!(info.octets, Octets::Fixed(_)));
        if block.width() != facts.octets || !same_kind {
            return Err(ErrorNumber::DATA_TYPE.into());
        }
        for index in 0..count {
            let element = subindex + u16::from(index);
            let raw = block.raw(usize::from(index)).ok_or(ErrorNumber::DATA_TYPE)?;
            drive
                .write(pnu, element, raw)
                .map_err(|number| at(number, element))?;
        }
        Ok(())
    }

    /// Puts the response ID in and cuts a positive change response to its form.
    fn finish(mut self, id: RequestId) -> usize {
        if self.failed {
            if let Some(response_id) = self.out.written().get_mut(1) {
                *response_id |= 0x80;
            }
        } else if id == RequestId::Change {
            self.out.truncate(HEADER);
            if self.dialect.change_response == ChangeResponse::HeaderAndZero {
                // There is room: the block of at least one parameter stood here.
                let _ = self.out.reserve(2);
            }
        }
        self.out.position()
    }
}

/// The number with the subindex as additional information, where the profile says so.
fn at(number: ErrorNumber, subindex: u16) -> ParameterError {
    let tells = number.info(ErrorNames::Profile).is_some_and(|info| info.subindex);
    ParameterError {
        number,
        info: (tells && subindex != 0).then_some(subindex),
    }
}

/// Number of elements really meant. Source: SINAMICS DCM p. 199, ABB RETA-02 p. 84, Vacon OPTEA p. 119; 0 elements of an array is the special function that
/// no client may send, it is refused like any impossible address.
fn checked_elements(facts: &Attributes, elements: u8, subindex: u16) -> Result<u8, ParameterError> {
    if facts.elements == 0 {
        return match (subindex, elements) {
            (0, 0 | 1) => Ok(1),
            (0, _) => Err(ErrorNumber::ADDRESS.into()),
            _ => Err(ErrorNumber::NO_ARRAY.into()),
        };
    }
    if elements == 0 || elements > MAX_ELEMENTS {
        return Err(ErrorNumber::ADDRESS.into());
    }
    if subindex >= facts.elements {
        return Err(at(ErrorNumber::SUBINDEX, subindex));
    }
    if u16::from(elements) > facts.elements - subindex {
        return Err(at(ErrorNumber::SUBINDEX, facts.elements));
    }
    Ok(elements)
}
