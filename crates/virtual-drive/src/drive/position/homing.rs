//! Homing: finds the place that positions count from.
//!
//! A mode is a row of [`MODES`]: what is searched, and what the reference is then. Source of the modes: AKD HOME.MODE
//! as `data/akd/meanings.csv` has it; the order of the movements of a mode is ours where no source states it, as said
//! at each step.

use super::{Seen, stop};
use crate::axis::{Command, Inputs, Latch, Ramps};

/// What homing goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct HomeSetup {
    /// HOME.MODE.
    pub mode: i64,
    /// HOME.V, rpm.
    pub speed: f64,
    /// HOME.ACC and HOME.DEC, rpm/s.
    pub ramps: Ramps,
    /// HOME.DIR 1.
    pub positive: bool,
    /// HOME.FEEDRATE as a part of one: the speed while an index is looked for.
    pub feedrate: f64,
    /// HOME.IPEAK, A; none when it is 0.
    pub current: Option<f64>,
    /// HOME.P: the value of the home point.
    pub position: i64,
    /// HOME.DIST: an extra move behind the home point.
    pub distance: i64,
    /// HOME.PERRTHRESH: following error that counts as hard stop.
    pub stop_error: i64,
    /// HOME.MAXDIST; none when it is 0.
    pub farthest: Option<i64>,
    /// HOME.AUTOMOVE is not 0.
    pub automatic: bool,
}

/// What is searched first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Search {
    Nothing,
    /// The limit switch in the direction of homing; the reference is where it lets go again.
    Limit,
    /// The edge of the home switch that is met in the direction of homing; limit switches turn the axis round.
    Switch,
    /// The same, and hard stops turn it round too.
    SwitchBetweenStops,
    /// A hard stop.
    Stop,
}

/// What the reference is after the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reference {
    /// The place that was found.
    Here,
    /// The next zero angle of the feedback behind it.
    NextZero,
    /// The nearest zero angle of the feedback.
    NearestZero,
    /// The next index pulse behind it.
    Index,
    /// Zero of the feedback, wherever the axis is: nothing moves.
    Feedback,
}

use Reference::{Feedback, Here, Index, NearestZero, NextZero};

/// Each mode of HOME.MODE that a source describes. 14 is not here: its meaning on this drive was not found.
const MODES: &[(i64, Search, Reference)] = &[
    (0, Search::Nothing, Here),
    (1, Search::Limit, Here),
    (2, Search::Limit, NextZero),
    (3, Search::Limit, Index),
    (4, Search::Switch, Here),
    (5, Search::Switch, NextZero),
    (6, Search::Switch, Index),
    (7, Search::Nothing, NearestZero),
    (8, Search::Stop, Here),
    (9, Search::Stop, NextZero),
    (10, Search::Stop, Index),
    (11, Search::Nothing, Index),
    (12, Search::SwitchBetweenStops, Here),
    (13, Search::Nothing, Feedback),
    (15, Search::Nothing, NextZero),
];

/// Returns true for a mode that can be carried out.
pub(in crate::drive) fn is_known(mode: i64) -> bool {
    MODES.iter().any(|(known, ..)| *known == mode)
}

/// One revolution.
const TURN: i64 = 1 << 32;

/// Way without an index pulse after which there is none: a revolution and a quarter.
const NO_INDEX: i64 = TURN + TURN / 4;

/// AKD warnings: homing failed; reference switch not found; index pulse not found.
const FAILED: u16 = 161;
const NO_SWITCH: u16 = 158;
const NO_PULSE: u16 = 157;

/// What homing is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Stands on the home switch: leaves it against the direction of homing.
    Leave,
    /// Goes in the direction of homing until it meets what is searched.
    Search,
    /// Has met a limit: goes back behind the home switch; true once it has seen it.
    Turn(bool),
    /// Leaves the limit switch.
    BackOff,
    /// Goes on to the index pulse.
    Seek,
    /// Goes to the reference.
    Approach,
    /// Makes the extra move.
    Distance,
}

/// A homing that runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Homing {
    search: Search,
    reference: Reference,
    phase: Phase,
    /// The phase has just begun: its command was not given yet.
    fresh: bool,
    /// Direction of the movement, 1 or -1, and that of homing.
    way: i64,
    direction: i64,
    /// Where homing began, and where the present phase did.
    start: i64,
    begin: i64,
    /// What the latches had counted when the present phase began.
    before: Inputs,
    /// Where the phases that end at a place end.
    target: i64,
    /// The axis presses against a hard stop; taken by the owner, who lets it go.
    pressed: bool,
    /// The place that is the reference; taken by the owner, who gives it its number.
    found: Option<i64>,
    /// All movements are done.
    pub finished: bool,
    /// The warning with the cause when homing cannot continue.
    pub failure: Option<u16>,
}

impl Homing {
    /// Begins; none for a mode that does not exist.
    pub fn new(setup: &HomeSetup, seen: &Seen) -> Option<Self> {
        let (_, search, reference) = *MODES.iter().find(|(mode, ..)| *mode == setup.mode)?;
        let direction = if setup.positive { 1 } else { -1 };
        let mut homing = Self {
            search,
            reference,
            phase: Phase::Search,
            fresh: true,
            way: direction,
            direction,
            start: seen.command,
            begin: seen.command,
            before: seen.inputs,
            target: seen.command,
            pressed: false,
            found: None,
            finished: false,
            failure: None,
        };
        match search {
            Search::Nothing => homing.refer(setup, seen, seen.command, direction),
            Search::Limit if seen.is_limited(direction) => homing.begin(Phase::BackOff, -direction, seen),
            Search::Switch | Search::SwitchBetweenStops if seen.inputs.home_switch => {
                homing.begin(Phase::Leave, -direction, seen);
            }
            _ => homing.begin(Phase::Search, direction, seen),
        }
        Some(homing)
    }

    fn begin(&mut self, phase: Phase, way: i64, seen: &Seen) {
        self.phase = phase;
        self.way = way;
        self.begin = seen.position;
        self.before = seen.inputs;
        self.fresh = true;
    }

    /// The search has ended at `place`; goes on in direction `way`.
    fn refer(&mut self, setup: &HomeSetup, seen: &Seen, place: i64, way: i64) {
        // Zero angles lie where the feedback has whole turns.
        let zero = |turns: i64| (turns << 32).wrapping_add(seen.shift);
        let angle = place.wrapping_sub(seen.shift);
        match self.reference {
            Here if self.search == Search::Nothing => self.arrive(setup, seen, place),
            Here => self.approach(place, seen),
            Feedback => self.arrive(setup, seen, seen.shift),
            NextZero if way > 0 => self.approach(zero(angle.wrapping_add(TURN - 1) >> 32), seen),
            NextZero => self.approach(zero(angle >> 32), seen),
            NearestZero => self.approach(zero(angle.wrapping_add(TURN / 2) >> 32), seen),
            Index => self.begin(Phase::Seek, way, seen),
        }
    }

    fn approach(&mut self, place: i64, seen: &Seen) {
        self.begin(Phase::Approach, place.wrapping_sub(seen.command).signum(), seen);
        self.target = place;
    }

    /// The reference is `place`; an extra move behind it is to be made.
    fn arrive(&mut self, setup: &HomeSetup, seen: &Seen, place: i64) {
        self.found = Some(place);
        self.begin(Phase::Distance, setup.distance.signum(), seen);
        self.target = seen.command.wrapping_add(setup.distance);
        self.finished = setup.distance == 0;
    }

    /// Returns the place of the reference, once when it is found; from then on its number is `number`, and the numbers
    /// of all other places have changed with it.
    pub fn take_reference(&mut self, number: i64) -> Option<i64> {
        let by = number.wrapping_sub(self.found?);
        for place in [&mut self.start, &mut self.begin, &mut self.target] {
            *place = place.wrapping_add(by);
        }
        self.found.take()
    }

    /// Returns true once when a hard stop has been met. The command went on behind it and is to come back to the axis:
    /// else that would press, with all the current it may once homing is over. No source states what holds after
    /// homing.
    pub const fn take_pressed(&mut self) -> bool {
        core::mem::replace(&mut self.pressed, false)
    }

    /// One step of the axis: what it has to do.
    pub fn step(&mut self, setup: &HomeSetup, seen: &Seen) -> Command {
        if !self.finished && self.failure.is_none() {
            self.go_on(setup, seen);
            let gone = seen.position.wrapping_sub(self.start).unsigned_abs();
            let too_far = setup.farthest.is_some_and(|most| gone > most.unsigned_abs());
            if too_far && self.phase != Phase::Distance {
                self.failure = Some(FAILED);
            }
        }
        self.command(setup)
    }

    /// Returns the command for the axis in the present phase.
    pub fn command(&mut self, setup: &HomeSetup) -> Command {
        self.fresh = false;
        let slow = self.phase == Phase::Seek || (self.phase == Phase::Approach && self.reference == Index);
        let speed = if slow {
            setup.speed * setup.feedrate
        } else {
            setup.speed
        };
        let ramps = setup.ramps;
        match self.phase {
            _ if self.failure.is_some() => stop(ramps),
            Phase::Approach | Phase::Distance => Command::Position {
                target: self.target,
                speed,
                ramps,
                smooth: false,
                end_speed: 0.0,
            },
            _ => Command::Travel {
                speed: speed * self.way as f64,
                ramps,
                smooth: false,
            },
        }
    }

    fn go_on(&mut self, setup: &HomeSetup, seen: &Seen) {
        let stops = matches!(self.search, Search::Stop | Search::SwitchBetweenStops);
        let blocked = stops && seen.following.saturating_mul(self.way) > setup.stop_error;
        let limited = seen.is_limited(self.way);
        let turns = limited || blocked;
        self.pressed = blocked && self.is_gentle();
        let (home, before) = (seen.inputs.home_switch, self.before);
        // A latch is more precise than the present position.
        let edge = |now: Latch, before: Latch| {
            if now.count == before.count {
                seen.position
            } else {
                now.position
            }
        };
        match self.phase {
            Phase::Leave if !home => self.begin(Phase::Search, self.direction, seen),
            Phase::Search if self.search == Search::Limit && limited => {
                self.begin(Phase::BackOff, -self.way, seen);
            }
            Phase::Search if self.search == Search::Limit => {}
            Phase::Search if self.search == Search::Stop => {
                if blocked {
                    self.refer(setup, seen, seen.position, -self.way);
                } else if limited {
                    self.failure = Some(FAILED);
                }
            }
            Phase::Search if home => {
                let place = edge(seen.inputs.home_edge, before.home_edge);
                self.refer(setup, seen, place, self.way);
            }
            Phase::Search if turns => self.begin(Phase::Turn(false), -self.direction, seen),
            Phase::Turn(false) if home => self.phase = Phase::Turn(true),
            Phase::Turn(true) if !home => self.begin(Phase::Search, self.direction, seen),
            Phase::Leave | Phase::Turn(_) if turns => self.failure = Some(NO_SWITCH),
            Phase::BackOff if !seen.is_limited(-self.way) => {
                let place = if self.way > 0 {
                    edge(seen.inputs.negative_edge, before.negative_edge)
                } else {
                    edge(seen.inputs.positive_edge, before.positive_edge)
                };
                self.refer(setup, seen, place, self.way);
            }
            Phase::Seek if seen.inputs.index.count != before.index.count => {
                self.approach(seen.inputs.index.position, seen);
            }
            Phase::Seek
                if seen.position.wrapping_sub(self.begin).unsigned_abs() > NO_INDEX.unsigned_abs() =>
            {
                self.failure = Some(NO_PULSE);
            }
            Phase::Approach if !self.fresh && seen.done && seen.standing => {
                self.arrive(setup, seen, self.target);
            }
            Phase::Distance if !self.fresh && seen.done && seen.standing => self.finished = true,
            Phase::Seek | Phase::Approach | Phase::Distance if limited => self.failure = Some(FAILED),
            _ => {}
        }
    }

    /// Returns true while the current is to be limited, so that a hard stop is met gently.
    pub const fn is_gentle(&self) -> bool {
        matches!(self.search, Search::Stop | Search::SwitchBetweenStops)
            && matches!(self.phase, Phase::Search | Phase::Leave | Phase::Turn(_))
    }
}
