use gsdml::{Bitmap, FileName, Severity, ValueList, check, parse};
use profile::telegram::Telegram;

use super::export::{export, export_with};
use super::*;
use crate::model::{AKD, ALL};

#[test]
fn the_exported_file_is_sound_and_read_back_as_it_was() {
    for model in ALL {
        let exported = export(model);
        let name = exported.file_name.to_string();
        let text = exported.description.to_xml();
        let report = check(text.as_bytes(), Some(&name));
        assert_eq!(report.problems, [], "{text}");
        assert_eq!(report.description.as_ref(), Some(&exported.description));
        assert_eq!(parse(text.as_bytes()), Ok(exported.description));
        assert_eq!(name.parse::<FileName>(), Ok(exported.file_name));
    }
}

#[test]
fn the_same_every_time() {
    let (one, two) = (export(&AKD), export(&AKD));
    assert_eq!(one, two);
    assert_eq!(one.description.to_xml(), two.description.to_xml());
}

/// What is exported describes exactly what the device is.
#[test]
fn exported_and_imported_is_the_model_again() {
    let import = Description::from_gsdml(&export(&AKD).description, &AKD, None).unwrap();
    assert_eq!(import.description, Description::of(&AKD));
    assert_eq!(import.left_out, [] as [String; 0]);
}

/// Telegrams 1 and 7 have the same length: without a name only the ident number of the submodule distinguishes them.
#[test]
fn a_telegram_without_a_name_is_found_by_ident_and_length() {
    let mut file = export(&AKD).description;
    for (at, module) in file.modules.iter_mut().enumerate() {
        let id = format!("ITEM_{at}");
        let references = file.access_points.iter_mut().flat_map(|point| &mut point.modules);
        for reference in references.filter(|reference| reference.target == module.id) {
            reference.target = id.clone();
        }
        module.id = id;
        module.info.name = None;
        for submodule in &mut module.virtual_submodules {
            submodule.id = format!("{}_S", module.id);
            submodule.info = None;
            for data in [&mut submodule.io.input, &mut submodule.io.output]
                .into_iter()
                .flatten()
            {
                data.items.iter_mut().for_each(|item| item.text = None);
            }
        }
    }
    let import = Description::from_gsdml(&file, &AKD, None).unwrap();
    assert_eq!(import.description.telegrams, Description::of(&AKD).telegrams);
    assert_eq!(import.left_out, [] as [String; 0]);
    // another length is not that telegram, whatever the ident number is
    let telegram = &mut file.modules[0].virtual_submodules[0];
    telegram.io.input.as_mut().unwrap().items.pop();
    let import = Description::from_gsdml(&file, &AKD, None).unwrap();
    assert_eq!(import.left_out.len(), 1, "{:?}", import.left_out);
}

#[test]
fn data_items_are_the_signals_of_the_telegram() {
    let exported = export(&AKD).description;
    for known in AKD.catalogue.device.telegrams {
        let telegram = Telegram::find(known.telegram, 0x0105).unwrap();
        let module = exported.module(&format!("M_TEL_{}", known.telegram)).unwrap();
        let io = &module.virtual_submodules[0].io;
        assert_eq!(
            module.virtual_submodules[0].lengths(),
            (known.inputs.into(), known.outputs.into())
        );
        assert_eq!(module.virtual_submodules[0].api, 0x3A00);
        let name = exported.text(module.info.name.as_ref());
        assert!(name.contains(&format!("telegram {},", known.telegram)), "{name}");
        if telegram.free {
            continue;
        }
        for (data, image) in [(&io.output, &telegram.setpoint), (&io.input, &telegram.actual)] {
            let mut at = 0;
            for item in &data.as_ref().unwrap().items {
                let text = exported.text(item.text.as_ref());
                let field = image.fields.iter().find(|field| field.offset == at);
                match field {
                    Some(field) => assert!(text.starts_with(&format!("{}: ", field.signal.name)), "{text}"),
                    None => assert!(text.starts_with("Process data word"), "{text}"),
                }
                at += u16::try_from(item.octets()).unwrap();
            }
            assert_eq!(at, image.octets);
        }
    }
}

#[test]
fn features_are_those_of_the_device() {
    let exported = export(&AKD).description;
    let point = &exported.access_points[0];
    let config = crate::station::describe::device_config(&crate::station::StationConfig::new(
        &AKD,
        MacAddress([2, 0, 0, 0, 0, 1]),
    ));
    assert_eq!(point.min_device_interval, config.min_device_interval);
    let fast = export_with(&AKD, Some(32)).description;
    assert_eq!(fast.access_points[0].min_device_interval, 32, "1 ms");
    let modes: ValueList = config
        .reset_modes
        .iter()
        .map(|mode| u32::from(mode.number()))
        .collect();
    assert_eq!(point.reset_modes, modes);
    assert_eq!(
        usize::from(point.device_access_ars.unwrap()),
        config.max_device_access
    );
    assert_eq!(point.object_instance, config.identity.instance);
    // every send clock and ratio that is offered is taken, where their product can be
    let interface = point.interface.as_ref().unwrap();
    for clock in interface.send_clocks.iter() {
        for ratio in interface.reduction_ratios.iter() {
            let timing = profinet::cyclic::Timing {
                send_clock_factor: u16::try_from(clock).unwrap(),
                reduction_ratio: u16::try_from(ratio).unwrap(),
                phase: 1,
            };
            let possible = clock * ratio >= 512 && clock * ratio <= 32 * 512;
            assert_eq!(
                timing.check(3, 3, config.min_device_interval).is_ok(),
                possible,
                "{clock} x {ratio}"
            );
        }
    }
    // the largest telegrams: 24 octets of actual values, 26 of setpoints; three submodules of slot 0
    assert_eq!(
        (point.io_limits.input, point.io_limits.output),
        (3 + 24 + 2, 3 + 26 + 2)
    );
}

#[test]
fn the_picture_belongs_to_the_description() {
    let exported = export(&AKD);
    let [(name, octets)] = exported.pictures.as_slice() else {
        panic!("{:?}", exported.pictures.len())
    };
    assert_eq!(
        name.trim_end_matches(".bmp"),
        exported.description.graphics[0].file
    );
    assert_eq!(Bitmap::size_of(octets), Some((70, 40)));
    let colours: std::collections::BTreeSet<&[u8]> = octets[54..]
        .chunks_exact(212)
        .flat_map(|row| row[..210].chunks(3))
        .collect();
    assert!(colours.len() >= 5, "something is drawn");
}

#[test]
fn german_texts_stand_beside_the_english_ones() {
    let exported = export(&AKD).description;
    let name = exported.module("M_TEL_353").unwrap().info.name.clone().unwrap();
    assert_eq!(
        exported.texts.get(&name),
        Some("Manufacturer telegram 353, PZD-13/5")
    );
    assert_eq!(
        exported.texts.in_language("de", &name),
        Some("Herstellertelegramm 353, PZD-13/5")
    );
    let report = check(exported.to_xml().as_bytes(), None);
    assert!(
        report
            .problems
            .iter()
            .all(|problem| problem.severity < Severity::Warning)
    );
}

#[test]
fn modules_of_a_file_are_bounded() {
    let unsupported = |file: &gsdml::Gsdml| match Description::from_gsdml(file, &AKD, None) {
        Err(ImportError::Unsupported { reason, .. }) => reason,
        other => format!("{other:?}"),
    };
    let original = export(&AKD).description;
    let first = original.modules[0].clone();
    let mut file = original.clone();
    file.modules.resize(4096, first.clone());
    assert!(Description::from_gsdml(&file, &AKD, None).is_ok());
    file.modules.push(first.clone());
    assert_eq!(
        unsupported(&file),
        "a drive with 4097 modules; at most 4096 are taken"
    );

    let mut file = original.clone();
    let submodules = &mut file.modules[0].virtual_submodules;
    submodules.resize(513, submodules[0].clone());
    assert_eq!(unsupported(&file), "a module with 513 submodules");

    // modules that are none of the drive: the report about them is bounded too
    let mut file = original;
    let mut unknown = first;
    unknown.info.name = None;
    let submodule = &mut unknown.virtual_submodules[0];
    submodule.info = None;
    for data in [&mut submodule.io.input, &mut submodule.io.output] {
        let items = &mut data.as_mut().unwrap().items;
        items.truncate(1);
        items[0].text = None;
    }
    for number in 0..600 {
        unknown.id = format!("ITEM_{number}");
        unknown.virtual_submodules[0].id = format!("ITEM_{number}_S");
        file.modules.push(unknown.clone());
        for point in &mut file.access_points {
            let mut reference = point.modules[0].clone();
            reference.target.clone_from(&unknown.id);
            point.modules.push(reference);
        }
    }
    let import = Description::from_gsdml(&file, &AKD, None).unwrap();
    assert_eq!(import.left_out.len(), 512);
    assert_eq!(import.description.telegrams, Description::of(&AKD).telegrams);
}
