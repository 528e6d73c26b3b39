//! A bench for the control's tests: the general state machine in miniature, with one cycle of delay each way.

use std::time::Duration;

use profinet::Instant;

use super::control::{AxisControl, Command, Goal, Limits, Progress};
use super::seen::{Phase, Seen};

pub struct Bench {
    axis: AxisControl,
    now: Instant,
    state: Phase,
    quick: bool,
    fault: bool,
    cause: bool,
    local: bool,
    ramps_down: bool,
    slows_down: bool,
    valid: bool,
    speed: i16,
    last_ack: bool,
    in_flight: Command,
    words: Vec<u16>,
}

impl Bench {
    pub fn new() -> Self {
        Self {
            axis: AxisControl::new(Limits::default()),
            now: Instant::ZERO,
            state: Phase::S1,
            quick: false,
            fault: false,
            cause: false,
            local: false,
            ramps_down: true,
            slows_down: true,
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
            self.state = Phase::S1;
            self.speed = 0;
        }
    }

    pub fn coast(&mut self) {
        self.state = Phase::S1;
        self.speed = 0;
    }

    pub fn never_ramps_down(&mut self) {
        self.ramps_down = false;
    }

    /// Operation goes on at the same speed whatever the setpoint says.
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
            Phase::NotReady => 0,
            Phase::S1 => 0x0070,
            Phase::S2 => 0x0031,
            Phase::S3 => 0x0033,
            Phase::S4 => 0x0037,
            Phase::S5 => 0x0033 & !(u16::from(self.quick) << 5),
        };
        let zsw1 = state | u16::from(self.fault) << 3 | u16::from(!self.local) << 9;
        Seen {
            zsw1,
            nist_a: self.speed,
        }
    }

    pub fn command(&self) -> Command {
        self.axis.command()
    }

    pub fn progress(&self) -> Progress {
        self.axis.progress()
    }

    pub fn phase(&self) -> Phase {
        self.state
    }

    pub fn speed(&self) -> i16 {
        self.speed
    }

    pub fn words(&self) -> &[u16] {
        &self.words
    }

    fn drive(&mut self, Command { stw1, nsoll_a }: Command) {
        let bit = |n: u16| stw1 & (1 << n) != 0;
        if self.local || !bit(10) {
            return;
        }
        if bit(7) && !self.last_ack && !self.cause {
            self.fault = false;
        }
        self.last_ack = bit(7);
        self.state = match self.state {
            Phase::S1 if !bit(0) && bit(1) && bit(2) && !self.fault => Phase::S2,
            Phase::S2 if bit(0) => Phase::S3,
            Phase::S3 if !bit(0) => Phase::S2,
            Phase::S3 if bit(3) => Phase::S4,
            Phase::S4 if !bit(0) => Phase::S5,
            Phase::S5 if self.speed == 0 => {
                if self.quick {
                    Phase::S1
                } else {
                    Phase::S2
                }
            }
            other => other,
        };
        self.quick = self.state == Phase::S5 && (self.quick || !bit(2));
        let target = match self.state {
            Phase::S4 if stw1 & 0x70 == 0 && bit(8) => 40,
            Phase::S4 if stw1 & 0x70 == 0 && bit(9) => -40,
            Phase::S4 if stw1 & 0x70 == 0x70 => nsoll_a,
            _ => 0,
        };
        let step = match self.state {
            Phase::S5 if !self.ramps_down && !self.quick => 0,
            Phase::S4 if !self.slows_down => 0,
            _ => 10,
        };
        self.speed += (target - self.speed).clamp(-step, step);
    }
}
