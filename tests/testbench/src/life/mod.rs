//! The life of some drives, their network and their clients, in virtual time: frames that are lost, doubled and overtaken,
//! cables that are pulled, clients that are killed or frozen, disks that are full, power that goes while a save is under way.
//! The same seed gives the same life. What must be true is compared with the drives themselves, after each step and after
//! each call of a client:
//!
//! - a value that was read is one that this parameter of this drive had meanwhile: no answer reaches another request;
//! - a value that is reported as written was there, one that is reported as saved survives the loss of power;
//! - what a drive finds after the loss of power is what was saved last or what was just being saved, never a mixture;
//! - a connection ends within its watchdog when the controller is away;
//! - no axis turns faster than it was ever commanded to, and none turns before it was commanded to;
//! - an axis without a controller comes to rest where its settings say so;
//! - what is reported as at rest is at rest;
//! - when all is repaired, everything can be read again.
//!
//! That its memory is bounded is measured around it ([`MOST_MEMORY`]).

mod accident;
mod caller;
mod drives;
mod state;
mod wire;

use std::fmt;
use std::ops::AddAssign;
use std::time::Duration;

use client::WriteMode;
use profinet::{Instant, MacAddress};

use crate::shared::Shared;
use caller::Caller;
use drives::drive_of;
use state::State;
use wire::Life;

const SECOND: Duration = Duration::from_secs(1);
const CLIENT: MacAddress = MacAddress([2, 0, 0, 0, 1, 0]);
/// All axes are commanded to turn at this, rpm.
const SPEED: f64 = 600.0;
/// A controlled speed may exceed its setpoint by so much for a moment.
const OVERSHOOT: f64 = 1.1;
/// A connection may end so much later than its watchdog: frames under way, and the next look.
const LATE: Duration = Duration::from_millis(60);
/// From the last accident until a call has to succeed.
const SETTLED: Duration = Duration::from_secs(8);
/// How long an axis may need to come to rest without anybody.
const COASTING: Duration = Duration::from_secs(60);
/// Values that a pair of parameters gets, in steps of the drive.
const LOWEST: i64 = 100;
const HIGHEST: i64 = 30_000;

/// Most memory that a life takes, octets: a plant of three drives, two clients, and all frames under way. Whoever lives it measures.
pub const MOST_MEMORY: i64 = 8 << 20;
/// What a life may leave, octets: tables that are made once.
pub const LEFT: i64 = 64 << 10;

/// Something was not as it must be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken {
    /// Repeats it.
    pub seed: u64,
    /// Virtual time.
    pub at: Instant,
    /// What was expected, and what was there.
    pub what: String,
    /// What happened before.
    pub story: Vec<String>,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in &self.story {
            writeln!(f, "{line}")?;
        }
        let at = self.at - Instant::ZERO;
        write!(f, "seed {} at {at:?}: {}", self.seed, self.what)
    }
}

/// What happened in some lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Virtual time.
    pub time: Duration,
    /// Calls of clients that succeeded.
    pub answered: u64,
    /// Calls that failed.
    pub failed: u64,
    /// Motions that ended as they should.
    pub motions: u64,
    /// Saves that reached the disk.
    pub saves: u64,
    /// Accidents of all kinds.
    pub accidents: u64,
    /// Clients that were killed.
    pub kills: u64,
    /// Drives that lost their power.
    pub power_cuts: u64,
    /// Cyclic connections that ended.
    pub connections: u64,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.time += other.time;
        self.answered += other.answered;
        self.failed += other.failed;
        self.motions += other.motions;
        self.saves += other.saves;
        self.accidents += other.accidents;
        self.kills += other.kills;
        self.power_cuts += other.power_cuts;
        self.connections += other.connections;
    }
}

/// Lives through everything that this seed brings.
///
/// # Errors
/// What was not as it must be.
pub fn live(seed: u64) -> Result<Tally, Broken> {
    let life = Life(Shared::new(State::new(seed)));
    let count = life.0.borrow().places.len();
    let none = || vec![None; count];
    let clients = 1 + life.below(3) as u64;
    for number in 0..clients {
        life.0.borrow_mut().plan();
        let network = life.client(number);
        let mut caller = Caller {
            life: &life,
            network,
            drives: none(),
        };
        for _ in 0..3 + life.below(5) {
            caller.act();
            let state = life.0.borrow();
            if state.killed || state.broken.is_some() {
                break;
            }
        }
        drop(caller);
        life.pass(life.time(SECOND * 3));
    }
    // all is repaired, and no client is there
    life.pass(SECOND * 20);
    let stops = |place: usize| {
        let mut state = life.0.borrow_mut();
        let kind = state.places[place].kind;
        state
            .station(place)
            .is_some_and(|station| kind.stops(drive_of(station)))
    };
    let stopping: Vec<usize> = (0..count).filter(|place| stops(*place)).collect();
    life.pass(COASTING);
    let network = life.client(clients);
    let mut caller = Caller {
        life: &life,
        network,
        drives: none(),
    };
    for place in stopping {
        caller.rests(place, "a minute without a controller");
    }
    life.0.borrow_mut().well = Instant::ZERO;
    caller.read();
    for place in 0..count {
        caller.write(place, WriteMode::Save);
    }
    caller.read();
    drop(caller);
    let mut state = life.0.borrow_mut();
    state.tally.time = state.now() - Instant::ZERO;
    match state.broken.take() {
        Some(broken) => Err(broken),
        None => Ok(state.tally),
    }
}
