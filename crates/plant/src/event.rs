//! What can happen to a drive: to the drive itself, to its cable, to its parameter answers.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use network::host::Host;
use network::impaired::Impaired;
use profile::catalogue::{Part, name_distance};
use profile::notation::Quantity;
use virtual_drive::drive::{Injection, InjectionError};
use virtual_drive::model::Model;
use virtual_drive::station::{AnswerFault, Station};

/// A virtual drive as a whole station on a cable that can be spoiled.
pub type Unit = Impaired<Host<Station>>;

/// Something that happens to a drive, in the notation `key=value`; [`keys`] lists all of it.
///
/// ```
/// use profidrive_plant::PlantEvent;
/// let pulled: PlantEvent = "cable=pulled".parse()?;
/// assert_eq!(pulled.undo().unwrap().to_string(), "cable=plugged");
/// let lasting: PlantEvent = "fault=439!".parse()?;
/// assert_eq!(lasting.undo().unwrap().to_string(), "clear=439");
/// # Ok::<(), profidrive_plant::PlantEventError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlantEvent {
    /// To motor, load, wiring and power of the drive.
    Drive(Injection),
    /// `cable=pulled`, `cable=plugged`.
    Cable {
        /// Nothing passes.
        pulled: bool,
    },
    /// To the frames that pass, in both directions.
    Link(LinkFault),
    /// To the answers of its parameter manager.
    Answers(AnswerFault),
}

/// One quality of a bad cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinkFault {
    /// `loss=5%`: this share of frames is lost, 0 to 1.
    Loss(f64),
    /// `duplicate=1%`: this share arrives twice.
    Duplicate(f64),
    /// `overtaken=2%`: this share is overtaken by frames of the next millisecond.
    Overtaken(f64),
    /// `delay=20ms`: every frame is late.
    Delay(Duration),
    /// `jitter=5ms`: and by chance up to this much more.
    Jitter(Duration),
}

/// The text is no event.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantEventError {
    /// No `=` in it.
    #[error("`{text}`: write KEY=VALUE, for example fault=439; {}", possible(.text))]
    NoValue {
        /// The text.
        text: String,
    },
    /// Nothing happens under this name.
    #[error("`{key}` is not an event of a drive; {}", possible(.key))]
    UnknownKey {
        /// The key.
        key: String,
    },
    /// The value does not fit.
    #[error("`{text}`: {expected}")]
    Value {
        /// The text.
        text: String,
        /// What can stand there.
        expected: &'static str,
    },
    /// The drive has no fault or warning of this number.
    #[error("`{text}`: {drive} has no {kind} {number}{}", nearest(.near))]
    UnknownNumber {
        /// The text.
        text: String,
        /// Name of the model.
        drive: &'static str,
        /// `fault`, `warning`, or both.
        kind: &'static str,
        /// The number.
        number: u16,
        /// The numbers next to it that there are.
        near: Vec<u16>,
    },
    /// The drive has no digital input of this number.
    #[error("`{text}`: {drive} has {}", inputs(*.most))]
    NoInput {
        /// The text.
        text: String,
        /// Name of the model.
        drive: &'static str,
        /// How many it has that can be given a level.
        most: usize,
    },
    /// The drive's own part of the notation.
    #[error(transparent)]
    Drive(#[from] InjectionError),
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

const fn key(key: &'static str, example: &'static str, meaning: &'static str) -> Key {
    Key {
        key,
        example,
        meaning,
    }
}

/// The keys that are not the drive's own.
static EXTERNAL: [Key; 7] = [
    key("cable", "cable=pulled", "pulled or plugged"),
    key("loss", "loss=5%", "share of frames lost, both directions"),
    key("duplicate", "duplicate=1%", "share of frames that arrive twice"),
    key(
        "overtaken",
        "overtaken=2%",
        "share of frames that later ones overtake",
    ),
    key("delay", "delay=20ms", "every frame is that much late"),
    key("jitter", "jitter=5ms", "and by chance up to that much more"),
    key(
        "answers",
        "answers=late 500ms",
        "parameter answers: none (all is well), silent, late TIME, reference, cut, error NUMBER; of these a PPO type and a serial line have error NUMBER",
    ),
];

/// Everything that can be written, in the order in which help shows it.
pub fn keys() -> impl Iterator<Item = Key> {
    Injection::keys()
        .map(|row| key(row.key, row.example, row.meaning))
        .chain(EXTERNAL)
}

/// The key nearest to a misspelled one, then all keys.
fn possible(text: &str) -> String {
    let all: Vec<&str> = keys().map(|key| key.key).collect();
    let list = format!("keys: {}", all.join(", "));
    // one wrong letter in three is still a misspelling, more is another word
    let bound = (text.len() / 3).max(1);
    let near = all.into_iter().map(|key| (name_distance(key, text), key)).min();
    match near {
        Some((distance, key)) if distance <= bound => format!("nearest key: {key}; {list}"),
        _ => list,
    }
}

fn nearest(near: &[u16]) -> String {
    let near: Vec<_> = near.iter().map(u16::to_string).collect();
    format!("; next to it there are {}", near.join(" and "))
}

fn inputs(most: usize) -> String {
    match most {
        0 => "no digital inputs here".into(),
        most => format!("the digital inputs 1 to {most}"),
    }
}

impl PlantEvent {
    /// Whether it can happen to a drive of this model: it must have the fault, warning or digital input that is
    /// named.
    ///
    /// # Errors
    /// [`PlantEventError::UnknownNumber`] with the numbers next to it, [`PlantEventError::NoInput`].
    pub fn fits(&self, model: &Model) -> Result<(), PlantEventError> {
        let (kind, number, meant): (_, _, &[bool]) = match *self {
            Self::Drive(Injection::Fault { number, .. }) => ("fault", number, &[false]),
            Self::Drive(Injection::Warning { number }) => ("warning", number, &[true]),
            Self::Drive(Injection::ClearCause { number }) => ("fault or warning", number, &[false, true]),
            Self::Drive(Injection::ButtonB1(_)) if model.number(Part::AddressMode).is_none() => {
                return Err(PlantEventError::Value {
                    text: self.to_string(),
                    expected: "this drive has no button B1",
                });
            }
            Self::Drive(Injection::Input { number, .. }) => {
                let most = model.terminals.len();
                if usize::from(number) <= most {
                    return Ok(());
                }
                return Err(PlantEventError::NoInput {
                    text: self.to_string(),
                    drive: model.catalogue.device.station_type,
                    most,
                });
            }
            _ => return Ok(()),
        };
        let catalogue = model.catalogue;
        if meant
            .iter()
            .any(|warning| catalogue.fault(number, *warning).is_some())
        {
            return Ok(());
        }
        let there = || {
            let all = catalogue.faults.iter();
            all.filter(|row| meant.contains(&row.warning))
                .map(|row| row.number)
        };
        let below = there().filter(|other| *other < number).max();
        let above = there().filter(|other| *other > number).min();
        Err(PlantEventError::UnknownNumber {
            text: self.to_string(),
            drive: catalogue.device.station_type,
            kind,
            number,
            near: below.into_iter().chain(above).collect(),
        })
    }

    /// Returns the event that ends it; `None` for an event without an end, such as a fault.
    #[must_use]
    pub fn undo(&self) -> Option<Self> {
        Some(match *self {
            Self::Drive(injection) => Self::Drive(undo(injection)?),
            Self::Cable { pulled } => Self::Cable { pulled: !pulled },
            Self::Link(fault) => Self::Link(match fault {
                LinkFault::Loss(_) => LinkFault::Loss(0.0),
                LinkFault::Duplicate(_) => LinkFault::Duplicate(0.0),
                LinkFault::Overtaken(_) => LinkFault::Overtaken(0.0),
                LinkFault::Delay(_) => LinkFault::Delay(Duration::ZERO),
                LinkFault::Jitter(_) => LinkFault::Jitter(Duration::ZERO),
            }),
            Self::Answers(_) => Self::Answers(AnswerFault::None),
        })
    }

    /// Lets it happen to a drive.
    pub fn apply(&self, unit: &mut Unit) {
        match *self {
            Self::Drive(injection) => unit.inner_mut().endpoint_mut().drive_mut().inject(injection),
            Self::Cable { pulled } => unit.pull_cable(pulled),
            Self::Link(fault) => {
                let mut conditions = unit.conditions();
                match fault {
                    LinkFault::Loss(share) => conditions.loss = share,
                    LinkFault::Duplicate(share) => conditions.duplicate = share,
                    LinkFault::Overtaken(share) => conditions.reorder = share,
                    LinkFault::Delay(time) => conditions.delay = time,
                    LinkFault::Jitter(time) => conditions.jitter = time,
                }
                unit.set_conditions(conditions);
            }
            Self::Answers(fault) => unit.inner_mut().endpoint_mut().set_answer_fault(fault),
        }
    }
}

/// Returns the event that ends one inside the drive.
fn undo(injection: Injection) -> Option<Injection> {
    use Injection as I;
    Some(match injection {
        I::Fault {
            number,
            lasting: true,
        }
        | I::Warning { number } => I::ClearCause { number },
        I::Sto(on) => I::Sto(!on),
        I::Load(_) => I::Load(0.0),
        I::Block(on) => I::Block(!on),
        I::Limit { positive, .. } => I::Limit {
            positive,
            active: None,
        },
        I::HomeSwitch(_) => I::HomeSwitch(None),
        I::FeedbackLoss(lost) => I::FeedbackLoss(!lost),
        I::Brake(_) => I::Brake(None),
        I::BusVoltage(_) => I::BusVoltage(None),
        I::Mains(on) => I::Mains(!on),
        I::Regen(on) => I::Regen(!on),
        I::MotorTemperature(_) => I::MotorTemperature(None),
        I::PowerTemperature(_) => I::PowerTemperature(None),
        I::HardwareDisable(on) => I::HardwareDisable(!on),
        I::ControlledStop(on) => I::ControlledStop(!on),
        I::Input { number, on } => I::Input { number, on: !on },
        I::Local(on) => I::Local(!on),
        I::LocalSpeed(_) => I::Local(false),
        _ => return None,
    })
}

impl FromStr for PlantEvent {
    type Err = PlantEventError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (key, value) = text.split_once('=').ok_or_else(|| PlantEventError::NoValue {
            text: text.to_owned(),
        })?;
        let (key, value) = (key.trim(), value.trim());
        let wrong = |expected| PlantEventError::Value {
            text: text.trim().to_owned(),
            expected,
        };
        let share = || {
            let quantity: Quantity = value.parse().map_err(|_| wrong(SHARE))?;
            let percent = match quantity.unit.as_deref() {
                Some("%") => quantity.number.as_f64(),
                None => quantity.number.as_f64() * 100.0,
                Some(_) => return Err(wrong(SHARE)),
            };
            let fits = (0.0..=100.0).contains(&percent);
            fits.then_some(percent / 100.0).ok_or_else(|| wrong(SHARE))
        };
        let time = || {
            let quantity: Quantity = value.parse().map_err(|_| wrong(TIME))?;
            let seconds = quantity.in_unit("s").map_err(|_| wrong(TIME))?;
            let fits = (0.0..=60.0).contains(&seconds);
            fits.then(|| Duration::from_secs_f64(seconds))
                .ok_or_else(|| wrong(TIME))
        };
        Ok(match key {
            "cable" => match value {
                "pulled" => Self::Cable { pulled: true },
                "plugged" => Self::Cable { pulled: false },
                _ => return Err(wrong("the cable is pulled or plugged")),
            },
            "loss" => Self::Link(LinkFault::Loss(share()?)),
            "duplicate" => Self::Link(LinkFault::Duplicate(share()?)),
            "overtaken" => Self::Link(LinkFault::Overtaken(share()?)),
            "delay" => Self::Link(LinkFault::Delay(time()?)),
            "jitter" => Self::Link(LinkFault::Jitter(time()?)),
            "answers" => Self::Answers(value.parse().map_err(|_| wrong(ANSWERS))?),
            key if Injection::keys().any(|row| row.key == key) => Self::Drive(text.trim().parse()?),
            key => {
                return Err(PlantEventError::UnknownKey { key: key.to_owned() });
            }
        })
    }
}

const SHARE: &str = "a share is 0% to 100%";
const TIME: &str = "a time of a frame is 0s to 60s, with its unit";
const ANSWERS: &str = "answers are none, silent, late TIME, reference, cut or error NUMBER";

impl fmt::Display for PlantEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| (share * 1e6).round() / 1e4;
        let millis = |time: Duration| time.as_secs_f64() * 1000.0;
        match *self {
            Self::Drive(injection) => injection.fmt(f),
            Self::Cable { pulled: true } => f.write_str("cable=pulled"),
            Self::Cable { pulled: false } => f.write_str("cable=plugged"),
            Self::Link(LinkFault::Loss(share)) => write!(f, "loss={}%", percent(share)),
            Self::Link(LinkFault::Duplicate(share)) => write!(f, "duplicate={}%", percent(share)),
            Self::Link(LinkFault::Overtaken(share)) => write!(f, "overtaken={}%", percent(share)),
            Self::Link(LinkFault::Delay(time)) => write!(f, "delay={}ms", millis(time)),
            Self::Link(LinkFault::Jitter(time)) => write!(f, "jitter={}ms", millis(time)),
            Self::Answers(fault) => write!(f, "answers={fault}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelled_key_comes_with_the_nearest_one() {
        for (text, near) in [
            ("fualt", Some("fault")),
            ("fualt=439", Some("fault")),
            ("warnin=3", Some("warning")),
            ("motor-temp=80degC", None),
            ("sto", Some("sto")),
            ("x=1", None),
        ] {
            let message = text.parse::<PlantEvent>().unwrap_err().to_string();
            let nearest = message
                .split_once("nearest key: ")
                .and_then(|(_, rest)| rest.split_once(';'));
            assert_eq!(nearest.map(|(key, _)| key), near, "{message}");
            assert!(message.contains("keys: fault, warning, "), "{message}");
        }
    }

    #[test]
    fn every_example_is_read_written_and_ended() {
        for row in keys() {
            let event: PlantEvent = row.example.parse().unwrap();
            assert_eq!(event.to_string(), row.example, "{}", row.key);
            assert_eq!(event.to_string().parse(), Ok(event));
            if let Some(end) = event.undo() {
                assert_ne!(end, event);
                assert_eq!(end.to_string().parse(), Ok(end));
            }
        }
        assert!(keys().count() > 15);
    }

    #[test]
    fn a_drive_has_the_faults_of_its_table_only() {
        let akd = &virtual_drive::model::AKD;
        for text in [
            "fault=439",
            "fault=439!",
            "warning=107",
            "clear=439",
            "clear=107",
            "sto=on",
            "input=7:on",
        ] {
            assert_eq!(text.parse::<PlantEvent>().unwrap().fits(akd), Ok(()), "{text}");
        }
        for (text, words) in [
            ("fault=999", "has no fault 999; next to it there are "),
            ("fault=65535!", "has no fault 65535; next to it there are "),
            ("warning=1", "has no warning 1; next to it there are "),
            ("clear=999", "has no fault or warning 999"),
            ("input=8:on", "has the digital inputs 1 to 7"),
        ] {
            let error = text
                .parse::<PlantEvent>()
                .unwrap()
                .fits(akd)
                .unwrap_err()
                .to_string();
            assert!(error.contains(words) && error.contains(text), "{text}: {error}");
        }
    }

    #[test]
    fn mistakes_are_reported_with_the_alternatives() {
        for (text, words) in [
            ("cable", "write KEY=VALUE"),
            (
                "cabel=pulled",
                "`cabel` is not an event of a drive; nearest key: cable; keys: fault",
            ),
            ("cable=cut", "pulled or plugged"),
            ("loss=120%", "0% to 100%"),
            ("loss=-1%", "0% to 100%"),
            ("delay=20", ""),
            ("delay=20rpm", "0s to 60s"),
            ("delay=1h", "0s to 60s"),
            ("answers=loud", "silent"),
            ("sto=perhaps", "sto"),
        ] {
            if words.is_empty() {
                continue;
            }
            let error = text.parse::<PlantEvent>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
