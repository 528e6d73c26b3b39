//! What has to be known of a drive before its axis is taken or moved. Reads only.

use profile::catalogue::{Device, Part};
use profile::notation::ParameterReference;
use profile::parameter::pnu;
use profile::state::{Mode, Profile, Stw1, Zsw1};
use profile::telegram::Telegram;

use super::authority::power_is_on;
use super::mode::mode_of;
use super::plugged::{Layout, Plugged};
use super::readings::{Readings, zsw1_of};
use super::{AxisSettings, Session, takeover};
use crate::axis::{
    Choice, ModuloRange, MotionFacts, Move, MovePlan, Purpose, ReportedTelegram, SpeedScale, SpeedUnit,
    Wiring, choose_telegram, named_telegram, plan_move, process_words,
};
use crate::drive::has_jog;
use crate::error::mode_words;
use crate::{Action, Authority, Drive, Error};
use profile::value::{Reading, Selection};

/// What matters for a move, and what a converter's ramps follow from.
const MOTION: [Part; 31] = [
    Part::Feedrate,
    Part::Reference,
    Part::ReferenceUnit,
    Part::ReferenceRange,
    Part::Direction,
    Part::ControlWord,
    Part::StatusWord,
    Part::ControlProfile,
    Part::Position,
    Part::Acceleration,
    Part::Deceleration,
    Part::RampUpTime,
    Part::RampDownTime,
    Part::MotorFrequency,
    Part::MotorSpeed,
    Part::MotorPoles,
    Part::NegativeSwitch,
    Part::PositiveSwitch,
    Part::ModuloEnd1,
    Part::ModuloEnd2,
    Part::ModuloWay,
    Part::Modulo,
    Part::SoftwareLimitsOn,
    Part::SoftwareLimit0,
    Part::SoftwareLimit1,
    Part::BackwardLimit,
    Part::ForwardLimit,
    Part::MotorType,
    Part::UnitNumerator,
    Part::UnitDenominator,
    Part::UnitRotary,
];

/// What decides whether and how an axis is taken.
const CONTROL: [Part; 13] = [
    Part::Reference,
    Part::ReferenceUnit,
    Part::LowestReference,
    Part::ControlWord,
    Part::StatusWord,
    Part::ControlProfile,
    Part::Acceleration,
    Part::Deceleration,
    Part::RampUpTime,
    Part::RampDownTime,
    Part::MotorFrequency,
    Part::MotorSpeed,
    Part::MotorPoles,
];

/// What an axis is taken with.
#[derive(Debug)]
pub(super) struct Prepared {
    pub mode: Mode,
    pub wiring: Wiring,
    /// None on a serial line.
    pub layout: Option<Layout>,
    /// The telegram the drive has now (PNU 922).
    pub reported: Option<u16>,
    /// The drive is in operation: what it obeys is to be kept when control is taken.
    pub kept: bool,
    /// What the numbers of its speeds mean.
    pub scale: SpeedScale,
    /// DRV.ACC in the unit of the speeds a second.
    pub acceleration: Option<f64>,
    /// DRV.DEC likewise.
    pub deceleration: Option<f64>,
}

/// A bit that the control word does not have is sent in vain.
fn check_jog(drive: &Drive, purpose: Purpose, profile: Profile) -> Result<(), Error> {
    if purpose == Purpose::Jog && !has_jog(profile, Stw1::JOG_1) {
        return Err(Error::NoJog {
            drive: drive.label(),
            profile: profile.name(),
        });
    }
    Ok(())
}

impl Session {
    /// Returns the plan of a move of an axis, and all objections to it.
    ///
    /// # Errors
    /// When the model is not known, or the drive cannot be reached.
    pub async fn plan_move(
        &mut self,
        drive: &mut Drive,
        order: &Move,
        speed_limit: f64,
    ) -> Result<MovePlan, Error> {
        self.read_scaling(drive).await?;
        let facts = self.motion_facts(drive).await?;
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

    /// Reads the facts of a drive that matter for a move; refused values are left out.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn motion_facts(&mut self, drive: &mut Drive) -> Result<MotionFacts, Error> {
        let readings = self.ask(drive, &MOTION).await?;
        let (number, raw) = (|part| readings.number(part), |part| readings.raw(part));
        let telegram = self.telegram_now(drive).await?;
        let zsw1 = zsw1_of(drive, &readings, telegram);
        let on = raw(Part::SoftwareLimitsOn).unwrap_or(0);
        // the signal wraps at 32 bits and has a sign, the table of the manual calls it unsigned
        let position = raw(Part::Position).map(|raw| f64::from(raw as i32) / drive.counts_per_turn());
        let [forward, backward] = speed_limits(&readings);
        let mut facts = MotionFacts {
            position,
            homed: zsw1.map(|word| word.has(Zsw1::HOMED)),
            fault: zsw1.map(|word| word.has(Zsw1::FAULT)),
            modulo: readings.flag(Part::Modulo) == Some(true),
            forward_limit: forward.map(|(limit, _)| limit),
            backward_limit: backward.map(|(limit, _)| limit),
            forward_by: forward.map(|(_, part)| part),
            backward_by: backward.map(|(_, part)| part),
            feedrate: number(Part::Feedrate),
            negative_switch: readings.flag(Part::NegativeSwitch),
            positive_switch: readings.flag(Part::PositiveSwitch),
            acceleration: readings.ramp(Part::Acceleration, Part::RampUpTime),
            deceleration: readings.ramp(Part::Deceleration, Part::RampDownTime),
            ..MotionFacts::default()
        };
        let units = units_per_turn(raw);
        let place = |part| number(part).zip(units).map(|(place, units)| place / units);
        facts.modulo_range = place(Part::ModuloEnd1)
            .zip(place(Part::ModuloEnd2))
            .and_then(|(one, other)| ModuloRange::new(one, other, raw(Part::ModuloWay).unwrap_or(0)));
        let limit = |bit: i64, part| place(part).filter(|_| on & bit != 0);
        (facts.lowest, facts.highest) = match (limit(1, Part::SoftwareLimit0), limit(2, Part::SoftwareLimit1))
        {
            // which of the two is the upper one is up to who set them
            (Some(one), Some(other)) => (Some(one.min(other)), Some(one.max(other))),
            others => others,
        };
        Ok(facts)
    }

    /// Values of some numbers, those that the drive refuses left out.
    pub(super) async fn read_numbers(
        &mut self,
        drive: &mut Drive,
        numbers: &[u16],
    ) -> Result<Vec<Reading>, Error> {
        let selections: Vec<Selection> = numbers
            .iter()
            .filter_map(|&pnu| drive.parameters.select(&ParameterReference::number(pnu)).ok())
            .collect();
        self.read_present(drive, &selections).await
    }

    /// Returns the mode of the drive, the telegram for a purpose and the modules to connect with (none on a serial
    /// line). Signals of the telegram that no command carries are preset to the present values of the drive.
    pub(super) async fn prepare(
        &mut self,
        drive: &mut Drive,
        device: &Device,
        settings: &AxisSettings,
    ) -> Result<Prepared, Error> {
        let purpose = settings.purpose;
        let (reported_mode, reported) = self.mode_and_telegram(drive).await?;
        let readings = self.ask(drive, &CONTROL).await?;
        let telegram = drive.telegram_in_use(reported.number);
        let word = zsw1_of(drive, &readings, telegram);
        self.free(drive, word, purpose).await?;
        let kept = takeover::is_kept(word);
        let mode = self.mode_for(drive, reported_mode, purpose)?;
        if drive.is_on_line() {
            let wiring = process_words(device, purpose).map_err(|problem| Error::Telegram {
                drive: drive.label(),
                problem,
            })?;
            if let Some(wanted) = settings.telegram.filter(|&wanted| wanted != wiring.telegram()) {
                return Err(Error::NoSuchTelegram {
                    drive: drive.label(),
                    wanted,
                    possible: vec![wiring.telegram()],
                });
            }
            let profile = readings.profile(drive, Some(wiring.telegram()));
            check_jog(drive, purpose, profile)?;
            let (scale, ramps) = scale_of(drive, &readings, wiring.telegram(), settings)?;
            return Ok(Prepared {
                mode,
                wiring: wiring.with_words(profile),
                layout: None,
                reported: telegram,
                kept,
                scale,
                acceleration: ramps[0],
                deceleration: ramps[1],
            });
        }
        let plugged = self.plugged(drive).await?;
        let reported = ReportedTelegram {
            number: reported.number.or_else(|| plugged.telegram(device)),
            ..reported
        };
        let (mut choice, layout) = self.telegram_for(drive, device, settings, mode, (&plugged, &reported))?;
        let uncommanded: Vec<u16> = choice.wiring.uncommanded().collect();
        for reading in self.read_numbers(drive, &uncommanded).await? {
            if let Some(raw) = reading.raw() {
                // a number that does not fit its signal stays 0
                let _ = choice.wiring.preset(reading.pnu, raw);
            }
        }
        let telegram = Telegram::find(choice.wiring.telegram(), drive.station.vendor_id);
        let profile = drive.model.words.of(telegram, readings.raw(Part::ControlProfile));
        check_jog(drive, purpose, profile)?;
        let (scale, ramps) = scale_of(drive, &readings, choice.wiring.telegram(), settings)?;
        Ok(Prepared {
            mode,
            wiring: choice.wiring.with_words(profile),
            layout: Some(layout),
            reported: reported.number,
            kept,
            scale,
            acceleration: ramps[0],
            deceleration: ramps[1],
        })
    }

    /// Returns the telegram for a purpose and the modules to connect with. Where settings of the drive decide about its
    /// words and cannot be read, it is telegram 1, if the drive has that.
    fn telegram_for(
        &self,
        drive: &Drive,
        device: &Device,
        settings: &AxisSettings,
        mode: Mode,
        (plugged, reported): (&Plugged, &ReportedTelegram),
    ) -> Result<(Choice, Layout), Error> {
        let purpose = settings.purpose;
        let choice = match settings.telegram {
            Some(wanted) if device.telegram(wanted).is_none() => {
                return Err(Error::NoSuchTelegram {
                    drive: drive.label(),
                    wanted,
                    possible: device.telegrams.iter().map(|module| module.telegram).collect(),
                });
            }
            Some(wanted) => named_telegram(device, reported, purpose, wanted),
            None => choose_telegram(device, reported, purpose, mode),
        };
        let choice = choice.map_err(|problem| Error::Telegram {
            drive: drive.label(),
            problem,
        })?;
        // a vendor's file is more certain than that the module plugged is the one of PNU 922
        let layout = |choice: &Choice| {
            plugged
                .layout_of(&drive.vendor_modules, device, &choice.module)
                .or_else(|| plugged.layout(device, &choice.module, reported.number))
        };
        if self.unread().is_some() && depends_on_settings(drive, &choice) {
            let standard = named_telegram(device, reported, purpose, 1).ok();
            let fits = standard.and_then(|choice| layout(&choice).map(|layout| (choice, layout)));
            if let Some(fits) = fits {
                return Ok(fits);
            }
        }
        match layout(&choice) {
            Some(layout) => Ok((choice, layout)),
            None => Err(Error::ForeignModule {
                drive: drive.label(),
                ident: plugged.drive.as_ref().map_or(0, |module| module.ident),
                plugged: reported.number,
                wanted: choice.module.telegram,
            }),
        }
    }

    /// Puts what the drive has now into the words of the telegram whose parameter settings choose: they are written
    /// with the first frame, and are to keep their values. To be called with the telegram in place.
    pub(super) async fn preset_chosen(
        &mut self,
        drive: &mut Drive,
        wiring: &mut Wiring,
    ) -> Result<(), Error> {
        let indices: Vec<u16> = wiring.chosen_words().collect();
        let mapping = self.ask(drive, &[Part::ChosenSetpoints]).await?;
        let number = |index: u16| -> Option<u16> {
            let mut all = mapping.all(Part::ChosenSetpoints);
            let reading = all.find(|reading| reading.index == Some(index))?;
            reading
                .raw()
                .and_then(|raw| u16::try_from(raw).ok())
                .filter(|number| *number != 0)
        };
        let numbers: Vec<u16> = indices.iter().filter_map(|index| number(*index)).collect();
        let readings = self.read_numbers(drive, &numbers).await?;
        for &index in &indices {
            let Some(chosen) = number(index) else { continue };
            let first = |reading: &&Reading| reading.pnu == chosen && reading.index.unwrap_or(0) == 0;
            let Some(reading) = readings.iter().find(first) else {
                continue;
            };
            // a double word stands in two words, the high one first; one word alone is the low one
            let high = reading.octets.len() == 4
                && number(index + 1) == Some(chosen)
                && (index == 0 || number(index - 1) != Some(chosen));
            let end = reading.octets.len() - if high { 2 } else { 0 };
            let word = reading.octets.get(end.saturating_sub(2)..end).unwrap_or_default();
            let value = word.iter().fold(0, |value, octet| value << 8 | u16::from(*octet));
            wiring.preset_chosen(index, value);
        }
        Ok(())
    }

    /// Checks that the drive is neither in local operation nor in operation without a controller. Reads only.
    ///
    /// # Errors
    /// [`Error::LocalOperation`], [`Error::Ownerless`], and when the drive cannot be reached.
    pub async fn check_control(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let authority = self.authority(drive).await?;
        permitted(drive, authority)
    }

    /// Returns the telegram of a drive's process data: that of PNU 922, or that of its line.
    pub(super) async fn telegram_now(&mut self, drive: &mut Drive) -> Result<Option<u16>, Error> {
        let readings = self.read_numbers(drive, &[pnu::TELEGRAM]).await?;
        let raw = readings.first().and_then(Reading::raw);
        let reported = raw.and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
        Ok(drive.telegram_in_use(reported))
    }

    /// Checks that control can be taken for a purpose. Control alone can be taken of a drive that is in operation without
    /// a controller; a motion is never begun on one.
    async fn free(&mut self, drive: &mut Drive, word: Option<Zsw1>, purpose: Purpose) -> Result<(), Error> {
        if purpose == Purpose::Observe && word.is_none() {
            return Err(Error::StatusUnread { drive: drive.label() });
        }
        match self.authority_by(drive, word).await? {
            Authority::Ownerless if purpose == Purpose::Control => Ok(()),
            // what a controller does not command is not seen to stop when this connection ends
            Authority::Free | Authority::Unknown
                if purpose == Purpose::Observe && word.is_some_and(power_is_on) =>
            {
                Err(ownerless(drive))
            }
            authority => permitted(drive, authority),
        }
    }

    /// Returns the mode, if it is the one that the purpose needs.
    fn mode_for(&self, drive: &Drive, readings: Option<u16>, purpose: Purpose) -> Result<Mode, Error> {
        let present = readings.map(|number| mode_of(i64::from(number)));
        let needed = purpose.mode();
        match (present, needed) {
            // for a drive that does not report it the caller's value counts
            (None, needed) => Ok(needed.unwrap_or_default()),
            (Some(Some(mode)), None) => Ok(mode),
            (Some(Some(mode)), Some(needed)) if mode == needed => Ok(mode),
            (Some(None), None) if matches!(purpose, Purpose::Observe | Purpose::Control) => {
                Ok(Mode::Velocity)
            }
            (Some(present), needed) => Err(Error::WrongMode {
                drive: drive.label(),
                needed: needed.unwrap_or_default(),
                present: present.map_or_else(
                    || {
                        format!(
                            "a vendor-specific mode (PNU 930 = 0x{:04X})",
                            readings.unwrap_or(0)
                        )
                    },
                    |mode| mode_words(mode).to_owned(),
                ),
            }),
        }
    }
}

/// Settings of the drive decide what a word of this telegram means, or whose bits its control word has.
fn depends_on_settings(drive: &Drive, choice: &Choice) -> bool {
    let telegram = Telegram::find(choice.wiring.telegram(), drive.station.vendor_id);
    let own_words = telegram.is_some_and(|telegram| telegram.own_words);
    choice.wiring.chosen_words().next().is_some() || own_words && !drive.model.words.chosen.is_empty()
}

/// Whether an axis of a drive with this authority may be taken; one that another controller has is refused with its name
/// when connecting.
fn permitted(drive: &Drive, authority: Authority) -> Result<(), Error> {
    match authority {
        Authority::Local(by) => Err(Error::LocalOperation {
            drive: drive.label(),
            by,
        }),
        Authority::Ownerless => Err(ownerless(drive)),
        Authority::Controller(_) | Authority::Free | Authority::Unknown => Ok(()),
    }
}

/// Returns the refusal of a motion of a drive that is in operation without a controller.
pub(super) fn ownerless(drive: &Drive) -> Error {
    let tables = drive.model.catalogue;
    let by_parameter = tables.is_some_and(|tables| tables.part(Part::Disable).is_some());
    Error::Ownerless {
        drive: drive.label(),
        // a stop by parameter leaves the power stage on
        stop: if by_parameter {
            Action::Disable
        } else {
            Action::Stop
        },
    }
}

/// Returns the unit of the speeds in a telegram, and the ramps up and down in that unit a second.
fn scale_of(
    drive: &Drive,
    readings: &Readings,
    telegram: u16,
    settings: &AxisSettings,
) -> Result<(SpeedScale, [Option<f64>; 2]), Error> {
    let tables = drive.model.catalogue.filter(|_| !drive.model.learned);
    let converter = tables.is_none_or(|tables| tables.part(Part::Reference).is_some());
    let own = Telegram::find(telegram, drive.station.vendor_id).and_then(|telegram| telegram.full_speed);
    let full = own.unwrap_or(PERCENT_100);
    let highest = settings.reference_speed.or_else(|| readings.reference());
    let lowest = readings
        .reference_at(Part::LowestReference)
        .filter(|_| own.is_some())
        .unwrap_or(0.0);
    let wrong = || Error::SpeedUnit {
        drive: drive.label(),
        wanted: settings.unit,
    };
    let ramps = [
        readings.ramp(Part::Acceleration, Part::RampUpTime),
        readings.ramp(Part::Deceleration, Part::RampDownTime),
    ];
    match (settings.unit, highest.filter(|_| converter)) {
        (SpeedUnit::Rpm, Some(highest)) => {
            Ok((SpeedScale::range(full, [lowest, highest], SpeedUnit::Rpm), ramps))
        }
        (SpeedUnit::Rpm, None) if !converter => {
            Ok((SpeedScale::linear(drive.parameters.scaling.speed()), ramps))
        }
        (SpeedUnit::Rpm, None) if settings.purpose == Purpose::Speed => Err(wrong()),
        (SpeedUnit::Percent, _) if !converter => Err(wrong()),
        (_, highest) => {
            let part = highest.map(|highest| 100.0 / highest);
            let ramps = ramps.map(|ramp| ramp.zip(part).map(|(ramp, part)| ramp * part));
            Ok((SpeedScale::percent(full), ramps))
        }
    }
}

/// 100 % of a speed in N2.
const PERCENT_100: u16 = 0x4000;

/// Returns the lowest of the limits of the speed in each direction, and what sets it.
fn speed_limits(readings: &Readings) -> [Option<(f64, Part)>; 2] {
    let of = |part| readings.rpm(part).map(|limit| (limit.abs(), part));
    let forward = of(Part::ForwardLimit);
    let reference = readings.reference().map(|limit| (limit, Part::Reference));
    let only = |part, at| (readings.raw(part) == Some(at)).then_some((0.0, part));
    let lowest = |limits: [Option<(f64, Part)>; 4]| {
        let limits = limits.into_iter().flatten();
        limits.min_by(|(one, _), (other, _)| one.total_cmp(other))
    };
    [
        lowest([forward, reference, only(Part::Direction, 1), None]),
        lowest([
            of(Part::BackwardLimit).or(forward),
            reference,
            only(Part::Direction, 0),
            only(Part::ReferenceRange, 0),
        ]),
    ]
}

/// Returns the units of the position parameters in one turn of a rotary motor; `None` for a linear one. Source:
/// AKD UNIT.PROTARY, UNIT.PIN, UNIT.POUT; MOTOR.TYPE 1 is linear.
fn units_per_turn(raw: impl Fn(Part) -> Option<i64>) -> Option<f64> {
    if raw(Part::MotorType) == Some(1) {
        return None;
    }
    match raw(Part::UnitRotary)? {
        0 => Some(4_294_967_296.0),
        1 => Some(std::f64::consts::TAU),
        2 => Some(360.0),
        3 => {
            let [numerator, denominator] =
                [Part::UnitNumerator, Part::UnitDenominator].map(|part| raw(part).filter(|&value| value > 0));
            let part = |value: i64| f64::from(u32::try_from(value).unwrap_or(u32::MAX));
            Some(part(numerator?) / part(denominator?))
        }
        4 => Some(65_536.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_units_as_the_drive_has_them() {
        let with = |pairs: &'static [(Part, i64)]| {
            move |pnu| pairs.iter().find(|pair| pair.0 == pnu).map(|pair| pair.1)
        };
        assert_eq!(units_per_turn(with(&[(Part::UnitRotary, 4)])), Some(65_536.0));
        assert_eq!(
            units_per_turn(with(&[(Part::UnitRotary, 0)])),
            Some(4_294_967_296.0)
        );
        assert_eq!(units_per_turn(with(&[(Part::UnitRotary, 2)])), Some(360.0));
        let custom = with(&[
            (Part::UnitRotary, 3),
            (Part::UnitNumerator, 10),
            (Part::UnitDenominator, 4),
        ]);
        assert_eq!(units_per_turn(custom), Some(2.5));
        assert_eq!(
            units_per_turn(with(&[
                (Part::UnitRotary, 3),
                (Part::UnitNumerator, 10),
                (Part::UnitDenominator, 0)
            ])),
            None
        );
        assert_eq!(
            units_per_turn(with(&[(Part::UnitRotary, 4), (Part::MotorType, 1)])),
            None
        );
        assert_eq!(units_per_turn(with(&[])), None);
    }
}
