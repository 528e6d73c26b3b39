//! The tables of the frequency converters against the files they are made of, and against themselves.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use profidrive_profile::catalogue::{
    AKD, Access, Catalogue, Cleared, Parameter, Phase, Reaction, Role, Scale, Scaling, Size, VACON, VLT,
};
use profidrive_profile::notation::{Notation, ParameterReference, Target};
use profidrive_profile::parameter::{CodeSpace, Format, Octets};
use profidrive_profile::state::{Mode, Profile};
use profidrive_profile::unit::{ConversionIndex, Variable};
use profidrive_profile::value::take_scale;

const MODELS: [&Catalogue; 3] = [&AKD, &VLT, &VACON];

type Row = BTreeMap<String, String>;

fn file(model: &str, name: &str) -> Vec<Row> {
    let path = format!("{}/../../data/{model}/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(cells);
    let columns = lines.next().unwrap();
    lines
        .map(|cells| {
            assert_eq!(cells.len(), columns.len(), "{cells:?}");
            columns.iter().cloned().zip(cells).collect()
        })
        .collect()
}

/// One line of comma separated cells; a quoted cell has its quotes doubled.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for character in line.chars() {
        match character {
            '"' => {
                quoted = !quoted;
                let last = cells.last_mut().unwrap();
                if quoted && !last.is_empty() {
                    last.push('"');
                }
            }
            ',' if !quoted => cells.push(String::new()),
            other => cells.last_mut().unwrap().push(other),
        }
    }
    cells
}

fn row_of<'a>(rows: &'a [Row], parameter: &Parameter) -> &'a Row {
    let base = parameter.base.map_or(String::new(), |base| base.to_string());
    let same = |row: &&Row| row["pnu"] == parameter.pnu.to_string() && row["base"] == base;
    rows.iter().find(same).unwrap()
}

#[test]
fn every_row_of_the_files_is_a_parameter_and_no_other() {
    for (catalogue, folder, rows, recalled) in [(&VLT, "vlt", 300, 255), (&VACON, "vacon", 176, 125)] {
        let table = file(folder, "parameters");
        assert_eq!((table.len(), catalogue.parameters.len()), (rows, rows));
        for parameter in catalogue.parameters {
            let row = row_of(&table, parameter);
            assert_eq!(row["name"], parameter.name);
            assert_eq!(row["elements"], parameter.elements.to_string(), "{parameter:?}");
            assert_eq!(row["unit"], parameter.unit);
            assert_eq!(row["confidence"] == "recalled", parameter.recalled);
            assert_eq!(row["access"] == "ro", parameter.access == Access::ReadOnly);
            let info = parameter.format.info(CodeSpace::V4).unwrap();
            assert_eq!(info.name, row["format"]);
            match info.octets {
                Octets::Fixed(octets) => assert_eq!(parameter.octets(), usize::from(octets), "{parameter:?}"),
                _ => assert_eq!(parameter.length.to_string(), row["length"]),
            }
        }
        let count = catalogue
            .parameters
            .iter()
            .filter(|parameter| parameter.recalled)
            .count();
        assert_eq!(count, recalled, "{folder}");
    }
}

#[test]
fn every_parameter_is_found_by_its_address_and_by_its_name() {
    for catalogue in MODELS {
        let address = |parameter: &Parameter| (parameter.pnu, parameter.base);
        let ascending = |pair: &[Parameter]| address(&pair[0]) < address(&pair[1]);
        assert!(catalogue.parameters.windows(2).all(ascending));
        for (position, parameter) in catalogue.parameters.iter().enumerate() {
            let found = catalogue.by_address(parameter.pnu, parameter.base).unwrap();
            assert_eq!(address(found), address(parameter));
            for element in [0, parameter.elements - 1] {
                let subindex = parameter.subindex(element);
                assert_eq!(
                    catalogue.place(parameter.pnu, subindex),
                    Some((position, element))
                );
            }
            assert_eq!(
                catalogue.position(parameter.pnu).is_some(),
                parameter.base.is_none()
            );
            assert_eq!(catalogue.is_collecting(parameter.pnu), parameter.base.is_some());
            let named = catalogue.by_name(&parameter.name.to_lowercase()).unwrap();
            assert_eq!(named.name.to_uppercase(), parameter.name.to_uppercase());
        }
    }
}

/// What is printed is what can be written.
#[test]
fn labels_read_back_as_their_parameter() {
    for catalogue in MODELS {
        for parameter in catalogue.parameters {
            let label = catalogue.label(parameter);
            if catalogue.notation == Notation::Name {
                assert_eq!(label, parameter.name);
                continue;
            }
            let reference: ParameterReference = label.parse().unwrap();
            let Target::Number(number) = reference.target else {
                panic!("{label} read as a name")
            };
            let meant = match reference.elements {
                None => catalogue.meant(number, reference.prefix),
                Some(elements) => (number, Some(elements.first)),
            };
            assert_eq!(meant, (parameter.pnu, parameter.base), "{label}");
        }
    }
}

#[test]
fn numbers_are_those_of_the_list_of_parameters() {
    let numbers = |catalogue: &Catalogue| catalogue.numbers().collect::<Vec<u16>>();
    assert_eq!((numbers(&AKD).len(), numbers(&VLT).len()), (921, 300));
    assert_eq!(
        numbers(&VACON),
        [
            915, 916, 922, 923, 930, 944, 947, 964, 965, 975, 980, 981, 982, 983, 984, 985, 986, 987, 988,
            989, 10001, 10122
        ]
    );
    for catalogue in MODELS {
        assert!(numbers(catalogue).windows(2).all(|pair| pair[0] < pair[1]));
    }
}

#[test]
fn a_bare_number_of_a_vacon_is_an_application_id_where_it_can_be() {
    for parameter in VACON.parameters {
        match parameter.base {
            Some(id) => assert_eq!(VACON.meant(id, None), (10001, Some(id))),
            None => assert_eq!(VACON.meant(parameter.pnu, None), (parameter.pnu, None)),
        }
    }
    // ids and profile numbers the table does not have
    assert_eq!(VACON.meant(1500, None), (10001, Some(1500)));
    assert_eq!(VACON.meant(970, None), (970, None));
    assert_eq!(VACON.meant(10001, None), (10001, None));
    assert_eq!(VACON.meant(61000, None), (61000, None));
    assert!(VACON.place(10001, 0).is_none() && VACON.place(10001, 104).is_some());
    assert!(VACON.place(10001, 10).is_none() && VACON.at(10002, 103).is_none());
    assert!(VACON.by_pnu(10001).is_none());
}

#[test]
fn raw_numbers_and_values_come_back() {
    for catalogue in MODELS {
        for parameter in catalogue.parameters.iter().filter(|row| !row.is_text()) {
            let (low, high) = parameter.raw_limits(&catalogue.scaling);
            let (first, last) = parameter.range().into_inner();
            for raw in [first, last, low, high, 0, 1, -1, 777, -4711] {
                // a double has 53 bits
                if !parameter.range().contains(&raw) || raw.unsigned_abs() > 1 << 52 {
                    continue;
                }
                let value = parameter.engineering(raw, &catalogue.scaling);
                assert_eq!(parameter.raw(value, &catalogue.scaling), raw, "{parameter:?}");
            }
        }
    }
}

#[test]
fn limits_defaults_and_texts_agree_with_each_other_and_with_the_type() {
    for catalogue in [&VLT, &VACON] {
        for parameter in catalogue.parameters {
            let (low, high) = parameter.raw_limits(&catalogue.scaling);
            let default = parameter.raw_default(&catalogue.scaling);
            let label = catalogue.label(parameter);
            assert!(low <= high && (low..=high).contains(&default), "{parameter:?}");
            if let Some(wanted) = parameter.default {
                let value = parameter.engineering(default, &catalogue.scaling);
                assert!((value - wanted).abs() < 1e-9, "{label} {value}");
            }
            for choice in parameter.choices {
                assert!(
                    parameter.range().contains(&i64::from(choice.value)),
                    "{parameter:?}"
                );
            }
            // a selection as delivered is one of its texts
            let known = parameter.choices.is_empty() || parameter.choice(default).is_some();
            assert!(known, "{label} as delivered is {default}");
            if parameter.is_text() {
                assert!(
                    parameter.text.len() <= usize::from(parameter.length),
                    "{parameter:?}"
                );
                assert!(parameter.text.is_ascii() && parameter.size == Size::Byte);
            } else {
                assert!(parameter.text.is_empty());
            }
        }
    }
}

/// The unit and the power of ten of a row are what its physical size and conversion index say.
#[test]
fn units_are_those_of_the_conversion_index() {
    for catalogue in [&VLT, &VACON] {
        for parameter in catalogue.parameters {
            let Some(exponent) = parameter.scale.exponent() else {
                assert_eq!((parameter.scale, parameter.format), (Scale::Percent, Format::N2));
                continue;
            };
            if parameter.unit == "hp" {
                assert_eq!(parameter.variable.unit(), ("", -2)); // no physical size has it
                continue;
            }
            let described = parameter.variable.unit() == (parameter.unit, exponent);
            let by_variable = Variable::of(parameter.unit, exponent) == Some(parameter.variable);
            assert!(
                described || by_variable,
                "{} {parameter:?}",
                catalogue.label(parameter)
            );
        }
    }
    let one = |pnu| VLT.by_pnu(pnu).unwrap();
    let steps_of_10_w = Variable {
        size: 9,
        conversion: ConversionIndex(1),
    };
    assert_eq!(one(120).variable, steps_of_10_w);
    assert_eq!(one(120).engineering(75, &VLT.scaling), 0.75);
    assert_eq!(one(1500).variable.conversion, ConversionIndex(74));
    assert_eq!((one(341).raw(3.0, &VLT.scaling), one(341).decimals()), (300, 2));
    assert_eq!(one(341).rule(&VLT.scaling), "raw 100 = 1 s");
    assert_eq!(one(1605).rule(&VLT.scaling), "raw 16384 = 100 %");
    assert_eq!(one(1605).engineering(-0x2000, &VLT.scaling), -50.0);
    let frequency = VACON.at(10001, 102).unwrap();
    assert_eq!(frequency.raw(50.0, &VACON.scaling), 0x1388);
}

#[test]
fn the_speed_setpoint_is_n2_of_the_reference() {
    for catalogue in [&VLT, &VACON] {
        assert_eq!(catalogue.scaling.reference, Some(1500.0));
        assert_eq!(catalogue.scaling.speed().raw(1500.0).value, 0x4000);
    }
    assert_eq!(VLT.by_pnu(303).unwrap().default, Some(1500.0));
    assert_eq!(AKD.scaling, Scaling::default());
    assert_eq!(AKD.scaling.speed().raw(60.0).value, 164);
}

#[test]
fn true_types_in_both_code_spaces() {
    let code = |parameter: &Parameter| parameter.format.in_space(CodeSpace::V3).0;
    let of = |pnu: u16| code(VLT.by_pnu(pnu).unwrap());
    assert_eq!(
        [1, 341, 302, 310, 1540, 965, 1605, 1600].map(of),
        [5, 7, 4, 3, 9, 10, 33, 35]
    );
    // no others are listed for a VLT
    for parameter in VLT.parameters {
        assert!(
            matches!(code(parameter), 2..=7 | 9 | 10 | 33 | 35 | 54),
            "{parameter:?}"
        );
    }
    for parameter in AKD.parameters {
        let info = parameter.format.info(CodeSpace::V4).unwrap();
        assert_eq!(info.octets, Octets::Fixed(parameter.size.octets() as u8));
    }
}

#[test]
fn faults_of_the_converters() {
    for (catalogue, folder) in [(&VLT, "vlt"), (&VACON, "vacon")] {
        assert_eq!(catalogue.faults.len(), file(folder, "faults").len());
        let ascending = |at: usize| catalogue.faults[at - 1].number <= catalogue.faults[at].number;
        assert!((1..catalogue.faults.len()).all(ascending));
        for fault in catalogue.faults {
            assert_eq!(fault.warning, fault.reaction == Reaction::None, "{fault:?}");
            assert_eq!(fault.warning, fault.cleared == Cleared::ByItself, "{fault:?}");
            assert_eq!(catalogue.fault(fault.number, fault.warning), Some(fault));
            assert!((5..110).contains(&fault.remedy.len()), "{fault:?}");
            assert!(fault.recalled && fault.bit.is_none_or(|bit| bit < 64));
        }
    }
    // one bit is one warning; of the alarms only the nine failures of AMA share one
    for (warning, shared) in [(true, 0), (false, 8)] {
        let of_kind = VLT.faults.iter().filter(|fault| fault.warning == warning);
        let mut bits: Vec<u8> = of_kind.filter_map(|fault| fault.bit).collect();
        let all = bits.len();
        bits.sort_unstable();
        bits.dedup();
        assert_eq!(all - bits.len(), shared);
    }
    assert_eq!(
        VLT.fault(4, false).map(|fault| fault.cleared),
        Some(Cleared::Restart)
    ); // trip lock
    assert_eq!(
        VACON.fault(53, false).map(|fault| fault.reaction),
        Some(Reaction::RampStop)
    );
}

#[test]
fn alarm_and_warning_words_name_their_faults() {
    for fault in VLT.faults {
        let Some(bit) = fault.bit.filter(|bit| *bit < 32) else {
            continue;
        };
        let pnu = if fault.warning { 1692 } else { 1690 };
        let describe = VLT
            .word(pnu)
            .unwrap()
            .describe(1 << bit, Profile::default(), Mode::default());
        let number = fault.number.to_string();
        let mut numbers = describe
            .iter()
            .flat_map(|text| text.split(|c: char| !c.is_ascii_digit()));
        assert!(numbers.any(|found| found == number), "{describe:?}");
    }
    assert_eq!(VLT.word(1603).map(|word| word.bits.len()), Some(0)); // as 8-10 says
    assert!(VACON.word_at(10001, Some(2101)).is_some() && VACON.word_at(10001, Some(103)).is_none());
    assert!(VLT.words.windows(2).all(|pair| pair[0].pnu < pair[1].pnu));
    let describe = VLT
        .word(1690)
        .unwrap()
        .describe(1 << 10, Profile::default(), Mode::default());
    assert_eq!(describe, ["DC link under-voltage (8)"]);
}

#[test]
fn the_devices_match_recorded_connects() {
    let device = &VLT.device;
    assert_eq!(
        (device.vendor_id, device.device_id, device.api),
        (0x0080, 1, 0x3A00)
    );
    let slot_0: Vec<(u16, u32)> = device.access_point().collect();
    assert_eq!(slot_0, [(1, 1), (0x8000, 2), (0x8001, 3), (0x8002, 3)]);
    assert_eq!(device.access_point_module, 2);
    let seen = device.telegram_of_module(0x100).unwrap();
    assert_eq!(
        (seen.telegram, seen.submodule, seen.outputs, seen.inputs),
        (104, 0x68, 12, 12)
    );
    let layout = &device.layout;
    assert_eq!(
        (layout.parameters.subslot, layout.parameters.submodule),
        (1, Some(0xFFFF))
    );
    assert_eq!(layout.telegram, 2);
    let views = VACON.device.layout.records;
    let views: Vec<(u16, u8)> = views.iter().map(|view| (view.subslot, view.octets)).collect();
    assert_eq!((VACON.device.vendor_id, views), (0x01BA, vec![(1, 2), (2, 4)]));
    let akd: Vec<(u16, u32)> = AKD.device.access_point().collect();
    assert_eq!(akd, [(1, 1), (0x8000, 2), (0x8001, 3)]);
    for catalogue in MODELS {
        let telegrams = catalogue.device.telegrams;
        for (at, module) in telegrams.iter().enumerate() {
            let mut before = telegrams[..at].iter();
            assert!(
                before.all(|other| other.module != module.module && other.telegram != module.telegram),
                "{module:?}"
            );
        }
    }
}

#[test]
fn what_is_saved_and_restored() {
    for catalogue in MODELS {
        let address = |at: usize| (catalogue.backup[at].pnu, catalogue.backup[at].base);
        assert!((1..catalogue.backup.len()).all(|at| address(at - 1) < address(at)));
        for rule in catalogue.backup {
            let parameter = catalogue.by_address(rule.pnu, rule.base).unwrap();
            assert_eq!(catalogue.backup_rule_at(rule.pnu, rule.base), *rule);
            let writable = parameter.access != Access::ReadOnly;
            assert!(writable || matches!(rule.role, Role::Active), "{rule:?}");
        }
    }
    assert_eq!(VLT.with_role(Role::Save).unwrap().pnu, 971);
    assert_eq!(VLT.backup_rule(341).role, Role::Setting);
    assert_eq!(VACON.backup_rule_at(10001, Some(2003)).role, Role::Setpoint);
    assert_eq!(VACON.backup_rule_at(10001, Some(103)).base, Some(103));
    assert_eq!(VACON.with_role(Role::Action).unwrap().base, Some(631));
}

#[test]
fn names_need_only_their_letters_where_numbers_are_the_names() {
    let vlt = |name: &str| VLT.by_name(name).map(|found| found.pnu);
    assert_eq!(vlt("ramp-1-ramp-up-time"), Some(341));
    assert_eq!(vlt("motor_power_kw"), Some(120));
    assert_eq!((vlt("ramp"), vlt("--"), vlt("")), (None, None, None));
    assert_eq!(VACON.by_name("acceleration-time-1").unwrap().base, Some(103));
    assert_eq!(VLT.nearest("motor-sped-unit", 1)[0].pnu, 2);
    assert!(AKD.by_name("DRVACC").is_none());
}

#[test]
fn a_catalogue_made_at_run_time_finds_the_same() {
    for model in MODELS {
        let mut parameters: Vec<Parameter> = model.parameters.to_vec();
        parameters.reverse();
        let own = Catalogue::assemble("own", model.notation, model.scaling, model.device, parameters);
        assert_eq!(own.parameters.len(), model.parameters.len());
        for (position, parameter) in own.parameters.iter().enumerate() {
            let subindex = parameter.subindex(0);
            let found = own.place(parameter.pnu, subindex);
            assert_eq!(found, model.place(parameter.pnu, subindex));
            assert_eq!(found, Some((position, 0)));
            let mut named = own.all_by_name(parameter.name);
            assert!(named.any(|found| found.pnu == parameter.pnu));
        }
        assert!(own.numbers().eq(model.numbers()));
    }
    let empty = Catalogue::assemble("none", Notation::Name, AKD.scaling, AKD.device, Vec::new());
    assert!(empty.by_pnu(0).is_none() && empty.place(1, 1).is_none());
    assert!(empty.numbers().next().is_none());
}

/// One scaling under two numbers: both texts name every signal that it scales (manual 5.12.3 and 6.1), and each other.
#[test]
fn both_numbers_of_the_acceleration_scaling_name_what_they_scale() {
    for (pnu, other) in [(1008, "3065"), (3065, "")] {
        let parameter = AKD.by_pnu(pnu).unwrap();
        for signal in ["1006, 1007", "DRV_ACC", "DRV_DEC", "MDI_ACC", "MDI_DEC", other] {
            assert!(parameter.description.contains(signal), "{pnu}: {signal}");
        }
        assert_eq!(
            (parameter.minimum, parameter.maximum, parameter.default),
            (Some(1.0), Some(14648.0), Some(763.0))
        );
    }
}

/// Names in the text of the AKD manual that its list of parameters (5.6) and of signals (5.8) does not have.
#[test]
fn names_not_in_the_manual_are_not_parameters() {
    for name in [
        "DRV.NAME",
        "IP.ADDRESS",
        "IP.SUBNET",
        "IP.GATEWAY",
        "MT.PARAMS",
        "MID_ACC",
        "MID_DEC",
        "MDI_VEL",
        "MDI_TAR_POS",
        "PN.VELSCAING",
    ] {
        assert_eq!(AKD.by_name(name).map(|parameter| parameter.pnu), None, "{name}");
    }
    let listed = ["AKTSATZ", "MDI_TARPOS", "MDI_VELOCITY", "MDI_ACC", "MDI_DEC"];
    let numbers = listed.map(|name| AKD.by_name(name).unwrap().pnu);
    assert_eq!(numbers, [33, 34, 35, 36, 37]);
    let near = |name: &str| {
        AKD.nearest(name, 3)
            .iter()
            .any(|near| listed.contains(&near.name))
    };
    for name in ["MID_ACC", "MID_DEC", "MDI_TAR_POS"] {
        assert!(near(name), "{name}");
    }
    assert_eq!(AKD.nearest("PN.VELSCAING", 1)[0].name, "PN.VELSCALING");
}

/// A backup is written phase by phase: what scales other values is written, and known, before them.
#[test]
fn every_setting_that_scales_others_is_written_first() {
    let mut count = 0;
    for tables in MODELS {
        for parameter in tables.parameters {
            let at = (parameter.pnu, parameter.base);
            let scales = take_scale(tables, &mut Scaling::default(), at, 2.0).is_some();
            let rule = tables.backup_rule_at(parameter.pnu, parameter.base);
            if scales && parameter.access != Access::ReadOnly && rule.role == Role::Setting {
                assert_eq!(rule.phase, Phase::Scaling, "{}", parameter.name);
                count += 1;
            }
        }
    }
    assert!(count >= 9, "{count}");
}
