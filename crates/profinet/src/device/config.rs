//! Configuration of a device (identity, pluggable modules, limits) and its non-volatile data.

use alloc::string::String;
use alloc::vec::Vec;
use core::time::Duration;

use crate::wire::dcp::{IpRule, NameRule, check_ip, check_name};
use crate::wire::{ByteOrder, PnioStatus};
use crate::{IpSuite, MacAddress};

/// Identity of the device; reported by DCP, I&M0 and the endpoint mapper.
///
/// IEC 61158-6-10: VendorID, DeviceID, I&M0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// Vendor number given by PI.
    pub vendor_id: u16,
    /// Device number of the vendor.
    pub device_id: u16,
    /// Instance in the object UUID, usually 1.
    pub instance: u16,
    /// DCP type of station; product name, ASCII, at most 25 characters.
    pub station_type: String,
    /// Order number, ASCII, at most 20 characters.
    pub order_id: String,
    /// Serial number, ASCII, at most 16 characters.
    pub serial_number: String,
    /// Hardware revision.
    pub hardware_revision: u16,
    /// Software revision prefix: `V` released, `R` revision, `P` prototype, `U` field test, `T` test.
    pub software_prefix: char,
    /// Software revision: functional enhancement, bug fix, internal change.
    pub software_revision: [u8; 3],
    /// Profile, 0x3A00 for PROFIdrive, 0 for none.
    pub profile_id: u16,
    /// Profile specific type.
    pub profile_specific_type: u16,
}

/// A submodule of a module of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubmoduleDescription {
    /// Subslot; 0x8000 is the interface, 0x8001 and up its ports.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Application process identifier, 0 unless a profile has its own.
    pub api: u32,
    /// Octets of input data (device to controller).
    pub input_length: u16,
    /// Octets of output data (controller to device).
    pub output_length: u16,
}

/// A module that can be plugged. One whose submodules can be changed is there once for each set of submodules, with the
/// same ident.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModuleDescription {
    /// ModuleIdentNumber, not 0.
    pub ident: u32,
    /// Slots it fits into.
    pub slots: Vec<u16>,
    /// Its fixed submodules.
    pub submodules: Vec<SubmoduleDescription>,
}

/// A reset a device offers by DCP.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ResetMode {
    /// 1: application data with I&M1 to 4.
    ApplicationData,
    /// 2: name and address.
    Communication,
    /// 3: engineering parameters.
    Engineering,
    /// 4: everything stored.
    AllStored,
    /// 8: as it left the factory.
    Device,
    /// 9: reset and restore.
    Restore,
}

impl ResetMode {
    /// Returns the mode of a number.
    #[must_use]
    pub const fn from_number(number: u16) -> Option<Self> {
        Some(match number {
            1 => Self::ApplicationData,
            2 => Self::Communication,
            3 => Self::Engineering,
            4 => Self::AllStored,
            8 => Self::Device,
            9 => Self::Restore,
            _ => return None,
        })
    }

    /// Returns the number in a BlockQualifier (before it is doubled).
    #[must_use]
    pub const fn number(self) -> u16 {
        match self {
            Self::ApplicationData => 1,
            Self::Communication => 2,
            Self::Engineering => 3,
            Self::AllStored => 4,
            Self::Device => 8,
            Self::Restore => 9,
        }
    }

    /// Returns true when name and address are lost.
    #[must_use]
    pub const fn clears_address(self) -> bool {
        !matches!(self, Self::ApplicationData | Self::Engineering)
    }

    /// Returns true when I&M1 to 4 are lost.
    #[must_use]
    pub const fn clears_im(self) -> bool {
        !matches!(self, Self::Communication | Self::Engineering)
    }
}

/// Services that a device refuses, each with the status of its answer; `None` accepts the service.
///
/// Access without a controller. Real devices differ: many accept no device access connection, some no reads outside of
/// a connection, some no records before data is exchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Refusals {
    /// Connect for record access (ARType 6 with device access).
    pub device_access: Option<PnioStatus>,
    /// Read without an AR (Read Implicit).
    pub implicit_read: Option<PnioStatus>,
    /// Connect of a controller.
    pub controller: Option<PnioStatus>,
    /// Write of a controller before data is exchanged.
    pub start_up_write: Option<PnioStatus>,
}

/// Everything fixed about a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceConfig {
    /// Own Ethernet address.
    pub mac: MacAddress,
    /// Makes UUIDs and handles differ from run to run.
    pub seed: u64,
    /// Who it is.
    pub identity: Identity,
    /// Every module that can be plugged.
    pub modules: Vec<ModuleDescription>,
    /// Modules plugged at the start: slot and ModuleIdentNumber. A controller that expects another module of the
    /// catalogue in a slot gets that one plugged.
    pub plugged: Vec<(u16, u32)>,
    /// Shortest send interval in ticks of 31.25 us.
    pub min_device_interval: u16,
    /// Resets offered by DCP; [`ResetMode::Communication`] is mandatory.
    pub reset_modes: Vec<ResetMode>,
    /// Maximum number of DeviceAccess ARs, in addition to the one controller; with 0 their ARType is refused as
    /// unknown.
    pub max_device_access: usize,
    /// Services that the device refuses.
    pub refusals: Refusals,
    /// Comes into step with the controller and sends each input frame right behind its output frame then, see
    /// [`Provider::follow`](crate::cyclic::Provider::follow): one wake-up in a cycle instead of two.
    pub follow_controller: bool,
    /// Enables LLDP (sent every 5 s and received) and SNMP. A PROFINET device requires both; off where only connections
    /// matter.
    pub neighbourhood: bool,
    /// FrameID of the outputs where the controller leaves the choice (0xFFFF): class 1 and class 2.
    pub output_frame_ids: [u16; 2],
    /// Longest alarm taken from the controller, octets: 200 to 1432.
    pub max_alarm_data: u16,
    /// Slots that the ModuleDiffBlock names even when nothing differs there: proper module, substitute submodules. The
    /// Danfoss VLT does so.
    pub always_listed: Vec<u16>,
    /// Refuses another name and a reset by DCP (block error 6, "in operation") while the application
    /// [operates](super::Device::set_operating) under a controller: both would end the connection.
    pub refuses_in_operation: bool,
    /// Byte order of the ApplicationReady call: of its RPC header and of the NDR lengths.
    pub ready_order: ByteOrder,
    /// ArgsMaximum of the ApplicationReady call, octets. A call that is longer states its own length.
    pub ready_arguments: u32,
    /// How long the application may take to answer a record before the engine refuses it.
    pub answer_limit: Duration,
}

impl DeviceConfig {
    /// Creates a device with this identity and these modules; plugs the first module that fits each slot.
    #[must_use]
    pub fn new(mac: MacAddress, identity: Identity, modules: Vec<ModuleDescription>) -> Self {
        let mut plugged: Vec<(u16, u32)> = Vec::new();
        for module in &modules {
            for slot in &module.slots {
                if plugged.iter().all(|(used, _)| used != slot) {
                    plugged.push((*slot, module.ident));
                }
            }
        }
        plugged.sort_unstable();
        Self {
            mac,
            seed: u64::from_be_bytes([0, 0, mac.0[0], mac.0[1], mac.0[2], mac.0[3], mac.0[4], mac.0[5]]),
            identity,
            modules,
            plugged,
            min_device_interval: 32,
            reset_modes: alloc::vec![ResetMode::Communication],
            max_device_access: 4,
            refusals: Refusals::default(),
            follow_controller: false,
            neighbourhood: true,
            output_frame_ids: [0xC000, 0x8000],
            max_alarm_data: 200,
            always_listed: Vec::new(),
            refuses_in_operation: true,
            ready_order: ByteOrder::Big,
            ready_arguments: 1024,
            answer_limit: Duration::from_secs(30),
        }
    }
}

/// I&M1 to I&M4 as they are stored: the record bodies behind the block header.
///
/// IEC 61158-6-10, I&M1 to I&M4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImRecords {
    /// I&M1: TagFunction 32 and TagLocation 22 characters, blank-padded.
    pub im1: [u8; 54],
    /// I&M2: installation date, 16 characters `YYYY-MM-DD HH:MM`.
    pub im2: [u8; 16],
    /// I&M3: descriptor, 54 characters.
    pub im3: [u8; 54],
    /// I&M4: signature, 54 octets.
    pub im4: [u8; 54],
}

impl Default for ImRecords {
    /// Blank; the signature is zero.
    fn default() -> Self {
        Self {
            im1: [b' '; 54],
            im2: [b' '; 16],
            im3: [b' '; 54],
            im4: [0; 54],
        }
    }
}

/// Non-volatile data of a device.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Stored {
    /// Name of station, empty for none.
    pub name: String,
    /// Address.
    pub ip: IpSuite,
    /// I&M1 to 4.
    pub im: ImRecords,
}

/// The rule that stored data breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StoredError {
    /// The name of station.
    #[error("the name is not valid: {0}")]
    Name(#[from] NameRule),
    /// The address.
    #[error("the address is not valid: {0}")]
    Address(#[from] IpRule),
}

impl Stored {
    /// Checks that a device could have been given these data: what comes from a disk is foreign too.
    ///
    /// ```
    /// use profidrive_profinet::device::Stored;
    /// let stored = Stored { name: "../../etc/passwd".into(), ..Stored::default() };
    /// assert!(stored.check().is_err());
    /// ```
    ///
    /// # Errors
    /// The first rule of names or addresses that is broken.
    pub fn check(&self) -> Result<(), StoredError> {
        if !self.name.is_empty() {
            check_name(self.name.as_bytes())?;
        }
        Ok(check_ip(&self.ip)?)
    }
}
