//! What an observer of the simulation sees of a drive, beside what the bus carries.

use profile::catalogue::Parameter;

use super::Drive;
use super::settings::Mode;

/// More than the faults or warnings that a drive has room for.
const MOST: usize = 64;

impl Drive {
    /// Returns the numbers of the faults that are not acknowledged.
    pub fn active_faults(&self) -> impl Iterator<Item = u16> {
        (0..MOST)
            .map(|place| self.faults.active(place))
            .take_while(|number| *number != 0)
    }

    /// Returns the numbers of the warnings that are present.
    pub fn active_warnings(&self) -> impl Iterator<Item = u16> {
        (0..MOST)
            .map(|place| self.faults.warning(place))
            .take_while(|number| *number != 0)
    }

    /// Returns true while the axis turns faster than its standstill window.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        !self.axis.is_standing(self.settings.standstill)
    }

    /// Returns true in position mode, in which bits 10 and 11 of the status word are those of positioning.
    #[must_use]
    pub fn is_positioning(&self) -> bool {
        self.settings.mode == Mode::Position
    }

    /// Returns one element of a parameter of the model as it reads now, in the unit of the parameter; `None` for one
    /// that cannot be read.
    #[must_use]
    pub fn reported(&self, parameter: &'static Parameter, element: u16) -> Option<f64> {
        let parameters = self.model.catalogue.parameters;
        let position = parameters.iter().position(|row| core::ptr::eq(row, parameter))?;
        let raw = self.element(position, element).ok()?;
        Some(parameter.engineering(raw, &self.settings.scaling))
    }
}
