//! The extended state machine of positioning: what happens inside S4 when the axis is in position mode.
//!
//! Source: AKD manual 5.10.1 to 5.10.3 and 5.4. The names of the states come from Festo and ABB manuals. The diagrams
//! of the manual are pictures without text, so the priorities between simultaneous requests are our choice: stopping
//! precedes starting.
//!
//! The facts are one table, [`POSITION_TRANSITIONS`]; [`PositionMachine`] applies it, one transition per drive cycle.
//! It returns the next action. The caller determines where the axis goes and whether a task can run.

use super::{Stw1, Zsw1};

use PositionCondition as Also;
use PositionState::{Basic, Braking, Homing, HomingStop, Jog1, Jog2, Pause, RealTimeJog, Reject, Task};

/// State inside S4 of an axis in position mode.
/// Source: profile 6.3.5 by way of Festo (S41 to S47) and AKD manual 5.10; the split of S44 by origin is ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PositionState {
    /// S41: the axis holds its position.
    Basic,
    /// S42: homing runs.
    Homing,
    /// S43: homing was aborted, brakes along the ramp of homing.
    HomingStop,
    /// S44: jogs at jog setpoint 1.
    Jog1,
    /// S44: jogs at jog setpoint 2.
    Jog2,
    /// S44: jogs with the values of MDI.
    RealTimeJog,
    /// S451: a traversing task is active.
    Task,
    /// S452: intermediate stop, the task waits.
    Pause,
    /// S46: the task was rejected, brakes with the highest deceleration.
    Reject,
    /// S47: jogging ended, brakes along its ramp.
    Braking,
}

impl PositionState {
    /// All states.
    pub const ALL: [Self; 10] = [
        Basic,
        Homing,
        HomingStop,
        Jog1,
        Jog2,
        RealTimeJog,
        Task,
        Pause,
        Reject,
        Braking,
    ];

    /// Returns the number and name as the profile's diagram has them.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Basic => "S41 basic state",
            Homing => "S42 homing",
            HomingStop => "S43 braking after homing",
            Jog1 | Jog2 | RealTimeJog => "S44 jogging",
            Task => "S451 traversing task active",
            Pause => "S452 intermediate stop",
            Reject => "S46 braking with maximum deceleration",
            Braking => "S47 braking with ramp",
        }
    }

    /// Returns true while a traversing task is there, running or waiting.
    #[must_use]
    pub const fn has_task(self) -> bool {
        matches!(self, Task | Pause)
    }

    /// Returns true while the axis jogs.
    #[must_use]
    pub const fn is_jogging(self) -> bool {
        matches!(self, Jog1 | Jog2 | RealTimeJog)
    }
}

/// A condition beside the bits of STW1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionCondition {
    /// The axis stands still.
    Standstill,
    /// Bit 6 rose in this step.
    TaskEdge,
    /// Bit 11 rose in this step.
    HomingEdge,
    /// The task that is requested can run.
    TaskPermitted,
    /// Homing can run.
    HomingPermitted,
    /// Nothing keeps the axis from jogging the way that is requested.
    JogPermitted,
    /// The jog bits that are 1 were 0 after the last task, homing or stop by a command.
    JogAnew,
    /// The running homing was started by bit 11.
    HomingByBus,
    /// The running task or homing came to its end.
    Finished,
    /// The running motion cannot go on: a limit switch, a target out of reach.
    Failed,
    /// This command came in by another way than STW1.
    Command(PositionCommand),
    /// The intermediate stop is, or is not, due to a command.
    PausedByCommand(bool),
}

/// A wish that comes by another way than STW1: parameters, digital inputs.
/// Source: AKD MT.MOVE, HOME.MOVE, DRV.STOP, MT.CONTINUE.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PositionCommand {
    /// Start a task.
    Task,
    /// Start homing.
    Homing,
    /// Stop the axis; a task waits then.
    Stop,
    /// Go on with the task that was stopped by a command.
    Continue,
}

/// What the owner has to do in a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PositionEffect {
    /// Nothing beyond the new state.
    None,
    /// The task that was requested becomes the running one, in the place of any other.
    StartTask,
    /// The running task goes on where it was interrupted.
    ContinueTask,
    /// The running task is done.
    FinishTask,
    /// The running task is lost.
    DropTask,
    /// Homing begins; the axis is not homed from now on.
    StartHoming,
    /// Homing ends without a home position.
    AbortHoming,
    /// The home position is set.
    FinishHoming,
}

/// One transition: from, to, when, and what comes with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionTransition {
    /// State it leaves.
    pub from: PositionState,
    /// State it enters.
    pub to: PositionState,
    /// Bits of STW1 that are looked at.
    pub mask: u16,
    /// The values these bits must have.
    pub value: u16,
    /// What else must be true, all of it.
    pub also: &'static [PositionCondition],
    /// What the owner has to do.
    pub effect: PositionEffect,
    /// Of several possible transitions out of a state the one with the highest number happens.
    pub priority: u8,
    /// Why, in a few words.
    pub reason: &'static str,
}

/// Bit 4, do not reject.
const KEEP: u16 = 1 << 4;
/// Bit 5, no intermediate stop.
const GO: u16 = 1 << 5;
/// Bit 6, activate task.
const ACTIVATE: u16 = 1 << 6;
/// Bit 8, jog 1.
const JOG1: u16 = 1 << 8;
/// Bit 9, jog 2.
const JOG2: u16 = 1 << 9;
/// Bit 11, homing.
const HOME: u16 = 1 << 11;
/// Bit 12, real-time jogging.
const REAL_TIME: u16 = 1 << 12;
/// Bits 4, 5 and 6: all 0 for jog 1 and 2.
const TASK_BITS: u16 = KEEP | GO | ACTIVATE;
/// Bits that request a jog.
const JOG_BITS: u16 = JOG1 | JOG2 | REAL_TIME;

/// No bit of STW1 is looked at.
const ANY: (u16, u16) = (0, 0);
const RUN: (u16, u16) = (KEEP | GO, KEEP | GO);

const STOP: Also = Also::Command(PositionCommand::Stop);
const BY_EDGE: &[Also] = &[Also::TaskEdge, Also::TaskPermitted];
const BY_COMMAND: &[Also] = &[Also::Command(PositionCommand::Task), Also::TaskPermitted];
const HOME_EDGE: &[Also] = &[Also::HomingEdge, Also::HomingPermitted];
const HOME_COMMAND: &[Also] = &[Also::Command(PositionCommand::Homing), Also::HomingPermitted];
const MAY_JOG: &[Also] = &[Also::Standstill, Also::JogPermitted, Also::JogAnew];
const CONTINUE: &[Also] = &[
    Also::PausedByCommand(true),
    Also::Command(PositionCommand::Continue),
];

/// All transitions, grouped by the state they leave, highest priority first: the first row that fits is the one.
/// A reason with "or" in its guard has a row for each alternative.
///
/// Source: AKD manual 5.4 and 5.10; ABB FSPS and FENA for the meaning of bits 4 and 5. Ours: jog 1 and 2 end with each
/// of bits 4 to 6, as in velocity mode; two simultaneous jog requests stop; a jog bit that is 1 during a task, homing
/// or a stop by a command has to be set again; a task is taken with bits 4 and 5 only; what comes while the axis brakes
/// is lost.
#[rustfmt::skip]
pub static POSITION_TRANSITIONS: &[PositionTransition] = &[
    row(Basic, Homing, (HOME, HOME), HOME_EDGE, PositionEffect::StartHoming, 4, "homing started"),
    row(Basic, Homing, ANY, HOME_COMMAND, PositionEffect::StartHoming, 4, "homing started by a command"),
    row(Basic, Task, RUN, BY_EDGE, PositionEffect::StartTask, 3, "task activated"),
    row(Basic, Task, RUN, BY_COMMAND, PositionEffect::StartTask, 3, "task activated by a command"),
    row(Basic, Jog1, (TASK_BITS | JOG_BITS, JOG1), MAY_JOG, PositionEffect::None, 2, "jog 1"),
    row(Basic, Jog2, (TASK_BITS | JOG_BITS, JOG2), MAY_JOG, PositionEffect::None, 2, "jog 2"),
    row(Basic, RealTimeJog, (JOG_BITS, REAL_TIME), MAY_JOG, PositionEffect::None, 2, "real-time jogging"),
    row(Homing, HomingStop, ANY, &[Also::Failed], PositionEffect::AbortHoming, 4, "homing failed"),
    row(Homing, HomingStop, (HOME, 0), &[Also::HomingByBus], PositionEffect::AbortHoming, 3, "homing aborted"),
    row(Homing, HomingStop, ANY, &[STOP], PositionEffect::AbortHoming, 3, "homing stopped by a command"),
    row(Homing, Basic, ANY, &[Also::Finished], PositionEffect::FinishHoming, 2, "homing finished"),
    row(HomingStop, Basic, ANY, &[Also::Standstill], PositionEffect::None, 1, "stands still"),
    row(Jog1, Braking, ANY, &[Also::Failed], PositionEffect::None, 3, "jogging cannot go on"),
    row(Jog1, Braking, ANY, &[STOP], PositionEffect::None, 3, "jogging stopped by a command"),
    row(Jog1, Braking, (JOG1, 0), &[], PositionEffect::None, 2, "jog 1 ended"),
    row(Jog1, Braking, (JOG2, JOG2), &[], PositionEffect::None, 2, "jog 2 in addition"),
    row(Jog1, Braking, (REAL_TIME, REAL_TIME), &[], PositionEffect::None, 2, "real-time jogging in addition"),
    row(Jog1, Braking, (KEEP, KEEP), &[], PositionEffect::None, 2, "bit 4 is for tasks"),
    row(Jog1, Braking, (GO, GO), &[], PositionEffect::None, 2, "bit 5 is for tasks"),
    row(Jog1, Braking, (ACTIVATE, ACTIVATE), &[], PositionEffect::None, 2, "bit 6 is for tasks"),
    row(Jog2, Braking, ANY, &[Also::Failed], PositionEffect::None, 3, "jogging cannot go on"),
    row(Jog2, Braking, ANY, &[STOP], PositionEffect::None, 3, "jogging stopped by a command"),
    row(Jog2, Braking, (JOG2, 0), &[], PositionEffect::None, 2, "jog 2 ended"),
    row(Jog2, Braking, (JOG1, JOG1), &[], PositionEffect::None, 2, "jog 1 in addition"),
    row(Jog2, Braking, (REAL_TIME, REAL_TIME), &[], PositionEffect::None, 2, "real-time jogging in addition"),
    row(Jog2, Braking, (KEEP, KEEP), &[], PositionEffect::None, 2, "bit 4 is for tasks"),
    row(Jog2, Braking, (GO, GO), &[], PositionEffect::None, 2, "bit 5 is for tasks"),
    row(Jog2, Braking, (ACTIVATE, ACTIVATE), &[], PositionEffect::None, 2, "bit 6 is for tasks"),
    row(RealTimeJog, Braking, ANY, &[Also::Failed], PositionEffect::None, 3, "jogging cannot go on"),
    row(RealTimeJog, Braking, ANY, &[STOP], PositionEffect::None, 3, "jogging stopped by a command"),
    row(RealTimeJog, Braking, (REAL_TIME, 0), &[], PositionEffect::None, 2, "real-time jogging ended"),
    row(RealTimeJog, Braking, (JOG1, JOG1), &[], PositionEffect::None, 2, "jog 1 in addition"),
    row(RealTimeJog, Braking, (JOG2, JOG2), &[], PositionEffect::None, 2, "jog 2 in addition"),
    row(Task, Reject, ANY, &[Also::Failed], PositionEffect::DropTask, 6, "the task cannot go on"),
    row(Task, Reject, (KEEP, 0), &[], PositionEffect::DropTask, 5, "task rejected"),
    row(Task, Pause, (GO, 0), &[], PositionEffect::None, 4, "intermediate stop"),
    row(Task, Pause, ANY, &[STOP], PositionEffect::None, 4, "stopped by a command"),
    row(Task, Task, RUN, BY_EDGE, PositionEffect::StartTask, 3, "change on the fly"),
    row(Task, Task, RUN, BY_COMMAND, PositionEffect::StartTask, 3, "change on the fly by a command"),
    row(Task, Basic, ANY, &[Also::Finished], PositionEffect::FinishTask, 2, "task done"),
    row(Pause, Reject, ANY, &[Also::Failed], PositionEffect::DropTask, 6, "the task cannot go on"),
    row(Pause, Reject, (KEEP, 0), &[], PositionEffect::DropTask, 5, "task rejected"),
    row(Pause, Task, RUN, BY_EDGE, PositionEffect::StartTask, 3, "another task activated"),
    row(Pause, Task, RUN, BY_COMMAND, PositionEffect::StartTask, 3, "another task activated by a command"),
    row(Pause, Task, RUN, &[Also::PausedByCommand(false)], PositionEffect::ContinueTask, 2, "task goes on"),
    row(Pause, Task, RUN, CONTINUE, PositionEffect::ContinueTask, 2, "task goes on by a command"),
    row(Reject, Basic, ANY, &[Also::Standstill], PositionEffect::None, 1, "stands still"),
    row(Braking, Basic, ANY, &[Also::Standstill], PositionEffect::None, 1, "stands still"),
];

/// Where the rows of each state begin in the table, and its end: a cycle looks at those of its state only.
const ROWS_OF: [usize; PositionState::ALL.len() + 1] = {
    let mut begins = [0; PositionState::ALL.len() + 1];
    let mut row = 0;
    while row < POSITION_TRANSITIONS.len() {
        let state = POSITION_TRANSITIONS[row].from as usize;
        assert!(
            row == 0 || state <= POSITION_TRANSITIONS[row - 1].from as usize + 1,
            "every state has rows, in the order of the states"
        );
        begins[state + 1] = row + 1;
        row += 1;
    }
    begins
};

/// Returns the transitions from a state.
fn transitions_from(state: PositionState) -> &'static [PositionTransition] {
    let [begin, end] = [0, 1].map(|next| ROWS_OF.get(state as usize + next).copied().unwrap_or_default());
    POSITION_TRANSITIONS.get(begin..end).unwrap_or_default()
}

const fn row(
    from: PositionState,
    to: PositionState,
    (mask, value): (u16, u16),
    also: &'static [PositionCondition],
    effect: PositionEffect,
    priority: u8,
    reason: &'static str,
) -> PositionTransition {
    PositionTransition {
        from,
        to,
        mask,
        value,
        also,
        effect,
        priority,
        reason,
    }
}

/// Inputs of the state machine in one drive cycle. The default: no request, nothing permitted, the axis turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PositionInputs {
    /// Control word in force.
    pub stw1: Stw1,
    /// The axis stands still: neither moves nor is led by its trajectory.
    pub standstill: bool,
    /// The task that [`PositionMachine::wants_task`] or the command requests can run.
    pub task_permitted: bool,
    /// Homing can run.
    pub homing_permitted: bool,
    /// Jogging the way that the word requests can begin.
    pub jog_permitted: bool,
    /// The running task (with all that follow it) or homing came to its end.
    pub finished: bool,
    /// The running motion cannot go on.
    pub failed: bool,
    /// A wish by another way than STW1.
    pub command: Option<PositionCommand>,
}

/// What comes out of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionOutput {
    /// The state now.
    pub state: PositionState,
    /// The transition of this step.
    pub transition: Option<&'static PositionTransition>,
    /// A task or homing was requested and is not taken: it gets no acknowledge.
    pub refused: bool,
}

impl PositionOutput {
    /// Returns the action that the owner must take.
    #[must_use]
    pub fn effect(&self) -> PositionEffect {
        self.transition.map_or(PositionEffect::None, |row| row.effect)
    }
}

/// State of the axis, for the status word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PositionFacts {
    /// The following error is inside its window.
    pub in_range: bool,
    /// The last task is done and the axis is in its window.
    pub reached: bool,
    /// The home position is set.
    pub homed: bool,
    /// The axis stands still.
    pub standstill: bool,
}

/// Extended state machine of one axis in position mode.
/// Source: AKD manual 5.10; the transitions are in [`POSITION_TRANSITIONS`].
///
/// - It runs in S4 only. The caller that enters or leaves S4 calls [`reset`](Self::reset): bits that are 1 already are
///   not edges then, so nothing that was requested outside S4 starts.
/// - Bit 12 of ZSW1 rises when a task that bit 6 requested is taken, and falls when bit 6 does. A task that cannot run
///   is not acknowledged; the one that runs is not disturbed.
///
/// ```
/// use profidrive_profile::state::{PositionInputs, PositionMachine, PositionState, Stw1};
/// let mut axis = PositionMachine::new();
/// let ready = Stw1::RUN.without(Stw1::ACTIVATE_TASK);
/// axis.reset(ready);
/// let inputs = PositionInputs { task_permitted: true, standstill: true, ..PositionInputs::default() };
/// let output = axis.step(&PositionInputs { stw1: Stw1::RUN, ..inputs }); // edge of bit 6
/// assert_eq!(output.state, PositionState::Task);
/// assert!(axis.acknowledges());
/// axis.step(&PositionInputs { stw1: ready, ..inputs });
/// assert!(!axis.acknowledges() && axis.state() == PositionState::Task);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionMachine {
    state: PositionState,
    /// The word of the last step.
    before: Stw1,
    acknowledge: bool,
    homing_by_bus: bool,
    paused_by_command: bool,
    /// Bits that request a jog and have to be 0 first: they were 1 while a task or homing had the axis.
    spent_jogs: u16,
}

impl Default for PositionMachine {
    fn default() -> Self {
        Self::new()
    }
}

impl PositionMachine {
    /// In the basic state, no bit has been 0 yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            state: Basic,
            before: Stw1(0xFFFF),
            acknowledge: false,
            homing_by_bus: false,
            paused_by_command: false,
            spent_jogs: 0,
        }
    }

    /// Back to the basic state, with this word in force: S4 or the mode is entered or left.
    pub const fn reset(&mut self, word: Stw1) {
        *self = Self {
            before: word,
            ..Self::new()
        };
    }

    /// Returns the state that a control word leads to from the basic state at standstill, with bits 6 and 11 as edges and
    /// everything permitted. [`PositionState::Basic`] where the word moves nothing.
    ///
    /// ```
    /// use profidrive_profile::state::{PositionMachine, PositionState, Stw1};
    /// assert_eq!(PositionMachine::commanded(Stw1(0x147F)), PositionState::Task);
    /// assert_eq!(PositionMachine::commanded(Stw1(0x140F)), PositionState::RealTimeJog);
    /// assert_eq!(PositionMachine::commanded(Stw1(0x150F)), PositionState::Basic); // two jogs at once
    /// ```
    #[must_use]
    pub fn commanded(word: Stw1) -> PositionState {
        let mut axis = Self::new();
        axis.reset(word.without(Stw1::ACTIVATE_TASK | Stw1::START_HOMING));
        let inputs = PositionInputs {
            stw1: word,
            standstill: true,
            task_permitted: true,
            homing_permitted: true,
            jog_permitted: true,
            ..PositionInputs::default()
        };
        axis.step(&inputs).state
    }

    /// Returns the state after the last step.
    #[must_use]
    pub const fn state(&self) -> PositionState {
        self.state
    }

    /// Traversing task acknowledgement (ZSW1 bit 12).
    #[must_use]
    pub const fn acknowledges(&self) -> bool {
        self.acknowledge
    }

    /// Returns true when a step with this word has a rising edge of bit 6: the caller has to check if the task can run.
    #[must_use]
    pub const fn wants_task(&self, word: Stw1) -> bool {
        self.rises(word, Stw1::ACTIVATE_TASK)
    }

    /// Returns true when a step with this word has a rising edge of bit 11.
    #[must_use]
    pub const fn wants_homing(&self, word: Stw1) -> bool {
        self.rises(word, Stw1::START_HOMING)
    }

    const fn rises(&self, word: Stw1, bit: Stw1) -> bool {
        word.has(bit) && !self.before.has(bit)
    }

    /// One drive cycle in S4: at most one transition. Does not allocate.
    pub fn step(&mut self, inputs: &PositionInputs) -> PositionOutput {
        let task_edge = self.wants_task(inputs.stw1);
        let homing_edge = self.wants_homing(inputs.stw1);
        let holds = |condition: &PositionCondition| match *condition {
            Also::Standstill => inputs.standstill,
            Also::TaskEdge => task_edge,
            Also::HomingEdge => homing_edge,
            Also::TaskPermitted => inputs.task_permitted,
            Also::HomingPermitted => inputs.homing_permitted,
            Also::JogPermitted => inputs.jog_permitted,
            Also::JogAnew => inputs.stw1.0 & self.spent_jogs == 0,
            Also::HomingByBus => self.homing_by_bus,
            Also::Finished => inputs.finished,
            Also::Failed => inputs.failed,
            Also::Command(command) => inputs.command == Some(command),
            Also::PausedByCommand(by_command) => self.paused_by_command == by_command,
        };
        let transition = transitions_from(self.state)
            .iter()
            .find(|row| inputs.stw1.0 & row.mask == row.value && row.also.iter().all(holds));
        let spends = matches!(self.state, Homing | HomingStop | Task | Pause | Reject)
            || inputs.command == Some(PositionCommand::Stop);
        self.spent_jogs = inputs.stw1.0 & if spends { JOG_BITS } else { self.spent_jogs };
        self.before = inputs.stw1;
        self.acknowledge &= inputs.stw1.has(Stw1::ACTIVATE_TASK);
        let effect = transition.map_or(PositionEffect::None, |row| row.effect);
        if let Some(row) = transition {
            self.state = row.to;
            match row.effect {
                PositionEffect::StartTask => self.acknowledge |= row.also.contains(&Also::TaskEdge),
                PositionEffect::StartHoming => self.homing_by_bus = row.also.contains(&Also::HomingEdge),
                _ => {}
            }
            self.paused_by_command = row.to == Pause && row.also.contains(&STOP);
        }
        let asked = |edge, command| edge || inputs.command == Some(command);
        let refused = (asked(task_edge, PositionCommand::Task) && effect != PositionEffect::StartTask)
            || (asked(homing_edge, PositionCommand::Homing) && effect != PositionEffect::StartHoming);
        PositionOutput {
            state: self.state,
            transition,
            refused,
        }
    }

    /// Bits 8 and 10 to 14 of ZSW1. While homing runs bits 10, 11 and 13 are 0; bit 10 also while there is a task.
    /// Source: AKD manual 5.5 and 5.10.3.
    #[must_use]
    pub const fn status(&self, facts: &PositionFacts) -> Zsw1 {
        let homing = matches!(self.state, Homing);
        let task = self.state.has_task();
        let mut word = Zsw1(0);
        if facts.in_range {
            word = word.with(Zsw1::IN_TOLERANCE);
        }
        if facts.reached && !homing && !task {
            word = word.with(Zsw1::REACHED);
        }
        if facts.homed && !homing {
            word = word.with(Zsw1::HOMED);
        }
        if self.acknowledge {
            word = word.with(Zsw1::TASK_ACKNOWLEDGED);
        }
        if facts.standstill && !homing {
            word = word.with(Zsw1::STOPPED);
        }
        if task {
            word = word.with(Zsw1::TASK_ACTIVE);
        }
        word
    }

    /// Creates a machine in the middle of something.
    #[cfg(test)]
    pub(super) const fn in_state(
        state: PositionState,
        before: Stw1,
        homing_by_bus: bool,
        paused_by_command: bool,
    ) -> Self {
        Self {
            state,
            before,
            acknowledge: before.has(Stw1::ACTIVATE_TASK),
            homing_by_bus,
            paused_by_command,
            spent_jogs: 0,
        }
    }
}

#[cfg(test)]
mod exhaustive;
#[cfg(test)]
mod tests;
