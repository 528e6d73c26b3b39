//! The parameter channel: a request is written to a record and its answer read from the same record.
//!
//! Source: PROFIdrive on PROFINET, records 0x002F, 0xB02E and 0xB02F; the answer belongs to the relation that asked,
//! and is gone with it or once it was read.

use profidrive::parameter::Refusal;
use profinet::wire::PnioStatus;
use profinet::wire::status::record as code1;

use crate::drive::Drive;

/// Records that carry parameter jobs.
pub(super) const INDICES: [u16; 3] = [0x002F, 0xB02E, 0xB02F];

/// Longest answer.
const LONGEST: usize = 240;

/// Answers that wait to be read, one per relation.
#[derive(Debug)]
pub(super) struct Channels<K> {
    waiting: Vec<(K, Vec<u8>)>,
}

impl<K> Default for Channels<K> {
    fn default() -> Self {
        Self { waiting: Vec::new() }
    }
}

impl<K: Copy + PartialEq> Channels<K> {
    /// Takes a request; an answer that was not fetched is given up.
    pub fn write(&mut self, relation: K, request: &[u8], drive: &mut Drive) -> Result<(), PnioStatus> {
        let mut out = [0; LONGEST];
        let length = drive.serve(request, &mut out).map_err(|refusal| {
            PnioStatus::write(match refusal {
                Refusal::Parameters { .. } => code1::INVALID_RANGE,
                Refusal::Length | Refusal::Room => code1::LENGTH,
            })
        })?;
        let answer = out.get(..length).unwrap_or_default();
        match self.waiting.iter_mut().find(|(known, _)| *known == relation) {
            Some((_, waiting)) => {
                waiting.clear();
                waiting.extend_from_slice(answer);
            }
            None => self.waiting.push((relation, answer.to_vec())),
        }
        Ok(())
    }

    /// Gives the answer to the relation's request, once. "Not ready" (0xB5) while there is none.
    pub fn read(&mut self, relation: Option<K>, most: usize) -> Result<Vec<u8>, PnioStatus> {
        let place = self
            .waiting
            .iter()
            .position(|(known, _)| Some(*known) == relation);
        let place = place.ok_or(PnioStatus::read(code1::STATE_CONFLICT))?;
        let (_, answer) = self.waiting.swap_remove(place);
        if answer.len() > most {
            Err(PnioStatus::read(code1::LENGTH))
        } else {
            Ok(answer)
        }
    }

    /// The relation has ended.
    pub fn forget(&mut self, relation: K) {
        self.waiting.retain(|(known, _)| *known != relation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::AKD;

    const READ_922: [u8; 10] = [1, 1, 0, 1, 0x10, 1, 0x03, 0x9A, 0, 0];
    const NOT_READY: PnioStatus = PnioStatus::read(code1::STATE_CONFLICT);

    #[test]
    fn an_answer_is_read_once_and_by_its_own_relation() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        assert_eq!(channels.read(Some(1), 240), Err(NOT_READY));
        channels.write(1, &READ_922, &mut drive).unwrap();
        assert_eq!(channels.read(Some(2), 240), Err(NOT_READY));
        assert_eq!(channels.read(None, 240), Err(NOT_READY));
        assert_eq!(channels.read(Some(1), 240), Ok(vec![1, 1, 0, 1, 0x42, 1, 0, 1]));
        assert_eq!(channels.read(Some(1), 240), Err(NOT_READY));
    }

    #[test]
    fn a_new_request_replaces_an_unread_answer() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        channels.write(1, &READ_922, &mut drive).unwrap();
        let mut second = READ_922;
        second[0] = 2;
        channels.write(1, &second, &mut drive).unwrap();
        channels.write(7, &READ_922, &mut drive).unwrap();
        assert_eq!(channels.read(Some(1), 240).unwrap()[0], 2);
        channels.forget(7);
        assert_eq!(channels.read(Some(7), 240), Err(NOT_READY));
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let mut drive = Drive::new(&AKD);
        let mut channels = Channels::default();
        assert_eq!(
            channels.write(1, &[], &mut drive),
            Err(PnioStatus::write(code1::LENGTH))
        );
        assert_eq!(
            channels.write(1, &READ_922[..9], &mut drive),
            Err(PnioStatus::write(code1::LENGTH))
        );
        let mut many = READ_922;
        many[3] = 40;
        assert_eq!(
            channels.write(1, &many, &mut drive),
            Err(PnioStatus::write(code1::INVALID_RANGE))
        );
        channels.write(1, &READ_922, &mut drive).unwrap();
        assert_eq!(channels.read(Some(1), 4), Err(PnioStatus::read(code1::LENGTH)));
    }
}
