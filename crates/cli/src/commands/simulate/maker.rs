//! What the simulated drives are, and by whose name they go: the model's own, or that of a device description.

use std::path::Path;

use plant::Scenario;
use virtual_drive::description::{Description, Import};
use virtual_drive::model::{self, Model as DriveModel};

use crate::args::{Model, Simulate};
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::render::table::clean;

/// The model on the command line, and the device description there.
#[derive(Debug)]
pub struct Maker {
    /// Of the drives that the options describe.
    pub model: &'static DriveModel,
    /// Instead of that of this model.
    description: Option<(&'static DriveModel, Description)>,
}

pub const fn model_of(model: Model) -> &'static DriveModel {
    match model {
        Model::Akd => &model::AKD,
        Model::Vlt => &model::VLT,
        Model::Vacon => &model::VACON,
    }
}

impl Maker {
    /// Reads the device description, and finds the model it is for.
    pub fn of(args: &Simulate, scenario: Option<&Scenario>, output: &Output) -> Result<Self, Failure> {
        let chosen = args.model.map(model_of);
        let Some(path) = &args.gsdml else {
            return Ok(Self {
                model: chosen.unwrap_or(&model::AKD),
                description: None,
            });
        };
        let file = crate::commands::gsdml::read(path)?;
        let (name, vendor) = (path.display().to_string(), file.identity.vendor_id);
        let made_by = |model: &DriveModel| model.catalogue.device.vendor_id == vendor;
        let own = match scenario {
            None => model::ALL.into_iter().find(|model| made_by(model)),
            Some(scenario) => {
                let drive = scenario.drives.iter().find(|drive| made_by(drive.model));
                Some(drive.map(|drive| drive.model).ok_or_else(|| {
                    let message = format!("{name} is of vendor 0x{vendor:04X}; no drive of the scenario is");
                    Failure::new(Exit::Failed, message)
                })?)
            }
        };
        let Some(model) = chosen.or(own) else {
            let maker = clean(&file.identity.vendor);
            let message =
                format!("{name} is of vendor 0x{vendor:04X} ({maker}), of which no drive is simulated");
            let hint =
                "--model akd|vlt|vacon says what the drive is inside; to others it is that of the file";
            return Err(Failure::usage(message).hint(hint));
        };
        if !made_by(model) {
            output.say(&format!(
                "to others a drive of vendor 0x{vendor:04X}, inside model {}",
                model.catalogue.model
            ));
        }
        let import = Description::under_the_name_of(&file, model, args.access_point.as_deref());
        let import = import.map_err(|error| {
            let message = format!("{name}: {}", clean(&error.to_string()));
            Failure::new(Exit::Failed, message).hint(format!(
                "`profidrive gsdml show {name}` shows access points and modules"
            ))
        })?;
        tell(path, &file.identity.vendor, &import, output);
        Ok(Self {
            model,
            description: Some((model, import.description)),
        })
    }

    /// What a drive of this model is to others.
    pub fn description(&self, model: &'static DriveModel) -> Description {
        match &self.description {
            Some((own, description)) if std::ptr::eq(*own, model) => description.clone(),
            _ => Description::of(model),
        }
    }
}

fn tell(path: &Path, maker: &str, import: &Import, output: &Output) {
    for reason in &import.left_out {
        output.warn(&format!("not simulated: {}", clean(reason)));
    }
    let identity = &import.description.identity;
    let mut telegrams: Vec<u16> = import.description.telegrams.iter().map(|t| t.telegram).collect();
    telegrams.sort_unstable();
    telegrams.dedup();
    let telegrams: Vec<String> = telegrams.iter().map(u16::to_string).collect();
    output.say(&format!(
        "{}: {} {}, device 0x{:04X}, telegrams {}",
        path.display(),
        clean(maker),
        identity.station_type,
        identity.device_id,
        telegrams.join(", ")
    ));
}
