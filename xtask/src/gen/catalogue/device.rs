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
    #[serde(default)]
    layout: Layout,
    #[serde(default)]
    scaling: Scaling,
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
    #[serde(default = "one")]
    ports: u8,
    min_device_interval: u16,
}

fn one() -> u8 {
    1
}

/// What is in slot 1; by default all in subslot 1, in one submodule.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Layout {
    telegram_subslot: u16,
    parameter_subslot: u16,
    parameter_submodule: Option<u32>,
    records: Vec<Records>,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            telegram_subslot: 1,
            parameter_subslot: 1,
            parameter_submodule: None,
            records: Vec::new(),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Records {
    subslot: u16,
    octets: u8,
}

/// What scales values in a drive as delivered.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Scaling {
    /// rpm at 100 % of the speed setpoint.
    reference: Option<f64>,
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
    /// Module and submodule ident where the vendor's are known.
    module: Option<u32>,
    submodule: Option<u32>,
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

/// Returns the scaling of a drive as delivered, as Rust.
pub fn render_scaling(device: &DeviceFile) -> String {
    match device.scaling.reference {
        Some(reference) => format!("Scaling::of_reference({reference:?})"),
        None => "Scaling::DELIVERED".to_owned(),
    }
}

/// Module and submodule ident of a telegram where the vendor's is unknown: ours, one rule for all.
const TELEGRAM_IDENT: u32 = 0x0001_0000;

/// Identity, modules and telegrams as Rust.
pub fn render(device: &DeviceFile) -> String {
    let identity = &device.identity;
    let point = &device.access_point;
    let mut modules = String::new();
    for telegram in &device.telegram {
        let ident = TELEGRAM_IDENT + u32::from(telegram.number);
        modules.push_str(&format!(
            "TelegramModule {{ telegram: {}, module: {:#010x}, submodule: {:#010x}, outputs: {}, inputs: {}, \
             words: Words {{ english: {:?}, german: {:?} }} }},",
            telegram.number,
            telegram.module.unwrap_or(ident),
            telegram.submodule.unwrap_or(ident),
            telegram.outputs,
            telegram.inputs,
            telegram.english,
            telegram.german
        ));
    }
    let layout = &device.layout;
    let records: Vec<String> = layout
        .records
        .iter()
        .map(|view| {
            format!(
                "RecordView {{ subslot: {}, octets: {} }}",
                view.subslot, view.octets
            )
        })
        .collect();
    let records_used = if records.is_empty() { "" } else { "RecordView, " };
    format!(
        "use crate::catalogue::{{DescriptionFacts, Device, Layout, ParameterPoint, {records_used}TelegramModule, \
         Words}};\n\n\
         pub static DEVICE: Device = Device {{ vendor_id: {:#06x}, device_id: {:#06x}, vendor: {:?}, station_type: {:?}, \
         order_id: {:?}, hardware_revision: {}, software_revision: {:?}, api: {:#06x}, drive_unit_type: {}, \
         firmware_year: {}, firmware_day_month: {}, access_point_module: {}, access_point_submodule: {}, \
         interface_submodule: {}, port_submodule: {}, ports: {}, \
         layout: Layout {{ telegram: {}, parameters: ParameterPoint {{ subslot: {}, submodule: {:?} }}, \
         records: &[{}] }}, min_device_interval: {}, telegrams: &[{modules}], \
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
        point.ports,
        layout.telegram_subslot,
        layout.parameter_subslot,
        layout.parameter_submodule,
        records.join(", "),
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
