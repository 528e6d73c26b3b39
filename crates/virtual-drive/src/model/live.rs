//! What stands behind a parameter that is not just a stored number.

use profile::catalogue::Part;

/// What a parameter shows and does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Live {
    /// Nothing but the stored number.
    Stored,
    /// A measured value; its resolution is in the catalogue.
    Measured(Quantity),
    /// A position, in the unit of the parameter; on the wire it wraps.
    Place(Place),
    /// The same engineering value as another parameter, in its own steps.
    Same(u16),
    /// Setpoint signal of the parameter's own number: the value that came last.
    Setpoint,
    /// The same, and it sets another parameter, within the limits of that one.
    Through(u16),
    /// A setpoint signal of another number: the value that came last.
    Signal(u16),
    /// The speed setpoint that came last, % of the way from the lowest to the highest reference, whatever its steps in the
    /// telegram are.
    SpeedReference,
    /// The control word that the controller sent last.
    ControlWord,
    /// The status word that the drive sends.
    StatusWord,
    /// Number of the telegram in use; writing chooses the one to start with.
    Telegram,
    /// PNU 930: 1 speed, 2 position, bit 15 for vendor-specific modes.
    OperatingMode,
    /// Control mode, changes only while the power stage is off.
    Mode,
    /// PNU 965: number and version of the profile.
    Profile,
    /// Number of changes of the fault buffer.
    FaultCounter,
    /// The n-th fault that is not acknowledged, 0 when there are fewer.
    Fault(u8),
    /// The n-th warning, 0 when there are fewer.
    Warning(u8),
    /// The bits of the faults that are not acknowledged: 32 of them from this one on.
    AlarmWord(u8),
    /// The bits of the warnings: 32 of them from this one on.
    WarningWord(u8),
    /// Extended status word of a VLT (16-94).
    ExtendedStatus,
    /// Number of fault situations; writing 0 clears the buffer.
    FaultSituations,
    /// The chosen process data word, from 0, as the drive sends it or as it came.
    Word {
        /// To the controller.
        actual: bool,
        /// Behind control or status word and speed, from 0.
        number: u8,
    },
    /// Writing one of these values does something; it reads as 0.
    Choose(&'static [i64], Action),
    /// Writing 1 to 4 copies the set-up that is edited to that one, 9 to all; it reads as 0.
    CopySetUp,
    /// Which set-up each channel edits.
    EditedSetUps,
    /// Time in milliseconds after which the controller counts as lost.
    Watchdog,
    /// Position of the rotary switches.
    Rotary,
    /// 1 while the power stage is on.
    Active,
    /// Bit field of the reasons why the power stage is off.
    DisableSources,
    /// 1 while torque is allowed, 0 for safe torque off.
    TorqueAllowed,
    /// 1 while the hardware limit switch of this direction is touched.
    LimitSwitch {
        /// Of the positive direction.
        positive: bool,
    },
    /// 1 while the level at a digital input is high.
    Input {
        /// Its number, from 1.
        number: u8,
    },
    /// Bit field of motion.
    MotionStatus,
    /// Number of the motion task that runs: 0 none, bit 15 MDI.
    RunningTask,
    /// Bit field of the software limits that are reached.
    SoftwareLimits,
    /// Writing a number empties that motion task, -1 all.
    ClearTask,
    /// Writing a number starts that motion task.
    StartTask,
    /// Bit field put together from bits of other parameters.
    Bits(&'static [Bit]),
    /// An array that is computed.
    Array(Table),
    /// A command.
    Do(Action),
    /// A procedure that a virtual drive does not have: 0, which starts nothing, is the only value.
    Absent,
}

/// One bit of another parameter in a bit field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bit {
    /// Number of the bit here.
    pub bit: u8,
    /// Part of the other parameter.
    pub part: Part,
    /// Number of the bit there.
    pub of: u8,
}

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Speed as measured, rpm.
    Speed,
    /// Speed through a filter, rpm.
    SpeedFiltered,
    /// Output of the ramp generator, rpm.
    SpeedCommand,
    /// Command minus measurement, rpm.
    SpeedError,
    /// Torque-producing current, A.
    Current,
    /// Commanded current, A.
    CurrentCommand,
    /// Speed of the trajectory in position mode, rpm.
    TaskSpeed,
    /// Voltage of the DC bus, V.
    BusVoltage,
    /// Power in the brake resistor, W.
    RegenPower,
    /// Current that the foldback allows, A.
    Foldback,
    /// The same, of the drive alone.
    DriveFoldback,
    /// The same, of the motor alone.
    MotorFoldback,
    /// Resistance of the temperature sensor of the motor, ohm.
    MotorSensor,
    /// A temperature, degC.
    Temperature(Sensor),
    /// Output frequency without sign, Hz.
    Frequency,
    /// The same with sign, % of the highest reference.
    FrequencyPart,
    /// Output voltage, V.
    MotorVoltage,
    /// Power at the shaft, kW.
    Power,
    /// The same in hp.
    Horsepower,
    /// The same, % of the nominal power.
    PowerPart,
    /// Torque, Nm.
    Torque,
    /// The same, % of the nominal torque.
    TorquePart,
    /// Calculated thermal load of the motor, %.
    MotorLoad,
    /// How much of the inverter's reserve is used up, %.
    InverterLoad,
    /// Power in the brake resistor, kW.
    BrakePower,
    /// Speed that the reference requests, rpm.
    Reference,
    /// The same, Hz.
    ReferenceFrequency,
    /// The same, % of the highest reference.
    ReferencePart,
    /// Speed, % of the highest reference.
    SpeedPart,
    /// Speed, % of the way from the lowest to the highest reference.
    SpeedOfRange,
    /// Time since power on, h.
    PowerTime,
    /// Time with the power stage on, h.
    RunningTime,
    /// Energy that went to the motor, kWh.
    Energy,
    /// How often power came.
    PowerUps,
    /// Faults of temperature.
    OverTemperatures,
    /// Faults of too high a voltage.
    OverVoltages,
}

/// What position, and in which unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Actual position in parts of a revolution (PNU 1002).
    Singleturn,
    /// Following error in the same parts.
    FollowingSingleturn,
    /// Actual position in the unit of the user.
    Actual,
    /// Commanded position in the unit of the user.
    Command,
    /// Following error in the unit of the user.
    Following,
    /// What the feedback gives, in the unit of the user.
    Feedback,
    /// Angle of the feedback in 2^-32 revolutions.
    Angle,
}

/// Where a temperature is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensor {
    /// Control board.
    Control,
    /// Power stage.
    PowerStage,
    /// Motor winding.
    Motor,
}

/// Arrays that are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// PNU 915: signal numbers of the setpoint telegram, one per word.
    SetpointSignals,
    /// PNU 916: signal numbers of the actual value telegram, one per word.
    ActualSignals,
    /// PNU 923: PNU of each signal number.
    SignalParameters,
    /// PNU 947: fault numbers, 8 situations of 8.
    FaultNumbers,
    /// PNU 915 of a drive whose process data words are chosen by parameter number: those numbers in a telegram of the
    /// vendor, signal numbers in one of the profile.
    SetpointWords,
    /// PNU 916 of such a drive.
    ActualWords,
    /// The process data in of a telegram, one for each element, in 32 bits (PNU 10122 of a Vacon).
    WideWords,
    /// Codes of the faults that came last, the newest first.
    LogCodes,
    /// When they came, s since power on.
    LogTimes,
    /// Which words changed, the last change first.
    HistoryEvents,
    /// To what.
    HistoryValues,
    /// When, ms since power on.
    HistoryTimes,
    /// PNU 964: drive unit identification.
    Identification,
    /// PNU 975: drive object identification.
    DriveObject,
    /// PNU 980 and following: the n-th part of the list of all PNUs.
    Numbers(u8),
    /// PNU 990 and following: the n-th part of the list of those that are not as delivered.
    Changed(u8),
}

/// What a command does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Power stage on, for the service channel: only while that one commands (DRV.CMDSOURCE 0), no controller has
    /// control (STW1 bit 10) and there is no fault; else error 0x11.
    Enable,
    /// Power stage off, at once or on the ramp (DRV.DISMODE); ends in S1, so that a controller needs OFF and ON.
    Disable,
    /// Stop all motion on the ramp; a setpoint of 0 or a closed setpoint channel ends it. In position mode a motion task
    /// waits for [`ContinueTask`](Self::ContinueTask).
    Stop,
    /// Store the values being edited as a motion task.
    SetTask,
    /// Fetch a motion task into the values being edited.
    LoadTask,
    /// Go on with the motion task that a stop interrupted.
    ContinueTask,
    /// Start homing.
    Home,
    /// The axis is homed where it stands.
    SetHome,
    /// Clear the faults whose cause is gone.
    ClearFaults,
    /// Store the parameters.
    Save,
    /// Fetch the stored parameters; not while the power stage is on.
    Load,
    /// Values as delivered; not while the power stage is on.
    Defaults,
    /// Reset the energy counter.
    ResetEnergy,
    /// Reset the time counter.
    ResetRunningTime,
    /// Show which drive this is.
    Blink,
    /// Restart with the values as saved.
    Restart,
    /// Take the address by the settings of now; not while a controller is connected.
    ApplyAddress,
    /// Nothing is left to do for it: what it stops or clears is never there.
    Nothing,
}
