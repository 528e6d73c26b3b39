//! What a drive model is on its field bus: numbers that a controller must match and a virtual drive must show.

use super::Parameter;
use crate::telegram::{Telegram, signal};

/// Identity and modules of a drive model.
/// Source: `data/<model>/device.toml`, which gives the source of each number.
#[derive(Debug, Clone, Copy)]
pub struct Device {
    /// Vendor number on PROFINET, also PNU 964 index 0.
    pub vendor_id: u16,
    /// Device number of the vendor.
    pub device_id: u16,
    /// Name of the vendor.
    pub vendor: &'static str,
    /// Type of station as reported in discovery (DCP).
    pub station_type: &'static str,
    /// Order number.
    pub order_id: &'static str,
    /// Hardware revision.
    pub hardware_revision: u16,
    /// Software revision, major, minor, bug fix.
    pub software_revision: [u8; 3],
    /// Application process identifier of the drive, 0x3A00 for PROFIdrive.
    pub api: u16,
    /// PNU 964 index 1.
    pub drive_unit_type: u16,
    /// PNU 964 index 3, decimal YYYY.
    pub firmware_year: u16,
    /// PNU 964 index 4, decimal DDMM.
    pub firmware_day_month: u16,
    /// Module ident of the device access point, slot 0.
    pub access_point_module: u32,
    /// Submodule ident of slot 0 subslot 1.
    pub access_point_submodule: u32,
    /// Submodule ident of the interface, slot 0 subslot 0x8000.
    pub interface_submodule: u32,
    /// Submodule ident of the ports, slot 0 from subslot 0x8001 on.
    pub port_submodule: u32,
    /// How many ports there are.
    pub ports: u8,
    /// What is where in slot 1.
    pub layout: Layout,
    /// Shortest update time in steps of 31.25 us.
    pub min_device_interval: u16,
    /// Telegram modules that can be plugged in slot 1.
    pub telegrams: &'static [TelegramModule],
    /// Further contents of its device description.
    pub description: DescriptionFacts,
}

/// What is in slot 1, where the telegram module is plugged.
/// Source: AKD, one submodule for all; VLT, the connect of a real drive; Vacon 100, PROFINET manual 5.4.4 for the records.
///
/// ```
/// use profidrive_profile::catalogue::{AKD, VLT};
/// assert_eq!((AKD.device.layout.telegram, AKD.device.layout.parameters.subslot), (1, 1));
/// assert_eq!((VLT.device.layout.telegram, VLT.device.layout.parameters.subslot), (2, 1));
/// assert_eq!(VLT.device.layout.parameters.submodule, Some(0xFFFF));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Subslot of the telegram.
    pub telegram: u16,
    /// Where parameter jobs go to.
    pub parameters: ParameterPoint,
    /// Records 0 to 0x7FFF that are parameters themselves, by subslot; empty where there are none.
    pub records: &'static [RecordView],
}

/// The submodule that takes parameter jobs: the parameter access point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ParameterPoint {
    /// Subslot in slot 1.
    pub subslot: u16,
    /// Its ident where it is a submodule of its own, without cyclic data. None: the telegram's submodule does it.
    pub submodule: Option<u32>,
}

/// Records whose index is the number of a parameter (Vacon: the application id) and whose content is its raw value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordView {
    /// Subslot in slot 1.
    pub subslot: u16,
    /// Octets of every value: 2 or 4.
    pub octets: u8,
}

impl RecordView {
    /// What the 32-bit view multiplies with where it resolves finer: a frequency 0.0001 Hz instead of 0.01 Hz.
    const FINER: i64 = 100;

    /// Returns the factor of the raw value of a parameter in this view.
    ///
    /// Source: Vacon 100 PROFINET manual 5.4.4, OPTEA manual p. 116 (ID 102 is 0x1388 in 16 bits and 0x0007A120 in 32).
    /// That every frequency of two decimals is like it, and nothing else, is our reading of the one example there is.
    ///
    /// ```
    /// use profidrive_profile::catalogue::VACON;
    /// let [short, long] = VACON.device.layout.records else { panic!() };
    /// let (frequency, time) = (VACON.at(10_001, 102).unwrap(), VACON.at(10_001, 103).unwrap());
    /// assert_eq!((short.factor(frequency), long.factor(frequency), long.factor(time)), (1, 100, 1));
    /// ```
    #[must_use]
    pub fn factor(&self, parameter: &Parameter) -> i64 {
        let finer = self.octets == 4 && parameter.scale.exponent() == Some(-2) && parameter.unit == "Hz";
        if finer { Self::FINER } else { 1 }
    }
}

/// A text in two languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Words {
    /// English.
    pub english: &'static str,
    /// German.
    pub german: &'static str,
}

/// Data of a drive model that only its device description contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DescriptionFacts {
    /// Date of the description as the number YYYYMMDD.
    pub date: u32,
    /// Device family in the file name.
    pub family: &'static str,
    /// Product family in catalogues.
    pub product_family: &'static str,
    /// Name of station proposed by tools.
    pub dns_name: &'static str,
    /// Name in catalogues.
    pub name: &'static str,
    /// What it is.
    pub words: Words,
    /// Conformance class of PROFINET: A, B or C.
    pub conformance_class: &'static str,
    /// Netload class: I, II or III.
    pub netload_class: &'static str,
    /// Protocols beside PROFINET.
    pub protocols: &'static [&'static str],
    /// Longest delay of a received frame in the port, ns.
    pub port_rx_delay: u16,
    /// Longest delay of a sent frame in the port, ns.
    pub port_tx_delay: u16,
}

/// A module that carries one telegram, slot 1; [`Layout`] says in which subslot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TelegramModule {
    /// Number of the telegram, as in PNU 922.
    pub telegram: u16,
    /// Module ident.
    pub module: u32,
    /// Submodule ident.
    pub submodule: u32,
    /// Octets from the controller to the drive.
    pub outputs: u16,
    /// Octets from the drive to the controller.
    pub inputs: u16,
    /// What it is for.
    pub words: Words,
}

impl Device {
    /// Returns the module of a telegram.
    #[must_use]
    pub fn telegram(&self, number: u16) -> Option<&'static TelegramModule> {
        self.telegrams.iter().find(|module| module.telegram == number)
    }

    /// Returns true when one of its telegrams carries traversing tasks: the drive positions. All others control speed.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, VACON, VLT};
    /// assert!(AKD.device.positions() && !VLT.device.positions() && !VACON.device.positions());
    /// ```
    #[must_use]
    pub fn positions(&self) -> bool {
        let mut known = self.telegrams.iter();
        known.any(|module| {
            let telegram = Telegram::find(module.telegram, self.vendor_id);
            telegram.is_some_and(|telegram| telegram.setpoint.field(signal::SATZANW).is_some())
        })
    }

    /// Subslots and idents of slot 0: access point, interface, ports.
    ///
    /// ```
    /// use profidrive_profile::catalogue::VLT;
    /// let subslots: Vec<u16> = VLT.device.access_point().map(|(subslot, _)| subslot).collect();
    /// assert_eq!(subslots, [1, 0x8000, 0x8001, 0x8002]);
    /// ```
    pub fn access_point(&self) -> impl Iterator<Item = (u16, u32)> + use<> {
        let port = self.port_submodule;
        let ports = (0x8001_u16..)
            .take(usize::from(self.ports))
            .map(move |subslot| (subslot, port));
        [
            (1, self.access_point_submodule),
            (0x8000, self.interface_submodule),
        ]
        .into_iter()
        .chain(ports)
    }

    /// Returns the telegram of a module ident.
    #[must_use]
    pub fn telegram_of_module(&self, module: u32) -> Option<&'static TelegramModule> {
        self.telegrams.iter().find(|known| known.module == module)
    }
}
