//! What happens to a drive from outside, and how people write it: `fault=439`, `sto=on`, `load=2.5Nm`.

mod rows;

use std::fmt;
use std::str::FromStr;

use rows::ROWS;

/// Something that happens to a drive: to its motor, its load, its wiring, or a fault out of nowhere.
///
/// The notation is the one of plant files and of `profidrive inject`; [`Injection::keys`] lists it.
///
/// ```
/// use profidrive_virtual_drive::drive::Injection;
/// assert_eq!("sto=on".parse(), Ok(Injection::Sto(true)));
/// assert_eq!("load=2.5Nm".parse(), Ok(Injection::Load(2.5)));
/// let lasting: Injection = "fault=439!".parse()?;
/// assert_eq!(lasting, Injection::Fault { number: 439, lasting: true });
/// assert_eq!(lasting.to_string(), "fault=439!");
/// # Ok::<(), profidrive_virtual_drive::drive::InjectionError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Injection {
    /// `fault=439`, or `fault=439!` for one that cannot be acknowledged before `clear=439`.
    Fault {
        /// Its number.
        number: u16,
        /// Its cause lasts.
        lasting: bool,
    },
    /// `warning=107`: there until `clear=107`.
    Warning {
        /// Its number.
        number: u16,
    },
    /// `clear=439`: the cause of a lasting fault or of a warning is gone; the fault can be acknowledged then.
    ClearCause {
        /// Number of the fault or warning.
        number: u16,
    },
    /// `sto=on`: safe torque off; `sto=off`: torque is allowed.
    Sto(bool),
    /// `load=2.5Nm`: torque against positive rotation.
    Load(f64),
    /// `block=on`: nothing can turn the shaft.
    Block(bool),
    /// `limit+=on`, `limit-=off`, `auto`: a hardware limit switch; `None` is where the axis is.
    Limit {
        /// Of the positive direction.
        positive: bool,
        /// Touched or not.
        active: Option<bool>,
    },
    /// `home=on`, `off`, `auto`: the home switch.
    HomeSwitch(Option<bool>),
    /// `feedback=lost`, `ok`: the feedback of the motor.
    FeedbackLoss(bool),
    /// `brake=on`, `off`, `auto`: the holding brake; `None` is as the drive commands it.
    Brake(Option<bool>),
    /// `bus=450V`, `auto`: voltage of the DC bus, `None` as mains and motor make it.
    BusVoltage(Option<f64>),
    /// `mains=on`, `off`.
    Mains(bool),
    /// `regen=on`, `off`: the brake resistor.
    Regen(bool),
    /// `motor-temperature=160degC`, `auto`.
    MotorTemperature(Option<f64>),
    /// `power-temperature=95degC`, `auto`: of the power stage.
    PowerTemperature(Option<f64>),
    /// `hardware-disable=on`, `off`: the enable input.
    HardwareDisable(bool),
    /// `controlled-stop=on`, `off`: the input that stops and disables.
    ControlledStop(bool),
    /// `input=1:on`, `off`: the level at a digital input; what it does is the business of its DINx.MODE.
    Input {
        /// Its number, from 1.
        number: u8,
        /// High.
        on: bool,
    },
    /// `local=on`: the panel takes the drive and stops it (VLT `[Off]`, Vacon keypad); `off`: the bus has it again.
    Local(bool),
    /// `local-speed=300rpm`: the panel takes the drive and runs it (VLT `[Hand on]`); `auto`: it stops it. A drive in
    /// another mode than speed is taken and not run.
    LocalSpeed(Option<f64>),
    /// `b1=5s`: button B1 of an AKD is held for so long.
    ButtonB1(f64),
}

/// A text that is not an injection.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InjectionError {
    /// No `=` in it.
    #[error("`{text}`: write KEY=VALUE, for example {}; keys: {}", ROWS[0].example, key_list())]
    NoValue {
        /// The text.
        text: String,
    },
    /// Nothing happens under this name.
    #[error("`{key}` is no event of a drive; keys: {}", key_list())]
    UnknownKey {
        /// The key as given.
        key: String,
    },
    /// The value does not fit the key.
    #[error("`{key}={value}`: {expected}")]
    Value {
        /// The key.
        key: &'static str,
        /// The value as given.
        value: String,
        /// What can stand there.
        expected: String,
    },
}

/// One key of the notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key {
    /// Left of the `=`.
    pub key: &'static str,
    /// A whole example.
    pub example: &'static str,
    /// What it does.
    pub meaning: &'static str,
}

impl Injection {
    /// Returns the keys of the notation, in the order in which help shows them.
    pub fn keys() -> impl Iterator<Item = Key> {
        ROWS.iter().map(|row| Key {
            key: row.key,
            example: row.example,
            meaning: row.meaning,
        })
    }
}

fn key_list() -> String {
    ROWS.iter().map(|row| row.key).collect::<Vec<_>>().join(", ")
}

impl FromStr for Injection {
    type Err = InjectionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (key, value) = text.split_once('=').ok_or_else(|| InjectionError::NoValue {
            text: text.chars().take(80).collect(),
        })?;
        let (key, value) = (key.trim(), value.trim());
        let row = ROWS
            .iter()
            .find(|row| row.key.eq_ignore_ascii_case(key))
            .ok_or_else(|| InjectionError::UnknownKey {
                key: key.chars().take(80).collect(),
            })?;
        row.form.parse(value).map_err(|expected| InjectionError::Value {
            key: row.key,
            value: value.chars().take(80).collect(),
            expected,
        })
    }
}

impl fmt::Display for Injection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = ROWS
            .iter()
            .find_map(|row| row.form.show(self).map(|value| (row.key, value)));
        match shown {
            Some((key, value)) => write!(f, "{key}={value}"),
            None => f.write_str("nothing"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parse(text: &str) -> Result<Injection, String> {
        text.parse().map_err(|error: InjectionError| error.to_string())
    }

    #[test]
    fn every_example_is_written_as_it_is_read() {
        for key in Injection::keys() {
            let injection = parse(key.example).unwrap();
            assert_eq!(injection.to_string(), key.example);
            assert!(key.example.starts_with(key.key));
            assert!(!key.meaning.is_empty());
        }
    }

    #[test]
    fn the_ways_to_write() {
        for (text, injection) in [
            (
                " FAULT = F439 ",
                Injection::Fault {
                    number: 439,
                    lasting: false,
                },
            ),
            (
                "fault=439!",
                Injection::Fault {
                    number: 439,
                    lasting: true,
                },
            ),
            ("warning=n107", Injection::Warning { number: 107 }),
            (
                "limit+=auto",
                Injection::Limit {
                    positive: true,
                    active: None,
                },
            ),
            (
                "limit-=off",
                Injection::Limit {
                    positive: false,
                    active: Some(false),
                },
            ),
            ("load=-500mNm", Injection::Load(-0.5)),
            ("bus=auto", Injection::BusVoltage(None)),
            ("feedback=ok", Injection::FeedbackLoss(false)),
            ("input = DIN7 : off", Injection::Input { number: 7, on: false }),
            ("motor-temperature=160", Injection::MotorTemperature(Some(160.0))),
        ] {
            assert_eq!(parse(text), Ok(injection), "{text}");
        }
    }

    #[test]
    fn mistakes_list_the_accepted_values() {
        for (text, words) in [
            ("fault", "write KEY=VALUE"),
            ("", "keys: fault, warning"),
            ("fire=on", "`fire` is no event of a drive; keys: fault, "),
            ("fault=x", "a number from 1 to 65535"),
            ("fault=0", "a number from 1 to 65535"),
            ("clear=439!", "`!` goes with faults only"),
            ("sto=maybe", "`sto=maybe`: write on or off"),
            ("feedback=off", "write lost or ok"),
            ("home=lost", "write on, off or auto"),
            ("load=auto", "load=auto"),
            ("load=2V", "load=2V"),
            ("bus=inf", "bus=inf"),
            ("input=on", "write NUMBER:on or NUMBER:off"),
            ("input=0:on", "write NUMBER:on or NUMBER:off"),
            ("input=1:auto", "write NUMBER:on or NUMBER:off"),
            ("input=256:on", "write NUMBER:on or NUMBER:off"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn numbers_and_values_come_back(number in 1_u16.., lasting: bool, value in -1e4..1e4_f64) {
            for injection in [
                Injection::Fault { number, lasting },
                Injection::ClearCause { number },
                Injection::Load(value),
                Injection::Input { number: number.to_be_bytes()[1].max(1), on: lasting },
                Injection::BusVoltage(Some(value.abs() / 5.0)),
                Injection::PowerTemperature(Some(value / 50.0)),
            ] {
                prop_assert_eq!(parse(&injection.to_string()), Ok(injection));
            }
        }

        #[test]
        fn no_text_does_harm(text in ".{0,60}") {
            let _ = parse(&text);
        }
    }
}
