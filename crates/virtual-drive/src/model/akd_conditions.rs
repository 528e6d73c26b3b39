//! What the AKD watches.
//!
//! Source of the numbers: `data/akd/faults.csv`. Of the behaviour: AKD Parameter Guide 12/2009 and the maker's pages on
//! PL.ERRMODE, VL.THRESH and foldback; "ours" where no source tells it.

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
    mode: 2289,
    milliseconds: 100,
});

pub(super) const CONDITIONS: &[Condition] = &[
    Condition {
        delay: ENHANCED,
        ..fault(439, Cause::FollowingError, Limit::Parameter(2290), When::Enabled) // PL.ERRFTHRESH
    },
    Condition {
        delay: ENHANCED,
        ..warning(439, Cause::FollowingError, Limit::Parameter(2292), When::Enabled) // PL.ERRWTHRESH
    },
    fault(302, Cause::Overspeed, Limit::Parameter(2444), When::NotCurrent), // VL.THRESH_32
    // A foldback current below the level raises the fault (IL.FOLDFTHRESH, which is IL.FOLDFTHRESHU) or the warning (IL.FOLDWTHRESH).
    fault(524, Cause::DriveFoldback, Limit::Parameter(2219), When::Enabled),
    warning(524, Cause::DriveFoldback, Limit::Parameter(2220), When::Enabled),
    fault(304, Cause::MotorFoldback, Limit::Parameter(2219), When::Enabled),
    warning(304, Cause::MotorFoldback, Limit::Parameter(2220), When::Enabled),
    fault(501, Cause::BusHigh, Limit::Parameter(2397), When::Always), // VBUS.OVFTHRESH
    warning(501, Cause::BusHigh, Limit::Parameter(2398), When::Always), // VBUS.OVWTHRESH
    // VBUS.UVFTHRESH; VBUS.UVMODE 1: only when enabling is tried.
    fault(502, Cause::BusLow, Limit::Parameter(2400), When::ByMode(2401)),
    warning(502, Cause::BusLow, Limit::Parameter(2402), When::Always), // VBUS.UVWTHRESH
    fault(301, Cause::MotorSensor, Limit::Parameter(2258), When::Always), // MOTOR.TEMPFAULT
    warning(301, Cause::MotorSensor, Limit::Parameter(2259), When::Always), // MOTOR.TEMPWARN
    fault(535, Cause::PowerStage, Limit::Fixed(POWER_STAGE), When::Always),
    fault(602, Cause::SafeTorqueOff, Limit::Present, When::Enabled),
    warning(602, Cause::SafeTorqueOff, Limit::Present, When::Disabled),
    fault(408, Cause::FeedbackLost, Limit::Present, When::Always), // FB1.IDENTIFIED 41, a smart feedback
    // The card has one number for each direction; the switches use it too, and its text names both. Ours.
    warning(107, Cause::PositiveSwitch, Limit::Present, When::Always),
    warning(108, Cause::NegativeSwitch, Limit::Present, When::Always),
    fault(307, Cause::BrakeClosed, Limit::Present, When::Enabled),
    fault(703, Cause::SlowDisable, Limit::Parameter(2121), When::Enabled), // DRV.DISTO
];

/// Temperature at which the power stage gives up, degC. Ours: no source tells it.
const POWER_STAGE: f64 = 90.0;

/// FAULTn.ACTION of the faults that have one, ascending by fault number.
pub(super) const ACTIONS: &[(u16, u16)] = &[
    (130, 2601),
    (131, 2602),
    (132, 2603),
    (134, 2604),
    (139, 2797),
    (451, 2615),
    (570, 2966),
    (702, 2605),
];

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
                When::ByMode(pnu) => Some(pnu),
                _ => None,
            };
            let limit = match condition.limit {
                Limit::Parameter(pnu) => Some(pnu),
                _ => None,
            };
            for pnu in [mode, limit, condition.delay.map(|delay| delay.mode)]
                .into_iter()
                .flatten()
            {
                assert!(AKD.catalogue.by_pnu(pnu).is_some(), "{condition:?}");
            }
        }
        for (fault, pnu) in ACTIONS {
            let name = format!("FAULT{fault}.ACTION");
            assert_eq!(AKD.catalogue.by_pnu(*pnu).unwrap().name, name);
            assert!(AKD.catalogue.fault(*fault, false).is_some(), "{name}");
        }
    }
}
