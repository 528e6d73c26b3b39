//! The general state machine of a drive: the table of its transitions, and where one drive is in it.

use dissect::meaning::WordBits;
use dissect::words::word_bits;
use profile::state::{Mode, Profile, State, TRANSITIONS, Transition, Zsw1, bits};
use serde::Serialize;

use super::{DriveState, DriveWords};

/// The states and transitions, as the profile has them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateMachine {
    /// The states, S1 first.
    pub states: Vec<StateName>,
    /// The transitions, those of a state together.
    pub transitions: Vec<TransitionRow>,
}

/// A state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateName {
    /// The state. Both ways of switching off are S5.
    pub state: DriveState,
    /// Its name.
    pub name: &'static str,
}

/// One transition, and when it happens.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TransitionRow {
    /// Its number: `T1`.
    pub reason: String,
    /// The state it leaves.
    pub from: DriveState,
    /// The state it enters.
    pub to: DriveState,
    /// When it happens, in a few words.
    pub text: &'static str,
    /// The bits of STW1 that it looks at.
    pub bits: Vec<BitCondition>,
    /// What else must be so.
    pub also: Vec<&'static str>,
}

/// A bit of STW1 and the value that it must have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BitCondition {
    /// Its number.
    pub bit: u8,
    /// Its name; of an inverse bit that of what it holds off.
    pub name: &'static str,
    /// The value.
    pub value: bool,
    /// What that value means.
    pub meaning: &'static str,
}

/// Where a drive is in the state machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MachineReport {
    /// Its state; null where its words have none.
    pub state: Option<DriveState>,
    /// Its words: those of a vendor as they travel, then the same as the profile has them.
    pub words: Vec<WordStrip>,
    /// The transition that it waits for: the next one on the way to operation, or the end of a stop.
    pub awaited: Option<TransitionRow>,
    /// The bits of STW1 that must change for it.
    pub missing: Vec<BitCondition>,
}

/// A control or status word with all of its bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WordStrip {
    /// `STW1`, `ZSW1`, or the vendor's name of the word.
    pub name: &'static str,
    /// Who writes it: `controller` or `drive`.
    pub writer: &'static str,
    /// Whose bits these are.
    pub profile: &'static str,
    /// The word.
    pub word: WordBits,
}

impl StateMachine {
    /// Returns the table.
    #[must_use]
    pub fn new() -> Self {
        let states = State::ALL.into_iter().filter(|state| *state != State::S5Quick);
        Self {
            states: states
                .map(|state| StateName {
                    state: of(state),
                    name: match state {
                        State::S5Ramp => "switching off",
                        other => other.name(),
                    },
                })
                .collect(),
            transitions: TRANSITIONS.iter().map(TransitionRow::new).collect(),
        }
    }
}

impl Default for StateMachine {
    fn default() -> Self {
        Self::new()
    }
}

impl TransitionRow {
    fn new(row: &Transition) -> Self {
        Self {
            reason: format!("{:?}", row.reason),
            from: of(row.from),
            to: of(row.to),
            text: row.reason.text(),
            bits: conditions(row.mask, row.value),
            also: row.also.iter().map(|condition| condition.text()).collect(),
        }
    }
}

/// The bits of a mask with the values that they must have.
fn conditions(mask: u16, value: u16) -> Vec<BitCondition> {
    let all = bits::describe(bits::stw1(Mode::Velocity), value);
    all.filter(|bit| mask & (1 << bit.number) != 0)
        .map(|bit| BitCondition {
            bit: bit.number,
            name: bit.name,
            value: bit.set,
            meaning: bit.meaning,
        })
        .collect()
}

const fn of(state: State) -> DriveState {
    match state {
        State::S1 => DriveState::S1,
        State::S2 => DriveState::S2,
        State::S3 => DriveState::S3,
        State::S4 => DriveState::S4,
        State::S5Ramp | State::S5Quick => DriveState::S5,
    }
}

impl MachineReport {
    /// Returns where a drive with these words is.
    #[must_use]
    pub fn new(words: &DriveWords) -> Self {
        let profile = Profile::ALL.into_iter().find(|one| one.name() == words.profile);
        let profile = profile.unwrap_or_default();
        let mode = if words.mode == Mode::Position.name() {
            Mode::Position
        } else {
            Mode::Velocity
        };
        let word =
            |word: &Option<super::Word>| word.as_ref().and_then(|word| u16::try_from(word.number).ok());
        let (control, status) = (word(&words.stw1), word(&words.zsw1));
        let general = status.map(|status| profile.zsw1(status, control.unwrap_or_default()));
        let state = general.and_then(|word| {
            // as a report of the words decides it
            let runs = if word.has(Zsw1::READY_TO_OPERATE) {
                State::S4
            } else {
                State::S2
            };
            let sent = control.map(|control| profile.orders(control, runs).stw1);
            word.state(sent.unwrap_or_default())
        });
        let stw1 = control.map(|control| profile.orders(control, state.unwrap_or(State::S2)).stw1);
        let mut strips = Vec::new();
        if profile != Profile::Profidrive {
            strips.extend(control.map(|word| strip("CTW", profile, mode, word)));
            strips.extend(status.map(|word| strip("STW", profile, mode, word)));
        }
        strips.extend(stw1.map(|word| strip("STW1", Profile::Profidrive, mode, word.0)));
        strips.extend(general.map(|word| strip("ZSW1", Profile::Profidrive, mode, word.0)));
        let awaited = state.and_then(Transition::awaited);
        let missing = awaited.map_or(0, |row| row.missing(stw1.unwrap_or_default()));
        Self {
            state: words.state,
            words: strips,
            awaited: awaited.map(TransitionRow::new),
            missing: awaited.map_or_else(Vec::new, |row| conditions(missing, row.value)),
        }
    }
}

fn strip(name: &'static str, profile: Profile, mode: Mode, word: u16) -> WordStrip {
    let is_control = matches!(name, "CTW" | "STW1");
    let table = if is_control {
        profile.control_bits(mode)
    } else {
        profile.status_bits(mode)
    };
    WordStrip {
        name,
        writer: if is_control { "controller" } else { "drive" },
        profile: profile.name(),
        word: word_bits(table, word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(profile: Profile, control: u16, status: u16) -> MachineReport {
        let words = DriveWords::of(profile, Mode::Velocity, Some(control), Some(status));
        MachineReport::new(&words)
    }

    #[test]
    fn a_drive_that_is_ready_waits_for_on() {
        let report = report(Profile::Profidrive, 0x047E, 0x0231);
        assert_eq!(report.state, Some(DriveState::S2));
        assert_eq!(report.awaited.unwrap().reason, "T3");
        let missing: Vec<_> = report.missing.iter().map(|bit| (bit.bit, bit.value)).collect();
        assert_eq!(missing, [(0, true)]);
        let names: Vec<_> = report.words.iter().map(|strip| strip.name).collect();
        assert_eq!(names, ["STW1", "ZSW1"]);
    }

    #[test]
    fn an_inhibited_drive_waits_for_off_without_a_stop() {
        let report = report(Profile::Profidrive, 0x0001, 0x0240);
        let missing: Vec<_> = report.missing.iter().map(|bit| (bit.bit, bit.value)).collect();
        assert_eq!(missing, [(0, false), (1, true), (2, true)]);
    }

    #[test]
    fn words_of_a_vendor_are_beside_those_of_the_profile() {
        let report = report(Profile::DanfossFc, 0x047C, 0x0F07);
        assert_eq!(report.state, Some(DriveState::S4));
        assert_eq!(report.awaited, None);
        let strips: Vec<_> = report
            .words
            .iter()
            .map(|strip| (strip.name, strip.writer, strip.word.number))
            .collect();
        assert_eq!(strips[0], ("CTW", "controller", 0x047C));
        assert_eq!(strips[1], ("STW", "drive", 0x0F07));
        assert_eq!((strips[2].0, strips[3].0), ("STW1", "ZSW1"));
    }

    #[test]
    fn each_state_of_the_table_has_a_name_and_a_way_out() {
        let machine = StateMachine::new();
        let states: Vec<_> = machine.states.iter().map(|row| row.state).collect();
        assert_eq!(states.len(), 5);
        for state in states {
            assert!(
                machine.transitions.iter().any(|row| row.from == state),
                "{state:?}"
            );
        }
        assert!(machine.transitions.iter().all(|row| row.reason.starts_with('T')));
    }
}
