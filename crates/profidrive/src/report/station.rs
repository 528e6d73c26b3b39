//! What the verbs report that name, address, show and reset stations.

use profinet::IpSuite;
use serde::Serialize;

/// A new name of a station.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NameReport {
    /// Ethernet address of the station.
    pub mac: String,
    /// Its name before.
    pub old: Option<String>,
    /// Its name now; null where it was taken away.
    pub name: Option<String>,
    /// Whether the name is kept over power-off.
    pub permanent: bool,
    /// Whether nothing was changed.
    pub dry_run: bool,
}

impl NameReport {
    /// Returns a new name of a station.
    #[must_use]
    pub fn new(station: &profinet::controller::Station, wanted: &crate::addressing::NewName) -> Self {
        let named = |name: &str| Some(name.to_owned()).filter(|name| !name.is_empty());
        Self {
            mac: station.mac.to_string(),
            old: named(&station.name),
            name: named(&wanted.name),
            permanent: wanted.permanent,
            dry_run: wanted.dry_run,
        }
    }
}

/// A new IP address of a station.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IpReport {
    /// Ethernet address of the station.
    pub mac: String,
    /// Its name.
    pub name: Option<String>,
    /// Its IP address.
    pub ip: String,
    /// Its subnet mask.
    pub mask: String,
    /// Its gateway.
    pub gateway: Option<String>,
    /// Whether the address is kept over power-off.
    pub permanent: bool,
    /// Whether nothing was changed.
    pub dry_run: bool,
}

impl IpReport {
    /// Returns a new address of a station.
    #[must_use]
    pub fn new(station: &profinet::controller::Station, ip: IpSuite, permanent: bool, dry_run: bool) -> Self {
        Self {
            mac: station.mac.to_string(),
            name: Some(station.name.clone()).filter(|name| !name.is_empty()),
            ip: ip.address.to_string(),
            mask: ip.mask.to_string(),
            gateway: (!ip.gateway.is_unspecified()).then(|| ip.gateway.to_string()),
            permanent,
            dry_run,
        }
    }
}

/// A station that blinked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlinkReport {
    /// Ethernet address of the station.
    pub mac: String,
}

/// A station that was reset.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResetReport {
    /// Ethernet address of the station.
    pub mac: String,
    /// Number of the reset (ResetToFactoryModes).
    pub mode: u8,
    /// What was reset.
    pub what: &'static str,
}
