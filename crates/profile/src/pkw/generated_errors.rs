// Generated from data/profile/pkw-errors.toml by `cargo run -p xtask -- gen`.

use super::error::{PkwErrorInfo, PkwErrorNumber};

impl PkwErrorNumber {
    /// 0: parameter number does not exist.
    pub const UNKNOWN_PARAMETER: Self = Self(0);
    /// 1: no write access to the parameter.
    pub const NOT_CHANGEABLE: Self = Self(1);
    /// 2: value exceeds the limits of the parameter.
    pub const LIMIT: Self = Self(2);
    /// 3: subindex does not exist.
    pub const SUBINDEX: Self = Self(3);
    /// 4: parameter is not an array.
    pub const NO_ARRAY: Self = Self(4);
    /// 5: data type does not match the parameter.
    pub const DATA_TYPE: Self = Self(5);
    /// 6: setting not permitted, only resetting.
    pub const RESET_ONLY: Self = Self(6);
    /// 7: description element cannot be changed.
    pub const DESCRIPTION_FIXED: Self = Self(7);
    /// 8: PPO write not available.
    pub const PPO_WRITE: Self = Self(8);
    /// 9: no description data.
    pub const NO_DESCRIPTION: Self = Self(9);
    /// 10: wrong access group.
    pub const ACCESS_GROUP: Self = Self(10);
    /// 11: no change rights.
    pub const NO_RIGHTS: Self = Self(11);
    /// 12: password missing.
    pub const PASSWORD: Self = Self(12);
    /// 13: text cannot be read in cyclic transmission.
    pub const TEXT_NOT_CYCLIC: Self = Self(13);
    /// 14: name cannot be read in cyclic transmission.
    pub const NAME_NOT_CYCLIC: Self = Self(14);
    /// 15: no text array.
    pub const NO_TEXT: Self = Self(15);
    /// 16: PPO write missing.
    pub const PPO_WRITE_MISSING: Self = Self(16);
    /// 17: not possible in the present mode of the drive.
    pub const NOT_NOW: Self = Self(17);
    /// 18: other error.
    pub const OTHER: Self = Self(18);
}

/// Error numbers that mean the same for every vendor, ascending.
#[rustfmt::skip]
pub static PKW_ERRORS: &[PkwErrorInfo] = &[
    PkwErrorInfo { number: 0, meaning: "parameter number does not exist", remedy: "the drive has no such PNU: check the number, the model and the firmware", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 1, meaning: "no write access to the parameter", remedy: "the parameter is read-only", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 2, meaning: "value exceeds the limits of the parameter", remedy: "give a value inside the limits that `describe` shows", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 3, meaning: "subindex does not exist", remedy: "the array has no such element: give a smaller subindex", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 4, meaning: "parameter is not an array", remedy: "the parameter has no elements: leave the subindex away", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 5, meaning: "data type does not match the parameter", remedy: "send the value in the size of the parameter: word, double word or text", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 6, meaning: "setting not permitted, only resetting", remedy: "only 0 may be written", source: "ABB FPBA-01 p.90, MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 7, meaning: "description element cannot be changed", remedy: "write the value, not the description", source: "ABB FPBA-01 p.90, MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 8, meaning: "PPO write not available", remedy: "use the acyclic channel", source: "SINAMICS G110D p.177" },
    PkwErrorInfo { number: 9, meaning: "no description data", remedy: "the drive does not describe this parameter; the tables may", source: "ABB FPBA-01 p.90, SINAMICS G110D p.177, Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 10, meaning: "wrong access group", remedy: "unlock the access level in the drive", source: "SINAMICS G110D p.177" },
    PkwErrorInfo { number: 11, meaning: "no change rights", remedy: "another interface holds the right to change: release it there, or set PNU 927", source: "ABB FPBA-01 p.90, Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 12, meaning: "password missing", remedy: "enter the password in the drive", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 13, meaning: "text cannot be read in cyclic transmission", remedy: "read the text acyclically or in a serial text block", source: "SINAMICS G110D p.177" },
    PkwErrorInfo { number: 14, meaning: "name cannot be read in cyclic transmission", remedy: "read the name acyclically", source: "SINAMICS G110D p.177" },
    PkwErrorInfo { number: 15, meaning: "no text array", remedy: "the parameter has no texts", source: "ABB FPBA-01 p.90, SINAMICS G110D p.177, Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 16, meaning: "PPO write missing", remedy: "use the acyclic channel", source: "SINAMICS G110D p.177" },
    PkwErrorInfo { number: 17, meaning: "not possible in the present mode of the drive", remedy: "some parameters can only be changed when the motor has stopped", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 18, meaning: "other error", remedy: "look at the drive's own display or log", source: "ABB FPBA-01 p.90, SINAMICS G110D p.177, Danfoss CDS 803 p.56" },
];

/// Danfoss.
#[rustfmt::skip]
pub static DANFOSS: &[PkwErrorInfo] = &[
    PkwErrorInfo { number: 130, meaning: "no bus access to the parameter", remedy: "read or set it at the drive's own panel", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 131, meaning: "change not possible, the factory setup is selected", remedy: "select another setup to edit, then write", source: "Danfoss FC parameter block description p.73" },
    PkwErrorInfo { number: 132, meaning: "no access for the panel", remedy: "use another interface for this parameter", source: "Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 252, meaning: "unknown viewer", remedy: "the drive does not know who asks: check address and protocol of the port", source: "Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 253, meaning: "request not supported", remedy: "use another request: the drive knows only some of them", source: "Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 254, meaning: "unknown attribute", remedy: "ask for the value only", source: "Danfoss CDS 803 p.56" },
    PkwErrorInfo { number: 255, meaning: "no error", remedy: "ask again", source: "Danfoss CDS 803 p.56" },
];

/// Siemens.
#[rustfmt::skip]
pub static SIEMENS: &[PkwErrorInfo] = &[
    PkwErrorInfo { number: 20, meaning: "value impermissible", remedy: "the value is inside the limits but not one of the allowed ones", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 21, meaning: "response too long", remedy: "ask for fewer values", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 22, meaning: "impermissible parameter address", remedy: "check PNU, page and subindex together", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 23, meaning: "illegal format", remedy: "send the value in the size of the parameter", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 24, meaning: "number of values inconsistent", remedy: "send as many values as elements are addressed", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 101, meaning: "parameter currently deactivated", remedy: "activate the function it belongs to", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 102, meaning: "channel too narrow", remedy: "the value needs a longer PKW part than the telegram has", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 103, meaning: "wrong number of PKW words", remedy: "set the length of the PKW part alike on both sides", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 104, meaning: "illegal parameter value", remedy: "send an allowed value", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 105, meaning: "parameter is indexed", remedy: "ask for an element of the array", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 106, meaning: "request not implemented", remedy: "use another request", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 107, meaning: "text cannot be changed", remedy: "texts of this parameter are fixed", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 108, meaning: "wrong number of parameter values", remedy: "send as many values as elements are addressed", source: "MASTERDRIVES compendium p.8.2-97" },
    PkwErrorInfo { number: 200, meaning: "below the limit that is valid now", remedy: "send a higher value", source: "MICROMASTER PROFIBUS 6SE6400-5AK00 p.27" },
    PkwErrorInfo { number: 201, meaning: "above the limit that is valid now", remedy: "send a lower value", source: "MICROMASTER PROFIBUS 6SE6400-5AK00 p.27" },
    PkwErrorInfo { number: 204, meaning: "access code missing", remedy: "enter the access code", source: "MICROMASTER PROFIBUS 6SE6400-5AK00 p.27" },
];

/// ABB.
#[rustfmt::skip]
pub static ABB: &[PkwErrorInfo] = &[
    PkwErrorInfo { number: 101, meaning: "vendor-specific error", remedy: "look at the drive's own display or log", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 102, meaning: "request not supported", remedy: "use another request", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 103, meaning: "communication error between adapter and drive", remedy: "check that the adapter sits right, then ask again", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 110, meaning: "writing the permanent memory failed", remedy: "write again; if it stays, write to RAM only", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 111, meaning: "time-out inside the drive", remedy: "ask again", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 120, meaning: "process data cannot be mapped", remedy: "choose another parameter for the process data", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 121, meaning: "process data cannot be mapped", remedy: "choose another parameter for the process data", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 122, meaning: "process data cannot be mapped", remedy: "choose another parameter for the process data", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 130, meaning: "bit of the control word cannot be mapped", remedy: "choose another bit", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 140, meaning: "torque mode", remedy: "leave torque control, then write", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 150, meaning: "buffer overflow", remedy: "ask for less at once", source: "ABB FPBA-01 p.90" },
    PkwErrorInfo { number: 160, meaning: "internal error", remedy: "restart the drive; if it stays, contact the vendor", source: "ABB FPBA-01 p.90" },
];
