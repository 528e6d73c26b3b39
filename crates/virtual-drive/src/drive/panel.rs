//! Local operation: the panel, or a setting, takes the drive from the bus and gives it back.
//!
//! While it has the drive, bit 9 of the status word is 0 and the control word of the bus is without effect. Source: profile,
//! ZSW1 bit 9; FC 300 programming guide 0-40 to 0-42 and 8-01, Vacon application manuals ID 172, from memory. That
//! a panel starts again by itself after its fault was acknowledged is ours.

use profile::catalogue::Part;
use profile::state::{State, Stw1};

use super::{Drive, Mode, Service};
use crate::axis::Command;
use crate::drive::velocity::on_ramp;

/// What the panel does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Panel {
    /// It has the drive.
    has: bool,
    /// Speed at which it runs the motor, rpm.
    speed: Option<f64>,
}

/// A key of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Key {
    /// Takes the drive and runs it.
    Hand,
    /// Takes the drive and stops it.
    Off,
    /// Gives it back.
    Auto,
}

impl Drive {
    /// The panel takes the drive and stops it, or gives it back.
    pub(super) fn press_local(&mut self, on: bool) {
        if self.key_works(if on { Key::Off } else { Key::Auto }) {
            self.external.panel = Panel { has: on, speed: None };
        }
    }

    /// The panel takes the drive and runs it at a speed; without one it stops it.
    pub(super) fn press_speed(&mut self, speed: Option<f64>) {
        match speed {
            Some(_) if self.key_works(Key::Hand) => self.external.panel = Panel { has: true, speed },
            None if self.external.panel.has && self.key_works(Key::Off) => self.external.panel.speed = None,
            _ => {}
        }
    }

    /// Ends a run commanded at the local panel. The panel keeps control.
    pub(super) const fn end_local_speed(&mut self) {
        self.external.panel.speed = None;
    }

    /// Keys can be switched off by parameters.
    fn key_works(&self, key: Key) -> bool {
        let number = self.model.number(match key {
            Key::Hand => Part::HandKey,
            Key::Off => Part::OffKey,
            Key::Auto => Part::AutoKey,
        });
        number.is_none_or(|number| self.values.get(number) != 0)
    }

    /// Returns whether the panel has the drive, or a setting keeps the bus off it.
    pub(super) fn is_local(&self) -> bool {
        let inverter = self.settings.inverter.as_ref();
        self.external.panel.has || inverter.is_some_and(|inverter| inverter.not_by_bus)
    }

    /// Speed at which the panel runs the motor, rpm.
    fn panel_speed(&self) -> Option<f64> {
        let speed = self.external.panel.speed;
        speed.filter(|_| self.external.panel.has && self.settings.mode == Mode::Speed)
    }

    /// Returns the control word of local operation, if anything but the bus has the drive. The service channel has no
    /// OFF command; a panel gives OFF first where the machine requires it.
    pub(super) fn panel_word(&self) -> Option<Stw1> {
        let stopped = self.panel_speed().is_none() || self.state() == State::S1;
        self.is_local()
            .then_some(if stopped { Stw1::READY } else { Stw1::RUN })
    }

    /// Returns the command of the panel to the axis in S4, if the panel has control.
    pub(super) fn panel_command(&mut self) -> Option<Command> {
        if self.service != Service::Off || !self.is_local() {
            return None;
        }
        let speed = self.panel_speed().filter(|_| !self.stop_requested);
        self.target = speed.unwrap_or(0.0);
        Some(on_ramp(self.target, self.settings.ramps))
    }
}
