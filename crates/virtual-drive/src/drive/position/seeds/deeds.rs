//! What happens to the drive, and how a life ends.

use core::time::Duration;

use profile::state::{PositionState, State};
use profile::telegram::signal;

use super::{Life, READY, TASKS, Trial};
use crate::drive::Disconnect;

impl Trial {
    /// Some cycles with a control word.
    pub fn send(&mut self, word: u16, milliseconds: u64) {
        self.word = word;
        let end = self.bench.now + Duration::from_millis(milliseconds);
        self.cycle(true);
        while self.bench.now < end {
            self.cycle(true);
        }
    }

    /// Back to S4 from wherever it is.
    pub fn enable(&mut self) {
        // No load acts on an axis without holding torque.
        self.bench.drive.set_load(0.0);
        self.bench.drive.axis.set_blocked(false);
        for word in [0x0430, 0x04B6, 0x0436, 0x0437, 0x043F] {
            self.send(word, 4);
        }
        let begin = self.bench.now;
        while self.bench.drive.state() != State::S4 {
            for word in [0x0430, 0x04B6, 0x0436, 0x043F] {
                self.send(word, 4);
            }
            assert!(
                self.bench.now - begin < Duration::from_secs(30),
                "{}",
                self.here()
            );
        }
    }

    /// Homes in one of the modes that need nothing.
    pub fn home(&mut self, abort: bool) {
        self.word = READY & !0x10;
        self.send(self.word, 4);
        while self.bench.status() & 0x2000 == 0 {
            self.cycle(true);
        }
        self.send(READY, 4);
        let abort_or_here = abort || self.life == Life::Plain;
        let mode = if abort_or_here { [0, 7, 11, 13, 15] } else { [0; 5] }
            [self.random.below(if abort { 3 } else { 5 }) as usize];
        self.bench.write("HOME.MODE", mode);
        if abort {
            let time = self.random.below(60);
            self.send(READY | 0x0800, time);
            self.send(READY, 20);
            return;
        }
        self.word = READY | 0x0800;
        let begin = self.bench.now;
        loop {
            self.cycle(true);
            let state = self.bench.drive.positioning.state();
            if state == Some(PositionState::Basic) && self.bench.drive.positioning.homed {
                break;
            }
            assert!(
                self.bench.now - begin < Duration::from_secs(20),
                "{}",
                self.here()
            );
        }
        self.send(READY, 4);
    }

    /// Requests a task, by SATZANW or by MDI.
    pub fn start(&mut self) {
        if self.random.one_in(2) {
            self.fill_mdi();
        } else {
            let number = self.random.below(TASKS as u64 + 2) as i64;
            self.bench.set(signal::SATZANW, number);
        }
        self.send(READY, 1);
        let time = self.random.below(40);
        self.send(READY | 0x40, time);
        if self.random.one_in(2) {
            self.send(READY, 1);
        }
    }

    pub fn intervene(&mut self) {
        let time = self.random.below(300);
        if self.life == Life::Blocked && self.random.one_in(6) {
            return self.block(time);
        }
        match self.random.below(20) {
            0..=7 => {
                self.start();
                self.send(self.word, time);
            }
            8 | 9 => {
                self.send(READY & !0x20, time);
                self.send(READY, time / 3);
            }
            10 => self.send(READY & !0x10, time),
            11 => {
                let jog = [0x0100, 0x0200][self.random.below(2) as usize];
                self.send(0x040F, 200);
                self.send(0x040F | jog, time);
            }
            12 => {
                self.fill_mdi();
                let reverse = [0, 0x2000][self.random.below(2) as usize];
                self.send(READY | 0x1000 | reverse, time);
                if self.random.one_in(2) {
                    self.fill_mdi();
                    self.send(READY | 0x1000, time);
                }
            }
            13 => {
                self.send(READY, time);
                let abort = self.random.one_in(2);
                self.home(abort);
                if !self.bench.drive.positioning.homed {
                    self.home(false);
                }
            }
            14 => {
                let number = [302, 439, 501, 702, 301][self.random.below(5) as usize];
                self.bench.drive.set_load(0.0);
                self.bench.drive.inject_fault(number, false);
                self.send(self.word, time);
                self.enable();
            }
            15 => {
                self.bench.drive.set_load(0.0);
                let word = [0x043E, 0x043D, 0x043B, 0x0437][self.random.below(4) as usize];
                self.send(word, time);
                self.enable();
            }
            16 => {
                self.bench.drive.set_load(0.0);
                self.bench.drive.disconnect(Disconnect::Lost);
                for _ in 0..time {
                    self.cycle(false);
                }
                self.bench.connect_again(9);
                self.acknowledged = false;
                self.enable();
            }
            17 => {
                self.bench.drive.set_load(0.0);
                for _ in 0..1 + time / 20 {
                    self.cycle(false);
                }
                self.enable();
            }
            18 => {
                let _ = self.bench.try_write("DRV.STOP", 1);
                self.send(READY, time);
                let _ = self.bench.try_write("MT.CONTINUE", 1);
                self.send(READY, time);
                let number = 1 + self.random.below(TASKS as u64) as i64;
                let _ = self.bench.try_write("MT.MOVE", number);
                self.send(READY, time);
            }
            _ => {
                let number = 1 + self.random.below(TASKS as u64) as usize;
                self.edit(number);
                let load = self.random.between(-0.3, 0.3);
                self.bench.drive.set_load(load);
                self.bench.drive.motion_event();
                self.send(self.word, time);
            }
        }
    }

    /// Ends all interference: each running task reaches its target, or reports the cause.
    pub fn finish(&mut self) {
        self.bench.drive.set_load(0.0);
        self.bench.drive.axis.set_blocked(false);
        if self.bench.drive.state() != State::S4 {
            self.enable();
        }
        let _ = self.bench.try_write("MT.CONTINUE", 1);
        self.word = READY;
        let begin = self.bench.now;
        let had_task = self.bench.status() & 0x4000 != 0;
        loop {
            self.cycle(true);
            let status = self.bench.status();
            if status & 0x4000 == 0 && status & 0x2000 != 0 {
                break;
            }
            assert!(
                self.bench.now - begin < Duration::from_secs(120),
                "never ends: {}",
                self.here()
            );
        }
        self.send(READY, 150);
        let status = self.bench.status();
        let flagged = self.bench.read("DRV.MOTIONSTAT") & 0x2400 != 0 && status & 0x80 != 0;
        if had_task && !flagged {
            assert!(status & 0x0400 != 0, "not reached, no reason: {}", self.here());
            self.seen.done += 1;
        }
    }

    /// Something holds the axis for a while, mostly in a movement.
    fn block(&mut self, time: u64) {
        self.start();
        self.bench.drive.axis.set_blocked(true);
        self.held = true;
        self.send(self.word, time);
        self.bench.drive.axis.set_blocked(false);
        self.send(self.word, 50);
        if self.bench.drive.state() != State::S4 {
            self.seen.stuck += 1;
            self.enable();
        }
    }
}
