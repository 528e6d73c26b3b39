//! Speed setpoint channel: bits 4, 5 and 6 of STW1, and jog 1 and 2.

use super::{State, Stw1};

/// What the setpoint channel does in S4.
/// Source: AKD manual 5.4; ABB FPBA-01 p. 57, Yaskawa Z1000 p. 25.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Setpoint {
    /// Output of the ramp generator forced to 0: brakes at the limits.
    ZeroAtLimits,
    /// Ramp generator keeps its present output.
    Freeze,
    /// Input of the ramp generator 0: brakes along the ramp.
    RampToZero,
    /// Follows NSOLL_A along the ramp.
    Follow,
}

/// One row of [`SETPOINT_RULES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SetpointRule {
    /// Bits of STW1 that are looked at.
    pub mask: u16,
    /// The values these bits must have.
    pub value: u16,
    /// What the channel does then.
    pub setpoint: Setpoint,
}

/// Bits 4, 5 and 6; the first row that fits is the one.
pub static SETPOINT_RULES: [SetpointRule; 4] = [
    rule(0x10, 0x00, Setpoint::ZeroAtLimits),
    rule(0x30, 0x10, Setpoint::Freeze),
    rule(0x70, 0x30, Setpoint::RampToZero),
    rule(0x70, 0x70, Setpoint::Follow),
];

const fn rule(mask: u16, value: u16, setpoint: Setpoint) -> SetpointRule {
    SetpointRule {
        mask,
        value,
        setpoint,
    }
}

/// The bits of the setpoint channel.
const CHANNEL: u16 = 0x70;

impl Setpoint {
    /// Returns the request of bits 4, 5 and 6 of this word.
    ///
    /// ```
    /// use profidrive_profile::state::{Setpoint, Stw1};
    /// assert_eq!(Setpoint::of(Stw1::RUN), Setpoint::Follow);
    /// assert_eq!(Setpoint::of(Stw1(0x045F)), Setpoint::Freeze);
    /// ```
    #[must_use]
    pub fn of(word: Stw1) -> Self {
        let rule = SETPOINT_RULES
            .iter()
            .find(|rule| word.0 & rule.mask == rule.value);
        rule.map_or(Self::ZeroAtLimits, |rule| rule.setpoint)
    }
}

/// State of jogging.
/// Source: AKD manual 5.4, setpoints PNU 1004 and 1005, ramps PNU 1006 and 1007.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Jog {
    /// Not jogging.
    #[default]
    Off,
    /// Runs at jog setpoint 1.
    One,
    /// Runs at jog setpoint 2.
    Two,
    /// Brakes along the ramp to standstill.
    Stopping,
}

/// What the speed loop gets as its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpeedCommand {
    /// According to bits 4, 5 and 6.
    Channel(Setpoint),
    /// Jog setpoint 1, along the jog ramps.
    Jog1,
    /// Jog setpoint 2, along the jog ramps.
    Jog2,
    /// Zero along the jog ramp.
    JogStop,
}

/// Decides in S4 between the setpoint and jog.
///
/// Jog begins at standstill with bits 4, 5 and 6 all 0, and exactly one of bits 8 and 9. It ends with its bit, with the
/// other bit in addition (the sources are silent, a stop is the safe reading), or with any of bits 4 to 6: then the
/// setpoint channel has the axis.
///
/// ```
/// use profidrive_profile::state::{SetpointChannel, SpeedCommand, State, Stw1};
/// let mut channel = SetpointChannel::default();
/// let jog = Stw1(0x050F);
/// assert_eq!(channel.step(State::S4, jog, true), SpeedCommand::Jog1);
/// assert_eq!(channel.step(State::S4, jog, false), SpeedCommand::Jog1);
/// assert_eq!(channel.step(State::S4, Stw1(0x040F), false), SpeedCommand::JogStop);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SetpointChannel {
    jog: Jog,
}

impl SetpointChannel {
    /// State of jogging after the last step.
    #[must_use]
    pub const fn jog(&self) -> Jog {
        self.jog
    }

    /// One drive cycle: the state of the axis, the word in force, and if the axis stands still. Outside S4 nothing of
    /// this has an effect; the answer then is that of bits 4, 5 and 6.
    pub fn step(&mut self, state: State, word: Stw1, standstill: bool) -> SpeedCommand {
        let permitted = state == State::S4 && word.0 & CHANNEL == 0;
        self.jog = if permitted {
            let wanted = match (word.has(Stw1::JOG_1), word.has(Stw1::JOG_2)) {
                (true, false) => Jog::One,
                (false, true) => Jog::Two,
                _ => Jog::Off,
            };
            next(self.jog, wanted, standstill)
        } else {
            Jog::Off
        };
        match self.jog {
            Jog::Off => SpeedCommand::Channel(Setpoint::of(word)),
            Jog::One => SpeedCommand::Jog1,
            Jog::Two => SpeedCommand::Jog2,
            Jog::Stopping => SpeedCommand::JogStop,
        }
    }
}

/// `wanted` is one of the two, or off.
fn next(now: Jog, wanted: Jog, standstill: bool) -> Jog {
    match (now, standstill) {
        _ if now == wanted => now,
        (_, true) => wanted,
        (Jog::Off, false) => Jog::Off,
        (_, false) => Jog::Stopping,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_has_exactly_one_rule_that_comes_first() {
        for word in 0..=u16::MAX {
            let (b4, b5, b6) = (word & 0x10 != 0, word & 0x20 != 0, word & 0x40 != 0);
            let expected = if !b4 {
                Setpoint::ZeroAtLimits
            } else if !b5 {
                Setpoint::Freeze
            } else if !b6 {
                Setpoint::RampToZero
            } else {
                Setpoint::Follow
            };
            assert_eq!(Setpoint::of(Stw1(word)), expected);
            let fits = |rule: &&SetpointRule| word & rule.mask == rule.value;
            assert_eq!(SETPOINT_RULES.iter().filter(fits).count(), 1);
        }
    }

    #[test]
    fn jog_begins_only_in_s4_at_standstill_with_a_closed_channel() {
        for state in State::ALL {
            for word in 0..=u16::MAX {
                for standstill in [false, true] {
                    let mut channel = SetpointChannel::default();
                    let command = channel.step(state, Stw1(word), standstill);
                    let permitted = state == State::S4 && standstill && word & 0x70 == 0;
                    let expected = match word >> 8 & 3 {
                        1 if permitted => SpeedCommand::Jog1,
                        2 if permitted => SpeedCommand::Jog2,
                        _ => SpeedCommand::Channel(Setpoint::of(Stw1(word))),
                    };
                    assert_eq!(command, expected, "{state:?} {word:04X} {standstill}");
                }
            }
        }
    }

    #[test]
    fn jog_from_one_to_the_other_passes_standstill() {
        let mut channel = SetpointChannel::default();
        let mut step = |word, standstill| channel.step(State::S4, Stw1(word), standstill);
        assert_eq!(step(0x050F, true), SpeedCommand::Jog1);
        assert_eq!(step(0x070F, false), SpeedCommand::JogStop); // both bits
        assert_eq!(step(0x060F, false), SpeedCommand::JogStop);
        assert_eq!(step(0x060F, true), SpeedCommand::Jog2);
        assert_eq!(step(0x067F, false), SpeedCommand::Channel(Setpoint::Follow));
        assert_eq!(step(0x060F, false), SpeedCommand::Channel(Setpoint::ZeroAtLimits));
        assert_eq!(step(0x060F, true), SpeedCommand::Jog2);
        assert_eq!(step(0x040F, false), SpeedCommand::JogStop);
        // Pressed again while still turning: stops first.
        assert_eq!(step(0x060F, false), SpeedCommand::JogStop);
    }

    #[test]
    fn leaving_s4_ends_jog() {
        let mut channel = SetpointChannel::default();
        channel.step(State::S4, Stw1(0x050F), true);
        channel.step(State::S5Ramp, Stw1(0x050E), false);
        assert_eq!(channel.jog(), Jog::Off);
    }
}
