//! `profidrive scan`

use std::collections::HashMap;

use client::{ErrorKind, Wait};
use profidrive::report::{
    Change, Identity, InfoReport, Neighbour, ScanReport, Scanned, Station, StationChange,
};
use profidrive::{Network, Reported, listed, scan};

use crate::args::{Interface, Scan};
use crate::cache;
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::Page;
use crate::render::table::{Table, clean};

pub fn run(args: &Scan, interface: &Interface, output: &Output) -> Result<(), Failure> {
    if args.csv && output.json() {
        return Err(Failure::usage("--csv and --json exclude each other"));
    }
    let mut network = connect::session(interface, Need::Discovery, output)?;
    if args.watch {
        return watch(args, &mut network, output);
    }
    let bar = connect::bar(output, 0, "reading who they are");
    let progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let spinner = connect::spinner(output, format!("listening for {} ms", args.time.as_millis()));
    let found = if args.quick {
        scan::discover(&mut network, args.time).wait()
    } else {
        scan::survey(&mut network, args.time, &mut |done, all| {
            spinner.finish_and_clear();
            progress(done, all);
        })
        .wait()
    };
    spinner.finish_and_clear();
    bar.finish_and_clear();
    let Reported { report, outcome } = found?;
    let crowded = scan::crowded(&network, &report);
    network.close().wait()?;
    cache::remember(report.stations.iter().map(|one| &one.station));
    if args.csv {
        output.raw(&csv(&report)?);
    } else {
        output.report(&report);
    }
    if !output.json() {
        for duplicate in report.duplicates() {
            output.warn(&duplicate.to_string());
        }
        if let Some(incomplete) = report.incomplete() {
            output.warn(&incomplete);
        }
        for (unread, read_in_part) in unread(&report.stations) {
            match read_in_part {
                false => output.say(&unread),
                true => output.warn(&unread),
            }
        }
        if let Some(crowded) = crowded.filter(|_| !args.quick) {
            output.warn(&crowded);
        }
    }
    outcome.kind().map_or(Ok(()), |kind| {
        Err(Failure::new(kind, "no station answered").hint("check cable, interface and power"))
    })
}

/// Returns what could not be read and whether the rest of the station was: a line for each reason, which many stations may have.
fn unread(stations: &[Scanned]) -> Vec<(String, bool)> {
    let mut reasons: Vec<(&str, bool, Vec<&str>)> = Vec::new();
    let mut places = HashMap::new();
    for one in stations {
        let Some(unread) = &one.unread else { continue };
        let label = label(&one.station);
        let own = unread
            .strip_prefix(label)
            .and_then(|rest| rest.strip_prefix(": "));
        let (reason, in_part) = (own.unwrap_or(unread), one.info.is_some());
        let place = *places.entry((reason, in_part)).or_insert_with(|| {
            reasons.push((reason, in_part, Vec::new()));
            reasons.len() - 1
        });
        if let Some((_, _, labels)) = reasons.get_mut(place) {
            labels.push(label);
        }
    }
    let line = |(reason, in_part, labels): (&str, bool, Vec<&str>)| {
        let what = match (in_part, labels.len()) {
            (false, _) => "could not be read",
            (true, 1) => "was read in part",
            (true, _) => "were read in part",
        };
        let text = match labels.as_slice() {
            [label] => format!("{label} {what}: {reason}"),
            several => format!(
                "{} stations {what}: {reason}; they are {}",
                several.len(),
                listed(several)
            ),
        };
        (text, in_part)
    };
    reasons.into_iter().map(line).collect()
}

/// Prints which stations come and go until the person ends it.
fn watch(args: &Scan, network: &mut Network, output: &Output) -> Result<(), Failure> {
    let mut watch = scan::Watch::default();
    loop {
        match watch.next(network, args.time).wait() {
            Ok(changes) => changes.iter().for_each(|change| output.report_event(change)),
            Err(error) if error.kind() == ErrorKind::Interrupted => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

impl Page for StationChange {
    fn print(&self, output: &Output) {
        let station = &self.station;
        let (colour, text) = match (self.change, &self.before) {
            (Change::Came, _) => (Colour::Normal, format!("came     {}", described(station))),
            (Change::Went, _) => (Colour::Fault, format!("went     {}", described(station))),
            (Change::Changed, before) => {
                let before = before.as_ref().map_or_else(String::new, described);
                let text = format!("changed  {} (before: {before})", described(station));
                (Colour::Warning, text)
            }
        };
        let line = format!("{:>9.1} s  {}", self.time, clean(&text));
        output.line(&output.paint(colour, &line));
    }
}

/// `akd-1 (02:00:00:00:00:01) at 10.0.0.2, Kollmorgen AKD`
fn described(station: &Station) -> String {
    let name = station.name.as_deref().unwrap_or("without a name");
    let ip = station.ip.as_deref().unwrap_or("no IP address");
    format!(
        "{name} ({}) at {ip}, {} {}",
        station.mac,
        vendor(station),
        station.station_type
    )
}

fn label(station: &Station) -> &str {
    station.name.as_deref().unwrap_or(&station.mac)
}

fn vendor(station: &Station) -> String {
    let number = || format!("0x{:04X}", station.vendor_id);
    station.vendor.map_or_else(number, str::to_owned)
}

/// What tables and files show of a station.
struct Row<'s> {
    station: &'s Station,
    identity: Option<&'s Identity>,
    state: &'s str,
    controller: &'s str,
    neighbours: String,
    remarks: String,
}

impl<'s> Row<'s> {
    fn new(scanned: &'s Scanned) -> Self {
        let info = scanned.info.as_ref();
        let state = |info: &'s InfoReport| info.words.zsw1.as_ref()?.meaning.as_deref();
        let controller = |info: &'s InfoReport| match info.controller.as_ref() {
            Some(controller) if controller.connected => {
                Some(controller.name.as_deref().unwrap_or("without a name"))
            }
            _ => None,
        };
        let neighbour = |one: &Neighbour| one.station.clone().unwrap_or_else(|| one.mac.clone());
        let neighbours = info.map_or(&[][..], |info| &info.neighbours);
        let remarks: Vec<String> = scanned.remarks.iter().map(ToString::to_string).collect();
        Self {
            station: &scanned.station,
            identity: info.and_then(|info| info.identity.as_ref()),
            state: info.and_then(state).unwrap_or_default(),
            controller: info.and_then(controller).unwrap_or_default(),
            neighbours: neighbours.iter().map(neighbour).collect::<Vec<_>>().join(", "),
            remarks: remarks.join(", "),
        }
    }

    fn of_identity(&self, field: fn(&Identity) -> &String) -> String {
        self.identity.map(field).cloned().unwrap_or_default()
    }
}

impl Page for ScanReport {
    fn print(&self, output: &Output) {
        let mut table = Table::new(&[
            "name",
            "MAC",
            "IP",
            "vendor",
            "type",
            "role",
            "firmware",
            "serial no.",
            "state",
            "controller",
            "neighbours",
            "remarks",
        ]);
        let absent = || "-".to_owned();
        for row in self.stations.iter().map(Row::new) {
            let station = row.station;
            let ip = station.ip.as_ref().zip(station.prefix);
            table.row([
                station.name.clone().unwrap_or_else(absent),
                station.mac.clone(),
                ip.map_or_else(absent, |(ip, prefix)| format!("{ip}/{prefix}")),
                vendor(station),
                station.station_type.clone(),
                // a column with nothing but "device" has no information
                station
                    .role
                    .filter(|role| *role != "device")
                    .unwrap_or_default()
                    .to_owned(),
                row.of_identity(|identity| &identity.software_revision),
                row.of_identity(|identity| &identity.serial_number),
                row.state.to_owned(),
                row.controller.to_owned(),
                row.neighbours,
                row.remarks,
            ]);
        }
        output.table(&table);
    }
}

/// All that is known, with a line of headings.
fn csv(report: &ScanReport) -> Result<String, Failure> {
    let lost = |error: &dyn std::fmt::Display| {
        Failure::new(ErrorKind::Internal, format!("cannot write the table: {error}"))
    };
    let mut file = csv::Writer::from_writer(Vec::new());
    let headings = [
        "name",
        "mac",
        "ip",
        "prefix",
        "gateway",
        "vendor_id",
        "vendor",
        "device_id",
        "type",
        "role",
        "model",
        "order_id",
        "serial_number",
        "hardware_revision",
        "software_revision",
        "state",
        "controller",
        "neighbours",
        "remarks",
    ];
    file.write_record(headings).map_err(|error| lost(&error))?;
    for row in report.stations.iter().map(Row::new) {
        let station = row.station;
        let text = |text: &Option<String>| text.clone().unwrap_or_default();
        let hardware = row
            .identity
            .map(|identity| identity.hardware_revision.to_string());
        let cells = [
            text(&station.name),
            station.mac.clone(),
            text(&station.ip),
            text(&station.prefix.map(|prefix| prefix.to_string())),
            text(&station.gateway),
            format!("0x{:04X}", station.vendor_id),
            station.vendor.unwrap_or_default().to_owned(),
            format!("0x{:04X}", station.device_id),
            station.station_type.clone(),
            station.role.unwrap_or_default().to_owned(),
            station.model.unwrap_or_default().to_owned(),
            row.of_identity(|identity| &identity.order_id),
            row.of_identity(|identity| &identity.serial_number),
            text(&hardware),
            row.of_identity(|identity| &identity.software_revision),
            row.state.to_owned(),
            row.controller.to_owned(),
            row.neighbours,
            row.remarks,
        ];
        file.write_record(cells.map(|cell| clean(&cell)))
            .map_err(|error| lost(&error))?;
    }
    let text = file.into_inner().map_err(|error| lost(&error))?;
    String::from_utf8(text).map_err(|error| lost(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_that_fail_for_one_reason_share_a_line() {
        let stations: Vec<(Station, Vec<_>)> = (1..=12_u8)
            .map(|number| {
                let station = profinet::controller::Station {
                    name: format!("akd-{number}"),
                    ..Default::default()
                };
                (Station::from(&station), Vec::new())
            })
            .collect();
        let mut report = ScanReport::new(stations);
        for (at, one) in report.stations.iter_mut().enumerate().skip(1) {
            let reason = if at == 1 {
                "no such record"
            } else {
                "connect: no answer in time"
            };
            one.unread = Some(format!("akd-{}: {reason}", at + 1));
        }
        let lines = unread(&report.stations);
        let [(alone, false), (together, false)] = lines.as_slice() else {
            panic!("{lines:?}");
        };
        assert_eq!(alone, "akd-2 could not be read: no such record");
        let start = "10 stations could not be read: connect: no answer in time; they are akd-3, akd-4, ";
        assert!(together.starts_with(start), "{together}");
    }
}
