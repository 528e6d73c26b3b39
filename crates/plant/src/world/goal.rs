//! A run that goes on until something is true of a drive.

use std::time::Duration;

use profinet::Instant;

use crate::expect::{ExpectationResult, Goal, Monitor};
use crate::trace::{Event, EventKind};

use super::keep::Watchers;
use super::{World, sample};

/// A [`Goal`] was not met in its time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct NotMet(
    /// What there was instead, with the nearest value and the last events of the drive.
    pub Box<ExpectationResult>,
);

/// A goal that a world waits for, until [`World::end_pursuit`].
#[derive(Debug, Clone)]
pub struct Pursuit {
    /// Its number in the world.
    number: u64,
    goal: Goal,
    /// Name of its drive.
    name: String,
    /// When it was looked at last without being decided.
    looked: Instant,
    end: Instant,
}

impl Pursuit {
    /// Returns whether an event of the drive may be the one that reports the goal: a caller that has the events keeps the newest
    /// for [`World::end_pursuit`].
    #[must_use]
    pub fn is_reported_by(&self, event: &Event) -> bool {
        event.drive == self.name && self.goal.is_reported_by(&event.kind)
    }
}

impl World {
    /// Runs until the conditions of a goal hold of its drive, and stops there; at most for `timeout`, the end of it included. Where
    /// the goal has a `for`, they must become true within `timeout` and the run goes on until they were true for that long.
    ///
    /// Returns the event of the drive that reports it, such as [`EventKind::FaultRaised`] for a fault; a sample of that moment
    /// where no event reports it. `record` receives all events.
    ///
    /// ```
    /// use std::time::Duration;
    /// use profidrive_plant::{EventKind, PlantPlan, World};
    /// let plant: PlantPlan = "[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"2s\", do = \"fault=439\" }]".parse()?;
    /// let mut world = World::new(&plant)?;
    /// let fault = plant.goal(r#"{ drive = "akd-1", fault = 439 }"#)?;
    /// let event = world.run_until_met(&fault, Duration::from_secs(5), &mut drop)?;
    /// assert!((2.0..2.1).contains(&event.time));
    /// assert!(matches!(event.kind, EventKind::FaultRaised { .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When they did not hold in time: what there was instead. The world is at the end of that time then.
    pub fn run_until_met(
        &mut self,
        goal: &Goal,
        timeout: Duration,
        record: &mut dyn FnMut(Event),
    ) -> Result<Event, NotMet> {
        let mut pursuit = self.pursue(goal, timeout);
        let reports = pursuit.clone();
        let mut newest = None;
        let mut record = |event: Event| {
            if reports.is_reported_by(&event) {
                newest = Some(event.clone());
            }
            record(event);
        };
        while let Some(time) = self.pursues(&mut pursuit) {
            let next = self.now() + time;
            self.run_until(next, &mut record);
        }
        self.end_pursuit(&pursuit, newest)
    }

    /// Begins to wait for the conditions of a goal, for a caller that lets the time pass itself ([`pursues`](Self::pursues)), beside
    /// others that wait for theirs.
    pub fn pursue(&mut self, goal: &Goal, timeout: Duration) -> Pursuit {
        let begin = self.now();
        let expectation = goal.within(timeout, begin - Instant::ZERO);
        let monitor = Monitor::new(&[expectation], self.drives.len(), self.seed);
        let number = self.watchers.next_goal;
        self.watchers.next_goal += 1;
        let watchers = self.shown(Watchers {
            goals: vec![(number, monitor)],
            ..Watchers::default()
        });
        self.watchers.goals.extend(watchers.goals);
        let name = self.drives.get(goal.drive()).map(|seat| seat.name.clone());
        Pursuit {
            number,
            goal: goal.clone(),
            name: name.unwrap_or_default(),
            looked: begin,
            end: begin + timeout + goal.lasts(),
        }
    }

    /// Returns how long nothing happens yet; `None` once it is decided whether the goal is met.
    #[must_use]
    pub fn pursues(&self, pursuit: &mut Pursuit) -> Option<Duration> {
        let mut goals = self.watchers.goals.iter();
        let own = goals.find(|(number, _)| *number == pursuit.number);
        let decided = own.is_none_or(|(_, goal)| goal.is_decided());
        if decided || self.now() >= pursuit.end {
            return None;
        }
        pursuit.looked = self.now();
        Some(self.next_event().max(self.now()).min(pursuit.end) - self.now())
    }

    /// Ends to wait for a goal; returns as [`run_until_met`](Self::run_until_met). `newest` is the newest event that reports it, where the
    /// caller knows it; otherwise it is looked for in the trace that is kept.
    ///
    /// # Errors
    /// As [`run_until_met`](Self::run_until_met), and when it was ended before.
    pub fn end_pursuit(&mut self, pursuit: &Pursuit, newest: Option<Event>) -> Result<Event, NotMet> {
        let Pursuit {
            number,
            goal,
            name,
            looked,
            ..
        } = pursuit;
        let now = self.now() - Instant::ZERO;
        let goals = &mut self.watchers.goals;
        let place = goals.iter().position(|(other, _)| other == number);
        let monitor = place.map(|place| goals.swap_remove(place).1);
        let unseen = || Monitor::new(&[goal.within(Duration::ZERO, now)], self.drives.len(), self.seed);
        let results = monitor.unwrap_or_else(unseen).finish(now, |_| name);
        // a goal has one drive, so one result
        if let Some(lost) = results.into_iter().find(|result| !result.is_met()) {
            return Err(NotMet(Box::new(lost)));
        }
        let kept = || {
            let mut events = self.trace()?.events();
            events.rfind(|event| pursuit.is_reported_by(event)).cloned()
        };
        // it became true since it was looked at last, or as long before as it had to last
        let before = (*looked - Instant::ZERO).saturating_sub(goal.lasts());
        Ok(newest
            .or_else(kept)
            .filter(|event| Duration::from_nanos(event.time_ns) >= before)
            .unwrap_or_else(|| self.sample_of(goal.drive(), name)))
    }

    fn sample_of(&self, drive: usize, name: &str) -> Event {
        let kind = self.drive(drive).map_or_else(
            || EventKind::note(""),
            |station| {
                let drive = station.drive();
                EventKind::Sample(sample(drive.status_word().0, drive))
            },
        );
        Event::at(self.now(), name, kind)
    }
}
