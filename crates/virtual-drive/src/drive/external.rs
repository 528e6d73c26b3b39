//! External inputs (STO, mains, load) and the status of the digital inputs.

use super::panel::Panel;
use super::{Drive, Injection, RESTLESS};

/// Inputs of the drive that are not the axis's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ExternalInputs {
    /// The enable input is taken away.
    pub hardware_disable: bool,
    /// The input for the controlled stop is active.
    pub controlled_stop: bool,
    /// The holding brake is applied or released independent of the drive.
    pub brake: Option<bool>,
    /// Local operation.
    pub panel: Panel,
}

/// Bits of DRV.DISSOURCES. Source: AKD Parameter Guide 12/2009.
const SOFTWARE: i64 = 1;
const FAULT: i64 = 1 << 1;
const HARDWARE: i64 = 1 << 2;
const CONTROLLED_STOP: i64 = 1 << 5;

impl Drive {
    /// Something happens to the drive: to its motor, its load, its wiring, or a fault out of nowhere. What comes of it
    /// is the business of the drive's own supervision; it is seen at once, and acted on in the next tick.
    pub fn inject(&mut self, injection: Injection) {
        let axis = &mut self.axis;
        match injection {
            Injection::Fault { number, lasting } => self.raise_external(number, lasting),
            Injection::Warning { number } => self.warn_external(number, true),
            Injection::ClearCause { number } => self.end_cause(number),
            Injection::Sto(active) => axis.set_sto(active),
            Injection::Load(torque) => axis.set_load(torque),
            Injection::Block(blocked) => axis.set_blocked(blocked),
            Injection::Limit { positive, active } => axis.set_limit_switch(positive, active),
            Injection::HomeSwitch(active) => axis.set_home_switch(active),
            Injection::FeedbackLoss(lost) => axis.set_feedback_lost(lost),
            Injection::Brake(applied) => self.external.brake = applied,
            Injection::BusVoltage(voltage) => axis.set_bus_voltage(voltage),
            Injection::Mains(on) => axis.set_mains(if on { None } else { Some(0.0) }),
            Injection::Regen(connected) => axis.set_regen(connected),
            Injection::MotorTemperature(temperature) => axis.set_motor_temperature(temperature),
            Injection::PowerTemperature(temperature) => axis.set_power_stage_temperature(temperature),
            Injection::HardwareDisable(active) => self.external.hardware_disable = active,
            Injection::ControlledStop(active) => self.external.controlled_stop = active,
            Injection::Input { number, on } => self.set_terminal(number, on),
            Injection::Local(on) => self.press_local(on),
            Injection::LocalSpeed(speed) => self.press_speed(speed),
            Injection::ButtonB1(seconds) => self.hold_button(seconds),
        }
        self.hold_brake();
        self.supervise();
        self.restless = RESTLESS;
    }

    /// Makes a fault happen, as if the drive had found it. A lasting one cannot be acknowledged before
    /// [`Injection::ClearCause`] ends its cause.
    pub fn inject_fault(&mut self, number: u16, lasting: bool) {
        self.inject(Injection::Fault { number, lasting });
    }

    /// Applies the holding brake while the power stage is off, where one is fitted (MOTOR.BRAKE) and not released by
    /// hand (MOTOR.BRAKERLS).
    pub(super) fn hold_brake(&mut self) {
        let wanted = self.settings.holds_when_off && !self.is_enabled();
        self.axis.set_brake(self.external.brake.unwrap_or(wanted));
    }

    /// DRV.DISSOURCES: why the power stage is off.
    pub(super) fn disable_sources(&self) -> i64 {
        let bit = |set: bool, bit: i64| if set { bit } else { 0 };
        bit(!self.is_enabled(), SOFTWARE)
            | bit(self.has_fault(), FAULT)
            | bit(self.external.hardware_disable, HARDWARE)
            | bit(self.is_stopped_by_input(), CONTROLLED_STOP)
    }
}
