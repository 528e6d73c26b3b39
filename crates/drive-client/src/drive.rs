//! What kind of drive answers, and how it wants to be spoken to.

use profidrive::catalogue::{AKD, Catalogue, Parameter, Part, Scaling, VACON, VLT};
use profidrive::notation::Notation;
use profidrive::parameter::{Dialect, Saving};
use profidrive::state::{ControlWords, Mode};
use profidrive::telegram::Telegram;
use profinet::controller::Station;
use profinet::cyclic::Timing;
use uss::SlaveId;

use crate::Error;
use crate::line::Shape;
use crate::modules::MakerModule;
use crate::parameter::{ParameterProblem, Parameters, Selection};
use crate::session::format_of;

/// Record index of the parameter channel: base mode parameter access, global.
const GLOBAL_ACCESS: u16 = 0xB02F;
/// The same, local.
const LOCAL_ACCESS: u16 = 0xB02E;
/// API of the drive profile.
pub const PROFIDRIVE_API: u32 = 0x3A00;

/// What is known about a kind of drive before it is asked.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// Name for people.
    pub name: &'static str,
    /// Parameters, modules and faults, where there are tables.
    pub catalogue: Option<&'static Catalogue>,
    /// How parameter requests are written and answers read.
    pub dialect: &'static Dialect,
    /// API, slot, subslot and record index of the parameter channel.
    pub channel: Channel,
    /// Whose bits its control and status words have.
    pub words: ControlWords,
    /// The tables are what a drive told of itself: no more than its parameters is in them.
    pub learned: bool,
}

/// Where the parameter channel of a drive is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channel {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Record index.
    pub index: u16,
}

/// Every make there are tables of.
struct Make {
    tables: &'static Catalogue,
    dialect: &'static Dialect,
    /// Record of the parameter channel.
    record: u16,
    words: ControlWords,
    /// What PNU 964 index 1 tells makes the drive one of this model, whatever its device id is.
    told_by_unit: bool,
}

/// Source of the records: AKD manual 3.5; MG06G102 5.5; OPTEA manual p. 116. Source of the type of the drive unit: OPTEA
/// manual chapter 8, Vacon 100 is 2; the FC 302 has the number in its name, which is ours; that of an AKD is not known.
const MAKES: [Make; 3] = [
    Make {
        tables: &AKD,
        dialect: &Dialect::AKD,
        record: GLOBAL_ACCESS,
        words: ControlWords::PROFIDRIVE,
        told_by_unit: false,
    },
    Make {
        tables: &VLT,
        dialect: &Dialect::VLT,
        record: LOCAL_ACCESS,
        words: ControlWords::VLT,
        told_by_unit: true,
    },
    Make {
        tables: &VACON,
        dialect: &Dialect::VACON,
        record: LOCAL_ACCESS,
        words: ControlWords::VACON,
        told_by_unit: true,
    },
];

/// A drive nobody described: the profile's own way.
const STANDARD: Model = Model {
    name: "PROFIdrive",
    catalogue: None,
    dialect: &Dialect::STANDARD,
    channel: Channel {
        api: PROFIDRIVE_API,
        slot: 1,
        subslot: 1,
        index: LOCAL_ACCESS,
    },
    words: ControlWords::PROFIDRIVE,
    learned: false,
};

impl Model {
    /// The model that PNU 964 tells by its maker (index 0) and the type of the drive unit (index 1), where that type is
    /// known.
    ///
    /// ```
    /// use drive_client::Model;
    /// assert_eq!(Model::of_unit(0x01BA, 2).map(|model| model.name), Some("VACON"));
    /// assert!(Model::of_unit(0x01BA, 1).is_none() && Model::of_unit(0x0105, 1).is_none());
    /// ```
    #[must_use]
    pub fn of_unit(vendor_id: u16, unit_type: u16) -> Option<Self> {
        let mut told = MAKES.iter().filter(|make| make.told_by_unit);
        let found = told.find(|make| {
            let device = &make.tables.device;
            (device.vendor_id, device.drive_unit_type) == (vendor_id, unit_type)
        });
        found.map(Self::made)
    }

    /// What a person may call a model: see [`by_name`](Self::by_name).
    pub const NAMES: [&'static str; 4] = ["akd", "vlt", "vacon", "standard"];

    /// The model with this vendor and device. Of another device of a known maker the parameters are not known, but how
    /// they are asked for; of all others nothing but the profile.
    ///
    /// ```
    /// use drive_client::Model;
    /// assert_eq!(Model::of(0x0080, 0x0001).name, "VLT");
    /// let other = Model::of(0x0080, 0x7777);
    /// assert!(other.catalogue.is_none() && other.dialect.name == "VLT");
    /// assert_eq!(Model::of(0x1234, 1).name, "PROFIdrive");
    /// ```
    #[must_use]
    pub fn of(vendor_id: u16, device_id: u16) -> Self {
        let models = || MAKES.iter().map(Self::made);
        let known = models().find(|model| {
            let device = model.catalogue.map(|tables| &tables.device);
            device.is_some_and(|device| (device.vendor_id, device.device_id) == (vendor_id, device_id))
        });
        let maker = || {
            MAKES
                .iter()
                .find(|make| make.tables.device.vendor_id == vendor_id)
        };
        let relative = || {
            maker().map(|make| Self {
                name: make.tables.device.vendor,
                catalogue: None,
                ..Self::made(make)
            })
        };
        known.or_else(relative).unwrap_or(STANDARD)
    }

    /// The makers there are tables of.
    pub(crate) fn vendors() -> impl Iterator<Item = u16> {
        MAKES.iter().map(|make| make.tables.device.vendor_id)
    }

    /// The model that a person names, case does not matter: `akd`, `vlt`, `vacon`, or `standard` for the profile alone,
    /// without any tables.
    ///
    /// ```
    /// use drive_client::Model;
    /// assert_eq!(Model::by_name("VLT").map(|model| model.dialect.axis), Some(0));
    /// assert!(Model::NAMES.iter().all(|name| Model::by_name(name).is_some()));
    /// ```
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        if name.eq_ignore_ascii_case("standard") {
            return Some(STANDARD);
        }
        let make = MAKES
            .iter()
            .find(|make| make.tables.model.eq_ignore_ascii_case(name));
        make.map(Self::made)
    }

    /// `None` for a model with tables of its own; else the tables that were learned, if any.
    pub(crate) fn learned_or_none(&self) -> Option<Option<&'static Catalogue>> {
        match self.catalogue {
            Some(tables) => self.learned.then_some(Some(tables)),
            None => Some(None),
        }
    }

    fn made(make: &Make) -> Self {
        let tables = make.tables;
        Self {
            name: tables.model,
            catalogue: Some(tables),
            dialect: make.dialect,
            channel: Channel {
                api: tables.device.api.into(),
                slot: 1,
                subslot: tables.device.layout.parameters.subslot,
                index: make.record,
            },
            words: make.words,
            learned: false,
        }
    }

    /// What scales values as long as the drive was not asked: as delivered.
    #[must_use]
    pub fn scaling(&self) -> Scaling {
        self.catalogue.map_or(Scaling::DELIVERED, |tables| tables.scaling)
    }
}

/// A drive that was found.
#[derive(Debug, Clone)]
pub struct Drive {
    /// What it said about itself. At a serial line its name is how it is addressed, and it has no other address.
    pub station: Station,
    /// What is known about its kind.
    pub model: Model,
    /// Its parameters: tables, and the values that scale others.
    pub parameters: Parameters,
    /// True once the values that scale others were read from it.
    pub(crate) scaled: bool,
    /// The modules that a device description of its maker has for it; those of the tables where there are none.
    pub maker_modules: Vec<MakerModule>,
    /// The update times that this device description allows; empty where none was read.
    pub maker_timings: Vec<Timing>,
    /// Whether its device description declares connections for records (`DeviceAccessSupported`); `None` where there is
    /// no description, or it says nothing.
    pub device_access: Option<bool>,
    /// Where it is at a serial line.
    pub(crate) slave: Option<SlaveId>,
}

impl Drive {
    /// The parameter that a person means: `DRV.ACC`, `930`, `r947[0]`, `947[0..7]`, `0x3A2`.
    ///
    /// # Errors
    /// When the text is no parameter, or the drive has none of this name; the error knows the nearest names.
    pub fn select(&self, text: &str) -> Result<Selection, ParameterProblem> {
        self.parameters.select(&text.parse()?)
    }

    /// From what a station said about itself.
    #[must_use]
    pub fn new(station: Station) -> Self {
        let model = Model::of(station.vendor_id, station.device_id);
        Self {
            station,
            parameters: Parameters::of(&model),
            model,
            scaled: false,
            maker_modules: Vec::new(),
            maker_timings: Vec::new(),
            device_access: None,
            slave: None,
        }
    }

    /// The same drive, taken for this model whatever it says it is.
    #[must_use]
    pub fn taken_for(self, model: Model) -> Self {
        Self {
            parameters: Parameters::of(&model),
            model,
            scaled: false,
            ..self
        }
    }

    /// True for a drive at a serial line: it has parameters and process data, but no records, name or IP address.
    #[must_use]
    pub const fn is_on_line(&self) -> bool {
        self.slave.is_some()
    }

    /// Returns when the drive keeps a changed value of this parameter over a power cycle. At a serial line text is saved
    /// with every write: the channel has no request that changes text in RAM only.
    #[must_use]
    pub const fn saving(&self, parameter: &Parameter) -> Saving {
        if self.is_on_line() && parameter.is_text() {
            Saving::Always
        } else {
            self.model.dialect.saving
        }
    }

    /// What this drive calls the parameters that have these parts, as a person writes them; what its make has not is left
    /// out.
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

    /// The telegram of the process data: PNU 922 says it, but not at a serial line, whose telegram is always the same.
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

    /// At a serial line the channel tells only how wide a value is; the rest is in the tables.
    pub(crate) fn shape(&self, pnu: u16) -> Option<Shape> {
        let tables = self.model.catalogue?;
        let parameter = tables.by_pnu(pnu).or_else(|| tables.by_high(pnu));
        let parameter = parameter.or_else(|| tables.parameters.iter().find(|one| one.pnu == pnu))?;
        Some(Shape {
            collecting: tables.is_collecting(pnu),
            format: format_of(parameter, self.model.dialect),
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

    /// Name for people: the station name, else its address.
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
