//! From the facts of a model to the configuration of its PROFINET device.

use profinet::MacAddress;
use profinet::device::{DeviceConfig, Identity, ModuleDescription, ResetMode, SubmoduleDescription};

use super::{SLOT, SUBSLOT, StationConfig};

/// Subslots of the interface and of the first port in slot 0.
const INTERFACE: u16 = 0x8000;
const PORT: u16 = 0x8001;

/// Identity, modules and limits.
pub(super) fn device_config(config: &StationConfig) -> DeviceConfig {
    let device = &config.model.catalogue.device;
    let identity = Identity {
        vendor_id: device.vendor_id,
        device_id: device.device_id,
        instance: 1,
        station_type: device.station_type.to_owned(),
        order_id: device.order_id.to_owned(),
        serial_number: serial_number(config.mac),
        hardware_revision: device.hardware_revision,
        software_prefix: 'V',
        software_revision: device.software_revision,
        profile_id: device.api,
        profile_specific_type: 0,
    };
    let plain = |subslot, ident| SubmoduleDescription {
        subslot,
        ident,
        api: 0,
        input_length: 0,
        output_length: 0,
    };
    let mut modules = vec![ModuleDescription {
        ident: device.access_point_module,
        slots: vec![0],
        submodules: vec![
            plain(1, device.access_point_submodule),
            plain(INTERFACE, device.interface_submodule),
            plain(PORT, device.port_submodule),
        ],
    }];
    modules.extend(device.telegrams.iter().map(|telegram| ModuleDescription {
        ident: telegram.module,
        slots: vec![SLOT],
        submodules: vec![SubmoduleDescription {
            subslot: SUBSLOT,
            ident: telegram.submodule,
            api: u32::from(device.api),
            input_length: telegram.inputs,
            output_length: telegram.outputs,
        }],
    }));
    DeviceConfig {
        follow_controller: config.follow_controller,
        min_device_interval: config.min_device_interval.unwrap_or(device.min_device_interval),
        reset_modes: vec![
            ResetMode::ApplicationData,
            ResetMode::Communication,
            ResetMode::AllStored,
            ResetMode::Device,
        ],
        ..DeviceConfig::new(config.mac, identity, modules)
    }
}

/// The last three octets of the Ethernet address make the serial number.
fn serial_number(mac: MacAddress) -> String {
    let [_, _, _, a, b, c] = mac.0;
    format!("V-{a:02X}{b:02X}{c:02X}")
}
