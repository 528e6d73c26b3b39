//! Position mode (AKD manual 5.10): motion tasks, MDI, homing and jogging inside S4.
//!
//! | file | what it holds |
//! |---|---|
//! | `task` | one motion task with its control word, the table of 128 |
//! | `run` | a task on its way: target, permission, what follows it |
//! | `homing` | the methods of homing |
//! | `limits`, `units` | software limits; units and modulo axes |
//! | `setup` | the parameters of positioning |
//! | `status` | ZSW1 bits 8 and 10 to 14, DRV.MOTIONSTAT, warnings |
//! | `tick` | the part of a drive's tick |
//! | `service` | the parameters and commands that do something: MT.SET, MT.MOVE, HOME.MOVE... |
//!
//! What shall happen is decided once in each tick by [`PositionMachine`], the table of the profile crate
//! ([`Positioning::decide`]); where the axis goes is reported in each step of the axis, at most a millisecond long
//! ([`Positioning::direct`]). Every movement keeps to defined ramps: an intermediate stop to the ramp of the task, a
//! rejected task to the steepest of that ramp and CS.DEC, homing and jogging to theirs.
//!
//! Positions are those of the axis, 2^-32 revolutions, as homing has numbered them; they never wrap here. A modulo axis
//! wraps where a target comes in and where a position is shown.

mod homing;
mod limits;
mod run;
mod service;
mod setup;
mod status;
mod stored;
mod task;
mod tick;
mod units;

#[cfg(test)]
mod chain_tests;
#[cfg(test)]
mod homing_tests;
#[cfg(test)]
mod seeds;
#[cfg(test)]
mod tests;

use profile::state::{PositionCommand, PositionEffect, PositionMachine, PositionState, Stw1};

use super::settings::Settings;
use crate::axis::{Axis, Command, Inputs, Ramps};
use homing::Homing;
use limits::{Limits, brake_way};
use run::{Leg, Next, Run, Start, Wait};
use task::{Follow, Refusal, Task, Tasks};

pub(super) use setup::Setup;

/// SATZANW and AKTSATZ bit 15: MDI.
const MDI: u16 = 0x8000;

/// A ramp counts as too flat for the way that is left from this part above it on.
const MARGIN: f64 = 1.01;

/// What the axis shows before a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Seen {
    /// PL.FB and PL.CMD.
    position: i64,
    command: i64,
    /// Speed of the reference, rpm.
    command_speed: f64,
    /// True speed, rpm.
    speed: f64,
    /// PL.ERR.
    following: i64,
    /// The reference has arrived.
    done: bool,
    /// Neither moves nor is led.
    standing: bool,
    /// What homing has added to the feedback.
    shift: i64,
    inputs: Inputs,
}

impl Seen {
    fn new(axis: &Axis, standstill: f64) -> Self {
        let command_speed = axis.trajectory_speed();
        Self {
            position: axis.position(),
            command: axis.position_command(),
            command_speed,
            speed: axis.speed(),
            following: axis.following_error(),
            done: axis.trajectory_done(),
            standing: command_speed == 0.0 && axis.is_standing(standstill),
            shift: axis.position().wrapping_sub(axis.feedback()),
            inputs: axis.inputs(),
        }
    }

    /// Returns whether a limit switch is touched in this direction.
    const fn is_limited(&self, way: i64) -> bool {
        (way > 0 && self.inputs.limit_positive) || (way < 0 && self.inputs.limit_negative)
    }

    /// Direction in which the reference moves; that of `otherwise` when it stands.
    fn heading(&self, otherwise: i64) -> i64 {
        if self.command_speed > 0.0 {
            1
        } else if self.command_speed < 0.0 {
            -1
        } else {
            otherwise
        }
    }
}

/// How long a command for the axis stays the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GoesOn {
    /// The next step may need another one.
    No,
    /// To the end of the tick, or until the reference arrives.
    UntilDone,
    /// To the end of the tick.
    Always,
}

/// Brakes along a ramp and stays.
const fn stop(ramps: Ramps) -> Command {
    Command::Travel {
        speed: 0.0,
        ramps,
        smooth: false,
    }
}

fn steepened(ramps: Ramps, deceleration: f64) -> Ramps {
    Ramps {
        deceleration: ramps.deceleration.max(deceleration),
        ..ramps
    }
}

/// Positioning of one axis.
#[derive(Debug, Clone)]
pub(super) struct Positioning {
    machine: PositionMachine,
    /// S4 in position mode.
    active: bool,
    tasks: Tasks,
    /// Task 0 holds the last MDI request and was not written by a client.
    mdi_in_table: bool,
    run: Option<Run>,
    homing: Option<Homing>,
    /// Homing that may have met a hard stop ended before its time: its current holds until the axis stands, then the
    /// command comes to it.
    presses: bool,
    /// Home position set.
    homed: bool,
    /// Target that was reached last; none since the axis left it for something else than a task.
    target: Option<i64>,
    /// The running task or homing is over; it cannot go on.
    finished: bool,
    failed: bool,
    /// It began in this tick.
    began: bool,
    /// What was requested beside the control word, and which task.
    wish: Option<PositionCommand>,
    wished_task: u16,
    /// An event that a chain of tasks may wait for.
    event: bool,
    /// How it brakes when it has to.
    brakes: Ramps,
    /// How it jogs: speed with sign and ramps.
    jog: (f64, Ramps),
    /// The ramps of jogging that were applied last.
    jog_ramps: Ramps,
    flags: status::Flags,
}

impl Positioning {
    pub fn new() -> Self {
        const DEFAULT: Ramps = Ramps {
            acceleration: 3000.0,
            deceleration: 3000.0,
        };
        Self {
            machine: PositionMachine::new(),
            active: false,
            tasks: Tasks::new(),
            mdi_in_table: false,
            run: None,
            homing: None,
            presses: false,
            homed: false,
            target: None,
            finished: false,
            failed: false,
            began: false,
            wish: None,
            wished_task: 0,
            event: false,
            brakes: DEFAULT,
            jog: (0.0, DEFAULT),
            jog_ramps: DEFAULT,
            flags: status::Flags::default(),
        }
    }

    /// State of the extended state machine, in S4 of position mode.
    pub const fn state(&self) -> Option<PositionState> {
        if self.active {
            Some(self.machine.state())
        } else {
            None
        }
    }

    /// Returns whether the chain of tasks stands between two of them and waits for an event.
    pub fn waits_for_event(&self) -> bool {
        let wait = self.run.as_ref().and_then(|run| run.wait.as_ref());
        self.active && wait.is_some_and(Wait::needs_event)
    }

    /// Returns the limits in force.
    const fn limits(&self, setup: &Setup) -> Limits {
        if self.homed { setup.limits } else { Limits::NONE }
    }

    /// Returns whether the current is to be limited to that of homing.
    pub fn is_gentle(&self) -> bool {
        self.presses || self.homing.as_ref().is_some_and(Homing::is_gentle)
    }

    /// S4 in position mode begins. An axis that still turns brakes along DRV.DEC, or as steep as it takes to stay inside
    /// the limits, up to CS.DEC or what could be braked with before.
    fn enter(&mut self, word: Stw1, axis: &Axis, rules: &Settings) {
        self.leave(word);
        self.active = true;
        let ramps = rules.ramps;
        self.brakes.deceleration = self.brakes.deceleration.max(rules.quick_stop);
        self.brakes = self.safe_stop(ramps, axis, &rules.position);
        if rules.position.home.automatic && !self.homed {
            self.wish = Some(PositionCommand::Homing);
        }
    }

    /// S4 or position mode ends: what was running is lost.
    fn leave(&mut self, word: Stw1) {
        self.machine.reset(word);
        self.active = false;
        self.presses = false;
        self.run = None;
        if self.homing.take().is_some() {
            self.flags.homing_failed = true;
        }
        self.target = None;
        self.finished = false;
        self.failed = false;
        self.wish = None;
        self.event = false;
        self.flags.leave();
    }

    /// Returns the position where the axis would stand if it braked now along this ramp.
    fn rest(seen: &Seen, task: &Task, axis: &Axis, rules: &Settings) -> i64 {
        let smooth = task.is_smooth() == Ok(true);
        let way = brake_way(seen.command_speed, task.deceleration);
        // A smooth stop takes longer: the braking builds up and ends.
        let more = if smooth {
            let building =
                rules.tuning.smoothing * (1.0 + axis.trajectory_acceleration().abs() / task.deceleration);
            (seen.command_speed.abs() * building * limits::COUNTS).ceil() as i64
        } else {
            0
        };
        let way = way.saturating_add(more).saturating_mul(seen.heading(0));
        seen.command.saturating_add(way)
    }

    /// Finds out if a task can run, and where it leads.
    fn permit(
        &self,
        number: u16,
        task: Task,
        seen: &Seen,
        axis: &Axis,
        rules: &Settings,
    ) -> Result<Leg, Refusal> {
        if !self.homed {
            return Err(Refusal::NotHomed);
        }
        let running = match self.machine.state() {
            PositionState::Basic => None,
            PositionState::Task | PositionState::Pause => self.run.as_ref(),
            _ => return Err(Refusal::Busy),
        };
        if running.is_some_and(|run| run.leg.task.has(task::EXCLUSIVE)) {
            return Err(Refusal::Exclusive);
        }
        if task.has(task::FLYING_ONLY) && seen.command_speed == 0.0 {
            return Err(Refusal::Standing);
        }
        let start = Start {
            command: seen.command,
            feedback: seen.position,
            target: running
                .map(|run| run.leg.target)
                .or(self.target)
                .unwrap_or(seen.command),
            rest: Self::rest(seen, &task, axis, rules),
        };
        let setup = &rules.position;
        Leg::plan(number, task, &start, seen, setup, &self.limits(setup))
    }

    /// Speed with sign and ramps of the jog that the word requests, with the task that MDI describes.
    fn jog_of(&self, word: Stw1, mdi: impl Fn() -> Task, rules: &Settings) -> (f64, Ramps) {
        let [one, two] = rules.jog_speed;
        if word.has(Stw1::JOG_1) {
            return (one, rules.jog_ramps);
        }
        if word.has(Stw1::JOG_2) {
            return (two, rules.jog_ramps);
        }
        let task = mdi();
        let direction = if word.has(Stw1::REAL_TIME_JOG_REVERSE) {
            -1.0
        } else {
            1.0
        };
        (direction * task.speed, task.ramps())
    }

    /// Nothing keeps the axis from jogging.
    fn may_jog(&self, (speed, ramps): (f64, Ramps), seen: &Seen, setup: &Setup) -> bool {
        let way = direction(speed);
        let room = self.limits(setup).room(seen.command, way);
        let ramps = ramps.acceleration > 0.0 && ramps.deceleration > 0.0;
        ramps && !seen.is_limited(way) && room != Some(0)
    }

    /// A task begins, from the place where the reference is.
    fn start(&mut self, leg: Leg, seen: &Seen, setup: &Setup) {
        let limits = self.limits(setup);
        self.flags.started(leg.is_slowed());
        let toward = seen.heading(0) == leg.way_from(seen.command) && seen.command_speed != 0.0;
        let room = leg.target.wrapping_sub(seen.command).saturating_abs();
        self.flags.crossed = toward && brake_way(seen.command_speed, leg.task.deceleration) > room;
        self.run = Some(Run::new(leg, seen.command, &self.tasks, seen, setup, &limits));
        self.presses = false;
        self.finished = false;
        self.failed = false;
        self.target = None;
    }

    /// Commands of the state machine.
    fn obey(&mut self, effect: PositionEffect, leg: Option<Leg>, seen: &Seen, rules: &Settings) {
        match effect {
            PositionEffect::None => {}
            PositionEffect::StartTask => {
                if let Some(leg) = leg {
                    self.start(leg, seen, &rules.position);
                }
            }
            PositionEffect::ContinueTask => {
                if let Some(run) = &mut self.run {
                    run.fresh = true;
                }
            }
            PositionEffect::FinishTask => self.run = None,
            PositionEffect::DropTask => {
                let ramp = self.run.take().map_or(self.brakes, |run| run.leg.task.ramps());
                self.brakes = steepened(ramp, rules.quick_stop);
                self.failed = false;
            }
            PositionEffect::StartHoming => {
                self.homed = false;
                self.presses = false;
                self.target = None;
                self.finished = false;
                self.failed = false;
                self.flags.homing_begins();
                self.brakes = rules.position.home.ramps;
                self.homing = Homing::new(&rules.position.home, seen);
            }
            PositionEffect::AbortHoming => {
                self.presses |= self.homing.as_ref().is_some_and(Homing::is_gentle);
                let failure = self.homing.take().and_then(|homing| homing.failure);
                self.flags.homing_ends(failure);
                self.failed = false;
            }
            PositionEffect::FinishHoming => {
                self.homing = None;
                self.homed = true;
                self.target = Some(seen.command);
                self.flags.homed();
            }
        }
    }

    /// Returns the command for the axis in the next step of `seconds`.
    fn direct(&mut self, axis: &mut Axis, seconds: f64, feedrate: f64, rules: &Settings) -> Command {
        let state = self.machine.state();
        let searches = state == PositionState::Homing && !self.failed;
        if self.presses && !searches && axis.is_standing(rules.standstill) {
            self.presses = false;
            axis.release();
        }
        if matches!(state, PositionState::Basic) {
            return stop(self.brakes);
        }
        let seen = Seen::new(axis, rules.standstill);
        match state {
            PositionState::Homing => self.home(axis, &seen, rules),
            PositionState::Jog1 | PositionState::Jog2 | PositionState::RealTimeJog => {
                self.travel(&seen, rules)
            }
            PositionState::Task => self.follow(&seen, seconds, feedrate, rules),
            PositionState::Pause => self.pause(&seen, rules),
            _ => stop(self.brakes),
        }
    }

    /// Returns whether the following steps of this tick have the command of the last one, whatever they show.
    pub fn goes_on(&self, axis: &Axis) -> GoesOn {
        if self.presses {
            return GoesOn::No;
        }
        match (self.machine.state(), &self.run) {
            (PositionState::Basic, _) => GoesOn::Always,
            (PositionState::Task, Some(run))
                if run.wait.is_none() && run.has_one_pace() && !self.failed && axis.is_without_switches() =>
            {
                if self.finished {
                    GoesOn::Always
                } else {
                    GoesOn::UntilDone
                }
            }
            _ => GoesOn::No,
        }
    }

    fn home(&mut self, axis: &mut Axis, seen: &Seen, rules: &Settings) -> Command {
        let setup = &rules.position.home;
        let Some(homing) = &mut self.homing else {
            self.failed = true;
            return stop(self.brakes);
        };
        let mut command = homing.step(setup, seen);
        if homing.take_pressed() {
            axis.release();
        }
        if let Some(place) = homing.take_reference(setup.position) {
            axis.shift_position(setup.position.wrapping_sub(place));
            self.flags.found = true;
            // What was to be done is to be done at the new numbers.
            command = homing.command(setup);
        }
        self.finished = homing.finished;
        let fails = homing.failure.is_some();
        self.presses |= fails && !self.failed && homing.is_gentle();
        self.failed = fails;
        command
    }

    fn travel(&mut self, seen: &Seen, rules: &Settings) -> Command {
        let (speed, ramps) = self.jog;
        let setup = &rules.position;
        let way = direction(speed);
        let heading = seen.heading(way);
        let limits = self.limits(setup);
        // Real-time jogging may change its ramp: what moves towards a limit keeps at least the one that stops it there.
        let needed = limits.needed(seen.command, seen.command_speed).unwrap_or(0.0);
        if seen.command_speed == 0.0 || self.jog_ramps != ramps || needed * MARGIN < ramps.deceleration {
            self.brakes = steepened(ramps, if seen.command_speed == 0.0 { 0.0 } else { needed });
        } else if needed > self.brakes.deceleration * MARGIN {
            self.brakes = steepened(ramps, needed);
        }
        self.jog_ramps = ramps;
        if seen.is_limited(heading) {
            self.failed = true;
            self.brakes = steepened(self.brakes, rules.quick_stop);
            return stop(self.brakes);
        }
        let speed = speed.clamp(-setup.fastest(-1), setup.fastest(1));
        match limits.towards(way) {
            Some(limit) if limits.room(seen.command, way) == Some(0) && limit != seen.command => {
                stop(self.brakes)
            }
            Some(limit) => Command::Position {
                target: limit,
                speed: speed.abs(),
                ramps: self.brakes,
                smooth: false,
                end_speed: 0.0,
            },
            None => Command::Travel {
                speed,
                ramps: self.brakes,
                smooth: false,
            },
        }
    }

    /// Aborts a task that cannot continue: brakes at once; the state machine follows in the next tick.
    fn fail(&mut self, rules: &Settings) -> Command {
        self.failed = true;
        self.flags.exception = true;
        self.brakes = steepened(self.brakes, rules.quick_stop);
        stop(self.brakes)
    }

    fn follow(&mut self, seen: &Seen, seconds: f64, feedrate: f64, rules: &Settings) -> Command {
        let setup = &rules.position;
        let limits = self.limits(setup);
        let event = core::mem::take(&mut self.event);
        let Some(run) = &mut self.run else {
            self.finished = true;
            return stop(self.brakes);
        };
        self.brakes = run.leg.task.ramps();
        if self.failed || seen.is_limited(seen.heading(run.leg.way_from(seen.command))) {
            return self.fail(rules);
        }
        if !limits.contains(run.leg.target) {
            return self.fail(rules);
        }
        if let Some(wait) = &mut run.wait {
            if wait.step(seconds, event) {
                self.advance(seen, setup);
            }
        } else if !run.fresh && seen.done && !self.finished {
            match run.next {
                Next::End => self.finished = true,
                Next::Impossible => {
                    self.flags.not_followed();
                    self.finished = true;
                }
                Next::Task { follow, .. } => match follow {
                    Follow::AtOnce | Follow::PresentSpeed | Follow::NextSpeed => self.advance(seen, setup),
                    _ => run.wait = Some(Wait::new(follow, run.leg.task.dwell)),
                },
            }
        }
        let Some(run) = &mut self.run else {
            return stop(self.brakes);
        };
        if self.finished {
            self.target = Some(run.leg.target);
        }
        run.fresh = false;
        let (speed, acceleration) = run.pace(seen.command);
        let leg = &run.leg;
        let smooth = leg.smooth;
        let ramps = Ramps {
            acceleration,
            ..leg.task.ramps()
        };
        Command::Position {
            target: leg.target,
            speed: speed * feedrate,
            ramps,
            smooth,
            end_speed: run.end_speed.min(speed) * feedrate,
        }
    }

    /// Goes over to the following task.
    fn advance(&mut self, seen: &Seen, setup: &Setup) {
        let limits = self.limits(setup);
        let Some(run) = self.run else { return };
        let Next::Task { number, task, .. } = run.next else {
            return;
        };
        let place = run.leg.target;
        let braking = brake_way(seen.command_speed, task.deceleration).saturating_mul(seen.heading(0));
        let start = Start {
            command: place,
            feedback: if seen.command_speed == 0.0 {
                seen.position
            } else {
                place
            },
            target: place,
            rest: seen.command.saturating_add(braking),
        };
        match Leg::plan(u16::from(number), task, &start, seen, setup, &limits) {
            Ok(leg) => {
                self.flags.started(leg.is_slowed());
                self.run = Some(Run::new(leg, place, &self.tasks, seen, setup, &limits));
            }
            Err(_) => {
                self.flags.not_followed();
                self.finished = true;
                // It was to be passed, and is not: comes back to it.
                if let Some(run) = &mut self.run {
                    run.end_speed = 0.0;
                    run.next = Next::End;
                    self.finished = seen.command_speed == 0.0;
                    run.fresh = true;
                }
            }
        }
    }

    /// Intermediate stop: brakes on the ramp of the task. A target that was to be passed is passed in the stop too.
    fn pause(&mut self, seen: &Seen, rules: &Settings) -> Command {
        if let Some(run) = self.run
            && run.end_speed > 0.0
            && run.leg.way_from(seen.command) != run.way
        {
            self.advance(seen, &rules.position);
        }
        if self.failed {
            return self.fail(rules);
        }
        let smooth = self.run.is_some_and(|run| run.leg.smooth);
        Command::Travel {
            speed: 0.0,
            ramps: self.brakes,
            smooth,
        }
    }

    /// Returns the ramp of a stop outside S4, made as steep as it takes to stay inside the limits, but not steeper than
    /// the movement that is stopped could have braked.
    pub fn safe_stop(&self, ramps: Ramps, axis: &Axis, setup: &Setup) -> Ramps {
        let needed = self.limits(setup).needed(axis.position(), axis.speed());
        let most = self.brakes.deceleration;
        match needed {
            Some(needed) => steepened(ramps, (needed * MARGIN).min(most)),
            None => ramps,
        }
    }
}

fn direction(speed: f64) -> i64 {
    if speed > 0.0 {
        1
    } else if speed < 0.0 {
        -1
    } else {
        0
    }
}
