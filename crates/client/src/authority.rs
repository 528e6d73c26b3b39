//! Who commands a drive, and what keeps it busy.

use std::fmt;

/// Who commands a drive.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Authority {
    /// Local operation at the drive itself (ZSW1 bit 9 is 0).
    Local(LocalControl),
    /// The controller of this station name, empty where it has none.
    Controller(String),
    /// No controller, and operation is enabled (S4) or the motor turns in S3: the last control word is still in force,
    /// or the drive follows its setting for a lost controller.
    Ownerless,
    /// No controller, and the drive is not in operation.
    Free,
    /// The device does not report its connections.
    Unknown,
}

/// Who at the drive itself commands it.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LocalControl {
    /// Its service channel has enabled it: setup software, or a parameter.
    ServiceChannel,
    /// A parameter keeps the field bus from commanding it.
    Setting {
        /// The parameter, as its vendor writes it.
        parameter: String,
        /// Its setting.
        setting: String,
    },
    /// Its panel or its inputs.
    Panel,
    /// It does not request control by the field bus; the commanding site is not reported.
    Elsewhere,
}

impl LocalControl {
    /// Returns the remedy at the drive that gives control to the field bus.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self {
            Self::ServiceChannel => "switch it off where it was enabled, or disable it by parameter".into(),
            Self::Setting { parameter, .. } => {
                format!("stop it at its inputs or its panel; {parameter} must let the field bus command it")
            }
            Self::Panel => {
                "stop it at its panel (OFF), then hand control over to the field bus (AUTO, remote)".into()
            }
            Self::Elsewhere => {
                "hand control over to the field bus in its setup software or by its inputs".into()
            }
        }
    }
}

impl fmt::Display for LocalControl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ServiceChannel => f.write_str("its service channel has enabled it"),
            Self::Setting { parameter, setting } => {
                write!(f, "{parameter} is {setting}, the field bus may not command it")
            }
            Self::Panel => f.write_str("its panel or its inputs command it"),
            Self::Elsewhere => f.write_str("its service channel or its inputs have it"),
        }
    }
}

/// What a drive is at work with.
#[derive(Debug, Clone, PartialEq)]
pub enum AtWork {
    /// A controller of this station name is connected.
    Controller(String),
    /// The axis turns at this speed in rpm, whether its power stage is on or not.
    Turns(f64),
    /// The power stage is on.
    Enabled,
}

impl fmt::Display for AtWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(name) if name.is_empty() => {
                write!(f, "a controller without a name is running it")
            }
            Self::Controller(name) => write!(f, "controller \"{name}\" is running it"),
            Self::Turns(speed) => write!(f, "its axis turns at {speed:.1} rpm"),
            Self::Enabled => write!(f, "its power stage is on"),
        }
    }
}
