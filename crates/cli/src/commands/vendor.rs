//! What a client takes from a vendor's device description: the ident numbers of its modules and its update times.

use std::collections::BTreeMap;
use std::path::Path;

use client::{Drive, VendorModule};
use gsdml::AccessPoint;
use profinet::controller::{ModuleConfig, SubmoduleConfig};
use profinet::cyclic::{TICK, Timing};
use virtual_drive::description::{Description, TelegramModule};
use virtual_drive::model;

use crate::failure::{Exit, Failure};
use crate::render::table::clean;

/// Applies a device description to the drive: the modules of its telegrams, its update times, and whether it accepts
/// connections for records.
pub fn describe(path: &Path, drive: &mut Drive) -> Result<(), Failure> {
    let file = super::gsdml::read(path)?;
    let (name, vendor) = (path.display(), file.identity.vendor_id);
    if vendor != drive.station.vendor_id {
        return Err(Failure::usage(format!(
            "{name} is of vendor 0x{vendor:04X}, {} is of vendor 0x{:04X}",
            drive.label(),
            drive.station.vendor_id
        )));
    }
    let catalogue = drive.model.catalogue;
    let model = model::ALL
        .into_iter()
        .find(|model| catalogue.is_some_and(|own| own.model == model.catalogue.model))
        .ok_or_else(|| {
            Failure::usage(format!("which telegrams {} has is not known", drive.label()))
                .hint("--model akd|vlt|vacon takes it for one of the known drives")
        })?;
    let import = Description::under_the_name_of(&file, model, None).map_err(|error| {
        let message = format!("{name}: {}", clean(&error.to_string()));
        Failure::new(Exit::Failed, message).hint(format!(
            "`profidrive gsdml show {name}` shows access points and modules"
        ))
    })?;
    drive.vendor_modules = import.description.telegrams.iter().map(of).collect();
    drive.vendor_timings = timings(&file.access_points);
    drive.device_access = device_access(&file.access_points);
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
    use super::*;
    use profinet::controller::Station;

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
        let failure = describe(&file, &mut Drive::new(other)).unwrap_err();
        assert_eq!(failure.exit, Exit::Usage);
        assert!(failure.message.contains("0x0105"), "{}", failure.message);
    }
}
