//! One client for all makes: AKD, VLT and Vacon side by side, and drives that nobody has tables of, in virtual time.

mod bench;

use std::time::Duration;

use bench::{Bench, bench_of, find, ip, select, with_drive};
use drive_client::axis::{Jog, Purpose, SpeedUnit};
use drive_client::backup::{Backup, Choice, Journal, compare};
use drive_client::parameter::{Assignment, Content};
use drive_client::status::diagnose;
use drive_client::{AxisSettings, Described, DescribedLimits, Drive, Error, Model, StopWay, WriteMode};
use network::host::Host;
use profidrive::catalogue::{Catalogue, Part};
use profidrive::notation::Notation;
use profidrive::parameter::{Dialect, RequestId};
use profidrive::state::{Mode, Profile, State};
use profinet::MacAddress;
use profinet::device::Stored;
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

fn makes() -> Bench {
    let models = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
    bench_of(stations.collect()).0
}

fn assign(text: &str) -> Assignment {
    text.parse().expect("an assignment")
}

fn write(session: &mut Bench, drive: &mut Drive, text: &str, mode: WriteMode) -> Result<(), Error> {
    for outcome in session.write(drive, &[assign(text)], mode)? {
        if let Some(Err(refusal)) = outcome.written {
            let drive = drive.label();
            return Err(Error::Refused { drive, refusal });
        }
        assert!(!outcome.differs(), "{text}: {outcome:?}");
    }
    Ok(())
}

fn number(session: &mut Bench, drive: &mut Drive, text: &str) -> f64 {
    let selection = select(drive, text);
    let reading = session.read_one(drive, &selection).expect("a value");
    reading.number().expect("a number")
}

/// What is done with one make: its ramp in both spellings, a wrong unit, something read-only, a value too high.
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
fn the_same_calls_read_and_write_every_make() {
    let mut session = makes();
    for (name, way) in NAMES.into_iter().zip(WAYS) {
        let mut drive = find(&mut session, name).expect("there");
        assert!(drive.model.catalogue.is_some(), "{name}");
        let text = format!("{}=7.5", way.ramp);
        write(&mut session, &mut drive, &text, WriteMode::Write).expect("taken");
        let selection = select(&drive, way.same);
        let reading = session.read_one(&mut drive, &selection).expect("a value");
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
    let mut session = makes();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    for (text, expected) in [
        ("0-37=HELLO", "HELLO"),
        ("0-37=\"PUMP 3, NORTH\"", "PUMP 3, NORTH"),
        ("0-37=42", "42"),
        ("0-37=\"\"", ""),
    ] {
        write(&mut session, &mut drive, text, WriteMode::Save).expect(text);
        let selection = select(&drive, "0-37");
        let reading = session.read_one(&mut drive, &selection).expect("a string");
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
fn texts_and_selections_are_told_in_words() {
    let mut session = makes();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    let selections = ["15-40", "15-43", "8-10"].map(|text| select(&drive, text));
    let readings: Vec<_> = session.read(&mut drive, &selections).expect("read");
    let told: Vec<_> = readings.into_iter().map(|one| one.expect("told")).collect();
    assert_eq!(told[0].content, Content::Text("FC-302".into()));
    assert_eq!(told[1].content, Content::Text("07.51".into()));
    assert!(
        told[2].choice.is_some_and(|text| text.contains("profile")),
        "{:?}",
        told[2]
    );
    // every parameter of every make is read without an answer that makes no sense
    for name in NAMES {
        let mut drive = find(&mut session, name).expect("there");
        let tables = drive.model.catalogue.expect("tables");
        let all: Vec<_> = tables
            .parameters
            .iter()
            .map(|parameter| drive_client::parameter::Selection::of(parameter, tables.notation))
            .collect();
        let answers = session.read(&mut drive, &all).expect("read");
        assert!(answers.iter().filter(|answer| answer.is_ok()).count() >= tables.parameters.len());
    }
}

#[test]
fn every_make_turns_and_says_so() {
    let mut session = makes();
    for name in NAMES {
        let mut drive = find(&mut session, name).expect("there");
        let before = diagnose(&session.status(&mut drive).expect("a status"));
        assert_eq!(before.cause.id(), "no-controller", "{name}: {before:?}");
        let mut axis = session
            .take_axis(&mut drive, AxisSettings::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut enabled = axis.enable().unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled
            .reach_speed(600.0, None)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled.hold(Duration::from_millis(500)).expect("it runs");
        let status = enabled.status().expect("a status");
        let speed = status.speed_actual.expect("a speed");
        assert!((speed - 600.0).abs() < 20.0, "{name}: {speed}");
        drop(enabled);
        {
            let (session, drive) = axis.session();
            let status = session.status(drive).expect("a status");
            assert_eq!(status.state(), Some(State::S2), "{name}: {status:?}");
            let snapshot = session.snapshot(drive, &[]).expect("a snapshot");
            let told = snapshot.speed_actual.expect("a speed");
            assert_eq!(told.unit, "rpm", "{name}");
        }
        drop(axis);
        let state = session.status(&mut drive).expect("a status").state();
        assert!(!state.is_some_and(State::pulses), "{name}: {state:?}");
    }
}

/// Whatever keeps a drive from running is told with what to do, in the parameters and words of its make.
#[test]
fn what_keeps_a_make_from_running_is_told_with_its_remedy() {
    type Row = (
        &'static str,
        [&'static str; 3],
        [&'static str; 3],
        [&'static str; 3],
    );
    // what happens; the cause of it; words of the sentence; words of the advice
    let rows: [Row; 3] = [
        (
            "sto=on",
            ["sto", "fault", "fault"],
            [
                "STO.STATE",
                "F68 is present: Safe stop",
                "F30 is present: Safe torque off",
            ],
            ["safety circuit", "terminal 37", "safety circuit"],
        ),
        (
            "mains=off",
            ["no-power"; 3],
            ["its DC bus has"; 3],
            ["VBUS.VALUE", "16-30", "ID 7"],
        ),
        (
            "limit+=on",
            ["no-controller"; 3],
            ["no controller is connected"; 3],
            ["HWLS.POSSTATE", "", ""],
        ),
    ];
    for (happening, causes, sentences, advices) in rows {
        let models = model::ALL.iter().zip(NAMES).zip(1..);
        let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
        let (mut session, ids) = bench_of(stations.collect());
        for (at, name) in NAMES.into_iter().enumerate() {
            let mut drive = find(&mut session, name).expect("there");
            let waits = diagnose(&session.status(&mut drive).expect("a status"));
            assert!(
                waits.cause.id() == "no-controller" && waits.notes.is_empty(),
                "{name}: {waits:?}"
            );
            with_drive(&mut session, ids[at], |drive| {
                drive.inject(happening.parse().expect("an injection"));
            });
            session.pass(Duration::from_secs(60)).expect("time passes");
            let found = diagnose(&session.status(&mut drive).expect("a status"));
            let told = format!("{name}, {happening}: {found:?}");
            assert_eq!(found.cause.id(), causes[at], "{told}");
            assert!(found.sentence.contains(sentences[at]), "{told}");
            let advice = format!("{:?} {:?}", found.next, found.notes);
            assert!(advice.contains(advices[at]), "{told}");
            if name != "akd-1" {
                for group in [
                    "DRV.",
                    "VBUS.",
                    "HWLS.",
                    "SWLS.",
                    "IL.",
                    "VL.",
                    "STO.STATE",
                    "MOTOR.",
                ] {
                    assert!(!told.contains(group), "{told}");
                }
            }
        }
    }
}

/// A situation of the buffer has eight places, and a drive may have more faults than that.
#[test]
fn faults_that_the_buffer_has_no_place_for_are_told_too() {
    let (mut session, ids) = bench_of(vec![station_of(&model::AKD, "akd-1", 1, None)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let numbers = [439, 301, 302, 501, 502, 535, 307, 408, 130, 131];
    for number in numbers {
        with_drive(&mut session, ids[0], |drive| drive.inject_fault(number, false));
        session.pass(Duration::from_millis(50)).expect("time passes");
    }
    let report = session.fault_report(&mut drive).expect("told");
    let told: Vec<u16> = report.present().map(|fault| fault.number).collect();
    assert_eq!(told, numbers);
    assert!(
        report
            .present()
            .all(|fault| fault.meaning.is_some() && fault.situation == 0)
    );
}

/// Warnings come with their remedy, beside the sentence.
#[test]
fn a_warning_of_each_make_is_told_with_its_remedy() {
    let models = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = models.map(|((model, name), last)| station_of(model, name, last, None));
    let (mut session, ids) = bench_of(stations.collect());
    for ((name, number), id) in NAMES.into_iter().zip([304, 59, 14]).zip(ids) {
        let mut drive = find(&mut session, name).expect("there");
        with_drive(&mut session, id, |drive| {
            drive.inject(format!("warning={number}").parse().expect("an injection"));
        });
        session.pass(Duration::from_secs(1)).expect("time passes");
        let found = diagnose(&session.status(&mut drive).expect("a status"));
        let note = found.notes.first().unwrap_or_else(|| panic!("{name}: {found:?}"));
        assert_eq!(note.id, "warning", "{name}: {note:?}");
        let tables = drive.model.catalogue.expect("tables");
        let mut numbers = [Part::Warning, Part::WarningWord]
            .iter()
            .flat_map(|&part| tables.parts_of(part));
        if numbers.next().is_none() {
            // a Vacon tells that there is one, not which
            assert!(note.sentence.contains("ZSW1 bit 7"), "{name}: {note:?}");
            continue;
        }
        assert!(note.sentence.contains(&format!("n{number} ")), "{name}: {note:?}");
        let row = tables.fault(number, true);
        assert_eq!(note.next.as_deref(), row.map(|row| row.remedy), "{name}");
    }
}

#[test]
fn settings_go_there_and_back() {
    for (at, (name, way)) in NAMES.into_iter().zip(WAYS).enumerate() {
        let mut session = makes();
        let mut drive = find(&mut session, name).expect("there");
        let first = session.backup(&mut drive, &mut |_, _| {}).expect("saved");
        assert!(first.readings().len() > 30, "{name}: {}", first.readings().len());
        let text = first.to_string();
        assert!(text.contains(&format!("\n{} ", way.shown)), "{text}");
        assert_eq!(
            Backup::parse(&text).expect("read back").to_string(),
            text,
            "{name}"
        );
        let change = format!("{}=7.5", way.ramp);
        write(&mut session, &mut drive, &change, WriteMode::Write).expect("taken");
        let changed = session.backup(&mut drive, &mut |_, _| {}).expect("saved");
        let differences = compare(&first, &changed);
        assert_eq!(differences.len(), 1, "{name}: {differences:?}");
        let plan = session
            .plan(&mut drive, &first, &Choice::default())
            .expect("a plan");
        assert_eq!(plan.changes.len(), 1, "{name}");
        let mut journal = Journal::new(&plan);
        session
            .restore(&mut drive, &mut journal, true, &mut |_| Ok(()))
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(journal.is_done(), "{name}: {journal}");
        let last = session.backup(&mut drive, &mut |_, _| {}).expect("saved");
        assert_eq!(last.to_string(), text, "{name} {at}");
    }
}

#[test]
fn a_drive_nobody_has_tables_of_tells_them_itself() {
    let strange = |id| station_of(&model::VLT, "strange", 1, Some((0x1234, id)));
    let (mut session, _) = bench_of(vec![strange(7)]);
    let mut drive = find(&mut session, "strange").expect("there");
    assert_eq!(
        (drive.model.name, drive.model.catalogue.is_none()),
        ("PROFIdrive", true)
    );
    let mut told = Vec::new();
    session
        .recognise(&mut drive, &mut |done, all| told.push((done, all)))
        .expect("learned");
    let tables = drive.model.catalogue.expect("its own tables");
    assert!(drive.model.learned && told.last().is_some_and(|(done, all)| done == all));
    assert_eq!((drive.model.dialect.axis, tables.notation), (0, Notation::Name));
    assert!(tables.parameters.len() > 250, "{}", tables.parameters.len());
    // names are those of the descriptions, numbers always work
    let ramp = select(&drive, "341");
    let row = ramp.parameter.expect("described");
    assert_eq!(
        (row.name, row.unit, row.maximum),
        ("Ramp 1 Ramp up T", "s", Some(3600.0))
    );
    assert_eq!(number(&mut session, &mut drive, "341"), 3.0);
    write(&mut session, &mut drive, "341=7.5s", WriteMode::Write).expect("taken");
    assert_eq!(number(&mut session, &mut drive, "p341"), 7.5);
    let error = write(&mut session, &mut drive, "341=3601", WriteMode::Write).expect_err("too long");
    assert!(error.to_string().contains("outside 0.01 to 3600 s"), "{error}");
    let error = write(&mut session, &mut drive, "1617=1", WriteMode::Write).expect_err("a measurement");
    assert!(error.to_string().contains("read-only"), "{error}");
    // selections by their texts, strings as text
    let selection = select(&drive, "810");
    let reading = session.read_one(&mut drive, &selection).expect("told");
    assert!(
        reading.choice.is_some_and(|text| text.contains("profile")),
        "{reading:?}"
    );
    let selection = select(&drive, "1540");
    let reading = session.read_one(&mut drive, &selection).expect("told");
    assert_eq!(reading.content, Content::Text("FC-302".into()));
    // another of its kind is known at once
    let mut again = find(&mut session, "strange").expect("there");
    session
        .recognise(&mut again, &mut |_, _| panic!("asked again"))
        .expect("known");
    assert!(std::ptr::eq(
        tables,
        again.model.catalogue.expect("the same tables")
    ));
    // and it is backed up by number and octets, as nobody else has its tables
    let saved = session.backup(&mut drive, &mut |_, _| {}).expect("saved");
    let read = Backup::parse(&saved.to_string()).expect("read back");
    assert!(compare(&saved, &read).is_empty());
    write(&mut session, &mut drive, "341=9s", WriteMode::Write).expect("taken");
    let plan = session
        .plan(&mut drive, &read, &Choice::default())
        .expect("a plan");
    assert_eq!(plan.changes.len(), 1);
    let mut journal = Journal::new(&plan);
    session
        .restore(&mut drive, &mut journal, false, &mut |_| Ok(()))
        .expect("restored");
    assert!(journal.is_done(), "{journal}");
    let status = session.status(&mut drive).expect("a status");
    assert!(status.status_word.is_some());
    assert!(session.faults(&mut drive).expect("told").is_empty());
}

#[test]
fn a_drive_that_tells_nothing_of_itself_goes_by_number() {
    let own = &model::VLT;
    let few = own.catalogue.parameters.iter().copied();
    let few = few.filter(|row| !(980..=989).contains(&row.pnu));
    let tables = Catalogue::assemble(
        "mute",
        own.catalogue.notation,
        own.catalogue.scaling,
        own.catalogue.device,
        few.collect(),
    );
    let mute: &'static model::Model = Box::leak(Box::new(model::Model {
        catalogue: Box::leak(Box::new(tables)),
        ..own.clone()
    }));
    let station = station_of(mute, "mute", 1, Some((0x1234, 99)));
    let (mut session, _) = bench_of(vec![station]);
    let mut drive = find(&mut session, "mute").expect("there");
    session.recognise(&mut drive, &mut |_, _| {}).expect("reached");
    assert!(drive.model.catalogue.is_none());
    assert_eq!(drive.model.dialect.axis, 0, "the axis was found all the same");
    assert_eq!(number(&mut session, &mut drive, "341"), 300.0);
    write(&mut session, &mut drive, "341=750", WriteMode::Write).expect("taken");
    assert_eq!(number(&mut session, &mut drive, "341"), 750.0);
}

/// Nothing is enabled for what a drive cannot do; where PNU 930 is read-only nobody is told to write it.
#[test]
fn speed_drives_refuse_positions_before_anything_is_enabled() {
    let mut session = makes();
    for name in &NAMES[1..] {
        let mut drive = find(&mut session, name).expect("there");
        for purpose in [Purpose::Home, Purpose::Task, Purpose::Move, Purpose::RealTimeJog] {
            let settings = AxisSettings::for_purpose(purpose);
            let error = session.take_axis(&mut drive, settings).map(|_| ());
            let error = error.expect_err("no positions");
            assert!(
                matches!(error, Error::SpeedOnly { .. }),
                "{name} {purpose:?}: {error}"
            );
            assert!(error.hint().is_some_and(|hint| !hint.contains("930")));
        }
        let error = session.check_mode(&mut drive, Mode::Position);
        assert!(matches!(error, Err(Error::SpeedOnly { .. })), "{name}: {error:?}");
    }
    let mut drive = find(&mut session, NAMES[0]).expect("there");
    let error = session.check_mode(&mut drive, Mode::Position);
    assert!(matches!(error, Err(Error::WrongMode { .. })), "{error:?}");
}

#[test]
fn a_person_may_force_the_model() {
    let station = station_of(&model::VLT, "odd", 1, Some((0x1234, 3)));
    let (mut session, _) = bench_of(vec![station]);
    let found = find(&mut session, "odd").expect("there");
    let mut drive = found.taken_for(Model::by_name("vlt").expect("known"));
    let selection = select(&drive, "3-41");
    let reading = session.read_one(&mut drive, &selection).expect("a value");
    assert_eq!(
        (reading.number(), reading.name),
        (Some(3.0), Some("Ramp 1 Ramp up Time"))
    );
    assert_eq!(
        drive
            .model
            .catalogue
            .and_then(|tables| tables.part(Part::Speed))
            .map(|row| row.pnu),
        Some(1617)
    );
}

#[test]
fn the_words_of_a_make_are_told_in_its_bits() {
    let mut session = makes();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    let status = session.status(&mut drive).expect("a status");
    assert_eq!(status.profile, Profile::DanfossProfidrive);
    assert!(status.zsw1.is_some() && status.status_word.is_some());
    let mut drive = find(&mut session, "vacon-1").expect("there");
    assert_eq!(
        session.status(&mut drive).expect("a status").profile,
        Profile::Profidrive
    );
}

#[test]
fn selections_are_written_by_their_texts_also_where_the_drive_told_them() {
    let mut session = makes();
    let mut vlt = find(&mut session, "vlt-1").expect("there");
    for (text, number) in [("8-10=profidrive", 1.0), ("8-10='FC profile'", 0.0)] {
        write(&mut session, &mut vlt, text, WriteMode::Write).expect("taken");
        let selection = select(&vlt, "8-10");
        let reading = session.read_one(&mut vlt, &selection).expect("told");
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

    let strange = station_of(&model::VLT, "strange", 1, Some((0x1234, 7)));
    let (mut session, _) = bench_of(vec![strange]);
    let mut drive = find(&mut session, "strange").expect("there");
    session.recognise(&mut drive, &mut |_, _| {}).expect("learned");
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

/// Runs a drive and gives the speed it says it has, what it really has in rpm, and the telegram.
fn turned(session: &mut Bench, name: &str, settings: AxisSettings, speed: f64) -> Result<(f64, u16), Error> {
    let mut drive = find(session, name).expect("there");
    session.recognise(&mut drive, &mut |_, _| {})?;
    let mut axis = session.take_axis(&mut drive, settings)?;
    let mut enabled = axis.enable()?;
    enabled.reach_speed(speed, None)?;
    enabled.keep_speed(speed, Duration::from_millis(500))?;
    let actual = enabled.status().and_then(|status| status.speed_actual);
    enabled.disable()?;
    let telegram = axis.telegram();
    axis.release()?;
    Ok((actual.expect("a speed"), telegram))
}

#[test]
fn telegrams_of_the_makers_turn_their_drives_at_the_same_speed() {
    let mut session = makes();
    let with = |telegram| AxisSettings {
        telegram: Some(telegram),
        ..AxisSettings::default()
    };
    for (name, setting, telegrams) in [
        (
            "vlt-1",
            "8-10='FC profile'",
            &[101, 102, 104, 105, 106, 107, 108, 103, 1][..],
        ),
        ("vlt-1", "8-10='PROFIdrive profile'", &[101, 104]),
        ("vacon-1", "ID101=5Hz", &[148, 149, 150, 1]),
    ] {
        let mut drive = find(&mut session, name).expect("there");
        write(&mut session, &mut drive, setting, WriteMode::Write).expect("taken");
        for &number in telegrams {
            let (speed, used) = turned(&mut session, name, with(number), 900.0)
                .unwrap_or_else(|error| panic!("{name} {number}: {error}"));
            assert!((speed - 900.0).abs() < 30.0, "{name} {number}: {speed}");
            assert_eq!(used, number);
            // what is plugged is used by itself
            let (speed, used) = turned(&mut session, name, AxisSettings::default(), 600.0)
                .unwrap_or_else(|error| panic!("{name} {number}: {error}"));
            assert!((speed - 600.0).abs() < 20.0, "{name} {number}: {speed}");
            assert_eq!(used, number, "{name}");
        }
    }
    let error = turned(&mut session, "vlt-1", with(999), 60.0).expect_err("no such telegram");
    assert_eq!(error.to_string(), "vlt-1 has no telegram 999");
    assert!(error.hint().is_some_and(|hint| hint.contains("104")), "{error}");
    let error = turned(&mut session, "akd-1", with(9), 60.0).expect_err("no speed in it");
    assert!(error.to_string().contains("carries what this needs"), "{error}");
}

#[test]
fn words_of_a_ppo_type_that_settings_choose_keep_their_parameters() {
    let mut session = makes();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    for setting in [
        "922=104",
        "915[2]=341",
        "915[3]=341",
        "915[4]=312",
        "341=7.5s",
        "312=25%",
    ] {
        write(&mut session, &mut drive, setting, WriteMode::Write)
            .unwrap_or_else(|error| panic!("{setting}: {error}"));
    }
    let settings = AxisSettings {
        telegram: Some(104),
        ..AxisSettings::default()
    };
    turned(&mut session, "vlt-1", settings, 300.0).expect("it turns");
    assert_eq!(number(&mut session, &mut drive, "3-41"), 7.5);
    assert_eq!(number(&mut session, &mut drive, "3-12"), 25.0);
}

#[test]
fn a_drive_nobody_has_tables_of_turns_at_a_share_of_its_reference() {
    for (model, id) in [(&model::VLT, 21), (&model::VACON, 22)] {
        let name = model.catalogue.model;
        let strange = || bench_of(vec![station_of(model, "strange", 1, Some((0x1234, id)))]).0;
        let mut session = strange();
        let error = turned(&mut session, "strange", AxisSettings::default(), 60.0).expect_err("no rpm");
        assert!(
            error.to_string().contains("how many rpm that is nobody knows"),
            "{name}: {error}"
        );
        let hint = error.hint().unwrap_or_default();
        assert!(
            hint.contains("--velocity 20%") && hint.contains("--reference-speed"),
            "{hint}"
        );
        let percent = AxisSettings {
            unit: SpeedUnit::Percent,
            speed_limit: 100.0,
            ..AxisSettings::default()
        };
        let (speed, telegram) =
            turned(&mut session, "strange", percent, 20.0).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!((speed - 20.0).abs() < 1.5, "{name}: {speed} %");
        assert_eq!(telegram, 1);
        let error = turned(&mut session, "strange", percent, 120.0).expect_err("above the limit");
        assert_eq!(error.to_string(), "120 % is above the limit of 100 %");
        let known = AxisSettings {
            reference_speed: Some(1500.0),
            ..AxisSettings::default()
        };
        let (speed, _) =
            turned(&mut session, "strange", known, 300.0).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!((speed - 300.0).abs() < 25.0, "{name}: {speed} rpm");
        // and without any tables: only its axis is looked for
        let mut session = strange();
        let standard = Model::by_name("standard").expect("the profile");
        let mut drive = find(&mut session, "strange").expect("there").taken_for(standard);
        session.find_channel(&mut drive).expect("reached");
        assert!(drive.model.catalogue.is_none() && number(&mut session, &mut drive, "964[0]") > 0.0);
        let mut axis = session
            .take_axis(&mut drive, percent)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut enabled = axis.enable().unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled
            .reach_speed(10.0, None)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    let mut session = makes();
    let percent = AxisSettings {
        unit: SpeedUnit::Percent,
        ..AxisSettings::default()
    };
    let error = turned(&mut session, "akd-1", percent, 20.0).expect_err("no reference");
    assert!(
        error.to_string().contains("in rpm, there is no reference"),
        "{error}"
    );
    let (speed, _) = turned(&mut session, "vlt-1", percent, 40.0).expect("a VLT has one");
    assert!((speed - 40.0).abs() < 1.5, "{speed}");
}

#[test]
fn a_fault_of_every_make_is_told_with_its_meaning_and_acknowledged() {
    let stations = model::ALL.iter().zip(NAMES).zip(1..);
    let stations = stations.map(|((model, name), last)| station_of(model, name, last, None));
    let (mut session, ids) = bench_of(stations.collect());
    for (((name, id), model), number) in NAMES.into_iter().zip(ids).zip(model::ALL).zip([439, 9, 1]) {
        let mut drive = find(&mut session, name).expect("there");
        for telegram in [None, Some(104), Some(149)] {
            let has = |number: &u16| model.catalogue.device.telegram(*number).is_some();
            if telegram.is_some_and(|number| !has(&number)) {
                continue;
            }
            let row = model.catalogue.fault(number, false).expect("a fault");
            with_drive(&mut session, id, |drive| drive.inject_fault(row.number, false));
            session.pass(Duration::from_millis(200)).expect("time passes");
            let report = session.fault_report(&mut drive).expect("told");
            let present: Vec<_> = report.present().collect();
            assert_eq!(present.len(), 1, "{name}: {present:?}");
            let fault = present.first().expect("one");
            assert_eq!(
                (fault.number, fault.meaning, fault.remedy),
                (row.number, Some(row.meaning), Some(row.remedy)),
                "{name}"
            );
            assert!(
                report.zsw1.is_some_and(|word| word & 8 != 0),
                "{name}: {:04X?}",
                report.zsw1
            );
            let status = session.status(&mut drive).expect("a status");
            let diagnosis = diagnose(&status);
            assert_eq!(diagnosis.cause.id(), "fault", "{name}: {diagnosis:?}");
            assert!(diagnosis.sentence.contains(row.meaning), "{name}: {diagnosis:?}");
            let settings = AxisSettings {
                telegram,
                ..AxisSettings::for_purpose(Purpose::Control)
            };
            let mut axis = session.take_axis(&mut drive, settings).expect("free");
            axis.ready_or_fault().expect("connected");
            axis.acknowledge()
                .unwrap_or_else(|error| panic!("{name} {telegram:?}: {error}"));
            axis.release().expect("released");
            let report = session.fault_report(&mut drive).expect("told");
            assert_eq!(report.present().count(), 0, "{name} {telegram:?}: {report:?}");
            assert!(
                report.zsw1.is_some_and(|word| word & 8 == 0),
                "{name}: {:04X?}",
                report.zsw1
            );
            // what was is still told
            let before = report.faults.iter().map(|fault| (fault.number, fault.meaning));
            let mut all = before.chain(report.log.iter().map(|fault| (fault.number, fault.meaning)));
            assert!(
                all.any(|one| one == (row.number, Some(row.meaning))),
                "{name}: {report:?}"
            );
            let after = diagnose(&session.status(&mut drive).expect("a status"));
            assert_ne!(after.cause.id(), "fault", "{name}: {after:?}");
        }
    }
}

#[test]
fn a_converter_is_not_stopped_beside_its_controller_and_says_so() {
    let mut session = makes();
    for name in ["vlt-1", "vacon-1"] {
        let mut drive = find(&mut session, name).expect("there");
        let mut axis = session
            .take_axis(&mut drive, AxisSettings::default())
            .expect("free");
        let mut enabled = axis.enable().expect("it starts");
        enabled.reach_speed(300.0, None).expect("it runs");
        let (inner, own) = enabled.session();
        let error = inner
            .stop_drive(own, StopWay::Stop, Duration::from_secs(1))
            .expect_err("owned");
        assert!(
            error
                .to_string()
                .contains("no parameter that stops it, and controller \"client\""),
            "{error}"
        );
        assert!(
            error
                .hint()
                .is_some_and(|hint| hint.contains("at its controller")),
            "{error}"
        );
        drop(enabled);
        axis.release().expect("released");
        let outcome = session.stop_drive(&mut drive, StopWay::Stop, Duration::from_secs(1));
        assert!(
            outcome.is_ok_and(|outcome| !outcome.sent && outcome.at_rest),
            "{name}"
        );
    }
}

/// What only an AKD has is in no text about another make.
#[test]
fn facts_of_a_make_come_from_its_own_parameters() {
    let mut session = makes();
    let limits = [
        (
            "vlt-1",
            Some(Part::Reference),
            Some((0.0, Some(Part::ReferenceRange))),
        ),
        (
            "vacon-1",
            Some(Part::Reference),
            Some((1500.0, Some(Part::Reference))),
        ),
    ];
    for (name, forward, backward) in limits {
        let mut drive = find(&mut session, name).expect("there");
        let facts = session.motion_facts(&mut drive).expect("facts");
        assert_eq!(
            (facts.forward_limit.map(f64::round), facts.forward_by),
            (Some(1500.0), forward),
            "{name}"
        );
        let found = facts
            .backward_limit
            .map(|limit| (limit.round(), facts.backward_by));
        assert_eq!(found, backward, "{name}");
        let backup = session.backup(&mut drive, &mut |_, _| {}).expect("saved");
        assert_eq!(backup.lacks(&drive.model), 0, "{name}");
        let text = backup.to_string();
        for foreign in ["scaling:", "units:", "MOTOR.TYPE"] {
            assert!(!text.contains(foreign), "{name}: {foreign}");
        }
        let error = Error::SpeedNotReached {
            drive: name.into(),
            wanted: 1.0,
            unit: "rpm",
            highest: None,
            limit: Duration::ZERO,
        };
        let hint = error.hint_for(&drive).expect("a hint");
        assert!(!hint.contains("DRV.") && !hint.contains("VL."), "{hint}");
        assert!(
            hint.contains(if name == "vlt-1" { "3-03" } else { "ID102" }),
            "{hint}"
        );
    }
}

/// Each make jogs at the speed of its own setting, and that one is told.
#[test]
fn every_make_jogs_at_its_own_setting() {
    let mut session = makes();
    for (name, label) in NAMES.into_iter().zip(["(p1004)", "(8-90)", "(ID 124)"]) {
        let mut drive = find(&mut session, name).expect("there");
        let setting = session.jog_speed(&mut drive, Jog::One).expect("known");
        assert!(
            setting.selection.label().ends_with(label),
            "{}",
            setting.selection.label()
        );
        let reading = session.read_one(&mut drive, &setting.selection).expect("told");
        let speed = setting.rpm(&reading).expect("a speed");
        assert!(speed > 10.0, "{name}: {speed}");
        let settings = AxisSettings::for_purpose(Purpose::Jog);
        let mut axis = session.take_axis(&mut drive, settings).expect("connected");
        let mut enabled = axis.enable().expect("enabled");
        enabled.jog(Jog::One).expect("jogs");
        enabled.hold(Duration::from_secs(4)).expect("goes on");
        let actual = enabled.status().and_then(|status| status.speed_actual);
        let near = actual.is_some_and(|actual| (actual - speed).abs() < speed * 0.06 + 2.0);
        assert!(near, "{name}: {actual:?} of {speed}");
        drop(enabled);
        axis.release().expect("at rest");
    }
}

/// What a drive says of one of its parameters, asked as `describe` does.
fn described(session: &mut Bench, drive: &Drive, text: &str) -> Option<Described> {
    session.described(drive, &select(drive, text)).expect("asked")
}

/// Name, type, unit and limits come from the drive itself; what only fits the type is not taken for limits; texts follow.
#[test]
fn a_drive_describes_its_own_parameters_when_asked() {
    let mut session = makes();
    let vlt = find(&mut session, "vlt-1").expect("there");
    let ramp = described(&mut session, &vlt, "3-41").expect("told");
    assert_eq!(
        (ramp.name.as_str(), ramp.data_type, ramp.unit, ramp.elements),
        ("Ramp 1 Ramp up T", Some("Unsigned32"), "s", 1)
    );
    assert_eq!(ramp.limits, DescribedLimits::Own(0.01, 3600.0));
    assert!(!ramp.read_only && !ramp.changed && ramp.texts.is_empty());
    let profile = described(&mut session, &vlt, "8-10").expect("told");
    let texts: Vec<_> = profile
        .texts
        .iter()
        .map(|(value, text)| (*value, text.as_str()))
        .collect();
    assert_eq!(texts[..2], [(0, "FC profile"), (1, "PROFIdrive profi")]);
    // numbers without a text lie between them
    assert_eq!(texts[2..], [(5, "ODVA"), (7, "CANopen DSP 402")]);
    let counter = described(&mut session, &vlt, "16-90").expect("told");
    assert!(counter.read_only, "{counter:?}");
    assert!(
        matches!(counter.limits, DescribedLimits::OfType(low, high) if (low, high) == (0.0, 4_294_967_295.0)),
        "{counter:?}"
    );
    let kind = described(&mut session, &vlt, "15-40").expect("told");
    assert_eq!(kind.limits, DescribedLimits::None, "a text has none");

    let vacon = find(&mut session, "vacon-1").expect("there");
    let telegram = described(&mut session, &vacon, "922").expect("told");
    assert_eq!(telegram.limits, DescribedLimits::OfType(0.0, 65_535.0));
    assert!(telegram.read_only && telegram.data_type == Some("Unsigned16"));
    let signals = described(&mut session, &vacon, "915").expect("told");
    assert_eq!(signals.elements, 16);
    // the description of the collecting number is not that of one of its ids
    assert_eq!(described(&mut session, &vacon, "ID 103"), None);

    // without tables: the same, by what the drive says alone; also of a number that nothing is known of
    for (model, id) in [("strange", 31), ("standard", 32)] {
        let station = station_of(&model::VLT, "strange", 1, Some((0x1234, id)));
        let (mut session, _) = bench_of(vec![station]);
        let mut drive = find(&mut session, "strange").expect("there");
        if model == "strange" {
            session.recognise(&mut drive, &mut |_, _| {}).expect("learned");
            assert!(drive.model.learned);
        } else {
            session.find_channel(&mut drive).expect("reached");
            assert!(drive.model.catalogue.is_none());
        }
        let ramp = described(&mut session, &drive, "341").expect("told");
        assert_eq!(
            (ramp.unit, ramp.limits),
            ("s", DescribedLimits::Own(0.01, 3600.0)),
            "{model}"
        );
        let profile = described(&mut session, &drive, "810").expect("told");
        assert_eq!(profile.texts.len(), 4, "{model}: {profile:?}");
        assert_eq!(described(&mut session, &drive, "4711"), None, "{model}");
    }
}

/// A VLT whose option does not know request 0x42 (only PROFIBUS manuals name it) saves by 9-71.
#[test]
fn values_are_saved_by_a_parameter_where_the_request_that_saves_is_unknown() {
    static DIALECT: Dialect = Dialect {
        requests: &[RequestId::Read, RequestId::Change],
        ..Dialect::VLT
    };
    let plain: &'static model::Model = Box::leak(Box::new(model::Model {
        dialect: &DIALECT,
        ..model::VLT
    }));
    for (model, saves) in [(plain, true), (&model::VLT, false)] {
        let (mut session, _) = bench_of(vec![station_of(model, "vlt-1", 1, None)]);
        let mut drive = find(&mut session, "vlt-1").expect("there");
        let outcomes = session
            .write(&mut drive, &[assign("3-41=7.5")], WriteMode::Save)
            .expect("saved");
        assert!(
            outcomes
                .iter()
                .all(|outcome| matches!(outcome.written, Some(Ok(())))),
            "{outcomes:?}"
        );
        assert!(!outcomes[0].differs());
        let numbers: Vec<u16> = outcomes
            .iter()
            .map(|outcome| outcome.change.selection.pnu)
            .collect();
        let expected: &[u16] = if saves { &[341, 971] } else { &[341] };
        assert_eq!(numbers, expected);
    }
}
