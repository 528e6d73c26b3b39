//! What writing a parameter does.

use std::time::Duration;

use profile::catalogue::{Access, Parameter, Part};

use profile::parameter::ErrorNumber;
use profile::telegram::{Direction, signal};

use super::reading::MODE_CURRENT;
use super::{Drive, Event, Service};
use crate::model::{Action, Live, Table, numbered};

impl Drive {
    /// Writes the number of one element as on the wire (sign included); `position` is the place in the catalogue.
    ///
    /// The order of the checks: known, subindex, read-only, factory set-up, state, limits, permitted value.
    pub(super) fn set_element(&mut self, position: usize, element: u16, raw: i64) -> Result<(), ErrorNumber> {
        let parameter = self.parameter_with(position, element)?;
        if parameter.access == Access::ReadOnly {
            return Err(ErrorNumber::NOT_CHANGEABLE);
        }
        self.check_factory_set_up(position, element)?;
        match self.live.get(position).copied().unwrap_or(Live::Stored) {
            Live::Do(action) => self.execute(action)?,
            Live::Same(other) => self.write_same(parameter, other, raw)?,
            Live::Mode => {
                self.within_limits(parameter, raw)?;
                self.set_mode(position, raw)?;
            }
            Live::OperatingMode => {
                let mode = match raw {
                    1 | 2 => raw,
                    MODE_CURRENT if self.model.number(Part::ControlMode).is_some() => 0,
                    _ => return Err(ErrorNumber::VALUE),
                };
                let position = self.model.number(Part::ControlMode);
                let position = position.and_then(|pnu| numbered(self.model.catalogue, pnu));
                self.set_mode(position.ok_or(ErrorNumber::NOT_NOW)?, mode)?;
            }
            Live::Telegram => {
                let number = u16::try_from(raw).map_err(|_| ErrorNumber::VALUE)?;
                self.set_telegram(number)?;
                self.values.set_at(position, raw);
            }
            // Values that a controller sends cannot be set by others.
            Live::Setpoint | Live::Through(_) if self.is_commanded(parameter.pnu) => {
                return Err(ErrorNumber::NOT_NOW);
            }
            Live::Setpoint => {
                self.within_limits(parameter, raw)?;
                self.take_setpoint(parameter.pnu, None, raw);
            }
            Live::Through(other) => {
                self.write_same(parameter, other, raw)?;
                self.process.set_signal(parameter.pnu, raw);
            }
            Live::ClearTask => self.clear_task(raw)?,
            Live::StartTask => self.move_task(raw)?,
            Live::Array(Table::SetpointSignals) => {
                let number = u16::try_from(raw).map_err(|_| ErrorNumber::VALUE)?;
                self.map_signal(Direction::Setpoint, element, number)?;
            }
            Live::Array(Table::SetpointWords | Table::ActualWords) => {
                self.choose_word(position, element, raw)?;
            }
            Live::Array(Table::WideWords) => {
                let word = u16::try_from(raw).map_err(|_| ErrorNumber::LIMIT)?;
                let place = self.wide_word(element.into()).ok_or(ErrorNumber::NOT_NOW)?;
                self.set_element(place, 0, word.into())?;
            }
            Live::ControlWord => return Err(ErrorNumber::NOT_NOW),
            Live::Signal(number) => {
                if self.is_commanded(number) {
                    return Err(ErrorNumber::NOT_NOW);
                }
                self.within_limits(parameter, raw)?;
                self.take_setpoint(number, None, raw);
            }
            Live::SpeedReference => {
                if self.is_commanded(signal::NSOLL_A) {
                    return Err(ErrorNumber::NOT_NOW);
                }
                self.within_limits(parameter, raw)?;
                let part = parameter.engineering(raw, &self.settings.scaling) / 100.0;
                let inverter = self.settings.inverter.as_ref();
                let speed = inverter.map_or(0.0, |inverter| inverter.speed_of_range(part));
                self.take_setpoint(signal::NSOLL_A, None, self.number_of_speed(speed));
            }
            Live::FaultSituations => {
                if raw != 0 {
                    return Err(ErrorNumber::RESET_ONLY);
                }
                self.faults.forget();
            }
            Live::Choose(values, action) if values.contains(&raw) => self.execute(action)?,
            Live::CopySetUp if (1..=4).contains(&raw) => self.copy_set_up(raw as u8)?,
            Live::CopySetUp if raw == 9 => self.copy_set_up(0)?,
            Live::Choose(..) | Live::CopySetUp => {
                if !parameter.choices.is_empty() && parameter.choice(raw).is_none() {
                    return Err(ErrorNumber::VALUE);
                }
            }
            Live::Array(Table::ActualSignals) => {
                let number = u16::try_from(raw).map_err(|_| ErrorNumber::VALUE)?;
                self.map_signal(Direction::Actual, element, number)?;
            }
            Live::Absent if raw == 0 => {}
            // a command or a procedure without effect in a virtual drive
            live if live == Live::Absent || parameter.access == Access::WriteOnly => {
                if live == Live::Absent {
                    self.within_limits(parameter, raw)?;
                }
                self.emit(Event::Unable { pnu: parameter.pnu });
                return Err(ErrorNumber::NOT_NOW);
            }
            _ => {
                self.within_limits(parameter, raw)?;
                if !parameter.choices.is_empty() && parameter.choice(raw).is_none() {
                    return Err(ErrorNumber::VALUE);
                }
                let kept = self.kept_number(parameter, raw);
                self.store(position, element, kept)?;
            }
        }
        self.apply();
        Ok(())
    }

    /// Chooses the parameter of a process data word (VLT 9-15 and 9-16). The first two words are fixed.
    fn choose_word(&mut self, position: usize, element: u16, raw: i64) -> Result<(), ErrorNumber> {
        if element < 2 {
            return Err(ErrorNumber::NOT_CHANGEABLE);
        }
        let actual = matches!(self.live.get(position), Some(Live::Array(Table::ActualWords)));
        let number = u16::try_from(raw).map_err(|_| ErrorNumber::VALUE)?;
        let fits = self.model.numbered(number).is_some_and(|chosen| {
            let plain = chosen.length == 0 && !chosen.is_array();
            plain && (actual || chosen.access == Access::ReadWrite)
        });
        if number != 0 && !fits {
            return Err(ErrorNumber::VALUE);
        }
        self.values.set_element_at(position, element, raw);
        Ok(())
    }

    pub(super) fn within_limits(&self, parameter: &Parameter, raw: i64) -> Result<(), ErrorNumber> {
        let (low, high) = self.own_limits(parameter);
        if (low..=high).contains(&raw) {
            Ok(())
        } else {
            Err(ErrorNumber::LIMIT)
        }
    }

    fn set_mode(&mut self, position: usize, raw: i64) -> Result<(), ErrorNumber> {
        let same = self.values.at(position) == raw;
        if self.is_enabled() && !same {
            return Err(ErrorNumber::NOT_NOW);
        }
        self.values.set_at(position, raw);
        Ok(())
    }

    /// Executes a command.
    pub(super) fn execute(&mut self, action: Action) -> Result<(), ErrorNumber> {
        match action {
            Action::Enable => {
                let by_service = !self.settings.commanded_by_bus && !self.is_controlled_by_bus();
                if self.has_fault() || !by_service {
                    return Err(ErrorNumber::NOT_NOW);
                }
                self.service = Service::Starting;
            }
            Action::Disable => self.request_disable(),
            Action::Stop => {
                self.stop_requested = self.is_enabled();
                self.stop_positioning();
                if let Some(pnu) = self.model.number(Part::ServiceSpeed) {
                    self.values.set(pnu, 0);
                }
            }
            Action::SetTask => self.set_task()?,
            Action::LoadTask => self.load_task()?,
            Action::ContinueTask => self.continue_task()?,
            Action::Home => self.start_homing()?,
            Action::SetHome => self.set_home()?,
            Action::ClearFaults => self.clear_faults(),
            Action::Save => self.save(),
            Action::Load => self.load()?,
            Action::Defaults => self.defaults()?,
            Action::ResetEnergy => self.meter.energy = 0.0,
            Action::ResetRunningTime => self.meter.running = Duration::ZERO,
            Action::Blink => self.emit(Event::Blink),
            Action::Restart => self.emit(Event::Restart),
            Action::ApplyAddress => {
                if self.link.is_cyclic() {
                    return Err(ErrorNumber::NOT_NOW);
                }
                self.emit(Event::ApplyAddress);
            }
            Action::Nothing => {}
        }
        Ok(())
    }
}
