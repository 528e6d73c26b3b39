//! The smallest plant in which an expectation still fails.

use std::fmt;
use std::time::Duration;

use toml_edit::{DocumentMut, Item, TableLike};

use crate::campaign::{Campaign, CampaignError, run};
use crate::expect::ExpectationResult;
use crate::source::PlantSource;

/// Runs that shrinking makes at most.
const MOST_RUNS: usize = 1000;

/// A small plant in which the same expectation of the same drive fails with the same outcome.
#[derive(Debug, Clone)]
pub struct Reproduction {
    /// The plant, with its seed and its duration.
    pub plant: PlantSource,
    /// What came of the expectation in it.
    pub result: ExpectationResult,
    /// Runs that it took.
    pub runs: usize,
    /// Whether nothing is left that can be removed; otherwise the time or the number of runs was up.
    pub is_smallest: bool,
}

/// Something that may be removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Expectation(usize),
    Controller(usize),
    Drive(usize),
    /// The event of a drive.
    Event(usize, usize),
    /// A value that varies; without it the plant has that of its file.
    Change(usize),
}

impl Campaign {
    /// Removes events, controllers, drives, other expectations and varied values from the run of a seed, and shortens it, as long as the
    /// same expectation fails; `expectation` is its name, or the first one that fails. Drive and controller of the expectation stay:
    /// without them it would fail for another reason. Returns nothing when it does not fail. `goes_on` is asked before each
    /// run; unless it ends the search, the same run always gives the same reproduction.
    ///
    /// ```
    /// use profidrive_plant::{Campaign, PlantSource};
    ///
    /// let plant: PlantSource = r#"
    ///     duration = "9s"
    ///     expect = [{ name = "no fault", never = true, drive = "akd-1", fault = "any" }]
    ///     [[drive]]
    ///     name = "akd-1"
    ///     event = [{ at = "1s", do = "warning=107" }, { at = "2s", do = "fault=439" }]
    ///     [[drive]]
    ///     name = "akd-2"
    /// "#.parse()?;
    /// let smallest = Campaign::new(plant).shrink(1, None, &mut || true)?.ok_or("no failure")?;
    /// let plan = smallest.plant.plan();
    /// assert_eq!((plan.drives.len(), plan.drives[0].cues.len()), (1, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Campaign::run`].
    pub fn shrink(
        &self,
        seed: u64,
        expectation: Option<&str>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Reproduction>, CampaignError> {
        let (whole, variables) = self.plant(seed)?;
        let end = self.end(&whole)?;
        let (results, ..) = run(&whole, seed, end, 0)?;
        let fails = |result: &ExpectationResult| {
            !result.is_met() && expectation.is_none_or(|name| result.name == name)
        };
        let Some(failed) = results.into_iter().find(fails) else {
            return Ok(None);
        };
        let mut search = Search {
            campaign: self,
            seed,
            all: parts(&whole, &failed, variables.len()),
            variables,
            plant: whole,
            result: failed,
            end,
            runs: 1,
            goes_on,
            ended: false,
        };
        search.shorten();
        let mut kept = search.all.clone();
        loop {
            let before = kept.len();
            search.remove(&mut kept);
            search.shorten();
            if kept.len() == before || search.ended {
                break;
            }
        }
        let duration = format!("{}ms", search.end.as_millis()).into();
        let plant = search.plant.with_changes([("duration", duration)]);
        Ok(Some(Reproduction {
            plant: plant.map_err(|error| CampaignError::Change { seed, error })?,
            result: search.result,
            runs: search.runs,
            is_smallest: !search.ended,
        }))
    }
}

fn parts(plant: &PlantSource, failed: &ExpectationResult, varied: usize) -> Vec<Part> {
    let plan = plant.plan();
    let other = |drive: usize| {
        plan.drives
            .get(drive)
            .is_some_and(|plan| plan.name != failed.drive)
    };
    let expectations = plan.expectations.iter().enumerate();
    let expectations = expectations.filter(|(_, expectation)| expectation.name() != failed.name);
    let controllers = plan.controllers.iter().enumerate();
    let controllers = controllers.filter(|(_, controller)| other(controller.drive));
    let drives = (0..plan.drives.len()).filter(|drive| other(*drive));
    let events = plan.drives.iter().enumerate();
    let events = events.flat_map(|(drive, plan)| (0..plan.cues.len()).map(move |event| (drive, event)));
    let mut parts: Vec<_> = expectations
        .map(|(number, _)| Part::Expectation(number))
        .collect();
    parts.extend(controllers.map(|(number, _)| Part::Controller(number)));
    parts.extend(drives.map(Part::Drive));
    parts.extend(events.map(|(drive, event)| Part::Event(drive, event)));
    parts.extend((0..varied).map(Part::Change));
    parts
}

struct Search<'s> {
    campaign: &'s Campaign,
    seed: u64,
    variables: Vec<(String, toml::Value)>,
    all: Vec<Part>,
    /// The smallest plant in which it fails so far, and how.
    plant: PlantSource,
    result: ExpectationResult,
    end: Duration,
    runs: usize,
    goes_on: &'s mut dyn FnMut() -> bool,
    ended: bool,
}

impl Search<'_> {
    /// Removes as many parts as possible at once, then half as many, down to one.
    fn remove(&mut self, kept: &mut Vec<Part>) {
        let mut size = kept.len();
        while size > 0 {
            let mut first = 0;
            while first < kept.len() {
                let mut fewer = kept.clone();
                fewer.drain(first..(first + size).min(kept.len()));
                match self.without(&fewer) {
                    Some(plant) if self.fails(&plant, self.end) => {
                        self.plant = plant;
                        *kept = fewer;
                    }
                    _ => first += size,
                }
            }
            size /= 2;
        }
    }

    /// Ends the run when the expectation is decided.
    fn shorten(&mut self) {
        let decided = Duration::from_millis((self.result.time * 1e3).ceil() as u64);
        if decided < self.end && self.fails(&self.plant.clone(), decided) {
            self.end = decided;
        }
    }

    fn fails(&mut self, plant: &PlantSource, end: Duration) -> bool {
        self.ended = self.ended || self.runs >= MOST_RUNS || !(self.goes_on)();
        if self.ended {
            return false;
        }
        self.runs += 1;
        // a plant that does not start is no reproduction
        let Ok((results, ..)) = run(plant, self.seed, end, 0) else {
            return false;
        };
        let same = |result: &ExpectationResult| {
            (&result.name, &result.drive, result.outcome)
                == (&self.result.name, &self.result.drive, self.result.outcome)
        };
        let Some(result) = results.into_iter().find(same) else {
            return false;
        };
        self.result = result;
        true
    }

    /// Returns the plant with these parts only. Numbers of parts are those of the whole plant.
    fn without(&self, kept: &[Part]) -> Option<PlantSource> {
        let is_gone = |part: Part| self.all.contains(&part) && !kept.contains(&part);
        let variables = self.variables.iter().enumerate();
        let variables = variables.filter(|(number, _)| !is_gone(Part::Change(*number)));
        let changed = self
            .campaign
            .changed(self.seed, variables.map(|(_, variable)| variable));
        let changed = changed.ok()?;
        let controllers = &changed.plan().controllers;
        let of_lost_drive = |number: usize| {
            let controller = controllers.get(number);
            controller.is_some_and(|controller| is_gone(Part::Drive(controller.drive)))
        };
        let edit = |document: &mut DocumentMut| {
            for_each(document.get_mut("drive"), |drive, table| {
                let events = table.get_mut("event");
                if retain(events, |event| !is_gone(Part::Event(drive, event))) == 0 {
                    table.remove("event");
                }
            });
            retain(document.get_mut("drive"), |drive| !is_gone(Part::Drive(drive)));
            let controller = |number| !is_gone(Part::Controller(number)) && !of_lost_drive(number);
            if retain(document.get_mut("controller"), controller) == 0 {
                document.remove("controller");
            }
            retain(document.get_mut("expect"), |number| {
                !is_gone(Part::Expectation(number))
            });
        };
        changed.edited(edit).ok()
    }
}

fn for_each(list: Option<&mut Item>, mut each: impl FnMut(usize, &mut dyn TableLike)) {
    match list {
        Some(Item::ArrayOfTables(list)) => {
            list.iter_mut()
                .enumerate()
                .for_each(|(number, table)| each(number, table));
        }
        Some(Item::Value(toml_edit::Value::Array(list))) => {
            for (number, value) in list.iter_mut().enumerate() {
                if let Some(table) = value.as_inline_table_mut() {
                    each(number, table);
                }
            }
        }
        _ => {}
    }
}

/// Keeps some entries of a list, by their numbers, and returns how many.
fn retain(list: Option<&mut Item>, keep: impl Fn(usize) -> bool) -> usize {
    let mut numbers = 0..;
    let mut next = || numbers.next().is_some_and(&keep);
    match list {
        Some(Item::ArrayOfTables(list)) => {
            list.retain(|_| next());
            list.len()
        }
        Some(Item::Value(toml_edit::Value::Array(list))) => {
            list.retain(|_| next());
            list.len()
        }
        _ => 0,
    }
}

/// One line: what fails, where and when.
impl fmt::Display for Reproduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ExpectationResult {
            name,
            drive,
            outcome,
            actual,
            time,
            ..
        } = &self.result;
        let line = format!("{drive}: {name}: {outcome}: {actual} at {time} s");
        f.write_str(&line.replace(char::is_control, " "))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Bounds, Distribution};

    const PRESS: &str = include_str!("../../../examples/plants/press.toml");

    /// A press whose connection is lost too early for one of its expectations.
    fn press(pulled: u32, until: u64) -> Campaign {
        let plant: PlantSource = PRESS.parse().unwrap();
        let cable = [
            ("drive.press-1.event.2.at", format!("{pulled}ms").into()),
            ("drive.feeder-1.event.3.do", "cable=pulled".into()),
        ];
        let friction =
            Distribution::Uniform(Bounds::new(&"0.05".parse().unwrap(), &"0.3".parse().unwrap()).unwrap());
        Campaign::new(plant.with_changes(cable).unwrap())
            .vary("drive.press-1.load.friction", friction)
            .until(Duration::from_millis(until))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]

        #[test]
        fn what_is_left_fails_in_the_same_way(seed in 0_u64..1000, pulled in 600_u32..2000) {
            let campaign = press(pulled, 3000);
            let failed = campaign.run(seed).unwrap().results.into_iter().find(|result| !result.is_met());
            let shrunk = campaign.shrink(seed, None, &mut || true).unwrap();
            prop_assert_eq!(failed.is_some(), shrunk.is_some());
            if let (Some(failed), Some(shrunk)) = (failed, shrunk) {
                prop_assert!(shrunk.is_smallest);
                // as a reader who has nothing but the file
                let alone = Campaign::new(shrunk.plant.as_toml().parse().unwrap()).run(seed).unwrap();
                let same = |result: &&ExpectationResult| (&result.name, &result.drive) == (&failed.name, &failed.drive);
                let again = alone.results.iter().find(same).unwrap();
                prop_assert_eq!(again.outcome, failed.outcome);
                let second = campaign.shrink(seed, None, &mut || true).unwrap().unwrap();
                prop_assert_eq!(second.plant.as_toml(), shrunk.plant.as_toml());
            }
        }
    }

    #[test]
    fn nothing_is_left_that_has_no_part_in_it() {
        let shrunk = press(1600, 30_000).shrink(3, Some("reaches speed"), &mut || true);
        let shrunk = shrunk.unwrap().unwrap();
        let plan = shrunk.plant.plan();
        assert_eq!(
            (plan.drives.len(), plan.controllers.len()),
            (1, 1),
            "{}",
            shrunk.plant.as_toml()
        );
        assert_eq!((plan.drives[0].cues.len(), plan.expectations.len()), (1, 1));
        assert_eq!(plan.drives[0].plant.coulomb_friction, 0.1, "as in the file");
        assert_eq!(plan.seed, 3);
        assert!(
            plan.duration.unwrap() < Duration::from_secs(3),
            "{:?}",
            plan.duration
        );
        assert!(
            shrunk.to_string().starts_with("press-1: reaches speed: not met"),
            "{shrunk}"
        );
        assert!(shrunk.runs < 40, "{}", shrunk.runs);
    }

    #[test]
    fn it_ends_when_it_is_told_to_and_finds_nothing_in_a_run_that_is_well() {
        let mut left = 3;
        let mut few = || {
            left -= 1;
            left > 0
        };
        let shrunk = press(1600, 30_000).shrink(3, None, &mut few).unwrap().unwrap();
        assert!(!shrunk.is_smallest && shrunk.runs == 3, "{}", shrunk.runs);
        let well = Campaign::new(PRESS.parse().unwrap());
        assert!(well.shrink(7, None, &mut || true).unwrap().is_none());
    }
}
