//! Positioning in the tick of the drive: signals in, requests to the state machine, commands to the axis.

use profile::state::{PositionCommand, PositionEffect, PositionInputs, PositionState, Stw1};
use profile::telegram::signal;
use profile::unit::akd;

use super::run::Leg;
use super::task::{Refusal, Task};
use super::{MDI, Seen, homing};
use crate::axis::{Command, Tuning};
use crate::drive::{Drive, Mode, Service, State};

/// MDI_MOD bit 0: the target is absolute.
const MDI_ABSOLUTE: i64 = 1;

/// MT.CNTL of a task relative to the commanded position.
const RELATIVE: u32 = 1;

impl Drive {
    /// Returns the task that the MDI signals describe.
    fn mdi(&self) -> Task {
        let scaling = &self.settings.scaling;
        let signal = |number| self.process.signal(number);
        let bits = u32::from(scaling.singleturn_bits.min(32));
        let ramp = |number| akd::acceleration(scaling).engineering(signal(number));
        let absolute = signal(signal::MDI_MOD) & MDI_ABSOLUTE != 0;
        Task {
            position: signal(signal::MDI_TARPOS) << (32 - bits),
            speed: akd::mdi_velocity().engineering(signal(signal::MDI_VELOCITY)),
            acceleration: ramp(signal::MDI_ACC),
            deceleration: ramp(signal::MDI_DEC),
            control: if absolute { 0 } else { RELATIVE },
            ..Task::default()
        }
    }

    /// MT_FEEDRATE as a part of one: 0 holds a task, and no task is faster than its own speed. That it is in percent is
    /// ours.
    pub(in crate::drive) fn feedrate(&self) -> f64 {
        let percent = self.process.signal(signal::kollmorgen::MT_FEEDRATE);
        (percent as f64 / 100.0).clamp(0.0, 1.0)
    }

    /// Returns the number of the task selected by SATZANW; `None` when no setpoint selects one.
    fn selected_task(&self) -> Option<u16> {
        let number = self.process.signal(signal::SATZANW) as u16;
        let given = number != 0 || self.process.setpoints().has(signal::SATZANW);
        given.then_some(number)
    }

    /// Checks whether the task with this number, as in SATZANW and MT.MOVE, can run.
    pub(super) fn permit(&mut self, number: u16, seen: &Seen) -> Result<Leg, Refusal> {
        let task = if number & MDI == 0 {
            let task = self.positioning.tasks.task(usize::from(number));
            if !self.positioning.homed && task != Err(Refusal::Number) {
                return Err(Refusal::NotHomed);
            }
            task?
        } else {
            let task = self.mdi();
            self.positioning.tasks.set(0, task);
            self.positioning.mdi_in_table = true;
            task
        };
        self.positioning
            .permit(number, task, seen, &self.axis, &self.settings)
    }

    /// Decides once in a tick what shall happen in position mode.
    pub(in crate::drive) fn position_decide(&mut self) {
        let active = self.state() == State::S4 && self.settings.mode == Mode::Position;
        let word = self.position_word();
        if active != self.positioning.active {
            if active {
                self.positioning.enter(word, &self.axis, &self.settings);
            } else {
                self.positioning.leave(word);
            }
        }
        if !active {
            return;
        }
        let seen = Seen::new(&self.axis, self.settings.standstill);
        let edge = self.positioning.machine.wants_task(word);
        let wish = self.positioning.wish.take();
        let homing = self.positioning.machine.wants_homing(word) || wish == Some(PositionCommand::Homing);
        let number = match (edge, wish) {
            (true, _) => self.selected_task(),
            (false, Some(PositionCommand::Task)) => Some(self.positioning.wished_task),
            _ => None,
        };
        let task = number.map(|number| match number {
            // What MDI has left in task 0 is not to be selected: it would go once more with SATZANW 0.
            0 if edge && self.positioning.mdi_in_table => {
                let homed = self.positioning.homed;
                (0, Err(if homed { Refusal::Empty } else { Refusal::NotHomed }))
            }
            number => (number, self.permit(number, &seen)),
        });
        if word.0 & (Stw1::JOG_1 | Stw1::JOG_2 | Stw1::REAL_TIME_JOG).0 != 0 {
            let jog = self.positioning.jog_of(word, || self.mdi(), &self.settings);
            // A ramp of 0 is not a ramp: the last one stays.
            if jog.1.acceleration > 0.0 && jog.1.deceleration > 0.0 {
                self.positioning.jog = jog;
            } else if self.positioning.machine.state() == PositionState::Basic {
                self.positioning.jog = (0.0, jog.1);
            }
        }
        let positioning = &mut self.positioning;
        let setup = &self.settings.position;
        let home = &setup.home;
        let leg = task.and_then(|(_, permitted)| permitted.ok());
        let output = positioning.machine.step(&PositionInputs {
            stw1: word,
            standstill: seen.standing,
            task_permitted: leg.is_some(),
            homing_permitted: homing::is_known(home.mode)
                && home.speed > 0.0
                && home.ramps.acceleration > 0.0
                && home.ramps.deceleration > 0.0,
            jog_permitted: positioning.may_jog(positioning.jog, &seen, setup),
            finished: positioning.finished,
            failed: positioning.failed,
            command: wish,
        });
        let effect = output.effect();
        positioning.began = matches!(effect, PositionEffect::StartTask | PositionEffect::StartHoming);
        positioning.obey(effect, leg, &seen, &self.settings);
        if output.state.is_jogging() {
            positioning.target = None;
        }
        // An edge of bit 6 without a selected task is not a request.
        match task {
            Some((_, Err(refusal))) => positioning.flags.refuse(refusal),
            Some((_, Ok(_))) if output.effect() != PositionEffect::StartTask => {
                positioning.flags.refuse(Refusal::Busy);
            }
            _ => {}
        }
        if homing && output.effect() != PositionEffect::StartHoming {
            positioning.flags.homing_refused();
        }
    }

    /// What the end of a tick brings: S4 can end in the middle of it, and a task or homing that arrived is over now, not
    /// a cycle later; but what began in this tick is seen for one.
    pub(in crate::drive) fn position_settle(&mut self) {
        if self.positioning.active && self.state() != State::S4 {
            self.positioning.leave(self.machine.word());
        }
        if self.positioning.active && self.positioning.finished && !self.positioning.began {
            let seen = Seen::new(&self.axis, self.settings.standstill);
            let output = self.positioning.machine.step(&PositionInputs {
                stw1: self.position_word(),
                standstill: seen.standing,
                finished: seen.standing,
                ..PositionInputs::default()
            });
            self.positioning
                .obey(output.effect(), None, &seen, &self.settings);
        }
        self.position_warnings();
    }

    /// Returns the control word in force; the service channel has bits 4, 5 and 6 set.
    const fn position_word(&self) -> Stw1 {
        match self.service {
            Service::Off => self.machine.word(),
            _ => Stw1::RUN,
        }
    }

    /// Limits and gains; homing onto a hard stop pushes gently.
    pub(in crate::drive) fn position_tuning(&self) -> Tuning {
        let tuning = self.settings.tuning;
        match self.settings.position.home.current {
            Some(current) if self.positioning.is_gentle() => Tuning {
                current_positive: tuning.current_positive.min(current),
                current_negative: tuning.current_negative.min(current),
                ..tuning
            },
            _ => tuning,
        }
    }

    /// Returns the command for the axis in the next step in position mode.
    pub(in crate::drive) fn position_command(&mut self, seconds: f64, feedrate: f64) -> Command {
        self.positioning
            .direct(&mut self.axis, seconds, feedrate, &self.settings)
    }
}
