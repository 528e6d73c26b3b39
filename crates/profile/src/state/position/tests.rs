//! Behaviour of the machine, one wish at a time.

use super::*;

#[test]
fn rows_of_a_state_stand_together_highest_priority_first() {
    for pair in POSITION_TRANSITIONS.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        assert!(
            a.from < b.from || (a.from == b.from && a.priority >= b.priority),
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn every_state_is_entered_and_left() {
    for state in PositionState::ALL {
        assert!(
            POSITION_TRANSITIONS.iter().any(|row| row.to == state),
            "{state:?}"
        );
        assert!(
            POSITION_TRANSITIONS
                .iter()
                .any(|row| row.from == state && row.to != state),
            "{state:?}"
        );
    }
    for row in POSITION_TRANSITIONS {
        assert_eq!(row.value & !row.mask, 0, "{row:?}");
    }
}

/// Returns all permitted, standing.
fn able(stw1: u16) -> PositionInputs {
    PositionInputs {
        stw1: Stw1(stw1),
        standstill: true,
        task_permitted: true,
        homing_permitted: true,
        jog_permitted: true,
        ..PositionInputs::default()
    }
}

#[test]
fn handshake_of_the_manual_with_change_on_the_fly() {
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x043F));
    let mut send = |stw1| {
        let output = axis.step(&able(stw1));
        (output.effect(), axis.acknowledges())
    };
    assert_eq!(send(0x043F), (PositionEffect::None, false));
    assert_eq!(send(0x047F), (PositionEffect::StartTask, true));
    assert_eq!(send(0x047F), (PositionEffect::None, true));
    assert_eq!(send(0x043F), (PositionEffect::None, false));
    assert_eq!(send(0x047F), (PositionEffect::StartTask, true)); // the first one still runs
}

#[test]
fn what_cannot_run_is_not_acknowledged_and_disturbs_nothing() {
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x043F));
    axis.step(&able(0x047F));
    axis.step(&able(0x043F));
    let output = axis.step(&PositionInputs {
        task_permitted: false,
        ..able(0x047F)
    });
    assert!(output.refused && !axis.acknowledges());
    assert_eq!(output.state, Task);
    // The level does not start it later.
    assert_eq!(axis.step(&able(0x047F)).effect(), PositionEffect::None);
}

#[test]
fn bits_that_are_there_when_s4_begins_start_nothing() {
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x0C7F));
    assert_eq!(axis.step(&able(0x0C7F)).transition, None);
    assert_eq!(PositionMachine::new().step(&able(0x0C7F)).transition, None);
}

#[test]
fn homing_by_a_command_is_not_aborted_by_a_bit_that_was_never_set() {
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x043F));
    let home = PositionInputs {
        command: Some(PositionCommand::Homing),
        ..able(0x043F)
    };
    assert_eq!(axis.step(&home).state, Homing);
    assert_eq!(axis.step(&able(0x043F)).state, Homing);
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x043F));
    assert_eq!(axis.step(&able(0x0C3F)).state, Homing);
    assert_eq!(axis.step(&able(0x043F)).effect(), PositionEffect::AbortHoming);
}

#[test]
fn a_stop_by_command_waits_for_its_own_continue() {
    let mut axis = PositionMachine::new();
    axis.reset(Stw1(0x043F));
    let with = |command| PositionInputs {
        command: Some(command),
        ..able(0x043F)
    };
    axis.step(&with(PositionCommand::Task));
    assert_eq!(axis.step(&with(PositionCommand::Stop)).state, Pause);
    axis.step(&able(0x041F));
    assert_eq!(axis.step(&able(0x043F)).state, Pause);
    assert_eq!(
        axis.step(&with(PositionCommand::Continue)).effect(),
        PositionEffect::ContinueTask
    );
    axis.step(&able(0x041F));
    assert_eq!(axis.step(&able(0x043F)).effect(), PositionEffect::ContinueTask);
}

#[test]
fn status_while_homing_and_with_a_task() {
    let facts = PositionFacts {
        in_range: true,
        reached: true,
        homed: true,
        standstill: true,
    };
    let status = |state| PositionMachine::in_state(state, Stw1(0x043F), false, false).status(&facts);
    assert_eq!(status(Basic), Zsw1(0x2D00));
    assert_eq!(status(Homing), Zsw1(0x0100));
    assert_eq!(status(Pause), Zsw1(0x6900));
    let acknowledged = PositionMachine::in_state(Task, Stw1(0x047F), false, false);
    assert_eq!(acknowledged.status(&PositionFacts::default()), Zsw1(0x5000));
}
