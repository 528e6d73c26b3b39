//! A bench for the control's tests: the general state machine in miniature, with one cycle of delay each way.

mod positioner;

use std::time::Duration;

use profile::state::{Mode, State, Stw1, Zsw1};
use profinet::Instant;

use super::{AxisControl, Command, Goal, Limits, Progress, Seen, StopKind, Traverse};
pub use positioner::Positioner;

pub struct Bench {
    axis: AxisControl,
    now: Instant,
    state: State,
    fault: bool,
    cause: bool,
    local: bool,
    ramps_down: bool,
    slows_down: bool,
    /// What a coasting axis loses of its speed in a cycle.
    friction: i16,
    valid: bool,
    speed: i16,
    last_ack: bool,
    in_flight: Command,
    words: Vec<Stw1>,
    /// What a drive in position mode has besides.
    pub positioner: Option<Positioner>,
}

impl Bench {
    pub fn new() -> Self {
        Self::with(AxisControl::new(Limits::default()), None)
    }

    /// Creates a drive in position mode, homed.
    pub fn positioning() -> Self {
        let limits = Limits {
            task_active: Zsw1::TASK_ACTIVE,
            ..Limits::default()
        };
        Self::with(
            AxisControl::in_mode(limits, Mode::Position),
            Some(Positioner::new()),
        )
    }

    fn with(axis: AxisControl, positioner: Option<Positioner>) -> Self {
        Self {
            axis,
            positioner,
            now: Instant::ZERO,
            state: State::S1,
            fault: false,
            cause: false,
            local: false,
            ramps_down: true,
            slows_down: true,
            friction: 10,
            valid: true,
            speed: 0,
            last_ack: false,
            in_flight: Command::default(),
            words: Vec::new(),
        }
    }

    pub fn pursue(&mut self, goal: Goal) {
        self.axis.pursue(self.now, goal);
        self.cycles(1);
    }

    pub fn end(&mut self) {
        self.axis.end();
    }

    pub fn cycles(&mut self, count: u32) {
        for _ in 0..count {
            self.now += Duration::from_millis(16);
            let command = if self.valid {
                self.axis.step(self.now, self.seen())
            } else {
                self.axis.step_blind(self.now)
            };
            if self.words.last() != Some(&command.stw1) {
                self.words.push(command.stw1);
            }
            let arrived = std::mem::replace(&mut self.in_flight, command);
            self.drive(arrived);
        }
    }

    pub fn until(&mut self, progress: Progress) {
        for _ in 0..2000 {
            if self.axis.progress() == progress {
                return;
            }
            self.cycles(1);
        }
        panic!(
            "{:?} instead of {progress:?} with {:?}",
            self.axis.progress(),
            self.seen()
        );
    }

    pub fn fail(&mut self, on: bool) {
        self.cause = on;
        if on {
            self.fault = true;
            self.state = State::S1;
            self.speed = 0;
        }
    }

    pub fn coast(&mut self) {
        self.state = State::S1;
        self.speed = 0;
    }

    pub fn never_ramps_down(&mut self) {
        self.ramps_down = false;
    }

    /// Nothing slows a coasting axis down.
    pub fn never_rubs(&mut self) {
        self.friction = 0;
    }

    pub fn stop_by(&mut self, way: StopKind) {
        self.axis.stop_now(self.now);
        self.axis.hurry(self.now, way);
        self.cycles(1);
    }

    /// Operation goes on at the same speed whatever the setpoint is.
    pub fn never_slows_down(&mut self) {
        self.slows_down = false;
    }

    pub fn inputs_valid(&mut self, valid: bool) {
        self.valid = valid;
    }

    pub fn is_at_rest(&self) -> bool {
        self.axis.is_at_rest()
    }

    pub fn local(&mut self) {
        self.local = true;
    }

    pub fn seen(&self) -> Seen {
        let state = match self.state {
            State::S1 => 0x0070,
            State::S2 => 0x0031,
            State::S3 | State::S5Ramp => 0x0033,
            State::S4 => 0x0037,
            State::S5Quick => 0x0013,
        };
        let zsw1 = state | u16::from(self.fault) << 3 | u16::from(!self.local) << 9;
        if let Some(positioner) = &self.positioner {
            return Seen {
                zsw1: Zsw1(zsw1 | positioner.bits()),
                xist_a: Some(positioner.position),
                ..Seen::default()
            };
        }
        Seen {
            zsw1: Zsw1(zsw1),
            nist_a: Some(self.speed),
            ..Seen::default()
        }
    }

    pub fn command(&self) -> Command {
        self.axis.command()
    }

    pub fn progress(&self) -> Progress {
        self.axis.progress()
    }

    pub fn state(&self) -> State {
        self.state
    }

    pub fn speed(&self) -> i16 {
        self.speed
    }

    pub fn held(&self) -> Option<Traverse> {
        self.axis.held()
    }

    pub fn is_accepted(&self) -> bool {
        self.axis.is_accepted()
    }

    pub fn words(&self) -> &[Stw1] {
        &self.words
    }

    fn drive(&mut self, command: Command) {
        let Command { stw1, nsoll_a, .. } = command;
        let has = |bits| stw1.has(bits);
        if self.local || !has(Stw1::CONTROL_BY_PLC) {
            return;
        }
        let ack = has(Stw1::ACKNOWLEDGE_FAULT);
        if ack && !self.last_ack && !self.cause {
            self.fault = false;
        }
        self.last_ack = ack;
        let (on, held) = (has(Stw1::ON), has(Stw1::NO_COAST_STOP | Stw1::NO_QUICK_STOP));
        self.state = match self.state {
            _ if !has(Stw1::NO_COAST_STOP) => State::S1,
            State::S1 if !on && held && !self.fault => State::S2,
            State::S2 if on => State::S3,
            State::S3 if !on => State::S2,
            State::S3 if has(Stw1::ENABLE_OPERATION) => State::S4,
            State::S4 if !on => State::S5Ramp,
            State::S5Ramp if on => State::S4,
            State::S5Ramp if self.speed == 0 => State::S2,
            State::S5Quick if self.speed == 0 => State::S1,
            other => other,
        };
        if self.state == State::S5Ramp && !has(Stw1::NO_QUICK_STOP) {
            self.state = State::S5Quick;
        }
        if let Some(positioner) = &mut self.positioner {
            positioner.step(&command, self.state == State::S4);
            self.speed = 0;
            return;
        }
        let channel = stw1 & (Stw1::ENABLE_RAMP | Stw1::UNFREEZE_RAMP | Stw1::ENABLE_SETPOINT);
        let target = match self.state {
            State::S4 if channel.0 == 0 && has(Stw1::JOG_1) => 40,
            State::S4 if channel.0 == 0 && has(Stw1::JOG_2) => -40,
            State::S4 if channel.0 == 0x70 => nsoll_a,
            _ => 0,
        };
        let step = match self.state {
            State::S5Ramp if !self.ramps_down => 0,
            State::S4 if !self.slows_down => 0,
            State::S1 => self.friction,
            _ => 10,
        };
        self.speed += (target - self.speed).clamp(-step, step);
    }
}
