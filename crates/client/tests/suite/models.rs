//! One client for all vendors: AKD, VLT and Vacon side by side, and drives without a built-in catalogue, in virtual
//! time.

mod running;
mod saving;
mod status;
mod without_tables;

use std::time::Duration;

use network::host::Host;
use profidrive_client::axis::{Jog, Purpose, SpeedUnit};
use profidrive_client::backup::{Backup, compare};
use profidrive_client::change::Choice;
use profidrive_client::status::diagnose;
use profidrive_client::{AxisSettings, Described, Drive, Error, ReportedLimits, StopWay, Wait, WriteMode};
use profile::catalogue::{Catalogue, Meaning, Part};
use profile::model::Model;
use profile::notation::Notation;
use profile::parameter::{Dialect, RequestId};
use profile::state::{Mode, Profile, State};
use profile::value::{Assignment, Content};
use profinet::MacAddress;
use profinet::device::Stored;
use testbench::{Bench, bench_of, find, ip, running_on, select, with_drive};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

const NAMES: [&str; 3] = ["akd-1", "vlt-1", "vacon-1"];

fn station_of(
    model: &'static model::Model,
    name: &str,
    last: u8,
    ids: Option<(u16, u16)>,
) -> Box<Host<Station>> {
    let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, last]));
    if let Some((vendor_id, device_id)) = ids {
        config.description.identity.vendor_id = vendor_id;
        config.description.identity.device_id = device_id;
    }
    config.network = Stored {
        name: name.into(),
        ip: ip(last),
        ..Stored::default()
    };
    Box::new(Host::new(Station::new(config)))
}

fn all_models() -> Bench {
    let models = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
    bench_of(stations.collect()).0
}

fn assign(text: &str) -> Assignment {
    text.parse().expect("an assignment")
}

fn write(session: &mut Bench, drive: &mut Drive, text: &str, mode: WriteMode) -> Result<(), Error> {
    let set = session.write(drive, &[assign(text)], mode).wait()?;
    set.accepted()?;
    assert!(set.is_done(), "{text}: {set:?}");
    Ok(())
}

fn number(session: &mut Bench, drive: &mut Drive, text: &str) -> f64 {
    let selection = select(drive, text);
    let reading = session.read_one(drive, &selection).wait().expect("a value");
    reading.number().expect("a number")
}

/// Runs a drive and gives the speed it says it has, what it really has in rpm, and the telegram.
fn turned(session: &mut Bench, name: &str, settings: AxisSettings, speed: f64) -> Result<(f64, u16), Error> {
    let mut drive = find(session, name).expect("there");
    session.recognise(&mut drive, &mut |_, _| {}).wait()?;
    let mut axis = session.take_axis(&mut drive, settings).wait()?;
    let mut enabled = axis.enable().wait()?;
    enabled.reach_speed(speed, None).wait()?;
    enabled.keep_speed(speed, Duration::from_millis(500)).wait()?;
    let actual = enabled.status().and_then(|status| status.speed_actual);
    enabled.disable().wait()?;
    let telegram = axis.telegram();
    axis.release().wait()?;
    Ok((actual.expect("a speed"), telegram))
}

/// Steps for one model: its ramp in both spellings, a wrong unit, a read-only parameter, a value too high.
struct Way {
    ramp: &'static str,
    same: &'static str,
    unit: &'static str,
    shown: &'static str,
    wrong_unit: (&'static str, &'static str),
    read_only: &'static str,
    /// Refused by the tables, or by the drive.
    limit: &'static str,
}

const WAYS: [Way; 3] = [
    Way {
        ramp: "DRV.ACC",
        same: "p2108",
        unit: "rpm/s",
        shown: "p2108",
        wrong_unit: ("DRV.ACC=5A", "unit of current"),
        read_only: "VL.FB=1",
        limit: "DRV.ACC=1",
    },
    Way {
        ramp: "3-41",
        same: "p341",
        unit: "s",
        shown: "3-41",
        wrong_unit: ("3-41=5A", "unit of current"),
        read_only: "16-17=1",
        limit: "3-41=3601",
    },
    Way {
        ramp: "ID 103",
        same: "103",
        unit: "s",
        shown: "ID 103",
        wrong_unit: ("ID103=5Hz", "unit of"),
        read_only: "ID 2=1",
        limit: "ID103=70000",
    },
];

#[test]
fn the_same_calls_read_and_write_every_model() {
    let mut session = all_models();
    for (name, way) in NAMES.into_iter().zip(WAYS) {
        let mut drive = find(&mut session, name).expect("there");
        assert!(drive.model.catalogue.is_some(), "{name}");
        let text = format!("{}=7.5", way.ramp);
        write(&mut session, &mut drive, &text, WriteMode::Write).expect("taken");
        let selection = select(&drive, way.same);
        let reading = session.read_one(&mut drive, &selection).wait().expect("a value");
        assert_eq!((reading.number(), reading.unit), (Some(7.5), way.unit), "{name}");
        assert_eq!(reading.shown().to_string(), way.shown);
        let mut refused = |text: &str| {
            let result = write(&mut session, &mut drive, text, WriteMode::Write);
            result.expect_err(text).to_string()
        };
        let (wrong, words) = way.wrong_unit;
        assert!(refused(wrong).contains(words), "{}", refused(wrong));
        assert!(
            refused(way.read_only).contains("read-only"),
            "{}",
            refused(way.read_only)
        );
        let words = refused(way.limit);
        assert!(words.contains("outside") || words.contains("limit"), "{words}");
        let text = format!("{}=8", way.ramp);
        write(&mut session, &mut drive, &text, WriteMode::Save).expect("kept");
        assert_eq!(number(&mut session, &mut drive, way.same), 8.0);
    }
}

#[test]
fn a_string_of_a_vlt_is_written_and_reads_back() {
    let mut session = all_models();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    for (text, expected) in [
        ("0-37=HELLO", "HELLO"),
        ("0-37=\"PUMP 3, NORTH\"", "PUMP 3, NORTH"),
        ("0-37=42", "42"),
        ("0-37=\"\"", ""),
    ] {
        write(&mut session, &mut drive, text, WriteMode::Save).expect(text);
        let selection = select(&drive, "0-37");
        let reading = session.read_one(&mut drive, &selection).wait().expect("a string");
        assert_eq!(reading.content, Content::Text(expected.into()));
    }
    for (text, words) in [
        ("15-40=FC-301", "read-only"),
        ("0-37=12345678901234567890123456", "holds 25 characters"),
        ("0-37=Zürich", "printable ASCII"),
    ] {
        let error = write(&mut session, &mut drive, text, WriteMode::Write).expect_err(text);
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn texts_and_selections_are_shown_as_text() {
    let mut session = all_models();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    let selections = ["15-40", "15-43", "8-10"].map(|text| select(&drive, text));
    let readings: Vec<_> = session.read(&mut drive, &selections).wait().expect("read");
    let values: Vec<_> = readings.into_iter().map(|one| one.expect("answered")).collect();
    assert_eq!(values[0].content, Content::Text("FC-302".into()));
    assert_eq!(values[1].content, Content::Text("07.51".into()));
    assert!(
        values[2].choice.is_some_and(|text| text.contains("profile")),
        "{:?}",
        values[2]
    );
    // every parameter of every model is read without an invalid answer
    for name in NAMES {
        let mut drive = find(&mut session, name).expect("there");
        let tables = drive.model.catalogue.expect("tables");
        let all: Vec<_> = tables
            .parameters
            .iter()
            .map(|parameter| profile::value::Selection::of(parameter, tables.notation))
            .collect();
        let answers = session.read(&mut drive, &all).wait().expect("read");
        assert!(answers.iter().filter(|answer| answer.is_ok()).count() >= tables.parameters.len());
    }
}

#[test]
fn selections_are_written_by_texts_read_from_the_drive() {
    let mut session = all_models();
    let mut vlt = find(&mut session, "vlt-1").expect("there");
    for (text, number) in [("8-10=profidrive", 1.0), ("8-10='FC profile'", 0.0)] {
        write(&mut session, &mut vlt, text, WriteMode::Write).expect("taken");
        let selection = select(&vlt, "8-10");
        let reading = session.read_one(&mut vlt, &selection).wait().expect("answered");
        assert_eq!(reading.number(), Some(number), "{text}");
        assert!(reading.choice.is_some(), "{reading:?}");
    }
    let error = write(&mut session, &mut vlt, "8-10=Siemens", WriteMode::Write).expect_err("no text");
    assert!(
        error.to_string().contains("0 FC profile, 1 PROFIdrive profile"),
        "{error}"
    );
    let mut akd = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut akd, "DRV.OPMODE=velocity", WriteMode::Write).expect("taken");

    let strange = station_of(&model::VLT, "strange", 1, Some((0x1234, 70)));
    let (mut session, _) = bench_of(vec![strange]);
    let mut drive = find(&mut session, "strange").expect("there");
    session
        .recognise(&mut drive, &mut |_, _| {})
        .wait()
        .expect("learned");
    write(
        &mut session,
        &mut drive,
        "810=\"profidrive profile\"",
        WriteMode::Write,
    )
    .expect("taken");
    assert_eq!(number(&mut session, &mut drive, "810"), 1.0);
    let error = write(&mut session, &mut drive, "810=Siemens", WriteMode::Write).expect_err("no text");
    assert!(
        error.to_string().contains("is none of its texts: 0 FC profile"),
        "{error}"
    );
}
