//! The causes, the most important first: a table that is walked.

use profile::catalogue::Cleared;
use profile::state::{Start, State, Stw1, Zsw1};

use super::{Diagnosis, DriveStatus, Verdict, notes, vendors};
use crate::{Action, Advice, FaultEntry, LossReaction};

/// Speed below which an axis counts as standing, rpm.
const STANDS: f64 = 1.0;
/// The same in percent of the reference.
const STANDS_PERCENT: f64 = 0.2;
/// Bits of DRV.DISSOURCES that stand for the hardware; bit 0 is the software, bit 1 the fault.
const HARDWARE_DISABLE: u16 = 1 << 2;
const CONTROLLED_STOP: u16 = 1 << 5;
/// What keeps the power stage off and is neither the software nor a fault.
pub(super) const AT_INPUTS: u16 = !3;
const OTHER_SOURCES: u16 = !(1 | 1 << 1 | HARDWARE_DISABLE | CONTROLLED_STOP);
/// DRV.MOTIONSTAT: homing runs, homing failed, a task could not be started.
const HOMING: u32 = 1 << 3;
const HOMING_ERROR: u32 = 1 << 4;
const NOT_STARTED: u32 = 1 << 10;
/// Without this voltage on its DC bus no drive runs, whatever its own limit is.
const NO_VOLTAGE: f64 = 50.0;

macro_rules! causes {
    ($($(#[$doc:meta])* $name:ident = $id:literal, $verdict:ident, $applies:expr, $sentence:expr, $next:expr;)*) => {
        /// What keeps a drive from running, or that nothing does. In the order of their weight.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Cause {
            $($(#[$doc])* $name,)*
        }

        impl Cause {
            /// Every cause, the most important first.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Stable name for programs.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self {
                    $(Self::$name => $id,)*
                }
            }
        }

        pub(super) const RULES: &[Rule] = &[$(Rule {
            cause: Cause::$name,
            verdict: Verdict::$verdict,
            applies: $applies,
            sentence: $sentence,
            next: $next,
        },)*];
    };
}

pub(super) struct Rule {
    pub cause: Cause,
    verdict: Verdict,
    pub applies: fn(&DriveStatus) -> bool,
    pub sentence: fn(&DriveStatus) -> String,
    /// What to do, of whatever make the drive is; empty where nothing is to be done. What
    /// names parameters is in the table of the makes.
    pub next: &'static str,
}

causes! {
    /// The status word cannot be read.
    Silent = "silent", Held,
        |s| s.zsw1.is_none(),
        |_| "the drive does not report its status word".into(),
        "{info} shows what it tells";
    /// ZSW1 bit 3.
    Fault = "fault", Held,
        |s| s.has(Zsw1::FAULT) || !s.faults.is_empty(),
        fault,
        "remove the cause, then {acknowledge}, or acknowledge from its controller (STW1 bit 7)";
    /// Safe torque off.
    Sto = "sto", Held,
        |s| s.torque_allowed == Some(false) || vendors::warned(s, Cause::Sto).is_some(),
        |s| match vendors::warned(s, Cause::Sto) {
            Some(warning) if s.torque_allowed.is_none() => format!("safe torque off is active: {}", notes::warning_text(warning)),
            _ => "safe torque off: the STO input is open (STO.STATE is 0)".into(),
        },
        "close the safety circuit";
    /// The DC bus has too little voltage.
    NoPower = "no-power", Held,
        |s| !s.has(Zsw1::OPERATION_ENABLED) && (bus_is_low(s) || vendors::warned(s, Cause::NoPower).is_some()),
        |s| match (s.bus_voltage, s.bus_lowest, vendors::warned(s, Cause::NoPower)) {
            (Some(volts), Some(least), _) if bus_is_low(s) && least > 0.0 => format!(
                "its DC bus has {volts:.0} V, it needs {least:.0} V: mains are off, missing a phase or too low"
            ),
            (Some(volts), ..) if bus_is_low(s) => format!("its DC bus has {volts:.0} V: mains are off or missing"),
            (_, _, Some(warning)) => format!("its DC bus has too little voltage: {}", notes::warning_text(warning)),
            _ => "its DC bus has too little voltage".into(),
        },
        "switch the mains on; check contactor, fuses and supply";
    /// The hardware enable is missing.
    HardwareDisable = "hardware-disable", Held,
        |s| sources(s) & HARDWARE_DISABLE != 0,
        |_| "the hardware enable input is open (DRV.DISSOURCES bit 2)".into(),
        "close the enable input";
    /// A digital input commands a stop.
    ControlledStop = "controlled-stop", Held,
        |s| sources(s) & CONTROLLED_STOP != 0,
        |_| "a digital input commands a controlled stop (DRV.DISSOURCES bit 5)".into(),
        "release that input";
    /// Something else of the drive keeps the power stage off.
    DisableSource = "disable-source", Held,
        |s| sources(s) & OTHER_SOURCES != 0,
        |s| format!("the drive keeps its power stage off (DRV.DISSOURCES is 0x{:04X})", sources(s)),
        "remove what keeps it off";
    /// DRV.CMDSOURCE is not the field bus. Motion tasks come through the service channel, so position mode has it too. A
    /// controller that connects sets it by its telegram: without one it holds nothing.
    CommandSource = "command-source", Held,
        |s| s.controller != Some(None)
            && s.command_source.is_some_and(|source| source != 1 && !(source == 0 && positioning(s))),
        |s| format!(
            "the drive does not take its setpoints from the field bus (DRV.CMDSOURCE is {}{})",
            s.command_source.unwrap_or_default(),
            s.command_source_text.map_or_else(String::new, |text| format!(", {text}")),
        ),
        "let it take its setpoints from the field bus";
    /// ZSW1 bit 9.
    LocalOperation = "local-operation", Held,
        |s| !s.has(Zsw1::CONTROL_REQUESTED),
        |s| match &s.local {
            Some(local) => format!("local operation (ZSW1 bit 9 is 0): {local}"),
            None => "local operation: the drive does not ask for control by the field bus (ZSW1 bit 9 is 0)".into(),
        },
        "hand control over to the field bus at the drive or in its software";
    /// PNU 930 is neither 1 nor 2.
    OtherMode = "other-mode", Held,
        |s| s.mode.is_some_and(|mode| !matches!(mode, 1 | 2)),
        |s| format!(
            "the drive is in a mode of its maker (PNU 930 is 0x{:04X}): neither speed nor position control",
            s.mode.unwrap_or_default()
        ),
        "{write 930=1} (speed) or {write 930=2} (position) while it is disabled";
    /// Nobody is connected, and it stands in operation.
    EnabledOwnerless = "enabled-alone", Held,
        |s| s.controller == Some(None) && s.state() == Some(State::S4) && !turns(s),
        |s| format!("its power stage is on though no controller is connected: {}", in_force(s)),
        "";
    /// Nobody is connected.
    NoController = "no-controller", Waits,
        |s| s.controller == Some(None) && !turns(s),
        |s| format!("nobody commands it: no controller is connected{}", stands_in(s)),
        "start the controller";
    /// Nobody is connected, its power stage is off, and it turns.
    MovedExternally = "moved-from-outside", Held,
        |s| s.controller == Some(None) && s.unpowered(),
        moved,
        MOVED_NEXT;
    /// Nobody is connected, and it turns.
    TurnsOwnerless = "turns-alone", Held,
        |s| s.controller == Some(None),
        |s| format!(
            "it turns at {} though no controller is connected: {}",
            speed(s),
            in_force(s)
        ),
        "";
    /// STW1 bit 10.
    NoControl = "no-control", Waits,
        |s| s.lacks(Stw1::CONTROL_BY_PLC),
        |s| format!("{} does not take control {}: its program is stopped, or does not want to", s.owner(), s.bit_is_0(10)),
        "in the controller: set STW1 bit 10, its program must run";
    /// STW1 bit 1.
    CoastStop = "coast-stop", Held,
        |s| s.lacks(Stw1::NO_COAST_STOP),
        |s| format!("{} commands a coast stop (OFF2) {}", s.owner(), s.bit_is_0(1)),
        "in the controller: set STW1 bit 1";
    /// STW1 bit 2.
    QuickStop = "quick-stop", Held,
        |s| s.lacks(Stw1::NO_QUICK_STOP),
        |s| format!("{} commands a quick stop (OFF3) {}", s.owner(), s.bit_is_0(2)),
        "in the controller: set STW1 bit 2";
    /// S5.
    Stopping = "stopping", Waits,
        |s| matches!(s.state(), Some(State::S5Ramp | State::S5Quick)),
        |s| format!("it is being stopped ({})", s.state().map_or_else(String::new, |state| state.to_string())),
        "";
    /// S1 with ON still set.
    Inhibited = "inhibited", Held,
        |s| s.state() == Some(State::S1) && s.sent(Stw1::ON) && s.profile.start() == Start::AfterOff,
        |s| format!(
            "switching on is inhibited (S1) because {} still sends ON from before {}",
            s.owner(),
            s.bit_is_1(0),
        ),
        "in the controller: OFF first (STW1 0x047E), then ON (0x047F)";
    /// S1 otherwise.
    NotReady = "not-ready", Held,
        |s| s.state() == Some(State::S1),
        |s| format!(
            "switching on is inhibited (S1) though {}: the drive is not ready for it",
            if s.sent(Stw1::ON) { "start is commanded" } else { "OFF is sent" },
        ),
        "look at its enable inputs";
    /// A status word without a state.
    SelfTest = "self-test", Waits,
        |s| s.state().is_none(),
        |s| format!("the drive is not ready yet (ZSW1 is 0x{:04X})", s.zsw1.unwrap_or_default().0),
        "";
    /// S2: ON is missing.
    Off = "off", Waits,
        |s| s.state() == Some(State::S2) && !s.sent(Stw1::ON),
        |s| format!("ready for switching on (S2), but {} does not send ON {}", s.owner(), s.bit_is_0(0)),
        "in the controller: ON (STW1 0x047F)";
    /// S3: operation is not enabled.
    OperationDisabled = "operation-disabled", Waits,
        |s| matches!(s.state(), Some(State::S2 | State::S3)) && !s.sent(Stw1::ENABLE_OPERATION),
        |s| format!(
            "switched on, but {} does not enable operation {}",
            s.owner(),
            s.bit_is_0(3)
        ),
        "in the controller: set STW1 bit 3";
    /// ON is sent, S4 is not there yet.
    SwitchingOn = "switching-on", Waits,
        |s| matches!(s.state(), Some(State::S2 | State::S3)),
        |s| format!("it is switching on ({})", s.state().map_or_else(String::new, |state| state.to_string())),
        "";
    /// DRV.MOTIONDISSOURCES.
    MotionHeld = "motion-held", Held,
        |s| s.motion_disable_sources.is_some_and(|sources| sources != 0),
        |s| format!(
            "enabled (S4), but the drive holds motion off (DRV.MOTIONDISSOURCES is 0x{:04X})",
            s.motion_disable_sources.unwrap_or_default()
        ),
        "remove what holds it";
    /// A speed telegram in position mode.
    SpeedTelegram = "speed-telegram", Held,
        |s| positioning(s) && s.carries_tasks == Some(false) && !s.sent(Stw1::START_HOMING) && !moves(s),
        |s| format!(
            "enabled in position mode (PNU 930 is 2), but {} carries no traversing tasks",
            telegram(s)
        ),
        "plug telegram 7 or 9 in the controller, or {write 930=1} for speed control";
    /// A position telegram in velocity mode.
    TaskTelegram = "task-telegram", Held,
        |s| s.mode == Some(1) && s.carries_speed == Some(false),
        |s| format!("enabled in velocity mode (PNU 930 is 1), but {} carries no speed setpoint", telegram(s)),
        "plug telegram 1 in the controller, or {write 930=2} for positioning";
    /// It turns.
    Moves = "moves", Runs,
        moves,
        |s| match turns(s) {
            true => format!("it runs: operation (S4), {}", speed(s)),
            false => "it runs: operation (S4), the axis moves (ZSW1 bit 13 is 0)".into(),
        },
        "";
    /// A limit switch is hit.
    LimitSwitch = "limit-switch", Held,
        |s| s.negative_switch == Some(true) || s.positive_switch == Some(true),
        |s| match (s.negative_switch, s.positive_switch) {
            (Some(true), Some(true)) => format!(
                "{}both limit switches are hit: look at their wiring and the supply of the inputs", but(s)
            ),
            (_, Some(true)) => format!("{}the positive limit switch is hit", but(s)),
            _ => format!("{}the negative limit switch is hit", but(s)),
        },
        "move away from it: only the other direction is free";
    /// A software limit is reached.
    SoftwareLimit = "software-limit", Held,
        |s| s.software_limits.is_some_and(|limits| limits != 0),
        |s| format!(
            "{}a software limit is reached (SWLS.STATE is {})",
            but(s),
            s.software_limits.unwrap_or_default()
        ),
        "move back inside";
    /// Homing runs.
    Homing = "homing", Runs,
        |s| positioning(s) && motion(s) & HOMING != 0,
        |_| "it is homing (DRV.MOTIONSTAT bit 3)".into(),
        "";
    /// Homing has failed.
    HomingFailed = "homing-failed", Held,
        |s| positioning(s) && !s.has(Zsw1::HOMED) && motion(s) & HOMING_ERROR != 0,
        |_| "enabled (S4), but homing has failed (DRV.MOTIONSTAT bit 4)".into(),
        "check how it is to home and the switches, then {home}";
    /// No home position.
    NotHomed = "not-homed", Held,
        |s| positioning(s) && !s.has(Zsw1::HOMED),
        |_| "enabled (S4), but the axis is not homed (ZSW1 bit 11 is 0): it accepts no task".into(),
        "home it: STW1 bit 11 in the controller, or {home}";
    /// STW1 bit 4, position mode.
    Rejected = "rejected", Waits,
        |s| positioning(s) && s.lacks(Stw1::NO_REJECT),
        |s| format!("enabled (S4), but {} rejects traversing tasks (STW1 bit 4 is 0)", s.owner()),
        "in the controller: set STW1 bit 4, then a new edge of bit 6";
    /// STW1 bit 5, position mode.
    IntermediateStop = "intermediate-stop", Waits,
        |s| positioning(s) && s.lacks(Stw1::NO_INTERMEDIATE_STOP),
        |s| format!("enabled (S4), but {} commands an intermediate stop (STW1 bit 5 is 0)", s.owner()),
        "in the controller: set STW1 bit 5, the task goes on";
    /// A task is under way, but the axis stands.
    TaskHeld = "task-held", Held,
        |s| positioning(s) && s.has(Zsw1::TASK_ACTIVE),
        |_| "enabled (S4), but its task is held (ZSW1 bits 13 and 14): by DRV.STOP, by a dwell time, or at a limit".into(),
        "a new task replaces it";
    /// The drive could not start the task.
    TaskRefused = "task-refused", Held,
        |s| positioning(s)
            && (motion(s) & NOT_STARTED != 0
                || (s.sent(Stw1::ACTIVATE_TASK) && !s.has(Zsw1::TASK_ACKNOWLEDGED) && !s.has(Zsw1::REACHED))),
        |_| "enabled (S4), but the drive did not accept the traversing task (ZSW1 bit 12 is 0)".into(),
        "look at warnings and at the task: target, speed and ramps within the limits?";
    /// At the target.
    AtTarget = "at-target", Waits,
        |s| positioning(s) && s.has(Zsw1::REACHED),
        |_| "enabled (S4), at the target of its task (ZSW1 bit 10): it waits for the next".into(),
        "";
    /// No task.
    NoTask = "no-task", Waits,
        positioning,
        |s| format!("enabled (S4), but {} starts no traversing task (edge of STW1 bit 6)", s.owner()),
        "in the controller: task or MDI values, then STW1 bit 6 from 0 to 1";
    /// STW1 bit 4, velocity mode.
    RampOff = "ramp-off", Waits,
        |s| s.lacks(Stw1::ENABLE_RAMP),
        |s| format!("enabled (S4), but {} holds the ramp generator at 0 {}", s.owner(), s.bit_is_0(4)),
        "in the controller: set STW1 bits 4, 5 and 6";
    /// STW1 bit 6, velocity mode.
    SetpointOff = "setpoint-off", Waits,
        |s| s.lacks(Stw1::ENABLE_SETPOINT),
        |s| format!("enabled (S4), but {} does not enable the setpoint {}", s.owner(), s.bit_is_0(6)),
        "in the controller: set STW1 bit 6";
    /// STW1 bit 5, velocity mode.
    RampFrozen = "ramp-frozen", Waits,
        |s| s.lacks(Stw1::UNFREEZE_RAMP),
        |s| format!("enabled (S4), but {} freezes the ramp generator {}", s.owner(), s.bit_is_0(5)),
        "in the controller: set STW1 bit 5";
    /// The speed setpoint is 0.
    ZeroSetpoint = "zero-setpoint", Waits,
        |s| s.speed_set.is_some_and(|speed| speed.abs() < STANDS),
        |s| format!("enabled (S4), but {} sends a speed setpoint of 0", s.owner()),
        "in the controller: give a speed";
    /// A setpoint, but no motion.
    DoesNotTurn = "does-not-turn", Held,
        |s| s.speed_set.is_some() && s.speed_actual.is_some(),
        |s| format!(
            "enabled (S4) with a setpoint of {:.1} rpm, but the motor does not turn: brake, load, or a limit of current or speed",
            s.speed_set.unwrap_or_default()
        ),
        "look at brake, load and limits";
    /// In operation, and nothing else is known.
    Operation = "operation", Runs,
        |_| true,
        |_| "it is in operation (S4)".into(),
        "";
}

pub(super) fn first(status: &DriveStatus) -> Diagnosis {
    let found = RULES.iter().find(|rule| (rule.applies)(status));
    let Some(rule) = found else {
        // the last rule applies to everything
        return Diagnosis {
            cause: Cause::Operation,
            verdict: Verdict::Runs,
            sentence: String::new(),
            next: None,
            actions: Vec::new(),
            notes: Vec::new(),
        };
    };
    Diagnosis {
        cause: rule.cause,
        verdict: rule.verdict,
        sentence: (rule.sentence)(status),
        next: advice(rule, status),
        actions: actions(rule.cause, status),
        notes: notes::beside(rule.cause, status),
    }
}

/// What to do about a cause as actions.
fn actions(cause: Cause, status: &DriveStatus) -> Vec<Action> {
    let by_parameter = vendors::disable(status.model).is_some();
    // a stop by parameter leaves the power stage on
    let stop = if by_parameter {
        Action::Disable
    } else {
        Action::Stop
    };
    match cause {
        Cause::TurnsOwnerless | Cause::EnabledOwnerless => {
            let remedy = status.loss.as_ref().and_then(|loss| loss.remedy.clone());
            [Some(stop), remedy].into_iter().flatten().collect()
        }
        // nobody commands it, and whether it turns cannot be read
        Cause::Silent if status.controller == Some(None) => vec![Action::Stop],
        // what its service channel has enabled a parameter switches off
        Cause::LocalOperation if by_parameter && status.has(Zsw1::OPERATION_ENABLED) => vec![stop],
        _ => Vec::new(),
    }
}

/// What to do about a cause: as the make of the drive has it, else what holds for all.
pub(super) fn advice(rule: &Rule, status: &DriveStatus) -> Option<Advice> {
    if let (Cause::LocalOperation, Some(local)) = (rule.cause, &status.local) {
        return Some(local.remedy().into());
    }
    if rule.cause == Cause::NoController && !status.motions.is_empty() {
        return Some(taking(rule.next, &status.motions));
    }
    let own = vendors::advice(rule.cause, status.model);
    let general = || vendors::in_words_of(status, rule.next).unwrap_or_else(|| rule.next.to_owned());
    let next = own.map_or_else(general, str::to_owned);
    if rule.cause == Cause::Fault {
        return Some(fault_advice(status, &next));
    }
    (!next.is_empty()).then(|| next.as_str().into())
}

/// What else can command the axis: that of the actions that the drive can do.
fn taking(next: &str, motions: &[Action]) -> Advice {
    let names: Vec<String> = motions.iter().map(|action| format!("{{{action}}}")).collect();
    let listed = match names.as_slice() {
        [more @ .., last] if !more.is_empty() => format!("{} or {last}", more.join(", ")),
        one => one.concat(),
    };
    format!("{next}, or take the axis with {listed}").as_str().into()
}

/// What ends the faults that are present: the remedy of the first by the table, then `acknowledge`, or a restart where
/// one of them goes away by nothing else.
fn fault_advice(status: &DriveStatus, acknowledge: &str) -> Advice {
    let remedy = status.faults.first().and_then(|fault| fault.remedy);
    let remedy = remedy.filter(|text| !text.is_empty());
    let restart = |fault: &&FaultEntry| fault.cleared == Some(Cleared::Restart);
    let restart = status.faults.iter().find(restart);
    match (remedy, restart.and_then(|fault| fault.clearing.as_deref())) {
        (Some(remedy), None) => {
            let acknowledge = acknowledge.trim_start_matches("remove the cause, ");
            Advice::from(remedy).then(acknowledge.into())
        }
        (None, None) => acknowledge.into(),
        (remedy, Some(clearing)) => {
            Advice::from(remedy.unwrap_or("remove the cause")).and(format!("; then {clearing}"))
        }
    }
}

/// What holds an axis that something outside turns.
const MOVED_NEXT: &str = "keep clear: no command stops it; let it come to rest, close a brake that holds it, or take the load away";

/// What to do about an axis of this make that something outside turns.
#[must_use]
pub fn moved_advice(model: &str) -> &'static str {
    vendors::advice(Cause::MovedExternally, model).unwrap_or(MOVED_NEXT)
}

pub(super) fn moved(status: &DriveStatus) -> String {
    format!(
        "it turns at {} with its power stage off: it coasts, or something outside moves it (a load that hangs on it, a brake that does not hold)",
        speed(status)
    )
}

/// What commands a drive that nobody is connected to.
fn in_force(status: &DriveStatus) -> String {
    if let Some((loss, parameter, setting)) = status.loss.as_ref().and_then(by_reaction) {
        let from = loss.after.map_or_else(String::new, |after| {
            format!(", from {} s after the last control word", after.as_secs_f64())
        });
        return format!(
            "what it does when its controller is lost commands it ({parameter} is {setting}){from}"
        );
    }
    match status.control_word {
        Some(word) if status.sent(Stw1::CONTROL_BY_PLC | Stw1::ON) => {
            format!("the last control word, 0x{word:04X}, is still in force")
        }
        _ => "what commanded it last is still in force".to_owned(),
    }
}

/// What commands a drive that has lost its controller, where that is not the last control word.
fn by_reaction(loss: &LossReaction) -> Option<(&LossReaction, &str, &str)> {
    let (parameter, setting) = loss.parameter.as_deref().zip(loss.setting.as_deref())?;
    loss.commands.then_some((loss, parameter, setting))
}

fn bus_is_low(status: &DriveStatus) -> bool {
    let least = status.bus_lowest.unwrap_or_default().max(NO_VOLTAGE);
    status.bus_voltage.is_some_and(|volts| volts < least)
}

/// What goes before something that keeps an enabled axis from moving.
fn but(status: &DriveStatus) -> &'static str {
    if status.state() == Some(State::S4) {
        "enabled (S4), but "
    } else {
        ""
    }
}

fn fault(status: &DriveStatus) -> String {
    match status.faults.as_slice() {
        [] => "a fault is present (ZSW1 bit 3), the drive does not report its number".into(),
        [fault, more @ ..] => {
            let text = fault.meaning.unwrap_or("not in the tables");
            let others = match more {
                [] => String::new(),
                [other] => format!(", then F{}", other.number),
                _ => format!(", then {} more", more.len()),
            };
            format!("fault F{} is present: {text}{others}", fault.number)
        }
    }
}

fn sources(status: &DriveStatus) -> u16 {
    status.disable_sources.unwrap_or(0)
}

fn motion(status: &DriveStatus) -> u32 {
    status.motion.unwrap_or(0)
}

fn positioning(status: &DriveStatus) -> bool {
    status.mode == Some(2)
}

pub(super) fn turns(status: &DriveStatus) -> bool {
    let above = |speed: Option<f64>, least: f64| speed.is_some_and(|speed| speed.abs() >= least);
    above(status.speed_actual, STANDS) || above(status.speed_percent, STANDS_PERCENT)
}

/// The speed in the unit in which it is known.
fn speed(status: &DriveStatus) -> String {
    match (status.speed_actual, status.speed_percent) {
        (None, Some(percent)) => format!("{percent:.1} % of its reference"),
        (speed, _) => format!("{:.1} rpm", speed.unwrap_or_default()),
    }
}

/// In operation and turning; in position mode the drive says so itself.
fn moves(status: &DriveStatus) -> bool {
    turns(status) || (positioning(status) && !status.has(Zsw1::STOPPED))
}

fn stands_in(status: &DriveStatus) -> String {
    status
        .state()
        .map_or_else(String::new, |state| format!(" (the drive is in {state})"))
}

fn telegram(status: &DriveStatus) -> String {
    status
        .telegram
        .map_or_else(|| "its telegram".into(), |number| format!("telegram {number}"))
}
