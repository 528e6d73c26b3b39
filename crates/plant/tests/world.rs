//! Whole plants in virtual time.
#![allow(clippy::unwrap_used, clippy::panic)] // a test reports by panicking

use std::time::Duration;

use profidrive_plant::{Event, EventKind, PlantPlan, Sample, World};
use profinet::Instant;

/// Returns a run at 60 rpm under telegram 1, with these events of the drive.
fn plant(seed: u64, events: &str) -> PlantPlan {
    format!(
        r#"
        seed = {seed}
        [[drive]]
        name = "press-1"
        ip = "10.0.0.1/24"
        event = [{events}]
        [[controller]]
        drive = "press-1"
        telegram = 1
        step = [
            {{ at = "0.5s", send = {{ STW1 = "0x047E" }} }},
            {{ at = "1s", send = {{ STW1 = "0x047F", NSOLL_A = "60rpm" }} }},
            {{ at = "7s", send = {{ STW1 = "0x04FE" }} }},
            {{ at = "7.2s", send = {{ STW1 = "0x047E" }} }},
            {{ at = "7.5s", send = {{ STW1 = "0x047F" }} }},
        ]
        "#
    )
    .parse()
    .unwrap()
}

/// Plays ten seconds; the trace and the hash of all frames.
fn play(plant: &PlantPlan) -> (Vec<Event>, u64) {
    let mut world = World::new(plant).unwrap();
    let mut trace = Vec::new();
    world.run_until(Instant::from_millis(10_000), &mut |entry| trace.push(entry));
    (trace, world.trace_hash())
}

/// Returns the time when the trace first says this.
fn first_entry(trace: &[Event], words: &str) -> Option<Duration> {
    let found = trace.iter().find(|entry| entry.to_string().contains(words));
    found.map(|entry| Duration::from_nanos(entry.time_ns))
}

#[test]
fn the_same_seed_gives_the_same_trace_and_the_same_frames() {
    let events = r#"{ at = "2s", do = "loss=10%" }, { at = "2s", do = "jitter=3ms" }"#;
    let (first, frames) = play(&plant(7, events));
    assert_eq!(play(&plant(7, events)), (first.clone(), frames));
    let (_, others) = play(&plant(8, events));
    assert_ne!(others, frames);
    assert!(first_entry(&first, "S4 operation").is_some());
}

#[test]
fn a_pulled_cable_ends_in_a_stop_and_everybody_finds_back() {
    let (trace, _) = play(&plant(1, r#"{ at = "3s", do = "cable=pulled", for = "500ms" }"#));
    let fault = first_entry(&trace, "fault F702").unwrap();
    assert!(
        fault > Duration::from_secs(3) && fault < Duration::from_millis(3100),
        "{fault:?}"
    );
    assert!(first_entry(&trace, "controller: connection lost").is_some());
    assert!(first_entry(&trace, "! cable=plugged").unwrap() == Duration::from_millis(3500));
    let acknowledged = first_entry(&trace, "bit 0 = 1 is gone").unwrap();
    assert!(acknowledged > Duration::from_secs(7));
    let again = trace
        .iter()
        .filter(|entry| entry.to_string().contains("-> S4 operation"));
    assert_eq!(again.count(), 2, "runs again after the acknowledge");
}

#[test]
fn a_place_on_the_way_lets_things_happen() {
    let (trace, _) = play(&plant(1, r#"{ position = "2.5rev", do = "fault=439" }"#));
    let happened = first_entry(&trace, "! fault=439").unwrap();
    // one revolution in a second, from second 1 on
    let due = Duration::from_millis(3500);
    assert!(
        happened.abs_diff(due) < Duration::from_millis(100),
        "{happened:?}"
    );
    assert!(first_entry(&trace, "fault F439").unwrap() >= happened);
}

#[test]
fn physical_causes_have_their_effects() {
    for (event, words) in [
        (r#"{ at = "3s", do = "sto=on" }"#, "fault F602"),
        (r#"{ at = "3s", do = "bus=900V", for = "1s" }"#, "fault F501"),
        (r#"{ at = "3s", do = "feedback=lost" }"#, "fault F408"),
        (r#"{ at = "3s", do = "limit+=on" }"#, "warning n107"),
    ] {
        let (trace, _) = play(&plant(1, event));
        let at = first_entry(&trace, words).unwrap_or_else(|| panic!("{event}"));
        assert!(
            at >= Duration::from_secs(3) && at < Duration::from_secs(4),
            "{event}: {at:?}"
        );
    }
    let (trace, _) = play(&plant(1, r#"{ at = "3s", do = "load=0.5Nm", for = "1s" }"#));
    assert!(first_entry(&trace, "! load=0Nm").is_some());
    assert!(first_entry(&trace, "fault").is_none(), "a small load is held");
}

/// A relative task that follows itself at each event (MT.CNTL: relative, followed, event): a turn for each edge at DIN1.
#[test]
fn edges_at_a_digital_input_lead_a_chain_of_tasks_on() {
    let text = r#"
        sample = "100ms"
        [[drive]]
        name = "feeder-1"
        ip = "10.0.0.1/24"
        parameters = { 930 = 2, "HOME.MODE" = 0, "HOME.AUTOMOVE" = 1, "DIN1.MODE" = 2, "MT.NUM" = 1, "MT.P" = 65536, "MT.V_32" = "600rpm", "MT.ACC" = "6000rpm/s", "MT.DEC" = "6000rpm/s", "MT.CNTL" = 0x53, "MT.MTNEXT" = 1, "MT.SET" = 1 }
        event = [
            { at = "4s", do = "input=1:on", for = "200ms" },
            { at = "6s", do = "input=1:on" },
            { at = "8s", do = "input=1:off" },
        ]
        [[controller]]
        drive = "feeder-1"
        telegram = 7
        step = [
            { at = "0.5s", send = { STW1 = "0x043E" } },
            { at = "1s", send = { STW1 = "0x043F" } },
            { at = "2s", send = { STW1 = "0x047F", SATZANW = 1 } },
        ]
    "#;
    let (trace, _) = play(&text.parse().unwrap());
    let place = |seconds: f64| {
        let at = Instant::ZERO + Duration::from_secs_f64(seconds);
        let values = trace.iter().rev().find_map(|entry| match &entry.kind {
            EventKind::Sample(Sample { position, .. })
                if Duration::from_nanos(entry.time_ns) <= at - Instant::ZERO =>
            {
                Some(*position)
            }
            _ => None,
        });
        values.unwrap()
    };
    for (seconds, turns) in [(1.9, 0.0), (3.9, 1.0), (5.9, 2.0), (7.9, 3.0), (9.9, 3.0)] {
        let place = place(seconds);
        assert!((place - turns).abs() < 0.005, "{seconds} s: {place}");
    }
    assert!(first_entry(&trace, "! input=1:on for 0.2 s").is_some());
    assert!(first_entry(&trace, "! input=1:off").is_some());
}

#[test]
fn samples_come_when_they_are_due() {
    let text = r#"
        sample = "100ms"
        [[drive]]
        name = "press-1"
    "#;
    let (trace, _) = play(&text.parse().unwrap());
    let times: Vec<_> = trace
        .iter()
        .map(|entry| Duration::from_nanos(entry.time_ns))
        .collect();
    let due: Vec<_> = (1..=100).map(|n| Duration::from_millis(100 * n)).collect();
    assert_eq!(times, due);
}

#[test]
fn a_refused_start_parameter_is_reported() {
    let text = r#"
        [[drive]]
        name = "press-1"
        ip = "10.0.0.1/30"
        parameters = { 930 = 7 }
    "#;
    let error = text.parse::<PlantPlan>().unwrap_err();
    assert_eq!(error.line, 5);
    let error = error.to_string();
    assert!(error.contains("press-1") && error.contains("refused"), "{error}");
}

/// Speeds of converters in rpm and percent, by the reference that the drive of the plant has; their modules are proper.
#[test]
fn a_converter_is_run_at_a_speed() {
    for (model, telegram, parameters, speed) in [
        ("vacon", 1, r#"ID103 = "0.5s""#, r#""600rpm""#),
        ("vacon", 1, r#"ID103 = "0.5s", ID102 = "60Hz""#, r#""600rpm""#),
        ("vacon", 149, r#"ID103 = "0.5s", ID101 = "10Hz""#, r#""600rpm""#),
        ("vacon", 148, r#"ID103 = "0.5s""#, r#""40%""#),
        ("vacon", 148, r#"ID103 = "0.5s""#, "4000"),
        ("vlt", 1, r#"3-41 = "0.5s""#, r#""600rpm""#),
        ("vlt", 1, r#"3-41 = "0.5s""#, r#""40%""#),
    ] {
        let plant = format!(
            r#"
            [[drive]]
            model = "{model}"
            name = "fan-1"
            ip = "10.0.0.1/24"
            parameters = {{ {parameters} }}
            [[controller]]
            drive = "fan-1"
            telegram = {telegram}
            step = [
                {{ at = "0.5s", send = {{ STW1 = "0x047E" }} }},
                {{ at = "1s", send = {{ STW1 = "0x047F", NSOLL_A = {speed} }} }},
            ]
            "#
        );
        let plan = plant.parse().unwrap_or_else(|error| panic!("{plant}: {error}"));
        let mut world = World::new(&plan).unwrap();
        let mut trace = Vec::new();
        world.run_until(Instant::from_millis(6000), &mut |entry| trace.push(entry));
        let speed = world.drive(0).unwrap().drive().axis().speed();
        assert!((speed - 600.0).abs() < 12.0, "{plant}: {speed}");
        assert!(
            first_entry(&trace, "controller: connected").is_some(),
            "{trace:?}"
        );
        assert!(
            first_entry(&trace, "the modules differ").is_none(),
            "nothing differs: {trace:?}"
        );
    }
}

#[test]
fn a_step_is_done_again_and_again() {
    let text = |every: &str| {
        format!(
            r#"
            [[drive]]
            name = "press-1"
            ip = "10.0.0.1/24"
            [[drive]]
            name = "new-1"
            unnamed = true
            [[controller]]
            drive = "press-1"
            telegram = 1
            step = [
                {{ at = "0.5s", send = {{ STW1 = "0x047E" }} }},
                {{ at = "0.6s", send = {{ STW1 = "0x047F" }} }},
                {{ at = "1s", every = "{every}", send = {{ NSOLL_A = "60rpm" }} }},
                {{ at = "2s", every = "{every}", send = {{ NSOLL_A = 0 }} }},
            ]
            "#
        )
    };
    let plan = text("2s").parse().unwrap();
    let mut world = World::new(&plan).unwrap();
    let mut speeds = Vec::new();
    for half_seconds in [3, 5, 7, 9, 11, 13] {
        world.run_until(Instant::from_millis(500 * half_seconds), &mut |_| {});
        speeds.push(world.drive(0).unwrap().drive().axis().speed().round());
    }
    assert_eq!(speeds, [60.0, 0.0, 60.0, 0.0, 60.0, 0.0]);
    assert_eq!(plan.drives[1].config().network.name, "");
    let error = text("0s").parse::<PlantPlan>().unwrap_err();
    assert!(
        error
            .to_string()
            .contains("`0s`: a step is repeated every 1 ms at the fastest"),
        "{error}"
    );
}

/// VLT 3-41 by the parameter channel of PPO type 1: one event for a request that stands for many cycles, none for the
/// first parameters.
#[test]
fn a_written_parameter_is_an_event_with_its_value_and_channel() {
    let text = r#"
        [[drive]]
        name = "fan-1"
        model = "vlt"
        ip = "10.0.0.1/24"
        parameters = { "3-42" = "3s" }
        [[controller]]
        drive = "fan-1"
        telegram = 101
        step = [
            { at = "1s", words = [0x3155, 0, 0, 250, 0x047E, 0] },
            { at = "2s", words = [0, 0, 0, 0, 0x047E, 0] },
        ]
    "#;
    let (trace, _) = play(&text.parse().unwrap());
    let written: Vec<_> = trace
        .iter()
        .filter(|event| matches!(event.kind, EventKind::ParameterWritten { .. }))
        .collect();
    let [event] = &written[..] else {
        panic!("{written:?}");
    };
    assert!((1.0..1.1).contains(&event.time), "{event}");
    let fields = serde_json::to_value(event).unwrap();
    assert_eq!(fields["event"], "parameter_written");
    assert_eq!(fields["by"], "pkw");
    let reading = serde_json::json!({
        "name": "Ramp 1 Ramp up Time", "parameter": "3-41", "pnu": 341, "index": 0,
        "value": 2.5, "unit": "s", "raw": 250, "text": null,
    });
    assert_eq!(fields["reading"], reading);
    let words = "3-41 Ramp 1 Ramp up Time = 2.5 s, written by the parameter channel";
    assert_eq!(event.kind.to_string(), words);
}
