//! When a cause applies and how it is reported, the most important first: a table that is walked. Verdict and advice of each
//! cause are in `data/profile/causes.csv`.

use profile::catalogue::Part;
use profile::state::{Start, State, Stw1, Zsw1};

use super::advice::{actions, advice};
use super::facts::{
    STANDS, bus_is_low, but, by, fault, in_force, jog_bits, jogs, jogs_at_once, motion, moved, moves,
    positioning, sources, speed, stands_in, telegram, turns,
};
use super::{Cause, Diagnosis, DriveStatus, Verdict, notes, vendors};
use crate::Advice;

/// Bits of the part `disable-sources` that stand for the hardware; bit 0 is the software, bit 1 the fault.
const HARDWARE_DISABLE: u16 = 1 << 2;
const CONTROLLED_STOP: u16 = 1 << 5;
/// What keeps the power stage off and is neither the software nor a fault.
pub(super) const AT_INPUTS: u16 = !3;
const OTHER_SOURCES: u16 = !(1 | 1 << 1 | HARDWARE_DISABLE | CONTROLLED_STOP);
/// Bits of the part `motion-status`: homing runs, homing failed, a task could not be started.
const HOMING: u32 = 1 << 3;
const HOMING_ERROR: u32 = 1 << 4;
const NOT_STARTED: u32 = 1 << 10;

pub(super) struct Rule {
    pub cause: Cause,
    pub applies: fn(&DriveStatus) -> bool,
    pub sentence: fn(&DriveStatus) -> String,
}

const fn rule(cause: Cause, applies: fn(&DriveStatus) -> bool, sentence: fn(&DriveStatus) -> String) -> Rule {
    Rule {
        cause,
        applies,
        sentence,
    }
}

/// One rule for each cause, in the order of [`Cause::ALL`].
pub(super) const RULES: &[Rule] = &[
    rule(
        Cause::Silent,
        |s| s.zsw1.is_none(),
        |_| "the drive does not report its status word".into(),
    ),
    rule(
        Cause::Fault,
        |s| s.has(Zsw1::FAULT) || !s.faults.is_empty(),
        fault,
    ),
    rule(
        Cause::Sto,
        |s| s.torque_allowed == Some(false) || vendors::warned(s, Cause::Sto).is_some(),
        |s| match vendors::warned(s, Cause::Sto) {
            Some(warning) if s.torque_allowed.is_none() => {
                format!("safe torque off is active: {warning}")
            }
            _ => format!(
                "safe torque off: the STO input is open{}",
                by(s, Part::TorqueAllowed, "is 0")
            ),
        },
    ),
    rule(
        Cause::NoPower,
        |s| {
            !s.has(Zsw1::OPERATION_ENABLED) && (bus_is_low(s) || vendors::warned(s, Cause::NoPower).is_some())
        },
        |s| match (s.bus_voltage, s.bus_lowest, vendors::warned(s, Cause::NoPower)) {
            (Some(volts), Some(least), _) if bus_is_low(s) && least > 0.0 => format!(
                "its DC bus has {volts:.0} V, it needs {least:.0} V: mains are off, missing a phase or too low"
            ),
            (Some(volts), ..) if bus_is_low(s) => {
                format!("its DC bus has {volts:.0} V: mains are off or missing")
            }
            (_, _, Some(warning)) => format!("its DC bus has too little voltage: {warning}"),
            _ => "its DC bus has too little voltage".into(),
        },
    ),
    rule(
        Cause::HardwareDisable,
        |s| sources(s) & HARDWARE_DISABLE != 0,
        |s| {
            format!(
                "the hardware enable input is open{}",
                by(s, Part::DisableSources, "bit 2")
            )
        },
    ),
    rule(
        Cause::ControlledStop,
        |s| sources(s) & CONTROLLED_STOP != 0,
        |s| {
            format!(
                "a digital input commands a controlled stop{}",
                by(s, Part::DisableSources, "bit 5")
            )
        },
    ),
    rule(
        Cause::DisableSource,
        |s| sources(s) & OTHER_SOURCES != 0,
        |s| {
            format!(
                "the drive keeps its power stage off{}",
                by(s, Part::DisableSources, &format!("is 0x{:04X}", sources(s)))
            )
        },
    ),
    rule(
        Cause::CommandSource,
        |s| {
            s.controller != Some(None)
                && s.command_source
                    .is_some_and(|source| source != 1 && !(source == 0 && positioning(s)))
        },
        |s| {
            let called = s.command_source_text;
            let called = called.map_or_else(String::new, |text| format!(", {text}"));
            let is = format!("is {}{called}", s.command_source.unwrap_or_default());
            format!(
                "the drive does not take its setpoints from the field bus{}",
                by(s, Part::CommandSource, &is)
            )
        },
    ),
    rule(
        Cause::LocalOperation,
        |s| !s.has(Zsw1::CONTROL_REQUESTED),
        |s| match &s.local {
            Some(local) => format!("local operation (ZSW1 bit 9 is 0): {local}"),
            None => "local operation: the drive does not ask for control by the field bus (ZSW1 bit 9 is 0)"
                .into(),
        },
    ),
    rule(
        Cause::OtherMode,
        |s| s.mode.is_some_and(|mode| !matches!(mode, 1 | 2)),
        |s| {
            format!(
                "the drive is in a vendor-specific mode (PNU 930 is 0x{:04X}): neither speed nor position control",
                s.mode.unwrap_or_default()
            )
        },
    ),
    rule(
        Cause::EnabledOwnerless,
        |s| s.controller == Some(None) && s.state() == Some(State::S4) && !turns(s),
        |s| {
            format!(
                "its power stage is on though no controller is connected: {}",
                in_force(s)
            )
        },
    ),
    rule(
        Cause::NoController,
        |s| s.controller == Some(None) && !turns(s),
        |s| format!("not commanded: no controller is connected{}", stands_in(s)),
    ),
    rule(
        Cause::MovedExternally,
        |s| s.controller == Some(None) && s.unpowered(),
        moved,
    ),
    rule(
        Cause::TurnsOwnerless,
        |s| s.controller == Some(None),
        |s| {
            format!(
                "it turns at {} though no controller is connected: {}",
                speed(s),
                in_force(s)
            )
        },
    ),
    rule(
        Cause::NoControl,
        |s| s.lacks(Stw1::CONTROL_BY_PLC),
        |s| {
            format!(
                "{} does not take control {}: its program is stopped, only records, or does not request control",
                s.owner(),
                s.bit_is_0(10)
            )
        },
    ),
    rule(
        Cause::CoastStop,
        |s| s.lacks(Stw1::NO_COAST_STOP),
        |s| format!("{} commands a coast stop (OFF2) {}", s.owner(), s.bit_is_0(1)),
    ),
    rule(
        Cause::QuickStop,
        |s| s.lacks(Stw1::NO_QUICK_STOP),
        |s| format!("{} commands a quick stop (OFF3) {}", s.owner(), s.bit_is_0(2)),
    ),
    rule(
        Cause::Stopping,
        |s| matches!(s.state(), Some(State::S5Ramp | State::S5Quick)),
        |s| {
            format!(
                "it is being stopped ({})",
                s.state().map_or_else(String::new, |state| state.to_string())
            )
        },
    ),
    rule(
        Cause::Inhibited,
        |s| s.state() == Some(State::S1) && s.sent(Stw1::ON) && s.profile.start() == Start::AfterOff,
        |s| {
            format!(
                "switching on is inhibited (S1) because {} still sends ON from before {}",
                s.owner(),
                s.bit_is_1(0),
            )
        },
    ),
    rule(
        Cause::NotReady,
        |s| s.state() == Some(State::S1),
        |s| {
            format!(
                "switching on is inhibited (S1) though {}: the drive is not ready for it",
                if s.sent(Stw1::ON) {
                    "start is commanded"
                } else {
                    "OFF is sent"
                },
            )
        },
    ),
    rule(
        Cause::SelfTest,
        |s| s.state().is_none(),
        |s| {
            format!(
                "the drive is not ready yet (ZSW1 is 0x{:04X})",
                s.zsw1.unwrap_or_default().0
            )
        },
    ),
    rule(
        Cause::Off,
        |s| s.state() == Some(State::S2) && !s.sent(Stw1::ON),
        |s| {
            format!(
                "ready for switching on (S2), but {} does not send ON {}",
                s.owner(),
                s.bit_is_0(0)
            )
        },
    ),
    rule(
        Cause::OperationDisabled,
        |s| matches!(s.state(), Some(State::S2 | State::S3)) && !s.sent(Stw1::ENABLE_OPERATION),
        |s| {
            format!(
                "switched on, but {} does not enable operation {}",
                s.owner(),
                s.bit_is_0(3)
            )
        },
    ),
    rule(
        Cause::SwitchingOn,
        |s| matches!(s.state(), Some(State::S2 | State::S3)),
        |s| {
            format!(
                "it is switching on ({})",
                s.state().map_or_else(String::new, |state| state.to_string())
            )
        },
    ),
    rule(
        Cause::MotionHeld,
        |s| s.motion_disable_sources.is_some_and(|sources| sources != 0),
        |s| {
            let is = format!("is 0x{:04X}", s.motion_disable_sources.unwrap_or_default());
            format!(
                "enabled (S4), but the drive holds motion off{}",
                by(s, Part::MotionDisableSources, &is)
            )
        },
    ),
    rule(
        Cause::SpeedTelegram,
        |s| positioning(s) && s.carries_tasks == Some(false) && !s.sent(Stw1::START_HOMING) && !moves(s),
        |s| {
            format!(
                "enabled in position mode (PNU 930 is 2), but {} carries no traversing tasks",
                telegram(s)
            )
        },
    ),
    rule(
        Cause::TaskTelegram,
        |s| s.mode == Some(1) && s.carries_speed == Some(false),
        |s| {
            format!(
                "enabled in velocity mode (PNU 930 is 1), but {} carries no speed setpoint",
                telegram(s)
            )
        },
    ),
    rule(
        Cause::FeedrateZero,
        |s| positioning(s) && s.feedrate == Some(0.0) && s.has(Zsw1::TASK_ACTIVE) && !turns(s),
        |s| {
            format!(
                "enabled (S4), but the feedrate is 0{}: its task does not move",
                by(s, Part::Feedrate, "")
            )
        },
    ),
    rule(Cause::Moves, moves, |s| match turns(s) {
        true => format!("it runs: operation (S4), {}", speed(s)),
        false => "it runs: operation (S4), the axis moves (ZSW1 bit 13 is 0)".into(),
    }),
    rule(
        Cause::LimitSwitch,
        |s| s.negative_switch == Some(true) || s.positive_switch == Some(true),
        |s| match (s.negative_switch, s.positive_switch) {
            (Some(true), Some(true)) => format!(
                "{}both limit switches are hit: look at their wiring and the supply of the inputs",
                but(s)
            ),
            (_, Some(true)) => format!("{}the positive limit switch is hit", but(s)),
            _ => format!("{}the negative limit switch is hit", but(s)),
        },
    ),
    rule(
        Cause::SoftwareLimit,
        |s| s.software_limits.is_some_and(|limits| limits != 0),
        |s| {
            format!(
                "{}a software limit is reached{}",
                but(s),
                by(
                    s,
                    Part::SoftwareLimitState,
                    &format!("is {}", s.software_limits.unwrap_or_default())
                )
            )
        },
    ),
    rule(
        Cause::Homing,
        |s| positioning(s) && motion(s) & HOMING != 0,
        |s| format!("it is homing{}", by(s, Part::MotionStatus, "bit 3")),
    ),
    rule(Cause::TwoJogs, jogs_at_once, |s| {
        format!(
            "enabled (S4), but {} commands two jogs at once {}: they move nothing",
            s.owner(),
            jog_bits(s)
        )
    }),
    rule(Cause::JogHeld, jogs, |s| {
        format!(
            "enabled (S4), but the jog that {} commands {} does not move the axis",
            s.owner(),
            jog_bits(s)
        )
    }),
    rule(
        Cause::HomingFailed,
        |s| positioning(s) && !s.has(Zsw1::HOMED) && motion(s) & HOMING_ERROR != 0,
        |s| {
            format!(
                "enabled (S4), but homing has failed{}",
                by(s, Part::MotionStatus, "bit 4")
            )
        },
    ),
    rule(
        Cause::NotHomed,
        |s| positioning(s) && !s.has(Zsw1::HOMED),
        |_| "enabled (S4), but the axis is not homed (ZSW1 bit 11 is 0): it accepts no task".into(),
    ),
    rule(
        Cause::Rejected,
        |s| positioning(s) && s.lacks(Stw1::NO_REJECT),
        |s| {
            format!(
                "enabled (S4), but {} rejects traversing tasks (STW1 bit 4 is 0)",
                s.owner()
            )
        },
    ),
    rule(
        Cause::IntermediateStop,
        |s| positioning(s) && s.lacks(Stw1::NO_INTERMEDIATE_STOP),
        |s| {
            format!(
                "enabled (S4), but {} commands an intermediate stop (STW1 bit 5 is 0)",
                s.owner()
            )
        },
    ),
    rule(
        Cause::TaskHeld,
        |s| positioning(s) && s.has(Zsw1::TASK_ACTIVE),
        |s| {
            format!(
                "enabled (S4), but its task is held (ZSW1 bits 13 and 14): by a stop{}, by a dwell time, or at a limit",
                by(s, Part::Stop, "")
            )
        },
    ),
    rule(
        Cause::TaskRefused,
        |s| {
            positioning(s)
                && (motion(s) & NOT_STARTED != 0
                    || (s.sent(Stw1::ACTIVATE_TASK)
                        && !s.has(Zsw1::TASK_ACKNOWLEDGED)
                        && !s.has(Zsw1::REACHED)))
        },
        |_| "enabled (S4), but the drive did not accept the traversing task (ZSW1 bit 12 is 0)".into(),
    ),
    rule(
        Cause::AtTarget,
        |s| positioning(s) && s.has(Zsw1::REACHED),
        |_| "enabled (S4), at the target of its task (ZSW1 bit 10): it waits for the next".into(),
    ),
    rule(Cause::NoTask, positioning, |s| {
        format!(
            "enabled (S4), but {} starts no traversing task (edge of STW1 bit 6)",
            s.owner()
        )
    }),
    rule(
        Cause::RampOff,
        |s| s.lacks(Stw1::ENABLE_RAMP),
        |s| {
            format!(
                "enabled (S4), but {} holds the ramp generator at 0 {}",
                s.owner(),
                s.bit_is_0(4)
            )
        },
    ),
    rule(
        Cause::SetpointOff,
        |s| s.lacks(Stw1::ENABLE_SETPOINT),
        |s| {
            format!(
                "enabled (S4), but {} does not enable the setpoint {}",
                s.owner(),
                s.bit_is_0(6)
            )
        },
    ),
    rule(
        Cause::RampFrozen,
        |s| s.lacks(Stw1::UNFREEZE_RAMP),
        |s| {
            format!(
                "enabled (S4), but {} freezes the ramp generator {}",
                s.owner(),
                s.bit_is_0(5)
            )
        },
    ),
    rule(
        Cause::ZeroSetpoint,
        |s| s.speed_set.is_some_and(|speed| speed.abs() < STANDS),
        |s| format!("enabled (S4), but {} sends a speed setpoint of 0", s.owner()),
    ),
    rule(
        Cause::DoesNotTurn,
        |s| s.speed_set.is_some() && s.speed_actual.is_some(),
        |s| {
            format!(
                "enabled (S4) with a setpoint of {:.1} rpm, but the motor does not turn: brake, load, or a limit of current or speed",
                s.speed_set.unwrap_or_default()
            )
        },
    ),
    rule(Cause::Operation, |_| true, |_| "it is in operation (S4)".into()),
];

pub(super) fn first(status: &DriveStatus) -> Diagnosis {
    let found = RULES.iter().find(|rule| (rule.applies)(status));
    let Some(rule) = found else {
        // the last rule applies to everything
        return Diagnosis {
            cause: Cause::Operation,
            verdict: Verdict::Runs,
            sentence: String::new(),
            next: None,
            notes: Vec::new(),
        };
    };
    Diagnosis {
        cause: rule.cause,
        verdict: rule.cause.verdict(),
        sentence: (rule.sentence)(status),
        next: actions(rule.cause, status)
            .into_iter()
            .chain(advice(rule.cause, status))
            .reduce(Advice::then),
        notes: notes::beside(rule.cause, status),
    }
}
