//! What the parameter managers of different vendors do differently, as data.

use super::access::Keep;
use super::address::RequestId;
use super::error::{ErrorNames, ErrorNumber};
use super::format::CodeSpace;
use crate::fault::Counting;

/// How a positive answer to a change request looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ChangeResponse {
    /// The four octets of the header (profile).
    Header,
    /// Two zero octets behind the header (AKD manual 3.6.2).
    HeaderAndZero,
}

/// When a drive keeps a changed value over a power cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Saving {
    /// On a command, for all values at once (AKD: DRV.NVSAVE; profile: PNU 971).
    Command,
    /// By the request that changes it, besides a command (VLT: request ID 0x42; parameter 9-71).
    Request,
    /// Always (Vacon).
    Always,
}

/// Facts about one vendor's parameter manager. Virtual drives and clients both follow them. Source: AKD
/// PROFINET manual 3.6; Danfoss MG06G102 5.5 and MCA 101 p. 27-34; Vacon OPTEA manual p. 116-123.
///
/// ```
/// use profidrive_profile::parameter::{ChangeResponse, Dialect, Keep, RequestId};
/// assert_eq!(Dialect::AKD.change_response, ChangeResponse::HeaderAndZero);
/// assert_eq!((Dialect::AKD.axis, Dialect::VACON.axis), (0, 1));
/// assert_eq!(Dialect::VLT.change_id(Keep::Permanent), Some(RequestId::ChangePermanent));
/// assert_eq!(Dialect::AKD.change_id(Keep::Permanent), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    /// Name for people.
    pub name: &'static str,
    /// Requests that exist.
    pub requests: &'static [RequestId],
    /// When changes are retained over a power cycle.
    pub saving: Saving,
    /// Axis or drive object number that a request carries.
    pub axis: u8,
    /// True when every other axis number is refused with [`bad_axis`](Self::bad_axis).
    pub axis_checked: bool,
    /// Numbers of the profile-specific formats.
    pub code_space: CodeSpace,
    /// Form of the positive change response.
    pub change_response: ChangeResponse,
    /// A response can repeat the parameter addresses in front of the values (AKD parameter access note).
    pub repeats_addresses: bool,
    /// Parameters in one request at most.
    pub max_parameters: u8,
    /// Values in one request or response at most, all parameters together, that a client requests.
    pub max_values: u16,
    /// The same that a drive answers: more where its documents name two numbers.
    pub served_values: u16,
    /// Octets of one request or response at most.
    pub max_block: usize,
    /// Texts of values exist (attribute 0x30).
    pub texts: bool,
    /// Answers only Byte, Word and Double word.
    pub substitution_only: bool,
    /// Zeros behind the last value of a change are as wrong as anything else there; else they are the rest of a buffer.
    pub exact_length: bool,
    /// Error number for an axis that is not there.
    pub bad_axis: ErrorNumber,
    /// Response ID and error number for a request ID that does not exist.
    pub bad_request: (u8, ErrorNumber),
    /// Error number for a number of parameters of 0 or above the limit; `None`: the record write is refused.
    pub bad_count: Option<ErrorNumber>,
    /// Error number for an illegal attribute.
    pub bad_attribute: ErrorNumber,
    /// Error number for a parameter that is not among those that one number collects.
    pub bad_member: ErrorNumber,
    /// Error number for a value block that runs past the end of the request.
    pub too_short: ErrorNumber,
    /// Error number for parameter addresses that run past the end of the request; `None`: the record write is refused.
    pub too_few_addresses: Option<ErrorNumber>,
    /// Error number for octets behind the last value of a change, nothing is changed then; `None`: the record write is
    /// refused.
    pub trailing: Option<ErrorNumber>,
    /// Error number for more values in a change than [`served_values`](Self::served_values).
    pub too_many_values: ErrorNumber,
    /// Error number for a value that the non-volatile memory did not store.
    pub not_saved: ErrorNumber,
    /// Errors report the subindex that they concern.
    pub error_info: bool,
    /// Error number for the reserved reference 0; `None`: it is mirrored like any other.
    pub bad_reference: Option<ErrorNumber>,
    /// What the fault message counter (PNU 944) counts.
    pub fault_counter: Counting,
    /// Meanings of manufacturer-specific error numbers.
    pub error_names: ErrorNames,
}

impl Dialect {
    /// The profile itself, for a drive of which nothing else is known.
    pub const STANDARD: Self = Self {
        name: "PROFIdrive",
        requests: &[RequestId::Read, RequestId::Change],
        saving: Saving::Command,
        axis: 1,
        axis_checked: false,
        code_space: CodeSpace::V4,
        change_response: ChangeResponse::Header,
        repeats_addresses: true,
        max_parameters: 39,
        max_values: u16::MAX,
        served_values: u16::MAX,
        max_block: 240,
        texts: true,
        substitution_only: false,
        exact_length: false,
        bad_axis: ErrorNumber::NO_AXIS,
        bad_request: (0x81, ErrorNumber::SERVICE),
        bad_count: None,
        bad_attribute: ErrorNumber::ADDRESS,
        bad_member: ErrorNumber::SUBINDEX,
        too_short: ErrorNumber::VALUE_COUNT,
        too_few_addresses: None,
        trailing: None,
        too_many_values: ErrorNumber::VALUE_COUNT,
        not_saved: ErrorNumber::NOT_NOW,
        error_info: true,
        bad_reference: None,
        fault_counter: Counting::Changes,
        error_names: ErrorNames::Profile,
    };

    /// Kollmorgen AKD: axis 0, formats 0x41 to 0x43, six-octet positive change response, no texts,
    /// PNU 944 counts situations.
    pub const AKD: Self = Self {
        name: "AKD",
        axis: 0,
        axis_checked: true,
        change_response: ChangeResponse::HeaderAndZero,
        substitution_only: true,
        texts: false,
        fault_counter: Counting::Situations,
        ..Self::STANDARD
    };

    /// Danfoss VLT with the PROFINET option: axis 0, true types with V2/V3 codes, 37 parameters, three more requests,
    /// data of exactly the size requested.
    ///
    /// Interpretation: the error number for octets too many (0x18) and the response ID for an unknown request (0x81) are
    /// in no public document.
    pub const VLT: Self = Self {
        name: "VLT",
        requests: &[
            RequestId::Read,
            RequestId::Change,
            RequestId::ChangePermanent,
            RequestId::ReadWide,
            RequestId::ChangeWide,
        ],
        saving: Saving::Request,
        axis: 0,
        axis_checked: true,
        code_space: CodeSpace::V3,
        repeats_addresses: false,
        max_parameters: 37,
        exact_length: true,
        bad_axis: ErrorNumber::DANFOSS_WRONG_AXIS,
        bad_request: (0x81, ErrorNumber::DANFOSS_UNKNOWN_SERVICE),
        trailing: Some(ErrorNumber::VALUE_COUNT),
        error_names: ErrorNames::Danfoss,
        ..Self::STANDARD
    };

    /// Vacon OPTEA and OPTE9: axis 1, no texts, own error numbers for malformed requests, errors without additional
    /// information.
    ///
    /// Interpretation: 0x6D (invalid change request) is the answer to octets behind the values; a wrong axis gets the
    /// profile's 0x19, as OPTEA has 0x67 as reserved. OPTEA p. 119 allows 1 to 234 elements of an array, p. 120 names
    /// 39 values for a frame: a drive answers what fits a block, a client requests 39 at a time, which is right for
    /// both. That errors have no additional information is how the examples of the manual look. 0x6E (general error)
    /// answers a value that could not be stored.
    pub const VACON: Self = Self {
        name: "Vacon",
        saving: Saving::Always,
        axis: 1,
        axis_checked: true,
        repeats_addresses: false,
        max_values: 39,
        texts: false,
        substitution_only: true,
        bad_request: (0x80, ErrorNumber::SERVICE),
        bad_count: Some(ErrorNumber::VACON_PARAMETERS),
        bad_attribute: ErrorNumber::VACON_ATTRIBUTE,
        bad_member: ErrorNumber::VACON_NOT_FOUND,
        too_short: ErrorNumber::VACON_TOO_SHORT,
        too_few_addresses: Some(ErrorNumber::VACON_TOO_SHORT),
        trailing: Some(ErrorNumber::VACON_INVALID_CHANGE),
        too_many_values: ErrorNumber::VACON_INVALID_CHANGE,
        not_saved: ErrorNumber::VACON_GENERAL,
        error_info: false,
        bad_reference: Some(ErrorNumber::VACON_REFERENCE),
        error_names: ErrorNames::Vacon,
        ..Self::STANDARD
    };

    /// Returns true when the drive supports requests with this ID.
    #[must_use]
    pub fn knows(&self, id: RequestId) -> bool {
        self.requests.contains(&id)
    }

    /// Returns the request that changes a value so that it lasts like that; `None` when the drive has none, see
    /// [`saving`](Self::saving).
    #[must_use]
    pub fn change_id(&self, keep: Keep) -> Option<RequestId> {
        let id = match (keep, self.saving) {
            (Keep::Volatile, _) | (Keep::Permanent, Saving::Always) => RequestId::Change,
            (Keep::Permanent, _) => RequestId::ChangePermanent,
        };
        self.knows(id).then_some(id)
    }
}
