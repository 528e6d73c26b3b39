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
        let begin = self.now();
        let expectation = goal.within(timeout, begin - Instant::ZERO);
        let monitor = Monitor::new(&[expectation], self.drives.len(), self.seed);
        let watchers = self.shown(Watchers {
            goal: Some(Box::new(monitor)),
            ..Watchers::default()
        });
        self.watchers.goal = watchers.goal;
        let name = self.drives.get(goal.drive()).map(|seat| seat.name.clone());
        let name = name.unwrap_or_default();
        let mut newest = None;
        let mut record = |event: Event| {
            if event.drive == name && goal.is_reported_by(&event.kind) {
                newest = Some(event.clone());
            }
            record(event);
        };
        let end = begin + timeout + goal.lasts();
        let decided = |world: &Self| {
            let goal = world.watchers.goal.as_ref();
            goal.is_none_or(|goal| goal.is_decided())
        };
        while !decided(self) && self.now() < end {
            let next = self.next_event().max(self.now()).min(end);
            self.run_until(next, &mut record);
        }
        let now = self.now();
        let monitor = self.watchers.goal.take();
        let results = monitor.map(|monitor| monitor.finish(now - Instant::ZERO, |_| &name));
        // a goal has one drive, so one result
        if let Some(lost) = results.into_iter().flatten().find(|result| !result.is_met()) {
            return Err(NotMet(Box::new(lost)));
        }
        let became = now - Instant::ZERO - goal.lasts();
        Ok(newest
            .filter(|event| Duration::from_nanos(event.time_ns) >= became)
            .unwrap_or_else(|| self.sample_of(goal.drive(), &name)))
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
