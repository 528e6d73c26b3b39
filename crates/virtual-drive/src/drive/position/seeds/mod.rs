//! Random task lists and random interventions in virtual time: a thousand seeds.
//!
//! In every cycle the axis keeps to its limits, to the speeds and ramps that were set, and the status word is compared
//! with what the axis really does. In the end each task has come to its target, or there is a reason that is reported.

use core::time::Duration;

use profile::state::PositionState;

use super::tests::{Bench, READY};
use crate::axis::{Plant, Travel};
use crate::model::AKD;

mod claims;
mod deeds;

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

/// What is special about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Life {
    /// Nothing.
    Plain,
    /// Limit switches along the way.
    Switches,
    /// Something holds it now and then.
    Blocked,
    /// It turns round and round, with this many revolutions in a round.
    Modulo(f64),
}

/// PL.ERRFTHRESH of an axis that is held, in revolutions, and what one cycle may add.
const THRESHOLD: f64 = 0.25;
const FOLLOWING: f64 = THRESHOLD + 2800.0 / 60.0 * 0.016;

/// What happened in a life, or in many.
#[derive(Debug, Clone, Copy, Default)]
struct Outcome {
    /// Tasks that came to their target at the end of a life.
    done: u32,
    /// Tasks that were refused.
    refused: u32,
    /// States that were seen, by place in `PositionState::ALL`.
    states: u32,
    /// How often an axis that was held ended in a fault.
    stuck: u32,
    /// Cycles in which the reference was on its way into a limit switch.
    limited: u32,
}

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
    /// The power stage went off while the axis turned: limit violations while it coasts are not counted until it is
    /// inside again.
    excused: bool,
    /// Where the reference was without a movement, in revolutions.
    rest: f64,
    /// What the ramp of real-time jogging had to be made.
    steepest: f64,
    word: u16,
    acknowledged: bool,
    seen: Outcome,
    life: Life,
    /// Something holds the axis, or did and it still hurries after its reference.
    held: bool,
    /// Limit switches of the last cycle.
    touched: (bool, bool),
}

impl Trial {
    fn new(seed: u64, life: Life) -> Self {
        let mut random = Random(seed);
        let mut bench = match life {
            Life::Switches => {
                let place = |turns: f64| (turns * 4_294_967_296.0) as i64;
                Bench::with(
                    9,
                    Plant {
                        travel: Some(Travel {
                            negative_switch: place(-random.between(2.0, 8.0)),
                            positive_switch: place(random.between(2.0, 8.0)),
                            ..Travel::FREE
                        }),
                        ..AKD.plant
                    },
                )
            }
            _ => Bench::new(9),
        };
        match life {
            Life::Blocked => bench.write("PL.ERRFTHRESH", (THRESHOLD * 65_536.0) as i64),
            Life::Modulo(turns) => {
                bench.write("PL.MODP2", (turns * 65_536.0) as i64);
                bench.write("PL.MODPDIR", random.below(4) as i64);
                bench.write("PL.MODPEN", 1);
            }
            Life::Plain | Life::Switches => {}
        }
        bench.cycle = Duration::from_millis([1, 2, 4, 16][random.below(4) as usize]);
        let limits = (-random.between(1.0, 15.0), random.between(1.0, 15.0));
        let enabled = match life {
            // A round axis has no ends.
            Life::Modulo(_) => 0,
            _ => random.below(4) as i64,
        };
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
            seen: Outcome::default(),
            life,
            held: false,
            touched: (false, false),
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
}

fn trial(seed: u64, life: Life) -> Outcome {
    let mut trial = Trial::new(seed, life);
    trial.enable();
    trial.home(false);
    for _ in 0..30 {
        trial.intervene();
    }
    trial.start();
    trial.finish();
    trial.seen
}

fn trials(seeds: core::ops::Range<u64>, life: fn(u64) -> Life) -> Outcome {
    let mut all = Outcome::default();
    for seed in seeds.clone() {
        match std::panic::catch_unwind(|| trial(seed, life(seed))) {
            Ok(one) => {
                all.done += one.done;
                all.refused += one.refused;
                all.states |= one.states;
                all.stuck += one.stuck;
                all.limited += one.limited;
            }
            Err(cause) => {
                eprintln!("seed {seed} fails");
                std::panic::resume_unwind(cause);
            }
        }
    }
    let count = (seeds.end - seeds.start) as u32;
    assert!(all.done > count / 6, "too few tasks came to an end: {all:?}");
    assert!(all.refused > count, "too few tasks were refused: {all:?}");
    let every = (1 << PositionState::ALL.len()) - 1;
    assert_eq!(all.states, every, "a state was never seen");
    all
}

#[test]
fn a_thousand_seeds_first_quarter() {
    trials(0..250, |_| Life::Plain);
}

#[test]
fn a_thousand_seeds_second_quarter() {
    trials(250..500, |_| Life::Plain);
}

#[test]
fn a_thousand_seeds_third_quarter() {
    trials(500..750, |_| Life::Plain);
}

#[test]
fn a_thousand_seeds_fourth_quarter() {
    trials(750..1000, |_| Life::Plain);
}

#[test]
fn limit_switches_along_the_way() {
    let all = trials(1000..1200, |_| Life::Switches);
    assert!(all.limited > 500, "{all:?}");
}

#[test]
fn held_now_and_then() {
    let all = trials(1200..1400, |_| Life::Blocked);
    assert!(all.stuck > 50, "{all:?}");
}

#[test]
fn round_and_round() {
    trials(1400..1600, |seed| Life::Modulo(1.0 + (seed % 13) as f64 * 0.75));
}
