//! What a controller expects a drive to have plugged, by the tables of its model.

use profile::catalogue::{Device, TelegramModule};
use profinet::controller::{ModuleConfig, SubmoduleConfig};

/// Ident number of an unknown module.
pub(crate) const UNKNOWN: u32 = 0;
/// Slot of the telegram and of parameter access, and the subslot that every drive has there.
pub(crate) const PLACE: (u16, u16) = (1, 1);

/// Slot and subslot of the telegram.
pub(crate) const fn place_of(device: &Device) -> (u16, u16) {
    (PLACE.0, device.layout.telegram)
}

/// The modules of a telegram as the vendor's device description of one drive has them, where no table is sure to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VendorModule {
    /// Number of the telegram, as in PNU 922.
    pub telegram: u16,
    /// Slot and subslot of its data.
    pub place: (u16, u16),
    /// What is in that slot, one for each application process.
    pub modules: Vec<ModuleConfig>,
}

impl VendorModule {
    /// Octets to the drive and from it.
    #[must_use]
    pub fn lengths(&self) -> (u16, u16) {
        let here = self.modules.iter().filter(|module| module.slot == self.place.0);
        let mut submodules = here.flat_map(|module| &module.submodules);
        submodules
            .find(|submodule| submodule.subslot == self.place.1)
            .map_or((0, 0), |data| (data.output_length, data.input_length))
    }
}

/// Slot 0 with its interface and ports, slot 1 with the module of a telegram, as the tables of a model have them.
///
/// ```
/// use profile::catalogue::AKD;
/// let telegram = AKD.device.telegram(1).unwrap();
/// let modules = profidrive_client::modules_of(&AKD.device, telegram);
/// assert_eq!(modules[1].ident, telegram.module);
///
/// // a VLT has two ports, and takes parameter jobs in a submodule of its own
/// use profile::catalogue::VLT;
/// let modules = profidrive_client::modules_of(&VLT.device, VLT.device.telegram(104).unwrap());
/// let idents: Vec<u32> = modules[1].submodules.iter().map(|submodule| submodule.ident).collect();
/// assert_eq!((modules[0].submodules.len(), idents), (4, vec![0xFFFF, 0x68]));
/// ```
#[must_use]
pub fn modules_of(device: &Device, telegram: &TelegramModule) -> Vec<ModuleConfig> {
    let (slot, subslot) = place_of(device);
    let submodule = |subslot, ident, input_length, output_length| SubmoduleConfig {
        subslot,
        ident,
        input_length,
        output_length,
    };
    let point = &device.layout.parameters;
    let data = submodule(subslot, telegram.submodule, telegram.inputs, telegram.outputs);
    let mut submodules: Vec<_> = point
        .submodule
        .map(|ident| submodule(point.subslot, ident, 0, 0))
        .into_iter()
        .chain([data])
        .collect();
    submodules.sort_by_key(|submodule| submodule.subslot);
    vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: device.access_point_module,
            submodules: device
                .access_point()
                .map(|(subslot, ident)| submodule(subslot, ident, 0, 0))
                .collect(),
        },
        ModuleConfig {
            api: device.api.into(),
            slot,
            ident: telegram.module,
            submodules,
        },
    ]
}
