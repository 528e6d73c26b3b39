//! What the AKD watches.
//!
//! Source of the numbers: `data/akd/faults.csv`. Of the behaviour: AKD Parameter Guide 12/2009 and the vendor's pages on
//! PL.ERRMODE, VL.THRESH and foldback; "ours" where no source has it.

use profile::catalogue::Part;

use super::condition::{Cause, Condition, Delay, Limit, When};

/// A fault with the plain meaning of its row.
const fn fault(number: u16, cause: Cause, limit: Limit, when: When) -> Condition {
    Condition {
        number,
        warning: false,
        cause,
        limit,
        when,
        delay: None,
    }
}

const fn warning(number: u16, cause: Cause, limit: Limit, when: When) -> Condition {
    Condition {
        warning: true,
        ..fault(number, cause, limit, when)
    }
}

/// PL.ERRMODE 1: the error must last for 100 ms. The prediction of the error that this mode takes off is 0 for a position
/// loop without integral part, as the virtual one is.
const ENHANCED: Option<Delay> = Some(Delay {
    mode: Part::FollowingErrorMode,
    milliseconds: 100,
});

pub(super) const CONDITIONS: &[Condition] = &[
    Condition {
        delay: ENHANCED,
        ..fault(
            439,
            Cause::FollowingError,
            Limit::Parameter(Part::FollowingErrorFault),
            When::Enabled,
        )
    },
    Condition {
        delay: ENHANCED,
        ..warning(
            439,
            Cause::FollowingError,
            Limit::Parameter(Part::FollowingErrorWarning),
            When::Enabled,
        )
    },
    fault(
        302,
        Cause::Overspeed,
        Limit::Parameter(Part::Overspeed),
        When::NotCurrent,
    ),
    // A foldback current below the level raises the fault (IL.FOLDFTHRESH, which is IL.FOLDFTHRESHU) or the warning (IL.FOLDWTHRESH).
    fault(
        524,
        Cause::DriveFoldback,
        Limit::Parameter(Part::FoldbackFault),
        When::Enabled,
    ),
    warning(
        524,
        Cause::DriveFoldback,
        Limit::Parameter(Part::FoldbackWarning),
        When::Enabled,
    ),
    fault(
        304,
        Cause::MotorFoldback,
        Limit::Parameter(Part::FoldbackFault),
        When::Enabled,
    ),
    warning(
        304,
        Cause::MotorFoldback,
        Limit::Parameter(Part::FoldbackWarning),
        When::Enabled,
    ),
    fault(
        501,
        Cause::BusHigh,
        Limit::Parameter(Part::BusHighFault),
        When::Always,
    ),
    warning(
        501,
        Cause::BusHigh,
        Limit::Parameter(Part::BusHighWarning),
        When::Always,
    ),
    // VBUS.UVFTHRESH; VBUS.UVMODE 1: only when enabling is tried.
    fault(
        502,
        Cause::BusLow,
        Limit::Parameter(Part::BusLowest),
        When::ByMode(Part::BusLowMode),
    ),
    warning(
        502,
        Cause::BusLow,
        Limit::Parameter(Part::BusLowWarning),
        When::Always,
    ),
    fault(
        301,
        Cause::MotorSensor,
        Limit::Parameter(Part::MotorSensorFault),
        When::Always,
    ),
    warning(
        301,
        Cause::MotorSensor,
        Limit::Parameter(Part::MotorSensorWarning),
        When::Always,
    ),
    fault(535, Cause::PowerStage, Limit::Fixed(POWER_STAGE), When::Always),
    fault(602, Cause::SafeTorqueOff, Limit::Present, When::Enabled),
    warning(602, Cause::SafeTorqueOff, Limit::Present, When::Disabled),
    fault(408, Cause::FeedbackLost, Limit::Present, When::Always), // FB1.IDENTIFIED 41, a smart feedback
    // The card has one number for each direction; the switches use it too, and its text names both. Ours.
    warning(107, Cause::PositiveSwitch, Limit::Present, When::Always),
    warning(108, Cause::NegativeSwitch, Limit::Present, When::Always),
    fault(307, Cause::BrakeClosed, Limit::Present, When::Enabled),
    fault(
        703,
        Cause::SlowDisable,
        Limit::Parameter(Part::DisableTime),
        When::Enabled,
    ),
];

/// Temperature at which the power stage switches off, degC. Ours: no source has it.
const POWER_STAGE: f64 = 90.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::AKD;

    #[test]
    fn every_number_is_in_the_table_of_faults() {
        for condition in CONDITIONS {
            assert!(
                AKD.catalogue.fault(condition.number, condition.warning).is_some(),
                "{condition:?}"
            );
        }
        assert!(CONDITIONS.len() <= crate::model::MOST_CONDITIONS);
    }

    #[test]
    fn the_warning_of_a_limit_switch_names_the_switch() {
        let switches = CONDITIONS
            .iter()
            .filter(|condition| matches!(condition.cause, Cause::PositiveSwitch | Cause::NegativeSwitch));
        let mut seen = 0;
        for condition in switches {
            let fault = AKD.catalogue.fault(condition.number, condition.warning).unwrap();
            assert!(fault.meaning.contains("limit switch"), "{fault:?}");
            assert!(
                fault.remedy.contains("HWLS.") && fault.remedy.contains("SWLS."),
                "{fault:?}"
            );
            seen += 1;
        }
        assert_eq!(seen, 2);
    }

    #[test]
    fn every_limit_is_a_parameter() {
        for condition in CONDITIONS {
            let mode = match condition.when {
                When::ByMode(part) => Some(part),
                _ => None,
            };
            let limit = match condition.limit {
                Limit::Parameter(part) => Some(part),
                _ => None,
            };
            let parts = [mode, limit, condition.delay.map(|delay| delay.mode)];
            for part in parts.into_iter().flatten() {
                assert!(AKD.number(part).is_some(), "{condition:?}");
            }
        }
    }

    #[test]
    fn every_action_of_a_fault_is_that_of_its_row() {
        let tables = AKD.catalogue;
        let rows = tables.parts.iter().filter(|row| row.part == Part::FaultAction);
        for row in rows.clone() {
            let fault = u16::try_from(row.values[0]).unwrap();
            let name = format!("FAULT{fault}.ACTION");
            assert_eq!(tables.by_pnu(row.pnu).unwrap().name, name);
            assert!(tables.fault(fault, false).is_some(), "{name}");
        }
        assert_eq!(rows.count(), 8);
    }
}
