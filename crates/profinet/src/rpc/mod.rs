//! Calls over UDP: a [`Server`] that never executes a call twice, a [`Client`] that repeats until it is answered,
//! and the [endpoint mapper](EndpointMapper). Both sides of PROFINET use both.
//!
//! C706 "DCE 1.1: Remote Procedure Call" chapters 9 to 12; IEC 61158-6-10.

mod client;
mod epm;
mod fragment;
mod path;
mod server;

pub use client::{CallError, CallId, Client, ClientConfig, Reply};
pub use epm::{EndpointMapper, Registration, annotation};
pub use path::PathCount;
pub use server::{Call, CallKey, Interface, Server, ServerLimits};

#[cfg(test)]
mod tests;
