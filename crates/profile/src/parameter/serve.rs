//! The parameter manager: request block in, response block out.

use super::access::{Attributes, ParameterAccess};
use super::address::{Attribute, HEADER, MAX_ELEMENTS, ParameterAddress, RequestId};
use super::block::{BlockWriter, ValueBlock};
use super::description::{Description, LENGTH as DESCRIPTION_LENGTH};
use super::dialect::{ChangeResponse, Dialect};
use super::error::{ErrorNumber, ParameterError};
use super::format::{CodeSpace, Format, Kind};
use super::objection::{Denial, Forbidden};
use super::request::Request;
use super::span::{Span, at, check_description};
use super::{DecodeError, Wrong};

/// A request that gets no response block: the record write is refused instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Shorter than its own header indicates, or followed by something: refuse with ErrorCode1 0xB1.
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
/// checks (our choice, no public text states one): request ID, number of parameters, length, reference; then for each
/// parameter axis, attribute, PNU, elements and subindex, and for a change: rights, read-only, format, number of
/// values, size, and what the drive itself reports (state, limits).
///
/// Elements of an array are written in order up to the first that is refused; the additional information of that error
/// is its subindex.
///
/// A string (VisibleString, OctetString) is read and written as a whole at subindex 0 with 0 or 1 elements; any other
/// subindex and number of elements mean the octets from there on. In an array of strings each string is an element. A
/// value block of a string counts octets.
///
/// A change may carry an integer in another integer type of its length (our reading). A number that the type of the parameter
/// does not have is refused with 0x02: -1 as Integer16 is not 65535 of an Unsigned16.
///
/// Danfoss requests with double words (0x51, 0x52): values of one and two octets travel as Integer32 or Unsigned32, those
/// of four octets as they are, strings not at all (0x05). A number that does not fit is refused here too. No document names
/// the formats of these answers, so this is an interpretation.
///
/// # Errors
/// When the block is not a request at all; the caller refuses the record write.
pub fn serve(
    request: &[u8],
    dialect: &Dialect,
    drive: &mut (impl ParameterAccess + ?Sized),
    out: &mut [u8],
) -> Result<usize, Refusal> {
    serve_each(request, dialect, drive, out, |_, _, _| {})
}

/// Checks everything of a request but its parameters, in the order of [`serve`].
///
/// # Errors
/// What is not allowed, and the error number of the answer; `None` where the record write is refused.
pub(super) fn whole<'a>(
    request: &'a [u8],
    dialect: &Dialect,
) -> Result<Request<'a>, (Forbidden, Option<ErrorNumber>)> {
    let &[reference, id, axis, parameters, ..] = request else {
        return Err((Forbidden::Short, None));
    };
    let id = RequestId::from_octet(id);
    if !dialect.knows(id) {
        return Err((Forbidden::Request(id.octet()), Some(dialect.bad_request.1)));
    }
    if parameters == 0 || parameters > dialect.max_parameters {
        let what = Forbidden::Parameters {
            found: parameters,
            allowed: dialect.max_parameters,
        };
        return Err((what, dialect.bad_count));
    }
    let Ok(parsed) = Request::parse(request, dialect.code_space) else {
        return Err((Forbidden::Short, dialect.too_few_addresses));
    };
    if let Some(number) = dialect.bad_reference.filter(|_| reference == 0) {
        return Err((Forbidden::Reference, Some(number)));
    }
    let behind = if dialect.exact_length && id.is_change() {
        parsed.behind().len()
    } else {
        parsed.trailing()
    };
    if behind > 0 {
        let number = dialect.trailing.filter(|_| id.is_change());
        return Err((Forbidden::Trailing(behind), number));
    }
    if dialect.axis_checked && axis != dialect.axis {
        let allowed = dialect.axis;
        let what = Forbidden::Axis { found: axis, allowed };
        return Err((what, Some(dialect.bad_axis)));
    }
    Ok(parsed)
}

/// Answers a request; `after` is called behind each parameter with its place and how it was answered.
pub(super) fn serve_each<D: ParameterAccess + ?Sized>(
    request: &[u8],
    dialect: &Dialect,
    drive: &mut D,
    out: &mut [u8],
    mut after: impl FnMut(&mut D, u32, Result<(), Denial>),
) -> Result<usize, Refusal> {
    let &[reference, id, axis, parameters, ..] = request else {
        return Err(Refusal::Length);
    };
    let limit = out.len().min(dialect.max_block);
    let id = RequestId::from_octet(id);
    let mut job = Job {
        dialect,
        id,
        out: BlockWriter::new(out.get_mut(..limit).unwrap_or_default()),
        values: 0,
        failed: false,
    };
    let parsed = match whole(request, dialect) {
        Ok(parsed) => parsed,
        Err((Forbidden::Parameters { found, allowed }, None)) => {
            return Err(Refusal::Parameters { found, allowed });
        }
        Err((_, None)) => return Err(Refusal::Length),
        Err((what, Some(number))) => {
            let response_id = match what {
                Forbidden::Request(_) => dialect.bad_request.0,
                _ => id.response_octet() | 0x80,
            };
            return job.whole([reference, response_id, axis, parameters], number);
        }
    };
    job.out
        .put(&[reference, id.response_octet(), axis, parameters])
        .ok_or(Refusal::Room)?;
    // A change without any values gets error numbers like one that lacks some.
    let missing = DecodeError {
        wrong: Wrong::Values,
        offset: request.len(),
        expected: 2,
        found: 0,
    };
    let mut values = parsed.values();
    let mut left = usize::from(parameters);
    for (address, place) in parsed.addresses().zip(0..) {
        left -= 1;
        let start = job.out.position();
        let result = if id.is_change() {
            let block = values.next().unwrap_or(Err(missing));
            job.change(address, block, drive)
        } else {
            job.read(address, left, drive)
        };
        after(drive, place, result);
        if let Err(denial) = result {
            job.out.truncate(start);
            job.error(denial.error, left)?;
        }
    }
    Ok(job.finish())
}

/// Octets of the shortest error block; reserved for every parameter that is still to be answered.
const ERROR_BLOCK: usize = 4;

struct Job<'a> {
    dialect: &'a Dialect,
    id: RequestId,
    out: BlockWriter<'a>,
    /// Values so far, of all parameters. Wider than the limit: beside `failed`, half a register is slow to pass on.
    values: u32,
    failed: bool,
}

impl Job<'_> {
    /// A negative response that answers the request itself: every parameter gets the error, and where a block has no room
    /// for so many there is one answer. The header gives the number of answers.
    fn whole(mut self, header: [u8; HEADER], number: ErrorNumber) -> Result<usize, Refusal> {
        let [reference, response_id, axis, parameters] = header;
        let answers = match parameters {
            count if HEADER + ERROR_BLOCK * usize::from(count) <= self.dialect.max_block => count.max(1),
            _ => 1,
        };
        self.out
            .put(&[reference, response_id, axis, answers])
            .ok_or(Refusal::Room)?;
        for left in (0..answers).rev() {
            self.error(number.into(), left.into())?;
        }
        Ok(self.out.position())
    }

    fn error(&mut self, error: ParameterError, left: usize) -> Result<(), Refusal> {
        self.failed = true;
        let [high, low] = error.number.0.to_be_bytes();
        let has_info = self.dialect.error_info && self.room(left) >= 6;
        match error.info.filter(|_| has_info) {
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
    #[inline]
    fn block(&mut self, format: Format, count: u8, data: usize, left: usize) -> Result<&mut [u8], Denial> {
        let too_long = Forbidden::Long.refused(ErrorNumber::TOO_LONG);
        let whole = 2 + data + (data & 1);
        if whole > self.room(left) {
            return Err(too_long);
        }
        let room = self.out.reserve(whole).ok_or(too_long)?;
        let [block_format, block_count, values @ ..] = room else {
            return Err(too_long);
        };
        (*block_format, *block_count) = (format.0, count);
        values.get_mut(..data).ok_or(too_long)
    }

    fn read(
        &mut self,
        address: ParameterAddress,
        left: usize,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), Denial> {
        let ParameterAddress {
            attribute,
            elements,
            pnu,
            subindex,
        } = address;
        match attribute {
            Attribute::Value => {
                let facts = self.facts(pnu, subindex, drive)?;
                let span = Span::of(&facts, elements, subindex)?;
                self.count(span.count, ErrorNumber::TOO_LONG)?;
                let form = self.form(&facts)?;
                let data = self.block(
                    form.format,
                    span.count,
                    form.octets * usize::from(span.count),
                    left,
                )?;
                for (values, index) in data
                    .chunks_exact_mut(form.octets.max(1))
                    .zip(span.first..=u16::MAX)
                {
                    let raw = drive
                        .read(pnu, index)
                        .map_err(|number| Denial::from(at(number, index)))
                        .map(|raw| {
                            if form.signed {
                                extended(raw, facts.octets)
                            } else {
                                raw
                            }
                        })?
                        .to_be_bytes();
                    for (place, octet) in values.iter_mut().rev().zip(raw.iter().rev()) {
                        *place = *octet;
                    }
                }
            }
            Attribute::Description => {
                let mut description = match drive.description(pnu) {
                    Some(description) => description,
                    None if drive.exists(pnu) => {
                        return Err(Forbidden::NoDescription.refused(ErrorNumber::NO_DESCRIPTION));
                    }
                    None => return Err(Forbidden::unknown(pnu).refused(ErrorNumber::UNKNOWN_PARAMETER)),
                };
                description.identifier = description.identifier.in_space(self.dialect.code_space);
                let octets = description.encode();
                if let Some(facts) = drive.attributes(pnu, 0) {
                    check_description(&facts, elements, subindex)?;
                }
                let element = Description::element(subindex).ok_or(
                    Forbidden::DescriptionElement(subindex).refused(at(ErrorNumber::SUBINDEX, subindex)),
                )?;
                let element = octets.get(element).unwrap_or(&octets);
                let length = u8::try_from(element.len()).unwrap_or(DESCRIPTION_LENGTH);
                self.block(Format::OCTET_STRING, length, element.len(), left)?
                    .copy_from_slice(element);
            }
            Attribute::Text => {
                if !drive.exists(pnu) {
                    return Err(Forbidden::unknown(pnu).refused(ErrorNumber::UNKNOWN_PARAMETER));
                }
                if !self.dialect.texts {
                    return Err(Forbidden::Texts.refused(ErrorNumber::NO_TEXT));
                }
                let count = elements.clamp(1, MAX_ELEMENTS / 16);
                if count < elements {
                    return Err(Forbidden::Long.refused(ErrorNumber::TOO_LONG));
                }
                let data = self.block(Format::VISIBLE_STRING, 16 * count, 16 * usize::from(count), left)?;
                let missing = Forbidden::NoText {
                    elements: count,
                    subindex,
                };
                let mut index = Some(subindex);
                for text in data.chunks_exact_mut(16) {
                    let found = index.and_then(|index| drive.text(pnu, index));
                    text.copy_from_slice(&found.ok_or(missing.refused(ErrorNumber::NO_TEXT))?);
                    index = index.and_then(|index| index.checked_add(1));
                }
            }
            Attribute::Other(code) => {
                return Err(Forbidden::Attribute(code).refused(self.dialect.bad_attribute));
            }
        }
        Ok(())
    }

    fn facts(
        &self,
        pnu: u16,
        subindex: u16,
        drive: &(impl ParameterAccess + ?Sized),
    ) -> Result<Attributes, Denial> {
        let none = || match drive.exists(pnu) {
            true => at(self.dialect.bad_member, subindex),
            false => ErrorNumber::UNKNOWN_PARAMETER.into(),
        };
        let facts = drive.attributes(pnu, subindex);
        facts.ok_or_else(|| Forbidden::unknown(pnu).refused(none()))
    }

    /// Counts values against the limit of all parameters together.
    fn count(&mut self, values: u8, number: ErrorNumber) -> Result<(), Denial> {
        let sum = self.values.saturating_add(values.into());
        if sum > self.dialect.served_values.into() {
            return Err(Forbidden::Long.refused(number));
        }
        self.values = sum;
        Ok(())
    }

    /// Returns the format in which values of a parameter are sent.
    #[inline]
    fn form(&self, facts: &Attributes) -> Result<Form, Denial> {
        let narrow = Forbidden::NoDoubleWord.refused(ErrorNumber::DATA_TYPE);
        let own = Form {
            format: facts.format.in_space(self.dialect.code_space),
            octets: facts.octets,
            signed: false,
        };
        Ok(match (self.id.is_wide(), facts.octets) {
            (true, _) if facts.is_string() => return Err(narrow),
            (true, 1 | 2) => {
                let signed = is_signed(facts);
                Form {
                    format: if signed {
                        Format::INTEGER32
                    } else {
                        Format::UNSIGNED32
                    },
                    octets: 4,
                    signed,
                }
            }
            (true, 4) => own,
            (true, _) => return Err(narrow),
            (false, octets) if self.dialect.substitution_only && !facts.is_string() => Form {
                format: Format::for_octets(octets).unwrap_or(own.format),
                ..own
            },
            (false, _) => own,
        })
    }

    fn change(
        &mut self,
        address: ParameterAddress,
        block: Result<ValueBlock<'_>, DecodeError>,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), Denial> {
        let ParameterAddress {
            attribute,
            elements,
            pnu,
            subindex,
        } = address;
        match attribute {
            Attribute::Value => {}
            Attribute::Description => {
                return Err(Forbidden::DescriptionChange.refused(ErrorNumber::DESCRIPTION_FIXED));
            }
            Attribute::Text => return Err(Forbidden::TextChange.refused(ErrorNumber::TEXT_FIXED)),
            Attribute::Other(code) => {
                return Err(Forbidden::Attribute(code).refused(self.dialect.bad_attribute));
            }
        }
        let facts = self.facts(pnu, subindex, drive)?;
        let span = Span::of(&facts, elements, subindex)?;
        if !drive.may_change(pnu) {
            return Err(ErrorNumber::NO_RIGHTS.into());
        }
        if !facts.writable {
            return Err(Forbidden::ReadOnly.refused(at(ErrorNumber::NOT_CHANGEABLE, subindex)));
        }
        let no_format = |code: u8| Forbidden::Format(code).refused(ErrorNumber::FORMAT);
        let block = block.map_err(|error| match error.wrong {
            Wrong::Format => no_format(u8::try_from(error.found).unwrap_or_default()),
            _ => Forbidden::Short.refused(self.dialect.too_short),
        })?;
        if matches!(block.format, Format::ZERO | Format::ERROR | Format::RESERVED) {
            return Err(no_format(block.format.0));
        }
        if block.count != span.count {
            let (found, expected) = (block.count, span.count.into());
            return Err(Forbidden::Values { found, expected }.refused(ErrorNumber::VALUE_COUNT));
        }
        self.count(span.count, self.dialect.too_many_values)?;
        let form = self.form(&facts)?;
        let space = self.dialect.code_space;
        let own = facts.format.in_space(space);
        let carries = [own, form.format]
            .iter()
            .any(|&own| block.format.carries(own, space));
        if block.width() != form.octets || !carries {
            return Err(Forbidden::Type(block.format.0).refused(ErrorNumber::DATA_TYPE));
        }
        let keep = self.id.keep();
        if let Some(length) = span.whole {
            let texts = block.data.chunks_exact(usize::from(length).max(1));
            for (text, first) in texts.zip((span.first..=u16::MAX).step_by(usize::from(length).max(1))) {
                drive.write_text(pnu, first, text, keep)?;
            }
        } else {
            for (index, element) in (0..usize::from(span.count)).zip(span.first..=u16::MAX) {
                let raw = fitted(&block, index, &facts, space)
                    .map_err(|number| Forbidden::Range.refused(at(number, element)))?;
                drive
                    .write(pnu, element, raw, keep)
                    .map_err(|number| at(self.known(number), element))?;
            }
        }
        self.out.put(&[Format::ZERO.0, 0]).ok_or(ErrorNumber::TOO_LONG)?;
        Ok(())
    }

    /// Returns a number of the vendor's older channel (PKW) that this one does not have: not now.
    fn known(&self, number: ErrorNumber) -> ErrorNumber {
        let own = number.0 >= ErrorNumber::FIRST_OWN;
        if own && number.info(self.dialect.error_names).is_none() {
            ErrorNumber::NOT_NOW
        } else {
            number
        }
    }

    /// Puts the response ID in and cuts a positive change response to its form.
    fn finish(mut self) -> usize {
        if self.failed {
            if let Some(response_id) = self.out.written().get_mut(1) {
                *response_id |= 0x80;
            }
        } else if self.id.is_change() {
            self.out.truncate(HEADER);
            if self.dialect.change_response == ChangeResponse::HeaderAndZero {
                // There is room: the block of at least one parameter stood here.
                let _ = self.out.reserve(2);
            }
        }
        self.out.position()
    }
}

/// How values of a parameter are sent: type in the code space of the dialect, octets of one, and whether the sign of the
/// drive's own number is extended to them.
#[derive(Debug, Clone, Copy)]
struct Form {
    format: Format,
    octets: usize,
    signed: bool,
}

fn is_signed(facts: &Attributes) -> bool {
    facts
        .format
        .info(CodeSpace::V4)
        .is_some_and(|info| info.kind == Kind::Signed)
}

/// Returns a number of one or two octets with its sign in all of them.
fn extended(raw: u64, octets: usize) -> u64 {
    match octets {
        1 => i64::from(raw as i8).cast_unsigned(),
        2 => i64::from(raw as i16).cast_unsigned(),
        _ => raw,
    }
}

/// Value `index` of `block` in the octets of the parameter, where it fits. Between two whole numbers the number counts, so
/// that -1 never becomes 65535. Where one of them is none (bits, Byte, Word, Double word), the octets count; four octets for
/// a shorter parameter are then a number with the sign of its type.
fn fitted(
    block: &ValueBlock<'_>,
    index: usize,
    facts: &Attributes,
    space: CodeSpace,
) -> Result<u64, ErrorNumber> {
    let (Some(raw), Some(signed)) = (block.raw(index), block.signed(index)) else {
        return Err(ErrorNumber::DATA_TYPE);
    };
    let sent = block.format.number_is_signed(space);
    let own = facts.format.number_is_signed(CodeSpace::V4);
    if block.width() == facts.octets && (sent.is_none() || own.is_none()) {
        return Ok(raw);
    }
    let number = if sent.unwrap_or(is_signed(facts)) {
        i128::from(signed)
    } else {
        i128::from(raw)
    };
    let range = 1_i128 << (8 * facts.octets);
    let allowed = if is_signed(facts) {
        -range / 2..range / 2
    } else {
        0..range
    };
    if !allowed.contains(&number) {
        return Err(ErrorNumber::LIMIT);
    }
    u64::try_from(number & (range - 1)).map_err(|_| ErrorNumber::LIMIT)
}
