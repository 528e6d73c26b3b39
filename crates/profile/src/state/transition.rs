//! The transitions of the general state machine as one table.

use super::State::{self, S1, S2, S3, S4, S5Quick, S5Ramp};
use super::Stw1;

/// Most transitions done in one step; the table needs three at most.
pub const MOST_TRANSITIONS: usize = 6;

/// Why a transition happens: T1 to T16 as numbered in this crate.
/// Source: our numbers, the profile's diagram has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// OFF commanded, no stop commanded, no fault: S1 to S2.
    T1,
    /// Coast stop or quick stop: S2 to S1.
    T2,
    /// ON: S2 to S3.
    T3,
    /// OFF: S3 to S2.
    T4,
    /// Coast stop or quick stop: S3 to S1.
    T5,
    /// Enable operation: S3 to S4.
    T6,
    /// Disable operation: S4 to S3.
    T7,
    /// OFF: S4 to the ramp stop.
    T8,
    /// Quick stop: S4 to the quick stop.
    T9,
    /// Coast stop: S4 to S1.
    T10,
    /// ON again during the ramp stop: back to S4.
    T11,
    /// Ramp stop done or operation disabled: to S2.
    T12,
    /// Quick stop during the ramp stop.
    T13,
    /// Quick stop done or operation disabled: to S1.
    T14,
    /// Coast stop during a stop: to S1.
    T15,
    /// Reaction to a fault.
    T16,
}

impl Reason {
    /// Returns a description in a few words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::T1 => "OFF commanded, and neither a coast stop nor a quick stop",
            Self::T2 | Self::T5 => "coast stop or quick stop commanded",
            Self::T3 => "ON",
            Self::T4 | Self::T8 => "OFF",
            Self::T6 => "operation enabled",
            Self::T7 => "operation disabled",
            Self::T9 | Self::T13 => "quick stop commanded",
            Self::T10 | Self::T15 => "coast stop commanded",
            Self::T11 => "ON during the ramp stop",
            Self::T12 => "ramp stop done, or operation disabled",
            Self::T14 => "quick stop done, or operation disabled",
            Self::T16 => "fault",
        }
    }
}

/// What the drive does about a fault that comes while the motor is on. With the motor off every fault leads to S1.
/// Source: profile 6.3.2 by way of Eaton MN040010EN p. 94.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FaultReaction {
    /// Pulses off at once.
    Coast,
    /// Quick stop, then S1.
    QuickStop,
    /// Ramp stop, then S1.
    RampStop,
}

/// A condition beside the bits of STW1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Condition {
    /// The axis stands still.
    Standstill,
    /// No fault waits for its acknowledge.
    NoFault,
    /// A fault with any reaction came in this step.
    NewFault,
    /// A fault with this reaction came in this step.
    NewFaultWith(FaultReaction),
    /// The running stop is not, or is, due to a fault.
    StoppedByFault(bool),
}

/// One transition: from, to, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// Which one.
    pub reason: Reason,
    /// State it leaves.
    pub from: State,
    /// State it enters.
    pub to: State,
    /// Bits of STW1 that are looked at.
    pub mask: u16,
    /// The values these bits must have.
    pub value: u16,
    /// What else must be true, all of it.
    pub also: &'static [Condition],
    /// Of several possible transitions out of a state the one with the highest number happens.
    pub priority: u8,
}

impl Transition {
    /// Returns the transition that a state waits for: the next one on the way to operation (S4), out of S5 that at
    /// standstill. `None` in S4.
    ///
    /// ```
    /// use profidrive_profile::state::{Reason, State, Transition};
    /// let awaited = |state| Transition::awaited(state).map(|row| row.reason);
    /// assert_eq!(awaited(State::S2), Some(Reason::T3));
    /// assert_eq!(awaited(State::S5Quick), Some(Reason::T14));
    /// assert_eq!(awaited(State::S4), None);
    /// ```
    #[must_use]
    pub fn awaited(state: State) -> Option<&'static Self> {
        let mut rows = TRANSITIONS.iter().filter(|row| row.from == state);
        if matches!(state, S5Ramp | S5Quick) {
            return rows.find(|row| row.also.contains(&STANDSTILL));
        }
        let next = [(S1, S2), (S2, S3), (S3, S4)];
        rows.find(|row| next.contains(&(row.from, row.to)))
    }

    /// Returns the bits of STW1 that must change for it, as a mask.
    #[must_use]
    pub const fn missing(&self, stw1: Stw1) -> u16 {
        (stw1.0 ^ self.value) & self.mask
    }
}

impl Condition {
    /// Returns a description in a few words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Standstill => "standstill",
            Self::NoFault => "no fault",
            Self::NewFault => "a fault",
            Self::NewFaultWith(FaultReaction::Coast) => "a fault with coast stop",
            Self::NewFaultWith(FaultReaction::QuickStop) => "a fault with quick stop",
            Self::NewFaultWith(FaultReaction::RampStop) => "a fault with ramp stop",
            Self::StoppedByFault(false) => "not stopped by a fault",
            Self::StoppedByFault(true) => "stopped by a fault",
        }
    }
}

/// Bit 0, ON.
const ON: u16 = 1;
/// Bit 1, no coast stop.
const NO_COAST: u16 = 2;
/// Bit 2, no quick stop.
const NO_QUICK: u16 = 4;
/// Bit 3, enable operation.
const ENABLE: u16 = 8;

const STANDSTILL: Condition = Condition::Standstill;
const NO_FAULT: Condition = Condition::NoFault;
const COMMANDED: Condition = Condition::StoppedByFault(false);
const BY_FAULT: Condition = Condition::StoppedByFault(true);
const NEW_FAULT: Condition = Condition::NewFault;
const COAST: Condition = Condition::NewFaultWith(FaultReaction::Coast);
const QUICK: Condition = Condition::NewFaultWith(FaultReaction::QuickStop);
const RAMP: Condition = Condition::NewFaultWith(FaultReaction::RampStop);

/// All transitions, grouped by the state they leave, highest priority first: the first row that fits is the one.
/// A reason with "or" in its guard has a row for each alternative.
///
/// Source: STW1 and priorities: Lenze KHB 13.0001 p. 33, Parker Compax3 p. 312, ABB FPBA-01 p. 57, Eaton MN040010EN
/// p. 94. The conditions of T1 (no fault) and of T12 and T14 (operation disabled) are as the profile's diagram is
/// from memory; no public text confirms them. T16 leads to S1 as in devices of V4; others have a fault state of its
/// own.
pub static TRANSITIONS: &[Transition] = &[
    row(
        Reason::T1,
        S1,
        S2,
        (ON | NO_COAST | NO_QUICK, NO_COAST | NO_QUICK),
        &[NO_FAULT],
        1,
    ),
    row(Reason::T16, S2, S1, ANY, &[NEW_FAULT], 5),
    row(Reason::T2, S2, S1, (NO_COAST, 0), &[], 2),
    row(Reason::T2, S2, S1, (NO_QUICK, 0), &[], 2),
    row(Reason::T3, S2, S3, (ON, ON), &[], 1),
    row(Reason::T16, S3, S1, ANY, &[NEW_FAULT], 5),
    row(Reason::T5, S3, S1, (NO_COAST, 0), &[], 3),
    row(Reason::T5, S3, S1, (NO_QUICK, 0), &[], 3),
    row(Reason::T4, S3, S2, (ON, 0), &[], 2),
    row(Reason::T6, S3, S4, (ENABLE, ENABLE), &[], 1),
    row(Reason::T16, S4, S1, ANY, &[COAST], 5),
    row(Reason::T16, S4, S5Quick, ANY, &[QUICK], 5),
    row(Reason::T16, S4, S5Ramp, ANY, &[RAMP], 5),
    row(Reason::T10, S4, S1, (NO_COAST, 0), &[], 4),
    row(Reason::T9, S4, S5Quick, (NO_QUICK, 0), &[], 3),
    row(Reason::T8, S4, S5Ramp, (ON, 0), &[], 2),
    row(Reason::T7, S4, S3, (ENABLE, 0), &[], 1),
    row(Reason::T16, S5Ramp, S1, ANY, &[COAST], 5),
    row(Reason::T16, S5Ramp, S5Quick, ANY, &[QUICK], 5),
    row(Reason::T15, S5Ramp, S1, (NO_COAST, 0), &[], 4),
    row(Reason::T13, S5Ramp, S5Quick, (NO_QUICK, 0), &[], 3),
    row(Reason::T12, S5Ramp, S2, ANY, &[STANDSTILL, COMMANDED], 2),
    row(Reason::T12, S5Ramp, S2, (ENABLE, 0), &[COMMANDED], 2),
    row(Reason::T16, S5Ramp, S1, ANY, &[STANDSTILL, BY_FAULT], 2),
    row(Reason::T16, S5Ramp, S1, (ENABLE, 0), &[BY_FAULT], 2),
    row(Reason::T11, S5Ramp, S4, (ALL, ALL), &[COMMANDED], 1),
    row(Reason::T16, S5Quick, S1, ANY, &[COAST], 5),
    row(Reason::T15, S5Quick, S1, (NO_COAST, 0), &[], 4),
    row(Reason::T14, S5Quick, S1, ANY, &[STANDSTILL], 2),
    row(Reason::T14, S5Quick, S1, (ENABLE, 0), &[], 2),
];

/// No bit of STW1 is looked at.
const ANY: (u16, u16) = (0, 0);
/// Bits 0 to 3.
const ALL: u16 = ON | NO_COAST | NO_QUICK | ENABLE;

const fn row(
    reason: Reason,
    from: State,
    to: State,
    (mask, value): (u16, u16),
    also: &'static [Condition],
    priority: u8,
) -> Transition {
    Transition {
        reason,
        from,
        to,
        mask,
        value,
        also,
        priority,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_state_stand_together_highest_priority_first() {
        for pair in TRANSITIONS.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            assert!(
                a.from < b.from || (a.from == b.from && a.priority >= b.priority),
                "{a:?}"
            );
        }
    }

    #[test]
    fn rows_of_equal_priority_lead_to_the_same_state_or_exclude_each_other() {
        for a in TRANSITIONS {
            for b in TRANSITIONS {
                if (a.from, a.priority) == (b.from, b.priority) && a.to != b.to {
                    let excluded = a.also.iter().any(|one| {
                        b.also.iter().any(|other| match (one, other) {
                            (Condition::NewFaultWith(a), Condition::NewFaultWith(b)) => a != b,
                            (Condition::StoppedByFault(a), Condition::StoppedByFault(b)) => a != b,
                            _ => false,
                        })
                    });
                    assert!(excluded, "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn guards_look_at_the_four_command_bits_only() {
        for row in TRANSITIONS {
            assert_eq!(row.mask & !ALL, 0, "{row:?}");
            assert_eq!(row.value & !row.mask, 0, "{row:?}");
        }
    }
}
