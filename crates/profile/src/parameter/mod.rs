//! Base mode parameter access: requests, responses and the parameter manager that turns one into the other.
//!
//! A request block names parameters (and carries values when it changes them); a response block carries values or
//! errors *in the order of the request* and does not repeat the addresses. How the blocks travel is not this module's
//! business (on PROFINET: records 0xB02E, 0xB02F and 0x002F).
//!
//! * a drive answers with [`serve`] over its [`ParameterAccess`];
//! * a client writes with [`encode_read`] and [`encode_change`], packs many parameters with [`plan_reads`] and
//!   [`plan_changes`], and reads the answer with [`Response`];
//! * vendors differ by data: [`Dialect`].
//!
//! Source: PROFIdrive base mode parameter access; AKD PROFINET manual 3.6.
//!
//! ```
//! use profidrive_profile::parameter::{Answer, Dialect, ParameterAddress, RequestId, Response, encode_read};
//! let address = ParameterAddress::value(930, 0);
//! let mut request = [0; 10];
//! let length = encode_read(5, &Dialect::AKD, &[address], &mut request).unwrap();
//! assert_eq!(request[..length], [5, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0]);
//! let bytes = [5, 1, 0, 1, 0x42, 1, 0, 1];
//! let response = Response::parse(&bytes, RequestId::Read, 5, &[address], &Dialect::AKD).unwrap();
//! let Some(Answer::Values(block)) = response.answers().next() else { panic!() };
//! assert_eq!(block.raw(0), Some(1));
//! ```

mod access;
mod address;
mod block;
mod description;
mod dialect;
mod error;
mod format;
mod generated_errors;
mod generated_formats;
mod objection;
mod plan;
pub mod pnu;
mod request;
mod response;
mod saving;
mod serve;
mod span;
#[cfg(test)]
mod tests;

pub use access::{Attributes, Keep, ParameterAccess, SaveId, SaveState};
pub use address::{Attribute, DecodeError, MAX_ELEMENTS, ParameterAddress, RequestId, Wrong};
pub use block::{Value, ValueBlock};
pub use description::{Description, Identifier};
pub use dialect::{ChangeResponse, Dialect, Saving};
pub use error::{ERRORS, ErrorInfo, ErrorNames, ErrorNumber, ParameterError};
pub use format::{CodeSpace, FORMATS, Format, FormatInfo, Integer, Kind, Octets};
pub use objection::{Forbidden, Objection, objections};
pub use plan::{plan_changes, plan_reads, split_array};
pub use request::{
    EncodeError, NewValue, Request, encode_change, encode_change_as, encode_read, encode_read_as,
};
pub use response::{Answer, Answers, Response, ResponseError, repeats_addresses};
pub use saving::{SavingChange, Served, not_saved, serve_saving};
pub use serve::{Refusal, serve};
