//! What a run waits for.

use std::time::Duration;

use super::condition::{Flag, Test};
use super::expectation::{After, Expectation, Rule};
use crate::trace::EventKind;

/// Conditions of one drive that a run waits for, read by [`PlantPlan::goal`](crate::PlantPlan::goal).
#[derive(Debug, Clone, PartialEq)]
pub struct Goal {
    expectation: Expectation,
    drive: usize,
}

impl Goal {
    /// Takes an expectation for its conditions; `None` for one of several drives.
    pub(super) fn of(expectation: Expectation) -> Option<Self> {
        let [target] = expectation.targets.as_slice() else {
            return None;
        };
        let drive = target.drive;
        Some(Self { expectation, drive })
    }

    /// Returns the number of its drive in the plant.
    pub(crate) const fn drive(&self) -> usize {
        self.drive
    }

    /// Returns true when a condition of it looks at a parameter.
    #[must_use]
    pub fn reads_parameters(&self) -> bool {
        self.expectation.reads_parameters()
    }

    /// Returns for how long its conditions must hold.
    pub(crate) const fn lasts(&self) -> Duration {
        self.expectation.lasts
    }

    /// Returns true for an event that reports a change of what one of its conditions looks at.
    pub(crate) fn is_reported_by(&self, event: &EventKind) -> bool {
        use EventKind as E;
        let mut tests = self
            .expectation
            .targets
            .iter()
            .flat_map(|target| &target.conditions)
            .map(|condition| &condition.test);
        tests.any(|test| match event {
            E::StateChanged { .. } => matches!(test, Test::State(_)),
            E::FaultRaised { .. } | E::FaultCleared { .. } => {
                matches!(test, Test::Messages { warnings: false, .. })
            }
            E::WarningRaised { .. } | E::WarningCleared { .. } => {
                matches!(test, Test::Messages { warnings: true, .. })
            }
            E::Connected { .. } | E::Exchanging { .. } | E::ConnectionLost { .. } | E::Released => {
                matches!(test, Test::Flag(Flag::Connected, _))
            }
            E::Homed => matches!(test, Test::Flag(Flag::Homed, _)),
            E::TargetReached { .. } => matches!(test, Test::Flag(Flag::TargetReached, _)),
            _ => false,
        })
    }

    /// Returns the expectation that it is met in this time, after that one.
    pub(crate) fn within(&self, span: Duration, after: Duration) -> Expectation {
        let mut expectation = self.expectation.clone();
        expectation.rule = Rule::Within {
            span,
            after: After::Time(after),
        };
        let seconds = |time: Duration| format!("{}s", time.as_secs_f64());
        expectation.source = format!(
            "within = \"{}\", after = \"{}\", {}",
            seconds(span),
            seconds(after),
            expectation.source
        );
        expectation
    }
}
