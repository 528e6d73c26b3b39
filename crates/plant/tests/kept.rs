//! Runs that are kept: the same checks afterwards as while the plant runs, bounded, the same for the same seed.

#![allow(clippy::unwrap_used)]

use std::time::Duration;

use profidrive_plant::{EventKind, Observed, ObservedQuantity, PlantPlan, Trace, World};
use profinet::Instant;
use proptest::prelude::*;

/// A press that loses its cable while it turns, beside a fan that stands.
const PLANT: &str = r#"
    duration = "3s"
    [[drive]]
    name = "press-1"
    ip = "10.0.0.1/24"
    event = [
        { at = "1.8s", do = "load=0.3Nm", for = "100ms" },
        { at = "2.2s", do = "cable=pulled", for = "100ms" },
    ]
    [[drive]]
    name = "fan-1"
    model = "vlt"
    ip = "10.0.0.2/24"
    event = [{ at = "1s", do = "fault=14" }]
    [[controller]]
    drive = "press-1"
    telegram = 1
    step = [
        { at = "0.5s", send = { STW1 = "0x047E" } },
        { at = "0.8s", send = { STW1 = "0x047F", NSOLL_A = "60rpm" } },
    ]
"#;

fn plant() -> PlantPlan {
    PLANT.parse().unwrap()
}

fn run(plant: &PlantPlan, limit: usize) -> Trace {
    let mut world = World::new(plant).unwrap();
    world.keep_trace(limit);
    world.run_until(Instant::ZERO + plant.duration.unwrap(), &mut drop);
    world.take_trace().unwrap()
}

#[test]
fn a_trace_has_every_event_of_the_run() {
    let plant = plant();
    let mut world = World::new(&plant).unwrap();
    world.keep_trace(Trace::USUAL_LIMIT);
    let mut events = Vec::new();
    world.run_until(Instant::ZERO + plant.duration.unwrap(), &mut |event| {
        events.push(event)
    });
    let trace = world.take_trace().unwrap();
    assert!(world.take_trace().is_none(), "it was taken");
    assert!(trace.events().eq(&events) && events.len() > 20);
    assert_eq!((trace.end(), trace.cut()), (Duration::from_secs(3), None));
    let fan = trace.of("fan-1").unwrap();
    let of_fan = events.iter().filter(|event| event.drive == "fan-1");
    assert!(fan.events().eq(of_fan) && fan.events().count() > 0);
    assert!(trace.of("fan-2").is_none());
}

#[test]
fn a_moment_has_the_words_and_values_that_the_events_have() {
    let trace = run(&plant(), Trace::USUAL_LIMIT);
    let press = trace.of("press-1").unwrap();
    let mut samples = 0;
    for event in press.events() {
        let EventKind::Sample(sample) = &event.kind else {
            continue;
        };
        samples += 1;
        let at = press.at(Duration::from_nanos(event.time_ns)).unwrap();
        assert_eq!((at.zsw1().0, at.stw1().0), (sample.zsw1, sample.stw1), "{event}");
        let speed = at.quantity(ObservedQuantity::LoadSpeed);
        assert!((speed - sample.speed).abs() < 1e-9, "{event}: {speed}");
    }
    assert!(samples > 5);
    let second = |seconds: f64| Duration::from_secs_f64(seconds);
    let at = |seconds: f64| trace.at(second(seconds)).unwrap().collect::<Vec<_>>();
    let [(press, before), (fan, _)] = at(0.99)[..] else {
        panic!("two drives");
    };
    assert_eq!((press, fan), ("press-1", "fan-1"));
    assert_eq!(before.connected(), Some(true));
    assert!((at(1.7)[0].1.quantity(ObservedQuantity::Speed) - 60.0).abs() < 1.0);
    assert!(at(0.99)[1].1.messages(false).is_empty());
    assert_eq!(at(1.01)[1].1.messages(false), [14]);
    assert_eq!(at(2.4)[0].1.messages(false), [702]);
    assert!(trace.at(second(3.001)).is_none(), "the run was over");
}

#[test]
fn only_changes_are_kept() {
    let plant: PlantPlan = "[[drive]]\nname = \"akd-1\"".parse().unwrap();
    let mut world = World::new(&plant).unwrap();
    world.keep_trace(Trace::USUAL_LIMIT);
    world.run_until(Instant::from_millis(3_600_000), &mut drop);
    let trace = world.take_trace().unwrap();
    let rest = trace.of("akd-1").unwrap();
    // the bus voltage settles in the first seconds
    assert!(rest.snapshots().len() < 1000, "{}", rest.snapshots().len());
    assert!(rest.at(Duration::from_secs(3600)).is_some());
}

#[test]
fn the_same_seed_has_the_same_digest_and_another_has_not() {
    let lossy = |seed: u64| {
        let loss = "event = [{ at = \"1s\", do = \"loss=10%\" },";
        let text = PLANT.replacen("event = [", loss, 1);
        run(
            &format!("seed = {seed}\n{text}").parse().unwrap(),
            Trace::USUAL_LIMIT,
        )
    };
    assert_eq!(lossy(7), lossy(7));
    assert_eq!(lossy(7).digest(), lossy(7).digest());
    assert_ne!(lossy(7).digest(), lossy(8).digest());
}

/// A full trace ends at a tick, has all until there, and says so.
#[test]
fn a_full_trace_is_the_beginning_of_the_whole_one() {
    let plant = plant();
    let whole = run(&plant, Trace::USUAL_LIMIT);
    let part = run(&plant, 30_000);
    let end = part.cut().unwrap();
    assert!(
        end > Duration::from_millis(100) && end < Duration::from_secs(3),
        "{end:?}"
    );
    let events = |trace: &Trace| trace.events().cloned().collect::<Vec<_>>();
    let (kept, all) = (events(&part), events(&whole));
    assert_eq!(kept[..], all[..kept.len()]);
    for drive in part.drives() {
        let same = whole.of(drive.name()).unwrap();
        assert!(
            drive
                .snapshots()
                .eq(same.snapshots().take(drive.snapshots().len()))
        );
    }
    let late = plant
        .expectations_of(r#"{ at = "2.9s", drive = "press-1", state = "S1" }"#)
        .unwrap();
    let results = part.expect(&late).unwrap();
    assert_eq!(results[0].outcome, profidrive_plant::Outcome::NotEnded);
    let nothing = run(&plant, 0);
    assert_eq!(
        (nothing.events().count(), nothing.cut()),
        (0, Some(Duration::ZERO))
    );
    assert!(nothing.at(Duration::ZERO).is_none());
}

#[test]
fn what_a_trace_does_not_have_is_an_error() {
    let trace = run(&plant(), Trace::USUAL_LIMIT);
    for text in [
        r#"{ at = "1s", drive = "press-1", parameter = { p922 = 1 } }"#,
        r#"{ within = "1s", after = { drive = "press-1", parameter = { p922 = 1 } }, drive = "press-1", state = "S1" }"#,
    ] {
        let error = trace.expect(&plant().expectations_of(text).unwrap()).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("`expectation 1` has a condition on a parameter"),
            "{error}"
        );
    }
    let more = format!("{PLANT}\n[[drive]]\nname = \"third\"");
    let more: PlantPlan = more.parse().unwrap();
    let other = more.expectations_of(r#"{ at = "1s", drive = "third", state = "S1" }"#);
    let error = trace.expect(&other.unwrap()).unwrap_err();
    assert!(error.to_string().contains("another plant"), "{error}");
}

fn condition() -> impl Strategy<Value = String> {
    let quantity = prop::sample::select(vec![
        ("speed", "rpm", 70),
        ("position", "rev", 2),
        ("current", "A", 2),
        ("torque", "Nm", 1),
        ("bus-voltage", "V", 700),
    ]);
    prop_oneof![
        (1_u8..6).prop_map(|state| format!("state = \"S{state}\"")),
        prop::sample::select(vec!["fault = \"none\"", "fault = \"any\"", "warning = \"any\""])
            .prop_map(str::to_owned),
        (
            prop::sample::select(vec!["connected", "moving", "homed"]),
            any::<bool>()
        )
            .prop_map(|(flag, is)| format!("{flag} = {is}")),
        (0_u16..16).prop_map(|bit| format!("zsw1 = \"0x{0:04X}/0x{0:04X}\"", 1 << bit)),
        (quantity, prop::sample::select(vec!["<", ">="]), 0..=100).prop_map(
            |((key, unit, full), sign, percent)| {
                format!("{key} = \"{sign}{}{unit}\"", f64::from(full * percent) / 100.0)
            }
        ),
    ]
}

fn expectation() -> impl Strategy<Value = String> {
    let ms = || 0_u32..3200;
    let drive = || prop::sample::select(vec!["press-1", "fan-1", "*"]);
    let time = prop_oneof![
        (ms(), 0_u32..200).prop_map(|(at, lasts)| format!("at = \"{at}ms\", for = \"{lasts}ms\"")),
        (ms(), ms(), 0_u32..200).prop_map(|(span, after, lasts)| {
            format!("within = \"{span}ms\", after = \"{after}ms\", for = \"{lasts}ms\"")
        }),
        (0_u32..500, drive(), condition()).prop_map(|(span, drive, condition)| {
            format!("within = \"{span}ms\", after = {{ drive = \"{drive}\", {condition} }}")
        }),
        (ms(), ms()).prop_map(|(from, more)| format!("always = \"{from}ms..{}ms\"", from + more)),
        ms().prop_map(|from| format!("never = \"{from}ms..\"")),
        Just("always = true".to_owned()),
    ];
    (time, drive(), condition())
        .prop_map(|(time, drive, condition)| format!("{{ {time}, drive = \"{drive}\", {condition} }}"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn expectations_afterwards_have_the_results_of_those_while_it_ran(
        texts in prop::collection::vec(expectation(), 40),
        end in 500_u64..3000,
        stride in 50_u64..700,
    ) {
        let plant = plant();
        let list = format!("expect = [{}]", texts.join(",\n"));
        let expectations = plant.expectations_of(&list).unwrap();
        let mut world = World::new(&plant).unwrap();
        world.keep_trace(Trace::USUAL_LIMIT);
        world.expect(&expectations, plant.seed);
        let end = Instant::from_millis(end);
        while world.now() < end {
            let until = (world.now() + Duration::from_millis(stride)).min(end);
            world.run_until(until, &mut drop);
        }
        let live = world.finish_expectations();
        let trace = world.take_trace().unwrap();
        prop_assert!(live.iter().any(|result| result.is_met()) && live.iter().any(|result| !result.is_met()));
        let after = trace.expect(&expectations).unwrap();
        for (live, after) in live.iter().zip(&after) {
            prop_assert_eq!(live, after);
        }
        prop_assert_eq!(live.len(), after.len());
    }
}
