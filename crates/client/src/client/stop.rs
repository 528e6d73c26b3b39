//! Stops on their way: from the moment they were requested until a frame with them has left.

use profile::state::Stw1;
use profinet::Instant;

use super::axis::AxisLink;
use super::{Client, Link};
use crate::axis::{Goal, StopKind};

/// How far a stop is on its way to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StopOnItsWay {
    /// It waits for its frame, the first after so many.
    Waits(u64),
    /// The frame was taken by the wire in this turn, at whose end it is known whether the wire failed.
    Handed(Instant),
    /// The frame was handed to the network.
    Sent(Instant),
}

impl AxisLink {
    /// Notes that so many frames have left until now: a stop that waits for its frame is in the last one, if the outputs have it.
    pub(super) fn note_stop(&mut self, frames: u64, now: Instant) {
        let Some(StopOnItsWay::Waits(before)) = self.stop else {
            return;
        };
        if frames > before {
            let command = self.control.command();
            // each word that stops is one without ON
            let has_it = self.sent == Some(command) && !command.stw1.has(Stw1::ON);
            self.stop = Some(match has_it {
                true => StopOnItsWay::Handed(now),
                false => StopOnItsWay::Waits(frames),
            });
        }
    }
}

impl Client {
    /// Stops an axis that is in operation, or all of them. Returns whether one was in operation or on its way out of it.
    pub fn stop_now(&mut self, now: Instant, link: Option<Link>, way: StopKind) -> bool {
        let mut stops = false;
        for at in 0..self.axes.len() {
            let Some(axis) = self.axes.get_mut(at) else { break };
            if link.is_some_and(|link| axis.link != link) {
                continue;
            }
            axis.control.stop_now(now);
            axis.control.hurry(now, way);
            stops |= axis.control.goal() == Goal::Stop && !axis.control.is_at_rest();
            // a telegram at a line that is under way already is answered first
            let under_way = u64::from(matches!(axis.link, Link::Slave(_)));
            let frames = self.frames_sent(at) + under_way;
            if let Some(axis) = self.axes.get_mut(at) {
                axis.stop = Some(StopOnItsWay::Waits(frames));
            }
        }
        self.stops_wait = true;
        self.work(now);
        stops
    }

    /// Returns how many frames with the outputs of an axis have left; of telegrams at a line, how many were answered.
    fn frames_sent(&self, at: usize) -> u64 {
        match self.axes.get(at).map(|axis| axis.link) {
            Some(Link::ArListEntry(ar)) => self.controller.sent(ar).map_or(0, |(sent, _)| sent),
            Some(Link::Slave(slave)) => self.line.as_ref().map_or(0, |line| line.replies(slave)),
            None => 0,
        }
    }

    /// Looks whether the frames have left that stops wait for.
    pub(super) fn note_stops(&mut self, now: Instant) {
        for at in 0..self.axes.len() {
            let frames = self.frames_sent(at);
            if let Some(axis) = self.axes.get_mut(at) {
                axis.note_stop(frames, now);
            }
        }
    }

    /// Ends a turn: what the wire took in it has left, unless the wire has failed.
    pub(crate) fn end_turn(&mut self, now: Instant, failed: bool) {
        if !self.stops_wait {
            return;
        }
        if self.line.is_some() {
            self.note_stops(now);
        }
        self.stops_wait = false;
        for at in 0..self.axes.len() {
            let frames = self.frames_sent(at);
            let Some(axis) = self.axes.get_mut(at) else { break };
            match axis.stop {
                Some(StopOnItsWay::Handed(at)) if !failed => {
                    axis.stop = Some(StopOnItsWay::Sent(at));
                    self.news.add(axis.link);
                }
                Some(StopOnItsWay::Handed(_)) => {
                    axis.stop = Some(StopOnItsWay::Waits(frames));
                    self.stops_wait = true;
                }
                Some(StopOnItsWay::Waits(_)) => self.stops_wait = true,
                Some(StopOnItsWay::Sent(_)) | None => {}
            }
        }
    }

    /// Returns when the first frame with the last stop of an axis was handed to the network; `None` before that.
    pub(crate) fn stop_sent(&self, link: Link) -> Option<Instant> {
        let axis = self.axes.iter().find(|axis| axis.link == link)?;
        match axis.stop? {
            StopOnItsWay::Sent(at) => Some(at),
            StopOnItsWay::Waits(_) | StopOnItsWay::Handed(_) => None,
        }
    }
}
