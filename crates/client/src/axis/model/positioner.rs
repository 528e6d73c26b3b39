//! The part of a drive in position mode that the control's tests need.

use profile::state::{Stw1, Zsw1};

use crate::axis::Command;

/// Increments a task covers in one cycle.
const STEP: i32 = 50;
/// Cycles that homing takes.
const HOMING: u32 = 30;

/// Tasks, homing and jog in increments and cycles.
pub struct Positioner {
    pub position: i32,
    pub homed: bool,
    /// Tasks are not accepted.
    pub refuses: bool,
    /// The acknowledge does not go back.
    pub acknowledges_for_ever: bool,
    /// Tasks end here, as at a limit switch.
    pub barrier: Option<i32>,
    /// Homing is not begun.
    pub ignores_homing: bool,
    /// Homing sets the position where the axis stands, within a cycle.
    pub homes_on_the_spot: bool,
    /// Homing ends without a home position.
    pub homing_fails: bool,
    /// Every task that was accepted: the target it leads to.
    pub accepted: Vec<i32>,
    /// Targets in the telegram while no task was accepted.
    pub idle_targets: Vec<i32>,
    target: Option<i32>,
    homing: Option<u32>,
    reached: bool,
    acknowledge: bool,
    moves: bool,
    last: Stw1,
}

impl Positioner {
    pub fn new() -> Self {
        Self {
            position: 1234,
            homed: true,
            refuses: false,
            acknowledges_for_ever: false,
            barrier: None,
            ignores_homing: false,
            homes_on_the_spot: false,
            homing_fails: false,
            accepted: Vec::new(),
            idle_targets: Vec::new(),
            target: None,
            homing: None,
            reached: false,
            acknowledge: false,
            moves: false,
            last: Stw1(0),
        }
    }

    pub fn bits(&self) -> u16 {
        [
            (self.reached, Zsw1::REACHED),
            (self.homed, Zsw1::HOMED),
            (self.acknowledge, Zsw1::TASK_ACKNOWLEDGED),
            (!self.moves, Zsw1::STOPPED),
            (self.target.is_some(), Zsw1::TASK_ACTIVE),
        ]
        .into_iter()
        .filter(|(set, _)| *set)
        .fold(0, |word, (_, bit)| word | bit.0)
    }

    pub fn step(&mut self, command: &Command, operation: bool) {
        let edge = |bit| command.stw1.has(bit) && !self.last.has(bit);
        let (task, home) = (edge(Stw1::ACTIVATE_TASK), edge(Stw1::START_HOMING));
        self.last = command.stw1;
        self.moves = false;
        if !command.stw1.has(Stw1::ACTIVATE_TASK) && !self.acknowledges_for_ever {
            self.acknowledge = false;
        }
        if !operation {
            self.idle_targets.push(command.traverse.target);
            self.target = None;
            self.homing = None;
            return;
        }
        self.home(home, command.stw1.has(Stw1::START_HOMING));
        if !command.stw1.has(Stw1::NO_REJECT) {
            self.target = None;
        }
        let free = command.stw1.has(Stw1::NO_REJECT | Stw1::NO_INTERMEDIATE_STOP);
        if task && free && self.homed && !self.refuses && !self.acknowledge {
            let traverse = command.traverse;
            let from = if traverse.is_absolute() { 0 } else { self.position };
            let target = if traverse.is_mdi() {
                from + traverse.target
            } else {
                500
            };
            self.target = Some(target);
            self.accepted.push(target);
            self.reached = false;
            self.acknowledge = true;
        }
        if command.stw1.has(Stw1::JOG_1) && !free {
            self.position += STEP;
            self.moves = true;
        }
        self.travel(free);
    }

    fn travel(&mut self, free: bool) {
        let Some(target) = self.target.filter(|_| free) else {
            return;
        };
        if self.barrier.is_some_and(|barrier| self.position >= barrier) {
            self.target = None;
            return;
        }
        self.position += (target - self.position).clamp(-STEP, STEP);
        self.moves = self.position != target;
        if !self.moves {
            self.target = None;
            self.reached = true;
        }
    }

    fn home(&mut self, begin: bool, wanted: bool) {
        if begin && !self.ignores_homing && self.target.is_none() {
            if self.homes_on_the_spot {
                (self.homed, self.reached, self.position) = (true, true, 0);
                return;
            }
            (self.homed, self.reached) = (false, false);
            self.homing = Some(HOMING);
        }
        if !wanted {
            self.homing = None;
        }
        self.homing = match self.homing {
            Some(0) => {
                let done = !self.homing_fails;
                (self.homed, self.reached) = (done, done);
                self.position = 0;
                None
            }
            Some(left) => {
                self.moves = true;
                Some(left - 1)
            }
            None => None,
        };
    }
}
