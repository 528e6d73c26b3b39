//! Takes control of an ownerless drive in operation: its present motion continues until the first goal.

use profile::catalogue::Part;
use profile::state::{State, Stw1, Zsw1};

use super::Session;
use crate::axis::{Command, SpeedScale, SpeedUnit, Wiring};
use crate::{Drive, Error};

/// What an ownerless drive does now, so that control of it can be taken without a jump.
const PRESENT: [Part; 5] = [
    Part::ControlWord,
    Part::ControlProfile,
    Part::SpeedSetpoint,
    Part::SpeedActual,
    Part::Speed,
];

impl Session {
    /// Reads the command that an ownerless drive obeys, as it is to be sent in its telegram; bits of the control word that
    /// only the vendor has go into `wiring`. `before` is the telegram in use until now.
    pub(super) async fn present_command(
        &mut self,
        drive: &mut Drive,
        wiring: &mut Wiring,
        before: Option<u16>,
        scale: &SpeedScale,
    ) -> Result<Command, Error> {
        let readings = self.ask(drive, &PRESENT).await?;
        let same_words = readings.profile(drive, before) == wiring.words();
        let obeyed = readings
            .word(Part::ControlWord)
            .filter(|_| same_words)
            .map(|word| (word, wiring.words().orders(word, State::S4).stw1))
            // a word without control is not the one that is in force
            .filter(|(_, stw1)| stw1.has(Stw1::CONTROL_BY_PLC));
        let speed = readings
            .rpm(Part::Speed)
            .or_else(|| readings.rpm(Part::SpeedActual));
        let actual = speed
            .filter(|_| scale.unit() == SpeedUnit::Rpm)
            .and_then(|speed| scale.raw(speed))
            .or_else(|| readings.line_speed());
        let Some((word, stw1)) = obeyed else {
            // it is in operation, so that was commanded; the direction is that of the axis
            return Ok(Command {
                stw1: Stw1::RUN,
                nsoll_a: actual.unwrap_or(0),
                ..Command::default()
            });
        };
        wiring.keep_bits(word);
        let commanded = readings
            .word(Part::SpeedSetpoint)
            .filter(|_| before == Some(wiring.telegram()))
            .map(u16::cast_signed);
        Ok(Command {
            // the edge of an acknowledge is nothing to go on with
            stw1: stw1.without(Stw1::ACKNOWLEDGE_FAULT),
            nsoll_a: slower(commanded, actual),
            ..Command::default()
        })
    }
}

/// Returns the setpoint that was commanded, but no more than the speed that the axis has: nothing is to make it faster.
fn slower(commanded: Option<i16>, actual: Option<i16>) -> i16 {
    match (commanded, actual) {
        (Some(commanded), Some(actual)) => {
            let least = commanded.unsigned_abs().min(actual.unsigned_abs());
            i16::try_from(least).unwrap_or(i16::MAX) * commanded.signum()
        }
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => 0,
    }
}

/// Returns true for a status word of a drive whose present command is to be kept.
pub(super) fn is_kept(word: Option<Zsw1>) -> bool {
    word.is_some_and(super::authority::in_operation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setpoint_taken_over_never_makes_the_axis_faster() {
        for (commanded, actual, taken) in [
            (Some(1000), Some(900), 900),
            // the motor has not come up to it, or turns at a speed of its own
            (Some(300), Some(8000), 300),
            // the direction is in the control word: the sign is that of the setpoint
            (Some(1000), Some(-900), 900),
            (Some(-1000), Some(-2000), -1000),
            (Some(i16::MIN), Some(i16::MIN), -i16::MAX),
            (Some(500), None, 500),
            (None, Some(-500), -500),
            (None, None, 0),
        ] {
            assert_eq!(slower(commanded, actual), taken, "{commanded:?} {actual:?}");
        }
    }
}
