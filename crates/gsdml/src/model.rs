//! Types for the contents of a device description.
//!
//! Source: GSDML of PROFIBUS & PROFINET International, schema versions 2.x. Names are those of the elements and
//! attributes; where two versions say the same thing in two ways, the newer one.

use alloc::string::String;
use alloc::vec::Vec;

use crate::data::IoData;
use crate::text::{TextId, Texts};
use crate::value::{SchemaVersion, ValueList};

/// A whole device description.
#[derive(Debug, Clone, PartialEq)]
pub struct Gsdml {
    /// Version of the schema it is written in, from `xsi:schemaLocation`; `None` when that does not contain it.
    pub schema_version: Option<SchemaVersion>,
    /// Who makes the device.
    pub identity: DeviceIdentity,
    /// Where it stands in a catalogue.
    pub family: Family,
    /// Variants of the device, at least one.
    pub access_points: Vec<AccessPoint>,
    /// Modules that can be plugged.
    pub modules: Vec<Module>,
    /// Submodules that can be plugged into modules.
    pub submodules: Vec<Submodule>,
    /// Value texts of parameters.
    pub values: Vec<ValueItem>,
    /// Texts of diagnoses.
    pub channel_diagnoses: Vec<ChannelDiagnosis>,
    /// Pictures.
    pub graphics: Vec<Graphic>,
    /// Categories of a catalogue.
    pub categories: Vec<Category>,
    /// All texts, in all languages.
    pub texts: Texts,
}

/// `DeviceIdentity`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceIdentity {
    /// Number of the vendor, given by PI.
    pub vendor_id: u16,
    /// Number of the device, given by the vendor.
    pub device_id: u16,
    /// What it is.
    pub info: Option<TextId>,
    /// Name of the vendor.
    pub vendor: String,
}

/// `DeviceFunction/Family`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Family {
    /// One of the families of the standard, for example `Drives`.
    pub main: String,
    /// The vendor's own name.
    pub product: Option<String>,
}

/// The families of the standard.
pub const MAIN_FAMILIES: [&str; 15] = [
    "General",
    "Drives",
    "Switching Devices",
    "I/O",
    "Valves",
    "Controllers",
    "HMI",
    "Encoders",
    "NC/RC",
    "Gateway",
    "PLCs",
    "Ident Systems",
    "PA Profiles",
    "Network Components",
    "Sensors",
];

/// `ModuleInfo`: name, order number and releases of a device, module or submodule.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModuleInfo {
    /// Name in the catalogue.
    pub name: Option<TextId>,
    /// What it is.
    pub info: Option<TextId>,
    /// Name of the vendor.
    pub vendor: Option<String>,
    /// Order number.
    pub order_number: Option<String>,
    /// Hardware release.
    pub hardware: Option<String>,
    /// Software release.
    pub software: Option<String>,
    /// Category of the catalogue.
    pub category: Option<String>,
}

/// `DeviceAccessPointItem`: one variant of the device, slot 0.
#[derive(Debug, Clone, PartialEq)]
pub struct AccessPoint {
    /// Identifier in this file.
    pub id: String,
    /// Name, order number and releases.
    pub info: ModuleInfo,
    /// ModuleIdentNumber of slot 0.
    pub module_ident: u32,
    /// Version of PROFINET it is made for.
    pub pnio_version: Option<SchemaVersion>,
    /// Oldest schema a reader must support to use it.
    pub required_schema: Option<SchemaVersion>,
    /// Slots it has.
    pub physical_slots: ValueList,
    /// Slots of the access point itself; 0 if absent.
    pub fixed_in_slots: ValueList,
    /// Shortest update time, in steps of 31.25 us.
    pub min_device_interval: u16,
    /// Name of station proposed by tools.
    pub dns_name: Option<String>,
    /// Instance in the object UUID.
    pub object_instance: u16,
    /// What the device can do.
    pub features: Features,
    /// Ways to get an address, `DCP` first of all.
    pub address_assignment: Vec<String>,
    /// Reset modes of DCP.
    pub reset_modes: ValueList,
    /// Connections for record access at once; none if absent.
    pub device_access_ars: Option<u16>,
    /// Longest record in octets; none if absent.
    pub max_record: Option<u32>,
    /// Certificate.
    pub certification: Option<Certification>,
    /// Names of subslots.
    pub subslots: Vec<SubslotName>,
    /// Most octets of cyclic data.
    pub io_limits: IoLimits,
    /// Modules that fit.
    pub modules: Vec<ModuleRef>,
    /// Submodules that are always there.
    pub virtual_submodules: Vec<Submodule>,
    /// Interface submodule, where the file has one (from version 2.1 on).
    pub interface: Option<Interface>,
    /// Port submodules.
    pub ports: Vec<Port>,
    /// Submodules that can be plugged into slot 0.
    pub submodules: Vec<SubmoduleRef>,
    /// Pictures.
    pub graphics: Vec<GraphicRef>,
}

/// Yes-or-no attributes of an access point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Features {
    /// `MultipleWriteSupported`: several records in one call.
    pub multiple_write: bool,
    /// `CheckDeviceID_Allowed`: a controller may compare the device number.
    pub check_device_id: bool,
    /// `NameOfStationNotTransferable`.
    pub name_not_transferable: bool,
    /// `LLDP_NoD_Supported`: names its ports in the newer form.
    pub lldp_nod: bool,
    /// `DeviceAccessSupported`: connections for record access; none if absent, which means no.
    pub device_access: Option<bool>,
    /// `SharedDeviceSupported`.
    pub shared_device: bool,
    /// `SharedInputSupported`.
    pub shared_input: bool,
}

/// `CertificationInfo`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Certification {
    /// `ConformanceClass`: A, B or C.
    pub conformance_class: String,
    /// `ApplicationClass`, for example `FunctionalSafety`; empty for none.
    pub application_class: Vec<String>,
    /// `NetloadClass`: I, II or III.
    pub netload_class: Option<String>,
}

/// `SubslotItem`: name of a subslot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SubslotName {
    /// Its number.
    pub number: u16,
    /// Its name.
    pub text: TextId,
}

/// `IOConfigData`: most octets of cyclic data, each with its IOPS and IOCS.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IoLimits {
    /// From the device.
    pub input: u16,
    /// To the device.
    pub output: u16,
    /// Both together; the sum if absent.
    pub both: Option<u16>,
}

/// `ModuleItemRef`: where a module fits.
#[derive(Debug, Clone, PartialEq)]
pub struct ModuleRef {
    /// Identifier of the module.
    pub target: String,
    /// Where it may be plugged.
    pub allowed: ValueList,
    /// Where it is plugged unless the user takes it out.
    pub used: ValueList,
    /// Where it always is.
    pub fixed: ValueList,
}

/// `SubmoduleItemRef`: where a submodule fits.
#[derive(Debug, Clone, PartialEq)]
pub struct SubmoduleRef {
    /// Identifier of the submodule.
    pub target: String,
    /// Where it may be plugged.
    pub allowed: ValueList,
    /// Where it is plugged unless the user takes it out.
    pub used: ValueList,
    /// Where it always is.
    pub fixed: ValueList,
}

/// `ModuleItem`.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Identifier in this file.
    pub id: String,
    /// ModuleIdentNumber, not 0.
    pub ident: u32,
    /// Name, order number and releases.
    pub info: ModuleInfo,
    /// Subslots it has, if listed in the file.
    pub physical_subslots: ValueList,
    /// Names of subslots.
    pub subslots: Vec<SubslotName>,
    /// Submodules that can be plugged.
    pub submodules: Vec<SubmoduleRef>,
    /// Submodules that are always there.
    pub virtual_submodules: Vec<Submodule>,
    /// Pictures.
    pub graphics: Vec<GraphicRef>,
}

/// `VirtualSubmoduleItem` and `SubmoduleItem`.
#[derive(Debug, Clone, PartialEq)]
pub struct Submodule {
    /// Identifier in this file.
    pub id: String,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Application process identifier; 0x3A00 for PROFIdrive.
    pub api: u32,
    /// Subslots where a virtual submodule is; 1 if absent.
    pub fixed_in_subslots: ValueList,
    /// `MayIssueProcessAlarm`.
    pub process_alarms: bool,
    /// I&M records that can be written.
    pub writable_im: ValueList,
    /// Name, order number and releases.
    pub info: Option<ModuleInfo>,
    /// Cyclic data.
    pub io: IoData,
    /// Records with parameters for the start.
    pub records: Vec<ParameterRecord>,
    /// Pictures.
    pub graphics: Vec<GraphicRef>,
}

/// `InterfaceSubmoduleItem`.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// Identifier in this file.
    pub id: String,
    /// Subslot, 0x8000 for the first interface.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Name.
    pub text: Option<TextId>,
    /// Real-time classes as `RT_CLASS_1`.
    pub rt_classes: Vec<String>,
    /// Protocols beside PROFINET, for example `SNMP`, `LLDP`.
    pub protocols: Vec<String>,
    /// `DCP_HelloSupported`.
    pub dcp_hello: bool,
    /// `PTP_BoundarySupported`.
    pub ptp_boundary: bool,
    /// `DCP_BoundarySupported`.
    pub dcp_boundary: bool,
    /// Controllers at once.
    pub ars: u16,
    /// Start-up modes: `Legacy`, `Advanced`; `Legacy` if absent.
    pub start_up: Vec<String>,
    /// Send clocks in steps of 31.25 us; 32 if absent.
    pub send_clocks: ValueList,
    /// Reduction ratios; 1 to 512 if absent.
    pub reduction_ratios: ValueList,
}

/// `PortSubmoduleItem`.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Identifier in this file.
    pub id: String,
    /// Subslot, 0x8001 for the first port.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Name.
    pub text: Option<TextId>,
    /// Longest delay of a received frame in ns.
    pub rx_delay: Option<u16>,
    /// Longest delay of a sent frame in ns.
    pub tx_delay: Option<u16>,
    /// Kinds of line, 16 for 100BASE-TX full duplex.
    pub mau_types: Vec<u16>,
}

/// `ParameterRecordDataItem`: a record written before data is exchanged.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRecord {
    /// Index of the record.
    pub index: u16,
    /// Octets.
    pub length: u16,
    /// Order among the records of the submodule; 0 for any.
    pub sequence: u16,
    /// Name.
    pub name: Option<TextId>,
    /// Octets that never change or that the parameters lie in.
    pub constants: Vec<Constant>,
    /// Parameters inside.
    pub parameters: Vec<ParameterRef>,
    /// How tools group the parameters.
    pub menus: Vec<Menu>,
}

/// `Const`: octets of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Constant {
    /// First octet.
    pub offset: u16,
    /// The octets.
    pub data: Vec<u8>,
}

/// `Ref`: a parameter inside a record.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRef {
    /// Identifier, where menus name it.
    pub id: Option<String>,
    /// Type as the file writes it, also `Bit` and `BitArea`.
    pub data_type: String,
    /// First octet.
    pub offset: u16,
    /// First bit in the octet.
    pub bit_offset: Option<u8>,
    /// Number of bits.
    pub bit_length: Option<u8>,
    /// Octets of a string.
    pub length: Option<u16>,
    /// Value unless the user changes it.
    pub default: Option<String>,
    /// What it may be, as the file writes it.
    pub allowed: Option<String>,
    /// Whether the user may change it.
    pub changeable: bool,
    /// Whether it is visible to the user.
    pub visible: bool,
    /// Value texts.
    pub values: Option<String>,
    /// Name.
    pub text: Option<TextId>,
}

/// `MenuItem`: a group of parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Menu {
    /// Identifier in the record.
    pub id: String,
    /// Name.
    pub name: Option<TextId>,
    /// What is in it.
    pub entries: Vec<MenuEntry>,
}

/// Something in a menu.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MenuEntry {
    /// A parameter of the record, by its identifier.
    Parameter(String),
    /// Another menu of the record, by its identifier.
    Menu(String),
}

/// `ValueItem`: texts for the values of a parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ValueItem {
    /// Identifier in this file.
    pub id: String,
    /// Value as the file writes it, and its text.
    pub assignments: Vec<(String, TextId)>,
}

/// `ChannelDiagItem`: text of a diagnosis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelDiagnosis {
    /// ChannelErrorType.
    pub error_type: u16,
    /// Its name.
    pub name: Option<TextId>,
    /// What to do.
    pub help: Option<TextId>,
}

/// `GraphicItem`: a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Graphic {
    /// Identifier in this file.
    pub id: String,
    /// File name without its ending.
    pub file: String,
}

/// `GraphicItemRef`: a picture of something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GraphicRef {
    /// What it shows: `DeviceSymbol`, `DeviceIcon`.
    pub kind: String,
    /// Identifier of the picture.
    pub target: String,
}

/// `CategoryItem`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Category {
    /// Identifier in this file.
    pub id: String,
    /// Name.
    pub text: Option<TextId>,
}

impl Gsdml {
    /// Returns the access point with this identifier.
    #[must_use]
    pub fn access_point(&self, id: &str) -> Option<&AccessPoint> {
        self.access_points.iter().find(|point| point.id == id)
    }

    /// Returns the module with this identifier.
    #[must_use]
    pub fn module(&self, id: &str) -> Option<&Module> {
        self.modules.iter().find(|module| module.id == id)
    }

    /// Returns the pluggable submodule with this identifier.
    #[must_use]
    pub fn submodule(&self, id: &str) -> Option<&Submodule> {
        self.submodules.iter().find(|submodule| submodule.id == id)
    }

    /// Returns the text of an identifier in the primary language; empty when there is none.
    #[must_use]
    pub fn text(&self, id: Option<&TextId>) -> &str {
        id.and_then(|id| self.texts.get(id)).unwrap_or_default()
    }
}

impl Submodule {
    /// Octets from the device and to the device.
    #[must_use]
    pub fn lengths(&self) -> (u32, u32) {
        (self.io.input_length(), self.io.output_length())
    }
}

impl AccessPoint {
    /// Octets that the access point itself needs in the input and in the output frame: each of its submodules has its
    /// data, and one octet of status in each direction.
    #[must_use]
    pub fn own_octets(&self) -> (u32, u32) {
        let plain = u32::from(self.interface.is_some()).saturating_add(count(self.ports.len()));
        self.virtual_submodules
            .iter()
            .map(|submodule| octets(&submodule.io))
            .fold((plain, plain), sum)
    }
}

impl Module {
    /// Octets that the fixed submodules need in the input and in the output frame, with their status.
    #[must_use]
    pub fn own_octets(&self) -> (u32, u32) {
        self.virtual_submodules
            .iter()
            .map(|submodule| octets(&submodule.io))
            .fold((0, 0), sum)
    }
}

/// Octets of a submodule in both frames: data with IOPS, and IOCS for data of the other direction. A submodule without
/// data has an IOPS in the input and an IOCS in the output frame.
fn octets(io: &IoData) -> (u32, u32) {
    let (input, output) = (io.input_length(), io.output_length());
    let (iops, iocs) = (u32::from(io.iops_length), u32::from(io.iocs_length));
    let none = input == 0 && output == 0;
    let data = |length: u32| if length > 0 { length + iops } else { 0 };
    let own = |there: bool, octets: u32| if there { octets } else { 0 };
    (
        data(input) + own(none, iops) + own(output > 0, iocs),
        data(output) + own(none || input > 0, iocs),
    )
}

/// Both halves of two pairs, as far as the numbers go.
const fn sum(one: (u32, u32), other: (u32, u32)) -> (u32, u32) {
    (one.0.saturating_add(other.0), one.1.saturating_add(other.1))
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}
