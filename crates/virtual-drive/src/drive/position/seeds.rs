//! Random task lists and random interventions in virtual time: a thousand seeds.
//!
//! In every cycle the axis keeps to its limits, to the speeds and ramps that were set, and the status word is compared
//! with what the axis really does. In the end each task has come to its target, or there is a reason that is told.

use core::time::Duration;

use profidrive::state::{PositionState, State};
use profidrive::telegram::signal;

use super::tests::{Bench, READY};
use super::units::REVOLUTION;
use crate::drive::Disconnect;

/// Small, fast and the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// What a movement may do.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bound {
    speed: f64,
    ramp: f64,
}

impl Bound {
    fn or(self, other: Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            ramp: self.ramp.max(other.ramp),
        }
    }
}

const NOTHING: Bound = Bound {
    speed: 0.0,
    ramp: 0.0,
};

/// Tasks 1 to 6 of the table.
const TASKS: usize = 6;

/// One drive, one seed.
struct Trial {
    seed: u64,
    random: Random,
    bench: Bench,
    /// Our own copy of the table, and of MDI as it was when it was acknowledged.
    table: [Bound; TASKS + 1],
    mdi: Bound,
    mdi_sent: Bound,
    jog: Bound,
    /// Steepest ramp of stops.
    stop: f64,
    /// Software limits in revolutions.
    limits: (f64, f64),
    window: f64,
    error_window: i64,
    /// What moved in the last cycle.
    moved: Bound,
    /// Speed of the reference in the last cycle.
    pace: f64,
    /// The power stage went off while the axis turned: where it rolls to is nobody's fault, until it is inside again.
    excused: bool,
    /// Where the reference was without a movement, in revolutions.
    rest: f64,
    /// What the ramp of real-time jogging had to be made.
    steepest: f64,
    word: u16,
    acknowledged: bool,
    tasks_done: u32,
    refused: u32,
    /// States that were seen, by place in `PositionState::ALL`.
    states: u32,
}

impl Trial {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let mut bench = Bench::new(9);
        bench.cycle = Duration::from_millis([1, 2, 4, 16][random.below(4) as usize]);
        let limits = (-random.between(1.0, 15.0), random.between(1.0, 15.0));
        let enabled = random.below(4) as i64;
        bench.write("SWLS.LIMIT0", (limits.0 * 65_536.0) as i64);
        bench.write("SWLS.LIMIT1", (limits.1 * 65_536.0) as i64);
        bench.write("SWLS.EN", enabled);
        let limits = (
            if enabled & 1 != 0 {
                limits.0
            } else {
                f64::NEG_INFINITY
            },
            if enabled & 2 != 0 { limits.1 } else { f64::INFINITY },
        );
        let quick = random.between(1000.0, 40_000.0);
        bench.write("CS.DEC", (quick * 1000.0) as i64);
        let ramp = random.between(1000.0, 40_000.0);
        bench.write("DRV.DEC", (ramp * 1000.0) as i64);
        let steps = 2 + random.below(30) as i64;
        let speed = random.between(20.0, 1500.0);
        bench.write("Jog v1", (speed / 0.366_12) as i64);
        bench.write("Jog v2", (-speed / 0.366_12) as i64);
        bench.write("Jog Acc", steps);
        bench.write("Jog Dec", steps);
        let window = 0.01;
        bench.write("MT.TPOSWND", (window * 65_536.0) as i64);
        let error_window = 1 + random.below(2000) as i64;
        bench.write("PL.ERRWTHRESH", error_window);
        bench.write("HOME.V_32", (random.between(50.0, 600.0) * 1000.0) as i64);
        let mut trial = Self {
            seed,
            random,
            bench,
            table: [NOTHING; TASKS + 1],
            mdi: NOTHING,
            mdi_sent: NOTHING,
            jog: Bound {
                speed: speed + 1.0,
                ramp: steps as f64 * 763.0,
            },
            stop: quick.max(ramp).max(3000.0),
            limits,
            window,
            error_window,
            moved: NOTHING,
            pace: 0.0,
            excused: false,
            rest: 0.0,
            steepest: 0.0,
            word: 0,
            acknowledged: false,
            tasks_done: 0,
            refused: 0,
            states: 0,
        };
        for number in 1..=TASKS {
            trial.edit(number);
        }
        trial
    }

    /// Puts a random task into the table; what runs is not touched by it.
    fn edit(&mut self, number: usize) {
        let random = &mut self.random;
        let speed = random.between(5.0, 2500.0);
        let ramp = random.between(500.0, 60_000.0);
        let reach = if random.one_in(4) { 25.0 } else { 6.0 };
        let turns = random.between(-reach, reach);
        let kind = [0, 0, 0, 1, 3, 7][random.below(6) as usize];
        // Forwards only, so that every chain has an end.
        let next = number as u64 + 1 + random.below(2);
        let follow = [0b00000, 0b00001, 0b00111, 0b10000, 0b11000][random.below(5) as usize];
        let chain = next <= TASKS as u64 && random.one_in(2);
        let smooth = if random.one_in(4) { 0x400 } else { 0 };
        let control = kind | i64::from(chain) << 4 | follow << 5 | smooth;
        self.bench.write("MT.MTNEXT", next.min(TASKS as u64) as i64);
        self.bench.write("MT.TNEXT", self.random.below(80) as i64);
        self.bench.task(number as i64, turns, speed, ramp, control);
        self.table[number] = self.table[number].or(Bound { speed, ramp });
    }

    fn fill_mdi(&mut self) {
        let random = &mut self.random;
        let speed = if random.one_in(20) {
            0.0
        } else {
            random.between(5.0, 2800.0)
        };
        let steps = if random.one_in(20) {
            0
        } else {
            1 + random.below(70) as i64
        };
        let turns = random.between(-18.0, 18.0);
        let absolute = random.one_in(2);
        self.bench.mdi(turns, speed, steps, absolute);
        self.steepest = 0.0;
        self.mdi_sent = Bound {
            speed: speed + 0.001,
            ramp: steps as f64 * 763.0,
        };
    }

    fn here(&self) -> String {
        format!(
            "seed {} at {} ms, STW1 {:04X}, ZSW1 {:04X}, {:?} {:?}, {:.4} rev, {:.1} rpm, limits {:?}: {:?}",
            self.seed,
            (self.bench.now - profinet::Instant::ZERO).as_millis(),
            self.word,
            self.bench.status(),
            self.bench.drive.state(),
            self.bench.drive.positioning.state(),
            self.bench.turns(),
            self.bench.pace(),
            self.limits,
            self.bench.drive.positioning.run,
        )
    }

    /// What the movement of this cycle may do, by what the drive says it does: speed and ramp that were set for it.
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
            // A ramp of 0 is no ramp: it goes on as before.
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
    fn cycle(&mut self, outputs: bool) {
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
        self.states |= place.map_or(0, |place| 1 << place);

        // The status word tells the truth.
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
            self.refused += 1;
        }
        if has(12) && !ack && number == 0x8000 {
            self.mdi = self.mdi_sent;
        }
        self.acknowledged = has(12);

        // Speed and ramps are those that were set.
        let pace = axis.trajectory_speed();
        let bound = self.bound();
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
            assert!(
                axis.speed().abs() <= most.speed.max(self.pace.abs()) * 1.02 + 20.0,
                "{} {most:?} {}",
                axis.speed(),
                self.here()
            );
        }
        self.pace = pace;
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
    }

    /// Some cycles with a control word.
    fn send(&mut self, word: u16, milliseconds: u64) {
        self.word = word;
        let end = self.bench.now + Duration::from_millis(milliseconds);
        self.cycle(true);
        while self.bench.now < end {
            self.cycle(true);
        }
    }

    /// Back to S4 from wherever it is.
    fn enable(&mut self) {
        // Nothing pulls an axis that nobody holds.
        self.bench.drive.set_load(0.0);
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
    fn home(&mut self, abort: bool) {
        self.word = READY & !0x10;
        self.send(self.word, 4);
        while self.bench.status() & 0x2000 == 0 {
            self.cycle(true);
        }
        self.send(READY, 4);
        let mode = [0, 7, 11, 13, 15][self.random.below(if abort { 3 } else { 5 }) as usize];
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

    /// Asks for a task, by SATZANW or by MDI.
    fn start(&mut self) {
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

    fn intervene(&mut self) {
        let time = self.random.below(300);
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

    /// Nothing interferes any more: each task that runs comes to its target, or tells why not.
    fn finish(&mut self) {
        self.bench.drive.set_load(0.0);
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
        let told = self.bench.read("DRV.MOTIONSTAT") & 0x2400 != 0 && status & 0x80 != 0;
        if had_task && !told {
            assert!(status & 0x0400 != 0, "not reached, no reason: {}", self.here());
            self.tasks_done += 1;
        }
    }
}

/// Tasks that came to their target, tasks that were refused, states that were seen.
fn trial(seed: u64) -> (u32, u32, u32) {
    let mut trial = Trial::new(seed);
    trial.enable();
    trial.home(false);
    for _ in 0..30 {
        trial.intervene();
    }
    trial.start();
    trial.finish();
    (trial.tasks_done, trial.refused, trial.states)
}

fn trials(seeds: core::ops::Range<u64>) {
    let (mut done, mut refused, mut states) = (0, 0, 0);
    for seed in seeds.clone() {
        let outcome = std::panic::catch_unwind(|| trial(seed));
        match outcome {
            Ok((one, other, seen)) => {
                done += one;
                refused += other;
                states |= seen;
            }
            Err(cause) => {
                eprintln!("seed {seed} fails");
                std::panic::resume_unwind(cause);
            }
        }
    }
    let count = (seeds.end - seeds.start) as u32;
    assert!(
        done > count / 4,
        "too few tasks came to an end: {done} of {count}"
    );
    assert!(refused > count, "too few tasks were refused: {refused}");
    assert_eq!(
        states,
        (1 << PositionState::ALL.len()) - 1,
        "a state was never seen"
    );
}

#[test]
fn a_thousand_seeds_first_quarter() {
    trials(0..250);
}

#[test]
fn a_thousand_seeds_second_quarter() {
    trials(250..500);
}

#[test]
fn a_thousand_seeds_third_quarter() {
    trials(500..750);
}

#[test]
fn a_thousand_seeds_fourth_quarter() {
    trials(750..1000);
}
