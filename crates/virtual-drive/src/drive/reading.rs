//! What a parameter reads as.

use profile::catalogue::{Access, Parameter, Part, Scale, Size};

use profile::parameter::ErrorNumber;
use profile::telegram::Mapping;

use super::faults::motor_sensor;
use super::inverter::HORSEPOWER;
use super::{Drive, Mode};
use crate::model::{Live, Quantity, Sensor, Table, numbered};

/// PNUs in one list: with the closing 0 they fit the answer to one request (117 words in 240 octets).
pub(super) const PER_LIST: usize = 116;

/// Value of PNU 930 in current mode: bit 15 marks modes of the vendor.
pub(super) const MODE_CURRENT: i64 = 0x8000;

impl Drive {
    /// Returns the number of one element as on the wire (sign included); `position` is the place in the catalogue.
    pub(super) fn element(&self, position: usize, element: u16) -> Result<i64, ErrorNumber> {
        let parameter = self.parameter_with(position, element)?;
        Ok(self.number(position, parameter, element))
    }

    /// Returns the parameter at a place in the catalogue, if it has this element.
    pub(super) fn parameter_with(
        &self,
        position: usize,
        element: u16,
    ) -> Result<&'static Parameter, ErrorNumber> {
        let parameters = self.model.catalogue.parameters;
        let parameter = parameters.get(position).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        if element < count(parameter) {
            Ok(parameter)
        } else if parameter.is_array() || parameter.length > 0 {
            Err(ErrorNumber::SUBINDEX)
        } else {
            Err(ErrorNumber::NO_ARRAY)
        }
    }

    fn number(&self, position: usize, parameter: &Parameter, element: u16) -> i64 {
        let live = self.live.get(position).copied().unwrap_or(Live::Stored);
        match live {
            Live::Stored if parameter.is_text() && parameter.access == Access::ReadOnly => {
                text_octet(parameter, element)
            }
            Live::Stored if parameter.is_text() => self.stored(position, element),
            Live::Stored if parameter.length > 0 => octet(self.values.at(position), parameter, element),
            Live::Stored | Live::Mode if parameter.size != Size::Command => {
                self.number_of_kept(parameter, self.stored(position, element))
            }
            Live::Stored | Live::Mode | Live::Do(_) | Live::Choose(..) | Live::CopySetUp | Live::Absent => 0,
            Live::Measured(quantity) => parameter.raw(self.measured(quantity), &self.settings.scaling),
            Live::Place(place) => wrap(self.place_number(place), parameter),
            Live::Same(other) => self.same(parameter, other),
            Live::Setpoint => self.process.signal(parameter.pnu),
            Live::Through(other) => self.through(parameter, other),
            Live::ControlWord => i64::from(self.process.control.0),
            Live::StatusWord => i64::from(self.process.status),
            Live::Telegram => i64::from(self.telegram_setting()),
            Live::OperatingMode => match self.settings.mode {
                Mode::Current => MODE_CURRENT,
                Mode::Speed => 1,
                Mode::Position => 2,
            },
            Live::Profile if parameter.length > 0 => octet(self.model.profile.into(), parameter, element),
            Live::Profile => i64::from(self.model.profile),
            Live::FaultCounter => i64::from(self.faults.counter()),
            Live::Fault(number) => i64::from(self.faults.active(usize::from(number))),
            Live::Warning(number) => i64::from(self.faults.warning(usize::from(number))),
            Live::Signal(number) => self.process.signal(number),
            Live::SpeedReference => {
                let part = self.settings.inverter.as_ref();
                let part = part.map_or(0.0, |inverter| inverter.part_of_range(self.process.speed));
                parameter.raw(100.0 * part, &self.settings.scaling)
            }
            Live::AlarmWord(first) => self.alarm_word(false, first),
            Live::WarningWord(first) => self.alarm_word(true, first),
            Live::ExtendedStatus => self.extended_status(),
            Live::FaultSituations => i64::from(self.faults.situations()),
            Live::EditedSetUps => self.edited_digits(),
            Live::Word { actual, number } => self.shown_word(actual, number),
            Live::Watchdog => i64::try_from(self.link.watchdog().as_millis()).unwrap_or(i64::MAX),
            Live::Rotary => i64::from(self.rotary()),
            Live::Active => i64::from(self.is_enabled()),
            Live::DisableSources => self.disable_sources(),
            Live::TorqueAllowed => i64::from(!self.axis.inputs().sto),
            Live::Input { number } => i64::from(self.terminals.is_high(number)),
            Live::MotionStatus => self.motion_status(),
            Live::RunningTask => i64::from(self.positioning.running_task()),
            Live::SoftwareLimits => self.software_limits(),
            Live::LimitSwitch { positive } => {
                let inputs = self.axis.inputs();
                i64::from(if positive {
                    inputs.limit_positive
                } else {
                    inputs.limit_negative
                })
            }
            Live::ClearTask | Live::StartTask => 0,
            Live::Bits(bits) => bits.iter().fold(0, |word, source| {
                let number = self.model.number(source.part);
                let value = number.and_then(|number| self.parameter(number)).unwrap_or(0);
                word | (value >> source.of & 1) << source.bit
            }),
            Live::Array(Table::SetpointWords) => self.word_number(false, position, element),
            Live::Array(Table::ActualWords) => self.word_number(true, position, element),
            Live::Array(table) => self.entry(table, usize::from(element)),
        }
    }

    /// Returns the number on the wire of a value that is kept: a position divided by PN.POSSCALE, nearest.
    fn number_of_kept(&self, parameter: &Parameter, kept: i64) -> i64 {
        if parameter.scale != Scale::Position {
            return kept;
        }
        let by = i64::from(self.settings.scaling.position.max(1));
        let half = by / 2 * kept.signum();
        kept.saturating_add(half) / by
    }

    /// Returns the stored value of a number from the wire that is inside its limits: a position times PN.POSSCALE.
    pub(super) fn kept_number(&self, parameter: &Parameter, raw: i64) -> i64 {
        if parameter.scale == Scale::Position {
            raw.saturating_mul(self.settings.scaling.position.max(1).into())
        } else {
            raw
        }
    }

    /// Returns the number of a parameter that is not an array.
    pub(super) fn parameter(&self, pnu: u16) -> Option<i64> {
        self.element(numbered(self.model.catalogue, pnu)?, 0).ok()
    }

    /// Returns a measured value in its engineering unit.
    pub(super) fn measured(&self, quantity: Quantity) -> f64 {
        let axis = &self.axis;
        match quantity {
            Quantity::Speed => axis.measured_speed(),
            Quantity::SpeedFiltered => axis.filtered_speed(),
            Quantity::SpeedCommand => {
                if self.is_enabled() {
                    axis.speed_command()
                } else {
                    0.0
                }
            }
            Quantity::SpeedError => {
                if self.is_enabled() {
                    axis.speed_command() - axis.measured_speed()
                } else {
                    0.0
                }
            }
            Quantity::Current | Quantity::CurrentCommand => axis.current(),
            Quantity::Frequency
            | Quantity::FrequencyPart
            | Quantity::MotorVoltage
            | Quantity::Power
            | Quantity::Horsepower
            | Quantity::PowerPart
            | Quantity::Torque
            | Quantity::TorquePart
            | Quantity::MotorLoad
            | Quantity::InverterLoad
            | Quantity::BrakePower => self.of_motor(quantity),
            Quantity::Reference
            | Quantity::ReferenceFrequency
            | Quantity::ReferencePart
            | Quantity::SpeedPart
            | Quantity::SpeedOfRange => self.of_reference(quantity),
            Quantity::PowerTime => self.meter.on.as_secs_f64() / HOUR,
            Quantity::RunningTime => self.meter.running.as_secs_f64() / HOUR,
            Quantity::Energy => self.meter.energy / (1000.0 * HOUR),
            Quantity::PowerUps => self.meter.power_ups.into(),
            Quantity::OverTemperatures => self.meter.hot.into(),
            Quantity::OverVoltages => self.meter.over_voltage.into(),
            Quantity::TaskSpeed => axis.trajectory_speed(),
            Quantity::BusVoltage => axis.electrical().bus_voltage(),
            Quantity::RegenPower => axis.electrical().regen_power(),
            Quantity::Foldback => axis.electrical().foldback_limit(),
            Quantity::DriveFoldback => axis.electrical().drive_foldback_limit(),
            Quantity::MotorFoldback => axis.electrical().motor_foldback_limit(),
            Quantity::MotorSensor => motor_sensor(axis.electrical().motor_temperature()),
            Quantity::Temperature(Sensor::Control) => axis.electrical().control_temperature(),
            Quantity::Temperature(Sensor::PowerStage) => axis.electrical().power_stage_temperature(),
            Quantity::Temperature(Sensor::Motor) => axis.electrical().motor_temperature(),
        }
    }

    fn entry(&self, table: Table, element: usize) -> i64 {
        let device = &self.model.catalogue.device;
        let [major, minor, _] = device.software_revision;
        let version = i64::from(major) * 100 + i64::from(minor);
        let unit = [
            i64::from(device.vendor_id),
            i64::from(device.drive_unit_type),
            version,
            i64::from(device.firmware_year),
            i64::from(device.firmware_day_month),
            1, // drive objects
        ];
        match table {
            Table::SetpointSignals => mapped(self.process.setpoints(), element),
            Table::ActualSignals => mapped(self.process.actuals(), element),
            Table::SignalParameters => u16::try_from(element)
                .ok()
                .and_then(|number| self.parameter_of_signal(number))
                .map_or(0, i64::from),
            Table::FaultNumbers => i64::from(self.fault_number(u16::try_from(element).unwrap_or(u16::MAX))),
            Table::LogCodes => self.faults.logged(element).map_or(0, |(code, _)| code.into()),
            Table::LogTimes => self
                .faults
                .logged(element)
                .map_or(0, |(_, at)| at.as_secs() as i64),
            Table::HistoryEvents => self.history.at(element).event.into(),
            Table::HistoryValues => self.history.at(element).value.into(),
            Table::HistoryTimes => i64::from(self.history.at(element).at.as_millis() as u32),
            Table::SetpointWords | Table::ActualWords => 0,
            Table::WideWords => self
                .wide_word(element)
                .map_or(0, |position| self.element(position, 0).unwrap_or(0) & 0xFFFF),
            Table::Changed(list) => self.changed(usize::from(list) * PER_LIST + element, element),
            Table::Identification => unit.get(element).copied().unwrap_or(0),
            // Type class 1 is an axis; application classes 1 and, with positioning, 3; the axis number that requests carry.
            Table::DriveObject => match element {
                5 => 1,
                6 if self.model.number(Part::ControlMode).is_some() => 0b101,
                6 => 1,
                7 => i64::from(self.model.known.dialect.axis),
                _ => unit.get(element).copied().unwrap_or(0),
            },
            Table::Numbers(list) => (element < PER_LIST)
                .then(|| usize::from(list) * PER_LIST + element)
                .and_then(|place| self.model.listed_numbers().get(place))
                .map_or(0, |pnu| i64::from(*pnu)),
        }
    }
}

impl Drive {
    /// Returns a reading of the motor, in its engineering unit.
    fn of_motor(&self, quantity: Quantity) -> f64 {
        let output = self.axis.motor_output();
        let plate = self.settings.inverter.as_ref().map(|inverter| inverter.plate);
        let [power, torque, synchronous] = plate.map_or([1.0; 3], |plate| {
            [plate.power, plate.torque(), plate.synchronous_speed()]
        });
        let shaft = output.torque * self.axis.speed() * std::f64::consts::TAU / 60.0;
        let inverter = self.settings.inverter.as_ref();
        match quantity {
            Quantity::Frequency => output.frequency.abs(),
            Quantity::FrequencyPart => {
                let speed = plate.map_or(0.0, |plate| output.frequency / plate.frequency * synchronous);
                100.0 * inverter.map_or(0.0, |inverter| inverter.part(speed))
            }
            Quantity::MotorVoltage => output.voltage,
            Quantity::Power => shaft / 1000.0,
            Quantity::Horsepower => shaft / 1000.0 * HORSEPOWER,
            Quantity::PowerPart => 100.0 * shaft / power,
            Quantity::Torque => output.torque,
            Quantity::TorquePart => 100.0 * output.torque / torque,
            Quantity::MotorLoad => 100.0 * output.thermal_load,
            Quantity::InverterLoad => 100.0 * self.axis.electrical().drive_load(),
            Quantity::BrakePower => self.axis.electrical().regen_power() / 1000.0,
            _ => 0.0,
        }
    }

    /// Returns the speed that the reference requests and the speed that is reached.
    fn of_reference(&self, quantity: Quantity) -> f64 {
        let Some(inverter) = &self.settings.inverter else {
            return 0.0;
        };
        let (wanted, speed) = (self.wanted_speed(), self.axis.measured_speed());
        match quantity {
            Quantity::Reference => wanted,
            Quantity::ReferenceFrequency => wanted.abs() * f64::from(inverter.plate.pole_pairs) / 60.0,
            Quantity::ReferencePart => 100.0 * inverter.part(wanted),
            Quantity::SpeedPart => 100.0 * inverter.part(speed),
            Quantity::SpeedOfRange => 100.0 * inverter.part_of_range(speed),
            _ => 0.0,
        }
    }

    /// Returns the n-th number of a parameter that is not as delivered.
    fn changed(&self, place: usize, in_list: usize) -> i64 {
        if in_list >= PER_LIST {
            return 0;
        }
        let stored = |position: &usize| matches!(self.live.get(*position), Some(Live::Stored));
        (0..self.live.len())
            .filter(|position| stored(position) && self.values.is_changed(*position))
            .filter_map(|position| self.model.catalogue.parameters.get(position))
            .nth(place)
            .map_or(0, |parameter| i64::from(parameter.pnu))
    }
}

/// One octet of a text as delivered; blanks behind its end. In an array of texts all are alike.
fn text_octet(parameter: &Parameter, place: u16) -> i64 {
    let place = usize::from(place) % usize::from(parameter.length.max(1));
    i64::from(parameter.text.as_bytes().get(place).copied().unwrap_or(b' '))
}

/// One octet of a number, high octet first.
fn octet(value: i64, parameter: &Parameter, place: u16) -> i64 {
    let from_the_end = u32::from(parameter.length.saturating_sub(place).saturating_sub(1));
    value.checked_shr(8 * from_the_end).unwrap_or(0) & 0xFF
}

/// Seconds.
const HOUR: f64 = 3600.0;

/// Signal number in one word of a mapping.
fn mapped(mapping: &Mapping, element: usize) -> i64 {
    u16::try_from(element).map_or(0, |word| i64::from(mapping.word(word)))
}

/// Elements on the wire: those of an array, the octets of a string and of all strings of an array.
pub(super) const fn count(parameter: &Parameter) -> u16 {
    if parameter.length > 0 {
        parameter.length.saturating_mul(if parameter.elements == 0 {
            1
        } else {
            parameter.elements
        })
    } else {
        parameter.elements
    }
}

/// Keeps the low bits that the size holds.
fn wrap(value: i64, parameter: &Parameter) -> i64 {
    if parameter.wide {
        return value;
    }
    match (parameter.size, parameter.signed) {
        (Size::Byte, true) => i64::from(value as i8),
        (Size::Byte, false) => i64::from(value as u8),
        (Size::Word | Size::Command, true) => i64::from(value as i16),
        (Size::Word | Size::Command, false) => i64::from(value as u16),
        (Size::Dword, true) => i64::from(value as i32),
        (Size::Dword, false) => i64::from(value as u32),
    }
}
