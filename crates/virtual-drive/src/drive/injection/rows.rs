//! The notation of injections: everything that can be written, and nothing else.

use profile::notation::Quantity;

use super::Injection;

/// How a value is written, and how it becomes an injection and back.
#[derive(Clone, Copy)]
pub(super) enum Form {
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
    /// The number of one of several, from 1, and `on` or `off` behind a colon.
    Numbered(fn(u8, bool) -> Injection, fn(&Injection) -> Option<(u8, bool)>),
    /// A value with a unit, or `auto` where the drive can go on by itself.
    Value {
        unit: &'static str,
        /// Lowest and highest; what lies outside is not a drive any more.
        range: [f64; 2],
        auto: bool,
        make: fn(Option<f64>) -> Injection,
        take: fn(&Injection) -> Option<Option<f64>>,
    },
}

/// One row of the table.
pub(super) struct Row {
    pub key: &'static str,
    pub example: &'static str,
    pub meaning: &'static str,
    pub form: Form,
}

const ON_OFF: [&str; 2] = ["on", "off"];

/// The notation: everything that can be written, and nothing else.
pub(super) static ROWS: &[Row] = &[
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
        meaning: "the holding brake is applied; auto: as the drive commands it",
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
    Row {
        key: "input",
        example: "input=1:on",
        meaning: "the level at that digital input; DINx.MODE sets what it does",
        form: Form::Numbered(
            |number, on| Injection::Input { number, on },
            |injection| match *injection {
                Injection::Input { number, on } => Some((number, on)),
                _ => None,
            },
        ),
    },
    Row {
        key: "local",
        example: "local=on",
        meaning: "the panel takes the drive and stops it; off: the bus has it again",
        form: Form::Switch(ON_OFF, Injection::Local, |injection| match *injection {
            Injection::Local(on) => Some(on),
            _ => None,
        }),
    },
    Row {
        key: "local-speed",
        example: "local-speed=300rpm",
        meaning: "the panel takes the drive and runs it; auto: it stops it",
        form: Form::Value {
            unit: "rpm",
            range: [-100_000.0, 100_000.0],
            auto: true,
            make: Injection::LocalSpeed,
            take: |injection| match *injection {
                Injection::LocalSpeed(speed) => Some(speed),
                _ => None,
            },
        },
    },
    Row {
        key: "b1",
        example: "b1=5s",
        meaning: "button B1 of an AKD is held: from 5 s on, with rotary switches at 0, resets its address at power-on",
        form: Form::Value {
            unit: "s",
            range: [0.0, 60.0],
            auto: false,
            make: |seconds| Injection::ButtonB1(seconds.unwrap_or(0.0)),
            take: |injection| match *injection {
                Injection::ButtonB1(seconds) => Some(Some(seconds)),
                _ => None,
            },
        },
    },
];

impl Form {
    pub fn parse(&self, text: &str) -> Result<Injection, String> {
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
            Self::Numbered(make, _) => {
                let read = || {
                    let (number, word) = text.split_once(':')?;
                    let number = number.trim();
                    let number = number.strip_prefix("DIN").unwrap_or(number);
                    let number = number.parse().ok().filter(|number| *number != 0)?;
                    match word.trim() {
                        "on" => Some(make(number, true)),
                        "off" => Some(make(number, false)),
                        _ => None,
                    }
                };
                read().ok_or_else(|| "write NUMBER:on or NUMBER:off, numbers from 1".to_owned())
            }
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
                    .map_err(|error: profile::notation::QuantityError| error.to_string())?;
                let value = quantity.in_unit(unit).map_err(|error| error.to_string())?;
                if (low..=high).contains(&value) {
                    Ok(make(Some(value)))
                } else {
                    Err(format!("write {low}{unit} to {high}{unit}"))
                }
            }
        }
    }

    /// Returns the value, when the injection is of this form.
    pub fn show(&self, injection: &Injection) -> Option<String> {
        let word = |on: bool| if on { "on" } else { "off" };
        Some(match *self {
            Self::Number(_, take) => {
                let (number, lasting) = take(injection)?;
                format!("{number}{}", if lasting { "!" } else { "" })
            }
            Self::Switch([yes, no], _, take) => (if take(injection)? { yes } else { no }).to_owned(),
            Self::Numbered(_, take) => {
                let (number, on) = take(injection)?;
                format!("{number}:{}", word(on))
            }
            Self::Forced(_, take) => take(injection)?.map_or("auto", word).to_owned(),
            Self::Value { unit, take, .. } => {
                take(injection)?.map_or_else(|| "auto".to_owned(), |value| format!("{value}{unit}"))
            }
        })
    }
}
