//! Runs that go on until something is true of a drive.

#![allow(clippy::unwrap_used)]

use std::time::Duration;

use profidrive_plant::{Event, EventKind, NotMet, Outcome, PlantPlan, Trace, World};

const PLANT: &str = r#"
    [[drive]]
    name = "press-1"
    ip = "10.0.0.1/24"
    event = [{ at = "3s", do = "cable=pulled", for = "400ms" }]
    [[drive]]
    name = "press-2"
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

fn wait(world: &mut World, goal: &str, ms: u64) -> Result<Event, NotMet> {
    let goal = plant().goal(goal).unwrap();
    world.run_until_met(&goal, Duration::from_millis(ms), &mut drop)
}

#[test]
fn a_run_stops_at_the_moment_when_the_goal_is_met() {
    let mut world = World::new(&plant()).unwrap();
    let at_speed = wait(&mut world, r#"{ drive = "press-1", speed = ">=59.9rpm" }"#, 2000).unwrap();
    assert!((0.8..1.5).contains(&at_speed.time), "{at_speed}");
    assert!(
        matches!(at_speed.kind, EventKind::Sample(sample) if sample.speed > 55.0),
        "{at_speed}"
    );
    assert_eq!(
        world.now(),
        profinet::Instant::ZERO + Duration::from_nanos(at_speed.time_ns)
    );
    let lost = wait(&mut world, r#"{ drive = "press-1", fault = 702 }"#, 3000).unwrap();
    assert!((3.0..3.06).contains(&lost.time), "{lost}");
    assert!(
        matches!(&lost.kind, EventKind::FaultRaised { fault } if fault.number == 702),
        "{lost}"
    );
    // it holds already: no time passes
    let again = wait(&mut world, r#"{ drive = "press-1", fault = 702 }"#, 0).unwrap();
    assert_eq!(again.time_ns, lost.time_ns);
}

#[test]
fn two_who_wait_do_not_end_the_wait_of_each_other() {
    let mut world = World::new(&plant()).unwrap();
    let long = plant().goal(r#"{ drive = "press-1", fault = 702 }"#).unwrap();
    let mut outer = world.pursue(&long, Duration::from_secs(2));
    wait(&mut world, r#"{ drive = "press-1", state = "S4" }"#, 2000).unwrap();
    assert!(world.pursues(&mut outer).is_some(), "the fault comes at 3 s");
    let end = profinet::Instant::ZERO + Duration::from_secs(2);
    world.run_until(end, &mut drop);
    assert!(world.pursues(&mut outer).is_none());
    let lost = world.end_pursuit(&outer, None).unwrap_err();
    assert_eq!(lost.0.outcome, Outcome::NotMet);
    // it was ended
    assert!(world.end_pursuit(&outer, None).is_err());
}

#[test]
fn a_goal_that_must_last_is_waited_for() {
    let mut world = World::new(&plant()).unwrap();
    let goal = r#"{ drive = "press-1", speed = "59rpm..61rpm", for = "300ms" }"#;
    let event = wait(&mut world, goal, 2000).unwrap();
    let mut other = World::new(&plant()).unwrap();
    let first = wait(
        &mut other,
        r#"{ drive = "press-1", speed = "59rpm..61rpm" }"#,
        2000,
    )
    .unwrap();
    assert!(
        event.time >= first.time + 0.3 && event.time < 2.0,
        "{event} {first}"
    );
    // the cable is pulled before it was true for so long
    let longer = r#"{ drive = "press-1", speed = "59rpm..61rpm", for = "5s" }"#;
    assert!(wait(&mut world, longer, 500).is_err());
}

#[test]
fn a_goal_that_is_not_met_has_the_nearest_value() {
    let mut world = World::new(&plant()).unwrap();
    let NotMet(result) = wait(&mut world, r#"{ drive = "press-1", speed = ">=130rpm" }"#, 2000).unwrap_err();
    assert_eq!((result.outcome, result.time), (Outcome::NotMet, 2.0));
    assert!((59.0..62.0).contains(&result.nearest.unwrap().value));
    assert_eq!(world.now(), profinet::Instant::from_millis(2000));
    let text = NotMet(
        wait(&mut world, r#"{ drive = "press-2", connected = true }"#, 10)
            .unwrap_err()
            .0,
    )
    .to_string();
    assert!(
        text.contains(r#"within = "0.01s", after = "2s", drive = "press-2", connected = true"#),
        "{text}"
    );
}

#[test]
fn waiting_changes_neither_the_run_nor_its_trace() {
    let run = |waits: bool| {
        let mut world = World::new(&plant()).unwrap();
        world.keep_trace(Trace::USUAL_LIMIT);
        if waits {
            let _ = wait(&mut world, r#"{ drive = "press-1", speed = ">=50rpm" }"#, 2000).unwrap();
            let _ = wait(&mut world, r#"{ drive = "press-1", speed = ">=500rpm" }"#, 200).unwrap_err();
        }
        world.run_until(profinet::Instant::from_millis(4000), &mut drop);
        (world.trace_hash(), world.take_trace().unwrap())
    };
    let ((frames, one), (same_frames, other)) = (run(false), run(true));
    assert_eq!(frames, same_frames);
    assert!(one.events().eq(other.events()));
    for drive in one.drives() {
        assert!(drive.snapshots().eq(other.of(drive.name()).unwrap().snapshots()));
    }
    assert_eq!(one.digest(), other.digest());
}

#[test]
fn mistakes_of_a_goal_have_their_reason() {
    for (text, reason) in [
        (r#"{ fault = 702 }"#, "one drive"),
        (r#"{ drive = "press-*", fault = 702 }"#, "one drive"),
        (r#"{ drive = "press-1" }"#, "no condition"),
        (r#"{ drive = "press-3", fault = 702 }"#, "no drive `press-3`"),
        (
            r#"{ drive = "press-1", within = "1s", fault = 702 }"#,
            "unknown key `within`",
        ),
        (r#"{ drive = "press-1", speed = "60rpm" }"#, "tolerance"),
        (r#"1"#, "table"),
        ("{ drive = \"press-1\", fault = 702 }\nmore = 1", "one table"),
        (r#"{ drive = "#, ""),
        ("", ""),
    ] {
        let error = plant().goal(text).unwrap_err().to_string();
        assert!(error.contains(reason), "{text}: {error}");
    }
}
