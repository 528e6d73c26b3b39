//! A device that is not a drive.

use profinet::MacAddress;
use profinet::device::{Device, DeviceConfig, Identity, ModuleDescription, Stored, SubmoduleDescription};

/// Remote inputs and outputs: identity, modules, nothing of the drive profile. Behind them come further modules, each with
/// an application process of its own.
pub fn remote_io(mac: MacAddress, stored: Stored, further: u16) -> Device {
    let submodule = |subslot, ident, input_length, output_length| SubmoduleDescription {
        subslot,
        ident,
        api: 0,
        input_length,
        output_length,
    };
    let module = |ident, slot, submodules| ModuleDescription {
        ident,
        slots: vec![slot],
        submodules,
    };
    let mut modules = vec![
        module(
            0x10,
            0,
            vec![
                submodule(1, 1, 0, 0),
                submodule(0x8000, 2, 0, 0),
                submodule(0x8001, 3, 0, 0),
            ],
        ),
        module(0x21, 1, vec![submodule(1, 0x22, 2, 0)]),
        module(0x31, 2, vec![submodule(1, 0x32, 0, 2)]),
    ];
    for slot in 3..3 + further {
        let own = SubmoduleDescription {
            api: slot.into(),
            ..submodule(1, 0x42, 0, 0)
        };
        modules.push(module(0x41, slot, vec![own]));
    }
    let identity = Identity {
        vendor_id: 0x0999,
        device_id: 7,
        instance: 1,
        station_type: "terminal".into(),
        order_id: "RIO-16".into(),
        serial_number: "4711".into(),
        hardware_revision: 2,
        software_prefix: 'V',
        software_revision: [1, 2, 3],
        profile_id: 0,
        profile_specific_type: 0,
    };
    let mut config = DeviceConfig::new(mac, identity, modules);
    config.max_device_access = 0;
    Device::new(config, stored)
}
