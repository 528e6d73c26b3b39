//! From a description to the configuration of the PROFINET device.

use profinet::device::DeviceConfig;

use super::StationConfig;

/// Identity, modules and limits.
pub(crate) fn device_config(config: &StationConfig) -> DeviceConfig {
    let description = &config.description;
    let identity = description.identity_of(config.mac);
    DeviceConfig {
        follow_controller: config.follow_controller,
        min_device_interval: config
            .min_device_interval
            .unwrap_or(description.min_device_interval),
        reset_modes: description.reset_modes.clone(),
        ..DeviceConfig::new(config.mac, identity, description.modules())
    }
}
