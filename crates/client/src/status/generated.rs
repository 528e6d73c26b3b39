// Generated from data/profile/causes.csv by `cargo run -p xtask -- gen`.

use super::Verdict;

/// What keeps a drive from running, or that nothing does. In the order of their weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// The status word cannot be read.
    Silent,
    /// ZSW1 bit 3.
    Fault,
    /// Safe torque off.
    Sto,
    /// The DC bus has too little voltage.
    NoPower,
    /// The hardware enable is missing.
    HardwareDisable,
    /// A digital input commands a stop.
    ControlledStop,
    /// Something else of the drive keeps the power stage off.
    DisableSource,
    /// DRV.CMDSOURCE is not the field bus. Motion tasks come through the service channel, so position mode has it too. A controller that connects sets it by its telegram: without one it holds nothing.
    CommandSource,
    /// ZSW1 bit 9.
    LocalOperation,
    /// PNU 930 is neither 1 nor 2.
    OtherMode,
    /// No controller is connected, and it stands in operation.
    EnabledOwnerless,
    /// No controller is connected.
    NoController,
    /// No controller is connected, its power stage is off, and it turns.
    MovedExternally,
    /// No controller is connected, and it turns.
    TurnsOwnerless,
    /// STW1 bit 10.
    NoControl,
    /// STW1 bit 1.
    CoastStop,
    /// STW1 bit 2.
    QuickStop,
    /// S5.
    Stopping,
    /// S1 with ON still set.
    Inhibited,
    /// S1 otherwise.
    NotReady,
    /// A status word without a state.
    SelfTest,
    /// S2: ON is missing.
    Off,
    /// S3: operation is not enabled.
    OperationDisabled,
    /// ON is sent, S4 is not there yet.
    SwitchingOn,
    /// DRV.MOTIONDISSOURCES.
    MotionHeld,
    /// A speed telegram in position mode.
    SpeedTelegram,
    /// A position telegram in velocity mode.
    TaskTelegram,
    /// A task is under way with a feedrate of 0.
    FeedrateZero,
    /// It turns.
    Moves,
    /// A limit switch is hit.
    LimitSwitch,
    /// A software limit is reached.
    SoftwareLimit,
    /// Homing runs.
    Homing,
    /// Two bits command a jog.
    TwoJogs,
    /// A jog is commanded, and the axis stands.
    JogHeld,
    /// Homing has failed.
    HomingFailed,
    /// No home position.
    NotHomed,
    /// STW1 bit 4, position mode.
    Rejected,
    /// STW1 bit 5, position mode.
    IntermediateStop,
    /// A task is under way, but the axis stands.
    TaskHeld,
    /// The drive could not start the task.
    TaskRefused,
    /// At the target.
    AtTarget,
    /// No task.
    NoTask,
    /// STW1 bit 4, velocity mode.
    RampOff,
    /// STW1 bit 6, velocity mode.
    SetpointOff,
    /// STW1 bit 5, velocity mode.
    RampFrozen,
    /// The speed setpoint is 0.
    ZeroSetpoint,
    /// A setpoint, but no motion.
    DoesNotTurn,
    /// In operation, and nothing else is known.
    Operation,
}

impl Cause {
    /// Every cause, the most important first.
    pub const ALL: &'static [Self] = &[
        Self::Silent,
        Self::Fault,
        Self::Sto,
        Self::NoPower,
        Self::HardwareDisable,
        Self::ControlledStop,
        Self::DisableSource,
        Self::CommandSource,
        Self::LocalOperation,
        Self::OtherMode,
        Self::EnabledOwnerless,
        Self::NoController,
        Self::MovedExternally,
        Self::TurnsOwnerless,
        Self::NoControl,
        Self::CoastStop,
        Self::QuickStop,
        Self::Stopping,
        Self::Inhibited,
        Self::NotReady,
        Self::SelfTest,
        Self::Off,
        Self::OperationDisabled,
        Self::SwitchingOn,
        Self::MotionHeld,
        Self::SpeedTelegram,
        Self::TaskTelegram,
        Self::FeedrateZero,
        Self::Moves,
        Self::LimitSwitch,
        Self::SoftwareLimit,
        Self::Homing,
        Self::TwoJogs,
        Self::JogHeld,
        Self::HomingFailed,
        Self::NotHomed,
        Self::Rejected,
        Self::IntermediateStop,
        Self::TaskHeld,
        Self::TaskRefused,
        Self::AtTarget,
        Self::NoTask,
        Self::RampOff,
        Self::SetpointOff,
        Self::RampFrozen,
        Self::ZeroSetpoint,
        Self::DoesNotTurn,
        Self::Operation,
    ];

    /// Stable name for programs.
#[must_use]
#[rustfmt::skip]
    pub const fn id(self) -> &'static str { match self { Self::Silent => "silent",
Self::Fault => "fault",
Self::Sto => "sto",
Self::NoPower => "no-power",
Self::HardwareDisable => "hardware-disable",
Self::ControlledStop => "controlled-stop",
Self::DisableSource => "disable-source",
Self::CommandSource => "command-source",
Self::LocalOperation => "local-operation",
Self::OtherMode => "other-mode",
Self::EnabledOwnerless => "enabled-alone",
Self::NoController => "no-controller",
Self::MovedExternally => "moved-from-outside",
Self::TurnsOwnerless => "turns-alone",
Self::NoControl => "no-control",
Self::CoastStop => "coast-stop",
Self::QuickStop => "quick-stop",
Self::Stopping => "stopping",
Self::Inhibited => "inhibited",
Self::NotReady => "not-ready",
Self::SelfTest => "self-test",
Self::Off => "off",
Self::OperationDisabled => "operation-disabled",
Self::SwitchingOn => "switching-on",
Self::MotionHeld => "motion-held",
Self::SpeedTelegram => "speed-telegram",
Self::TaskTelegram => "task-telegram",
Self::FeedrateZero => "feedrate-zero",
Self::Moves => "moves",
Self::LimitSwitch => "limit-switch",
Self::SoftwareLimit => "software-limit",
Self::Homing => "homing",
Self::TwoJogs => "two-jogs",
Self::JogHeld => "jog-held",
Self::HomingFailed => "homing-failed",
Self::NotHomed => "not-homed",
Self::Rejected => "rejected",
Self::IntermediateStop => "intermediate-stop",
Self::TaskHeld => "task-held",
Self::TaskRefused => "task-refused",
Self::AtTarget => "at-target",
Self::NoTask => "no-task",
Self::RampOff => "ramp-off",
Self::SetpointOff => "setpoint-off",
Self::RampFrozen => "ramp-frozen",
Self::ZeroSetpoint => "zero-setpoint",
Self::DoesNotTurn => "does-not-turn",
Self::Operation => "operation",
 } }

#[rustfmt::skip]
    pub(super) const fn verdict(self) -> Verdict { match self { Self::Silent => Verdict::Held,
Self::Fault => Verdict::Held,
Self::Sto => Verdict::Held,
Self::NoPower => Verdict::Held,
Self::HardwareDisable => Verdict::Held,
Self::ControlledStop => Verdict::Held,
Self::DisableSource => Verdict::Held,
Self::CommandSource => Verdict::Held,
Self::LocalOperation => Verdict::Held,
Self::OtherMode => Verdict::Held,
Self::EnabledOwnerless => Verdict::Held,
Self::NoController => Verdict::Waits,
Self::MovedExternally => Verdict::Held,
Self::TurnsOwnerless => Verdict::Held,
Self::NoControl => Verdict::Waits,
Self::CoastStop => Verdict::Held,
Self::QuickStop => Verdict::Held,
Self::Stopping => Verdict::Waits,
Self::Inhibited => Verdict::Held,
Self::NotReady => Verdict::Held,
Self::SelfTest => Verdict::Waits,
Self::Off => Verdict::Waits,
Self::OperationDisabled => Verdict::Waits,
Self::SwitchingOn => Verdict::Waits,
Self::MotionHeld => Verdict::Held,
Self::SpeedTelegram => Verdict::Held,
Self::TaskTelegram => Verdict::Held,
Self::FeedrateZero => Verdict::Held,
Self::Moves => Verdict::Runs,
Self::LimitSwitch => Verdict::Held,
Self::SoftwareLimit => Verdict::Held,
Self::Homing => Verdict::Runs,
Self::TwoJogs => Verdict::Waits,
Self::JogHeld => Verdict::Held,
Self::HomingFailed => Verdict::Held,
Self::NotHomed => Verdict::Held,
Self::Rejected => Verdict::Waits,
Self::IntermediateStop => Verdict::Waits,
Self::TaskHeld => Verdict::Held,
Self::TaskRefused => Verdict::Held,
Self::AtTarget => Verdict::Waits,
Self::NoTask => Verdict::Waits,
Self::RampOff => Verdict::Waits,
Self::SetpointOff => Verdict::Waits,
Self::RampFrozen => Verdict::Waits,
Self::ZeroSetpoint => Verdict::Waits,
Self::DoesNotTurn => Verdict::Held,
Self::Operation => Verdict::Runs,
 } }

    /// What to do, whatever the model is; empty where nothing is to be done.
#[rustfmt::skip]
    pub(super) const fn advice(self) -> &'static str { match self { Self::Silent => "{info} shows what it reports",
Self::Fault => "remove the cause, then {acknowledge}, or acknowledge from its controller (STW1 bit 7)",
Self::Sto => "close the safety circuit",
Self::NoPower => "switch the mains on; check contactor, fuses and supply",
Self::HardwareDisable => "close the enable input",
Self::ControlledStop => "release that input",
Self::DisableSource => "remove what keeps it off",
Self::CommandSource => "let it take its setpoints from the field bus",
Self::LocalOperation => "hand control over to the field bus at the drive or in its software",
Self::OtherMode => "{write 930=1} (speed) or {write 930=2} (position) while it is disabled",
Self::EnabledOwnerless => "",
Self::NoController => "start the controller",
Self::MovedExternally => "keep clear: no command stops it; let it come to rest, close a brake that holds it, or take the load away",
Self::TurnsOwnerless => "",
Self::NoControl => "in the controller: set STW1 bit 10, its program must run",
Self::CoastStop => "in the controller: set STW1 bit 1",
Self::QuickStop => "in the controller: set STW1 bit 2",
Self::Stopping => "",
Self::Inhibited => "in the controller: OFF first (STW1 0x047E), then ON (0x047F)",
Self::NotReady => "look at its enable inputs",
Self::SelfTest => "",
Self::Off => "in the controller: ON (STW1 0x047F)",
Self::OperationDisabled => "in the controller: set STW1 bit 3",
Self::SwitchingOn => "",
Self::MotionHeld => "remove what holds it",
Self::SpeedTelegram => "plug telegram 7 or 9 in the controller, or {write 930=1} for speed control",
Self::TaskTelegram => "plug telegram 1 in the controller, or {write 930=2} for positioning",
Self::FeedrateZero => "give a feedrate above 0, where a controller's telegram carries it in the controller",
Self::Moves => "",
Self::LimitSwitch => "move away from it: only the other direction is free",
Self::SoftwareLimit => "move back inside",
Self::Homing => "",
Self::TwoJogs => "in the controller: set one of these bits alone",
Self::JogHeld => "check the speed of the jog, which may be 0; a bit that was 1 before has to be 0 first",
Self::HomingFailed => "check how it is to home and the switches, then {home}",
Self::NotHomed => "home it: STW1 bit 11 in the controller, or {home}",
Self::Rejected => "in the controller: set STW1 bit 4, then a new edge of bit 6",
Self::IntermediateStop => "in the controller: set STW1 bit 5, the task goes on",
Self::TaskHeld => "a new task replaces it",
Self::TaskRefused => "look at warnings and at the task: target, speed and ramps within the limits?",
Self::AtTarget => "",
Self::NoTask => "in the controller: task or MDI values, then STW1 bit 6 from 0 to 1",
Self::RampOff => "in the controller: set STW1 bits 4, 5 and 6",
Self::SetpointOff => "in the controller: set STW1 bit 6",
Self::RampFrozen => "in the controller: set STW1 bit 5",
Self::ZeroSetpoint => "set a speed setpoint other than 0 in the controller",
Self::DoesNotTurn => "look at brake, load and limits",
Self::Operation => "",
 } }
}

/// What to do about a cause with the parameters of a model, actions in braces.
#[rustfmt::skip]
pub(super) static ADVICE: &[(&str, Cause, &str)] = &[
("AKD", Cause::NoPower, "switch the mains on; {read VBUS.VALUE VBUS.UVFTHRESH} shows the voltage"),
("AKD", Cause::ControlledStop, "release that input: {find DIN values} shows which"),
("AKD", Cause::DisableSource, "{read DRV.DISSOURCES} names the bits"),
("AKD", Cause::CommandSource, "{write DRV.CMDSOURCE=1} while it is disabled"),
("AKD", Cause::MovedExternally, "keep clear: no command stops it; let it come to rest, take the load away, or have it held by a brake (MOTOR.BRAKE=1 where one is fitted, MOTOR.BRAKERLS=0)"),
("AKD", Cause::NotReady, "{read DRV.DISSOURCES} may show more"),
("AKD", Cause::MotionHeld, "{read DRV.MOTIONDISSOURCES}"),
("AKD", Cause::FeedrateZero, "{write MT_FEEDRATE=100}, or in the controller where its telegram carries signal 101"),
("AKD", Cause::LimitSwitch, "move away from it, only the other direction is free; {read HWLS.NEGSTATE HWLS.POSSTATE} shows the switches"),
("AKD", Cause::SoftwareLimit, "move back inside: {read SWLS.LIMIT0 SWLS.LIMIT1} shows the limits"),
("AKD", Cause::HomingFailed, "check HOME.MODE and the switches, then {home}"),
("AKD", Cause::TaskHeld, "{write MT.CONTINUE=1} goes on after DRV.STOP; a new task replaces it"),
("AKD", Cause::DoesNotTurn, "{read IL.FB IL.LIMITP VL.LIMITP VL.LIMITN}"),
("VLT", Cause::Sto, "close the safety circuit: 24 V at terminal 37"),
("VLT", Cause::NoPower, "switch the mains on; {read 16-30} shows the voltage of the DC link"),
("VLT", Cause::NotReady, "terminal 27 may command a coast (5-12): {read 16-60} shows the inputs"),
("VLT", Cause::DoesNotTurn, "{read 16-14 4-18 4-13} shows current and limits"),
("VACON", Cause::NoPower, "switch the mains on; {read ID7} shows the voltage of the DC link"),
("VACON", Cause::NotReady, "an input may hold it: {read ID15 ID16} shows the inputs"),
("VACON", Cause::DoesNotTurn, "{read ID3 ID107} shows current and limit"),
];

/// Causes that a warning reports.
#[rustfmt::skip]
pub(super) static WARNINGS: &[(&str, u32, &[Cause])] = &[
("AKD", 602, &[Cause::Sto]),
("AKD", 502, &[Cause::NoPower]),
("AKD", 107, &[Cause::LimitSwitch, Cause::SoftwareLimit]),
("AKD", 108, &[Cause::LimitSwitch, Cause::SoftwareLimit]),
("VLT", 68, &[Cause::Sto]),
("VLT", 8, &[Cause::NoPower]),
("VLT", 36, &[Cause::NoPower]),
];

/// The parameter that switches a drive off beside its controller, and what to do about it.
#[rustfmt::skip]
pub(super) static DISABLES: &[(&str, &str, &str)] = &[
("AKD", "DRV.DIS", "find out what does it: {disable} of another program, service software (WorkBench), or a controller that writes DRV.DIS by record; then start again"),
];
