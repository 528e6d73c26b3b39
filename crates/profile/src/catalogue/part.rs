//! The role of a parameter for a client: which parameter holds the speed, the ramps, the control word.

use super::{Catalogue, Parameter};

macro_rules! parts {
    ($($(#[$doc:meta])* $name:ident = $key:literal;)*) => {
        /// A role that parameters of several vendors have, for reading or writing. A model without such a parameter has
        /// no row.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Part {
            $($(#[$doc])* $name,)*
        }

        impl Part {
            /// Every part.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Returns the word for it in `data/<model>/parts.csv`.
            #[must_use]
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$name => $key,)*
                }
            }
        }
    };
}

parts! {
    /// Control word that the drive acts on.
    ControlWord = "control-word";
    /// Status word.
    StatusWord = "status-word";
    /// Numbers of the parameters in the words behind the speed setpoint, word by word.
    ChosenSetpoints = "chosen-setpoints";
    /// Speed setpoint of the controller.
    SpeedSetpoint = "speed-setpoint";
    /// Speed as it is sent to the controller.
    SpeedActual = "speed-actual";
    /// Speed of the motor in rpm.
    Speed = "speed";
    /// Output frequency in Hz.
    Frequency = "frequency";
    /// Position in increments of one revolution.
    Position = "position";
    /// Position command minus position, in the same increments.
    FollowingError = "following-error";
    /// Where setpoints come from; 1 is the field bus.
    CommandSource = "command-source";
    /// What keeps the power stage off, bit by bit.
    DisableSources = "disable-sources";
    /// What keeps an enabled axis from moving, bit by bit.
    MotionDisableSources = "motion-disable-sources";
    /// State of the motion, bit by bit.
    MotionStatus = "motion-status";
    /// 0 while safe torque off is active.
    TorqueAllowed = "torque-allowed";
    /// Not 0 while the limit switch at the negative end is hit.
    NegativeSwitch = "negative-switch";
    /// Not 0 while the limit switch at the positive end is hit.
    PositiveSwitch = "positive-switch";
    /// Bits 0 and 1: at a software limit.
    SoftwareLimitState = "software-limit-state";
    /// Voltage of the DC bus.
    BusVoltage = "bus-voltage";
    /// Voltage of the DC bus below which the drive does not run.
    BusLowest = "bus-lowest";
    /// 1: a holding brake is fitted, which the drive applies while its power stage is off.
    Brake = "brake";
    /// 1: the brake is released by hand.
    BrakeReleased = "brake-released";
    /// Current of the motor.
    Current = "current";
    /// Limit of the current, negative.
    NegativeCurrentLimit = "negative-current-limit";
    /// Limit of the current, positive.
    PositiveCurrentLimit = "positive-current-limit";
    /// Ramp up, rpm/s.
    Acceleration = "acceleration";
    /// Ramp down, rpm/s.
    Deceleration = "deceleration";
    /// Time of the ramp up, s.
    RampUpTime = "ramp-up-time";
    /// Time of the ramp down, s.
    RampDownTime = "ramp-down-time";
    /// Highest speed forward.
    ForwardLimit = "forward-limit";
    /// Highest speed backward.
    BackwardLimit = "backward-limit";
    /// Which direction the motor may turn in: 0 forward, 1 backward, 2 both.
    Direction = "direction";
    /// 0: no references backward.
    ReferenceRange = "reference-range";
    /// Speed of jog 1.
    Jog1 = "jog-1";
    /// Speed of jog 2.
    Jog2 = "jog-2";
    /// Speed of jog with control words of the vendor that have one only.
    JogOnly = "jog-only";
    /// Not 0: the axis is a modulo axis.
    Modulo = "modulo";
    /// One end of the modulo range.
    ModuloEnd1 = "modulo-end-1";
    /// The other end of the modulo range.
    ModuloEnd2 = "modulo-end-2";
    /// Which way round a modulo axis goes.
    ModuloWay = "modulo-way";
    /// Bits 0 and 1: the software limits count.
    SoftwareLimitsOn = "software-limits-on";
    /// One software limit.
    SoftwareLimit0 = "software-limit-0";
    /// The other software limit.
    SoftwareLimit1 = "software-limit-1";
    /// How homing is done.
    HomeMode = "home-mode";
    /// 1: a linear motor.
    MotorType = "motor-type";
    /// Way of one electrical revolution of a linear motor.
    MotorPitch = "motor-pitch";
    /// Unit of positions of a rotary motor.
    UnitRotary = "unit-rotary";
    /// Unit of positions of a linear motor.
    UnitLinear = "unit-linear";
    /// Own unit of positions: numerator.
    UnitNumerator = "unit-numerator";
    /// Own unit of positions: denominator.
    UnitDenominator = "unit-denominator";
    /// Steps of speed signals.
    VelocityScaling = "velocity-scaling";
    /// Steps of acceleration signals.
    AccelerationScaling = "acceleration-scaling";
    /// Divisor of positions.
    PositionScaling = "position-scaling";
    /// Current that is 100 %.
    PeakCurrent = "peak-current";
    /// Bits of one revolution.
    SingleturnBits = "singleturn-bits";
    /// Highest reference, which is 100 %: a frequency where [`ReferenceUnit`](Self::ReferenceUnit) or its unit says so, else a speed.
    Reference = "reference";
    /// The lowest reference, where the speed word of own telegrams counts from it on.
    LowestReference = "lowest-reference";
    /// Unit of the reference where it can be chosen.
    ReferenceUnit = "reference-unit";
    /// Nominal frequency of the motor.
    MotorFrequency = "motor-frequency";
    /// Nominal speed of the motor.
    MotorSpeed = "motor-speed";
    /// Poles of the motor, twice its pole pairs.
    MotorPoles = "motor-poles";
    /// Which bits the control word of the vendor's own telegrams has.
    ControlProfile = "control-profile";
    /// Decides what the drive does when its controller is lost. With the values of the row it stops.
    LostController = "lost-controller";
    /// When its controller is lost, the drive keeps turning with these values. The values of this part and of the other
    /// `loss` parts are those of one parameter.
    LossKeepsTurning = "loss-keeps-turning";
    /// With these of the values with which it keeps turning the drive does nothing: its last control word stays in force.
    LossNone = "loss-none";
    /// When its controller is lost, the drive stops along its ramp with these values.
    LossRamp = "loss-ramp";
    /// When its controller is lost, the drive does a quick stop with these values.
    LossQuickStop = "loss-quick-stop";
    /// When its controller is lost, the drive switches its power stage off and coasts with these values.
    LossCoast = "loss-coast";
    /// When its controller is lost, the drive stops with these values, and no source says how.
    LossStop = "loss-stop";
    /// When its controller is lost, the drive stops by its stop function ([`StopFunction`](Self::StopFunction)) with these
    /// values.
    LossStopFunction = "loss-stop-function";
    /// Time from the last control word until the drive counts its controller as lost, s.
    LossTime = "loss-time";
    /// How the drive stops: along its ramp with the values of the row, else it coasts.
    StopFunction = "stop-function";
    /// Who may command the drive. With the values of the row the field bus may not.
    ControlSite = "control-site";
    /// Writing it stops all motion on the ramp.
    Stop = "stop";
    /// Writing it switches the power stage off.
    Disable = "disable";
    /// Number of a fault that is present, 0 for none.
    Fault = "fault";
    /// Number of a warning that is present, 0 for none.
    Warning = "warning";
    /// Faults that are present, bit by bit; the second row has bits 32 to 63.
    AlarmWord = "alarm-word";
    /// Warnings that are present, bit by bit; the second row has bits 32 to 63.
    WarningWord = "warning-word";
    /// Codes of the last faults, newest first.
    FaultLog = "fault-log";
    /// What the drive noted with each of them.
    FaultLogValue = "fault-log-value";
    /// When each of them came.
    FaultLogTime = "fault-log-time";
    /// Identity and state of the drive.
    Page = "page";
}

/// One row of `data/<model>/parts.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartRow {
    /// The part.
    pub part: Part,
    /// Number of the parameter.
    pub pnu: u16,
    /// Its subindex where it is an element of a collecting number.
    pub base: Option<u16>,
    /// Values that the part is about; which ones is reported there.
    pub values: &'static [i64],
}

impl Catalogue {
    /// Returns the parameter that has this part; the first one where several have it.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Part, VACON, VLT};
    /// let name = |tables: &profidrive_profile::catalogue::Catalogue| tables.part(Part::Speed).unwrap().name;
    /// assert_eq!([name(&AKD), name(&VLT), name(&VACON)], ["VL.FB_32", "Speed [RPM]", "Motor speed"]);
    /// assert!(VLT.part(Part::Stop).is_none());
    /// ```
    #[must_use]
    pub fn part(&self, part: Part) -> Option<&'static Parameter> {
        self.parts_of(part).next()
    }

    /// Every parameter that has this part, in the order of the table.
    pub fn parts_of(&self, part: Part) -> impl Iterator<Item = &'static Parameter> {
        let rows = self.parts.iter().filter(move |row| row.part == part);
        rows.filter_map(|row| self.by_address(row.pnu, row.base))
    }

    /// Returns the values that the row of a part names.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{Part, VLT};
    /// assert_eq!(VLT.part_values(Part::LostController), [2, 5]); // 8-04: stop, stop and trip
    /// ```
    #[must_use]
    pub fn part_values(&self, part: Part) -> &'static [i64] {
        let row = self.parts.iter().find(|row| row.part == part);
        row.map_or(&[], |row| row.values)
    }

    /// Returns the parts that a parameter has.
    pub fn parts_at(&self, pnu: u16, base: Option<u16>) -> impl Iterator<Item = Part> {
        let rows = self
            .parts
            .iter()
            .filter(move |row| (row.pnu, row.base) == (pnu, base));
        rows.map(|row| row.part)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AKD, Access, VACON, VLT};
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn every_row_is_a_parameter_and_every_model_has_control_and_status_words() {
        for tables in [&AKD, &VLT, &VACON] {
            for row in tables.parts {
                assert!(tables.by_address(row.pnu, row.base).is_some(), "{row:?}");
            }
            for part in [Part::ControlWord, Part::StatusWord, Part::Speed, Part::Page] {
                assert!(tables.part(part).is_some(), "{} {part:?}", tables.model);
            }
            let speed = tables.part(Part::Speed).unwrap();
            assert_eq!((speed.unit, speed.access), ("rpm", Access::ReadOnly));
        }
        assert_eq!(VLT.parts_of(Part::WarningWord).count(), 2);
        assert_eq!(
            AKD.parts_at(3064, None).collect::<Vec<_>>(),
            [Part::VelocityScaling]
        );
    }

    #[test]
    fn values_of_a_part_are_choices_of_its_parameter() {
        for tables in [&AKD, &VLT, &VACON] {
            for row in tables.parts.iter().filter(|row| !row.values.is_empty()) {
                let parameter = tables.by_address(row.pnu, row.base).unwrap();
                for value in row.values {
                    assert!(parameter.choice(*value).is_some(), "{row:?} {value}");
                }
            }
        }
        assert_eq!(VLT.part(Part::LostController).unwrap().pnu, 804);
    }

    #[test]
    fn numbers_of_the_akd_that_a_client_relies_on() {
        for (part, name) in [
            (Part::Acceleration, "DRV.ACC"),
            (Part::CommandSource, "DRV.CMDSOURCE"),
            (Part::TorqueAllowed, "STO.STATE"),
            (Part::SoftwareLimitState, "SWLS.STATE"),
            (Part::PositiveCurrentLimit, "IL.LIMITP"),
            (Part::UnitDenominator, "UNIT.POUT"),
            (Part::FollowingError, "XIST_ERROR"),
        ] {
            assert_eq!(AKD.part(part).map(|found| found.name), Some(name));
        }
    }
}
