//! The device description that simulated drives have towards others.

use plant::PlantPlan;
use plant::host::{DescriptionError, ForeignDescription};

use crate::args::Simulate;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::clean;

/// Reads the device description on the command line, and prints what was taken from it.
pub fn read(
    args: &Simulate,
    plant: Option<&PlantPlan>,
    output: &Output,
) -> Result<Option<ForeignDescription>, Failure> {
    let Some(path) = &args.gsdml else {
        return Ok(None);
    };
    let file = crate::commands::gsdml::read(path)?;
    let (name, identity) = (path.display().to_string(), &file.identity);
    let chosen = args.model;
    let description = ForeignDescription::new(&file, chosen, plant, args.access_point.as_deref());
    let description = description.map_err(|error| failure(&name, &error))?;
    if description.of_other_vendor {
        output.say(&format!(
            "to others a drive of vendor 0x{:04X}, inside model {}",
            identity.vendor_id, description.model.catalogue.model
        ));
    }
    for reason in &description.import.left_out {
        output.warn(&format!("not simulated: {}", clean(reason)));
    }
    let imported = &description.import.description;
    let mut telegrams: Vec<u16> = imported.telegrams.iter().map(|t| t.telegram).collect();
    telegrams.sort_unstable();
    telegrams.dedup();
    let telegrams: Vec<String> = telegrams.iter().map(u16::to_string).collect();
    output.say(&format!(
        "{name}: {} {}, device 0x{:04X}, telegrams {}",
        clean(&identity.vendor),
        imported.identity.station_type,
        imported.identity.device_id,
        telegrams.join(", ")
    ));
    Ok(Some(description))
}

fn failure(name: &str, error: &DescriptionError) -> Failure {
    let failure = Failure::explained(error);
    let failure = Failure {
        message: clean(&format!("{name}: {}", failure.message)),
        ..failure
    };
    match error {
        DescriptionError::Import(_) => failure.hint(format!(
            "`profidrive gsdml show {name}` shows access points and modules"
        )),
        _ => failure,
    }
}
