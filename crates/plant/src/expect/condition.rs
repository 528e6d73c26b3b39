//! Conditions: what must hold of a drive.

use profile::catalogue::Parameter;
use profile::notation::figures;
use profile::state::{State, Stw1, Zsw1};
use virtual_drive::drive::Drive;

/// What a monitor looks at of a drive at one moment.
pub trait Observed {
    /// State of the general state machine.
    fn state(&self) -> State;
    /// Control word in force.
    fn stw1(&self) -> Stw1;
    /// Status word that the drive sends.
    fn zsw1(&self) -> Zsw1;
    /// The drive positions: bits 10 and 11 of the status word are those of position mode.
    fn is_positioning(&self) -> bool;
    /// The axis turns.
    fn is_moving(&self) -> bool;
    /// A controller exchanges data with it; `None` before the first one did.
    fn connected(&self) -> Option<bool>;
    /// Numbers of the faults (or warnings) that are present.
    fn messages(&self, warnings: bool) -> Vec<u16>;
    /// A quantity in its own unit, see [`Quantity::unit`].
    fn quantity(&self, quantity: Quantity) -> f64;
    /// An element of a parameter in its unit; `None` when it cannot be read.
    fn parameter(&self, parameter: &'static Parameter, element: u16) -> Option<f64>;
}

/// A quantity of a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Speed that the drive measures.
    Speed,
    /// Position that the drive reports.
    Position,
    /// Current of the motor.
    Current,
    /// Torque of the motor.
    Torque,
    /// Voltage of the DC bus.
    BusVoltage,
    /// Position command minus position.
    FollowingError,
    /// True speed of the shaft.
    LoadSpeed,
    /// True position of the shaft, counted from the start.
    LoadPosition,
}

impl Quantity {
    /// All of them with their keys.
    pub const ALL: [(Self, &'static str); 8] = [
        (Self::Speed, "speed"),
        (Self::Position, "position"),
        (Self::Current, "current"),
        (Self::Torque, "torque"),
        (Self::BusVoltage, "bus-voltage"),
        (Self::FollowingError, "following-error"),
        (Self::LoadSpeed, "load.speed"),
        (Self::LoadPosition, "load.position"),
    ];

    /// Returns its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Speed | Self::LoadSpeed => "rpm",
            Self::Position | Self::FollowingError | Self::LoadPosition => "rev",
            Self::Current => "A",
            Self::Torque => "Nm",
            Self::BusVoltage => "V",
        }
    }
}

/// A drive as it runs.
#[derive(Debug, Clone, Copy)]
pub struct Live<'a> {
    /// The drive.
    pub drive: &'a Drive,
    /// A controller exchanges data with it; `None` before the first one did.
    pub connected: Option<bool>,
}

impl Observed for Live<'_> {
    fn state(&self) -> State {
        self.drive.state()
    }

    fn stw1(&self) -> Stw1 {
        self.drive.control_word()
    }

    fn zsw1(&self) -> Zsw1 {
        self.drive.status_word()
    }

    fn is_positioning(&self) -> bool {
        self.drive.is_positioning()
    }

    fn is_moving(&self) -> bool {
        self.drive.is_moving()
    }

    fn connected(&self) -> Option<bool> {
        self.connected
    }

    fn messages(&self, warnings: bool) -> Vec<u16> {
        if warnings {
            self.drive.active_warnings().collect()
        } else {
            self.drive.active_faults().collect()
        }
    }

    fn quantity(&self, quantity: Quantity) -> f64 {
        let axis = self.drive.axis();
        match quantity {
            Quantity::Speed => axis.measured_speed(),
            Quantity::Position => revolutions(axis.position()),
            Quantity::Current => axis.current(),
            Quantity::Torque => axis.motor_output().torque,
            Quantity::BusVoltage => axis.electrical().bus_voltage(),
            Quantity::FollowingError => revolutions(axis.following_error()),
            Quantity::LoadSpeed => axis.speed(),
            Quantity::LoadPosition => revolutions(axis.true_position()),
        }
    }

    fn parameter(&self, parameter: &'static Parameter, element: u16) -> Option<f64> {
        self.drive.reported(parameter, element)
    }
}

/// Returns revolutions of a position in 2^-32 revolutions.
pub fn revolutions(position: i64) -> f64 {
    position as f64 / 4_294_967_296.0
}

/// Which faults or warnings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Numbers {
    /// None at all.
    None,
    /// At least one, whichever.
    Any,
    /// At least one of these.
    These(Vec<u16>),
}

/// Something that is true or false of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    /// A controller exchanges data with it.
    Connected,
    /// It has its home position.
    Homed,
    /// It is at the target of its task.
    TargetReached,
    /// The axis turns.
    Moving,
}

impl Flag {
    /// All of them with their keys.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Connected, "connected"),
        (Self::Homed, "homed"),
        (Self::TargetReached, "target-reached"),
        (Self::Moving, "moving"),
    ];

    fn of(self, seen: &dyn Observed) -> Option<bool> {
        let positioning = |bit| Some(seen.is_positioning() && seen.zsw1().has(bit));
        match self {
            Self::Connected => seen.connected(),
            Self::Homed => positioning(Zsw1::HOMED),
            Self::TargetReached => positioning(Zsw1::REACHED),
            Self::Moving => Some(seen.is_moving()),
        }
    }
}

/// Where a number must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The lowest, and whether it belongs to the range.
    pub low: (f64, bool),
    /// The highest, and whether it belongs to the range.
    pub high: (f64, bool),
}

impl Bounds {
    /// Returns how far a number is outside, 0 inside.
    pub fn distance(&self, value: f64) -> f64 {
        if self.contain(value) {
            return 0.0;
        }
        let distance = (self.low.0 - value).max(value - self.high.0);
        // not a number is as far as can be; a bound that does not belong to the range is next to it
        if distance.is_nan() {
            f64::INFINITY
        } else {
            distance.max(f64::MIN_POSITIVE)
        }
    }

    pub fn contain(&self, value: f64) -> bool {
        let above = value > self.low.0 || self.low.1 && value == self.low.0;
        let below = value < self.high.0 || self.high.1 && value == self.high.0;
        above && below
    }
}

/// Where a number comes from.
#[derive(Debug, Clone, Copy)]
pub enum Source {
    Quantity(Quantity),
    Parameter(&'static Parameter, u16),
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Quantity(one), Self::Quantity(other)) => one == other,
            (Self::Parameter(one, at), Self::Parameter(other, there)) => {
                std::ptr::eq(*one, *other) && at == there
            }
            _ => false,
        }
    }
}

/// One condition, for one drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Key in the file.
    pub key: String,
    pub test: Test,
}

/// What a condition tests.
#[derive(Debug, Clone, PartialEq)]
pub enum Test {
    State(Vec<u8>),
    Messages {
        warnings: bool,
        numbers: Numbers,
    },
    Flag(Flag, bool),
    Word {
        status: bool,
        mask: u16,
        value: u16,
    },
    Number {
        source: Source,
        unit: &'static str,
        bounds: Bounds,
    },
}

/// What a condition looks at, as it was at one moment.
#[derive(Debug, Clone, PartialEq)]
pub enum Seen {
    State(State),
    Messages(Vec<u16>),
    Flag(Option<bool>),
    Word(u16),
    Number(Option<f64>),
}

impl Condition {
    /// Returns what there is of what it looks at.
    pub fn look(&self, drive: &dyn Observed) -> Seen {
        match &self.test {
            Test::State(_) => Seen::State(drive.state()),
            Test::Messages { warnings, .. } => Seen::Messages(drive.messages(*warnings)),
            Test::Flag(flag, _) => Seen::Flag(flag.of(drive)),
            Test::Word { status: true, .. } => Seen::Word(drive.zsw1().0),
            Test::Word { status: false, .. } => Seen::Word(drive.stw1().0),
            Test::Number { source, .. } => Seen::Number(source.of(drive)),
        }
    }

    /// Returns true when it holds of what it looked at.
    pub fn holds(&self, seen: &Seen) -> bool {
        match (&self.test, seen) {
            (Test::State(states), Seen::State(state)) => states.contains(&state.number()),
            (Test::Messages { numbers, .. }, Seen::Messages(present)) => match numbers {
                Numbers::None => present.is_empty(),
                Numbers::Any => !present.is_empty(),
                Numbers::These(wanted) => wanted.iter().any(|number| present.contains(number)),
            },
            (Test::Flag(_, wanted), Seen::Flag(is)) => *is == Some(*wanted),
            (Test::Word { mask, value, .. }, Seen::Word(word)) => word & mask == *value,
            (Test::Number { bounds, .. }, Seen::Number(value)) => {
                value.is_some_and(|value| bounds.contain(value))
            }
            _ => false,
        }
    }

    /// Returns the number that it looked at with its distance from the wanted ones; `None` for other conditions.
    pub fn distance(&self, seen: &Seen) -> Option<(f64, f64)> {
        match (&self.test, seen) {
            (Test::Number { bounds, .. }, Seen::Number(Some(value))) => {
                Some((*value, bounds.distance(*value)))
            }
            _ => None,
        }
    }

    /// Returns the unit of its number, empty for none.
    pub const fn unit(&self) -> &'static str {
        match &self.test {
            Test::Number { unit, .. } => unit,
            _ => "",
        }
    }

    /// Returns what it looked at in words: `speed 34.2 rpm`.
    pub fn in_words(&self, seen: &Seen) -> String {
        let key = &self.key;
        match seen {
            Seen::State(state) => format!("{key} {state}"),
            Seen::Messages(present) if present.is_empty() => format!("no {key}"),
            Seen::Messages(present) => {
                let present: Vec<_> = present.iter().map(u16::to_string).collect();
                format!("{key} {}", present.join(", "))
            }
            Seen::Flag(Some(is)) => format!("{key} {is}"),
            Seen::Flag(None) => format!("not {key} yet"),
            Seen::Word(word) => format!("{key} 0x{word:04X}"),
            Seen::Number(Some(value)) => format!("{key} {}", with_unit(*value, self.unit())),
            Seen::Number(None) => format!("{key} cannot be read"),
        }
    }
}

impl Source {
    fn of(self, seen: &dyn Observed) -> Option<f64> {
        match self {
            Self::Quantity(quantity) => Some(seen.quantity(quantity)),
            Self::Parameter(parameter, element) => seen.parameter(parameter, element),
        }
    }
}

/// Returns a number with at most seven digits and its unit.
pub fn with_unit(value: f64, unit: &str) -> String {
    let number = figures(value);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}
