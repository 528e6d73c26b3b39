//! What a client takes from a vendor's device description: the ident numbers of its modules, its update times, and whether it
//! accepts connections for records.

use std::collections::BTreeMap;

use client::{Drive, ErrorKind, VendorModule};
use gsdml::{AccessPoint, Gsdml};
use profinet::controller::{ModuleConfig, SubmoduleConfig};
use profinet::cyclic::{TICK, Timing};
use virtual_drive::description::{Description, ImportError, TelegramModule};
use virtual_drive::model;

/// Why a device description does not fit a drive.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// It is a description of another vendor.
    #[error("the device description is of vendor 0x{described:04X}, {drive} is of vendor 0x{vendor:04X}")]
    OtherVendor {
        /// The drive.
        drive: String,
        /// Its vendor.
        vendor: u16,
        /// Vendor of the description.
        described: u16,
    },
    /// There is no model, so the telegrams of the drive are not known.
    #[error("which telegrams {drive} has is not known")]
    UnknownTelegrams {
        /// The drive.
        drive: String,
    },
    /// Its modules do not carry the telegrams of the model.
    #[error(transparent)]
    Modules(#[from] ImportError),
}

impl DescriptionError {
    /// What kind of error it is.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        match self {
            Self::OtherVendor { .. } | Self::UnknownTelegrams { .. } => ErrorKind::Usage,
            Self::Modules(_) => ErrorKind::Unsupported,
        }
    }
}

/// Applies a device description to a drive.
///
/// # Errors
/// When it is of another vendor, the model of the drive is not known, or no module carries a telegram of it.
pub fn describe(description: &Gsdml, drive: &mut Drive) -> Result<(), DescriptionError> {
    let described = description.identity.vendor_id;
    if described != drive.station.vendor_id {
        return Err(DescriptionError::OtherVendor {
            drive: drive.label(),
            vendor: drive.station.vendor_id,
            described,
        });
    }
    let catalogue = drive.model.catalogue;
    let known = model::ALL
        .into_iter()
        .find(|model| catalogue.is_some_and(|own| own.model == model.catalogue.model));
    let model = known.ok_or_else(|| DescriptionError::UnknownTelegrams { drive: drive.label() })?;
    let import = Description::under_the_name_of(description, model, None)?;
    drive.vendor_modules = import.description.telegrams.iter().map(of).collect();
    drive.vendor_timings = timings(&description.access_points);
    drive.device_access = device_access(&description.access_points);
    Ok(())
}

/// Returns the value that all access points of a description declare: which one is plugged is the project's choice.
fn device_access(points: &[AccessPoint]) -> Option<bool> {
    let mut declared = points.iter().map(|point| point.features.device_access);
    let first = declared.next().flatten()?;
    declared.all(|other| other == Some(first)).then_some(first)
}

/// Returns the update times that every access point of a description allows: which one is plugged is the project's
/// choice.
fn timings(points: &[AccessPoint]) -> Vec<Timing> {
    let every = |timing: &Timing| {
        points.iter().all(|point| {
            let known = point.interface.as_ref().is_none_or(|interface| {
                interface.send_clocks.contains(timing.send_clock_factor.into())
                    && interface.reduction_ratios.contains(timing.reduction_ratio.into())
            });
            known && timing.ticks() >= point.min_device_interval.into()
        })
    };
    let times = (0..15).filter_map(|power| Timing::for_interval(TICK * (1 << power)));
    times.filter(every).collect()
}

/// One telegram of a description as a controller expects it.
fn of(telegram: &TelegramModule) -> VendorModule {
    let mut by_api: BTreeMap<u32, Vec<SubmoduleConfig>> = BTreeMap::new();
    for submodule in &telegram.module.submodules {
        by_api.entry(submodule.api).or_default().push(SubmoduleConfig {
            subslot: submodule.subslot,
            ident: submodule.ident,
            input_length: submodule.input_length,
            output_length: submodule.output_length,
        });
    }
    let (slot, ident) = (telegram.slot, telegram.module.ident);
    let modules = by_api.into_iter().map(|(api, submodules)| ModuleConfig {
        api,
        slot,
        ident,
        submodules,
    });
    VendorModule {
        telegram: telegram.telegram,
        place: (slot, telegram.subslot),
        modules: modules.collect(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use profinet::controller::Station;

    use super::*;

    #[test]
    fn telegrams_of_a_vendor_file() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/descriptions");
        let file = folder.join("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml");
        let station = Station {
            vendor_id: 0x0105,
            device_id: 1,
            ..Station::default()
        };
        let mut drive = Drive::new(station);
        let file = gsdml::parse(&std::fs::read(file).unwrap()).unwrap();
        describe(&file, &mut drive).unwrap();
        assert_eq!(drive.device_access, None, "the file says nothing");
        let mut modules = drive.vendor_modules.iter();
        let nine = modules.find(|module| module.telegram == 9).unwrap();
        assert_eq!(nine.lengths(), (20, 10));
        let intervals = drive.vendor_timings.iter().map(Timing::interval);
        let longest = intervals.max().map(|longest| longest.as_millis());
        assert_eq!(longest, Some(512));
        let other = Station {
            vendor_id: 0x1234,
            ..drive.station.clone()
        };
        let error = describe(&file, &mut Drive::new(other)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains("0x0105"), "{error}");
    }
}
