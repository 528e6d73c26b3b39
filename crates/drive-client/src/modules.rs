//! What a controller expects a drive to have plugged, by the tables of its model.

use profidrive::catalogue::{Device, TelegramModule};
use profinet::controller::{ModuleConfig, SubmoduleConfig};

/// Slot and subslot of the telegram.
pub(crate) const PLACE: (u16, u16) = (1, 1);

/// Slot 0 with its interface and port, slot 1 with the module of a telegram, as the tables of a model have them.
///
/// ```
/// use profidrive::catalogue::AKD;
/// let telegram = AKD.device.telegram(1).unwrap();
/// let modules = drive_client::modules_of(&AKD.device, telegram);
/// assert_eq!(modules[1].ident, telegram.module);
/// ```
#[must_use]
pub fn modules_of(device: &Device, telegram: &TelegramModule) -> Vec<ModuleConfig> {
    let (slot, subslot) = PLACE;
    let submodule = |subslot, ident, input_length, output_length| SubmoduleConfig {
        subslot,
        ident,
        input_length,
        output_length,
    };
    vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: device.access_point_module,
            submodules: vec![
                submodule(1, device.access_point_submodule, 0, 0),
                submodule(0x8000, device.interface_submodule, 0, 0),
                submodule(0x8001, device.port_submodule, 0, 0),
            ],
        },
        ModuleConfig {
            api: device.api.into(),
            slot,
            ident: telegram.module,
            submodules: vec![submodule(
                subslot,
                telegram.submodule,
                telegram.inputs,
                telegram.outputs,
            )],
        },
    ]
}
