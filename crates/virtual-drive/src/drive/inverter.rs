//! The functions of a frequency converter in addition to those of all drives: motor data, references, ramp times, jog
//! speeds, DC brake, and their status.

use profile::catalogue::{Parameter, Part};
use profile::state::{Conditions, Correction, Orders, Profile, SpeedCommand, State};

use super::Drive;
use crate::axis::{Endurance, Induction, InverterTuning, Motor, Plant, Ramps, Tuning};
use crate::model::{Converter, Model, RampTo};
use crate::store::Values;

/// Number of preset references that a control word can choose.
const PRESETS: usize = 4;

/// Time for which an inverter delivers its highest current, s. Source: Danfoss and Vacon data sheets, 160 % for a minute.
const OVERLOAD_TIME: f64 = 60.0;

/// kW in W; and in hp.
const KILO: f64 = 1000.0;
pub(super) const HORSEPOWER: f64 = 1.341_022;

/// The parameters of a frequency converter in the units of the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inverter {
    pub plate: Induction,
    /// Ramps 1 and 2.
    pub ramps: [Ramps; 2],
    pub quick_stop: f64,
    pub jog_ramps: Ramps,
    /// Speeds of jog 1 and 2 and of control words with one jog, rpm.
    pub jogs: [f64; 2],
    pub jog: f64,
    /// Lowest and highest reference, rpm.
    pub reference: [f64; 2],
    both_signs: bool,
    own_speed_of_range: bool,
    /// Parts of the highest reference.
    presets: [f64; PRESETS],
    correction: f64,
    /// Lowest and highest speed, rpm.
    speed_limits: [f64; 2],
    /// Hz.
    frequency_limits: [f64; 2],
    forward: bool,
    backward: bool,
    /// A.
    pub brake_current: f64,
    pub inverter_current: [f64; 2],
    pub current_limit: f64,
    tuning: InverterTuning,
    /// Words of the vendor's own telegrams.
    pub own_words: Profile,
    /// The control word of the bus has no effect.
    pub not_by_bus: bool,
    pub thermal_warning: bool,
    pub thermal_trip: bool,
    /// Low and high limits of current, A, and speed, rpm, outside of which the extended status word sets its bits.
    pub watched: [[f64; 2]; 2],
}

/// Reads parameters by their parts.
struct Reader<'a> {
    model: &'a Model,
    values: &'a Values,
    /// Pairs of poles: what makes speed of frequency.
    pairs: f64,
    /// Nominal current, A.
    current: f64,
}

impl Reader<'_> {
    fn parameter(&self, part: Part) -> Option<&'static Parameter> {
        self.model.numbered(self.model.number(part)?)
    }

    fn raw(&self, part: Part) -> Option<i64> {
        Some(self.values.get(self.model.number(part)?))
    }

    fn value(&self, part: Part) -> Option<f64> {
        let raw = self.raw(part)?;
        Some(
            self.parameter(part)?
                .engineering(raw, &self.model.catalogue.scaling),
        )
    }

    /// The parameter has one of the values that its row names.
    fn is_as_in_row(&self, part: Part) -> Option<bool> {
        let raw = self.raw(part)?;
        Some(self.model.catalogue.part_values(part).contains(&raw))
    }

    fn of_frequency(&self, hertz: f64) -> f64 {
        60.0 * hertz / self.pairs
    }

    /// rpm, whatever the unit of the parameter.
    fn speed(&self, part: Part, in_hertz: bool) -> Option<f64> {
        let value = self.value(part)?;
        let hertz = in_hertz || self.parameter(part)?.unit == "Hz";
        Some(if hertz { self.of_frequency(value) } else { value })
    }

    /// A, whatever the unit of the parameter.
    fn ampere(&self, part: Part, otherwise: f64) -> f64 {
        match (self.value(part), self.parameter(part).map(|found| found.unit)) {
            (Some(value), Some("%")) => value / 100.0 * self.current,
            (Some(value), _) => value,
            (None, _) => otherwise,
        }
    }
}

impl Inverter {
    pub fn new(converter: Converter, model: &Model, values: &Values) -> Self {
        let mut reader = Reader {
            model,
            values,
            pairs: 2.0,
            current: 1.0,
        };
        let plate = plate(&reader);
        reader.pairs = f64::from(plate.pole_pairs.max(1));
        reader.current = plate.current;
        let read = &reader;
        let in_hertz = read.is_as_in_row(Part::ReferenceUnit) == Some(true);
        let counted_from = read.speed(Part::LowestReference, in_hertz);
        let lowest = counted_from.or_else(|| read.speed(Part::ReferenceMinimum, in_hertz));
        let highest = read.speed(Part::Reference, in_hertz);
        let highest = highest.unwrap_or_else(|| plate.synchronous_speed());
        let reach = match converter.ramp_to {
            RampTo::Synchronous => plate.synchronous_speed(),
            RampTo::HighestReference => highest,
        };
        let slope = |part| read.value(part).map(|seconds| reach / seconds.max(0.01));
        let ramps = [
            [Part::RampUpTime, Part::RampDownTime],
            [Part::Ramp2UpTime, Part::Ramp2DownTime],
        ];
        let ramps = ramps.map(|[up, down]| Ramps {
            acceleration: slope(up).unwrap_or(reach),
            deceleration: slope(down).unwrap_or(reach),
        });
        let [first, _] = ramps;
        let jog = slope(Part::JogTime);
        let whole = 100.0;
        let mut presets = [0.0; PRESETS];
        if let Some(number) = model.number(Part::PresetReferences)
            && let Some(parameter) = model.numbered(number)
        {
            for (element, preset) in (0..).zip(&mut presets) {
                let raw = values.element_of(number, element);
                *preset = parameter.engineering(raw, &model.catalogue.scaling) / whole;
            }
        }
        let direction = read.raw(Part::Direction).unwrap_or(2);
        let nominal = read.ampere(Part::InverterCurrent, 1.25 * plate.current);
        let inverter_current = [nominal, read.ampere(Part::InverterPeakCurrent, 1.6 * nominal)];
        let jogs = [Part::Jog1, Part::Jog2].map(|part| read.speed(part, false).unwrap_or(0.0));
        let choice = read.raw(Part::ControlProfile);
        Self {
            plate,
            ramps,
            quick_stop: slope(Part::QuickStopTime).unwrap_or(first.deceleration),
            jog_ramps: jog.map_or(first, |slope| Ramps {
                acceleration: slope,
                deceleration: slope,
            }),
            jogs,
            jog: read.speed(Part::JogOnly, false).unwrap_or(jogs[0]),
            reference: [lowest.unwrap_or(0.0), highest],
            both_signs: read.is_as_in_row(Part::ReferenceRange).unwrap_or(true),
            own_speed_of_range: counted_from.is_some(),
            presets,
            correction: read.value(Part::ReferenceCorrection).unwrap_or(0.0) / whole,
            speed_limits: [
                read.speed(Part::LowestSpeed, false).unwrap_or(0.0),
                read.speed(Part::ForwardLimit, false).unwrap_or(highest),
            ],
            frequency_limits: [
                read.value(Part::LowestFrequency).unwrap_or(0.0),
                read.value(Part::HighestFrequency)
                    .or_else(|| read.value(Part::Reference))
                    .unwrap_or(f64::INFINITY),
            ],
            forward: direction != 1,
            backward: direction != 0,
            brake_current: read.ampere(Part::BrakeCurrent, plate.current),
            inverter_current,
            current_limit: read.ampere(Part::CurrentLimit, inverter_current[1]),
            tuning: InverterTuning {
                slip_compensation: read.value(Part::SlipCompensation).unwrap_or(whole) / whole,
                slip_time: read.value(Part::SlipTime).unwrap_or(0.1),
                flying_start: read.raw(Part::FlyingStart).unwrap_or(0) != 0,
                ..InverterTuning::default()
            },
            own_words: model.known.words.vendor_profile(choice),
            not_by_bus: read.is_as_in_row(Part::ControlSite) == Some(true),
            thermal_warning: read.is_as_in_row(Part::MotorProtectionWarning) == Some(true),
            thermal_trip: read.is_as_in_row(Part::MotorProtectionTrip) == Some(true),
            watched: [
                [Part::LowCurrentWarning, Part::HighCurrentWarning].map(|part| read.ampere(part, f64::NAN)),
                [Part::LowSpeedWarning, Part::HighSpeedWarning]
                    .map(|part| read.speed(part, false).unwrap_or(f64::NAN)),
            ],
        }
    }

    /// Highest speed, rpm.
    pub const fn fastest(&self) -> f64 {
        let [_, fastest] = self.speed_limits;
        fastest
    }

    /// Limits for the axis.
    pub fn tuning(&self, tuning: Tuning) -> Tuning {
        let [nominal, most] = self.inverter_current;
        let [_, fastest] = self.speed_limits;
        let limit = self.current_limit.min(most);
        let permitted = |permitted: bool| if permitted { fastest } else { 0.0 };
        Tuning {
            current_positive: limit,
            current_negative: limit,
            speed_positive: permitted(self.forward),
            speed_negative: permitted(self.backward),
            drive_endurance: Endurance {
                continuous: nominal,
                peak: most.max(nominal),
                time: OVERLOAD_TIME,
            },
            // its own thermal model watches the motor, nothing folds back
            motor_endurance: Endurance {
                continuous: 2.0 * most,
                peak: 3.0 * most,
                time: OVERLOAD_TIME,
            },
            inverter: self.tuning,
            ..tuning
        }
    }

    /// Speed in rpm that a number of the vendor's own speed word means, `full` of them being all.
    pub fn own_speed(&self, value: i64, full: u16) -> f64 {
        self.speed_of_range(value as f64 / f64::from(full.max(1)))
    }

    /// Returns the speed that is this part of the way from the lowest to the highest reference, or of the highest one.
    pub fn speed_of_range(&self, part: f64) -> f64 {
        let [lowest, highest] = self.reference;
        if self.own_speed_of_range {
            part.signum() * lowest + part * (highest - lowest)
        } else {
            part * highest
        }
    }

    /// Returns the number of a speed in the vendor's own speed word.
    pub fn own_number(&self, speed: f64, full: u16) -> f64 {
        f64::from(full) * self.part_of_range(speed)
    }

    /// Speed as part of the way from the lowest to the highest reference, or from 0 to the highest one.
    pub fn part_of_range(&self, speed: f64) -> f64 {
        let [lowest, highest] = self.reference;
        if !self.own_speed_of_range {
            return self.part(speed);
        }
        let way = (highest - lowest).max(1e-9);
        speed.signum() * ((speed.abs() - lowest) / way).max(0.0)
    }

    /// Returns whether the motor follows its frequency: it is not behind by more than twice its nominal slip.
    pub fn follows(&self, command: f64, measured: f64) -> bool {
        let slip = self.plate.synchronous_speed() - self.plate.speed;
        (command - measured).abs() <= 2.0 * slip.abs().max(1.0)
    }

    /// Speed as part of the highest reference.
    pub fn part(&self, speed: f64) -> f64 {
        speed / self.reference[1].max(1e-9)
    }

    /// Returns the speed that a reference and the other bits of the control word command, rpm.
    ///
    /// Bus reference and preset reference add up (3-04 "sum"), never to more than the highest reference; below the lowest
    /// one the motor runs with that. Catch up and slow down work on the amount.
    pub fn wanted(&self, speed: f64, orders: &Orders) -> f64 {
        let [lowest, highest] = self.reference;
        let preset = orders
            .preset
            .and_then(|number| self.presets.get(usize::from(number)))
            .copied()
            .unwrap_or(0.0);
        let mut sum = self.part(speed) + preset;
        let step = match orders.correction {
            Correction::None => 0.0,
            Correction::SlowDown => -self.correction,
            Correction::CatchUp => self.correction,
        };
        if step != 0.0 {
            sum += sum.signum() * step.max(-sum.abs());
        }
        let mut speed = sum.clamp(-1.0, 1.0) * highest;
        if !self.both_signs {
            speed = speed.max(lowest);
        }
        let [slowest, _] = self.speed_limits;
        if speed.abs() < slowest {
            speed = slowest.copysign(speed);
        }
        if orders.reverse { -speed } else { speed }
    }
}

fn plate(read: &Reader<'_>) -> Induction {
    let value = |part, otherwise: f64| read.value(part).filter(|value| *value > 0.0).unwrap_or(otherwise);
    let standard = Induction::KW_1_5;
    let plate = Induction::from_plate(
        KILO * value(Part::MotorPower, standard.power / KILO),
        value(Part::MotorVoltage, standard.voltage),
        value(Part::MotorFrequency, standard.frequency),
        value(Part::MotorCurrent, standard.current),
        value(Part::MotorSpeed, standard.speed),
    );
    let poles = read.raw(Part::MotorPoles);
    Induction {
        pole_pairs: poles
            .and_then(|poles| u16::try_from(poles / 2).ok())
            .filter(|pairs| *pairs > 0)
            .unwrap_or(plate.pole_pairs),
        magnetising_current: value(Part::MotorMagnetisingCurrent, plate.magnetising_current),
        ..plate
    }
}

impl Drive {
    /// Returns whose words the telegram in use has.
    pub(super) fn profile(&self) -> Profile {
        let words = &self.model.known.words;
        match &self.settings.inverter {
            _ if !self.process.has_own_words() => words.standard,
            Some(inverter) => inverter.own_words,
            None => words.own,
        }
    }

    /// Puts the motor of the name plate to the drive.
    pub(super) fn fit_motor(&mut self) {
        if let Some(inverter) = &self.settings.inverter {
            let plant = *self.axis.plant();
            let motor = Motor::Induction(inverter.plate);
            if plant.motor != motor {
                self.axis.set_plant(Plant { motor, ..plant });
            }
        }
    }

    /// Returns the speed that is requested, rpm.
    pub(super) fn wanted_speed(&self) -> f64 {
        match &self.settings.inverter {
            Some(inverter) => inverter.wanted(self.process.speed, &self.orders),
            None => self.process.speed,
        }
    }

    /// Ramp 1 or 2.
    pub(super) fn ramps(&self) -> Ramps {
        match &self.settings.inverter {
            Some(inverter) if self.orders.second_ramp => inverter.ramps[1],
            _ => self.settings.ramps,
        }
    }

    /// Jog speeds 1 and 2, rpm.
    pub(super) fn jog_speeds(&self) -> [f64; 2] {
        match &self.settings.inverter {
            Some(inverter) if self.profile() == Profile::DanfossFc => [inverter.jog; 2],
            _ => self.settings.jog_speed,
        }
    }

    /// Returns the bits of the status word that are not part of the state.
    pub(super) fn conditions(&self) -> Conditions {
        let electrical = self.axis.electrical();
        let output = self.axis.motor_output();
        let bus = electrical.bus_voltage();
        let within_frequency_limits = self.settings.inverter.as_ref().is_none_or(|inverter| {
            let [low, high] = inverter.frequency_limits;
            !self.is_enabled() || (low..=high).contains(&output.frequency.abs())
        });
        Conditions {
            warning: self.has_warning(),
            error_without_trip: false,
            trip_locked: self.faults.has_lasting(),
            unpowered: !electrical.can_drive(),
            at_reference: self.state() == State::S4 && self.is_at_speed(),
            within_frequency_limits,
            stopped_auto_start: false,
            voltage_exceeded: self.axis.plant().power.mains > 0.0 && !self.is_bus_fine(bus),
            torque_exceeded: output.limited,
            timer_exceeded: output.thermal_load > 1.0 || electrical.drive_load() >= 1.0,
        }
    }

    /// Returns whether the bus is where a warning about it does not begin.
    fn is_bus_fine(&self, bus: f64) -> bool {
        let nominal = self.axis.plant().power.mains * std::f64::consts::SQRT_2;
        (0.75 * nominal..=1.45 * nominal).contains(&bus)
    }

    /// 16-94: bit 0 ramping, 2 started, 3 slow down, 4 catch up, 7 and 8 current high and low, 9 and 10 speed high and
    /// low, 13 braking. Source: FC 300 programming guide, from memory.
    pub(super) fn extended_status(&self) -> i64 {
        let Some(inverter) = &self.settings.inverter else {
            return 0;
        };
        let running = self.is_enabled();
        let [[current_low, current_high], [speed_low, speed_high]] = inverter.watched;
        let (current, speed) = (self.axis.current().abs(), self.axis.measured_speed().abs());
        let jogging = matches!(self.orders.speed, Some(SpeedCommand::Jog1 | SpeedCommand::Jog2));
        let bits = [
            (0, running && !self.is_at_speed() && !jogging),
            (2, self.state() == State::S4),
            (3, running && self.orders.correction == Correction::SlowDown),
            (4, running && self.orders.correction == Correction::CatchUp),
            (7, current > current_high),
            (8, running && current < current_low),
            (9, speed > speed_high),
            (10, running && speed < speed_low),
            (13, self.axis.electrical().regen_power() > 0.0),
        ];
        bits.iter()
            .filter(|(_, set)| *set)
            .fold(0, |word, (bit, _)| word | 1 << bit)
    }
}
