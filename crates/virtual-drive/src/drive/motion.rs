//! From state and control word to what the power stage does, and back into the status word.

use super::control::Seen;
use super::{Drive, Event, Mode, State};
use crate::axis::{Command, Ramps};

/// STW1 bit 0, ON.
const ON: u16 = 1 << 0;
/// STW1 bit 1, no coast stop.
const NO_COAST: u16 = 1 << 1;
/// STW1 bit 4, ramp generator enabled.
const RAMP_ENABLE: u16 = 1 << 4;
/// STW1 bit 5, ramp generator not frozen.
const RAMP_RUN: u16 = 1 << 5;
/// STW1 bit 6, setpoint enabled.
const SETPOINT: u16 = 1 << 6;
/// STW1 bits 8 and 9, jog 1 and 2.
const JOG: [u16; 2] = [1 << 8, 1 << 9];

/// ZSW1 bit 8, speed error within tolerance.
const SPEED_IN_RANGE: u16 = 1 << 8;
/// ZSW1 bit 9, control requested.
const CONTROL_REQUESTED: u16 = 1 << 9;
/// ZSW1 bit 10, target speed reached.
const TARGET_REACHED: u16 = 1 << 10;

/// Tolerance of ZSW1 bits 8 and 10: 1 rpm, or this part of the speed.
const TOLERANCE: f64 = 0.005;

impl Drive {
    /// Runs the state machine.
    pub(super) fn decide(&mut self) {
        // Without valid data from a controller nothing keeps the drive on: it ramps down, and then needs OFF and ON.
        let mut control = match (self.is_running(), self.decision.pulses) {
            (true, _) => self.process.control,
            (false, true) => self.process.control & !ON,
            (false, false) => 0,
        };
        if self.disable_requested && self.decision.pulses && self.settings.disable_on_ramp {
            control &= !ON;
        } else if self.disable_requested {
            // Ends in S1: the controller needs OFF and ON.
            self.disable_requested = false;
            control &= !NO_COAST;
        }
        if self.service {
            control &= !NO_COAST;
            self.service = !self.faults.is_present();
        }
        let seen = Seen {
            control,
            standing: self.axis.is_standing(self.settings.standstill),
            fault: self.faults.is_present(),
            coast: self.faults.has(self.model.overspeed_fault),
        };
        let before = self.decision.state;
        self.decision = self.control.step(&seen);
        if before != self.decision.state {
            self.emit(Event::State {
                from: before,
                to: self.decision.state,
            });
        }
        if self.decision.state != State::S4 {
            self.jogging = false;
            self.stop_requested = false;
        }
    }

    /// What the power stage has to do.
    pub(super) fn command(&mut self) -> Command {
        let settings = &self.settings;
        if self.service {
            return match settings.mode {
                Mode::Current => Command::Current {
                    target: settings.service_current,
                },
                _ => on_ramp(settings.service_speed, settings.ramps),
            };
        }
        match self.decision.state {
            State::S4 => self.operation(),
            State::S5RampStop => on_ramp(0.0, settings.ramps),
            State::S5QuickStop => on_ramp(
                0.0,
                Ramps {
                    acceleration: settings.quick_stop,
                    deceleration: settings.quick_stop,
                },
            ),
            State::S1 | State::S2 | State::S3 => Command::Off,
        }
    }

    /// The setpoint channel in S4.
    fn operation(&mut self) -> Command {
        let control = self.process.control;
        let settings = &self.settings;
        let channel = control & (RAMP_ENABLE | RAMP_RUN | SETPOINT);
        if channel == 0 {
            let wanted = JOG.map(|bit| control & bit != 0);
            let standing = self.axis.is_standing(settings.standstill);
            let [one, two] = settings.jog_speed;
            let target = match wanted {
                [true, false] => one,
                [false, true] => two,
                _ => 0.0,
            };
            if target != 0.0 && standing {
                self.jogging = true;
            } else if target == 0.0 && standing {
                self.jogging = false;
            }
            if self.jogging {
                return on_ramp(target, settings.jog_ramps);
            }
        } else {
            self.jogging = false;
        }
        if settings.mode != Mode::Speed {
            return on_ramp(0.0, settings.ramps);
        }
        if channel != RAMP_ENABLE | RAMP_RUN | SETPOINT || self.process.speed == 0.0 {
            self.stop_requested = false;
        }
        if control & RAMP_ENABLE == 0 {
            return Command::Speed {
                target: 0.0,
                ramp: None,
                hold: false,
            };
        }
        let target = if control & SETPOINT == 0 || self.stop_requested {
            0.0
        } else {
            self.process.speed
        };
        Command::Speed {
            target,
            ramp: Some(settings.ramps),
            hold: control & RAMP_RUN == 0,
        }
    }

    /// The status word.
    pub(super) fn status(&self) -> u16 {
        let mut status = self.decision.status;
        if !self.service {
            status |= CONTROL_REQUESTED;
        }
        if self.decision.state == State::S4 {
            let within = |wanted: f64| {
                (wanted - self.axis.measured_speed()).abs() <= (TOLERANCE * wanted.abs()).max(1.0)
            };
            if within(self.axis.speed_command()) {
                status |= SPEED_IN_RANGE;
            }
            if within(self.process.speed) {
                status |= TARGET_REACHED;
            }
        }
        status
    }
}

const fn on_ramp(target: f64, ramps: Ramps) -> Command {
    Command::Speed {
        target,
        ramp: Some(ramps),
        hold: false,
    }
}
