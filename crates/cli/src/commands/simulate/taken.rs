//! Whether somebody else on the segment has the name or an address of a drive.

use std::collections::BTreeSet;
use std::net::Ipv4Addr;
use std::time::Duration;

use client::describe;
use network::host::{Host, StationId};
use network::linux::{InterfaceInfo, Runner, now};
use network::probe::Probe;
use profinet::controller::{Controller, ControllerConfig, Event, Filter, IdentifyOptions, Station};
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};

use crate::desk;
use crate::failure::{Exit, Failure};
use crate::output::Output;

/// How everybody is asked: answers spread over 100 ms.
const ASKED: IdentifyOptions = IdentifyOptions {
    delay_factor: 10,
    margin: Duration::from_millis(200),
    sends: 2,
};
/// How long answers are waited for.
const PATIENCE: Duration = Duration::from_millis(320);

/// What a drive is about to take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// What it is called on the command line.
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

/// The question who is there. It is asked while the drives run already, so that nobody waits for it.
#[derive(Debug)]
pub struct Question {
    wanted: Vec<Wanted>,
    others: Vec<Station>,
    probe: StationId,
    due: Instant,
}

impl Question {
    /// Asks the other simulations on this interface by their sockets, which are there at once, and begins to ask the
    /// segment by DCP and ARP.
    ///
    /// # Errors
    /// When another simulation has the MAC address of a drive: no frame would find the right one.
    pub fn ask(runner: &mut Runner, wanted: Vec<Wanted>) -> Result<Self, Failure> {
        let others = desk::neighbours(&runner.interface().name);
        same_mac(&wanted, &others)?;
        let own = runner.interface().usable()?;
        let addresses: Vec<Ipv4Addr> = wanted
            .iter()
            .filter(|drive| drive.ip.is_set())
            .map(|drive| drive.ip.address)
            .collect();
        let begin = now();
        let mut controller = Controller::new(ControllerConfig::new(own, IpSuite::NONE, "profidrive", 1));
        controller
            .identify_with(begin, Filter::all(), ASKED)
            .map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
        let probe = runner.attach(Box::new(Probe::new(Host::new(controller), addresses)))?;
        Ok(Self {
            wanted,
            others,
            probe,
            due: begin + PATIENCE,
        })
    }

    /// When all who answer have answered.
    pub const fn due(&self) -> Instant {
        self.due
    }

    /// What came of it. Names and addresses that are taken, on the segment or by this computer, are warned of only, as
    /// that can be what is to be tried.
    ///
    /// # Errors
    /// When somebody on the segment has the MAC address of a drive.
    pub fn tell(mut self, runner: &mut Runner, output: &Output) -> Result<(), Failure> {
        let answers = answers(runner, self.probe);
        self.others.extend(answers);
        same_mac(&self.wanted, &self.others)?;
        let own = InterfaceInfo::list().unwrap_or_default();
        let own = own
            .iter()
            .flat_map(|info| info.addresses.iter().map(|ip| (ip.address, info.name.as_str())));
        for words in warnings(&self.wanted, &self.others, &own.collect::<Vec<_>>()) {
            output.warn(&words);
        }
        Ok(())
    }
}

/// Who answered to DCP, and who to ARP; takes the probe away.
fn answers(runner: &mut Runner, id: StationId) -> Vec<Station> {
    let mut stations = Vec::new();
    if let Some(probe) = runner.station_mut::<Probe<Host<Controller>>>(id) {
        while let Some(event) = probe.inner_mut().endpoint_mut().poll_event() {
            if let Event::Identified { station, .. } = event {
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

fn same_mac(wanted: &[Wanted], others: &[Station]) -> Result<(), Failure> {
    let both = wanted
        .iter()
        .find_map(|drive| Some((drive, others.iter().find(|other| other.mac == drive.mac)?)));
    let Some((drive, other)) = both else {
        return Ok(());
    };
    let message = format!(
        "the MAC address of {} is in use on this segment: {}",
        drive.key,
        describe(other)
    );
    Err(Failure::new(Exit::Failed, message)
        .hint("does the same simulation run already? Another --name or --mac makes another drive"))
}

/// Names and IP addresses that are taken, each in one line.
fn warnings(wanted: &[Wanted], others: &[Station], own: &[(Ipv4Addr, &str)]) -> Vec<String> {
    let mut told = BTreeSet::new();
    for drive in wanted {
        for other in others.iter().filter(|other| other.mac != drive.mac) {
            if !drive.name.is_empty() && other.name == drive.name {
                told.insert(format!(
                    "the name {} is taken on this segment: {}; a controller finds two of it",
                    drive.name,
                    describe(other)
                ));
            }
            if drive.ip.is_set() && other.ip.address == drive.ip.address {
                let who = if other.name.is_empty() {
                    other.mac.to_string()
                } else {
                    describe(other)
                };
                told.insert(format!(
                    "the address {} of {} is taken on this segment: {who}",
                    drive.ip.address, drive.key
                ));
            }
        }
        for (address, interface) in own.iter().filter(|(address, _)| *address == drive.ip.address) {
            told.insert(format!(
                "the address {address} of {} is this computer's own, on {interface}",
                drive.key
            ));
        }
    }
    told.into_iter().collect()
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
    fn what_is_taken_is_told_once() {
        let drives = [
            wanted("akd-1", 1, suite(11)),
            wanted("akd-2", 2, suite(12)),
            wanted("", 3, IpSuite::NONE),
        ];
        assert_eq!(
            warnings(&drives, &[station("", 9, IpSuite::NONE)], &[]),
            Vec::<String>::new()
        );
        let others = [
            station("akd-1", 7, suite(50)),
            station("akd-1", 7, suite(50)),
            station("", 8, suite(12)),
            station("pump", 9, suite(11)),
        ];
        assert_eq!(
            warnings(&drives, &others, &[(suite(12).address, "eth0")]),
            [
                "the address 10.0.0.11 of akd-1 is taken on this segment: pump (02:00:00:00:00:09, 10.0.0.11)",
                "the address 10.0.0.12 of akd-2 is taken on this segment: 02:00:00:00:00:08",
                "the address 10.0.0.12 of akd-2 is this computer's own, on eth0",
                "the name akd-1 is taken on this segment: akd-1 (02:00:00:00:00:07, 10.0.0.50); a controller finds two of it",
            ]
        );
        assert_eq!(same_mac(&drives, &others), Ok(()));
        let failure = same_mac(&drives, &[station("akd-9", 2, suite(9))]).unwrap_err();
        assert_eq!(
            failure.message,
            "the MAC address of akd-2 is in use on this segment: akd-9 (02:00:00:00:00:02, 10.0.0.9)"
        );
    }
}
