//! Checks whether a name or an address of a drive is in use on the segment.

use std::collections::BTreeSet;
use std::fmt;
use std::net::Ipv4Addr;
use std::time::Duration;

use network::ethernet::Runner;
use network::host::{Host, StationId};
use network::probe::Probe;
use network::system::{InterfaceInfo, now};
use profinet::controller::{self, Controller, ControllerConfig, Filter, IdentifyOptions, Station};
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};

use super::error::HostError;
use super::event::{Event, EventSender};
use crate::control_socket::neighbours;
use crate::text::station_text;

/// How stations are identified: responses spread over 100 ms.
const IDENTIFY: IdentifyOptions = IdentifyOptions {
    delay_factor: 10,
    margin: Duration::from_millis(200),
    sends: 2,
};
/// How long to wait for responses.
const TIMEOUT: Duration = Duration::from_millis(320);

/// What a drive is about to take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Its name in this simulation.
    pub key: String,
    pub mac: MacAddress,
    pub name: String,
    pub ip: IpSuite,
}

impl Wanted {
    pub fn new(key: &str, mac: MacAddress, network: &Stored) -> Self {
        Self {
            key: key.to_owned(),
            mac,
            name: network.name.clone(),
            ip: network.ip,
        }
    }
}

/// The duplicate check: a search for stations with the same name or address. It runs beside the drives, so that
/// starting them does not wait for it.
#[derive(Debug)]
pub struct DuplicateCheck {
    wanted: Vec<Wanted>,
    others: Vec<Station>,
    probe: StationId,
    due: Instant,
}

impl DuplicateCheck {
    /// Queries the other simulations on this interface by their sockets, which answer at once, and begins to search the
    /// segment by DCP and ARP.
    ///
    /// # Errors
    /// When another simulation has the MAC address of a drive: no frame would find the right one.
    pub fn start(runner: &mut Runner, wanted: Vec<Wanted>) -> Result<Self, HostError> {
        let others = neighbours(&runner.interface().name);
        same_mac(&wanted, &others)?;
        let own = runner.interface().usable()?;
        let addresses: Vec<Ipv4Addr> = wanted
            .iter()
            .filter(|drive| drive.ip.is_set())
            .map(|drive| drive.ip.address)
            .collect();
        let begin = now();
        let mut controller = Controller::new(ControllerConfig::new(own, IpSuite::NONE, "profidrive", 1));
        controller.identify_with(begin, Filter::all(), IDENTIFY)?;
        let probe = runner.attach(Box::new(Probe::new(Host::new(controller), addresses)))?;
        Ok(Self {
            wanted,
            others,
            probe,
            due: begin + TIMEOUT,
        })
    }

    /// Returns the time when all who respond have responded.
    pub const fn due(&self) -> Instant {
        self.due
    }

    /// Reports names and addresses that are in use, on the segment or by this computer. That can be what is to be
    /// tried, so it is not an error.
    ///
    /// # Errors
    /// When a station on the segment has the MAC address of a drive.
    pub fn finish(mut self, runner: &mut Runner, events: &EventSender) -> Result<(), HostError> {
        let answers = answers(runner, self.probe);
        self.others.extend(answers);
        same_mac(&self.wanted, &self.others)?;
        let own = InterfaceInfo::list().unwrap_or_default();
        let own = own
            .iter()
            .flat_map(|info| info.addresses.iter().map(|ip| (ip.address, info.name.as_str())));
        for duplicate in duplicates(&self.wanted, &self.others, &own.collect::<Vec<_>>()) {
            events.send(Event::Duplicate(duplicate));
        }
        Ok(())
    }
}

/// A name or an address of a drive that is in use elsewhere.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Duplicate {
    /// A station on the segment has the IP address of a drive.
    Address {
        /// The address.
        address: Ipv4Addr,
        /// Name of the drive in this simulation.
        drive: String,
        /// The other station in words.
        other: String,
    },
    /// This computer has the IP address of a drive.
    OwnAddress {
        /// The address.
        address: Ipv4Addr,
        /// Name of the drive in this simulation.
        drive: String,
        /// The interface that has it.
        interface: String,
    },
    /// A station on the segment has the name of a drive.
    Name {
        /// The name of station.
        name: String,
        /// The other station in words.
        other: String,
    },
}

impl fmt::Display for Duplicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Address {
                address,
                drive,
                other,
            } => {
                write!(
                    f,
                    "the address {address} of {drive} is taken on this segment: {other}"
                )
            }
            Self::OwnAddress {
                address,
                drive,
                interface,
            } => write!(
                f,
                "the address {address} of {drive} is this computer's own, on {interface}"
            ),
            Self::Name { name, other } => write!(
                f,
                "the name {name} is taken on this segment: {other}; a controller finds two of it"
            ),
        }
    }
}

/// Returns the stations that responded to DCP or ARP; removes the probe.
fn answers(runner: &mut Runner, id: StationId) -> Vec<Station> {
    let mut stations = Vec::new();
    if let Some(probe) = runner.station_mut::<Probe<Host<Controller>>>(id) {
        while let Some(event) = probe.inner_mut().endpoint_mut().poll_event() {
            if let controller::Event::Identified { station, .. } = event {
                stations.push(station);
            }
        }
        // a PROFINET station answers both
        for (address, mac) in probe.found() {
            let known = |station: &Station| station.mac == *mac && station.ip.address == *address;
            if !stations.iter().any(known) {
                stations.push(Station {
                    mac: *mac,
                    ip: IpSuite {
                        address: *address,
                        ..IpSuite::NONE
                    },
                    ..Station::default()
                });
            }
        }
    }
    runner.detach(id);
    stations
}

fn same_mac(wanted: &[Wanted], others: &[Station]) -> Result<(), HostError> {
    let both = wanted
        .iter()
        .find_map(|drive| Some((drive, others.iter().find(|other| other.mac == drive.mac)?)));
    match both {
        None => Ok(()),
        Some((drive, other)) => Err(HostError::MacInUse {
            drive: drive.key.clone(),
            other: describe(other),
        }),
    }
}

fn describe(station: &Station) -> String {
    let name = match station.name.as_str() {
        "" => "no name",
        name => name,
    };
    station_text(name, station.mac, station.ip)
}

/// Names and IP addresses that are in use, each once.
fn duplicates(wanted: &[Wanted], others: &[Station], own: &[(Ipv4Addr, &str)]) -> BTreeSet<Duplicate> {
    let mut found = BTreeSet::new();
    for drive in wanted {
        for other in others.iter().filter(|other| other.mac != drive.mac) {
            if !drive.name.is_empty() && other.name == drive.name {
                found.insert(Duplicate::Name {
                    name: drive.name.clone(),
                    other: describe(other),
                });
            }
            if drive.ip.is_set() && other.ip.address == drive.ip.address {
                let nameless = other.name.is_empty();
                found.insert(Duplicate::Address {
                    address: drive.ip.address,
                    drive: drive.key.clone(),
                    other: if nameless {
                        other.mac.to_string()
                    } else {
                        describe(other)
                    },
                });
            }
        }
        for (address, interface) in own.iter().filter(|(address, _)| *address == drive.ip.address) {
            found.insert(Duplicate::OwnAddress {
                address: *address,
                drive: drive.key.clone(),
                interface: (*interface).to_owned(),
            });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suite(last: u8) -> IpSuite {
        IpSuite {
            address: [10, 0, 0, last].into(),
            mask: [255, 255, 255, 0].into(),
            ..IpSuite::NONE
        }
    }

    fn station(name: &str, mac: u8, ip: IpSuite) -> Station {
        Station {
            name: name.into(),
            mac: MacAddress([2, 0, 0, 0, 0, mac]),
            ip,
            ..Station::default()
        }
    }

    fn wanted(name: &str, mac: u8, ip: IpSuite) -> Wanted {
        Wanted {
            key: if name.is_empty() { "drive-1" } else { name }.into(),
            mac: MacAddress([2, 0, 0, 0, 0, mac]),
            name: name.into(),
            ip,
        }
    }

    #[test]
    fn what_is_in_use_is_reported_once() {
        let drives = [
            wanted("akd-1", 1, suite(11)),
            wanted("akd-2", 2, suite(12)),
            wanted("", 3, IpSuite::NONE),
        ];
        assert!(duplicates(&drives, &[station("", 9, IpSuite::NONE)], &[]).is_empty());
        let others = [
            station("akd-1", 7, suite(50)),
            station("akd-1", 7, suite(50)),
            station("", 8, suite(12)),
            station("pump", 9, suite(11)),
        ];
        let found = duplicates(&drives, &others, &[(suite(12).address, "eth0")]);
        let texts: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "the address 10.0.0.11 of akd-1 is taken on this segment: pump (02:00:00:00:00:09, 10.0.0.11)",
                "the address 10.0.0.12 of akd-2 is taken on this segment: 02:00:00:00:00:08",
                "the address 10.0.0.12 of akd-2 is this computer's own, on eth0",
                "the name akd-1 is taken on this segment: akd-1 (02:00:00:00:00:07, 10.0.0.50); a controller finds two of it",
            ]
        );
        same_mac(&drives, &others).unwrap();
        let error = same_mac(&drives, &[station("akd-9", 2, suite(9))]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the MAC address of akd-2 is in use on this segment: akd-9 (02:00:00:00:00:02, 10.0.0.9)"
        );
    }
}
