//! General state machine of an axis: states, control and status word, transitions, setpoint channel, jog.
//!
//! Source: PROFIdrive profile V4.1 (3.172) 6.3.2 and 6.3.4 as documented in the AKD PROFINET manual ed. M 5.3 to 5.5
//! and 5.9 and in the manuals of Eaton, Lenze and Parker. The text of the profile itself was not available. Items
//! mention where those sources differ.
//!
//! The facts are tables ([`TRANSITIONS`], the bit tables in [`bits`]); [`Machine`] walks them. It has no clock and does
//! nothing by itself: each drive cycle calls [`Machine::step`] once. What happens inside S4 of an axis in position mode
//! is a table and a machine of its own, [`POSITION_TRANSITIONS`] and [`PositionMachine`]. Vendors with control words of
//! their own have a [`Profile`], a translation to and from the same machine.
//!
//! ```
//! use profidrive_profile::state::{Inputs, Machine, Motion, State, Stw1, Zsw1};
//! let mut drive = Machine::new();
//! let mut send = |stw1| drive.step(&Inputs { stw1, standstill: true, ..Inputs::default() });
//! assert_eq!(send(Stw1::RUN).state, State::S1); // no start without OFF before
//! assert_eq!(send(Stw1::READY).state, State::S2);
//! let output = send(Stw1::RUN); // through S3 to S4 in one cycle
//! assert_eq!((output.state, output.zsw1), (State::S4, Zsw1(0x0237)));
//! assert_eq!(output.motion, Motion::FollowSetpoint);
//! ```

pub mod bits;
mod generated_bits;
mod machine;
mod position;
mod profile;
mod setpoint;
mod transition;
mod word;

#[cfg(test)]
mod exhaustive;

pub use bits::Mode;
pub use machine::{Inputs, Machine, Output, Path};
pub use position::{
    POSITION_TRANSITIONS, PositionCommand, PositionCondition, PositionEffect, PositionFacts, PositionInputs,
    PositionMachine, PositionOutput, PositionState, PositionTransition,
};
pub use profile::{Conditions, ControlWords, Correction, Orders, Profile, Start};
pub use setpoint::{Jog, SETPOINT_RULES, Setpoint, SetpointChannel, SetpointRule, SpeedCommand};
pub use transition::{Condition, FaultReaction, MOST_TRANSITIONS, Reason, TRANSITIONS, Transition};
pub use word::{Stw1, Zsw1};

use core::fmt;

/// State of the general state machine.
/// Source: profile 6.3.2; AKD manual 5.4 and 5.9 use the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum State {
    /// Switching on inhibited: pulses off, leaves only by OFF with neither coast stop nor quick stop commanded.
    S1,
    /// Ready for switching on: pulses off, waits for ON.
    S2,
    /// Switched on: pulses off, waits for the enable of operation.
    S3,
    /// Operation: the axis follows the setpoint.
    S4,
    /// Switching off by ramp stop (OFF1): brakes along the ramp, ON during the ramp takes it back.
    S5Ramp,
    /// Switching off by quick stop (OFF3): brakes as fast as it can, nothing takes it back.
    S5Quick,
}

/// What the axis does with its motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Pulses off, the axis runs out.
    Coast,
    /// Follows the setpoint channel, see [`SetpointChannel`].
    FollowSetpoint,
    /// Brakes along the deceleration ramp to standstill.
    RampStop,
    /// Brakes as fast as it can to standstill.
    QuickStop,
}

/// What is fixed for a state.
struct Facts {
    state: State,
    number: u8,
    name: &'static str,
    /// Bits 0 to 2 and 4 to 6 of ZSW1; in S1 bits 4 and 5 mirror the command instead.
    zsw1: Zsw1,
    pulses: bool,
    motion: Motion,
}

/// One row per state, in the order of [`State`]. Bit 2 is 0 in S5, as in the profile's diagram; Lenze has 1 there.
static FACTS: [Facts; 6] = [
    facts(State::S1, 1, "switching on inhibited", 0x40, Motion::Coast),
    facts(State::S2, 2, "ready for switching on", 0x31, Motion::Coast),
    facts(State::S3, 3, "switched on", 0x33, Motion::Coast),
    facts(State::S4, 4, "operation", 0x37, Motion::FollowSetpoint),
    facts(
        State::S5Ramp,
        5,
        "switching off, ramp stop",
        0x33,
        Motion::RampStop,
    ),
    facts(
        State::S5Quick,
        5,
        "switching off, quick stop",
        0x13,
        Motion::QuickStop,
    ),
];

const fn facts(state: State, number: u8, name: &'static str, zsw1: u16, motion: Motion) -> Facts {
    Facts {
        state,
        number,
        name,
        zsw1: Zsw1(zsw1),
        pulses: !matches!(motion, Motion::Coast),
        motion,
    }
}

impl State {
    /// All states, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::S1,
        Self::S2,
        Self::S3,
        Self::S4,
        Self::S5Ramp,
        Self::S5Quick,
    ];

    fn facts(self) -> &'static Facts {
        let [s1, rest @ ..] = &FACTS;
        rest.iter().find(|facts| facts.state == self).unwrap_or(s1)
    }

    /// Returns the number 1 to 5; both ways of switching off are 5.
    #[must_use]
    pub fn number(self) -> u8 {
        self.facts().number
    }

    /// Returns the name in words, for example `switching on inhibited`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Returns true when the power stage is on.
    #[must_use]
    pub fn pulses(self) -> bool {
        self.facts().pulses
    }

    /// Returns the behaviour of the axis in this state.
    #[must_use]
    pub fn motion(self) -> Motion {
        self.facts().motion
    }
}

impl fmt::Display for State {
    /// `S4 operation`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "S{} {}", self.number(), self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString as _;

    #[test]
    fn one_row_of_facts_for_each_state() {
        for (state, facts) in State::ALL.into_iter().zip(&FACTS) {
            assert_eq!(facts.state, state);
            assert_eq!(facts.zsw1.0 & !Zsw1::STATE_BITS.0, 0);
        }
    }

    #[test]
    fn names() {
        assert_eq!(State::S1.to_string(), "S1 switching on inhibited");
        assert_eq!(State::S5Quick.to_string(), "S5 switching off, quick stop");
        assert!(State::S5Ramp.pulses() && !State::S3.pulses());
    }
}
