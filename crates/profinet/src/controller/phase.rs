//! Phases of a connection and what leads from one to the next.

/// Where a connection stands.
///
/// Source: IEC 61158-6-10, context management of the controller (CMCTL), in our words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// The name is looked up.
    Resolve,
    /// The IP address is set.
    SetIp,
    /// The connect request is under way.
    Connect,
    /// Start-up records are written, then PrmEnd.
    Parameterize,
    /// Waiting for the device to become ready.
    AwaitReady,
    /// Cyclic data counts.
    Data,
    /// A device-access connection is open.
    Access,
    /// The release request is under way.
    Release,
    /// Over.
    Closed,
}

/// What happened to a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Trigger {
    /// One station of the name, all as expected.
    Found,
    /// One station of the name, its IP is to be set.
    OtherIp,
    /// The device took its IP.
    IpSet,
    /// Cyclic connect accepted.
    Accepted,
    /// Device-access connect accepted.
    AccessGranted,
    /// PrmEnd confirmed.
    PrmEnd,
    /// ApplicationReady came and was confirmed.
    Ready,
    /// The caller requested its end.
    Release,
    /// It ended, well or not.
    End,
}

/// From, by, to. What is not here is not possible.
const TRANSITIONS: &[(Phase, Trigger, Phase)] = &[
    (Phase::Resolve, Trigger::Found, Phase::Connect),
    (Phase::Resolve, Trigger::OtherIp, Phase::SetIp),
    (Phase::SetIp, Trigger::IpSet, Phase::Connect),
    (Phase::Connect, Trigger::Accepted, Phase::Parameterize),
    (Phase::Connect, Trigger::AccessGranted, Phase::Access),
    (Phase::Parameterize, Trigger::PrmEnd, Phase::AwaitReady),
    (Phase::AwaitReady, Trigger::Ready, Phase::Data),
    (Phase::Connect, Trigger::Release, Phase::Release),
    (Phase::Parameterize, Trigger::Release, Phase::Release),
    (Phase::AwaitReady, Trigger::Release, Phase::Release),
    (Phase::Data, Trigger::Release, Phase::Release),
    (Phase::Access, Trigger::Release, Phase::Release),
    (Phase::Resolve, Trigger::Release, Phase::Closed),
    (Phase::SetIp, Trigger::Release, Phase::Closed),
    (Phase::Resolve, Trigger::End, Phase::Closed),
    (Phase::SetIp, Trigger::End, Phase::Closed),
    (Phase::Connect, Trigger::End, Phase::Closed),
    (Phase::Parameterize, Trigger::End, Phase::Closed),
    (Phase::AwaitReady, Trigger::End, Phase::Closed),
    (Phase::Data, Trigger::End, Phase::Closed),
    (Phase::Access, Trigger::End, Phase::Closed),
    (Phase::Release, Trigger::End, Phase::Closed),
];

impl Phase {
    /// Returns the phase that follows; `None` if nothing of the kind can happen here.
    pub(super) fn after(self, trigger: Trigger) -> Option<Self> {
        TRANSITIONS
            .iter()
            .find(|row| row.0 == self && row.1 == trigger)
            .map(|row| row.2)
    }

    /// Records can be read and written.
    #[must_use]
    pub const fn takes_records(self) -> bool {
        matches!(
            self,
            Self::Parameterize | Self::AwaitReady | Self::Data | Self::Access
        )
    }

    /// The start-up is under way.
    pub(super) const fn is_starting(self) -> bool {
        matches!(
            self,
            Self::Resolve | Self::SetIp | Self::Connect | Self::Parameterize | Self::AwaitReady
        )
    }

    /// Cyclic frames are sent and taken.
    #[must_use]
    pub const fn is_cyclic(self) -> bool {
        matches!(
            self,
            Self::Parameterize | Self::AwaitReady | Self::Data | Self::Release
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHASES: [Phase; 9] = [
        Phase::Resolve,
        Phase::SetIp,
        Phase::Connect,
        Phase::Parameterize,
        Phase::AwaitReady,
        Phase::Data,
        Phase::Access,
        Phase::Release,
        Phase::Closed,
    ];
    const TRIGGERS: [Trigger; 9] = [
        Trigger::Found,
        Trigger::OtherIp,
        Trigger::IpSet,
        Trigger::Accepted,
        Trigger::AccessGranted,
        Trigger::PrmEnd,
        Trigger::Ready,
        Trigger::Release,
        Trigger::End,
    ];

    #[test]
    fn every_open_phase_can_end_and_closed_is_the_end() {
        for phase in PHASES {
            assert_eq!(
                phase.after(Trigger::End).is_some(),
                phase != Phase::Closed,
                "{phase:?}"
            );
        }
        assert!(TRIGGERS.iter().all(|t| Phase::Closed.after(*t).is_none()));
    }

    #[test]
    fn the_table_names_each_pair_once() {
        for phase in PHASES {
            for trigger in TRIGGERS {
                let count = TRANSITIONS
                    .iter()
                    .filter(|row| row.0 == phase && row.1 == trigger)
                    .count();
                assert!(count <= 1, "{phase:?} {trigger:?}");
            }
        }
        let ready: [_; 9] = PHASES.map(|phase| phase.after(Trigger::Ready).is_some());
        assert_eq!(
            ready.iter().filter(|r| **r).count(),
            1,
            "ready only while it is awaited"
        );
    }
}
