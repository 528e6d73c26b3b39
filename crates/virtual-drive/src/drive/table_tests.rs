//! Every parameter of the catalogue through the drive.

use super::tests::Bench;
use super::*;
use crate::model::AKD;
use profile::catalogue::{Access, Size};
use profile::parameter::ErrorNumber;

#[test]
fn every_parameter_reads_within_its_size_and_refuses_what_it_must() {
    let mut bench = Bench::new();
    bench.run(163);
    for (position, parameter) in AKD.catalogue.parameters.iter().enumerate() {
        let range = parameter.range();
        for element in 0..parameter.elements {
            let raw = bench.drive.element(position, element).unwrap();
            assert!(range.contains(&raw), "{parameter:?} reads {raw}");
        }
        let beyond = if parameter.is_array() {
            ErrorNumber::SUBINDEX
        } else {
            ErrorNumber::NO_ARRAY
        };
        assert_eq!(bench.drive.element(position, parameter.elements), Err(beyond));
        assert_eq!(
            bench.drive.set_element(position, parameter.elements, 0),
            Err(beyond)
        );
        if parameter.access == Access::ReadOnly {
            assert_eq!(
                bench.drive.set_element(position, 0, 1),
                Err(ErrorNumber::NOT_CHANGEABLE),
                "{parameter:?}"
            );
        }
    }
    assert_eq!(bench.drive.element(800, 0), Err(ErrorNumber::UNKNOWN_PARAMETER));
}

#[test]
fn every_known_limit_is_enforced() {
    let mut drive = Drive::new(&AKD);
    let mut checked = 0;
    for (position, parameter) in AKD.catalogue.parameters.iter().enumerate() {
        let stored = matches!(drive.live[position], Live::Stored);
        if parameter.access != Access::ReadWrite || !stored || parameter.size == Size::Command {
            continue;
        }
        let (low, high) = drive.own_limits(parameter);
        let range = parameter.range();
        let before = drive.element(position, 0).unwrap();
        for (raw, allowed) in [
            (low, true),
            (high, true),
            (low.saturating_sub(1), low == i64::MIN),
            (high.saturating_add(1), high == i64::MAX),
        ] {
            if !range.contains(&raw) {
                continue;
            }
            // An enumeration takes what it names and nothing else.
            let named = parameter.choices.is_empty() || parameter.choice(raw).is_some();
            let expected = match (allowed, named) {
                (true, true) => Ok(()),
                (true, false) => Err(ErrorNumber::VALUE),
                (false, _) => Err(ErrorNumber::LIMIT),
            };
            let allowed = allowed && named;
            assert_eq!(
                drive.set_element(position, 0, raw),
                expected,
                "{parameter:?} {raw}"
            );
            assert_eq!(drive.element(position, 0).unwrap() == raw, allowed);
        }
        drive.set_element(position, 0, before).unwrap();
        checked += 1;
    }
    assert!(checked > 550, "{checked}");
}

#[test]
fn enumerations_take_what_they_name() {
    let mut bench = Bench::new();
    for (raw, answer) in [
        (0, Ok(())),
        (1, Ok(())),
        (2, Err(ErrorNumber::VALUE)),
        (3, Err(ErrorNumber::VALUE)),
        (4, Ok(())),
        (255, Err(ErrorNumber::VALUE)),
    ] {
        assert_eq!(bench.write("FAULT702.ACTION", raw), answer, "{raw}");
    }
    assert_eq!(
        bench.write("DRV.OPMODE", 3),
        Err(ErrorNumber::LIMIT),
        "limits come first"
    );
}

#[test]
fn lists_of_parameters() {
    let bench = Bench::new();
    let mut found = Vec::new();
    for list in 980..=989 {
        let list: Vec<i64> = (0..117)
            .map(|element| bench.element(&list.to_string(), element))
            .collect();
        let end = list.iter().position(|pnu| *pnu == 0).expect("ends with 0");
        assert!(list[end..].iter().all(|pnu| *pnu == 0));
        found.extend_from_slice(&list[..end]);
    }
    assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
    let expected: Vec<i64> = AKD
        .catalogue
        .numbers()
        .filter(|pnu| !(980..=989).contains(pnu))
        .map(i64::from)
        .collect();
    assert_eq!(expected.len(), 911);
    assert_eq!(found, expected);
}

#[test]
fn identification_and_telegrams() {
    let bench = Bench::new();
    let all = |name: &str, count| {
        (0..count)
            .map(|element| bench.element(name, element))
            .collect::<Vec<_>>()
    };
    assert_eq!(all("964", 5), [0x0105, 1, 117, 2017, 110]);
    assert_eq!(bench.read("965"), 0x0329);
    assert_eq!(all("975", 8)[5..], [1, 5, 0]);
    assert_eq!(bench.read("922"), 1);
    assert_eq!(bench.read("FBUS.PARAM01"), 1);
    assert_eq!(all("915", 4), [1, 5, 0, 0]);
    assert_eq!(all("916", 4), [2, 6, 0, 0]);
    let signals = all("923", 110);
    assert_eq!(
        (signals[1], signals[5], signals[107], signals[109], signals[0]),
        (1, 5, 0, 109, 0)
    );
    assert_eq!(bench.read("PN.TIMEOUTFTHRESH"), 48);
}
