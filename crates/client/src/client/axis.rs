//! One axis of a client: what is sent and seen of it.

use std::sync::Arc;

use profile::state::{Mode, State, Stw1, Zsw1};
use profinet::Instant;
use profinet::controller::Controller;

use super::Link;
use super::stop::StopOnItsWay;
use crate::axis::{AxisControl, Command, Goal, Progress, SampleQueue, Seen, Travel, Traverse, Wiring};
use crate::line::Line;

/// One axis of one cyclic connection.
#[derive(Debug)]
pub(super) struct AxisLink {
    pub(super) link: Link,
    /// Where the telegram is; nowhere on a line.
    pub(super) slot: u16,
    pub(super) subslot: u16,
    pub(super) wiring: Wiring,
    pub(super) control: AxisControl,
    pub(super) seen: Option<Seen>,
    pub(super) sent: Option<Command>,
    /// The control word that the answer of the drive belongs to.
    pub(super) answered: Stw1,
    /// Frames and status word when the present control word was sent.
    pub(super) since: (u64, Option<Zsw1>),
    /// It was in operation under this control.
    pub(super) operated: bool,
    /// Frames that it was stepped by.
    pub(super) stepped: u64,
    /// Frames that were sampled.
    pub(super) sampled: u64,
    /// How far it may go, where that is limited.
    pub(super) travel: Option<Travel>,
    /// It was halted there, and no motion was begun since.
    pub(super) travel_ended: bool,
    /// Receivers of every input.
    pub(super) taps: Vec<Arc<SampleQueue>>,
    /// How far the last stop is on its way; `None` before the first.
    pub(super) stop: Option<StopOnItsWay>,
}

/// Frames after which a drive has had time to answer a control word, whether its status word changed or not.
const ANSWER: u64 = 4;

impl AxisLink {
    /// Halts the axis along its ramp where it would leave its travel; it stays in operation.
    pub(super) fn keep_within(&mut self, now: Instant, seen: Seen) {
        let Some(travel) = &mut self.travel else { return };
        travel.see(now, seen);
        if travel.ends() && self.control.goal().moves() {
            self.control.pursue(now, Goal::Enabled);
            self.travel_ended = true;
        }
    }

    /// Puts the present command into the outputs, if it is not there.
    pub(super) fn send(&mut self, controller: &mut Controller, line: Option<&mut Line>) {
        let command = self.control.command();
        if self.sent == Some(command) {
            return;
        }
        let data = self.wiring.encode(&command);
        let sent = match self.link {
            Link::ArListEntry(ar) => controller.set_output(ar, self.slot, self.subslot, data).is_ok(),
            Link::Slave(slave) => match (line, data.try_into()) {
                (Some(line), Ok(outputs)) => {
                    line.set_outputs(slave, outputs);
                    true
                }
                _ => false,
            },
        };
        if sent {
            self.sent = Some(command);
        }
    }

    /// Notes that the drive answered the present control word: by another status word, or by the same one for some
    /// cycles.
    pub(super) fn note_answer(&mut self, received: u64) {
        let word = self.control.command().stw1;
        let status = self.seen.map(|seen| seen.zsw1);
        if self.answered != word && (status != self.since.1 || received >= self.since.0 + ANSWER) {
            self.answered = word;
        }
        // in local operation it follows no ON of ours: pulses without operation are those of its stop
        if self.seen.is_some_and(|seen| !seen.control_requested()) {
            self.answered = self.answered.without(Stw1::ON);
        }
    }
}

/// An axis at a glance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisView {
    /// The goal.
    pub goal: Goal,
    /// How far it is.
    pub progress: Progress,
    /// What is being sent, in the bits of the profile.
    pub command: Command,
    /// The control word as it is sent, in the words of the model.
    pub sent: u16,
    /// The last decoded inputs; `None` before the first valid input.
    pub seen: Option<Seen>,
    /// The control word that the last answer of the drive belongs to.
    pub answered: Stw1,
    /// True when the axis stands with the pulses off.
    pub at_rest: bool,
    /// True when a quick stop was commanded: it was requested, or the ramp stop took too long.
    pub quick_stop: bool,
    /// True when that was requested.
    pub hurried: bool,
    /// True when the drive reports that the axis moves, whether it is driven or not.
    pub turns: bool,
    /// True while the axis stands where its task does not end.
    pub stays_away: bool,
    /// True once the drive has accepted the task, or has begun to home.
    pub accepted: bool,
    /// The task that an intermediate stop holds.
    pub held: Option<Traverse>,
    /// What the drive is for, as passed to the control.
    pub mode: Mode,
    /// True once it was in operation under this control.
    pub operated: bool,
    /// True when it was halted at the end of its travel, and no motion was begun since.
    pub travel_ended: bool,
}

impl AxisView {
    /// State of the drive: its status word read with the control word that it answers. `None` before the first valid
    /// input and while the drive is not ready.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.seen?.state(self.answered)
    }
}
