//! What the parameter managers of different makers do differently, as data.

use super::error::{ErrorNames, ErrorNumber};
use super::format::CodeSpace;

/// How a positive answer to a change request looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ChangeResponse {
    /// The four octets of the header (profile).
    Header,
    /// Two zero octets behind the header (AKD manual 3.6.2).
    HeaderAndZero,
}

/// Facts about one maker's parameter manager. A virtual drive answers by them, a client asks by them.
/// Source: AKD PROFINET manual 3.6; Danfoss MG06G102 5.5 and MCA 101 p. 27-34; Vacon OPTEA manual p. 116-123.
///
/// ```
/// use profidrive::parameter::{ChangeResponse, Dialect};
/// assert_eq!(Dialect::AKD.change_response, ChangeResponse::HeaderAndZero);
/// assert_eq!((Dialect::AKD.axis, Dialect::VACON.axis), (0, 1));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    /// Name for people.
    pub name: &'static str,
    /// Axis or drive object number that a request carries.
    pub axis: u8,
    /// True when every other axis number is refused with 0x19.
    pub axis_checked: bool,
    /// Numbers of the profile-specific formats.
    pub code_space: CodeSpace,
    /// Form of the positive change response.
    pub change_response: ChangeResponse,
    /// Parameters in one request at most.
    pub max_parameters: u8,
    /// Octets of one request or response at most.
    pub max_block: usize,
    /// Answers only Byte, Word and Double word.
    pub substitution_only: bool,
    /// Response ID and error number for a request ID that is neither read nor change.
    pub bad_request: (u8, ErrorNumber),
    /// Error number for a number of parameters of 0 or above the limit; `None`: the record write is refused.
    pub bad_count: Option<ErrorNumber>,
    /// Error number for an illegal attribute.
    pub bad_attribute: ErrorNumber,
    /// Error number for a value block that runs past the end of the request.
    pub too_short: ErrorNumber,
    /// Error number for the reserved reference 0; `None`: it is mirrored like any other.
    pub bad_reference: Option<ErrorNumber>,
    /// Meanings of manufacturer-specific error numbers.
    pub error_names: ErrorNames,
}

impl Dialect {
    /// The profile itself, for a drive of which nothing else is known.
    pub const STANDARD: Self = Self {
        name: "PROFIdrive",
        axis: 1,
        axis_checked: false,
        code_space: CodeSpace::V4,
        change_response: ChangeResponse::Header,
        max_parameters: 39,
        max_block: 240,
        substitution_only: false,
        bad_request: (0x81, ErrorNumber::SERVICE),
        bad_count: None,
        bad_attribute: ErrorNumber::ADDRESS,
        too_short: ErrorNumber::VALUE_COUNT,
        bad_reference: None,
        error_names: ErrorNames::Profile,
    };

    /// Kollmorgen AKD: axis 0, formats 0x41 to 0x43, six-octet positive change response.
    pub const AKD: Self = Self {
        name: "AKD",
        axis: 0,
        axis_checked: true,
        change_response: ChangeResponse::HeaderAndZero,
        substitution_only: true,
        ..Self::STANDARD
    };

    /// Danfoss VLT with the PROFINET option: axis 0, V2/V3 formats, 37 parameters.
    pub const VLT: Self = Self {
        name: "VLT",
        axis: 0,
        axis_checked: true,
        code_space: CodeSpace::V3,
        max_parameters: 37,
        error_names: ErrorNames::Danfoss,
        ..Self::STANDARD
    };

    /// Vacon OPTEA and OPTE9: axis 1, own error numbers for malformed requests.
    pub const VACON: Self = Self {
        name: "Vacon",
        axis: 1,
        axis_checked: true,
        substitution_only: true,
        bad_request: (0x80, ErrorNumber::SERVICE),
        bad_count: Some(ErrorNumber(0x68)),
        bad_attribute: ErrorNumber(0x69),
        too_short: ErrorNumber::VACON_TOO_SHORT,
        bad_reference: Some(ErrorNumber(0x65)),
        error_names: ErrorNames::Vacon,
        ..Self::STANDARD
    };
}
