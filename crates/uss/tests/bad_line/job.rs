//! What is asked, and whether the answer is its own.

use std::time::Duration;

use profidrive_uss::Protocol;
use profile::pkw::{Answer, Client, Job, JobError, Memory, Outcome, PkwErrorNumber, PkwValue};

use super::drive::{LABEL, Named, TEXT};
use super::{Dice, Tally};

/// A job under way.
#[derive(Debug, Clone)]
pub struct Asked {
    pub begun: Duration,
    /// Number of the drive.
    number: u32,
    pnu: u16,
    element: Option<u8>,
    written: Option<(u32, Memory)>,
    text: Option<Vec<u8>>,
}

impl Asked {
    pub fn new(dice: &mut Dice, protocol: Protocol, begun: Duration, number: u32, serial: u32) -> Self {
        let texts = protocol == Protocol::Fc;
        let pnu = [1, 2, 3, 1, 4, 5, 5, 9, LABEL, LABEL][dice.roll(if texts { 10 } else { 8 }) as usize];
        let memory = if dice.chance(50) {
            Memory::Ram
        } else {
            Memory::Eeprom
        };
        let writes = dice.chance(50);
        let text = format!("{number}.{serial}").into_bytes();
        Self {
            begun,
            number,
            pnu,
            element: (pnu == 5).then_some(dice.roll(2) as u8),
            written: (pnu < 4 && writes).then_some((Named::name(number, pnu.into()) | serial, memory)),
            text: (pnu == LABEL && writes).then_some(text),
        }
    }

    pub fn start(&self, client: &mut Client) {
        let Self { pnu, element, .. } = *self;
        let job = match (&self.text, self.written) {
            (Some(text), _) => Job::ChangeText { pnu, index: 0, text },
            _ if pnu == LABEL => Job::ReadText { pnu, index: 0 },
            (None, Some((value, memory))) => Job::Change {
                pnu,
                element,
                value: PkwValue::DoubleWord(value),
                memory,
            },
            (None, None) => Job::Read { pnu, element },
        };
        client.start(self.begun, job).unwrap();
    }

    pub fn judge(&self, outcome: Outcome, client: &Client, drive: &Named, tally: &mut Tally) {
        let right = match outcome {
            Ok(Answer::Text) => {
                tally.texts += 1;
                let text = client.text();
                assert!(text.len() <= TEXT);
                self.pnu == LABEL
                    && drive.had(LABEL, text, self.begun)
                    && self.text.as_ref().is_none_or(|written| written == text)
            }
            Ok(Answer::Value(PkwValue::DoubleWord(value))) => {
                tally.answered += 1;
                let name = u32::from(self.pnu) + u32::from(self.element.unwrap_or(0));
                let own = value & 0xFF00_0000 == Named::name(self.number, name);
                let stamp = Duration::from_millis((value & 0x00FF_FFFF).into());
                match self.pnu {
                    1..=3 => {
                        own && drive.had(self.pnu, &value.to_be_bytes(), self.begun)
                            && self.written.is_none_or(|(written, _)| written == value)
                    }
                    _ => {
                        tally.old += u32::from(own && stamp + Duration::from_millis(1) < self.begun);
                        own && matches!(self.pnu, 4 | 5)
                    }
                }
            }
            Err(JobError::Refused(number)) => {
                tally.refused += 1;
                self.pnu == 9 && number == PkwErrorNumber::UNKNOWN_PARAMETER
            }
            Err(_) => {
                tally.failed += 1;
                true
            }
            Ok(_) => false,
        };
        tally.wrong += u32::from(!right);
    }
}
