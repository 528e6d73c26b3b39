// Generated from data/profile/parts.csv by `cargo run -p xtask -- gen`.

/// What a parameter is to drive and client. A model without such a parameter has no row of the part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// Control word that the drive acts on.
    ControlWord,
    /// Status word.
    StatusWord,
    /// Numbers of the parameters in the words behind the speed setpoint, word by word.
    ChosenSetpoints,
    /// Speed setpoint of the controller.
    SpeedSetpoint,
    /// Speed as it is sent to the controller.
    SpeedActual,
    /// Speed of the motor in rpm.
    Speed,
    /// Output frequency in Hz.
    Frequency,
    /// Position in increments of one revolution.
    Position,
    /// Position command minus position, in the same increments.
    FollowingError,
    /// Where setpoints come from; 1 is the field bus.
    CommandSource,
    /// What keeps the power stage off, bit by bit.
    DisableSources,
    /// What keeps an enabled axis from moving, bit by bit.
    MotionDisableSources,
    /// Share of its speed with which a motion task runs, in percent; 0 holds it.
    Feedrate,
    /// State of the motion, bit by bit.
    MotionStatus,
    /// 0 while safe torque off is active.
    TorqueAllowed,
    /// Not 0 while the limit switch at the negative end is hit.
    NegativeSwitch,
    /// Not 0 while the limit switch at the positive end is hit.
    PositiveSwitch,
    /// Bits 0 and 1: at a software limit.
    SoftwareLimitState,
    /// Voltage of the DC bus.
    BusVoltage,
    /// Voltage of the DC bus below which the drive does not run.
    BusLowest,
    /// 1: a holding brake is fitted, which the drive applies while its power stage is off.
    Brake,
    /// 1: the brake is released by hand.
    BrakeReleased,
    /// Current of the motor.
    Current,
    /// Limit of the current, negative.
    NegativeCurrentLimit,
    /// Limit of the current, positive.
    PositiveCurrentLimit,
    /// Ramp up, rpm/s.
    Acceleration,
    /// Ramp down, rpm/s.
    Deceleration,
    /// Time of the ramp up, s.
    RampUpTime,
    /// Time of the ramp down, s.
    RampDownTime,
    /// Highest speed forward.
    ForwardLimit,
    /// Highest speed backward.
    BackwardLimit,
    /// Which direction the motor may turn in: 0 forward, 1 backward, 2 both.
    Direction,
    /// With the values of the row references go backward too; with 0 none does.
    ReferenceRange,
    /// Speed of jog 1.
    Jog1,
    /// Speed of jog 2.
    Jog2,
    /// Speed of jog with control words of the vendor that have one only.
    JogOnly,
    /// Not 0: the axis is a modulo axis.
    Modulo,
    /// One end of the modulo range.
    ModuloEnd1,
    /// The other end of the modulo range.
    ModuloEnd2,
    /// Which way round a modulo axis goes.
    ModuloWay,
    /// Bits 0 and 1: the software limits count.
    SoftwareLimitsOn,
    /// One software limit.
    SoftwareLimit0,
    /// The other software limit.
    SoftwareLimit1,
    /// How homing is done.
    HomeMode,
    /// 1: a linear motor.
    MotorType,
    /// Way of one electrical revolution of a linear motor.
    MotorPitch,
    /// Unit of positions of a rotary motor.
    UnitRotary,
    /// Unit of positions of a linear motor.
    UnitLinear,
    /// Own unit of positions: numerator.
    UnitNumerator,
    /// Own unit of positions: denominator.
    UnitDenominator,
    /// Steps of speed signals.
    VelocityScaling,
    /// Steps of acceleration signals.
    AccelerationScaling,
    /// Divisor of positions.
    PositionScaling,
    /// Current that is 100 %.
    PeakCurrent,
    /// Bits of one revolution.
    SingleturnBits,
    /// Highest reference, which is 100 %: a frequency where [`ReferenceUnit`](Self::ReferenceUnit) or its own unit is one, else a speed.
    Reference,
    /// The lowest reference, where the speed word of own telegrams counts from it on.
    LowestReference,
    /// Unit of the reference where it can be chosen. The value of the row is Hz.
    ReferenceUnit,
    /// Nominal frequency of the motor.
    MotorFrequency,
    /// Nominal speed of the motor.
    MotorSpeed,
    /// Poles of the motor, twice its pole pairs.
    MotorPoles,
    /// Which bits the control word of the vendor's own telegrams has.
    ControlProfile,
    /// Decides what the drive does when its controller is lost. With the values of the row it stops.
    LostController,
    /// When its controller is lost, the drive keeps turning with these values. The values of this part and of the other `loss` parts are those of one parameter.
    LossKeepsTurning,
    /// With these of the values with which it keeps turning the drive does nothing: its last control word stays in force.
    LossNone,
    /// When its controller is lost, the drive stops along its ramp with these values.
    LossRamp,
    /// When its controller is lost, the drive does a quick stop with these values.
    LossQuickStop,
    /// When its controller is lost, the drive switches its power stage off and coasts with these values.
    LossCoast,
    /// When its controller is lost, the drive stops with these values, and no source says how.
    LossStop,
    /// When its controller is lost, the drive stops by its stop function ([`StopFunction`](Self::StopFunction)) with these values.
    LossStopFunction,
    /// Time from the last control word until the drive counts its controller as lost, s.
    LossTime,
    /// How the drive stops: along its ramp with the values of the row, else it coasts.
    StopFunction,
    /// Who may command the drive. With the values of the row the field bus may not.
    ControlSite,
    /// Writing it stops all motion on the ramp.
    Stop,
    /// Writing it switches the power stage off.
    Disable,
    /// Number of a fault that is present, 0 for none.
    Fault,
    /// Number of a warning that is present, 0 for none.
    Warning,
    /// Faults that are present, bit by bit; the second row has bits 32 to 63.
    AlarmWord,
    /// Warnings that are present, bit by bit; the second row has bits 32 to 63.
    WarningWord,
    /// Codes of the last faults, newest first.
    FaultLog,
    /// What the drive noted with each of them.
    FaultLogValue,
    /// When each of them came.
    FaultLogTime,
    /// How many fault situations there were.
    FaultSituations,
    /// Describes the drive and its state on the page of `info`.
    Page,
    /// 0: the field bus changes no parameter but this one.
    ParameterEdit,
    /// Cannot be changed while the power stage is on.
    OnlyStopped,
    /// What is controlled: 0 current, 1 speed, 2 position. Changes only while the power stage is off.
    ControlMode,
    /// How the IP address is obtained: 0 by the rotary switches, 1 as DCP set it.
    AddressMode,
    /// Speed command of the service channel, rpm.
    ServiceSpeed,
    /// Current command of the service channel, A.
    ServiceCurrent,
    /// What a disable does: 0 and 1 at once, 2 and 3 after a ramp.
    DisableMode,
    /// Longest time of a disable on the ramp, ms.
    DisableTime,
    /// Bit 0: the connection fault comes when the controller goes from RUN to STOP.
    BusOptions,
    /// Ramp of the quick stop, rpm/s.
    QuickStopDeceleration,
    /// Ramp up of jogging, rpm/s.
    JogAcceleration,
    /// Ramp down of jogging, rpm/s.
    JogDeceleration,
    /// Proportional gain of the velocity loop, A/(rad/s).
    VelocityGain,
    /// Corner frequency of the integral part of the velocity loop, Hz.
    VelocityIntegral,
    /// Part of the reference speed that passes the position loop by.
    VelocityFeedforward,
    /// Proportional gain of the position loop, (rev/s)/rev.
    PositionGain,
    /// Continuous current of the drive, A.
    DriveContinuousCurrent,
    /// Continuous current of the motor, mA.
    MotorContinuousCurrent,
    /// Peak current of the motor, mA.
    MotorPeakCurrent,
    /// Longest time at the peak current of the motor, s.
    MotorPeakTime,
    /// Speed above which the drive has a fault, rpm; 0 for none.
    Overspeed,
    /// Current of the foldback below which the drive has a fault, A.
    FoldbackFault,
    /// The same under another number.
    FoldbackFaultCopy,
    /// Current of the foldback below which the drive warns, A.
    FoldbackWarning,
    /// Voltage of the DC bus above which the drive has a fault, V.
    BusHighFault,
    /// Voltage of the DC bus above which the drive warns, V.
    BusHighWarning,
    /// Voltage of the DC bus below which the drive warns, V.
    BusLowWarning,
    /// 0: a low voltage of the DC bus is a fault at any time, else only while the power stage is on.
    BusLowMode,
    /// Resistance of the temperature sensor of the motor above which the drive has a fault, ohm.
    MotorSensorFault,
    /// Resistance of the temperature sensor of the motor above which the drive warns, ohm.
    MotorSensorWarning,
    /// Following error above which the drive has a fault; 0 for none.
    FollowingErrorFault,
    /// Following error above which the drive warns and is out of tolerance; 0 for none.
    FollowingErrorWarning,
    /// Not 0: the following error must last to count.
    FollowingErrorMode,
    /// Decides what becomes of the fault whose number is the value of the row: 0 fault, 1 nothing, 4 warning.
    FaultAction,
    /// 1: low is active. A row for each digital input.
    InputInverted,
    /// What a digital input does. A row for each.
    InputMode,
    /// What the function of a digital input needs. A row for each.
    InputArgument,
    /// 1 while the level at a digital input is high. A row for each.
    InputState,
    /// What the inputs of the drive command and what they keep from moving, bit by bit.
    DriveInputs,
    /// Number of the motion task being edited.
    TaskNumber,
    /// Target or distance of the task being edited.
    TaskPosition,
    /// Speed of the task being edited, rpm.
    TaskVelocity,
    /// Acceleration of the task being edited, rpm/s.
    TaskAcceleration,
    /// Deceleration of the task being edited, rpm/s.
    TaskDeceleration,
    /// Control word of the task being edited.
    TaskControl,
    /// Number of the task that follows.
    TaskNext,
    /// Time before the task that follows, ms.
    TaskDwell,
    /// Profile table of the task being edited.
    TaskProfile,
    /// Window around the target, in position units.
    TargetWindow,
    /// Window around the speed of the task, rpm.
    TargetSpeedWindow,
    /// How homing is done, under another number.
    HomeModeCopy,
    /// How homing is done, as a setpoint signal.
    HomeModeSignal,
    /// Speed of homing, rpm.
    HomeSpeed,
    /// Ramp up of homing, rpm/s.
    HomeAcceleration,
    /// Ramp down of homing, rpm/s.
    HomeDeceleration,
    /// Start direction of homing: 1 positive.
    HomeDirection,
    /// Percentage of the speed while an index is searched.
    HomeFeedrate,
    /// Current limit on the way to a hard stop, A.
    HomeCurrent,
    /// Position of the home point.
    HomePosition,
    /// Extra move of homing.
    HomeDistance,
    /// Extra move of homing, as a setpoint signal.
    HomeDistanceSignal,
    /// Following error that counts as a hard stop.
    HomeStopError,
    /// Longest way of homing, in position units; 0 for any.
    HomeFarthest,
    /// Not 0: homing starts when the axis is enabled and not homed.
    HomeAutomatic,
    /// Ramp up as a setpoint signal.
    AccelerationSignal,
    /// Ramp down as a setpoint signal.
    DecelerationSignal,
    /// Steps of acceleration signals under another number.
    AccelerationScalingCopy,
    /// Steps of speed signals under another number.
    VelocityScalingCopy,
    /// Nominal power of the motor, kW.
    MotorPower,
    /// Nominal voltage of the motor, V.
    MotorVoltage,
    /// Nominal current of the motor, A.
    MotorCurrent,
    /// Magnetising current of the motor, A.
    MotorMagnetisingCurrent,
    /// Time of ramp 2 up, s.
    Ramp2UpTime,
    /// Time of ramp 2 down, s.
    Ramp2DownTime,
    /// Time of the ramp of the quick stop, s.
    QuickStopTime,
    /// Time of the ramp of jogging, s.
    JogTime,
    /// Lowest reference, where the speed word of own telegrams counts from 0 on.
    ReferenceMinimum,
    /// Preset references, % of the highest one.
    PresetReferences,
    /// What catch up adds and slow down takes away, %.
    ReferenceCorrection,
    /// Lowest speed.
    LowestSpeed,
    /// Lowest output frequency without a warning, Hz.
    LowestFrequency,
    /// Highest output frequency without a warning, Hz.
    HighestFrequency,
    /// Limit of the output current of a frequency converter.
    CurrentLimit,
    /// Nominal current of the inverter, A.
    InverterCurrent,
    /// Highest current of the inverter, A.
    InverterPeakCurrent,
    /// Current of the DC brake.
    BrakeCurrent,
    /// Slip compensation, %.
    SlipCompensation,
    /// Time of the slip compensation, s.
    SlipTime,
    /// Not 0: starts a motor that turns at the speed it has.
    FlyingStart,
    /// With the value of the row the calculated motor protection warns.
    MotorProtectionWarning,
    /// With the value of the row the calculated motor protection trips.
    MotorProtectionTrip,
    /// 0: the key of the panel for running by hand has no effect.
    HandKey,
    /// 0: the key of the panel for off has no effect.
    OffKey,
    /// 0: the key of the panel for the field bus has no effect.
    AutoKey,
    /// The set-up in use, 0 to 4; with any other value the control word chooses it.
    ActiveSetUp,
    /// The set-up that is read and written, 0 to 4; with any other value the active one.
    EditedSetUp,
    /// Which set-up each channel edits.
    EditedSetUps,
    /// With the values of the row the control word chooses the set-up.
    SetUpSite,
    /// Current below which the extended status word has its warning bit set, A.
    LowCurrentWarning,
    /// Current above which the extended status word has its warning bit set, A.
    HighCurrentWarning,
    /// Speed below which the extended status word has its warning bit set, rpm.
    LowSpeedWarning,
    /// Speed above which the extended status word has its warning bit set, rpm.
    HighSpeedWarning,
    /// Word whose changes are logged. The rows are events 1, 2 and so on.
    HistoryWord,
    /// The parameter of signal 1 (PNU 923), where it is not `control-word`.
    ControlWordSignal,
    /// The parameter of signal 2 (PNU 923), where it is not `status-word`.
    StatusWordSignal,
    /// The control word under another number.
    ControlWordCopy,
    /// The status word under another number.
    StatusWordCopy,
    /// The number of the speed setpoint as it came.
    SpeedSetpointSignal,
    /// The speed setpoint, % of the way from the lowest to the highest reference.
    SpeedReference,
    /// Numbers of the parameters in the words behind the actual speed, word by word.
    ChosenActuals,
    /// Process data in 1, 2 and so on.
    ProcessDataIn,
    /// Number of the parameter in process data out 1, 2 and so on.
    ProcessDataOutChoice,
    /// Process data in 1, 2 and so on as they came.
    ReceivedWord,
    /// Process data out 1, 2 and so on as the drive sends them.
    SentWord,
    /// Process data out under other numbers.
    SentWordCopy,
    /// Process data in with 32 bits each.
    WideWords,
    /// Number of the telegram under another number than PNU 922.
    TelegramCopy,
    /// List of all parameters under another number than PNU 980.
    ParameterNumbers,
    /// List of changed parameters under another number than PNU 990.
    ChangedParameters,
    /// Time after which the controller counts as lost, ms.
    Watchdog,
    /// Position of the rotary switches.
    RotarySwitches,
    /// Speed of the motor in rpm under another number.
    SpeedCopy,
    /// Speed through a filter, rpm.
    SpeedFiltered,
    /// Output of the ramp generator, rpm.
    SpeedCommand,
    /// Speed command minus speed, rpm.
    SpeedError,
    /// Speed, % of the highest reference.
    SpeedPercent,
    /// Speed, % of the way from the lowest to the highest reference.
    SpeedOfRange,
    /// Speed that the reference demands, rpm.
    ReferenceSpeed,
    /// Frequency that the reference demands, Hz.
    ReferenceFrequency,
    /// Speed that the reference demands, % of the highest one.
    ReferencePercent,
    /// Output frequency with its sign, % of the highest reference.
    FrequencyPercent,
    /// Output voltage, V.
    OutputVoltage,
    /// Current of the motor under another number.
    CurrentCopy,
    /// Commanded current, A.
    CurrentCommand,
    /// Power at the shaft, kW.
    Power,
    /// Power at the shaft, hp.
    Horsepower,
    /// Power at the shaft, % of the nominal power.
    PowerPercent,
    /// Torque, Nm.
    Torque,
    /// Torque, % of the nominal torque.
    TorquePercent,
    /// Calculated thermal load of the motor, %.
    MotorLoad,
    /// How much of the reserve of the inverter is used up, %.
    InverterLoad,
    /// Power in the brake resistor, kW.
    BrakePower,
    /// Power in the brake resistor, W.
    RegeneratedPower,
    /// Current that the foldback allows, A.
    Foldback,
    /// Current that the foldback of the drive allows, A.
    DriveFoldback,
    /// Current that the foldback of the motor allows, A.
    MotorFoldback,
    /// Resistance of the temperature sensor of the motor, ohm.
    MotorSensor,
    /// Temperature of the control board, degC.
    ControlTemperature,
    /// Temperature of the power stage, degC.
    PowerStageTemperature,
    /// Temperature of the motor, degC.
    MotorTemperature,
    /// Time since power on, h.
    PowerTime,
    /// Time with the power stage on, h.
    RunningTime,
    /// Energy that went to the motor, kWh.
    Energy,
    /// How often power came.
    PowerUps,
    /// Number of faults of temperature.
    OverTemperatures,
    /// Number of faults of too high a voltage.
    OverVoltages,
    /// Which words changed, the last change first.
    HistoryEvents,
    /// The values of these changes.
    HistoryValues,
    /// The times of these changes, ms since power on.
    HistoryTimes,
    /// Number of a fault that is present, beside the fault buffer.
    FaultCopy,
    /// Extended status word.
    ExtendedStatus,
    /// 1 while the power stage is on.
    Active,
    /// State of the motion, bit by bit, under another number.
    MotionStatusCopy,
    /// Number of the motion task that runs: 0 none, bit 15 MDI.
    RunningTask,
    /// Speed of the trajectory in position mode, rpm.
    TaskSpeed,
    /// Position in the unit of the user.
    PositionActual,
    /// Position command in the unit of the user.
    PositionCommand,
    /// Position command minus position in the unit of the user.
    PositionError,
    /// Position of the feedback in the unit of the user.
    FeedbackPosition,
    /// Angle of the feedback in 2^-32 revolutions.
    FeedbackAngle,
    /// Writing it switches the power stage on, for the service channel.
    Enable,
    /// Writing it clears the faults whose cause is gone.
    ClearFaults,
    /// Writing it, or the value of the row, saves the parameters.
    Save,
    /// Writing it fetches the saved parameters.
    Load,
    /// Writing it, or the value of the row, sets the values as delivered.
    Defaults,
    /// Writing it, or the value of the row, restarts the drive.
    Restart,
    /// Writing it makes the drive show itself.
    Blink,
    /// Writing it applies the settings of the IP address.
    ApplyAddress,
    /// Writing it stores the values being edited as a motion task.
    SetTask,
    /// Writing it fetches a motion task into the values being edited.
    LoadTask,
    /// Writing it continues the motion task that a stop interrupted.
    ContinueTask,
    /// Writing a number starts that motion task.
    StartTask,
    /// Writing a number empties that motion task, -1 all.
    ClearTask,
    /// Writing it starts homing.
    Home,
    /// Writing it makes the present position the home position.
    SetHome,
    /// Writing 1 to 4 copies the edited set-up to that one, 9 to all.
    CopySetUp,
    /// Writing the value of the row sets the counted energy to 0.
    ResetEnergy,
    /// Writing the value of the row sets the counted time to 0.
    ResetRunningTime,
    /// Writing it does nothing in a virtual drive: what it stops or clears is never there.
    WithoutEffect,
    /// Starts a procedure that a virtual drive does not have.
    AbsentProcedure,
    /// Protocol at the serial line.
    LineProtocol,
    /// Address at the serial line.
    LineAddress,
    /// Baud rate at the serial line.
    LineBaudRate,
    /// Parity and stop bits at the serial line.
    LineParity,
}

impl Part {
    /// Every part.
    pub const ALL: &'static [Self] = &[
        Self::ControlWord,
        Self::StatusWord,
        Self::ChosenSetpoints,
        Self::SpeedSetpoint,
        Self::SpeedActual,
        Self::Speed,
        Self::Frequency,
        Self::Position,
        Self::FollowingError,
        Self::CommandSource,
        Self::DisableSources,
        Self::MotionDisableSources,
        Self::Feedrate,
        Self::MotionStatus,
        Self::TorqueAllowed,
        Self::NegativeSwitch,
        Self::PositiveSwitch,
        Self::SoftwareLimitState,
        Self::BusVoltage,
        Self::BusLowest,
        Self::Brake,
        Self::BrakeReleased,
        Self::Current,
        Self::NegativeCurrentLimit,
        Self::PositiveCurrentLimit,
        Self::Acceleration,
        Self::Deceleration,
        Self::RampUpTime,
        Self::RampDownTime,
        Self::ForwardLimit,
        Self::BackwardLimit,
        Self::Direction,
        Self::ReferenceRange,
        Self::Jog1,
        Self::Jog2,
        Self::JogOnly,
        Self::Modulo,
        Self::ModuloEnd1,
        Self::ModuloEnd2,
        Self::ModuloWay,
        Self::SoftwareLimitsOn,
        Self::SoftwareLimit0,
        Self::SoftwareLimit1,
        Self::HomeMode,
        Self::MotorType,
        Self::MotorPitch,
        Self::UnitRotary,
        Self::UnitLinear,
        Self::UnitNumerator,
        Self::UnitDenominator,
        Self::VelocityScaling,
        Self::AccelerationScaling,
        Self::PositionScaling,
        Self::PeakCurrent,
        Self::SingleturnBits,
        Self::Reference,
        Self::LowestReference,
        Self::ReferenceUnit,
        Self::MotorFrequency,
        Self::MotorSpeed,
        Self::MotorPoles,
        Self::ControlProfile,
        Self::LostController,
        Self::LossKeepsTurning,
        Self::LossNone,
        Self::LossRamp,
        Self::LossQuickStop,
        Self::LossCoast,
        Self::LossStop,
        Self::LossStopFunction,
        Self::LossTime,
        Self::StopFunction,
        Self::ControlSite,
        Self::Stop,
        Self::Disable,
        Self::Fault,
        Self::Warning,
        Self::AlarmWord,
        Self::WarningWord,
        Self::FaultLog,
        Self::FaultLogValue,
        Self::FaultLogTime,
        Self::FaultSituations,
        Self::Page,
        Self::ParameterEdit,
        Self::OnlyStopped,
        Self::ControlMode,
        Self::AddressMode,
        Self::ServiceSpeed,
        Self::ServiceCurrent,
        Self::DisableMode,
        Self::DisableTime,
        Self::BusOptions,
        Self::QuickStopDeceleration,
        Self::JogAcceleration,
        Self::JogDeceleration,
        Self::VelocityGain,
        Self::VelocityIntegral,
        Self::VelocityFeedforward,
        Self::PositionGain,
        Self::DriveContinuousCurrent,
        Self::MotorContinuousCurrent,
        Self::MotorPeakCurrent,
        Self::MotorPeakTime,
        Self::Overspeed,
        Self::FoldbackFault,
        Self::FoldbackFaultCopy,
        Self::FoldbackWarning,
        Self::BusHighFault,
        Self::BusHighWarning,
        Self::BusLowWarning,
        Self::BusLowMode,
        Self::MotorSensorFault,
        Self::MotorSensorWarning,
        Self::FollowingErrorFault,
        Self::FollowingErrorWarning,
        Self::FollowingErrorMode,
        Self::FaultAction,
        Self::InputInverted,
        Self::InputMode,
        Self::InputArgument,
        Self::InputState,
        Self::DriveInputs,
        Self::TaskNumber,
        Self::TaskPosition,
        Self::TaskVelocity,
        Self::TaskAcceleration,
        Self::TaskDeceleration,
        Self::TaskControl,
        Self::TaskNext,
        Self::TaskDwell,
        Self::TaskProfile,
        Self::TargetWindow,
        Self::TargetSpeedWindow,
        Self::HomeModeCopy,
        Self::HomeModeSignal,
        Self::HomeSpeed,
        Self::HomeAcceleration,
        Self::HomeDeceleration,
        Self::HomeDirection,
        Self::HomeFeedrate,
        Self::HomeCurrent,
        Self::HomePosition,
        Self::HomeDistance,
        Self::HomeDistanceSignal,
        Self::HomeStopError,
        Self::HomeFarthest,
        Self::HomeAutomatic,
        Self::AccelerationSignal,
        Self::DecelerationSignal,
        Self::AccelerationScalingCopy,
        Self::VelocityScalingCopy,
        Self::MotorPower,
        Self::MotorVoltage,
        Self::MotorCurrent,
        Self::MotorMagnetisingCurrent,
        Self::Ramp2UpTime,
        Self::Ramp2DownTime,
        Self::QuickStopTime,
        Self::JogTime,
        Self::ReferenceMinimum,
        Self::PresetReferences,
        Self::ReferenceCorrection,
        Self::LowestSpeed,
        Self::LowestFrequency,
        Self::HighestFrequency,
        Self::CurrentLimit,
        Self::InverterCurrent,
        Self::InverterPeakCurrent,
        Self::BrakeCurrent,
        Self::SlipCompensation,
        Self::SlipTime,
        Self::FlyingStart,
        Self::MotorProtectionWarning,
        Self::MotorProtectionTrip,
        Self::HandKey,
        Self::OffKey,
        Self::AutoKey,
        Self::ActiveSetUp,
        Self::EditedSetUp,
        Self::EditedSetUps,
        Self::SetUpSite,
        Self::LowCurrentWarning,
        Self::HighCurrentWarning,
        Self::LowSpeedWarning,
        Self::HighSpeedWarning,
        Self::HistoryWord,
        Self::ControlWordSignal,
        Self::StatusWordSignal,
        Self::ControlWordCopy,
        Self::StatusWordCopy,
        Self::SpeedSetpointSignal,
        Self::SpeedReference,
        Self::ChosenActuals,
        Self::ProcessDataIn,
        Self::ProcessDataOutChoice,
        Self::ReceivedWord,
        Self::SentWord,
        Self::SentWordCopy,
        Self::WideWords,
        Self::TelegramCopy,
        Self::ParameterNumbers,
        Self::ChangedParameters,
        Self::Watchdog,
        Self::RotarySwitches,
        Self::SpeedCopy,
        Self::SpeedFiltered,
        Self::SpeedCommand,
        Self::SpeedError,
        Self::SpeedPercent,
        Self::SpeedOfRange,
        Self::ReferenceSpeed,
        Self::ReferenceFrequency,
        Self::ReferencePercent,
        Self::FrequencyPercent,
        Self::OutputVoltage,
        Self::CurrentCopy,
        Self::CurrentCommand,
        Self::Power,
        Self::Horsepower,
        Self::PowerPercent,
        Self::Torque,
        Self::TorquePercent,
        Self::MotorLoad,
        Self::InverterLoad,
        Self::BrakePower,
        Self::RegeneratedPower,
        Self::Foldback,
        Self::DriveFoldback,
        Self::MotorFoldback,
        Self::MotorSensor,
        Self::ControlTemperature,
        Self::PowerStageTemperature,
        Self::MotorTemperature,
        Self::PowerTime,
        Self::RunningTime,
        Self::Energy,
        Self::PowerUps,
        Self::OverTemperatures,
        Self::OverVoltages,
        Self::HistoryEvents,
        Self::HistoryValues,
        Self::HistoryTimes,
        Self::FaultCopy,
        Self::ExtendedStatus,
        Self::Active,
        Self::MotionStatusCopy,
        Self::RunningTask,
        Self::TaskSpeed,
        Self::PositionActual,
        Self::PositionCommand,
        Self::PositionError,
        Self::FeedbackPosition,
        Self::FeedbackAngle,
        Self::Enable,
        Self::ClearFaults,
        Self::Save,
        Self::Load,
        Self::Defaults,
        Self::Restart,
        Self::Blink,
        Self::ApplyAddress,
        Self::SetTask,
        Self::LoadTask,
        Self::ContinueTask,
        Self::StartTask,
        Self::ClearTask,
        Self::Home,
        Self::SetHome,
        Self::CopySetUp,
        Self::ResetEnergy,
        Self::ResetRunningTime,
        Self::WithoutEffect,
        Self::AbsentProcedure,
        Self::LineProtocol,
        Self::LineAddress,
        Self::LineBaudRate,
        Self::LineParity,
    ];
}
