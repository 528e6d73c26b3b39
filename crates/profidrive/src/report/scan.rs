//! What is on a network.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::{InfoReport, Station};

/// The stations on a network.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScanReport {
    /// The stations that answered.
    pub stations: Vec<Scanned>,
    /// Whether more stations answered than one search takes; those are missing here.
    pub more: bool,
}

/// A station that answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scanned {
    /// How it answered to discovery.
    #[serde(flatten)]
    pub station: Station,
    /// What is to be known about its name and its address.
    pub remarks: Vec<Remark>,
    /// Its own description; null where it was not read.
    pub info: Option<InfoReport>,
    /// Why it was not read, or what of it was not answered; null where all was read, or where this was not requested.
    pub unread: Option<String>,
}

/// What is to be known about the name or the address of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Remark {
    /// It has no name: no controller finds it.
    NoName,
    /// It has no IP address: nothing can be read.
    NoAddress,
    /// It is in another subnet and has no gateway: no answer can come to this computer.
    OtherSubnet,
    /// It is in another subnet: it takes a router between them.
    Routed,
    /// Another station has the same name.
    NameTwice,
    /// Another station has the same address.
    AddressTwice,
    /// It reports itself that another station has its address.
    Conflict,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoName => "no name",
            Self::NoAddress => "no IP address",
            Self::OtherSubnet => "other subnet",
            Self::Routed => "other subnet, by a router",
            Self::NameTwice => "name used twice",
            Self::AddressTwice => "address used twice",
            Self::Conflict => "reports an address conflict",
        })
    }
}

impl ScanReport {
    /// Returns what is to be known where more stations answered than one search takes.
    #[must_use]
    pub fn incomplete(&self) -> Option<String> {
        self.more.then(|| {
            format!(
                "more than {} stations answered: one search takes no more, and the others are not shown",
                self.stations.len()
            )
        })
    }

    /// Returns the report on stations that were not read, those with the same name or address marked.
    #[must_use]
    pub fn new(stations: impl IntoIterator<Item = (Station, Vec<Remark>)>) -> Self {
        let scanned = |(station, remarks)| Scanned {
            station,
            remarks,
            info: None,
            unread: None,
        };
        let mut report = Self {
            stations: stations.into_iter().map(scanned).collect(),
            more: false,
        };
        for Duplicate { what, stations } in report.duplicates() {
            let remark = match what {
                Shared::Name(_) => Remark::NameTwice,
                Shared::Address(_) => Remark::AddressTwice,
            };
            let of_them = |one: &&mut Scanned| stations.contains(&one.station.mac);
            for one in report.stations.iter_mut().filter(of_them) {
                one.remarks.push(remark);
            }
        }
        report
    }

    /// Returns the names and addresses that more than one station has.
    #[must_use]
    pub fn duplicates(&self) -> Vec<Duplicate> {
        let mut owners: BTreeMap<Shared, Vec<String>> = BTreeMap::new();
        for Scanned { station, .. } in &self.stations {
            let name = station.name.clone().map(Shared::Name);
            let ip = station.ip.clone().map(Shared::Address);
            for what in [name, ip].into_iter().flatten() {
                owners.entry(what).or_default().push(station.mac.clone());
            }
        }
        owners
            .into_iter()
            .filter(|(_, stations)| stations.len() > 1)
            .map(|(what, stations)| Duplicate { what, stations })
            .collect()
    }
}

/// What only one station may have.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shared {
    /// A station name.
    Name(String),
    /// An IP address.
    Address(String),
}

/// A name or an address that more than one station has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Duplicate {
    /// The name or the address.
    pub what: Shared,
    /// The Ethernet addresses of the stations that have it.
    pub stations: Vec<String>,
}

impl fmt::Display for Duplicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, stations } = self;
        let what = match what {
            Shared::Name(name) => format!("the name {name}"),
            Shared::Address(address) => format!("the address {address}"),
        };
        write!(
            f,
            "{} stations have {what}: {}",
            stations.len(),
            stations.join(" and ")
        )
    }
}

/// A station that came, went or is another one than before.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StationChange {
    /// When, in seconds since the first answer was asked for.
    pub time: f64,
    /// What happened.
    pub change: Change,
    /// The station as it answered last.
    pub station: Station,
    /// As it was before; null for one that came or went.
    pub before: Option<Station>,
}

/// What happened to a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// It answers for the first time.
    Came,
    /// It no longer answers.
    Went,
    /// It has another name or address.
    Changed,
}

#[cfg(test)]
mod tests {
    use profinet::MacAddress;

    use super::*;

    #[test]
    fn what_two_stations_share_is_reported_and_remarked() {
        let station = |last: u8, name: &str| {
            Station::from(&profinet::controller::Station {
                mac: MacAddress([2, 0, 0, 0, 0, last]),
                name: name.into(),
                vendor_id: 0x0105,
                device_id: 1,
                role: 1,
                ..Default::default()
            })
        };
        let stations = [station(1, "akd-1"), station(2, "akd-1"), station(3, "akd-3")];
        let report = ScanReport::new(stations.map(|one| (one, Vec::new())));
        let texts: Vec<String> = report.duplicates().iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            ["2 stations have the name akd-1: 02:00:00:00:00:01 and 02:00:00:00:00:02"]
        );
        let remarks: Vec<&[Remark]> = report.stations.iter().map(|one| &*one.remarks).collect();
        assert_eq!(remarks, [&[Remark::NameTwice][..], &[Remark::NameTwice], &[]]);
        let first = &report.stations[0].station;
        assert_eq!(
            (first.model, first.role, first.vendor),
            (Some("AKD"), Some("device"), Some("Kollmorgen"))
        );
    }
}
