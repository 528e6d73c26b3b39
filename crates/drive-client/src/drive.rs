//! What kind of drive answers, and how it wants to be spoken to.

use profidrive::catalogue::{AKD, Catalogue, Scaling};
use profidrive::parameter::Dialect;
use profinet::controller::Station;

use crate::parameter::{ParameterProblem, Parameters, Selection};

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

const AKD_MODEL: Model = Model {
    name: "AKD",
    catalogue: Some(&AKD),
    dialect: &Dialect::AKD,
    channel: Channel {
        api: PROFIDRIVE_API,
        slot: 1,
        subslot: 1,
        index: GLOBAL_ACCESS,
    },
};

/// A drive nobody described: the profile's own way.
const STANDARD_MODEL: Model = Model {
    name: "PROFIdrive",
    catalogue: None,
    dialect: &Dialect::STANDARD,
    channel: Channel {
        api: PROFIDRIVE_API,
        slot: 1,
        subslot: 1,
        index: LOCAL_ACCESS,
    },
};

impl Model {
    /// The model with this vendor and device, the standard one for all others.
    #[must_use]
    pub const fn of(vendor_id: u16, device_id: u16) -> Self {
        if vendor_id == AKD.device.vendor_id && device_id == AKD.device.device_id {
            AKD_MODEL
        } else {
            STANDARD_MODEL
        }
    }
}

/// A drive that was found.
#[derive(Debug, Clone)]
pub struct Drive {
    /// What it said about itself.
    pub station: Station,
    /// What is known about its kind.
    pub model: Model,
    /// Its parameters: tables, and the values that scale others.
    pub parameters: Parameters,
    /// True once the values that scale others were read from it.
    pub(crate) scaled: bool,
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
        let parameters = Parameters {
            catalogue: model.catalogue,
            scaling: Scaling::default(),
        };
        Self {
            station,
            model,
            parameters,
            scaled: false,
        }
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
