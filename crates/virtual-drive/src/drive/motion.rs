//! From the state machine to what the power stage does, and back into the status word.

use profile::state::{Inputs, Motion, Orders, Profile, State, Stw1, Zsw1};

use super::position::GoesOn;
use super::velocity::on_ramp;
use super::{Drive, Event, Mode, Service};
use crate::axis::{Command, Ramps};

/// Longest step of the axis in position mode, s, and most of them in one tick.
const STEP: f64 = 0.001;
const MOST_STEPS: f64 = 512.0;

impl Drive {
    /// Runs the state machine; the status word without the bits that depend on the axis.
    pub(super) fn decide(&mut self) -> u16 {
        let before = self.state();
        let profile = self.profile();
        let orders = profile.orders(self.process.control.0, before);
        let mut inputs = Inputs {
            stw1: orders.stw1,
            local: self.local_word(),
            standstill: self.axis.is_standing(self.settings.standstill),
            fault: self.reaction.take(),
            cause_present: self.a_cause_lasts(),
            coast_stop: self.external.hardware_disable,
            quick_stop: self.is_stopped_by_input(),
            acknowledge: core::mem::take(&mut self.clear_requested),
            ..Inputs::default()
        };
        if !self.is_running() {
            // Without valid data from a controller nothing keeps the drive on: it ramps down, and then needs OFF and ON.
            inputs.silent = true;
            // The word of local operation is not a controller's: where DRV.DIS ends it, none is in force.
            inputs.stw1 = match inputs.local {
                Some(_) => Stw1::default(),
                None => self.machine.word().without(Stw1::ON),
            };
            if !before.pulses() && inputs.local.is_none() {
                self.machine.forget_word();
                inputs.stw1 = Stw1::default();
            }
        }
        if self.disable_requested {
            let ramp = before.pulses() && self.settings.disable_on_ramp;
            inputs.stw1 = inputs.stw1.without(Stw1::ON);
            inputs.local = inputs.local.map(|word| word.without(Stw1::ON));
            if !ramp {
                // Ends in S1: the controller needs OFF and ON.
                self.disable_requested = false;
                self.service = Service::Off;
                // who commands at the drive has to start it again
                self.end_local_speed();
                inputs.local = None;
                inputs.coast_stop = true;
            }
        }
        let output = profile.step(&mut self.machine, &inputs);
        if self.is_local() {
            self.orders = Orders::default();
        } else if output.accepted && self.is_running() {
            self.orders = orders;
        }
        if self.follow_set_up() {
            self.apply();
        }
        if output.acknowledged {
            self.acknowledged();
        }
        if output.state != before {
            self.emit(Event::State {
                from: before,
                to: output.state,
            });
        }
        if output.state != State::S4 {
            self.stop_requested = false;
        }
        if self.service == Service::On && !output.pulses {
            self.service = Service::Off;
        }
        output.zsw1.0
    }

    /// Returns the control word of the service channel, which has no OFF command: run. Otherwise that of the panel.
    fn local_word(&mut self) -> Option<Stw1> {
        if self.service == Service::Starting {
            self.service = Service::On;
            self.machine.rearm(&Inputs {
                local: Some(Stw1::RUN),
                standstill: true,
                ..Inputs::default()
            });
        }
        (self.service == Service::On)
            .then_some(Stw1::RUN)
            .or_else(|| self.panel_word())
    }

    /// Moves the axis on by `seconds`; in position mode in steps in which it can be redirected.
    pub(super) fn move_axis(&mut self, seconds: f64) {
        if self.settings.mode != Mode::Position || !self.is_enabled() {
            let command = self.command();
            return self.axis.step(seconds, command, &self.settings.tuning);
        }
        let steps = (seconds / STEP).ceil().clamp(1.0, MOST_STEPS);
        let dt = (seconds / steps).min(STEP);
        let feedrate = self.feedrate();
        let mut gentle = self.positioning.is_gentle();
        let mut stride = self.axis.stride(dt, &self.position_tuning());
        let mut left = steps as usize;
        while left > 0 {
            let operates = self.state() == State::S4;
            let command = if operates {
                self.position_command(dt, feedrate)
            } else {
                self.command()
            };
            if self.positioning.is_gentle() != gentle {
                gentle = !gentle;
                stride = self.axis.stride(dt, &self.position_tuning());
            }
            // the next steps have the same command until the reference arrives
            let goes_on = if operates {
                self.positioning.goes_on(&self.axis)
            } else {
                GoesOn::No
            };
            let most = if goes_on == GoesOn::No { 1 } else { left };
            left -= self
                .axis
                .steps_by(&mut stride, command, most, goes_on == GoesOn::UntilDone);
        }
    }

    /// Returns the ramp of a stop outside S4; in position mode it keeps the axis inside its software limits.
    fn safe_stop(&self, ramps: Ramps) -> Ramps {
        if self.settings.mode == Mode::Position {
            self.positioning
                .safe_stop(ramps, &self.axis, &self.settings.position)
        } else {
            ramps
        }
    }

    /// Returns the command for the power stage.
    pub(super) fn command(&mut self) -> Command {
        let settings = &self.settings;
        match self.state().motion() {
            Motion::Coast => Command::Off,
            Motion::RampStop if self.orders.dc_brake => Command::DcBrake {
                current: settings.inverter.map_or(0.0, |inverter| inverter.brake_current),
            },
            Motion::RampStop => on_ramp(0.0, self.safe_stop(self.ramps())),
            Motion::QuickStop if self.profile().quick_stop_on_ramp() => on_ramp(0.0, self.ramps()),
            Motion::QuickStop => on_ramp(
                0.0,
                self.safe_stop(Ramps {
                    acceleration: settings.quick_stop,
                    deceleration: settings.quick_stop,
                }),
            ),
            Motion::FollowSetpoint if self.service == Service::Off => {
                let panel = self.panel_command();
                let command = panel
                    .or_else(|| self.timeout_command())
                    .unwrap_or_else(|| self.velocity_operation());
                self.kept_off_switches(command)
            }
            Motion::FollowSetpoint => match settings.mode {
                Mode::Current => Command::Current {
                    target: settings.service_current,
                },
                _ => {
                    let (speed, ramps) = (settings.service_speed, settings.ramps);
                    self.target = speed;
                    self.kept_off_switches(on_ramp(speed, ramps))
                }
            },
        }
    }

    /// Returns the status word for a state, with the bits that depend on the axis, in the words of the telegram in use.
    pub(super) fn in_profile_bits(&self, status: u16) -> u16 {
        let profile = self.profile();
        let status = Zsw1(status | self.application_status());
        if profile == Profile::Profidrive {
            return status.0;
        }
        profile.status(self.state(), status, &self.conditions())
    }

    /// Returns the bits of the status word that depend on the axis.
    fn application_status(&self) -> u16 {
        let warning = if self.has_warning() { Zsw1::WARNING.0 } else { 0 };
        if self.settings.mode == Mode::Position {
            return self.position_status().0 | warning;
        }
        if self.state() != State::S4 {
            return warning;
        }
        self.velocity_status().0 | warning
    }
}
