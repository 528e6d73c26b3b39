//! The PKW channel: the parameter channel of PROFIdrive V2, in the words of a PPO and on serial lines.
//!
//! One parameter at a time travels in eight octets: PKE says what is wanted and of which parameter, IND which element,
//! PWE is the value. A request stands until its reply comes; then the reply stands. How the octets travel is not this
//! module's business: in the cyclic data of a PPO, or in a serial telegram.
//!
//! * [`Pkw`] is the telegram, [`REQUESTS`] and [`REPLIES`] are its codes, [`PkwErrorNumber`] is the cause of a refusal;
//! * a drive answers with a [`Server`] over its [`ParameterAccess`](crate::parameter::ParameterAccess);
//! * a master uses a [`Client`], one [`Job`] after the other;
//! * vendors and carriers differ by data: [`PkwDialect`].
//!
//! Source: PROFIdrive V2 parameter channel as printed in Danfoss FC parameter block description p. 73, Siemens CU240S
//! p. 123, Kollmorgen S300 PROFIBUS p. 18.
//!
//! ```
//! use profidrive_profile::pkw::{Pkw, PkwDialect, RequestCode};
//! let request = Pkw::from_octets([0x15, 0xFA, 0, 1, 0, 0, 0, 0]);
//! assert_eq!(request.request_code(), RequestCode::READ);
//! let address = request.address(&PkwDialect::DANFOSS_FC).unwrap();
//! assert_eq!((address.pnu, address.subindex), (1530, 1));
//! ```

mod client;
mod code;
mod dialect;
mod error;
mod generated_errors;
mod job;
mod server;
#[cfg(test)]
mod tests;
mod words;

pub use client::{Client, ClientTiming, Outcome, Spontaneous};
pub use code::{Action, Memory, REPLIES, REQUESTS, ReplyCode, ReplyInfo, RequestCode, RequestInfo, Width};
pub use dialect::{IndLayout, PAGES, PageRow, PkwDialect, PlainArray};
pub use error::{PKW_ERRORS, PkwErrorInfo, PkwErrorNames, PkwErrorNumber};
pub use job::{Answer, Job, JobError, PkwValue, StartError};
pub use server::{BlockError, Server};
pub use words::{
    MAX_BLOCK, MAX_TEXT, PKW_LEN, Pkw, PkwAddress, ReplyWords, RequestWords, TEXT_AT, TEXT_READ, TEXT_WRITE,
    Words,
};
