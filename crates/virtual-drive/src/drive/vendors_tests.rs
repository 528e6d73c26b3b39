//! What holds for the tables of every model: each parameter is read, and written with what it can be.

use profile::catalogue::{Access, Parameter};
use profile::parameter::{ErrorNumber, Format, Keep, ParameterAccess};

use super::bench::{Bench, CYCLE, ask};
use super::*;
use crate::model::{self, Limit, Live};

/// Returns a request for all elements of a parameter that fit one answer.
fn request(model: &Model, parameter: &Parameter, id: u8, elements: u8) -> Vec<u8> {
    let [high, low] = parameter.pnu.to_be_bytes();
    let [sub_high, sub_low] = parameter.base.unwrap_or(0).to_be_bytes();
    vec![
        9,
        id,
        model.known.dialect.axis,
        1,
        0x10,
        elements,
        high,
        low,
        sub_high,
        sub_low,
    ]
}

#[test]
fn there_is_a_virtual_drive_for_each_model() {
    let virtual_drives = model::ALL.map(|model| model.known.key);
    assert_eq!(virtual_drives, profile::model::ALL.map(|model| model.key));
}

#[test]
fn every_parameter_of_every_model_is_read() {
    for model in [&model::VLT, &model::VACON] {
        let mut drive = Drive::new(model);
        for parameter in model.catalogue.parameters {
            let elements = if parameter.is_array() && parameter.length == 0 {
                parameter.elements.min(39)
            } else {
                1
            };
            let answer = ask(&mut drive, &request(model, parameter, 1, elements as u8));
            assert_eq!(answer[1], 1, "{parameter:?} {answer:02X?}");
            let octets = if parameter.length > 0 {
                usize::from(parameter.length)
            } else {
                usize::from(elements) * parameter.size.octets()
            };
            assert_eq!(answer.len(), 6 + octets + octets % 2, "{parameter:?}");
            let description = ask(&mut drive, &{
                let mut request = request(model, parameter, 1, 1);
                request[4] = 0x20;
                request[8..10].fill(0);
                request
            });
            if parameter.base.is_none() {
                assert_eq!((description[4], description.len()), (0x0A, 52), "{parameter:?}");
            }
        }
    }
}

#[test]
fn every_parameter_of_every_model_is_written() {
    for model in [&model::VLT, &model::VACON] {
        let mut written = 0;
        for (position, parameter) in model.catalogue.parameters.iter().enumerate() {
            let mut drive = Drive::new(model);
            let subindex = parameter.base.unwrap_or(0);
            let present = drive.read(parameter.pnu, subindex).unwrap();
            let mut write = |raw: u64| drive.write(parameter.pnu, subindex, raw, Keep::Volatile);
            if parameter.access == Access::ReadOnly {
                assert_eq!(write(present), Err(ErrorNumber::NOT_CHANGEABLE), "{parameter:?}");
                continue;
            }
            let live = model.live_by_position()[position];
            if !matches!(live, Live::Stored) {
                continue;
            }
            let (low, high) = drive.limits(position, parameter);
            for raw in [low, high] {
                let known = parameter.choices.is_empty() || parameter.choice(raw).is_some();
                let result = drive.write(parameter.pnu, subindex, raw.cast_unsigned(), Keep::Volatile);
                assert_eq!(result.is_ok(), known, "{parameter:?} {raw}");
                if known {
                    assert_eq!(drive.element(position, 0), Ok(raw), "{parameter:?}");
                }
            }
            if high < *parameter.range().end() {
                let above = drive.write(
                    parameter.pnu,
                    subindex,
                    (high + 1).cast_unsigned(),
                    Keep::Volatile,
                );
                assert!(above.is_err(), "{parameter:?}");
            }
            written += 1;
        }
        assert!(written >= 100, "{written}");
    }
}

#[test]
fn the_tables_name_parameters_and_faults_that_exist() {
    for model in model::ALL {
        for (parameter, live) in model
            .catalogue
            .parameters
            .iter()
            .zip(model.live_by_position().iter().copied())
        {
            match live {
                Live::Measured(_) | Live::StatusWord | Live::AlarmWord(_) | Live::WarningWord(_) => {
                    assert_eq!(parameter.access, Access::ReadOnly, "{parameter:?}");
                }
                Live::Choose(..) => assert_eq!(parameter.access, Access::ReadWrite, "{parameter:?}"),
                Live::Array(_) => assert!(parameter.is_array() || parameter.pnu >= 980, "{parameter:?}"),
                _ => {}
            }
        }
        for condition in model.conditions {
            let fault = model.catalogue.fault(condition.number, condition.warning);
            assert!(fault.is_some(), "{condition:?}");
            if let Limit::Parameter(part) = condition.limit {
                assert!(model.number(part).is_some(), "{condition:?}");
            }
        }
        assert!(model.conditions.len() <= model::MOST_CONDITIONS);
        let lost = model.connection_lost_fault;
        assert!(model.catalogue.fault(lost, false).is_some());
        if model.converter.is_some() {
            // the motor as delivered is the one of the plant
            let drive = Drive::new(model);
            assert_eq!(
                drive.axis().plant().motor,
                model.plant.motor,
                "{}",
                model.catalogue.model
            );
        }
    }
}

#[test]
fn every_injection_works_on_every_model() {
    for model in model::ALL {
        for key in Injection::keys() {
            let mut bench = Bench::new(model, 1);
            bench.send(0x047E, 0, 40);
            bench.send(0x047F, 0x1000, 200);
            let injection: Injection = key.example.parse().unwrap();
            bench.drive.inject(injection);
            bench.ticks(50);
            assert!(bench.now >= Instant::ZERO + CYCLE, "{}", key.example);
        }
        // what takes the torque away trips, and the trip goes with its cause
        let mut bench = Bench::new(model, 1);
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, 0x1000, 400);
        assert!(bench.drive.is_enabled());
        bench.drive.inject(Injection::Sto(true));
        bench.ticks(2);
        assert!(
            bench.drive.has_fault() && !bench.drive.is_enabled(),
            "{}",
            model.catalogue.model
        );
        bench.drive.inject(Injection::Sto(false));
        bench.send(0x047E, 0, 40);
        bench.send(0x04FE, 0, 40);
        assert!(!bench.drive.has_fault(), "{}", model.catalogue.model);
    }
}

fn hex(text: &str) -> Vec<u8> {
    let octets = text.split_whitespace();
    octets
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

/// Rows of the checklist on parameter access and profile parameters, by their numbers.
#[test]
fn checklist_of_parameter_access() {
    let rows = [
        // 1 and 4, 7, 10, 16, 22, 25, 55 of a VLT
        (
            &model::VLT,
            "01 01 00 01 10 01 03 9A 00 00",
            "01 01 00 01 06 01 00 01",
        ),
        (
            &model::VLT,
            "07 01 00 01 10 01 03 9A 00 05",
            "07 81 00 01 44 01 00 04",
        ),
        (
            &model::VLT,
            "0A 01 00 01 50 01 03 9A 00 00",
            "0A 81 00 01 44 01 00 16",
        ),
        (
            &model::VLT,
            "10 01 00 02 10 01 03 9A 00 00 10 01 FF FE 00 00",
            "10 81 00 02 06 01 00 01 44 01 00 00",
        ),
        (
            &model::VLT,
            "16 02 00 01 10 01 01 55 00 00 07 01 00 00 01 2C",
            "16 02 00 01",
        ),
        (
            &model::VLT,
            "19 02 00 01 10 01 03 2A 00 00 50 01 01 00",
            "19 82 00 01 44 01 00 17",
        ),
        (
            &model::VLT,
            "37 01 00 01 10 00 03 C5 00 00",
            "37 01 00 01 0A 02 03 29",
        ),
        // the same of a Vacon, and 13 below, 37, 52
        (
            &model::VACON,
            "01 01 01 01 10 01 03 9A 00 00",
            "01 01 01 01 42 01 00 01",
        ),
        (
            &model::VACON,
            "07 01 01 01 10 01 03 9A 00 05",
            "07 81 01 01 44 01 00 04",
        ),
        (
            &model::VACON,
            "0A 01 01 01 50 01 03 9A 00 00",
            "0A 81 01 01 44 01 00 69",
        ),
        (
            &model::VACON,
            "10 01 01 02 10 01 03 9A 00 00 10 01 FF FE 00 00",
            "10 81 01 02 42 01 00 01 44 01 00 00",
        ),
        (
            &model::VACON,
            "16 02 01 01 10 01 27 11 00 67 42 01 00 32",
            "16 02 01 01",
        ),
        (
            &model::VACON,
            "00 01 01 01 10 01 03 9A 00 00",
            "00 81 01 01 44 01 00 65",
        ),
        (
            &model::VACON,
            "34 01 01 01 30 01 03 9A 00 00",
            "34 81 01 01 44 01 00 0F",
        ),
        (
            &model::VACON,
            "37 01 01 01 10 01 03 C5 00 00",
            "37 01 01 01 42 01 03 29",
        ),
    ];
    for (model, request, response) in rows {
        let mut drive = Drive::new(model);
        let answer = ask(&mut drive, &hex(request));
        assert_eq!(answer, hex(response), "{request} -> {answer:02X?}");
    }
    let many = |axis: u8, count: u8, address: [u8; 6]| {
        let mut request = vec![0x0D, 1, axis, count];
        (0..count).for_each(|_| request.extend(address));
        request
    };
    let refused = ask(
        &mut Drive::new(&model::VACON),
        &many(1, 40, [0x10, 1, 3, 0x9A, 0, 0]),
    ); // 13
    assert_eq!((refused[1], &refused[4..8]), (0x81, &[0x44, 1, 0, 0x68][..]));
    let long = ask(
        &mut Drive::new(&model::VLT),
        &many(0, 37, [0x10, 8, 3, 0xB3, 0, 0]),
    ); // 19
    assert!(long.len() <= 240 && long[1] == 0x81);
    assert!(long.windows(4).any(|block| block == [0x44, 1, 0, 0x15]));
}

/// Rows 76 to 94 of the checklist, in telegram 1: ZSW1 under the mask 0077.
#[test]
fn checklist_of_the_state_machine() {
    for model in [&model::VLT, &model::VACON] {
        let name = model.catalogue.model;
        let masked = |status: u16| status & 0x77;
        for word in [0x0476, 0x047E] {
            let mut bench = Bench::new(model, 1);
            assert_eq!(masked(bench.send(word, 0, 40)), 0x31, "{name} 76");
        }
        let mut bench = Bench::new(model, 1);
        assert_eq!(bench.send(0x047F, 0x2000, 1000) & 0x40, 0x40, "{name} 79");
        bench.send(0x047E, 0, 40);
        let before = bench.status();
        assert_eq!(bench.send(0x007F, 0x2000, 400), before, "{name} 91");
        bench.send(0x047F, 0x4000, 8000);
        assert_eq!(bench.drive.state(), State::S4, "{name} 91");
        let status = bench.send(0x047E, 0x4000, 200);
        assert_eq!(status & 0x42, 0x02, "{name} 82");
        assert_eq!(masked(bench.send(0x047E, 0x4000, 12_000)), 0x31, "{name} 82");
        bench.send(0x047F, 0x4000, 8000);
        bench.send(0x047B, 0x4000, 40);
        bench.send(0x047F, 0x4000, 40);
        assert_eq!(bench.drive.state(), State::S5Quick, "{name} 85");
        bench.send(0x047F, 0x4000, 12_000);
        assert_eq!(bench.drive.state(), State::S1, "{name} 85");
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, 0x4000, 4000);
        bench.send(0x047D, 0x4000, 12_000);
        assert_eq!(masked(bench.send(0x047F, 0x4000, 400)), 0x70, "{name} 88");
        bench.send(0x047E, 0, 40);
        let number = model.connection_lost_fault;
        let counted = bench.drive.parameter(944).unwrap();
        bench.drive.inject_fault(number, false);
        bench.ticks(2);
        assert_eq!(bench.drive.parameter(944), Some(counted + 1), "{name} 67");
        assert_eq!(bench.send(0x047E, 0, 40) & 8, 8, "{name} 94");
        assert_eq!(bench.send(0x04FE, 0, 40) & 8, 0, "{name} 94");
        assert_eq!(masked(bench.send(0x047E, 0, 40)), 0x31, "{name} 94");
    }
}

/// MG06G102 5.8 lists format 35 for changes; the parameters that have it are words that the drive reports.
#[test]
fn bit_sequences_of_a_vlt_can_only_be_read() {
    let mut drive = Drive::new(&model::VLT);
    let parameters = model::VLT.catalogue.parameters.iter();
    let bits = parameters.filter(|parameter| parameter.format == Format::V2);
    let mut count = 0;
    for parameter in bits {
        let [high, low] = parameter.pnu.to_be_bytes();
        let change = [1, 2, 0, 1, 0x10, 1, high, low, 0, 0, 35, 1, 0, 1];
        let answer = ask(&mut drive, &change);
        assert_eq!(answer, [1, 0x82, 0, 1, 0x44, 1, 0, 1], "PNU {}", parameter.pnu);
        count += 1;
    }
    assert_eq!(count, 8);
}

/// The example of the page about parameter bytes, which is not a parameter of this drive.
#[test]
fn parameter_615_does_not_exist() {
    let mut bench = Bench::new(&model::VLT, 101);
    bench.outputs[..8].copy_from_slice(&[0x12, 0x67, 1, 0, 0, 0, 0, 0]);
    bench.ticks(1);
    assert_eq!(bench.inputs[..8], [0x72, 0x67, 1, 0, 0, 0, 0, 0]);
}
