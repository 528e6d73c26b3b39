//! The parameter channel: a request is written to a record and its answer read from the same record.
//!
//! Source: PROFIdrive on PROFINET, records 0x002F, 0xB02E and 0xB02F; the answer belongs to the AR that asked, and is
//! gone with it or once it was read.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use profile::notation::Quantity;
use profile::parameter::{
    ErrorNumber, Format, ParameterAccess, Refusal, SaveId, SaveState, Served, not_saved,
};
use profile::pkw::{PkwDialect, PkwErrorNumber};
use profinet::Instant;
use profinet::wire::PnioStatus;
use profinet::wire::status::record as code1;

use crate::drive::Drive;
use crate::model::Model;

/// Records that carry parameter jobs.
pub(super) const INDICES: [u16; 3] = [0x002F, 0xB02E, 0xB02F];

/// Longest answer.
const LONGEST: usize = 240;

/// An impaired parameter manager, to test the reaction of a client.
///
/// Written `none`, `silent`, `late 500ms`, `reference`, `cut` or `error 0x11`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AnswerFault {
    /// All is well.
    #[default]
    None,
    /// Takes requests and never has an answer: "not ready" for ever. What was requested is done anyway.
    Silent,
    /// Has its answer ready only after this time.
    Late(Duration),
    /// Answers with the reference of another request.
    Reference,
    /// Leaves the last octet of the answer out.
    Cut,
    /// Does nothing and refuses every parameter with this error number. The parameter channel of a PPO type refuses with
    /// the same number. Records have another where that is a vendor's number of the parameter channel alone.
    Error(u16),
}

/// The text is no [`AnswerFault`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}`: answers can be none, silent, late TIME, reference, cut or error NUMBER")]
pub struct NoAnswerFault(String);

impl AnswerFault {
    /// Returns the number with which the parameter channel (PKW) refuses every request.
    #[must_use]
    pub const fn in_channel(self) -> Option<PkwErrorNumber> {
        match self {
            Self::Error(number) => Some(PkwErrorNumber(number)),
            _ => None,
        }
    }
}

impl FromStr for AnswerFault {
    type Err = NoAnswerFault;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || NoAnswerFault(text.to_owned());
        let (word, value) = text.trim().split_once(' ').unwrap_or((text.trim(), ""));
        let value = value.trim();
        let quantity = || value.parse::<Quantity>().map_err(|_| wrong());
        Ok(match (word, value) {
            ("none", "") => Self::None,
            ("silent", "") => Self::Silent,
            ("reference", "") => Self::Reference,
            ("cut", "") => Self::Cut,
            ("late", _) => {
                let seconds = quantity()?.in_unit("s").map_err(|_| wrong())?;
                Self::Late(Duration::try_from_secs_f64(seconds).map_err(|_| wrong())?)
            }
            ("error", _) => {
                let number = quantity()?.in_unit("").map_err(|_| wrong())?;
                if number.fract() != 0.0 || !(0.0..=65_535.0).contains(&number) {
                    return Err(wrong());
                }
                Self::Error(number as u16)
            }
            _ => return Err(wrong()),
        })
    }
}

impl fmt::Display for AnswerFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Silent => f.write_str("silent"),
            Self::Late(time) => write!(f, "late {}ms", time.as_secs_f64() * 1000.0),
            Self::Reference => f.write_str("reference"),
            Self::Cut => f.write_str("cut"),
            Self::Error(number) => write!(f, "error 0x{number:02X}"),
        }
    }
}

/// The answer to the request of a connection, until it is read.
#[derive(Debug)]
struct Waiting<K> {
    ar: K,
    /// It can be read from then on; `None` for never.
    ready: Option<Instant>,
    answer: Vec<u8>,
    /// The save that the answer waits for, and the answer if that fails.
    save: Option<(SaveId, Vec<u8>)>,
}

impl<K> Waiting<K> {
    fn is_ready(&self, now: Instant) -> bool {
        self.save.is_none() && self.ready.is_some_and(|ready| ready <= now)
    }
}

/// Answers that wait to be read, one per connection.
#[derive(Debug)]
pub(super) struct Channels<K> {
    waiting: Vec<Waiting<K>>,
    fault: AnswerFault,
}

impl<K> Default for Channels<K> {
    fn default() -> Self {
        Self {
            waiting: Vec::new(),
            fault: AnswerFault::None,
        }
    }
}

impl<K: Copy + PartialEq> Channels<K> {
    /// Removes every AR.
    pub fn forget_all(&mut self) {
        *self = Self {
            fault: self.fault,
            ..Self::default()
        };
    }

    /// Sets how requests are answered from the next one on. Requests set to stay unanswered are discarded.
    pub fn set_fault(&mut self, fault: AnswerFault) {
        self.waiting.retain(|waiting| waiting.ready.is_some());
        self.fault = fault;
    }

    /// Processes a request of a connection. An answer that is ready and was not fetched is discarded. While the previous
    /// request of the connection is still being processed, nothing is done and the request is refused with 0xB5.
    pub fn write(
        &mut self,
        now: Instant,
        ar: K,
        request: &[u8],
        drive: &mut Drive,
    ) -> Result<(), PnioStatus> {
        let busy = |waiting: &Waiting<K>| waiting.ar == ar && !waiting.is_ready(now);
        if self.waiting.iter().any(busy) {
            return Err(PnioStatus::write(code1::STATE_CONFLICT));
        }
        let mut out = [0; LONGEST];
        let served = match self.fault {
            AnswerFault::Error(number) => refuse_all(request, in_records(number, drive.model()), &mut out)
                .map(|length| Served { length, save: None }),
            _ => drive.serve_saving(request, &mut out),
        };
        let Served { length, save } = served.map_err(|refusal| {
            PnioStatus::write(match refusal {
                Refusal::Parameters { .. } => code1::INVALID_RANGE,
                Refusal::Length | Refusal::Room => code1::LENGTH,
            })
        })?;
        let answer = out.get(..length).unwrap_or_default();
        let ready = match self.fault {
            AnswerFault::Silent => None,
            AnswerFault::Late(time) => Some(now + time),
            _ => Some(now),
        };
        let save = save.map(|change| {
            let mut refused = [0; LONGEST];
            let length = not_saved(answer, change, drive.model().known.dialect, &mut refused);
            (change.save, self.sent(refused.get(..length).unwrap_or_default()))
        });
        let answer = self.sent(answer);
        self.forget(ar);
        self.waiting.push(Waiting {
            ar,
            ready,
            answer,
            save,
        });
        Ok(())
    }

    /// Returns an answer as the parameter manager sends it.
    fn sent(&self, answer: &[u8]) -> Vec<u8> {
        let mut answer = answer.to_vec();
        match (self.fault, answer.first_mut()) {
            (AnswerFault::Cut, _) => {
                answer.pop();
            }
            (AnswerFault::Reference, Some(reference)) => *reference = reference.wrapping_add(1),
            _ => {}
        }
        answer
    }

    /// Completes the answers whose save has ended.
    pub fn settle(&mut self, drive: &Drive) {
        for waiting in &mut self.waiting {
            let state = waiting.save.as_ref().map(|(save, _)| drive.save_state(*save));
            match (state, waiting.save.take()) {
                (Some(SaveState::Pending), pending) => waiting.save = pending,
                (Some(SaveState::Failed), Some((_, refused))) => waiting.answer = refused,
                _ => {}
            }
        }
    }

    /// Gives the answer to the AR's request, once. "Not ready" (0xB5) while there is none.
    pub fn read(&mut self, now: Instant, ar: Option<K>, most: usize) -> Result<Vec<u8>, PnioStatus> {
        let place = self
            .waiting
            .iter()
            .position(|waiting| Some(waiting.ar) == ar && waiting.is_ready(now));
        let place = place.ok_or(PnioStatus::read(code1::STATE_CONFLICT))?;
        let Waiting { answer, .. } = self.waiting.swap_remove(place);
        if answer.len() > most {
            Err(PnioStatus::read(code1::LENGTH))
        } else {
            Ok(answer)
        }
    }

    /// The AR has ended.
    pub fn forget(&mut self, ar: K) {
        self.waiting.retain(|waiting| waiting.ar != ar);
    }
}

/// Returns the number under which records refuse with `number`: that of the model's dialect where only the vendor's
/// parameter channel (PKW) has `number`.
fn in_records(number: u16, model: &Model) -> ErrorNumber {
    let own = |dialect: &&PkwDialect| {
        let mut rows = dialect.error_names.rows().iter();
        rows.any(|row| row.number == number)
    };
    match (
        ErrorNumber(number).info(model.known.dialect.error_names),
        model.known.pkw.filter(own),
    ) {
        (None, Some(channel)) => PkwErrorNumber(number).to_parameter(channel.error_names),
        _ => ErrorNumber(number),
    }
}

/// Returns a negative answer to every parameter of a request, and nothing done.
fn refuse_all(request: &[u8], ErrorNumber(number): ErrorNumber, out: &mut [u8]) -> Result<usize, Refusal> {
    let [reference, id, axis, count, ..] = *request else {
        return Err(Refusal::Length);
    };
    let length = 4 + 4 * usize::from(count);
    let room = out.get_mut(..length).filter(|_| (1..=39).contains(&count));
    let block = room.ok_or(Refusal::Parameters {
        found: count,
        allowed: 39,
    })?;
    let (head, errors) = block.split_at_mut(4);
    head.copy_from_slice(&[reference, id | 0x80, axis, count]);
    let [high, low] = number.to_be_bytes();
    let (errors, _) = errors.as_chunks_mut::<4>();
    errors.fill([Format::ERROR.0, 1, high, low]);
    Ok(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{AKD, VLT};

    const READ_922: [u8; 10] = [1, 1, 0, 1, 0x10, 1, 0x03, 0x9A, 0, 0];
    const NOW: Instant = Instant::ZERO;
    const NOT_READY: PnioStatus = PnioStatus::read(code1::STATE_CONFLICT);

    #[test]
    fn an_answer_is_read_once_and_by_its_own_ar() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        assert_eq!(channels.read(NOW, Some(1), 240), Err(NOT_READY));
        channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
        assert_eq!(channels.read(NOW, Some(2), 240), Err(NOT_READY));
        assert_eq!(channels.read(NOW, None, 240), Err(NOT_READY));
        assert_eq!(
            channels.read(NOW, Some(1), 240),
            Ok(vec![1, 1, 0, 1, 0x42, 1, 0, 1])
        );
        assert_eq!(channels.read(NOW, Some(1), 240), Err(NOT_READY));
    }

    /// An answer for each connection, none longer than 240 octets: the elements that do not fit are refused.
    #[test]
    fn answers_are_bounded_in_number_and_length() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        // all of PNU 947, three times
        let mut request = vec![1, 1, 0, 3];
        request.extend([0x10, 64, 0x03, 0xB3, 0, 0].repeat(3));
        for _ in 0..3 {
            for ar in 1..=5 {
                channels.write(NOW, ar, &request, &mut drive).unwrap();
            }
        }
        assert_eq!(channels.waiting.len(), 5);
        let answer = channels.read(NOW, Some(1), LONGEST).unwrap();
        assert_eq!(answer.len(), 4 + (2 + 64 * 2) + 2 * 4);
        assert_eq!(answer[134..138], [0x44, 1, 0, ErrorNumber::TOO_LONG.0 as u8]);
    }

    #[test]
    fn a_new_request_replaces_an_unread_answer() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
        let mut second = READ_922;
        second[0] = 2;
        channels.write(NOW, 1, &second, &mut drive).unwrap();
        channels.write(NOW, 7, &READ_922, &mut drive).unwrap();
        assert_eq!(channels.read(NOW, Some(1), 240).unwrap()[0], 2);
        channels.forget(7);
        assert_eq!(channels.read(NOW, Some(7), 240), Err(NOT_READY));
    }

    /// DF 80 B5 00, and the first change is answered as if nothing had come in between.
    #[test]
    fn a_second_request_is_refused_while_the_first_is_processed() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        channels.set_fault("late 500ms".parse().unwrap());
        let change = [7, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
        channels.write(NOW, 1, &change, &mut drive).unwrap();
        let busy = PnioStatus::write(code1::STATE_CONFLICT);
        assert_eq!(busy.to_u32(), 0xDF80_B500);
        let at = |ms| NOW + Duration::from_millis(ms);
        let mut second = change;
        second[13] = 1;
        for ms in [0, 499] {
            assert_eq!(channels.write(at(ms), 1, &second, &mut drive), Err(busy));
            assert_eq!(channels.read(at(ms), Some(1), 240), Err(NOT_READY));
        }
        // another connection has a channel of its own
        assert_eq!(channels.write(at(499), 2, &READ_922, &mut drive), Ok(()));
        assert_eq!(channels.read(at(500), Some(1), 240), Ok(vec![7, 2, 0, 1, 0, 0]));
        assert_eq!(
            drive.read(930, 0),
            Ok(2),
            "the refused change was not carried out"
        );
        assert_eq!(channels.write(at(500), 1, &READ_922, &mut drive), Ok(()));
    }

    /// Numbers of the parameter channel of a VLT are those of its dialect here; all others are as they are.
    #[test]
    fn a_number_that_only_the_parameter_channel_has_is_that_of_the_dialect_in_records() {
        for (model, number, received) in [
            (&VLT, 131, 0x11),
            (&VLT, 130, 0x68),
            (&VLT, 0x11, 0x11),
            (&VLT, 0x65, 0x65),
            (&VLT, 999, 999),
            (&AKD, 131, 131),
        ] {
            let mut drive = Drive::new(model);
            let mut channels = Channels::default();
            channels.set_fault(AnswerFault::Error(number));
            channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
            let [high, low] = u16::to_be_bytes(received);
            assert_eq!(
                channels.read(NOW, Some(1), 240),
                Ok(vec![1, 0x81, 0, 1, 0x44, 1, high, low]),
                "{number}"
            );
        }
    }

    #[test]
    fn a_request_without_an_answer_is_forgotten_with_the_fault() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        channels.set_fault(AnswerFault::Silent);
        channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
        let much_later = NOW + Duration::from_secs(3600);
        let busy = PnioStatus::write(code1::STATE_CONFLICT);
        assert_eq!(channels.write(much_later, 1, &READ_922, &mut drive), Err(busy));
        channels.set_fault(AnswerFault::None);
        assert_eq!(channels.write(much_later, 1, &READ_922, &mut drive), Ok(()));
        assert!(channels.read(much_later, Some(1), 240).is_ok());
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        assert_eq!(
            channels.write(NOW, 1, &[], &mut drive),
            Err(PnioStatus::write(code1::LENGTH))
        );
        assert_eq!(
            channels.write(NOW, 1, &READ_922[..9], &mut drive),
            Err(PnioStatus::write(code1::LENGTH))
        );
        let mut many = READ_922;
        many[3] = 40;
        assert_eq!(
            channels.write(NOW, 1, &many, &mut drive),
            Err(PnioStatus::write(code1::INVALID_RANGE))
        );
        channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
        assert_eq!(
            channels.read(NOW, Some(1), 4),
            Err(PnioStatus::read(code1::LENGTH))
        );
    }

    #[test]
    fn an_impaired_parameter_manager_answers_as_injected() {
        let answer = |fault: &str, wait: u64| {
            let mut drive = Drive::new(&AKD);
            let mut channels = Channels::default();
            channels.set_fault(fault.parse().unwrap());
            channels.write(NOW, 1, &READ_922, &mut drive).unwrap();
            channels.read(NOW + Duration::from_millis(wait), Some(1), 240)
        };
        let good = vec![1, 1, 0, 1, 0x42, 1, 0, 1];
        assert_eq!(answer("none", 0), Ok(good.clone()));
        assert_eq!(answer("silent", 3_600_000), Err(NOT_READY));
        assert_eq!(answer("late 500ms", 499), Err(NOT_READY));
        assert_eq!(answer("late 500ms", 500), Ok(good.clone()));
        assert_eq!(answer("reference", 0), Ok(vec![2, 1, 0, 1, 0x42, 1, 0, 1]));
        assert_eq!(answer("cut", 0), Ok(good[..7].to_vec()));
        assert_eq!(answer("error 0x11", 0), Ok(vec![1, 0x81, 0, 1, 0x44, 1, 0, 0x11]));
    }

    #[test]
    fn faults_of_answers_are_written_and_read_alike() {
        for text in ["none", "silent", "late 500ms", "reference", "cut", "error 0x11"] {
            assert_eq!(text.parse::<AnswerFault>().unwrap().to_string(), text);
        }
        for wrong in [
            "",
            "late",
            "late 3rpm",
            "error 70000",
            "error 1.5",
            "cut 3",
            "loud",
        ] {
            let error = wrong.parse::<AnswerFault>().unwrap_err().to_string();
            assert!(error.contains("answers can be"), "{error}");
        }
    }
}
