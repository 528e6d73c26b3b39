//! What a parameter is to drive and client: where a drive has its speed, its ramps, its control word.

use super::{Catalogue, Parameter, Part};

/// One row of `data/<model>/parts.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartRow {
    /// The part.
    pub part: Part,
    /// Number of the parameter.
    pub pnu: u16,
    /// Its subindex where it is an element of a collecting number.
    pub base: Option<u16>,
    /// Values that the part is about; which ones is reported there.
    pub values: &'static [i64],
}

impl PartRow {
    /// The number of the parameter as the vendor counts: a PNU, or an application id.
    #[must_use]
    pub const fn number(&self) -> u16 {
        match self.base {
            Some(id) => id,
            None => self.pnu,
        }
    }
}

/// The numbers of the parameters of a model by their parts, looked up once: a drive that uses parameters reads this
/// instead of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartNumbers([u16; Part::ALL.len()]);

impl PartNumbers {
    /// Returns the numbers as the vendor counts of the first parameter that has each part.
    #[must_use]
    pub const fn of(tables: &Catalogue) -> Self {
        let mut numbers = [0; Part::ALL.len()];
        let mut rest = tables.parts;
        // from the last row on, so that the first one of a part remains
        while let [before @ .., row] = rest {
            numbers[row.part as usize] = row.number();
            rest = before;
        }
        Self(numbers)
    }

    /// The number of the parameter that has this part.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{Part, PartNumbers, VACON, VLT};
    /// assert_eq!(PartNumbers::of(&VLT).get(Part::RampUpTime), Some(341)); // 3-41
    /// assert_eq!(PartNumbers::of(&VACON).get(Part::RampUpTime), Some(103)); // ID 103
    /// assert_eq!(PartNumbers::of(&VACON).get(Part::Stop), None);
    /// ```
    #[must_use]
    pub fn get(&self, part: Part) -> Option<u16> {
        let number = self.0.get(part as usize).copied();
        number.filter(|number| *number != 0)
    }
}

impl Catalogue {
    /// The numbers as the vendor counts of the parameters that have this part, in the order of the table; 0 behind the last
    /// one.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{Part, VLT};
    /// assert_eq!(VLT.part_numbers::<3>(Part::AlarmWord), [1690, 1691, 0]);
    /// ```
    #[must_use]
    pub const fn part_numbers<const N: usize>(&self, part: Part) -> [u16; N] {
        let mut numbers = [0; N];
        let (mut found, mut rest) = (0, self.parts);
        while let [row, behind @ ..] = rest {
            if row.part as usize == part as usize && found < N {
                numbers[found] = row.number();
                found += 1;
            }
            rest = behind;
        }
        numbers
    }

    /// The parameter that has this part; the first one where several have it.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Part, VACON, VLT};
    /// let name = |tables: &profidrive_profile::catalogue::Catalogue| tables.part(Part::Speed).unwrap().name;
    /// assert_eq!([name(&AKD), name(&VLT), name(&VACON)], ["VL.FB_32", "Speed [RPM]", "Motor speed"]);
    /// assert!(VLT.part(Part::Stop).is_none());
    /// ```
    #[must_use]
    pub fn part(&self, part: Part) -> Option<&'static Parameter> {
        self.parts_of(part).next()
    }

    /// Every parameter that has this part, in the order of the table.
    pub fn parts_of(&self, part: Part) -> impl Iterator<Item = &'static Parameter> {
        let rows = self.parts.iter().filter(move |row| row.part == part);
        rows.filter_map(|row| self.by_address(row.pnu, row.base))
    }

    /// Returns the values that the row of a part names.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{Part, VLT};
    /// assert_eq!(VLT.part_values(Part::LostController), [2, 5]); // 8-04: stop, stop and trip
    /// ```
    #[must_use]
    pub fn part_values(&self, part: Part) -> &'static [i64] {
        let row = self.parts.iter().find(|row| row.part == part);
        row.map_or(&[], |row| row.values)
    }

    /// Returns the parts that a parameter has.
    pub fn parts_at(&self, pnu: u16, base: Option<u16>) -> impl Iterator<Item = Part> {
        let rows = self
            .parts
            .iter()
            .filter(move |row| (row.pnu, row.base) == (pnu, base));
        rows.map(|row| row.part)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AKD, Access, VACON, VLT};
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn every_row_is_a_parameter_and_every_model_has_control_and_status_words() {
        for tables in [&AKD, &VLT, &VACON] {
            for row in tables.parts {
                assert!(tables.by_address(row.pnu, row.base).is_some(), "{row:?}");
            }
            for part in [Part::ControlWord, Part::StatusWord, Part::Speed, Part::Page] {
                assert!(tables.part(part).is_some(), "{} {part:?}", tables.model);
            }
            let speed = tables.part(Part::Speed).unwrap();
            assert_eq!((speed.unit, speed.access), ("rpm", Access::ReadOnly));
        }
        assert_eq!(VLT.parts_of(Part::WarningWord).count(), 2);
        assert_eq!(
            AKD.parts_at(3064, None).collect::<Vec<_>>(),
            [Part::VelocityScaling]
        );
    }

    #[test]
    fn values_of_a_part_are_choices_of_its_parameter() {
        for tables in [&AKD, &VLT, &VACON] {
            let about_values = tables.parts.iter().filter(|row| row.part != Part::FaultAction);
            for row in about_values.filter(|row| !row.values.is_empty()) {
                let parameter = tables.by_address(row.pnu, row.base).unwrap();
                for value in row.values {
                    assert!(parameter.choice(*value).is_some(), "{row:?} {value}");
                }
            }
        }
        assert_eq!(VLT.part(Part::LostController).unwrap().pnu, 804);
    }

    #[test]
    fn numbers_of_the_akd_that_a_client_relies_on() {
        for (part, name) in [
            (Part::Acceleration, "DRV.ACC"),
            (Part::CommandSource, "DRV.CMDSOURCE"),
            (Part::TorqueAllowed, "STO.STATE"),
            (Part::SoftwareLimitState, "SWLS.STATE"),
            (Part::PositiveCurrentLimit, "IL.LIMITP"),
            (Part::UnitDenominator, "UNIT.POUT"),
            (Part::FollowingError, "XIST_ERROR"),
        ] {
            assert_eq!(AKD.part(part).map(|found| found.name), Some(name));
        }
    }
}
