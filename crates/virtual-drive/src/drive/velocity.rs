//! Operation (S4) in the modes without positioning: velocity, and current.
//!
//! Source: AKD manual 5.4, 5.5 and 5.9 (application class 1).

use profile::state::{Setpoint, SpeedCommand, Zsw1};

use super::{Drive, Mode};
use crate::axis::{Command, Ramps};

/// Tolerance of ZSW1 bits 8 and 10: 1 rpm, or this part of the speed, whichever is more. No source states the AKD's;
/// the sample of manual 7.1.4 has 158 steps for 163 (1.83 rpm at 60 rpm) and neither bit.
const TOLERANCE: f64 = 0.005;
const LEAST_TOLERANCE: f64 = 1.0;

/// Returns true when a measured speed counts as equal to the setpoint, in rpm, limits included.
fn within(wanted: f64, measured: f64) -> bool {
    (wanted - measured).abs() <= (TOLERANCE * wanted.abs()).max(LEAST_TOLERANCE)
}

impl Drive {
    /// Returns the setpoint channel in S4.
    pub(super) fn velocity_operation(&mut self) -> Command {
        let standing = self.axis.is_standing(self.settings.standstill);
        let speed = match self.orders.speed {
            Some(speed) => speed,
            None => self.channel.step(self.state(), self.machine.word(), standing),
        };
        let settings = &self.settings;
        let [one, two] = self.jog_speeds();
        let jog = match speed {
            SpeedCommand::Jog1 => Some(one),
            SpeedCommand::Jog2 => Some(two),
            SpeedCommand::JogStop => Some(0.0),
            SpeedCommand::Channel(_) => None,
        };
        if let Some(target) = jog.filter(|_| settings.mode == Mode::Speed) {
            self.target = target;
            return on_ramp(target, settings.jog_ramps);
        }
        let setpoint = match speed {
            SpeedCommand::Channel(setpoint) => setpoint,
            _ => Setpoint::ZeroAtLimits,
        };
        if setpoint != Setpoint::Follow || (self.process.speed == 0.0 && self.process.current == 0.0) {
            self.stop_requested = false;
        }
        match settings.mode {
            Mode::Current => self.current_operation(setpoint),
            Mode::Speed => self.speed_operation(setpoint),
            Mode::Position => self.hold(),
        }
    }

    fn speed_operation(&mut self, setpoint: Setpoint) -> Command {
        let ramps = self.ramps();
        let wanted = if self.stop_requested {
            0.0
        } else {
            self.wanted_speed()
        };
        let quick = Ramps {
            acceleration: self.settings.quick_stop,
            deceleration: self.settings.quick_stop,
        };
        let (target, ramp, hold) = match setpoint {
            Setpoint::ZeroAtLimits if self.profile().zero_on_quick_ramp() => (0.0, Some(quick), false),
            Setpoint::Follow => (wanted, Some(ramps), false),
            Setpoint::Freeze => (wanted, Some(ramps), true),
            Setpoint::RampToZero => (0.0, Some(ramps), false),
            Setpoint::ZeroAtLimits => (0.0, None, false),
        };
        self.target = target;
        Command::Speed { target, ramp, hold }
    }

    /// Current mode: IL_CMD_FIELDBUS (signal 102) is the setpoint. There is no ramp: bits 4 and 6 let it through, bit 5
    /// keeps the present one. Source: manual 5.8 names the signal only, the bits are ours by analogy.
    fn current_operation(&mut self, setpoint: Setpoint) -> Command {
        self.target = 0.0;
        let target = match setpoint {
            Setpoint::Follow if !self.stop_requested => self.process.current,
            Setpoint::Freeze => self.held_current,
            _ => 0.0,
        };
        self.held_current = target;
        Command::Current { target }
    }

    /// Stops the axis at a hardware limit switch in velocity mode: motion farther into it brakes with CS.DEC or the own
    /// ramp, whichever is steeper, and stays; what leads out of it goes. Software limits belong to position mode. Ours:
    /// the manual names the switches and their warnings, not what velocity mode does. A frequency converter has no
    /// limit switches.
    pub(super) fn kept_off_switches(&self, command: Command) -> Command {
        let Command::Speed { target, ramp, hold } = command else {
            return command;
        };
        if self.settings.inverter.is_some() {
            return command;
        }
        let inputs = self.axis.inputs();
        let leads_in =
            |speed: f64| (speed > 0.0 && inputs.limit_positive) || (speed < 0.0 && inputs.limit_negative);
        let moves_in = leads_in(self.axis.speed_command());
        if !moves_in && !leads_in(target) {
            return command;
        }
        let target = if hold || leads_in(target) { 0.0 } else { target };
        let ramp = ramp.map(|ramp| Ramps {
            deceleration: ramp.deceleration.max(self.settings.quick_stop),
            ..ramp
        });
        Command::Speed {
            target,
            ramp,
            hold: false,
        }
    }

    fn hold(&mut self) -> Command {
        self.target = 0.0;
        on_ramp(0.0, self.settings.ramps)
    }

    /// Bit 8, velocity error in range: the axis follows the ramp generator. Bit 10, target velocity reached: it has the
    /// speed that is requested at the end of the ramp, be it NSOLL_A, a jog speed or 0. Neither means anything in
    /// current mode.
    pub(super) fn velocity_status(&self) -> Zsw1 {
        let mut status = Zsw1::default();
        if self.settings.mode == Mode::Current {
            return status;
        }
        let measured = self.axis.measured_speed();
        let follows = match &self.settings.inverter {
            Some(inverter) => {
                !self.axis.motor_output().limited && inverter.follows(self.axis.speed_command(), measured)
            }
            None => within(self.axis.speed_command(), measured),
        };
        if follows {
            status = status.with(Zsw1::IN_TOLERANCE);
        }
        if self.is_at_speed() {
            status = status.with(Zsw1::REACHED);
        }
        status
    }

    /// Returns whether the axis has the speed that is requested; without feedback that is what the ramp puts out.
    pub(super) fn is_at_speed(&self) -> bool {
        let speed = match &self.settings.inverter {
            Some(_) => self.axis.speed_command(),
            None => self.axis.measured_speed(),
        };
        within(self.target, speed)
    }
}

pub(super) const fn on_ramp(target: f64, ramps: Ramps) -> Command {
    Command::Speed {
        target,
        ramp: Some(ramps),
        hold: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_of_the_tolerance_are_inside() {
        // 1 rpm up to 200 rpm, half a percent above
        for (wanted, tolerance) in [
            (0.0, 1.0),
            (60.0, 1.0),
            (199.0, 1.0),
            (200.0, 1.0),
            (201.0, 1.005),
            (1000.0, 5.0),
            (3000.0, 15.0),
        ] {
            for sign in [1.0, -1.0] {
                let wanted: f64 = wanted * sign;
                let near = |error: f64| within(wanted, wanted + error);
                let least = 1e-9;
                assert!(near(tolerance - least) && near(-tolerance + least), "{wanted}");
                assert!(!near(tolerance + least) && !near(-tolerance - least), "{wanted}");
            }
        }
        assert!(within(60.0, 61.0) && within(60.0, 59.0) && within(1000.0, 995.0) && within(1000.0, 1005.0));
        // the sample of the manual: 0x00A3 requested, 0x009E measured, neither bit
        assert!(!within(59.678, 57.847));
        assert!(!within(f64::NAN, 0.0) && !within(0.0, f64::NAN));
    }
}
