//! The goals of position mode: traversing tasks with their handshake, intermediate stop, homing.
//!
//! Source: AKD manual 5.10; profile 6.3.4 by way of ABB FSPS-21 and Festo CMMT.

use profile::state::Stw1;
use profinet::Instant;

use super::{AxisControl, Command, JOG_READY, word};
use crate::axis::command::Traverse;
use crate::axis::goal::{Goal, Progress, Trouble};
use crate::axis::seen::Seen;

/// Operation without a task: neither rejected nor held, bit 6 waits for its edge.
const IDLE: Stw1 = Stw1::RUN.without(Stw1::ACTIVATE_TASK);
/// The same with the edge.
const EDGE: Stw1 = Stw1::RUN;
/// Intermediate stop: the task stays.
pub(super) const PAUSED: Stw1 = IDLE.without(Stw1::NO_INTERMEDIATE_STOP);
/// Bits 4 and 5 are 0: the task is discarded. The same word permits jogging.
const DISCARD: Stw1 = JOG_READY;
/// Real-time jogging.
const REAL_TIME: Stw1 = IDLE.with(Stw1::REAL_TIME_JOG);
/// Homing.
const HOMING: Stw1 = IDLE.with(Stw1::START_HOMING);

/// How far a goal of position mode is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// Operation is not reached, or the values of the task have just been put into the telegram.
    Begin,
    /// The edge stands, the drive has not acknowledged.
    Edge,
    /// Accepted.
    UnderWay,
    /// At the target, or homed.
    Done,
}

impl AxisControl {
    /// Where a new wish begins: the task that a pause holds goes on, everything else starts again.
    pub(super) fn keep_task(&mut self, now: Instant, goal: Goal) {
        let phase = match (self.goal, goal) {
            (Goal::Pause, Goal::Traverse(task)) if self.paused == Some(task) => Phase::UnderWay,
            (Goal::Traverse(task), Goal::Pause) if self.phase == Phase::UnderWay => {
                self.paused = Some(task);
                Phase::Begin
            }
            (Goal::Pause, Goal::Pause) => self.phase,
            // other values take effect while it jogs
            (Goal::RealTimeJog { .. }, Goal::RealTimeJog { .. }) => self.phase,
            (_, Goal::Traverse(_)) => Phase::Begin,
            _ => {
                self.paused = None;
                Phase::Begin
            }
        };
        let unfinished = match self.goal {
            Goal::Traverse(_) | Goal::Home { .. } => self.phase != Phase::Done,
            Goal::Pause | Goal::Jog(_) | Goal::RealTimeJog { .. } => true,
            _ => false,
        };
        self.braking = unfinished
            && match goal {
                Goal::Enabled | Goal::Home { .. } => true,
                Goal::RealTimeJog { .. } => !matches!(self.goal, Goal::RealTimeJog { .. }),
                // a task may follow a task on the fly, but not a jog or homing
                Goal::Traverse(_) => {
                    matches!(
                        self.goal,
                        Goal::Jog(_) | Goal::RealTimeJog { .. } | Goal::Home { .. }
                    )
                }
                _ => false,
            };
        self.enter(now, phase);
    }

    fn enter(&mut self, now: Instant, phase: Phase) {
        self.phase = phase;
        self.phase_since = now;
        self.astray = None;
    }

    /// Returns a task: values first, then the edge, until the target.
    pub(super) fn traverse(&mut self, now: Instant, seen: Seen, task: Traverse) -> Command {
        if let Some(command) = self.operation(now, seen).or_else(|| self.brake(now, seen)) {
            return command;
        }
        let command = |stw1| Command {
            traverse: task,
            ..word(stw1)
        };
        let waited = now - self.phase_since;
        match self.phase {
            Phase::Begin => {
                let valid = self.command == command(IDLE);
                if !valid {
                    // the values stand before the edge
                    self.phase_since = now;
                } else if waited >= self.limits.dwell && !seen.task_acknowledged() {
                    self.enter(now, Phase::Edge);
                    return command(EDGE);
                } else if waited > self.limits.accept {
                    return self.fail(now, seen, Trouble::AcceptanceStays);
                }
                command(IDLE)
            }
            Phase::Edge if seen.task_acknowledged() => {
                self.enter(now, Phase::UnderWay);
                command(IDLE)
            }
            Phase::Edge if waited > self.limits.accept => {
                let homed = seen.homed();
                self.fail(now, seen, Trouble::NotAccepted { homed })
            }
            Phase::Edge => command(EDGE),
            Phase::UnderWay => {
                // bits 10 and 13 may be those of the task before until the acknowledge has gone
                let released = !seen.task_acknowledged() || waited > self.limits.accept;
                let settled = released && waited >= self.limits.dwell;
                let active = self.limits.task_active.0 != 0 && seen.zsw1.has(self.limits.task_active);
                let stands = settled && seen.stopped();
                if stands && seen.reached() && !active {
                    self.enter(now, Phase::Done);
                    self.progress = Progress::Reached;
                    self.paused = None;
                } else if self.strays(now, stands && (task.is_mdi() || !active)) {
                    // a task of the drive may stand for its dwell time
                    return self.fail(now, seen, Trouble::TargetNotReached);
                }
                command(IDLE)
            }
            Phase::Done => command(IDLE),
        }
    }

    /// Real-time jogging: first the values, then the bits; the values count as long as bit 12 stands.
    pub(super) fn real_time_jog(
        &mut self,
        now: Instant,
        seen: Seen,
        values: Traverse,
        backwards: bool,
    ) -> Command {
        if let Some(command) = self.operation(now, seen).or_else(|| self.brake(now, seen)) {
            return command;
        }
        let command = |stw1| Command {
            traverse: values,
            ..word(stw1)
        };
        if self.phase == Phase::Begin {
            if self.command != command(IDLE) || !seen.stopped() {
                // the values stand before the bits
                self.phase_since = now;
                return command(IDLE);
            }
            if now - self.phase_since < self.limits.dwell {
                return command(IDLE);
            }
            self.enter(now, Phase::UnderWay);
        }
        self.progress = Progress::Reached;
        let way = if backwards {
            REAL_TIME.with(Stw1::REAL_TIME_JOG_REVERSE)
        } else {
            REAL_TIME
        };
        command(way)
    }

    /// Pauses: the task stays, the axis stands.
    pub(super) fn pause(&mut self, now: Instant, seen: Seen) -> Command {
        if let Some(command) = self.operation(now, seen) {
            return command;
        }
        if self.stood(now) && self.command.stw1 == PAUSED && seen.stopped() {
            self.progress = Progress::Reached;
        } else if self.progress == Progress::Pursuing && self.took(now) > self.limits.stop {
            return self.fail(now, seen, Trouble::NotStopped);
        }
        Command {
            traverse: self.paused.unwrap_or_default(),
            ..word(PAUSED)
        }
    }

    /// Operation without motion.
    pub(super) fn halt(&mut self, now: Instant, seen: Seen) -> Command {
        if let Some(command) = self.operation(now, seen).or_else(|| self.brake(now, seen)) {
            return command;
        }
        if self.command.stw1 == IDLE && seen.stopped() {
            self.progress = Progress::Reached;
        } else if self.progress == Progress::Pursuing && self.took(now) > self.limits.step + self.limits.stop
        {
            return self.fail(now, seen, Trouble::NotStopped);
        }
        word(IDLE)
    }

    /// Stops the present motion along its ramp, then discards it; `None` once that is done.
    fn brake(&mut self, now: Instant, seen: Seen) -> Option<Command> {
        if !self.braking {
            return None;
        }
        let stands = self.stood(now) && seen.stopped();
        Some(match self.command.stw1 {
            DISCARD if stands => {
                self.braking = false;
                self.enter(now, Phase::Begin);
                return None;
            }
            _ if self.took(now) > self.limits.step + self.limits.stop => {
                self.fail(now, seen, Trouble::NotStopped)
            }
            PAUSED if stands => word(DISCARD),
            DISCARD => word(DISCARD),
            _ => word(PAUSED),
        })
    }

    /// Homing: bits 10, 11 and 13 of ZSW1 go, and come back when the home position is set.
    pub(super) fn home(&mut self, now: Instant, seen: Seen, on_the_spot: bool) -> Command {
        if let Some(command) = self.operation(now, seen).or_else(|| self.brake(now, seen)) {
            return command;
        }
        let waited = now - self.phase_since;
        let homed = seen.homed() && seen.stopped() && seen.reached();
        match self.phase {
            Phase::Begin if seen.stopped() => {
                self.enter(now, Phase::Edge);
                self.homed_before = seen.homed();
                word(HOMING)
            }
            Phase::Begin if waited > self.limits.accept => self.fail(now, seen, Trouble::NotStopped),
            Phase::Begin => word(IDLE),
            Phase::Edge => {
                let begun = !seen.stopped() || (self.homed_before && !seen.homed());
                let at_once = homed && (on_the_spot || !self.homed_before) && waited >= self.limits.dwell;
                if begun {
                    self.enter(now, Phase::UnderWay);
                } else if at_once {
                    return self.homed(now);
                } else if waited > self.limits.accept {
                    return self.fail(now, seen, Trouble::HomingNotStarted);
                }
                word(HOMING)
            }
            Phase::UnderWay if homed => self.homed(now),
            Phase::UnderWay => {
                if self.strays(now, seen.stopped()) {
                    return self.fail(now, seen, Trouble::HomingFailed);
                }
                word(HOMING)
            }
            Phase::Done => word(IDLE),
        }
    }

    fn homed(&mut self, now: Instant) -> Command {
        self.enter(now, Phase::Done);
        self.progress = Progress::Reached;
        word(IDLE)
    }

    /// Returns the way to operation; `None` once there.
    fn operation(&mut self, now: Instant, seen: Seen) -> Option<Command> {
        let command = self.switch_on(now, seen, IDLE)?;
        if self.goal.operates() {
            self.enter(now, Phase::Begin);
        }
        Some(command)
    }

    /// Returns true when the axis has stood for too long where it should not.
    fn strays(&mut self, now: Instant, stands: bool) -> bool {
        if !stands {
            self.astray = None;
            return false;
        }
        now - *self.astray.get_or_insert(now) > self.limits.settle
    }

    fn fail(&mut self, now: Instant, seen: Seen, trouble: Trouble) -> Command {
        self.give_up(now, trouble);
        self.stop(now, seen)
    }
}
