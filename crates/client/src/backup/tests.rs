//! Text and comparison, without a drive.

use profile::catalogue::{AKD, Access, Parameter, Scaling};
use profile::notation::setting::{LONGEST, crc32};
use profile::notation::{Notation, Shown};
use profile::parameter::{ErrorNumber, Format};
use profile::unit::UnitChoice;
use proptest::prelude::*;

use super::*;
use profile::value::Interpretation;

pub(crate) fn header() -> Header {
    Header {
        model: "AKD".into(),
        vendor_id: AKD.device.vendor_id,
        device_id: AKD.device.device_id,
        station: "akd-1".into(),
        order_id: "AKD-P00306-NBPN-0000".into(),
        serial_number: "V-000001".into(),
        software: "V1.17.0".into(),
        ip: None,
        telegram: None,
        tasks: TaskCoverage::Nothing,
    }
}

pub(crate) fn tables(scaling: Scaling) -> Parameters {
    Parameters {
        catalogue: Some(&AKD),
        scaling,
    }
}

pub(crate) fn reading(
    parameters: &Parameters,
    parameter: &'static Parameter,
    index: u16,
    raw: i64,
) -> Reading {
    let octets = raw.to_be_bytes();
    let octets = &octets[8 - parameter.octets()..];
    let selection = Selection {
        pnu: parameter.pnu,
        first: index,
        count: 1,
        indexed: parameter.is_array(),
        ..Selection::of(parameter, Notation::Name)
    };
    parameters.reading(
        &selection,
        0,
        parameter.size.format_code(),
        Interpretation::Plain,
        octets,
    )
}

/// A drive with these values; everything else as delivered.
pub(crate) fn drive(scaling: Scaling, values: &[(&str, i64)]) -> Backup {
    let parameters = tables(scaling);
    let answers = everything(&Header::known(&header()))
        .into_iter()
        .map(|selection| {
            let parameter = selection.parameter.unwrap();
            let set = values.iter().find(|(name, _)| *name == parameter.name);
            let raw = set.map_or_else(|| parameter.raw_default(&scaling), |(_, raw)| *raw);
            Ok(reading(&parameters, parameter, 0, raw))
        });
    Backup::new(header(), parameters, answers)
}

pub(crate) fn file(lines: &str) -> Backup {
    Backup::read(with_head(lines)).unwrap()
}

pub(crate) fn with_head(lines: &str) -> String {
    format!(
        "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\nscaling: velocity 1638, acceleration 763, \
         position 1000, singleturn 16, peak current 9\n{lines}\n"
    )
}

#[test]
fn every_setting_is_one_line_by_number() {
    let text = drive(Scaling::default(), &[]).to_string();
    assert!(
        text.starts_with("profidrive backup 1\nmodel: AKD\nvendor: 0x0105\n"),
        "{text}"
    );
    let line = text.lines().find(|line| line.starts_with("p2108 ")).unwrap();
    assert_eq!(
        line,
        "p2108 DRV.ACC = 3000 rpm/s              # Acceleration ramp of the velocity loop command"
    );
    let line = text.lines().find(|line| line.starts_with("p2135 ")).unwrap();
    assert!(line.starts_with("p2135 DRV.OPMODE = 1 "), "{line}");
    assert!(line.to_lowercase().contains("# velocity"), "{line}");
    // what a controller or the drive itself writes, and what does something, is not in it
    for name in [
        "NSOLL_A",
        "DRV.NVSAVE",
        "DRV.REBOOT",
        "MOTOR.BRAKERLS",
        "VL.FB_32",
        "MT.MOVE",
    ] {
        assert!(!text.contains(&format!(" {name} = ")), "{name}");
    }
    let numbers: Vec<u16> = text
        .lines()
        .filter_map(|line| line.strip_prefix('p')?.get(..4)?.parse().ok())
        .collect();
    assert!(numbers.len() > 400 && numbers.is_sorted());
    assert!(!text.lines().any(|line| line.ends_with(' ')));
}

#[test]
fn a_value_that_its_unit_cannot_say_exactly_has_its_raw_number() {
    let text = drive(Scaling::default(), &[("Jog v1", 164)]).to_string();
    let line = text.lines().find(|line| line.starts_with("p1004 ")).unwrap();
    assert!(
        line.starts_with("p1004 Jog v1 = 60.059 rpm (raw 0x00A4) "),
        "{line}"
    );
    assert_eq!(
        file("p1004 Jog v1 = 60.059 rpm (raw 0x00A4)").readings()[0].raw(),
        Some(164)
    );
    assert_eq!(file("Jog v1 = -60 rpm").readings()[0].raw(), Some(-164));
    let error = Backup::read(with_head("p1004 Jog v1 = 70 rpm (raw 0x00A4)")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("line 6: Jog v1 (p1004): 70 rpm is not the raw value beside it"),
        "{error}"
    );
}

#[test]
fn mistakes_are_reported_with_their_lines() {
    for (lines, expected) in [
        (
            "p2108 DRV.DEC = 3000 rpm/s",
            "line 6: p2108 is DRV.ACC, not DRV.DEC",
        ),
        (
            "DRV.ACCC = 1",
            "line 6: AKD has no parameter `DRV.ACCC`; nearest names: DRV.ACC",
        ),
        (
            "p2108 = 3000 A",
            "line 6: DRV.ACC (p2108): `A` is a unit of current",
        ),
        (
            "p2439 = 5e9 rpm",
            "line 6: VL.LIMITP_32 (p2439): 5000000000 rpm does not fit its 4 octets",
        ),
        (
            "p2135 = 1.5",
            "line 6: DRV.OPMODE (p2135): takes whole numbers, not 1.5",
        ),
        (
            "p2135 = 0x100",
            "line 6: DRV.OPMODE (p2135): 0x100 does not fit its 1 octets",
        ),
        ("p2135 =", "line 6: DRV.OPMODE (p2135): no value given"),
        (
            "p2135",
            "line 6: `p2135` is neither PARAM = VALUE nor a line of the head",
        ),
        (
            "\n\np2135 = 1\np2108 = 3000\nDRV.OPMODE = 2",
            "line 10: DRV.OPMODE stands in line 8 already",
        ),
        (
            "colour: blue",
            "line 6: `colour:` is not a line of the head of a backup",
        ),
        (
            "vendor: 261",
            "line 6: `261` is not a number of four hexadecimal digits",
        ),
        (
            "scaling: velocity 0",
            "line 6: `0` is not a valid scaling of velocity",
        ),
        ("scaling: warp 9", "line 6: nothing is scaled by `warp`"),
        ("p915 = 1", "one element in each line"),
        ("p915[16] = 1", "element 16 does not exist"),
        ("= 1", "line 6: a value without a parameter"),
        ("p65000 = 7", "line 6: `7`: nothing is known about this parameter"),
        ("p65000 = 0x123", "line 6: `0x123`"),
    ] {
        let error = Backup::read(with_head(lines)).unwrap_err().to_string();
        assert!(error.contains(expected), "{lines:?}: {error}");
    }
    for (text, expected) in [
        (
            "",
            "line 1: not a backup: the first line is `profidrive backup 1`, not ``",
        ),
        ("#!/bin/sh\nrm x\n", "line 1: not a backup"),
        (
            "profidrive backup 2\n",
            "line 1: a backup of form 2, this program reads form 1",
        ),
        (
            "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\np1006 = 7630 rpm/s\n",
            "line 5: Jog Acc (p1006): the line `scaling:` of the head is needed",
        ),
    ] {
        let error = Backup::read(text).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
}

/// The first ones of whatever kind: unknown words, settings and tasks.
#[test]
fn the_mistakes_of_a_file_are_bounded() {
    for lines in [
        "nonsense\n".repeat(1000),
        "p2135 = 0x100\n".repeat(1000),
        "task 0 = nonsense\n".repeat(1000),
        "p2135 = 0x100\ntask 0 = nonsense\n".repeat(1000),
    ] {
        let problems = Backup::read(with_head(&lines)).unwrap_err().problems;
        let places: Vec<usize> = problems.iter().map(|problem| problem.line).collect();
        assert_eq!(places, (6..26).collect::<Vec<_>>(), "{problems:?}");
    }
}

#[test]
fn the_cause_of_a_file_that_is_no_backup_is_typed() {
    let form = ("backup", 1);
    let found = |text: &str| text.to_owned();
    let long = " ".repeat(LONGEST + 1).into_bytes();
    let changed = b"profidrive backup 1\np918 = 0x0001\nchecksum 00000000\n";
    let cases: [(&[u8], usize, Cause); 6] = [
        (&long, 1, Cause::TooLong { kind: "backup" }),
        (
            b"profidrive backup 1\n\xFF\n",
            2,
            Cause::NotText { kind: "backup" },
        ),
        (
            b"Dear Sir\n",
            1,
            Cause::OtherKind {
                form,
                found: found("Dear Sir"),
            },
        ),
        (
            b"profidrive backup 2\n",
            1,
            Cause::OtherVersion {
                form,
                found: found("2"),
            },
        ),
        (b"profidrive backup 1\np918 = 1", 2, Cause::NoLineBreak),
        (
            changed,
            3,
            Cause::Changed {
                found: found("00000000"),
                computed: crc32(&changed[..changed.len() - "checksum 00000000\n".len()]),
            },
        ),
    ];
    for (octets, line, cause) in cases {
        let problems = Backup::read(octets).unwrap_err().problems;
        assert_eq!(problems, [Problem { line, cause }]);
    }
    let problems = Backup::read(with_head("nonsense")).unwrap_err().problems;
    assert!(matches!(problems[0].cause, Cause::Line(_)), "{problems:?}");
}

/// The files in `tests/data` were written by the program before the form was shared with other files. What is read and
/// printed again is the same text, so that backups differ in nothing but settings.
#[test]
fn files_of_former_programs_read_back_and_are_written_the_same() {
    for (text, settings, tasks) in [
        (include_str!("../../tests/data/akd.backup"), 546, 2),
        (include_str!("../../tests/data/vlt.backup"), 226, 0),
        (include_str!("../../tests/data/vacon.backup"), 122, 0),
    ] {
        let backup = Backup::read(text).unwrap();
        assert_eq!((backup.readings().len(), backup.task_count()), (settings, tasks));
        assert_eq!(backup.to_string(), text);
    }
    let way_back = Backup::read(include_str!("../../tests/data/akd.before")).unwrap();
    assert_eq!(way_back.readings()[0].raw(), Some(0xA4));
    assert_eq!(way_back.task(3), Some(&Task::Empty));
}

/// What is left of a text that was cut is refused, or it is as many whole lines.
#[test]
fn a_cut_backup_is_refused_or_has_fewer_lines() {
    let text = include_str!("../../tests/data/vacon.backup");
    let whole = Backup::read(text).unwrap();
    for end in 0..text.len() {
        let Ok(cut) = Backup::read(&text[..end]) else {
            continue;
        };
        assert!(text[..end].ends_with('\n'), "{end}");
        for reading in cut.readings() {
            let whole = whole.reading(reading.pnu, reading.index).unwrap();
            assert_eq!(reading.octets, whole.octets, "{end}");
        }
    }
}

#[test]
fn a_drive_without_tables_is_kept_by_number_and_octets() {
    let parameters = Parameters {
        catalogue: None,
        scaling: Scaling::default(),
    };
    let read = |pnu, index: Option<u16>, format: Format, octets: &[u8]| {
        let selection = Selection {
            first: index.unwrap_or(0),
            indexed: index.is_some(),
            ..Selection::number(pnu, Notation::Name)
        };
        let interpretation = Interpretation::of(format, CodeSpace::V4);
        Ok(parameters.reading(&selection, 0, format.0, interpretation, octets))
    };
    let header = Header {
        model: "PROFIdrive".into(),
        vendor_id: 0x1234,
        ..Header::default()
    };
    let refused = Refusal {
        shown: Shown {
            pnu: 1300,
            index: None,
            writable: None,
            notation: Notation::Name,
        },
        name: None,
        write: false,
        number: ErrorNumber::NO_RIGHTS,
        names: profile::parameter::ErrorNames::Profile,
        information: None,
        advice: None,
        channel: None,
    };
    let backup = Backup::new(
        header,
        parameters,
        [
            read(1200, None, Format::INTEGER16, &[0xFF, 0xFE]),
            read(1100, Some(1), Format::UNSIGNED32, &[0, 0, 1, 0]),
            read(1201, None, Format::VISIBLE_STRING, b"feed\n#x"),
            Err(refused),
        ],
    );
    let text = backup.to_string();
    assert!(text.contains("\n1100[1] = 0x00000100 "), "{text}");
    assert!(
        text.contains("\n1200 = 0xFFFE ") && text.contains("# -2 Integer16"),
        "{text}"
    );
    assert!(text.contains("\n# reading 1300 refused: 0x0B "), "{text}");
    let again = Backup::read(&text).unwrap();
    assert_eq!(again.readings()[2].octets, b"feed\n#x");
    assert_eq!(again, Backup::read(again.to_string()).unwrap());
}

#[test]
fn settings_of_another_model_do_not_fit_whatever_its_numbers() {
    let station = profinet::controller::Station {
        name: "akd-1".into(),
        vendor_id: AKD.device.vendor_id,
        device_id: AKD.device.device_id,
        ..profinet::controller::Station::default()
    };
    let drive = Drive::new(station);
    assert_eq!(header().misfit(&drive), None);
    let vlt = Header {
        model: "VLT".into(),
        ..header()
    };
    assert!(vlt.misfit(&drive).unwrap().contains("of model VLT"));
    let unnamed = Header {
        model: String::new(),
        ..header()
    };
    assert_eq!(unnamed.misfit(&drive), None);
    let other = Header {
        device_id: 9,
        ..header()
    };
    assert!(other.misfit(&drive).is_some());
}

#[test]
fn differences_are_in_units_and_say_what_is_missing() {
    let left = file("p2108 = 3000 rpm/s\np2115 = 1000 rpm/s\np1006 = 7630 rpm/s");
    let coarse = with_head("p2108 = 4000 rpm/s\np2117 = 1\np1006 = 7630 rpm/s")
        .replace("acceleration 763", "acceleration 109");
    let right = Backup::read(&coarse).unwrap();
    assert_ne!(left.readings()[0].raw(), right.readings()[0].raw());
    let differences = compare(&left, &right);
    let names: Vec<_> = differences.iter().filter_map(Difference::name).collect();
    assert_eq!(names, ["DRV.ACC", "DRV.DEC", "DRV.DIR"]);
    assert_eq!(differences[1].right, Side::Missing);
    assert_eq!(differences[2].left, Side::Missing);
    assert!(compare(&left, &left).is_empty());
}

fn some_scaling() -> impl Strategy<Value = Scaling> {
    (
        1_u16..=2000,
        1_u16..=14648,
        1_u32..=1_000_000,
        1_u16..=32,
        1_u16..=480,
    )
        .prop_map(
            |(velocity, acceleration, position, singleturn_bits, peak)| Scaling {
                velocity,
                acceleration,
                position,
                singleturn_bits,
                peak_current: f64::from(peak) / 10.0,
                unit: UnitChoice {
                    rotary_unit: i64::from(velocity % 5),
                    ..UnitChoice::DELIVERED
                },
                reference: None,
            },
        )
}

proptest! {
    /// Whatever numbers a drive has: its text reads back as the same numbers, and prints as the same text.
    #[test]
    fn every_number_survives_the_text(scaling in some_scaling(), seed: u64) {
        let parameters = tables(scaling);
        let mut state = seed | 1;
        let mut next = || {
            state = state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
            state.rotate_left(29)
        };
        let answers: Vec<_> = AKD
            .parameters
            .iter()
            .filter(|parameter| parameter.access != Access::WriteOnly)
            .map(|parameter| {
                let bits = 8 * parameter.octets() as u32;
                // small numbers, large ones, the ends
                let raw = match next() % 4 {
                    0 => next() & 0xFF,
                    1 => u64::MAX,
                    2 => 1 << (bits - 1),
                    _ => next(),
                };
                let unused = u32::from(parameter.wide && !parameter.signed);
                let raw = (raw << (64 - bits)) >> (64 - bits) << unused >> unused;
                let index = if parameter.is_array() { next() as u16 % parameter.elements } else { 0 };
                Ok(reading(&parameters, parameter, index, raw as i64))
            })
            .collect();
        let backup = Backup::new(header(), parameters, answers);
        let text = backup.to_string();
        let again = Backup::read(&text);
        prop_assert!(again.is_ok(), "{:?}", again);
        let again = again.unwrap();
        prop_assert_eq!(&again, &backup);
        prop_assert_eq!(again.parameters().scaling, scaling);
        prop_assert_eq!(again.to_string(), text);
        prop_assert!(compare(&again, &backup).is_empty());
    }

    /// Any line, any file: an error with a line of the file, or something that prints and reads back as the same.
    #[test]
    fn any_text_is_read_or_refused(lines in prop::collection::vec("[ -~\\n#=:(]{0,40}|p?2108 ?= ?[-0-9.e]{1,8} ?(rpm/s|A)?|p915\\[[0-9]{1,3}\\] = 0x[0-9A-F]{0,6}", 0..12)) {
        let text = with_head(&lines.join("\n"));
        match Backup::read(&text) {
            Ok(backup) => prop_assert_eq!(&Backup::read(backup.to_string()).unwrap(), &backup),
            Err(error) => {
                let count = text.lines().count();
                prop_assert!(!error.problems.is_empty());
                prop_assert!(error.problems.iter().all(|problem| (1..=count).contains(&problem.line)));
            }
        }
    }
}
