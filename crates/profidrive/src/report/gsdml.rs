//! What the verbs report about device descriptions.

use std::collections::BTreeMap;

use serde::Serialize;

/// Files that were written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlExportReport {
    /// The files.
    pub files: Vec<String>,
}

/// What is against the rules in a device description.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlCheckReport {
    /// The file.
    pub file: String,
    /// Whether nothing is against the rules.
    pub sound: bool,
    /// Whether the file can be used.
    pub usable: bool,
    /// What was found.
    pub problems: Vec<GsdmlProblem>,
    /// Problems that were found and are not listed.
    pub left_out: usize,
    /// What is wrong with the pictures beside the file.
    pub pictures: Vec<String>,
}

/// Something that is against the rules.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlProblem {
    /// `warning`, `error` or `unusable`.
    pub severity: &'static str,
    /// Name of the rule.
    pub rule: &'static str,
    /// Line in the file, from 1.
    pub line: u32,
    /// Column in the line, from 1.
    pub column: u32,
    /// What is wrong.
    pub message: String,
}

/// A device description.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlShowReport {
    /// Version of GSDML; null where the file does not name one.
    pub schema_version: Option<String>,
    /// VendorID.
    pub vendor_id: u16,
    /// DeviceID.
    pub device_id: u16,
    /// Name of the vendor.
    pub vendor: String,
    /// What the device is.
    pub info: String,
    /// Main family: `Drives`.
    pub main_family: String,
    /// Product family.
    pub product_family: Option<String>,
    /// The access points.
    pub access_points: Vec<GsdmlAccessPoint>,
    /// The modules of all access points.
    pub modules: Vec<GsdmlModule>,
    /// Texts of the primary language by their identifiers.
    pub texts: BTreeMap<String, String>,
    /// The same of all other languages, by their tags.
    pub languages: BTreeMap<String, BTreeMap<String, String>>,
}

/// An access point: a variant of the device on the network.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlAccessPoint {
    /// Identifier in the file.
    pub id: String,
    /// Name.
    pub name: String,
    /// Order number.
    pub order_number: Option<String>,
    /// Hardware release.
    pub hardware: Option<String>,
    /// Software release.
    pub software: Option<String>,
    /// Ident number.
    pub module_ident: u32,
    /// Slots: `0..2`.
    pub slots: String,
    /// Shortest update time, in steps of 31.25 us.
    pub min_device_interval: u16,
    /// Instance of the device.
    pub instance: u16,
    /// Modes of a reset to factory values.
    pub reset_modes: String,
    /// Most octets of input data.
    pub max_input: u16,
    /// Most octets of output data.
    pub max_output: u16,
    /// Its own submodules.
    pub submodules: Vec<GsdmlSubmodule>,
    /// The submodule of its interface.
    pub interface: Option<GsdmlSystemSubmodule>,
    /// The submodules of its ports.
    pub ports: Vec<GsdmlSystemSubmodule>,
    /// Conformance class: `A`, `B` or `C`.
    pub conformance_class: Option<String>,
    /// Identifiers of the modules that fit.
    pub modules: Vec<String>,
    /// Classes of real-time communication.
    pub rt_classes: Vec<String>,
    /// Modes of start-up.
    pub start_up: Vec<String>,
    /// Other protocols: `SNMP`, `LLDP`.
    pub protocols: Vec<String>,
}

/// A submodule that PROFINET defines: the interface or a port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlSystemSubmodule {
    /// Its subslot, from 0x8000.
    pub subslot: u16,
    /// Ident number.
    pub ident: u32,
}

/// A module.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlModule {
    /// Identifier in the file.
    pub id: String,
    /// Name.
    pub name: String,
    /// Ident number.
    pub ident: u32,
    /// What it is.
    pub info: String,
    /// Slots where it may be.
    pub slots: String,
    /// Its submodules.
    pub submodules: Vec<GsdmlSubmodule>,
}

/// A submodule. What the system defines, interface and ports, has no identifier and no name.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlSubmodule {
    /// Identifier in the file.
    pub id: Option<String>,
    /// Name.
    pub name: Option<String>,
    /// Subslots where it may be.
    pub subslots: String,
    /// Whether it can be left out.
    pub pluggable: bool,
    /// Ident number.
    pub ident: u32,
    /// API, 0x3A00 for PROFIdrive.
    pub api: u32,
    /// Octets of input data.
    pub input: u32,
    /// Octets of output data.
    pub output: u32,
    /// The input data.
    pub input_items: Vec<GsdmlItem>,
    /// The output data.
    pub output_items: Vec<GsdmlItem>,
}

/// A value in cyclic data.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlItem {
    /// Data type.
    #[serde(rename = "type")]
    pub data_type: String,
    /// Length in octets.
    pub octets: u32,
    /// Name.
    pub name: String,
}
