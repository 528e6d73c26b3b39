//! Which control word to send next: the steps of a person at the drive, as a machine without time of its own.

mod position;

use core::time::Duration;

use profile::state::{Mode, State, Stw1};
use profinet::Instant;

use super::command::{Command, Traverse};
use super::goal::{Goal, Jog, Limits, Progress, StopKind, Trouble};
use super::seen::Seen;
use position::Phase;

/// Quick stop (OFF3) with OFF: once it is over, nothing switches on again.
const QUICK_STOP: Stw1 = Stw1::READY.without(Stw1::NO_QUICK_STOP);
/// Coast stop (OFF2) with OFF: the pulses are off at once.
const COAST_STOP: Stw1 = Stw1::READY.without(Stw1::NO_COAST_STOP);
/// Operation with the ramp generator's input at zero: brakes along the ramp, stays enabled.
const INPUT_ZERO: Stw1 = Stw1::RUN.without(Stw1::ENABLE_SETPOINT);
/// Operation with the setpoint channel closed: jogging is permitted.
const JOG_READY: Stw1 = INPUT_ZERO.without(Stw1::ENABLE_RAMP).without(Stw1::UNFREEZE_RAMP);
/// Bits 4 to 6, which only count in operation.
const SETPOINT_CHANNEL: Stw1 = Stw1(0x0070);
/// No control by PLC: the drive ignores everything else.
const RELEASED: Stw1 = Stw1(0);

/// Steps a drive towards a goal, one control word at a time.
///
/// Never switches on by itself again after the drive left operation; every failure turns into a ramp stop.
///
/// ```
/// use profidrive_client::axis::{AxisControl, Goal, Limits, Seen};
/// use profile::state::{Stw1, Zsw1};
/// use profinet::Instant;
/// let mut axis = AxisControl::new(Limits::default());
/// axis.pursue(Instant::ZERO, Goal::Run { setpoint: 0xA3 });
/// let ready_for_switching_on = Seen { zsw1: Zsw1(0x0231), ..Seen::default() };
/// assert_eq!(axis.step(Instant::ZERO, ready_for_switching_on).stw1, Stw1::RUN);
/// let operation = Seen { zsw1: Zsw1(0x0237), ..Seen::default() };
/// assert_eq!(axis.step(Instant::from_millis(16), operation).nsoll_a, 0xA3);
/// ```
#[derive(Debug, Clone)]
pub struct AxisControl {
    limits: Limits,
    mode: Mode,
    goal: Goal,
    progress: Progress,
    /// Start of the present goal, or of its last step.
    since: Instant,
    /// Since when the present control word stands.
    word_since: Instant,
    command: Command,
    /// Since when the drive is controlled.
    controlled_since: Instant,
    was_in_operation: bool,
    way: StopKind,
    /// The quick or coast stop was requested, so it is no sign of a ramp stop that failed.
    hurried: bool,
    /// Since when a coasting axis stands.
    standing: Option<Instant>,
    /// ON was sent and the drive has not reported since that the pulses are off.
    may_turn: bool,
    /// First trouble since the last goal set by the caller.
    trouble: Option<Trouble>,
    /// Step of a goal of position mode, and since when.
    phase: Phase,
    phase_since: Instant,
    /// The task that an intermediate stop holds.
    paused: Option<Traverse>,
    /// Something may be under way that has to be stopped and discarded first.
    braking: bool,
    /// The home position was set when homing was started.
    homed_before: bool,
    /// Since when the axis stands where it should not stay.
    astray: Option<Instant>,
    /// Time at which operation ends unless it is extended.
    deadline: Option<Instant>,
    /// Time at which a motion is halted unless it is extended.
    beat: Option<Instant>,
    /// It is brought to rest and released for good.
    ending: bool,
}

impl AxisControl {
    /// Without control, for a drive in velocity mode.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self::in_mode(limits, Mode::Velocity)
    }

    /// Without control, for a drive in this mode.
    #[must_use]
    pub fn in_mode(limits: Limits, mode: Mode) -> Self {
        Self {
            limits,
            mode,
            goal: Goal::Released,
            progress: Progress::Reached,
            since: Instant::ZERO,
            word_since: Instant::ZERO,
            command: Command::default(),
            controlled_since: Instant::ZERO,
            was_in_operation: false,
            way: StopKind::Ramp,
            hurried: false,
            standing: None,
            may_turn: false,
            trouble: None,
            phase: Phase::Begin,
            phase_since: Instant::ZERO,
            paused: None,
            braking: false,
            homed_before: false,
            astray: None,
            deadline: None,
            beat: None,
            ending: false,
        }
    }

    /// With control of a drive that is in operation: what it obeys now goes on until the first goal.
    #[must_use]
    pub fn taking_over(limits: Limits, mode: Mode, present: Command) -> Self {
        let position = mode == Mode::Position;
        let stw1 = if position {
            present.stw1.without(Stw1::ACTIVATE_TASK)
        } else {
            present.stw1
        };
        Self {
            goal: Goal::Keep,
            command: Command { stw1, ..present },
            may_turn: true,
            ..Self::in_mode(limits, mode)
        }
    }

    /// From now on only a stop and the release are pursued, whatever else is requested.
    pub const fn end(&mut self) {
        self.ending = true;
    }

    /// Sets the target state from now on.
    pub fn pursue(&mut self, now: Instant, goal: Goal) {
        if self.ending && !matches!(goal, Goal::Stop | Goal::Released) {
            return;
        }
        // a new setpoint while running is not a new start
        let same_motion = matches!((self.goal, goal), (Goal::Run { .. }, Goal::Run { .. }));
        // a quick or coast stop under way is not taken back
        let same_stop = self.way > StopKind::Ramp && (self.goal, goal) == (Goal::Stop, Goal::Stop);
        let goes_on = self.goal.operates() && goal.operates();
        self.keep_task(now, goal);
        self.goal = goal;
        self.trouble = None;
        if same_motion {
            return;
        }
        self.progress = Progress::Pursuing;
        // an axis that was in operation and is not any more is not switched on by the next wish
        self.was_in_operation &= goes_on;
        if !same_stop {
            self.since = now;
            self.way = StopKind::Ramp;
            self.hurried = false;
        }
    }

    /// Stops an axis that is in operation, whoever moves it: who does is reported by [`Trouble::Stopped`].
    pub fn stop_now(&mut self, now: Instant) {
        if self.goal.operates() || self.goal == Goal::Keep {
            self.give_up(now, Trouble::Stopped);
        }
    }

    /// Turns a stop under way into this one. A coast stop stays one.
    pub fn hurry(&mut self, now: Instant, way: StopKind) {
        if self.goal != Goal::Stop || self.progress != Progress::Pursuing || way == StopKind::Ramp {
            return;
        }
        self.hurried = true;
        if self.way < way {
            self.way = way;
            self.since = now;
            self.standing = None;
        }
    }

    /// Says how long a ramp stop may take from now on before the quick stop is used.
    pub const fn allow_stop(&mut self, limit: Duration) {
        self.limits.stop = limit;
    }

    /// Says when operation ends by a ramp stop, unless it is said again; with `None` it never does.
    pub const fn set_deadline(&mut self, deadline: Option<Instant>) {
        self.deadline = deadline;
    }

    /// Says when a motion is halted along its ramp, unless it is said again; the axis stays in operation. From the first beat on
    /// a motion without one is halted at once; with `None` it needs none.
    pub const fn set_beat(&mut self, beat: Option<Instant>) {
        self.beat = beat;
    }

    /// Returns the goal.
    #[must_use]
    pub const fn goal(&self) -> Goal {
        self.goal
    }

    /// Returns the progress. A failure stays until the next [`pursue`](Self::pursue).
    #[must_use]
    pub fn progress(&self) -> Progress {
        // a failed motion is reported at once, while the stop is still under way
        self.trouble.map_or(self.progress, Progress::Failed)
    }

    /// Returns true when the axis stands with the pulses off, as far as the drive reports.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        matches!(
            self.goal,
            Goal::Released | Goal::Stop | Goal::Ready | Goal::Acknowledge
        ) && self.progress == Progress::Reached
    }

    /// Returns the operating mode of the drive.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Returns true once the drive has accepted the task, or has begun to home.
    #[must_use]
    pub const fn is_accepted(&self) -> bool {
        matches!(self.phase, Phase::UnderWay | Phase::Done)
    }

    /// Returns the task that an intermediate stop holds.
    #[must_use]
    pub const fn held(&self) -> Option<Traverse> {
        match self.goal {
            Goal::Pause => self.paused,
            _ => None,
        }
    }

    /// Returns the command that is being sent.
    #[must_use]
    pub const fn command(&self) -> Command {
        self.command
    }

    /// Evaluates what the drive reports and chooses what to send.
    pub fn step(&mut self, now: Instant, seen: Seen) -> Command {
        // a coasting axis turns with its pulses off
        let coasts = self.way == StopKind::Coast && self.progress == Progress::Pursuing;
        let off = seen.pulses_off() && !self.command.stw1.has(Stw1::ON) && self.stood(now) && !coasts;
        self.may_turn &= !off;
        let mut next = self.choose(now, seen);
        if next.traverse == Traverse::default() {
            // preset to where the axis is, so that no edge could ever take it elsewhere
            next.traverse.target = seen.xist_a.unwrap_or(0);
        }
        self.send(now, next)
    }

    /// As [`step`](Self::step) while the inputs of the drive are not valid: an axis that may turn is stopped, and no
    /// goal is pursued for longer than it could be with them.
    pub fn step_blind(&mut self, now: Instant) -> Command {
        let next = self.choose_blind(now);
        self.send(now, next)
    }

    fn send(&mut self, now: Instant, mut next: Command) -> Command {
        if self.mode == Mode::Position && self.phase != Phase::Edge {
            // in position mode bit 6 starts a task
            next.stw1 = next.stw1.without(Stw1::ACTIVATE_TASK);
        }
        if next.stw1 != self.command.stw1 {
            self.word_since = now;
        }
        if self.command.stw1 == RELEASED {
            self.controlled_since = now;
        }
        self.may_turn |= next.stw1.has(Stw1::ON);
        self.command = next;
        next
    }

    fn choose_blind(&mut self, now: Instant) -> Command {
        let too_long = self.took(now) > self.limits.step;
        if self.goal.moves() && self.beat.is_some_and(|beat| beat <= now) {
            self.pursue(now, Goal::Enabled);
        }
        match self.goal {
            Goal::Released => {
                self.progress = Progress::Reached;
                word(RELEASED)
            }
            Goal::Stop => self.stop_blind(now),
            goal if goal.operates() && (self.may_turn || too_long) => {
                self.give_up(now, Trouble::NoInputs);
                self.stop_blind(now)
            }
            _ => {
                if too_long {
                    self.trouble.get_or_insert(Trouble::NoInputs);
                }
                self.command
            }
        }
    }

    /// Nothing says that the axis stands: the stops get all the time they may take.
    fn stop_blind(&mut self, now: Instant) -> Command {
        if self.may_turn {
            self.stop_in_time(now, false);
        } else {
            self.progress = Progress::Reached;
        }
        self.stop_word()
    }

    /// A motion has failed: what remains is to stop.
    fn give_up(&mut self, now: Instant, trouble: Trouble) {
        self.trouble.get_or_insert(trouble);
        self.goal = Goal::Stop;
        self.phase = Phase::Begin;
        self.braking = false;
        self.progress = Progress::Pursuing;
        self.since = now;
        self.way = StopKind::Ramp;
        self.hurried = false;
    }

    fn choose(&mut self, now: Instant, seen: Seen) -> Command {
        if self.goal != Goal::Released && !seen.control_requested() && self.took(now) > self.limits.step {
            self.trouble.get_or_insert(Trouble::LocalOperation);
        }
        if let Some(needed) = self.goal.mode().filter(|&needed| needed != self.mode) {
            self.give_up(now, Trouble::OtherMode { needed });
        }
        if self.goal.operates() && self.deadline.is_some_and(|deadline| deadline <= now) {
            self.give_up(now, Trouble::Unattended);
        }
        if self.goal.moves() && self.beat.is_some_and(|beat| beat <= now) {
            self.pursue(now, Goal::Enabled);
        }
        match self.goal {
            Goal::Released => {
                self.progress = Progress::Reached;
                word(RELEASED)
            }
            Goal::Keep => {
                self.progress = Progress::Reached;
                self.command
            }
            Goal::Ready => self.make_ready(now, seen),
            Goal::Enabled => self.enabled(now, seen),
            Goal::Traverse(task) => self.traverse(now, seen, task),
            Goal::Pause => self.pause(now, seen),
            Goal::Home { on_the_spot } => self.home(now, seen, on_the_spot),
            Goal::Run { setpoint } => self.run(now, seen, setpoint),
            Goal::Jog(jog) => self.jog(now, seen, jog),
            Goal::RealTimeJog { values, backwards } => self.real_time_jog(now, seen, values, backwards),
            Goal::Acknowledge => self.acknowledge(now, seen),
            Goal::Stop => self.stop(now, seen),
        }
    }

    fn make_ready(&mut self, now: Instant, seen: Seen) -> Command {
        if self.state(seen) == Some(State::S2) {
            self.progress = Progress::Reached;
        } else if self.progress == Progress::Pursuing && self.took(now) > self.limits.step {
            let fault = seen.fault().then_some(Trouble::Fault);
            self.trouble.get_or_insert(fault.unwrap_or(Trouble::StuckIn {
                state: self.state(seen),
            }));
        }
        word(Stw1::READY)
    }

    fn run(&mut self, now: Instant, seen: Seen, setpoint: i16) -> Command {
        match self.switch_on(now, seen, Stw1::RUN) {
            Some(command) => command,
            None => {
                self.progress = Progress::Reached;
                Command {
                    nsoll_a: setpoint,
                    ..word(Stw1::RUN)
                }
            }
        }
    }

    /// In operation, standing.
    fn enabled(&mut self, now: Instant, seen: Seen) -> Command {
        match self.mode {
            Mode::Velocity => self.run(now, seen, 0),
            Mode::Position => self.halt(now, seen),
        }
    }

    fn jog(&mut self, now: Instant, seen: Seen, jog: Jog) -> Command {
        if let Some(command) = self.switch_on(now, seen, JOG_READY) {
            return command;
        }
        // standstill is waited for before a jog, but no longer than for a stop
        if self.progress == Progress::Pursuing && self.took(now) > self.limits.step + self.limits.stop {
            self.give_up(now, Trouble::NotStopped);
            return self.stop(now, seen);
        }
        match self.command.stw1 {
            jogging if jogging == JOG_READY | jog.bit() => {
                self.progress = Progress::Reached;
                word(jogging)
            }
            // along the ramp to standstill before the setpoint channel is closed, or the task is discarded
            running if running.0 & SETPOINT_CHANNEL.0 != 0 && !self.stands(seen) => match self.mode {
                Mode::Velocity => word(INPUT_ZERO),
                Mode::Position => word(position::PAUSED),
            },
            JOG_READY if self.stood(now) && self.stands(seen) => word(JOG_READY | jog.bit()),
            _ => word(JOG_READY),
        }
    }

    /// Returns the way to S4 with `on` as the word that switches on; `None` once there. Failures turn into a stop.
    fn switch_on(&mut self, now: Instant, seen: Seen, on: Stw1) -> Option<Command> {
        let state = self.state(seen);
        let operation = state == Some(State::S4);
        if seen.fault() && !self.has_answered(now) {
            return Some(word(Stw1::READY));
        }
        let trouble = if seen.fault() {
            Some(Trouble::Fault)
        } else if self.was_in_operation && !operation {
            Some(if seen.control_requested() {
                Trouble::LeftOperation { state }
            } else {
                Trouble::LocalOperation
            })
        } else if !operation && self.took(now) > self.limits.step {
            let local = !seen.control_requested();
            Some(if local {
                Trouble::LocalOperation
            } else {
                Trouble::StuckIn { state }
            })
        } else {
            self.trouble
        };
        if let Some(trouble) = trouble {
            self.give_up(now, trouble);
            return Some(self.stop(now, seen));
        }
        match state {
            Some(State::S4) => {
                self.was_in_operation = true;
                None
            }
            Some(State::S2 | State::S3) => Some(word(on)),
            // ON takes a ramp stop back, once the drive is sure to have seen the OFF
            Some(State::S5Ramp) if self.stood(now) => Some(word(on)),
            // OFF first, also to end a stop that is still under way
            Some(State::S1 | State::S5Ramp | State::S5Quick) | None => Some(word(Stw1::READY)),
        }
    }

    fn acknowledge(&mut self, now: Instant, seen: Seen) -> Command {
        // bit 6 does not count here, position mode sends it as 0
        match self.command.stw1.with(Stw1::ACTIVATE_TASK) {
            Stw1::ACKNOWLEDGE => {
                let cleared = !seen.fault();
                if !(cleared && self.stood(now)) && self.word_age(now) <= self.limits.step {
                    return word(Stw1::ACKNOWLEDGE);
                }
                if !cleared {
                    self.trouble.get_or_insert(Trouble::FaultStays);
                }
                self.progress = Progress::Reached;
                word(Stw1::READY)
            }
            Stw1::READY if self.progress == Progress::Pursuing && self.stood(now) => {
                if seen.fault() {
                    word(Stw1::ACKNOWLEDGE)
                } else {
                    self.progress = Progress::Reached;
                    word(Stw1::READY)
                }
            }
            _ => word(Stw1::READY),
        }
    }

    fn stop(&mut self, now: Instant, seen: Seen) -> Command {
        if self.way == StopKind::Coast {
            self.coast(now, seen);
        } else if seen.pulses_off() {
            // the word must have reached the drive: what it reports may be older than the command
            if !self.command.stw1.has(Stw1::ON) && self.stood(now) {
                self.progress = Progress::Reached;
            }
        } else {
            self.stop_in_time(now, false);
        }
        self.stop_word()
    }

    /// Waits until a coasting axis rests. Pulses that are off are no proof of that, as nothing brakes it: the drive has to
    /// report for a while that it stands.
    fn coast(&mut self, now: Instant, seen: Seen) {
        if self.progress == Progress::Reached {
            return;
        }
        if !seen.pulses_off() || !self.stands(seen) {
            self.standing = None;
            self.stop_in_time(now, seen.pulses_off());
            return;
        }
        let since = *self.standing.get_or_insert(now);
        if self.stood(now) && now - since >= self.limits.rest {
            self.progress = Progress::Reached;
        }
    }

    const fn stop_word(&self) -> Command {
        word(match self.way {
            StopKind::Ramp => Stw1::READY,
            StopKind::Quick => QUICK_STOP,
            StopKind::Coast => COAST_STOP,
        })
    }

    /// Returns the state reported by the drive, decoded with the control word it was sent.
    fn state(&self, seen: Seen) -> Option<State> {
        seen.state(self.command.stw1)
    }

    /// Changes to the quick stop when the ramp stop takes longer than its limit, and gives up after the same time again, or
    /// when an axis that coasts does not come to rest. `off`: the pulses are off.
    fn stop_in_time(&mut self, now: Instant, off: bool) {
        let limit = match self.way {
            StopKind::Coast => self.limits.coast,
            StopKind::Ramp | StopKind::Quick => self.limits.stop,
        };
        if self.took(now) <= limit {
            return;
        }
        if self.way == StopKind::Ramp {
            self.way = StopKind::Quick;
            self.since = now;
            self.trouble.get_or_insert(Trouble::QuickStopUsed);
        } else {
            self.trouble = Some(if off {
                Trouble::StillTurns
            } else {
                Trouble::NotStopped
            });
            self.progress = Progress::Reached;
        }
    }

    /// Returns whether the axis stands, by the best value in the telegram of its mode.
    const fn stands(&self, seen: Seen) -> bool {
        match self.mode {
            Mode::Velocity => seen.stands(self.limits.standstill),
            Mode::Position => seen.stopped(),
        }
    }

    /// Returns whether the axis stands where its task does not end.
    pub(crate) const fn stays_away(&self) -> bool {
        self.astray.is_some()
    }

    /// Returns whether the axis stops by its quick stop.
    pub(crate) fn stops_quickly(&self) -> bool {
        self.way == StopKind::Quick
    }

    /// Returns whether that was requested.
    pub(crate) const fn was_hurried(&self) -> bool {
        self.hurried
    }

    /// Returns true if the axis certainly moves, independent of the goal. Without speed and standstill bit in the
    /// telegram the result is false.
    pub(crate) fn turns(&self, seen: Seen) -> bool {
        match self.mode {
            Mode::Velocity => {
                let above = |speed: i16| speed.unsigned_abs() > self.limits.standstill;
                seen.nist_a.is_some_and(above)
            }
            Mode::Position => !seen.stopped(),
        }
    }

    /// Returns whether the status word answers the present control word: before that it may be one of another
    /// connection, with other bits.
    fn has_answered(&self, now: Instant) -> bool {
        self.command.stw1 != RELEASED && now - self.controlled_since >= self.limits.dwell
    }

    fn took(&self, now: Instant) -> Duration {
        now - self.since
    }

    fn word_age(&self, now: Instant) -> Duration {
        now - self.word_since
    }

    /// Returns whether the present word stood long enough to be seen by the drive.
    fn stood(&self, now: Instant) -> bool {
        self.word_age(now) >= self.limits.dwell
    }
}

const fn word(stw1: Stw1) -> Command {
    Command {
        stw1,
        nsoll_a: 0,
        traverse: Traverse::task(0),
    }
}

#[cfg(test)]
mod tests;
