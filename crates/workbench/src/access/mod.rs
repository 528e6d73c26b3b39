//! Who may use a server: tokens, sessions, hosts, origins and the headers of each response.

mod claimed;
mod guard;
mod headers;
mod origin;
mod session;
mod tls;
mod token;

pub(crate) use claimed::{Claimed, person};
pub(crate) use guard::{Caller, Stops, guard, session_of};
pub(crate) use headers::secure;
pub(crate) use origin::{Peer, Places};
pub(crate) use session::{IDLE, LIFETIME, SESSIONS, Sessions};
pub(crate) use tls::Tls;
pub use tls::TlsError;
pub(crate) use token::{Attempts, Once, Tokens};

use schemars::JsonSchema;
use serde::Serialize;

/// What a session may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Role {
    /// Look, change and move.
    Control,
    /// Look, and stop.
    View,
}
