//! `profidrive scan`

use std::collections::BTreeMap;

use client::ErrorKind;
use client::Wait;
use profidrive::report::{ScanReport, Station};

use crate::args::{Interface, Scan};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;
use crate::render::table::Table;

pub fn run(args: &Scan, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let mut session = connect::session(interface, Need::Discovery, output)?;
    let spinner = connect::spinner(output, format!("listening for {} ms", args.time.as_millis()));
    let stations = session.scan(args.time).wait();
    spinner.finish_and_clear();
    let report = ScanReport {
        stations: stations?.iter().map(Station::from).collect(),
    };
    output.report(&report);
    if report.stations.is_empty() {
        return Err(Failure::new(ErrorKind::Unreachable, "no station answered")
            .hint("check cable, interface and power"));
    }
    if !output.json() {
        for warning in warnings(&report.stations) {
            output.warn(&warning);
        }
    }
    Ok(())
}

impl Page for ScanReport {
    fn print(&self, output: &Output) {
        let mut table = Table::new(&["name", "MAC", "IP", "vendor", "device", "model", "type", "role"]);
        let absent = || "-".to_owned();
        for station in &self.stations {
            let ip = station.ip.as_ref().zip(station.prefix);
            table.row([
                station.name.clone().unwrap_or_else(absent),
                station.mac.clone(),
                ip.map_or_else(absent, |(ip, prefix)| format!("{ip}/{prefix}")),
                format!("0x{:04X}", station.vendor_id),
                format!("0x{:04X}", station.device_id),
                station.model.unwrap_or_default().to_owned(),
                station.station_type.clone(),
                station.role.unwrap_or_default().to_owned(),
            ]);
        }
        output.table(&table);
    }
}

/// Names and addresses that more than one station has.
fn warnings(stations: &[Station]) -> Vec<String> {
    let mut owners: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for station in stations {
        let name = station.name.as_ref().map(|name| format!("the name {name}"));
        let ip = station.ip.as_ref().map(|ip| format!("the address {ip}"));
        for what in [name, ip].into_iter().flatten() {
            owners.entry(what).or_default().push(&station.mac);
        }
    }
    owners
        .into_iter()
        .filter(|(_, macs)| macs.len() > 1)
        .map(|(what, macs)| format!("{} stations have {what}: {}", macs.len(), macs.join(" and ")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use profinet::MacAddress;

    #[test]
    fn duplicate_names_are_reported() {
        let station = |last| {
            Station::from(&profinet::controller::Station {
                mac: MacAddress([2, 0, 0, 0, 0, last]),
                name: "akd-1".into(),
                vendor_id: 0x0105,
                device_id: 1,
                role: 1,
                ..Default::default()
            })
        };
        let stations = [station(1), station(2)];
        assert_eq!(
            warnings(&stations),
            ["2 stations have the name akd-1: 02:00:00:00:00:01 and 02:00:00:00:00:02"]
        );
        assert_eq!(
            (stations[0].model, stations[0].role),
            (Some("AKD"), Some("device"))
        );
    }
}
