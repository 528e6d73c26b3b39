// Generated from data/profile/parameter-errors.toml by `cargo run -p xtask -- gen`.

use super::error::{ErrorInfo, ErrorNumber};

impl ErrorNumber {
    /// 0x00: impermissible parameter number.
    pub const UNKNOWN_PARAMETER: Self = Self(0x00);
    /// 0x01: parameter value cannot be changed.
    pub const NOT_CHANGEABLE: Self = Self(0x01);
    /// 0x02: lower or upper limit exceeded.
    pub const LIMIT: Self = Self(0x02);
    /// 0x03: faulty subindex.
    pub const SUBINDEX: Self = Self(0x03);
    /// 0x04: no array.
    pub const NO_ARRAY: Self = Self(0x04);
    /// 0x05: incorrect data type.
    pub const DATA_TYPE: Self = Self(0x05);
    /// 0x06: setting not permitted, only resetting.
    pub const RESET_ONLY: Self = Self(0x06);
    /// 0x07: description element cannot be changed.
    pub const DESCRIPTION_FIXED: Self = Self(0x07);
    /// 0x08: PPO write not available.
    pub const PPO_WRITE: Self = Self(0x08);
    /// 0x09: no description data.
    pub const NO_DESCRIPTION: Self = Self(0x09);
    /// 0x0a: wrong access group.
    pub const ACCESS_GROUP: Self = Self(0x0a);
    /// 0x0b: no operation priority.
    pub const NO_RIGHTS: Self = Self(0x0b);
    /// 0x0c: password missing.
    pub const PASSWORD: Self = Self(0x0c);
    /// 0x0d: text cannot be read in cyclic transmission.
    pub const TEXT_NOT_CYCLIC: Self = Self(0x0d);
    /// 0x0e: name cannot be read in cyclic transmission.
    pub const NAME_NOT_CYCLIC: Self = Self(0x0e);
    /// 0x0f: no text array available.
    pub const NO_TEXT: Self = Self(0x0f);
    /// 0x10: no read access.
    pub const READ_PROTECTED: Self = Self(0x10);
    /// 0x11: not executable in the present operating state.
    pub const NOT_NOW: Self = Self(0x11);
    /// 0x12: other error.
    pub const OTHER: Self = Self(0x12);
    /// 0x14: value impermissible.
    pub const VALUE: Self = Self(0x14);
    /// 0x15: response too long.
    pub const TOO_LONG: Self = Self(0x15);
    /// 0x16: impermissible parameter address.
    pub const ADDRESS: Self = Self(0x16);
    /// 0x17: illegal format.
    pub const FORMAT: Self = Self(0x17);
    /// 0x18: number of values inconsistent.
    pub const VALUE_COUNT: Self = Self(0x18);
    /// 0x19: axis or drive object does not exist.
    pub const NO_AXIS: Self = Self(0x19);
    /// 0x20: text element cannot be changed.
    pub const TEXT_FIXED: Self = Self(0x20);
    /// 0x21: service not supported.
    pub const SERVICE: Self = Self(0x21);
    /// 0x22: too many parameter requests.
    pub const TOO_MANY: Self = Self(0x22);
    /// 0x23: only single parameter access supported.
    pub const SINGLE_ONLY: Self = Self(0x23);
}

/// Error numbers of the profile, ascending.
#[rustfmt::skip]
pub static ERRORS: &[ErrorInfo] = &[
    ErrorInfo { number: 0x00, meaning: "impermissible parameter number", remedy: "the drive has no such PNU: check the number, the model and the firmware", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x01, meaning: "parameter value cannot be changed", remedy: "the parameter is read-only", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x02, meaning: "lower or upper limit exceeded", remedy: "give a value inside the limits that `describe` shows", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x03, meaning: "faulty subindex", remedy: "the array has no such element: give a smaller subindex", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x04, meaning: "no array", remedy: "the parameter has no elements: leave the subindex away", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x05, meaning: "incorrect data type", remedy: "send the value in the size of the parameter", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x06, meaning: "setting not permitted, only resetting", remedy: "only 0 may be written", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x07, meaning: "description element cannot be changed", remedy: "write the value, not the description", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x08, meaning: "PPO write not available", remedy: "use the acyclic channel", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x09, meaning: "no description data", remedy: "the drive does not describe this parameter; the tables may", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x0a, meaning: "wrong access group", remedy: "unlock the access level in the drive", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x0b, meaning: "no operation priority", remedy: "another interface holds the right to change: release it there, or set PNU 927", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x0c, meaning: "password missing", remedy: "enter the password in the drive", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x0d, meaning: "text cannot be read in cyclic transmission", remedy: "read the text acyclically", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x0e, meaning: "name cannot be read in cyclic transmission", remedy: "read the name acyclically", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x0f, meaning: "no text array available", remedy: "the parameter has no texts", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x10, meaning: "no read access", remedy: "the parameter is protected in the drive", subindex: false, source: "SINAMICS G130 p.230" },
    ErrorInfo { number: 0x11, meaning: "not executable in the present operating state", remedy: "most settings need the drive disabled or the axis at rest, a command that moves it needs the drive enabled", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x12, meaning: "other error", remedy: "look at the drive's own display or log", subindex: false, source: "Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x14, meaning: "value impermissible", remedy: "the value is inside the limits but not one of the allowed ones", subindex: true, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x15, meaning: "response too long", remedy: "ask for fewer parameters or elements at once", subindex: false, source: "SINAMICS DCM, Danfoss MCA 101 p.30" },
    ErrorInfo { number: 0x16, meaning: "impermissible parameter address", remedy: "check attribute, number of elements, PNU and subindex together", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x17, meaning: "illegal format", remedy: "send Byte, Word, Double word or the true type of the parameter", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x18, meaning: "number of values inconsistent", remedy: "send as many values as elements are addressed", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x19, meaning: "axis or drive object does not exist", remedy: "use the axis number of the drive (0 for AKD and VLT, 1 for Vacon)", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x20, meaning: "text element cannot be changed", remedy: "texts of this parameter are fixed", subindex: false, source: "SINAMICS DCM, G130 p.230" },
    ErrorInfo { number: 0x21, meaning: "service not supported", remedy: "the drive does not know this kind of request", subindex: false, source: "Vacon OPTEA p.122, Wireshark" },
    ErrorInfo { number: 0x22, meaning: "too many parameter requests", remedy: "send fewer requests at once", subindex: false, source: "Wireshark, wording not verified" },
    ErrorInfo { number: 0x23, meaning: "only single parameter access supported", remedy: "send one parameter in each request", subindex: false, source: "Wireshark" },
];

/// Danfoss VLT.
#[rustfmt::skip]
pub static DANFOSS: &[ErrorInfo] = &[
    ErrorInfo { number: 0x11, meaning: "not executable in the present operating state", remedy: "most settings need the motor stopped; while 0-11 selects the factory set-up (0) the settings of a set-up cannot be written: select another one in 0-11", subindex: false, source: "0x11 for 131 of the parameter channel is ours; 0-11: FC 300 programming guide, from memory" },
    ErrorInfo { number: 0x65, meaning: "wrong axis", remedy: "send axis 0", subindex: false, source: "Danfoss FC 300 PROFIBUS manual MG.33.C2 p.50" },
    ErrorInfo { number: 0x66, meaning: "unknown service", remedy: "send request ID 1, 2, 0x42, 0x51 or 0x52", subindex: false, source: "Danfoss FC 300 PROFIBUS manual MG.33.C2 p.50" },
    ErrorInfo { number: 0x67, meaning: "not with multi-parameter access", remedy: "send one parameter in each request", subindex: false, source: "Danfoss FC 300 PROFIBUS manual MG.33.C2 p.50" },
    ErrorInfo { number: 0x68, meaning: "no bus access to the parameter value", remedy: "read or set it at the drive's own panel", subindex: false, source: "Danfoss FC 300 PROFIBUS manual MG.33.C2 p.50, which has reading only; a write gets it for 130 of the parameter channel (ours)" },
];

/// Vacon.
#[rustfmt::skip]
pub static VACON: &[ErrorInfo] = &[
    ErrorInfo { number: 0x65, meaning: "invalid request reference", remedy: "send a reference from 1 to 255", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x66, meaning: "invalid request ID", remedy: "send 1 to read or 2 to change; some firmware answers with 0x21 instead", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x67, meaning: "invalid axis", remedy: "send axis 1", subindex: false, source: "Vacon OPTCP manual p.36; reserved in the OPTEA manual" },
    ErrorInfo { number: 0x68, meaning: "illegal number of parameters", remedy: "send 1 to 39 parameters", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x69, meaning: "illegal attribute", remedy: "send 0x10 (value) or 0x20 (description)", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x6b, meaning: "request too short", remedy: "send the whole request", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x6c, meaning: "parameter not found or not accessible", remedy: "check the application ID in the subindex", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x6d, meaning: "invalid change request", remedy: "check number, format and value", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
    ErrorInfo { number: 0x6e, meaning: "general error", remedy: "look at the drive's panel", subindex: false, source: "Vacon OPTEA manual p.122-123, OPTCP manual p.36" },
];

/// Siemens SINAMICS.
#[rustfmt::skip]
pub static SIEMENS: &[ErrorInfo] = &[
    ErrorInfo { number: 0x65, meaning: "parameter currently deactivated", remedy: "activate the function it belongs to", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x66, meaning: "channel too narrow", remedy: "ask for fewer values", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x68, meaning: "illegal parameter value", remedy: "send an allowed value", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x6a, meaning: "request not implemented", remedy: "use another request", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x6b, meaning: "no write access while the controller is enabled", remedy: "switch the drive off, then write", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x6c, meaning: "unknown unit", remedy: "use another unit", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x86, meaning: "write only in commissioning state 15", remedy: "set p0010 to 15 first", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0x87, meaning: "know-how protection", remedy: "remove the protection with the vendor's tool", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0xc8, meaning: "below the limit that is valid now", remedy: "send a higher value", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0xc9, meaning: "above the limit that is valid now", remedy: "send a lower value", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
    ErrorInfo { number: 0xcc, meaning: "access code missing", remedy: "enter the access code", subindex: false, source: "SINAMICS G120, G115D list of request errors" },
];
