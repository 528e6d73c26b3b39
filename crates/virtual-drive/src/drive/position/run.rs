//! A task on its way: where it leads, if it can run, and what follows it.

use super::limits::{COUNTS, Limits, brake_way};
use super::task::{Follow, Kind, Refusal, Task, Tasks};
use super::{Seen, Setup};

/// A task with its target worked out. Positions are unwrapped ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Leg {
    /// As in AKTSATZ: the number of the task, only bit 15 for MDI.
    pub number: u16,
    pub task: Task,
    pub target: i64,
    /// rpm, within the limits of the drive.
    pub speed: f64,
    pub smooth: bool,
}

/// Where a task starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Start {
    /// PL.CMD and PL.FB.
    pub command: i64,
    pub feedback: i64,
    /// Target of the task before.
    pub target: i64,
    /// Where the axis would stand if it braked now along the ramp of the task.
    pub rest: i64,
}

impl Leg {
    /// Works out a task.
    ///
    /// # Errors
    /// When it cannot run: the reason.
    pub fn plan(
        number: u16,
        task: Task,
        start: &Start,
        seen: &Seen,
        setup: &Setup,
        limits: &Limits,
    ) -> Result<Self, Refusal> {
        if task.is_empty() {
            return Err(Refusal::Values);
        }
        let smooth = task.is_smooth()?;
        task.follow()?;
        let from = |place: i64| place.checked_add(task.position).ok_or(Refusal::Range);
        let target = match task.kind()? {
            Kind::Absolute => match setup.modulo {
                None => task.position,
                Some(modulo) if modulo.contains(task.position) => modulo.target(start.command, task.position),
                Some(_) => return Err(Refusal::Range),
            },
            Kind::FromCommand => from(start.command)?,
            Kind::FromTarget => from(start.target)?,
            Kind::FromFeedback => from(start.feedback)?,
        };
        if !limits.contains(target) {
            return Err(Refusal::Range);
        }
        if limits.is_left(start.command, start.rest) {
            return Err(Refusal::TooFast);
        }
        let way = target.wrapping_sub(start.command).signum();
        if seen.is_limited(way) {
            return Err(Refusal::Switch);
        }
        Ok(Self {
            number,
            task,
            target,
            speed: task.speed.min(setup.fastest(way)),
            smooth,
        })
    }

    /// Returns true when the limits of the drive are below the speed of the task.
    pub fn is_slowed(&self) -> bool {
        self.speed < self.task.speed
    }

    /// Direction in which the target lies.
    pub const fn way_from(&self, position: i64) -> i64 {
        self.target.wrapping_sub(position).signum()
    }
}

/// What comes after the running task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) enum Next {
    /// Nothing.
    End,
    /// This task, fetched from the table when the running one began.
    Task { number: u8, task: Task, follow: Follow },
    /// A task that cannot run.
    Impossible,
}

/// The wait between two tasks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Wait {
    follow: Follow,
    /// s
    left: f64,
    event: bool,
}

impl Wait {
    pub fn new(follow: Follow, dwell: u16) -> Self {
        Self {
            follow,
            left: f64::from(dwell) / 1000.0,
            event: false,
        }
    }

    /// It is over by an event, or not without one.
    pub const fn needs_event(&self) -> bool {
        matches!(
            self.follow,
            Follow::Event | Follow::DwellAndEvent | Follow::DwellOrEvent
        )
    }

    /// Advances the time; returns true when the wait is over.
    pub fn step(&mut self, seconds: f64, event: bool) -> bool {
        self.left -= seconds;
        self.event |= event;
        // A wait of n milliseconds is over after n of them, whatever the last digit.
        let dwelt = self.left < 1.0e-9;
        match self.follow {
            Follow::AtOnce | Follow::PresentSpeed | Follow::NextSpeed => true,
            Follow::Dwell => dwelt,
            Follow::Event => self.event,
            Follow::DwellAndEvent => dwelt && self.event,
            Follow::DwellOrEvent => dwelt || self.event,
        }
    }
}

/// The running chain of tasks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Run {
    pub leg: Leg,
    pub next: Next,
    /// Direction of the leg.
    pub way: i64,
    /// Speed at the target, rpm; 0 stops there.
    pub end_speed: f64,
    /// Its command was not given to the axis yet.
    pub fresh: bool,
    pub wait: Option<Wait>,
    /// It accelerates already for the next task.
    pub hurried: bool,
}

impl Run {
    /// Begins with a leg at a commanded position; fetches what follows it.
    pub fn new(leg: Leg, command: i64, tasks: &Tasks, seen: &Seen, setup: &Setup, limits: &Limits) -> Self {
        let next = match leg.task.follow() {
            Ok(None) => Next::End,
            Ok(Some((number, follow))) => match tasks.task(usize::from(number)) {
                Ok(task) if number != 0 => Next::Task { number, task, follow },
                _ => Next::Impossible,
            },
            Err(_) => Next::Impossible,
        };
        let mut run = Self {
            leg,
            next,
            way: leg.way_from(command),
            end_speed: 0.0,
            fresh: true,
            wait: None,
            hurried: false,
        };
        run.end_speed = run.passing_speed(seen, setup, limits);
        run
    }

    /// Speed at which the target is passed: that of the kind of change, if the next task goes on in the same direction
    /// and both could still brake inside the limits; else 0. Tasks with s-curves stop at their targets.
    fn passing_speed(&self, seen: &Seen, setup: &Setup, limits: &Limits) -> f64 {
        let Next::Task { number, task, follow } = self.next else {
            return 0.0;
        };
        let place = self.leg.target;
        let at_target = Start {
            command: place,
            feedback: place,
            target: place,
            rest: place,
        };
        let next = Leg::plan(u16::from(number), task, &at_target, seen, setup, limits);
        let Ok(next) = next else { return 0.0 };
        if self.way == 0 || next.way_from(place) != self.way || self.leg.smooth || next.smooth {
            return 0.0;
        }
        let wanted = match follow {
            Follow::PresentSpeed => self.leg.speed,
            Follow::NextSpeed => next.speed,
            _ => return 0.0,
        };
        // Not faster than the next task can stop from.
        let room = next.target.wrapping_sub(place).unsigned_abs() as f64 / COUNTS;
        let speed = wanted.min((2.0 * task.deceleration * room).sqrt());
        let ramp = task.deceleration.min(self.leg.task.deceleration);
        let rest = place.saturating_add(brake_way(speed, ramp).saturating_mul(self.way));
        if limits.is_left(place, rest) { 0.0 } else { speed }
    }

    /// Returns true when [`pace`](Self::pace) gives the same all the way.
    pub fn has_one_pace(&self) -> bool {
        !matches!(self.next, Next::Task { .. }) || self.hurried || self.end_speed <= self.leg.speed
    }

    /// Speed and acceleration that apply now, with `command` as the commanded position: those of the task, or of the
    /// next one when its speed has to be there already at the target.
    pub fn pace(&mut self, command: i64) -> (f64, f64) {
        let own = (self.leg.speed, self.leg.task.acceleration);
        let Next::Task { task, .. } = self.next else {
            return own;
        };
        let (end, speed) = (self.end_speed, self.leg.speed);
        if end <= speed {
            return own;
        }
        let left = self.leg.target.wrapping_sub(command).unsigned_abs() as f64 / COUNTS;
        self.hurried |= 2.0 * task.acceleration * left <= end * end - speed * speed;
        if self.hurried {
            (end, task.acceleration)
        } else {
            own
        }
    }
}
