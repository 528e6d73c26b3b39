// Generated from data/profile/names.csv by `cargo run -p xtask -- gen`.

use super::{CommonName, Part};

#[rustfmt::skip]
pub(super) static NAMES: &[CommonName] = &[
CommonName { name: "ramp-up", parts: &[Part::Acceleration,Part::RampUpTime,], about: "Ramp up: an acceleration or the time up to a speed, by vendor." },
CommonName { name: "ramp-down", parts: &[Part::Deceleration,Part::RampDownTime,], about: "Ramp down: a deceleration or the time down from a speed, by vendor." },
CommonName { name: "ramp-2-up", parts: &[Part::Ramp2UpTime,], about: "Second ramp up." },
CommonName { name: "ramp-2-down", parts: &[Part::Ramp2DownTime,], about: "Second ramp down." },
CommonName { name: "quick-stop-ramp", parts: &[Part::QuickStopDeceleration,Part::QuickStopTime,], about: "Ramp of the quick stop." },
CommonName { name: "jog-ramp-up", parts: &[Part::JogAcceleration,Part::JogTime,], about: "Ramp up of jogging." },
CommonName { name: "jog-ramp-down", parts: &[Part::JogDeceleration,Part::JogTime,], about: "Ramp down of jogging." },
CommonName { name: "homing-ramp-up", parts: &[Part::HomeAcceleration,], about: "Ramp up of homing." },
CommonName { name: "homing-ramp-down", parts: &[Part::HomeDeceleration,], about: "Ramp down of homing." },
CommonName { name: "jog-speed", parts: &[Part::Jog1,], about: "Speed of jog 1." },
CommonName { name: "jog-speed-2", parts: &[Part::Jog2,], about: "Speed of jog 2." },
CommonName { name: "homing-speed", parts: &[Part::HomeSpeed,], about: "Speed of homing." },
CommonName { name: "max-speed", parts: &[Part::ForwardLimit,Part::Reference,], about: "Highest speed forward; a frequency where the drive has its limit in Hz." },
CommonName { name: "max-speed-backward", parts: &[Part::BackwardLimit,], about: "Highest speed backward." },
CommonName { name: "min-speed", parts: &[Part::LowestSpeed,], about: "Lowest speed." },
CommonName { name: "current-limit", parts: &[Part::CurrentLimit,Part::PositiveCurrentLimit,], about: "Limit of the current." },
CommonName { name: "speed", parts: &[Part::Speed,], about: "Speed of the motor." },
CommonName { name: "frequency", parts: &[Part::Frequency,], about: "Output frequency." },
CommonName { name: "current", parts: &[Part::Current,], about: "Current of the motor." },
CommonName { name: "motor-torque", parts: &[Part::Torque,], about: "Torque of the motor." },
CommonName { name: "power", parts: &[Part::Power,], about: "Power of the motor." },
CommonName { name: "bus-voltage", parts: &[Part::BusVoltage,], about: "Voltage of the DC bus." },
CommonName { name: "drive-temperature", parts: &[Part::PowerStageTemperature,], about: "Temperature of the power stage." },
CommonName { name: "motor-temperature", parts: &[Part::MotorTemperature,], about: "Temperature of the motor." },
CommonName { name: "nominal-speed", parts: &[Part::MotorSpeed,], about: "Nominal speed of the motor." },
CommonName { name: "nominal-frequency", parts: &[Part::MotorFrequency,], about: "Nominal frequency of the motor." },
CommonName { name: "nominal-current", parts: &[Part::MotorCurrent,Part::MotorContinuousCurrent,], about: "Nominal current of the motor." },
CommonName { name: "nominal-voltage", parts: &[Part::MotorVoltage,], about: "Nominal voltage of the motor." },
CommonName { name: "nominal-power", parts: &[Part::MotorPower,], about: "Nominal power of the motor." },
CommonName { name: "motor-poles", parts: &[Part::MotorPoles,], about: "Poles of the motor, twice its pole pairs." },
];
