//! The checks of expectations, tick by tick, in bounded memory.
//!
//! Between two looks at a drive its conditions are what they were at the first. What is true at a time is what is true
//! after everything that happened until then, that time included.

use std::collections::VecDeque;
use std::time::Duration;

use super::condition::{Observed, Seen};
use super::expectation::{After, Expectation, Rule, Target};
use super::result::{ExpectationResult, Nearest, Outcome};
use crate::trace::{Event, EventKind};

/// Events of each drive that a result has.
const RECENT: usize = 5;

/// Checks expectations while a plant runs.
///
/// The caller shows it each drive at each tick ([`observe`](Self::observe)), at times that never go back, and each event
/// before ([`note`](Self::note)).
#[derive(Debug)]
pub struct Monitor {
    expectations: Vec<Expectation>,
    checks: Vec<Check>,
    /// The checks of each drive that are not decided.
    open: Vec<Vec<usize>>,
    /// Expectations whose clock waits for a condition.
    waiting: Vec<usize>,
    recent: Vec<VecDeque<Event>>,
    seed: u64,
}

/// One expectation for one drive.
#[derive(Debug)]
struct Check {
    expectation: usize,
    target: Target,
    drive: usize,
    clock: Clock,
    /// Whether the conditions held at the last look; `None` before the first.
    last: Option<bool>,
    /// What each condition looked at, then.
    seen: Vec<Seen>,
    /// The nearest value of a quantity that was not met, with its distance.
    nearest: Option<(f64, usize, f64, Duration)>,
    done: Option<Done>,
}

#[derive(Debug)]
struct Done {
    outcome: Outcome,
    at: Duration,
    actual: String,
    recent: Vec<Event>,
}

/// What is left of the rule of an expectation, and how far it is.
#[derive(Debug, Clone, Copy)]
struct Clock {
    kind: Kind,
    /// When the window begins; `None` while its clock has not started.
    from: Option<Duration>,
    /// When it ends; `None` for the end of the run.
    to: Option<Duration>,
    lasts: Duration,
    /// Since when the conditions hold.
    since: Option<Duration>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// At the time `from`, and until `lasts` after it.
    At,
    /// Once from `from` to `to`, for `lasts`.
    Within,
    /// From `from` to `to` without a break.
    Whole {
        /// Whether the conditions hold, or do not hold.
        holds: bool,
    },
}

impl Clock {
    fn new(expectation: &Expectation) -> Self {
        let (kind, from, to) = match &expectation.rule {
            Rule::At(at) => (Kind::At, Some(*at), Some(*at + expectation.lasts)),
            Rule::Within { span, after } => {
                let from = match after {
                    After::Time(from) => Some(*from),
                    After::Condition(_) => None,
                };
                (Kind::Within, from, from.map(|from| from + *span))
            }
            Rule::Whole { holds, from, to } => (Kind::Whole { holds: *holds }, Some(*from), *to),
        };
        Self {
            kind,
            from,
            to,
            lasts: expectation.lasts,
            since: None,
        }
    }

    /// Decides by time alone: nothing changed until `now`, which is not over yet. `last` is what held until then.
    fn pass(&self, last: bool, now: Duration) -> Option<(Outcome, Duration)> {
        let from = self.from?;
        if now <= from {
            return None;
        }
        match self.kind {
            Kind::At => {
                if !last {
                    return Some((Outcome::NotMet, from.max(self.since.unwrap_or(from))));
                }
                let to = self.to.unwrap_or(from);
                (now >= to).then_some((Outcome::Met, to))
            }
            Kind::Within => {
                let to = self.to.unwrap_or(from);
                let began = self
                    .since
                    .map(|since| since.max(from))
                    .filter(|began| *began <= to);
                match began {
                    Some(began) if now >= began + self.lasts => Some((Outcome::Met, began + self.lasts)),
                    None if now > to => Some((Outcome::NotMet, to)),
                    _ => None,
                }
            }
            Kind::Whole { holds } => {
                if last != holds {
                    return Some((Outcome::NotMet, from));
                }
                self.to.filter(|to| now > *to).map(|to| (Outcome::Met, to))
            }
        }
    }

    /// Takes what holds at `now`; decides when that does.
    fn take(&mut self, holds: bool, now: Duration) -> Option<(Outcome, Duration)> {
        if holds {
            self.since.get_or_insert(now);
        } else {
            self.since = None;
        }
        let from = self.from?;
        let inside = now >= from && self.to.is_none_or(|to| now <= to);
        match self.kind {
            // the end is not inside: it was true for that long
            Kind::At => {
                (!holds && now > from && self.to.is_some_and(|to| now < to)).then_some((Outcome::NotMet, now))
            }
            Kind::Within => {
                let to = self.to?;
                if holds {
                    (inside && self.lasts.is_zero()).then_some((Outcome::Met, now))
                } else {
                    (now > to).then_some((Outcome::NotMet, now))
                }
            }
            Kind::Whole { holds: wanted } => (inside && holds != wanted).then_some((Outcome::NotMet, now)),
        }
    }

    /// Decides at the end of the run.
    fn end(&self, last: bool, end: Duration) -> (Outcome, Duration) {
        let Some(from) = self.from.filter(|from| *from <= end) else {
            let outcome = if self.kind == Kind::At {
                Outcome::NotEnded
            } else {
                Outcome::NeverStarted
            };
            return (outcome, end);
        };
        // everything that happens at the end has happened
        let decided = match self.kind {
            Kind::At if !last => Some(Outcome::NotMet),
            Kind::Whole { holds } if last != holds => Some(Outcome::NotMet),
            Kind::Whole { .. } if self.to.is_none() => Some(Outcome::Met),
            Kind::Within => {
                let to = self.to.unwrap_or(from);
                let began = self
                    .since
                    .map(|since| since.max(from))
                    .filter(|began| *began <= to);
                match began {
                    Some(began) if began + self.lasts <= end => Some(Outcome::Met),
                    Some(_) => None,
                    None if to <= end => Some(Outcome::NotMet),
                    None => None,
                }
            }
            _ => self.to.filter(|to| *to <= end).map(|_| Outcome::Met),
        };
        (decided.unwrap_or(Outcome::NotEnded), end)
    }

    /// Returns true while a nearest value counts.
    fn counts(&self, now: Duration) -> bool {
        let inside = self.from.is_some_and(|from| now >= from) && self.to.is_none_or(|to| now <= to);
        inside && !matches!(self.kind, Kind::Whole { .. })
    }
}

impl Monitor {
    /// Creates the checks of a plant with so many drives, at its start.
    #[must_use]
    pub fn new(expectations: &[Expectation], drives: usize, seed: u64) -> Self {
        let mut checks = Vec::new();
        let mut open = vec![Vec::new(); drives];
        let mut waiting = Vec::new();
        for (number, expectation) in expectations.iter().enumerate() {
            if matches!(
                &expectation.rule,
                Rule::Within {
                    after: After::Condition(_),
                    ..
                }
            ) {
                waiting.push(number);
            }
            for target in &expectation.targets {
                if let Some(open) = open.get_mut(target.drive) {
                    open.push(checks.len());
                }
                checks.push(Check {
                    expectation: number,
                    drive: target.drive,
                    target: target.clone(),
                    clock: Clock::new(expectation),
                    last: None,
                    nearest: None,
                    done: None,
                    seen: Vec::new(),
                });
            }
        }
        Self {
            expectations: expectations.to_vec(),
            checks,
            open,
            waiting,
            recent: vec![VecDeque::new(); drives],
            seed,
        }
    }

    /// Notes an event of the drive of that number, for the results.
    pub fn note(&mut self, drive: usize, event: &Event) {
        if matches!(event.kind, EventKind::Sample(_)) {
            return;
        }
        if let Some(recent) = self.recent.get_mut(drive) {
            if recent.len() >= RECENT {
                recent.pop_front();
            }
            recent.push_back(event.clone());
        }
    }

    /// Takes what the drive of that number is like at `now`, after everything that has happened until then.
    pub fn observe(&mut self, drive: usize, now: Duration, seen: &dyn Observed) {
        self.start_clocks(drive, now, seen);
        let (recent, checks) = (&self.recent, &mut self.checks);
        let recent = || recent.get(drive).into_iter().flatten().cloned().collect();
        let Some(open) = self.open.get_mut(drive) else {
            return;
        };
        open.retain(|number| {
            checks.get_mut(*number).is_some_and(|check| {
                check.observe(now, seen, recent);
                check.done.is_none()
            })
        });
    }

    fn start_clocks(&mut self, drive: usize, now: Duration, seen: &dyn Observed) {
        let (expectations, checks) = (&self.expectations, &mut self.checks);
        self.waiting.retain(|number| {
            let rule = expectations.get(*number).map(|expectation| &expectation.rule);
            let Some(Rule::Within {
                span,
                after: After::Condition(targets),
            }) = rule
            else {
                return false;
            };
            let mut own = targets.iter().filter(|target| target.drive == drive);
            if !own.any(|target| target.hold(seen)) {
                return true;
            }
            for check in checks.iter_mut().filter(|check| check.expectation == *number) {
                check.clock.from = Some(now);
                check.clock.to = Some(now + *span);
            }
            false
        });
    }

    /// Returns true when every check is decided.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.open.iter().all(Vec::is_empty)
    }

    /// Ends the run at `end`; returns what came of each expectation for each drive, in the order of the file. `name` has the
    /// names of the drives.
    #[must_use]
    pub fn finish<'a>(self, end: Duration, name: impl Fn(usize) -> &'a str) -> Vec<ExpectationResult> {
        let Self {
            expectations,
            checks,
            recent,
            seed,
            ..
        } = self;
        let result = |mut check: Check| {
            let expectation = expectations.get(check.expectation)?;
            let done = check.done.take().unwrap_or_else(|| {
                let (outcome, at) = check.clock.end(check.last.unwrap_or(false), end);
                Done {
                    outcome,
                    at,
                    actual: check.in_words(),
                    recent: recent.get(check.drive).into_iter().flatten().cloned().collect(),
                }
            });
            let met = done.outcome == Outcome::Met;
            Some(ExpectationResult {
                file: expectation.file.clone(),
                name: expectation.name.clone(),
                line: expectation.line,
                drive: name(check.drive).to_owned(),
                outcome: done.outcome,
                expected: expectation.source.clone(),
                actual: done.actual,
                time: done.at.as_secs_f64(),
                nearest: check.nearest().filter(|_| !met),
                last_events: if met { Vec::new() } else { done.recent },
                seed,
            })
        };
        checks.into_iter().filter_map(result).collect()
    }
}

impl Target {
    fn hold(&self, drive: &dyn Observed) -> bool {
        let mut conditions = self.conditions.iter();
        conditions.all(|condition| condition.holds(&condition.look(drive)))
    }
}

impl Check {
    fn observe(&mut self, now: Duration, drive: &dyn Observed, recent: impl Fn() -> Vec<Event>) {
        let mut decided = self.last.and_then(|last| self.clock.pass(last, now));
        // what is decided by time alone was decided by what was there before
        if decided.is_none() {
            let conditions = &self.target.conditions;
            self.seen.clear();
            self.seen
                .extend(conditions.iter().map(|condition| condition.look(drive)));
            let holds = conditions
                .iter()
                .zip(&self.seen)
                .all(|(condition, seen)| condition.holds(seen));
            self.last = Some(holds);
            decided = self.clock.take(holds, now);
            if !holds && self.clock.counts(now) {
                self.note_nearest(now);
            }
        }
        if let Some((outcome, at)) = decided {
            self.done = Some(Done {
                outcome,
                at,
                actual: self.in_words(),
                recent: if outcome == Outcome::Met {
                    Vec::new()
                } else {
                    recent()
                },
            });
        }
    }

    fn note_nearest(&mut self, now: Duration) {
        let seen = self.target.conditions.iter().zip(&self.seen).enumerate();
        let mut unmet = seen.filter_map(|(at, (condition, seen))| {
            let (value, distance) = condition.distance(seen)?;
            (distance > 0.0).then_some((distance, at, value, now))
        });
        if let Some(new) = unmet.next()
            && self.nearest.is_none_or(|best| new.0 < best.0)
        {
            self.nearest = Some(new);
        }
    }

    fn nearest(&self) -> Option<Nearest> {
        let (_, at, value, time) = self.nearest?;
        let condition = self.target.conditions.get(at)?;
        Some(Nearest {
            quantity: condition.key.clone(),
            value,
            unit: condition.unit(),
            time: time.as_secs_f64(),
        })
    }

    fn in_words(&self) -> String {
        let seen = self.target.conditions.iter().zip(&self.seen);
        seen.map(|(condition, seen)| condition.in_words(seen))
            .collect::<Vec<_>>()
            .join(", ")
    }
}
