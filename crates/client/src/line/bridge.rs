//! A parameter job over the PKW channel: a base mode request in, one exchange of the channel after the other, a base
//! mode response out.

use profile::parameter::{
    Attribute, CodeSpace, DecodeError, Description, Dialect, ErrorNumber, Format, Kind, Octets,
    ParameterAddress, Request, RequestId, ValueBlock,
};
use profile::pkw::{
    Answer, Job, JobError, Memory, Outcome, PkwErrorNames, PkwErrorNumber, PkwValue, RequestCode, StartError,
    Width,
};

use crate::error::{ChannelCause, NotCarried};

/// Request ID of a change that is retained over a power cycle (Danfoss).
const CHANGE_PERMANENT: u8 = 0x42;
/// Elements of a description that fit the channel: all but the name and what is reserved.
const TRAVELLING: [u16; 8] = [1, 2, 3, 4, 7, 8, 11, 12];
/// Octets of a whole description.
const DESCRIPTION: usize = 46;

/// Properties of a parameter that the channel does not report: it distinguishes only word and double word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Format code of the answer.
    pub format: Format,
    /// Octets of one value.
    pub octets: usize,
    /// Characters of a text. The channel carries it without the spaces at its end; records carry them.
    pub characters: usize,
    /// Its elements are distinguished.
    pub array: bool,
    /// Its elements are parameters of their own: no array that the channel could name an element of. No document has the
    /// application ids of a Vacon in a parameter channel.
    pub collecting: bool,
}

/// One exchange.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Read {
        pnu: u16,
        element: Option<u8>,
    },
    Describe {
        pnu: u16,
        element: u8,
    },
    ReadText {
        pnu: u16,
    },
    Change {
        pnu: u16,
        element: Option<u8>,
        value: PkwValue,
    },
    ChangeText {
        pnu: u16,
        text: Vec<u8>,
    },
}

/// What one address of the request comes to.
#[derive(Debug, Clone)]
struct Part {
    shape: Option<Shape>,
    steps: Vec<Step>,
    /// Steps done.
    done: usize,
    /// How a request for a number was refused in whose place text is read.
    before: Option<PkwErrorNumber>,
    outcome: Result<Gathered, Refused>,
}

/// Answer as far as it has come.
#[derive(Debug, Clone)]
enum Gathered {
    Values {
        format: Option<Format>,
        octets: Vec<u8>,
        count: u8,
    },
    Written,
}

/// Number for the response, the element at fault, and what happened in the channel.
#[derive(Debug, Clone, Copy)]
struct Refused {
    number: ErrorNumber,
    element: u16,
    cause: ChannelCause,
}

/// The response to a whole request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answered {
    /// Base mode response.
    pub octets: Vec<u8>,
    /// What happened in the channel, for each address of the request that has no value. Empty where records answered.
    pub channel: Vec<Option<ChannelCause>>,
}

impl Answered {
    /// Returns the response of a record.
    pub const fn by_record(octets: Vec<u8>) -> Self {
        Self {
            octets,
            channel: Vec::new(),
        }
    }

    /// Returns the result in the channel for this address of the request.
    pub fn cause(&self, address: usize) -> Option<ChannelCause> {
        self.channel.get(address).copied().flatten()
    }
}

/// A parameter job on its way through the channel.
#[derive(Debug, Clone)]
pub struct Bridge {
    reference: u8,
    id: RequestId,
    axis: u8,
    space: CodeSpace,
    memory: Memory,
    names: PkwErrorNames,
    parts: Vec<Part>,
    at: usize,
}

impl Bridge {
    /// Splits a request; `names` selects the error numbers of the answer, `shape` returns the parameters, as far as
    /// there are tables.
    ///
    /// # Errors
    /// When the request cannot be taken apart.
    pub fn new(
        request: &[u8],
        dialect: &Dialect,
        names: PkwErrorNames,
        shape: impl Fn(u16) -> Option<Shape>,
    ) -> Result<Self, DecodeError> {
        let request = Request::parse(request, dialect.code_space)?;
        let reads = request.id() == RequestId::Read;
        let mut values = request.values();
        let mut parts = Vec::with_capacity(request.addresses().len());
        for address in request.addresses() {
            let shape = shape(address.pnu);
            let part = if reads {
                read(address, shape)
            } else {
                match values.next().transpose()? {
                    Some(block) => change(address, shape, &block, dialect.code_space),
                    None => unsent(shape, NotCarried::Request),
                }
            };
            parts.push(part);
        }
        Ok(Self {
            reference: request.reference(),
            id: request.id(),
            axis: request.axis(),
            space: dialect.code_space,
            memory: if request.id().octet() == CHANGE_PERMANENT {
                Memory::Eeprom
            } else {
                Memory::Ram
            },
            names,
            parts,
            at: 0,
        })
    }

    /// Exchanges done so far.
    pub fn progress(&self) -> usize {
        self.at + self.parts.iter().map(|part| part.done).sum::<usize>()
    }

    /// Returns the next exchange; `None` when all are done.
    pub fn job(&mut self) -> Option<Job<'_>> {
        while let Some(part) = self.parts.get(self.at) {
            if part.outcome.is_ok() && part.done < part.steps.len() {
                break;
            }
            self.at += 1;
        }
        let part = self.parts.get(self.at)?;
        Some(match part.steps.get(part.done)? {
            &Step::Read { pnu, element } => Job::Read { pnu, element },
            &Step::Describe { pnu, element } => Job::Description { pnu, element },
            &Step::ReadText { pnu } => Job::ReadText { pnu, index: 0 },
            &Step::Change { pnu, element, value } => Job::Change {
                pnu,
                element,
                value,
                memory: self.memory,
            },
            Step::ChangeText { pnu, text } => Job::ChangeText {
                pnu: *pnu,
                index: 0,
                text,
            },
        })
    }

    /// The channel cannot carry the exchange.
    pub fn cannot(&mut self, error: StartError) {
        if let Some(number) = self.parts.get(self.at).and_then(|part| part.before) {
            return self.refuse_as(number);
        }
        let why = match error {
            StartError::NoRequest {
                request: RequestCode::TEXT,
                ..
            } => NotCarried::Text,
            StartError::NoRequest { .. } | StartError::Busy => NotCarried::Request,
            StartError::Number { pnu, .. } => NotCarried::Number(pnu),
            StartError::TextLength(length) => NotCarried::TextLength(length),
        };
        self.refuse(why.number(), ChannelCause::NotCarried(why));
    }

    /// The drive refused with this number of the channel.
    fn refuse_as(&mut self, number: PkwErrorNumber) {
        let names = self.names;
        let cause = ChannelCause::Number { number, names };
        self.refuse(number.to_parameter(names), cause);
    }

    /// How the exchange ended; `text` are the characters of a text.
    ///
    /// # Errors
    /// When no slave answered: then the whole job is over.
    pub fn take(&mut self, outcome: Outcome, text: &[u8]) -> Result<(), JobError> {
        let answer = match outcome {
            Ok(answer) => answer,
            Err(JobError::Refused(number)) => {
                if !self.is_text_instead(number) {
                    self.refuse_as(number);
                }
                return Ok(());
            }
            Err(JobError::NoRights) => {
                self.refuse(ErrorNumber::NO_RIGHTS, ChannelCause::NoRights);
                return Ok(());
            }
            Err(error @ (JobError::NotAtRest | JobError::NoReply | JobError::Lost)) => return Err(error),
        };
        let space = self.space;
        let Some(part) = self.parts.get_mut(self.at) else {
            return Ok(());
        };
        let step = part.steps.get(part.done).cloned();
        part.done += 1;
        let (Some(step), Ok(gathered)) = (step, &mut part.outcome) else {
            return Ok(());
        };
        let Gathered::Values {
            format,
            octets,
            count,
        } = gathered
        else {
            return Ok(());
        };
        match (step, answer) {
            (Step::Read { .. }, Answer::Value(value)) => {
                let (code, width) = carried(part.shape, value, space);
                *format = Some(code);
                *count = count.saturating_add(1);
                let whole = value.raw().to_be_bytes();
                octets.extend_from_slice(whole.get(whole.len() - width..).unwrap_or_default());
            }
            (Step::Describe { element, .. }, Answer::Description(value)) => {
                octets.resize(DESCRIPTION, 0);
                if let Some(range) = Description::element(element.into()) {
                    let whole = value.to_be_bytes();
                    let from = whole.len().saturating_sub(range.len());
                    if let (Some(place), Some(value)) = (octets.get_mut(range), whole.get(from..)) {
                        place.copy_from_slice(value);
                    }
                }
                *count = DESCRIPTION as u8;
                *format = Some(Format::OCTET_STRING);
            }
            (Step::ReadText { .. }, Answer::Text) => {
                octets.extend_from_slice(text);
                let whole = part.shape.map_or(0, |shape| shape.characters);
                octets.resize(whole.max(text.len()), b' ');
                *count = u8::try_from(octets.len()).unwrap_or(u8::MAX);
                *format = Some(Format::VISIBLE_STRING);
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns whether a parameter without tables whose value has another data type may be text, which has a request of
    /// its own. True when that request is to be tried.
    fn is_text_instead(&mut self, number: PkwErrorNumber) -> bool {
        let Some(part) = self.parts.get_mut(self.at).filter(|part| part.shape.is_none()) else {
            return false;
        };
        match part.steps.as_slice() {
            &[Step::Read { pnu, .. }] if number == PkwErrorNumber::DATA_TYPE => {
                part.before = Some(number);
                part.steps = vec![Step::ReadText { pnu }];
                true
            }
            _ => false,
        }
    }

    fn refuse(&mut self, number: ErrorNumber, cause: ChannelCause) {
        let Some(part) = self.parts.get_mut(self.at) else {
            return;
        };
        let element = match part.steps.get(part.done) {
            Some(Step::Read { element, .. } | Step::Change { element, .. }) => element.unwrap_or(0),
            // a description without one of its elements is still one
            Some(&Step::Describe { element, .. }) if element != 1 && number != ErrorNumber::SERVICE => {
                part.done += 1;
                return;
            }
            _ => 0,
        };
        part.outcome = Err(Refused {
            number,
            element: element.into(),
            cause,
        });
    }

    /// Returns the response to the whole request, and what happened in the channel.
    pub fn answered(&self) -> Answered {
        let cause = |part: &Part| part.outcome.as_ref().err().map(|refused| refused.cause);
        Answered {
            octets: self.response(),
            channel: self.parts.iter().map(cause).collect(),
        }
    }

    fn response(&self) -> Vec<u8> {
        let failed = self.parts.iter().any(|part| part.outcome.is_err());
        let negative = if failed { 0x80 } else { 0 };
        let parameters = u8::try_from(self.parts.len()).unwrap_or(u8::MAX);
        let mut out = vec![self.reference, self.id.octet() | negative, self.axis, parameters];
        if self.id != RequestId::Read && !failed {
            return out;
        }
        for part in &self.parts {
            match &part.outcome {
                Ok(Gathered::Values {
                    format,
                    octets,
                    count,
                }) => {
                    let format = format.unwrap_or(Format::ZERO);
                    out.extend([format.0, *count]);
                    out.extend_from_slice(octets);
                    if octets.len() % 2 == 1 {
                        out.push(0);
                    }
                }
                Ok(Gathered::Written) => out.extend([Format::ZERO.0, 0]),
                Err(Refused { number, element, .. }) => {
                    out.extend([Format::ERROR.0, 2]);
                    out.extend(number.0.to_be_bytes());
                    out.extend(element.to_be_bytes());
                }
            }
        }
        out
    }
}

fn part(shape: Option<Shape>, steps: Vec<Step>, outcome: Result<Gathered, Refused>) -> Part {
    Part {
        shape,
        steps,
        done: 0,
        before: None,
        outcome,
    }
}

/// Returns the part of a request that the channel cannot carry.
fn unsent(shape: Option<Shape>, why: NotCarried) -> Part {
    let refused = Refused {
        number: why.number(),
        element: 0,
        cause: ChannelCause::NotCarried(why),
    };
    part(shape, Vec::new(), Err(refused))
}

/// Returns the element of an array; none for what is not an array.
fn element(address: ParameterAddress, shape: Option<Shape>, offset: u8) -> Option<Option<u8>> {
    let array = match shape {
        Some(shape) => shape.array,
        None => address.elements > 1 || address.subindex > 0,
    };
    let number = u8::try_from(address.subindex).ok()?.checked_add(offset)?;
    Some(array.then_some(number))
}

fn read(address: ParameterAddress, shape: Option<Shape>) -> Part {
    let pnu = address.pnu;
    if shape.is_some_and(|shape| shape.collecting) {
        return unsent(shape, NotCarried::Member(pnu));
    }
    let steps: Option<Vec<Step>> = match address.attribute {
        Attribute::Value if shape.is_some_and(|shape| is_text(shape.format)) => {
            Some(vec![Step::ReadText { pnu }])
        }
        Attribute::Value => (0..address.elements.max(1))
            .map(|offset| {
                let element = element(address, shape, offset)?;
                Some(Step::Read { pnu, element })
            })
            .collect(),
        Attribute::Description => Some(
            TRAVELLING
                .iter()
                .filter(|&&number| address.subindex == 0 || address.subindex == number)
                .filter_map(|&number| {
                    let element = u8::try_from(number).ok()?;
                    Some(Step::Describe { pnu, element })
                })
                .collect(),
        ),
        // texts of values have no place in the channel
        Attribute::Text => return unsent(shape, NotCarried::Text),
        Attribute::Other(_) => return unsent(shape, NotCarried::Request),
    };
    match steps {
        None => unsent(shape, NotCarried::Element(address.subindex)),
        Some(steps) => part(
            shape,
            steps,
            Ok(Gathered::Values {
                format: None,
                octets: Vec::new(),
                count: 0,
            }),
        ),
    }
}

fn change(address: ParameterAddress, shape: Option<Shape>, block: &ValueBlock<'_>, space: CodeSpace) -> Part {
    let pnu = address.pnu;
    if shape.is_some_and(|shape| shape.collecting) {
        return unsent(shape, NotCarried::Member(pnu));
    }
    if address.attribute != Attribute::Value {
        return unsent(shape, NotCarried::Request);
    }
    if is_text(block.format) {
        let text = block.data.to_vec();
        return part(shape, vec![Step::ChangeText { pnu, text }], Ok(Gathered::Written));
    }
    let mut steps = Vec::new();
    for offset in 0..block.count {
        let Some(element) = element(address, shape, offset) else {
            return unsent(shape, NotCarried::Element(address.subindex));
        };
        let Some(value) = sent(block, offset, space) else {
            let octets = block.octets(offset.into()).map_or(0, <[u8]>::len);
            return unsent(shape, NotCarried::Size(octets));
        };
        steps.push(Step::Change { pnu, element, value });
    }
    part(shape, steps, Ok(Gathered::Written))
}

/// Returns a value as it travels: one octet as a word, with its sign if it has one.
fn sent(block: &ValueBlock<'_>, offset: u8, space: CodeSpace) -> Option<PkwValue> {
    match *block.octets(offset.into())? {
        [octet] if kind(block.format, space) == Some(Kind::Signed) => {
            let wide = i16::from(octet.cast_signed());
            Some(PkwValue::Word(wide.cast_unsigned()))
        }
        [octet] => Some(PkwValue::Word(octet.into())),
        [high, low] => Some(PkwValue::Word(u16::from_be_bytes([high, low]))),
        [a, b, c, d] => Some(PkwValue::DoubleWord(u32::from_be_bytes([a, b, c, d]))),
        _ => None,
    }
}

/// Format and octets of a value that came: those of the table where they fit what came.
fn carried(shape: Option<Shape>, value: PkwValue, space: CodeSpace) -> (Format, usize) {
    let width = match value.width() {
        Width::Word => 2,
        Width::DoubleWord => 4,
    };
    match shape {
        Some(shape) if shape.octets == width || (shape.octets == 1 && width == 2) => {
            (shape.format, shape.octets)
        }
        _ => match (space, width) {
            (CodeSpace::V3, 2) => (Format::UNSIGNED16, width),
            (CodeSpace::V3, _) => (Format::UNSIGNED32, width),
            (_, 2) => (Format::WORD, width),
            _ => (Format::DOUBLE_WORD, width),
        },
    }
}

fn kind(format: Format, space: CodeSpace) -> Option<Kind> {
    Some(format.info(space)?.kind)
}

fn is_text(format: Format) -> bool {
    format
        .info(CodeSpace::V4)
        .is_some_and(|info| info.octets == Octets::Counted && info.kind == Kind::Text)
}
