//! The device description of a virtual drive: written, checked, read back; the drive is then made from the file.
//!
//! `cargo run -p examples --example device_description`

use std::error::Error;

use profinet::MacAddress;
use virtual_drive::description::Description;
use virtual_drive::description::export::export;
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

fn main() -> Result<(), Box<dyn Error>> {
    let exported = export(&model::AKD);
    let (name, text) = (exported.file_name.to_string(), exported.description.to_xml());
    let report = gsdml::check(text.as_bytes(), Some(&name));
    println!(
        "{name}: {} octets, {} problems",
        text.len(),
        report.problems.len()
    );

    // any vendor's file is read the same way, with errors that have line and column
    let read = gsdml::parse(text.as_bytes())?;
    for module in &read.modules {
        println!(
            "  0x{:08X}  {}",
            module.ident,
            read.text(module.info.name.as_ref())
        );
    }
    let mut config = StationConfig::new(&model::AKD, MacAddress([0x02, 0x50, 0x4E, 0, 0, 1]));
    config.description = Description::from_gsdml(&read, &model::AKD, None)?.description;
    let station = Station::new(config);
    println!("a drive with {} modules", station.device().config().modules.len());
    Ok(())
}
