//! Numbers of the parameters that the profile itself has, the same for every vendor.
//!
//! Source: PROFIdrive profile as AKD PROFINET manual 3.8 and chapter 6, MCA 101 and OPTEA manuals state it.
//!
//! ```
//! use profidrive_profile::catalogue::{AKD, VACON, VLT};
//! use profidrive_profile::parameter::pnu;
//! assert!([&AKD, &VLT, &VACON].iter().all(|tables| tables.by_pnu(pnu::FAULT_NUMBERS).is_some()));
//! ```

/// Numbers of the signals in the controller's telegram, one an element.
pub const SETPOINT_SIGNALS: u16 = 915;
/// Numbers of the signals in the drive's telegram, one an element.
pub const ACTUAL_SIGNALS: u16 = 916;
/// Number of the telegram in use.
pub const TELEGRAM: u16 = 922;
/// Operating mode: 1 speed control, 2 positioning.
pub const OPERATING_MODE: u16 = 930;
/// Fault message counter: changes with each change of the buffer.
pub const FAULT_COUNTER: u16 = 944;
/// Fault buffer: numbers.
pub const FAULT_NUMBERS: u16 = 947;
/// Fault buffer: times.
pub const FAULT_TIMES: u16 = 948;
/// Fault buffer: values.
pub const FAULT_VALUES: u16 = 949;
/// How the fault buffer is divided into situations.
pub const FAULT_DIVISION: u16 = 950;
/// Drive unit identification: vendor, type, version, date.
pub const IDENTIFICATION: u16 = 964;
/// Number and version of the profile.
pub const PROFILE: u16 = 965;
/// Transfer of all parameters to the non-volatile memory.
pub const SAVE: u16 = 971;
/// Drive object identification.
pub const DRIVE_OBJECT: u16 = 975;
