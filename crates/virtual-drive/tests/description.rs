//! A controller configured from nothing but a device description connects to the drive that has it.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use gsdml::{Gsdml, Submodule};
use profidrive_virtual_drive::description::export::export;
use profidrive_virtual_drive::description::{Description, ImportError};
use profidrive_virtual_drive::model::{AKD, ALL};
use profidrive_virtual_drive::station::StationConfig;
use profinet::controller::{ModuleConfig, SubmoduleConfig};

mod pair;

/// Returns a test file laid out as vendors do.
fn vendor_file(name: &str) -> Gsdml {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/descriptions");
    let file: PathBuf = folder.join(name);
    gsdml::parse(&std::fs::read(&file).unwrap()).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

const MODULES: &str = "GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml";
const SUBMODULES: &str = "GSDML-V2.32-Kollmorgen-DriveObject-20170601-103000.xml";

fn submodule(subslot: u32, submodule: &Submodule) -> SubmoduleConfig {
    let (input, output) = submodule.lengths();
    SubmoduleConfig {
        subslot: u16::try_from(subslot).unwrap(),
        ident: submodule.ident,
        input_length: u16::try_from(input).unwrap(),
        output_length: u16::try_from(output).unwrap(),
    }
}

/// Returns the project that an engineering tool creates from a file: an access point and a module in slot 1, perhaps
/// with a submodule plugged.
fn project(gsdml: &Gsdml, point: &str, module: &str, plugged: Option<(u32, &str)>) -> Vec<ModuleConfig> {
    let point = gsdml.access_point(point).unwrap();
    let plain = |subslot, ident| SubmoduleConfig {
        subslot,
        ident,
        input_length: 0,
        output_length: 0,
    };
    let mut own: Vec<SubmoduleConfig> = point
        .virtual_submodules
        .iter()
        .map(|s| submodule(s.fixed_in_subslots.first().unwrap(), s))
        .collect();
    own.extend(point.interface.iter().map(|i| plain(i.subslot, i.ident)));
    own.extend(point.ports.iter().map(|p| plain(p.subslot, p.ident)));
    let module = gsdml.module(module).unwrap();
    let mut submodules: Vec<SubmoduleConfig> = module
        .virtual_submodules
        .iter()
        .map(|s| submodule(s.fixed_in_subslots.first().unwrap(), s))
        .collect();
    submodules.extend(plugged.map(|(subslot, id)| submodule(subslot, gsdml.submodule(id).unwrap())));
    vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: point.module_ident,
            submodules: own,
        },
        ModuleConfig {
            api: 0x3A00,
            slot: 1,
            ident: module.ident,
            submodules,
        },
    ]
}

/// Exchanges data and gives the telegram the drive then has.
#[track_caller]
fn telegram_after(config: StationConfig, modules: Vec<ModuleConfig>, interval: u64) -> u16 {
    let mut pair = pair::Pair::connected(config, modules, Duration::from_millis(interval));
    for _ in 0..20 {
        pair.cycle(|_, work| work());
    }
    assert!(pair.station.device().is_exchanging());
    // PNU 922
    let axis = pair.station.drive().model().known.dialect.axis;
    let request = [1, 1, axis, 1, 0x10, 1, 0x03, 0x9A, 0, 0];
    let mut answer = [0; 240];
    pair.station.drive_mut().serve(&request, &mut answer).unwrap();
    match answer[..6] {
        [1, 1, _, 1, 0x42, 1] => u16::from_be_bytes([answer[6], answer[7]]),
        // a VLT reports its true type
        [1, 1, _, 1, 6, 1] => u16::from_be_bytes([answer[6], answer[7]]),
        ref other => panic!("{other:02X?}"),
    }
}

#[test]
fn every_module_of_the_exported_file_is_a_module_of_the_device() {
    for model in ALL {
        let exported = export(model).description;
        assert_eq!(exported.modules.len(), model.catalogue.device.telegrams.len());
        for module in &exported.modules {
            let number: u16 = module.id.trim_start_matches("M_TEL_").parse().unwrap();
            let config = StationConfig::new(model, pair::DRIVE);
            let modules = project(&exported, "DAP_1", &module.id, None);
            assert_eq!(
                telegram_after(config, modules, 16),
                number,
                "{}",
                model.catalogue.model
            );
        }
    }
}

#[test]
fn a_project_for_a_vendor_file_connects() {
    let file = vendor_file(MODULES);
    for (point, module, number, interval) in [
        ("ID_DAP_NEW", "ID_MOD_1", 1, 16),
        ("ID_DAP_OLD", "ID_MOD_1", 1, 32),
        ("ID_DAP_NEW", "ID_MOD_7", 7, 16),
        ("ID_DAP_NEW", "ID_MOD_353", 353, 64),
        ("ID_DAP_NEW", "ID_MOD_FREE_8", 0, 16),
        ("ID_DAP_NEW", "ID_MOD_FREE_12", 0, 16),
    ] {
        let mut config = StationConfig::new(&AKD, pair::DRIVE);
        config.description = Description::from_gsdml(&file, &AKD, None).unwrap().description;
        let modules = project(&file, point, module, None);
        assert_eq!(telegram_after(config, modules, interval), number, "{module}");
    }
}

#[test]
fn telegrams_that_are_submodules_of_one_module_connect() {
    let file = vendor_file(SUBMODULES);
    for (plugged, number) in [("S_SPEED", 1), ("S_TASKS", 7), ("S_MDI", 9)] {
        let mut config = StationConfig::new(&AKD, pair::DRIVE);
        config.description = Description::from_gsdml(&file, &AKD, None).unwrap().description;
        let modules = project(&file, "DAP", "M_DO", Some((2, plugged)));
        assert_eq!(telegram_after(config, modules, 2), number, "{plugged}");
    }
}

#[test]
fn identity_and_what_is_left_out() {
    let import = Description::from_gsdml(&vendor_file(MODULES), &AKD, None).unwrap();
    let Description {
        identity,
        access_points,
        telegrams,
        min_device_interval,
        ..
    } = import.description;
    assert_eq!((identity.vendor_id, identity.device_id), (0x0105, 1));
    assert_eq!(identity.station_type, "AKD-like V1.11");
    assert_eq!(identity.order_id, "AKD-P00606-NBPN");
    assert_eq!(
        (identity.hardware_revision, identity.software_revision),
        (2, [1, 11, 0])
    );
    assert_eq!(
        access_points.iter().map(|point| point.ident).collect::<Vec<_>>(),
        [0x712, 0x711]
    );
    assert_eq!(min_device_interval, 512);
    let numbers: Vec<_> = telegrams.iter().map(|t| (t.telegram, t.module.ident)).collect();
    assert_eq!(
        numbers,
        [
            (1, 0x2001),
            (7, 0x2007),
            (9, 0x2009),
            (353, 0x2161),
            (0, 0x2108),
            (0, 0x210C)
        ]
    );
    assert_eq!(import.left_out.len(), 1);
    assert!(
        import.left_out[0].starts_with("Monitor words: no telegram of the AKD has 2 octets"),
        "{:?}",
        import.left_out
    );

    let one = Description::from_gsdml(&vendor_file(MODULES), &AKD, Some("ID_DAP_OLD"))
        .unwrap()
        .description;
    assert_eq!(
        (
            one.access_points.len(),
            one.telegrams.len(),
            one.min_device_interval
        ),
        (1, 2, 1024)
    );

    let object = Description::from_gsdml(&vendor_file(SUBMODULES), &AKD, None).unwrap();
    assert_eq!(object.description.identity.device_id, 0x0102);
    // hardware release "A" is not a number: that of the model
    assert_eq!(object.description.identity.hardware_revision, 1);
    assert_eq!(object.description.identity.software_revision, [3, 21, 4]);
    assert_eq!(object.description.access_points[0].submodules.len(), 4);
    assert_eq!(object.left_out.len(), 1, "{:?}", object.left_out);
    assert!(object.left_out[0].starts_with("Drive object, PPO 6: "));
}

#[test]
fn a_file_that_does_not_fit_is_refused_with_the_reason() {
    let refused = |change: fn(&mut Gsdml), point: Option<&str>| {
        let mut file = vendor_file(MODULES);
        change(&mut file);
        Description::from_gsdml(&file, &AKD, point).unwrap_err()
    };
    let error = refused(|file| file.identity.vendor_id = 0x0080, None);
    assert_eq!(
        error.to_string(),
        "the file is that of vendor 0x0080, the AKD is one of vendor 0x0105"
    );
    let error = refused(|_| {}, Some("DAP"));
    assert_eq!(
        error.to_string(),
        "the file has no access point `DAP`; it has ID_DAP_NEW, ID_DAP_OLD"
    );
    let error = refused(
        |file| file.modules.retain(|module| module.id == "ID_MOD_MONITOR"),
        None,
    );
    assert!(matches!(error, ImportError::NoTelegram { .. }));
    assert!(
        error.to_string().contains("Monitor words: no telegram"),
        "{error}"
    );
    let error = refused(
        |file| {
            file.modules[0].virtual_submodules[0].api = 0;
            file.modules[1].virtual_submodules[0].io.output = None;
        },
        Some("ID_DAP_OLD"),
    );
    assert!(error.to_string().contains("data in both directions"), "{error}");
    let error = refused(
        |file| {
            let data = file.modules[0].virtual_submodules[0].io.input.as_mut().unwrap();
            data.items[0].length = Some(6);
        },
        None,
    );
    assert_eq!(
        error.to_string(),
        "module `Standard telegram 1`: telegram 1 of the AKD has 4 octets of setpoints and 4 of actual values, \
         the file 4 and 6"
    );
    let error = refused(
        |file| file.modules[0].virtual_submodules[0].io.iops_length = 2,
        None,
    );
    assert!(
        error.to_string().contains("status of more than one octet"),
        "{error}"
    );
}
