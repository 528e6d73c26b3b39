//! What a drive watches, and which fault or warning number it raises: data, the walking is in `drive::faults`.

use profile::catalogue::Part;

/// A physical cause with the number it raises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Number of the fault (PNU 947) or warning (DRV.WARNING1 and following).
    pub number: u16,
    /// True for a warning: there while the cause is, no reaction.
    pub warning: bool,
    /// What is watched.
    pub cause: Cause,
    /// Beyond what.
    pub limit: Limit,
    /// In which situation the cause counts. A fault that has come cannot be acknowledged while its cause is there,
    /// whatever the situation.
    pub when: When,
    /// How long the cause must be there without a break.
    pub delay: Option<Delay>,
}

/// What is watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Cause {
    /// Following error above the limit, in the position unit of the drive.
    FollowingError,
    /// Speed above the limit, rpm.
    Overspeed,
    /// Current that the foldback of the drive allows below the limit, A.
    DriveFoldback,
    /// Current that the foldback of the motor allows below the limit, A.
    MotorFoldback,
    /// Voltage of the DC bus above the limit, V.
    BusHigh,
    /// Voltage of the DC bus below the limit, V.
    BusLow,
    /// Resistance of the temperature sensor of the motor above the limit, ohm.
    MotorSensor,
    /// Temperature of the power stage above the limit, degC.
    PowerStage,
    /// Safe torque off is active.
    SafeTorqueOff,
    /// The feedback does not answer.
    FeedbackLost,
    /// The hardware limit switch of the positive direction is touched.
    PositiveSwitch,
    /// The hardware limit switch of the negative direction is touched.
    NegativeSwitch,
    /// The holding brake is applied.
    BrakeClosed,
    /// A disable on the ramp takes longer than the limit, ms.
    SlowDisable,
    /// Calculated thermal load of the motor above the limit, %.
    MotorLoad,
    /// The same, only while the calculated protection is to trip.
    MotorLoadTrip,
    /// How much of the inverter's reserve is used up above the limit, %.
    InverterLoad,
    /// The current limit holds the ramp.
    CurrentLimit,
    /// The mains is away.
    MainsLost,
    /// Temperature of the motor above the limit, degC.
    MotorHot,
}

impl Cause {
    /// Number of causes.
    pub const COUNT: usize = 20;

    /// True when the value must be below the limit instead of above it.
    #[must_use]
    pub const fn is_below(self) -> bool {
        matches!(self, Self::DriveFoldback | Self::MotorFoldback | Self::BusLow)
    }
}

/// Beyond what a value must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The engineering value of this parameter; 0 switches the supervision off.
    Parameter(Part),
    /// Always the same.
    Fixed(f64),
    /// The cause is there or it is not.
    Present,
}

/// In which situation a cause counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum When {
    /// Always.
    Always,
    /// While the power stage is on, or is about to be switched on.
    Enabled,
    /// While the power stage is off.
    Disabled,
    /// In speed and position mode.
    NotCurrent,
    /// Always when this parameter is 0, else as [`Self::Enabled`].
    ByMode(Part),
}

/// How long a cause must last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delay {
    /// Only while this parameter is not 0.
    pub mode: Part,
    /// Time, ms.
    pub milliseconds: u16,
}
