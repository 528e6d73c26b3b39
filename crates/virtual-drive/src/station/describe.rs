//! From a description to the configuration of the PROFINET device.

use profinet::device::DeviceConfig;

use super::StationConfig;

/// Identity, modules and limits.
pub(crate) fn device_config(config: &StationConfig) -> DeviceConfig {
    let description = &config.description;
    let identity = description.identity_of(config.mac);
    let usual = DeviceConfig::new(config.mac, identity, description.modules());
    DeviceConfig {
        max_device_access: if description.device_access {
            usual.max_device_access
        } else {
            0
        },
        refusals: config.refusals,
        follow_controller: config.follow_controller,
        refuses_in_operation: config.refuses_in_operation,
        min_device_interval: config
            .min_device_interval
            .unwrap_or(description.min_device_interval),
        reset_modes: description.reset_modes.clone(),
        output_frame_ids: config.model.wire.output_frame_ids,
        max_alarm_data: config.model.wire.max_alarm_data,
        always_listed: config.model.wire.always_listed.to_vec(),
        ready_order: config.model.wire.ready_order,
        ready_arguments: config.model.wire.ready_arguments,
        ..usual
    }
}
