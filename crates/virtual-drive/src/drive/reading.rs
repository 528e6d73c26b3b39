//! What a parameter reads as.

use profidrive::catalogue::{Parameter, Size};

use profidrive::parameter::ErrorNumber;
use profidrive::telegram::Mapping;

use super::faults::motor_sensor;
use super::{Drive, Mode};
use crate::model::{Live, Quantity, Sensor, Table};

/// PNUs of the lists of PNUs.
const LISTS: core::ops::RangeInclusive<u16> = 980..=989;

/// PNUs in one list: with the closing 0 they fit the answer to one request (117 words in 240 octets).
pub(super) const PER_LIST: usize = 116;

/// Value of PNU 930 in current mode: bit 15 marks modes of the maker.
const MODE_CURRENT: i64 = 0x8000;

impl Drive {
    /// The number of one element as on the wire (sign included); `position` is the place in the catalogue.
    pub(super) fn element(&self, position: usize, element: u16) -> Result<i64, ErrorNumber> {
        let parameter = self.parameter_with(position, element)?;
        Ok(self.number(position, parameter, element))
    }

    /// The parameter at a place in the catalogue, if it has this element.
    pub(super) fn parameter_with(
        &self,
        position: usize,
        element: u16,
    ) -> Result<&'static Parameter, ErrorNumber> {
        let parameters = self.model.catalogue.parameters;
        let parameter = parameters.get(position).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        if element < parameter.elements {
            Ok(parameter)
        } else if parameter.is_array() {
            Err(ErrorNumber::SUBINDEX)
        } else {
            Err(ErrorNumber::NO_ARRAY)
        }
    }

    fn number(&self, position: usize, parameter: &Parameter, element: u16) -> i64 {
        let live = self.live.get(position).copied().unwrap_or(Live::Stored);
        match live {
            Live::Stored | Live::Mode if parameter.size != Size::Command => self.values.at(position),
            Live::Stored | Live::Mode | Live::Do(_) => 0,
            Live::Measured(quantity) => parameter.raw(self.measured(quantity), &self.settings.scaling),
            Live::Place(place) => wrap(self.place_number(place), parameter),
            Live::Same(other) => self.same(parameter, other),
            Live::Setpoint => self.process.signal(parameter.pnu),
            Live::Through(other) => self.through(parameter, other),
            Live::ControlWord => i64::from(self.process.control.0),
            Live::StatusWord => i64::from(self.process.status),
            Live::Telegram => i64::from(self.process.telegram()),
            Live::OperatingMode => match self.settings.mode {
                Mode::Current => MODE_CURRENT,
                Mode::Speed => 1,
                Mode::Position => 2,
            },
            Live::Profile => i64::from(self.model.profile),
            Live::FaultCounter => i64::from(self.faults.counter()),
            Live::Fault(number) => i64::from(self.faults.active(usize::from(number))),
            Live::Warning(number) => i64::from(self.faults.warning(usize::from(number))),
            Live::Watchdog => i64::try_from(self.link.watchdog().as_millis()).unwrap_or(i64::MAX),
            Live::Active => i64::from(self.is_enabled()),
            Live::DisableSources => self.disable_sources(),
            Live::TorqueAllowed => i64::from(!self.axis.inputs().sto),
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
                let value = self.parameter(source.pnu).unwrap_or(0);
                word | (value >> source.of & 1) << source.bit
            }),
            Live::Array(table) => self.entry(table, usize::from(element)),
        }
    }

    /// The number of a parameter that is no array.
    pub(super) fn parameter(&self, pnu: u16) -> Option<i64> {
        self.element(self.model.catalogue.position(pnu)?, 0).ok()
    }

    /// A measured value in its engineering unit.
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
        ];
        match table {
            Table::SetpointSignals => mapped(self.process.setpoints(), element),
            Table::ActualSignals => mapped(self.process.actuals(), element),
            Table::SignalParameters => u16::try_from(element)
                .ok()
                .and_then(|number| self.parameter_of_signal(number))
                .map_or(0, i64::from),
            Table::FaultNumbers => i64::from(self.fault_number(u16::try_from(element).unwrap_or(u16::MAX))),
            Table::Identification => unit.get(element).copied().unwrap_or(0),
            // Type class 1 is an axis; application classes 1 and 3; the axis number that requests carry.
            Table::DriveObject => match element {
                5 => 1,
                6 => 0b101,
                _ => unit.get(element).copied().unwrap_or(0),
            },
            Table::Numbers(list) => (element < PER_LIST)
                .then(|| usize::from(list) * PER_LIST + element)
                .and_then(|place| self.numbers.get(place))
                .map_or(0, |pnu| i64::from(*pnu)),
        }
    }

    /// What the lists of PNUs hold together: they do not name themselves.
    pub(super) fn listed_numbers(model: &crate::model::Model) -> Box<[u16]> {
        model
            .catalogue
            .numbers()
            .filter(|pnu| !LISTS.contains(pnu))
            .collect()
    }
}

/// Signal number in one word of a mapping.
fn mapped(mapping: &Mapping, element: usize) -> i64 {
    u16::try_from(element).map_or(0, |word| i64::from(mapping.word(word)))
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
