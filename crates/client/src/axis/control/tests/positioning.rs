//! Tasks, intermediate stop, homing and jog of a drive in position mode.

use super::*;
use profile::state::Mode;

const OFF: Stw1 = Stw1(0x043E);
const IDLE: Stw1 = Stw1(0x043F);
const EDGE: Stw1 = Stw1(0x047F);
const PAUSED: Stw1 = Stw1(0x041F);
const DISCARD: Stw1 = Stw1(0x040F);
const HOMING: Stw1 = Stw1(0x0C3F);

fn to(target: i32) -> Goal {
    Goal::Traverse(Traverse::absolute(target).with_speed(1000, 5, 5))
}

fn positioner(bench: &mut Bench) -> &mut crate::axis::model::Positioner {
    bench.positioner.as_mut().unwrap()
}

#[test]
fn a_task_by_the_handshake_of_the_manual() {
    let mut bench = Bench::positioning();
    bench.pursue(to(5000));
    while !bench.is_accepted() {
        bench.cycles(1);
        assert_eq!(bench.progress(), Progress::Pursuing);
    }
    assert!(positioner(&mut bench).position < 5000);
    bench.until(Progress::Reached);
    assert_eq!(positioner(&mut bench).position, 5000);
    assert_eq!(positioner(&mut bench).accepted, [5000]);
    bench.pursue(Goal::Stop);
    bench.until(Progress::Reached);
    assert_eq!(bench.words(), [OFF, IDLE, EDGE, IDLE, OFF]);
}

#[test]
fn values_stand_before_the_edge_and_presets_before_operation() {
    let mut bench = Bench::positioning();
    bench.pursue(to(-700));
    bench.until(Progress::Reached);
    let idle = &positioner(&mut bench).idle_targets;
    assert!(
        idle.iter().skip(1).all(|&target| target == 1234),
        "where the axis stands: {idle:?}"
    );
    // at rest again the preset follows the axis
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    assert_eq!(bench.command().traverse.target, -700);
}

#[test]
fn relative_tasks_and_tasks_of_the_drive() {
    let mut bench = Bench::positioning();
    bench.pursue(Goal::Traverse(Traverse::relative(100).with_speed(1000, 5, 5)));
    bench.until(Progress::Reached);
    assert_eq!(positioner(&mut bench).position, 1334);
    bench.pursue(Goal::Traverse(Traverse::task(3)));
    bench.until(Progress::Reached);
    assert_eq!(positioner(&mut bench).position, 500);
    assert_eq!(bench.command().traverse.satzanw, 3);
}

#[test]
fn change_on_the_fly() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    assert!(bench.is_accepted());
    let before = positioner(&mut bench).position;
    bench.pursue(to(0));
    bench.until(Progress::Reached);
    assert!(before > 1234);
    assert_eq!(positioner(&mut bench).accepted, [50_000, 0]);
    assert_eq!(positioner(&mut bench).position, 0);
    assert_eq!(bench.words(), [OFF, IDLE, EDGE, IDLE, EDGE, IDLE]);
}

#[test]
fn a_pause_keeps_the_task_and_enabled_discards_it() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    bench.pursue(Goal::Pause);
    bench.until(Progress::Reached);
    let stopped_at = positioner(&mut bench).position;
    bench.cycles(100);
    assert_eq!(positioner(&mut bench).position, stopped_at);
    bench.pursue(to(50_000));
    bench.until(Progress::Reached);
    assert_eq!(positioner(&mut bench).position, 50_000);
    assert_eq!(
        positioner(&mut bench).accepted,
        [50_000],
        "the same task, no new edge"
    );
    bench.pursue(to(0));
    bench.cycles(60);
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    let stopped_at = positioner(&mut bench).position;
    bench.cycles(100);
    assert_eq!(positioner(&mut bench).position, stopped_at, "not taken up again");
    assert_eq!(
        bench.words(),
        [
            OFF, IDLE, EDGE, IDLE, PAUSED, IDLE, EDGE, IDLE, PAUSED, DISCARD, IDLE
        ]
    );
}

#[test]
fn a_pause_without_a_task_holds_none() {
    let mut bench = Bench::positioning();
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    bench.pursue(Goal::Pause);
    bench.until(Progress::Reached);
    assert_eq!(bench.held(), None);
    bench.pursue(to(5000));
    bench.until(Progress::Reached);
    bench.pursue(Goal::Pause);
    assert_eq!(bench.held(), None, "at its target it is over");
    bench.pursue(to(0));
    bench.cycles(60);
    bench.pursue(Goal::Pause);
    assert!(bench.held().is_some_and(|task| task.target == 0));
}

#[test]
fn a_task_just_accepted_is_discarded_though_the_axis_still_stands() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    while !bench.is_accepted() {
        bench.cycles(1);
    }
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    assert!(bench.words().ends_with(&[PAUSED, DISCARD, IDLE]));
    let stopped_at = positioner(&mut bench).position;
    bench.cycles(100);
    assert_eq!(positioner(&mut bench).position, stopped_at);
}

#[test]
fn a_task_that_is_not_accepted_ends_in_a_stop() {
    for homed in [true, false] {
        let mut bench = Bench::positioning();
        positioner(&mut bench).refuses = true;
        positioner(&mut bench).homed = homed;
        bench.pursue(to(5000));
        bench.until(Progress::Failed(Trouble::NotAccepted { homed }));
        bench.cycles(50);
        assert!(bench.is_at_rest() || bench.state() == State::S2);
        assert_eq!(positioner(&mut bench).position, 1234);
        assert_eq!(bench.words(), [OFF, IDLE, EDGE, OFF]);
    }
    let text = Trouble::NotAccepted { homed: false }.to_string();
    assert!(
        text.ends_with("the axis is not homed (ZSW1 bit 11 is 0)"),
        "{text}"
    );
}

#[test]
fn an_acknowledge_that_does_not_go_back_is_no_acknowledge() {
    let mut bench = Bench::positioning();
    positioner(&mut bench).acknowledges_for_ever = true;
    bench.pursue(to(5000));
    bench.until(Progress::Reached);
    bench.pursue(to(6000));
    bench.until(Progress::Failed(Trouble::AcceptanceStays));
    assert_eq!(positioner(&mut bench).accepted, [5000]);
}

#[test]
fn an_axis_that_stops_before_its_target_is_reported() {
    let mut bench = Bench::positioning();
    positioner(&mut bench).barrier = Some(3000);
    bench.pursue(to(50_000));
    bench.until(Progress::Failed(Trouble::TargetNotReached));
    assert_eq!(bench.command().stw1, OFF);
}

#[test]
fn faults_and_lost_operation_end_a_task() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    bench.fail(true);
    bench.cycles(2);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::Fault));
    assert_eq!(bench.command().stw1, OFF);
    bench.fail(false);
    bench.pursue(Goal::Acknowledge);
    bench.until(Progress::Reached);
    assert!(!bench.seen().fault());
    bench.pursue(to(0));
    bench.cycles(60);
    bench.coast();
    bench.cycles(2);
    assert!(matches!(
        bench.progress(),
        Progress::Failed(Trouble::LeftOperation { .. })
    ));
    bench.cycles(100);
    assert_eq!(bench.command().stw1, OFF, "not switched on again");
}

#[test]
fn an_axis_that_fell_out_of_operation_is_not_switched_on_by_the_next_wish() {
    let mut bench = Bench::positioning();
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    bench.coast();
    bench.pursue(to(0));
    bench.cycles(3);
    assert!(matches!(
        bench.progress(),
        Progress::Failed(Trouble::LeftOperation { .. })
    ));
}

#[test]
fn homing_is_done_when_the_bits_went_and_came_back() {
    let mut bench = Bench::positioning();
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.cycles(10);
    assert_eq!(
        bench.progress(),
        Progress::Pursuing,
        "homed before is not homed now"
    );
    bench.until(Progress::Reached);
    assert!(positioner(&mut bench).homed);
    assert_eq!(positioner(&mut bench).position, 0);
    bench.cycles(5);
    assert_eq!(bench.words(), [OFF, IDLE, HOMING, IDLE]);
    let mut bench = Bench::positioning();
    positioner(&mut bench).homed = false;
    positioner(&mut bench).homes_on_the_spot = true;
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.until(Progress::Reached);
}

#[test]
fn homing_in_place_must_be_declared() {
    for (on_the_spot, end) in [
        (true, Progress::Reached),
        (false, Progress::Failed(Trouble::HomingNotStarted)),
    ] {
        let mut bench = Bench::positioning();
        positioner(&mut bench).homes_on_the_spot = true;
        bench.pursue(Goal::Home { on_the_spot });
        bench.until(end);
    }
}

#[test]
fn homing_that_does_not_begin_or_fails_is_reported_and_stopped() {
    let mut bench = Bench::positioning();
    positioner(&mut bench).ignores_homing = true;
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.until(Progress::Failed(Trouble::HomingNotStarted));
    let mut bench = Bench::positioning();
    positioner(&mut bench).homing_fails = true;
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.until(Progress::Failed(Trouble::HomingFailed));
    assert_eq!(bench.command().stw1, OFF);
    // given up by the caller: bit 11 goes, the home position stays unset
    let mut bench = Bench::positioning();
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.cycles(20);
    bench.pursue(Goal::Enabled);
    bench.until(Progress::Reached);
    assert!(!positioner(&mut bench).homed);
    assert!(bench.words().ends_with(&[HOMING, PAUSED, DISCARD, IDLE]));
}

#[test]
fn homing_waits_for_a_task_to_end() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    bench.pursue(Goal::Home { on_the_spot: false });
    bench.until(Progress::Reached);
    assert_eq!(
        bench.words(),
        [OFF, IDLE, EDGE, IDLE, PAUSED, DISCARD, HOMING, IDLE]
    );
}

#[test]
fn jog_after_a_task_and_a_task_after_a_jog() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    bench.pursue(Goal::Jog(Jog::One));
    bench.until(Progress::Reached);
    bench.cycles(20);
    bench.pursue(to(0));
    bench.until(Progress::Reached);
    assert_eq!(positioner(&mut bench).position, 0);
    let jog = DISCARD.with(Stw1::JOG_1);
    assert_eq!(
        bench.words(),
        [
            OFF, IDLE, EDGE, IDLE, PAUSED, DISCARD, jog, PAUSED, DISCARD, IDLE, EDGE, IDLE
        ]
    );
}

#[test]
fn a_goal_of_the_other_mode_is_refused() {
    for (mut bench, goal, needed) in [
        (Bench::new(), to(5), Mode::Position),
        (Bench::new(), Goal::Home { on_the_spot: true }, Mode::Position),
        (Bench::positioning(), Goal::Run { setpoint: 5 }, Mode::Velocity),
    ] {
        bench.pursue(goal);
        bench.until(Progress::Failed(Trouble::OtherMode { needed }));
        bench.cycles(100);
        assert!(bench.words().iter().all(|stw1| !stw1.has(Stw1::ON)), "{goal:?}");
    }
}

#[test]
fn inputs_that_become_bad_stop_a_task() {
    let mut bench = Bench::positioning();
    bench.pursue(to(50_000));
    bench.cycles(60);
    bench.inputs_valid(false);
    bench.cycles(1);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::NoInputs));
    assert_eq!(bench.command().stw1, OFF);
}
