//! What must be true in every cycle.

use profile::state::{PositionState, State};
use profile::telegram::signal;

use super::{Bound, FOLLOWING, Life, TASKS, Trial};
use crate::drive::position::units::REVOLUTION;

impl Trial {
    /// Returns the bounds of the movement in this cycle, by the reported state of the drive: speed and ramp that were
    /// set for it.
    fn bound(&self) -> Bound {
        let home = Bound {
            speed: self.bench.read("HOME.V_32") as f64 / 1000.0 + 0.01,
            ramp: 3000.0,
        };
        let number = self.bench.get(signal::AKTSATZ);
        match self.bench.drive.positioning.state() {
            Some(PositionState::Task | PositionState::Pause) if number == 0x8000 => self.mdi,
            Some(PositionState::Task | PositionState::Pause) => {
                let number = number as usize;
                let task = self.table[number];
                // Also that of the tasks after it: it may hurry for them.
                (number + 1..=TASKS).fold(task, |bound, next| bound.or(self.table[next]))
            }
            Some(PositionState::Homing | PositionState::HomingStop) => home,
            Some(PositionState::Jog1 | PositionState::Jog2) => self.jog,
            // A ramp of 0 is not a ramp: it goes on as before.
            Some(PositionState::RealTimeJog) if self.mdi_sent.ramp == 0.0 => self.moved,
            Some(PositionState::RealTimeJog) => {
                // A ramp that became too flat for the way to the limit is made as steep as that takes.
                let limit = if self.pace > 0.0 {
                    self.limits.1
                } else {
                    self.limits.0
                };
                let room = (limit - self.bench.drive.axis.position_command() as f64 / REVOLUTION).abs();
                let needed = self.pace * self.pace / 120.0 / room.max(1e-9);
                Bound {
                    ramp: self
                        .mdi_sent
                        .ramp
                        .max(needed.max(self.steepest).min(self.moved.ramp)),
                    ..self.mdi_sent
                }
            }
            Some(PositionState::Reject) => Bound {
                ramp: self.moved.ramp.max(self.stop),
                ..self.moved
            },
            Some(PositionState::Braking) => self.moved,
            Some(PositionState::Basic) | None => Bound {
                ramp: self.moved.ramp.max(self.stop),
                ..self.moved
            },
        }
    }

    /// One cycle with all its claims.
    pub fn cycle(&mut self, outputs: bool) {
        let before = self.bench.drive.state();
        let (ack, word_before) = (self.acknowledged, self.bench.drive.machine.word().0);
        self.bench.set(signal::STW1, i64::from(self.word));
        if outputs {
            self.bench.tick();
        } else {
            self.bench.tick_without();
        }
        let drive = &self.bench.drive;
        let (state, axis) = (drive.state(), &drive.axis);
        let status = drive.process.status;
        let has = |bit: u16| status & (1 << bit) != 0;
        let positioning = drive.positioning.state();
        let dt = self.bench.cycle.as_secs_f64();
        let place = PositionState::ALL
            .iter()
            .position(|state| Some(*state) == positioning);
        self.seen.states |= place.map_or(0, |place| 1 << place);

        // The status word matches the axis.
        assert_eq!(has(2), state == State::S4, "{}", self.here());
        assert_eq!(has(6), state == State::S1, "{}", self.here());
        assert_eq!(has(3), drive.has_fault(), "{}", self.here());
        assert_eq!(has(7), drive.has_warning(), "{}", self.here());
        let homing = positioning == Some(PositionState::Homing);
        let error = axis.following_error().unsigned_abs() as f64 / REVOLUTION * 65_536.0;
        assert_eq!(
            has(8),
            error <= self.error_window as f64,
            "{error} {}",
            self.here()
        );
        let stands = axis.speed().abs() < 3.0 && axis.trajectory_speed() == 0.0;
        assert_eq!(has(13), stands && !homing, "{}", self.here());
        assert_eq!(has(11), drive.positioning.homed, "{}", self.here());
        let number = i64::from(drive.positioning.running_task());
        assert_eq!(has(14), number != 0, "{}", self.here());
        if has(10) {
            let target = drive.positioning.target.unwrap();
            let off = target.wrapping_sub(axis.position()).unsigned_abs() as f64 / REVOLUTION;
            assert!(off <= self.window && !has(14) && !homing, "{}", self.here());
            assert_eq!(axis.trajectory_speed(), 0.0, "{}", self.here());
        }
        // Acknowledged only in the cycle of an edge, and never longer than the bit.
        let word = drive.machine.word().0;
        if has(12) && !ack {
            assert!(
                word & 0x40 != 0 && word_before & 0x40 == 0 && has(14),
                "{}",
                self.here()
            );
        }
        assert!(!has(12) || word & 0x40 != 0, "{}", self.here());
        if word & 0x40 != 0 && word_before & 0x40 == 0 && positioning.is_some() && !has(12) {
            self.seen.refused += 1;
        }
        if has(12) && !ack && number == 0x8000 {
            self.mdi = self.mdi_sent;
        }
        self.acknowledged = has(12);

        // Speed and ramps are those that were set.
        let pace = axis.trajectory_speed();
        let mut bound = self.bound();
        // A limit switch stops with CS.DEC, whatever the ramp of the task is.
        let inputs = axis.inputs();
        if self.life == Life::Switches && (inputs.limit_negative || inputs.limit_positive) {
            bound.ramp = bound.ramp.max(self.stop);
        }
        let most = bound.or(self.moved);
        if positioning.is_some() && before == State::S4 {
            let slope = (pace - self.pace).abs() / dt;
            assert!(
                slope <= most.ramp * 1.015 + 1.0,
                "{slope} above {most:?} {}",
                self.here()
            );
            assert!(
                pace.abs() <= bound.speed + 0.01 || pace.abs() <= self.pace.abs(),
                "{pace} above {bound:?} {}",
                self.here()
            );
            // An axis that was held hurries after its reference.
            assert!(
                self.held || axis.speed().abs() <= most.speed.max(self.pace.abs()) * 1.02 + 20.0,
                "{} {most:?} {}",
                axis.speed(),
                self.here()
            );
        }
        let last = core::mem::replace(&mut self.pace, pace);
        self.steepest = if positioning == Some(PositionState::RealTimeJog) && pace != 0.0 {
            bound.ramp
        } else {
            0.0
        };
        if pace != 0.0 || bound != self.moved {
            self.moved = bound;
        }

        // The axis stays inside.
        let turns = axis.position() as f64 / REVOLUTION;
        let (low, high) = self.limits;
        if !state.pulses() && axis.speed().abs() > 3.0 {
            self.excused = true;
        }
        if !drive.positioning.homed {
            self.excused = true;
        } else if turns >= low && turns <= high && stands {
            self.excused = false;
        }
        if !self.excused {
            assert!(turns >= low - 0.03 && turns <= high + 0.03, "{}", self.here());
            if positioning.is_some() {
                // A stop outside S4 is led by the speed loop and ends near the limit; from there on it is exact.
                let command = axis.position_command() as f64 / REVOLUTION;
                let (low, high) = (low.min(self.rest), high.max(self.rest));
                let exact = positioning != Some(PositionState::Basic);
                assert!(
                    !exact || (command >= low - 1e-6 && command <= high + 1e-6),
                    "{command} {}",
                    self.here()
                );
            }
        }
        if positioning.is_none_or(|state| state == PositionState::Basic) {
            self.rest = axis.position_command() as f64 / REVOLUTION;
        }
        self.life_holds(before == State::S4, last);
    }

    /// What the kind of this life adds; `led` by the reference, whose speed was `last` one cycle ago.
    fn life_holds(&mut self, led: bool, last: f64) {
        let axis = &self.bench.drive.axis;
        let inputs = axis.inputs();
        let positioning = self.bench.drive.positioning.state();
        let (pace, error) = (axis.trajectory_speed(), axis.following_error());
        match self.life {
            Life::Plain => {}
            Life::Switches => {
                let limited = (pace > 0.0 && inputs.limit_positive && self.touched.1)
                    || (pace < 0.0 && inputs.limit_negative && self.touched.0);
                self.touched = (inputs.limit_negative, inputs.limit_positive);
                if limited && led && positioning.is_some() {
                    self.seen.limited += 1;
                    assert!(pace.abs() <= last.abs() + 1e-6, "farther in {}", self.here());
                }
            }
            Life::Blocked => {
                let error = error.unsigned_abs() as f64 / REVOLUTION;
                let drive = &self.bench.drive;
                assert!(
                    error <= FOLLOWING || drive.has_fault() || drive.state() != State::S4,
                    "{error} and no fault {}",
                    self.here()
                );
                // Free again it hurries after its reference, and is a little too fast when it has got there.
                let behind = error > 0.005 || (axis.speed() - pace).abs() > 10.0;
                self.held = axis.is_blocked() || (self.held && behind);
            }
            Life::Modulo(turns) => {
                let shown = self.bench.read("PL.FB") as f64 / 65_536.0;
                assert!((0.0..turns + 1e-4).contains(&shown), "{shown} {}", self.here());
            }
        }
    }
}
