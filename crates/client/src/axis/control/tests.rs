//! The control against the bench.

use super::*;
use crate::axis::model::Bench;
use profile::state::Zsw1;

mod positioning;

#[test]
fn runs_and_stops() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    assert_eq!(
        bench.command(),
        Command {
            stw1: Stw1::RUN,
            nsoll_a: 100,
            ..Command::default()
        }
    );
    bench.cycles(60);
    assert_eq!(bench.speed(), 100);
    bench.pursue(Goal::Run { setpoint: -50 });
    assert_eq!(bench.progress(), Progress::Reached);
    bench.cycles(60);
    assert_eq!(bench.speed(), -50);
    bench.pursue(Goal::Stop);
    bench.until(Progress::Reached);
    assert_eq!(bench.speed(), 0);
    assert_eq!(bench.words(), [Stw1::READY, Stw1::RUN, Stw1::READY]);
}

#[test]
fn the_words_are_those_of_the_manuals() {
    let words = [QUICK_STOP, COAST_STOP, INPUT_ZERO, JOG_READY, RELEASED];
    assert_eq!(words, [0x047A, 0x047C, 0x043F, 0x040F, 0].map(Stw1));
}

#[test]
fn an_axis_that_is_ended_only_stops() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 300 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.end();
    bench.pursue(Goal::Stop);
    bench.cycles(5);
    bench.pursue(Goal::Enabled);
    bench.pursue(Goal::Run { setpoint: 300 });
    bench.until(Progress::Reached);
    assert_eq!(bench.speed(), 0);
    bench.pursue(Goal::Released);
    bench.pursue(Goal::Ready);
    bench.cycles(5);
    assert_eq!(bench.command().stw1, RELEASED);
}

#[test]
fn a_run_during_the_ramp_stop_takes_it_back() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 300 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.pursue(Goal::Stop);
    bench.pursue(Goal::Run { setpoint: 300 });
    bench.until(Progress::Reached);
    bench.cycles(2);
    assert!(bench.speed() > 0, "not stopped in between");
    bench.cycles(60);
    assert_eq!((bench.progress(), bench.speed()), (Progress::Reached, 300));
}

#[test]
fn no_setpoint_before_operation() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 1000 });
    while bench.state() != State::S4 {
        assert_eq!(bench.command().nsoll_a, 0);
        bench.cycles(1);
    }
}

#[test]
fn jog_after_run_waits_for_standstill() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 200 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.pursue(Goal::Jog(Jog::Two));
    bench.until(Progress::Reached);
    bench.cycles(40);
    assert_eq!(bench.speed(), -40, "the jog setpoint of the bench");
    bench.pursue(Goal::Stop);
    bench.until(Progress::Reached);
    assert_eq!(
        bench.words(),
        [
            Stw1::READY,
            Stw1::RUN,
            INPUT_ZERO,
            JOG_READY,
            JOG_READY | Stw1::JOG_2,
            Stw1::READY
        ]
    );
}

#[test]
fn fault_is_reported_stopped_and_acknowledged_by_an_edge() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.fail(true);
    bench.cycles(2);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::Fault));
    assert_eq!(bench.command().stw1, Stw1::READY);
    bench.pursue(Goal::Acknowledge);
    bench.until(Progress::Failed(Trouble::FaultStays));
    bench.fail(false);
    bench.pursue(Goal::Acknowledge);
    bench.until(Progress::Reached);
    assert!(!bench.seen().fault());
    assert_eq!(bench.command().stw1, Stw1::READY);
}

#[test]
fn is_not_switched_on_again_by_itself() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.coast();
    bench.cycles(200);
    assert!(matches!(
        bench.progress(),
        Progress::Failed(Trouble::LeftOperation { .. })
    ));
    assert_eq!(bench.command().stw1, Stw1::READY);
}

#[test]
fn a_stop_that_does_not_end_becomes_a_quick_stop() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.never_ramps_down();
    bench.pursue(Goal::Stop);
    bench.cycles(2000);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::QuickStopUsed));
    assert_eq!(bench.words().last(), Some(&QUICK_STOP));
    assert_eq!(bench.speed(), 0);
}

#[test]
fn inputs_that_are_not_valid_any_more_stop_the_axis() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.inputs_valid(false);
    bench.cycles(1);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::NoInputs));
    assert_eq!(bench.command(), word(Stw1::READY));
    bench.cycles(100);
    assert_eq!(bench.speed(), 0);
    assert!(!bench.is_at_rest(), "nothing says so");
    bench.inputs_valid(true);
    bench.cycles(10);
    assert!(bench.is_at_rest());
    assert_eq!(bench.words(), [Stw1::READY, Stw1::RUN, Stw1::READY]);
    // nor does the end of a stop need them
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.pursue(Goal::Stop);
    bench.inputs_valid(false);
    bench.until(Progress::Failed(Trouble::NotStopped));
    assert!(bench.is_at_rest() && bench.words().ends_with(&[Stw1::READY, QUICK_STOP]));
}

#[test]
fn inputs_that_never_become_valid_are_not_waited_for_for_ever() {
    for goal in [
        Goal::Ready,
        Goal::Acknowledge,
        Goal::Run { setpoint: 5 },
        Goal::Jog(Jog::One),
    ] {
        let mut bench = Bench::new();
        bench.inputs_valid(false);
        bench.pursue(goal);
        bench.until(Progress::Failed(Trouble::NoInputs));
        assert!(bench.words().iter().all(|stw1| !stw1.has(Stw1::ON)), "{goal:?}");
        bench.pursue(Goal::Stop);
        assert!(bench.is_at_rest(), "never switched on: nothing to wait for");
    }
}

#[test]
fn a_jog_does_not_wait_for_ever_for_standstill() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    bench.never_slows_down();
    bench.pursue(Goal::Jog(Jog::One));
    bench.until(Progress::Failed(Trouble::NotStopped));
    assert_eq!(bench.command(), word(Stw1::READY));
}

#[test]
fn a_quick_stop_is_not_taken_back_by_another_wish_to_stop() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 1000 });
    bench.until(Progress::Reached);
    bench.cycles(150);
    bench.never_ramps_down();
    bench.pursue(Goal::Stop);
    bench.until(Progress::Failed(Trouble::QuickStopUsed));
    // as an axis does that goes out of scope after the error
    bench.pursue(Goal::Stop);
    bench.until(Progress::Reached);
    assert_eq!((bench.speed(), bench.is_at_rest()), (0, true));
    assert_eq!(bench.words(), [Stw1::READY, Stw1::RUN, Stw1::READY, QUICK_STOP]);
}

#[test]
fn a_coasting_axis_rests_once_it_stands_for_a_while() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 1000 });
    bench.until(Progress::Reached);
    bench.cycles(150);
    bench.stop_by(StopKind::Coast);
    bench.cycles(5);
    assert_eq!(bench.state(), State::S1, "the pulses are off");
    assert!(bench.speed() > 900 && !bench.is_at_rest(), "which is no rest");
    // neither a ramp stop nor a quick stop takes it back
    bench.pursue(Goal::Stop);
    bench.stop_by(StopKind::Quick);
    while bench.speed() > 0 {
        assert!(!bench.is_at_rest());
        bench.cycles(1);
    }
    let rest = Limits::default().rest.as_millis() / 16;
    bench.cycles(u32::try_from(rest).unwrap() - 1);
    assert!(!bench.is_at_rest(), "it has to stand for a while");
    bench.cycles(5);
    assert!(bench.is_at_rest());
    assert_eq!(bench.words(), [Stw1::READY, Stw1::RUN, COAST_STOP]);
    // and it runs again only by a new goal
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.until(Progress::Reached);
    bench.cycles(50);
    assert_eq!(bench.speed(), 100);
}

#[test]
fn an_axis_that_coasts_for_ever_is_reported() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Run { setpoint: 1000 });
    bench.until(Progress::Reached);
    bench.cycles(150);
    bench.never_rubs();
    bench.stop_by(StopKind::Coast);
    bench.cycles(20);
    bench.inputs_valid(false);
    bench.cycles(20);
    assert!(!bench.is_at_rest(), "nothing says so");
    bench.inputs_valid(true);
    bench.cycles(4000);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::StillTurns));
    assert_eq!(bench.words().last(), Some(&COAST_STOP));
    // an axis at rest is not made to coast
    let mut bench = Bench::new();
    bench.pursue(Goal::Stop);
    bench.until(Progress::Reached);
    bench.stop_by(StopKind::Coast);
    assert!(bench.is_at_rest() && bench.words() == [Stw1::READY]);
}

#[test]
fn local_operation_is_reported() {
    let mut bench = Bench::new();
    bench.local();
    bench.pursue(Goal::Run { setpoint: 100 });
    bench.cycles(1000);
    assert_eq!(bench.progress(), Progress::Failed(Trouble::LocalOperation));
}

#[test]
fn release_gives_control_back() {
    let mut bench = Bench::new();
    bench.pursue(Goal::Ready);
    bench.until(Progress::Reached);
    bench.pursue(Goal::Released);
    bench.cycles(1);
    assert_eq!(bench.command(), Command::default());
}

/// The first status word may be one of an earlier connection, with other bits: a VLT that used its PROFIdrive words
/// reports bits that look like a fault.
#[test]
fn a_fault_is_believed_after_the_control_word_had_its_time_only() {
    let mut axis = AxisControl::new(Limits::default());
    axis.pursue(Instant::ZERO, Goal::Run { setpoint: 100 });
    let stale = Seen {
        zsw1: Zsw1(0x0268),
        ..Seen::default()
    };
    for millisecond in [0, 4, 8] {
        assert_eq!(
            axis.step(Instant::from_millis(millisecond), stale).stw1,
            Stw1::READY
        );
        assert_eq!(axis.progress(), Progress::Pursuing);
    }
    let ready = Seen {
        zsw1: Zsw1(0x0231),
        ..Seen::default()
    };
    assert_eq!(axis.step(Instant::from_millis(16), ready).stw1, Stw1::RUN);
    // one that stays is one
    let mut axis = AxisControl::new(Limits::default());
    axis.pursue(Instant::ZERO, Goal::Run { setpoint: 100 });
    axis.step(Instant::ZERO, stale);
    axis.step(Instant::ZERO + Limits::default().dwell, stale);
    assert_eq!(axis.progress(), Progress::Failed(Trouble::Fault));
}
