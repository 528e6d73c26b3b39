//! The time line of one drive: what is still to happen to it.

use std::time::Duration;

use profinet::Instant;

use crate::event::{PlantEvent, Unit};
use crate::plan::{Cue, Trigger};

/// Most happenings that one call lets happen; what is left follows with the next one.
const MOST_AT_ONCE: usize = 1000;
/// Most events of one drive that may wait, the ends of those that last among them. Twice what a plant file may have.
pub(crate) const MOST_PENDING: usize = 20_000;

/// What is still to happen to one drive.
///
/// The owner calls [`play`](Self::play) when [`next`](Self::next) is due, and, while
/// [`watches_position`](Self::watches_position), whenever the drive may have moved.
#[derive(Debug, Clone, Default)]
pub struct Timeline {
    pending: Vec<Pending>,
    /// Where the axis was when last looked at.
    place: Option<i64>,
}

#[derive(Debug, Clone, Copy)]
struct Pending {
    when: When,
    lasts: Option<Duration>,
    what: PlantEvent,
    /// Ends something that was to last for a time.
    restores: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum When {
    At(Instant),
    Place(i64),
}

/// Something that has just happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Played {
    /// What.
    pub what: PlantEvent,
    /// Duration; `None` until the next change.
    pub lasts: Option<Duration>,
    /// It ends something that was to last for a time.
    pub restores: bool,
}

impl Timeline {
    /// Returns the time line of a drive that starts at `start`.
    #[must_use]
    pub fn new(cues: &[Cue], start: Instant) -> Self {
        let pending = cues.iter().map(|cue| Pending {
            when: match cue.trigger {
                Trigger::Time(after) => When::At(start + after),
                Trigger::Place(place) => When::Place(place),
            },
            lasts: cue.lasts,
            what: cue.what,
            restores: false,
        });
        Self {
            pending: pending.collect(),
            place: None,
        }
    }

    /// Returns true if so many more events may wait.
    #[must_use]
    pub const fn has_room(&self, more: usize) -> bool {
        more <= MOST_PENDING.saturating_sub(self.pending.len())
    }

    /// Adds something that is to happen now. The caller checks [`has_room`](Self::has_room) before.
    pub fn add(&mut self, now: Instant, what: PlantEvent, lasts: Option<Duration>) {
        self.pending.push(Pending {
            when: When::At(now),
            lasts,
            what,
            restores: false,
        });
    }

    /// Returns true when nothing is left to happen.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.pending.is_empty()
    }

    /// Returns the time when the next thing happens by time.
    #[must_use]
    pub fn next(&self) -> Option<Instant> {
        let times = self.pending.iter().filter_map(|pending| match pending.when {
            When::At(at) => Some(at),
            When::Place(_) => None,
        });
        times.min()
    }

    /// Returns true while something waits for the axis to reach a place.
    #[must_use]
    pub fn watches_position(&self) -> bool {
        let waits = |pending: &Pending| matches!(pending.when, When::Place(_));
        self.pending.iter().any(waits)
    }

    /// Returns true when [`play`](Self::play) would do something.
    #[must_use]
    pub fn is_due(&self, now: Instant, unit: &Unit) -> bool {
        let place = position(unit);
        self.pending.iter().any(|pending| self.due(pending, now, place))
            || self.watches_position() && self.place != Some(place)
    }

    /// Lets everything happen that is due, in the order of its time, then of the file.
    pub fn play(&mut self, now: Instant, unit: &mut Unit) -> Vec<Played> {
        let mut played = Vec::new();
        let place = position(unit);
        while played.len() < MOST_AT_ONCE {
            let due = self
                .pending
                .iter()
                .enumerate()
                .filter(|(_, pending)| self.due(pending, now, place))
                .min_by_key(|(_, pending)| match pending.when {
                    When::At(at) => at,
                    When::Place(_) => now,
                })
                .map(|(index, _)| index);
            let Some(index) = due else { break };
            let Pending {
                lasts,
                what,
                restores,
                ..
            } = self.pending.remove(index);
            what.apply(unit);
            if let (Some(lasts), Some(end)) = (lasts, what.undo()) {
                self.pending.push(Pending {
                    when: When::At(now + lasts),
                    lasts: None,
                    what: end,
                    restores: true,
                });
            }
            played.push(Played {
                what,
                lasts,
                restores,
            });
        }
        self.place = Some(place);
        played
    }

    fn due(&self, pending: &Pending, now: Instant, place: i64) -> bool {
        match pending.when {
            When::At(at) => at <= now,
            // From either side; standing on it from the start counts too.
            When::Place(wanted) => {
                let before = self.place.unwrap_or(place);
                (before.min(place)..=before.max(place)).contains(&wanted)
            }
        }
    }
}

fn position(unit: &Unit) -> i64 {
    unit.inner().endpoint().drive().axis().position()
}

#[cfg(test)]
mod tests {
    use super::*;
    use network::host::Host;
    use profinet::MacAddress;
    use virtual_drive::model;
    use virtual_drive::station::{Station, StationConfig};

    fn unit() -> Unit {
        let config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
        Unit::new(Host::new(Station::new(config)), 1)
    }

    fn cue(trigger: Trigger, what: &str, lasts: Option<u64>) -> Cue {
        Cue {
            trigger,
            what: what.parse().unwrap(),
            lasts: lasts.map(Duration::from_millis),
        }
    }

    fn at(millis: u64) -> Instant {
        Instant::from_millis(millis)
    }

    #[test]
    fn things_happen_in_time_and_end() {
        let after = |millis| Trigger::Time(Duration::from_millis(millis));
        let cues = [
            cue(after(20), "cable=pulled", Some(30)),
            cue(after(10), "fault=439", None),
            cue(after(20), "loss=5%", None),
        ];
        let mut line = Timeline::new(&cues, at(1000));
        let mut unit = unit();
        assert_eq!(line.next(), Some(at(1010)));
        assert!(line.play(at(1009), &mut unit).is_empty());
        let texts = |played: Vec<Played>| played.iter().map(|p| p.what.to_string()).collect::<Vec<_>>();
        assert_eq!(texts(line.play(at(1010), &mut unit)), ["fault=439"]);
        assert!(unit.inner().endpoint().drive().has_fault());
        assert_eq!(texts(line.play(at(1025), &mut unit)), ["cable=pulled", "loss=5%"]);
        assert!(unit.is_pulled());
        assert_eq!(line.next(), Some(at(1055)));
        assert_eq!(texts(line.play(at(1055), &mut unit)), ["cable=plugged"]);
        assert!(!unit.is_pulled());
        assert_eq!(line.next(), None);
    }

    #[test]
    fn events_that_wait_for_their_end_fill_the_room() {
        let mut line = Timeline::new(&[], at(0));
        let mut unit = unit();
        assert!(line.has_room(MOST_PENDING) && !line.has_room(MOST_PENDING + 1));
        let what = "cable=pulled".parse().unwrap();
        line.add(at(0), what, Some(Duration::from_secs(3600)));
        assert_eq!(line.play(at(0), &mut unit).len(), 1);
        assert!(line.has_room(MOST_PENDING - 1) && !line.has_room(MOST_PENDING));
        assert_eq!(line.play(at(3_600_000), &mut unit).len(), 1);
        assert!(line.has_room(MOST_PENDING));
    }

    #[test]
    fn a_place_is_met_once_from_either_side() {
        let mut line = Timeline::new(&[cue(Trigger::Place(100), "fault=439", None)], at(0));
        let unit = unit();
        assert!(line.watches_position());
        for (before, now, meets) in [(0, 99, false), (0, 100, true), (200, 50, true), (101, 300, false)] {
            line.place = Some(before);
            assert_eq!(line.due(&line.pending[0], at(0), now), meets, "{before} to {now}");
        }
        assert!(!Timeline::default().is_due(at(0), &unit));
    }
}
