//! `profidrive scan`

use client::Wait;
use profidrive::report::ScanReport;
use profidrive::{Reported, inspection};

use crate::args::{Interface, Scan};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;
use crate::render::table::Table;

pub fn run(args: &Scan, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let mut session = connect::session(interface, Need::Discovery, output)?;
    let spinner = connect::spinner(output, format!("listening for {} ms", args.time.as_millis()));
    let found = inspection::scan(&mut session, args.time).wait();
    spinner.finish_and_clear();
    let Reported { report, outcome } = found?;
    output.report(&report);
    if !output.json() {
        for duplicate in report.duplicates() {
            output.warn(&duplicate.to_string());
        }
    }
    outcome.kind().map_or(Ok(()), |kind| {
        Err(Failure::new(kind, "no station answered").hint("check cable, interface and power"))
    })
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
