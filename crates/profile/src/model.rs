//! Facts about a drive model: one row for each model, used by virtual drives and clients.

use crate::catalogue::{self, Catalogue, Scaling};
use crate::parameter::Dialect;
use crate::pkw::PkwDialect;
use crate::state::{ControlWords, Zsw1};

/// Record index of the parameter channel: base mode parameter access, global.
const GLOBAL_ACCESS: u16 = 0xB02F;
/// The same, local.
const LOCAL_ACCESS: u16 = 0xB02E;
/// A model without such a bit in its status word.
const NO_BIT: Zsw1 = Zsw1(0);
/// API of the drive profile.
pub const PROFIDRIVE_API: u32 = 0x3A00;

/// Facts about a drive model that are available before the first request.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// Name for people.
    pub name: &'static str,
    /// Name to be typed: see [`by_name`](Self::by_name).
    pub key: &'static str,
    /// Vendor and name.
    pub title: &'static str,
    /// Parameters, modules and faults, where there are tables.
    pub catalogue: Option<&'static Catalogue>,
    /// How parameter requests are written and answers read.
    pub dialect: &'static Dialect,
    /// API, slot, subslot and record index of the parameter channel.
    pub channel: Channel,
    /// The rules of the parameter channel in cyclic words, where it has one.
    pub pkw: Option<&'static PkwDialect>,
    /// Whose bits its control and status words have.
    pub words: ControlWords,
    /// Bits of ZSW1 that report a running traversing task; none where the model has no such bit.
    pub task_active: Zsw1,
    /// True when PNU 964 index 1 identifies this model, whatever the device id.
    pub identified_by_unit: bool,
    /// The tables were read from a drive: they hold its parameters and nothing else.
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

impl Channel {
    const fn of(tables: &Catalogue, index: u16) -> Self {
        Self {
            api: tables.device.api as u32,
            slot: 1,
            subslot: tables.device.layout.parameters.subslot,
            index,
        }
    }
}

/// Kollmorgen AKD. The type of its drive unit is not known. Source of the record: AKD manual 3.5.
pub static AKD: Model = Model {
    name: catalogue::AKD.model,
    key: "akd",
    title: "Kollmorgen AKD",
    catalogue: Some(&catalogue::AKD),
    dialect: &Dialect::AKD,
    channel: Channel::of(&catalogue::AKD, GLOBAL_ACCESS),
    pkw: None,
    words: ControlWords::PROFIDRIVE,
    task_active: Zsw1::TASK_ACTIVE,
    identified_by_unit: false,
    learned: false,
};

/// Danfoss VLT FC 302. The type of its drive unit is ours. Source of the record: MG06G102 5.5.
pub static VLT: Model = Model {
    name: catalogue::VLT.model,
    key: "vlt",
    title: "Danfoss VLT FC 302",
    catalogue: Some(&catalogue::VLT),
    dialect: &Dialect::VLT,
    channel: Channel::of(&catalogue::VLT, LOCAL_ACCESS),
    pkw: Some(&PkwDialect::DANFOSS_PPO),
    words: ControlWords::VLT,
    task_active: NO_BIT,
    identified_by_unit: true,
    learned: false,
};

/// Vacon 100 with an OPTEA board. Source: OPTEA manual p. 116 (record), chapter 8 (type of the drive unit).
pub static VACON: Model = Model {
    name: catalogue::VACON.model,
    key: "vacon",
    title: "Vacon 100",
    catalogue: Some(&catalogue::VACON),
    dialect: &Dialect::VACON,
    channel: Channel::of(&catalogue::VACON, LOCAL_ACCESS),
    pkw: None,
    words: ControlWords::VACON,
    task_active: NO_BIT,
    identified_by_unit: true,
    learned: false,
};

/// A drive without tables: the profile's own rules.
pub static STANDARD: Model = Model {
    name: "PROFIdrive",
    key: "standard",
    title: "PROFIdrive",
    catalogue: None,
    dialect: &Dialect::STANDARD,
    channel: Channel {
        api: PROFIDRIVE_API,
        slot: 1,
        subslot: 1,
        index: LOCAL_ACCESS,
    },
    pkw: None,
    words: ControlWords::PROFIDRIVE,
    task_active: NO_BIT,
    identified_by_unit: false,
    learned: false,
};

/// Every model with tables.
pub static ALL: [&Model; 3] = [&AKD, &VLT, &VACON];

/// Every model with its tables.
fn with_tables() -> impl Iterator<Item = (&'static Model, &'static Catalogue)> {
    ALL.into_iter()
        .filter_map(|model| Some((model, model.catalogue?)))
}

/// Returns the first model whose tables fit.
fn first(fits: impl Fn(&Model, &Catalogue) -> bool) -> Option<(&'static Model, &'static Catalogue)> {
    with_tables().find(|(model, tables)| fits(model, tables))
}

impl Model {
    /// What [`by_name`](Self::by_name) accepts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        ALL.into_iter().chain([&STANDARD]).map(|model| model.key)
    }

    /// Returns the model that PNU 964 identifies by its vendor (index 0) and the type of the drive unit (index 1),
    /// where that type is known.
    ///
    /// ```
    /// use profidrive_profile::model::Model;
    /// assert_eq!(Model::of_unit(0x01BA, 2).map(|model| model.name), Some("VACON"));
    /// assert!(Model::of_unit(0x01BA, 1).is_none() && Model::of_unit(0x0105, 1).is_none());
    /// ```
    #[must_use]
    pub fn of_unit(vendor_id: u16, unit_type: u16) -> Option<Self> {
        let found = first(|model, tables| {
            let device = &tables.device;
            model.identified_by_unit && (device.vendor_id, device.drive_unit_type) == (vendor_id, unit_type)
        });
        found.map(|(model, _)| *model)
    }

    /// Returns the model with this vendor and device. Of another device of a known vendor the parameters are not known,
    /// but the dialect is; of all others nothing but the profile.
    ///
    /// ```
    /// use profidrive_profile::model::Model;
    /// assert_eq!(Model::of(0x0080, 0x0001).name, "VLT");
    /// let other = Model::of(0x0080, 0x7777);
    /// assert!(other.catalogue.is_none() && other.dialect.name == "VLT");
    /// assert_eq!(Model::of(0x1234, 1).name, "PROFIdrive");
    /// ```
    #[must_use]
    pub fn of(vendor_id: u16, device_id: u16) -> Self {
        let known =
            first(|_, tables| (tables.device.vendor_id, tables.device.device_id) == (vendor_id, device_id));
        if let Some((model, _)) = known {
            return *model;
        }
        let of_vendor = first(|_, tables| tables.device.vendor_id == vendor_id);
        of_vendor.map_or(STANDARD, |(model, tables)| Self {
            name: tables.device.vendor,
            catalogue: None,
            ..*model
        })
    }

    /// Returns the VendorIDs of the models with tables.
    pub fn vendors() -> impl Iterator<Item = u16> {
        with_tables().map(|(_, tables)| tables.device.vendor_id)
    }

    /// Returns the model that a person names, case does not matter: `akd`, `vlt`, `vacon`, or `standard` for the
    /// profile alone, without any tables.
    ///
    /// ```
    /// use profidrive_profile::model::Model;
    /// assert_eq!(Model::by_name("VLT").map(|model| model.dialect.axis), Some(0));
    /// assert!(Model::names().all(|name| Model::by_name(name).is_some()));
    /// ```
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        let mut models = ALL.into_iter().chain([&STANDARD]);
        models.find(|model| model.key.eq_ignore_ascii_case(name)).copied()
    }

    /// `None` for a model with built-in tables; else the tables that were read from the drive, if any.
    #[must_use]
    pub fn learned_or_none(&self) -> Option<Option<&'static Catalogue>> {
        match self.catalogue {
            Some(tables) => self.learned.then_some(Some(tables)),
            None => Some(None),
        }
    }

    /// Returns the scaling as delivered, which holds until the one of the drive was read.
    #[must_use]
    pub fn scaling(&self) -> Scaling {
        self.catalogue.map_or(Scaling::DELIVERED, |tables| tables.scaling)
    }
}
