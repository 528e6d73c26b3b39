//! Records that are parameters themselves: the index is the number of the vendor, the content the raw value.
//!
//! Source: Vacon 100 PROFINET manual 5.4.4, OPTEA manual p. 116 (ID 102 is 0x1388 in 16 bits and 0x0007A120 in 32).

use profile::catalogue::RecordView;
use profile::parameter::{ErrorNumber, Keep, ParameterAccess, SaveId};
use profinet::wire::PnioStatus;
use profinet::wire::status::record as code1;

use crate::drive::{Drive, WriteChannel};

/// ErrorCode1 for what a parameter does not take.
fn refusal(number: ErrorNumber) -> u8 {
    match number {
        ErrorNumber::UNKNOWN_PARAMETER => code1::INVALID_INDEX,
        ErrorNumber::NOT_CHANGEABLE => code1::ACCESS_DENIED,
        ErrorNumber::LIMIT | ErrorNumber::VALUE => code1::INVALID_PARAMETER,
        _ => code1::STATE_CONFLICT,
    }
}

impl Drive {
    /// Parameter and subindex of a record, and what its number is multiplied with in this view.
    fn of_record(&self, view: RecordView, index: u16) -> Option<(u16, u16, bool, i64)> {
        let catalogue = self.model().catalogue;
        let (pnu, base) = catalogue.meant(index, None);
        let parameter = catalogue.by_address(pnu, Some(base?))?;
        Some((pnu, base?, parameter.signed, view.factor(parameter)))
    }

    /// Returns the value of a record.
    pub(super) fn read_record(&mut self, view: RecordView, index: u16) -> Result<Vec<u8>, PnioStatus> {
        let found = self.of_record(view, index);
        let (pnu, subindex, signed, factor) = found.ok_or(PnioStatus::read(code1::INVALID_INDEX))?;
        let raw = self
            .read(pnu, subindex)
            .map_err(|number| PnioStatus::read(refusal(number)))?;
        let value = if signed {
            i64::from(raw as u16 as i16)
        } else {
            raw.cast_signed()
        };
        let octets = (value * factor).to_be_bytes();
        let from = octets.len().saturating_sub(view.octets.into());
        Ok(octets.get(from..).unwrap_or_default().to_vec())
    }

    /// Sets the value of a record. A Vacon saves it: the result names the save that the answer waits for. A value finer than
    /// the step of the parameter is refused, not cut; that is our reading.
    pub(super) fn write_record(
        &mut self,
        view: RecordView,
        index: u16,
        data: &[u8],
    ) -> Result<Option<SaveId>, PnioStatus> {
        let _ = self.started_save();
        let refuse = PnioStatus::write;
        let found = self.of_record(view, index);
        let (pnu, subindex, signed, factor) = found.ok_or(refuse(code1::INVALID_INDEX))?;
        let native = match (data, signed) {
            _ if data.len() != usize::from(view.octets) => return Err(refuse(code1::LENGTH)),
            ([a, b], true) => i64::from(i16::from_be_bytes([*a, *b])),
            ([a, b], false) => i64::from(u16::from_be_bytes([*a, *b])),
            ([a, b, c, d], true) => i64::from(i32::from_be_bytes([*a, *b, *c, *d])),
            ([a, b, c, d], false) => i64::from(u32::from_be_bytes([*a, *b, *c, *d])),
            _ => return Err(refuse(code1::LENGTH)),
        };
        let raw = native / factor;
        let fits = native % factor == 0
            && if signed {
                i16::try_from(raw).is_ok()
            } else {
                u16::try_from(raw).is_ok()
            };
        let writable = self.attributes(pnu, subindex).is_some_and(|facts| facts.writable);
        match (fits, writable) {
            (_, false) => Err(refuse(code1::ACCESS_DENIED)),
            (false, true) => Err(refuse(code1::INVALID_PARAMETER)),
            (true, true) => self
                .written_through(WriteChannel::Record, |drive| {
                    drive.write(pnu, subindex, raw.cast_unsigned(), Keep::Permanent)
                })
                .map(|()| self.started_save())
                .map_err(|number| refuse(refusal(number))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::VACON;

    const SHORT: RecordView = RecordView {
        subslot: 1,
        octets: 2,
    };
    const LONG: RecordView = RecordView {
        subslot: 2,
        octets: 4,
    };

    #[test]
    fn the_highest_frequency_in_both_views() {
        let mut drive = Drive::new(&VACON);
        assert_eq!(drive.read_record(SHORT, 102), Ok(vec![0x13, 0x88]));
        assert_eq!(drive.read_record(LONG, 102), Ok(vec![0x00, 0x07, 0xA1, 0x20]));
        assert_eq!(drive.read_record(LONG, 600), Ok(vec![0, 0, 0, 0]));
        assert_eq!(drive.write_record(LONG, 102, &[0x00, 0x04, 0x93, 0xE0]), Ok(None));
        assert_eq!(drive.read_record(SHORT, 102), Ok(vec![0x0B, 0xB8])); // 30 Hz
        let refused = |code| Err(PnioStatus::write(code));
        // 60.0001 Hz cannot be kept, and what cannot be kept is not taken
        assert_eq!(
            drive.write_record(LONG, 102, &[0x00, 0x09, 0x27, 0xC1]),
            refused(code1::INVALID_PARAMETER)
        );
        assert_eq!(drive.read_record(SHORT, 102), Ok(vec![0x0B, 0xB8]));
        assert_eq!(drive.write_record(SHORT, 102, &[1]), refused(code1::LENGTH));
        assert_eq!(
            drive.write_record(SHORT, 1, &[0, 1]),
            refused(code1::ACCESS_DENIED)
        );
        assert_eq!(
            drive.write_record(SHORT, 20_000, &[0, 1]),
            refused(code1::INVALID_INDEX)
        );
        assert_eq!(
            drive.read_record(SHORT, 20_000),
            Err(PnioStatus::read(code1::INVALID_INDEX))
        );
        assert_eq!(
            drive.write_record(LONG, 103, &[0, 1, 0, 0]),
            refused(code1::INVALID_PARAMETER)
        );
    }
}
