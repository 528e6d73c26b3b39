//! The device description that drives have towards others: that of the model, or one from a file.

use gsdml::Gsdml;
use virtual_drive::description::{Description, Import, ImportError};
use virtual_drive::model::{self, Model};

use crate::plan::PlantPlan;

/// A device description from a file, and the model that has it.
#[derive(Debug, Clone)]
pub struct ForeignDescription {
    /// The model: its drives have the description.
    pub model: &'static Model,
    /// The description is of another vendor than the model.
    pub of_other_vendor: bool,
    /// The description, and what of the file is not simulated.
    pub import: Import,
}

/// Why a device description cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// No drive of the plant is of this vendor.
    #[error("the device description is of vendor 0x{0:04X}; no drive of the plant is")]
    NotInPlant(u16),
    /// No model is of this vendor, and none was chosen.
    #[error("the device description is of vendor 0x{vendor:04X} ({name}), of which no drive is simulated")]
    NoModel {
        /// Number of the vendor.
        vendor: u16,
        /// Its name; foreign text.
        name: String,
    },
    /// It does not fit the model.
    #[error(transparent)]
    Import(#[from] ImportError),
}

impl ForeignDescription {
    /// Returns the description of `file` for `chosen`, else for the model of its vendor, in a plant for one of its
    /// drives; with `access_point` only that of the file.
    ///
    /// # Errors
    /// When there is no such model, or when the file does not fit it.
    pub fn new(
        file: &Gsdml,
        chosen: Option<&'static Model>,
        plant: Option<&PlantPlan>,
        access_point: Option<&str>,
    ) -> Result<Self, DescriptionError> {
        let vendor = file.identity.vendor_id;
        let made_by = |model: &Model| model.catalogue.device.vendor_id == vendor;
        let own = match plant {
            None => model::ALL.into_iter().find(|model| made_by(model)),
            Some(plant) => {
                let drive = plant.drives.iter().find(|drive| made_by(drive.model));
                Some(drive.ok_or(DescriptionError::NotInPlant(vendor))?.model)
            }
        };
        let model = chosen.or(own).ok_or_else(|| DescriptionError::NoModel {
            vendor,
            name: file.identity.vendor.clone(),
        })?;
        Ok(Self {
            model,
            of_other_vendor: !made_by(model),
            import: Description::under_the_name_of(file, model, access_point)?,
        })
    }
}

/// Returns the description of a drive of `model`.
pub(super) fn description_of(model: &'static Model, foreign: Option<&ForeignDescription>) -> Description {
    match foreign {
        Some(foreign) if std::ptr::eq(foreign.model, model) => foreign.import.description.clone(),
        _ => Description::of(model),
    }
}
