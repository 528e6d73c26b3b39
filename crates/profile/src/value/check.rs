//! Values checked before they are sent.

use alloc::borrow::ToOwned;
use alloc::string::String;
use core::str::FromStr;

use crate::catalogue::{Access, Parameter, Scale};
use crate::notation::{Elements, Number, ParameterReference, Prefix, Quantity, Target};

use super::choice::Given;

use super::{ParameterProblem, Parameters, Selection};

/// `PARAM=VALUE` as a person wrote it.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// What to write to.
    pub reference: ParameterReference,
    /// What to write: a number, or the text of a selection.
    pub value: Given,
}

impl Assignment {
    /// Creates a whole number for a parameter of the tables, as it travels.
    #[must_use]
    pub fn of(parameter: &Parameter, number: i64) -> Self {
        let base = parameter.base.map(|first| Elements { first, count: 1 });
        Self {
            reference: ParameterReference {
                target: Target::Number(parameter.pnu),
                elements: base,
                prefix: Some(Prefix::Number),
            },
            value: Quantity {
                number: Number::Integer(number),
                unit: None,
            }
            .into(),
        }
    }
}

impl FromStr for Assignment {
    type Err = ParameterProblem;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| ParameterProblem::NoAssignment {
                text: text.to_owned(),
            })?;
        let reference: ParameterReference = name.parse()?;
        let value = Given::of(value).map_err(|problem| ParameterProblem::Quantity {
            // as the caller writes it: only a drive can check the notation of its vendor
            parameter: name.trim().to_owned(),
            problem,
        })?;
        Ok(Self { reference, value })
    }
}

/// A value that fits its parameter as far as the tables state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckedValue {
    /// The number on the wire.
    pub raw: i64,
    /// Its engineering value, at most [`MOST_ROUNDING`] away from the one requested.
    pub engineering: f64,
    /// The engineering value requested.
    pub asked: f64,
    /// Unit of the engineering value, empty for none.
    pub unit: &'static str,
}

/// How far the nearest value that a drive can hold may be from the one requested, as a share of it: a tenth. What is
/// further away is refused before anything is sent, and so is a value that would become zero; what is nearer is
/// reported.
pub const MOST_ROUNDING: f64 = 0.1;
/// Values with a smaller relative difference count as equal.
const SAME: f64 = 1e-6;

/// Returns true when `held` is not a rounding of `asked` but another value.
#[must_use]
pub fn is_other_value(asked: f64, held: f64) -> bool {
    (held - asked).abs() > asked.abs() * MOST_ROUNDING * (1.0 + 1e-9)
}

/// Returns true when `held` is the representable value nearest to `asked`.
#[must_use]
pub fn is_rounding(asked: f64, held: f64) -> bool {
    (held - asked).abs() > asked.abs() * SAME
}

impl CheckedValue {
    /// Returns true when the drive cannot hold the value requested and gets one beside it.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        is_rounding(self.asked, self.engineering)
    }
}

impl Parameters {
    /// Returns the number to send for a value, once unit, limits and access are right.
    ///
    /// A selection takes its texts too. A parameter without table entry takes bare numbers only; its size comes from the
    /// drive. A value between two that the drive can hold becomes the nearer one, if that is not more than
    /// [`MOST_ROUNDING`] away. Raw numbers are sent as they are.
    ///
    /// # Errors
    /// What is wrong, before anything is sent.
    pub fn check(&self, selection: &Selection, given: &Given) -> Result<CheckedValue, ParameterProblem> {
        writable(selection)?;
        if selection.parameter.is_some_and(|parameter| parameter.length > 0) {
            return Err(ParameterProblem::Text {
                parameter: selection.label(),
            });
        }
        let Some(parameter) = selection.parameter else {
            if let Some(whole) = self.catalogue.and_then(|tables| tables.by_high(selection.pnu)) {
                return Err(ParameterProblem::HighHalf {
                    parameter: selection.label(),
                    whole: whole.name,
                });
            }
            return unknown_parameter(selection, &given.quantity(&selection.label())?);
        };
        let chosen = given.choice(selection, parameter)?;
        let quantity = match chosen {
            Some(value) => Quantity {
                number: Number::Integer(value.into()),
                unit: None,
            },
            None => given.quantity(&selection.label())?,
        };
        let quantity = &quantity;
        let (raw, asked) = match quantity.raw() {
            Some(raw) => {
                let raw = self.check_raw(selection, parameter, raw)?;
                (raw, parameter.engineering(raw, &self.scaling))
            }
            None => self.check_engineering(selection, parameter, quantity)?,
        };
        Ok(CheckedValue {
            raw,
            engineering: parameter.engineering(raw, &self.scaling),
            asked,
            unit: parameter.unit_in(&self.scaling),
        })
    }

    /// Returns the characters to send for a string, `None` for a parameter that is not one.
    ///
    /// # Errors
    /// When the string cannot be written, does not hold so many characters, or one of them is not printable ASCII.
    pub fn check_text(
        &self,
        selection: &Selection,
        given: &Given,
    ) -> Result<Option<String>, ParameterProblem> {
        let Some(parameter) = selection.parameter.filter(|parameter| parameter.is_text()) else {
            return Ok(None);
        };
        writable(selection)?;
        // blanks fill the rest of a string, so those at the end are none of the text
        let text = given.text().trim_end_matches(' ');
        if let Some(character) = text.chars().find(|one| !matches!(one, ' '..='~')) {
            return Err(ParameterProblem::Character {
                parameter: selection.label(),
                character,
            });
        }
        if text.len() > usize::from(parameter.length) {
            return Err(ParameterProblem::TextLength {
                parameter: selection.label(),
                length: text.len(),
                most: parameter.length,
            });
        }
        Ok(Some(text.to_owned()))
    }

    fn check_engineering(
        &self,
        selection: &Selection,
        parameter: &'static Parameter,
        quantity: &Quantity,
    ) -> Result<(i64, f64), ParameterProblem> {
        let value =
            parameter
                .quantity(quantity, &self.scaling)
                .map_err(|problem| ParameterProblem::Unit {
                    parameter: selection.label(),
                    problem,
                })?;
        let unit = parameter.unit_in(&self.scaling);
        let converted = quantity.unit.as_deref().is_some_and(|given| given != unit);
        if parameter.scale == Scale::Raw && value % 1.0 != 0.0 && !converted {
            return Err(ParameterProblem::Fraction {
                parameter: selection.label(),
                value,
            });
        }
        let (minimum, maximum) = self.limits(parameter);
        if value < minimum || value > maximum {
            return Err(ParameterProblem::Limit {
                parameter: selection.label(),
                value,
                minimum,
                maximum,
                unit,
            });
        }
        let raw = parameter.raw(value, &self.scaling);
        let held = parameter.engineering(raw, &self.scaling);
        if !is_other_value(value, held) {
            return Ok((raw, value));
        }
        let other = parameter.engineering(if held > value { raw - 1 } else { raw + 1 }, &self.scaling);
        Err(ParameterProblem::Coarse {
            parameter: selection.label(),
            wanted: quantity.clone(),
            nearest: [held.min(other), held.max(other)].map(|value| value.clamp(minimum, maximum)),
            unit,
        })
    }

    /// Checks a raw number bit by bit; the limits apply to it too.
    fn check_raw(
        &self,
        selection: &Selection,
        parameter: &'static Parameter,
        raw: u64,
    ) -> Result<i64, ParameterProblem> {
        let octets = if parameter.wide {
            8
        } else {
            parameter.size.octets()
        };
        let bits = 8 * u32::try_from(octets).unwrap_or(8);
        if bits < 64 && raw >> bits != 0 {
            return Err(ParameterProblem::RawSize {
                parameter: selection.label(),
                raw,
                octets,
            });
        }
        let number = if parameter.signed {
            sign_extend(raw, bits)
        } else {
            i64::try_from(raw).unwrap_or(i64::MAX)
        };
        let (low, high) = parameter.raw_limits(&self.scaling);
        if number < low || number > high {
            let (minimum, maximum) = self.limits(parameter);
            return Err(ParameterProblem::Limit {
                parameter: selection.label(),
                value: parameter.engineering(number, &self.scaling),
                minimum,
                maximum,
                unit: parameter.unit_in(&self.scaling),
            });
        }
        Ok(number)
    }

    /// Lowest and highest engineering value: the known limits, cut to what the size of the parameter holds. A limit far from
    /// every step (1 rpm/s in steps of 763) is the next step inside.
    #[must_use]
    pub fn limits(&self, parameter: &Parameter) -> (f64, f64) {
        let range = parameter.range();
        let fits = |raw: i64| parameter.engineering(raw, &self.scaling);
        let (low, high) = (fits(*range.start()), fits(*range.end()));
        let (minimum, maximum) = parameter.limits_in(&self.scaling);
        let inside = |limit: f64, upwards: bool| {
            let step = fits(parameter.raw_limit(limit, upwards, &self.scaling));
            if is_other_value(limit, step) { step } else { limit }
        };
        (
            minimum.map_or(low, |limit| inside(limit, true).max(low)),
            maximum.map_or(high, |limit| inside(limit, false).min(high)),
        )
    }
}

/// Refuses what cannot be written, and one value for several elements.
fn writable(selection: &Selection) -> Result<(), ParameterProblem> {
    if selection
        .parameter
        .is_some_and(|parameter| parameter.access == Access::ReadOnly)
    {
        return Err(ParameterProblem::ReadOnly {
            parameter: selection.label(),
        });
    }
    if selection.count != 1 {
        return Err(ParameterProblem::ManyElements {
            parameter: selection.label(),
            count: selection.count,
        });
    }
    Ok(())
}

fn unknown_parameter(selection: &Selection, quantity: &Quantity) -> Result<CheckedValue, ParameterProblem> {
    let value = quantity.in_unit("").map_err(|problem| ParameterProblem::Unit {
        parameter: selection.label(),
        problem,
    })?;
    if value % 1.0 != 0.0 {
        return Err(ParameterProblem::Fraction {
            parameter: selection.label(),
            value,
        });
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "saturates; the size is checked against the description of the drive"
    )]
    let raw = quantity
        .raw()
        .map_or(value as i64, |raw| i64::try_from(raw).unwrap_or(i64::MAX));
    Ok(CheckedValue {
        raw,
        engineering: value,
        asked: value,
        unit: "",
    })
}

/// Two's complement of `bits` bits as a number.
pub(super) const fn sign_extend(raw: u64, bits: u32) -> i64 {
    if bits == 0 || bits >= 64 {
        return raw.cast_signed();
    }
    let shift = 64 - bits;
    (raw << shift).cast_signed() >> shift
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;
    use crate::catalogue::{AKD, Scaling};
    use crate::unit::UnitChoice;

    fn check(text: &str) -> Result<CheckedValue, ParameterProblem> {
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let assignment: Assignment = text.parse()?;
        let selection = drive.select(&assignment.reference)?;
        drive.check(&selection, &assignment.value)
    }

    /// A jog ramp is at least one step of PN.ACCSCALING, whatever that is.
    #[test]
    fn the_lowest_jog_ramp_is_one_step() {
        let parameter = AKD.by_pnu(1006).unwrap();
        for (acceleration, lowest) in [(763, 763.0), (1, 1.0), (14_648, 14_648.0)] {
            let drive = Parameters {
                catalogue: Some(&AKD),
                scaling: Scaling {
                    acceleration,
                    ..Scaling::default()
                },
            };
            assert_eq!(drive.limits(parameter).0, lowest);
            assert_eq!(parameter.raw_limits(&drive.scaling), (1, 65_535));
            let selection = drive.select(&ParameterReference::number(1006)).unwrap();
            let below: Assignment = "1006=0.5rpm/s".parse().unwrap();
            let problem = drive.check(&selection, &below.value).unwrap_err();
            assert!(matches!(problem, ParameterProblem::Limit { minimum, .. } if minimum == lowest));
        }
    }

    /// The tables have limits in the unit of a drive as delivered, 2^16 counts for each revolution.
    #[test]
    fn limits_of_positions_are_in_the_unit_of_the_drive() {
        for (unit, per_revolution) in [(2, 360.0), (4, 65_536.0), (0, 4_294_967_296.0)] {
            let rotary_unit = UnitChoice {
                rotary_unit: unit,
                ..UnitChoice::DELIVERED
            };
            let drive = Parameters {
                catalogue: Some(&AKD),
                scaling: Scaling {
                    unit: rotary_unit,
                    ..Scaling::default()
                },
            };
            let parameter = AKD.by_name("SWLS.LIMIT1").unwrap();
            let most = parameter.maximum.unwrap() / 65_536.0 * per_revolution;
            let (low, high) = drive.limits(parameter);
            assert!(
                (high - most.min(i64::MAX as f64)).abs() < 1e-9 * high,
                "{high} {most}"
            );
            assert!((low + high).abs() <= 1e-9 * high, "{low} {high}");
            // 2 * 10^11 revolutions are out of range in every unit that can express them
            let assignment: Assignment = "SWLS.LIMIT1=200000000000rev".parse().unwrap();
            let selection = drive.select(&assignment.reference).unwrap();
            let checked = drive.check(&selection, &assignment.value);
            assert!(
                matches!(checked, Err(ParameterProblem::Limit { .. })),
                "{checked:?}"
            );
        }
    }

    #[test]
    fn values_in_every_view() {
        let value = check("DRV.ACC=5000rpm/s").unwrap();
        assert_eq!(
            (value.raw, value.engineering, value.unit),
            (5_000_000, 5000.0, "rpm/s")
        );
        assert_eq!(check("DRV.ACC=5000").unwrap(), value);
        assert_eq!(check("DRV.ACC = 0x4C4B40").unwrap(), value);
        let rps = check("DRV.ACC=100rps/s").unwrap();
        assert_eq!(rps.raw, 6_000_000);
        assert_eq!(check("930=1").unwrap().raw, 1);
        assert_eq!(check("1004=-100rpm").map(|v| v.raw < 0), Ok(true));
    }

    #[test]
    fn positions_in_the_unit_of_the_drive_and_in_turns() {
        let check = |text: &str, rotary_unit: i64| {
            let drive = Parameters {
                catalogue: Some(&AKD),
                scaling: Scaling {
                    unit: UnitChoice {
                        rotary_unit,
                        custom: (720, 1),
                        ..UnitChoice::DELIVERED
                    },
                    ..Scaling::default()
                },
            };
            let assignment: Assignment = text.parse()?;
            drive.check(&drive.select(&assignment.reference)?, &assignment.value)
        };
        for (text, unit, raw, symbol) in [
            ("MT.P=3rev", 4, 196_608, "counts"),
            ("HOME.DIST=90deg", 4, 16_384, "counts"),
            ("MT.P=3rev", 0, 3 << 32, "counts32"),
            ("MT.P=3rev", 2, 1080, "deg"),
            ("MT.P=-3.141592653589793rad", 2, -180, "deg"),
            ("MT.P=45", 2, 45, "deg"),
            ("MT.P=3rev", 3, 2160, "LU"),
            ("MT.P=7LU", 3, 7, "LU"),
            ("SWLS.LIMIT1=2rev", 4, 131_072, "counts"),
            ("MT.P=5counts", 4, 5, "counts"),
        ] {
            let value = check(text, unit).unwrap();
            assert_eq!((value.raw, value.unit), (raw, symbol), "{text}");
        }
        let error = check("MT.P=5counts", 2).unwrap_err().to_string();
        assert!(error.contains("a bare number in deg"), "{error}");
        assert!(check("FB1.ENCRES=1rev", 4).is_err(), "no position");
    }

    #[test]
    fn the_nearest_value_that_the_drive_holds_or_none() {
        // steps of 0.366 rpm
        let near = check("1004=99rpm").unwrap();
        assert_eq!((near.raw, near.asked, near.is_rounded()), (270, 99.0, true));
        assert!((near.engineering - 98.877).abs() < 1e-3, "{near:?}");
        let slow = check("1004=5").unwrap();
        assert_eq!((slow.raw, slow.is_rounded()), (14, true));
        assert!(!check("DRV.ACC=5000rpm/s").unwrap().is_rounded());
        assert!(!check("1004=0rpm").unwrap().is_rounded());
        assert!(!check("1004=0x0001").unwrap().is_rounded(), "raw is as it is");
        for (text, words) in [
            (
                "1004=0.001rpm",
                "0.001 rpm is not representable: the nearest values are 0 rpm and 0.3662",
            ),
            (
                "1004=-0.01rps",
                "-0.01 rps is not representable: the nearest values are -0.7324",
            ),
            (
                "1004=0.5rpm",
                "0.5 rpm is not representable: the nearest values are 0.3662",
            ),
        ] {
            let problem = check(text).unwrap_err();
            let message = problem.to_string();
            assert!(message.contains(words), "{text}: {message}");
            assert!(problem.hint().is_some());
        }
        let radians = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling {
                unit: UnitChoice {
                    rotary_unit: 1,
                    ..UnitChoice::DELIVERED
                },
                ..Scaling::default()
            },
        };
        let quarter: Assignment = "HOME.DIST=90deg".parse().unwrap();
        let selection = radians.select(&quarter.reference).unwrap();
        let message = radians.check(&selection, &quarter.value).unwrap_err().to_string();
        assert!(
            message.ends_with("90 deg is not representable: the nearest values are 1 rad and 2 rad"),
            "{message}"
        );
    }

    #[test]
    fn nothing_wrong_is_sent() {
        for (text, words) in [
            ("DRV.ACC=5A", "unit of current; accepted: rpm/s"),
            (
                "DRV.ACC=1",
                "DRV.ACC (p2108): 1 rpm/s is outside 1.86 to 50000000 rpm/s",
            ),
            ("DRV.ACC=99999999", "is outside"),
            (
                "MDI_VELOCITY=12000",
                "MDI_VELOCITY (p0035): 12000 rpm is outside 0 to 11999.999997 rpm",
            ),
            ("DRV.ACC=0x1", "is outside"),
            ("VL.FB_32=3", "is read-only"),
            ("947[0..3]=0", "is read-only"),
            ("915[0..3]=0", "one value for 4 elements"),
            ("DRV.OPMODE=1.5", "takes whole numbers, not 1.5"),
            ("DRV.OPMODE=0x100", "does not fit 1 octets"),
            ("DRV.OPMODE=fast", "`fast` is none of its texts: 0 "),
            ("DRV.ACC=fast", "does not start with a number"),
            ("DRV.OPMODE", "PARAM=VALUE"),
            ("DRV.OPMOD=1", "no parameter `DRV.OPMOD`"),
            ("2109=1", "2109 is the high half of DRV.ACC"),
            ("DRV.ACC=1e300", "1e300 rpm/s is outside 1.86 to 50000000 rpm/s"),
        ] {
            let error = check(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn both_sides_of_a_limit() {
        assert!(check("DRV.OPMODE=2").is_ok());
        assert!(check("DRV.OPMODE=3").is_err());
        assert!(check("DRV.ACC=1.86").is_ok());
        assert!(check("DRV.ACC=1.859").is_err());
    }

    #[test]
    fn parameters_without_tables_take_bare_numbers() {
        let plain = Parameters {
            catalogue: None,
            scaling: Scaling::default(),
        };
        let check = |text: &str| {
            let assignment: Assignment = text.parse()?;
            plain.check(&plain.select(&assignment.reference)?, &assignment.value)
        };
        assert_eq!(check("1234=-7").map(|value| value.raw), Ok(-7));
        assert!(check("1234=7rpm").is_err());
        assert!(check("1234=0.5").is_err());
    }

    #[test]
    fn twos_complement() {
        assert_eq!(sign_extend(0xFFFF, 16), -1);
        assert_eq!(sign_extend(0x7FFF, 16), 32767);
        assert_eq!(sign_extend(0x80, 8), -128);
        assert_eq!(sign_extend(u64::MAX, 64), -1);
    }
}
