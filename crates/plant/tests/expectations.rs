//! Expectations: each row of the grammar, mistakes with their lines, and the monitor against a plain definition.

#![allow(clippy::unwrap_used)]

use std::time::Duration;

use profidrive_plant::{ExpectationResult, Monitor, Observed, ObservedQuantity, Outcome, PlantPlan, World};
use profile::catalogue::Parameter;
use profile::state::{State, Stw1, Zsw1};
use profinet::Instant;
use proptest::prelude::*;

const TWO: &str = "[[drive]]\nname = \"press-1\"\n[[drive]]\nname = \"feeder-1\"\nmodel = \"vlt\"\n";

fn two() -> PlantPlan {
    TWO.parse().unwrap()
}

/// Returns the message of a mistake.
fn mistake(text: &str) -> String {
    two()
        .expectations_of(text)
        .map(|found| format!("accepted: {found:?}"))
        .unwrap_or_else(|error| error.to_string())
}

#[test]
fn every_row_of_the_grammar_is_read_and_written_alike() {
    for text in [
        r#"{ at = "2s", state = "S4" }"#,
        r#"{ at = "2s", state = "S1|S2", for = "200ms" }"#,
        r#"{ within = "700ms", speed = "120rpm", tolerance = "2rpm" }"#,
        r#"{ within = "700ms", after = "1.5s", speed = "120rpm", tolerance = "1%", for = "1s" }"#,
        r#"{ within = "60ms", after = { drive = "press-1", connected = false }, drive = "press-1", fault = 702 }"#,
        r#"{ within = "60ms", after = { drive = "press-*", speed = ">1rpm", state = "S4" }, homed = true }"#,
        r#"{ always = true, drive = "*", speed = "-130rpm..130rpm" }"#,
        r#"{ always = "2s..5s", target-reached = false }"#,
        r#"{ never = "..19s", drive = ["press-1", "feeder-1"], fault = "any" }"#,
        r#"{ never = "3s..", moving = true, connected = true }"#,
        r#"{ always = true, warning = "none", fault = "none" }"#,
        r#"{ at = "1s", drive = "press-1", fault = [702, 439], warning = [107] }"#,
        r#"{ at = "1s", zsw1 = "0x0737/0x0FFF" }"#,
        r#"{ at = "1s", stw1 = "0x047E" }"#,
        r#"{ at = "1s", zsw1 = "OPERATION_ENABLED !FAULT", stw1 = "ON !JOG_1" }"#,
        r#"{ at = "1s", position = "<2.5rev", current = "<=3A", torque = ">-1Nm", bus-voltage = ">=300V" }"#,
        r#"{ at = "1s", following-error = "-0.1rev..0.1rev", load.speed = "<1rpm", load.position = ">0rev" }"#,
        r#"{ at = "1s", drive = "press-1", parameter = { "DRV.ACC" = "5000rpm/s" }, tolerance = "1%" }"#,
        r#"{ at = "1s", drive = "press-1", parameter = { "p922" = 1 } }"#,
        r#"{ name = "a \"name\"", at = "1s", state = "S1" }"#,
    ] {
        let found = two()
            .expectations_of(text)
            .unwrap_or_else(|error| panic!("{text}: {error}"));
        let again = two().expectations_of(&found[0].to_string()).unwrap();
        assert_eq!(again, found, "{text}");
    }
}

#[test]
fn mistakes_are_reported_with_their_reason() {
    for (text, reason) in [
        (r#"{ state = "S1" }"#, "exactly one of `at`"),
        (
            r#"{ at = "1s", within = "1s", state = "S1" }"#,
            "exactly one of `at`",
        ),
        (r#"{ at = "1s" }"#, "no condition"),
        (r#"{ at = "1", state = "S1" }"#, "unit"),
        (
            r#"{ at = "1s", after = "2s", state = "S1" }"#,
            "`after` belongs to `within`",
        ),
        (
            r#"{ always = true, for = "1s", state = "S1" }"#,
            "`for` belongs to",
        ),
        (r#"{ always = false, state = "S1" }"#, "a range of time"),
        (r#"{ never = "5s..2s", state = "S1" }"#, "a range of time"),
        (r#"{ never = "..", state = "S1" }"#, "a range of time"),
        (
            r#"{ within = "1s", after = { state = "S1" }, state = "S2" }"#,
            "names its `drive`",
        ),
        (
            r#"{ at = "1s", drive = "press-7", state = "S1" }"#,
            "no drive `press-7`",
        ),
        (r#"{ at = "1s", drive = [], state = "S1" }"#, "at least one"),
        (r#"{ at = "1s", state = "S6" }"#, "states are S1 to S5"),
        (r#"{ at = "1s", fault = 65000 }"#, "has no fault 65000"),
        (r#"{ at = "1s", fault = "some" }"#, "a fault is a number"),
        (r#"{ at = "1s", moving = "yes" }"#, "true or false"),
        (r#"{ at = "1s", zsw1 = "0x1000/0x0FFF" }"#, "VALUE/MASK"),
        (
            r#"{ at = "1s", zsw1 = "OPERATING" }"#,
            "there are: READY_TO_SWITCH_ON",
        ),
        (r#"{ at = "1s", zsw1 = "FAULT !FAULT" }"#, "cannot be 0 and 1"),
        (r#"{ at = "1s", zsw1 = "" }"#, "names of bits"),
        (r#"{ at = "1s", speed = "120rpm" }"#, "tolerance"),
        (
            r#"{ at = "1s", speed = "120s", tolerance = "1%" }"#,
            "unit of time",
        ),
        (
            r#"{ at = "1s", speed = "120rpm", tolerance = "-1rpm" }"#,
            "not negative",
        ),
        (
            r#"{ at = "1s", speed = ">1rpm", tolerance = "1rpm" }"#,
            "`tolerance` belongs to",
        ),
        (r#"{ at = "1s", speed = "2rpm..1rpm" }"#, "begins behind its end"),
        (
            r#"{ at = "1s", load.spede = ">1rpm" }"#,
            "unknown key `load.spede`",
        ),
        (r#"{ at = "1s", spede = ">1rpm" }"#, "unknown key `spede`"),
        (r#"{ at = "1s", parameter = { DRV.ACC = 1 } }"#, "quotation marks"),
        (
            r#"{ at = "1s", drive = "press-1", parameter = { "DRV.AC" = 1 } }"#,
            "DRV.ACC",
        ),
        (
            r#"{ at = "1s", drive = "press-1", parameter = { "DRV.ACC" = "1rpm/s" } }"#,
            "tolerance",
        ),
        ("expected = []", "unknown key `expected`"),
        ("expect = 1", "a list of tables"),
    ] {
        let message = mistake(text);
        assert!(message.contains(reason), "{text}: {message}");
    }
}

#[test]
fn a_mistake_in_a_plant_file_has_its_line() {
    let text = format!(
        "expect = [\n    {{ at = \"1s\", state = \"S1\" }},\n    {{ at = \"1s\",\n state = \"S9\" }},\n]\n{TWO}"
    );
    let error = text.parse::<PlantPlan>().unwrap_err();
    assert_eq!(error.line, 4, "{error}");
    let twice = "expect = [\n{ name = \"a\", at = \"1s\", state = \"S1\" },\n{ name = \"a\", at = \"1s\", state = \"S1\" }]";
    assert_eq!(two().expectations_of(twice).unwrap_err().line, 3);
}

/// A drive of which only its speed matters.
struct Speed(f64);

impl Observed for Speed {
    fn state(&self) -> State {
        State::S1
    }
    fn stw1(&self) -> Stw1 {
        Stw1(0)
    }
    fn zsw1(&self) -> Zsw1 {
        Zsw1(0)
    }
    fn is_positioning(&self) -> bool {
        false
    }
    fn is_moving(&self) -> bool {
        false
    }
    fn connected(&self) -> Option<bool> {
        None
    }
    fn messages(&self, _: bool) -> Vec<u16> {
        Vec::new()
    }
    fn quantity(&self, _: ObservedQuantity) -> f64 {
        self.0
    }
    fn parameter(&self, _: &'static Parameter, _: u16) -> Option<f64> {
        None
    }
}

const fn ms(time: u64) -> Duration {
    Duration::from_millis(time)
}

/// Runs one expectation over the ticks of one drive, in milliseconds.
fn monitored(plant: &PlantPlan, text: &str, ticks: &[(u64, f64)], end: u64) -> ExpectationResult {
    let expectations = plant.expectations_of(text).unwrap();
    let mut monitor = Monitor::new(&expectations, 1, 7);
    for (at, speed) in ticks {
        monitor.observe(0, ms(*at), &Speed(*speed));
    }
    monitor.finish(ms(end), |_| "a").remove(0)
}

/// The rules of expectations, written down over the complete list of ticks. `true_at(t)` is what is true after everything
/// that happened until `t`; `ticks` are all instants at which something was seen.
mod definition {
    use super::Outcome;

    pub type Ticks = [(u64, bool)];

    fn true_at(ticks: &Ticks, time: u64) -> bool {
        ticks
            .iter()
            .rfind(|(at, _)| *at <= time)
            .is_some_and(|(_, holds)| *holds)
    }

    /// True from `from` on, and at every tick before `to`.
    fn stays(ticks: &Ticks, from: u64, to: u64) -> bool {
        true_at(ticks, from) && ticks.iter().all(|(at, holds)| *at <= from || *at >= to || *holds)
    }

    pub fn at(ticks: &Ticks, at: u64, lasts: u64, end: u64) -> Outcome {
        if at > end {
            Outcome::NotEnded
        } else if !stays(ticks, at, (at + lasts).min(end + 1)) {
            Outcome::NotMet
        } else if at + lasts > end {
            Outcome::NotEnded
        } else {
            Outcome::Met
        }
    }

    pub fn within(ticks: &Ticks, span: u64, after: u64, lasts: u64, end: u64) -> Outcome {
        if after > end {
            return Outcome::NeverStarted;
        }
        let starts: Vec<u64> = (after..=(after + span).min(end)).collect();
        let tick_in = ticks
            .iter()
            .any(|(at, holds)| *holds && (after..=after + span).contains(at));
        let stays_from = |from: &&u64| stays(ticks, **from, **from + lasts) && **from + lasts <= end;
        if lasts == 0 && tick_in || starts.iter().any(|from| stays_from(&from)) {
            return Outcome::Met;
        }
        let may_yet = starts
            .iter()
            .any(|from| stays(ticks, *from, end + 1) && *from + lasts > end);
        if after + span > end || may_yet {
            Outcome::NotEnded
        } else {
            Outcome::NotMet
        }
    }

    pub fn whole(ticks: &Ticks, wanted: bool, from: u64, to: Option<u64>, end: u64) -> Outcome {
        if from > end {
            return Outcome::NeverStarted;
        }
        let last = to.unwrap_or(end).min(end);
        let inside = ticks.iter().filter(|(at, _)| (from..=last).contains(at));
        if true_at(ticks, from) != wanted || inside.clone().any(|(_, holds)| *holds != wanted) {
            Outcome::NotMet
        } else if to.is_some_and(|to| to > end) {
            Outcome::NotEnded
        } else {
            Outcome::Met
        }
    }
}

/// Ticks from 0 on, some at the same time.
fn ticks() -> impl Strategy<Value = Vec<(u64, bool)>> {
    let steps = prop::collection::vec((0_u64..6, any::<bool>()), 1..20);
    (any::<bool>(), steps).prop_map(|(first, steps)| {
        let mut at = 0;
        let rest = steps.into_iter().map(|(step, holds)| {
            at += step;
            (at, holds)
        });
        std::iter::once((0, first)).chain(rest).collect()
    })
}

proptest! {
    #[test]
    fn the_monitor_decides_as_the_rules_are_written(
        ticks in ticks(),
        start in 0_u64..40,
        span in 0_u64..30,
        lasts in 0_u64..12,
        more in 0_u64..10,
    ) {
        let end = ticks.last().map_or(0, |(at, _)| *at) + more;
        let speeds: Vec<_> = ticks.iter().map(|(at, holds)| (*at, if *holds { 10.0 } else { 0.0 })).collect();
        let plant: PlantPlan = "[[drive]]\nname = \"a\"".parse().unwrap();
        let to = start + span;
        let condition = "speed = \">5rpm\"";
        let cases = [
            (format!("{{ at = \"{start}ms\", for = \"{lasts}ms\", {condition} }}"), definition::at(&ticks, start, lasts, end)),
            (
                format!("{{ within = \"{span}ms\", after = \"{start}ms\", for = \"{lasts}ms\", {condition} }}"),
                definition::within(&ticks, span, start, lasts, end),
            ),
            (format!("{{ always = \"{start}ms..{to}ms\", {condition} }}"), definition::whole(&ticks, true, start, Some(to), end)),
            (format!("{{ never = \"{start}ms..\", {condition} }}"), definition::whole(&ticks, false, start, None, end)),
        ];
        for (text, expected) in cases {
            let result = monitored(&plant, &text, &speeds, end);
            prop_assert_eq!(result.outcome, expected, "{} over {:?} until {}", text, &ticks, end);
        }
    }

    #[test]
    fn a_clock_starts_at_the_first_time_its_condition_holds(ticks in ticks(), span in 0_u64..30) {
        let end = ticks.last().map_or(0, |(at, _)| *at);
        let speeds: Vec<_> = ticks.iter().map(|(at, holds)| (*at, if *holds { 10.0 } else { 0.0 })).collect();
        let plant: PlantPlan = "[[drive]]\nname = \"a\"".parse().unwrap();
        let text = format!("{{ within = \"{span}ms\", after = {{ drive = \"a\", speed = \">5rpm\" }}, speed = \"<5rpm\" }}");
        let result = monitored(&plant, &text, &speeds, end);
        let first = ticks.iter().position(|(_, holds)| *holds);
        let Some(first) = first else {
            prop_assert_eq!(result.outcome, Outcome::NeverStarted);
            return Ok(());
        };
        let (start, rest) = (ticks[first].0, &ticks[first..]);
        let inverse: Vec<_> = rest.iter().map(|(at, holds)| (*at, !holds)).collect();
        prop_assert_eq!(result.outcome, definition::within(&inverse, span, start, 0, end));
    }

    #[test]
    fn no_text_makes_the_parser_panic(text in "\\PC*", key in "(at|within|always|never|after|for|drive|state|fault|zsw1|speed|tolerance|parameter|load)", value in "[\"{}\\[\\]a-zS0-9.<>=/|!% ,-]*") {
        let _ = two().expectations_of(&text);
        let _ = two().expectations_of(&format!("{{ at = \"1s\", {key} = {value} }}"));
        if let Ok(found) = two().expectations_of(&format!("{{ at = \"1s\", {key} = \"{value}\" }}")) {
            let again = two().expectations_of(&found[0].to_string()).unwrap();
            prop_assert_eq!(again, found);
        }
    }
}

#[test]
fn a_plant_is_checked_while_it_runs() {
    let text = include_str!("../../../examples/plants/press.toml");
    let plant: PlantPlan = text.parse().unwrap();
    let lost = plant
        .expectations_of(r#"{ within = "700ms", after = "1.5s", drive = "press-1", speed = "130rpm", tolerance = "1rpm" }"#)
        .unwrap();
    let mut all = plant.expectations.clone();
    all.extend(lost);
    let mut world = World::new(&plant).unwrap();
    world.expect(&all, plant.seed);
    world.run_until(Instant::ZERO + plant.duration.unwrap(), &mut drop);
    let results = world.finish_expectations();
    let (last, met) = results.split_last().unwrap();
    assert!(met.iter().all(ExpectationResult::is_met), "{met:#?}");
    assert_eq!(
        (last.outcome, last.seed, last.last_events.len()),
        (Outcome::NotMet, 7, 5),
        "{last}"
    );
    let nearest = last.nearest.as_ref().unwrap();
    assert!(
        (119.0..122.0).contains(&nearest.value) && (1.5..2.2).contains(&nearest.time),
        "{last}"
    );
}
