//! What a virtual drive is on its field bus: identity, modules and ident numbers.
//!
//! Made from the tables of a model ([`Description::of`]) or from a vendor's device description
//! ([`Description::from_gsdml`]), so that a project engineered for the real drive connects to the virtual one. The same
//! tables make the device description of the virtual drive ([`export::export`]): what the file says and what the device
//! answers have one source.

pub mod export;
mod import;
mod mapping;
mod picture;
#[cfg(test)]
mod tests;

pub use import::{Import, ImportError};

use profinet::MacAddress;
use profinet::device::{Identity, ModuleDescription, ResetMode, SubmoduleDescription};

use crate::model::Model;

/// Subslot of the interface in slot 0; its ports follow.
const INTERFACE: u16 = 0x8000;
/// Slot of the telegram in our own modules.
const SLOT: u16 = 1;
/// Longest telegram of any model, in octets.
pub(crate) const LONGEST_TELEGRAM: u16 = 64;

/// Identity and modules of a virtual drive.
///
/// ```
/// use profidrive_virtual_drive::description::Description;
/// use profidrive_virtual_drive::model;
/// let description = Description::of(&model::AKD);
/// assert_eq!(description.identity.vendor_id, 0x0105);
/// let telegram = description.telegrams.iter().find(|module| module.telegram == 353).unwrap();
/// assert_eq!(telegram.data().map(|data| (data.output_length, data.input_length)), Some((26, 10)));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// Who it is. The serial number is left empty: each drive has its own.
    pub identity: Identity,
    /// Variants of slot 0; the controller's project chooses.
    pub access_points: Vec<ModuleDescription>,
    /// Modules that carry a telegram; the controller's project chooses.
    pub telegrams: Vec<TelegramModule>,
    /// Further modules without cyclic data.
    pub others: Vec<ModuleDescription>,
    /// Application process identifier of the drive.
    pub api: u32,
    /// Shortest update time in steps of 31.25 us.
    pub min_device_interval: u16,
    /// Resets by DCP.
    pub reset_modes: Vec<ResetMode>,
    /// Accepts connections for record access (ARType 6) beside its controller.
    pub device_access: bool,
}

/// A module with a telegram in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TelegramModule {
    /// Number of the telegram, as in PNU 922.
    pub telegram: u16,
    /// The module with all its submodules.
    pub module: ModuleDescription,
    /// Slot it is plugged in.
    pub slot: u16,
    /// Subslot with the cyclic data.
    pub subslot: u16,
}

impl TelegramModule {
    /// Returns the submodule with the cyclic data.
    #[must_use]
    pub fn data(&self) -> Option<&SubmoduleDescription> {
        self.module
            .submodules
            .iter()
            .find(|submodule| submodule.subslot == self.subslot)
    }

    /// Octets of the setpoints and of the actual values.
    #[must_use]
    pub fn lengths(&self) -> (u16, u16) {
        self.data()
            .map_or((0, 0), |data| (data.output_length, data.input_length))
    }
}

impl Description {
    /// Returns the description from the tables of a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let device = &model.catalogue.device;
        let plain = |subslot, ident| SubmoduleDescription {
            subslot,
            ident,
            api: 0,
            input_length: 0,
            output_length: 0,
        };
        let layout = &device.layout;
        let api = u32::from(device.api);
        let telegrams = device.telegrams.iter().map(|telegram| {
            let data = SubmoduleDescription {
                subslot: layout.telegram,
                ident: telegram.submodule,
                api,
                input_length: telegram.inputs,
                output_length: telegram.outputs,
            };
            let point = layout.parameters.submodule.map(|ident| SubmoduleDescription {
                api,
                ..plain(layout.parameters.subslot, ident)
            });
            let mut submodules: Vec<_> = point.into_iter().chain([data]).collect();
            submodules.sort_by_key(|submodule| submodule.subslot);
            TelegramModule {
                telegram: telegram.telegram,
                module: ModuleDescription {
                    ident: telegram.module,
                    slots: vec![SLOT],
                    submodules,
                },
                slot: SLOT,
                subslot: layout.telegram,
            }
        });
        Self {
            identity: Identity {
                vendor_id: device.vendor_id,
                device_id: device.device_id,
                instance: 1,
                station_type: device.station_type.to_owned(),
                order_id: device.order_id.to_owned(),
                serial_number: String::new(),
                hardware_revision: device.hardware_revision,
                software_prefix: 'V',
                software_revision: device.software_revision,
                profile_id: device.api,
                profile_specific_type: 0,
            },
            access_points: vec![ModuleDescription {
                ident: device.access_point_module,
                slots: vec![0],
                submodules: device
                    .access_point()
                    .map(|(subslot, ident)| plain(subslot, ident))
                    .collect(),
            }],
            telegrams: telegrams.collect(),
            others: Vec::new(),
            api: u32::from(device.api),
            min_device_interval: device.min_device_interval,
            reset_modes: vec![
                ResetMode::ApplicationData,
                ResetMode::Communication,
                ResetMode::AllStored,
                ResetMode::Device,
            ],
            device_access: true,
        }
    }

    /// Every module that can be plugged: those of slot 0 first, then the others, then the telegrams.
    pub(crate) fn modules(&self) -> Vec<ModuleDescription> {
        let telegrams = self.telegrams.iter().map(|telegram| &telegram.module);
        let modules = self.access_points.iter().chain(&self.others).chain(telegrams);
        modules.cloned().collect()
    }

    /// Returns the telegram of what is plugged, found by requesting the module of a slot.
    pub(crate) fn plugged<'a>(
        &'a self,
        module_of: impl Fn(u16) -> Option<&'a ModuleDescription>,
    ) -> Option<&'a TelegramModule> {
        self.telegrams
            .iter()
            .find(|telegram| module_of(telegram.slot) == Some(&telegram.module))
    }

    /// Returns the identity of one drive: the last three octets of its Ethernet address make the serial number.
    pub(crate) fn identity_of(&self, mac: MacAddress) -> Identity {
        let [_, _, _, a, b, c] = mac.0;
        Identity {
            serial_number: format!("V-{a:02X}{b:02X}{c:02X}"),
            ..self.identity.clone()
        }
    }
}
