//! `profidrive scan`

use client::Wait;
use std::collections::BTreeMap;

use profile::model::Model;
use profinet::controller::Station;
use profinet::wire::dcp::role;
use serde_json::Value;

use crate::args::{Interface, Scan};
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;
use crate::render::table::Table;

pub fn run(args: &Scan, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let mut session = connect::session(interface, Need::Discovery, None, output)?;
    let spinner = connect::spinner(output, format!("listening for {} ms", args.time.as_millis()));
    let stations = session.scan(args.time).wait();
    spinner.finish_and_clear();
    let stations = stations?;
    if output.json() {
        let list: Vec<Value> = stations.iter().map(json).collect();
        output.document("scan", fields! { "stations": list });
    } else if !stations.is_empty() {
        for line in table(&stations).lines() {
            output.line(&line);
        }
    }
    if stations.is_empty() {
        return Err(
            Failure::new(Exit::Unreachable, "no station answered").hint("check cable, interface and power")
        );
    }
    if !output.json() {
        for warning in warnings(&stations) {
            output.warn(&warning);
        }
    }
    Ok(())
}

fn table(stations: &[Station]) -> Table {
    let mut table = Table::new(&["name", "MAC", "IP", "vendor", "device", "model", "type", "role"]);
    for station in stations {
        let prefix = u32::from(station.ip.mask).leading_ones();
        let ip = if station.ip.is_set() {
            format!("{}/{prefix}", station.ip.address)
        } else {
            "-".into()
        };
        let model = Model::of(station.vendor_id, station.device_id);
        table.row([
            if station.name.is_empty() {
                "-".into()
            } else {
                station.name.clone()
            },
            station.mac.to_string(),
            ip,
            format!("0x{:04X}", station.vendor_id),
            format!("0x{:04X}", station.device_id),
            if model.catalogue.is_some() {
                model.name.into()
            } else {
                String::new()
            },
            station.station_type.clone(),
            role_word(station.role).into(),
        ]);
    }
    table
}

fn json(station: &Station) -> Value {
    Value::Object(fields! {
        "name": station.name.as_str(), "mac": station.mac.to_string(),
        "ip": station.ip.is_set().then(|| station.ip.address.to_string()),
        "mask": station.ip.is_set().then(|| station.ip.mask.to_string()),
        "gateway": (!station.ip.gateway.is_unspecified()).then(|| station.ip.gateway.to_string()),
        "vendor_id": station.vendor_id, "device_id": station.device_id, "instance": station.instance,
        "type": station.station_type.as_str(), "role": role_word(station.role),
    })
}

const fn role_word(bits: u8) -> &'static str {
    if bits & role::CONTROLLER != 0 {
        "controller"
    } else if bits & role::SUPERVISOR != 0 {
        "supervisor"
    } else if bits & role::DEVICE != 0 {
        "device"
    } else {
        ""
    }
}

/// Names and addresses that more than one station has.
fn warnings(stations: &[Station]) -> Vec<String> {
    let mut owners: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for station in stations {
        if !station.name.is_empty() {
            owners
                .entry(format!("the name {}", station.name))
                .or_default()
                .push(station.mac.to_string());
        }
        if station.ip.is_set() {
            owners
                .entry(format!("the address {}", station.ip.address))
                .or_default()
                .push(station.mac.to_string());
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
        let station = |last| Station {
            mac: MacAddress([2, 0, 0, 0, 0, last]),
            name: "akd-1".into(),
            vendor_id: 0x0105,
            device_id: 1,
            role: 1,
            ..Station::default()
        };
        let stations = [station(1), station(2)];
        assert_eq!(
            warnings(&stations),
            ["2 stations have the name akd-1: 02:00:00:00:00:01 and 02:00:00:00:00:02"]
        );
        assert_eq!(
            table(&stations).lines()[1],
            "akd-1  02:00:00:00:00:01  -   0x0105  0x0001  AKD    device"
        );
    }
}
