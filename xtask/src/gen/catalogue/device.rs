//! Identity, modules and telegrams of a model on the field bus: its `device.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use crate::Outcome;

/// `device.toml` of a model.
#[derive(Deserialize)]
pub struct DeviceFile {
    identity: Identity,
    access_point: AccessPoint,
    description: Description,
    telegram: Vec<TelegramModule>,
    /// What a parameter is delivered with where that depends on the size of the drive, by name.
    pub values: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct Identity {
    vendor_id: u16,
    device_id: u16,
    vendor: String,
    station_type: String,
    order_id: String,
    hardware_revision: u16,
    software_revision: [u8; 3],
    profile_id: u16,
    drive_unit_type: u16,
    firmware_year: u16,
    firmware_day_month: u16,
}

#[derive(Deserialize)]
struct AccessPoint {
    module: u32,
    submodule: u32,
    interface_submodule: u32,
    port_submodule: u32,
    min_device_interval: u16,
}

#[derive(Deserialize)]
struct Description {
    date: u32,
    family: String,
    product_family: String,
    dns_name: String,
    name: String,
    english: String,
    german: String,
    conformance_class: String,
    netload_class: String,
    protocols: Vec<String>,
    port_rx_delay: u16,
    port_tx_delay: u16,
}

#[derive(Deserialize)]
struct TelegramModule {
    number: u16,
    english: String,
    german: String,
    outputs: u16,
    inputs: u16,
}

impl DeviceFile {
    /// Reads `root/file`.
    pub fn read(root: &Path, file: &str) -> Outcome<Self> {
        let text = std::fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))?;
        toml::from_str(&text).map_err(|error| format!("{file}: {error}").into())
    }
}

/// Module and submodule ident of a telegram: ours, one rule for all.
const TELEGRAM_IDENT: u32 = 0x0001_0000;

/// Identity, modules and telegrams as Rust.
pub fn render(device: &DeviceFile) -> String {
    let identity = &device.identity;
    let point = &device.access_point;
    let mut modules = String::new();
    for telegram in &device.telegram {
        let ident = TELEGRAM_IDENT + u32::from(telegram.number);
        modules.push_str(&format!(
            "TelegramModule {{ telegram: {}, module: {ident:#010x}, submodule: {ident:#010x}, outputs: {}, inputs: {}, \
             words: Words {{ english: {:?}, german: {:?} }} }},",
            telegram.number, telegram.outputs, telegram.inputs, telegram.english, telegram.german
        ));
    }
    format!(
        "use crate::catalogue::{{DescriptionFacts, Device, TelegramModule, Words}};\n\n\
         pub static DEVICE: Device = Device {{ vendor_id: {:#06x}, device_id: {:#06x}, vendor: {:?}, station_type: {:?}, \
         order_id: {:?}, hardware_revision: {}, software_revision: {:?}, api: {:#06x}, drive_unit_type: {}, \
         firmware_year: {}, firmware_day_month: {}, access_point_module: {}, access_point_submodule: {}, \
         interface_submodule: {}, port_submodule: {}, min_device_interval: {}, telegrams: &[{modules}], \
         description: {} }};\n",
        identity.vendor_id,
        identity.device_id,
        identity.vendor,
        identity.station_type,
        identity.order_id,
        identity.hardware_revision,
        identity.software_revision,
        identity.profile_id,
        identity.drive_unit_type,
        identity.firmware_year,
        identity.firmware_day_month,
        point.module,
        point.submodule,
        point.interface_submodule,
        point.port_submodule,
        point.min_device_interval,
        render_description(&device.description),
    )
}

fn render_description(facts: &Description) -> String {
    format!(
        "DescriptionFacts {{ date: {}, family: {:?}, product_family: {:?}, dns_name: {:?}, name: {:?}, \
         words: Words {{ english: {:?}, german: {:?} }}, conformance_class: {:?}, netload_class: {:?}, \
         protocols: &{:?}, port_rx_delay: {}, port_tx_delay: {} }}",
        facts.date,
        facts.family,
        facts.product_family,
        facts.dns_name,
        facts.name,
        facts.english,
        facts.german,
        facts.conformance_class,
        facts.netload_class,
        facts.protocols,
        facts.port_rx_delay,
        facts.port_tx_delay,
    )
}
