//! Walks the table of transitions.

use super::transition::{Condition, FaultReaction, MOST_TRANSITIONS, TRANSITIONS, Transition};
use super::{Motion, State, Stw1, Zsw1};

/// Inputs of the state machine in one drive cycle. The default is a drive without anything: no valid word, turning,
/// no fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inputs {
    /// Control word 1 as received; zero when there is no connection.
    pub stw1: Stw1,
    /// `stw1` did not come from a controller: its bit 7 is not a level that an edge could start from.
    pub silent: bool,
    /// Control word of local operation (panel, setup software); it takes the place of `stw1`, bit 10 does not matter.
    pub local: Option<Stw1>,
    /// The axis stands still.
    pub standstill: bool,
    /// A fault came since the last step: the strongest reaction if there were several.
    pub fault: Option<FaultReaction>,
    /// The cause of a fault is still there: an acknowledge has no effect.
    pub cause_present: bool,
    /// Acknowledge by another way than STW1, for example a command of the drive.
    pub acknowledge: bool,
    /// The drive itself requests OFF2, for example because a safety function took the pulses away.
    pub coast_stop: bool,
    /// The drive itself requests OFF3, for example by a digital input.
    pub quick_stop: bool,
    /// Bits of ZSW1 that are not the state machine's: 7, 8 and 10 to 15. Others are left out.
    pub status: Zsw1,
}

/// What comes out of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    /// The state now.
    pub state: State,
    /// Status word 1 to send.
    pub zsw1: Zsw1,
    /// The power stage is on.
    pub pulses: bool,
    /// What the axis does.
    pub motion: Motion,
    /// The faults were acknowledged in this step: the fault buffer is to be shifted.
    pub acknowledged: bool,
    /// The word was taken, and so are the setpoints that came with it. When false the last ones stay in force.
    pub accepted: bool,
    /// The transitions of this step.
    pub path: Path,
}

/// The transitions of one step, in order.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub struct Path {
    rows: [Option<&'static Transition>; MOST_TRANSITIONS],
}

impl Path {
    /// Returns the transitions, first one first.
    pub fn iter(&self) -> impl Iterator<Item = &'static Transition> + use<> {
        self.rows.into_iter().flatten()
    }

    /// These transitions and then those, as far as there is room.
    #[must_use]
    pub(super) fn then(mut self, next: Self) -> Self {
        let free = self.rows.iter_mut().filter(|place| place.is_none());
        for (place, row) in free.zip(next.iter()) {
            *place = Some(row);
        }
        self
    }

    /// Returns true when the state did not change.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }
}

impl core::fmt::Debug for Path {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list()
            .entries(self.iter().map(|row| (row.reason, row.to)))
            .finish()
    }
}

/// General state machine of one axis.
/// Source: profile 6.3.2; AKD manual 5.3, 5.4 and 5.9. The transitions are in [`TRANSITIONS`].
///
/// - A word without bit 10 is ignored: the last accepted one stays in force. Before the first accepted one the drive is
///   in S1 as with a word of zeros, and requests control (ZSW1 bit 9).
/// - A step goes on until nothing changes any more, so `0x040F` leads from S2 through S3 to S4 at once.
/// - A fault with the motor on starts its reaction, any other leads to S1. It stays in ZSW1 bit 3 until an edge of STW1
///   bit 7 comes without the cause being present. Then OFF leads to S2.
/// - The edge needs bit 10 in the word with the 1; the word with the 0 before it may be without. A bit 7 that is 1 from
///   the first word on is not an edge. Source: the profile requires control for the edge; that the 0 needs none is an
///   own choice.
/// - When control changes between the PLC and local operation, S2 and S3 fall back to S1, so that an ON that waits on the
///   other side cannot start the motor; in S4 the other side takes over. Source: ours, the profile is silent.
///
/// ```
/// use profidrive_profile::state::{FaultReaction, Inputs, Machine, State, Stw1, Zsw1};
/// let mut drive = Machine::new();
/// let inputs = |stw1| Inputs { stw1, standstill: true, ..Inputs::default() };
/// drive.step(&inputs(Stw1::READY));
/// drive.step(&inputs(Stw1::RUN));
/// let fault = Inputs { fault: Some(FaultReaction::Coast), ..inputs(Stw1::RUN) };
/// assert_eq!(drive.step(&fault).zsw1, Zsw1(0x0278));
/// assert_eq!(drive.step(&inputs(Stw1::READY)).zsw1, Zsw1(0x0278)); // OFF alone does not help
/// let output = drive.step(&inputs(Stw1::ACKNOWLEDGE));
/// assert!(output.acknowledged);
/// assert_eq!((output.state, output.zsw1), (State::S2, Zsw1(0x0231)));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    state: State,
    /// The word in force.
    word: Stw1,
    /// Bit 7 of the last word.
    acknowledge_level: bool,
    /// The word in force came from local operation.
    local: bool,
    /// A fault waits for its acknowledge.
    fault: bool,
    /// The running stop is due to a fault.
    stopped_by_fault: bool,
}

impl Default for Machine {
    fn default() -> Self {
        Self::new()
    }
}

impl Machine {
    /// Creates a drive after power-on: S1, no word accepted, no fault.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: State::S1,
            word: Stw1(0),
            // A bit that is 1 from the beginning is not an edge.
            acknowledge_level: true,
            local: false,
            fault: false,
            stopped_by_fault: false,
        }
    }

    /// Returns the state after the last step.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Returns the word in force: the last accepted one.
    #[must_use]
    pub const fn word(&self) -> Stw1 {
        self.word
    }

    /// Returns true while a fault waits for its acknowledge.
    #[must_use]
    pub const fn fault(&self) -> bool {
        self.fault
    }

    /// Clears the word in force: from the next step on the drive behaves as before the first one, which is a coast
    /// stop. For a controller that is gone and will not be waited for.
    pub fn forget_word(&mut self) {
        self.word = Stw1(0);
        self.acknowledge_level = true;
    }

    /// Gives OFF twice, so that the word of `inputs` starts the motor in the next step: taking control leads to S1, and OFF
    /// from there to S2. For sources without an OFF command that start by a level: a service channel, or a control word
    /// profile ([`Start::ByLevel`](super::Start)). Ignores a new fault and an acknowledge in `inputs`.
    pub fn rearm(&mut self, inputs: &Inputs) -> Path {
        let off = Inputs {
            stw1: inputs.stw1.without(Stw1::ON),
            local: inputs.local.map(|word| word.without(Stw1::ON)),
            fault: None,
            acknowledge: false,
            ..*inputs
        };
        let first = self.step(&off).path;
        first.then(self.step(&off).path)
    }

    /// One drive cycle. Does not allocate; at most [`MOST_TRANSITIONS`] transitions.
    pub fn step(&mut self, inputs: &Inputs) -> Output {
        let (accepted, edge, takeover) = self.take_word(inputs);
        let mut command = self.word;
        if inputs.coast_stop || (takeover && matches!(self.state, State::S2 | State::S3)) {
            command = command.without(Stw1::NO_COAST_STOP);
        }
        if inputs.quick_stop {
            command = command.without(Stw1::NO_QUICK_STOP);
        }

        let acknowledged =
            self.fault && (edge || inputs.acknowledge) && !inputs.cause_present && inputs.fault.is_none();
        if acknowledged {
            self.fault = false;
        }
        if inputs.fault.is_some() {
            self.fault = true;
            self.stopped_by_fault |= self.state.pulses();
        }

        let path = self.walk(command, inputs);
        Output {
            state: self.state,
            zsw1: self.zsw1(command, inputs.status),
            pulses: self.state.pulses(),
            motion: self.state.motion(),
            acknowledged,
            accepted,
            path,
        }
    }

    /// Takes over the word of the controller. Returns whether a word was accepted, whether bit 7 rose, and whether
    /// control changed.
    fn take_word(&mut self, inputs: &Inputs) -> (bool, bool, bool) {
        let local = inputs.local.is_some();
        let takeover = local != self.local;
        if takeover {
            self.local = local;
            self.forget_word();
        }
        let word = inputs.local.unwrap_or(inputs.stw1);
        let accepted = local || word.has(Stw1::CONTROL_BY_PLC);
        let level = word.has(Stw1::ACKNOWLEDGE_FAULT);
        let edge = level && !self.acknowledge_level;
        if accepted || !inputs.silent {
            self.acknowledge_level = level;
        }
        if !accepted {
            return (false, false, takeover);
        }
        self.word = word;
        (true, edge, takeover)
    }

    /// Walks the table until no row fits.
    fn walk(&mut self, command: Stw1, inputs: &Inputs) -> Path {
        let mut path = Path::default();
        let mut fault = inputs.fault;
        for place in &mut path.rows {
            let row = TRANSITIONS.iter().find(|row| {
                row.from == self.state
                    && command.0 & row.mask == row.value
                    && row
                        .also
                        .iter()
                        .all(|condition| self.holds(*condition, inputs.standstill, fault))
            });
            let Some(row) = row else { break };
            *place = Some(row);
            self.state = row.to;
            fault = None; // has had its reaction
            if self.state == State::S1 {
                self.stopped_by_fault = false;
            }
        }
        path
    }

    fn holds(&self, condition: Condition, standstill: bool, new_fault: Option<FaultReaction>) -> bool {
        match condition {
            Condition::Standstill => standstill,
            Condition::NoFault => !self.fault,
            Condition::NewFault => new_fault.is_some(),
            Condition::NewFaultWith(reaction) => new_fault == Some(reaction),
            Condition::StoppedByFault(by_fault) => self.stopped_by_fault == by_fault,
        }
    }

    fn zsw1(&self, command: Stw1, status: Zsw1) -> Zsw1 {
        let mut word = self.state.facts().zsw1 | (status & Zsw1::APPLICATION_BITS);
        if self.state == State::S1 {
            if command.has(Stw1::NO_COAST_STOP) {
                word = word.with(Zsw1::NO_COAST_STOP);
            }
            if command.has(Stw1::NO_QUICK_STOP) {
                word = word.with(Zsw1::NO_QUICK_STOP);
            }
        }
        if self.fault {
            word = word.with(Zsw1::FAULT);
        }
        if !self.local {
            word = word.with(Zsw1::CONTROL_REQUESTED);
        }
        word
    }

    /// Creates a machine in the middle of something.
    #[cfg(test)]
    pub(super) fn in_state(state: State, fault: bool, stopped_by_fault: bool) -> Self {
        Self {
            state,
            fault,
            stopped_by_fault,
            ..Self::new()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Reason;
    use super::*;
    use alloc::vec::Vec;

    fn standing(stw1: u16) -> Inputs {
        Inputs {
            stw1: Stw1(stw1),
            standstill: true,
            ..Inputs::default()
        }
    }

    fn turning(stw1: u16) -> Inputs {
        Inputs {
            standstill: false,
            ..standing(stw1)
        }
    }

    fn running() -> Machine {
        let mut machine = Machine::new();
        machine.step(&standing(0x047E));
        machine.step(&standing(0x047F));
        assert_eq!(machine.state(), State::S4);
        machine
    }

    /// Steps with each word; the states that come out.
    fn sequence(words: &[u16]) -> Vec<(State, u16)> {
        let mut machine = Machine::new();
        words
            .iter()
            .map(|word| {
                let output = machine.step(&standing(*word));
                (output.state, output.zsw1.0)
            })
            .collect()
    }

    #[test]
    fn start_of_akd_manual_5_9() {
        assert_eq!(
            sequence(&[0x0470, 0x0476, 0x0477, 0x047F]),
            [
                (State::S1, 0x0240),
                (State::S2, 0x0231),
                (State::S3, 0x0233),
                (State::S4, 0x0237)
            ]
        );
    }

    #[test]
    fn start_of_akd_manual_7_1_4() {
        assert_eq!(
            sequence(&[0x0400, 0x0406, 0x040E, 0x040F, 0x047F]),
            [
                (State::S1, 0x0240),
                (State::S2, 0x0231),
                (State::S2, 0x0231), // the manual states S3, but ON is not given
                (State::S4, 0x0237),
                (State::S4, 0x0237)
            ]
        );
        let mut machine = Machine::new();
        machine.step(&standing(0x0406));
        let path = machine.step(&standing(0x040F)).path;
        let reasons: Vec<_> = path.iter().map(|row| row.reason).collect();
        assert_eq!(reasons, [Reason::T3, Reason::T6]);
    }

    #[test]
    fn no_start_without_off_before() {
        assert_eq!(sequence(&[0x047F; 3]), [(State::S1, 0x0270); 3]);
    }

    #[test]
    fn before_any_word_s1_and_control_requested() {
        let mut machine = Machine::new();
        for word in [0x0000, 0x007F, 0xFBFF] {
            let output = machine.step(&standing(word));
            assert_eq!(
                (output.state, output.zsw1, output.accepted),
                (State::S1, Zsw1(0x0240), false)
            );
        }
    }

    #[test]
    fn a_word_without_control_by_plc_changes_nothing() {
        let mut machine = Machine::new();
        machine.step(&standing(0x047E));
        let output = machine.step(&standing(0x007F));
        assert_eq!((output.state, output.accepted), (State::S2, false));
        assert_eq!(machine.step(&standing(0x047F)).state, State::S4);
        assert_eq!(machine.step(&turning(0x0000)).state, State::S4);
        assert_eq!(machine.word(), Stw1::RUN);
        machine.forget_word();
        assert_eq!(machine.step(&turning(0x0000)).state, State::S1);
    }

    #[test]
    fn ramp_stop_can_be_taken_back() {
        let mut machine = running();
        let output = machine.step(&turning(0x047E));
        assert_eq!(
            (output.state, output.zsw1, output.motion, output.pulses),
            (State::S5Ramp, Zsw1(0x0233), Motion::RampStop, true)
        );
        assert_eq!(machine.step(&turning(0x047F)).state, State::S4);
        machine.step(&turning(0x047E));
        assert_eq!(machine.step(&standing(0x047E)).zsw1, Zsw1(0x0231));
    }

    #[test]
    fn quick_stop_ends_in_s1_whatever_is_sent() {
        let mut machine = running();
        let output = machine.step(&turning(0x047B));
        assert_eq!((output.zsw1, output.motion), (Zsw1(0x0213), Motion::QuickStop));
        assert_eq!(machine.step(&turning(0x047F)).state, State::S5Quick);
        assert_eq!(machine.step(&turning(0x047E)).zsw1, Zsw1(0x0213));
        assert_eq!(machine.step(&standing(0x047F)).zsw1, Zsw1(0x0270));
        assert_eq!(machine.step(&standing(0x047F)).state, State::S1);
        assert_eq!(machine.step(&standing(0x047E)).state, State::S2);
    }

    #[test]
    fn coast_stop_wins_over_all() {
        let mut machine = running();
        let output = machine.step(&turning(0x0470));
        assert_eq!(
            (output.state, output.zsw1, output.pulses),
            (State::S1, Zsw1(0x0240), false)
        );
        assert_eq!(machine.step(&turning(0x047D)).zsw1, Zsw1(0x0260));
        assert_eq!(machine.step(&turning(0x047F)).zsw1, Zsw1(0x0270));
    }

    #[test]
    fn fault_with_ramp_stop_ends_in_s1_and_cannot_be_taken_back() {
        let mut machine = running();
        let fault = Inputs {
            fault: Some(FaultReaction::RampStop),
            ..turning(0x047F)
        };
        let output = machine.step(&fault);
        assert_eq!((output.state, output.zsw1), (State::S5Ramp, Zsw1(0x023B)));
        assert_eq!(machine.step(&turning(0x047F)).state, State::S5Ramp);
        // Acknowledged while it still brakes: the bit goes, the stop goes on.
        let output = machine.step(&turning(0x04FF));
        assert!(output.acknowledged);
        assert_eq!(output.zsw1, Zsw1(0x0233));
        let output = machine.step(&standing(0x047F));
        assert_eq!((output.state, output.zsw1), (State::S1, Zsw1(0x0270)));
    }

    #[test]
    fn fault_reactions_in_every_state() {
        use FaultReaction::{Coast, QuickStop, RampStop};
        use State::{S1, S5Quick, S5Ramp};
        // Words that keep each state as it is while the axis turns.
        let words = [0x047F, 0x047E, 0x0477, 0x047F, 0x047E, 0x047B];
        let expected = [
            (Coast, [S1, S1, S1, S1, S1, S1]),
            (QuickStop, [S1, S1, S1, S5Quick, S5Quick, S5Quick]),
            (RampStop, [S1, S1, S1, S5Ramp, S5Ramp, S5Quick]),
        ];
        for (reaction, states) in expected {
            for ((from, to), word) in State::ALL.into_iter().zip(states).zip(words) {
                let mut machine = Machine::in_state(from, false, false);
                assert_eq!(machine.step(&turning(word)).state, from, "{word:04X}");
                let output = machine.step(&Inputs {
                    fault: Some(reaction),
                    ..turning(word)
                });
                assert_eq!(output.state, to, "{from:?} {reaction:?}");
                assert!(output.zsw1.has(Zsw1::FAULT) && machine.fault());
                // In the end it is S1 with the fault, and stays there.
                let output = machine.step(&standing(0x047E));
                assert_eq!((output.state, output.zsw1), (S1, Zsw1(0x0278)));
            }
        }
    }

    #[test]
    fn acknowledge_needs_an_edge_control_and_no_cause() {
        let faulty = || {
            let mut machine = running();
            machine.step(&Inputs {
                fault: Some(FaultReaction::Coast),
                ..standing(0x047F)
            });
            machine
        };
        // A level is not an edge, and an edge in a word without control is none.
        let mut machine = faulty();
        machine.step(&Inputs {
            cause_present: true,
            ..standing(0x04FE)
        });
        assert_eq!(machine.step(&standing(0x04FE)).zsw1, Zsw1(0x0278));
        assert!(!machine.step(&standing(0x007E)).acknowledged);
        assert!(!machine.step(&standing(0x00FE)).acknowledged);
        assert!(!machine.step(&standing(0x04FE)).acknowledged);
        machine.step(&standing(0x047E));
        assert!(machine.step(&standing(0x04FE)).acknowledged);
        // An edge together with a further fault.
        let mut machine = faulty();
        let output = machine.step(&Inputs {
            fault: Some(FaultReaction::Coast),
            ..standing(0x04FE)
        });
        assert!(!output.acknowledged);
        assert_eq!(output.zsw1, Zsw1(0x0278));
        // With ON still given it stays in S1.
        let mut machine = faulty();
        let output = machine.step(&standing(0x04FF));
        assert!(output.acknowledged);
        assert_eq!(output.zsw1, Zsw1(0x0270));
        assert_eq!(machine.step(&standing(0x047F)).state, State::S1);
        assert_eq!(machine.step(&standing(0x047E)).state, State::S2);
        // By a command of the drive; without a fault nothing is acknowledged.
        let mut machine = faulty();
        let command = Inputs {
            acknowledge: true,
            ..standing(0x047F)
        };
        assert!(machine.step(&command).acknowledged);
        assert!(!machine.step(&command).acknowledged);
    }

    #[test]
    fn an_acknowledge_may_begin_in_a_word_without_control() {
        let faulty = || {
            let mut machine = Machine::new();
            machine.step(&Inputs {
                fault: Some(FaultReaction::Coast),
                silent: true,
                ..standing(0)
            });
            machine
        };
        // A plain program gives bits 7 and 10 together.
        let mut machine = faulty();
        machine.step(&standing(0x0000));
        let output = machine.step(&standing(0x04FE));
        assert!(output.acknowledged);
        assert_eq!(
            output.zsw1,
            Zsw1(0x0231),
            "S1, and with OFF on to S2 in the same step"
        );
        // A level from the first word on is none, nor is one that rose without control.
        assert!(!faulty().step(&standing(0x04FE)).acknowledged);
        let mut machine = faulty();
        machine.step(&standing(0x0000));
        machine.step(&standing(0x00FE));
        assert!(!machine.step(&standing(0x04FE)).acknowledged);
        // What stands for the word while there is none does not count.
        let mut machine = faulty();
        machine.step(&Inputs {
            silent: true,
            ..standing(0)
        });
        assert!(!machine.step(&standing(0x04FE)).acknowledged);
    }

    #[test]
    fn the_drives_own_stops_act_like_the_bits() {
        let mut machine = running();
        let coast = Inputs {
            coast_stop: true,
            ..turning(0x047F)
        };
        let output = machine.step(&coast);
        assert_eq!((output.state, output.zsw1), (State::S1, Zsw1(0x0260)));
        assert_eq!(machine.step(&turning(0x047F)).zsw1, Zsw1(0x0270));
        let mut machine = running();
        let quick = Inputs {
            quick_stop: true,
            ..turning(0x047F)
        };
        assert_eq!(machine.step(&quick).state, State::S5Quick);
    }

    #[test]
    fn local_operation() {
        let local = |word, plc| Inputs {
            local: Some(Stw1(word)),
            ..standing(plc)
        };
        let mut machine = Machine::new();
        assert_eq!(machine.step(&standing(0x047E)).state, State::S2);
        let output = machine.step(&local(0x000E, 0x047F));
        assert_eq!((output.state, output.zsw1.0), (State::S1, 0x0060)); // the change itself, bit 9 is 0
        assert_eq!(machine.step(&local(0x000E, 0x047F)).state, State::S2);
        assert_eq!(machine.step(&local(0x000F, 0x0470)).state, State::S4);
        assert_eq!(machine.step(&local(0x000E, 0x047F)).state, State::S2);
        // Back to the PLC, which holds ON: no start.
        assert_eq!(machine.step(&standing(0x047F)).state, State::S1);
        assert_eq!(machine.step(&standing(0x047F)).zsw1, Zsw1(0x0270));
        machine.step(&standing(0x047E));
        machine.step(&standing(0x047F));
        // In operation the other side takes over.
        assert_eq!(machine.step(&local(0x000F, 0x0000)).zsw1, Zsw1(0x0037));
        assert_eq!(machine.step(&standing(0x047F)).zsw1, Zsw1(0x0237));
    }

    #[test]
    fn bits_of_the_application_pass_and_others_do_not() {
        let mut machine = Machine::new();
        let output = machine.step(&Inputs {
            status: Zsw1(0xFFFF),
            ..standing(0x047E)
        });
        assert_eq!(output.zsw1, Zsw1(0xFFB1));
    }
}
