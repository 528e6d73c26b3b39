//! Numbers that are made of a run.

use std::time::Duration;

use super::condition::{Observed as _, Quantity};
use super::goal::Goal;
use super::parse::{Scope, range_of, read_goal};
use crate::kept::{DriveTrace, Trace, TraceError};
use crate::located::PlantError;

/// A number that is made of a [`Trace`], read by [`PlantPlan::measure`](crate::PlantPlan::measure):
///
/// ```text
/// max speed of press-1                              the highest speed, rpm
/// mean current of press-1 in 2s..5s                 over this time; also "2s.." and "..5s"
/// time of { drive = "press-1", fault = 702 }        the first time at which this holds, s
/// ```
///
/// The first word is `min`, `max`, `mean` (by time) or `last`, the second one a [`Quantity`].
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    text: String,
    what: What,
}

#[derive(Debug, Clone, PartialEq)]
enum What {
    Quantity {
        how: How,
        quantity: Quantity,
        /// Number of the drive in the plant.
        drive: usize,
        from: Duration,
        to: Option<Duration>,
    },
    Time(Box<Goal>),
}

/// Which number stands for all values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum How {
    Min,
    Max,
    Mean,
    Last,
}

const HOW: [(How, &str); 4] = [
    (How::Min, "min"),
    (How::Max, "max"),
    (How::Mean, "mean"),
    (How::Last, "last"),
];

impl Measure {
    pub(crate) fn read(text: &str, scope: Scope<'_>) -> Result<Self, PlantError> {
        let what = what(text.trim(), scope).map_err(|message| PlantError {
            line: 1,
            message: format!("`{text}`: {message}"),
        })?;
        Ok(Self {
            text: text.to_owned(),
            what,
        })
    }

    /// Returns its unit.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match &self.what {
            What::Quantity { quantity, .. } => quantity.unit(),
            What::Time(_) => "s",
        }
    }

    /// Returns the number that it is of a run; `None` where there is none: the run ended before, or what is looked for did not happen.
    ///
    /// # Errors
    /// When the trace has no room for what it is made of, and for a trace of another plant.
    pub fn of(&self, trace: &Trace) -> Result<Option<f64>, TraceError> {
        let found = match &self.what {
            What::Quantity {
                how,
                quantity,
                drive,
                from,
                to,
            } => {
                let needs_all = to.is_none_or(|to| to > trace.end());
                if needs_all && let Some(cut) = trace.cut() {
                    return Err(self.no_room(cut));
                }
                let to = to.map_or(trace.end(), |to| to.min(trace.end()));
                let mut drives = trace.drives();
                let seen = drives.nth(*drive).map(|seen| values(seen, *quantity, *from, to));
                seen.and_then(|values| how.of(&values))
            }
            What::Time(goal) => {
                let whole = goal.within(trace.end(), Duration::ZERO);
                let results = trace.expect(&[whole])?;
                let met = results.iter().find(|result| result.is_met());
                if let (None, Some(cut)) = (met, trace.cut()) {
                    return Err(self.no_room(cut));
                }
                met.map(|result| result.time)
            }
        };
        Ok(found)
    }

    fn no_room(&self, time: Duration) -> TraceError {
        TraceError::NoRoom {
            what: self.text.clone(),
            time,
        }
    }
}

fn what(text: &str, scope: Scope<'_>) -> Result<What, String> {
    let (first, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    if first == "time" {
        let conditions = rest.trim_start().strip_prefix("of").map(str::trim_start);
        let conditions =
            conditions.ok_or("a time is that of conditions: time of { drive = .., CONDITION .. }")?;
        let goal = read_goal(conditions, scope).map_err(|error| error.message)?;
        if goal.reads_parameters() {
            return Err("a trace keeps no parameters".to_owned());
        }
        return Ok(What::Time(Box::new(goal)));
    }
    let (how, _) = HOW.into_iter().find(|(_, name)| *name == first).ok_or_else(|| {
        let names = HOW.map(|(_, name)| name).join(", ");
        format!("it begins with one of {names}, time")
    })?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let (quantity, drive, time) = match words.as_slice() {
        [quantity, "of", drive] => (*quantity, *drive, None),
        [quantity, "of", drive, "in", time] => (*quantity, *drive, Some(*time)),
        _ => {
            return Err(format!(
                "it has the form `{first} QUANTITY of DRIVE`, or `.. in 2s..5s`"
            ));
        }
    };
    let known = Quantity::ALL.into_iter().find(|(_, key)| *key == quantity);
    let (quantity, _) = known.ok_or_else(|| {
        let names = Quantity::ALL.map(|(_, key)| key).join(", ");
        format!("no quantity `{quantity}`; there are: {names}")
    })?;
    let named = scope.drives.iter().position(|one| one.name == drive);
    let drive = named.ok_or_else(|| {
        let names: Vec<_> = scope
            .drives
            .iter()
            .take(16)
            .map(|one| one.name.as_str())
            .collect();
        format!(
            "no drive `{drive}` in this plant; there are: {}",
            names.join(", ")
        )
    })?;
    let (from, to) = time.map_or(Ok((Duration::ZERO, None)), range_of)?;
    Ok(What::Quantity {
        how,
        quantity,
        drive,
        from,
        to,
    })
}

/// The values of a drive in a time, each with how long it lasted.
fn values(drive: DriveTrace<'_>, quantity: Quantity, from: Duration, to: Duration) -> Vec<(f64, Duration)> {
    let mut found = Vec::new();
    // the run ended before
    if from > to {
        return found;
    }
    let mut snapshots = drive.snapshots().peekable();
    while let Some((begin, snapshot)) = snapshots.next() {
        let next = snapshots.peek().map(|(next, _)| *next);
        // at the begin of the time it is what it was before
        if begin > to || next.is_some_and(|next| next <= from) {
            continue;
        }
        let end = next.map_or(to, |next| next.min(to));
        found.push((snapshot.quantity(quantity), end.saturating_sub(begin.max(from))));
    }
    found
}

impl How {
    fn of(self, values: &[(f64, Duration)]) -> Option<f64> {
        let mut numbers = values.iter().map(|(value, _)| *value);
        match self {
            Self::Min => numbers.reduce(f64::min),
            Self::Max => numbers.reduce(f64::max),
            Self::Last => numbers.next_back(),
            Self::Mean => {
                let time: f64 = values.iter().map(|(_, lasts)| lasts.as_secs_f64()).sum();
                if time == 0.0 {
                    // a moment
                    return numbers.next_back();
                }
                let sum: f64 = values
                    .iter()
                    .map(|(value, lasts)| value * lasts.as_secs_f64())
                    .sum();
                Some(sum / time)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use profinet::Instant;

    use super::*;
    use crate::plan::PlantPlan;
    use crate::world::World;

    const PLANT: &str = r#"
        [[drive]]
        name = "press-1.a"
        ip = "10.0.0.1/24"
        event = [{ at = "2s", do = "fault=439" }]
        [[controller]]
        drive = "press-1.a"
        telegram = 1
        step = [
            { at = "200ms", send = { STW1 = "0x047E" } },
            { at = "600ms", send = { STW1 = "0x047F", NSOLL_A = "120rpm" } },
        ]
    "#;

    fn run(limit: usize) -> (PlantPlan, Trace) {
        let plan: PlantPlan = PLANT.parse().unwrap();
        let mut world = World::new(&plan).unwrap();
        world.keep_trace(limit);
        world.run_until(Instant::from_millis(4000), &mut drop);
        (plan, world.take_trace().unwrap())
    }

    #[test]
    fn numbers_are_made_of_a_run() {
        let (plan, trace) = run(Trace::USUAL_LIMIT);
        let of = |text: &str| plan.measure(text).unwrap().of(&trace).unwrap();
        let near = |text: &str, value: f64, by: f64| {
            let found = of(text).unwrap();
            assert!((found - value).abs() <= by, "{text}: {found}");
        };
        near("max load.speed of press-1.a", 120.0, 5.0);
        near("min speed of press-1.a in 1500ms..1900ms", 120.0, 2.0);
        near("mean speed of press-1.a in 1500ms..1900ms", 120.0, 1.0);
        near("last speed of press-1.a", 0.0, 1.0);
        near("last speed of press-1.a in ..1800ms", 120.0, 2.0);
        near("time of { fault = 439 }", 2.0, 0.01);
        near("time of { speed = \"> 100rpm\", for = \"500ms\" }", 1.2, 0.3);
        // it turns for some of the time, so the mean is below the speed, and a moment has a mean too
        assert!((40.0..70.0).contains(&of("mean speed of press-1.a").unwrap()));
        near("mean speed of press-1.a in 1800ms..1800ms", 120.0, 2.0);
        assert_eq!(of("time of { fault = 702 }"), None);
        assert_eq!(of("max speed of press-1.a in 5s.."), None, "the run ended before");
        assert_eq!(plan.measure("max current of press-1.a").unwrap().unit(), "A");
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let (plan, _) = run(Trace::USUAL_LIMIT);
        for (text, why) in [
            ("", "min, max, mean, last, time"),
            ("highest speed of press-1.a", "min, max, mean, last, time"),
            ("max speed", "max QUANTITY of DRIVE"),
            ("max speeds of press-1.a", "load.speed"),
            ("max speed of press-2", "there are: press-1.a"),
            ("max speed of press-1.a in 2s", "range of time"),
            ("max speed of press-1.a in 5s..2s", "range of time"),
            ("time fault", "time of {"),
            ("time of { fault = 1 }", "no fault 1"),
            (
                "time of { parameter = { \"DRV.ACC\" = \"> 3rpm/s\" } }",
                "no parameters",
            ),
        ] {
            let error = plan.measure(text).unwrap_err();
            assert!(error.message.contains(why), "{text}: {}", error.message);
        }
    }

    #[test]
    fn a_trace_that_is_cut_gives_no_number_for_what_it_does_not_have() {
        let (plan, trace) = run(20_000);
        let cut = trace.cut().unwrap();
        assert!(cut > Duration::from_millis(50));
        let of = |text: &str| plan.measure(text).unwrap().of(&trace);
        assert!(of("max speed of press-1.a in ..40ms").is_ok());
        for text in ["max speed of press-1.a", "time of { fault = 702 }"] {
            let error = of(text).unwrap_err();
            assert!(error.to_string().contains(text), "{error}");
        }
    }
}
