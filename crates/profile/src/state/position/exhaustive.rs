//! Every word in every state of positioning against a second reading, written without the table.

use super::PositionState::{
    self, Basic, Braking, Homing, HomingStop, Jog1, Jog2, Pause, RealTimeJog, Reject, Task,
};
use super::{PositionCommand, PositionEffect, PositionInputs, PositionMachine, Stw1};

/// Inputs of one step.
#[derive(Clone, Copy)]
struct Asked {
    inputs: PositionInputs,
    before: u16,
    homing_by_bus: bool,
    paused_by_command: bool,
}

impl Asked {
    fn bit(&self, number: u8) -> bool {
        self.inputs.stw1.0 & (1 << number) != 0
    }

    fn rises(&self, number: u8) -> bool {
        self.bit(number) && self.before & (1 << number) == 0
    }

    fn command(&self, command: PositionCommand) -> bool {
        self.inputs.command == Some(command)
    }

    /// Returns whether a requested task or homing starts: it can run, and for a task bits 4 and 5 are set.
    fn takes_task(&self) -> bool {
        let wanted = self.rises(6) || self.command(PositionCommand::Task);
        wanted && self.inputs.task_permitted && self.bit(4) && self.bit(5)
    }

    fn takes_homing(&self) -> bool {
        let wanted = self.rises(11) || self.command(PositionCommand::Homing);
        wanted && self.inputs.homing_permitted
    }

    fn jog(&self) -> Option<PositionState> {
        let closed = !self.bit(4) && !self.bit(5) && !self.bit(6);
        match (self.bit(8), self.bit(9), self.bit(12)) {
            (true, false, false) if closed => Some(Jog1),
            (false, true, false) if closed => Some(Jog2),
            (false, false, true) => Some(RealTimeJog),
            _ => None,
        }
    }
}

/// Returns the next state and the effects, as in the manual.
fn next(state: PositionState, asked: &Asked) -> (PositionState, PositionEffect) {
    let stop = asked.command(PositionCommand::Stop);
    let inputs = &asked.inputs;
    match state {
        Basic if asked.takes_homing() => (Homing, PositionEffect::StartHoming),
        Basic if asked.takes_task() => (Task, PositionEffect::StartTask),
        Basic => match asked.jog() {
            Some(jog) if inputs.standstill && inputs.jog_permitted => (jog, PositionEffect::None),
            _ => (Basic, PositionEffect::None),
        },
        Homing if inputs.failed || stop || (asked.homing_by_bus && !asked.bit(11)) => {
            (HomingStop, PositionEffect::AbortHoming)
        }
        Homing if inputs.finished => (Basic, PositionEffect::FinishHoming),
        HomingStop | Reject | Braking if inputs.standstill => (Basic, PositionEffect::None),
        Jog1 | Jog2 | RealTimeJog if inputs.failed || stop || asked.jog() != Some(state) => {
            (Braking, PositionEffect::None)
        }
        Task | Pause if inputs.failed || !asked.bit(4) => (Reject, PositionEffect::DropTask),
        Task if !asked.bit(5) || stop => (Pause, PositionEffect::None),
        Task | Pause if asked.takes_task() => (Task, PositionEffect::StartTask),
        Task if inputs.finished => (Basic, PositionEffect::FinishTask),
        Pause if asked.bit(5) && (!asked.paused_by_command || asked.command(PositionCommand::Continue)) => {
            (Task, PositionEffect::ContinueTask)
        }
        state => (state, PositionEffect::None),
    }
}

const COMMANDS: [Option<PositionCommand>; 5] = [
    None,
    Some(PositionCommand::Task),
    Some(PositionCommand::Homing),
    Some(PositionCommand::Stop),
    Some(PositionCommand::Continue),
];

#[test]
fn all_words_in_all_states_of_positioning() {
    // Bits 4, 5, 6, 8, 9, 11, 12 of the word; bits 6 and 11 of the one before; six facts; two memories.
    for state in PositionState::ALL {
        for bits in 0..1_u32 << 17 {
            let bit = |number: u32| bits & (1 << number) != 0;
            let mut word = 0x040F;
            for (place, number) in [4, 5, 6, 8, 9, 11, 12].into_iter().enumerate() {
                word |= u16::from(bit(place as u32)) << number;
            }
            let before = 0x040F | u16::from(bit(7)) << 6 | u16::from(bit(8)) << 11;
            for command in COMMANDS {
                let asked = Asked {
                    inputs: PositionInputs {
                        stw1: Stw1(word),
                        standstill: bit(9),
                        task_permitted: bit(10),
                        homing_permitted: bit(11),
                        jog_permitted: bit(12),
                        finished: bit(13),
                        failed: bit(14),
                        command,
                    },
                    before,
                    homing_by_bus: bit(15),
                    paused_by_command: bit(16),
                };
                let mut axis = PositionMachine::in_state(
                    state,
                    Stw1(before),
                    asked.homing_by_bus,
                    asked.paused_by_command,
                );
                let output = axis.step(&asked.inputs);
                let (expected, effect) = next(state, &asked);
                assert_eq!(
                    (output.state, output.effect()),
                    (expected, effect),
                    "{state:?} {word:04X} after {before:04X} {:?}",
                    asked.inputs
                );
                assert_eq!(axis.state(), expected);
                let wanted = asked.rises(6) || asked.command(PositionCommand::Task);
                let homing = asked.rises(11) || asked.command(PositionCommand::Homing);
                assert_eq!(
                    output.refused,
                    (wanted && effect != PositionEffect::StartTask)
                        || (homing && effect != PositionEffect::StartHoming)
                );
                // Acknowledged is what the bus requested and got, until the bit falls.
                let taken = asked.rises(6) && effect == PositionEffect::StartTask;
                let kept = before & 0x40 != 0 && asked.bit(6);
                assert_eq!(axis.acknowledges(), taken || kept, "{state:?} {word:04X}");
            }
        }
    }
}
