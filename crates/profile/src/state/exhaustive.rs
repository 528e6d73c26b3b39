//! Every control word in every state against a second reading of the state machine, written without the table.

use super::State::{S1, S2, S3, S4, S5Quick, S5Ramp};
use super::{FaultReaction, Inputs, MOST_TRANSITIONS, Machine, State, Stw1, Zsw1};

/// The arrows that exist.
const ARROWS: &[(State, State)] = &[
    (S1, S2),
    (S2, S1),
    (S2, S3),
    (S3, S1),
    (S3, S2),
    (S3, S4),
    (S4, S1),
    (S4, S3),
    (S4, S5Quick),
    (S4, S5Ramp),
    (S5Ramp, S1),
    (S5Ramp, S2),
    (S5Ramp, S4),
    (S5Ramp, S5Quick),
    (S5Quick, S1),
];

#[derive(Clone, Copy)]
struct World {
    standstill: bool,
    unacknowledged: bool,
    by_fault: bool,
}

/// Returns the next state, as in the profile.
fn next(state: State, word: u16, world: World) -> State {
    let off = word & 1 == 0;
    let coast = word & 2 == 0;
    let quick = word & 4 == 0;
    let disabled = word & 8 == 0;
    match state {
        S1 if off && !coast && !quick && !world.unacknowledged => S2,
        S1 => S1,
        S2 | S3 | S4 | S5Ramp | S5Quick if coast => S1,
        S2 | S3 if quick => S1,
        S4 | S5Ramp if quick => S5Quick,
        S2 if off => S2,
        S2 => S3,
        S3 if off => S2,
        S3 if disabled => S3,
        S3 => S4,
        S4 if off => S5Ramp,
        S4 if disabled => S3,
        S4 => S4,
        S5Quick if world.standstill || disabled => S1,
        S5Quick => S5Quick,
        S5Ramp if world.standstill || disabled => {
            if world.by_fault {
                S1
            } else {
                S2
            }
        }
        S5Ramp if off || world.by_fault => S5Ramp,
        S5Ramp => S4,
    }
}

fn react(state: State, reaction: FaultReaction) -> State {
    match (state, reaction) {
        (S1 | S2 | S3, _) | (_, FaultReaction::Coast) => S1,
        (S5Quick, _) | (_, FaultReaction::QuickStop) => S5Quick,
        (_, FaultReaction::RampStop) => S5Ramp,
    }
}

/// ZSW1 of section 2.1 of the tables, control requested.
fn status(state: State, word: u16, fault: bool) -> u16 {
    let bits = match state {
        S1 => {
            let no_coast = if word & 2 == 0 { 0 } else { 0x10 };
            let no_quick = if word & 4 == 0 { 0 } else { 0x20 };
            0x40 | no_coast | no_quick
        }
        S2 => 0x31,
        S3 | S5Ramp => 0x33,
        S4 => 0x37,
        S5Quick => 0x13,
    };
    0x0200 | bits | if fault { 8 } else { 0 }
}

#[test]
fn all_words_in_all_states() {
    let reactions = [
        None,
        Some(FaultReaction::Coast),
        Some(FaultReaction::QuickStop),
        Some(FaultReaction::RampStop),
    ];
    for from in State::ALL {
        for word in 0..=u16::MAX {
            // Without control the word in force is that of power-on: all zeros.
            let command = if word & 0x0400 == 0 { 0 } else { word };
            for case in 0..32_u8 {
                let standstill = case & 1 != 0;
                let pending = case & 2 != 0;
                let by_fault = case & 4 != 0;
                let new = reactions[usize::from(case >> 3)];
                if (by_fault && !from.pulses()) || (pending && matches!(from, S2 | S3 | S4)) {
                    continue; // cannot be
                }
                let mut machine = Machine::in_state(from, pending, by_fault);
                let output = machine.step(&Inputs {
                    stw1: Stw1(word),
                    standstill,
                    fault: new,
                    ..Inputs::default()
                });

                let mut expected = from;
                let mut world = World {
                    standstill,
                    unacknowledged: pending || new.is_some(),
                    by_fault: by_fault || (new.is_some() && from.pulses()),
                };
                if let Some(reaction) = new {
                    expected = react(expected, reaction);
                }
                for _ in 0..MOST_TRANSITIONS {
                    world.by_fault &= expected != S1;
                    expected = next(expected, command, world);
                }
                assert_eq!(next(expected, command, world), expected, "does not settle");

                assert_eq!(output.state, expected, "{from:?} {word:04X} case {case:05b}");
                let zsw1 = Zsw1(status(expected, command, world.unacknowledged));
                assert_eq!(output.zsw1, zsw1, "{from:?} {word:04X} case {case:05b}");
                assert_eq!(output.pulses, matches!(expected, S4 | S5Ramp | S5Quick));

                let mut at = from;
                for row in output.path.iter() {
                    assert_eq!(row.from, at);
                    assert!(ARROWS.contains(&(row.from, row.to)), "{row:?}");
                    at = row.to;
                }
                assert_eq!(at, expected);
                assert!(output.path.iter().count() <= 3, "{:?}", output.path);
            }
        }
    }
}
