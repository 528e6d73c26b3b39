//! What has to be known of a drive before its axis is taken or moved. Reads only.

use profidrive::catalogue::Device;
use profidrive::notation::ParameterReference;
use profidrive::state::{Mode, Zsw1};
use profidrive::telegram::signal;
use profinet::Medium;

use super::Session;
use crate::axis::{
    Choice, MotionFacts, Move, MovePlan, Purpose, ReportedTelegram, choose_telegram, plan_move,
};
use crate::error::mode_words;
use crate::parameter::{Assignment, Reading, Selection};
use crate::{Drive, Error, WriteMode};

/// PNUs of the profile: telegram, mapping, mode.
const TELEGRAM: u16 = 922;
const SETPOINT_SIGNALS: u16 = 915;
const ACTUAL_SIGNALS: u16 = 916;
const MODE: u16 = 930;
/// PNUs of an AKD that matter for a move.
const ZSW1: u16 = signal::ZSW1;
const XIST_A: u16 = signal::XIST_A;
const DRV_ACC: u16 = 2108;
const DRV_DEC: u16 = 2115;
const NEGATIVE_SWITCH: u16 = 2211;
const POSITIVE_SWITCH: u16 = 2212;
const MODULO: u16 = 2308;
const LIMITS_ON: u16 = 2382;
const LIMIT_0: u16 = 2383;
const LIMIT_1: u16 = 2385;
const BACKWARD: u16 = 2438;
const FORWARD: u16 = 2439;

/// Increments in one turn of the position parameters (SWLS.LIMIT0 and others) in the units as delivered.
const PARAMETER_COUNTS: f64 = 65_536.0;

impl<M: Medium> Session<M>
where
    M::Error: Send + Sync + 'static,
{
    /// The mode that a drive is in (PNU 930): `None` for one that is neither speed control nor positioning, or that
    /// does not tell.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn operating_mode(&mut self, drive: &mut Drive) -> Result<Option<Mode>, Error> {
        let readings = self.read_numbers(drive, &[MODE])?;
        Ok(readings
            .first()
            .and_then(|reading| reading.raw())
            .and_then(mode_of))
    }

    /// Puts a drive into a mode (PNU 930) and reads back.
    ///
    /// # Errors
    /// When the drive refuses, which it does while it is in operation, or cannot be reached.
    pub fn set_operating_mode(&mut self, drive: &mut Drive, mode: Mode) -> Result<(), Error> {
        let number = match mode {
            Mode::Velocity => 1,
            Mode::Position => 2,
        };
        let assignment: Assignment = format!("{MODE}={number}").parse()?;
        let outcomes = self.write(drive, &[assignment], WriteMode::Write)?;
        for outcome in outcomes {
            if let Some(Err(refusal)) = outcome.written {
                let drive = drive.label();
                return Err(Error::Refused { drive, refusal });
            }
            if outcome.differs() {
                return Err(Error::WrongMode {
                    drive: drive.label(),
                    needed: mode,
                    present: "the mode as before, though it took the change".into(),
                });
            }
        }
        Ok(())
    }

    /// What a move of an axis would be, and everything that speaks against it.
    ///
    /// # Errors
    /// When the model is not known, or the drive cannot be reached.
    pub fn plan_move(
        &mut self,
        drive: &mut Drive,
        order: &Move,
        speed_limit: f64,
    ) -> Result<MovePlan, Error> {
        self.read_scaling(drive)?;
        let facts = self.motion_facts(drive)?;
        self.plan_with(drive, order, &facts, speed_limit)
    }

    pub(super) fn plan_with(
        &self,
        drive: &Drive,
        order: &Move,
        facts: &MotionFacts,
        speed_limit: f64,
    ) -> Result<MovePlan, Error> {
        let tables = drive.model.catalogue.ok_or_else(|| Error::UnknownModel {
            drive: drive.label(),
            what: "the scale of positions",
            vendor_id: drive.station.vendor_id,
            device_id: drive.station.device_id,
        })?;
        Ok(plan_move(
            order,
            facts,
            tables,
            &drive.parameters.scaling,
            speed_limit,
        ))
    }

    /// What a drive says that matters for a move; what it refuses to tell is left out.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn motion_facts(&mut self, drive: &mut Drive) -> Result<MotionFacts, Error> {
        let readings = self.read_numbers(
            drive,
            &[
                ZSW1,
                XIST_A,
                DRV_ACC,
                DRV_DEC,
                NEGATIVE_SWITCH,
                POSITIVE_SWITCH,
                MODULO,
                LIMITS_ON,
                BACKWARD,
                FORWARD,
            ],
        )?;
        let find = |pnu| readings.iter().find(|reading| reading.pnu == pnu);
        let number = |pnu| find(pnu).and_then(Reading::number);
        let raw = |pnu| find(pnu).and_then(Reading::raw);
        let zsw1 = raw(ZSW1)
            .and_then(|raw| u16::try_from(raw & 0xFFFF).ok())
            .map(Zsw1);
        let on = raw(LIMITS_ON).unwrap_or(0);
        // the signal wraps at 32 bits and has a sign, the table of the manual calls it unsigned
        let position = raw(XIST_A).map(|raw| f64::from(raw as i32) / drive.counts_per_turn());
        let mut facts = MotionFacts {
            position,
            homed: zsw1.map(|word| word.has(Zsw1::HOMED)),
            fault: zsw1.map(|word| word.has(Zsw1::FAULT)),
            modulo: raw(MODULO).is_some_and(|on| on != 0),
            forward_limit: number(FORWARD).map(f64::abs),
            backward_limit: number(BACKWARD).map(f64::abs),
            negative_switch: raw(NEGATIVE_SWITCH).map(|state| state != 0),
            positive_switch: raw(POSITIVE_SWITCH).map(|state| state != 0),
            acceleration: number(DRV_ACC),
            deceleration: number(DRV_DEC),
            ..MotionFacts::default()
        };
        let mut limits = Vec::new();
        for (bit, pnu) in [(1, LIMIT_0), (2, LIMIT_1)] {
            if on & bit != 0 {
                limits.push(self.wide(drive, pnu)?.map(|counts| counts / PARAMETER_COUNTS));
            } else {
                limits.push(None);
            }
        }
        // which of the two is the upper one is up to who set them
        match limits.as_slice() {
            [Some(one), Some(other)] => {
                facts.lowest = Some(one.min(*other));
                facts.highest = Some(one.max(*other));
            }
            [one, other] => (facts.lowest, facts.highest) = (*one, *other),
            _ => {}
        }
        Ok(facts)
    }

    /// Values of some numbers, those that the drive refuses left out.
    pub(super) fn read_numbers(&mut self, drive: &mut Drive, numbers: &[u16]) -> Result<Vec<Reading>, Error> {
        let selections: Vec<Selection> = numbers
            .iter()
            .filter_map(|&pnu| drive.parameters.select(&ParameterReference::number(pnu)).ok())
            .collect();
        Ok(self.read(drive, &selections)?.into_iter().flatten().collect())
    }

    /// A number of 64 bits that takes two PNUs, low half first; the low half with its sign where there is no other.
    fn wide(&mut self, drive: &mut Drive, pnu: u16) -> Result<Option<f64>, Error> {
        let readings = self.read_numbers(drive, &[pnu, pnu + 1])?;
        let raw = |pnu| {
            let reading = readings.iter().find(|reading| reading.pnu == pnu)?;
            reading.raw()
        };
        let low = raw(pnu);
        Ok(match (low, raw(pnu + 1)) {
            (Some(low), Some(high)) => Some(f64::from(high as i32) * 4_294_967_296.0 + f64::from(low as u32)),
            (Some(low), None) => Some(f64::from(low as i32)),
            (None, _) => None,
        })
    }

    /// The mode of the drive and the telegram for a purpose, with everything in it that no command carries preset to
    /// what the drive has now.
    pub(super) fn prepare(
        &mut self,
        drive: &mut Drive,
        device: &Device,
        purpose: Purpose,
    ) -> Result<(Mode, Choice), Error> {
        let readings = self.read_numbers(drive, &[TELEGRAM, MODE, SETPOINT_SIGNALS, ACTUAL_SIGNALS])?;
        let words = |pnu| -> Vec<u16> {
            readings
                .iter()
                .filter(|reading| reading.pnu == pnu)
                .filter_map(|reading| reading.raw())
                .filter_map(|raw| u16::try_from(raw & 0xFFFF).ok())
                .collect()
        };
        let reported = ReportedTelegram {
            number: words(TELEGRAM).first().copied(),
            setpoint: trimmed(words(SETPOINT_SIGNALS)),
            actual: trimmed(words(ACTUAL_SIGNALS)),
        };
        let told = words(MODE).first().copied();
        let mode = self.mode_for(drive, told, purpose)?;
        let mut choice =
            choose_telegram(device, &reported, purpose, mode).map_err(|problem| Error::Telegram {
                drive: drive.label(),
                problem,
            })?;
        let alone: Vec<u16> = choice.wiring.left_alone().collect();
        for reading in self.read_numbers(drive, &alone)? {
            if let Some(raw) = reading.raw() {
                // a number that does not fit its signal stays 0
                let _ = choice.wiring.preset(reading.pnu, raw);
            }
        }
        Ok((mode, choice))
    }

    /// The mode, if it is the one that the purpose needs.
    fn mode_for(&self, drive: &Drive, told: Option<u16>, purpose: Purpose) -> Result<Mode, Error> {
        let present = told.map(|number| mode_of(i64::from(number)));
        let needed = purpose.mode();
        match (present, needed) {
            // a drive that does not tell is taken at the caller's word
            (None, needed) => Ok(needed.unwrap_or_default()),
            (Some(Some(mode)), None) => Ok(mode),
            (Some(Some(mode)), Some(needed)) if mode == needed => Ok(mode),
            (Some(None), None) if purpose == Purpose::Control => Ok(Mode::Velocity),
            (Some(present), needed) => Err(Error::WrongMode {
                drive: drive.label(),
                needed: needed.unwrap_or_default(),
                present: present.map_or_else(
                    || format!("a mode of its maker (PNU 930 = 0x{:04X})", told.unwrap_or(0)),
                    |mode| mode_words(mode).to_owned(),
                ),
            }),
        }
    }
}

/// PNU 930: 1 speed control, 2 positioning.
const fn mode_of(number: i64) -> Option<Mode> {
    match number {
        1 => Some(Mode::Velocity),
        2 => Some(Mode::Position),
        _ => None,
    }
}

/// Without the empty words behind the last signal.
fn trimmed(mut words: Vec<u16>) -> Vec<u16> {
    while words.last() == Some(&0) {
        words.pop();
    }
    words
}
