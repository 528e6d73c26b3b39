//! A state of the general state machine in words: what it is, how it is left, how it is reached.

use crate::meaning::{StateMeaning, StateWay};
use profile::state::{Condition, FaultReaction, Mode, Motion, State, TRANSITIONS, Transition, bits};

/// Returns the states that a person means: `S4`, `s5`, `operation`.
pub fn named(text: &str) -> Vec<State> {
    let wanted = text.trim().to_ascii_lowercase();
    let is = |state: &State| {
        wanted == format!("s{}", state.number())
            || wanted == state.name()
            || wanted == state.to_string().to_ascii_lowercase()
    };
    State::ALL.into_iter().filter(is).collect()
}

/// One state, line by line.
pub fn lines(state: State) -> Vec<String> {
    let mut lines = vec![state.to_string()];
    lines.push(format!("  motor    {}", motor(state.motion())));
    for (at, way) in ways(state, true).iter().enumerate() {
        let head = if at == 0 { "leave" } else { "" };
        lines.push(format!("  {head:<8} {}: to {}", way.why, way.other));
    }
    for (at, way) in ways(state, false).iter().enumerate() {
        let head = if at == 0 { "reach" } else { "" };
        lines.push(format!("  {head:<8} from {}: {}", way.other, way.why));
    }
    lines
}

/// Returns the same for programs.
pub fn meaning(state: State) -> StateMeaning {
    let list = |leaving| {
        let ways = ways(state, leaving).into_iter();
        ways.map(|way| StateWay {
            state: way.other.to_string(),
            by: way.why,
        })
        .collect()
    };
    StateMeaning {
        state: format!("S{}", state.number()),
        name: state.name(),
        pulses: state.pulses(),
        motor: motor(state.motion()),
        left_to: list(true),
        reached_from: list(false),
    }
}

const fn motor(motion: Motion) -> &'static str {
    match motion {
        Motion::Coast => "pulses off, an axis that turns runs out",
        Motion::FollowSetpoint => "pulses on, the axis follows its setpoint",
        Motion::RampStop => "pulses on, the axis brakes along its ramp to standstill",
        Motion::QuickStop => "pulses on, the axis brakes as fast as it can to standstill",
    }
}

/// One transition seen from one of its ends.
struct Way {
    other: State,
    why: String,
}

/// Returns the transitions from or to a state, in the order of the table.
fn ways(state: State, leaving: bool) -> Vec<Way> {
    let rows = TRANSITIONS.iter();
    let ends = rows.map(|row| {
        if leaving {
            (row.from, row.to, row)
        } else {
            (row.to, row.from, row)
        }
    });
    ends.filter(|(own, ..)| *own == state)
        .map(|(_, other, row)| Way { other, why: why(row) })
        .collect()
}

/// `STW1 bit 0 (ON) = 0`, and what else has to be true.
fn why(row: &Transition) -> String {
    let looked_at = bits::stw1(Mode::Velocity)
        .iter()
        .filter(|bit| row.mask >> bit.number & 1 == 1)
        .map(|bit| {
            let on = row.value >> bit.number & 1;
            format!("STW1 bit {} ({}) = {on}", bit.number, bit.name)
        });
    let also = row
        .also
        .iter()
        .map(|condition| condition_words(*condition).to_owned());
    looked_at.chain(also).collect::<Vec<_>>().join(", ")
}

const fn condition_words(condition: Condition) -> &'static str {
    match condition {
        Condition::Standstill => "the axis stands",
        Condition::NoFault => "no fault waits for its acknowledge",
        Condition::NewFault => "a fault",
        Condition::NewFaultWith(FaultReaction::Coast) => "a fault that takes the pulses off",
        Condition::NewFaultWith(FaultReaction::QuickStop) => "a fault with quick stop",
        Condition::NewFaultWith(FaultReaction::RampStop) => "a fault with ramp stop",
        Condition::StoppedByFault(false) => "the stop was commanded",
        Condition::StoppedByFault(true) => "the stop is due to a fault",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_by_number_and_name() {
        assert_eq!(named("S4"), [State::S4]);
        assert_eq!(named(" s5 "), [State::S5Ramp, State::S5Quick]);
        assert_eq!(named("Operation"), [State::S4]);
        assert_eq!(named("4"), []);
    }

    #[test]
    fn a_state_is_described_with_its_transitions() {
        let text = lines(State::S1).join("\n");
        assert_eq!(
            text.lines().nth(2),
            Some(
                "  leave    STW1 bit 0 (ON) = 0, STW1 bit 1 (OFF2) = 1, STW1 bit 2 (OFF3) = 1, no fault waits for its acknowledge: to S2 ready for switching on"
            )
        );
        let text = lines(State::S4).join("\n");
        assert!(
            text.starts_with("S4 operation\n  motor    pulses on, the axis follows"),
            "{text}"
        );
        assert!(
            text.contains("STW1 bit 0 (ON) = 0: to S5 switching off, ramp stop\n"),
            "{text}"
        );
        assert!(
            text.contains("  reach    from S3 switched on: STW1 bit 3 (EN_OP) = 1\n"),
            "{text}"
        );
        for state in State::ALL {
            assert!(lines(state).len() > 3, "{state}");
            assert!(!meaning(state).left_to.is_empty(), "{state}");
        }
    }
}
