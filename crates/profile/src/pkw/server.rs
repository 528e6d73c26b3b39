//! The slave side: a request stands in the channel until its reply is there.

use super::code::{Action, Memory, ReplyCode, RequestInfo, Width};
use super::dialect::{PkwDialect, PlainArray};
use super::error::PkwErrorNumber;
use super::words::{MAX_BLOCK, PKW_LEN, Pkw, PkwAddress, TEXT_AT, TEXT_WRITE};
use crate::parameter::{
    Attributes, CodeSpace, Description, ErrorNumber, Format, Keep, Kind, Octets, ParameterAccess, SaveId,
    SaveState,
};

/// A block that is not a request of the channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BlockError {
    /// Neither the eight octets of PKE, IND and PWE, nor six with a PWE of one word, nor a text block.
    #[error("a parameter block of {0} octets, 8, 6 or a text block (AK 15) of 4 to {MAX_BLOCK} are possible")]
    Length(usize),
    /// The buffer for the reply is shorter than eight octets.
    #[error("no room for the reply")]
    Room,
}

/// Result of a change. The change is executed once; its result is repeated while the request stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Done {
    Changed,
    /// Changed; acknowledged when the save has ended.
    Saving(SaveId),
    Refused(Refusal),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refusal {
    Number(PkwErrorNumber),
    Rights,
}

/// The parameter channel of a drive. Called with the present request in every cycle, or with each telegram.
///
/// * A request is new when PKE, IND, PWE or the text differ from the ones before. A change is executed once, when it is
///   new; to repeat it the master puts AK 0 between. At a serial line a refused one is new with the next telegram
///   ([`clear_refusal`](Self::clear_refusal)).
/// * Reads, and the value in the reply to a change, are fetched from the drive in every call: a reply that stands
///   shows the present value.
/// * AK 0 is answered with the zero telegram. So is a change whose value the drive has not stored yet: no reply (AK 0).
/// * A value of one or two octets travels as a word, of four as a double word. One octet is widened to a word by the
///   sign of its type; PWE high of a word reply is 0, also when the value is negative, and is ignored in a request.
///
/// Source: Parker Compax3 p. 358, Danfoss FCM 300 p. 18-30, Kollmorgen S300 PROFIBUS p. 46, Lenze E82ZAFPC p. 66.
///
/// ```
/// use profidrive_profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};
/// use profidrive_profile::pkw::{PkwDialect, Server};
///
/// struct OneWord(u64);
/// impl ParameterAccess for OneWord {
///     fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
///         (pnu == 930).then_some(Attributes::simple(Format::UNSIGNED16, 2, true))
///     }
///     fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
///         Ok(self.0)
///     }
///     fn write(&mut self, _: u16, _: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
///         self.0 = raw;
///         Ok(())
///     }
/// }
///
/// let mut drive = OneWord(1);
/// let mut server = Server::new(PkwDialect::STANDARD);
/// let read = [0x13, 0xA2, 0, 0, 0, 0, 0, 0];
/// assert_eq!(server.handle(read, &mut drive), [0x13, 0xA2, 0, 0, 0, 0, 0, 1]);
/// drive.0 = 2; // the request still stands: the reply follows the value
/// assert_eq!(server.handle(read, &mut drive), [0x13, 0xA2, 0, 0, 0, 0, 0, 2]);
/// ```
#[derive(Debug, Clone)]
pub struct Server {
    dialect: PkwDialect,
    standing: [u8; MAX_BLOCK],
    length: usize,
    done: Option<Done>,
    /// The block in hand has one word of PWE only.
    narrow: bool,
    /// Every request is refused with this number.
    refused: Option<PkwErrorNumber>,
}

impl Server {
    /// Creates a channel at rest.
    #[must_use]
    pub const fn new(dialect: PkwDialect) -> Self {
        Self {
            dialect,
            standing: [0; MAX_BLOCK],
            length: 0,
            done: None,
            narrow: false,
            refused: None,
        }
    }

    /// Returns the facts it answers by.
    #[must_use]
    pub const fn dialect(&self) -> &PkwDialect {
        &self.dialect
    }

    /// Discards the standing request: the next request is new. For a new connection.
    pub fn reset(&mut self) {
        self.length = 0;
        self.done = None;
    }

    /// Refuses every request with this number and does nothing, until it is called with `None`: an error of the drive that
    /// a client is to be tested with. A change that was carried out already keeps its reply; a refused request that still
    /// stands stays refused.
    pub const fn refuse_all(&mut self, number: Option<PkwErrorNumber>) {
        self.refused = number;
    }

    /// Clears the refusal of the standing request, so that the same request is tried again: each telegram of a serial
    /// line is a request of its own. A change that was carried out or is being saved is not repeated, as the master may
    /// have lost the reply.
    pub fn clear_refusal(&mut self) {
        self.done = self.done.filter(|done| !matches!(done, Done::Refused(_)));
    }

    /// Answers the eight octets of a cyclic channel. Text has no room there and is refused with 13.
    pub fn handle(
        &mut self,
        request: [u8; PKW_LEN],
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> [u8; PKW_LEN] {
        let mut out = [0; PKW_LEN];
        // eight octets are always a block and always have room
        let _ = self.handle_block(&request, drive, &mut out);
        out
    }

    /// Answers a parameter block of a serial telegram, which is eight octets, or longer or shorter with text (AK 15);
    /// writes the reply into `out` and gives its length. Nothing is allocated. A block of six octets has one word of
    /// PWE (USS with three words of parameter part) and is answered alike; a double word does not fit it.
    ///
    /// # Errors
    /// When the block cannot be a request; a slave leaves such a telegram unanswered.
    pub fn handle_block(
        &mut self,
        request: &[u8],
        drive: &mut (impl ParameterAccess + ?Sized),
        out: &mut [u8],
    ) -> Result<usize, BlockError> {
        let (pkw, text) = parse(request)?;
        if out.len() < PKW_LEN {
            return Err(BlockError::Room);
        }
        if self.standing.get(..self.length) != Some(request) {
            self.done = None;
            self.length = request.len();
            if let Some(standing) = self.standing.get_mut(..request.len()) {
                standing.copy_from_slice(request);
            }
        }
        let info = pkw.request_code().info();
        self.narrow = request.len() == NARROW_LEN && info.action != Action::Text;
        let reply = match self.answer(pkw, info, text, drive, out) {
            Ok(Reply::Words(code, pwe)) => pkw.mirrored(&self.dialect, code, pwe),
            Ok(Reply::Nothing) => Pkw::ZERO,
            Ok(Reply::Text(length)) => {
                let head = pkw.mirrored(&self.dialect, ReplyCode::TEXT, 0).to_octets();
                copy(out, &head, TEXT_AT);
                return Ok(TEXT_AT + length);
            }
            Err(Refusal::Rights) => pkw.mirrored(&self.dialect, ReplyCode::NO_RIGHTS, 0),
            Err(Refusal::Number(number)) => pkw.mirrored(&self.dialect, ReplyCode::REFUSED, number.0.into()),
        };
        let octets = reply.to_octets();
        if self.narrow {
            let [a, b, c, d, _, _, g, h] = octets;
            copy(out, &[a, b, c, d, g, h], NARROW_LEN);
            return Ok(NARROW_LEN);
        }
        copy(out, &octets, PKW_LEN);
        Ok(PKW_LEN)
    }

    fn answer(
        &mut self,
        pkw: Pkw,
        info: &RequestInfo,
        text: &[u8],
        drive: &mut (impl ParameterAccess + ?Sized),
        out: &mut [u8],
    ) -> Result<Reply, Refusal> {
        if info.action == Action::Nothing {
            return Ok(Reply::Nothing);
        }
        let refused = self.refused.map(|number| Done::Refused(Refusal::Number(number)));
        self.done = self.done.or(refused);
        if let Some(Done::Refused(refusal)) = self.done {
            return Err(refusal);
        }
        if !pkw.is_request_of(&self.dialect) {
            return Err(Refusal::Number(self.dialect.unknown_request));
        }
        let address = pkw
            .address(&self.dialect)
            .ok_or(Refusal::Number(PkwErrorNumber::UNKNOWN_PARAMETER))?;
        let facts = drive
            .attributes(address.pnu, address.subindex.into())
            .ok_or(Refusal::Number(PkwErrorNumber::UNKNOWN_PARAMETER))?;
        match info.action {
            Action::Nothing => Ok(Reply::Nothing),
            Action::Read => {
                let width = self.width(&facts)?;
                self.check_element(&facts, address, info.array)?;
                self.value(address, &facts, width, info.array, drive)
            }
            Action::Change => {
                let Some(width) = info.width else {
                    return Err(Refusal::Number(self.dialect.unknown_request));
                };
                let done = match self.done {
                    Some(done) => done,
                    None => self.done(drive, |server, drive| {
                        server.change(pkw, info, address, &facts, drive)
                    }),
                };
                match self.stored(done, drive) {
                    Done::Refused(refusal) => Err(refusal),
                    Done::Saving(_) => Ok(Reply::Nothing),
                    // what can be written and not read shows what was written
                    Done::Changed => self
                        .value(address, &facts, width, info.array, drive)
                        .or(Ok(Reply::Words(code(width, info.array), pkw.value(width)))),
                }
            }
            Action::ReadDescription => self.description(address, drive),
            Action::ChangeDescription => {
                self.check_rights(address, drive)?;
                self.description(address, drive)?;
                Err(Refusal::Number(PkwErrorNumber::DESCRIPTION_FIXED))
            }
            Action::CountElements if facts.elements == 0 => Err(Refusal::Number(PkwErrorNumber::NO_ARRAY)),
            Action::CountElements => Ok(Reply::Words(ReplyCode::ELEMENTS, facts.elements.into())),
            Action::Text => self.text(address, &facts, text, drive, out),
            Action::Reserved => Err(Refusal::Number(self.dialect.unknown_request)),
        }
    }

    /// Carries out a change, which is new.
    fn done<D: ParameterAccess + ?Sized>(
        &self,
        drive: &mut D,
        change: impl FnOnce(&Self, &mut D) -> Result<(), Refusal>,
    ) -> Done {
        // saves of other channels are theirs to wait for
        let _ = drive.started_save();
        match (change(self, drive), drive.started_save()) {
            (Err(refusal), _) => Done::Refused(refusal),
            (Ok(()), Some(save)) => Done::Saving(save),
            (Ok(()), None) => Done::Changed,
        }
    }

    /// Keeps what came of the standing change, which a save that has ended completes.
    fn stored(&mut self, done: Done, drive: &mut (impl ParameterAccess + ?Sized)) -> Done {
        let done = match done {
            Done::Saving(save) => match drive.save_state(save) {
                SaveState::Pending => done,
                SaveState::Stored => Done::Changed,
                SaveState::Failed => Done::Refused(self.refusal(ErrorNumber::NOT_NOW)),
            },
            done => done,
        };
        self.done = Some(done);
        done
    }

    fn check_rights(
        &self,
        address: PkwAddress,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), Refusal> {
        if drive.may_change(address.pnu) {
            Ok(())
        } else if self.dialect.replies_with(ReplyCode::NO_RIGHTS) {
            Err(Refusal::Rights)
        } else {
            Err(Refusal::Number(PkwErrorNumber::NO_RIGHTS))
        }
    }

    fn check_element(&self, facts: &Attributes, address: PkwAddress, array: bool) -> Result<(), Refusal> {
        let number = match (facts.elements, array, self.dialect.plain_array) {
            (0, true, _) => PkwErrorNumber::NO_ARRAY,
            (0, false, _) if address.subindex == 0 => return Ok(()),
            (0, false, _) => PkwErrorNumber::NO_ARRAY,
            (1.., false, PlainArray::Refused(number)) => number,
            (elements, _, _) if u16::from(address.subindex) < elements => return Ok(()),
            _ => PkwErrorNumber::SUBINDEX,
        };
        Err(Refusal::Number(number))
    }

    /// Returns the width of a value of the parameter in PWE.
    fn width(&self, facts: &Attributes) -> Result<Width, Refusal> {
        if counted(facts.format) {
            // a text is not a value of the channel: it has a request of its own, where there is one
            return Err(Refusal::Number(PkwErrorNumber::DATA_TYPE));
        }
        match facts.octets {
            1 | 2 => Ok(Width::Word),
            4 if !self.narrow => Ok(Width::DoubleWord),
            _ => Err(Refusal::Number(self.dialect.too_wide)),
        }
    }

    fn value(
        &self,
        address: PkwAddress,
        facts: &Attributes,
        width: Width,
        array: bool,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<Reply, Refusal> {
        let raw = drive
            .read(address.pnu, address.subindex.into())
            .map_err(|number| self.refusal(number))?;
        let [.., high, low] = raw.to_be_bytes();
        let pwe = match (width, facts.octets) {
            (Width::Word, 1) if signed(facts.format) => {
                let [_, low] = i16::from(low.cast_signed()).to_be_bytes();
                let extension = if low.cast_signed() < 0 { 0xFF } else { 0 };
                u32::from(u16::from_be_bytes([extension, low]))
            }
            (Width::Word, 1) => low.into(),
            (Width::Word, _) => u16::from_be_bytes([high, low]).into(),
            (Width::DoubleWord, _) => {
                let [_, _, _, _, quad @ ..] = raw.to_be_bytes();
                u32::from_be_bytes(quad)
            }
        };
        Ok(Reply::Words(code(width, array), pwe))
    }

    fn change(
        &self,
        pkw: Pkw,
        info: &RequestInfo,
        address: PkwAddress,
        facts: &Attributes,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), Refusal> {
        self.check_rights(address, drive)?;
        self.check_element(facts, address, info.array)?;
        if !facts.writable {
            return Err(Refusal::Number(PkwErrorNumber::NOT_CHANGEABLE));
        }
        let width = self.width(facts)?;
        if info.width != Some(width) {
            return Err(Refusal::Number(PkwErrorNumber::DATA_TYPE));
        }
        let mut raw = u64::from(pkw.value(width));
        if facts.octets == 1 {
            raw = octet(pkw.pwe_low(), signed(facts.format))
                .ok_or(Refusal::Number(PkwErrorNumber::LIMIT))?
                .into();
        }
        let subindex = address.subindex.into();
        let keep = match info.memory {
            Some(Memory::Eeprom) => Keep::Permanent,
            _ => Keep::Volatile,
        };
        drive
            .write(address.pnu, subindex, raw, keep)
            .map_err(|number| self.refusal(number))
    }

    fn description(
        &self,
        address: PkwAddress,
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<Reply, Refusal> {
        let description = drive
            .description(address.pnu)
            .ok_or(Refusal::Number(PkwErrorNumber::NO_DESCRIPTION))?
            .encode();
        // element 0 would be all 46 octets
        let element = Description::element(address.subindex.into())
            .filter(|_| address.subindex != 0)
            .and_then(|element| description.get(element))
            .ok_or(Refusal::Number(PkwErrorNumber::SUBINDEX))?;
        if element.len() > 4 {
            return Err(Refusal::Number(PkwErrorNumber::NAME_NOT_CYCLIC));
        }
        if self.narrow && element.len() > 2 {
            return Err(Refusal::Number(self.dialect.too_wide));
        }
        let pwe = element.iter().fold(0, |pwe, &octet| pwe << 8 | u32::from(octet));
        Ok(Reply::Words(ReplyCode::DESCRIPTION, pwe))
    }

    fn text(
        &mut self,
        address: PkwAddress,
        facts: &Attributes,
        text: &[u8],
        drive: &mut (impl ParameterAccess + ?Sized),
        out: &mut [u8],
    ) -> Result<Reply, Refusal> {
        if facts.format != Format::VISIBLE_STRING {
            return Err(Refusal::Number(PkwErrorNumber::DATA_TYPE));
        }
        // the index names one of an array of texts
        let first = u16::from(address.subindex).saturating_mul(facts.string_octets());
        if first > 0 && facts.string == 0 {
            return Err(Refusal::Number(PkwErrorNumber::NO_ARRAY));
        }
        if first > 0 && first >= facts.elements {
            return Err(Refusal::Number(PkwErrorNumber::SUBINDEX));
        }
        if address.text == TEXT_WRITE {
            let done = match self.done {
                Some(done) => done,
                None => self.done(drive, |server, drive| {
                    server.change_text(address, first, facts, text, drive)
                }),
            };
            match self.stored(done, drive) {
                Done::Refused(refusal) => return Err(refusal),
                Done::Saving(_) => return Ok(Reply::Nothing),
                Done::Changed => {}
            }
        }
        let mut length = 0;
        let mut room = out.iter_mut().skip(TEXT_AT);
        for place in 0..facts.string_octets() {
            let octet = drive
                .read(address.pnu, first.saturating_add(place))
                .map_err(|number| self.refusal(number))?;
            let [.., octet] = octet.to_be_bytes();
            *room
                .next()
                .ok_or(Refusal::Number(PkwErrorNumber::TEXT_NOT_CYCLIC))? = octet;
            if octet != b' ' && octet != 0 {
                length = usize::from(place) + 1;
            }
        }
        Ok(Reply::Text(length))
    }

    /// Text has no request that changes it in RAM only, so it is saved (our reading).
    fn change_text(
        &self,
        address: PkwAddress,
        first: u16,
        facts: &Attributes,
        text: &[u8],
        drive: &mut (impl ParameterAccess + ?Sized),
    ) -> Result<(), Refusal> {
        self.check_rights(address, drive)?;
        if !facts.writable {
            return Err(Refusal::Number(PkwErrorNumber::NOT_CHANGEABLE));
        }
        if text.len() > usize::from(facts.string_octets()) {
            return Err(Refusal::Number(PkwErrorNumber::LIMIT));
        }
        drive
            .write_text(address.pnu, first, text, Keep::Permanent)
            .map_err(|number| self.refusal(number))
    }

    fn refusal(&self, number: ErrorNumber) -> Refusal {
        Refusal::Number(PkwErrorNumber::from_parameter(number, self.dialect.error_names))
    }
}

/// Octets of a block with one word of PWE.
const NARROW_LEN: usize = 6;

enum Reply {
    Nothing,
    Words(ReplyCode, u32),
    /// That many characters are in the buffer behind PKE and IND.
    Text(usize),
}

/// Returns the fixed part and the characters of a block.
fn parse(request: &[u8]) -> Result<(Pkw, &[u8]), BlockError> {
    let wrong = BlockError::Length(request.len());
    let (head, text) = request.split_first_chunk::<TEXT_AT>().ok_or(wrong)?;
    let mut octets = [0; PKW_LEN];
    copy(&mut octets, head, TEXT_AT);
    let is_text = Pkw::from_octets(octets).request_code() == super::code::RequestCode::TEXT;
    if is_text && request.len() <= MAX_BLOCK {
        return Ok((Pkw::from_octets(octets), text));
    }
    if let &[a, b, c, d, g, h] = request {
        return Ok((Pkw::from_octets([a, b, c, d, 0, 0, g, h]), &[]));
    }
    let octets = request.first_chunk().filter(|_| request.len() == PKW_LEN);
    Ok((Pkw::from_octets(*octets.ok_or(wrong)?), &[]))
}

fn copy(to: &mut [u8], from: &[u8], count: usize) {
    for (place, octet) in to.iter_mut().zip(from).take(count) {
        *place = *octet;
    }
}

const fn code(width: Width, array: bool) -> ReplyCode {
    match (width, array) {
        (Width::Word, false) => ReplyCode::WORD,
        (Width::DoubleWord, false) => ReplyCode::DOUBLE_WORD,
        (Width::Word, true) => ReplyCode::ARRAY_WORD,
        (Width::DoubleWord, true) => ReplyCode::ARRAY_DOUBLE_WORD,
    }
}

fn counted(format: Format) -> bool {
    format
        .info(CodeSpace::V4)
        .is_some_and(|info| info.octets == Octets::Counted)
}

fn signed(format: Format) -> bool {
    format
        .info(CodeSpace::V4)
        .is_some_and(|info| info.kind == Kind::Signed)
}

/// Returns a word as one octet; `None` when it does not fit.
fn octet(word: u16, signed: bool) -> Option<u8> {
    let [_, low] = word.to_be_bytes();
    if signed {
        i8::try_from(word.cast_signed()).ok().map(i8::cast_unsigned)
    } else {
        u8::try_from(word).ok().map(|_| low)
    }
}
