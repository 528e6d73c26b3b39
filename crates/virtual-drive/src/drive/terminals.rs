//! Digital inputs: their levels, and the functions of their modes.
//!
//! Source: AKD Parameter Guide 12/2009, DINx.MODE, DINx.INV, DINx.PARAM, DINx.STATE.

use super::Drive;
use crate::model::{Action, InputFunction, Terminal};

/// The levels at the digital inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Terminals {
    /// Bit by number, from bit 0 for number 1.
    high: u32,
    /// An input commands the controlled stop.
    stops: bool,
    /// The fault that an input keeps up.
    fault: Option<u16>,
}

/// Bit of a number from 1 on.
fn bit(number: u8) -> u32 {
    let place = u32::from(number).wrapping_sub(1);
    1_u32.checked_shl(place).unwrap_or(0)
}

impl Terminals {
    /// Returns whether the level at this number is high.
    pub fn is_high(&self, number: u8) -> bool {
        self.high & bit(number) != 0
    }
}

impl Drive {
    /// A digital input gets a level. A number that the model has not is nothing.
    pub(super) fn set_terminal(&mut self, number: u8, high: bool) {
        let place = usize::from(number).checked_sub(1);
        let Some(terminal) = place.and_then(|place| self.model.terminals.get(place)) else {
            return;
        };
        let before = self.is_active(number, terminal);
        if high {
            self.terminals.high |= bit(number);
        } else {
            self.terminals.high &= !bit(number);
        }
        self.follow_levels();
        if self.is_active(number, terminal) && !before {
            self.obey_edge(terminal);
            self.apply();
        }
    }

    /// Returns whether the controlled stop is commanded from outside.
    pub(super) const fn is_stopped_by_input(&self) -> bool {
        self.external.controlled_stop || self.terminals.stops
    }

    /// What inputs do for as long as they are active: after a new level, and after a parameter has changed.
    pub(super) fn follow_levels(&mut self) {
        let (mut stops, mut fault) = (false, None);
        for (number, terminal) in (1_u8..).zip(self.model.terminals) {
            match self.function(terminal) {
                Some(function) if self.is_active(number, terminal) => match function {
                    InputFunction::ControlledStop => stops = true,
                    InputFunction::Fault(number) => fault = Some(number),
                    _ => {}
                },
                _ => {}
            }
        }
        self.terminals.stops = stops;
        if fault != self.terminals.fault {
            if let Some(gone) = core::mem::replace(&mut self.terminals.fault, fault) {
                self.end_cause(gone);
            }
            if let Some(number) = fault {
                self.raise_external(number, true);
            }
        }
    }

    /// Handles an input that becomes active. A function that is impossible now is skipped; motion reports it by its
    /// warnings.
    fn obey_edge(&mut self, terminal: &Terminal) {
        match self.function(terminal) {
            Some(InputFunction::ClearFaults) => self.clear_faults(),
            Some(InputFunction::StartTask) if self.positioning.waits_for_event() => self.motion_event(),
            Some(InputFunction::StartTask) => {
                let number = self.argument(terminal);
                // As delivered it names no task: 0 is the one that MDI fills.
                if number > 0 {
                    let _ = self.move_task(number);
                }
            }
            Some(InputFunction::Home) => {
                let _ = self.start_homing();
            }
            Some(InputFunction::Stop) => {
                let _ = self.execute(Action::Stop);
            }
            Some(InputFunction::ControlledStop | InputFunction::Fault(_)) | None => {}
        }
    }

    fn function(&self, terminal: &Terminal) -> Option<InputFunction> {
        let mode = self.values.get(terminal.mode);
        let mut functions = self.model.input_functions.iter();
        functions
            .find(|(known, _)| *known == mode)
            .map(|(_, function)| *function)
    }

    fn is_active(&self, number: u8, terminal: &Terminal) -> bool {
        self.terminals.is_high(number) != (self.values.get(terminal.inverted) == 1)
    }

    fn argument(&self, terminal: &Terminal) -> i64 {
        let raw = self.values.get(terminal.argument);
        let parameter = self.model.catalogue.by_pnu(terminal.argument);
        parameter.map_or(0.0, |parameter| {
            parameter.engineering(raw, &self.settings.scaling.kept())
        }) as i64
    }
}
