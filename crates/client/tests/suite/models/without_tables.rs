//! Drives without a built-in catalogue, and what a drive describes itself.

use super::*;
use profidrive_client::Wait;
use profile::parameter::{Keep, ParameterAccess};
use testbench::{bench, drive_mut};

#[test]
fn a_drive_without_a_built_in_catalogue_reports_its_parameters() {
    let strange = |id| station_of(&model::VLT, "strange", 1, Some((0x1234, id)));
    let (mut session, _) = bench_of(vec![strange(7)]);
    let mut drive = find(&mut session, "strange").expect("there");
    assert_eq!(
        (drive.model.name, drive.model.catalogue.is_none()),
        ("PROFIdrive", true)
    );
    let mut progress = Vec::new();
    session
        .recognise(&mut drive, &mut |done, all| progress.push((done, all)))
        .wait()
        .expect("learned");
    let tables = drive.model.catalogue.expect("its own tables");
    assert!(drive.model.learned && progress.last().is_some_and(|(done, all)| done == all));
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
    let reading = session.read_one(&mut drive, &selection).wait().expect("answered");
    assert!(
        reading.choice.is_some_and(|text| text.contains("profile")),
        "{reading:?}"
    );
    let selection = select(&drive, "1540");
    let reading = session.read_one(&mut drive, &selection).wait().expect("answered");
    assert_eq!(reading.content, Content::Text("FC-302".into()));
    // another of its kind is known at once
    let mut again = find(&mut session, "strange").expect("there");
    session
        .recognise(&mut again, &mut |_, _| panic!("asked again"))
        .wait()
        .expect("known");
    assert!(std::ptr::eq(
        tables,
        again.model.catalogue.expect("the same tables")
    ));
    // and it is backed up by number and octets, as other programs lack its tables
    let saved = session.backup(&mut drive, &mut |_, _| {}).wait().expect("saved");
    let read = Backup::read(saved.to_string()).expect("read back");
    assert!(compare(&saved, &read).is_empty());
    write(&mut session, &mut drive, "341=9s", WriteMode::Write).expect("taken");
    let mut plan = session
        .plan(&mut drive, &read, &Choice::default())
        .wait()
        .expect("a plan");
    assert_eq!(plan.set.changes().len(), 1);
    session.apply(&mut drive, &mut plan.set).wait().expect("restored");
    assert!(plan.set.is_done(), "{}", plan.set);
    let status = session.status(&mut drive).wait().expect("a status");
    assert!(status.status_word.is_some());
    assert!(session.faults(&mut drive).wait().expect("answered").is_empty());
}

#[test]
fn a_drive_without_descriptions_is_used_by_number() {
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
    session
        .recognise(&mut drive, &mut |_, _| {})
        .wait()
        .expect("reached");
    assert!(drive.model.catalogue.is_none());
    assert_eq!(drive.model.dialect.axis, 0, "the axis was found anyway");
    assert_eq!(number(&mut session, &mut drive, "341"), 300.0);
    write(&mut session, &mut drive, "341=750", WriteMode::Write).expect("taken");
    assert_eq!(number(&mut session, &mut drive, "341"), 750.0);
}

#[test]
fn the_texts_of_a_parameter_are_read_up_to_a_bound() {
    let own = &model::VLT;
    let texts = (0..100).map(|value| Meaning {
        value,
        text: "a choice",
    });
    let texts: &'static [Meaning] = texts.collect::<Vec<_>>().leak();
    let mut rows = own.catalogue.parameters.to_vec();
    for row in rows.iter_mut().filter(|row| row.pnu == 810) {
        row.choices = texts;
    }
    let tables = Catalogue::assemble(
        "talkative",
        own.catalogue.notation,
        own.catalogue.scaling,
        own.catalogue.device,
        rows,
    );
    let talkative: &'static model::Model = Box::leak(Box::new(model::Model {
        catalogue: Box::leak(Box::new(tables)),
        ..own.clone()
    }));
    let station = station_of(talkative, "talkative", 1, Some((0x1234, 98)));
    let (mut session, _) = bench_of(vec![station]);
    let mut drive = find(&mut session, "talkative").expect("there");
    session
        .recognise(&mut drive, &mut |_, _| {})
        .wait()
        .expect("learned");
    let tables = drive.model.catalogue.expect("its own tables");
    assert_eq!(tables.by_pnu(810).map(|row| row.choices.len()), Some(65));
}

#[test]
fn a_person_may_force_the_model() {
    let station = station_of(&model::VLT, "odd", 1, Some((0x1234, 3)));
    let (mut session, _) = bench_of(vec![station]);
    let found = find(&mut session, "odd").expect("there");
    let mut drive = found.as_model(Model::by_name("vlt").expect("known"));
    let selection = select(&drive, "3-41");
    let reading = session.read_one(&mut drive, &selection).wait().expect("a value");
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
fn a_drive_without_a_built_in_catalogue_runs_at_a_percentage() {
    for (model, id) in [(&model::VLT, 21), (&model::VACON, 22)] {
        let name = model.catalogue.model;
        let strange = || bench_of(vec![station_of(model, "strange", 1, Some((0x1234, id)))]).0;
        let mut session = strange();
        let error = turned(&mut session, "strange", running_on(Purpose::Speed), 60.0).expect_err("no rpm");
        assert!(
            error.to_string().contains("which is not known in rpm"),
            "{name}: {error}"
        );
        let hint = error.advice().unwrap_or_default().to_string();
        assert!(
            hint.contains("[choose percent]") && hint.contains("[choose reference-speed]"),
            "{hint}"
        );
        let percent = AxisSettings {
            unit: SpeedUnit::Percent,
            speed_limit: 100.0,
            ..running_on(Purpose::Speed)
        };
        let (speed, telegram) =
            turned(&mut session, "strange", percent, 20.0).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!((speed - 20.0).abs() < 1.5, "{name}: {speed} %");
        assert_eq!(telegram, 1);
        let error = turned(&mut session, "strange", percent, 120.0).expect_err("above the limit");
        assert_eq!(error.to_string(), "120 % is above the limit of 100 %");
        let known = AxisSettings {
            reference_speed: Some(1500.0),
            ..running_on(Purpose::Speed)
        };
        let (speed, _) =
            turned(&mut session, "strange", known, 300.0).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!((speed - 300.0).abs() < 25.0, "{name}: {speed} rpm");
        // and without any tables: only its axis is looked for
        let mut session = strange();
        let standard = Model::by_name("standard").expect("the profile");
        let mut drive = find(&mut session, "strange").expect("there").as_model(standard);
        session.find_channel(&mut drive).wait().expect("reached");
        assert!(drive.model.catalogue.is_none() && number(&mut session, &mut drive, "964[0]") > 0.0);
        let mut axis = session
            .take_axis(&mut drive, percent)
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut enabled = axis
            .enable()
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled
            .reach_speed(10.0, None)
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    let mut session = all_models();
    let percent = AxisSettings {
        unit: SpeedUnit::Percent,
        ..running_on(Purpose::Speed)
    };
    let error = turned(&mut session, "akd-1", percent, 20.0).expect_err("no reference");
    assert!(
        error.to_string().contains("in rpm, there is no reference"),
        "{error}"
    );
    let (speed, _) = turned(&mut session, "vlt-1", percent, 40.0).expect("a VLT has one");
    assert!((speed - 40.0).abs() < 1.5, "{speed}");
}

/// What a drive says of one of its parameters, asked as `describe` does.
fn described(session: &mut Bench, drive: &mut Drive, text: &str) -> Option<Described> {
    let selection = select(drive, text);
    session.described(drive, &selection).wait().expect("asked")
}

/// Name, type, unit and limits come from the drive itself; what only fits the type is not taken for limits; texts follow.
#[test]
fn a_drive_describes_its_own_parameters() {
    let mut session = all_models();
    let mut vlt = find(&mut session, "vlt-1").expect("there");
    let ramp = described(&mut session, &mut vlt, "3-41").expect("answered");
    assert_eq!(
        (ramp.name.as_str(), ramp.data_type, ramp.unit, ramp.elements),
        ("Ramp 1 Ramp up T", Some("Unsigned32"), "s", 1)
    );
    assert_eq!(ramp.limits, ReportedLimits::Own(0.01, 3600.0));
    assert!(!ramp.read_only && !ramp.changed && ramp.texts.is_empty());
    let profile = described(&mut session, &mut vlt, "8-10").expect("answered");
    let texts: Vec<_> = profile
        .texts
        .iter()
        .map(|(value, text)| (*value, text.as_str()))
        .collect();
    assert_eq!(texts[..2], [(0, "FC profile"), (1, "PROFIdrive profi")]);
    // numbers without a text lie between them
    assert_eq!(texts[2..], [(5, "ODVA"), (7, "CANopen DSP 402")]);
    let counter = described(&mut session, &mut vlt, "16-90").expect("answered");
    assert!(counter.read_only, "{counter:?}");
    assert!(
        matches!(counter.limits, ReportedLimits::OfType(low, high) if (low, high) == (0.0, 4_294_967_295.0)),
        "{counter:?}"
    );
    let kind = described(&mut session, &mut vlt, "15-40").expect("answered");
    assert_eq!(kind.limits, ReportedLimits::None, "a text has none");

    let mut vacon = find(&mut session, "vacon-1").expect("there");
    let telegram = described(&mut session, &mut vacon, "922").expect("answered");
    assert_eq!(telegram.limits, ReportedLimits::OfType(0.0, 65_535.0));
    assert!(telegram.read_only && telegram.data_type == Some("Unsigned16"));
    let signals = described(&mut session, &mut vacon, "915").expect("answered");
    assert_eq!(signals.elements, 16);
    // the description of the collecting number is not that of one of its ids
    assert_eq!(described(&mut session, &mut vacon, "ID 103"), None);

    // without tables: the same, by what the drive says alone; also of a number that nothing is known of
    for (model, id) in [("strange", 31), ("standard", 32)] {
        let station = station_of(&model::VLT, "strange", 1, Some((0x1234, id)));
        let (mut session, _) = bench_of(vec![station]);
        let mut drive = find(&mut session, "strange").expect("there");
        if model == "strange" {
            session
                .recognise(&mut drive, &mut |_, _| {})
                .wait()
                .expect("learned");
            assert!(drive.model.learned);
        } else {
            session.find_channel(&mut drive).wait().expect("reached");
            assert!(drive.model.catalogue.is_none());
        }
        let ramp = described(&mut session, &mut drive, "341").expect("answered");
        assert_eq!(
            (ramp.unit, ramp.limits),
            ("s", ReportedLimits::Own(0.01, 3600.0)),
            "{model}"
        );
        let profile = described(&mut session, &mut drive, "810").expect("answered");
        assert_eq!(profile.texts.len(), 4, "{model}: {profile:?}");
        assert_eq!(described(&mut session, &mut drive, "4711"), None, "{model}");
    }
}

/// Limits are in the unit of the tables, by the scaling that the drive has now.
#[test]
fn limits_are_described_with_the_scaling_of_the_drive() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    for scaling in [763_u16, 100] {
        let mut drive = find(&mut session, "akd-1").expect("there");
        drive_mut(&session, ids[0])
            .write(1008, 0, scaling.into(), Keep::Volatile)
            .expect("PN.ACCSCALING");
        let ramp = described(&mut session, &mut drive, "1006").expect("answered");
        let scaling = f64::from(scaling);
        assert_eq!(
            (ramp.unit, ramp.limits),
            ("rpm/s", ReportedLimits::Own(scaling, scaling * 65_535.0))
        );
    }
}
