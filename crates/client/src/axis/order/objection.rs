//! Objections to a move.

use std::fmt;

use profile::catalogue::Part;
use profile::notation::figures;

use crate::Advice;
use crate::names::{in_models, read_in_models, write_in_models};

/// Why a move is not sent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Objection {
    /// ZSW1 bit 11 is 0.
    NotHomed,
    /// ZSW1 bit 3.
    Fault,
    /// The feedrate is 0: a task does not move.
    Feedrate,
    /// The table of the drive has no motion task of this number.
    NoTask {
        /// Its number.
        number: u16,
    },
    /// The target is outside the software limits.
    SoftwareLimit {
        /// Target in turns.
        target: f64,
        /// The limit in turns.
        limit: f64,
        /// True for the upper one.
        upper: bool,
    },
    /// An absolute target outside of the range of a modulo axis.
    ModuloRange {
        /// Target in turns.
        target: f64,
        /// Lower end in turns, inside the range.
        low: f64,
        /// Upper end in turns, the first position outside.
        high: f64,
    },
    /// The limit switch in the direction of the move is hit.
    LimitSwitch {
        /// True for the one at the positive end.
        positive: bool,
    },
    /// The target does not fit 32 bits of increments.
    Range {
        /// Target in increments.
        counts: f64,
    },
    /// No speed at all, or none that the drive could take.
    NoSpeed {
        /// Requested speed, rpm.
        speed: f64,
    },
    /// A distance of less than half an increment: the axis would not move.
    NoDistance {
        /// Requested distance, in increments.
        counts: f64,
    },
    /// A speed between two that are representable in the setpoint, and neither is near.
    SpeedStep {
        /// Requested speed, rpm.
        speed: f64,
        /// The representable speeds below and above it, rpm.
        nearest: [f64; 2],
    },
    /// Above what the setpoint carries.
    SpeedRange {
        /// Requested speed, rpm.
        speed: f64,
        /// The highest speed of MDI_VELOCITY, rpm.
        highest: f64,
    },
    /// Above what the caller allows.
    SpeedLimit {
        /// Requested speed, rpm.
        speed: f64,
        /// Speed allowed, rpm.
        limit: f64,
    },
    /// Above what the drive allows.
    DriveLimit {
        /// Requested speed, rpm.
        speed: f64,
        /// Its limit in that direction, rpm.
        limit: f64,
    },
    /// A ramp that the drive cannot take.
    Ramp {
        /// Requested ramp, rpm/s.
        ramp: f64,
        /// Lowest, rpm/s.
        lowest: f64,
        /// Highest, rpm/s.
        highest: f64,
    },
}

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotHomed => f.write_str("the axis is not homed (ZSW1 bit 11 is 0)"),
            Self::Fault => f.write_str("a fault is present (ZSW1 bit 3)"),
            Self::Feedrate => write!(
                f,
                "the feedrate is 0{}: no task moves the axis",
                in_models(&[Part::Feedrate])
            ),
            Self::NoTask { number } => write!(f, "motion task {number} is empty"),
            Self::SoftwareLimit { target, limit, upper } => write!(
                f,
                "the target {target:.3} rev is {} the software limit of {limit:.3} rev{}",
                if *upper { "above" } else { "below" },
                in_models(&[if *upper {
                    Part::SoftwareLimit1
                } else {
                    Part::SoftwareLimit0
                }]),
            ),
            Self::ModuloRange { target, low, high } => write!(
                f,
                "the target {target:.3} rev is outside of the modulo range of {low:.3} to {high:.3} rev{}",
                in_models(&[Part::ModuloEnd1, Part::ModuloEnd2])
            ),
            Self::LimitSwitch { positive } => write!(
                f,
                "the {} limit switch is hit, the move leads further into it",
                if *positive { "positive" } else { "negative" }
            ),
            Self::Range { counts } => write!(
                f,
                "the target of {counts:.0} counts does not fit 32 bits (MDI_TARPOS)"
            ),
            Self::NoSpeed { speed } => write!(f, "{} rpm is not a valid speed for a move", figures(*speed)),
            Self::NoDistance { counts } => write!(
                f,
                "a distance of {} counts is less than half an increment: the axis would not move",
                figures(*counts)
            ),
            Self::SpeedStep { speed, nearest } => write!(
                f,
                "{} rpm is not representable: the nearest speeds are {} rpm and {} rpm (MDI_VELOCITY)",
                figures(*speed),
                figures(nearest[0]),
                figures(nearest[1])
            ),
            Self::SpeedRange { speed, highest } => write!(
                f,
                "{} rpm is more than MDI_VELOCITY carries, {} rpm",
                figures(*speed),
                figures(*highest)
            ),
            Self::SpeedLimit { speed, limit } => {
                write!(
                    f,
                    "{} rpm is above the limit of {} rpm",
                    figures(*speed),
                    figures(*limit)
                )
            }
            Self::DriveLimit { speed, limit } => write!(
                f,
                "{} rpm is above the limit of the drive, {} rpm{}",
                figures(*speed),
                figures(*limit),
                in_models(&[Part::ForwardLimit, Part::BackwardLimit])
            ),
            Self::Ramp {
                ramp,
                lowest,
                highest,
            } => write!(
                f,
                "{} rpm/s is outside of what MDI_ACC and MDI_DEC carry, {} to {} rpm/s",
                figures(*ramp),
                figures(*lowest),
                figures(*highest)
            ),
        }
    }
}

impl Objection {
    /// Returns the hint.
    #[must_use]
    pub fn advice(&self) -> Advice {
        match self {
            Self::NotHomed => "{home} sets the home position",
            Self::Fault => "{status} shows which, {acknowledge} acknowledges it",
            Self::Feedrate => {
                let write = write_in_models(Part::Feedrate, 100);
                return format!("{write} lets tasks run at their own speed").as_str().into();
            }
            Self::NoTask { .. } => {
                let table = in_models(&[Part::TaskNumber, Part::LoadTask]);
                return format!("the table of motion tasks shows which ones there are{table}").into();
            }
            Self::SoftwareLimit { .. } => {
                return shows_limits(&[
                    Part::SoftwareLimitsOn,
                    Part::SoftwareLimit0,
                    Part::SoftwareLimit1,
                ]);
            }
            Self::ModuloRange { .. } => {
                "a target lies inside the range, its upper end not included; {choose relative} goes on over the end"
            }
            Self::LimitSwitch { .. } => "move the other way",
            Self::Range { .. } => "a distance ({choose relative}) may be shorter than a position",
            Self::NoSpeed { .. } => "use a speed above 0: the direction follows from the target",
            Self::NoDistance { .. } => "use a longer distance",
            Self::SpeedStep { .. } => "use one of them",
            Self::SpeedRange { .. } => "use a lower speed",
            Self::SpeedLimit { .. } => "raise the limit with {choose speed-limit} if the machine allows it",
            Self::DriveLimit { .. } => return shows_limits(&[Part::ForwardLimit, Part::BackwardLimit]),
            Self::Ramp { .. } => {
                let steps = in_models(&[Part::AccelerationScaling]);
                return format!("the steps are those of acceleration signals{steps}").into();
            }
        }
        .into()
    }
}

/// What reads the limits that are parameters with these parts.
fn shows_limits(parts: &[Part]) -> Advice {
    format!("{} shows the limits", read_in_models(parts))
        .as_str()
        .into()
}
