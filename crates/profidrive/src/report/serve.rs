//! What a server for browsers reports.

use serde::Serialize;

/// A server that is ready for browsers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ServeReport {
    /// `ready`.
    pub event: &'static str,
    /// The address to open, with the token that allows everything.
    pub url: String,
    /// The address with the token that allows to look and to stop.
    pub view_url: String,
    /// Whether the drives are virtual.
    pub simulation: bool,
    /// Fingerprint (SHA-256, `AB:CD:..`) of the certificate; null without encryption.
    pub fingerprint: Option<String>,
}
