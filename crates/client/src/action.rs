//! What a person can do next, as values: each front end words them as its own commands, buttons or calls.

use std::fmt;

/// Something to do about a state of a drive or about an error.
///
/// An action applies to the drive that the state or the error is about, unless it names another.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// List the devices of the network.
    Scan,
    /// Examine this computer, its network and the way to the drive.
    Doctor,
    /// Make a device show itself.
    Blink {
        /// How the device is addressed, where a name would not identify it.
        device: Option<String>,
    },
    /// Give a device a name.
    SetName {
        /// How the device is addressed, where a name would not identify it.
        device: Option<String>,
    },
    /// Give a device an IP address.
    SetAddress {
        /// How the device is addressed, where a name would not identify it.
        device: Option<String>,
    },
    /// Identity and plugged modules.
    Info,
    /// Read the status of the drive.
    Status,
    /// Read faults and warnings.
    Faults,
    /// Acknowledge the faults.
    Acknowledge,
    /// Show state and values as they change.
    Monitor,
    /// Read parameters.
    Read {
        /// As their vendor writes them; empty for any.
        parameters: Vec<String>,
    },
    /// Write a parameter.
    Write {
        /// The parameter as its vendor writes it.
        parameter: String,
        /// The value as a person gives it: a number in the unit of the parameter, with its unit or without.
        value: String,
    },
    /// Unit, limits and scaling of a parameter.
    Describe {
        /// The parameter.
        parameter: String,
    },
    /// Find parameters by a part of their name.
    Find {
        /// The part; empty for any.
        part: String,
        /// With their values.
        values: bool,
    },
    /// Bring the axis to rest along its ramp.
    Stop,
    /// Bring the axis to rest and switch its power stage off.
    Disable,
    /// Turn the axis at a speed.
    Run,
    /// Turn the axis at its jog speed.
    Jog,
    /// Move the axis to a position.
    Move,
    /// Set the home position.
    Home,
    /// Write all settings of the drive to a file.
    Backup,
    /// Repeat what was tried with another choice.
    Choose(Choice),
}

/// A choice of the caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Choice {
    /// The device description of the vendor: modules, ident numbers, update times.
    Description,
    /// Which model the drive is taken for.
    Model,
    /// The update time of the cyclic connection.
    Cycle,
    /// How long to wait.
    Time,
    /// The highest speed allowed.
    SpeedLimit,
    /// Change the mode of the drive for this one task.
    Mode,
    /// A distance instead of a position.
    Relative,
    /// A speed in percent of the reference.
    Percent,
    /// What 100 % of the reference is.
    ReferenceSpeed,
    /// Consent to an axis that runs on when its controller is lost.
    RunOn,
    /// The network interface.
    Interface,
    /// Go on although something speaks against it.
    Force,
    /// The file for the values before.
    WayBack,
    /// The drive saves new values.
    Save,
    /// The machine file.
    Machine,
    /// Which settings of a file.
    Settings,
}

/// Every choice with its stable name.
const CHOICES: [(&str, Choice); 16] = [
    ("description", Choice::Description),
    ("model", Choice::Model),
    ("cycle", Choice::Cycle),
    ("time", Choice::Time),
    ("speed-limit", Choice::SpeedLimit),
    ("mode", Choice::Mode),
    ("relative", Choice::Relative),
    ("percent", Choice::Percent),
    ("reference-speed", Choice::ReferenceSpeed),
    ("run-on", Choice::RunOn),
    ("interface", Choice::Interface),
    ("force", Choice::Force),
    ("way-back", Choice::WayBack),
    ("save", Choice::Save),
    ("machine", Choice::Machine),
    ("settings", Choice::Settings),
];

impl Choice {
    /// Stable name for programs.
    #[must_use]
    pub fn id(self) -> &'static str {
        let row = CHOICES.iter().find(|(_, choice)| *choice == self);
        row.map_or("", |(id, _)| id)
    }
}

impl Action {
    /// Stable name for programs.
    ///
    /// ```
    /// assert_eq!(profidrive_client::Action::Disable.id(), "disable");
    /// ```
    #[must_use]
    pub const fn id(&self) -> &'static str {
        match self {
            Self::Scan => "scan",
            Self::Doctor => "doctor",
            Self::Blink { .. } => "blink",
            Self::SetName { .. } => "name",
            Self::SetAddress { .. } => "address",
            Self::Info => "info",
            Self::Status => "status",
            Self::Faults => "faults",
            Self::Acknowledge => "acknowledge",
            Self::Monitor => "monitor",
            Self::Read { .. } => "read",
            Self::Write { .. } => "write",
            Self::Describe { .. } => "describe",
            Self::Find { .. } => "find",
            Self::Stop => "stop",
            Self::Disable => "disable",
            Self::Run => "run",
            Self::Jog => "jog",
            Self::Move => "move",
            Self::Home => "home",
            Self::Backup => "backup",
            Self::Choose(_) => "choose",
        }
    }

    /// The action that `name` and its arguments stand for: `read VBUS.VALUE`, `write 930=1`, `choose model`.
    fn named(name: &str, arguments: &[&str]) -> Option<Self> {
        let first = || arguments.first().copied().unwrap_or_default();
        let device = (!first().is_empty()).then(|| first().to_owned());
        Some(match name {
            "scan" => Self::Scan,
            "doctor" => Self::Doctor,
            "blink" => Self::Blink { device },
            "name" => Self::SetName { device },
            "address" => Self::SetAddress { device },
            "info" => Self::Info,
            "status" => Self::Status,
            "faults" => Self::Faults,
            "acknowledge" => Self::Acknowledge,
            "monitor" => Self::Monitor,
            "read" => Self::Read {
                parameters: arguments.iter().map(|one| (*one).to_owned()).collect(),
            },
            "write" => {
                let (parameter, value) = first().split_once('=')?;
                Self::Write {
                    parameter: parameter.to_owned(),
                    value: value.to_owned(),
                }
            }
            "describe" => Self::Describe {
                parameter: first().to_owned(),
            },
            "find" => Self::Find {
                part: first().to_owned(),
                values: arguments.get(1) == Some(&"values"),
            },
            "stop" => Self::Stop,
            "disable" => Self::Disable,
            "run" => Self::Run,
            "jog" => Self::Jog,
            "move" => Self::Move,
            "home" => Self::Home,
            "backup" => Self::Backup,
            "choose" => {
                let found = CHOICES.iter().find(|(id, _)| *id == first());
                Self::Choose(found.map(|(_, choice)| *choice)?)
            }
            _ => return None,
        })
    }

    /// What it is done with, as text: a device, parameters, `PARAMETER=VALUE`, a choice.
    #[must_use]
    pub fn arguments(&self) -> Vec<String> {
        let all = match self {
            Self::Blink { device } | Self::SetName { device } | Self::SetAddress { device } => {
                vec![device.clone().unwrap_or_default()]
            }
            Self::Read { parameters } => parameters.clone(),
            Self::Write { parameter, value } => vec![format!("{parameter}={value}")],
            Self::Describe { parameter } => vec![parameter.clone()],
            Self::Find { part, values } => {
                let values = if *values { "values" } else { "" };
                vec![part.clone(), values.to_owned()]
            }
            Self::Choose(choice) => vec![choice.id().to_owned()],
            _ => Vec::new(),
        };
        all.into_iter().filter(|one| !one.is_empty()).collect()
    }

    /// The action with what it does, as a sentence.
    ///
    /// ```
    /// use profidrive_client::Action;
    /// assert_eq!(Action::Stop.sentence().to_string(), "[stop] brings it to rest");
    /// ```
    #[must_use]
    pub fn sentence(self) -> Advice {
        let does = match self {
            Self::Scan => "lists the devices that respond",
            Self::Doctor => "measures packet loss and latency",
            Self::Blink { .. } => "shows which device it is",
            Self::SetName { .. } => "gives it a name",
            Self::SetAddress { .. } => "gives it an address",
            Self::Acknowledge => "acknowledges the faults",
            Self::Read { .. } => "shows more",
            Self::Write { .. } => "changes it",
            Self::Stop => "brings it to rest",
            Self::Disable => "brings it to rest and switches its power stage off",
            Self::Run => "turns it at a speed",
            Self::Jog => "turns it at its jog speed",
            Self::Move => "moves it to a position",
            Self::Home => "sets the home position",
            Self::Backup => "writes its settings to a file",
            Self::Choose(_) => "tries it in another way",
            Self::Info
            | Self::Status
            | Self::Faults
            | Self::Monitor
            | Self::Describe { .. }
            | Self::Find { .. } => "shows how it is",
        };
        Advice::from(self).and(format!(" {does}"))
    }
}

/// `read VBUS.VALUE`
impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())?;
        for argument in self.arguments() {
            write!(f, " {argument}")?;
        }
        Ok(())
    }
}

/// A part of an [`Advice`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AdvicePart {
    /// Words.
    Text(String),
    /// An action, in place of the words for it.
    Action(Action),
}

/// What to do, in words with actions between them.
///
/// Written as text with the actions in braces. A front end takes the [`parts`](Self::parts) and puts its own command,
/// button or call in the place of each action; as text the action keeps its name:
///
/// ```
/// use profidrive_client::{Action, Advice, AdvicePart};
/// let advice = Advice::from("switch the mains on; {read VBUS.VALUE} shows the voltage");
/// let read = Action::Read { parameters: vec!["VBUS.VALUE".into()] };
/// assert_eq!(advice.parts()[1], AdvicePart::Action(read));
/// assert_eq!(advice.to_string(), "switch the mains on; [read VBUS.VALUE] shows the voltage");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Advice(Vec<AdvicePart>);

impl Advice {
    /// Words and actions in their order.
    #[must_use]
    pub fn parts(&self) -> &[AdvicePart] {
        &self.0
    }

    /// The actions in it.
    pub fn actions(&self) -> impl Iterator<Item = &Action> {
        self.0.iter().filter_map(|part| match part {
            AdvicePart::Action(action) => Some(action),
            AdvicePart::Text(_) => None,
        })
    }

    /// True where there is nothing to do.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// One advice behind the other.
    #[must_use]
    pub fn then(mut self, other: Self) -> Self {
        if !self.is_empty() && !other.is_empty() {
            self.0.push(AdvicePart::Text("; ".into()));
        }
        self.0.extend(other.0);
        self
    }

    /// The same with an action behind it.
    #[must_use]
    pub fn with(mut self, action: Action) -> Self {
        self.0.push(AdvicePart::Action(action));
        self
    }

    /// The same with words behind it.
    #[must_use]
    pub fn and(mut self, text: impl Into<String>) -> Self {
        self.0.push(AdvicePart::Text(text.into()));
        self
    }

    /// The words of a front end: its own for each action, the same text between them.
    pub fn worded(&self, mut action: impl FnMut(&Action) -> String) -> String {
        let words = self.0.iter().map(|part| match part {
            AdvicePart::Text(text) => text.clone(),
            AdvicePart::Action(one) => action(one),
        });
        words.collect()
    }
}

impl From<&str> for Advice {
    fn from(text: &str) -> Self {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some((before, behind)) = rest.split_once('{') {
            let Some((inside, after)) = behind.split_once('}') else {
                break;
            };
            let mut words = inside.split(' ');
            let name = words.next().unwrap_or_default();
            let arguments: Vec<&str> = words.collect();
            let Some(action) = Action::named(name, &arguments) else {
                break;
            };
            if !before.is_empty() {
                parts.push(AdvicePart::Text(before.to_owned()));
            }
            parts.push(AdvicePart::Action(action));
            rest = after;
        }
        if !rest.is_empty() {
            parts.push(AdvicePart::Text(rest.to_owned()));
        }
        Self(parts)
    }
}

/// Words alone: braces in it are braces.
impl From<String> for Advice {
    fn from(text: String) -> Self {
        Self(vec![AdvicePart::Text(text)])
    }
}

impl From<Action> for Advice {
    fn from(action: Action) -> Self {
        Self(vec![AdvicePart::Action(action)])
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.worded(|action| format!("[{action}]")))
    }
}

#[cfg(test)]
mod tests {
    use profile::catalogue::{AKD, Catalogue, VACON, VLT};

    use super::*;

    #[test]
    fn every_action_in_the_tables_exists() {
        for tables in [&AKD, &VLT, &VACON] as [&'static Catalogue; 3] {
            let remedies = tables.faults.iter().map(|fault| fault.remedy);
            let not_now = tables.parameters.iter().filter_map(|one| tables.not_now(one.pnu));
            for text in remedies.chain(not_now) {
                let shown = Advice::from(text).to_string();
                assert!(!shown.contains(['{', '}', '`']), "{}: {text}", tables.model);
            }
        }
        let refused = AKD.not_now(922).map(Advice::from).unwrap();
        assert_eq!(refused.actions().collect::<Vec<_>>(), [&Action::Status]);
    }

    #[test]
    fn actions_in_text_are_found_and_shown_by_name() {
        for text in [
            "scan",
            "blink MAC",
            "write 930=1",
            "read SWLS.LIMIT0 SWLS.LIMIT1",
            "find DIN values",
            "find HOME.",
            "choose reference-speed",
            "disable",
        ] {
            let words: Vec<&str> = text.split(' ').collect();
            let action = Action::named(words[0], &words[1..]);
            assert_eq!(action.map(|action| action.to_string()).as_deref(), Some(text));
        }
        for nonsense in ["fly", "write 930", "choose nothing"] {
            let words: Vec<&str> = nonsense.split(' ').collect();
            assert_eq!(Action::named(words[0], &words[1..]), None, "{nonsense}");
        }
        let advice = Advice::from("{home} sets the home position").then(Advice::from("or wait"));
        assert_eq!(advice.to_string(), "[home] sets the home position; or wait");
        assert_eq!(advice.actions().collect::<Vec<_>>(), [&Action::Home]);
        assert!(Advice::from("").is_empty());
    }
}
