//! What a parameter reads as.

use profidrive::catalogue::{Parameter, Size};

use profidrive::parameter::ErrorNumber;

use super::{Drive, Mode, Service};
use crate::model::{Live, Quantity, Sensor, Table};

/// Signal numbers have PNUs of their own in this range (PNU 923 tells which).
const SIGNALS: core::ops::RangeInclusive<u16> = 1..=109;

/// PNUs of the lists of PNUs.
const LISTS: core::ops::RangeInclusive<u16> = 980..=989;

/// PNUs in one list: with the closing 0 they fit the answer to one request (117 words in 240 octets).
pub(super) const PER_LIST: usize = 116;

/// Value of PNU 930 in current mode: bit 15 marks modes of the maker.
const MODE_CURRENT: i64 = 0x8000;

/// DRV.MOTIONSTAT bit 7, a quick stop is in progress, and bit 9, service motion is active.
const MOTION_QUICK_STOP: i64 = 1 << 7;
const MOTION_SERVICE: i64 = 1 << 9;

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
            Live::Measured(Quantity::Revolutions) => {
                let bits = u32::from(self.settings.scaling.singleturn_bits.min(32));
                wrap(self.axis.position() >> (32 - bits), parameter)
            }
            Live::Measured(Quantity::Counts) => {
                let counts = i128::from(self.axis.position() >> 16) * 1000;
                let scaled = counts.div_euclid(i128::from(self.settings.scaling.position.max(1)));
                wrap(scaled as i64, parameter)
            }
            Live::Measured(Quantity::Angle) => wrap(self.axis.position(), parameter),
            Live::Measured(quantity) => parameter.raw(self.measured(quantity), &self.settings.scaling),
            Live::Same(other) => self.same(parameter, other),
            Live::ControlWord => i64::from(self.process.control.0),
            Live::StatusWord => i64::from(self.process.status),
            Live::Telegram => i64::from(self.telegram_number()),
            Live::OperatingMode => match self.settings.mode {
                Mode::Current => MODE_CURRENT,
                Mode::Speed => 1,
                Mode::Position => 2,
            },
            Live::Profile => i64::from(self.model.profile),
            Live::FaultCounter => i64::from(self.faults.counter()),
            Live::Fault(number) => i64::from(self.fault_number(u16::from(number))),
            Live::Watchdog => i64::try_from(self.link.watchdog().as_millis()).unwrap_or(i64::MAX),
            Live::Active => i64::from(self.is_enabled()),
            Live::DisableSources => {
                if self.is_enabled() {
                    0
                } else {
                    1 | i64::from(self.has_fault()) << 1
                }
            }
            Live::MotionStatus => {
                let quick = if self.is_quick_stopping() {
                    MOTION_QUICK_STOP
                } else {
                    0
                };
                quick
                    | if self.service != Service::Off {
                        MOTION_SERVICE
                    } else {
                        0
                    }
            }
            // Bit 6: torque is allowed, there is no STO. No limit switch is touched, no input disables.
            Live::Inputs => 1 << 6,
            Live::Array(table) => self.entry(table, usize::from(element)),
        }
    }

    fn same(&self, parameter: &Parameter, other: u16) -> i64 {
        let Some(position) = self.model.catalogue.position(other) else {
            return 0;
        };
        let Some(target) = self.model.catalogue.parameters.get(position) else {
            return 0;
        };
        let raw = self.values.at(position);
        if parameter.scale == target.scale {
            return raw;
        }
        let scaling = &self.settings.scaling;
        parameter.raw(target.engineering(raw, scaling), scaling)
    }

    /// A measured value in its engineering unit; positions in revolutions and counts.
    pub(super) fn measured(&self, quantity: Quantity) -> f64 {
        let axis = &self.axis;
        let revolutions = axis.position() as f64 / 4_294_967_296.0;
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
            Quantity::SpeedSetpoint => self.process.speed,
            Quantity::SpeedError => {
                if self.is_enabled() {
                    axis.speed_command() - axis.measured_speed()
                } else {
                    0.0
                }
            }
            Quantity::Current | Quantity::CurrentCommand => axis.current(),
            Quantity::Revolutions | Quantity::Angle => revolutions,
            Quantity::Counts => revolutions * 65_536.0,
            Quantity::BusVoltage => axis.electrical().bus_voltage(),
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
            Table::SetpointSignals => i64::from(self.setpoint_signal(element)),
            Table::ActualSignals => i64::from(self.actual_signal(element)),
            Table::SignalParameters => {
                let number = u16::try_from(element).unwrap_or(0);
                let known = SIGNALS.contains(&number)
                    && self
                        .model
                        .catalogue
                        .by_pnu(number)
                        .is_some_and(|parameter| parameter.name != "reserved");
                if known { i64::from(number) } else { 0 }
            }
            Table::FaultNumbers => i64::from(self.fault_number(u16::try_from(element).unwrap_or(u16::MAX))),
            Table::Identification => unit.get(element).copied().unwrap_or(0),
            // Type class 1 is an axis; application classes 1 and 3; the axis number that requests carry.
            Table::DriveObject => match element {
                5 => 1,
                6 => 0b101,
                _ => unit.get(element).copied().unwrap_or(0),
            },
            Table::Numbers(list) => {
                let Some(skip) = (element < PER_LIST).then(|| usize::from(list) * PER_LIST + element) else {
                    return 0;
                };
                let place = skip + usize::from(skip >= self.first_list) * LISTS.len();
                self.model
                    .catalogue
                    .parameters
                    .get(place)
                    .map_or(0, |parameter| i64::from(parameter.pnu))
            }
        }
    }

    /// Position of the first list of PNUs in the catalogue: the lists follow each other and do not name themselves.
    pub(super) fn first_list(model: &crate::model::Model) -> usize {
        model.catalogue.position(*LISTS.start()).unwrap_or(usize::MAX)
    }
}

/// Keeps the low bits that the size holds.
fn wrap(value: i64, parameter: &Parameter) -> i64 {
    match (parameter.size, parameter.signed) {
        (Size::Byte, true) => i64::from(value as i8),
        (Size::Byte, false) => i64::from(value as u8),
        (Size::Word | Size::Command, true) => i64::from(value as i16),
        (Size::Word | Size::Command, false) => i64::from(value as u16),
        (Size::Dword, true) => i64::from(value as i32),
        (Size::Dword, false) => i64::from(value as u32),
    }
}
