//! What makes one drive model differ from another: tables, and nothing that runs.
//!
//! A model is a catalogue (the tables from `data/`) and what no table has: motor and load, what it watches, particulars of
//! its process data and of PROFINET. Which parameters take effect, are measured or trigger an action, are the parts
//! of the catalogue ([`Part`]), the same rows that a client reads. The behaviour itself is the same for all models and lives
//! in [`crate::drive`].

mod akd;
mod akd_conditions;
mod condition;
mod converter;
mod live;
mod meaning;
mod process;
mod terminal;
mod vacon;
mod vlt;

pub use akd::AKD;
pub use condition::{Cause, Condition, Delay, Limit, When};
pub use converter::{Converter, RampTo};
pub use live::{Action, Bit, Live, Place, Quantity, Sensor, Table};
pub use process::{Chosen, ControlTimeout, Lost, ProcessFacts, Signals, TimeoutAction, Wire};
pub use terminal::{InputFunction, Terminal};
pub use vacon::VACON;
pub use vlt::VLT;

use std::sync::OnceLock;

use profile::catalogue::{Catalogue, Parameter, Part, PartNumbers};
use profile::fault::Shape;
use profile::telegram::signal;

use crate::axis::Plant;

/// Most conditions a model can have.
pub const MOST_CONDITIONS: usize = 32;

/// Every model: a virtual drive for each one of [`profile::model::ALL`].
pub static ALL: [&Model; 3] = [&AKD, &VLT, &VACON];

/// The model with this name, case does not matter.
///
/// ```
/// use profidrive_virtual_drive::model;
/// assert_eq!(model::by_name("vlt").unwrap().catalogue.model, "VLT");
/// assert!(model::by_name("sinamics").is_none());
/// ```
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Model> {
    ALL.into_iter()
        .find(|model| model.known.key.eq_ignore_ascii_case(name))
}

/// A drive model.
#[derive(Debug, Clone)]
pub struct Model {
    /// Its parameters, faults and modules.
    pub catalogue: &'static Catalogue,
    /// Numbers of the parameters by their parts.
    pub numbers: PartNumbers,
    /// Digital inputs, from number 1 on.
    pub terminals: &'static [Terminal],
    /// What they do by their modes; a mode that is not here does nothing.
    pub input_functions: &'static [(i64, InputFunction)],
    /// Particulars of a frequency converter; none for a servo drive.
    pub converter: Option<Converter>,
    /// Motor and load of the virtual drive.
    pub plant: Plant,
    /// Facts that clients also use: dialect of its parameter manager, parameter channel, control words.
    pub known: &'static profile::model::Model,
    /// What its process data are.
    pub process: ProcessFacts,
    /// What is particular about it on PROFINET.
    pub wire: Wire,
    /// What it watches, and the numbers that come of it; at most [`MOST_CONDITIONS`].
    pub conditions: &'static [Condition],
    /// Fault raised when the controller is lost.
    pub connection_lost_fault: u16,
    /// When that is a fault.
    pub connection_lost: Lost,
    /// Shape of its fault buffer.
    pub fault_buffer: Shape,
    /// Value of PNU 965: profile 3, version 41.
    pub profile: u16,
    /// What follows from the tables, made by the first drive and shared by all: `OnceLock::new()`.
    pub derived: OnceLock<Derived>,
}

/// What follows from the tables of a model.
#[derive(Debug, Clone)]
pub struct Derived {
    /// What each parameter is, by position in the catalogue.
    live: Box<[Live]>,
    /// Every number, ascending, without those of the lists of numbers.
    numbers: Box<[u16]>,
}

/// Returns the index in the catalogue of the parameter with this number of its vendor: a PNU, or an application id of a
/// Vacon.
#[must_use]
pub fn numbered(catalogue: &Catalogue, number: u16) -> Option<usize> {
    let (pnu, base) = catalogue.meant(number, None);
    catalogue
        .place(pnu, base.unwrap_or_default())
        .map(|(position, _)| position)
}

impl Model {
    /// Returns the parameter with this number of its vendor.
    #[must_use]
    pub fn numbered(&self, number: u16) -> Option<&'static Parameter> {
        self.catalogue.parameters.get(numbered(self.catalogue, number)?)
    }

    /// The number of the parameter that has this part.
    #[must_use]
    pub fn number(&self, part: Part) -> Option<u16> {
        self.numbers.get(part)
    }

    /// The parameter at this place of the catalogue cannot be changed while the power stage is on.
    #[must_use]
    pub fn is_only_stopped(&self, position: usize) -> bool {
        let mut rows = self.catalogue.parts.iter();
        rows.any(|row| {
            row.part == Part::OnlyStopped && numbered(self.catalogue, row.number()) == Some(position)
        })
    }

    /// Number of the parameter that a signal is, as its vendor counts.
    #[must_use]
    pub fn number_of_signal(&self, signal: u16) -> Option<u16> {
        let parts = match self.process.signals {
            Signals::Numbers => return Some(signal),
            Signals::Parts => match signal {
                signal::STW1 => [Part::ControlWordSignal, Part::ControlWord],
                signal::ZSW1 => [Part::StatusWordSignal, Part::StatusWord],
                signal::NSOLL_A => [Part::SpeedSetpoint; 2],
                signal::NIST_A => [Part::SpeedActual; 2],
                signal::vacon::DW_PDI6 | signal::vacon::DW_PDI7 | signal::vacon::DW_PDI8 => {
                    [Part::WideWords; 2]
                }
                _ => return None,
            },
        };
        parts.into_iter().find_map(|part| self.number(part))
    }

    /// Where in the catalogue the parameter is that a signal is.
    #[must_use]
    pub fn position_of_signal(&self, signal: u16) -> Option<usize> {
        numbered(self.catalogue, self.number_of_signal(signal)?)
    }
}
