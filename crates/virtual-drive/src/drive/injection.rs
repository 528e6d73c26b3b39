//! What happens to a drive from outside, and how people write it: `fault=439`, `sto=on`, `load=2.5Nm`.

use std::fmt;
use std::str::FromStr;

use profidrive::notation::Quantity;

/// Something that happens to a drive: to its motor, its load, its wiring, or a fault out of nowhere.
///
/// The notation is the one of plant files and of `profidrive inject`; [`Injection::keys`] lists it.
///
/// ```
/// use virtual_drive::drive::Injection;
/// assert_eq!("sto=on".parse(), Ok(Injection::Sto(true)));
/// assert_eq!("load=2.5Nm".parse(), Ok(Injection::Load(2.5)));
/// let lasting: Injection = "fault=439!".parse()?;
/// assert_eq!(lasting, Injection::Fault { number: 439, lasting: true });
/// assert_eq!(lasting.to_string(), "fault=439!");
/// # Ok::<(), virtual_drive::drive::InjectionError>(())
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
    /// `brake=on`, `off`, `auto`: the holding brake; `None` is as the drive wants it.
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
}

/// A text that is no injection.
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
    #[error("`{key}` is nothing that can happen to a drive; keys: {}", key_list())]
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
    /// The keys of the notation, in the order in which help shows them.
    pub fn keys() -> impl Iterator<Item = Key> {
        ROWS.iter().map(|row| Key {
            key: row.key,
            example: row.example,
            meaning: row.meaning,
        })
    }
}

/// How a value is written, and how it becomes an injection and back.
#[derive(Clone, Copy)]
enum Form {
    /// A number, perhaps with `!`.
    Number(
        fn(u16, bool) -> Option<Injection>,
        fn(&Injection) -> Option<(u16, bool)>,
    ),
    /// One of two words; the first is true.
    Switch(
        [&'static str; 2],
        fn(bool) -> Injection,
        fn(&Injection) -> Option<bool>,
    ),
    /// `on`, `off` or `auto`.
    Forced(
        fn(Option<bool>) -> Injection,
        fn(&Injection) -> Option<Option<bool>>,
    ),
    /// A value with a unit, or `auto` where the drive can go on by itself.
    Value {
        unit: &'static str,
        /// Lowest and highest; what lies outside is no drive any more.
        range: [f64; 2],
        auto: bool,
        make: fn(Option<f64>) -> Injection,
        take: fn(&Injection) -> Option<Option<f64>>,
    },
}

/// One row of the table.
struct Row {
    key: &'static str,
    example: &'static str,
    meaning: &'static str,
    form: Form,
}

const ON_OFF: [&str; 2] = ["on", "off"];

/// The notation: everything that can be written, and nothing else.
static ROWS: &[Row] = &[
    Row {
        key: "fault",
        example: "fault=439",
        meaning: "a fault comes; with ! behind the number its cause lasts",
        form: Form::Number(
            |number, lasting| Some(Injection::Fault { number, lasting }),
            |injection| match *injection {
                Injection::Fault { number, lasting } => Some((number, lasting)),
                _ => None,
            },
        ),
    },
    Row {
        key: "warning",
        example: "warning=107",
        meaning: "a warning comes and stays until it is cleared",
        form: Form::Number(
            |number, lasting| (!lasting).then_some(Injection::Warning { number }),
            |injection| match *injection {
                Injection::Warning { number } => Some((number, false)),
                _ => None,
            },
        ),
    },
    Row {
        key: "clear",
        example: "clear=439",
        meaning: "the cause of that fault or warning is gone",
        form: Form::Number(
            |number, lasting| (!lasting).then_some(Injection::ClearCause { number }),
            |injection| match *injection {
                Injection::ClearCause { number } => Some((number, false)),
                _ => None,
            },
        ),
    },
    Row {
        key: "sto",
        example: "sto=on",
        meaning: "safe torque off",
        form: Form::Switch(ON_OFF, Injection::Sto, |injection| match *injection {
            Injection::Sto(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "load",
        example: "load=2.5Nm",
        meaning: "torque against positive rotation",
        form: Form::Value {
            unit: "Nm",
            range: [-10_000.0, 10_000.0],
            auto: false,
            make: |torque| Injection::Load(torque.unwrap_or(0.0)),
            take: |injection| match *injection {
                Injection::Load(torque) => Some(Some(torque)),
                _ => None,
            },
        },
    },
    Row {
        key: "block",
        example: "block=on",
        meaning: "nothing can turn the shaft",
        form: Form::Switch(ON_OFF, Injection::Block, |injection| match *injection {
            Injection::Block(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "limit+",
        example: "limit+=on",
        meaning: "the positive limit switch; auto: where the axis is",
        form: Form::Forced(
            |active| Injection::Limit {
                positive: true,
                active,
            },
            |injection| match *injection {
                Injection::Limit {
                    positive: true,
                    active,
                } => Some(active),
                _ => None,
            },
        ),
    },
    Row {
        key: "limit-",
        example: "limit-=on",
        meaning: "the negative limit switch; auto: where the axis is",
        form: Form::Forced(
            |active| Injection::Limit {
                positive: false,
                active,
            },
            |injection| match *injection {
                Injection::Limit {
                    positive: false,
                    active,
                } => Some(active),
                _ => None,
            },
        ),
    },
    Row {
        key: "home",
        example: "home=on",
        meaning: "the home switch; auto: where the axis is",
        form: Form::Forced(Injection::HomeSwitch, |injection| match *injection {
            Injection::HomeSwitch(active) => Some(active),
            _ => None,
        }),
    },
    Row {
        key: "feedback",
        example: "feedback=lost",
        meaning: "the feedback of the motor: lost or ok",
        form: Form::Switch(
            ["lost", "ok"],
            Injection::FeedbackLoss,
            |injection| match *injection {
                Injection::FeedbackLoss(lost) => Some(lost),
                _ => None,
            },
        ),
    },
    Row {
        key: "brake",
        example: "brake=on",
        meaning: "the holding brake is applied; auto: as the drive wants it",
        form: Form::Forced(Injection::Brake, |injection| match *injection {
            Injection::Brake(active) => Some(active),
            _ => None,
        }),
    },
    Row {
        key: "bus",
        example: "bus=450V",
        meaning: "voltage of the DC bus; auto: as mains and motor make it",
        form: Form::Value {
            unit: "V",
            range: [0.0, 2000.0],
            auto: true,
            make: Injection::BusVoltage,
            take: |injection| match *injection {
                Injection::BusVoltage(voltage) => Some(voltage),
                _ => None,
            },
        },
    },
    Row {
        key: "mains",
        example: "mains=off",
        meaning: "the supply",
        form: Form::Switch(ON_OFF, Injection::Mains, |injection| match *injection {
            Injection::Mains(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "regen",
        example: "regen=off",
        meaning: "the brake resistor",
        form: Form::Switch(ON_OFF, Injection::Regen, |injection| match *injection {
            Injection::Regen(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "motor-temperature",
        example: "motor-temperature=160degC",
        meaning: "temperature of the motor winding; auto: as the current makes it",
        form: Form::Value {
            unit: "degC",
            range: [-273.0, 1000.0],
            auto: true,
            make: Injection::MotorTemperature,
            take: |injection| match *injection {
                Injection::MotorTemperature(temperature) => Some(temperature),
                _ => None,
            },
        },
    },
    Row {
        key: "power-temperature",
        example: "power-temperature=95degC",
        meaning: "temperature of the power stage; auto: as the current makes it",
        form: Form::Value {
            unit: "degC",
            range: [-273.0, 1000.0],
            auto: true,
            make: Injection::PowerTemperature,
            take: |injection| match *injection {
                Injection::PowerTemperature(temperature) => Some(temperature),
                _ => None,
            },
        },
    },
    Row {
        key: "hardware-disable",
        example: "hardware-disable=on",
        meaning: "the enable input is taken away",
        form: Form::Switch(ON_OFF, Injection::HardwareDisable, |injection| match *injection {
            Injection::HardwareDisable(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "controlled-stop",
        example: "controlled-stop=on",
        meaning: "the input that stops the axis and then disables",
        form: Form::Switch(ON_OFF, Injection::ControlledStop, |injection| match *injection {
            Injection::ControlledStop(on) => Some(on),
            _ => None,
        }),
    },
];

fn key_list() -> String {
    ROWS.iter().map(|row| row.key).collect::<Vec<_>>().join(", ")
}

impl Form {
    fn parse(&self, text: &str) -> Result<Injection, String> {
        match *self {
            Self::Number(make, _) => {
                let (digits, lasting) = match text.strip_suffix('!') {
                    Some(digits) => (digits, true),
                    None => (text, false),
                };
                let digits = digits.trim_start_matches(['F', 'f', 'n']);
                let number: u16 = digits
                    .parse()
                    .ok()
                    .filter(|number| *number != 0)
                    .ok_or_else(|| "a number from 1 to 65535 belongs there".to_owned())?;
                make(number, lasting).ok_or_else(|| "`!` goes with faults only".to_owned())
            }
            Self::Switch([yes, no], make, _) => match text {
                _ if text == yes => Ok(make(true)),
                _ if text == no => Ok(make(false)),
                _ => Err(format!("write {yes} or {no}")),
            },
            Self::Forced(make, _) => match text {
                "on" => Ok(make(Some(true))),
                "off" => Ok(make(Some(false))),
                "auto" => Ok(make(None)),
                _ => Err("write on, off or auto".to_owned()),
            },
            Self::Value {
                unit,
                range: [low, high],
                auto,
                make,
                ..
            } => {
                if auto && text == "auto" {
                    return Ok(make(None));
                }
                let quantity: Quantity = text
                    .parse()
                    .map_err(|error: profidrive::notation::QuantityError| error.to_string())?;
                let value = quantity.in_unit(unit).map_err(|error| error.to_string())?;
                if (low..=high).contains(&value) {
                    Ok(make(Some(value)))
                } else {
                    Err(format!("write {low}{unit} to {high}{unit}"))
                }
            }
        }
    }

    /// The value, when the injection is of this form.
    fn show(&self, injection: &Injection) -> Option<String> {
        let word = |on: bool| if on { "on" } else { "off" };
        Some(match *self {
            Self::Number(_, take) => {
                let (number, lasting) = take(injection)?;
                format!("{number}{}", if lasting { "!" } else { "" })
            }
            Self::Switch([yes, no], _, take) => (if take(injection)? { yes } else { no }).to_owned(),
            Self::Forced(_, take) => take(injection)?.map_or("auto", word).to_owned(),
            Self::Value { unit, take, .. } => {
                take(injection)?.map_or_else(|| "auto".to_owned(), |value| format!("{value}{unit}"))
            }
        })
    }
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
            ("motor-temperature=160", Injection::MotorTemperature(Some(160.0))),
        ] {
            assert_eq!(parse(text), Ok(injection), "{text}");
        }
    }

    #[test]
    fn mistakes_tell_what_can_stand_there() {
        for (text, words) in [
            ("fault", "write KEY=VALUE"),
            ("", "keys: fault, warning"),
            (
                "fire=on",
                "`fire` is nothing that can happen to a drive; keys: fault, ",
            ),
            ("fault=x", "a number from 1 to 65535"),
            ("fault=0", "a number from 1 to 65535"),
            ("clear=439!", "`!` goes with faults only"),
            ("sto=maybe", "`sto=maybe`: write on or off"),
            ("feedback=off", "write lost or ok"),
            ("home=lost", "write on, off or auto"),
            ("load=auto", "load=auto"),
            ("load=2V", "load=2V"),
            ("bus=inf", "bus=inf"),
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
