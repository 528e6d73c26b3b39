//! A drive: its model, its address and its dialect.

use profile::catalogue::{Parameter, Part};
use profile::model::Model;
use profile::notation::Notation;
use profile::parameter::Saving;
use profile::state::{Mode, Profile, Stw1};
use profile::telegram::Telegram;
use profile::value::{ParameterProblem, Parameters, Selection};
use profinet::Instant;
use profinet::controller::Station;
use profinet::cyclic::Timing;
use uss::SlaveId;

use crate::line::Shape;
use crate::modules::VendorModule;
use crate::{Action, Error};

/// Returns true where a control word can request this jog: [`Stw1::JOG_1`] or [`Stw1::JOG_2`].
pub(crate) fn has_jog(words: Profile, jog: Stw1) -> bool {
    words.control(Stw1(Stw1::RUN.0 | jog.0)) != words.control(Stw1::RUN)
}

/// A drive that was found.
#[derive(Debug, Clone)]
pub struct Drive {
    /// What it reported about itself. At a serial line its name is how it is addressed, and it has no other address.
    pub station: Station,
    /// What is known about its kind.
    pub model: Model,
    /// Its parameters: tables, and the values that scale others.
    pub parameters: Parameters,
    /// When the values that scale others were read from it; `None` where that has to be done again.
    pub(crate) scaled_at: Option<Instant>,
    /// The modules that a device description of its vendor has for it; those of the tables where there are none.
    pub vendor_modules: Vec<VendorModule>,
    /// The update times that this device description allows; empty where none was read.
    pub vendor_timings: Vec<Timing>,
    /// Whether its device description declares connections for records (`DeviceAccessSupported`); `None` where there is
    /// no description, or it says nothing.
    pub device_access: Option<bool>,
    /// Where it is at a serial line.
    pub(crate) slave: Option<SlaveId>,
}

impl Drive {
    /// Returns the parameter that a person means: `DRV.ACC`, `930`, `r947[0]`, `947[0..7]`, `0x3A2`.
    ///
    /// # Errors
    /// When the text is not a parameter, or the drive has none of this name; the error contains the nearest names.
    pub fn select(&self, text: &str) -> Result<Selection, ParameterProblem> {
        self.parameters.select(&text.parse()?)
    }

    /// Creates a drive from a discovered station.
    #[must_use]
    pub fn new(station: Station) -> Self {
        let model = Model::of(station.vendor_id, station.device_id);
        Self {
            station,
            parameters: Parameters::of(&model),
            model,
            scaled_at: None,
            vendor_modules: Vec::new(),
            vendor_timings: Vec::new(),
            device_access: None,
            slave: None,
        }
    }

    /// Returns the same drive as this model, independent of its identification.
    #[must_use]
    pub fn as_model(self, model: Model) -> Self {
        Self {
            parameters: Parameters::of(&model),
            model,
            scaled_at: None,
            ..self
        }
    }

    /// Returns true for a drive at a serial line: it has parameters and process data, but no records, name or IP
    /// address.
    #[must_use]
    pub const fn is_on_line(&self) -> bool {
        self.slave.is_some()
    }

    /// Returns the condition under which the drive saves a changed value of this parameter. At a serial line text is
    /// saved with every write: the channel has no request that changes text in RAM only.
    #[must_use]
    pub const fn saving(&self, parameter: &Parameter) -> Saving {
        if self.is_on_line() && parameter.is_text() {
            Saving::Always
        } else {
            self.model.dialect.saving
        }
    }

    /// Returns this drive's names of the parameters that have these parts, as a person writes them; a part that its
    /// model does not have is left out.
    #[must_use]
    pub fn named(&self, parts: &[Part]) -> Vec<String> {
        let tables = self.model.catalogue;
        let known = parts.iter().filter_map(|&part| tables?.part(part));
        let notation = self.parameters.notation();
        let name = |parameter: &'static Parameter| match notation {
            Notation::Name => parameter.name.to_owned(),
            _ => Selection::of(parameter, notation).shown(0).to_string(),
        };
        known.map(name).collect()
    }

    /// Returns the actions that move its axis in this mode (PNU 930) by these control words, as far as its tables say: each
    /// is one that the drive can do. `homed` is bit 11 of ZSW1 in position mode: without a home position there is no move.
    #[must_use]
    pub fn motions(&self, mode: Option<Mode>, homed: bool, words: Profile) -> Vec<Action> {
        let tables = self.model.catalogue;
        // at a serial line there is a speed setpoint and no position
        let positions = !self.is_on_line()
            && tables.is_some_and(|tables| !self.model.learned && tables.device.positions());
        let part = |part| tables.is_some_and(|tables| tables.part(part).is_some());
        let motions = [
            (Action::Run, mode != Some(Mode::Position)),
            (
                Action::Move,
                positions && mode != Some(Mode::Velocity) && (homed || mode.is_none()),
            ),
            (Action::Home, positions && mode == Some(Mode::Position) && !homed),
            (
                Action::Jog,
                has_jog(words, Stw1::JOG_1) && (part(Part::Jog1) || part(Part::JogOnly)),
            ),
        ];
        let can = motions.into_iter().filter(|(_, can)| *can);
        can.map(|(action, _)| action).collect()
    }

    /// Says whether the drive can do what needs this mode, as far as its telegrams are known.
    ///
    /// # Errors
    /// When it has no positions and this needs them.
    pub fn check_able(&self, needed: Option<Mode>) -> Result<(), Error> {
        let known = self.model.catalogue.filter(|_| !self.model.learned);
        match known {
            Some(tables) if needed == Some(Mode::Position) && !tables.device.positions() => {
                Err(Error::SpeedOnly {
                    drive: self.label(),
                    model: tables.model,
                })
            }
            _ => Ok(()),
        }
    }

    /// Returns the telegram of the process data: that of PNU 922, except on a serial line, whose telegram is always the
    /// same.
    pub(crate) fn telegram_in_use(&self, reported: Option<u16>) -> Option<u16> {
        if self.is_on_line() {
            Telegram::of_line(self.station.vendor_id).map(|telegram| telegram.number)
        } else {
            reported
        }
    }

    /// Returns the mode that decides over the bits of the control and status word, from PNU 930 and the number of the
    /// telegram in use.
    #[must_use]
    pub fn word_mode(&self, operating_mode: Option<i64>, telegram: Option<u16>) -> Mode {
        let telegram = telegram.and_then(|number| Telegram::find(number, self.station.vendor_id));
        Mode::of(operating_mode, telegram)
    }

    /// Returns the shape of a parameter. On a serial line the channel reports only the width of a value; the rest is in
    /// the tables.
    pub(crate) fn shape(&self, pnu: u16) -> Option<Shape> {
        let tables = self.model.catalogue?;
        let parameter = tables.by_pnu(pnu).or_else(|| tables.by_high(pnu));
        let parameter = parameter.or_else(|| tables.parameters.iter().find(|one| one.pnu == pnu))?;
        Some(Shape {
            collecting: tables.is_collecting(pnu),
            format: parameter.format_in(self.model.dialect),
            octets: parameter.size.octets(),
            characters: parameter.length.into(),
            array: parameter.is_array(),
        })
    }

    /// Increments in one turn of MDI_TARPOS and XIST_A, as far as the scaling was read.
    #[must_use]
    pub fn counts_per_turn(&self) -> f64 {
        2_f64.powi(i32::from(self.parameters.scaling.singleturn_bits.min(32)))
    }

    /// Returns the name for people: the station name, else its address.
    #[must_use]
    pub fn label(&self) -> String {
        if !self.station.name.is_empty() {
            self.station.name.clone()
        } else if self.station.ip.is_set() {
            self.station.ip.address.to_string()
        } else {
            self.station.mac.to_string()
        }
    }
}
