//! Application ARs: their phases as a table, and the data of one.

use core::net::Ipv4Addr;
use core::time::Duration;

use super::event::ArKey;
use crate::Instant;
use crate::alarm::Alarms;
use crate::cyclic::{Consumer, Provider};
use crate::rpc::CallId;
use crate::wire::block::{ArRequest, IocrRequest, ModuleDiff};
use crate::wire::record::Identification;

/// Phase of an AR with cyclic data.
///
/// IEC 61158-6-10, CMDEV: W_PEIND, W_ARDY, W_ARDYCNF, WDATA, DATA.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Phase {
    /// Connected; parameters are written, PrmEnd is awaited.
    Parameters,
    /// PrmEnd came; the application prepares itself.
    Preparing,
    /// ApplicationReady is sent; its confirmation is awaited.
    Announcing,
    /// Confirmed; the first valid outputs are awaited.
    AwaitingData,
    /// Data is exchanged.
    Data,
}

/// What moves an AR on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Trigger {
    /// PrmEnd of the controller.
    ParameterEnd,
    /// The application is ready.
    ApplicationReady,
    /// The controller confirmed ApplicationReady.
    Confirmed,
    /// A valid output frame.
    ValidOutput,
}

/// Every transition there is; what is not here does not happen.
const TRANSITIONS: &[(Phase, Trigger, Phase)] = &[
    (Phase::Parameters, Trigger::ParameterEnd, Phase::Preparing),
    (Phase::Preparing, Trigger::ApplicationReady, Phase::Announcing),
    (Phase::Announcing, Trigger::Confirmed, Phase::AwaitingData),
    (Phase::AwaitingData, Trigger::ValidOutput, Phase::Data),
];

impl Phase {
    /// Returns the phase that follows, `None` if the trigger means nothing here.
    pub(super) fn after(self, trigger: Trigger) -> Option<Self> {
        TRANSITIONS
            .iter()
            .find(|row| row.0 == self && row.1 == trigger)
            .map(|row| row.2)
    }

    /// Returns true when the controller may write records: always, except between PrmEnd and ApplicationReady.
    pub(super) const fn takes_writes(self) -> bool {
        !matches!(self, Self::Preparing)
    }

    /// Returns true until the first valid output ends the start-up.
    pub(super) const fn is_start_up(self) -> bool {
        !matches!(self, Self::Data)
    }
}

/// The time after which an AR without activity ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Activity {
    limit: Duration,
    deadline: Option<Instant>,
}

impl Activity {
    pub(super) fn new(now: Instant, factor: u16) -> Self {
        let limit = Duration::from_millis(u64::from(factor) * 100);
        Self {
            limit,
            deadline: Some(now + limit),
        }
    }

    /// Starts again, unless it was stopped.
    pub(super) fn restart(&mut self, now: Instant) {
        if self.deadline.is_some() {
            self.deadline = Some(now + self.limit);
        }
    }

    pub(super) const fn stop(&mut self) {
        self.deadline = None;
    }

    pub(super) const fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    pub(super) fn is_over(&self, now: Instant) -> bool {
        self.deadline.is_some_and(|deadline| deadline <= now)
    }

    /// Returns the time since the last activity; `None` once stopped.
    pub(super) fn idle(&self, now: Instant) -> Option<Duration> {
        let left = self.deadline?.saturating_since(now);
        Some(self.limit.saturating_sub(left))
    }

    /// Returns true when more than half of the activity time passed without a sign of life: a client that stays
    /// connected sends one earlier.
    pub(super) fn is_half_over(&self, now: Instant) -> bool {
        self.idle(now).is_some_and(|idle| idle * 2 > self.limit)
    }
}

/// An AR with cyclic data.
#[derive(Debug)]
pub(super) struct IoAr {
    pub(super) key: ArKey,
    pub(super) request: ArRequest,
    /// Address of the controller.
    pub(super) host: Ipv4Addr,
    pub(super) phase: Phase,
    pub(super) activity: Activity,
    pub(super) input: IocrRequest,
    pub(super) output: IocrRequest,
    pub(super) provider: Provider,
    /// Both directions have the same interval.
    pub(super) same_interval: bool,
    pub(super) consumer: Consumer,
    pub(super) alarms: Alarms,
    pub(super) diff: ModuleDiff,
    pub(super) expected: Identification,
    /// ApplicationReady on its way.
    pub(super) ready_call: Option<CallId>,
    /// Run state of the controller's provider, unknown before its first frame.
    pub(super) run: Option<bool>,
}

/// An AR for record access.
#[derive(Debug)]
pub(super) struct AccessAr {
    pub(super) key: ArKey,
    pub(super) request: ArRequest,
    pub(super) host: Ipv4Addr,
    pub(super) activity: Activity,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_listed_transitions_exist() {
        use Phase::{Announcing, AwaitingData, Data, Parameters, Preparing};
        use Trigger::{ApplicationReady, Confirmed, ParameterEnd, ValidOutput};
        let mut found = 0;
        for phase in [Parameters, Preparing, Announcing, AwaitingData, Data] {
            for trigger in [ParameterEnd, ApplicationReady, Confirmed, ValidOutput] {
                found += usize::from(phase.after(trigger).is_some());
            }
        }
        assert_eq!(found, TRANSITIONS.len());
        let start_up = [ParameterEnd, ApplicationReady, Confirmed, ValidOutput];
        let end = start_up.into_iter().try_fold(Parameters, Phase::after);
        assert_eq!(end, Some(Data));
    }
}
